"""Results of the commands on loads."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from drillpetsc.output.conditions import BLOCK
from drillpetsc.output.summaries.summary import MISSING, Missing, Summary


@dataclass(frozen=True, kw_only=True)
class LimitsSummary(Summary):
    """summary.json of limits."""

    title: Annotated[str, "", "Title of the case."]
    operation: Annotated[str, "", "Operation of the string, or 'as the case'."]
    motion: Annotated[dict[str, Any], "", "Motion that friction opposes: lowering [m/s], rotation [rad/s]."]
    hook_load: Annotated[float, "N", "Hook load of the string."]
    hook_load_total: Annotated[float | Missing, "N", "Hook load with the block.", BLOCK] = MISSING
    surface_torque: Annotated[float, "N m", "Torque at the top."]
    wob: Annotated[float, "N", "Weight on bit."]
    bit_torque: Annotated[float, "N m", "Torque of the bit."]
    stable: Annotated[bool, "", "True if the state is stable."]
    choices: Annotated[
        dict[str, Any],
        "",
        "Law of the helical limit, design factors, share of the pull at yield, largest side force on a tool joint [N].",
    ]
    helical_law: Annotated[
        str, "", "Law of the helical limit in words, with its ratio to the sinusoidal one."
    ]
    units: Annotated[str, "", "Units of printed and plotted figures; files are in SI."]
    neutral_point: Annotated[
        dict[str, Any],
        "",
        "Places at which effective tension (effective) and axial force (true) change to compression: md [m], above_bit [m]; or null.",
    ]
    weakest: Annotated[
        dict[str, Any],
        "",
        "For safety factor, ratios of tension, torque and dogleg, side force on tool joints: worst value, md [m], item; or null.",
    ]
    contacts: Annotated[list[dict[str, Any]], "", "List: the rows of contacts.csv by name."]
    rig: Annotated[dict[str, Any] | None, "", "Limits of the rig; null without them."]
    notes: Annotated[list[str], "", "Omissions of the results."]
    margin_of_overpull: Annotated[
        dict[str, Any] | None,
        "",
        "Smallest margin between tension limit and tension at pick-up: margin [N], ratio, md [m], item, hook_load [N]; null if unknown.",
    ]
    max_overpull_at_bit: Annotated[
        dict[str, Any] | None,
        "",
        "Pull at the lower end that reaches a tension limit, with friction: pull [N], md [m], item; null if unknown.",
    ]
    max_wob: Annotated[
        dict[str, Any] | None,
        "",
        "For drilling and sliding: largest weight before the string passes the sinusoidal and the helical limit: wob [N] (null: no limit found), md [m], item; null without a soft string.",
    ]
    max_slackoff: Annotated[
        float | None, "N", "Fall of the hook load from the free string to the helical limit when sliding."
    ]
    available_wob: Annotated[
        dict[str, Any] | None,
        "",
        "For drilling and sliding: largest weight on bit that the string and the block bring down before the string becomes helical (limited_by: helical) or the hook load is zero (hook_load): wob [N], md [m], item; null without a soft string.",
    ]
    margin_of_overpull_still: Annotated[
        dict[str, Any] | Missing, "", "The same with the mud at rest, if mud is pumped."
    ] = MISSING
    buckling: Annotated[
        dict[str, Any], "", "Ranges of measured depth [m] that are sinusoidal or helical by the state found."
    ]
    warnings: Annotated[
        list[str], "", "Limits that are passed, each with its worst place, and what statics warns of."
    ]
