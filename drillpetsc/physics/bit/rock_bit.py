"""A bit that cuts rock: contact with bottom and side of its hole, laws of bit and rock, the end of the hole as states.

Kernel: kernels/bit/bit.hpp.  Manual: sec-bit.
"""

from __future__ import annotations

import ctypes
from functools import cached_property
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.component import Component, ContactFlags, ElementBlock, Field
from drillpetsc.fem.quantity import Quantity
from drillpetsc.geometry.growing_hole import GrowingHole
from drillpetsc.geometry.well import Well
from drillpetsc.kernels import function, pointer
from drillpetsc.kernels.parameters import Parameters, Table, columns, structure
from drillpetsc.physics import quantities as declared
from drillpetsc.physics.bit.bit_laws import BitContact, BitShape, DragBit, PatternOrder, Rock, Weakening
from drillpetsc.physics.bit.bit_profile import CHIPS, chip_for, profile_derivative
from drillpetsc.physics.contact import penetration
from drillpetsc.physics.interfaces import Bit, SideContact
from drillpetsc.physics.own_law import OwnLaw
from drillpetsc.physics.rigid_bodies import VERTEX_SLOTS, local_vertices

_rate = function("rock_rate", "pppddpp")
_beyond = function("bit_beyond", "dd", ctypes.c_double)

_Law = structure("bit_law")  # BitLaw of kernels/bit/bit.hpp
LAYER_WIDTH = 0.1  # length over which one layer goes over into the next [m]
STRAYED = 1e-3  # distance [m] from the end of the hole that the bit follows, a few millionths of a parameter beside it
KINDS = columns("bit_kind")
RESULTS = columns("bit_rock_results")
_MODES = columns("bit_mode")
MOTION, STATICS, QUASI_STATIC = (_MODES[name] for name in ("motion", "statics", "quasi_static"))


class RockBit(Bit):
    """The bit at the lower end of the string (manual: sec-bit).

    Unknowns: displacement of the hole's end hole.end (3) [m], length drilled hole.drilled [m], the
    profile bit.chips [m] of a drag bit, and if the side yields the over-gauge hole.overgauge [m] in excess of new hole.

    node: of the bit; shape, contact: of the bit; law: of its torque, or of the user, None: friction; rock: the formation.
    hole: the growing hole.
    inertia: the string has inertia; without it a drag bit cuts steadily and has no profile.
    pattern: of the bottom under a roller cone, empty: a plane bottom.  Not for a drag bit.
    """

    name = "bit"
    has_contact = True
    update_size = 12
    hole: GrowingHole

    def __init__(
        self,
        node: int,
        shape: BitShape,
        contact: BitContact,
        law: DragBit | Weakening | OwnLaw | None,
        rock: Rock,
        hole: GrowingHole,
        inertia: bool = True,
        pattern: tuple[PatternOrder, ...] = (),
    ):
        self.pattern = pattern
        self.stiffness = contact.stiffness
        self.node, self.shape, self.contact, self.law, self.rock, self.hole = (
            node,
            shape,
            contact,
            law,
            rock,
            hole,
        )
        self.profiled = isinstance(law, DragBit) and inertia
        if pattern:
            assert not isinstance(law, DragBit)
            self.update_size = 13  # and the angle from which the pattern counts
        self.own = law if isinstance(law, OwnLaw) else None
        self._memory_from = self.update_size
        if self.own is not None:
            self.update_size += len(self.own.memory_names)
        self._zero_angle = 0.0
        self._leader: RockBit | None = None
        self._made = self._law_record()
        self._flags = np.frombuffer(self._made, dtype=np.int32, count=1, offset=_Law.touching.offset)
        self._time = self._accepted = 0.0
        self._turned = np.zeros(3)  # displacement of the end as its direction turns [m]
        self._end = np.zeros(
            4
        )  # displacement of the hole's end (3) and metres drilled at the last accepted step

    # ------------------------------------------------------------------ constants
    @property
    def rounding(self) -> float:
        """Speed of rotation over which torque builds up in a bit that sticks [rad/s]."""
        return self.contact.slip / (2 / 3 * self.shape.radius)

    def _law_record(self) -> Any:
        rock, law, a = self.rock, self.law, self.shape.radius
        self._layers = Table(
            columns("bit_layer"),
            len(rock.layers),
            rock=np.array([np.ravel(q.rock) for q in rock.layers]).reshape(-1, 9),
            **{
                name: [getattr(q, name) for q in rock.layers]
                for name in columns("bit_layer").names
                if name != "rock"
            },
        ).array
        r = _Law(
            bit_axis=float(rock.bit_axis),
            walk_cos=np.cos(rock.walk),
            walk_sin=np.sin(rock.walk),
            reference_speed=rock.reference_speed,
            reference_weight=rock.reference_weight,
            width=LAYER_WIDTH,
            layers=pointer(self._layers),
            count=len(self._layers),
            turn_rounding=self.rounding,
            rest=1e-4,
            kind=KINDS["rop"],
        )
        if self.pattern:
            names = columns("bit_order").names
            self._orders = Table(
                columns("bit_order"),
                len(self.pattern),
                **{name: [getattr(q, name) for q in self.pattern] for name in names},
            ).array
            r.orders, r.order_count = pointer(self._orders), len(self._orders)
        self._torque = 0.0, self.contact.friction * a * 2 / 3
        if rock.law is not None:
            r.rock, r.start = rock.law.record(1), self.hole.start
        if isinstance(law, DragBit):
            r.kind, r.blades = KINDS["drag_bit"], law.blades
            r.cut, r.contact = (
                law.inclination_ratio * law.specific_energy * a,
                law.contact_stress * a * law.wear_flat,
            )
            r.torque_cut, r.rub = 0.5 * law.specific_energy * a**2, 0.5 * law.friction * a
            r.exposure, r.saturated = law.exposure, r.cut * law.blades * law.exposure + r.contact
            r.onset = max(
                r.contact / self.contact.stiffness, 1e-6
            )  # the wear flat comes into contact as stiffly as a bit on the bottom
            self._derivative = profile_derivative(CHIPS, 2 * np.pi / law.blades)
            r.derivative = pointer(self._derivative)
            share = r.torque_cut / r.cut
            self._torque = (r.rub - share) * r.contact, share
        elif isinstance(law, OwnLaw):
            r.kind, r.own, r.own_rate = KINDS["own"], law.record(1, r.rock or 0), float("rate" in law.gives)
            r.start = self.hole.start
        elif isinstance(law, Weakening):
            r.kind, r.by_weight = KINDS["velocity_weakening"], float(law.by_weight)
            r.static_torque, r.dynamic_torque, r.speed = law.static, law.dynamic, law.speed
            r.turn_rounding = min(r.turn_rounding, law.speed / 100)  # the bit breaks loose at this speed
        return r

    def _constants(self) -> tuple[Any, ...]:
        """Numbers of the record."""
        numbers = [getattr(self._made, name) for name, kind in _Law._fields_ if kind is ctypes.c_double]
        tables = [getattr(self, name, None) for name in ("_orders", "_derivative")]
        return (np.array(numbers), self._layers, *(t for t in tables if t is not None))

    def fields(self) -> tuple[Field, ...]:
        free = not self.rock.post_step
        scale = 1e-3
        out: tuple[Field, ...] = (
            Field(
                "hole.end",
                3,
                physics="rock",
                region="bottom",
                scale=scale,
                second_order=False,
                differential=free,
            ),
            Field(
                "hole.drilled",
                1,
                physics="rock",
                region="bottom",
                scale=scale,
                second_order=False,
                differential=free,
            ),
        )
        if self.profiled:
            out += (
                Field("bit.chips", CHIPS, physics="rock", region="bottom", scale=1e-4, second_order=False),
            )
        return out + self.contact.side.fields(scale)

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        _, vertices = local_vertices(part, np.array([self.node]))
        self._mine = bool(len(vertices))
        slots: tuple[tuple[str, int], ...] = (*VERTEX_SLOTS, ("hole.end", 0), ("hole.drilled", 0))
        if self.profiled:
            slots += (("bit.chips", 0),)
        s, c = self.shape, self.contact
        slots += c.side.slots()
        self.params = Parameters(
            "bit_rock",
            len(vertices),
            face=s.face,
            centre=s.face - s.half,
            radius=s.radius,
            half=s.half,
            stiffness=c.stiffness,
            clearance=0.0,  # this and the axis: _follow
            friction=c.friction,
            slip=c.slip,
            damping=c.damping,
            end=self.hole.end,
            axis=0.0,
            mode=MOTION,
            axial=0.0,
            spin=0.0,
            share=0.0,
            torque0=0.0,
            torque1=0.0,
            held=self.rock.post_step,
            hold=0.0,
            angle=0.0,
            turned=0.0,
            **c.side.parameters(),
        )
        kernel = "bit_rock_profile" if self.profiled else "bit_rock_pattern" if self.pattern else "bit_rock"
        kernel += c.side.kernel
        self._results = f"{kernel}_results"
        self._block = ElementBlock(
            "bit_rock",
            kernel,
            "vertex",
            vertices,
            slots,
            (0,),
            self.params.array,
            context=ctypes.addressof(self._made),
            constants=() if self.own_laws else self._constants(),
            remembers=True,
            update=self._note if self.remembers else None,
        )
        self._follow()
        return (self._block,)

    def _note(self, t: float) -> None:
        self._time = t
        for law in self.own_laws:
            law.at_time(t)

    @cached_property
    def own_laws(self) -> tuple[OwnLaw, ...]:
        return tuple(law for law in (self.own, self.rock.law) if law is not None)

    def _strength(self, drilled: float = 0.0) -> float:
        """Strength of the rock [-] where ``drilled`` metres are drilled, relative to the layers'."""
        law = self.rock.law
        return 1.0 if law is None else law.value(depth=self.hole.start + drilled)["strength"]

    def _follow(self) -> None:
        self.params["axis"] = self.hole.direction
        self.params["clearance"] = self.hole.radial_clearance(self.shape.radius)

    # ------------------------------------------------------------------ statics and motion
    def impose_sliding_direction(
        self, axial: float, spin: float, side: float = 1.0, motor: float = 0.0
    ) -> None:
        """Let friction oppose an imposed motion, for statics; the hole does not grow (see ``Contact``)."""
        self._impose(STATICS, axial, spin + motor, side)

    def follow_overdamped_motion(self, speed: float, slip: float) -> None:
        """Let friction at the side of the hole oppose a slide along it: the bit's velocity is small compared with ``speed``."""
        self.impose_sliding_direction(speed, 0.0)

    def impose_drilling(self, axial: float, spin: float, side: float = 1.0) -> None:
        """Let the hole grow under a bit that turns with ``spin`` [rad/s], without inertia and impacts.

        Manual: sec-bit-quasi-static.
        """
        self._impose(QUASI_STATIC, axial, spin, side)

    def _impose(self, mode: float, axial: float, spin: float, side: float) -> None:
        p = self.params
        p["mode"], p["axial"], p["spin"], p["share"] = mode, axial, spin, side
        p["torque0"], p["torque1"] = self._torque_line(spin)

    def release_sliding_direction(self) -> None:
        self.params["mode"] = MOTION
        self.params["torque0"], self.params["torque1"] = self._torque

    def copy_sliding_direction(self, other) -> None:
        """Take over the motion that statics imposed on the bit of another model."""
        self.params.array[:] = other.params.array

    def _torque_line(self, spin: float) -> tuple[float, float]:
        """Compute the torque on bit as first + second * weight, at a rotation ``spin`` [rad/s].

        [N m] and [m].
        """
        if not isinstance(self.law, Weakening):
            return self._torque
        fall = float(np.exp(-((spin / self.law.speed) ** 2)))
        size = self.law.dynamic + (self.law.static - self.law.dynamic) * fall
        return (0.0, size) if self.law.by_weight else (size, 0.0)

    def torque_for(self, weight: float, spin: float) -> float:
        """Compute the torque [N m] of the bit that turns with ``spin`` [rad/s] under ``weight`` [N]."""
        if weight <= 0:
            return 0.0
        if self.own is not None:
            return self.own.value(weight=weight, speed=spin, depth=self.hole.start)["torque"]
        first, second = self._torque_line(spin)
        if not isinstance(self.law, DragBit):
            return first + second * weight
        law, strength = self._made, self._strength()
        share = weight / strength
        return strength * (first + second * share - _beyond(share, law.saturated) * (second - law.rub))

    def depth_for(self, weight: float) -> float:
        """Compute the depth [m] at which the bit carries ``weight`` [N] at rest."""
        return float(penetration(weight / self.contact.stiffness))

    def depth_of_face(self, state) -> tuple[float, FloatArray]:
        """Compute the depth of the bit below the end of the hole [m] and its gradient (n,) by the local unknowns.

        Both are zero without the bit.  Manual: eq-bit-support, eq-bit-depths.
        """
        gradient = np.zeros(len(state.x))
        if not self._mine:
            return 0.0, gradient[: state.layout.size]
        i, p, s = state.index_of(self._block)[0], self.params, self.shape
        v = state.x[i[3:6]]
        n = float(np.linalg.norm(v))
        t, axis, to_centre = v / n, p["axis"][0], p["centre"][0]
        tilt, squeeze = float(t @ axis), s.half**2 - s.radius**2
        reach = np.sqrt(s.radius**2 + squeeze * tilt**2)
        gradient[i[:3]] = axis
        gradient[i[3:6]] = (to_centre + squeeze * tilt / reach) * (axis - t * tilt) / n
        centre = (state.x[i[:3]] - p["end"][0]) + (to_centre * t - state.x[i[7:10]] - p["turned"][0])
        return float(centre @ axis + reach - s.half), gradient[: state.layout.size]

    def first_cut(self, state) -> None:
        """Set the rates of the hole's end from the string's motion at the start (manual: sec-bit-start).

        The profile of a drag bit is set to carry the weight on bit: steady cutting if the bit turns, else a
        flat indentation.

        The pattern of a roller cone counts from the present angle.
        """
        if not self._mine:
            return
        i = state.index_of(self._block)[0]
        if self.profiled:
            self._indent(state, i)
        if self.pattern:
            self.params["angle"] = self._zero_angle = float(state.x[i[6]])
        rate = self.element_results(state)[RESULTS["velocity"]]
        state.y[i[7:10]], state.y[i[10]] = rate, np.linalg.norm(rate)

    def _indent(self, state, i: np.ndarray) -> None:
        depth, _ = self.depth_of_face(state)
        weight = max(0.0, depth) * self.contact.stiffness
        down, axis, r = float(state.y[i[:3]] @ self.params["axis"][0]), state.y[i[6]], self._made
        flat, strength = 0.5 * r.contact * (1 + down / np.hypot(down, r.rest)), self._strength(state.x[i[10]])
        chip = chip_for(weight / strength, r.cut * r.blades, flat, r.onset)
        cut = min(chip, r.exposure)
        if chip > cut:  # the body carries the rest
            chip = cut + (weight - strength * (r.cut * r.blades * cut + flat)) / self.contact.stiffness
        place = np.arange(CHIPS) / CHIPS
        ahead = 0.5 * (1 - np.cos(np.pi * place)) if axis > 0 else np.zeros(CHIPS)
        state.x[i[11 : 11 + CHIPS]] = (depth - chip + cut * ahead) if weight > 0 else 0.0

    # ------------------------------------------------------------------ growth
    def follow(self, leader: Component, state) -> None:
        assert isinstance(leader, RockBit)
        self._leader, self.hole.leader = leader, leader.hole

    @property
    def idle(self) -> bool:
        return not (self._leader is None or self.rock.post_step or self.hole.grows_to(0.0))

    @property
    def remembers(self) -> bool:
        cuts = self.profiled or any(layer.drillability for layer in self.rock.layers)
        return bool(cuts or self.pattern or self.own_laws)

    def accept(self, t: float, state) -> None:
        for law in self.own_laws:
            law.at_time(t)

    def local_update(self, state) -> FloatArray:
        """Return (12,) after an accepted step, zero without the bit; (13,) with a pattern.

        Displacement of the end (3) [m] and length drilled since the start [m], time [s], number of bits; where the hole grows, the
        bit's centre from the end (3) [m] and its direction (3); angle from which the pattern counts [rad].
        With ``post_step`` the end is moved in this call.
        """
        now = np.zeros(self.update_size)
        if self._mine:
            if self.rock.post_step:
                self._move(state)
            i = state.index_of(self._block)[0]
            now[:4] = self.params["hold"][0] if self.rock.post_step else state.x.take(i[7:11])
            now[4], now[5] = self._time, 1.0
            if self.hole.grows_to(now.item(3)):
                direction = state.x[i[3:6]] / np.linalg.norm(state.x[i[3:6]])
                p = self.params
                place = p["centre"][0] * direction - now[:3] - p["turned"][0]
                now[6:9], now[9:12] = (state.x[i[:3]] - p["end"][0]) + place, direction
            if self.pattern:
                now[12] = self.params["angle"][0]
            if self.own is not None and self.own.memory_names:
                state.evaluated(self._block, self._results, RESULTS.width)
                now[self._memory_from :] = self.own.next_memory
        return now

    def apply_update(self, total: FloatArray) -> None:
        """Store the sum of ``local_update`` over all ranks; the wall follows the end."""
        if self._leader is not None:
            self.strayed = not np.abs(total[:4] - self._leader._end).max() <= STRAYED
            if self.strayed:
                return
        self._end, self._accepted = total[:4], total.item(4)  # a new array in every step
        if self.pattern:
            self._zero_angle = float(total[12])
        if self.own is not None:
            self.own.raise_error()
            self.own.set_memory(total[self._memory_from :])
        if self.hole.grows_to(total.item(3)):
            before = self.hole.direction
            self.hole.follow(total[3], self.hole.start_point + total[:3])
            self._follow()
            self._turn_bottom(before, self.hole.direction, total[6:9], total[9:12])

    def _turn_bottom(
        self, before: FloatArray, now: FloatArray, place: FloatArray, direction: FloatArray
    ) -> None:
        """Turn the bottom about the position of the bit, so that the depth of the bit does not change (manual: eq-bit-bottom-turn).

        before, now: (3,) axes of the end; place: (3,) of the bit's centre from the end [m]; direction: (3,) of the bit.
        """
        s = self.shape
        reach = [
            np.sqrt(s.radius**2 + (s.half**2 - s.radius**2) * float(direction @ axis) ** 2)
            for axis in (before, now)
        ]
        self._turned = self._turned + (float(place @ (now - before)) + reach[1] - reach[0]) * now
        self.params["turned"] = self._turned

    def drilled_hole(self) -> Well:
        """Return the hole with its new part after the last accepted step."""
        return self.hole.whole_path(float(self._end[3]), self.hole.start_point + self._end[:3])

    def _move(self, state) -> None:
        step = self._time - self._accepted
        if step > 0 and self.params["mode"][0] != STATICS:
            rate, hold = self.element_results(state)[RESULTS["velocity"]], self.params["hold"]
            hold[:, :3] += rate * step
            hold[:, 3] += np.linalg.norm(rate) * step

    def get_state(self) -> dict[str, FloatArray]:
        """History variables for a checkpoint, the same on all ranks; includes the history of the hole."""
        angle = {"pattern_angle": np.array([self._zero_angle])} if self.pattern else {}
        own = {"hold": self._end, "accepted": np.array([self._accepted]), "turned": self._turned}
        memory = {} if self.own is None else {f"memory.{name}": q for name, q in self.own.memory.items()}
        return own | angle | memory | self.hole.get_state()

    def set_state(self, saved: dict[str, FloatArray]) -> None:
        """Continue from the history variables of a checkpoint."""
        self.hole.set_state(saved)
        self.params["hold"] = self._end = np.array(saved["hold"])
        self.params["turned"] = self._turned = np.array(saved.get("turned", np.zeros(3)))
        self.params["end"] = saved["first"]
        self._accepted = self._time = float(saved["accepted"][0])
        if self.pattern:
            self.params["angle"] = self._zero_angle = float(saved["pattern_angle"][0])
        if self.own is not None:
            none = np.full(1, np.nan)
            self.own.set_memory([saved.get(f"memory.{name}", none)[0] for name in self.own.memory_names])
        self._follow()

    def contact_flags(self) -> tuple[ContactFlags, ...]:
        return (ContactFlags(self._flags),)

    # ------------------------------------------------------------------ results
    def element_results_of(self, steps) -> FloatArray:
        """(k, columns) of ``RESULTS``: weight [N], torque [N m], rate [m/s], side force [N], stored
        energy [J], power into the rock [W], depth [m], offset of the bit's centre from the hole's axis [m],
        rate of penetration in space (3) [m/s], forces and couple of the side; zero without the bit."""
        return np.asarray(steps.sums(self._block, self._results, RESULTS.width))

    @property
    def side_contact(self) -> SideContact:
        s = self.shape
        return SideContact(s.face - s.half, self.contact.side.stiffness, self.hole.radial_clearance(s.radius))

    def direction_of(self, steps) -> FloatArray:
        return (
            np.asarray(steps.parameters(self._block, "axis", 0)) if self._mine else np.zeros((len(steps), 3))
        )

    def progress_of(self, steps) -> FloatArray:
        if not self._mine:
            return np.zeros((len(steps), 2))
        if self.rock.post_step:
            drilled = steps.parameters(self._block, "hold", 0)[:, 3]
        else:
            drilled = steps.unknowns(int(steps.assembly.index_of(self._block)[0, 10]))
        return np.column_stack([drilled, self.element_results_of(steps)[:, RESULTS["rate"]]])

    @property
    def side_strength(self) -> float | None:
        gauge = self.contact.side.gauge
        return None if gauge is None else gauge.strength

    def orbit_and_overgauge(self, state) -> tuple[float, float]:
        """Return the offset of the bit from the axis of its hole and the over-gauge of the hole beside it [m]."""
        if not self._mine:
            return 0.0, 0.0
        wider = 0.0 if self.contact.side.gauge is None else float(state.x[state.index_of(self._block)[0, -1]])
        orbit = float(self.element_results(state)[RESULTS["offset"]])
        return orbit, wider + self.hole.radial_clearance(self.shape.radius)

    def rate_under(
        self, force: FloatArray, axis: FloatArray, omega: float, drilled: float = 0.0
    ) -> FloatArray:
        """Compute the rate of penetration (3,) [m/s] (manual: eq-bit-rate).

        force: (3,) of the bit on the rock [N]; axis: (3,) of the bit; omega: rotation [rad/s]; drilled:
        length [m].
        """
        out, e = np.zeros(3), np.array(axis, dtype=float)
        F = np.array(force, dtype=float) / self._strength(drilled)
        along, known = np.zeros(1), None
        if self.own is not None and "rate" in self.own.gives:
            weight = float(np.dot(force, e))
            along[0] = self.own.value(weight=weight, speed=omega, depth=self.hole.start + drilled)["rate"]
            known = pointer(along)
        _rate(ctypes.addressof(self._made), pointer(F), pointer(e), omega, drilled, known, pointer(out))
        return out

    def energies_of(self, steps) -> tuple[Any, Any, Any]:
        return 0.0, self.element_results_of(steps)[:, RESULTS["stored"]], 0.0

    def powers_of(self, steps) -> tuple[Any, Any]:
        return self.element_results_of(steps)[:, RESULTS["dissipated"]], 0.0

    def quantities(self) -> tuple[Quantity, ...]:
        return declared.BIT if self.contact.side.gauge is None else declared.BIT + declared.BIT_SIDE
