"""Words on a controlled top drive: gains and tuned frequency for the screen and summary.json."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.case.blocks.top_drive import PythonController
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.physics.top.control import Law, Motor, reflection
from drillpetsc.physics.top.top_drive import MotorDrive
from drillpetsc.unit_systems import System, shown


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
