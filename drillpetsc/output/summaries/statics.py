"""The result of statics."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Annotated, Any, Self

from drillpetsc.output.conditions import (
    CONTACT,
    STRING,
)
from drillpetsc.output.summaries.summary import MISSING, QUANTITIES, Missing, Summary

STATIC_PATH = "path of a buckled string"
STATIC_BAND = "buckled string that slides"
RIGID_ITEMS = (
    "List of every rigid item with an outer diameter: name, md [m] of the middle, side_force [N], its components with friction "
    "side_high [N] and side_right [N], side_couple [N m], contact_force_sum [N], couple_high [N m] and couple_right [N m] "
    "(they turn the lower end to the high side and to the right); for the bit bit_force_on_rock_high [N], positive if it builds"
)


@dataclass(frozen=True, kw_only=True)
class Buckled(Summary):
    """Where the string is buckled."""

    sinusoidal: Annotated[
        list[Any],
        "",
        "Measured depths (from, to) between which the compression exceeds the sinusoidal buckling load [m].",
    ]
    helical: Annotated[list[Any], "", "Measured depths (from, to) between which the string coils [m]."]


@dataclass(frozen=True, kw_only=True)
class SoftString(Summary):
    """The soft-string model beside a static state."""

    hook_load: Annotated[float, "N", "Hook load by the soft-string model."]
    surface_torque: Annotated[float, "N m", "Surface torque by the soft-string model."]
    stretch: Annotated[float, "m", "Stretch by the soft-string model."]


@dataclass(frozen=True, kw_only=True)
class StaticsSummary(Summary):
    """summary.json of statics, beside the quantities of the state."""

    title: Annotated[str, "", "Title of the case."]
    motion: Annotated[
        str, "", "Motion that friction opposes: 'hoist', 'lower', 'rotate' or 'as the top prescribes'."
    ]
    quantities: Annotated[dict[str, Any], QUANTITIES]
    negative_pivots: Annotated[
        int | Missing,
        "-",
        "Negative pivots of the stiffness matrix beyond one for each constraint; a stable state has none.",
        STRING,
    ] = MISSING
    stable: Annotated[bool | Missing, "", "True if the state is stable.", STRING] = MISSING
    iterations: Annotated[int | Missing, "-", "Iterations of Newton's method.", STRING] = MISSING
    residual: Annotated[float | Missing, "N", "Residual of the equilibrium.", STRING] = MISSING
    imperfection: Annotated[
        float | Missing,
        "-",
        "Lateral load that was added to leave a straight unstable state, as a fraction of the weight.",
        STRING,
    ] = MISSING
    buckling: Annotated[Buckled | dict[str, Any] | Missing, STRING] = MISSING
    helix_band: Annotated[
        dict[str, Any] | Missing,
        "",
        "For a buckled string that slides along an inclined hole with friction, whose load is not unique: name (hook_load, or wob under a given force at the top), low and high [N], depending on whether the pipe becomes helical late or early.",
        STATIC_BAND,
    ] = MISSING
    path: Annotated[
        str | Missing,
        "",
        "Motion followed by the path: 'sliding' or 'slack_off'.",
        STATIC_PATH,
    ] = MISSING
    path_states: Annotated[
        list[Any] | Missing,
        "",
        "List, one entry a path: start, hook_load [N], wob [N], surface_torque [N m] (of a string that turns, else 0), negative_pivots, change (of the transmitted force over the push, or of the torque over itself), slid [m], steps, iterations; the first is the state of the table.",
        STATIC_PATH,
    ] = MISSING
    warnings: Annotated[list[str], "", "Warnings for the user."]
    rigid_items: Annotated[list[Any] | Missing, "", f"{RIGID_ITEMS}.", CONTACT] = MISSING
    soft_string: Annotated[SoftString | dict[str, Any] | Missing, CONTACT] = MISSING

    @classmethod
    def of(cls, values: Mapping[str, Any]) -> Self:
        """A result from its values by key; those that are not fields are quantities."""
        own = {q.name for q in fields(cls)}
        rest = {name: value for name, value in values.items() if name not in own}
        return cls(**{name: value for name, value in values.items() if name in own}, quantities=rest)
