"""Soft strings of many bit depths, operations and friction factors, integrated together from the bit up.

The equations are those of `soft_string`, with the extra wall force r F^2/(4 EI) where the compression F is above the
helical buckling load (manual: sec-soft-string-helical).  The steps are a kernel (kernels/soft/step.hpp).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from drillpetsc.analysis.loads.torque_drag.string_rows import StringRows
from drillpetsc.analysis.statics.start.soft_string import _GAUSS, MAX_STEP
from drillpetsc.arrays import FloatArray
from drillpetsc.geometry.well import Well
from drillpetsc.kernels import function, pointer

VERTICAL = np.radians(3.0)  # inclination below which a hole is vertical
LARGEST_FORCE = 5e7  # compression beyond that of any string: the force would grow without bound [N]
PASSED = 0.01  # share of a change of the hook load that must reach the bit
SMALLEST_CLEARANCE = 1e-6  # [m]
RESULTS = 6  # of a step, in the kernel's order
RIGID = 1e30  # stiffness of rigid items, in place of infinity [N], [N m2]


@dataclass(frozen=True)
class Columns:
    """Loads of c soft strings, (c,) each unless stated.

    placed: number of the string's `StringRows`.
    friction: (c, m) friction coefficients of the hole's sections.
    item_factor: by which friction coefficients of items are multiplied.
    wob: force of the rock [N]; torque: of the rock on the string [N m].
    axial_velocity: [m/s], positive when hoisting; rotation: [rad/s].
    weight_factor: by which the buoyed weight is multiplied.
    lift: (k, c) force per length that lifts the string in each step of the hole [N/m], None without flow.
    thrust: of jets on the bit, up [N], None without flow.
    """

    placed: np.ndarray
    friction: FloatArray
    item_factor: FloatArray
    wob: FloatArray
    torque: FloatArray
    axial_velocity: FloatArray
    rotation: FloatArray
    weight_factor: FloatArray
    lift: FloatArray | None = None
    thrust: FloatArray | None = None


@dataclass(frozen=True)
class Batch:
    """Soft strings: (k,) steps from the top down with k + 1 edges, c strings; nan below the lower end of a string.

    md: (k+1,) measured depths of the edges [m].
    tension: (k+1, c) effective axial force [N]; torque: (k+1, c) [N m].
    contact: (k, c) mean wall force per length, the helix's included [N/m].
    state: (k, c) 0 straight, 1 sinusoidal, 2 helical.
    ratios: (2, k, c) compression over the load at which the string buckles sinusoidally, helically [-].
    elongation, twist: (c,) of the whole string [m], [rad].
    locked: (c,) deepest measured depth that a change of the hook load reaches, nan: it reaches the bit [m].
    broken: (c,) mask of strings that cannot carry the weight on bit: hook load and torque do not exist.
    inside: (k, c) mask of the steps in the string; item: (k, c) number of the item.
    """

    md: FloatArray
    tension: FloatArray
    torque: FloatArray
    contact: FloatArray
    state: np.ndarray
    ratios: FloatArray
    elongation: FloatArray
    twist: FloatArray
    locked: FloatArray
    broken: np.ndarray
    inside: np.ndarray
    item: np.ndarray


class Hole:
    """Steps along the hole for some strings, with the geometry at their Gauss points.

    edges: (k+1,) [m]; section: (k,) number of the hole's section; placed: the strings.
    max_step: longest step [m].
    like: another hole with these strings, slightly changed, whose number of steps is taken.  Raises ValueError if the steps of both
    do not correspond.
    """

    def __init__(
        self, well: Well, placed: Sequence[StringRows], max_step: float = MAX_STEP, like: Hole | None = None
    ) -> None:
        self.well, self.placed = well, tuple(placed)
        end = max(rows.depth for rows in placed)
        marks = np.concatenate([well.node_md, well.section_to, *(rows.edges for rows in placed), [0.0, end]])
        marks = np.unique(marks[(marks >= 0) & (marks <= end)])
        keep = np.append(True, np.diff(marks) > 1e-7)
        marks = marks[keep]
        marks[-1] = end
        pieces: np.ndarray = np.ceil(np.diff(marks) / max_step).astype(int) if like is None else like.pieces
        if len(pieces) != len(marks) - 1:
            raise ValueError("the steps of both holes do not correspond")
        self.pieces: np.ndarray = pieces
        first = np.repeat(np.cumsum(pieces) - pieces, pieces)
        fraction = (np.arange(pieces.sum()) - first) / np.repeat(pieces, pieces)
        self.edges = np.append(
            np.repeat(marks[:-1], pieces) + fraction * np.repeat(np.diff(marks), pieces), marks[-1]
        )
        self.h = np.diff(self.edges)
        middle = self.edges[:-1] + 0.5 * self.h
        self.section = np.minimum(np.searchsorted(well.section_to, middle), len(well.section_to) - 1)
        points = self.edges[:-1, None] + self.h[:, None] * _GAUSS
        _, tangent, curvature = well.at(points)
        self.down = tangent[..., 2]  # (k, 2) cos I
        across = -self.down[..., None] * tangent
        across[..., 2] += 1.0
        self.kk = (curvature * curvature).sum(-1)
        self.kz = (curvature * across).sum(-1)
        self.zz = (across * across).sum(-1)
        self.points = np.ascontiguousarray(np.concatenate([self.down, self.kk, self.kz, self.zz], axis=1))
        self.vertical = self.down.mean(1) > np.cos(VERTICAL)
        self.curvature = np.sqrt(self.kk)
        radius = np.asarray(well.section_radius)[self.section]
        count, k = len(self.placed), len(self.h)
        self.item = np.empty((k, count), dtype=int)
        self.inside = np.empty((k, count), dtype=bool)
        self.of: dict[str, FloatArray] = {}
        names = (
            "weight",
            "contact_radius",
            "axial_stiffness",
            "bending_stiffness",
            "torsional_stiffness",
            "friction",
        )
        for name in (*names, "clearance"):
            self.of[name] = np.empty((k, count))
        for p, rows in enumerate(self.placed):
            i = np.clip(np.searchsorted(rows.edges, middle) - 1, 0, len(rows.weight) - 1)
            self.item[:, p], self.inside[:, p] = i, middle < rows.depth
            for name in names:
                self.of[name][:, p] = np.minimum(getattr(rows, name)[i], RIGID)
            self.of["clearance"][:, p] = np.maximum(radius - rows.clearance_radius[i], SMALLEST_CLEARANCE)

    def item_values(self, name: str) -> FloatArray:
        """(k, strings) values of a column of `StringRows`."""
        return np.stack([getattr(rows, name)[self.item[:, p]] for p, rows in enumerate(self.placed)], axis=1)


def soft_strings(hole: Hole, loads: Columns) -> Batch:
    """Integrate all strings from the bit up."""
    steps = Steps(hole, loads)
    tension, results, stop = steps.march()
    with np.errstate(over="ignore", invalid="ignore"):  # of strings whose force grows without bound
        return steps.batch(tension, results, stop)


@dataclass(frozen=True)
class Step:
    """Result of all steps, (k, c) of each.

    above: force at the upper end [N]; contact: mean wall force per length [N/m]; mean: force [N].
    state: 0 straight, 1 sinusoidal, 2 helical.
    ratios: (2, k, c) compression over both buckling loads, as in ``Batch``.
    growth: of a change of the force over the step.
    """

    above: FloatArray
    contact: FloatArray
    mean: FloatArray
    state: np.ndarray
    ratios: FloatArray
    growth: FloatArray


class Steps:
    """The steps of soft strings under their loads: the force at the upper end of a step from that at its lower end."""

    def __init__(self, hole: Hole, loads: Columns) -> None:
        self.hole, self.loads = hole, loads
        placed, of = loads.placed, hole.of
        own = of["friction"][:, placed] * loads.item_factor
        self.mu = np.where(np.isnan(own), loads.friction.T[hole.section], own)
        around = loads.rotation * of["contact_radius"][:, placed]
        speed = np.hypot(loads.axial_velocity, around)
        scale = np.divide(1.0, speed, out=np.zeros_like(speed), where=speed > 0)
        along, self.hoop = loads.axial_velocity * scale, around * scale
        self.drag = along * self.mu
        self.weight = of["weight"][:, placed] * loads.weight_factor
        self.inside = hole.inside[:, placed]
        stiffness, clearance = of["bending_stiffness"][:, placed], of["clearance"][:, placed]
        extra = clearance / (4 * stiffness)
        root = np.sqrt(stiffness / clearance)
        hanging = np.where(hole.vertical[:, None], np.cbrt(self.weight**2 * stiffness), 0.0)
        self.h = np.ascontiguousarray(np.where(self.inside, hole.h[:, None], 0.0))
        lift = np.zeros((len(hole.h), 1)) if loads.lift is None else loads.lift
        parts = self.weight, lift, self.drag, extra, root, hanging
        self.values = np.ascontiguousarray(np.stack(np.broadcast_arrays(*parts), axis=-1), dtype=float)

    @property
    def end(self) -> FloatArray:
        """(c,) force at the lower ends [N]."""
        hole, loads, placed = self.hole, self.loads, self.loads.placed
        weight = np.array([rows.end_weight for rows in hole.placed])[placed] * loads.weight_factor
        lower_end = np.array([rows.depth for rows in hole.placed])
        at_end = np.asarray(hole.well.at(lower_end)[1])[:, 2][placed]
        return np.asarray(weight * at_end - loads.wob - (0.0 if loads.thrust is None else loads.thrust))

    def from_below(self, t: FloatArray) -> Step:
        """Take every step from the forces ``t`` (k, c) [N] at the lower ends."""
        t = np.ascontiguousarray(t)
        above, out = np.empty(t.shape), np.empty((RESULTS, *t.shape))
        _steps(*t.shape, *self._arguments(), pointer(t), pointer(above), pointer(out))
        return _step_of(above, out)

    def march(self) -> tuple[FloatArray, Step, FloatArray]:
        """Forces (k+1, c) [N] at the edges from the lower end up, their steps, and (c,) measured depths [m] where a string breaks, else nan."""
        k, count = self.h.shape
        tension, out = np.empty((k + 1, count)), np.zeros((RESULTS, k, count))
        tension[-1], stop = self.end, np.full(count, np.nan)
        edges = np.ascontiguousarray(self.hole.edges)
        _march(
            k, count, *self._arguments(), pointer(edges), LARGEST_FORCE, pointer(tension), pointer(out), pointer(stop)
        )  # fmt: skip
        return tension, _step_of(tension[:-1], out), stop

    def _arguments(self) -> tuple[int, ...]:
        return tuple(pointer(q) for q in (self.hole.points, self.values, self.h))

    def batch(self, tension: FloatArray, steps: Step, stop: FloatArray | None = None) -> Batch:
        """Everything that forces (k+1, c) [N] at the edges give, with their ``steps``.

        stop: (c,) measured depths [m] where strings cannot carry their weight on bit, nan of others; None: none.
        """
        hole, loads, placed, inside = self.hole, self.loads, self.loads.placed, self.inside
        count = len(placed)
        stop = np.full(count, np.nan) if stop is None else stop
        broken = ~np.isnan(stop)
        h, mean = self.h, steps.mean
        torque_step = h * self.hoop * hole.of["contact_radius"][:, placed] * self.mu * steps.contact
        torque = loads.torque + np.vstack([np.cumsum(torque_step[::-1], axis=0)[::-1], np.zeros((1, count))])
        elongation = (h * mean / hole.of["axial_stiffness"][:, placed]).sum(0)
        twist = (h * 0.5 * (torque[:-1] + torque[1:]) / hole.of["torsional_stiffness"][:, placed]).sum(0)
        locked = np.where(broken, stop, _locked(hole, steps.growth, loads.axial_velocity < 0))
        for values in (elongation, twist):
            values[broken] = np.nan
        below = np.vstack([np.ones((1, count), dtype=bool), inside])
        tension = np.where(below, tension, np.nan)
        torque = np.where(below, torque, np.nan)
        above = np.isnan(stop) | (hole.edges[:, None] >= stop)
        return Batch(
            hole.edges,
            np.where(above, tension, np.nan),
            np.where(above, torque, np.nan),
            np.where(inside, steps.contact, np.nan),
            np.where(inside & above[:-1], steps.state, 0),
            np.where(inside & above[:-1], steps.ratios, 0.0),
            elongation,
            twist,
            locked,
            broken,
            inside,
            hole.item[:, placed],
        )


def _step_of(above: FloatArray, out: FloatArray) -> Step:
    """The step of results (RESULTS, k, c) in the order of kernels/soft/step.hpp."""
    contact, mean, growth, sinusoidal, helical, state = out
    return Step(above, contact, mean, state.astype(np.int8), np.stack([sinusoidal, helical]), growth)


@cache
def _entry(name: str, arguments: str) -> Any:
    return function(name, arguments)


def _steps(*arguments: Any) -> None:
    _entry("soft_string_steps", "iipppppp")(*arguments)


def _march(*arguments: Any) -> None:
    _entry("soft_string_march", "iippppdppp")(*arguments)


def _locked(hole: Hole, slope: FloatArray, lowered: np.ndarray) -> FloatArray:
    """(c,) measured depth below which less than `PASSED` of a change of the hook load arrives; nan where there is none.

    slope: (k, c) growth of a change of the force over a step, upwards.
    """
    passed = np.cumsum(slope, axis=0)  # from the top down to the lower end of each step
    less = passed > -np.log(PASSED)
    found = less.any(0) & lowered & less[-1]
    return np.where(found, hole.edges[1:][np.argmax(less, axis=0)], np.nan)
