"""The result of a run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from drillpetsc.output.conditions import (
    AUTODRILLER,
    CONTACT,
    CUTTINGS,
    DRILLS,
    FOLLOWS,
    HOIST,
    INDICES,
    INERTIA,
    MOTOR,
    MUD,
    SENSOR,
)
from drillpetsc.output.summaries.statics import RIGID_ITEMS
from drillpetsc.output.summaries.summary import MISSING, Missing, Summary

STATIC_START = "static start"
MESH_ERROR = "run --mesh-error"
TOLERANCE_CHECK = "run --check-tolerance"
WHIRLS = "run in which a part that may whirl limits a step"
ACCEPTED_CHANGES = "run --accept-changes"


@dataclass(frozen=True, kw_only=True)
class StaticStart(Summary):
    """The static start of a run."""

    iterations: Annotated[int, "-", "Newton iterations of the static start."]
    negative_pivots: Annotated[
        int,
        "-",
        "Negative pivots of the stiffness matrix in the static start, beyond one for each constraint.",
    ]
    residual: Annotated[float, "N", "Residual of the static start."]
    imperfection: Annotated[
        float,
        "-",
        "Lateral load that was added to leave a straight unstable state, as a fraction of the weight.",
    ]
    warnings: Annotated[list[str], "", "Warnings of the static start."]


@dataclass(frozen=True, kw_only=True)
class Energy(Summary):
    """Energy balance of a run."""

    kinetic: Annotated[float, "J", "Kinetic energy at the end."]
    strain: Annotated[float, "J", "Strain energy at the end."]
    potential: Annotated[float, "J", "Potential energy of gravity at the end."]
    dissipated: Annotated[float, "J", "Energy dissipated since the start."]
    supplied: Annotated[float, "J", "Energy supplied since the start."]
    error: Annotated[float, "J", "Stored energy gained plus dissipated less supplied energy since the start."]
    error_share: Annotated[
        float, "-", "Energy error over the larger of supplied work and peak change of stored energy."
    ]
    newton: Annotated[
        float | Missing, "J", "Work of the residuals that Newton's method left (manual: eq-time-work)."
    ] = MISSING
    damped: Annotated[
        float | Missing,
        "J",
        "Energy that the time formula's damping has removed: energy.newton minus energy.error; negative if it gained.",
    ] = MISSING
    damped_share: Annotated[float | Missing, "-", "Removed energy, as a share like error_share."] = MISSING
    followed: Annotated[
        float | Missing,
        "J",
        "Energy that quasi-steady mud took up as its steady flow changed; counted as supplied (manual: eq-mud-follows).",
        FOLLOWS,
    ] = MISSING
    gained: Annotated[float | Missing, "J", "Largest energy error in any row of the history, at least 0."] = (
        MISSING
    )
    gained_share: Annotated[float | Missing, "-", "Gained energy, as a share like error_share."] = MISSING
    gain_limit: Annotated[float | Missing, "-", "Limit of gained_share (option -drillpetsc_gain_limit)."] = (
        MISSING
    )
    flag: Annotated[bool | Missing, "", "True if gained_share exceeds its limit."] = MISSING


@dataclass(frozen=True, kw_only=True)
class TopDriveFigures(Summary):
    """Top drive with a motor."""

    impedance: Annotated[float, "N m s/rad", "Torsional impedance of the uppermost pipe."]
    inertia: Annotated[float, "kg m2", "Inertia of the drive."]
    control: Annotated[
        list[Any],
        "",
        "List: kind, from [s], p [N m s/rad] and i [N m/rad] of each controller, and for a tuned one frequency [Hz] and reflection [-] there.",
    ]


@dataclass(frozen=True, kw_only=True)
class HoistFigures(Summary):
    """Hoist of a run."""

    line_stiffness: Annotated[
        float | Missing, "N/m", "Stiffness of the lines against the block at the start."
    ] = MISSING
    stretch: Annotated[float | Missing, "m", "Stretch of the lines at the start."] = MISSING
    fast_line_efficiency: Annotated[
        float, "-", "Load over the tension of the fast line and the number of lines."
    ]
    slack: Annotated[float | None | Missing, "s", "Time from which the lines are pushed; null if never."] = (
        MISSING
    )
    autodriller: Annotated[
        dict[str, Any] | Missing,
        "",
        "from [s], least and most speed [m/s] and loops: kind, p [m/s] and i [m/s2] per unit of each.",
        AUTODRILLER,
    ] = MISSING


@dataclass(frozen=True, kw_only=True)
class MudBalance(Summary):
    """Balance of the mud."""

    pumped: Annotated[float, "m3", "Volume of mud pumped in since the start."]
    returned: Annotated[float, "m3", "Volume of mud that came out since the start."]
    cuttings: Annotated[
        float | Missing, "m3", "Volume of rock that the mud took up, counted as mud.", CUTTINGS
    ] = MISSING
    content_change: Annotated[float, "m3", "Change of the volume of mud in string and hole."]
    error: Annotated[float, "m3", "Change of content less pumped plus returned less cuttings."]
    error_share: Annotated[float, "-", "Error over the largest of pumped, returned and changed volume."]


@dataclass(frozen=True, kw_only=True)
class NewHole(Summary):
    """The hole that was drilled."""

    drilled: Annotated[float, "m", "Length of the new hole."]
    inclination_start: Annotated[float, "deg", "Inclination at the start of the new hole."]
    inclination_end: Annotated[float, "deg", "Inclination at the end of the new hole."]
    azimuth_start: Annotated[float, "deg", "Azimuth at the start of the new hole."]
    azimuth_end: Annotated[float, "deg", "Azimuth at the end of the new hole."]
    build_rate: Annotated[float, "deg/30m", "Build rate of the new hole (manual: eq-borehole-rates)."]
    turn_rate: Annotated[float, "deg/30m", "Turn rate of the new hole (manual: eq-borehole-rates)."]
    dogleg_severity: Annotated[float, "deg/30m", "Dogleg severity of the new hole."]
    end_above: Annotated[
        float,
        "m",
        "Offset of the end of the hole from the straight continuation of the old hole, to the high side.",
    ]
    end_right: Annotated[float, "m", "Offset to the right of that, looking down the hole."]


@dataclass(frozen=True, kw_only=True)
class ErrorEstimate(Summary):
    """Estimated errors of a run."""

    time: Annotated[
        dict[str, Any] | Missing,
        "",
        "Local errors of the time formula by unknown, largest over the string.",
        "",
    ] = MISSING
    outputs: Annotated[
        dict[str, Any],
        "",
        "Estimated time error of the main outputs: range, error at an instant and their quotient share, and pace, the relative error of size and speed of the changes; null if an output switches.",
    ]
    damped_above: Annotated[
        float,
        "Hz",
        "Frequency above which the time formula takes more than 1 % of an amplitude in a period, at the median of the steps by time.",
    ]
    mesh: Annotated[
        dict[str, Any] | Missing,
        "",
        "Differences of the history from a run on elements twice as long.",
        MESH_ERROR,
    ] = MISSING
    tolerance: Annotated[
        dict[str, Any] | Missing,
        "",
        "Differences from a run at a tenth of the tolerance: history columns, and classes of motion that changed.",
        TOLERANCE_CHECK,
    ] = MISSING


@dataclass(frozen=True, kw_only=True)
class StepLimit(Summary):
    """The part that limited most steps."""

    name: Annotated[
        dict[str, Any], "", "Part whose whirl limited most of the steps (manual: sec-time-choice)."
    ]
    md: Annotated[float, "m", "Its measured depth at the start."]
    share: Annotated[float, "-", "Share of the steps that it limited."]
    shortest: Annotated[float, "s", "The shortest of these steps."]


@dataclass(frozen=True, kw_only=True)
class Vibration(Summary):
    """Indices of drilling dynamics."""

    windows: Annotated[int, "-", "Number of windows of the indices."]
    window: Annotated[float, "s", "Length of a window."]
    largest: Annotated[dict[str, Any], "", "Largest value of every index over the windows."]
    mean: Annotated[dict[str, Any], "", "Mean value of every index over the windows."]
    whirl: Annotated[list[Any], "", "For every probe: shares of the windows by class of whirl."]


@dataclass(frozen=True, kw_only=True)
class Memory(Summary):
    """Peak memory of a run."""

    start: Annotated[int, "bytes", "Peak memory at the start of the motion, all ranks together."]
    after_a_tenth: Annotated[int, "bytes", "Peak memory after a tenth of the motion."]
    end: Annotated[int, "bytes", "Peak memory after the last step."]
    peak: Annotated[int, "bytes", "Peak memory at the end."]


@dataclass(frozen=True, kw_only=True)
class RunSummary(Summary):
    """summary.json of run."""

    title: Annotated[str, "", "Title of the case."]
    status: Annotated[str, "", "'done', 'failed: REASON', or 'stopped by SIGNAL ...'."]
    interrupted: Annotated[bool, "", "True if a signal ended the run."]
    case_digest: Annotated[str, "", "SHA-256 of the case with all defaults, in SI."]
    versions: Annotated[
        dict[str, Any], "", "Versions of drillpetsc, PETSc, numpy and Python that computed the run."
    ]
    petsc_options: Annotated[dict[str, Any], "", "PETSc options in effect."]
    ranks: Annotated[int, "-", "Number of ranks."]
    elements: Annotated[int, "-", "Number of elements."]
    unknowns: Annotated[int, "-", "Number of unknowns, without their rates."]
    simulated: Annotated[
        float, "s", "Simulated time of this run; of a continued run, since it was continued."
    ]
    time: Annotated[float, "s", "Simulated time at the end."]
    steps: Annotated[int, "-", "Number of accepted time steps."]
    rejected_steps: Annotated[int, "-", "Number of rejected time steps."]
    newton_iterations: Annotated[int, "-", "Number of Newton iterations."]
    jacobians: Annotated[int, "-", "Number of evaluations of the Jacobian."]
    failed_solves: Annotated[int, "-", "Number of time steps in which Newton's method failed."]
    linear_iterations: Annotated[int, "-", "Number of iterations of the linear solver."]
    residuals: Annotated[int, "-", "Number of evaluations of the residual."]
    wall_seconds: Annotated[float, "s", "Wall time of the motion."]
    cpu_seconds: Annotated[float, "s", "Processor time of the motion, all ranks together."]
    start_seconds: Annotated[float, "s", "Wall time of the start, which contains the statics."]
    real_time_factor: Annotated[float, "-", "Simulated time over wall time of the motion."]
    wall_by_phase: Annotated[
        float,
        "s",
        "Wall time of the first rank by phase: residual, Jacobian, factorisation, solve, output; empty without PETSc's log.",
    ]
    warnings: Annotated[list[str], "", "Warnings for the user."]
    accepted_changes: Annotated[
        list[str] | Missing,
        "",
        "Changes of the case that were accepted for a continued run, each with its time.",
        ACCEPTED_CHANGES,
    ] = MISSING
    statics: Annotated[StaticStart | dict[str, Any] | Missing, STATIC_START] = MISSING
    energy: Annotated[Energy | dict[str, Any] | Missing, INERTIA] = MISSING
    top_drive: Annotated[TopDriveFigures | dict[str, Any] | Missing, MOTOR] = MISSING
    hoist: Annotated[HoistFigures | dict[str, Any] | Missing, HOIST] = MISSING
    mass: Annotated[MudBalance | dict[str, Any] | Missing, MUD] = MISSING
    rigid_items: Annotated[list[Any] | Missing, "", f"{RIGID_ITEMS}, at the end.", CONTACT] = MISSING
    new_hole: Annotated[NewHole | dict[str, Any] | Missing, DRILLS] = MISSING
    final: Annotated[dict[str, Any] | Missing, "", "Last values of history.csv, by column."] = MISSING
    error_estimate: Annotated[ErrorEstimate | dict[str, Any] | Missing, INERTIA] = MISSING
    steps_limited_by: Annotated[StepLimit | dict[str, Any] | Missing, WHIRLS] = MISSING
    motion: Annotated[
        list[Any] | Missing,
        "",
        "List: contact, sliding and whirl of each rigid item and probe, rotation of the lower end, in the second half of the run.",
        TOLERANCE_CHECK,
    ] = MISSING
    sensors: Annotated[
        list[Any] | Missing,
        "",
        "For every sensor: name, md [m], rate [Hz], number of samples, finest frequency [Hz] of its filter or rate, frequency up to which the time steps resolve its content [Hz], share of the time with coarser steps, points out of range.",
        SENSOR,
    ] = MISSING
    vibration: Annotated[Vibration | dict[str, Any] | Missing, INDICES] = MISSING
    memory: Annotated[Memory | dict[str, Any] | Missing, ""] = MISSING
