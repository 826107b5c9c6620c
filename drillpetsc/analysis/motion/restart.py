"""The checkpoint that a restart continues, and when it is refused (manual: run-folders)."""

from __future__ import annotations

from typing import Any

from drillpetsc.analysis.motion import checkpoint, provenance
from drillpetsc.case.case import Case
from drillpetsc.errors import LONGEST, CaseError
from drillpetsc.output import RunFolder, read_summary
from drillpetsc.output.files.run_writer import missing_output
from drillpetsc.output.recorder import Recorder
from drillpetsc.solvers.time.time_integrator import TimeIntegrator

ROUNDING = 1e-9  # output times closer than this fraction of the end time are one


def saved_state(comm, folder: RunFolder, restart: bool) -> checkpoint.Checkpoint | None:
    """The checkpoint that a restart continues; None at a start, or if the folder has none yet; collective.

    Raises CaseError if the checkpoint cannot be read, or is missing in the folder of a run that has reached its end.
    """
    if not restart:
        return None
    answer: Any = None
    if comm.rank == 0:
        try:
            if folder.checkpoint.exists():
                answer = checkpoint.read(folder.checkpoint)
            elif folder.summary.exists() and read_summary(folder.summary).get("status") == "done":
                raise CaseError(
                    file=folder.checkpoint,
                    got="no such file",
                    want="the checkpoint of the run, which is continued",
                    hint="take the file from a copy of the run folder, or start the run again with --overwrite",
                )
        except CaseError as error:
            answer = error
    answer = comm.tompi4py().bcast(answer)
    if isinstance(answer, CaseError):
        raise answer
    return answer


def check_restart(
    comm,
    saved: checkpoint.Checkpoint | None,
    folder: RunFolder,
    case: Case,
    recorder: Recorder,
    integrator: TimeIntegrator,
    accept_changes: bool,
) -> list[str]:
    """Raise CaseError, on all ranks, where ``saved`` cannot be continued; returns accepted changes; collective."""
    if saved is None:
        if accept_changes:
            raise CaseError(at="--accept-changes", want="--restart of a run with a checkpoint")
        return []
    assert case.time is not None
    early: CaseError | None = None
    if case.time.end < saved.time * (1 - ROUNDING):
        early = CaseError(
            at="time.end",
            got=f"{case.time.end:.9g} s",
            want=f"at least {saved.time:.9g} s, the time of the checkpoint",
            hint=f"the run in {folder.path} has already passed this time",
        )
    changes = provenance.changes(saved.provenance, case, integrator.user_options)
    if changes and not accept_changes:
        raise CaseError(
            file=folder.checkpoint,
            got="changed since the checkpoint (numbers in SI units): " + provenance.listed(changes),
            want="the case, the PETSc options and the drillpetsc of the run; "
            f"only {', '.join(provenance.FREE_KEYS)} may change",
            hint="--accept-changes continues nevertheless; --overwrite begins anew"
            if early is None
            else "--overwrite begins anew",
            longest=LONGEST,
            also=[] if early is None else [early],
        )
    if early is not None:
        raise early
    refusal: CaseError | None = None
    if comm.rank == 0:
        written = saved.notes.get("tables", {})
        try:
            refusal = missing_output(folder, recorder, saved.time, saved.notes["last_row"], written)
        except CaseError as error:  # a list of frames that cannot be read
            refusal = error
    refusal = comm.tompi4py().bcast(refusal)
    if refusal is not None:
        raise refusal
    return changes


def is_finished(time: float, end: float) -> bool:
    """Whether a run that has reached ``time`` [s] is at its ``end`` [s]."""
    return time >= end * (1 - ROUNDING)
