"""The `campbell` command: tables, summary and lines of modes over rotary speeds, and critical speeds over the stiffness of the wall.

Manual: sec-campbell, sec-campbell-stiffness.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from petsc4py import PETSc

from drillpetsc.analysis.linear.doubts import Followed
from drillpetsc.analysis.linear.frequency.campbell import (
    DEFAULT_LINES,
    Campbell,
    Critical,
    Sought,
    campbell,
)
from drillpetsc.analysis.linear.frequency.response import RPM, case_rpm, rpm_of
from drillpetsc.analysis.linear.frequency.tracking import LEAST_MAC, searched_beside
from drillpetsc.analysis.linear.frequency.turning import TurningModel, turning_case
from drillpetsc.analysis.motion.run_options import options_of
from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.formation import DragBit
from drillpetsc.case.blocks.items.motor import PositiveDisplacementMotor
from drillpetsc.case.blocks.items.reamer import Reamer
from drillpetsc.case.case import Case
from drillpetsc.doubts import doubts_at
from drillpetsc.errors import CaseError
from drillpetsc.output.files.run_folder import CAMPBELL_TABLE, CRITICAL_MAP_TABLE, CRITICAL_TABLE
from drillpetsc.output.job import Job, RunResult


def demand_wall(case: Case) -> None:
    """Raise CaseError for a case whose string touches nothing."""
    if case.well is None or case.contact is None:
        raise CaseError(
            at="--stiffness",
            want="a well and contact: it is the stiffness of the wall",
            hint="give well and contact",
        )
    if case.contact.law != "linear":
        raise CaseError(
            at="--stiffness",
            got=f"contact.law {case.contact.law}",
            want="contact.law linear, whose stiffness is in Pa",
        )


def undamped(case: Case, stiffness: float) -> Case:
    """The case at a stiffness of the wall [Pa], without damping of the pipe and of impacts, and without friction."""
    assert case.well is not None and case.contact is not None
    none = {"stiffness": 0.0, "mass": 0.0}

    def still(material: Any) -> Any:
        if material is None or material.damping is None:
            return material
        return material.model_copy(update={"damping": material.damping.model_copy(update=none)})

    def smooth(item: Any) -> Any:
        changed: dict[str, Any] = {"friction": None if item.friction is None else 0.0}
        if item.material is not None:
            changed["material"] = still(item.material)
        if getattr(item, "damping", None) is not None and hasattr(item.damping, "stiffness"):
            changed["damping"] = item.damping.model_copy(update=none)
        return item.model_copy(update=changed)

    sections = tuple(q.model_copy(update={"friction": 0.0}) for q in case.well.sections)
    wall = {"stiffness": stiffness, "restitution": 1.0, "stribeck": None}
    changed = {
        "material": still(case.material),
        "string": tuple(smooth(item) for item in case.string),
        "well": case.well.model_copy(update={"sections": sections}),
        "contact": case.contact.model_copy(update=wall),
    }
    if getattr(case.bottom, "friction", None) is not None:
        changed["bottom"] = case.bottom.model_copy(update={"friction": 0.0})
    return case.model_copy(update=changed)


def critical_map(
    case: Case,
    stiffnesses: tuple[float, ...],
    sought: Sought,
    without_control: bool,
    comm: PETSc.Comm,
) -> list[tuple[float, Critical]]:
    """Critical speeds of the undamped case at each stiffness of the wall [Pa], by natural frequencies; collective.

    without_control: as for ``run_campbell``.
    """
    out = []
    for stiffness in stiffnesses:
        states = TurningModel(turning_case(undamped(case, stiffness), "campbell", without_control), comm)
        out += [(stiffness, c) for c in campbell(states, sought, natural=True).critical]
    return out


def map_rows(found: list[tuple[float, Critical]]) -> list[Any]:
    """Rows of critical_map.csv."""
    return [
        [k, c.branch, c.kind, c.whirl, c.excitation, c.line, rpm_of(c.speed), c.frequency] for k, c in found
    ]


SHARP = 0.1  # damping ratio below which a critical speed near the case's speed is warned of
MARGIN = 15.0  # margin to the case's speed [%] below which a critical speed is warned of


def run_campbell(
    job: Job,
    sought: Sought,
    without_control: bool = False,
    frequency: str = "wd",
    stiffness: tuple[float, ...] = (),
) -> RunResult:
    """Compute modes over rotary speeds; collective.

    sought: its lines may name ``blades``, too; without lines: 1, 2, 3 and the blades of a drag bit.
    without_control: leave out motor and controller, and hold the top at the rotation.
    frequency: wd, lines meet damped frequencies; wn, natural ones.
    stiffness: of the wall [Pa], for critical_map.csv.

    Raises CaseError for wrong arguments, SolveError if no state or mode is found.
    """
    case, comm = job.case, job.comm
    turning = turning_case(case, "campbell", without_control)
    if len(sought.speeds) < 2:
        got = f"{rpm_of(sought.speeds[0]):g} rpm"
        raise CaseError(at="--speeds", got=got, want="two speeds or more; `modes` is for one")
    lines = named_lines(case, sought.lines) if sought.lines else default_lines(case)
    sought = replace(sought, lines=lines)
    if stiffness:
        demand_wall(case)
    with options_of(case):
        states = TurningModel(turning, comm)
        folder = job.make_folder()
        found = campbell(states, sought, frequency == "wn")
        by_wall = critical_map(case, stiffness, sought, without_control, comm)
    summary = _summary(case, found, sought, states, frequency)
    tables = {
        CAMPBELL_TABLE: _campbell_rows(found),
        CRITICAL_TABLE: _critical_rows(found, summary["case_speed"]),
    }
    shown = _lines(case, found, summary)
    if stiffness:
        tables[CRITICAL_MAP_TABLE] = map_rows(by_wall)
        said = f"  {len(by_wall)} critical speeds without damping at {len(stiffness)} stiffnesses of the wall: {CRITICAL_MAP_TABLE}"
        shown.append(said)
    return job.result(folder, summary, shown, tables)


def _blades(case: Case) -> tuple[float, ...]:
    """Blades of a drag bit and of reamers."""
    law = case.formation.bit_law if case.formation is not None else None
    bit = (float(law.blades),) if isinstance(law, DragBit) else ()
    return bit + tuple(float(item.blades) for item in case.string if isinstance(item, Reamer))


def named_lines(case: Case, lines: tuple[float | str, ...]) -> tuple[float | str, ...]:
    """Excitation lines with the blades of the case; raises CaseError for lines that it has not."""
    out: set[float | str] = {line for line in lines if line != "blades"}
    if "blades" in lines:
        if not (found := _blades(case)):
            want = "no line blades in a case without a drag bit or a reamer: give their number"
            raise CaseError(at="--lines", got="blades", want=want)
        out |= set(found)
    motors = [item for item in case.string if isinstance(item, PositiveDisplacementMotor)]
    if "motor" in lines and not any(item.pdm.lobes is not None for item in motors):
        raise CaseError(at="--lines", got="motor", want="a pdm with lobes: the orbit of its rotor excites")
    return (*sorted(q for q in out if not isinstance(q, str)), *sorted(q for q in out if isinstance(q, str)))


def default_lines(case: Case) -> tuple[float | str, ...]:
    """Once, twice and three times per turn, the blades of a drag bit, and the lobes under a roller cone."""
    law = case.formation.bit_law if case.formation is not None else None
    blades: tuple[float, ...] = (float(law.blades),) if isinstance(law, DragBit) else ()
    blades += tuple(q.order for q in law.orders) if law is not None else ()
    return tuple(sorted({*DEFAULT_LINES, *blades}))


def margin(critical: Critical, case_speed: float) -> float:
    """Distance of a critical speed from the case's rotary speed [% of the latter]; nan for a case that does not turn."""
    return 100.0 * (critical.speed / RPM - case_speed) / case_speed if case_speed else float("nan")


def searched_to(found: Campbell) -> FloatArray:
    """(k,) frequency [rad/s] at each speed up to which all modes are known: that of the highest mode asked for."""
    return np.array([m.s.imag[m.counted].max(initial=0.0) for m in found.speeds])


def _summary(
    case: Case, found: Campbell, sought: Sought, states: TurningModel, frequency: str
) -> dict[str, Any]:
    case_speed = case_rpm(case)
    lost = [b for b in found.branches if b.end == "lost"]
    grows = [rpm_of(m.speed) for m in found.speeds if m.grows.any()]
    near = [
        c for c in found.critical
        if case_speed and abs(margin(c, case_speed)) < MARGIN and c.damping_ratio < SHARP
    ]  # fmt: skip
    orbit = found.orbit
    told = [(b.number, rpm_of(found.speeds[b.points[-1][0]].speed)) for b in lost]
    moment = Followed(case, case_speed, MARGIN, LEAST_MAC, told, near, found.speeds)
    return {
        "title": case.title,
        "speeds": [rpm_of(s) for s in sought.speeds],
        "added_speeds": [rpm_of(m.speed) for m in found.speeds if m.speed not in sought.speeds],
        "case_speed": case_speed,
        "lines": [line for line in sought.lines if not isinstance(line, str)],
        **(
            {}
            if orbit is None
            else {"motor_line": [None if np.isnan(q) else abs(q) / (2 * np.pi) for q in orbit]}
        ),
        "searched": sought.kind or "all kinds",
        "searched_to": [float(q) for q in searched_to(found) / (2 * np.pi)],
        "searched_beside": [
            None if np.isnan(q) else float(q) for q in searched_beside(found.speeds) / (2 * np.pi)
        ],
        "branches": len(found.branches),
        "lost": len(lost),
        "critical_speeds": len(found.critical),
        "growing_speeds": grows,
        "static_solutions": states.solved,
        "warnings": doubts_at(moment),
        "frequency": frequency,
    }


def _campbell_rows(found: Campbell) -> list[Any]:
    rows = []
    for branch in found.branches:
        for (k, j), mac in zip(branch.points, branch.mac, strict=True):
            modes = found.speeds[k]
            s = modes.s[j]
            ratio = float(modes.damping_ratio[j])
            decrement = 2 * np.pi * ratio / np.sqrt(1 - ratio**2) if abs(ratio) < 1 else np.inf
            last = branch.end if (k, j) == branch.points[-1] and branch.end else "tracked"
            rows.append([
                rpm_of(modes.speed), branch.number, s.imag / (2 * np.pi), abs(s) / (2 * np.pi), ratio, decrement, s.real,
                modes.kind[j], modes.whirl[j], mac, last,
            ])  # fmt: skip
    return rows


def _critical_rows(found: Campbell, case_speed: float) -> list[Any]:
    return [
        [c.branch, c.kind, c.whirl, c.excitation, c.line, rpm_of(c.speed), c.frequency, c.damping_ratio, c.amplification,
         margin(c, case_speed)]
        for c in found.critical
    ]  # fmt: skip


def _lines(case: Case, found: Campbell, summary: dict[str, Any]) -> list[str]:
    first, last = summary["speeds"][0], summary["speeds"][-1]
    added = f" and {len(summary['added_speeds'])} between" if summary["added_speeds"] else ""
    lines = [
        f"{case.title or 'case'}: {summary['branches']} branches at {len(summary['speeds'])} speeds from {first:g} to {last:g} rpm{added}",
        "  critical speeds, the least damped first:",
        "    [rpm]        [Hz]   per turn   kind        whirl      damping ratio   amplification   branch",
    ]
    shown = sorted(found.critical, key=lambda c: c.damping_ratio)[:SHOWN]
    for c in shown:
        lines.append(
            f"  {c.speed / RPM:>9.3f} {c.frequency:>9.4g} {c.line:>8.4g}     {c.kind:<11} {c.whirl:<9} {c.damping_ratio:>12.3g}   "
            f"{_amplification(c):>13}   {c.branch:>6}"
        )
    if not shown:
        lines.append("    none among the modes that were searched")
    if len(found.critical) > SHOWN:
        lines.append(f"    and {len(found.critical) - SHOWN} more in {CRITICAL_TABLE}")
    turning = [q for q, m in zip(summary["searched_to"], found.speeds, strict=True) if m.speed]
    beside = [q for q in summary["searched_beside"] if q is not None]
    lines.append(
        f"  searched: all modes up to {min(turning):.3g} Hz"
        + (f"; above, those within {min(beside):.2g} Hz of the excitation lines" if beside else "")
    )
    return lines


SHOWN = 12  # critical speeds that are printed


def _amplification(critical: Critical) -> str:
    value = critical.amplification
    return "grows" if np.isnan(value) else "infinite" if np.isinf(value) else f"{value:.3g}"
