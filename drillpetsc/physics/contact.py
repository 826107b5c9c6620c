"""The string in its hole: contact and friction along the pipe, of rigid items, and of the bit on the
bottom."""

from __future__ import annotations

import ctypes
import zlib
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.component import Component, ElementBlock, Energies, Powers
from drillpetsc.fem.quadrature import exposed_ends, rule
from drillpetsc.fem.quantity import Quantity
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.well import Well
from drillpetsc.kernels import function, pointer
from drillpetsc.kernels.parameters import Parameters, columns, constant, structure
from drillpetsc.physics import quantities as declared
from drillpetsc.physics.beam import JUNCTION_SLOTS, SLOTS
from drillpetsc.physics.interfaces import Bit
from drillpetsc.physics.rigid_bodies import VERTEX_SLOTS, local_vertices
from drillpetsc.physics.roots import bracketed_root

RESULTS = {
    kernel: function(f"{kernel}_results", "ippp" + "ppp")
    for kernel in ("contact", "contact_junction", "body_contact")
}
_bit_results = function("bit_contact_results", "ppppp")
_Law = structure("contact_law")  # ContactLaw of kernels/contact/contact.hpp
REPORT = columns("contact_results").names
NOT_IMPOSED = constant("not_imposed")
_STORED = REPORT.index("stored")
_POWERS = columns("contact_results").span("damping_power", "friction_power")


@dataclass(frozen=True)
class ContactLaw:
    """Constants of the wall contact.

    stiffness per unit length [N/m^2] (``linear``), [N/m^2.5] (``hertz``), or per point [N/m^1.5]
    (``hertz_point``); restitution at
    ``restitution_speed`` [m/s]; slip_velocity [m/s] rounds off Coulomb's law; static_ratio = mu_static / mu,
    stribeck_speed [m/s].
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
    """Depth [m] to which a piece of string of ``mass`` [kg/m] that strikes at ``restitution_speed`` v goes
    into the wall, undamped.

    Its energy m v^2/2 is stored in k d^(p+1)/(p+1), so d = ((p+1) m v^2 / 2k)^(1/(p+1)); for a law per point
    m is the share of an element of ``length`` [m] that its point carries.
    """
    power = 1.0 if law.law == "linear" else 1.5
    share = mass * length / law.points if law.law == "hertz_point" else mass
    return float((0.5 * (power + 1) * share * law.restitution_speed**2 / law.stiffness) ** (1 / (power + 1)))


def damping_factor(restitution: float, speed: float) -> float:
    """c [s/m] of the factor 1 + c * penetration rate that returns ``restitution`` of an impact at ``speed``
    [m/s].

    With d = c speed the rebound is exact for any exponent: d (1 + e) = ln((1 + d) / (1 - d e)) (from m u du =
    -k (1 + c u) f dx).
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
    # d = 0 is a root, too; near e = 1 the wanted one is 3/2 (1 - e) (1 + (1 - e) + ...), from the series of
    # the logarithms
    if 1 - e < 1e-4:
        return 1.5 * (1 - e) * (2 - e) / speed
    return bracketed_root(miss, 0.5 * (1 - e), (1 - 1e-14) / e, absolute=1e-14, relative=1e-14) / speed


class Contact(Component):
    """Contact of pipes and rigid items with the wall.

    with_bit False: a bit that cuts has its own contact (physics/rock_bit.py); free_top: nothing holds the
    string's upper end.
    """

    name = "contact"
    RESULTS = REPORT  # columns of ``report``
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
        self._laws: list[Any] = []
        self._keep: list[np.ndarray] = []

    def _context(self, count: int, ends: tuple[bool, bool]) -> int:
        """Record for a block; ends: whether the upper and the lower ends of its elements stand out."""
        law, at = self.law, rule(self.law.points, *ends)
        n = count * len(at)
        normal, segment, touching = np.zeros(n), np.full(n, -1, dtype=np.int32), np.zeros(n, dtype=np.int8)
        record = _Law(
            well=pointer(self._packed),
            stiffness=law.stiffness,
            exponent=1.0 if law.law == "linear" else 1.5,
            damping=damping_factor(law.restitution, law.restitution_speed),
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
            None  # normal forces at the points of a local cell, once asked for
        )
        self._normal: list[np.ndarray] = []
        self._blocks: list[ElementBlock] = []
        junction = m.junction if len(m.junction) else np.zeros(m.nodes, dtype=bool)
        friction = np.where(np.isnan(m.friction), -1.0, m.friction)
        touches = (m.outer_diameter > 0) & ~m.is_joint
        for below, (name, mask, ends) in product((False, True), self._groups()):
            on_rank = (junction[:-1] == below) & touches & mask
            if not on_rank.any():
                continue
            chosen = np.flatnonzero(on_rank[part.cells]).astype(np.int32)
            e = part.cells[chosen]
            params = Parameters(
                "contact",
                len(e),
                length=m.length[e],
                rigid=m.rigid_above[e],
                radius=0.5 * m.outer_diameter[e],
                friction=friction[e],
            )
            self._blocks.append(
                ElementBlock(
                    f"contact_junction{name}" if below else f"contact{name}",
                    "contact_junction" if below else "contact",
                    "cell",
                    chosen,
                    JUNCTION_SLOTS if below else SLOTS,
                    (0, 1),
                    params.array,
                    context=self._context(len(chosen), ends),
                    component="contact",
                )
            )
        self._blocks += self._on_items(part)
        return tuple(self._blocks)

    def _on_items(self, part) -> list[ElementBlock]:
        """The block of the rigid items."""
        items = [b for b in self.mesh.bodies if b.radius > 0 and (self.with_bit or b.kind != "bit")]
        if not items:
            return []
        picked, vertices = local_vertices(part, np.array([b.node for b in items]))
        here = [items[k] for k in picked]
        params = Parameters(
            "body_contact",
            len(here),
            above=[b.above for b in here],
            length=[b.length for b in here],
            radius=[b.radius for b in here],
            friction=[-1.0 if b.friction is None else b.friction for b in here],
        )
        return [
            ElementBlock(
                "contact_bodies",
                "body_contact",
                "vertex",
                vertices,
                VERTEX_SLOTS,
                (0,),
                params.array,
                context=self._context(len(here), self._item_ends),
                component="contact",
            )
        ]

    @property
    def _item_ends(self) -> tuple[bool, bool]:
        """The ends of rigid items stand out, but for a law per point, whose points stand for so many tool
        joints."""
        stands = self.law.law != "hertz_point"
        return stands, stands

    def _groups(self) -> list[tuple[str, np.ndarray, tuple[bool, bool]]]:
        """Name, (n,) mask and ends that stand out, of the elements whose contact is integrated alike; those
        without such ends first."""
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
        """The hole has grown: take its wall from ``well``."""
        self.well = well
        self._packed = np.ascontiguousarray(well.packed())
        for record in self._laws:
            record.well = pointer(self._packed)

    def impose_sliding_direction(self, axial: float, spin: float, side: float = 1.0) -> None:
        """StaticNewton: friction acts against a rigid motion of the string, ``axial`` [m/s] downward and
        ``spin`` [rad/s].

        side 0: friction across the pipe gives its torque but does not push it sideways.
        """
        for record in self._laws:
            record.imposed, record.axial, record.spin, record.side = 1.0, axial, spin, side

    def copy_sliding_direction(self, other: Contact) -> None:
        """Take over the sliding direction that statics imposed on the contact of another model."""
        imposed = next((record for record in other._laws if record.imposed), None)
        if imposed is None:
            self.release_sliding_direction()
        else:
            self.impose_sliding_direction(imposed.axial, imposed.spin, imposed.side)

    def release_sliding_direction(self) -> None:
        """TimeIntegrator: friction follows the motion."""
        for record in self._laws:
            record.imposed = 0.0

    def set_stiffness(self, factor: float) -> None:
        """Scale the stiffness (continuation in statics)."""
        for record in self._laws:
            record.stiffness = self.law.stiffness * factor

    def contact_signature(self) -> int:
        """Changes whenever a contact opens or closes on this rank; the same in another process (unlike
        hash)."""
        return zlib.crc32(b"".join(t.tobytes() for t in self._touching))

    def normal_force(self, cell: int) -> float:
        """Normal force on a local cell in the last residual [N]."""
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
        """(n, 7) of each block: the columns of ``REPORT``."""
        out = []
        for b in self._blocks:
            out.append(np.zeros((len(b.points), len(REPORT))))
            RESULTS[b.kernel](
                len(out[-1]),
                pointer(state.index_of(b)),
                pointer(b.params),
                b.context,
                pointer(state.x),
                pointer(state.y),
                pointer(out[-1]),
            )
        return out

    def report(self, state) -> tuple[FloatArray, FloatArray]:
        """(nc, 7) per local cell and (nb, 7) per rigid item of this rank: the columns of ``REPORT``."""
        cells, bodies = np.zeros((len(self._part.cells), len(REPORT))), np.zeros((0, len(REPORT)))
        for b, figures in zip(self._blocks, self._figures(state), strict=True):
            if b.on == "cell":
                cells[b.points] = figures
            else:
                bodies = figures
        return cells, bodies

    def energies(self, t: float, state) -> Energies:
        return Energies(strain=float(sum(figures[:, _STORED].sum() for figures in self._figures(state))))

    def powers(self, t: float, state) -> Powers:
        return Powers(float(sum(figures[:, _POWERS].sum() for figures in self._figures(state))))

    def quantities(self) -> tuple[Quantity, ...]:
        return declared.CONTACT


class BitOnBottom(Bit):
    """The bit stands on the end of the hole: a spring along its axis, and a friction torque."""

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
        self.face, self.radius, self.friction, self.slip_velocity = face, radius, friction, slip_velocity
        self.end, self.axis = np.array(end, dtype=float), np.array(axis, dtype=float)

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        _, vertices = local_vertices(part, np.array([self.node]))
        params = Parameters(
            "bit_contact",
            len(vertices),
            face=self.face,
            radius=self.radius,
            stiffness=self.stiffness,
            friction=self.friction,
            end=self.end,
            axis=self.axis,
            slip=self.slip_velocity,
            imposed=NOT_IMPOSED,
        )
        self._block = ElementBlock(
            "bit_bottom", "bit_contact", "vertex", vertices, VERTEX_SLOTS, (0,), params.array
        )
        return (self._block,)

    def impose_sliding_direction(self, axial: float, spin: float, side: float = 1.0) -> None:
        self._block.named["imposed"] = np.sign(spin)

    def release_sliding_direction(self) -> None:
        self._block.named["imposed"] = NOT_IMPOSED

    def copy_sliding_direction(self, other) -> None:
        """Take over the sliding that statics imposed on another room."""
        self._block.params[:] = other._block.params

    def weight_and_torque(self, state) -> tuple[float, float]:
        """Weight on bit [N] and torque on bit [N m], zero on ranks without the bit."""
        if not len(self._block.points):
            return 0.0, 0.0
        out = np.zeros(2)
        _bit_results(
            pointer(state.index_of(self._block)),
            pointer(self._block.params),
            pointer(state.x),
            pointer(state.y),
            pointer(out),
        )
        return float(out[0]), float(out[1])

    def depth_of_face(self, state) -> tuple[float, FloatArray]:
        """How far the face is below the end of the hole [m], and its gradient by the local unknowns (n,);
        zero without the bit."""
        gradient = np.zeros(len(state.x))
        if not len(self._block.points):
            return 0.0, gradient[: state.layout.size]
        index = state.index_of(self._block)[0]
        face, end, axis = self.face, self.end, self.axis
        v = state.x[index[3:6]]
        n = np.linalg.norm(v)
        gradient[index[:3]] = axis
        gradient[index[3:6]] = face * (axis - v * (v @ axis) / n**2) / n
        return float((state.x[index[:3]] + face * v / n - end) @ axis), gradient[: state.layout.size]

    def torque_for(self, weight: float) -> float:
        """Friction torque [N m] of the turning bit under ``weight`` [N]."""
        return weight * self.friction * self.radius * 2 / 3

    @contextmanager
    def preloaded(self, weight: float, travel: float):
        """Meanwhile the bit stands on a weak spring that carries ``weight`` [N] after ``travel`` [m], at the
        depth of ``depth_for``."""
        p = self._block.named
        before = p.array.copy()
        p["stiffness"] = weight / travel
        p["end"] -= (travel - self.depth_for(weight)) * p["axis"]
        try:
            yield
        finally:
            p.array[:] = before

    def depth_for(self, weight: float) -> float:
        """Penetration [m] at which the bit carries ``weight`` [N]."""
        return weight / self.stiffness

    def energies(self, t: float, state) -> Energies:
        weight, _ = self.weight_and_torque(state)
        return Energies(strain=0.5 * weight**2 / self.stiffness)

    def powers(self, t: float, state) -> Powers:
        if not len(self._block.points):
            return Powers()
        _, torque = self.weight_and_torque(state)
        return Powers(float(torque * state.y[state.index_of(self._block)[0, 6]]))

    def quantities(self) -> tuple[Quantity, ...]:
        return declared.BIT
