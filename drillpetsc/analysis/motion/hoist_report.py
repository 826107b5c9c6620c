"""Words on hoist and autodriller: figures for the screen and summary.json."""

from __future__ import annotations

from typing import Any

from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.model.top.hoist import autodriller_of, gear_of
from drillpetsc.physics.top.hoist import Hoist, HoistLine
from drillpetsc.physics.top.hoisting import fast_line_efficiency
from drillpetsc.unit_systems import shown


def hoist_summary(model: DrillingModel, hoist: Hoist) -> dict[str, Any]:
    """Entries of summary.json (SI)."""
    gear = gear_of(model.case)
    out: dict[str, Any] = {"fast_line_efficiency": fast_line_efficiency(gear.efficiency, gear.lines)}
    if isinstance(hoist, HoistLine):
        out |= {"line_stiffness": hoist.line.stiffness, "stretch": hoist.stretch, "slack": hoist.slack}
    drill = autodriller_of(model.case)
    if drill is not None:
        loops = [{"kind": q.kind, "p": q.p, "i": q.i} for q in drill.loops]
        out["autodriller"] = {"from": drill.start, "least": drill.least, "most": drill.most, "loops": loops}
    return out


def hoist_lines(model: DrillingModel) -> list[str]:
    """Lines of the command `check`; empty without a hoist."""
    case = model.case
    if not model.parts(Hoist):
        return []
    gear, drill, units = gear_of(case), autodriller_of(case), case.shown_units
    lines = [
        f"hoist: block {shown(gear.mass, 'mass', units, 6)} on {gear.lines} lines, {shown(gear.height, 'length', units)} over the floor"
    ]
    if gear.line is not None:
        k = gear.line.stiffness
        lines.append(
            f"  line: EA {shown(gear.line.axial_stiffness, 'force', units, 6)}, {shown(k, 'stiffness', units, 6)} at the block"
        )
    if gear.efficiency < 1:
        e = fast_line_efficiency(gear.efficiency, gear.lines)
        lines.append(f"  sheaves: efficiency of the fast line {e:.4f}")
    if gear.heave is not None:
        lines.append(
            f"  heave: period {gear.heave.period:g} s, {100 * gear.heave.compensation:g} % compensated"
        )
    if drill is not None:
        for q in drill.loops:
            unit = {"wob": "N", "torque": "(N m)", "differential_pressure": "Pa"}[q.kind]
            lag = f", reset time {q.p / q.i:.4g} s" if q.i else ""
            lines.append(f"  autodriller {q.kind}: p {q.p:g} m/s/{unit}, i {q.i:g} m/s2/{unit}{lag}")
        if drill.rate is not None:
            lines.append("  autodriller rop: the drum runs at the set point")
        lines.append(
            f"  drum: {shown(drill.least, 'rop', units)} to {shown(drill.most, 'rop', units)} from {drill.start:g} s on"
        )
    return lines
