"""Send runs a signal at random moments, continue each, and compare all files with those of an uninterrupted run.

The moments are uniformly distributed over the wall time of the whole command, so they hit the start of Python, imports, statics, steps,
rows, frames and checkpoints. SIGKILL goes to one rank or to all, other signals to the command as a user would send them. Then
`--restart` must end with the same files, for an equal number of ranks to the last byte. Before the folder exists,
and after a request for a checkpoint, which ends no run, the command itself is repeated or has ended.
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
NOT_COMPARED = ("summary.json", "checkpoint.h5", ".lock")  # files with wall times and process numbers
SIGNALS = ("SIGKILL", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGUSR1")


@dataclass
class Blow:
    """One signal and what followed.

    wall: wall time after the start of the command [s].
    name: of the signal.
    status: exit status of the command, negative by a signal.
    row, saved: simulated times of the last row and of the checkpoint [s]; None if there is none yet.
    caught: files that were being written.
    wrong: files that differ at the end, or what else went wrong.
    """

    wall: float
    name: str
    status: int
    row: float | None
    saved: float | None
    caught: str
    wrong: list[str]


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


def finish(words: list[str], ranks: int) -> str:
    """Run a job to the end; returns what went wrong, empty if nothing did."""
    job = start(words, ranks)
    _, errors = job.communicate()
    return f"status {job.returncode}: {errors.strip()}" if job.returncode else ""


def strike(job: subprocess.Popen, name: str) -> None:
    """Send a signal: SIGKILL to all ranks and their launcher or to one rank, any other to the command."""
    number = getattr(signal, name)
    children = Path(f"/proc/{job.pid}/task/{job.pid}/children")
    ranks = [int(word) for word in children.read_text().split()] if children.exists() else []
    if name == "SIGKILL":
        one = bool(ranks) and random.random() < 0.5
        for target in [random.choice(ranks)] if one else [*ranks, job.pid]:
            try:
                os.kill(target, number)
            except ProcessLookupError:
                pass
    else:
        job.send_signal(number)


def blow_once(case: Path, whole: Path, out: Path, wall: float, name: str, ranks: int) -> Blow | None:
    """Start a run, send it a signal after ``wall`` [s], restart and compare; None if the run ended before."""
    shutil.rmtree(out, ignore_errors=True)
    job = start([str(case), "--out", str(out)], ranks)
    time.sleep(wall)
    if job.poll() is not None:
        return None
    strike(job, name)
    _, errors = job.communicate()
    begun = out.is_dir()
    row, saved, caught = last_row(out), saved_time(out), half_way(out)
    failed = finish([str(case), "--out", str(out), *(["--restart"] if begun else [])], ranks)
    wrong = [failed] if failed else differences(whole, out)
    if "Traceback" in errors and name != "SIGKILL":
        wrong.append(f"a traceback: {errors.strip().splitlines()[-1]}")
    return Blow(wall, name, job.returncode, row, saved, caught if begun else "no folder yet", wrong)


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


def show(number: int, blow: Blow) -> str:
    def shown(value: float | None) -> str:
        return "none" if value is None else f"{value:.6g}"

    verdict = "identical" if not blow.wrong else f"WRONG: {', '.join(blow.wrong[:4])}"
    return (
        f"{number:>4} {blow.wall:>9.3f} {blow.name:>8} {blow.status:>6} {shown(blow.row):>12} {shown(blow.saved):>14}"
        f"   {verdict:<10}  {blow.caught}"
    )


def main(words: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--ranks", type=int, default=1)
    parser.add_argument("--case", type=Path, default=CASE)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--signals", nargs="+", default=SIGNALS, choices=SIGNALS, metavar="SIGNAL")
    arguments = parser.parse_args(words)
    case, ranks = arguments.case.resolve(), arguments.ranks
    random.seed(arguments.seed)
    bad = number = 0
    with tempfile.TemporaryDirectory() as folder:
        whole = Path(folder) / "whole"
        began = time.monotonic()
        failed = finish([str(case), "--out", str(whole)], ranks)
        if failed:
            raise SystemExit(f"kill-test: an uninterrupted run failed with {failed}")
        length = time.monotonic() - began
        print(f"{case.name} on {ranks} rank(s), {length:.3g} s of wall time")
        print(
            "kill  wall [s]   signal status last row [s] checkpoint [s]   files       caught while writing",
            flush=True,
        )
        while number < arguments.kills:
            name = arguments.signals[number % len(arguments.signals)]
            blow = blow_once(case, whole, Path(folder) / "struck", random.uniform(0.0, length), name, ranks)
            if blow is None:
                length *= 0.98  # the first run was slower than usual
                continue
            number += 1
            bad += bool(blow.wrong)
            print(show(number, blow), flush=True)
    print(f"{number - bad} of {number} identical")
    return 1 if bad else 0


if __name__ == "__main__":
    raise SystemExit(main())
