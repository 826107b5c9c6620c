"""Words on a controlled top drive, hoist and autodriller: figures for the screen and summary.json."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.case.blocks.top_drive import PythonController
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.model.top import autodriller_of, gear_of
from drillpetsc.physics.top.control import Law, Motor, reflection
from drillpetsc.physics.top.hoist import Hoist, HoistLine
from drillpetsc.physics.top.hoisting import fast_line_efficiency
from drillpetsc.physics.top.top_drive import MotorDrive
from drillpetsc.unit_systems import System, shown


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


def control_summary(laws: tuple[Law, ...], motor: Motor, impedance: float) -> dict[str, Any]:
    """Entries of summary.json: impedance, inertia, and gains of each controller (SI)."""
    return {
        "impedance": impedance,
        "inertia": motor.inertia,
        "control": [_law_summary(law, motor, impedance) for law in laws],
    }


def _law_summary(law: Law, motor: Motor, impedance: float) -> dict[str, Any]:
    out: dict[str, Any] = {"kind": law.kind, "from": law.start}
    out |= {"p": law.p, "i": law.i}
    if law.frequency:
        r = abs(reflection(law, motor, impedance, np.array([law.frequency]))[0])
        out |= {"frequency": law.frequency, "reflection": float(r)}
    return out


def control_lines(laws: tuple[Law, ...], motor: Motor, impedance: float, units: System) -> list[str]:
    """Lines for the screen: impedance, gains and tuned frequency of each controller."""
    lines = [
        f"top drive: inertia {shown(motor.inertia, 'inertia', units, 6)}, impedance of the uppermost pipe {shown(impedance, 'turning_damping', units, 6)}"
    ]
    for law in laws:
        start = f" from {law.start:g} s" if len(laws) > 1 else ""
        tuned = ""
        if law.frequency:
            r = abs(reflection(law, motor, impedance, np.array([law.frequency]))[0])
            tuned = f", tuned to {law.frequency:.5g} Hz, at which it reflects {r:.3g} of a wave"
        late = f", delay {law.delay:g} s" if law.delay else ""
        lines.append(
            f"  {law.kind}{start}: p {shown(law.p, 'turning_damping', units, 6)} ({law.p / impedance:.4g} impedances), i {shown(law.i, 'turning_stiffness', units, 6)}"
            f"{tuned}{late}"
        )
    return lines


def drive_lines(model: DrillingModel) -> list[str]:
    """Lines of the command `check`; empty without a motor."""
    drive = model.part(MotorDrive)
    if drive is None:
        return []
    lines = control_lines(drive.described, drive.motor, drive.impedance, model.system.units)
    for q in model.case.top.control:
        if isinstance(q, PythonController):
            lines.append(f"  python: {q.function} every {q.sample:g} s")
    return lines
