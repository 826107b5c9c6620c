"""Positive displacement motor in the string: torque between stator and rotor, and the motion of its rotor.

Kernel: kernels/tools/mud_motor.hpp.  Manual: sec-motor.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.component import DRIVE, Component, ElementBlock, Field, Powers, Start
from drillpetsc.fem.quantity import OneStep, Quantity
from drillpetsc.geometry.frames import directors, tool_face_zero
from drillpetsc.kernels.parameters import Parameters, columns
from drillpetsc.physics import quantities as declared
from drillpetsc.physics.beam import SLOTS
from drillpetsc.physics.end_conditions import Input
from drillpetsc.physics.joints import Joints
from drillpetsc.physics.rigid_bodies import end_frames, local_vertices
from drillpetsc.physics.tools.motor_law import SLIP, MotorLaw

RESULTS = columns("mud_motor_results")
LEAST_STATIC = (
    1.0e-3  # least speed of a motor in statics as a share of its free speed, for the direction of friction
)
TORQUE_SCALE = 1.0e4  # usual torque of a motor [N m]
TORQUE = 14  # place of the torque among the kernel's unknowns
MUD_SLOTS = (("bore.pressure", 0), ("bore.pressure", 1), ("bore.flow", 1))


@dataclass(frozen=True)
class Rotor:
    """Rotor of a motor, which orbits backwards in its stator.

    lobes: of the rotor; mass [kg]; eccentricity: radius of the orbit [m]; inertia: about the rotor axis [kg m2].
    seal_area: on which the differential pressure pushes the rotor down [m2].
    """

    lobes: int = 1
    mass: float = 0.0
    eccentricity: float = 0.0
    inertia: float = 0.0
    seal_area: float = 0.0

    @property
    def unbalance(self) -> float:
        """Unbalance of the orbit [kg m]."""
        return self.mass * self.eccentricity


@dataclass(frozen=True)
class Bend:
    """Reference of the tool face of a motor: the bend of its housing, otherwise its scribe line.

    node: at which it is; tool_face: at spin angle zero [rad].
    """

    node: int
    tool_face: float


@dataclass(frozen=True)
class MotorDesign:
    """What a motor is: its law, its rotor, the bend of its housing, and the name of the item in messages."""

    law: MotorLaw
    rotor: Rotor
    bend: Bend
    label: str = "pdm"


@dataclass(frozen=True)
class Supply:
    """The mud of a motor.

    flow: flow rate over time [m3/s] of a model without mud, else None; compressibility: of the mud [1/Pa].
    outside: pressure around a string without an annulus over time [Pa]; both None without mud.
    """

    flow: Input | None = None
    compressibility: float | None = None
    outside: Input | None = None


class MudMotor(Component):
    """The motor at a joint of the string that leaves rotation about the tangent free.

    Field: ``motor.torque`` at the node below the joint, torque of the stator on the rotor [N m]; its row is the law.

    cell: of the joint; joints: of the string, which know the force through the motor.
    balanced: leave out the turning force of the orbit.
    """

    name = "mud_motor"
    free_angles = 1  # that of the rotor

    def __init__(
        self,
        joints: Joints,
        gravity: FloatArray,
        cell: int,
        design: MotorDesign,
        supply: Supply,
        balanced: bool = False,
    ):
        self.mesh, self.frames, self.gravity = joints.mesh, joints.frames, gravity
        self.cell, self.law, self.rotor, self.joints = cell, design.law, design.rotor, joints
        self.bend, self.label, self.balanced = design.bend, design.label, balanced
        self.flow, self.compressibility, self.outside = supply.flow, supply.compressibility, supply.outside
        self._speed = self._start_speed = self._load = 0.0
        node = self.bend.node  # its frame before any change of references
        self._start = self.frames.reference[node].copy(), self.frames.second_director[node].copy()

    # ------------------------------------------------------------------ discretisation
    def regions(self) -> dict[str, np.ndarray]:
        below = np.zeros(self.mesh.nodes, dtype=bool)
        below[self.cell + 1] = True
        return {"motor": below}

    def fields(self) -> tuple[Field, ...]:
        return (
            Field(
                "motor.torque",
                1,
                region="motor",
                scale=TORQUE_SCALE,
                second_order=False,
                differential=False,
                physics=DRIVE,
            ),
        )

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        self._part = part
        place = {int(c): i for i, c in enumerate(part.cells)}
        here = [self.cell] if self.cell in place else []
        cells, flowing, rotor = np.array(here, dtype=int), self.flow is None, self.rotor
        kernel = "mud_motor_flowing" if flowing else "mud_motor"
        self.params = Parameters(
            kernel,
            len(here),
            law=self.law.parameters.array[0],
            held=0.0,
            load=0.0,
            flow=0.0,
            compressibility=self.compressibility or 0.0,
            lobes=rotor.lobes,
            rotor_mass=rotor.mass,
            eccentricity=rotor.eccentricity,
            rotor_inertia=rotor.inertia,
            balanced=float(self.balanced),
            gravity=self.gravity,
            **end_frames(self.frames, cells),
        )
        self._cells, self._flow = cells, self.params["flow"]
        slots = (*SLOTS, ("motor.torque", 1), *(MUD_SLOTS if flowing else ()))
        self._block = ElementBlock(
            "mud_motor",
            kernel,
            "cell",
            np.array([place[c] for c in here], dtype=np.int32),
            slots,
            (0, 1),
            self.params.array,
            context=self.law.address,
            update=None if flowing else self._update,
            keep=(self.law,),
        )
        return (self._block,)

    def _update(self, t: float) -> None:
        if self.flow is not None:
            self._flow[:] = self.flow.value(t)

    def breaks(self) -> tuple[float, ...]:
        return self.flow.breaks() if self.flow is not None else ()

    def update_reference_frames(self) -> None:
        self.params.update(end_frames(self.frames, self._cells))

    # ------------------------------------------------------------------ statics and start
    @property
    def static_speed(self) -> float:
        """Speed of the rotor from the stator in statics [rad/s]; friction below the motor takes its direction from it."""
        return self._speed

    @property
    def _held(self) -> bool:
        """Whether statics holds the rotor, on the rank that has it."""
        return bool(len(self._block.points)) and bool(self.params["held"][0] > 0)

    def hold(self) -> None:
        self.params["held"] = 1.0
        self.joints.lock(self.cell, True)

    @property
    def start_speed(self) -> float:
        """Speed of the rotor from the stator at the start of a run [rad/s]."""
        return self._start_speed

    def run_statically(self, flow: float) -> None:
        """Turn in statics as without torque at a flow rate [m3/s]; at 0 the motor does not turn."""
        self._speed = self._start_speed = self.law.free_speed(flow)
        self._load, self.params["load"] = 0.0, 0.0

    def update_static_speed(self, torque: float, flow: float) -> float:
        """Set the speeds by the torque [N m] and flow rate [m3/s] of a static state.

        Returns the larger change: of the speed as a share of the free speed, or of the torque as a share of the stall torque.
        """
        before, free = self._speed, self.law.free_speed(flow)
        turns = abs(free)  # backwards if the mud flows up
        change, self._load = abs(torque - self._load) / self.law.stall_torque(flow), torque
        self.params["load"] = torque
        self._start_speed = self.law.speed(torque, flow)  # with the slip of a stalled motor
        # a stalled motor resists with the friction of rotation, in the direction of its rotation
        least = LEAST_STATIC * turns
        self._speed = min(self._start_speed, -least) if free < 0 else max(self._start_speed, least)
        return max(abs(self._speed - before) / turns, change) if turns > SLIP else change

    def begin_motion(self, state: Any, start: Start) -> None:
        if self._held:
            state.x[state.index_of(self._block)[0, TORQUE]] = self._results(state)[RESULTS["torque"]]
        self.params["held"] = 0.0
        self.joints.lock(self.cell, False)

    def balance(self, state: Any) -> str:
        self.balance_orbit()  # the unbalance excites the string and does not change its linear response
        return ""

    def balance_orbit(self, balanced: bool = True) -> None:
        """Leave out the turning force of the rotor's orbit, or include it again."""
        self.params["balanced"] = float(balanced)

    def orbit_speed(self, t: float, state: Any) -> float:
        """Speed of the rotor's orbit in space [rad/s], clockwise positive; on the rank with the motor, 0 elsewhere."""
        return float(self.figures(t, state)[RESULTS["orbit_speed"]])

    # ------------------------------------------------------------------ results
    def _results(self, state: Any) -> FloatArray:
        """(7,) results by the names of ``RESULTS``; zero on ranks without the motor."""
        out = np.array(state.evaluated(self._block, self._block.results_kernel, RESULTS.width).sums)
        if self._held:  # the joint has the torque
            out[RESULTS["torque"]] = self._of_joint("torque", state)
        return out

    def _of_joint(self, name: str, state: Any) -> float:
        """Result of the motor's joint, on the rank that has it."""
        k = [j.cell for j in self.joints.joints].index(self.cell)
        return float(self.joints.element_results(state)[k, self.joints.RESULTS.index(name)])

    def figures(self, t: float, state: Any) -> FloatArray:
        """(7,) results by the names of ``RESULTS`` at the time ``t`` [s]; zero on ranks without the motor."""
        if len(self._block.points):
            self._update(t)
        return self._results(state)

    def torque_and_flow(self, t: float, state: Any) -> FloatArray:
        """(2,) torque of the motor [N m] and flow rate through it [m3/s] at the time ``t`` [s], this rank's share."""
        r = self.figures(t, state)
        return np.array([r[RESULTS["torque"]], r[RESULTS["flow_rate"]]])

    def thrust(self, t: float, state: Any) -> float:
        """Load of the thrust bearing [N], this rank's share; positive while the mud and the weight below load it."""
        if not len(self._block.points):
            return 0.0
        pressure = float(self.figures(t, state)[RESULTS["pressure"]])
        if self.outside is not None:  # and the rest of it down to the annulus
            below, dofs = int(self._part.ends[self._block.points[0], 1]), state.layout.dofs
            around = dofs.get("annulus.pressure")
            out = self.outside.value(t) if around is None else state.x[around[below, 0]]
            pressure += float(state.x[dofs["bore.pressure"][below, 0]] - out)
        return pressure * self.rotor.seal_area + self._of_joint("tension", state)

    def housing(self, state: Any) -> FloatArray:
        """(6,) tangent and direction of the bend at its node; zero on ranks that do not own it."""
        _, vertices = local_vertices(self._part, np.array([self.bend.node]))
        if not len(vertices):
            return np.zeros(6)
        dofs, node = state.layout.dofs, np.array([self.bend.node])
        v, phi = (
            state.x[dofs["string.tangent"][vertices]],
            state.x[dofs["string.spin"][vertices]][:, 0],
        )
        zero = tool_face_zero(self._start[0])
        towards = np.cos(self.bend.tool_face) * zero + np.sin(self.bend.tool_face) * np.cross(
            self._start[0], zero
        )
        along, across = towards @ self._start[1], towards @ np.cross(self._start[0], self._start[1])
        d2, d3 = directors(self.frames, node, v, phi)
        return np.concatenate([v[0] / np.linalg.norm(v[0]), along * d2[0] + across * d3[0]])

    @staticmethod
    def tool_face(values: FloatArray) -> float:
        """Tool face [rad], between -pi and pi, of tangent and direction (6,) of the bend."""
        tangent, towards = values[:3] / np.linalg.norm(values[:3]), values[3:]
        zero = tool_face_zero(tangent)
        return float(np.arctan2(towards @ np.cross(tangent, zero), towards @ zero))

    def energies_of(self, steps: OneStep) -> tuple[Any, Any, Any]:
        """Energies of the rotor."""
        found = steps.sums(self._block, self._block.results_kernel, RESULTS.width)
        return found[:, RESULTS["kinetic"]], 0.0, found[:, RESULTS["potential"]]

    def powers(self, t: float, state: Any) -> Powers:
        if not len(self._block.points) or self._held:
            return Powers()
        r = self.figures(t, state)
        turned = float(r[RESULTS["torque"]] * r[RESULTS["speed"]])
        if self.flow is not None:
            return Powers(supplied=turned)
        return Powers(dissipated=float(r[RESULTS["pressure"]] * r[RESULTS["flow_rate"]]) - turned)

    def quantities(self) -> tuple[Quantity, ...]:
        return declared.MUD_MOTOR
