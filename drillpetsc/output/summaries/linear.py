"""Results of the linear analyses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from drillpetsc.arrays import FloatArray
from drillpetsc.output.summaries.summary import MISSING, Missing, Summary


@dataclass(frozen=True, kw_only=True)
class ModesSummary(Summary):
    """summary.json of modes."""

    title: Annotated[str, "", "Title of the case."]
    searched: Annotated[str, "", "Which modes were computed."]
    about: Annotated[str, "", "The state: 'rest', or its motion."]
    lowering: Annotated[float, "m/s", "Axial velocity of the state, positive down."]
    rotation: Annotated[float, "rad/s", "Rotation of the state, positive clockwise."]
    modes: Annotated[int, "-", "Number of modes found."]
    stable: Annotated[
        bool,
        "",
        "True if all modes decay, all eigenvalues differ from zero, and the static state has no negative pivots.",
    ]
    margin: Annotated[float, "1/s", "Largest growth rate; negative if all computed modes decay."]
    unstable: Annotated[int, "-", "Number of modes that grow."]
    diverging: Annotated[int, "-", "Number of modes that grow without oscillation."]
    fluttering: Annotated[int, "-", "Number of modes that grow with oscillation."]
    zero_roots: Annotated[
        int, "-", "Number of zero eigenvalues: free motions, or a load at which the string just buckles."
    ]
    smallest_eigenvalue: Annotated[float, "rad/s", "Smallest magnitude of an eigenvalue."]
    largest_error: Annotated[float, "-", "Largest backward error of an eigenvalue."]
    imbalance: Annotated[float, "N", "Largest unbalanced force on a node in the state."]
    frequency: Annotated[FloatArray, "Hz", "List: frequency of each mode."]
    damping_ratio: Annotated[FloatArray, "-", "List: damping ratio of each mode."]
    growth: Annotated[FloatArray, "1/s", "List: growth rate of each mode."]
    kind: Annotated[list[str], "", "List: kind of each mode."]
    negative_pivots: Annotated[int, "-", "As in the summary of statics."]
    warnings: Annotated[list[str], "", "Warnings for the user."]
    time_scales: Annotated[list[str], "", "Periods and travel times of waves, as text."]


@dataclass(frozen=True, kw_only=True)
class CampbellSummary(Summary):
    """summary.json of campbell."""

    title: Annotated[str, "", "Title of the case."]
    speeds: Annotated[list[float], "rpm", "List: rotary speeds requested."]
    added_speeds: Annotated[
        list[float], "rpm", "List: speeds added between them because shapes changed too much to be followed."
    ]
    case_speed: Annotated[float, "rpm", "Rotation of the case at time 0."]
    lines: Annotated[list[float], "-", "List: excitation lines in cycles per turn."]
    motor_line: Annotated[
        list[float | None] | Missing,
        "Hz",
        "List: frequency of the orbit of the motor's rotor at each speed; null if it is unknown.",
        "excitation line motor",
    ] = MISSING
    searched: Annotated[str, "", "Kind of the modes, or all kinds."]
    searched_to: Annotated[
        list[float],
        "Hz",
        "Frequency up to which all modes are known, at each speed, speeds between included.",
    ]
    searched_beside: Annotated[
        list[float | None],
        "Hz",
        "Distance from excitation lines above up to which modes are known, at each speed; null without a line above.",
    ]
    branches: Annotated[int, "-", "Number of modes that were followed."]
    lost: Annotated[int, "-", "Number of branches lost."]
    critical_speeds: Annotated[int, "-", "Number of crossings of branches and lines."]
    growing_speeds: Annotated[list[float], "rpm", "List: speeds at which a mode grows."]
    static_solutions: Annotated[int, "-", "Number of static equilibria that were solved for."]
    warnings: Annotated[list[str], "", "Warnings for the user."]
    frequency: Annotated[
        str, "", "Frequency that meets the lines: 'wd' of the damped or 'wn' of the undamped mode."
    ]


@dataclass(frozen=True, kw_only=True)
class StabilitySummary(Summary):
    """summary.json of stability."""

    title: Annotated[str, "", "Title of the case."]
    speeds: Annotated[list[float], "rpm", "List: rotary speeds."]
    weights: Annotated[list[float], "N", "List: weights on bit."]
    case_speed: Annotated[float, "rpm", "Rotation of the case at the end of its run."]
    case_weight: Annotated[
        float | Missing, "N", "Weight on bit at the start of the case.", "`initial.wob`"
    ] = MISSING
    searched: Annotated[str, "", "Kind of the modes, or all kinds."]
    unstable: Annotated[int, "-", "Number of points at which a mode grows."]
    marginal: Annotated[
        int, "-", "Number of points whose largest growth is within 1e-4 of the angular frequency."
    ]
    boundaries: Annotated[int, "-", "Number of speeds found at which stability changes."]
    warnings: Annotated[list[str], "", "Warnings for the user."]
    runs: Annotated[
        dict[str, Any] | Missing,
        "",
        "Runs at every point: duration [s], number of runs by behaviour, and of those that differ from the eigenvalues.",
        "`--method time`",
    ] = MISSING


@dataclass(frozen=True, kw_only=True)
class ResponseSummary(Summary):
    """summary.json of response."""

    title: Annotated[str, "", "Title of the case."]
    excitation: Annotated[str, "", "The excitation, in words."]
    order: Annotated[float | None, "-", "Cycles of the excitation per turn."]
    speeds: Annotated[list[float], "rpm", "List: rotary speeds."]
    validity: Annotated[
        list[str], "", "List: linear, touches, lifts or infinite at each speed, as in the table."
    ]
    peaks: Annotated[
        list[dict[str, Any]],
        "",
        "List: by place its md [m] and the largest amplitude of each column with its speed [rpm].",
    ]
    static_solutions: Annotated[int, "-", "Number of static equilibria that were solved for."]
    warnings: Annotated[list[str], "", "Warnings for the user."]
