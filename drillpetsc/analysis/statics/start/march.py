"""Start of statics: axial force and torque of the string in its hole, marched from the bit up, and the place of its nodes.

Manual: sec-statics-march.  The loads of each node are the rows of the model itself, with the string
unstrained along the hole, so that mud, pressure, rigid items and loads are contained.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from drillpetsc.analysis.statics.checks.slider_travel import travels
from drillpetsc.analysis.statics.placement import end_is_held, is_slanted, top_depth
from drillpetsc.arrays import FloatArray, halves_at_nodes, sums_from_below
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.frames import directors
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.model.hole import hole_depth
from drillpetsc.output.measured.flow_recorder import flow_recorder
from drillpetsc.output.static_table import at_nodes
from drillpetsc.parallel import total
from drillpetsc.physics.contact import penetration
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
LARGEST_PULL = 1e7  # [N] that is sought below a string whose lower end is held
BEND_ROUNDS = 4  # of place and shortening by the bends of the hole
STANDING_TOLERANCE = 1e-6  # way that is left of the bit of a held string to the bottom [m]
FORCE_TOLERANCE = 1e-3  # at the bottom under a given force at the top [N]
CRUSHING_STRAIN = 0.01  # a push that compresses the string by more means that no push passes [-]
LEFT_OUT = (
    "contact",
    "body_contact",
    "bit_contact",
    "bit_rock",
    "reamer",
)  # first words of kernels whose forces are no loads


@dataclass
class March:
    """Forces along a string in its hole, and the place of its nodes under them; node arrays (n,) unless said otherwise.

    string: its loads and stiffnesses.
    axial_force: (n+1,) EA times the axial strain above node 0, of each element, and below the last node [N].
    contact_force: on the wall [N]; coiling: push over that at which the string coils there [-].
    torque: (n+1,) as the axial force [N m].
    shape: (n, 4) offsets [m] from the axis of the hole and slopes [-] against it, along both directors at zero spin.
    top_on_wall: whether the string lies on the wall at its top.
    end: measured depth at which the lower end is kept [m]; None: the top is.
    locked: node below which no push passes, None: it passes.

    What follows: measured_depth of the nodes [m]; centre: (n, 3) of the hole there; axes: (n, 3, 3) its tangent and both directors;
    offset, position, tangent: (n, 3) of the start [m, m, -]; ratio: of the stretch below a junction to that above [-];
    twist: spin angle [rad]; top_motion: distance that the top is moved down [m].
    """

    string: Marcher
    axial_force: FloatArray
    contact_force: FloatArray
    torque: FloatArray
    coiling: FloatArray
    shape: FloatArray
    top_on_wall: bool = False
    end: float | None = None
    locked: int | None = None
    measured_depth: FloatArray = field(init=False)
    centre: FloatArray = field(init=False)
    axes: FloatArray = field(init=False)
    offset: FloatArray = field(init=False)
    position: FloatArray = field(init=False)
    tangent: FloatArray = field(init=False)
    ratio: FloatArray = field(init=False)
    twist: FloatArray = field(init=False)
    top_motion: float = field(init=False)

    def __post_init__(self) -> None:
        model, mesh, inner = self.string.model, self.string.model.mesh, self.axial_force[1:-1]
        pipe, helical = ~mesh.is_joint, self.helical
        strain, twist = np.zeros((2, len(inner)))
        np.divide(inner, mesh.axial_stiffness, out=strain, where=pipe)
        np.divide(self.torque[1:-1] * mesh.length, mesh.torsional_stiffness, out=twist, where=pipe)
        # a helix is longer than the axis about which it winds
        coils = helical[:-1] & helical[1:] & pipe
        gap = 0.5 * (self.string.clearance[:-1] + self.string.clearance[1:])
        coil = gap**2 * np.maximum(-self.effective_tension, 0.0) / (4 * self.string.bending[:-1])
        longer = strain * mesh.length + travels(mesh, inner) - coils * coil * mesh.length
        short = np.zeros(len(inner))
        for _ in range(BEND_ROUNDS):  # where the hole's curvature changes, it depends on the place
            below = np.append(0.0, np.cumsum(longer - short)) + mesh.node_depth
            self.top_motion = self.string.start if self.end is None else self.end - float(below[-1])
            self.measured_depth = below + self.top_motion
            self.centre, self.axes = hole_axes(model, self.measured_depth)
            short = ~coils * self._shortening()
        self.offset = np.einsum("np,npi->ni", self.shape[:, :2], self.axes[:, 1:])
        self.position = self.centre + self.offset
        direction = self.axes[:, 0] + np.einsum("np,npi->ni", self.shape[:, 2:], self.axes[:, 1:])
        above, under = _nodal_strains(mesh, strain)
        self.tangent = ((1 + above) / np.linalg.norm(direction, axis=1))[:, None] * direction
        self.ratio = (1 + under) / (1 + above)
        self.twist = -np.append(0.0, np.cumsum(twist))

    def _shortening(self) -> FloatArray:
        """By how much the shape shortens the elements (n-1,) [m].

        The mean square of the slope in each element, by Simpson's rule, less the offset towards the inside of a bend.
        """
        mesh, across, slope = self.string.model.mesh, self.shape[:, :2], self.shape[:, 2:]
        L = mesh.length_divisor[:, None]
        middle = 1.5 * np.diff(across, axis=0) / L - 0.25 * (slope[1:] + slope[:-1])
        square = np.sum(slope[:-1] ** 2 + 4 * middle**2 + slope[1:] ** 2, axis=1) / 6
        return (0.5 * square - np.sum(self.bend() * 0.5 * (across[1:] + across[:-1]), axis=1)) * mesh.length

    def bend(self) -> FloatArray:
        """Mean curvature (n-1, 2) [1/m] of the hole along both directors."""
        turn = np.diff(self.axes[:, 0], axis=0) / self.string.model.mesh.length_divisor[:, None]
        return np.asarray(np.einsum("epi,ei->ep", 0.5 * (self.axes[1:, 1:] + self.axes[:-1, 1:]), turn))

    @property
    def helical(self) -> np.ndarray:
        """(n,) whether the string coils."""
        return np.asarray(self.coiling > 1)

    @property
    def effective_tension(self) -> FloatArray:
        """(n-1,) tension of the elements that buckles them; the axial force without mud [N]."""
        return self.axial_force[1:-1] + self.string.wet

    @property
    def side_load(self) -> FloatArray:
        """(n, 3) load across the hole, of weight, flow and tension in its curvature [N]."""
        return self.string.side_load(self.axial_force)

    def with_contact(self, contact: FloatArray, below: float | None = None) -> March:
        """The march with the axial force and torque that belong to the contact forces (n,) [N].

        below: axial force below the string [N], None: as before.
        """
        string, more = self.string, contact - self.contact_force
        change = -sums_from_below(string.drag * more)
        if below is not None:
            change += below - self.axial_force[-1]
        if string.model.case.top.force is not None:
            change -= change[0]  # the top is given, so the bit feels the difference
        torque = self.torque + sums_from_below(string.around * more)
        return replace(self, axial_force=self.axial_force + change, contact_force=contact, torque=torque)


@dataclass(frozen=True)
class HelixBand:
    """Band [N] of what a string transmits: ``wob`` under a given force at the top, else ``hook_load``."""

    name: str
    low: float
    high: float


def hole_axes(model: DrillingModel, depth: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Axis of the hole (n, 3), and its tangent with both directors at zero spin (n, 3, 3), at the ``depth`` (n,) [m] of the nodes."""
    centre, tangent, _ = (np.asarray(q) for q in model.given_well.at(depth))
    nodes = np.arange(len(depth))
    return centre, np.stack([tangent, *directors(model.frames, nodes, tangent, np.zeros(len(depth)))], axis=1)


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


class Marcher:
    """Loads and stiffnesses of a string along its hole, and its march from any force below it.

    motion: axial velocity [m/s, down positive] and rotation [rad/s] that friction opposes.
    rates: of a steady motion that the mud sees, as of ``nodal_loads``.
    The string must lie unstrained along the hole, its top at ``top_depth``.  Collective; the same on all ranks.

    start: measured depth of the top [m], depth: (n,) of the nodes.  drag, around: (n,) axial friction and friction torque over the
    contact force [-, m]; the slip direction has the axial speed and the speed of the circumference.
    across: (n, 3) load across the hole [N], without the tension in its curvature.
    """

    def __init__(self, model: DrillingModel, motion: tuple[float, float], rates: FloatArray | None = None):
        mesh, well = model.mesh, model.given_well
        self.model, self.start = model, top_depth(model)
        self.depth = depth = mesh.node_depth + self.start
        force, self.load_torque = nodal_loads(model, rates)
        t = np.asarray(well.at(depth)[1])
        self.half = halves_at_nodes(mesh.length)
        middle = np.concatenate([[depth[0]], 0.5 * (depth[1:] + depth[:-1]), [depth[-1]]])
        self.turn = np.diff(np.asarray(well.at(middle)[1]), axis=0)  # of the hole over each node's own length
        along = np.sum(force * t, axis=1)
        self.across = force - along[:, None] * t
        self.bending = np.append(mesh.bending_stiffness, mesh.bending_stiffness[-1])
        # a joint has no stiffness, with which its node would coil first
        self.bending[:-1][mesh.is_joint] = mesh.bending_stiffness[~mesh.is_joint].max()
        radius = 0.5 * np.append(mesh.contact_diameter, mesh.contact_diameter[-1])
        for b in mesh.bodies:
            radius[b.node] = max(radius[b.node], b.radius)
        self.clearance = np.maximum(np.asarray(well.radius(depth)) - radius, 0.0)
        # below a downhole motor the string turns with the motor's speed, too
        below_motor = mesh.nodes if mesh.motor_cell is None else mesh.motor_cell + 1
        spin = motion[1] + model.motor_speed * (np.arange(mesh.nodes) >= below_motor)
        own = np.append(mesh.friction, mesh.friction[-1])
        friction = np.where(np.isnan(own), well.friction(depth), own)
        speed = np.hypot(motion[0], spin * radius)
        scale = np.divide(friction, speed, out=np.zeros(mesh.nodes), where=speed > 0)
        self.drag, self.around = motion[0] * scale, spin * scale * radius**2
        self.motion, self.turning = motion, motion[1] + model.motor_speed
        self.weight = np.linalg.norm(force, axis=1) / np.maximum(self.half, 1e-9)
        axial = np.where(mesh.is_joint, mesh.axial_stiffness[~mesh.is_joint].max(), mesh.axial_stiffness)
        self.wet = pressure_tension(model)
        columns = (
            along,
            self.drag,
            np.sum(self.turn**2, axis=1),
            np.sum(self.turn * self.across, axis=1),
            np.sum(self.across**2, axis=1),
            self.half,
            self.bending,
            np.maximum(self.clearance, 1e-3),
            VERTICAL_FACTOR * np.cbrt(self.bending * self.weight**2),
            CRUSHING_STRAIN * np.append(axial, axial[-1]),
            at_nodes(self.wet, self.wet),
        )
        self._rows = np.column_stack(columns).tolist()

    def side_load(self, tension: FloatArray) -> FloatArray:
        """Load (n, 3) across the hole [N] with the ``tension`` (n+1,) [N] above and below the nodes."""
        return 0.5 * (tension[:-1] + tension[1:])[:, None] * self.turn + self.across

    def _run(
        self, bottom: float, coils_above: float | None, standing: dict[int, float] | None = None
    ) -> tuple[FloatArray, FloatArray, FloatArray, int | None]:
        """Return tension (n+1,), contact force (n,), push over that at which the string coils (n,), and the node of lock-up, from the
        force below.

        coils_above: axial force above which a string on the wall coils, over sqrt(EI w/r); None: it stays straight.
        standing: weights [N] that stand on the hole above its bottom, by their nodes.
        """
        standing = standing or {}
        n = len(self._rows)
        tension, contact, coiling, locked = np.empty(n + 1), np.empty(n), np.zeros(n), None
        tension[n] = below = bottom
        for i in range(n - 1, -1, -1):
            load, drag, kk, kw, ww, length, bending, clearance, vertical, crushing, wet = self._rows[i]
            load -= standing.get(i, 0.0)
            above, total, times = below + load, 0.0, 0.0
            for _ in range(
                3
            ):  # friction changes the mean tension by which the wall pushes; each round leaves little of that
                mean = 0.5 * (below + above)
                side = max(kk * mean * mean + 2 * kw * mean + ww, 0.0) ** 0.5
                push, coil, times = -mean - wet, 0.0, 0.0
                if coils_above is not None and push > 0 and length > 0:
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

    def march(self, coils: bool = True, wob: float | None = None) -> March:
        """March from the bit up; arguments as of ``march``."""
        model, case = self.model, self.model.case
        factor = HELIX_FACTOR if coils else None
        weight = (case.initial.wob or 0.0) if wob is None else wob
        if model.bit is None:
            if end_is_held(model) and case.top.force is not None:
                bottom = self._bottom_force(factor, LARGEST_PULL)
                # pushed in a vertical hole it has no side to lie on: its relaxation from the axis needs no side loads that stay
                if bottom > 0 or is_slanted(model):
                    return self._from(bottom, 0.0, factor, float(self.depth[-1]))
            elif end_is_held(model) and model.top.prescribes:
                return self._closed(factor)
        elif case.top.force is not None:
            bottom = self._bottom_force(factor)
            weight = max(weight, -bottom)
            return self._from(bottom, weight, factor, None if bottom >= -1.0 else self._on_bottom(weight))
        elif case.initial.wob is not None:
            return self._from(-weight, weight, factor, self._on_bottom(weight))
        elif stands(model):
            return self._closed(factor)
        return self._from(-weight, weight, factor)

    def band(self) -> HelixBand | None:
        """What a string that slides transmits by theory, as it coils early or late; None if that is the same, or not wanted.

        Between ``HELIX_FACTORS`` a pipe on the wall may snake or coil, which its history decides.  The helix presses on the wall
        with r F^2/4EI, and friction takes its share.
        """
        case, values, push = self.model.case, [], 1.0
        if not self.motion[0] or self.motion[1] or stands(self.model):
            return None
        for factor in HELIX_FACTORS:
            if case.top.force is not None:
                if self.model.bit is None:
                    return None
                values.append(-self._bottom_force(factor))
                push = max(push, abs(float(case.top.force.value(0.0))))
            else:
                tension, _, _, locked = self._run(-(case.initial.wob or 0.0), factor)
                if locked is not None:
                    return None
                values.append(float(tension[0]))
                push = max(push, -float(tension.min()))
        low, high = min(values), max(values)
        if high - low < NO_BAND * push:
            return None
        return HelixBand("wob" if case.top.force is not None else "hook_load", low, high)

    def _on_bottom(self, wob: float) -> float:
        """Measured depth [m] of the lower end of a string whose bit carries ``wob`` [N]."""
        mesh, bit = self.model.mesh, self.model.bit
        assert bit is not None
        return (
            hole_depth(self.model.case)
            - (mesh.total_length - float(mesh.node_depth[-1]))
            + bit.depth_for(wob)
        )

    def _from(self, bottom: float, wob: float, factor: float | None, end: float | None = None) -> March:
        """The march from the axial force ``bottom`` [N] below the string.

        wob: weight on bit, of which its torque is [N].  end: as of ``March``.
        """
        model = self.model
        reamers = (
            self._standing_reamers(bottom, wob, factor) if end is not None and model.bit is not None else {}
        )
        weights = {node: weight for node, (weight, _) in reamers.items()}
        tension, contact, coiling, locked = self._run(bottom, factor, weights)
        steps = self.around * contact - self.load_torque
        for node, (_, rocks) in reamers.items():
            steps[node] += rocks * np.sign(self.around[node])
        # rows are loads on the string: from the bit up, each node adds what it takes from the pipe above
        rock = 0.0 if model.bit is None else model.bit.torque_for(wob, self.turning) * np.sign(self.turning)
        torque = sums_from_below(steps) + rock
        on_wall = bool(
            contact[0] > LATERAL_LOAD_THRESHOLD * self.weight[1] * self.half[0] and coiling[0] <= 1
        )
        # the loads press the string to its place on the wall
        load, law = self.side_load(tension), model.given_contact.law
        size, deep = np.linalg.norm(load, axis=1), self.clearance
        if law.law == "linear":
            deep = deep + penetration(contact / np.maximum(self.half, 1e-9) / law.stiffness)
        share = np.divide(deep, size, out=np.zeros_like(size), where=size > 1e-6 * size.max(initial=0.0))
        shape = np.zeros((len(size), 4))
        shape[:, :2] = np.einsum("npi,ni->np", hole_axes(model, self.depth)[1][:, 1:], share[:, None] * load)
        if not size.any():  # no side load shows a string without weight where to lie: it winds
            push = np.maximum(-tension[1:-1] - self.wet, 0.0)
            turn = np.append(0.0, np.cumsum(np.sqrt(push / (2 * self.bending[:-1])) * model.mesh.length))
            shape[:, :2] = ((coiling > 1) * deep)[:, None] * np.column_stack([np.cos(turn), np.sin(turn)])
        shape[0] *= on_wall
        return March(self, tension, contact, torque, coiling, shape, on_wall, end, locked)

    def _standing_reamers(
        self, bottom: float, wob: float, factor: float | None
    ) -> dict[int, tuple[float, float]]:
        """Weight [N] and torque [N m] of the reamers under the force ``bottom`` [N] below the string, by their nodes.

        The bit and the string below a reamer determine its depth; a reamer above does not count.
        """
        model, mesh = self.model, self.model.mesh
        found: dict[int, tuple[float, float]] = {}
        for reamer in reversed(model.parts(Reamer)):
            weights = {node: weight for node, (weight, _) in found.items()}
            inner = self._run(bottom, factor, weights)[0][1:-1]
            strain = np.divide(inner, mesh.axial_stiffness, out=np.zeros_like(inner), where=~mesh.is_joint)
            longer = float(np.sum((strain * mesh.length + travels(mesh, inner))[reamer.node :]))
            above = float(mesh.node_depth[-1] - mesh.node_depth[reamer.node])
            found[reamer.node] = reamer.weight_and_torque_at(self._on_bottom(wob) - above - longer)
        return found

    def _bottom_force(self, factor: float | None, most: float = 0.0) -> float:
        """Find the axial force at the bottom [N] that belongs to the given force at the top; at most ``most``.

        The top's load is among the loads of the first node, so the tension above it vanishes.
        """

        def top(bottom: float) -> float:
            return float(self._run(bottom, factor)[0][0])

        if top(most) <= 0:  # friction takes the push, or the top pulls
            return most
        if top(-LARGEST_PULL) > 0:
            return -LARGEST_PULL
        return bracketed_root(top, -LARGEST_PULL, most, FORCE_TOLERANCE)

    def _closed(self, factor: float | None) -> March:
        """The march of a string between a held top and a lower end that is held, or stands on the bottom.

        The push on the lower end (negative: pull) closes the gap below it, which grows with the push.  A bit may hang above the bottom.
        """
        mesh, bit = self.model.mesh, self.model.bit

        def gap_under(push: float) -> tuple[float, March]:
            """Distance [m] from the lower end down to where it carries ``push`` [N], and the march under it."""
            found = self._from(-push, 0.0 if bit is None else push, factor)
            depth = float(self.depth[-1]) if bit is None else self._on_bottom(push)
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
        accuracy = STANDING_TOLERANCE / compliance
        return gap_under(bracketed_root(lambda push: gap_under(push)[0], near, far, accuracy, 1e-6))[1]


def march(
    model: DrillingModel, motion: tuple[float, float], coils: bool = True, wob: float | None = None
) -> March | None:
    """March from the bit up; None without contact.

    motion: axial velocity [m/s, down positive] and rotation [rad/s] that friction opposes.
    coils: the string coils if the push suffices; otherwise it stays straight in the hole.
    wob: weight on bit [N]; None takes that of the case.  Under a top that is held, and without a weight in the case, the
    weight is what the string leaves on the bottom that it stands on, whatever ``wob`` is.  An end that is clamped or
    pinned stays at its place.
    The string must lie unstrained along the hole, its top at ``top_depth``.  Collective; the same on all ranks.
    """
    return None if model.contact is None else Marcher(model, motion).march(coils, wob)


def place_marched(model: DrillingModel, found: March) -> None:
    """Put the string at the start that ``march`` found, and its top at the wall where the string is on it."""
    system, top = model.system, model.top
    if model.case.top.force is None:
        top.shift(found.top_motion)
    if found.top_on_wall:
        # the top is at the wall with the string: on the axis it would carry the first tens of metres, which
        # changes torque and drag of a short string by percents
        top.displace(found.offset[0])
    system.set_field("string.position", found.position)
    system.set_field("string.tangent", found.tangent)
    system.set_field("string.spin", found.twist[:, None])
    if "string.ratio" in system.layout.dofs:
        system.set_field("string.ratio", found.ratio[:, None])


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


def _nodal_strains(mesh: StringMesh, strain: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Axial strain above and below each node, (n,) each, from that of the elements (n-1,).

    It is continuous along a pipe; it jumps at junctions and joints.
    """
    above, below, L, pipe = (
        np.append(strain[0], strain),
        np.append(strain, strain[-1]),
        mesh.length,
        ~mesh.is_joint,
    )
    jumps = mesh.junction[1:-1] if len(mesh.junction) else np.zeros(mesh.nodes - 2, dtype=bool)
    inner = 1 + np.flatnonzero(pipe[1:] & pipe[:-1] & ~jumps)
    up, down = inner - 1, inner
    above[inner] = below[inner] = (strain[up] * L[down] + strain[down] * L[up]) / (L[up] + L[down])
    upper, lower, ends = below[:-1], above[1:], np.isin(np.arange(mesh.nodes), inner, invert=True)
    for one, other, alone in ((upper, lower, ends[:-1] & ~ends[1:]), (lower, upper, ends[1:] & ~ends[:-1])):
        one[alone] = (2 * strain - other)[alone]  # it is linear in an element
    joint = np.flatnonzero(mesh.is_joint)
    below[joint], above[joint + 1] = above[joint], below[joint + 1]
    return above, below
