"""Contact of the string with its hole: contact and friction along the pipe, of rigid items, and of the bit on
the bottom; stiffness of the wall from the moduli of rock and steel.

Manual: sec-contact, sec-contact-physical, sec-bit-on-bottom.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.bound_parts import BlockResults
from drillpetsc.fem.component import Component, ContactFlags, ElementBlock
from drillpetsc.fem.quadrature import exposed_ends, rule
from drillpetsc.fem.quantity import Quantity
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.well import Well
from drillpetsc.kernels import pointer
from drillpetsc.kernels.parameters import Parameters, columns, constant, structure
from drillpetsc.physics import quantities as declared
from drillpetsc.physics.beam import JUNCTION_SLOTS, SLOTS
from drillpetsc.physics.own_law import OwnLaw
from drillpetsc.physics.rigid_bodies import VERTEX_SLOTS, local_vertices
from drillpetsc.physics.roots import bracketed_root

_Law = structure("contact_law")  # ContactLaw of kernels/contact/contact.hpp
RESULTS = columns("contact_results")
_NORMAL = RESULTS["normal"]
_STORED, _DAMPED, _RUBBED = (RESULTS[name] for name in ("stored", "damping_power", "friction_power"))


@dataclass(frozen=True)
class ContactLaw:
    """Constants of the wall contact.

    stiffness: per unit length [N/m^2] (``linear``), [N/m^2.5] (``hertz``), or per point [N/m^1.5]
    (``hertz_point``).
    law: one of these three (manual: eq-contact-normal).
    restitution: coefficient [-] at ``restitution_speed`` [m/s] (manual: eq-contact-restitution).
    slip_velocity: regularisation of Coulomb's law [m/s] (manual: eq-contact-friction).
    static_ratio: mu_static / mu [-]; stribeck_speed: [m/s] (manual: eq-contact-stribeck).
    points: contact points of an element.
    own: law of the user for the friction coefficient, None: Coulomb's law.
    """

    stiffness: float = 1.0e8
    law: str = "linear"
    restitution: float = 0.5
    restitution_speed: float = 1.0
    slip_velocity: float = 0.01
    static_ratio: float = 1.0
    stribeck_speed: float = 1.0
    points: int = 2
    own: OwnLaw | None = None


def impact_depth(law: ContactLaw, mass: float, length: float) -> float:
    """Compute the penetration [m] of an undamped impact at ``restitution_speed`` v.

    Manual: eq-contact-impact-depth.

    The energy m v^2/2 becomes the stored energy k d^(p+1)/(p+1), so d = ((p+1) m v^2 / 2k)^(1/(p+1)).  With a
    law per point m is the mass of an element divided by its points.

    mass: per length [kg/m]; length: of an element [m].
    """
    power = 1.0 if law.law == "linear" else 1.5
    share = mass * length / law.points if law.law == "hertz_point" else mass
    return float((0.5 * (power + 1) * share * law.restitution_speed**2 / law.stiffness) ** (1 / (power + 1)))


def damping_factor(restitution: float, speed: float) -> float:
    """Compute the damping factor c [s/m] for a given restitution.

    Manual: eq-contact-damping, eq-contact-restitution.

    The contact force has the factor 1 + c * penetration rate.  With d = c speed the rebound is exact for any
    exponent: d (1 + e) = ln((1 + d) / (1 - d e)), from m u du = -k (1 + c u) f dx.

    restitution: coefficient e [-], above 0; speed: of the impact [m/s].
    Raises ValueError for a restitution of 0 or less.
    """
    e = restitution
    if e >= 1.0:
        return 0.0
    if e <= 0.0:
        raise ValueError(
            "restitution must be above 0: a perfectly plastic impact needs an infinite damping factor"
        )

    def miss(d: float) -> float:
        return float(np.log1p(d) - np.log1p(-d * e) - d * (1 + e))

    if miss((1 - 1e-14) / e) < 0:  # below e = 0.027: 1 - d e = (1 + d) exp(-d (1 + e)) is less than rounding
        return 1 / e / speed
    # d = 0 is also a root; near e = 1 the other one is 3/2 (1 - e) (1 + (1 - e) + ...), by the series of the
    # logarithms
    if 1 - e < 1e-4:
        return 1.5 * (1 - e) * (2 - e) / speed
    return bracketed_root(miss, 0.5 * (1 - e), (1 - 1e-14) / e, absolute=1e-14, relative=1e-14) / speed


CALLS = 3  # evaluations of a contact point in one call of a kernel, at most: those of its Jacobian below a junction

ONSET = constant("contact_onset")  # half width of the onset [m] (manual: eq-contact-onset)


def penetration(linear: ArrayLike) -> FloatArray:
    """Compute the penetration [m] at which the wall carries a force, from the penetration of a wall without onset.

    The onset is a parabola, (d + e)^2/4e for |d| < e (manual: eq-contact-onset).
    """
    d = np.asarray(linear, dtype=float)
    return np.where(d > ONSET, d, 2 * np.sqrt(ONSET * np.maximum(d, 0.0)) - ONSET)


class Contact(Component):
    """Contact of pipes and rigid items with the wall.

    mesh: of the string; well: the hole; law: constants of the contact.
    with_bit: include the bit; a cutting bit has a separate contact (physics/bit/rock_bit.py).
    free_top: the upper end of the string is free.
    hardness: stiffness of the wall at each element (n,) and each rigid item (bodies,), relative to the law [-]; None: the law's stiffness.
    """

    name = "contact"
    RESULTS = RESULTS  # columns of ``element_results``
    has_contact = True
    #: kernel, slots and ends with spins of an element that is not below a rigid item
    _element: tuple[str, tuple[tuple[str, int], ...], tuple[int, ...]] = ("contact", SLOTS, (0, 1))

    def __init__(
        self,
        mesh: StringMesh,
        well: Well,
        law: ContactLaw,
        with_bit: bool = True,
        free_top: bool = False,
        hardness: tuple[FloatArray, FloatArray] | None = None,
    ):
        self.hardness = hardness or (np.ones(len(mesh.upper)), np.ones(len(mesh.bodies)))
        self.mesh, self.well, self.law, self.with_bit, self.free_top = mesh, well, law, with_bit, free_top
        self._packed = np.ascontiguousarray(well.packed())
        length = float(mesh.length.sum())
        self.impact_depth = impact_depth(
            law, float(mesh.mass @ mesh.length) / length, length / len(mesh.length)
        )  # of the mean string
        self._damping = damping_factor(law.restitution, law.restitution_speed)
        self._laws: list[Any] = []
        self._driven: list[bool] = []  # of each law: whether a downhole motor turns its elements
        self._motor_cell = mesh.motor_cell
        self._keep: list[np.ndarray] = []
        self._free: list[FloatArray] = []

    def _context(self, count: int, ends: tuple[bool, bool], driven: bool = False) -> int:
        """Create the kernel's record for a block of ``count`` elements; returns its address.

        ends: the upper and the lower ends of its elements are exposed (``exposed_ends``).
        driven: a downhole motor turns the elements.
        """
        law, at = self.law, rule(self.law.points, *ends)
        n = count * len(at)
        normal, segment, touching = np.zeros(n), np.full(n, -1, dtype=np.int32), np.zeros(n, dtype=np.int8)
        free = np.zeros((n, 5))
        record = _Law(
            well=pointer(self._packed),
            stiffness=law.stiffness,
            exponent=1.0 if law.law == "linear" else 1.5,
            damping=self._damping,
            slip=law.slip_velocity,
            extra=law.static_ratio - 1.0,
            decay=law.stribeck_speed,
            side=1.0,
            per_point=int(law.law == "hertz_point"),
            points=len(at),
            at=pointer(at),
            normal=pointer(normal),
            segment=pointer(segment),
            touching=pointer(touching),
            free=pointer(free),
            own=None if law.own is None else law.own.record(CALLS * n),
        )
        self._laws.append(record)
        self._driven.append(driven)
        self._keep += [at, normal, segment]
        self._free.append(free)
        self._normal.append(normal.reshape(count, len(at)))
        self._touching.append(touching)
        return ctypes.addressof(record)

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        m = self.mesh
        self._part = part
        self._touching: list[np.ndarray] = []
        #: of a local cell: the table of normal forces and its row there, filled at the first use
        self._row_of: dict[int, tuple[FloatArray, int]] = {}
        self._normal: list[np.ndarray] = []
        self._blocks: list[ElementBlock] = []
        below_junction = m.below_junction
        friction = np.where(np.isnan(m.friction), -1.0, m.friction)
        touches = (m.contact_diameter > 0) & ~m.is_joint
        turned = np.zeros(len(m.upper), dtype=bool)
        if self._motor_cell is not None:
            turned[self._motor_cell + 1 :] = True
        groups = product((False, True), self._groups(), (False, True) if turned.any() else (False,))
        for below, (group, mask, ends), driven in groups:
            name = f"{group}_driven" if driven else group
            on_rank = (below_junction == below) & touches & mask & (turned == driven)
            if not on_rank.any():
                continue
            chosen = np.flatnonzero(on_rank[part.cells]).astype(np.int32)
            e = part.cells[chosen]
            kernel, slots, spins = ("contact_junction", JUNCTION_SLOTS, (0, 1)) if below else self._element
            params = Parameters(
                kernel,
                len(e),
                length=m.length[e],
                rigid=m.rigid_above[e],
                radius=0.5 * m.contact_diameter[e],
                friction=friction[e],
                hardness=self.hardness[0][e],
            )
            self._blocks.append(
                ElementBlock(
                    f"contact_junction{name}" if below else f"contact{name}",
                    kernel,
                    "cell",
                    chosen,
                    slots,
                    spins,
                    params.array,
                    context=self._context(len(chosen), ends, driven),
                    constants=(self.law, self._packed, rule(self.law.points, *ends)),
                    component="contact",
                    update=self._update,
                )
            )
        self._blocks += self._on_items(part)
        return tuple(self._blocks)

    @cached_property
    def own_laws(self) -> tuple[OwnLaw, ...]:
        return () if self.law.own is None else (self.law.own,)

    @property
    def _update(self) -> Callable[[float], None] | None:
        return None if self.law.own is None else self.law.own.at_time

    @property
    def remembers(self) -> bool:
        return bool(self.own_laws)

    def accept(self, t: float, state: Any) -> None:
        for law in self.own_laws:
            law.raise_error()

    def _on_items(self, part) -> list[ElementBlock]:
        """Create the blocks of the rigid items, above and below a downhole motor, if there are any."""
        bodies, last = self.mesh.bodies, self._motor_cell
        touching = [k for k, b in enumerate(bodies) if b.radius > 0 and (self.with_bit or b.kind != "bit")]
        self._items: list[np.ndarray] = []  # of this rank, by block: numbers in mesh.bodies
        above = [k for k in touching if last is None or bodies[k].node <= last]
        out = [self._item_block(part, above, "contact_bodies", False)] if above else []
        if len(above) < len(touching):
            below = [k for k in touching if k not in above]
            out.append(self._item_block(part, below, "contact_bodies_driven", True))
        return out

    def _item_block(self, part, touching: list[int], name: str, driven: bool) -> ElementBlock:
        """Create the block of rigid items, by their numbers in mesh.bodies."""
        bodies = self.mesh.bodies
        picked, vertices = local_vertices(part, np.array([bodies[k].node for k in touching]))
        items = np.array(touching, dtype=int)[picked]
        self._items.append(items)
        here = [bodies[k] for k in items]
        params = Parameters(
            "body_contact",
            len(here),
            above=[b.contact_above for b in here],
            length=[b.contact_length for b in here],
            span=[b.contact_span for b in here],
            radius=[b.radius for b in here],
            friction=[-1.0 if b.friction is None else b.friction for b in here],
            guided=[float(b.guided) for b in here],
            hardness=self.hardness[1][items],
        )
        return ElementBlock(
            name,
            "body_contact",
            "vertex",
            vertices,
            VERTEX_SLOTS,
            (0,),
            params.array,
            context=self._context(len(here), self._item_ends, driven),
            constants=(self.law, self._packed, rule(self.law.points, *self._item_ends)),
            component="contact",
            update=self._update,
        )

    @property
    def _item_ends(self) -> tuple[bool, bool]:
        """Whether upper and lower ends of rigid items are exposed: not with a law per point, whose points are
        tool joints.
        """
        stands = self.law.law != "hertz_point"
        return stands, stands

    def _groups(self) -> list[tuple[str, np.ndarray, tuple[bool, bool]]]:
        """Group the elements by their quadrature: name, mask (n,) and exposed ends.

        Elements without exposed ends come first.
        """
        upper, lower = exposed_ends(self.mesh, self.free_top)
        if self.law.law == "hertz_point":
            upper, lower = np.zeros_like(upper), np.zeros_like(lower)
        found = [
            (name, (upper == a) & (lower == b), (a, b))
            for name, a, b in (
                ("", False, False),
                ("_below", False, True),
                ("_above", True, False),
                ("_ends", True, True),
            )
        ]
        return [group for group in found if group[1].any()]

    def follow_hole(self, well: Well) -> None:
        """Use the wall of a borehole that has grown."""
        self.well = well
        self._packed = np.ascontiguousarray(well.packed())
        for record in self._laws:
            record.well = pointer(self._packed)
        for b in self._blocks:
            b.constants = self.law, self._packed, b.constants[-1]
        self._forget_clearances()

    def _forget_clearances(self) -> None:
        """Project all contact points again at the next evaluation: the wall may be nearer than it was."""
        for free in self._free:
            free[:, 4] = 0.0

    def impose_sliding_direction(
        self, axial: float, spin: float, side: float = 1.0, motor: float = 0.0
    ) -> None:
        """Let friction oppose a rigid motion of the string, for statics (manual: eq-contact-imposed).

        axial: velocity [m/s], down positive; spin: [rad/s].
        side: fraction of the lateral friction force; at 0 friction across the pipe has only its torque.
        motor: contribution of a downhole motor to the spin below it [rad/s].
        """
        for record, driven in zip(self._laws, self._driven, strict=True):
            record.imposed, record.axial, record.side = 1.0, axial, side
            record.spin = spin + motor if driven else spin
            record.slip, record.damping = self.law.slip_velocity, self._damping

    def copy_sliding_direction(self, other: Contact) -> None:
        """Copy the sliding direction that statics imposed on the contact of another model."""
        imposed = [
            (record, driven)
            for record, driven in zip(other._laws, other._driven, strict=True)
            if record.imposed
        ]
        if not imposed:
            self.release_sliding_direction()
            return
        above = next((record for record, driven in imposed if not driven), None)
        below = next((record for record, driven in imposed if driven), None)
        first = above or below
        assert first is not None
        motor = below.spin - above.spin if above is not None and below is not None else 0.0
        self.impose_sliding_direction(first.axial, first.spin, first.side, motor)

    def release_sliding_direction(self) -> None:
        """Let friction follow the actual motion."""
        for record in self._laws:
            record.imposed = record.axial = 0.0
            record.slip, record.damping = self.law.slip_velocity, self._damping

    def follow_overdamped_motion(self, speed: float, slip: float) -> None:
        """Let friction follow the actual motion past a moving hole; the wall has no damping.

        Manual: sec-statics-path.

        speed: of the string along the hole [m/s], down positive, added to the velocities of the state.
        slip: velocity over which Coulomb's law is rounded [m/s].
        """
        for record in self._laws:
            record.imposed, record.axial, record.slip, record.damping = 0.0, speed, slip, 0.0

    def set_stiffness(self, factor: float) -> None:
        """Scale the stiffness by ``factor`` [-] (continuation in statics; manual: sec-contact-continuation)."""
        for record in self._laws:
            record.stiffness = self.law.stiffness * factor

    def contact_flags(self) -> tuple[ContactFlags, ...]:
        pairs = zip(self._touching, self._laws[-len(self._touching) :], strict=True)
        return tuple(ContactFlags(touching, True, ctypes.addressof(law)) for touching, law in pairs)

    def _block_results(self, state) -> list[BlockResults]:
        """Results of each block: the columns of ``RESULTS``."""
        return [state.results(b, b.results_kernel, RESULTS.width) for b in self._blocks]

    def element_results(self, state) -> tuple[FloatArray, FloatArray]:
        """(nc, columns) per local cell and (nb, columns) per rigid item of this rank: the columns of ``RESULTS``."""
        cells, bodies = (
            np.zeros((len(self._part.cells), RESULTS.width)),
            [np.zeros((0, RESULTS.width))],
        )
        for b, results in zip(self._blocks, self._block_results(state), strict=True):
            if b.on == "cell":
                cells[b.points] = results.table
            else:
                bodies.append(results.table.copy())
        return cells, bodies[-1] if len(bodies) == 2 else np.vstack(bodies)

    def evaluate(self, state) -> None:
        """Compute all results at the present state."""
        self._block_results(state)

    def normal_forces_at(self, state) -> tuple[np.ndarray, np.ndarray]:
        """Addresses of the sums of normal forces [N] that ``evaluate`` computes: (nc,) of each local cell, (bodies,) of each rigid item,
        0 for none, and if another rank has it."""
        cells, bodies = (np.zeros(n, dtype=np.uintp) for n in (len(self._part.cells), len(self.mesh.bodies)))
        items = iter(self._items)
        for b, results in zip(self._blocks, self._block_results(state), strict=True):
            table = results.table
            at = pointer(table) + _NORMAL * table.itemsize + table.strides[0] * np.arange(len(table))
            if b.on == "cell":
                cells[b.points] = at
            else:
                bodies[next(items)] = at
        return cells, bodies

    def _sums_of(self, steps) -> list[FloatArray]:
        return [steps.sums(b, b.results_kernel, RESULTS.width) for b in self._blocks]

    def energies_of(self, steps) -> tuple[Any, Any, Any]:
        return 0.0, sum(sums[:, _STORED] for sums in self._sums_of(steps)), 0.0

    def powers_of(self, steps) -> tuple[Any, Any]:
        return sum(sums[:, _DAMPED] + sums[:, _RUBBED] for sums in self._sums_of(steps)), 0.0

    def item_results_of(self, steps) -> FloatArray:
        """(k, bodies, columns) results of each rigid item of the mesh after each of k steps, in the columns of ``RESULTS``; zero on
        ranks without the item."""
        out = np.zeros((len(steps), len(self.mesh.bodies), RESULTS.width))
        found = (b for b in self._blocks if b.on != "cell")
        for items, b in zip(self._items, found, strict=True):
            table = steps.results(b, b.results_kernel, RESULTS.width).table
            out[:, items] = steps.numbers(table, range(table.size)).reshape(len(steps), *table.shape)
        return out

    def normal_force_of(self, cell: int, steps) -> FloatArray:
        """(k,) normal force on a local cell in the last residual of each of k steps [N]."""
        if not self._row_of:
            self._row_of = {
                int(c): (normal, e)
                for b, normal in zip(self._blocks, self._normal, strict=True)
                if b.on == "cell"
                for e, c in enumerate(b.points)
            }
        if cell not in self._row_of:
            return np.zeros(len(steps))
        normal, row = self._row_of[cell]
        points = normal.shape[1]
        return np.asarray(steps.numbers(normal, range(row * points, (row + 1) * points)).sum(axis=1))

    def quantities(self) -> tuple[Quantity, ...]:
        return declared.CONTACT


STEEL_YOUNG, STEEL_POISSON = 206e9, 0.3  # [Pa], [-]
ROCK_POISSON = 0.25
THIN_WALL = 0.15  # wall over outer diameter below which a tube ovalises noticeably


def line_stiffness(
    load: ArrayLike, radius: ArrayLike, hole: ArrayLike, steel: ArrayLike, wall: float, poisson: float
) -> FloatArray:
    """Secant stiffness [Pa] of a cylinder pressed into the wall of a hole, line contact (manual: eq-contact-line).

    load: per length [N/m]; radius: of the cylinder [m]; hole: its radius, larger [m].
    steel, wall: Young's moduli [Pa] of cylinder and wall; poisson: of the wall.
    """
    P, a, b = (np.asarray(v, dtype=float) for v in (load, radius, hole))
    inner, outer = (1 - STEEL_POISSON**2) / np.asarray(steel, dtype=float), (1 - poisson**2) / wall
    width = np.sqrt(4 * P * (a * b / (b - a)) * (inner + outer) / np.pi)
    depth = inner * (2 * np.log(4 * a / width) - 1) + outer * (2 * np.log(4 * b / width) - 1)
    return np.asarray(np.pi / depth)


def ring_stiffness(outer: ArrayLike, inner: ArrayLike, young: ArrayLike) -> FloatArray:
    """Stiffness [Pa] of a tube against two opposite loads per length (manual: eq-contact-ring); infinite for thick tubes.

    outer, inner: diameters [m]; young: modulus [Pa].
    """
    D, d, E = (np.asarray(v, dtype=float) for v in (outer, inner, young))
    t = 0.5 * (D - d)
    stiffness = E / (1 - STEEL_POISSON**2) * t**3 / 12 / (0.149 * (0.5 * (D - t)) ** 3)
    return np.where((d > 0) & (t < THIN_WALL * D), stiffness, np.inf)
