"""Lengths of the elements of items without `element_length`: chosen from the physics along the string, and graded.

Manual: sec-mesh.  Each piece of the string demands a longest element, and so do places such as stabilizers, ends
and sharp bends of the hole.  Lengths grow away from the shortest at a bounded rate.  The choice depends on the
case alone, so that every rank, restart and command has the same mesh.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.ends import PointLoad
from drillpetsc.case.blocks.items.string import Rigid
from drillpetsc.case.case import Case
from drillpetsc.case.quantities import largest
from drillpetsc.geometry.well import Well
from drillpetsc.model.string_forces import StringForces, estimate_forces
from drillpetsc.unit_systems import display_unit, shown

LONGEST = 10.0  # [m]
GROWTH = 0.3  # growth of the length per length along the string [-]
LARGEST_GROWTH = 0.6  # the same of a mesh that is coarsened [-]
LARGEST_RATIO = 2.0  # of neighbouring elements, if one of them is automatic
LAYER_SHARE = 0.25  # of sqrt(EI/T): moments beside a support to 1 % (manual: eq-mesh-layer)
SPAN_SHARE = 0.05  # of the free length beside a support: the same with a side load
WAVE_STEP = 1.0  # phase of a buckle's wave in one element [rad]
FREE_STEP = 1.0  # the same for a column that no wall supports [rad]
VIBRATION_STEP = np.pi / 3  # the same for a vibration: six elements a wave length [rad]
NEAR_BUCKLING = 0.5  # share of the buckling load from which elements are made for buckles
LARGEST_TURN = 0.1  # of the hole in one element [rad]
LARGEST_STRESS_FREE_TURN = 0.2  # of the stress-free shape in one element [rad]
SHARP_BEND = 20e6  # bending stress of a jump of the hole's curvature that is resolved [Pa]
STEP_SHARE = 0.1  # the same beside a step on the wall
LEAST_STEP = 1e-5  # of the clearance [m]
STEP_STRESS = 5e6  # bending stress beside a step on the wall that is resolved [Pa]
WEIGHT_SHARE = 0.5  # of the limit (240 EI/w)^(1/3) (manual: eq-beam-length-limit)
FEWEST = 8  # elements in a string without a wall
MOST_ELEMENTS = 20_000  # automatic elements; beyond it all lengths are made longer
HELIX = np.sqrt(2.0)  # helical over sinusoidal buckling load (manual: sec-statics-report)
VERTICAL = 1.94  # manual: sec-statics-report


@dataclass(frozen=True)
class LengthRange:
    """Neighbouring automatic elements whose length has one reason.

    item: number of the string item; upper, lower: measured depths along the string [m].
    shortest, longest: element lengths [m]; count: of elements; reason: what decided.
    """

    item: int
    upper: float
    lower: float
    shortest: float
    longest: float
    count: int
    reason: str


@dataclass(frozen=True)
class ElementLengths:
    """Automatic elements of a string.

    edges: depths of the element ends [m] of each item with automatic lengths, by its number.
    ranges: lengths and their reasons from the top down.
    coarsened: factor by which lengths exceed what the physics requires, 1 unless ``MOST_ELEMENTS`` is reached.
    """

    edges: dict[int, list[float]]
    ranges: tuple[LengthRange, ...] = ()
    coarsened: float = 1.0

    @property
    def limited(self) -> tuple[dict[str, Any], ...]:
        """Figures of a mesh that is coarser than the physics requires, none for others; depths in [m]."""
        if self.coarsened <= 1.001:
            return ()
        worst = min(self.ranges, key=lambda r: r.shortest)
        return (
            {
                "most": MOST_ELEMENTS,
                "times": self.coarsened,
                "upper": worst.upper,
                "lower": worst.lower,
                "reason": worst.reason,
            },
        )


def instead_of_length(case: Case) -> str:
    """Alternatives in a case to a shorter ``element_length``: auto, or a finer mesh if all lengths are automatic."""
    given = any(isinstance(getattr(item, "element_length", None), float) for item in case.string)
    return "or auto" if given else f"or mesh: {{refinement: {2 * case.mesh.refinement:g}}}"


def choose_lengths(
    case: Case,
    well: Well | None,
    sections: dict[int, dict[str, float]],
    marks: dict[int, list[float]],
    given: dict[int, list[float]],
    motion: tuple[float, float] | None = None,
) -> ElementLengths:
    """Choose the automatic elements of ``case``.

    sections: section values of each flexible item (``StringMesh`` units); by number of the item, as below.
    marks: depths [m] where an item with automatic lengths must have nodes, its ends included.
    given: depths [m] of the element ends of items that name their length.
    motion: axial speed [m/s, down positive] and rotation [rad/s] of a static problem, None: the motion of the case.
    """
    if case.hold_string:  # no beam: lengths matter for the mud only
        edges = {i: _uniform(m, LONGEST / case.mesh.refinement) for i, m in marks.items()}
        return ElementLengths(edges)
    places = sorted({depth for depths in marks.values() for depth in depths})
    forces = estimate_forces(case, well, sections, motion, places)
    asked = _Asked(case, forces, sections, given)
    factor, lengths = 1.0, asked.field(1.0)
    limit = MOST_ELEMENTS * max(case.mesh.refinement, 1.0)
    if lengths.count() > limit:
        low, high = 1.0, 1e6
        while asked.field(high).count() > limit and high < 1e60:  # of a beam without stiffness, say
            low, high = high, 1e6 * high
        for _ in range(30):
            factor = float(np.sqrt(low * high))
            low, high = (factor, high) if asked.field(factor).count() > limit else (low, factor)
        factor, lengths = high, asked.field(high)
    edges = _graded(asked, lengths, marks, given)
    return ElementLengths(edges, _ranges(edges, lengths), factor)


def free_length(bending: float, clearance: float, side: float) -> float:
    """Length [m] over which a string hangs between a support and the wall (manual: eq-mesh-layer).

    bending: EI [N m2]; clearance: [m]; side: load across the string [N/m].  Infinite without a side load or a wall.
    """
    if not (np.isfinite(clearance) and side > 0):
        return np.inf
    return float((72 * bending * clearance / side) ** 0.25)


def step_moment(bending: FloatArray, height: float | FloatArray, side: FloatArray) -> FloatArray:
    """Bending moment [N m] of a string that comes down from a step on the wall (manual: eq-mesh-step).

    bending: EI [N m2]; height: of the step [m]; side: load across the string [N/m].  A beam clamped on the step that
    reaches the wall without slope and moment: height = w L^4/(72 EI), moment w L^2/6.
    """
    return np.asarray(np.sqrt(2 * bending * height * side))


# ---------------------------------------------------------------------- demands
class _Asked:
    """Longest element that each piece and each place of the string may have, with reasons.

    The coordinate x [m] is the measured depth without the rigid items.
    """

    def __init__(
        self,
        case: Case,
        forces: StringForces,
        sections: dict[int, dict[str, float]],
        given: dict[int, list[float]],
    ) -> None:
        self.case, self.forces, self.units = case, forces, case.shown_units
        self.texts = [f"longest automatic element, {shown(LONGEST, 'length', self.units, 3)}"]
        flexible = np.isin(forces.item, list(sections))
        self.x = np.concatenate([[0.0], np.cumsum(np.where(flexible, np.diff(forces.md), 0.0))])
        self.flexible, n = flexible, len(flexible)
        self.in_pieces = np.where(flexible, LONGEST, np.inf)
        self.why = np.zeros(n, dtype=int)
        self.at_nodes, self.why_at = np.full(n + 1, np.inf), np.zeros(n + 1, dtype=int)
        stand_in = next(iter(sections.values()))
        rows = [sections.get(int(i), stand_in) for i in forces.item]
        self.bending = np.array([row["bending_stiffness"] for row in rows])
        self.outer = np.array([row["outer_diameter"] for row in rows])
        self._buckles()
        self._curvatures()
        self._waves(rows)
        self._own_weight(rows)
        self._span()
        self._supports()
        self._loads_and_joints()
        young = self._young(rows)
        self._sharp_bends(young)
        self._steps(young)
        for number, edges in given.items():
            self._given(number, edges)

    # -------------------------------------------------------------- pieces
    def _pieces(self, length: FloatArray, text: Callable[[int], str]) -> None:
        """Demand ``length`` (n,) [m] in the pieces; ``text`` gives the reason of a piece by its number."""
        shorter = self.flexible & (length < self.in_pieces)
        known: dict[str, int] = {}
        for k in np.flatnonzero(shorter):
            reason = text(int(k))
            if reason not in known:
                known[reason] = len(self.texts)
                self.texts.append(reason)
            self.why[k] = known[reason]
        self.in_pieces = np.where(shorter, length, self.in_pieces)

    def _buckles(self) -> None:
        f = self.forces
        walled = np.isfinite(f.clearance)
        with np.errstate(divide="ignore", invalid="ignore"):
            wall = np.where(
                walled, 2 * np.sqrt(self.bending * f.side / np.where(walled, f.clearance, 1.0)), 0.0
            )
            load = np.maximum(wall, VERTICAL * np.cbrt(self.bending * f.weight**2) * walled)
            wave = np.sqrt(self.bending / np.maximum(f.push, 1e-9))  # of a free column [m/rad]
            length = np.where(walled, WAVE_STEP * np.sqrt(2.0), FREE_STEP) * wave
        coils = walled & (f.push > HELIX * load)
        length = np.where(f.push > NEAR_BUCKLING * load, length, np.inf)

        def text(k: int) -> str:
            if not walled[k]:
                return "a column under a push"
            return "expected helix" if coils[k] else "push near or above the buckling load"

        self._pieces(length, text)

    def _curvatures(self) -> None:
        hole = self.forces.curvature
        with np.errstate(divide="ignore"):
            self._pieces(LARGEST_TURN / hole, lambda k: "curvature of the hole")
            pipe = np.array([getattr(self.case.string[int(i)], "curvature", 0.0) for i in self.forces.item])
            self._pieces(LARGEST_STRESS_FREE_TURN / pipe, lambda k: "residual curvature of the pipe")

    def _waves(self, rows: list[dict[str, float]]) -> None:
        asked, case = self.case.mesh.frequency, self.case
        if asked is None and (case.time is None or case.time.mode != "dynamic"):
            return
        omega = 2 * np.pi * asked if asked is not None else largest(case.top.rotation)
        if not omega:
            return
        f = self.forces
        tension = np.maximum(f.least, -2 * np.sqrt(self.bending * f.mass) * omega)
        # the root of EI k^4 + T k^2 = m omega^2, in the form that does not cancel under a large tension
        square = (
            2 * f.mass * omega**2 / (np.sqrt(tension**2 + 4 * self.bending * f.mass * omega**2) + tension)
        )
        name = "highest frequency requested" if asked is not None else "bending waves at the rotation speed"
        self._pieces(VIBRATION_STEP / np.sqrt(square), lambda k: name)
        if asked is not None:
            speed = [
                min(
                    (r["torsional_stiffness"] / r["polar_inertia"]) ** 0.5,
                    (r["axial_stiffness"] / r["mass"]) ** 0.5,
                )
                for r in rows
            ]
            self._pieces(VIBRATION_STEP * np.array(speed) / omega, lambda k: name)

    def _own_weight(self, rows: list[dict[str, float]]) -> None:
        g = float(np.linalg.norm(self.case.gravity))
        mass = np.array([row["mass"] for row in rows])
        with np.errstate(divide="ignore"):
            self._pieces(
                WEIGHT_SHARE * np.cbrt(240 * self.bending / (mass * g)), lambda k: "own weight of an element"
            )

    def _span(self) -> None:
        if self.case.well is None or self.case.contact is None:
            whole = np.full(len(self.bending), self.x[-1] / FEWEST)
            self._pieces(whole, lambda k: f"{FEWEST} elements at least in a string without a wall")

    def _given(self, number: int, edges: list[float]) -> None:
        """Elements of an item that names their length: the neighbours are graded to them."""
        here = np.flatnonzero(self.forces.item == number)
        if not len(here):
            return
        size, name = np.diff(edges), self.case.string[number].name
        self.texts.append(f"graded from the elements given for {name}")
        self.in_pieces[here] = np.inf
        self.at_nodes[here[0] + 1 : here[-1] + 1] = np.inf
        for node, length in ((here[0], size[0]), (here[-1] + 1, size[-1])):
            self._place(int(node), float(length), len(self.texts) - 1)

    # -------------------------------------------------------------- places
    def _place(self, node: int, length: float, why: int) -> None:
        if length < self.at_nodes[node]:
            self.at_nodes[node], self.why_at[node] = length, why

    def _beside(self, node: int, distance: float, name: str, height: float | None = None) -> None:
        """Demand short elements beside a support at ``node``, ``distance`` [m] from the next one on either side.

        height: of a step on the wall that the string comes down from [m], None: from the middle of the hole.
        """
        f = self.forces
        for k in (node - 1, node):
            if not 0 <= k < len(self.flexible) or not self.flexible[k]:
                continue
            layer = np.sqrt(self.bending[k] / max(f.pull[k], f.push[k], 1e-9))
            drop = float(f.clearance[k]) if height is None else height
            free = min(distance, free_length(self.bending[k], drop, float(f.side[k])))
            share = SPAN_SHARE if height is None else STEP_SHARE
            length = max(min(LAYER_SHARE * layer, share * free), self.outer[k] or 1e-4 * self.x[-1])
            if length < LONGEST:
                what = (
                    f"bending layer of {shown(float(layer), 'length', self.units, 2)}"
                    if LAYER_SHARE * layer < share * free
                    else f"free length of {shown(float(free), 'length', self.units, 2)}"
                )
                self.texts.append(f"beside {name}: {what}")
                self._place(node, float(length), len(self.texts) - 1)

    def _supports(self) -> None:
        """Ends and rigid items that hold or touch."""
        case, md = self.case, self.forces.md
        supports: list[tuple[float, float, str]] = []  # upper and lower end of a support [m], its name
        if case.top.kind != "free":
            supports.append((0.0, 0.0, "the top"))
        for item, (top, bottom) in zip(case.string, case.item_depths, strict=True):
            if isinstance(item, Rigid) and (item.od is not None and case.contact is not None):
                if supports and abs(supports[-1][1] - top) < 1e-6:
                    before = supports.pop()
                    supports.append((before[0], bottom, item.name if before[2] == "the top" else before[2]))
                else:
                    supports.append((top, bottom, item.name))
        if case.bottom.kind in ("clamped", "pinned", "bit"):
            if supports and abs(supports[-1][1] - case.string_length) < 1e-6:
                pass
            else:
                supports.append((case.string_length, case.string_length, "the lower end"))
        for number, (upper, lower, name) in enumerate(supports):
            above = upper - (supports[number - 1][1] if number else 0.0)
            below = (supports[number + 1][0] if number + 1 < len(supports) else float(md[-1])) - lower
            for place, distance in ((upper, above), (lower, below)):
                if distance > 1e-6:
                    self._beside(int(np.argmin(np.abs(md - place))), distance, name)

    def _loads_and_joints(self) -> None:
        md = self.forces.md
        places = [(load.at, "a point load") for load in self.case.loads if isinstance(load, PointLoad)]
        places += [(joint.at, "a joint") for joint in self.case.all_joints]
        places += [(depth, "a steerable tool") for depth in self.case.steering_depths.values()]
        for at, name in places:
            if 0 < at < md[-1]:
                self._beside(int(np.argmin(np.abs(md - at))), np.inf, name)

    def _young(self, rows: list[dict[str, float]]) -> FloatArray:
        """Young's modulus [Pa] of each piece."""
        area = [np.pi / 64 * (r["outer_diameter"] ** 4 - r["inner_diameter"] ** 4) for r in rows]
        return self.bending / np.maximum(area, 1e-12)

    def _sharp_bends(self, young: FloatArray) -> None:
        """Places where the hole's curvature jumps, by the bending stress that follows the jump."""
        stress = np.zeros(len(self.at_nodes))
        stress[1:] = 0.5 * self.outer * young * self.forces.change[1:]
        size, _, unit = display_unit("length", self.units)
        for node in np.flatnonzero(stress > SHARP_BEND):
            depth = float(self.forces.md[node]) + self.forces.top
            if np.isfinite(self.forces.clearance[min(node, len(self.bending) - 1)]):
                self._beside(
                    int(node), np.inf, f"a jump of the hole's curvature at MD {depth / size:.0f} {unit}"
                )

    def _steps(self, young: FloatArray) -> None:
        """Places where the clearance steps, by the bending stress that follows the step."""
        f, size = self.forces, display_unit("length", self.units)
        both = (
            self.flexible[1:]
            & self.flexible[:-1]
            & np.isfinite(f.clearance[1:])
            & np.isfinite(f.clearance[:-1])
        )
        height = np.where(both, np.abs(np.diff(np.where(np.isfinite(f.clearance), f.clearance, 0.0))), 0.0)
        for k in np.flatnonzero(height > LEAST_STEP):
            pair, a = slice(k, k + 2), float(height[k])
            moment = step_moment(self.bending[pair], a, f.side[pair])
            stress = 0.5 * self.outer[pair] * young[pair] / self.bending[pair] * moment
            if np.max(stress) > STEP_STRESS and not self._bridges(int(k), a):
                where = f"a step of {shown(a, 'diameter', self.units, 2)} on the wall"
                self._beside(
                    int(k) + 1, np.inf, f"{where} at MD {(f.md[k + 1] + f.top) / size[0]:.0f} {size[2]}", a
                )

    def _bridges(self, k: int, height: float) -> bool:
        """Whether the wider hole beside the step between pieces ``k`` and ``k`` + 1 ends before the string reaches its wall.

        height: of the step [m].
        """
        f = self.forces
        down = f.clearance[k + 1] > f.clearance[k]  # the wider hole is below
        wide, narrow, way = (k + 1, k, 1) if down else (k, k + 1, -1)
        free = free_length(self.bending[wide], height, float(f.side[wide]))
        middle, length, i = f.clearance[narrow] + 0.5 * height, 0.0, wide
        while 0 <= i < len(f.clearance) and f.clearance[i] > middle and length < free:
            length += f.md[i + 1] - f.md[i]
            i += way
        return bool(length < free)

    # -------------------------------------------------------------- field
    def field(self, factor: float) -> _Lengths:
        """Field of element lengths with all demands ``factor`` times as long."""
        refinement = self.case.mesh.refinement
        scale, growth = factor / refinement, min(GROWTH / refinement, LARGEST_GROWTH)
        return _Lengths(self, scale * self.in_pieces, scale * self.at_nodes, growth)


class _Lengths:
    """Element length along the string, growing by ``growth`` at most from every demand."""

    def __init__(self, asked: _Asked, pieces: FloatArray, nodes: FloatArray, growth: float) -> None:
        self.asked, self.pieces, self.growth = asked, pieces, growth
        self.x, self.md = asked.x, asked.forces.md
        beside = np.full((2, len(nodes)), np.inf)
        beside[0, 1:], beside[1, :-1] = pieces, pieces
        own = np.concatenate([nodes[None], beside])
        which = np.argmin(own, axis=0)
        value = own.min(axis=0)
        above, below = np.append(0, asked.why), np.append(asked.why, 0)
        reason = np.choose(which, [asked.why_at, above, below])
        self.value, self.reason = _spread(value, reason, self.x, growth)

    def lower(self, at: FloatArray, length: FloatArray) -> None:
        """Add demands ``length`` (k,) [m] at the coordinates ``at`` (k,) [m], on the nodes beside them."""
        above = np.clip(np.searchsorted(self.x, at + 1e-9, side="right") - 1, 0, len(self.x) - 1)
        below = np.clip(np.searchsorted(self.x, at - 1e-9), 0, len(self.x) - 1)
        value = self.value.copy()
        for node in (above, below):
            np.minimum.at(value, node, length + self.growth * np.abs(self.x[node] - at))
        self.value, self.reason = _spread(value, self.reason, self.x, self.growth)

    def count(self) -> float:
        """Number of automatic elements."""
        x, h = self.samples(most=100.0)
        return float(np.sum(np.diff(x) * 0.5 * (1 / h[1:] + 1 / h[:-1])))

    def samples(self, most: float = 1e5) -> tuple[FloatArray, FloatArray]:
        """Coordinates (k,) [m], dense against the lengths (k,) [m] there; ``most`` of them in a piece."""
        delta = np.diff(self.x)
        least = np.minimum(self.value[1:], self.value[:-1])
        parts = np.where(
            delta > 0, np.ceil(np.minimum(6 * delta / np.where(np.isfinite(least), least, LONGEST), most)), 0
        )
        parts = np.maximum(parts, 1).astype(int)
        piece = np.repeat(np.arange(len(delta)), parts)
        start = np.cumsum(parts) - parts
        along = (np.arange(len(piece)) - start[piece]) / parts[piece] * delta[piece]
        h = self.at(piece, along)
        return np.append(self.x[piece] + along, self.x[-1]), np.append(h, self.value[-1])

    def at(self, piece: np.ndarray, along: FloatArray) -> FloatArray:
        """Lengths (k,) [m] at ``along`` (k,) [m] below the upper ends of the pieces (k,)."""
        delta = np.diff(self.x)[piece]
        left, right = (
            self.value[:-1][piece] + self.growth * along,
            self.value[1:][piece] + self.growth * (delta - along),
        )
        return np.asarray(np.minimum(np.minimum(left, right), self.pieces[piece]))

    def reasons_at(self, md: FloatArray) -> np.ndarray:
        """Numbers (k,) of the texts on what decides the length at measured depths ``md`` (k,) [m]."""
        k = np.clip(np.searchsorted(self.md, md, side="right") - 1, 0, len(self.pieces) - 1)
        above, below = md - self.md[k], self.md[k + 1] - md
        own = np.array(
            [self.pieces[k], self.value[k] + self.growth * above, self.value[k + 1] + self.growth * below]
        )
        return np.choose(np.argmin(own, axis=0), [self.asked.why[k], self.reason[k], self.reason[k + 1]])


def _spread(
    value: FloatArray, reason: np.ndarray, x: FloatArray, growth: float
) -> tuple[FloatArray, np.ndarray]:
    """Lower ``value`` (n,) so that it grows by ``growth`` at most along ``x`` (n,); the reasons follow."""
    for _ in range(2):  # downward, then upward
        level = value - growth * x
        source = np.maximum.accumulate(np.where(level <= np.minimum.accumulate(level), np.arange(len(x)), 0))
        value, reason = level[source] + growth * x, reason[source]
        value, reason, x = value[::-1], reason[::-1], -x[::-1]
    return value, reason


# ---------------------------------------------------------------------- elements
def _uniform(marks: list[float], length: float) -> list[float]:
    """Ends of equal elements of at most about ``length`` [m] between the marks."""
    edges = [marks[0]]
    for a, b in zip(marks, marks[1:], strict=False):
        edges += np.linspace(a, b, max(1, round((b - a) / length)) + 1)[1:].tolist()
    return edges


def _graded(
    asked: _Asked,
    lengths: _Lengths,
    marks: dict[int, list[float]],
    given: dict[int, list[float]],
) -> dict[int, list[float]]:
    """Element ends of the automatic items: equal steps of the integral of 1/length between the marks.

    Lengths are made shorter until neighbours differ by ``LARGEST_RATIO`` at most.
    """
    edges: dict[int, list[float]] = {}
    for _ in range(50):
        edges = _edges(asked, lengths, marks)
        x, size, automatic = _chain(asked, edges, given)
        ratio = size[1:] / size[:-1]
        long_below = (ratio > LARGEST_RATIO * (1 + 1e-9)) & automatic[1:]
        long_above = (ratio < (1 - 1e-9) / LARGEST_RATIO) & automatic[:-1]
        if not (long_below.any() or long_above.any()):
            break
        shorter = np.minimum(size[1:], size[:-1])
        bad = long_below | long_above
        lengths.lower(x[bad], np.asarray(shorter[bad]))
    return edges


def _edges(asked: _Asked, lengths: _Lengths, marks: dict[int, list[float]]) -> dict[int, list[float]]:
    x, h = lengths.samples()
    total = np.concatenate([[0.0], np.cumsum(np.diff(x) * 0.5 * (1 / h[1:] + 1 / h[:-1]))])
    depth, coordinate = asked.forces.md, asked.x
    out: dict[int, list[float]] = {}
    for number, places in marks.items():
        top = coordinate[np.searchsorted(depth, places[0] + 1e-7) - 1] if places[0] > 0 else 0.0
        here, edges = np.array(places) - places[0] + top, [places[0]]
        for a, b, upper, lower in zip(here, here[1:], places, places[1:], strict=False):
            first, last = np.interp([a, b], x, total)
            count = max(1, int(np.ceil(last - first - 1e-6)))
            inner = np.interp(first + (last - first) * np.arange(1, count) / count, total, x)
            even = np.linspace(upper, lower, count + 1)[1:-1]
            inner = inner - a + upper
            edges += (even if np.allclose(inner, even, atol=1e-6 * (b - a)) else inner).tolist() + [lower]
        out[number] = edges
    return out


def _chain(
    asked: _Asked, edges: dict[int, list[float]], given: dict[int, list[float]]
) -> tuple[FloatArray, FloatArray, np.ndarray]:
    """Coordinates (n-1,) [m] of the nodes between elements, lengths (n,) [m] and whether they are automatic (n,)."""
    size: list[float] = []
    automatic: list[bool] = []
    for number in sorted({**edges, **given}):
        new = np.diff(edges[number] if number in edges else given[number]).tolist()
        size += new
        automatic += [number in edges] * len(new)
    sizes = np.array(size)
    return np.cumsum(sizes)[:-1], sizes, np.array(automatic, dtype=bool)


def _ranges(edges: dict[int, list[float]], lengths: _Lengths) -> tuple[LengthRange, ...]:
    """Group the elements of each item by what decided their length."""
    out: list[LengthRange] = []
    for number in sorted(edges):
        ends = np.array(edges[number])
        size, why = np.diff(ends), lengths.reasons_at(0.5 * (ends[1:] + ends[:-1]))
        texts = np.array(lengths.asked.texts, dtype=object)[why]
        first = np.flatnonzero(np.concatenate([[True], texts[1:] != texts[:-1]]))
        for a, b in zip(first, np.append(first[1:], len(size)), strict=True):
            shortest, longest = float(size[a:b].min()), float(size[a:b].max())
            out.append(
                LengthRange(
                    number, float(ends[a]), float(ends[b]), shortest, longest, int(b - a), str(texts[a])
                )
            )
    return tuple(out)
