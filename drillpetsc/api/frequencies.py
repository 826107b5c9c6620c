"""The model about its steady state: frequencies, stability, response, linear models, top drive and motor."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from drillpetsc.api.loading import loaded
from drillpetsc.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.parallel import initialise_petsc

if TYPE_CHECKING:
    from drillpetsc.analysis.linearise import LinearResult
    from drillpetsc.physics.tools.motor_law import MotorLaw
    from drillpetsc.results import Result


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
    case, name = loaded(case, name)
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
    case, name = loaded(case, name)
    initialise_petsc()
    from drillpetsc.analysis.frequency.campbell_command import run_campbell
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
    case, name = loaded(case, name)
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
    excite: Literal["unbalance", "bit", "motor"] | str,
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
    excite: unbalance, what is off the axis in the case, once per turn; bit, a motion, force or torque of the lower end; motor,
        the orbit of a downhole motor's rotor; or the same as of the bit somewhere along the string: the name of a string item, or a measured depth
        ("120 m")
    speeds: rotary speeds above 0, as text ("20:200:2 rpm", "60,90 rpm") or in rad/s, ascending
    amplitude: of the bit or the place, with its unit: "3 mm", "5 kN", "1 kN m"
    order: cycles per turn; by default 3 of the bit, 1 of a place
    stress: True to add the alternating stresses of the turning pipe
    overwrite: True to replace the results in an existing folder
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    without_control: True to hold the top instead of the motor and controller that the case has
    """
    from drillpetsc.case.speed_options import read_excitation, read_speeds

    case, name = loaded(case, name)
    excitation = read_excitation(excite, amplitude, order, case)
    values = read_speeds(speeds, "--speeds", lowest_above_zero=True)
    initialise_petsc()
    from drillpetsc.analysis.frequency.response import run_response
    from drillpetsc.results.result import result_of

    return result_of(
        run_response(case, excitation, values, out, overwrite, name, comm, without_control, stress)
    )


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
    case, name = loaded(case, name)
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
    case, name = loaded(case, name)
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

    found = motor_item(loaded(case, None)[0])
    if found is None:
        raise CaseError(at="string", want="an item of kind pdm")
    return motor_law(found[1].pdm)
