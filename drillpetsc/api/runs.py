"""Runs in time, sweeps and studies of them; results and co-simulation units."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from drillpetsc.api.loading import loaded
from drillpetsc.case import Case
from drillpetsc.parallel import initialise_petsc

if TYPE_CHECKING:
    from drillpetsc.results import Result
    from drillpetsc.studies.convergence.study import StudyResult
    from drillpetsc.studies.sweep.sweep import SweepResult


def run(case: Case | str | Path, out: str | Path | None = None, **keywords: Any) -> Result:
    """Simulate a case and write its run folder (collective).

    case: a Case, or the path of a case file
    out: run folder; by default results/<case>-NNN, the next free number
    restart: True to continue from the checkpoint in the run folder
    overwrite: True to replace the results in an existing folder
    accept_changes: True to continue although the case or the PETSc options have changed
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    progress: auto, live, log or silent; or a function that is called with the share of the run that is done (0 to 1) and a
    line of text, several times a second, on the first rank

    An interrupt (Ctrl-C, or the button of a notebook) ends the run after a step: the result has what was written, and its
    `status` says so. A second one raises KeyboardInterrupt.
    """
    initialise_petsc()
    from drillpetsc.analysis import transient
    from drillpetsc.errors import Interrupted
    from drillpetsc.results.result import open_run, result_of

    try:
        return result_of(transient.run(case, out, **keywords))
    except Interrupted as error:
        if error.signal != "SIGINT":
            raise
        from petsc4py import PETSc

        (keywords.get("comm") or PETSc.COMM_WORLD).barrier()  # the first rank has written the summary
        return open_run(error.folder)


def sweep(
    case: str | Path, values: Mapping[str, Iterable[Any]], out: str | Path | None = None, **keywords: Any
) -> SweepResult:
    """Simulate every combination of some values of a case file, the ranks shared out over them (collective).

    case: path of the case file
    values: key -> its values: {"fluid.flow_rate": ["20 l/s", 0.03], "fluid": ["on", "off"]}
    out: folder of the table and of the run folders; by default results/<case>-NNN
    restart: True to keep members that are done and to continue those with a checkpoint
    overwrite: True to replace the results in an existing folder
    comm: PETSc communicator; by default all ranks
    progress: auto or silent; or a function that is called with the share of members that have ended and a line of text
    """
    initialise_petsc()
    from drillpetsc.studies.sweep import sweep as sweeps

    return sweeps.sweep(case, values, out, **keywords)


def study(
    case: str | Path, vary: str | None = None, curves: Sequence[str] | None = None, **keywords: Any
) -> StudyResult:
    """Measure error against run time: many runs of a case file, each in a process of its own.

    PETSc is not initialised here, because the runs start MPI themselves.

    case: path of the case file
    vary: time-step, tolerance, order, mesh, formulation, integrator, solver or ranks
    curves: names of several curves, instead of vary
    keywords: options of the command `study` by name (values, outputs, repeats, reference, out, ...)
    """
    from drillpetsc.studies.convergence import study as studies

    return studies.study(case, vary, curves, **keywords)


def open_run(folder: str | Path) -> Result:
    """The result in a run folder: tables, pictures, summary. Nothing is computed, and neither PETSc nor MPI is started.

    folder: run folder of `run`, `statics`, `hydraulics`, `surge` or `modes`, finished or not
    Raises CaseError where the folder does not exist or holds no results.
    """
    from drillpetsc.results import open_run as read

    return read(folder)


def fmu(
    case: Case | str | Path,
    out: str | Path,
    *,
    inputs: Sequence[str] | None = None,
    outputs: Sequence[str] | None = None,
    overwrite: bool = False,
    interpolate: Literal["held", "linear"] = "held",
    name: str | None = None,
) -> Path:
    """Write a case as a co-simulation unit of FMI 2.0, and return its path; needs pythonfmu (one process).

    case: a Case, or the path of a case file
    out: file to write, NAME.fmu
    inputs, outputs: names as of Session.inputs and Session.outputs; None: all
    overwrite: True to replace an existing file
    interpolate: held or linear, as of Session
    name: of the model
    """
    case, name = loaded(case, name)
    initialise_petsc()
    from drillpetsc.analysis.fmu import build_fmu

    return build_fmu(case, out, inputs, outputs, overwrite, interpolate, name)
