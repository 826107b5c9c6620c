"""The `stability` command: does steady drilling decay or grow, over rotary speed and weight on bit (manual: sec-stability-map)."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from petsc4py import PETSc

from drillpetsc.analysis.linear.doubts import Mapped
from drillpetsc.analysis.linear.frequency.response import RPM, case_rpm, rpm_of
from drillpetsc.analysis.linear.frequency.stability_runs import BEHAVIOURS, RunPoint, refuse, run_point
from drillpetsc.analysis.linear.frequency.turning import TurningModel, turning_case
from drillpetsc.analysis.linear.modal import modes, without_motor
from drillpetsc.analysis.linear.modes import Modes
from drillpetsc.analysis.motion.run_options import options_of
from drillpetsc.case.blocks.ends import BitBottom
from drillpetsc.case.case import Case
from drillpetsc.doubts import doubts_at
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output.files.run_folder import (
    BOUNDARY_TABLE,
    STABILITY_RUNS_TABLE,
    STABILITY_TABLE,
)
from drillpetsc.output.job import Job, RunResult
from drillpetsc.output.progress import counted
from drillpetsc.physics.roots import bracketed_root
from drillpetsc.unit_systems import display_unit

SPEED_TOLERANCE = 0.05 * RPM  # of a boundary [rad/s]
MARGINAL = 1e-4  # growth over |s| within which a mode neither grows nor decays: 1100 periods to double; less than damping is known
SAYS = {"steady": "is steady", "decays": "calms down", "grows": "swings up", "stick_slip": "sticks and slips"}
IMBALANCE_SHARE = 1e-2  # unbalanced force over weight on bit beyond which a state counts as not steady


@dataclass(frozen=True)
class Point:
    """Result at one speed [rad/s] and weight on bit [N]: largest growth [1/s], its frequency [Hz] and kind, imbalance [N]."""

    speed: float
    weight: float
    growth: float
    frequency: float
    kind: str
    imbalance: float

    @property
    def marginal(self) -> bool:
        """Whether the growth is too small beside the frequency to be told from none."""
        return self.frequency > 0 and abs(self.growth) <= MARGINAL * np.hypot(
            self.growth, 2 * np.pi * self.frequency
        )

    @property
    def unstable(self) -> bool:
        """Whether a mode grows beyond the marginal band; False without a mode."""
        return self.growth > 0 and not self.marginal


@dataclass(frozen=True)
class Boundary:
    """A speed [rad/s] at which the largest growth changes its sign, at a weight on bit [N]."""

    weight: float
    speed: float
    stable_above: bool


class StateGrowth:
    """Largest growth of the modes about steady drilling with one weight on bit.

    case: from ``turning_case``; weight: [N]; count, kind: of modes, as in ``modes``.
    """

    def __init__(self, case: Case, weight: float, count: int, kind: str | None, comm: PETSc.Comm | None):
        initial = case.initial.model_copy(update={"wob": weight})
        self.states = TurningModel(case.model_copy(update={"initial": initial}), comm)
        self.weight, self.count, self.kind = weight, count, kind
        self.points: dict[float, Point] = {}

    def at(self, speed: float) -> Point:
        """Find the largest growth at ``speed`` [rad/s]; nan where no state is found.  Collective."""
        speed = float(speed)
        if speed not in self.points:
            self.points[speed] = self._solve(speed)
        return self.points[speed]

    def _solve(self, speed: float) -> Point:
        model = self.states.model
        try:
            self.states.at(speed, penetration(model, self.weight, speed))
            found = modes(model, self.count, kind=self.kind)
        except SolveError:
            return Point(speed, self.weight, np.nan, np.nan, "none", np.nan)
        worst = largest(found)
        if worst is None:
            return Point(speed, self.weight, np.nan, np.nan, "none", found.imbalance)
        return Point(
            speed,
            self.weight,
            float(found.growth[worst]),
            float(found.frequency[worst]),
            found.kind[worst],
            found.imbalance,
        )


def largest(found: Modes) -> int | None:
    """Number of the mode that grows fastest, those at zero left out; None without one."""
    growth = np.where(np.abs(found.eigenvalue) > found.zero, found.growth, -np.inf)
    return int(growth.argmax()) if np.isfinite(growth).any() else None


def penetration(model: DrillingModel, weight: float, speed: float) -> float | None:
    """Rate of penetration [m/s] at which drilling with ``weight`` [N] is steady; None without a bit that drills."""
    bit = model.drilling
    if bit is None or model.well is None:
        return None
    axis = np.asarray(model.tangent[-1]) / np.linalg.norm(model.tangent[-1])
    return float(bit.rate_under(weight * axis, axis, speed) @ axis)


def boundaries(growth: StateGrowth, speeds: tuple[float, ...]) -> list[Boundary]:
    """Find the speeds between ``speeds`` at which the largest growth changes its sign, within ``SPEED_TOLERANCE``."""
    out = []
    for low, high in zip(speeds, speeds[1:], strict=False):
        ends = growth.at(low), growth.at(high)
        first, last = ends[0].growth, ends[1].growth
        if all(end.marginal for end in ends):
            continue
        if not (np.isfinite(first) and np.isfinite(last)) or (first > 0) == (last > 0):
            continue
        try:
            speed = bracketed_root(lambda w: _finite(growth.at(w).growth), low, high, SPEED_TOLERANCE)
        except SolveError:
            continue
        out.append(Boundary(growth.weight, speed, bool(first > 0)))
    return out


def _finite(value: float) -> float:
    if not np.isfinite(value):
        raise SolveError("no steady state beside the stability boundary")
    return value


# ---------------------------------------------------------------------- command
def run_stability(
    job: Job,
    speeds: tuple[float, ...],
    weights: tuple[float, ...],
    count: int = 20,
    kind: str | None = None,
    without_control: bool = False,
    duration: float | None = None,
) -> RunResult:
    """Compute the largest growth over rotary speeds [rad/s] and weights on bit [N]; collective.

    count, kind: of modes, as in ``modes``.
    without_control: leave out motor and controller, and hold the top at the rotation.
    duration: of a run at each point [s]; None: no runs.
    """
    case, comm = job.case, job.comm
    turning = turning_case(case, "stability", without_control)
    if duration is not None:
        refuse(case)
    if not isinstance(case.bottom, BitBottom):
        raise CaseError(at="bottom", got=case.bottom.kind, want="a bit on bottom, which carries the weight")
    if turning.top.force is not None or turning.top.lowering is None:
        raise CaseError(at="top.force", want="a top with a lowering: its position meets the weight on bit")
    points: list[Point] = []
    edges: list[Boundary] = []
    runs: list[RunPoint] = []
    run_case = without_motor(case) if without_control else case
    with options_of(case):
        folder = job.make_folder()
        growth = StateGrowth(turning, weights[0], count, kind, comm)
        for weight, speed in counted(itertools.product(weights, speeds), "points", comm.rank):
            if weight != growth.weight:
                growth = StateGrowth(turning, weight, count, kind, comm)
            points.append(growth.at(speed))
            if duration is not None:
                lowering = penetration(growth.states.model, weight, speed)
                runs.append(run_point(run_case, speed, weight, lowering, duration, comm))
            if speed == speeds[-1]:
                edges += boundaries(growth, speeds)
    summary = _summary(case, points, len(edges), kind, runs, duration)
    rows = [[rpm_of(p.speed), p.weight, p.growth, p.frequency, p.kind, p.imbalance] for p in points]
    ends = [[b.weight, rpm_of(b.speed), "above" if b.stable_above else "below"] for b in edges]
    did = [[rpm_of(r.speed), r.weight, r.index, r.before, r.stuck, r.behaviour] for r in runs]
    tables: dict[str, list[Any]] = {STABILITY_TABLE: rows, BOUNDARY_TABLE: ends}
    tables |= {STABILITY_RUNS_TABLE: did} if runs else {}
    return job.result(folder, summary, _lines(case, points, edges, summary), tables)


def _summary(
    case: Case,
    points: list[Point],
    boundaries: int,
    kind: str | None,
    runs: Sequence[RunPoint] = (),
    duration: float | None = None,
) -> dict[str, Any]:
    """Counts and warnings of all points, and what the runs of a ``duration`` [s] did there."""
    behaviours = [r.behaviour for r in runs]
    differ = [
        (p, SAYS[r.behaviour])
        for p, r in zip(points, runs, strict=False)
        if r.behaviour != "failed" and np.isfinite(p.growth) and not p.marginal and p.unstable != r.unstable
    ]
    counts = {name: behaviours.count(name) for name in BEHAVIOURS}
    did = {"duration": duration, **{name: n for name, n in counts.items() if n}, "differ": len(differ)}
    return {
        "title": case.title,
        "speeds": [rpm_of(s) for s in dict.fromkeys(p.speed for p in points)],
        "weights": list(dict.fromkeys(p.weight for p in points)),
        "case_speed": case_rpm(case, case.time.end if case.time is not None else 0.0),
        **({} if case.initial.wob is None else {"case_weight": case.initial.wob}),
        "searched": kind or "all kinds",
        "unstable": sum(p.unstable for p in points),
        "marginal": sum(p.marginal for p in points),
        "boundaries": boundaries,
        "warnings": doubts_at(Mapped(case, points, IMBALANCE_SHARE, behaviours, differ)),
        **({} if duration is None else {"runs": did}),
    }


def _lines(case: Case, points: list[Point], edges: list[Boundary], summary: dict[str, Any]) -> list[str]:
    size, _, text = display_unit("force", case.shown_units)
    lines = [
        f"{case.title or 'case'}: steady motion at {len(summary['speeds'])} speeds and {len(summary['weights'])} weights on bit, "
        f"unstable at {summary['unstable']} of {len(points)} points"
    ]
    if summary["marginal"]:
        lines[0] += (
            f", marginal at {summary['marginal']} (growth within {MARGINAL:g} of the angular frequency)"
        )
    for weight in summary["weights"]:
        own = [p for p in points if p.weight == weight]
        worst = max((p for p in own if np.isfinite(p.growth)), key=lambda p: p.growth, default=None)
        crossed = [b for b in edges if b.weight == weight]
        shown = ", ".join(
            f"{b.speed / RPM:.2f} rpm (stable {'above' if b.stable_above else 'below'})" for b in crossed
        )
        if not shown:
            shown = (
                "none"
                if worst is None
                else "unstable at all speeds"
                if all(p.unstable for p in own)
                else "stable or marginal at all speeds"
                if any(p.marginal for p in own) and not any(p.unstable for p in own)
                else "unstable at some speeds"
                if any(p.unstable for p in own)
                else "stable at all speeds"
            )
        line = f"  {weight / size:>8.4g} {text}  boundary: {shown}"
        if worst is not None:
            line += f"; largest growth {worst.growth:.3g} 1/s at {rpm_of(worst.speed):g} rpm ({worst.kind}, {worst.frequency:.4g} Hz)"
        lines.append(line)
    if "runs" in summary:
        done = ", ".join(f"{summary['runs'][name]} {name}" for name in BEHAVIOURS if name in summary["runs"])
        lines.append(
            f"  runs of {summary['runs']['duration']:g} s: {done}; {summary['runs']['differ']} differ from the eigenvalues"
        )
    return lines
