"""Modes over rotary speeds, tracked by shape, and critical speeds (manual: sec-campbell)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from drillpetsc.analysis.linear.frequency.beside_lines import (
    half_widths,
    in_bands,
    step_at,
    with_modes_beside,
)
from drillpetsc.analysis.linear.frequency.stokes import (
    FrequencyDependent,
    at_own_frequencies,
    frequency_dependent,
)
from drillpetsc.analysis.linear.frequency.tracking import (
    Branch,
    Pairing,
    SpeedModes,
    pair,
    track,
)
from drillpetsc.analysis.linear.frequency.turning import TurningModel
from drillpetsc.analysis.linear.linearised_model import linearise_model
from drillpetsc.analysis.linear.modal import ZERO_FRACTION, _of_kind, _shares, reference_rate, storage
from drillpetsc.analysis.linear.modes import KINDS
from drillpetsc.arrays import FloatArray
from drillpetsc.geometry.frames import two_across
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output.progress import counted
from drillpetsc.parallel import first_rank_gives, total
from drillpetsc.physics.roots import bracketed_root
from drillpetsc.physics.tools.mud_motor import MudMotor
from drillpetsc.solvers.linear.linearization import Linearised
from drillpetsc.solvers.linear.quadratic_eigenproblem import NEUTRAL_GROWTH, Eigenvalues, lowest_eigenvalues

SPARE_OF_KIND = 2  # the same for modes of one kind, which lie far apart
SPARE_MODES = 8  # computed beyond those asked for, so that branches that rise are still found
SMALLEST_STEP = 8  # a speed step is divided into so many parts before a branch is lost
EQUAL = 1e-6  # relative difference of eigenvalues that are one up to rounding
STRAIGHT = 1e-3  # short over long axis of an orbit below which it is a straight line
PURE = 0.9  # share of the energy in forward orbits above which a mode whirls forward
DEFAULT_LINES = (1.0, 2.0, 3.0)
BESIDE_A_LINE = 80  # eigenvalues computed beside a line at most, where twice --count is less


@dataclass(frozen=True)
class Sought:
    """What a Campbell diagram is computed for.

    speeds: [rad/s]; count, kind: of modes at each of them, as in ``modes``.
    lines: excitation lines in cycles per turn, and ``motor``.
    """

    speeds: tuple[float, ...]
    count: int
    kind: str | None = None
    lines: tuple[float | str, ...] = ()


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
    Raises SolveError if there is no state or no eigenvalue.
    """
    states.at(speed)
    model, beside = states.model, lines()
    own = frequency_dependent(model)
    linearised = linearise_model(model)

    def solve() -> SpeedModes:
        assert linearised is not None  # rank 0 has it
        return _found(model, linearised, own, speed, count, kind, beside)

    modes: SpeedModes = first_rank_gives(model.system.comm.tompi4py(), solve)
    return modes


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
    x = np.where(linearised.second_order[:, None], size * u, u)
    wx = 0.5 * (linearised.M @ x + linearised.M.T @ x) + storage(model, linearised)[:, None] * x
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
    one, other = (np.sum(values * axis, axis=2) for axis in two_across(t))
    forward, backward = np.abs(one + 1j * other) ** 2, np.abs(one - 1j * other) ** 2
    total = forward + backward
    straight = np.abs(np.sqrt(forward) - np.sqrt(backward)) < STRAIGHT * (
        np.sqrt(forward) + np.sqrt(backward) + 1e-300
    )
    share = np.sum(np.where(straight, 0.5, forward > backward) * total, axis=1)
    share = share / np.maximum(total.sum(axis=1), 1e-300)
    return tuple("forward" if q > PURE else "backward" if q < 1 - PURE else "mixed" for q in share)


# ---------------------------------------------------------------------- the map
def campbell(states: TurningModel, sought: Sought, natural: bool = False) -> Campbell:
    """Compute modes at the speeds sought, track them, and find critical speeds; collective.

    natural: lines meet natural frequencies |s|, else damped ones Im s.

    Where a branch finds no partner of ``LEAST_MAC``, speeds are added between the two, down to an eighth of the step;
    as many as there are given ones at most.
    """
    orbit, speeds, lines = dict[float, float](), sought.speeds, sought.lines
    step_to_next = step_at(speeds)

    def at(speed: float) -> SpeedModes:
        def beside() -> list[tuple[float, float]]:
            rates = [abs(line) * abs(speed) for line in lines if not isinstance(line, str)]
            if "motor" in lines:
                orbit[speed] = orbit_rate(states.model)
                rates.append(abs(orbit[speed]))
            return half_widths(sorted(rates), abs(speed), step_to_next(speed)) if speed else []

        return modes_at(states, speed, sought.count, sought.kind, beside)

    found: list[SpeedModes] = []
    pairings: list[Pairing] = []
    budget = len(speeds)
    for speed in counted(speeds, "given speeds", states.model.system.comm.rank):
        waiting = [at(speed)]
        if not found:
            found.append(waiting.pop())
            continue
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

    nan in a string at rest, whose rotor is also at rest.
    """
    motor = model.part(MudMotor)
    assert motor is not None
    return float(total(model.system.comm, motor.orbit_speed(0.0, model.system.assembly))) or float("nan")


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
                w = (
                    float(omega[k])
                    if values[k] == 0
                    else bracketed_root(gap, float(omega[k]), float(omega[k + 1]), 1e-10)
                )
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
