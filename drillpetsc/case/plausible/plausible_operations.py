"""Doubts about valid but unlikely loads, flow rates and readings: a number in another unit, or swapped numbers."""

from __future__ import annotations

from collections.abc import Sequence

from drillpetsc.case.blocks.case_blocks import CaseBlocks
from drillpetsc.case.blocks.items.string import Bit
from drillpetsc.case.blocks.roadmap import MeasuredPoint
from drillpetsc.case.quantities import largest
from drillpetsc.unit_systems import System, shown
from drillpetsc.units import to_si

SMALL_TORQUE = 200.0  # [N m], 150 ft-lbf: no string of drill pipe is turned with less
STRING_OD = 0.05  # [m]: below it are models of a table, and wires
LEAST_FLOW, MOST_FLOW = (
    to_si("8 gpm", "m^3/s") / to_si("1 in", "m"),
    to_si("150 gpm", "m^3/s") / to_si("1 in", "m"),
)  # over the diameter of the bit; 30 to 60 gpm per inch are usual [m2/s]
#: outer diameters of casing (API 5CT) that are not the bore of another casing [in]
CASING_OD = (9.625, 10.75, 11.75, 13.375, 18.625)


def torques(case: CaseBlocks) -> list[str]:
    """List torques of a few N m on a string of drill pipe: `tob: 5` in ft-lbf instead of kft-lbf."""
    if max((item.od or 0.0 for item in case.string), default=0.0) < STRING_OD:
        return []
    units = case.shown_units
    keys: dict[str, float | None] = {}
    if case.roadmap is not None:
        plan = case.roadmap
        for word in ("drilling", "sliding", "backreaming"):
            keys[f"roadmap.{word}.tob"] = getattr(plan, word).tob
    if case.rig is not None:
        keys["rig.max_surface_torque"] = case.rig.max_surface_torque
    return [
        _small(key, value, units) for key, value in keys.items() if value is not None and _is_small(value)
    ]


def _is_small(torque: float) -> bool:
    return 0 < torque < SMALL_TORQUE


def _small(at: str, torque: float, units: System) -> str:
    number = shown(torque, "torque", units)
    hint = f"; {number.split()[0]} kft-lbf?" if units == "field" else ""
    return f"{at} is {number}: unusual for a torque of a drillstring{hint}"


def intervals(case: CaseBlocks) -> list[str]:
    """Warn that the history has only its first row, because its interval is longer than the run."""
    every = case.output.history_every
    if case.time is None or every is None or every <= case.time.end:
        return []
    return [
        f"output.history_every is {every:g} s: longer than the run of {case.time.end:g} s, whose history has the row at time 0 only"
    ]


def flows(case: CaseBlocks) -> list[str]:
    """Sentence on a flow rate far outside the usual range for the size of the bit."""
    bit, units = case.string[-1], case.shown_units
    if case.well is None or not isinstance(bit, Bit):
        return []
    keys: dict[str, float] = {}
    if case.fluid is not None and case.fluid.flow_rate is not None:
        keys["fluid.flow_rate"] = largest(case.fluid.flow_rate)
    if case.roadmap is not None:
        for word in ("drilling", "sliding", "backreaming"):
            keys[f"roadmap.{word}.flow_rate"] = (
                getattr(case.roadmap, word).flow_rate or 0.0
            )  # not given: taken from the fluid
    out = []
    for key, flow in keys.items():
        if flow > 0 and not LEAST_FLOW <= flow / bit.od <= MOST_FLOW:
            low, high = (shown(q * bit.od, "flow", units, 2) for q in (LEAST_FLOW, MOST_FLOW))
            size = shown(bit.od, "diameter", units)
            out.append(
                f"{key} is {shown(flow, 'flow', units)}: {'little' if flow < LEAST_FLOW * bit.od else 'much'} for a bit of "
                f"{size}, {low} to {high} are usual; another unit?"
            )
    return out


def casings(case: CaseBlocks) -> list[str]:
    """Warn that the diameter of a casing, its bore, equals a nominal outer diameter."""
    if case.well is None:
        return []
    units = case.shown_units
    out = []
    for i, section in enumerate(case.well.sections):
        inches = section.diameter / to_si("1 in", "m")
        if section.kind == "casing" and any(abs(inches - od) < 1e-4 for od in CASING_OD):
            out.append(
                f"well.sections[{i}].diameter is {shown(section.diameter, 'diameter', units)}: the outer diameter of a casing; "
                "diameter is its bore, in which the string lies"
            )
    return out


def readings(points: Sequence[MeasuredPoint], hole: float | None, units: System) -> list[str]:
    """Warn of measured points below the end of the hole, with torques of another unit, or swapped.

    hole: measured depth of the end of the hole [m]; None: not known.
    """
    out = []

    def at(depth: float) -> str:
        return f"at {shown(depth, 'length', units, 5)}"

    beyond = [p for p in points if hole is not None and p.bit_depth > hole + 1e-6]
    if beyond and hole is not None:
        out.append(
            f"{len(beyond)} of {len(points)} measured points lie below the end of the hole, "
            f"{shown(hole, 'length', units, 5)}: the first {at(beyond[0].bit_depth)}"
        )
    small = [p for p in points if p.torque is not None and _is_small(p.torque)]
    if small:
        out.append(_small(f"the measured torque {at(small[0].bit_depth)}", small[0].torque or 0.0, units))
    for depth in dict.fromkeys(p.bit_depth for p in points):
        loads: dict[str, list[float]] = {}
        for p in points:
            if p.bit_depth == depth and p.hook_load is not None:
                loads.setdefault(p.operation, []).append(p.hook_load)
        up, down = loads.get("trip_out"), loads.get("trip_in")
        if up and down and max(up) < min(down):
            out.append(
                f"measured {at(depth)}: the pick-up load, {shown(max(up), 'force', units)}, is below the slack-off load, "
                f"{shown(min(down), 'force', units)}; swapped?"
            )
    return out
