"""Words on hoist and autodriller: figures for the screen and summary.json, and warnings."""

from __future__ import annotations

from typing import Any

from drillpetsc.case.case import Case
from drillpetsc.model.drilling_model import DrillingModel, is_quasi_static
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


def hoist_warnings(case: Case) -> list[str]:
    """Sentences, before the run, on a hoist that may behave unexpectedly."""
    hoist = case.top.hoist
    if hoist is None:
        return []
    if is_quasi_static(case):
        return ["top.hoist: left out, since time.mode is quasi_static: the lowering moves the top itself"]
    rig, out, units = case.rig, [], case.shown_units
    weight = hoist.block_mass * 9.80665
    if rig is not None and rig.block_weight and abs(rig.block_weight / weight - 1) > 0.01:
        out.append(
            f"rig.block_weight {shown(rig.block_weight, 'force', units)} is not the weight of top.hoist.block_mass, "
            f"{shown(weight, 'force', units)}: hook_load_total has the first, hook_load_sensor the second"
        )
    drill = autodriller_of(case)
    given = case.top.autodriller
    if (
        drill is not None
        and given is not None
        and given.max_speed is None
        and drill.rate is None
        and not case.initial.wob
    ):
        out.append(
            f"top.autodriller: a bit that starts without weight may reach the bottom at up to {shown(drill.most, 'rop', units)}, the maximum speed of the "
            "drum; give max_speed, or also the mode rop"
        )
    if drill is not None and drill.start == 0 and case.initial.from_ in ("rest", "straight"):
        if any(q.kind == "wob" for q in drill.loops) and not drill.at_bit and any(case.gravity):
            out.append(
                f"top.autodriller: from 0 s with initial.from {case.initial.from_}: the hook load is tared before the string "
                "hangs on the hook; start the autodriller later, or start from statics"
            )
    return out


def slack_warnings(hoist: Hoist) -> list[str]:
    """Sentence on lines that would have gone slack."""
    if not isinstance(hoist, HoistLine) or hoist.slack is None:
        return []
    return [
        f"top.hoist: the lines would be slack from t = {hoist.slack:.4g} s on; in the model they push the block"
    ]
