"""A reamer above the bit: blades that cut the ring around the pilot hole (manual: sec-reamer).

Kernel: kernels/tools/reamer.hpp.
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.component import Component, ContactFlags, ElementBlock, Field
from drillpetsc.fem.quantity import OneStep, Quantity, numbered
from drillpetsc.geometry.growing_hole import GrowingHole
from drillpetsc.geometry.well import Well
from drillpetsc.kernels import pointer
from drillpetsc.kernels.parameters import Parameters, columns, structure
from drillpetsc.physics import quantities as declared
from drillpetsc.physics.bit.bit_profile import CHIPS, profile_derivative
from drillpetsc.physics.bit.rock_bit import KINDS, MOTION, QUASI_STATIC, STATICS
from drillpetsc.physics.contact import ONSET, penetration
from drillpetsc.physics.rigid_bodies import VERTEX_SLOTS, local_vertices

_Law = structure("bit_law")
RESULTS = columns("reamer_results")
LIFTED = 0.01  # distance of the cutters from the shoulder above which they do not touch it [m]


@dataclass(frozen=True)
class ReamerLaw:
    """Cutting of the ring (manual: eq-reamer-law): W = zeta eps (a_r - a_b) d, T = eps (a_r^2 - a_b^2) d/2.

    radius, pilot: a_r and a_b [m]; blades: their number; specific_energy: eps [Pa]; inclination_ratio: zeta [-].
    stiffness: of cutters on the shoulder, without inertia [N/m]; slip: velocity that rounds off the torque [m/s].
    """

    radius: float
    pilot: float
    blades: int
    specific_energy: float
    inclination_ratio: float
    stiffness: float
    slip: float

    @property
    def cut(self) -> float:
        """Weight over depth of cut per turn [N/m]."""
        return self.inclination_ratio * self.specific_energy * (self.radius - self.pilot)

    @property
    def torque_cut(self) -> float:
        """Torque over depth of cut per turn [N]."""
        return 0.5 * self.specific_energy * (self.radius**2 - self.pilot**2)


@dataclass(frozen=True)
class ReamerPlace:
    """Where a reamer is.

    node: that carries the item; nodes: of the string; face: distance of the cutters below the node [m].
    start: measured depth of the cutters in the unstrained string [m].
    shoulder: measured depth of the shoulder at the start [m]; section: of the hole at the start that it has reamed.
    driven: below a downhole motor, which turns it; number: of the reamer in the string, from the top.
    """

    node: int
    nodes: int
    face: float
    start: float
    shoulder: float
    section: int = 0
    driven: bool = False
    number: int = 1


class Reamer(Component):
    """The cutters of a reamer, and the shoulder under them.

    Unknowns: metres reamed hole.reamer [m], and with inertia the profile reamer.chips [m].

    place, law: of its cutters; well, hole: at the start, and the growing hole, whose reamed part follows.
    inertia: the string has inertia.
    """

    name = "reamer"
    has_contact = True
    update_size = 9

    def __init__(
        self, place: ReamerPlace, law: ReamerLaw, well: Well, hole: GrowingHole, inertia: bool = True
    ):
        self._nodes, self._section, self._number = place.nodes, place.section, place.number
        self.name = numbered("reamer", place.number)
        self.depth_field, self._chips_field = f"hole.{self.name}", f"{self.name}.chips"
        self.ring = np.pi * (law.radius**2 - law.pilot**2)
        self.node, self.face, self.shoulder, self._driven = (
            place.node,
            place.face,
            place.shoulder,
            place.driven,
        )
        self.law, self.stiffness, self._profiled, self._hole = law, law.stiffness, inertia, hole
        self._derivative = profile_derivative(CHIPS, 2 * np.pi / law.blades)
        self._made: Any = _Law(
            kind=KINDS["drag_bit"],
            blades=law.blades,
            cut=law.cut,
            torque_cut=law.torque_cut,
            turn_rounding=law.slip / law.radius,
            derivative=pointer(self._derivative),
        )
        self._flags = np.frombuffer(self._made, dtype=np.int32, count=1, offset=_Law.touching.offset)
        self._well = well
        self._reamed = 0.0
        self._place(place.start)

    def weight_and_torque_at(self, depth: float) -> tuple[float, float]:
        """Weight [N] and torque, not negative [N m], at the start if the node rests at the measured depth ``depth`` [m]."""
        below = depth + self.face - self.shoulder
        onset = max(below + ONSET, 0.0) ** 2 / (4 * ONSET)
        weight = self.stiffness * (below if below > ONSET else onset)
        return weight, weight * self.law.torque_cut / self.law.cut

    @property
    def reamed(self) -> float:
        """Metres reamed after the last accepted step."""
        return self._reamed

    @property
    def stands(self) -> bool:
        """Whether the cutters are on the shoulder."""
        return float(self._frame[6]) - self._reamed > -LIFTED

    def _place(self, md: float) -> None:
        """Measure places from the point of the hole's axis at ``md`` [m]."""
        point, axis, _ = self._well.at(np.array([md]))
        self._frame = np.concatenate([np.asarray(axis)[0], np.asarray(point)[0], [md - self.shoulder]])

    # ------------------------------------------------------------------ discretisation
    def fields(self) -> tuple[Field, ...]:
        out: tuple[Field, ...] = (
            Field(self.depth_field, 1, physics="rock", region=self.name, scale=1e-3, second_order=False),
        )
        if self._profiled:
            out += (
                Field(
                    self._chips_field, CHIPS, physics="rock", region=self.name, scale=1e-4, second_order=False
                ),
            )
        return out

    def regions(self) -> dict[str, np.ndarray]:
        mask = np.zeros(self._nodes, dtype=bool)
        mask[self.node] = True
        return {self.name: mask}

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        _, vertices = local_vertices(part, np.array([self.node]))
        self._mine = bool(len(vertices))
        slots: tuple[tuple[str, int], ...] = (*VERTEX_SLOTS, (self.depth_field, 0))
        if self._profiled:
            slots += ((self._chips_field, 0),)
        self.params = Parameters(
            "reamer",
            len(vertices),
            face=self.face,
            stiffness=self.stiffness,
            axis=self._frame[:3],
            point=self._frame[3:6],
            place=self._frame[6],
            mode=MOTION,
            spin=0.0,
        )
        self._block = ElementBlock(
            self.name,
            "reamer_profile" if self._profiled else "reamer",
            "vertex",
            vertices,
            slots,
            (0,),
            self.params.array,
            context=ctypes.addressof(self._made),
        )
        return (self._block,)

    # ------------------------------------------------------------------ statics and motion
    def impose_sliding_direction(
        self, axial: float, spin: float, side: float = 1.0, motor: float = 0.0
    ) -> None:
        self.params["mode"], self.params["spin"] = STATICS, spin + motor if self._driven else spin

    def impose_drilling(self, axial: float, spin: float, side: float = 1.0) -> None:
        self.params["mode"], self.params["spin"] = QUASI_STATIC, spin

    def release_sliding_direction(self) -> None:
        self.params["mode"] = MOTION

    def copy_sliding_direction(self, other: Reamer) -> None:
        for name in ("mode", "spin"):
            self.params[name] = other.params[name]

    def contact_flags(self) -> tuple[ContactFlags, ...]:
        return (ContactFlags(self._flags),)

    # ------------------------------------------------------------------ history
    def first_cut(self, state) -> None:
        """Set profile and rate so that the cutters carry their static weight at the start of the motion."""
        if not self._mine:
            return
        i, p = state.index_of(self._block)[0], self.params
        v = state.x[i[3:6]]
        centre = state.x[i[:3]] + self.face * v / np.linalg.norm(v)
        zeta = float((centre - p["point"][0]) @ p["axis"][0] + p["place"][0])
        if self._profiled:
            gap = zeta - float(state.x[i[7]])
            weight = self.stiffness * (gap if gap > ONSET else max(gap + ONSET, 0.0) ** 2 / (4 * ONSET))
            chip = weight / (self.law.cut * self.law.blades)
            place = np.arange(CHIPS) / CHIPS
            ahead = 0.5 * (1 - np.cos(np.pi * place)) if state.y[i[6]] > 0 else np.zeros(CHIPS)
            below = zeta - float(penetration(chip)) if weight > 0 else float(state.x[i[7]])
            state.x[i[8:]] = below + chip * ahead
        state.y[i[7]] = self.element_results(state)[RESULTS["rate"]]

    def follow(self, leader: Component, state: Any) -> None:
        assert isinstance(leader, Reamer)
        self._hole.leader = leader._hole

    def local_update(self, state) -> FloatArray:
        """(9,) metres reamed, direction and point of the hole at the cutters, their place, and 1; zero on other ranks."""
        now = np.zeros(9)
        if self._mine:
            i = state.index_of(self._block)[0]
            v = state.x[i[3:6]]
            centre = state.x[i[:3]] + self.face * v / np.linalg.norm(v)
            self._place(float(self._well.project(centre[None, :]).md[0]))
            now[0], now[1:8], now[8] = state.x[i[7]], self._frame, 1.0
        return now

    def apply_update(self, total: FloatArray) -> None:
        """Places are measured from the hole's axis at the cutters; the hole's reamed part follows the shoulder."""
        self._reamed, self._frame = float(total[0]), total[1:8].copy()
        self._follow()
        self._hole.widen_to(self._section, self._reamed)

    def _follow(self) -> None:
        p, f = self.params, self._frame
        p["axis"], p["point"], p["place"] = f[:3], f[3:6], f[6]

    def follow_hole(self, well: Well) -> None:
        self._well = well

    def get_state(self) -> dict[str, FloatArray]:
        return {"reamed": np.array([self._reamed]), "frame": self._frame.copy()}

    def set_state(self, state: dict[str, FloatArray]) -> None:
        self._reamed, self._frame = float(state["reamed"][0]), np.array(state["frame"])
        self._follow()
        self._hole.widen_to(self._section, self._reamed)

    # ------------------------------------------------------------------ results
    def element_results_of(self, steps: OneStep) -> FloatArray:
        """Results of the reamer by ``RESULTS``: (k, ..) after each of k steps, zero on the other ranks."""
        return np.asarray(steps.sums(self._block, self._block.results_kernel, RESULTS.width))

    def element_results(self, state) -> FloatArray:
        """Results of the reamer by ``RESULTS``, zero on the other ranks."""
        return np.asarray(self.element_results_of(OneStep(state, 0.0))[0])

    def depth(self, state) -> float:
        """Measured depth of the shoulder [m] on the rank with the reamer, 0 elsewhere."""
        return self.shoulder + float(state.x[state.index_of(self._block)[0, 7]]) if self._mine else 0.0

    def energies_of(self, steps: OneStep) -> tuple[Any, Any, Any]:
        return 0.0, self.element_results_of(steps)[:, RESULTS["stored"]], 0.0

    def powers_of(self, steps: OneStep) -> tuple[Any, Any]:
        return self.element_results_of(steps)[:, RESULTS["dissipated"]], 0.0

    def quantities(self) -> tuple[Quantity, ...]:
        return tuple(q.numbered(self._number) for q in declared.REAMER)
