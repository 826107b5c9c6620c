"""Contact of the string with its hole: contact and friction along the pipe, of rigid items, and of the bit on
the bottom.

Manual: sec-contact, sec-bit-on-bottom.
"""

from __future__ import annotations

import ctypes
import zlib
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.optimize import brentq

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.component import Component, ElementBlock, Energies, Powers
from drillpetsc.fem.quadrature import exposed_ends, rule
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.well import Well
from drillpetsc.kernels import function, pointer
from drillpetsc.physics.beam import SLOTS, SPLIT_SLOTS
from drillpetsc.physics.interfaces import Bit
from drillpetsc.physics.rigid_bodies import VERTEX_SLOTS, local_vertices

_report = function("contact_report", "iipppppp")
_bit_report = function("bit_report", "ppppp")
KINDS = {"contact": 0, "contact_split": 1, "body_contact": 2}  # of kernels, as contact_report numbers them
REPORT = ("normal", "stored", "damping_power", "friction_power", "penetration", "axial", "torque")


class _Law(ctypes.Structure):
    """ContactLaw of kernels/contact/contact.hpp."""

    _fields_ = (
        [("well", ctypes.c_void_p)]
        + [
            (n, ctypes.c_double)
            for n in (
                "stiffness",
                "exponent",
                "damping",
                "slip",
                "extra",
                "decay",
                "imposed",
                "axial",
                "spin",
                "side",
            )
        ]
        + [("per_point", ctypes.c_int), ("points", ctypes.c_int)]
        + [(n, ctypes.c_void_p) for n in ("at", "normal", "segment", "touching")]
    )


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
    """

    stiffness: float = 1.0e8
    law: str = "linear"
    restitution: float = 0.5
    restitution_speed: float = 1.0
    slip_velocity: float = 0.01
    static_ratio: float = 1.0
    stribeck_speed: float = 1.0
    points: int = 2


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
    # d = 0 is a root, too; near e = 1 the other one is 3/2 (1 - e) (1 + (1 - e) + ...), by the series of the
    # logarithms
    if 1 - e < 1e-4:
        return 1.5 * (1 - e) * (2 - e) / speed
    return float(brentq(miss, 0.5 * (1 - e), (1 - 1e-14) / e, xtol=1e-14, rtol=1e-14)) / speed


class Contact(Component):
    """Contact of pipes and rigid items with the wall (manual: sec-contact).

    mesh: of the string; well: the hole; law: constants of the contact.
    with_bit: include the bit; a bit that cuts has its own contact (physics/rock_bit.py).
    free_top: the upper end of the string is free.
    """

    name = "contact"
    has_contact = True

    def __init__(
        self, mesh: StringMesh, well: Well, law: ContactLaw, with_bit: bool = True, free_top: bool = False
    ):
        self.mesh, self.well, self.law, self.with_bit, self.free_top = mesh, well, law, with_bit, free_top
        self._packed = np.ascontiguousarray(well.packed())
        length = float(mesh.length.sum())
        self.impact_depth = impact_depth(
            law, float(mesh.mass @ mesh.length) / length, length / len(mesh.length)
        )  # of the mean string
        self._laws: list[_Law] = []
        self._keep: list[np.ndarray] = []

    def _context(self, count: int, ends: tuple[bool, bool]) -> int:
        """Create the kernel's record for a block of ``count`` elements; returns its address.

        ends: the upper and the lower ends of its elements are exposed (``exposed_ends``).
        """
        law, at = self.law, rule(self.law.points, *ends)
        n = count * len(at)
        normal, segment, touching = np.zeros(n), np.full(n, -1, dtype=np.int32), np.zeros(n, dtype=np.int8)
        record = _Law(
            pointer(self._packed),
            law.stiffness,
            1.0 if law.law == "linear" else 1.5,
            damping_factor(law.restitution, law.restitution_speed),
            law.slip_velocity,
            law.static_ratio - 1.0,
            law.stribeck_speed,
            0.0,
            0.0,
            0.0,
            1.0,
            int(law.law == "hertz_point"),
            len(at),
            pointer(at),
            pointer(normal),
            pointer(segment),
            pointer(touching),
        )
        self._laws.append(record)
        self._keep += [at, normal, segment]
        self._normal.append(normal.reshape(count, len(at)))
        self._touching.append(touching)
        return ctypes.addressof(record)

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        m = self.mesh
        self._part = part
        self._touching: list[np.ndarray] = []
        self._row_of: dict[int, FloatArray] | None = (
            None  # normal forces at the points of a local cell, filled at the first use
        )
        self._normal: list[np.ndarray] = []
        self._blocks: list[ElementBlock] = []
        junction = m.junction if len(m.junction) else np.zeros(m.nodes, dtype=bool)
        friction = np.where(np.isnan(m.friction), -1.0, m.friction)
        touches = (m.outer_diameter > 0) & ~m.is_joint
        for split, (name, mask, ends) in product((False, True), self._groups()):
            on_rank = (junction[:-1] == split) & touches & mask
            if not on_rank.any():
                continue
            chosen = np.flatnonzero(on_rank[part.cells]).astype(np.int32)
            e = part.cells[chosen]
            params = np.ascontiguousarray(
                np.column_stack([m.length[e], m.rigid_above[e], 0.5 * m.outer_diameter[e], friction[e]])
            )
            self._blocks.append(
                ElementBlock(
                    f"contact_junction{name}" if split else f"contact{name}",
                    "contact_split" if split else "contact",
                    "cell",
                    chosen,
                    SPLIT_SLOTS if split else SLOTS,
                    (0, 1),
                    params,
                    context=self._context(len(chosen), ends),
                    component="contact",
                )
            )
        self._blocks += self._on_items(part)
        return tuple(self._blocks)

    def _on_items(self, part) -> list[ElementBlock]:
        """Create the block of the rigid items, if there are any."""
        items = [b for b in self.mesh.bodies if b.radius > 0 and (self.with_bit or b.kind != "bit")]
        if not items:
            return []
        picked, vertices = local_vertices(part, np.array([b.node for b in items]))
        here = [items[k] for k in picked]
        params = np.array(
            [[b.above, b.length, b.radius, -1.0 if b.friction is None else b.friction] for b in here]
        ).reshape(-1, 4)
        return [
            ElementBlock(
                "contact_bodies",
                "body_contact",
                "vertex",
                vertices,
                VERTEX_SLOTS,
                (0,),
                np.ascontiguousarray(params),
                context=self._context(len(here), self._item_ends),
                component="contact",
            )
        ]

    @property
    def _item_ends(self) -> tuple[bool, bool]:
        """Whether upper and lower ends of rigid items are exposed: not with a law per point, whose points are
        tool joints.
        """
        stands = self.law.law != "hertz_point"
        return stands, stands

    def _groups(self) -> list[tuple[str, np.ndarray, tuple[bool, bool]]]:
        """Group the elements by their quadrature: name, mask (n,) and exposed ends.

        Those without exposed ends first.
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

    def impose_sliding_direction(self, axial: float, spin: float, side: float = 1.0) -> None:
        """Let friction oppose a rigid motion of the string, for statics (manual: eq-contact-imposed).

        axial: velocity [m/s], down positive; spin: [rad/s].
        side: fraction of the lateral friction force; at 0 friction across the pipe has only its torque.
        """
        for record in self._laws:
            record.imposed, record.axial, record.spin, record.side = 1.0, axial, spin, side

    def copy_sliding_direction(self, other: Contact) -> None:
        """Copy the sliding direction that statics imposed on the contact of another model."""
        imposed = next((record for record in other._laws if record.imposed), None)
        if imposed is None:
            self.release_sliding_direction()
        else:
            self.impose_sliding_direction(imposed.axial, imposed.spin, imposed.side)

    def release_sliding_direction(self) -> None:
        """Let friction follow the actual motion."""
        for record in self._laws:
            record.imposed = 0.0

    def set_stiffness(self, factor: float) -> None:
        """Scale the stiffness by ``factor`` [-] (continuation in statics; manual: sec-contact-continuation)."""
        for record in self._laws:
            record.stiffness = self.law.stiffness * factor

    def contact_signature(self) -> int:
        """A number that changes when a contact opens or closes on this rank.

        Unlike ``hash`` the same in every process.
        """
        return zlib.crc32(b"".join(t.tobytes() for t in self._touching))

    def normal_force(self, cell: int) -> float:
        """Return the normal force on a local cell in the last residual [N]."""
        if self._row_of is None:
            self._row_of = {
                int(c): normal[e]
                for b, normal in zip(self._blocks, self._normal, strict=True)
                if b.on == "cell"
                for e, c in enumerate(b.points)
            }
        normal = self._row_of.get(cell)
        return 0.0 if normal is None else float(normal.sum())

    def _figures(self, state) -> list[FloatArray]:
        """Compute (n, 7) for each block: the columns of ``REPORT``."""
        out = []
        for b in self._blocks:
            out.append(np.zeros((len(b.points), len(REPORT))))
            _report(
                len(out[-1]),
                KINDS[b.kernel],
                pointer(state.index_of(b)),
                pointer(b.params),
                b.context,
                pointer(state.x),
                pointer(state.y),
                pointer(out[-1]),
            )
        return out

    def report(self, state) -> tuple[FloatArray, FloatArray]:
        """Compute (nc, 7) for the local cells and (nb, 7) for the rigid items of this rank: the columns of
        ``REPORT``.
        """
        cells, bodies = np.zeros((len(self._part.cells), len(REPORT))), np.zeros((0, len(REPORT)))
        for b, figures in zip(self._blocks, self._figures(state), strict=True):
            if b.on == "cell":
                cells[b.points] = figures
            else:
                bodies = figures
        return cells, bodies

    def energies(self, t: float, state) -> Energies:
        return Energies(strain=float(sum(figures[:, 1].sum() for figures in self._figures(state))))

    def powers(self, t: float, state) -> Powers:
        return Powers(float(sum(figures[:, 2:4].sum() for figures in self._figures(state))))


class BitOnBottom(Bit):
    """Bit on the end of the hole: a spring along its axis, and a friction torque (manual: eq-bit-on-bottom).

    node: of the bit; face: distance from the node down to the bit's face [m]; radius: of the bit [m].
    stiffness: of the bottom [N/m]; friction: coefficient [-]; slip_velocity: regularisation of friction
    [m/s].
    end: (3,) end of the hole [m]; axis: (3,) its direction.
    """

    name = "bit"

    def __init__(
        self,
        node: int,
        face: float,
        radius: float,
        stiffness: float,
        friction: float,
        end: FloatArray,
        axis: FloatArray,
        slip_velocity: float = 0.01,
    ):
        self.node = node
        self.stiffness = stiffness
        self._row = [face, radius, stiffness, friction, *end, *axis, slip_velocity, -3.0]
        self._length = face

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        _, vertices = local_vertices(part, np.array([self.node]))
        params = np.ascontiguousarray(np.tile(self._row, (len(vertices), 1)))
        self._block = ElementBlock(
            "bit_bottom", "bit_contact", "vertex", vertices, VERTEX_SLOTS, (0,), params
        )
        return (self._block,)

    def impose_sliding_direction(self, axial: float, spin: float, side: float = 1.0) -> None:
        self._block.params[:, 11] = np.sign(spin)

    def release_sliding_direction(self) -> None:
        self._block.params[:, 11] = -3.0

    def copy_sliding_direction(self, other) -> None:
        """Copy the sliding direction that statics imposed on the bit of another model."""
        self._block.params[:] = other._block.params

    def weight_and_torque(self, state) -> tuple[float, float]:
        """Compute weight on bit [N] and torque on bit [N m], zero on ranks without the bit."""
        if not len(self._block.points):
            return 0.0, 0.0
        out = np.zeros(2)
        _bit_report(
            pointer(state.index_of(self._block)),
            pointer(self._block.params),
            pointer(state.x),
            pointer(state.y),
            pointer(out),
        )
        return float(out[0]), float(out[1])

    def depth_of_face(self, state) -> tuple[float, FloatArray]:
        """Compute the depth of the face below the end of the hole [m] and its gradient (n,).

        Zero without the bit.
        """
        gradient = np.zeros(len(state.x))
        if not len(self._block.points):
            return 0.0, gradient[: state.layout.size]
        index = state.index_of(self._block)[0]
        face, end, axis = self._row[0], np.array(self._row[4:7]), np.array(self._row[7:10])
        v = state.x[index[3:6]]
        n = np.linalg.norm(v)
        gradient[index[:3]] = axis
        gradient[index[3:6]] = face * (axis - v * (v @ axis) / n**2) / n
        return float((state.x[index[:3]] + face * v / n - end) @ axis), gradient[: state.layout.size]

    def torque_for(self, weight: float) -> float:
        """Compute the friction torque [N m] of the turning bit under ``weight`` [N]."""
        return weight * self._row[3] * self._row[1] * 2 / 3

    @contextmanager
    def preloaded(self, weight: float, travel: float):
        """Context in which a weak spring replaces the bottom (manual: sec-statics-wob).

        It carries ``weight`` [N] after ``travel`` [m], at the depth of ``depth_for``.
        """
        p = self._block.params
        before = p.copy()
        p[:, 2] = weight / travel
        p[:, 4:7] -= (travel - self.depth_for(weight)) * p[:, 7:10]
        try:
            yield
        finally:
            p[:] = before

    def depth_for(self, weight: float) -> float:
        """Compute the penetration [m] at which the bit carries ``weight`` [N]."""
        return weight / self._row[2]

    def energies(self, t: float, state) -> Energies:
        weight, _ = self.weight_and_torque(state)
        return Energies(strain=0.5 * weight**2 / self._row[2])

    def powers(self, t: float, state) -> Powers:
        if not len(self._block.points):
            return Powers()
        _, torque = self.weight_and_torque(state)
        return Powers(float(torque * state.y[state.index_of(self._block)[0, 6]]))
