"""Start a script on several MPI ranks from a test."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


@lru_cache
def _mpirun() -> tuple[str, bool] | None:
    """The launcher, and whether it is Open MPI's; the one beside the running Python (a wheel's) has
    priority."""
    beside = Path(sys.executable).parent / "mpirun"
    command = str(beside) if beside.exists() else shutil.which("mpirun") or shutil.which("mpiexec")
    if command is None:
        return None
    version = subprocess.run([command, "--version"], capture_output=True, text=True)
    return command, "Open MPI" in version.stdout or "OpenRTE" in version.stdout


def have_mpi() -> bool:
    return _mpirun() is not None


def start_mpi(n: int, script: str | Path, args: tuple[str, ...] | list[str] = ()) -> subprocess.Popen:
    """Start ``python script *args`` on n ranks, all on one core.

    Waiting ranks yield the processor: both MPI libraries spin by default, and there may be more ranks than
    cores. On one core a rank yields to one that has work; on several it takes the time of tests beside it, a third of the job's.
    """
    found = _mpirun()
    assert found is not None, "no mpirun found"
    command, open_mpi = found
    # PETSc has started MPI in this process and thereby set variables of the environment, which a new job must
    # not inherit
    env = {
        k: v
        for k, v in os.environ.items()
        if not k.startswith(("PMIX", "PMI_", "PRTE_"))
        and (not k.startswith("OMPI_") or k.startswith(("OMPI_MCA_rmaps", "OMPI_ALLOW")))
    }
    env |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    env["PYTHONPATH"] = os.pathsep.join([str(ROOT), *filter(None, [env.get("PYTHONPATH")])])
    if open_mpi:
        env.update(
            OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", OMPI_MCA_mpi_yield_when_idle="1"
        )
        options = ["--oversubscribe", "--bind-to", "none"]
    else:
        env.update(MPIR_CVAR_POLLS_BEFORE_YIELD="1")  # 0 would never yield
        options = []
    line = [command, *options, "-n", str(n), sys.executable, str(script), *args]
    with _one_core():
        return subprocess.Popen(
            line,
            env=env,
            cwd=ROOT,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )


@contextmanager
def _one_core() -> Iterator[None]:
    """Processes that are started within are on one core, another one for each worker of pytest-xdist."""
    if not hasattr(os, "sched_setaffinity"):  # Linux only
        yield
        return
    cores = os.sched_getaffinity(0)
    worker = int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw"))
    os.sched_setaffinity(0, {sorted(cores)[worker % len(cores)]})
    try:
        yield
    finally:
        os.sched_setaffinity(0, cores)


def run_mpi(
    n: int, script: str | Path, args: tuple[str, ...] | list[str] = (), timeout: float = 120.0
) -> str:
    """Run ``python script *args`` on n ranks; returns what was printed, or raises AssertionError with all
    output.

    After ``timeout`` [s] the whole job is ended: a deadlock is a failed test, not a hanging one.
    """
    job = start_mpi(n, script, args)
    try:
        out, err = job.communicate(timeout=timeout)
    except subprocess.TimeoutExpired:
        os.killpg(job.pid, signal.SIGTERM)
        out, err = job.communicate()
        raise AssertionError(f"{n} ranks did not end within {timeout:g} s\n{out}\n{err}") from None
    assert job.returncode == 0, f"exit status {job.returncode} on {n} ranks\n{out}\n{err}"
    return out
