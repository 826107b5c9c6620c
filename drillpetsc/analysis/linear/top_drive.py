"""The `top-drive` command: gains of a controller, and how much of a torsional wave the top reflects at each frequency."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.analysis.motion.machine_report import control_lines, control_summary
from drillpetsc.analysis.motion.run_options import options_of
from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.ends import HeldBottom
from drillpetsc.case.case import Case
from drillpetsc.doubts import doubts_at
from drillpetsc.doubts.moments import Tuned
from drillpetsc.errors import CaseError
from drillpetsc.model.hole import build_well
from drillpetsc.model.mesh import build_mesh
from drillpetsc.model.top import laws_of, lowest_torsional_frequency, motor_of, pipe_impedance
from drillpetsc.output.files.run_folder import REFLECTION_TABLE
from drillpetsc.output.job import Job, RunResult
from drillpetsc.physics.top.control import Law, Motor, reflection

FREQUENCIES = np.geomspace(0.01, 10.0, 601)  # of the table [Hz]
PRINTED = (0.05, 0.1, 0.2, 0.3, 0.5, 1.0)  # [Hz]


def run_top_drive(job: Job) -> RunResult:
    """Compute the reflection at the top over the frequency; collective.

    Raises CaseError for a case without a motor or a controller.
    """
    case = job.case
    if case.top.motor is None or not case.top.control:
        raise CaseError(
            at="top.control",
            want="a motor and its controller, such as motor: {inertia: 2900 kg m2} and control: stiff",
        )
    if any(q.kind == "python" for q in case.top.control):
        raise CaseError(
            at="top.control.kind", got="python", want="another: a function in Python has no known reflection"
        )
    with options_of(case):
        mesh = build_mesh(case, build_well(case), None)
    motor, laws, impedance = motor_of(case), laws_of(case, mesh), pipe_impedance(mesh)
    table = [np.abs(reflection(law, motor, impedance, FREQUENCIES)) for law in laws]
    summary: dict[str, Any] = {"title": case.title, "top_drive": control_summary(laws, motor, impedance)}
    summary["warnings"] = doubts_at(Tuned(case, laws))
    try:
        held = isinstance(case.bottom, HeldBottom) and case.bottom.kind == "clamped"
        summary["top_drive"]["torsional_frequency"] = lowest_torsional_frequency(mesh, held)
    except CaseError:  # parts that turn by themselves
        summary["top_drive"]["torsional_frequency"] = None
    rows = [(k, *row) for k, q in enumerate(table, 1) for row in zip(FREQUENCIES, q, strict=True)]
    lines = _lines(case, laws, motor, impedance, summary)
    return job.result(job.make_folder(), summary, lines, {REFLECTION_TABLE: rows})


def _lines(
    case: Case, laws: tuple[Law, ...], motor: Motor, impedance: float, summary: dict[str, Any]
) -> list[str]:
    lines = [f"{case.title or 'case'}: {control_lines(laws, motor, impedance, case.said_units)[0]}"]
    lines += control_lines(laws, motor, impedance, case.said_units)[1:]
    lowest = summary["top_drive"]["torsional_frequency"]
    if lowest is not None:
        lines.append(f"  lowest torsional frequency with the top held: {lowest:.6g} Hz")
    lines.append("  reflection |r| of a torsional wave:")
    lines.append("    frequency [Hz]  " + "".join(f"{law.kind:>14}" for law in laws))
    at: FloatArray = np.array(PRINTED)
    values = [np.abs(reflection(law, motor, impedance, at)) for law in laws]
    for k, f in enumerate(PRINTED):
        lines.append(f"    {f:>14g}  " + "".join(f"{v[k]:>14.5f}" for v in values))
    return lines
