"""Runs of a study, each in a separate process for reliable run times; finished runs are kept."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import statistics
import subprocess
import sys
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from drillpetsc.arrays import FloatArray
from drillpetsc.errors import CaseError
from drillpetsc.output import RunFolder, read_summary, read_table
from drillpetsc.output.files.atomic import replace_text
from drillpetsc.output.files.tables import split_name
from drillpetsc.studies.convergence.plan import Base, Point, case_of

COUNTS = (
    "elements",
    "steps",
    "rejected_steps",
    "newton_iterations",
    "linear_iterations",
    "jacobians",
    "residuals",
    "failed_solves",
)
NEEDED_FILES = ("summary.json", "history.csv", "probes.csv", "case.yaml")  # kept of a run folder
MESSAGE_PREFIX = "drillpetsc: "  # of the program's error messages
DONE, FAILED = "done", "failed"


@dataclass(frozen=True)
class Job:
    """One run.

    case: case file. folder: run folder. ranks: number of ranks. limit: longest wall time [s].
    """

    case: Path
    folder: Path
    ranks: int
    limit: float


#: function that runs a job; returns the error message, or an empty text
Runner = Callable[[Job], str]


@dataclass(frozen=True)
class Measured:
    """Measured costs of a point.

    status: DONE or FAILED, with the reason in ``message``.
    folder: folder of the first run, relative to the study's folder.
    wall, cpu: times of the time loop, one value per repetition [s].
    counts: steps, iterations etc. of the first run.
    step: mean step [s].
    energy_error: energy error over the energy of the run.
    """

    point: Point
    status: str
    message: str = ""
    folder: str = ""
    wall: tuple[float, ...] = ()
    cpu: tuple[float, ...] = ()
    counts: dict[str, int] = field(default_factory=dict)
    step: float = float("nan")
    energy_error: float = float("nan")

    @property
    def done(self) -> bool:
        return self.status == DONE

    def median(self, what: str) -> float:
        times = getattr(self, what)
        return statistics.median(times) if times else float("nan")

    def spread(self, what: str) -> float:
        """Longest less shortest [s]."""
        times = getattr(self, what)
        return max(times) - min(times) if times else float("nan")


def measure(
    base: Base, point: Point, out: Path, repeats: int, limit: float, run: Runner, keep: bool = True
) -> Measured:
    """Run a point ``repeats`` times below ``out``.

    limit: longest wall time of a run [s].
    keep: whether finished runs of the same case are kept.
    """
    home = out / "runs" / _file_name(point.curve) / _file_name(point.label)
    try:
        text = case_of(base, point).to_yaml()
    except CaseError as error:
        return Measured(point, FAILED, _one_line(error))
    kept = _kept(home, point, text, repeats) if keep else None
    if kept is not None:
        return kept
    shutil.rmtree(home, ignore_errors=True)
    home.mkdir(parents=True)
    file = home / "case.yaml"
    file.write_text(text, encoding="utf-8")
    summaries: list[dict[str, Any]] = []
    for k in range(repeats):
        folder = home / f"run-{k + 1}"
        wrong = run(Job(file, folder, point.ranks, limit))
        if wrong:
            return _store(home, Measured(point, FAILED, _one_line(wrong), str(folder.relative_to(out))))
        summaries.append(read_summary(RunFolder(folder).summary))
        _tidy(folder, first=k == 0)
    first = summaries[0]
    return _store(
        home,
        Measured(
            point,
            DONE,
            "",
            str((home / "run-1").relative_to(out)),
            tuple(s["wall_seconds"] for s in summaries),
            tuple(s["cpu_seconds"] for s in summaries),
            {name: int(first[name]) for name in COUNTS if first.get(name) is not None},
            first["simulated"] / max(first["steps"], 1),
            float(first.get("energy", {}).get("error_share") or 0.0),
        ),
    )


def _kept(home: Path, point: Point, text: str, repeats: int) -> Measured | None:
    try:
        stored = json.loads((home / "point.json").read_text(encoding="utf-8"))
        if (home / "case.yaml").read_text(encoding="utf-8") != text:
            return None
        old = Measured(
            **{
                **stored,
                "point": Point(**{**stored["point"], "changes": tuple(stored["point"]["changes"])}),
                "wall": tuple(stored["wall"]),
                "cpu": tuple(stored["cpu"]),
            }
        )
    except (OSError, ValueError, KeyError, TypeError):
        return None
    enough = (
        old.done
        and len(old.wall) >= repeats
        and old.point.ranks == point.ranks
        and (home / "run-1" / "summary.json").is_file()
    )
    return Measured(**{**vars(old), "point": point}) if enough else None


def _store(home: Path, measured: Measured) -> Measured:
    replace_text(home / "point.json", json.dumps(asdict(measured), indent=1))
    return measured


def _tidy(folder: Path, first: bool) -> None:
    """Keep the tables of the first run; remove frames, checkpoints and the other runs."""
    if not first:
        shutil.rmtree(folder)
        return
    for entry in folder.iterdir():
        if entry.is_dir():
            shutil.rmtree(entry)
        elif entry.name not in NEEDED_FILES:
            entry.unlink()


def _file_name(text: str) -> str:
    return re.sub(r"[^\w.+-]", "_", text)


def _one_line(text: object) -> str:
    return "; ".join(" ".join(line.split()) for line in str(text).splitlines() if line.strip())[:400]


# ---------------------------------------------------------------------- outputs of a run
def outputs_of(folder: Path) -> tuple[FloatArray, dict[str, FloatArray], dict[str, str]]:
    """Times (k,) [s], outputs name -> (k,) [SI] and their units, from history.csv and probes.csv of a run."""
    values: dict[str, FloatArray] = {}
    units: dict[str, str] = {}
    run = RunFolder(folder)
    times = read_table(run.history)["time [s]"]
    for file in (run.history, run.probes):
        if not file.is_file():
            continue
        for title, column in read_table(file).items():
            name, unit = split_name(title)
            if name != "time" and len(column) == len(times):
                values[name], units[name] = column, unit
    return times, values, units


# ---------------------------------------------------------------------- processes
def run_process(job: Job) -> str:
    """Run `drillpetsc run` in a separate process, under mpirun for more than one rank.

    Returns the error message, or an empty text.
    """
    words = [
        sys.executable,
        "-m",
        "drillpetsc",
        "run",
        str(job.case),
        "--out",
        str(job.folder),
        "--overwrite",
        "--progress",
        "silent",
    ]
    environment = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
    if job.ranks > 1:
        launcher = find_launcher()
        if launcher is None:
            return "no mpirun found: install one for the MPI of the PETSc in use, or put it into PATH"
        words = [*launcher, "-n", str(job.ranks), *words]
        environment |= launcher_environment()
    process = subprocess.Popen(
        words,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        env=environment,
        start_new_session=True,
    )
    try:
        _, error_output = process.communicate(timeout=job.limit)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGTERM)
        process.communicate()
        return f"stopped: it took longer than {job.limit:g} s"
    except BaseException:
        os.killpg(process.pid, signal.SIGTERM)
        raise
    if process.returncode == 0:
        return ""
    start = error_output.find(MESSAGE_PREFIX)  # warnings of libraries may come first
    return (
        error_output[max(start, 0) :].removeprefix(MESSAGE_PREFIX).strip()
        or f"ended with status {process.returncode}"
    )


def find_launcher() -> list[str] | None:
    """Command of mpirun: from the environment of the running Python, or from the PATH; None if not found."""
    beside = Path(sys.executable).parent / "mpirun"
    found = str(beside) if beside.exists() else shutil.which("mpirun") or shutil.which("mpiexec")
    return [found] if found else None


def launcher_environment() -> Mapping[str, str]:
    """Environment variables for Open MPI: allow root, and more ranks than cores. Other MPIs ignore them."""
    new = {"OMPI_MCA_rmaps_base_oversubscribe": "1"}
    if hasattr(os, "geteuid") and os.geteuid() == 0:
        new |= {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    return new


def ranks_here() -> int:
    """Number of ranks with which this process was started, from variables set by MPI launchers."""
    for name in ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE"):
        if os.environ.get(name, "").isdigit():
            return int(os.environ[name])
    return 1
