"""Start of statics: the lateral equilibrium of a string in its hole under the axial force of the march.

Manual: sec-statics-lateral-start.  The relaxation alone finds most buckled states, too, with 5 to 100 times the factorisations.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from drillpetsc.analysis.statics.imperfection import nodal_weight, side_load_size
from drillpetsc.analysis.statics.start.march import March
from drillpetsc.arrays import FloatArray
from drillpetsc.fem.quadrature import exposed_ends, rule
from drillpetsc.fem.string_mesh import RigidItem
from drillpetsc.geometry.frames import directors
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output.static_table import at_nodes
from drillpetsc.physics.contact import ONSET
from drillpetsc.solvers.static.lateral_beam import (
    ContactPoints,
    Elements,
    LateralBeam,
    element_matrices,
    lateral_state,
)
from drillpetsc.solvers.static.lateral_loads import lateral_shares
from drillpetsc.solvers.static.search_limit import SearchLimit

LYING_SHARE = 0.01  # of the push: a side load on the string above the buckle that holds it on the wall
GROWTH, LONGEST = 1.3, 60.0  # of the elements above the buckle: ratio of neighbours, length [m]
MARGIN = 6.0  # of (EI/w)^(1/3) above the uppermost push, over which a buckle dies out
ROUGH_SHARE = 0.25  # length of rough elements over the pitch of a helix
REFINEMENT = 4.0  # ratio of the lengths of rough elements from one round to the next
BIT_DEPTH = 1e-4  # of a bit in the side of its hole, where the law of Hertz has the force of its spring [m]
NO_LENGTH = 1e-9  # of an element that is a joint [m]
MAX_ROUNDS = 10  # of lateral equilibrium and tension
SETTLED_PUSH, SETTLED_PULL = (
    1e-3,
    1e-4,
)  # change of the tension, over the largest push or pull, with which the rounds end


@dataclass(frozen=True)
class LateralStart:
    """A start of statics.

    march: with the places of the lateral equilibrium.
    side_loads: standard deviation (n_nodes,) of the loads that lead the string off a saddle, and stay [N]; None: it does
    not buckle.
    """

    march: March
    side_loads: FloatArray | None


def lateral_start(straight: March, coiled: March, limit: SearchLimit) -> LateralStart | None:
    """Find the start of a string under the tension of the march ``straight``, which does not coil.

    coiled: the march of a string that may coil, whose friction is the first estimate.
    limit: of the work of the search.
    Returns None if no stable state is found.  The same on all ranks.
    """
    model = straight.string.model
    found, disturbed = (
        replace(
            straight.with_contact(coiled.contact_force, float(coiled.axial_force[-1])), shape=coiled.shape
        ),
        False,
    )
    # only on the pushed part: kilometres of pipe in tension would lie down on the wall under them
    tension = at_nodes(found.effective_tension, found.effective_tension)
    size = np.where(tension < 0, side_load_size(model), 0.0)
    shares = lateral_shares(model.mesh.node_depth)
    if not any(model.case.gravity):  # a string without weight is led by a share of the force on its helix
        size = model.case.initial.imperfection * coiled.contact_force
        shares = found.shape[:, :2] / max(np.abs(found.shape).max(), 1e-9)
    loads = np.concatenate([size[:, None] * shares, np.zeros_like(shares)], axis=1)
    least = _rough_length(found)
    for _ in range(MAX_ROUNDS):
        # on short elements the boundary of a contact moves by an element in a step, and contacts that open and close hold up a
        # buckle that moves along the hole: wells of 12 km need half as long
        parts = _Parts(found, least)
        beam = parts.beam()
        beam.limit = limit
        state = lateral_state(beam, found.shape[parts.nodes], parts.gathered(loads), disturbed)
        if state is None:
            return None
        disturbed = state.disturbed
        least = least / REFINEMENT if REFINEMENT * len(parts.nodes) < model.mesh.nodes else 0.0
        before = found.axial_force
        found = replace(found.with_contact(parts.contact(beam, state.place)), shape=parts.spread(state.place))
        change, force = np.abs(found.axial_force - before).max(), found.axial_force
        if not parts.rough and change <= max(-SETTLED_PUSH * force.min(), SETTLED_PULL * force.max()):
            break
    return LateralStart(found, size if disturbed else None)


def _rough_length(found: March) -> float:
    """Length [m] of elements that show a buckle: a share of the pitch 2 pi sqrt(2 EI/F) under the largest push F; 0 without a push.

    A small push bends the string less than its weight does, over (EI/w)^(1/3).
    """
    model, mesh = found.string.model, found.string.model.mesh
    pipe, push = ~mesh.is_joint, np.maximum(-found.effective_tension, 0.0)
    if not push.any():
        return 0.0
    stiffness, weight = mesh.bending_stiffness[pipe], nodal_weight(model).sum() / mesh.total_length
    pitch = 2 * np.pi * np.sqrt(2 * stiffness / np.maximum(push[pipe], 1e-9)).min()
    return float(min(ROUGH_SHARE * pitch, np.cbrt(stiffness.min() / max(weight, 1e-3))))


class _Parts:
    """Elements of the lateral problem: those of the model from where the string may be buckled, longer ones above it.

    There they grow if the string hangs free: it passes a side force over kilometres.  Elements of the model are merged up to the
    length ``least`` [m]; rough: some are.
    """

    def __init__(self, found: March, least: float):
        self.model, self.found = found.string.model, found
        mesh, depth = self.model.mesh, self.model.mesh.node_depth
        buckling = _first_node(found)
        lying = float(np.linalg.norm(found.side_load[:buckling], axis=1).sum())
        free = lying <= LYING_SHARE * float(-found.effective_tension.min())
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
        self.nodes = np.array(nodes[::-1], dtype=int)
        self.rigid = np.add.reduceat(mesh.rigid_above, self.nodes[:-1])
        self.length = np.diff(depth[self.nodes]) - self.rigid
        # of each node of the model: its element, and the factors (n, 4) of its displacement and slope
        node = np.arange(mesh.nodes)
        cell = np.clip(np.searchsorted(self.nodes, node, side="right") - 1, 0, len(self.length) - 1)
        self._place, self._slope = self._factors(cell, depth)
        own = self.nodes[cell] == node
        self._place[own], self._slope[own] = np.eye(4)[:2]
        self._ends = 2 * cell[:, None] + np.arange(4)

    def beam(self) -> LateralBeam:
        """The lateral problem under the tension of the march."""
        mesh, found = self.model.mesh, self.found
        load = np.zeros((mesh.nodes, 4))
        load[:, :2] = np.einsum("npi,ni->np", found.axes[:, 1:], found.string.across)
        # the moments q L^2/12 of elements of different length or weight do not cancel
        size = (~mesh.is_joint * self.model.effective_mass * mesh.length**2 / 12)[:, None]
        weight = found.axes[:, 1:] @ np.array(self.model.case.gravity)
        load[:-1, 2:] += size * weight[:-1]
        load[1:, 2:] -= size * weight[1:]
        _add_curvature(found, load)
        held = np.zeros((len(self.nodes), 4), dtype=bool)
        held[0] = True
        if found.top_on_wall:
            held[0, :2] = False  # its place is part of the equilibrium
        bending, force = (self._mean(q) for q in (mesh.bending_stiffness, found.effective_tension))
        pipe = np.where(mesh.is_joint, np.inf, mesh.contact_diameter)
        thin = np.minimum(np.append(pipe, pipe[-1]), np.append(pipe[0], pipe))
        clearance = np.maximum(
            np.asarray(self.model.given_well.radius(found.measured_depth)) - 0.5 * thin, 0.0
        )
        hinged = [joint.cell for joint in mesh.joints if joint.kind == "universal"]
        elements = Elements(self.length, bending, force, self.rigid, np.isin(self.nodes[:-1], hinged))
        points = self._contact_points()
        return LateralBeam(
            elements, self.gathered(load), points, _wall(self.model), held, clearance[self.nodes]
        )

    def _mean(self, values: FloatArray) -> FloatArray:
        """Means (n,) over the length of the elements of the model's elements (m,)."""
        h = self.model.mesh.length
        return np.add.reduceat(values * h, self.nodes[:-1]) / np.maximum(
            np.add.reduceat(h, self.nodes[:-1]), NO_LENGTH
        )

    def _factors(self, cell: np.ndarray, depth: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Factors (m, 4) of the unknowns of elements ``cell`` (m,) in displacement and slope at ``depth`` (m,) [m]."""
        L = np.maximum(self.length[cell], NO_LENGTH)
        x = 1 - (self.model.mesh.node_depth[self.nodes[cell + 1]] - depth) / L
        place = [1 - 3 * x**2 + 2 * x**3, L * (x - 2 * x**2 + x**3), 3 * x**2 - 2 * x**3, L * (x**3 - x**2)]
        slope = [6 * x * (x - 1) / L, (1 - x) * (1 - 3 * x), 6 * x * (1 - x) / L, x * (3 * x - 2)]
        for factors in (place, slope):
            factors[1] = factors[1] + factors[0] * self.rigid[cell]
        return np.column_stack(place), np.column_stack(slope)

    def gathered(self, load: FloatArray) -> FloatArray:
        """Loads (n+1, 4) on the elements' ends that do the work of those of the model's nodes (n_nodes, 4)."""
        out = np.zeros((2 * len(self.nodes), 2))
        work = self._place[:, :, None] * load[:, None, :2] + self._slope[:, :, None] * load[:, None, 2:]
        np.add.at(out, self._ends, work)
        return out.reshape(-1, 4)

    def spread(self, U: FloatArray) -> FloatArray:
        """Displacements and slopes (n_nodes, 4) of the model's nodes."""
        ends = U.reshape(-1, 2)[self._ends]
        return np.concatenate([np.einsum("na,nap->np", q, ends) for q in (self._place, self._slope)], axis=1)

    def contact(self, beam: LateralBeam, U: FloatArray) -> FloatArray:
        """Contact force (n_nodes,) [N] of the state ``U``."""
        depth, nodes, at = self.model.mesh.node_depth, self.model.mesh.nodes, beam.points.at
        node = np.clip(np.searchsorted(depth, at, side="right") - 1, 0, nodes - 2)
        share = np.clip((at - depth[node]) / np.maximum(np.diff(depth)[node], 1e-9), 0.0, 1.0)
        force = beam.contact_force(U)
        upper, lower = (1 - share) * force, share * force
        return np.asarray(np.bincount(node, upper, nodes) + np.bincount(node + 1, lower, nodes), dtype=float)

    def _contact_points(self) -> ContactPoints:
        """The points of the model's own quadrature where the string may touch the wall."""
        model, found, mesh = self.model, self.found, self.model.mesh
        contact, md, centre, t = model.given_contact, found.measured_depth, found.centre, found.axes[:, 0]
        well, law = contact.well, contact.law
        upper, lower = exposed_ends(mesh, contact.free_top)
        upper, lower = upper[self.nodes[:-1]], lower[self.nodes[1:] - 1]
        radius = 0.5 * np.append(mesh.contact_diameter, mesh.contact_diameter[-1])
        touches = (radius[self.nodes[:-1]] > 0) & (self.length > NO_LENGTH)

        def off_axis(place: FloatArray, at: FloatArray, node: np.ndarray) -> FloatArray:
            """Offset (m, 2) from the axis of the hole at the depths ``at`` (m,) of ``place`` (m, 3)."""
            return np.einsum("mpi,mi->mp", found.axes[node, 1:], place - np.asarray(well.at(at)[0]))

        columns: list[tuple] = []
        for ends in ((False, False), (False, True), (True, False), (True, True)):
            e = np.flatnonzero((upper == ends[0]) & (lower == ends[1]) & touches)
            a, b = self.nodes[e], self.nodes[e + 1]
            L = md[b] - md[a] - self.rigid[e]
            for x, weight in rule(law.points, *ends) if len(e) else ():
                at = md[b] - (1 - x) * L
                gap = np.maximum(np.asarray(well.radius(at)) - radius[a], 0.0)
                # an element does not follow the hole where its curvature changes
                place = (
                    (1 + 2 * x) * (1 - x) ** 2 * (centre[a] + self.rigid[e][:, None] * t[a])
                    + x**2 * (3 - 2 * x) * centre[b]
                    + L[:, None] * (x * (1 - x) ** 2 * t[a] - x**2 * (1 - x) * t[b])
                )
                depth = mesh.node_depth[b] - (1 - x) * self.length[e]
                wall = contact.hardness[0][a] * (1.0 if law.law == "hertz_point" else weight * self.length[e])
                columns.append((e, self._factors(e, depth)[0], gap, wall, off_axis(place, at, a), depth))
        for body, hardness in zip(mesh.bodies, contact.hardness[1], strict=True):
            last, node = body.node == mesh.nodes - 1, np.array([body.node])
            cell = np.searchsorted(self.nodes, node) - last
            for y, length, clearance in (
                _points_of_item(model, body, float(hardness)) if body.radius > 0 else ()
            ):
                factors = np.array([[0.0, 0.0, 1.0, y] if last else [1.0, y, 0.0, 0.0]])
                gap = np.maximum(np.asarray(well.radius(md[node] + y)) - body.radius, 0.0)
                if clearance is not None:
                    gap[:] = clearance
                off = off_axis(centre[node] + y * t[node], md[node] + y, node)
                columns.append((cell, factors, gap, np.array([length]), off, mesh.node_depth[node] + y))
        return ContactPoints(*(np.concatenate(q) for q in zip(*columns, strict=True)))


def _points_of_item(
    model: DrillingModel, item: RigidItem, hardness: float
) -> list[tuple[float, float, float | None]]:
    """Points where a rigid item may touch the wall: distance below its node [m], length of wall [m], clearance [m].

    The clearance is None if the item has one of its own.  A bit that cuts touches the side of its hole at one point.
    """
    law, side = model.given_contact.law, model.bit.side_contact if model.bit is not None else None
    if item.kind == "bit" and side is not None:
        per_length = law.stiffness * (1.0 if law.law == "linear" else np.sqrt(BIT_DEPTH))
        return [(side.below, side.stiffness / per_length, side.clearance)] if side.stiffness else []
    return [
        (item.contact_above + x * item.contact_length, weight * item.contact_span * hardness, None)
        for x, weight in rule(law.points, True, True)
    ]


def _first_node(found: March) -> int:
    """The node from which on the string may be buckled: some lengths above the uppermost push; the first without a push."""
    model, push = found.string.model, found.effective_tension < 0
    mesh, top = model.mesh, int(np.argmax(push))
    weight = nodal_weight(model).sum() / mesh.total_length
    reach = MARGIN * float(np.cbrt(mesh.bending_stiffness[~mesh.is_joint].max() / max(weight, 1e-3)))
    return int(np.searchsorted(mesh.node_depth, mesh.node_depth[top] - reach))


def _add_curvature(found: March, load: FloatArray) -> None:
    """Add to ``load`` the rows of a string on the axis of the bent hole, under tension, with its stress-free curvature."""
    model, mesh, t, e = found.string.model, found.string.model.mesh, found.axes[:, 0], found.axes[:, 1:]
    L, pipe = mesh.length_divisor, ~mesh.is_joint
    bending, tension = mesh.bending_stiffness * pipe, found.axial_force[1:-1] * pipe
    chord = np.diff(found.centre, axis=0) - mesh.rigid_above[:, None] * t[:-1]
    chord[mesh.is_joint] = t[:-1][mesh.is_joint]
    chord /= np.linalg.norm(chord, axis=1, keepdims=True)
    two, three = directors(model.frames, np.arange(mesh.nodes), t, found.twist)
    own = mesh.curvature[:, 1:] * two[:-1] - mesh.curvature[:, :1] * three[:-1]
    middle = 0.5 * (e[1:] + e[:-1])
    middle -= np.einsum("epi,ei->ep", middle, chord)[:, :, None] * chord[:, None]
    hole = np.zeros((len(L), 4, 2))  # the displacements and slopes of the hole itself, from the chord
    hole[:, 1], hole[:, 3] = (np.einsum("epi,ei->ep", middle, q) for q in (t[:-1], t[1:]))
    rows = -np.einsum("eab,ebp->eap", element_matrices(L, bending, tension, np.zeros_like(L)), hole)
    moment = bending[:, None] * np.einsum("epi,ei->ep", middle, own)
    rows[:, 1] += mesh.rigid_above[:, None] * rows[:, 0] - moment
    rows[:, 3] += moment
    pull = tension[:, None] * chord
    rows[:, 0] += np.einsum("epi,ei->ep", e[:-1], pull)
    rows[:, 2] -= np.einsum("epi,ei->ep", e[1:], pull)
    load[:-1] += rows[:, :2].reshape(-1, 4)
    load[1:] += rows[:, 2:].reshape(-1, 4)


def _wall(model: DrillingModel) -> Callable[[FloatArray, FloatArray], tuple[FloatArray, FloatArray]]:
    """Contact force per length [N/m] by depth and clearance [m], and its derivative, as in the model."""
    law = model.given_contact.law
    power = 1.0 if law.law == "linear" else 1.5

    def wall(depth: FloatArray, clearance: FloatArray) -> tuple[FloatArray, FloatArray]:
        loose = clearance > 0
        slope = np.where(loose, np.clip((depth + ONSET) / (2 * ONSET), 0.0, 1.0), 1.0)
        d = np.where(loose & (depth < ONSET), ONSET * slope**2, np.maximum(depth, 0.0))
        return law.stiffness * d**power, law.stiffness * power * d ** (power - 1) * slope

    return wall
