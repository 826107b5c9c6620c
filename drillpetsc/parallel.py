"""Several ranks: start of PETSc, work of rank 0, waiting without a busy core, and the end of a failed job.

A rank that fails alone must end the job, because the other ranks wait for it forever. The ranks find out by a
barrier on a separate communicator, the control communicator. No message of a computation can meet it.
"""

from __future__ import annotations

import os
import signal
import sys
import time as clock
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

from drillpetsc.errors import RESTART_HINT, CaseError, DrillError, SolveError, cannot_write

RANK_TIMEOUT = 5.0  # waiting time of a failed rank for the others to fail as well [s]
POLL_INTERVAL = 0.02  # between two tests of a request [s]; a rank that waits leaves its core to others
FILE_POLL_INTERVAL = 0.2  # between two looks for a file [s]
#: signals that end a job; a terminal that closes sends SIGHUP
ENDING = ("SIGTERM", "SIGINT", "SIGHUP", "SIGQUIT")

_control: Any = None  # control communicator (mpi4py's); None on one rank


# ---------------------------------------------------------------------- start
def initialise_petsc(options: Sequence[str] = ()) -> None:
    """Initialise PETSc, and MPI with it, unless that has been done.

    options: PETSc options as on a command line
    """
    import petsc4py

    petsc4py.init(["drillpetsc", *options])


def start_job(options: Sequence[str]) -> None:
    """Initialise PETSc for a command. From now on, a rank that fails alone ends the job.

    options: PETSc options as on a command line
    """
    global _control
    missing = _missing_options_file([*options, *os.environ.get("PETSC_OPTIONS", "").split()])
    if (
        missing
    ):  # PETSc would end before the ranks know each other: one message from all of them comes afterwards
        options = ()
        os.environ["PETSC_OPTIONS"] = ""
    initialise_petsc(options)
    from petsc4py import PETSc

    # PETSc's handler would print a stack if the reader of a pipe has ended; Python raises BrokenPipeError
    signal.signal(signal.SIGPIPE, signal.SIG_IGN)
    # it would also print one for a signal that ends the job before a run takes signals over
    for number in (getattr(signal, name) for name in ENDING if hasattr(signal, name)):
        if signal.getsignal(number) == signal.SIG_DFL:  # what the parent process ignores stays ignored
            signal.signal(number, signal.default_int_handler)
    PETSc.Log.begin()
    if PETSc.COMM_WORLD.size > 1:
        _control = PETSc.COMM_WORLD.tompi4py().Dup()
        sys.excepthook = _end_job_with_traceback
    if missing:
        raise CaseError(at="-options_file", got=missing, want="a file with PETSc options")
    given = {word.lstrip("-") for word in options}
    others = [
        f"-{name} {value}".rstrip() for name, value in PETSc.Options().getAll().items() if name not in given
    ]
    if others and PETSc.COMM_WORLD.rank == 0:
        print(
            f"note: PETSc options from .petscrc, PETSC_OPTIONS or a file: {' '.join(others)}", file=sys.stderr
        )


def _missing_options_file(words: Sequence[str]) -> str:
    """The file of ``-options_file`` that does not exist; empty if there is none."""
    for name, value in pairwise(words):
        if name.lstrip("-") == "options_file" and not Path(value).is_file():
            return value
    return ""


# ---------------------------------------------------------------------- numbers of all ranks
def total(comm: Any, values: Any) -> Any:
    """Sum a number or an array over the ranks; the same on every rank, collective.

    One call on a buffer. mpi4py's ``allreduce`` of objects sends each of them as two messages to one rank and back. This takes
    some 30 us, and a step needs twenty of them.

    comm: PETSc's communicator or mpi4py's.
    Returns ``values`` itself on one rank; else a float, or a new array of floats of the same shape.
    """
    return _reduced(comm, values, "SUM")


def total_in_order(comm: Any, values: Any) -> Any:
    """Sum an array over the ranks in their order; the same on every rank, collective.

    MPI may add up a long array in another order than a short one, so a sum would depend on their number.

    comm: mpi4py's communicator.  Returns ``values`` itself on one rank.
    """
    if comm.size == 1:
        return values
    import numpy as np

    sent = np.ascontiguousarray(values, dtype=float)
    received = np.empty((comm.size, *sent.shape))
    comm.Allgather(sent, received)
    out = received[0]
    for part in received[1:]:
        out = out + part
    return out


def joined(mpi: Any, values: Any) -> Any:
    """Join the arrays of all ranks on rank 0 in the order of the ranks, None elsewhere; collective.

    mpi4py's ``gather`` of objects copies large arrays four times: into a pickle, into a message, out of it and out of the pickle.

    mpi: mpi4py's communicator.
    values: (n, ...) floats; n may differ from rank to rank, the other sizes may not.
    Returns ``values`` itself on one rank.
    """
    if mpi.size == 1:
        return values
    import numpy as np

    sent = np.ascontiguousarray(values, dtype=float)
    counts = mpi.gather(len(sent))
    if counts is None:
        mpi.Gatherv(sent, None)
        return None
    received = np.empty((sum(counts), *sent.shape[1:]))
    width = int(np.prod(sent.shape[1:]))
    mpi.Gatherv(sent, (received, [count * width for count in counts]))
    return received


def largest(comm: Any, value: float) -> float:
    """Find the largest of the ranks' numbers; collective. As ``total``.

    nan counts as infinity on several ranks: a comparison with nan could end differently on two of them.
    """
    return float(_reduced(comm, value if value == value or comm.size == 1 else float("inf"), "MAX"))


def all_true(comm: Any, value: bool) -> bool:
    """Whether ``value`` is true on every rank; collective. As ``total``."""
    return bool(_reduced(comm, value, "MIN"))


def _reduced(comm: Any, values: Any, operation: str) -> Any:
    if comm.size == 1:
        return values
    import numpy as np
    from mpi4py import MPI

    sent = np.array(values, dtype=float)
    received = np.empty_like(sent)
    mpi = comm.tompi4py() if hasattr(comm, "tompi4py") else comm
    mpi.Allreduce(sent, received, op=getattr(MPI, operation))
    return received if sent.ndim else float(received)


def world_rank() -> int:
    """Rank of this process in the whole job; 0 as long as PETSc is not imported."""
    if "petsc4py.PETSc" not in sys.modules:
        return 0
    from petsc4py import PETSc

    return PETSc.COMM_WORLD.rank


# ---------------------------------------------------------------------- end
def report_error(error: DrillError) -> int:
    """Print an error once for the whole job and return the exit status.

    If this rank has failed alone, it prints the error itself and ends the job.
    """
    together = _all_ranks_have_ended()
    if world_rank() == 0 or not together:
        alone = "" if together else f"rank {world_rank()}: "
        print(f"drillpetsc: {alone}{error}", file=sys.stderr)
    sys.stderr.flush()
    if not together:
        _control.Abort(error.exit_status)
    return error.exit_status


def report_interrupt() -> int:
    """Print that the user has interrupted the job and return the exit status."""
    print("drillpetsc: interrupted; the output written so far is kept", file=sys.stderr)
    if not _all_ranks_have_ended():
        _control.Abort(1)
    return 1


def _all_ranks_have_ended() -> bool:
    """Whether all ranks arrive here within RANK_TIMEOUT."""
    return _control is None or wait_for(_control.Ibarrier(), RANK_TIMEOUT)


def _end_job_with_traceback(kind: Any, value: Any, trace: Any) -> None:
    """Exception hook: an unexpected exception on one rank must not leave the others waiting."""
    sys.__excepthook__(kind, value, trace)
    print(f"drillpetsc: rank {world_rank()} failed, so the job is ended", file=sys.stderr, flush=True)
    _control.Abort(1)


# ---------------------------------------------------------------------- work of rank 0, waiting
def first_rank_gives(mpi: Any, function: Callable[[], Any]) -> Any:
    """The result of a function of rank 0, or its DrillError, on all ranks of ``mpi`` (mpi4py's; collective)."""
    answer: Any = None
    if mpi.rank == 0:
        try:
            answer = function()
        except DrillError as error:
            answer = error
    if mpi.size > 1:
        answer = mpi.bcast(answer)
    if isinstance(answer, DrillError):
        raise answer
    return answer


def first_rank_does(mpi: Any, what: str, action: Callable[[], Any], time: float | None = None) -> None:
    """Let rank 0 write something. An error there is raised on all ranks (collective).

    mpi: communicator (mpi4py's)
    what: name of what is written, for the error message
    action: function that writes
    time: simulated time for the error message [s]
    """

    def write() -> None:
        try:
            action()
        except OSError as error:
            raise SolveError(
                cannot_write(error, error.filename or what), time=time, hint=RESTART_HINT
            ) from None
        except ValueError as error:  # a table with other columns
            raise CaseError(at="--restart", want="the case that is continued", hint=str(error)) from None

    first_rank_gives(mpi, write)


def wait_for(request: Any, longest: float = float("inf")) -> bool:
    """Wait for an MPI request without a busy core; False if it is not complete after `longest` [s]."""
    began = clock.monotonic()
    while not request.Test():
        if clock.monotonic() - began > longest:
            return False
        clock.sleep(POLL_INTERVAL)
    return True


def wait_for_files(files: Sequence[Path]) -> None:
    """Wait until all of the files exist."""
    while not all(file.exists() for file in files):
        clock.sleep(FILE_POLL_INTERVAL)
