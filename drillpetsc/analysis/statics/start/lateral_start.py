"""Start of statics of a pushed string: its lateral equilibrium under the push of the march.

Manual: sec-statics-lateral-start.  Buckled strings need it: `x22-helix.yaml`, `jar-stuck.yaml`, `agitator-slide.yaml`, a dry vertical
well of 12 km, pipe that is lowered or hoisted with more weight on its bit than it carries straight.  The relaxation alone finds most
of these states, too, with 5 to 100 times the factorisations.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from drillpetsc.analysis.statics.imperfection import item_imperfection, nodal_weight
from drillpetsc.analysis.statics.start.march import (
    March,
    moved_along,
    stands,
    with_contact,
)
from drillpetsc.arrays import FloatArray
from drillpetsc.fem.quadrature import exposed_ends, rule
from drillpetsc.fem.string_mesh import RigidItem, StringJoint
from drillpetsc.geometry.frames import directors
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output.static_table import at_nodes
from drillpetsc.physics.contact import ONSET
from drillpetsc.solvers.static.lateral_beam import (
    ContactPoints,
    Elements,
    LateralBeam,
    LateralState,
    element_matrices,
    lateral_state,
)
from drillpetsc.solvers.static.lateral_loads import lateral_shares
from drillpetsc.solvers.static.search_limit import SearchLimit

SPACING = 3.0  # of independent side loads, the same on all meshes [m]
LYING_SHARE = 0.01  # of the push: a side load on the string above the buckle that holds it on the wall
GROWTH, LONGEST = 1.3, 60.0  # of the elements above the buckle: ratio of neighbours, length [m]
MARGIN = 6.0  # of (EI/w)^(1/3) above the uppermost push, over which a buckle dies out
ROUGH_SHARE = 0.25  # length of rough elements over the pitch of a helix
REFINEMENT = 4.0  # ratio of the lengths of rough elements from one round to the next
BIT_DEPTH = 1e-4  # of a bit in the side of its hole, where the law of Hertz has the force of its spring [m]
NO_LENGTH = 1e-9  # of an element that is a joint [m]
MAX_ROUNDS = 10  # of lateral equilibrium and tension
SETTLED_PUSH = 1e-3  # change of the tension, over the largest push, with which the rounds end


@dataclass(frozen=True)
class LateralStart:
    """A start of statics.

    march: with the places of the lateral equilibrium.
    side_loads: standard deviation (n_nodes,) of the loads that lead the string off a saddle, and stay [N]; None: it does
    not buckle.
    """

    march: March
    side_loads: FloatArray | None


def lateral_start(
    model: DrillingModel,
    found: March | None,
    motion: tuple[float, float],
    coiled: March | None,
    limit: SearchLimit,
) -> LateralStart | None:
    """Find the start of a pushed string under the tension of the march ``found``, which does not coil.

    motion: axial velocity [m/s, down positive] and rotation [rad/s] that friction opposes.
    coiled: the march of a string that may coil, whose friction is the first estimate if the string slides.
    limit: of the work of the search.
    Returns None if nothing pushes the string, or no stable state is found.  The same on all ranks.
    """
    mesh, fraction = model.mesh, model.case.initial.imperfection
    if found is None or model.contact is None or model.contact.law.law == "hertz_point" or not fraction:
        return None
    # the elements of the lateral problem are rigid or hinged in both directions alike
    if any(_ties_slope(joint) is None for joint in mesh.joints):
        return None
    if coiled is not None and (motion[0] or stands(model)):
        push = -float(coiled.axial_force[-1]) if stands(model) else None
        found = with_contact(model, found, motion, coiled.contact_force, push)
    loads, last = _side_loads(model, found), None
    least = _rough_length(model, found)
    for _ in range(MAX_ROUNDS):
        buckling = _first_node(model, found)
        if buckling is None:
            return None
        frame = _directors(model, found)
        # on short elements the boundary of a contact moves by an element in a step, and contacts that open and close hold up a
        # buckle that moves along the hole: wells of 12 km need half as long
        parts = _Parts(model, found, buckling, least)
        beam = _beam(model, found, parts, frame)
        beam.limit = limit
        state = _solved(model, found, beam, parts, frame, loads, last)
        if state is None:
            return None
        last = state.disturbed, *parts.spread(state.place)
        least = least / REFINEMENT if REFINEMENT * len(parts.nodes) < mesh.nodes else 0.0
        before, found = found, with_contact(model, found, motion, parts.contact(beam, state.place, found))
        change = np.abs(found.axial_force - before.axial_force).max()
        if not parts.rough and change <= SETTLED_PUSH * -found.axial_force.min():
            break
    assert last is not None  # MAX_ROUNDS is at least 1
    disturbed, across, slope = last
    return LateralStart(_placed(model, found, parts.nodes[0], across, slope), loads if disturbed else None)


def _directors(model: DrillingModel, found: March) -> tuple[FloatArray, FloatArray]:
    """Both directors (n_nodes, 3) at zero spin across the hole where the string lies."""
    nodes = model.mesh.nodes
    return directors(model.frames, np.arange(nodes), found.direction, np.zeros(nodes))


def _ties_slope(joint: StringJoint) -> bool | None:
    """Whether a joint holds both directions of the bending; None: one of them."""
    if joint.kind == "universal":
        return False
    along = joint.kind == "revolute" and abs(joint.axes[0][0]) > 1 - 1e-9  # a motor's
    return True if along or joint.kind != "revolute" else None


def _rough_length(model: DrillingModel, found: March) -> float:
    """Length [m] of elements that show a buckle: a share of the pitch 2 pi sqrt(2 EI/F) under the largest push F."""
    pipe = ~model.mesh.is_joint
    push = np.maximum(-found.effective_tension[pipe], 1e-9)
    return ROUGH_SHARE * 2 * np.pi * float(np.sqrt(np.min(2 * model.mesh.bending_stiffness[pipe] / push)))


def _beam(
    model: DrillingModel,
    found: March,
    parts: _Parts,
    frame: tuple[FloatArray, FloatArray],
) -> LateralBeam:
    """The lateral problem of ``parts`` under the tension of ``found``."""
    mesh, t, (second, third) = model.mesh, found.direction, frame
    load = np.zeros((mesh.nodes, 4))
    load[:, 0] = np.sum(found.load_across * second, axis=1)
    load[:, 1] = np.sum(found.load_across * third, axis=1)
    _add_moments_of_weight(model, found, second, third, load)
    _add_curvature(model, found, t, second, third, load)
    points = parts.contact_points(found.position - found.offset, t, second, third)
    held = np.zeros((len(parts.nodes), 4), dtype=bool)
    held[0] = True
    if found.top_on_wall:
        held[0, :2] = False  # its place is part of the equilibrium
    bending, force = (parts.mean(q) for q in (mesh.bending_stiffness, found.effective_tension))
    clearance = _clearance(model, found)[parts.nodes]
    hinged = [j.cell for j in mesh.joints if not _ties_slope(j)]
    elements = Elements(parts.length, bending, force, parts.rigid, hinged=np.isin(parts.nodes[:-1], hinged))
    return LateralBeam(elements, parts.gathered(load), points, _wall(model), held, clearance)


def _solved(
    model: DrillingModel,
    found: March,
    beam: LateralBeam,
    parts: _Parts,
    frame: tuple[FloatArray, FloatArray],
    loads: FloatArray,
    last: tuple[bool, FloatArray, FloatArray] | None,
) -> LateralState | None:
    """State of ``beam`` from the string as it lies, or from the ``last`` one: disturbed, displacements and slopes."""
    start = np.zeros((len(parts.nodes), 4))
    disturbance = np.zeros((model.mesh.nodes, 4))
    disturbance[:, :2] = loads[:, None] * lateral_shares(model.mesh.node_depth, spacing=SPACING)
    if last is None:
        start[:, 0], start[:, 1] = (np.sum(found.offset * e, axis=1)[parts.nodes] for e in frame)
    else:
        start = np.concatenate(last[1:], axis=1)[parts.nodes]
    if not found.top_on_wall and model.top.prescribes and parts.nodes[0] == 0:
        start[0] = 0.0
    return lateral_state(beam, start, parts.gathered(disturbance), last is not None and last[0])


class _Parts:
    """Elements of the lateral problem: those of the model from node ``buckling`` on, longer ones above it.

    Above it they reach up to where the string lies on the wall, or to its top: a string that hangs free passes a side
    force over kilometres.  Elements of the model are merged up to the length ``least`` [m]; rough: some are.
    """

    def __init__(self, model: DrillingModel, found: March, buckling: int, least: float = 0.0):
        mesh, depth = model.mesh, model.mesh.node_depth
        self.model, self.md = model, found.measured_depth
        lying = np.cumsum(np.linalg.norm(found.side_load, axis=1)[:buckling][::-1])
        share = LYING_SHARE * float(-found.effective_tension.min())
        free = not (len(lying) and lying[-1] > share)
        joints = np.flatnonzero(mesh.is_joint)
        # where stiffness, load or slope jumps, an element has to end
        marks = {b.node for b in mesh.bodies} | set(joints) | set(joints + 1)
        self.rough = bool((2 * mesh.length[buckling:] <= least)[~mesh.is_joint[buckling:]].any())
        nodes, length = [mesh.nodes - 1], least
        while nodes[-1] > 0:
            at = nodes[-1]
            if at <= buckling and free:
                length = min(GROWTH * max(length, float(mesh.length[at - 1])), LONGEST)
            k = at - 1
            while k > 0 and depth[at] - depth[k - 1] <= length and k not in marks and k != buckling:
                k -= 1
            nodes.append(k)
        self._number(np.array(nodes[::-1], dtype=int))

    def _number(self, nodes: np.ndarray) -> None:
        mesh, depth = self.model.mesh, self.model.mesh.node_depth
        self.nodes = nodes
        self.rigid = np.array(
            [mesh.rigid_above[a:b].sum() for a, b in zip(self.nodes[:-1], self.nodes[1:], strict=True)]
        )
        self.length = np.diff(depth[self.nodes]) - self.rigid

    def mean(self, values: FloatArray) -> FloatArray:
        """Means (n,) over the length of the elements of the model's elements (m,)."""
        h = self.model.mesh.length
        return np.add.reduceat(values * h, self.nodes[:-1]) / np.maximum(
            np.add.reduceat(h, self.nodes[:-1]), NO_LENGTH
        )

    def _shape(self, cell: np.ndarray, depth: FloatArray) -> FloatArray:
        """Factors (m, 4) of the displacements and slopes at the ends of elements ``cell`` (m,), at ``depth`` (m,) [m]."""
        L = np.maximum(self.length[cell], NO_LENGTH)
        x = 1 - (self.model.mesh.node_depth[self.nodes[cell + 1]] - depth) / L
        N = np.column_stack(
            [1 - 3 * x**2 + 2 * x**3, L * (x - 2 * x**2 + x**3), 3 * x**2 - 2 * x**3, L * (x**3 - x**2)]
        )
        N[:, 1] += N[:, 0] * self.rigid[cell]
        return N

    def _cells(self) -> tuple[np.ndarray, FloatArray]:
        """Element (m,) of each node of the model from the first on, and its factors (m, 4)."""
        node = np.arange(self.nodes[0], self.model.mesh.nodes)
        cell = np.clip(np.searchsorted(self.nodes, node, side="right") - 1, 0, len(self.length) - 1)
        N = self._shape(cell, self.model.mesh.node_depth[node])
        same = self.nodes[cell] == node
        N[same] = [1.0, 0.0, 0.0, 0.0]
        return cell, N

    def gathered(self, load: FloatArray) -> FloatArray:
        """Loads (n+1, 4) on the elements' ends that do the work of those of the model's nodes (n_nodes, 4).

        Moments between the ends are left out.
        """
        cell, N = self._cells()
        own = load[self.nodes[0] :]
        out = np.zeros((len(self.nodes), 4))
        for p in range(2):
            np.add.at(out[:, p], cell, N[:, 0] * own[:, p])
            np.add.at(out[:, 2 + p], cell, N[:, 1] * own[:, p])
            np.add.at(out[:, p], cell + 1, N[:, 2] * own[:, p])
            np.add.at(out[:, 2 + p], cell + 1, N[:, 3] * own[:, p])
        out[:, 2:] += load[self.nodes, 2:]
        return out

    def spread(self, U: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Displacements and slopes (n_nodes, 2) each of the model's nodes; 0 above the first."""
        cell, N = self._cells()
        first, nodes = self.nodes[0], self.model.mesh.nodes
        across, slope = np.zeros((nodes, 2)), np.zeros((nodes, 2))
        across[first:] = (
            N[:, :1] * U[cell, :2]
            + N[:, 1:2] * U[cell, 2:]
            + N[:, 2:3] * U[cell + 1, :2]
            + N[:, 3:] * U[cell + 1, 2:]
        )
        L = np.maximum(self.length[cell], NO_LENGTH)
        x = 1 - (self.model.mesh.node_depth[self.nodes[cell + 1]] - self.model.mesh.node_depth[first:]) / L
        a = U[cell, :2] + self.rigid[cell][:, None] * U[cell, 2:]
        slope[first:] = (
            (6 * x * (1 - x) / L)[:, None] * (U[cell + 1, :2] - a)
            + ((1 - x) * (1 - 3 * x))[:, None] * U[cell, 2:]
            - (x * (2 - 3 * x))[:, None] * U[cell + 1, 2:]
        )
        across[self.nodes], slope[self.nodes] = U[:, :2], U[:, 2:]
        return across, slope

    def contact(self, beam: LateralBeam, U: FloatArray, found: March) -> FloatArray:
        """Contact force (n_nodes,) [N] of the state ``U``; that of ``found`` above the first node."""
        depth, nodes = self.model.mesh.node_depth, self.model.mesh.nodes
        out = found.contact_force.copy()
        out[self.nodes[0] :] = 0.0
        node = np.clip(np.searchsorted(depth, beam.points.at, side="right") - 1, 0, nodes - 2)
        share = np.clip((beam.points.at - depth[node]) / np.maximum(np.diff(depth)[node], 1e-9), 0.0, 1.0)
        force = beam.contact_force(U)
        return (
            out + np.bincount(node, (1 - share) * force, nodes) + np.bincount(node + 1, share * force, nodes)
        )

    def contact_points(
        self,
        centre: FloatArray,
        t: FloatArray,
        second: FloatArray,
        third: FloatArray,
    ) -> ContactPoints:
        """The points of the model's own quadrature where the string may touch the wall.

        centre, t, second, third: (n_nodes, 3) axis of the hole at the nodes, its tangent and the directors.
        """
        model = self.model
        mesh, contact = model.mesh, model.contact
        assert contact is not None
        well, law, md = contact.well, contact.law, self.md
        upper, lower = exposed_ends(mesh, contact.free_top)
        upper, lower = upper[self.nodes[:-1]], lower[self.nodes[1:] - 1]
        radius = 0.5 * np.append(mesh.contact_diameter, mesh.contact_diameter[-1])

        def across(d: FloatArray, node: np.ndarray) -> FloatArray:
            return np.column_stack([np.sum(d * e[node], axis=1) for e in (second, third)])

        columns: list[tuple] = []
        for ends in ((False, False), (False, True), (True, False), (True, True)):
            e = np.flatnonzero(
                (upper == ends[0])
                & (lower == ends[1])
                & (radius[self.nodes[:-1]] > 0)
                & (self.length > NO_LENGTH)
            )
            for x, weight in rule(law.points, *ends) if len(e) else ():
                depth = mesh.node_depth[self.nodes[e + 1]] - (1 - x) * self.length[e]
                below, L = md[self.nodes[e + 1]], np.diff(md[self.nodes])[e] - self.rigid[e]
                at = below - (1 - x) * L
                gap = np.maximum(np.asarray(well.radius(at)) - radius[self.nodes[e]], 0.0)
                # an element does not follow the hole where its curvature changes
                a, b = self.nodes[e], self.nodes[e + 1]
                ends_at = (
                    (1 + 2 * x) * (1 - x) ** 2 * (centre[a] + self.rigid[e][:, None] * t[a])
                    + x**2 * (3 - 2 * x) * centre[b]
                    + L[:, None] * (x * (1 - x) ** 2 * t[a] - x**2 * (1 - x) * t[b])
                )
                off = across(ends_at - np.asarray(well.at(at)[0]), a)
                wall = weight * self.length[e] * contact.hardness[0][a]
                columns.append((e, self._shape(e, depth), gap, wall, off, depth))
        for b, hardness in zip(mesh.bodies, contact.hardness[1], strict=True):
            if b.radius <= 0 or b.node < self.nodes[0]:
                continue
            last, node = b.node == mesh.nodes - 1, np.array([b.node])
            cell = np.searchsorted(self.nodes, node) - last
            for y, length, clearance in _points_of_item(model, b, float(hardness)):
                factors = np.array([[0.0, 0.0, 1.0, y] if last else [1.0, y, 0.0, 0.0]])
                gap = np.maximum(np.asarray(well.radius(md[node] + y)) - b.radius, 0.0)
                if clearance is not None:
                    gap[:] = clearance
                off = across(centre[node] + y * t[node] - np.asarray(well.at(md[node] + y)[0]), node)
                at = mesh.node_depth[node] + y
                columns.append((cell, factors, gap, np.array([length]), off, at))
        return ContactPoints(*(np.concatenate(q) for q in zip(*columns, strict=True)))


def _points_of_item(
    model: DrillingModel, item: RigidItem, hardness: float
) -> list[tuple[float, float, float | None]]:
    """Points where a rigid item may touch the wall: distance below its node [m], length of wall [m], clearance [m].

    The clearance is None if the item has one of its own.  A bit that cuts touches the side of its hole at one point.
    """
    assert model.contact is not None
    law, side = model.contact.law, model.bit.side_contact if model.bit is not None else None
    if item.kind == "bit" and side is not None:
        per_length = law.stiffness * (1.0 if law.law == "linear" else np.sqrt(BIT_DEPTH))
        return [(side.below, side.stiffness / per_length, side.clearance)] if side.stiffness else []
    return [
        (item.contact_above + x * item.contact_length, weight * item.contact_span * hardness, None)
        for x, weight in rule(law.points, True, True)
    ]


def _side_loads(model: DrillingModel, found: March) -> FloatArray:
    """Standard deviation (n_nodes,) of the side loads [N] that lead a straight string off its saddle.

    Only on the pushed part: kilometres of pipe in tension would lie down on the wall under them.
    """
    fraction = model.case.initial.imperfection
    tension = at_nodes(found.effective_tension, found.effective_tension)
    pushed = tension < 0
    return np.where(pushed, fraction * item_imperfection(model, fraction) * nodal_weight(model), 0.0)


def _first_node(model: DrillingModel, found: March) -> int | None:
    """The node from which on the string may be buckled: some lengths above the uppermost push; None without a push."""
    mesh = model.mesh
    push = found.effective_tension < 0
    if not push.any():
        return None
    top = int(np.argmax(push))
    weight = nodal_weight(model).sum() / mesh.total_length
    reach = MARGIN * float(np.cbrt(mesh.bending_stiffness[~mesh.is_joint].max() / max(weight, 1e-3)))
    return int(np.searchsorted(mesh.node_depth, mesh.node_depth[top] - reach))


def _clearance(model: DrillingModel, found: March) -> FloatArray:
    """Radial clearance (n_nodes,) [m] of the thinner pipe at each node, not below zero."""
    mesh, well = model.mesh, model.well
    assert well is not None
    pipe = mesh.contact_diameter.copy()
    for cell in np.flatnonzero(mesh.is_joint):
        pipe[cell] = pipe[cell - 1] if cell else pipe[1]
    thin = np.append(pipe, pipe[-1])
    thin[1:-1] = np.minimum(pipe[1:], pipe[:-1])
    return np.maximum(np.asarray(well.radius(found.measured_depth)) - 0.5 * thin, 0.0)


def _add_curvature(
    model: DrillingModel,
    found: March,
    t: FloatArray,
    second: FloatArray,
    third: FloatArray,
    load: FloatArray,
) -> None:
    """Add to ``load`` the rows of a string on the axis of the bent hole, under tension, with its stress-free curvature."""
    mesh = model.mesh
    centre, L = found.position - found.offset, mesh.length_divisor
    own = np.zeros((len(L), 3))
    if np.any(mesh.curvature):
        two, three = directors(model.frames, np.arange(mesh.nodes), t, found.twist)
        own = mesh.curvature[:, 1:] * two[:-1] - mesh.curvature[:, :1] * three[:-1]
    bending, tension = (
        np.where(mesh.is_joint, 0.0, q) for q in (mesh.bending_stiffness, found.axial_force[1:-1])
    )
    K = element_matrices(L, bending, tension, np.zeros_like(L))
    chord = centre[1:] - centre[:-1] - mesh.rigid_above[:, None] * t[:-1]
    chord[mesh.is_joint] = t[:-1][mesh.is_joint]
    pull = tension[:, None] * chord / np.linalg.norm(chord, axis=1, keepdims=True)
    for p, e in ((0, second), (1, third)):
        load[:-1, p] += np.sum(pull * e[:-1], axis=1)
        load[1:, p] -= np.sum(pull * e[1:], axis=1)
        e = 0.5 * (e[1:] + e[:-1])
        e -= chord * (np.sum(e * chord, axis=1) / np.sum(chord * chord, axis=1))[:, None]
        hole = np.zeros((len(L), 4))  # the displacements and slopes of the hole itself, from the chord
        hole[:, 1], hole[:, 3] = np.sum(t[:-1] * e, axis=1), np.sum(t[1:] * e, axis=1)
        rows = -np.einsum("eab,eb->ea", K, hole)
        moment = bending * np.sum(own * e, axis=1)
        rows[:, 1] -= moment
        rows[:, 3] += moment
        rows[:, 1] += mesh.rigid_above * rows[:, 0]
        for k, (node, place) in enumerate(((0, p), (0, 2 + p), (1, p), (1, 2 + p))):
            load[node : node + len(L), place] += rows[:, k]


def _add_moments_of_weight(
    model: DrillingModel, found: March, second: FloatArray, third: FloatArray, load: FloatArray
) -> None:
    """Add to ``load`` the moments q L^2/12 at the ends of elements under a side load q per length.

    Those of neighbours cancel, but at the ends of the string, at junctions and where the hole bends.
    """
    mesh, gravity = model.mesh, np.array(model.case.gravity)
    size = np.where(mesh.is_joint, 0.0, model.effective_mass * mesh.length**2 / 12)
    t = found.direction[:-1] + found.direction[1:]
    t /= np.linalg.norm(t, axis=1, keepdims=True)
    across = size[:, None] * (gravity - t * (t @ gravity)[:, None])
    for p, e in ((2, second), (3, third)):
        moment = np.sum(across * e[:-1], axis=1)
        load[:-1, p] += moment
        load[1:, p] -= moment


def _wall(model: DrillingModel) -> Callable[[FloatArray, FloatArray], tuple[FloatArray, FloatArray]]:
    """Contact force per length [N/m] by depth and clearance [m], and its derivative, as in the model."""
    assert model.contact is not None
    law = model.contact.law
    power = 1.0 if law.law == "linear" else 1.5

    def wall(depth: FloatArray, clearance: FloatArray) -> tuple[FloatArray, FloatArray]:
        loose = clearance > 0
        d = np.maximum(depth, -ONSET)
        eased = np.abs(d) < ONSET
        d, slope = (
            np.where(eased & loose, (d + ONSET) ** 2 / (4 * ONSET), d),
            np.where(eased, (d + ONSET) / (2 * ONSET), 1.0),
        )
        d, slope = np.maximum(d, 0.0), np.where(loose, np.where(depth <= -ONSET, 0.0, slope), 1.0)
        return law.stiffness * d**power, law.stiffness * power * d ** (power - 1) * slope

    return wall


def _placed(model: DrillingModel, found: March, first: int, across: FloatArray, slope: FloatArray) -> March:
    """``found`` with the lateral displacement and slope (n, 2) of the nodes from ``first`` on, which draw the nodes up."""
    t, frames = found.direction, np.stack(_directors(model, found), axis=1)
    unit = found.tangent / np.linalg.norm(found.tangent, axis=1, keepdims=True)
    unit /= np.sum(unit * t, axis=1, keepdims=True)
    before = _in_frame(frames, found.offset), _in_frame(frames, unit)
    after = before[0].copy(), before[1].copy()
    after[0][first:], after[1][first:] = across[first:], slope[first:]
    short = _shortening(model, t, frames, *after) - _shortening(model, t, frames, *before)
    offset, lean = (np.einsum("npi,np->ni", frames, q) for q in after)
    tangent = t + lean
    tangent *= (np.linalg.norm(found.tangent, axis=1) / np.linalg.norm(tangent, axis=1))[:, None]
    # a weight that is given keeps the bit on the bottom: the string comes down by what its buckles take up
    down = short[-1] if model.bit is not None and model.case.initial.wob is not None else 0.0
    shifted = replace(found, tangent=tangent, offset=offset)
    return replace(moved_along(model, shifted, down - short), top_motion=found.top_motion + down)


def _in_frame(frames: FloatArray, vectors: FloatArray) -> FloatArray:
    """Components (n, 2) of ``vectors`` (n, 3) along ``frames`` (n, 2, 3)."""
    return np.einsum("npi,ni->np", frames, vectors)


def _shortening(
    model: DrillingModel, t: FloatArray, frames: FloatArray, across: FloatArray, slope: FloatArray
) -> FloatArray:
    """Distance (n,) [m] by which offsets and slopes (n, 2) from the axis of the hole draw the nodes up.

    The mean square of the slope in each element, by Simpson's rule, less the offset towards the inside of a bend.
    """
    L = model.mesh.length_divisor[:, None]
    middle = 1.5 * np.diff(across, axis=0) / L - 0.25 * (slope[1:] + slope[:-1])
    square = np.sum(slope[:-1] ** 2 + 4 * middle**2 + slope[1:] ** 2, axis=1) / 6
    bend = np.einsum("epi,ei->ep", 0.5 * (frames[1:] + frames[:-1]), np.diff(t, axis=0) / L)
    inside = np.sum(bend * 0.5 * (across[1:] + across[:-1]), axis=1)
    return np.concatenate([[0.0], np.cumsum((0.5 * square - inside) * model.mesh.length)])
