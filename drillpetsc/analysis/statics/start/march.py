"""Start of statics: axial force, torque and shape of the string in its hole, marched from the bit up.

Manual: sec-statics-march.  The loads of each node are the rows of the model itself, with the string
unstrained along the hole, so that mud, pressure, rigid items and loads are contained.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from drillpetsc.analysis.statics.checks.slider_travel import travels
from drillpetsc.analysis.statics.placement import end_is_held, is_slanted, top_depth
from drillpetsc.analysis.statics.start.march_shape import (
    OnWall,
    frame_across,
    lateral_shape,
    place,
    shortening,
)
from drillpetsc.analysis.statics.start.resting_shape import Beam
from drillpetsc.arrays import FloatArray, halves_at_nodes
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.model.hole import hole_depth
from drillpetsc.output.measured.flow_recorder import flow_recorder
from drillpetsc.output.static_table import at_nodes
from drillpetsc.parallel import total
from drillpetsc.physics.roots import bracketed_root
from drillpetsc.physics.tools.reamer import Reamer

#: contact force at the top, as a fraction of the load of its node, above which the string is on the wall there
LATERAL_LOAD_THRESHOLD = 0.1
#: axial force over which a string that lies on the wall coils (Chen, Lin and Cheatham 1990): 2 sqrt(2) sqrt(EI w/r)
HELIX_FACTOR = 2 * np.sqrt(2.0)
#: the same where a helix begins at the earliest, by the wall force of snakes (Chen 1990), and at the latest, 1.83 times
#: 2 sqrt(EI w/r) (Wu and Juvkam-Wold 1993)
HELIX_FACTORS = (HELIX_FACTOR, 3.66)
NO_BAND = 5e-3  # width of a band over the largest push, below which the string has one state
#: force over which a vertical string coils: 2.65 (EI w^2)^(1/3) (manual: eq-statics-march)
VERTICAL_FACTOR = 2.65
LEAST_LOAD = 1e-3  # load per length that holds the string in the middle of the hole, over its weight [-]
LARGEST_PULL = 1e7  # [N] that is sought below a string whose lower end is held
BEND_ROUNDS = 3  # of place and shortening by the bends of the hole
STANDING_TOLERANCE = 1e-6  # way that is left of the bit of a held string to the bottom [m]
FORCE_TOLERANCE = 1e-3  # at the bottom under a given force at the top [N]
CRUSHING_STRAIN = 0.01  # a push that compresses the string by more means that no push passes [-]
#: largest rotation of a helix within one element, so that the mesh can represent it [rad]
MAX_ROTATION = 0.45 * np.pi
LEFT_OUT = (
    "contact",
    "body_contact",
    "bit_contact",
    "bit_rock",
    "reamer",
)  # first words of kernels whose forces are no loads


@dataclass
class March:
    """Result of ``march``, node arrays (n,) unless said otherwise.

    axial_force: (n+1,) EA times the axial strain above node 0, of each element, and below the last node [N].
    effective_tension: (n-1,) of the elements, which buckles them; the same without mud [N].
    contact_force: on the wall [N]; helical: whether the string coils there; coiling: push over that at which it coils [-].
    torque: (n+1,) as the axial force [N m].
    position, tangent: (n, 3) of the start [m, -]; ratio: of the stretch below a junction to that above [-];
    twist: spin angle [rad].
    offset: (n, 3) from the axis of the hole [m]; top_on_wall: whether the string lies on the wall at its top.
    top_motion: distance that the top is moved down [m].
    usual_contact_force: force per length that nine tenths of the nodes do not exceed [N/m].
    measured_depth: of the nodes at the start [m]; direction: (n, 3) of the hole there [-].
    side_load: (n, 3) across the hole, of weight, flow and tension in its curvature [N]; load_across: without the last.
    locked_at: measured depth in the hole below which no push passes, None: it passes; locked_node: its node.
    """

    axial_force: FloatArray
    contact_force: FloatArray
    helical: np.ndarray
    torque: FloatArray
    position: FloatArray
    tangent: FloatArray
    ratio: FloatArray
    twist: FloatArray
    offset: FloatArray
    top_on_wall: bool
    top_motion: float
    locked_at: float | None = None
    locked_node: int = 0
    usual_contact_force: float = 0.0
    side_load: FloatArray = field(default_factory=lambda: np.zeros((0, 3)))
    load_across: FloatArray = field(default_factory=lambda: np.zeros((0, 3)))
    measured_depth: FloatArray = field(default_factory=lambda: np.zeros(0))
    direction: FloatArray = field(default_factory=lambda: np.zeros((0, 3)))
    effective_tension: FloatArray = field(default_factory=lambda: np.zeros(0))
    coiling: FloatArray = field(default_factory=lambda: np.zeros(0))


@dataclass(frozen=True)
class HelixBand:
    """Band [N] of what a string transmits: ``wob`` under a given force at the top, else ``hook_load``."""

    name: str
    low: float
    high: float


def nodal_loads(model: DrillingModel, rates: FloatArray | None = None) -> tuple[FloatArray, FloatArray]:
    """Compute force (n, 3) [N] and torque (n,) [N m] on every node but those of contact, bit and axial strain.

    rates: (n+1,) of a steady motion that the mud sees [SI of each field per second]; None: at rest.
    The string must lie unstrained along the hole.  Collective; the same on all ranks.
    """
    system, asm = model.system, model.system.assembly
    asm.y[:], asm.a[:] = 0.0 if rates is None else rates, 0.0
    asm.partial_residual(0.0, lambda block: not block.kernel.startswith(LEFT_OUT))
    for bound in asm.bound_blocks:
        # what bends the string along the hole is no load: it lies along chords of rigid items, and the hole's curvature changes within
        # an element
        if bound.block.kernel.startswith("beam") and bound.count:
            table = bound.block.named
            gravity = np.array(table["gravity"])
            table["gravity"] = 0.0
            np.subtract.at(asm.r, bound.index, asm.block_rows(bound, 0.0))
            table["gravity"] = gravity
    rows = system.sum_local(asm.r.copy()) if system.comm.size > 1 else asm.r[: system.layout.size].copy()
    force, torque, owned = np.zeros((model.mesh.nodes, 3)), np.zeros(model.mesh.nodes), system.chain.owned
    here = system.chain.vertices[owned]
    force[here] = -rows[system.layout.dofs["string.position"][owned]]
    torque[here] = -rows[system.layout.dofs["string.spin"][owned, 0]]
    return total(system.comm, force), total(system.comm, torque)


def pressure_tension(model: DrillingModel) -> FloatArray:
    """Effective tension less EA times the axial strain (n-1,) of the elements [N]; zeros without mud.

    Collective; the same on all ranks.  Manual: eq-mud-effective-tension.
    """
    system, mud = model.system, flow_recorder(model)
    if mud is None:
        return np.zeros(model.mesh.nodes - 1)
    whole = system.gather((mud.wall_tension() + mud.pressure_force()).mean(axis=1, keepdims=True), "cell")
    if system.comm.size > 1:
        whole = system.comm.tompi4py().bcast(whole)
    assert whole is not None
    return np.asarray(whole[:, 0])


class _Column:
    """Values of the nodes that the march uses, as lists, and the march itself."""

    def __init__(self, *values: FloatArray) -> None:
        self.rows = np.column_stack(values).tolist()

    def run(
        self, bottom: float, coils_above: float = HELIX_FACTOR, standing: dict[int, float] | None = None
    ) -> tuple[FloatArray, FloatArray, FloatArray, int | None]:
        """Return tension (n+1,), contact force (n,), push over that at which the string coils (n,), and the node of lock-up, from the
        force below.

        coils_above: axial force above which a string on the wall coils, over sqrt(EI w/r).
        standing: weights [N] that stand on the hole above its bottom, by their nodes.
        """
        standing = standing or {}
        n = len(self.rows)
        tension, contact, coiling, locked = np.empty(n + 1), np.empty(n), np.zeros(n), None
        tension[n] = below = bottom
        for i in range(n - 1, -1, -1):
            load, drag, kk, kw, ww, length, bending, clearance, vertical, crushing, wet = self.rows[i]
            load -= standing.get(i, 0.0)
            above, total, times = below + load, 0.0, 0.0
            for _ in range(
                3
            ):  # friction changes the mean tension by which the wall pushes; each round leaves little of that
                mean = 0.5 * (below + above)
                side = max(kk * mean * mean + 2 * kw * mean + ww, 0.0) ** 0.5
                push, coil, times = -mean - wet, 0.0, 0.0
                if push > 0 and length > 0 and clearance > 0:
                    critical = coils_above * (bending * side / length / clearance) ** 0.5
                    # in a vertical hole nothing lies on the wall, and weight alone keeps the string straight
                    times = push / max(critical, vertical, 1e-9)
                    if times > 1:
                        coil = clearance * push * push / (4 * bending) * length
                total = max(side, coil)
                above = below + load - drag * total
            if above + wet < -crushing:  # the march goes on with this push: the caller names the place
                locked, above = (i if locked is None else locked), -crushing - wet
            coiling[i], contact[i], tension[i] = times, total, above
            below = above
        return tension, contact, coiling, locked


class _Marcher:
    """Loads and stiffnesses of a string along its hole, and its march from any force below it."""

    def __init__(
        self, model: DrillingModel, motion: tuple[float, float], coils: bool, rates: FloatArray | None = None
    ):
        mesh, well = model.mesh, model.well
        assert well is not None
        n, depth = mesh.nodes, mesh.node_depth + top_depth(model)
        force, load_torque = nodal_loads(model, rates)
        _, t, _ = well.at(depth)
        half = halves_at_nodes(mesh.length)
        middle = np.concatenate([[depth[0]], 0.5 * (depth[1:] + depth[:-1]), [depth[-1]]])
        turn = np.diff(np.asarray(well.at(middle)[1]), axis=0)  # of the hole over each node's own length
        along = np.sum(force * t, axis=1)
        across = force - along[:, None] * t
        bending = np.append(mesh.bending_stiffness, mesh.bending_stiffness[-1])
        # a joint has no stiffness, with which its node would coil first
        bending[:-1][mesh.is_joint] = mesh.bending_stiffness[~mesh.is_joint].max()
        radius = _radius(model)
        clearance = np.maximum(np.asarray(well.radius(depth)) - radius, 0.0)
        drag, around = friction_factors(model, motion)
        weight = np.linalg.norm(force, axis=1) / np.maximum(half, 1e-9)
        axial = np.where(mesh.is_joint, mesh.axial_stiffness[~mesh.is_joint].max(), mesh.axial_stiffness)
        wet = pressure_tension(model)
        self.column = _Column(
            along,
            drag,
            np.sum(turn * turn, axis=1),
            np.sum(turn * across, axis=1),
            np.sum(across * across, axis=1),
            half,
            bending,
            np.maximum(clearance, 1e-3) if coils else np.zeros(n),
            VERTICAL_FACTOR * np.cbrt(bending * weight**2),
            CRUSHING_STRAIN * np.append(axial, axial[-1]),
            at_nodes(wet, wet),
        )
        self.model, self.motion, self.half, self.turn, self.across = model, motion, half, turn, across
        self.depth, self.bending, self.clearance, self.weight, self.wet = (
            depth,
            bending,
            clearance,
            weight,
            wet,
        )
        self.around, self.load_torque = around, load_torque

    def result(self, bottom: float, wob: float, top: float | None) -> March:
        """The march from the axial force ``bottom`` [N] below the string.

        wob: weight on bit, of which its torque is [N].
        top: measured depth of the upper end [m]; None: where the bit carries ``wob``.
        """
        model, motion, mesh, depth = self.model, self.motion, self.model.mesh, self.depth
        bending, clearance, wet, half = self.bending, self.clearance, self.wet, self.half
        reamers = self._standing_reamers(bottom, wob) if top is None else {}
        tension, contact, coiling, locked = self.column.run(
            bottom, standing={node: weight for node, (weight, _) in reamers.items()}
        )
        helical = coiling > 1
        rock = 0.0
        if model.bit is not None:
            turning = motion[1] + model.motor_speed
            rock = model.bit.torque_for(wob, turning) * np.sign(turning)
        steps = self.around * contact - self.load_torque
        for node, (_, rocks) in reamers.items():
            steps[node] += rocks * np.sign(self.around[node])
        # rows are loads on the string: from the bit up, each node adds what it takes from the pipe above
        torque = np.append(np.cumsum(steps[::-1])[::-1], 0.0) + rock
        inner = tension[1:-1]
        coils = helical[:-1] & helical[1:] & ~mesh.is_joint
        pitch = np.where(coils, np.sqrt(np.maximum(-inner - wet, 0.0) / (2 * bending[:-1])), 0.0)
        pitch = np.minimum(pitch, MAX_ROTATION / np.maximum(mesh.length, 1e-9))
        gap = 0.5 * (clearance[:-1] + clearance[1:])
        with np.errstate(divide="ignore", invalid="ignore"):
            strain = np.where(mesh.is_joint, 0.0, inner / mesh.axial_stiffness)
            twist = np.where(mesh.is_joint, 0.0, torque[1:-1] * mesh.length / mesh.torsional_stiffness)
        load = 0.5 * (tension[:-1] + tension[1:])[:, None] * self.turn + self.across
        on_wall = bool(contact[0] > LATERAL_LOAD_THRESHOLD * self.weight[1] * half[0] and not helical[0])
        per_length = contact / np.maximum(half, 1e-9)
        bed = np.maximum(per_length, LEAST_LOAD * self.weight) / np.maximum(clearance, 1e-3)
        beam = Beam(mesh.length, mesh.bending_stiffness, inner, mesh.is_joint, bed)
        phase = np.concatenate([[0.0], np.cumsum(pitch * mesh.length)])
        longer = strain * mesh.length + travels(mesh, inner)
        measured_depth, _ = self._depths(longer, wob, top)
        shape, across, slope, share = lateral_shape(
            model, measured_depth, OnWall(load, per_length, clearance, on_wall), beam, helical, phase
        )
        # a helix is longer than the axis about which it winds
        longer -= 0.5 * (gap * pitch) ** 2 * mesh.length
        for _ in range(BEND_ROUNDS):  # where the hole's curvature changes, it depends on the place
            short = (1 - share) * shortening(model, measured_depth, across, slope)
            measured_depth, end = self._depths(longer - short * mesh.length, wob, top)
        top = end
        position, tangent, offset, direction = place(model, measured_depth, shape)
        strain_above, strain_below = _nodal_strains(mesh, strain)
        return March(
            axial_force=tension,
            contact_force=contact,
            helical=helical,
            coiling=coiling,
            torque=torque,
            position=position,
            tangent=(1 + strain_above)[:, None] * tangent,
            ratio=(1 + strain_below) / (1 + strain_above),
            twist=-np.concatenate([[0.0], np.cumsum(twist)]),
            offset=offset,
            top_on_wall=on_wall,
            top_motion=top,
            usual_contact_force=float(np.quantile(per_length, 0.9)),
            locked_at=None if locked is None else float(depth[locked]),
            locked_node=locked or 0,
            side_load=load,
            load_across=self.across,
            measured_depth=measured_depth,
            direction=direction,
            effective_tension=inner + wet,
        )

    def _depths(self, longer: FloatArray, wob: float, top: float | None) -> tuple[FloatArray, float]:
        """Measured depths (n,) of the nodes and of the top of a string whose elements are ``longer`` (n-1,) than without strain [m].

        wob, top: as of ``result``.
        """
        model, mesh = self.model, self.model.mesh
        stretch = np.concatenate([[0.0], np.cumsum(longer)])
        if top is None:
            assert model.bit is not None
            top = hole_depth(model.case) - (mesh.total_length + stretch[-1]) + model.bit.depth_for(wob)
        return mesh.node_depth + stretch + top, top

    def _standing_reamers(self, bottom: float, wob: float) -> dict[int, tuple[float, float]]:
        """Weight [N] and torque [N m] of the reamers under the force ``bottom`` [N] below the string, by their nodes.

        The bit and the string below a reamer determine its depth; a reamer above does not count.
        """
        model, mesh = self.model, self.model.mesh
        found: dict[int, tuple[float, float]] = {}
        bit = model.bit
        for reamer in reversed(model.parts(Reamer)) if bit is not None else ():
            assert bit is not None
            tension = self.column.run(bottom, standing={node: weight for node, (weight, _) in found.items()})[
                0
            ]
            with np.errstate(divide="ignore", invalid="ignore"):
                strain = np.where(mesh.is_joint, 0.0, tension[1:-1] / mesh.axial_stiffness)
            longer = float(np.sum((strain * mesh.length + travels(mesh, tension[1:-1]))[reamer.node :]))
            end = hole_depth(model.case) - (mesh.total_length - mesh.node_depth[-1]) + bit.depth_for(wob)
            depth = end - (mesh.node_depth[-1] - mesh.node_depth[reamer.node]) - longer
            found[reamer.node] = reamer.weight_and_torque_at(float(depth))
        return found


def march(
    model: DrillingModel,
    motion: tuple[float, float],
    coils: bool = True,
    wob: float | None = None,
    rates: FloatArray | None = None,
) -> March | None:
    """March from the bit up; None without contact.

    motion: axial velocity [m/s, down positive] and rotation [rad/s] that friction opposes.
    coils: the string coils if the push suffices; otherwise it stays straight in the hole.
    wob: weight on bit [N]; None takes that of the case.  Under a top that is held, and without a weight in the case, the
    weight is what the string leaves on the bottom that it stands on, whatever ``wob`` is.  An end that is clamped or
    pinned stays at its place.
    rates: of a steady motion that the mud sees, as of ``nodal_loads``.
    The string must lie unstrained along the hole, its top at ``top_depth``.  Collective; the same on all ranks.
    """
    if model.contact is None:
        return None
    marcher, case, start = _Marcher(model, motion, coils, rates), model.case, top_depth(model)
    weight = (case.initial.wob or 0.0) if wob is None else wob
    if model.bit is None:
        if end_is_held(model) and case.top.force is not None:
            bottom = _bottom_force(marcher.column, most=LARGEST_PULL)
            # pushed in a vertical hole it has no side to lie on: its relaxation from the axis needs no side loads that stay
            if bottom > 0 or is_slanted(model):
                return _pulled(marcher, bottom, start)
        elif end_is_held(model) and model.top.prescribes:
            return _closed(marcher, start)
        return marcher.result(-weight, weight, start)
    if case.top.force is not None:
        bottom = _bottom_force(marcher.column)
        return marcher.result(bottom, max(weight, -bottom), start if bottom >= -1.0 else None)
    if case.initial.wob is not None:
        return marcher.result(-weight, weight, None)
    return _closed(marcher, start) if stands(model) else marcher.result(-weight, weight, start)


def helix_band(
    model: DrillingModel, motion: tuple[float, float], rates: FloatArray | None = None
) -> HelixBand | None:
    """What a string that slides transmits by theory, as it coils early or late; None if that is the same, or not wanted.

    Between ``HELIX_FACTORS`` a pipe on the wall may snake or coil, which its history decides.  The helix presses on the wall
    with r F^2/4EI, and friction takes its share.  rates: as of ``nodal_loads``.  The string must lie unstrained along the
    hole.  Collective.
    """
    case = model.case
    if model.contact is None or not motion[0] or motion[1] or stands(model):
        return None
    column, values, push = _Marcher(model, motion, True, rates).column, [], 1.0
    for factor in HELIX_FACTORS:
        if case.top.force is not None:
            if model.bit is None:
                return None
            bottom = _bottom_force(column, factor)
            values.append(-bottom)
            push = max(push, abs(float(case.top.force.value(0.0))))
        else:
            tension, _, _, locked = column.run(-(case.initial.wob or 0.0), factor)
            if locked is not None:
                return None
            values.append(float(tension[0]))
            push = max(push, -float(tension.min()))
    low, high = min(values), max(values)
    if high - low < NO_BAND * push:
        return None
    return HelixBand("wob" if case.top.force is not None else "hook_load", low, high)


def _pulled(marcher: _Marcher, bottom: float, top: float) -> March:
    """The march of a string whose lower end is held with the force ``bottom`` [N], and whose top follows from measured depth ``top`` [m]."""
    end, found = float(marcher.depth[-1]), marcher.result(bottom, 0.0, top)
    for _ in range(BEND_ROUNDS):  # what bends shorten depends on the place
        top += end - float(found.measured_depth[-1])
        found = marcher.result(bottom, 0.0, top)
    return found


def _closed(marcher: _Marcher, top: float) -> March:
    """The march of a string between a held top, at measured depth ``top`` [m], and a lower end that is held, or stands on the bottom.

    The push on the lower end (negative: pull) closes the gap below it, which grows with the push.  A bit may hang above the bottom.
    """
    model, mesh, bit = marcher.model, marcher.model.mesh, marcher.model.bit
    end = float(marcher.depth[-1])
    if bit is not None:
        end = hole_depth(model.case) - (mesh.total_length - mesh.node_depth[-1])

    def gap_under(push: float) -> tuple[float, March]:
        """Distance [m] from the lower end down to where it carries ``push`` [N], and the march under it."""
        found = marcher.result(-push, 0.0 if bit is None else push, top)
        depth = end if bit is None else end + bit.depth_for(push)
        return depth - float(found.measured_depth[-1]), found

    gap, found = gap_under(0.0)
    if gap == 0.0 or (bit is not None and gap > 0):  # the bit hangs free above the bottom
        return found
    most = 2 * CRUSHING_STRAIN * float(mesh.axial_stiffness[~mesh.is_joint].max())
    compliance = axial_compliance(mesh)
    near, far = 0.0, -gap / compliance
    # friction and coils make the string softer or stiffer than its pipe: the guess need not reach beyond the root
    while (there := gap_under(far))[0] * gap > 0:
        if abs(far) > most:
            return there[1]  # no push shortens the string that much
        near, far = far, 2 * far
    return gap_under(
        bracketed_root(lambda push: gap_under(push)[0], near, far, STANDING_TOLERANCE / compliance, 1e-6)
    )[1]


def axial_compliance(mesh: StringMesh) -> float:
    """Elongation [m/N] of the string under a unit pull."""
    pipe = ~mesh.is_joint
    return float(np.sum(mesh.length[pipe] / mesh.axial_stiffness[pipe]))


def stands(model: DrillingModel) -> bool:
    """Whether the bit may stand on the bottom under a top that is held, with a weight that no one gives."""
    case = model.case
    return (
        model.bit is not None and model.top.prescribes and case.initial.wob is None and case.top.force is None
    )


def with_contact(
    model: DrillingModel,
    found: March,
    motion: tuple[float, float],
    contact: FloatArray,
    push: float | None = None,
) -> March:
    """``found`` with the axial force, torque, stretch and twist that belong to the contact forces (n,) [N].

    motion: as of ``march``.  push: of the bottom on the bit [N], None: as before.
    The bit stays where it is, or the top where its force is given, or where the bit stands under a held top.
    """
    mesh, case = model.mesh, model.case
    drag, around = friction_factors(model, motion)
    more = contact - found.contact_force
    change = -np.append(np.cumsum((drag * more)[::-1])[::-1], 0.0)
    if push is not None:
        change -= push + found.axial_force[-1]
    if case.top.force is not None:
        change -= change[0]  # the top is given, so the bit feels the difference
    tension = found.axial_force + change
    torque = found.torque + np.append(np.cumsum((around * more)[::-1])[::-1], 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        before, strain = (
            np.where(mesh.is_joint, 0.0, q[1:-1] / mesh.axial_stiffness) for q in (found.axial_force, tension)
        )
        twist = np.where(mesh.is_joint, 0.0, torque[1:-1] * mesh.length / mesh.torsional_stiffness)
    more_travel = travels(mesh, tension[1:-1]) - travels(mesh, found.axial_force[1:-1])
    down = np.concatenate([[0.0], np.cumsum((strain - before) * mesh.length + more_travel)])
    follows = case.top.force is not None and (model.bit is not None or end_is_held(model))
    if follows or (model.bit is not None and case.initial.wob is not None):
        down -= down[-1]  # the bit stays on the bottom, or a held end at its place, and the top follows
    above, below = _nodal_strains(mesh, strain)
    moved = moved_along(model, found, down)
    unit = moved.tangent / np.linalg.norm(moved.tangent, axis=1, keepdims=True)
    return replace(
        moved,
        axial_force=tension,
        effective_tension=found.effective_tension + change[1:-1],
        contact_force=contact,
        torque=torque,
        twist=-np.concatenate([[0.0], np.cumsum(twist)]),
        tangent=(1 + above)[:, None] * unit,
        ratio=(1 + below) / (1 + above),
    )


def moved_along(model: DrillingModel, found: March, down: FloatArray) -> March:
    """``found`` with its nodes moved along the axis of the hole by ``down`` (n,) [m], at the same place across it.

    A straight way would leave the wall of a bent hole: 0.1 m at 2 deg/30 m by 6 um, which carries 0.6 kN/m.
    """
    depth = found.measured_depth + down
    old = np.stack([found.direction, *frame_across(model, found.direction)], axis=1)  # (n, 3, 3)
    well, size = model.well, np.linalg.norm(found.tangent, axis=1, keepdims=True)
    assert well is not None
    centre, direction, _ = well.at(depth)
    new = np.stack([direction, *frame_across(model, np.asarray(direction))], axis=1)
    offset, tangent = (
        np.einsum("nk,nki->ni", np.einsum("nki,ni->nk", old, q), new) for q in (found.offset, found.tangent)
    )
    return replace(
        found,
        measured_depth=depth,
        direction=np.asarray(direction),
        offset=offset,
        position=np.asarray(centre) + offset,
        tangent=size * tangent / np.linalg.norm(tangent, axis=1, keepdims=True),
        top_motion=found.top_motion + float(down[0]),
    )


def friction_factors(
    model: DrillingModel, motion: tuple[float, float], depth: FloatArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """Compute axial friction and friction torque over the contact force, (n,) each [-, m], against ``motion``.

    depth: (n,) measured depth of the nodes in the hole [m]; None: unstrained.

    As in torque_drag: the slip direction has the axial speed and the speed of the circumference.  Below a downhole motor the
    string turns with the motor's speed, too.
    """
    mesh, well = model.mesh, model.well
    assert well is not None
    radius, spin = _radius(model), np.full(mesh.nodes, motion[1])
    if mesh.motor_cell is not None:
        spin[mesh.motor_cell + 1 :] += model.motor_speed
    at = mesh.node_depth + top_depth(model) if depth is None else depth
    mu = np.asarray(well.friction(at)).copy()
    own = np.append(mesh.friction, mesh.friction[-1])
    mu = np.where(np.isnan(own), mu, own)
    speed = np.hypot(motion[0], spin * radius)
    scale = np.divide(mu, speed, out=np.zeros(mesh.nodes), where=speed > 0)
    return motion[0] * scale, spin * scale * radius**2


def _radius(model: DrillingModel) -> FloatArray:
    """Outer radius (n,) [m] of the string at each node, that of a rigid item if there is one."""
    mesh = model.mesh
    radius = 0.5 * np.append(mesh.contact_diameter, mesh.contact_diameter[-1])
    for b in mesh.bodies:
        radius[b.node] = max(radius[b.node], b.radius)
    return radius


def _bottom_force(column: _Column, coils_above: float = HELIX_FACTOR, most: float = 0.0) -> float:
    """Find the axial force at the bottom [N] that belongs to the given force at the top; at most ``most``.

    The top's load is among the loads of the first node, so the tension above it vanishes.
    """

    def top(bottom: float) -> float:
        return float(column.run(bottom, coils_above)[0][0])

    if top(most) <= 0:  # friction takes the push, or the top pulls
        return most
    return (
        -LARGEST_PULL if top(-LARGEST_PULL) > 0 else bracketed_root(top, -LARGEST_PULL, most, FORCE_TOLERANCE)
    )


def _nodal_strains(mesh: StringMesh, strain: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Axial strain above and below each node, (n,) each, from that in the middle of the elements (n-1,).

    It is linear along a pipe; it jumps at junctions and joints.
    """
    L, elements = mesh.length, len(strain)
    whole = ~mesh.is_joint
    inner = np.zeros(mesh.nodes, dtype=bool)
    inner[1:-1] = whole[1:] & whole[:-1]
    if len(mesh.junction):
        inner &= ~mesh.junction
    at = np.zeros(mesh.nodes)
    both = np.flatnonzero(inner)
    at[both] = (strain[both - 1] * L[both] + strain[both] * L[both - 1]) / (L[both - 1] + L[both])
    upper, lower = at[:-1].copy(), at[1:].copy()
    ends = ~inner[:-1], ~inner[1:]
    upper[ends[0]] = np.where(ends[1], strain, 2 * strain - lower)[ends[0]]
    lower[ends[1]] = np.where(ends[0], strain, 2 * strain - at[:-1])[ends[1]]
    above, below = np.append(upper[0], lower), np.append(upper, lower[-1])
    joint = np.flatnonzero(mesh.is_joint)
    below[joint], above[joint + 1] = above[joint], below[np.minimum(joint + 1, elements)]
    return above, below
