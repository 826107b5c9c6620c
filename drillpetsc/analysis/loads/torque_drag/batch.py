"""Soft strings of many bit depths, operations and friction factors, integrated from the bit up by compiled code.

The equations are those of `soft_string`, with the extra wall force r F^2/(4 EI) where the compression F is above the
helical buckling load (manual: sec-soft-string-helical).  Within a step whether the string is helical follows from the
force at the step's lower end, so that the stage equations are smooth.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from drillpetsc.analysis.loads.torque_drag.string_rows import StringRows
from drillpetsc.analysis.statics.start.soft_string import _GAUSS, MAX_STEP
from drillpetsc.arrays import FloatArray
from drillpetsc.geometry.well import Well
from drillpetsc.kernels import function, pointer
from drillpetsc.kernels.parameters import columns, structure

VERTICAL = np.radians(3.0)  # inclination below which a hole is vertical
LARGEST_FORCE = 5e7  # compression beyond that of any string: the force would grow without bound [N]
PASSED = 0.01  # share of a change of the hook load that must reach the bit
SMALLEST_CLEARANCE = 1e-6  # [m]
RIGID = 1e30  # stiffness of rigid items, in place of infinity [N], [N m2]


_Call, _STEP = structure("soft_string_call"), columns("soft_string_step")
_soft_strings = function("soft_strings", "p")


@dataclass(frozen=True)
class Columns:
    """Loads of c soft strings, (c,) each, or a number for all of them, unless stated.

    placed: (c,) number of the string's `StringRows`.
    friction: (c, m) friction coefficients of the hole's sections.
    wob: force of the rock [N]; torque: of the rock on the string [N m].
    axial_velocity: [m/s], positive when hoisting; rotation: [rad/s].
    item_factor: by which friction coefficients of items are multiplied; weight_factor: the same of the buoyed weight.
    lift: force per length that lifts each string in its steps [N/m], None without flow.
    thrust: of jets on the bit, up [N].
    """

    placed: np.ndarray
    friction: FloatArray
    wob: FloatArray | float
    torque: FloatArray | float
    axial_velocity: FloatArray | float
    rotation: FloatArray | float
    item_factor: FloatArray | float = 1.0
    weight_factor: FloatArray | float = 1.0
    lift: Sequence[FloatArray] | None = None
    thrust: FloatArray | float = 0.0


class TopLoads(NamedTuple):
    """What a soft string gives at its top, (c,) each.

    tension [N], torque [N m]: nan for a string that cannot carry its weight on bit.
    sinusoidal, helical: largest compression along the string over the load at which it buckles so [-].
    """

    tension: FloatArray
    torque: FloatArray
    sinusoidal: FloatArray
    helical: FloatArray


@dataclass(frozen=True)
class Batch:
    """Soft strings: (k,) steps from the top down with k + 1 edges, c strings; nan below the lower end of a string, and above the last
    force that it bears.

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


class SoftStrings:
    """The strings of some holes, ready to be integrated, numbered through.

    Hundreds of bit depths cost what they cost alone if each has a hole, and so steps, of its own.
    """

    def __init__(self, holes: Sequence[Hole]) -> None:
        self.holes, rows, sections = holes, list[FloatArray](), []
        ends: list[tuple[float, float]] = []
        for hole in holes:
            down = np.asarray(hole.well.at([string.depth for string in hole.placed])[1])[:, 2]
            ends += zip((string.end_weight for string in hole.placed), down.tolist(), strict=True)
            for p, count in enumerate(hole.inside.sum(axis=0)):
                of = {name: values[:count, p] for name, values in hole.of.items()}
                along = (hole.h, hole.down, hole.kk, hole.kz, hole.zz)
                row = [*(q[:count] for q in along), of["weight"], of["contact_radius"]]
                row += [of["bending_stiffness"], of["clearance"], of["friction"], hole.vertical[:count]]
                rows.append(np.column_stack(row))
                sections.append(hole.section[:count])
        self._first = np.append(0, np.cumsum([len(q) for q in rows])).astype(np.int32)
        self._rows = np.ascontiguousarray(np.concatenate(rows), dtype=float)
        self._section = np.concatenate(sections).astype(np.int32)
        self._end = np.array(ends, dtype=float)

    def ends(
        self, loads: Columns, edges: FloatArray | None = None, steps: FloatArray | None = None
    ) -> TopLoads:
        """Both ends of c strings, and what is between them into ``edges`` and ``steps``, as compiled code has them."""
        count, lift = len(loads.placed), loads.lift or ()
        shared = {id(values): values for values in lift}  # columns of one point have one array
        starts = dict(zip(shared, np.cumsum([0, *(len(q) for q in shared.values())]), strict=False))
        numbers = {
            name: q for name, q in vars(loads).items() if name not in ("placed", "friction", "torque", "lift")
        }
        arrays: dict[str, Any] = {
            "first": self._first,
            "rows": self._rows,
            "section": self._section,
            "end": self._end,
            "placed": np.ascontiguousarray(loads.placed, dtype=np.int32),
            "friction": np.ascontiguousarray(loads.friction, dtype=float),
            "lift": np.concatenate([*shared.values(), np.zeros(1)]),
            "lift_at": np.array([starts[id(q)] for q in lift] or [-1] * count, dtype=np.int32),
            **{
                name: np.full(count, q, dtype=float)
                for name, q in (numbers | {"moment": loads.torque}).items()
            },
            **{name: np.empty(count) for name in TopLoads._fields},
        }
        if edges is not None and steps is not None:
            arrays |= {"edges": edges, "steps": steps}
        call = _Call(**{name: pointer(array) for name, array in arrays.items()})
        call.largest, call.count, call.sections = LARGEST_FORCE, count, arrays["friction"].shape[1]
        call.most = 0 if steps is None else steps.shape[1]
        _soft_strings(ctypes.addressof(call))
        return TopLoads(*(arrays[name] for name in TopLoads._fields))


def soft_strings(hole: Hole, loads: Columns) -> Batch:
    """Integrate strings of a hole, and keep all that they have along it."""
    placed, k = loads.placed, len(hole.h)
    edges, steps = np.full((len(placed), k + 1, 2), np.nan), np.full((len(placed), k, _STEP.width), np.nan)
    SoftStrings([hole]).ends(loads, edges, steps)
    tension, torque = np.moveaxis(edges, 0, 1)[..., 0], np.moveaxis(edges, 0, 1)[..., 1]
    contact, mean, *both, growth = np.moveaxis(steps, (2, 1), (0, 1))
    ratios = np.nan_to_num(both, nan=0.0, posinf=np.inf)
    borne = np.isfinite(tension)
    broken = ~borne[0]
    h, turned = hole.h[:, None], 0.5 * (torque[:-1] + torque[1:])
    elongation = np.nansum(h * mean / hole.of["axial_stiffness"][:, placed], axis=0)
    twist = np.nansum(h * turned / hole.of["torsional_stiffness"][:, placed], axis=0)
    elongation[broken] = twist[broken] = np.nan
    # below which less than `PASSED` of a change of the hook load arrives
    less = np.cumsum(np.nan_to_num(growth), axis=0) > -np.log(PASSED)
    held = less[-1] & np.broadcast_to(np.asarray(loads.axial_velocity) < 0, len(placed))
    locked = np.where(held, hole.edges[1:][np.argmax(less, axis=0)], np.nan)
    return Batch(
        hole.edges,
        tension,
        torque,
        contact,
        (ratios > 1).sum(axis=0),
        ratios,
        elongation,
        twist,
        np.where(broken, hole.edges[np.argmax(borne, axis=0)], locked),
        broken,
        hole.inside[:, placed],
        hole.item[:, placed],
    )
