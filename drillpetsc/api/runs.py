"""Runs in time, sweeps and studies of them, whose arguments in Python are not those of the command; results; the law of a motor."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drillpetsc.case import Case, load_case
from drillpetsc.errors import CaseError
from drillpetsc.parallel import initialise_petsc

if TYPE_CHECKING:
    from drillpetsc.physics.tools.motor_law import MotorLaw
    from drillpetsc.results import Result
    from drillpetsc.studies.convergence.study import StudyResult
    from drillpetsc.studies.sweep.sweep import SweepResult


def run(
    case: Case | str | Path,
    out: str | Path | None = None,
    *,
    restart: bool = False,
    overwrite: bool = False,
    accept_changes: bool = False,
    name: str | None = None,
    comm: Any = None,
    progress: str | Callable[[float, str], None] = "auto",
    watch_motion: bool = False,
) -> Result:
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
    watch_motion: True to add the classes of motion (whirl, contact, sliding, sticking) to the summary, as `motion`

    An interrupt (Ctrl-C, or the button of a notebook) ends the run after a step: the result has what was written, and its
    `status` says so. A second one raises KeyboardInterrupt.
    """
    initialise_petsc()
    keywords = {key: value for key, value in locals().items() if key not in ("case", "out")}
    from drillpetsc.analysis.motion import transient
    from drillpetsc.errors import Interrupted
    from drillpetsc.results.result import open_run, result_of

    try:
        return result_of(transient.run(case, out, **keywords))
    except Interrupted as error:
        if error.signal != "SIGINT":
            raise
        from petsc4py import PETSc

        (comm or PETSc.COMM_WORLD).barrier()  # the first rank has written the summary
        return open_run(error.folder)


def sweep(
    case: Case | str | Path,
    values: Mapping[str, Iterable[Any]],
    out: str | Path | None = None,
    *,
    restart: bool = False,
    overwrite: bool = False,
    comm: Any = None,
    progress: str | Callable[[float, str], None] = "auto",
) -> SweepResult:
    """Simulate every combination of some values of a case, the ranks shared out over them (collective).

    case: a Case, or the path of a case file
    values: key -> its values: {"fluid.flow_rate": ["20 l/s", 0.03], "fluid": ["on", "off"]}
    out: folder of the table and of the run folders; by default results/<case>-NNN
    restart: True to keep members that are done and to continue those with a checkpoint
    overwrite: True to replace the results in an existing folder
    comm: PETSc communicator; by default all ranks
    progress: auto or silent; or a function that is called with the share of members that have ended and a line of text
    """
    initialise_petsc()
    from drillpetsc.studies.sweep import sweep as sweeps

    return sweeps.sweep(case, values, out, restart=restart, overwrite=overwrite, comm=comm, progress=progress)


def study(
    case: Case | str | Path,
    vary: str | None = None,
    curves: Sequence[str] | None = None,
    *,
    values: Sequence[str | float] = (),
    steps: Sequence[str | float] = (),
    tolerances: Sequence[str | float] = (),
    outputs: Sequence[str] = (),
    repeats: int = 3,
    reference: str | Path = "auto",
    limit: float = 600.0,
    few: bool = False,
    out: str | Path | None = None,
    restart: bool = False,
    overwrite: bool = False,
    options: Mapping[str, Any] | None = None,
) -> StudyResult:
    """Measure error against run time: many runs of a case, each in a process of its own.

    PETSc is not initialised here, because the runs start MPI themselves.

    case: a Case, or the path of a case file
    vary: time-step, tolerance, order, mesh, formulation, integrator, solver or ranks
    curves: names of several curves, instead of vary; an empty list for the usual ones
    values: values along the curve, or names of curves; by default around the case's own
    steps, tolerances: of all curves that have them
    outputs: columns of history.csv and probes.csv to compare; by default up to six
    repeats: runs of each point, for the median of their times
    reference: exact, arkimex, bdf3, bdf2, or a run folder; auto: a closed form if there is one, else what works
    limit: wall seconds that one run may take, the reference three times as long
    few: True for three points a curve
    out: folder of table, pictures and runs; by default results/<case>-study-NNN
    restart: True to keep points that are done
    overwrite: True to replace the results in an existing folder
    options: PETSc options of every run by name
    """
    keywords = {key: value for key, value in locals().items() if key not in ("case", "vary", "curves")}
    from drillpetsc.studies.convergence import study as studies

    return studies.study(case, vary, curves, **keywords)


def open_run(folder: str | Path) -> Result:
    """The result in a run folder: tables, pictures, summary. Nothing is computed, and neither PETSc nor MPI is started.

    folder: run folder of `run`, `statics`, `hydraulics`, `surge` or `modes`, finished or not
    Raises CaseError if the folder does not exist or holds no results.
    """
    from drillpetsc.results import open_run as read

    return read(folder)


def mud_motor(case: Case | str | Path) -> MotorLaw:
    """The law of the downhole motor of a string: speed, differential pressure and leak by torque and flow rate.

    case: a Case with an item `pdm`, or the path of a case file
    Raises CaseError for a string without a motor.
    """
    from drillpetsc.model.tools.mud_motor import motor_item, motor_law

    found = motor_item(case if isinstance(case, Case) else load_case(case))
    if found is None:
        raise CaseError(at="string", want="an item of kind pdm")
    return motor_law(found[1].pdm)
