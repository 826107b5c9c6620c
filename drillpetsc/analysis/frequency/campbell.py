"""The `campbell` command: modes over rotary speeds, tracked by shape, and critical speeds (manual: sec-campbell)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from petsc4py import PETSc
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

from drillpetsc.analysis.frequency.beside_lines import (
    half_widths,
    in_bands,
    not_searched,
    searched_beside,
    step_at,
    with_modes_beside,
)
from drillpetsc.analysis.frequency.critical_map import critical_map, demand_wall, map_columns
from drillpetsc.analysis.frequency.response import RPM, rpm_of, write_case_folder
from drillpetsc.analysis.frequency.stokes import FrequencyDependent, at_own_frequencies, frequency_dependent
from drillpetsc.analysis.frequency.tracking import (
    LEAST_MAC,
    Branch,
    Pairing,
    SpeedModes,
    pair,
    track,
)
from drillpetsc.analysis.frequency.turning import TurningModel, turning_case
from drillpetsc.analysis.linearised_model import linearise_model
from drillpetsc.analysis.modal import ROW_WEIGHT, ZERO_FRACTION, _of_kind, _shares, reference_rate
from drillpetsc.analysis.run_options import options_of
from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.formation import DragBit
from drillpetsc.case.blocks.motor import PositiveDisplacementMotor
from drillpetsc.case.blocks.reamer import Reamer
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError, DrillError
from drillpetsc.fem.component import DRIVE
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output import write_summary, write_table
from drillpetsc.output.files.run_folder import CAMPBELL_TABLE, CRITICAL_MAP_TABLE, CRITICAL_TABLE, make_folder
from drillpetsc.output.quantities import MODE_KINDS as KINDS
from drillpetsc.output.quantities.frequency import CAMPBELL, CRITICAL, CRITICAL_MAP
from drillpetsc.output.result import RunResult
from drillpetsc.solvers.linearization import Linearised
from drillpetsc.solvers.quadratic_eigenproblem import NEUTRAL_GROWTH, Eigenvalues, lowest_eigenvalues

SPARE_OF_KIND = 2  # the same for modes of one kind, which lie far apart
SPARE_MODES = 8  # computed beyond those asked for, so that branches that rise are still found
SMALLEST_STEP = 8  # a speed step is divided into so many parts before a branch is lost
EQUAL = 1e-6  # relative difference of eigenvalues that are one up to rounding
STRAIGHT = 1e-3  # short over long axis of an orbit below which it is a straight line
PURE = 0.9  # share of the energy in forward orbits above which a mode whirls forward
SHARP = 0.1  # damping ratio below which a critical speed near the case's speed is warned of
MARGIN = 15.0  # margin to the case's speed [%] below which a critical speed is warned of
DEFAULT_LINES = (1.0, 2.0, 3.0)
BESIDE_A_LINE = 80  # eigenvalues computed beside a line at most, where twice --count is less
FREQUENCIES = ("wd", "wn")  # lines meet damped or natural frequencies


@dataclass(frozen=True)
class Critical:
    """Crossing of a branch with an excitation line.

    branch: number; kind, whirl: of the mode; line: cycles per turn; speed: [rad/s]; frequency: [Hz].
    damping_ratio: [-]; excitation: ``turn``, or ``motor`` for the orbit of a motor's rotor.
    """

    branch: int
    kind: str
    whirl: str
    line: float
    speed: float
    frequency: float
    damping_ratio: float
    excitation: str = "turn"

    @property
    def amplification(self) -> float:
        """1/(2 damping ratio), inf without damping; nan for a mode that grows."""
        if self.damping_ratio < -NEUTRAL_GROWTH:
            return float("nan")
        return 0.5 / self.damping_ratio if self.damping_ratio > NEUTRAL_GROWTH else float("inf")


@dataclass(frozen=True)
class Campbell:
    """Modes over rotary speeds.

    speeds: modes at each speed, ascending, those between the given ones included; branches: tracked modes.
    critical: crossings with the excitation lines, by speed.
    orbit: angular frequencies of the orbit of a motor's rotor at the ``speeds`` [rad/s]; None without such a line.
    """

    speeds: list[SpeedModes]
    branches: list[Branch]
    critical: list[Critical]
    orbit: FloatArray | None = None


# ---------------------------------------------------------------------- one speed
def modes_at(
    states: TurningModel,
    speed: float,
    count: int,
    kind: str | None = None,
    lines: Callable[[], list[tuple[float, float]]] = list,
) -> SpeedModes:
    """Compute the lowest modes at ``speed`` [rad/s] and some more, the same on all ranks; collective.

    count: oscillating modes; kind: only those of one kind.
    lines: frequencies beside which modes are sought, too, and half widths [rad/s], from the state at this speed.
    Raises SolveError where no state or no eigenvalue is found.
    """
    states.at(speed)
    model, beside = states.model, lines()
    own = frequency_dependent(model)
    system, linearised = model.system, linearise_model(model)
    answer: Any = None
    if linearised is not None:
        try:
            answer = _found(model, linearised, own, speed, count, kind, beside)
        except DrillError as failure:
            answer = failure
    if system.comm.size > 1:
        answer = system.comm.tompi4py().bcast(answer)
    if isinstance(answer, DrillError):
        raise answer
    return answer


def _found(
    model: DrillingModel,
    linearised: Linearised,
    own: FrequencyDependent | None,
    speed: float,
    count: int,
    kind: str | None,
    lines: list[tuple[float, float]],
) -> SpeedModes:
    """The modes of the linearised system, on the rank that has it."""
    reference = reference_rate(model)
    problem, selected = (
        linearised.eigenproblem(reference),
        _of_kind(model, linearised, kind) if kind else None,
    )
    wanted = count + (SPARE_OF_KIND if kind else SPARE_MODES)
    found = lowest_eigenvalues(problem, wanted, selected=selected, sparing=True)
    rate = np.sort(found.s.imag[found.s.imag > 0])
    reach, top = (float(rate[:n].max(initial=0.0)) for n in (count, wanted))
    above = [line for line in lines if sum(line) > reach]
    found, bands = with_modes_beside(problem, found, top, above, max(BESIDE_A_LINE, 2 * count), selected)
    u = linearised.vectors(found)
    share = _shares(model, linearised, found.s, u)
    if own is not None:
        found = at_own_frequencies(own, found, share[:, 0]).found
        u = linearised.vectors(found)
        share = _shares(model, linearised, found.s, u)
    kinds = tuple(KINDS[i] for i in share.argmax(axis=1))
    x, wx = energy_vectors(model, linearised, found, u)
    oscillating = np.flatnonzero((found.s.imag > 0) & (found.s.imag <= top))
    counted = np.zeros(len(found.s), dtype=bool)
    rate = found.s[oscillating]
    while 0 < count < len(rate) and abs(rate[count] - rate[count - 1]) < EQUAL * abs(rate[count]):
        count += 1  # which of equal modes comes first is rounding: all of them count
    counted[oscillating[:count]] = True
    near = (found.s.imag > 0) & ~counted & in_bands(bands, found.s)
    sense = whirl(model, linearised, u) if speed else ("mixed",) * len(kinds)
    sense = tuple(q if k == "lateral" else "none" for q, k in zip(sense, kinds, strict=True))
    stuck = (
        speed == 0
        and not model.system.assembly.y.any()
        and (model.contact is not None or model.bit is not None)
    )
    zero = ZERO_FRACTION * reference
    return SpeedModes(speed, found.s, x, wx, kinds, sense, counted, stuck, zero, near, bands)


def energy_vectors(
    model: DrillingModel, linearised: Linearised, found: Eigenvalues, u: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Scale modes so that their products in a metric W are energies: returns x and W x (n, m).

    W is the symmetric part of the mass of the string, and the storage coefficients of pressures and flows (manual:
    eq-campbell-metric).
    """
    size = np.maximum(np.abs(found.s), ZERO_FRACTION * reference_rate(model))
    names = [f.name for f in model.system.layout.fields]
    weight = np.zeros(len(linearised.scale))
    stored = np.abs(linearised.C.diagonal())
    for i, name in enumerate(names):
        if model.system.layout.fields[i].physics == DRIVE:
            continue
        rows = (linearised.field == i) & ~linearised.second_order
        weight[rows] = stored[rows] / ROW_WEIGHT.get(name.split(".")[-1], 1.0)
    x = np.where(linearised.second_order[:, None], size * u, u)
    wx = 0.5 * (linearised.M @ x + linearised.M.T @ x) + weight[:, None] * x
    energy = np.abs(np.sum(x.conj() * wx, axis=0))
    factor = 1.0 / np.sqrt(np.maximum(energy, 1e-300))
    return x * factor, wx * factor


def whirl(model: DrillingModel, linearised: Linearised, u: np.ndarray) -> tuple[str, ...]:
    """Sense of the orbits of modes u (n, m) seen from above: forward is clockwise, with the rotation."""
    names = [f.name for f in model.system.layout.fields]
    if "string.position" not in names:
        return ("mixed",) * u.shape[1]
    values = linearised.field_values(names.index("string.position"), u, model.mesh.nodes, 3)
    t = model.tangent / np.linalg.norm(model.tangent, axis=1, keepdims=True)
    near = np.where(np.abs(t[:, :1]) < 0.9, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    first = near - t * np.sum(near * t, axis=1, keepdims=True)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    one = np.sum(values * first, axis=2)
    other = np.sum(values * np.cross(t, first), axis=2)
    forward, backward = np.abs(one + 1j * other) ** 2, np.abs(one - 1j * other) ** 2
    total = forward + backward
    straight = np.abs(np.sqrt(forward) - np.sqrt(backward)) < STRAIGHT * (
        np.sqrt(forward) + np.sqrt(backward) + 1e-300
    )
    share = np.sum(np.where(straight, 0.5, forward > backward) * total, axis=1)
    share = share / np.maximum(total.sum(axis=1), 1e-300)
    return tuple("forward" if q > PURE else "backward" if q < 1 - PURE else "mixed" for q in share)


# ---------------------------------------------------------------------- the map
def campbell(
    states: TurningModel,
    speeds: tuple[float, ...],
    count: int,
    lines: tuple[float | str, ...],
    kind: str | None = None,
    natural: bool = False,
) -> Campbell:
    """Compute modes at ``speeds`` [rad/s], track them, and find critical speeds; collective.

    lines: cycles per turn, and ``motor``; natural: lines meet natural frequencies |s|, else damped ones Im s.

    Where a branch finds no partner of ``LEAST_MAC``, speeds are added between the two, down to an eighth of the step;
    as many as there are given ones at most.
    """
    orbit = dict[float, float]()

    step_to_next = step_at(speeds)

    def at(speed: float) -> SpeedModes:
        def beside() -> list[tuple[float, float]]:
            rates = [abs(line) * abs(speed) for line in lines if not isinstance(line, str)]
            if "motor" in lines:
                orbit[speed] = orbit_rate(states.model)
                rates.append(abs(orbit[speed]))
            return half_widths(sorted(rates), abs(speed), step_to_next(speed)) if speed else []

        return modes_at(states, speed, count, kind, beside)

    found = [at(speeds[0])]
    pairings: list[Pairing] = []
    budget = len(speeds)
    for speed in speeds[1:]:
        waiting = [at(speed)]
        step = (speed - found[-1].speed) / SMALLEST_STEP
        while waiting:
            here, there = found[-1], waiting[-1]
            pairing = pair(here, there)
            if _unpaired(here, there, pairing) and budget > 0 and there.speed - here.speed > 1.5 * step:
                budget -= 1
                waiting.append(at(0.5 * (here.speed + there.speed)))
                continue
            pairings.append(pairing)
            found.append(waiting.pop())
    branches = track(found, pairings)
    rates = np.array([orbit[m.speed] for m in found]) if orbit else None
    critical = critical_speeds(found, branches, lines, natural, rates)
    met = {c.branch for c in critical}
    kept = [b for b in branches if b.number in met or b.end == "lost" or not _begins_beside(found, b)]
    numbers = {b.number: k for k, b in enumerate(kept, 1)}
    critical = [replace(c, branch=numbers[c.branch]) for c in critical]
    for branch in kept:
        branch.number = numbers[branch.number]
    return Campbell(found, kept, critical, rates)


def _begins_beside(speeds: list[SpeedModes], branch: Branch) -> bool:
    """Whether a branch begins with a mode that was sought beside a line."""
    speed, mode = branch.points[0]
    near = speeds[speed].near
    return near is not None and bool(near[mode])


def orbit_rate(model: DrillingModel) -> float:
    """Angular frequency of the orbit of a motor's rotor in space at the present state [rad/s], negative backwards; collective.

    nan in a string at rest, whose rotor stands as well.
    """
    assert model.motor is not None
    rate = model.motor.orbit_speed(0.0, model.system.assembly)
    if model.system.comm.size > 1:
        rate = float(model.system.comm.tompi4py().allreduce(rate))
    return rate if rate else float("nan")


def _unpaired(here: SpeedModes, there: SpeedModes, pairing: Pairing) -> bool:
    """Whether a mode that is asked for has no partner, and is not above those that were computed."""
    if here.stuck:
        return False
    alone = np.flatnonzero((pairing.after < 0) & here.starts)
    return any(there.awaits(here, int(mode), pairing.after) for mode in alone)


def critical_speeds(
    speeds: list[SpeedModes],
    branches: list[Branch],
    lines: tuple[float | str, ...],
    natural: bool = False,
    orbit: FloatArray | None = None,
) -> list[Critical]:
    """Find where branches meet the lines, by cubic interpolation over the speed.

    A line is f = n Omega/2 pi, or, for ``motor``, the frequency of the ``orbit`` at each speed [rad/s].
    natural: of the natural frequencies |s|, else of the damped ones, Im s.
    """
    out = []
    for branch in branches:
        if len(branch.points) < 2:
            continue
        at = [k for k, _ in branch.points]
        omega = np.array([speeds[k].speed for k in at])
        s = np.array([speeds[k].s[j] for k, j in branch.points])
        rates = np.abs(s) if natural else s.imag
        rate, growth, size = (CubicSpline(omega, q) for q in (rates, s.real, np.abs(s)))
        for line in lines:
            excitation, moving = _excitation(line, omega, None if orbit is None else orbit[at])

            def gap(
                w: float, rate: CubicSpline = rate, excitation: Callable[[Any], Any] = excitation
            ) -> float:
                return float(rate(w)) - float(excitation(w))

            values = np.where(moving, rates - excitation(omega), np.nan)
            for k in np.flatnonzero(values[:-1] * values[1:] <= 0):
                if values[k] == 0 and (k > 0 or omega[k] == 0):
                    continue  # counted with the interval before; nothing excites a string at rest
                w = float(omega[k]) if values[k] == 0 else brentq(gap, omega[k], omega[k + 1], xtol=1e-10)
                number, mode = branch.points[k]
                modes = speeds[branch.points[k + 1][0]]
                sense = modes.whirl[branch.points[k + 1][1]]
                ratio = -float(growth(w)) / max(float(size(w)), 1e-300)
                per_turn = float(excitation(w)) / w if line == "motor" else float(line)
                out.append(
                    Critical(
                        branch.number,
                        speeds[number].kind[mode],
                        sense,
                        per_turn,
                        w,
                        float(rate(w)) / (2 * np.pi),
                        ratio,
                        "motor" if line == "motor" else "turn",
                    )
                )
    return sorted(out, key=lambda c: (c.speed, c.line, c.branch))


def _excitation(
    line: float | str, omega: FloatArray, orbit: FloatArray | None
) -> tuple[Callable[[Any], Any], np.ndarray]:
    """Frequency of a line [rad/s] as a function of the speed, and at which of the speeds ``omega`` there is one."""
    if line != "motor":
        return (lambda w: float(line) * w), np.full(len(omega), True)
    assert orbit is not None
    moving = np.isfinite(orbit)
    if moving.sum() < 2:
        return (lambda w: np.nan * w), np.full(len(omega), False)
    rate = CubicSpline(omega[moving], orbit[moving])  # it passes zero where the rotor's orbit stands in space
    return (lambda w: np.abs(rate(w))), moving


# ---------------------------------------------------------------------- command
def run_campbell(
    case: Case,
    speeds: tuple[float, ...],
    out: str | Path | None = None,
    count: int = 20,
    kind: str | None = None,
    lines: tuple[float | str, ...] | None = None,
    overwrite: bool = False,
    name: str = "case",
    comm: PETSc.Comm | None = None,
    without_control: bool = False,
    frequency: str = "wd",
    stiffness: tuple[float, ...] = (),
) -> RunResult:
    """Compute modes over rotary speeds [rad/s]; write campbell.csv, critical.csv and summary.json; collective.

    case: the user's case; count, kind: of modes, as in ``modes``.
    lines: excitation lines in cycles per turn, ``blades`` or ``motor``; None: 1, 2, 3 and the blades of a drag bit.
    frequency: wd, lines meet damped frequencies; wn, natural ones.
    out: run folder, None: a new one named after ``name``; overwrite: replace an existing one.
    comm: communicator, all ranks by default.
    without_control: leave out motor and controller, and hold the top at the rotation.
    stiffness: of the wall [Pa], for critical_map.csv.

    Returns folder, summary and the lines to show.  Raises CaseError for wrong arguments, SolveError where no state or
    mode is found.
    """
    turning = turning_case(case, "campbell", without_control)
    comm = comm or PETSc.COMM_WORLD
    if count < 1:
        raise CaseError(at="--count", got=count, want="a number of modes, at least 1")
    if len(speeds) < 2:
        raise CaseError(
            at="--speeds", got=f"{rpm_of(speeds[0]):g} rpm", want="two speeds or more; `modes` is for one"
        )
    if frequency not in FREQUENCIES:
        raise CaseError(at="--frequency", got=frequency, want=" or ".join(FREQUENCIES))
    lines = named_lines(case, lines) if lines else default_lines(case)
    if stiffness:
        demand_wall(case)
    with options_of(case):
        states = TurningModel(turning, comm)
        folder = make_folder(comm, name, out, False, overwrite)
        found = campbell(states, speeds, count, lines, kind, frequency == "wn")
        by_wall = critical_map(case, stiffness, speeds, count, lines, kind, without_control, comm)
    summary = _summary(case, found, speeds, lines, states, kind) | {"frequency": frequency}
    if comm.rank == 0:
        write_case_folder(case, folder.path)
        write_table(folder.path / CAMPBELL_TABLE, [q.column for q in CAMPBELL], _campbell_columns(found))
        rows = _critical_columns(found, summary["case_speed"])
        write_table(folder.path / CRITICAL_TABLE, [q.column for q in CRITICAL], rows)
        if stiffness:
            columns = [q.column for q in CRITICAL_MAP]
            write_table(folder.path / CRITICAL_MAP_TABLE, columns, map_columns(by_wall))
        write_summary(folder.summary, summary)
    lines_shown = _lines(case, folder.path, found, summary)
    if stiffness:
        said = f"  {len(by_wall)} critical speeds without damping at {len(stiffness)} stiffnesses of the wall: {CRITICAL_MAP_TABLE}"
        lines_shown.insert(-1, said)
    return RunResult(folder.path, summary, lines_shown)


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


def _case_speed(case: Case) -> float:
    """Rotation of the case at time 0 [rpm], 0 without one."""
    return rpm_of(case.top.rotation.value(0.0)) if case.top.rotation is not None else 0.0


def margin(critical: Critical, case_speed: float) -> float:
    """Distance of a critical speed from that of the case [% of the latter]; nan for a case that does not turn."""
    return 100.0 * (critical.speed / RPM - case_speed) / case_speed if case_speed else float("nan")


def searched_to(found: Campbell) -> FloatArray:
    """(k,) frequency [rad/s] at each speed up to which all modes are known: that of the highest mode asked for."""
    return np.array([m.s.imag[m.counted].max(initial=0.0) for m in found.speeds])


def _summary(
    case: Case,
    found: Campbell,
    speeds: tuple[float, ...],
    lines: tuple[float | str, ...],
    states: TurningModel,
    kind: str | None,
) -> dict[str, Any]:
    case_speed = _case_speed(case)
    lost = [b for b in found.branches if b.end == "lost"]
    grows = [rpm_of(m.speed) for m in found.speeds if m.grows.any()]
    warnings = []
    if lost:
        shown = ", ".join(
            f"{b.number} at {rpm_of(found.speeds[b.points[-1][0]].speed):g} rpm" for b in lost[:6]
        ) + (f" and {len(lost) - 6} more" if len(lost) > 6 else "")
        warnings.append(
            f"branches lost, because no mode at the next speed has a MAC of {LEAST_MAC:g}: {shown}; a finer step may help"
        )
    near = [
        c for c in found.critical
        if case_speed and abs(margin(c, case_speed)) < MARGIN and c.damping_ratio < SHARP
    ]  # fmt: skip
    for c in near[:5]:
        ratio = "undamped" if np.isinf(c.amplification) else f"damping ratio {c.damping_ratio:.2g}"
        warnings.append(
            f"critical speed {rpm_of(c.speed):.4g} rpm ({'motor, ' if c.excitation == 'motor' else ''}{c.line:.4g} per turn, {c.kind} {c.frequency:.4g} Hz, {ratio}) is within "
            f"{MARGIN:g} % of the case's {case_speed:g} rpm"
        )
    if len(near) > 5:
        warnings.append(f"{len(near) - 5} more critical speeds are within {MARGIN:g} % of the case's speed")
    if found.speeds[0].stuck:
        warnings.append(
            "at 0 rpm the string is at rest without friction; modes there need not continue those above"
        )
    warnings += not_searched(found.speeds)
    if grows:
        warnings.append(
            f"a mode grows at {len(grows)} of {len(found.speeds)} speeds, first at {grows[0]:g} rpm"
        )
    return {
        "title": case.title,
        "speeds": [rpm_of(s) for s in speeds],
        "added_speeds": [rpm_of(m.speed) for m in found.speeds if m.speed not in speeds],
        "case_speed": case_speed,
        "lines": [line for line in lines if not isinstance(line, str)],
        **(
            {"motor_line": [None if np.isnan(q) else abs(q) / (2 * np.pi) for q in found.orbit]}
            if found.orbit is not None
            else {}
        ),
        "searched": kind or "all kinds",
        "searched_to": [float(q) for q in searched_to(found) / (2 * np.pi)],
        "searched_beside": [
            None if np.isnan(q) else float(q) for q in searched_beside(found.speeds) / (2 * np.pi)
        ],
        "branches": len(found.branches),
        "lost": len(lost),
        "critical_speeds": len(found.critical),
        "growing_speeds": grows,
        "static_solutions": states.solved,
        "warnings": warnings,
    }


def _campbell_columns(found: Campbell) -> list[Any]:
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
    return [np.array(column) for column in zip(*rows, strict=True)] if rows else [np.zeros(0)] * len(CAMPBELL)


def _critical_columns(found: Campbell, case_speed: float) -> list[Any]:
    rows = [
        [c.branch, c.kind, c.whirl, c.excitation, c.line, rpm_of(c.speed), c.frequency, c.damping_ratio, c.amplification,
         margin(c, case_speed)]
        for c in found.critical
    ]  # fmt: skip
    return [np.array(column) for column in zip(*rows, strict=True)] if rows else [np.zeros(0)] * len(CRITICAL)


def _lines(case: Case, folder: Path, found: Campbell, summary: dict[str, Any]) -> list[str]:
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
    lines += [f"  note: {w}" for w in summary["warnings"]]
    lines.append(f"  results: {folder}")
    return lines


SHOWN = 12  # critical speeds that are printed


def _amplification(critical: Critical) -> str:
    value = critical.amplification
    return "grows" if np.isnan(value) else "infinite" if np.isinf(value) else f"{value:.3g}"
