"""Kill a run at random moments, restart it, and compare all files with those of an uninterrupted run.

The moments are uniformly distributed over the wall time from the appearance of the run folder to the end, so
they hit steps, rows, frames and checkpoints. For an equal number of ranks the files must be identical.
"""

from __future__ import annotations

import argparse
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CASE = ROOT / "cases" / "verification" / "kill-test.yaml"
NOT_COMPARED = ("summary.json", "checkpoint.h5")  # files with wall times


@dataclass
class Kill:
    """One kill.

    wall: wall time after the appearance of the folder [s].
    row, saved: simulated times of the last row and of the checkpoint [s]; None if there is none yet.
    caught: files that were being written.
    differ: files that differ at the end.
    """

    wall: float
    row: float | None
    saved: float | None
    caught: str
    differ: list[str]


def command(words: list[str], ranks: int) -> list[str]:
    """Command of a run."""
    alone = [sys.executable, "-m", "drillpetsc", "run", *words, "--progress", "silent"]
    if ranks == 1:
        return alone
    mpirun = shutil.which("mpirun") or "mpirun"
    version = subprocess.run([mpirun, "--version"], capture_output=True, text=True).stdout
    return [
        mpirun,
        *(["--oversubscribe", "--bind-to", "none"] if "Open" in version else []),
        "-n",
        str(ranks),
        *alone,
    ]


def start(words: list[str], ranks: int) -> subprocess.Popen:
    environment = {
        **os.environ,
        "OMP_NUM_THREADS": "1",
        "OMPI_ALLOW_RUN_AS_ROOT": "1",
        "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
        "OMPI_MCA_mpi_yield_when_idle": "1",
        "MPIR_CVAR_POLLS_BEFORE_YIELD": "1",
        "PYTHONPATH": os.pathsep.join([str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])]),
    }
    return subprocess.Popen(
        command(words, ranks), env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    )


def finish(words: list[str], ranks: int) -> None:
    """Run a job to the end."""
    job = start(words, ranks)
    _, errors = job.communicate()
    if job.returncode:
        raise SystemExit(f"kill-test: an uninterrupted run failed with status {job.returncode}:\n{errors}")


def end_all(job: subprocess.Popen) -> None:
    """Send SIGKILL to the ranks, then to their launcher."""
    children = Path(f"/proc/{job.pid}/task/{job.pid}/children")
    ranks = [int(word) for word in children.read_text().split()] if children.exists() else []
    for number in [*ranks, job.pid]:
        try:
            os.kill(number, signal.SIGKILL)
        except ProcessLookupError:
            pass
    job.communicate()


def duration(case: Path, out: Path, ranks: int) -> float:
    """Wall seconds of a whole run from the appearance of its folder."""
    job = start([str(case), "--out", str(out)], ranks)
    while not out.exists() and job.poll() is None:
        time.sleep(0.001)
    began = time.monotonic()
    _, errors = job.communicate()
    if job.returncode:
        raise SystemExit(f"kill-test: the run itself fails with status {job.returncode}:\n{errors}")
    return time.monotonic() - began


def kill_once(case: Path, whole: Path, out: Path, wall: float, ranks: int) -> Kill | None:
    """Start a run, kill it after ``wall`` [s], restart and compare; None if the run ended before."""
    shutil.rmtree(out, ignore_errors=True)
    job = start([str(case), "--out", str(out)], ranks)
    while not out.exists() and job.poll() is None:
        time.sleep(0.0005)
    time.sleep(wall)
    if job.poll() is not None:
        return None
    end_all(job)
    row, saved, caught = last_row(out), saved_time(out), half_way(out)
    finish([str(case), "--out", str(out), "--restart"], ranks)
    return Kill(wall, row, saved, caught, differences(whole, out))


def last_row(out: Path) -> float | None:
    """Time of the last complete row [s]."""
    try:
        lines = (out / "history.csv").read_text().split("\n")[1:-1]
    except FileNotFoundError:
        return None
    return float(lines[-1].split(",")[0]) if lines else None


def saved_time(out: Path) -> float | None:
    """Time of the checkpoint [s]."""
    from drillpetsc.analysis.motion import checkpoint

    return checkpoint.read(out / "checkpoint.h5").time if (out / "checkpoint.h5").exists() else None


def half_way(out: Path) -> str:
    """Names of the files that were being written."""
    found = [p.name.split("-", 1)[1] for p in (*out.glob(".*-*"), *(out / "string").glob(".*-*"))]
    table = out / "history.csv"
    if table.exists() and not table.read_text().endswith("\n"):
        found.append("row")
    listed = (out / "string.pvd").read_text() if (out / "string.pvd").exists() else ""
    found += [f"{p.name} unlisted" for p in (out / "string").glob("[0-9]*.vtu") if p.name not in listed]
    return ", ".join(found)


def differences(one: Path, other: Path) -> list[str]:
    """Names of files that differ or are on one side only."""
    names = {
        str(p.relative_to(folder))
        for folder in (one, other)
        for p in folder.rglob("*")
        if p.is_file() and p.name not in NOT_COMPARED
    }
    return sorted(
        n
        for n in names
        if not (one / n).is_file()
        or not (other / n).is_file()
        or (one / n).read_bytes() != (other / n).read_bytes()
    )


def show(number: int, kill: Kill) -> str:
    def shown(value: float | None) -> str:
        return "none" if value is None else f"{value:.6g}"

    verdict = "identical" if not kill.differ else f"DIFFERENT: {', '.join(kill.differ[:4])}"
    return f"{number:>4} {kill.wall:>10.3f} {shown(kill.row):>12} {shown(kill.saved):>14}   {verdict:<10}  {kill.caught}"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--ranks", type=int, default=1)
    parser.add_argument("--case", type=Path, default=CASE)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    case, ranks = arguments.case.resolve(), arguments.ranks
    random.seed(arguments.seed)
    bad = 0
    with tempfile.TemporaryDirectory() as folder:
        whole = Path(folder) / "whole"
        length = duration(case, whole, ranks)
        print(
            f"{case.name} on {ranks} rank(s), {length:.3g} s of wall time; killed, restarted, compared with an uninterrupted run"
        )
        print("kill   wall [s]  last row [s] checkpoint [s]   files       caught while writing", flush=True)
        number = 0
        while number < arguments.kills:
            kill = kill_once(case, whole, Path(folder) / "killed", random.uniform(0.0, length), ranks)
            if kill is None:
                length *= 0.98  # the first run was slower than usual
                continue
            number += 1
            bad += bool(kill.differ)
            print(show(number, kill), flush=True)
    print(f"{number - bad} of {number} identical")
    return 1 if bad else 0


if __name__ == "__main__":
    raise SystemExit(main())
