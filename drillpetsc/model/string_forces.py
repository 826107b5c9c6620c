"""Estimate of the axial force along the string before any solve, from which element lengths are chosen.

Manual: sec-mesh-forces.  The string lies on the wall of its hole as in the soft string (manual: sec-soft-string);
if it is helical, the wall force of the helix is added (manual: eq-statics-march).  The largest push and pull over
the operations of the case are kept, so that one mesh serves all of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.ends import BitBottom, ForcedBottom, HeldBottom, PointLoad, TopDrive
from drillpetsc.case.blocks.items.string import Flexible
from drillpetsc.case.case import Case
from drillpetsc.case.quantities import largest
from drillpetsc.geometry.well import Well
from drillpetsc.model.hole import axis_of, top_of_string

MAX_STEP = 5.0  # longest piece of the string in the estimate [m]
HELIX_FACTOR = 2 * np.sqrt(2.0)  # manual: eq-statics-march
VERTICAL_FACTOR = 2.65
CRUSHING_STRAIN = 0.01  # compression [-] of the pipe at the largest push
LEAST_CLEARANCE = 1e-3  # [m]


@dataclass(frozen=True)
class StringForces:
    """Pieces of the string between the depths ``md``, each inside one item; values (n,) unless said otherwise.

    md: (n+1,) measured depths along the string [m]; item: number of the string item.
    push, pull: largest compression and tension [N], not below zero; least: smallest axial force [N].
    side: load across the string per length, of weight and of the hole's curvature [N/m].
    weight: buoyed weight per length [N/m]; mass: per length with the mud that moves with it [kg/m].
    clearance: radial [m], infinite without contact.
    curvature: (n,) of the hole [1/m]; change: (n+1,) jump of its curvature vector at the depths [1/m].
    top: measured depth in the hole of the string's upper end [m].
    """

    md: FloatArray
    item: np.ndarray
    push: FloatArray
    pull: FloatArray
    least: FloatArray
    side: FloatArray
    weight: FloatArray
    mass: FloatArray
    clearance: FloatArray
    curvature: FloatArray
    change: FloatArray
    top: float


def _areas(case: Case, number: int, flexible: dict[int, dict[str, float]]) -> tuple[float, float]:
    """Areas [m2] of the bore and of the outside of an item, means over a joint of pipe with tool joints."""
    if number in flexible:
        return flexible[number]["bore_area"], flexible[number]["outer_area"]
    item = case.string[number]
    return item.bore_section, item.outer_section


def held_at_weight(case: Case) -> Case:
    """The case of statics: a top under a force is held at the depth where the bit carries ``initial.wob``."""
    if case.initial.wob is None or case.top.force is None:
        return case
    assert isinstance(case.top, TopDrive)
    held = case.top.model_copy(update={"force": None, "guided": True})
    return case.model_copy(update={"top": held})


def estimate_forces(
    case: Case,
    well: Well | None,
    sections: dict[int, dict[str, float]],
    motion: tuple[float, float] | None,
    places: Sequence[float] = (),
) -> StringForces:
    """Estimate the forces of the string of ``case``.

    sections: section values of each flexible item by its number (``StringMesh`` units).
    motion: axial speed [m/s, down positive] and rotation [rad/s] of a static problem, None: the motion of the case.
    places: measured depths [m] where pieces end, beside items' ends and the hole's nodes.
    """
    case = held_at_weight(case)
    shift = top_of_string(case, case.string_length)
    md, item = _pieces(case, well, shift, places)
    middle, h = 0.5 * (md[1:] + md[:-1]), np.diff(md)
    tangent, curvature, change = _hole(case, well, md, middle, shift)
    g = np.array(case.gravity, dtype=float)
    flexible = {i: s for i, s in sections.items() if isinstance(case.string[i], Flexible)}
    stand_in = next(iter(flexible.values()))

    def section(key: str) -> FloatArray:
        return np.array([flexible.get(int(i), stand_in)[key] for i in item])

    metal = np.array([_mass(case, int(i), flexible) for i in item])
    outer = np.array([case.string[int(i)].contact_od or 0.0 for i in item])
    mud_inside, displaced = np.zeros(len(h)), np.zeros(len(h))
    if case.fluid is not None:
        if case.has_bore:
            mud_inside = case.fluid.density * np.array([_areas(case, int(i), flexible)[0] for i in item])
        if case.has_annulus:
            displaced = case.fluid.density * np.array([_areas(case, int(i), flexible)[1] for i in item])
    per_length = (metal + mud_inside - displaced)[:, None] * g
    load, across = _loads(case, md, middle, h, tangent)
    load += _without_length(case, md, len(h))[:, None] * g
    force = per_length * h[:, None] + load
    along = np.sum(force * tangent, axis=1)
    perpendicular = force - along[:, None] * tangent + across
    clearance = np.full(len(h), np.inf)
    friction = np.zeros(len(h))
    if well is not None and case.contact is not None:
        clearance = np.asarray(well.radius(middle + shift)) - 0.5 * outer
        clearance = np.maximum(clearance, LEAST_CLEARANCE)
        own = [case.string[int(i)].friction for i in item]
        friction = np.asarray(well.friction(middle + shift)).copy()
        friction = np.array([mu if q is None else q for mu, q in zip(friction, own, strict=True)])
    bending, axial = section("bending_stiffness"), section("axial_stiffness")
    weight = np.linalg.norm(per_length, axis=1)
    is_flexible = np.array([int(i) in flexible for i in item])
    pieces = _Pieces(
        along, (h * curvature.T).T, perpendicular, h, bending, np.where(is_flexible, clearance, np.inf), weight, axial
    )  # fmt: skip
    profiles = [
        pieces.march(bottom, drag * friction)
        for bottom in _bottom_forces(case, pieces, tangent)
        for drag in _drags(case, motion, 0.5 * float(outer.max(initial=0.0)))
    ]
    if case.top.force is not None or case.top.kind == "free":
        profiles = [value - np.cumsum(pieces.along) + 0.5 * pieces.along for value in _top_forces(case)]
    stack = np.array(profiles)
    low, high = stack.min(axis=0), stack.max(axis=0)
    extreme = np.where(np.abs(low) > np.abs(high), low, high)
    side = np.linalg.norm(pieces.turn * extreme[:, None] + perpendicular, axis=1) / h
    return StringForces(
        md,
        item,
        np.maximum(-low, 0.0),
        np.maximum(high, 0.0),
        low,
        side,
        weight,
        metal + mud_inside + displaced,
        clearance,
        np.linalg.norm(curvature, axis=1),
        change,
        shift,
    )


@dataclass(frozen=True)
class _Pieces:
    """Pieces of a string, and the march along them.

    along: (n,) axial loads [N]; turn: (n, 3) of the hole [rad]; across: (n, 3) loads [N]; h: (n,) lengths [m].
    bending: (n,) [N m2] and axial: (n,) [N] stiffness; clearance: (n,) [m]; weight: (n,) [N/m].
    """

    along: FloatArray
    turn: FloatArray
    across: FloatArray
    h: FloatArray
    bending: FloatArray
    clearance: FloatArray
    weight: FloatArray
    axial: FloatArray

    @cached_property
    def rows(self) -> list[list[float]]:
        """What the march needs of each piece."""
        vertical = VERTICAL_FACTOR * np.cbrt(self.bending * self.weight**2)
        pairs = ((self.turn, self.turn), (self.turn, self.across), (self.across, self.across))
        products = [np.sum(a * b, axis=1) for a, b in pairs]
        crushing = CRUSHING_STRAIN * self.axial
        columns = [self.along, *products, self.h, self.bending, self.clearance, vertical, crushing]
        return np.column_stack(columns).tolist()

    def march(self, bottom: float, drag: FloatArray) -> FloatArray:
        """Mean axial force (n,) of the pieces [N] from the force at the bottom.

        drag: friction coefficient along the string, positive if friction acts upward on the string.
        """
        out, below, factors = np.empty(len(self.rows)), bottom, drag.tolist()
        for i in range(len(self.rows) - 1, -1, -1):
            load, kk, kw, ww, h, bending, clearance, vertical, crushing = self.rows[i]
            above = below + load
            for _ in range(2 if factors[i] else 1):
                mean = 0.5 * (below + above)
                wall = max(kk * mean * mean + 2 * kw * mean + ww, 0.0) ** 0.5
                if (
                    -mean > max(vertical, HELIX_FACTOR * (bending * wall / h / clearance) ** 0.5)
                    and clearance < 1e9
                ):
                    wall = max(wall, clearance * mean * mean / (4 * bending) * h)
                above = below + load - factors[i] * wall
            above = max(above, -crushing)
            out[i], below = 0.5 * (below + above), above
        return out


def _pieces(
    case: Case, well: Well | None, shift: float, places: Sequence[float]
) -> tuple[FloatArray, np.ndarray]:
    """Depths (n+1,) [m] of pieces that end at items' ends, at the hole's nodes and sections, and the item of each (n,)."""
    marks, items = [0.0], []
    nodes = np.zeros(0) if well is None else np.concatenate([well.node_md, well.section_to]) - shift
    nodes = np.unique(np.concatenate([nodes, places]))
    for number, (top, bottom) in enumerate(case.item_depths):
        if bottom - top < 1e-9:
            continue
        inside = nodes[(nodes > top + 1e-6) & (nodes < bottom - 1e-6)]
        edges = np.concatenate([[top], inside, [bottom]])
        for a, b in zip(edges[:-1], edges[1:], strict=True):
            count = int(np.ceil((b - a) / MAX_STEP - 1e-9))
            marks += np.linspace(a, b, count + 1)[1:].tolist()
            items += [number] * count
    return np.array(marks), np.array(items, dtype=int)


def _hole(
    case: Case, well: Well | None, md: FloatArray, middle: FloatArray, shift: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Tangent (n, 3), curvature vector (n, 3) [1/m] of the hole at the pieces, jump of the curvature (n+1,)."""
    axis = axis_of(case, well)
    _, tangent, curvature = (np.asarray(q) for q in axis.at(middle + shift))
    above, below = (np.asarray(axis.at(md + shift + d)[2]) for d in (-1e-6, 1e-6))
    change = np.linalg.norm(below - above, axis=1)
    change[[0, -1]] = 0.0
    return tangent, curvature, change


def _mass(case: Case, number: int, flexible: dict[int, dict[str, float]]) -> float:
    """Mass per length of an item [kg/m]."""
    if number in flexible:
        return flexible[number]["mass"]
    item = case.string[number]
    return float(getattr(item, "mass", 0.0) or 0.0) / item.length


def _without_length(case: Case, md: FloatArray, pieces: int) -> FloatArray:
    """Masses (n,) [kg] of items without length, on the piece above each."""
    out = np.zeros(pieces)
    for item, (top, bottom) in zip(case.string, case.item_depths, strict=True):
        if bottom - top < 1e-9:
            out[max(int(np.searchsorted(md, top - 1e-9)) - 1, 0)] += float(getattr(item, "mass", 0.0) or 0.0)
    return out


def _loads(
    case: Case, md: FloatArray, middle: FloatArray, h: FloatArray, tangent: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Loads in space (n, 3) and across the string (n, 3) on the pieces [N], the largest over time."""
    out, across = np.zeros((len(h), 3)), np.zeros((len(h), 3))
    for load in case.loads:
        factor = largest(load.value_over)
        vector = factor * np.array(load.force, dtype=float)
        if isinstance(load, PointLoad):
            share = np.zeros(len(h))
            share[min(int(np.searchsorted(md, load.at, side="right")) - 1, len(h) - 1)] = 1.0
        else:
            overlap = np.minimum(md[1:], load.to) - np.maximum(md[:-1], load.from_)
            share = np.maximum(overlap, 0.0)
        if load.frame == "section":  # along the string, then across it
            out += share[:, None] * vector[0] * tangent
        elif isinstance(
            load, PointLoad
        ):  # its part across the string bends, but does not press a length of it
            out += share[:, None] * (tangent @ vector)[:, None] * tangent
        else:
            out += share[:, None] * vector
    return out, across


def _bottom_forces(case: Case, pieces: _Pieces, tangent: FloatArray) -> list[float]:
    """Axial forces at the lower end [N] that the case may meet."""
    bottom = case.bottom
    if isinstance(bottom, ForcedBottom):
        return [float(np.dot(bottom.force, tangent[-1]))]
    if isinstance(bottom, BitBottom):
        return sorted({0.0, -_weight_on_bit(case, pieces)})
    if isinstance(bottom, HeldBottom) and bottom.kind != "free" and case.top.kind != "free":
        return [0.0, -max(0.5 * float(pieces.along.sum()), 0.0)]
    return [0.0]


def _weight_on_bit(case: Case, pieces: _Pieces) -> float:
    """Largest weight on bit [N]: at the start, or after the lowering of the top."""
    wob = case.initial.wob or 0.0
    lowering = case.top.lowering if case.top.force is None else None
    if lowering is None or case.time is None:
        return wob
    travel = max(lowering.integral(case.time.end), 0.0)
    if case.formation is not None:  # in the end the bit drills as fast as the top is lowered
        rock = case.formation
        softest = min([rock.drillability, *(layer.drillability for layer in rock.layers)])
        stands = largest(lowering) / softest if softest > 0 else np.inf
    else:
        stands = np.inf
    stiffness = 1.0 / sum(row[4] / (row[8] / CRUSHING_STRAIN) for row in pieces.rows)
    return max(wob, min(wob + travel * stiffness, stands, max(float(pieces.along.sum()), wob)))


def _drags(case: Case, motion: tuple[float, float] | None, radius: float) -> list[float]:
    """Axial part of the slip direction, (down) positive, of every operation.

    A string that turns has little axial friction; one that does not is lowered and hoisted.
    """
    if motion is None:
        speed, rotation = largest(case.top.lowering), largest(case.top.rotation)
    else:
        speed, rotation = abs(motion[0]), abs(motion[1])
    around = rotation * radius
    if not around:
        return [1.0, -1.0]
    share = speed / float(np.hypot(speed, around))
    return [share, -share] if share else [0.0]


def _top_forces(case: Case) -> list[float]:
    """Axial forces at the top [N] of a case that gives the force, or none for a free top."""
    force = case.top.force
    if force is None:
        return [0.0]
    breaks = force.breaks()
    return sorted({float(force.value(t)) for t in (0.0, *breaks, 1e9)})
