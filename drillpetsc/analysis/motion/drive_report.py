"""Words on a controlled top drive: gains and tuned frequency for the screen and summary.json, and warnings."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.case.blocks.top_drive import PythonController
from drillpetsc.case.case import Case
from drillpetsc.model.drilling_model import DrillingModel, is_quasi_static
from drillpetsc.physics.top.control import Law, Motor, reflection
from drillpetsc.physics.top.top_drive import MotorDrive
from drillpetsc.unit_systems import System, shown

COARSE_SAMPLE = 0.1  # of the tuned period


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


def control_warnings(case: Case, laws: tuple[Law, ...], impedance: float) -> list[str]:
    """Sentences on controllers that may behave unexpectedly."""
    out = []
    for number, q in enumerate(case.top.control):
        at = "top.control" + (f"[{number}]" if len(laws) > 1 else "")
        damping = getattr(q, "damping", None)
        if damping is not None and damping < 1:
            out.append(
                f"{at}.damping: {damping:g} is below 1: the drive yields more than the pipe and reflects with opposite "
                "sign; allowed above 0"
            )
    built_in = [(k, q) for k, q in enumerate(case.top.control) if not isinstance(q, PythonController)]
    for (number, q), law in zip(built_in, laws, strict=False):
        at = "top.control" + (f"[{number}]" if len(case.top.control) > 1 else "")
        if law.frequency and q.sample * law.frequency > COARSE_SAMPLE:
            out.append(
                f"{at}.sample: {1e3 * q.sample:g} ms is coarser than a tenth of the tuned period, {1 / law.frequency:.3g} s: the "
                "half-sample delay makes it reflect more than its tuning states"
            )
    return out


def start_warnings(torque: float, motor: Motor, units: System) -> list[str]:
    """Sentence on a start for which the motor is too weak; torque: static, at the start [N m]."""
    if not motor.max_torque or motor.min_torque <= torque <= motor.max_torque:
        return []
    limit = motor.max_torque if torque > 0 else -motor.min_torque
    key = "max_torque" if torque > 0 else "min_torque"
    return [
        f"top.motor: {key} {shown(limit, 'torque', units)} is below the torque of the start, {shown(abs(torque), 'torque', units)}: "
        "the string does not turn"
    ]


def drive_warnings(model: DrillingModel, starts: bool) -> list[str]:
    """Sentences on the drive of a run, the same on all ranks; collective.

    starts: the run begins; a continued one has no static torque.
    """
    case, drive = model.case, model.part(MotorDrive)
    if case.top.motor is not None and is_quasi_static(case):
        return ["top.motor: left out, since time.mode is quasi_static: the rotation is prescribed"]
    if drive is None:
        return []
    out = control_warnings(case, drive.described, drive.impedance)
    if starts:
        torque = float(model.system.comm.tompi4py().allreduce(drive.start_torque))
        out += start_warnings(torque, drive.motor, case.output.units or "metric")
    return out


def drive_lines(model: DrillingModel) -> list[str]:
    """Lines of the command `check`; empty without a motor."""
    drive = model.part(MotorDrive)
    if drive is None:
        return []
    lines = control_lines(drive.described, drive.motor, drive.impedance, model.system.units)
    for q in model.case.top.control:
        if isinstance(q, PythonController):
            lines.append(f"  python: {q.function} every {q.sample:g} s")
    return [
        *lines,
        *(f"  WARNING: {text}" for text in control_warnings(model.case, drive.described, drive.impedance)),
    ]
