"""The public Python face: a function for each command of the command line.

    import drillpetsc
    case = drillpetsc.load_case("cases/vertical-2000m.yaml", ["top.rotation=90 rpm"])
    result = drillpetsc.run(case, "out")
    print(result.summary["real_time_factor"], result.history["hook_load"][-1])

PETSc is initialised by the first function that needs it, unless the caller has done so. Each function writes
the same files as its command and raises the same errors: CaseError for bad input, SolveError for a computation
that cannot go on.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from drillpetsc.case import Case, load_case
from drillpetsc.case.catalogue import catalogue
from drillpetsc.case.items import (
    HWDP,
    Agitator,
    Beam,
    Bit,
    Body,
    BumperSub,
    Casing,
    CoiledTubing,
    DrillCollar,
    DrillPipe,
    Jar,
    MudMotor,
    Pipe,
    Reamer,
    RotarySteerable,
    ShockSub,
    Stabilizer,
)
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.parallel import initialise_petsc

if TYPE_CHECKING:
    from drillpetsc.analysis.linearise import LinearResult
    from drillpetsc.physics.tools.motor_law import MotorLaw
    from drillpetsc.results import Result
    from drillpetsc.studies.convergence.study import StudyResult
    from drillpetsc.studies.sweep.sweep import SweepResult

__all__ = [
    "Agitator",
    "Beam",
    "Bit",
    "Body",
    "BumperSub",
    "Case",
    "CaseError",
    "Casing",
    "CoiledTubing",
    "DrillCollar",
    "DrillPipe",
    "HWDP",
    "Jar",
    "MudMotor",
    "Pipe",
    "Reamer",
    "RotarySteerable",
    "ShockSub",
    "Stabilizer",
    "calibrate",
    "campbell",
    "catalogue",
    "fmu",
    "freepoint",
    "hydraulics",
    "limits",
    "linearise",
    "load_case",
    "modes",
    "mud_motor",
    "open_run",
    "response",
    "roadmap",
    "SolveError",
    "run",
    "stability",
    "statics",
    "study",
    "surge",
    "sweep",
    "top_drive",
]


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


def statics(
    case: Case | str | Path,
    out: str | Path | None = None,
    *,
    motion: str | None = None,
    operation: str | None = None,
    path: Literal["sliding", "slack_off"] | None = None,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
) -> Result:
    """Solve for the static equilibrium of a case and write statics.csv, string.pvd and summary.json
    (collective).

    case: a Case, or the path of a case file
    out: run folder; by default results/<case>-NNN
    motion: hoist, lower or rotate, which friction opposes; by default the motion of the top at time 0
    operation: instead of a motion, trip_in, trip_out, rotate_off_bottom, drilling, sliding, backreaming, or slackoff, pickup, rob
    path: follow the history of a buckled string with friction: sliding, the whole string slides along the hole or turns in
    it, or slack_off, it is lowered onto a bit that stands
    overwrite: True to replace the results in an existing folder
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    """
    case, name = _loaded(case, name)
    initialise_petsc()
    from drillpetsc.analysis.statics import run_statics
    from drillpetsc.results.result import result_of

    return result_of(run_statics(case, out, motion, overwrite, name, comm, path, operation))


def hydraulics(
    case: Case | str | Path,
    out: str | Path | None = None,
    *,
    flow: str | float | Sequence[str | float] | None = None,
    spp: str | float | None = None,
    units: Any = None,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
) -> Result:
    """Solve for the steady flow of the mud and write hydraulics.csv, pressure_profile.csv and flow_curve.csv
    (collective).

    case: a Case, or the path of a case file
    out: run folder; by default results/<case>-NNN
    flow: flow rates, as text ("400,500 gpm") or in m3/s; by default that of the case
    spp: pump pressure instead, as text ("3000 psi") or in Pa: the flow rate that it gives is found
    units: field, metric or SI, of `lines` of the result and of plots; by default metric
    overwrite: True to replace the results in an existing folder
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    """
    from drillpetsc.case.flow_options import read_flows

    flows, pressure = read_flows(flow, spp)
    case, name = _loaded(case, name)
    initialise_petsc()
    from drillpetsc.analysis.hydraulics.hydraulics import run_hydraulics
    from drillpetsc.results.result import result_of

    return result_of(run_hydraulics(case, flows, pressure, out, overwrite, name, comm, units))


def surge(
    case: Case | str | Path,
    out: str | Path | None = None,
    *,
    speed: str | float | Sequence[str | float],
    units: Any = None,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
    **options: Any,
) -> Result:
    """Solve for the pressures of tripping and write surge.csv and max_trip_speed.csv (collective).

    case: a Case, or the path of a case file
    out: run folder; by default results/<case>-NNN
    speed: trip speeds, as text ("20..200 ft/min") or in m/s
    operation: trip_in, trip_out; by default both
    pipe: closed, open, pumping; by default closed and open
    bit_depth: measured depths of the bit, as text or in m; by default that of the case
    window: limits of the open hole, as text ("11.2,13.8 ppg") or in kg/m3; by default the window of the case
    flow: flow rate of a pumping pipe, as text or in m3/s; by default that of the case
    dynamic: True for a run of string and mud from rest for each speed, too
    units: field, metric or SI, of `lines` of the result and of plots; by default metric
    overwrite: True to replace the results in an existing folder
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    """
    from drillpetsc.case.flow_options import read_trips

    trips = read_trips(speed, **options)
    case, name = _loaded(case, name)
    initialise_petsc()
    from drillpetsc.analysis.hydraulics.surge import run_surge
    from drillpetsc.results.result import result_of

    return result_of(run_surge(case, trips, out, overwrite, name, comm, units))


def roadmap(
    case: Case | str | Path,
    out: str | Path | None = None,
    *,
    measured: str | None = None,
    model: Literal["soft", "stiff"] = "soft",
    units: Any = None,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
    **block: Any,
) -> Result:
    """Compute hook load and torque over the bit depth and write roadmap.csv and roadmap.json (collective).

    case: a Case, or the path of a case file; its `roadmap` has operations, depths and friction factors
    out: run folder; by default results/<case>-NNN
    model: soft, the soft string, or stiff, the static equilibrium of the beam
    measured: file of measured points to plot; by default those of the case
    units: field, metric or SI, of `lines` of the result and of plots; by default metric
    overwrite: True to replace the results in an existing folder
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    block: keys of the case's block `roadmap` in the place of those of the case, such as
    friction_factor={"cased": [0.2, 0.25], "open_hole": [0.3, 0.35]}
    """
    from drillpetsc.case.measured_option import measured_option

    case, name = _loaded(case, name)
    if block:
        case = case.replace({f"roadmap.{key}": value for key, value in block.items()})
    points = None if measured is None else measured_option(measured, case)
    initialise_petsc()
    from drillpetsc.analysis.torque_drag.roadmap import run_roadmap
    from drillpetsc.results.result import result_of

    return result_of(run_roadmap(case, out, overwrite, name, comm, units, points, model))


def calibrate(
    case: Case | str | Path,
    out: str | Path | None = None,
    *,
    measured: str | None = None,
    fit: str | None = None,
    units: Any = None,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
) -> Result:
    """Fit friction factors to measured hook loads and torques and write calibration.csv (collective).

    case: a Case, or the path of a case file
    out: run folder; by default results/<case>-NNN
    measured: file of measured points; by default those of the case
    fit: what is fitted, such as "cased,open_hole,block_weight", or a group of sections; by default all friction factors
    units: field, metric or SI, of `lines` of the result and of plots; by default metric
    overwrite: True to replace the results in an existing folder
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    """
    from drillpetsc.case.measured_option import fit_option, measured_option

    case, name = _loaded(case, name)
    parameters = None if fit is None else fit_option(fit, case)
    points = None if measured is None else measured_option(measured, case)
    initialise_petsc()
    from drillpetsc.analysis.torque_drag.calibrate import run_calibrate
    from drillpetsc.results.result import result_of

    return result_of(run_calibrate(case, points, parameters, out, overwrite, name, comm, units))


def limits(
    case: Case | str | Path,
    out: str | Path | None = None,
    *,
    operation: str | None = None,
    helical: Literal["chen", "wu"] = "chen",
    design_factor: float = 1.25,
    tension_fraction: float = 0.9,
    corrosive: bool = False,
    sn: str | None = None,
    units: Any = None,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
) -> Result:
    """Solve for the static equilibrium in an operation and write limits.csv and contacts.csv (collective).

    case: a Case, or the path of a case file
    out: run folder; by default results/<case>-NNN
    operation: trip_in, trip_out, rotate_off_bottom, drilling, sliding, backreaming; by default the case as it is
    helical: law of the helical limit
    design_factor: least yield strength over von Mises stress, below which a warning is given
    tension_fraction: share of the pull at yield that tension_limit allows
    corrosive: the mud is corrosive: 0.6 of the permissible doglegs
    sn: S-N curve for Miner's damage: "15.0,4.0" for a and b of log10 N = a - b log10(S/MPa), or a CSV file
    units: field, metric or SI, of `lines` of the result and of plots; by default metric
    overwrite: True to replace the results in an existing folder
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    """
    case, name = _loaded(case, name)
    initialise_petsc()
    from drillpetsc.analysis.limits.limits import run_limits
    from drillpetsc.analysis.limits.sn_curve import read_sn
    from drillpetsc.analysis.limits.table import Choices
    from drillpetsc.results.result import result_of

    curve = None if sn is None else read_sn(sn)
    choices = Choices(
        helical=helical,
        design_factor=design_factor,
        tension_fraction=tension_fraction,
        corrosive=corrosive,
        sn=curve,
    )
    return result_of(run_limits(case, operation, choices, out, overwrite, name, comm, units))


def freepoint(
    case: Case | str | Path,
    *,
    stretch: str | float | Sequence[str | float],
    pull: str | float | Sequence[str | float],
) -> dict[str, Any]:
    """Find how much of a stuck string is free, from its stretch under pulls.

    case: a Case, or the path of a case file
    stretch: of the string at the surface, as text ("10,24 in") or in m
    pull: beyond the weight of the free string, one for each stretch, as text ("12,30 klb") or in N
    Returns `pairs`, a FreePoint for each pair, and `slope`, that of the line through them (None for one pull).
    """
    from drillpetsc.case.free_point_options import read_pairs

    pairs = read_pairs(stretch, pull)
    from drillpetsc.analysis.limits.free_point import free_points

    return free_points(_loaded(case, None)[0], pairs)


def modes(
    case: Case | str | Path,
    out: str | Path | None = None,
    *,
    count: int = 20,
    shift: float | None = None,
    kind: str | None = None,
    about: str = "steady",
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
    without_control: bool = False,
) -> Result:
    """Find eigenvalues of the linearised model of a case and write modes.csv and mode shapes (collective).

    case: a Case, or the path of a case file
    out: run folder; by default results/<case>-NNN
    count: number of oscillating modes
    shift: frequency [Hz]; the modes nearest to it instead of the lowest
    kind: lateral, axial, torsional or fluid; by default all
    about: steady, the motion of the top at time 0, or rest
    overwrite: True to replace the results in an existing folder
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    without_control: True to hold the top instead of the motor, hoist and controllers that the case has
    """
    case, name = _loaded(case, name)
    initialise_petsc()
    from drillpetsc.analysis.modal import run_modes
    from drillpetsc.results.result import result_of

    return result_of(run_modes(case, out, count, shift, kind, about, overwrite, name, comm, without_control))


def campbell(
    case: Case | str | Path,
    out: str | Path | None = None,
    *,
    speeds: str | Sequence[float],
    count: int = 20,
    kind: str | None = None,
    lines: str | Sequence[float | str] | None = None,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
    without_control: bool = False,
    frequency: str = "wd",
    stiffness: str | Sequence[float] = (),
) -> Result:
    """Compute modes over rotary speeds, follow them by shape, and write campbell.csv and critical.csv (collective).

    case: a Case, or the path of a case file
    out: run folder; by default results/<case>-NNN
    speeds: rotary speeds, as text ("0:240:10 rpm", "60,90 rpm") or in rad/s, ascending
    count: number of oscillating modes at each speed, the lowest
    kind: lateral, axial, torsional or fluid; by default all
    lines: excitation lines in cycles per turn, "blades" or "motor"; by default 1, 2, 3 and the blades of a drag bit
    overwrite: True to replace the results in an existing folder
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    without_control: True to hold the top instead of the motor and controller that the case has
    frequency: wd, critical speeds are where lines meet damped frequencies; wn, natural ones
    stiffness: of the wall, as text ("1e6,1e7 Pa") or in Pa, ascending: critical_map.csv has the critical speeds without damping at each
    """
    from drillpetsc.case.speed_options import read_lines, read_speeds, read_stiffnesses

    values, orders = read_speeds(speeds, "--speeds"), None if lines is None else read_lines(lines)
    walls = read_stiffnesses(stiffness) if len(stiffness) else ()
    case, name = _loaded(case, name)
    initialise_petsc()
    from drillpetsc.analysis.frequency.campbell import run_campbell
    from drillpetsc.results.result import result_of

    return result_of(
        run_campbell(
            case, values, out, count, kind, orders, overwrite, name, comm, without_control, frequency, walls
        )
    )


def stability(
    case: Case | str | Path,
    out: str | Path | None = None,
    *,
    rpm: str | Sequence[float],
    wob: str | float | Sequence[str | float],
    count: int = 20,
    kind: str | None = None,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
    without_control: bool = False,
    method: Literal["eigen", "time"] = "eigen",
    duration: str | float = 60.0,
) -> Result:
    """Find the fastest growing mode about steady drilling over rotary speed and weight on bit (collective).

    Writes stability_map.csv and stability_boundary.csv.

    case: a Case with a bit on bottom, or the path of a case file
    out: run folder; by default results/<case>-NNN
    rpm: rotary speeds above 0, as text ("60:180:10 rpm") or in rad/s, ascending
    wob: weights on bit, as text ("50,100 kN") or in N, ascending
    count: number of oscillating modes at each point, the lowest
    kind: lateral, axial, torsional or fluid; by default all
    overwrite: True to replace the results in an existing folder
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    without_control: True to hold the top instead of the motor and controller that the case has
    method: eigen, or time: also a run at each point, classed in stability_runs.csv
    duration: of each run, "60 s" or in seconds
    """
    from drillpetsc.case.speed_options import read_duration, read_speeds, read_weights

    speeds, weights = read_speeds(rpm, "--rpm", lowest_above_zero=True), read_weights(wob)
    seconds = read_duration(duration)
    case, name = _loaded(case, name)
    initialise_petsc()
    from drillpetsc.analysis.frequency.stability_map import run_stability
    from drillpetsc.results.result import result_of

    return result_of(
        run_stability(
            case, speeds, weights, out, count, kind, overwrite, name, comm, without_control, method, seconds
        )
    )


def response(
    case: Case | str | Path,
    out: str | Path | None = None,
    *,
    excite: Literal["unbalance", "bit", "motor"],
    speeds: str | Sequence[float],
    amplitude: str | None = None,
    order: float | None = None,
    stress: bool = False,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
    without_control: bool = False,
) -> Result:
    """Compute the forced harmonic response over rotary speeds and write response.csv (collective).

    case: a Case, or the path of a case file
    out: run folder; by default results/<case>-NNN
    excite: unbalance, what is off the axis in the case, once per turn; bit, a motion, force or torque of the lower end; or
        motor, the orbit of a downhole motor's rotor
    speeds: rotary speeds above 0, as text ("20:200:2 rpm", "60,90 rpm") or in rad/s, ascending
    amplitude: of the bit, with its unit: "3 mm", "5 kN", "1 kN m"
    order: cycles per turn of the bit; by default 3
    stress: True to add the alternating stresses of the turning pipe
    overwrite: True to replace the results in an existing folder
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    without_control: True to hold the top instead of the motor and controller that the case has
    """
    from drillpetsc.case.speed_options import read_excitation, read_speeds

    excitation = read_excitation(excite, amplitude, order)
    values = read_speeds(speeds, "--speeds", lowest_above_zero=True)
    case, name = _loaded(case, name)
    initialise_petsc()
    from drillpetsc.analysis.frequency.response import run_response
    from drillpetsc.results.result import result_of

    return result_of(
        run_response(case, excitation, values, out, overwrite, name, comm, without_control, stress)
    )


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
    case, name = _loaded(case, name)
    initialise_petsc()
    from drillpetsc.analysis.fmu import build_fmu

    return build_fmu(case, out, inputs, outputs, overwrite, interpolate, name)


def linearise(
    case: Case | str | Path,
    inputs: Sequence[str],
    outputs: Sequence[str],
    out: str | Path | None = None,
    *,
    reduce: Literal["balanced", "modal"] | None = None,
    order: int = 20,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
) -> LinearResult:
    """Form x' = A x + B u, y = C x + D u of a case about its steady state; writes linear.npz and linear.mat (collective).

    case: a Case, or the path of a case file
    inputs: keys that may vary over time, such as top.torque, as in Session.inputs
    outputs: columns of history.csv, such as bit_speed, as in Session.outputs
    out: run folder; by default results/<case>-NNN
    reduce: balanced, by balanced truncation, or modal, to the dominant modes; None: the whole model alone
    order: states of the reduced model
    overwrite: True to replace the results in an existing folder
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks

    The result has `system` and `reduced`, with the matrices A, B, C, D and F, and `to_control()` for python-control.
    """
    case, name = _loaded(case, name)
    initialise_petsc()
    from drillpetsc.analysis.linearise import run_linearise

    return run_linearise(case, inputs, outputs, out, reduce, order, overwrite, name, comm)


def top_drive(
    case: Case | str | Path,
    out: str | Path | None = None,
    *,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
) -> Result:
    """Compute gains of a top drive's controllers and the reflection of torsional waves, and write reflection.csv (collective).

    case: a Case with `top.motor` and `top.control`, or the path of a case file
    out: run folder; by default results/<case>-NNN
    overwrite: True to replace the results in an existing folder
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    """
    case, name = _loaded(case, name)
    initialise_petsc()
    from drillpetsc.analysis.top_drive import run_top_drive
    from drillpetsc.results.result import result_of

    return result_of(run_top_drive(case, out, overwrite, name, comm))


def mud_motor(case: Case | str | Path) -> MotorLaw:
    """The law of the downhole motor of a string: speed, differential pressure and leak by torque and flow rate.

    case: a Case with an item `pdm`, or the path of a case file
    Raises CaseError for a string without a motor.
    """
    from drillpetsc.model.mud_motor import motor_item, motor_law

    found = motor_item(_loaded(case, None)[0])
    if found is None:
        raise CaseError(at="string", want="an item of kind pdm")
    return motor_law(found[1].pdm)


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


def _loaded(case: Case | str | Path, name: str | None) -> tuple[Case, str]:
    """(case, name) of a case or of the path of a case file."""
    if isinstance(case, Case):
        return case, name or "case"
    return load_case(case), name or Path(case).stem
