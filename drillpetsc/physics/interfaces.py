"""Interfaces of the components that others use: beam, top, bit, wall contact, drive, joints, tools."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray, IntArray
from drillpetsc.fem.component import Component
from drillpetsc.fem.string_mesh import StringJoint
from drillpetsc.geometry.growing_hole import GrowingHole
from drillpetsc.geometry.well import Well
from drillpetsc.unit_systems import System


class Beam(Component):
    """Elements of the string."""

    #: name of the formation in the case file: ``ancf`` or ``quaternion``
    formulation: str = ""
    #: statics starts from the equilibrium of the ANCF element, which Newton's method corrects
    needs_ancf_equilibrium: bool = False
    #: field of the section's direction at a node, whose rows hold the couples about the node
    orientation: str = ""
    #: the spin angle is known up to a multiple of this [rad]; 0: it counts all turns
    angle_period: float = 0.0

    @abstractmethod
    def place(self, system: Any, position: FloatArray, tangent: FloatArray) -> None:
        """Put the unstrained string at rest on ``position`` (n_nodes, 3) [m] with directions ``tangent``
        (n_nodes, 3).
        """

    @abstractmethod
    def set_rigid_motion(
        self,
        system: Any,
        tangent: FloatArray,
        curvature: FloatArray,
        lowering: float | FloatArray,
        rotation: float | FloatArray,
    ) -> None:
        """Set the velocity of every node to ``lowering`` [m/s] along the hole, its spin to ``rotation`` [rad/s].

        lowering, rotation: (n_nodes,) where they differ along the string.
        tangent: (n_nodes, 3) of the hole at the nodes; curvature: (n_nodes, 3) its derivative [1/m].
        """

    @abstractmethod
    def impose_rigid_motion(self, system: Any, rates: FloatArray, lowering: float, rotation: float) -> None:
        """Write the rates of a string that moves along itself with ``lowering`` [m/s] and turns in place with ``rotation`` [rad/s].

        rates: (n,) of the local unknowns, in which those of the string's position and section are replaced.
        """

    @abstractmethod
    def first_node(self, fields: Mapping[str, FloatArray]) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Position (3,) [m], slope (3,) [-] and spin angle (1,) [rad] of the top node.

        fields: (n_nodes, size) values of the string's fields, by name.
        """

    @abstractmethod
    def section(self, state: Any, vertex: int | IntArray) -> tuple[FloatArray, FloatArray, Any]:
        """Position (3,) [m], slope (3,) [-] and spin rate [rad/s] of a local vertex; of k vertices (k, 3), (k, 3), (k,)."""

    @abstractmethod
    def nodal_motion(self, state: Any, vertices: IntArray) -> FloatArray:
        """(3, k, 7) position [m], slope [-] and spin angle [rad] of k local vertices, their rates and accelerations.

        The rate of the spin angle is the spin rate, that of rotation about the tangent.
        """

    @abstractmethod
    def columns(self, state: Any) -> FloatArray:
        """Return (nv, 8) at the local vertices: position (3) [m], velocity (3) [m/s], spin rate [rad/s], spin
        angle [rad].
        """

    @abstractmethod
    def couple(self, values: FloatArray, rows: FloatArray) -> FloatArray:
        """(n, 3) couples about nodes [N m] that the rows of the field ``orientation`` stand for, across the tangent.

        values, rows: (n, k) the field and its rows; what a result has along the tangent has no meaning.
        """

    @abstractmethod
    def element_results(self, layout: Any, x: FloatArray, y: FloatArray) -> FloatArray:
        """(nc, 9) per local cell in depth order: the columns of ``physics.beam.RESULT_NAMES``."""


class Top(Component):
    """Upper end of the string, fixed or moved.  ``anchor``: prescribed values at time 0 [m, -, rad].

    ``shift`` changes them.
    """

    anchor: FloatArray

    @abstractmethod
    def shift(self, distance: float) -> None:
        """Move the prescribed axial position by ``distance`` [m], down positive."""

    @property
    def on_path(self) -> bool:
        """Whether the end moves along a curved path; ``anchor`` then has coordinates on the path."""
        return False

    def prescribed_position(self) -> FloatArray:
        """Return the prescribed position (3,) at time 0 [m]; only where ``on_path``."""
        raise NotImplementedError

    def place(self) -> tuple[float, FloatArray, FloatArray]:
        """Return a point of the path near the end: depth [m], centre (3,) [m], tangent (3,); only of a top that may be free."""
        raise NotImplementedError

    def displace(self, offset: FloatArray) -> None:
        """Move the prescribed position by ``offset`` (3,) [m]."""
        for condition in self.prescribed():
            self.anchor += condition.directions[:, :3] @ offset

    def place_across(self, position: FloatArray) -> None:
        """Prescribe at time 0 the place of ``position`` (3,) [m] across the path of the top."""

    def copy_position(self, other: Top) -> None:
        """Copy the prescribed position at time 0 from the top of another model with other elements."""

    def align(self, position: FloatArray, slope: FloatArray, spin: FloatArray) -> None:
        """Prescribe at time 0 the given position (3,) [m], slope (3,) [-] and spin angle (1,) [rad] of the top node."""
        for condition in self.prescribed():
            self.anchor[:] = condition.directions @ np.concatenate([position, slope, spin])


@dataclass(frozen=True)
class SideContact:
    """Contact of a bit that cuts with the side of its hole, at one point of its axis.

    below: distance of that point below the bit's node [m]; stiffness [N/m], 0: it does not touch; clearance: radial [m].
    """

    below: float
    stiffness: float
    clearance: float


class Bit(Component):
    """The bit at the lower end of the string.  ``stiffness``: of its contact with the bottom [N/m]."""

    #: the growing hole of a bit that cuts rock, None otherwise
    hole: GrowingHole | None = None
    stiffness: float = 0.0

    @property
    def side_contact(self) -> SideContact | None:
        """Contact with the side of the hole; None: that of a rigid item."""
        return None

    @abstractmethod
    def weight_and_torque(self, state: Any) -> tuple[float, float]:
        """Compute weight on bit [N] and torque on bit [N m], zero on ranks without the bit."""

    def weight_and_torque_of(self, steps: Any) -> FloatArray | None:
        """(k, 2) ``weight_and_torque`` after each of k recorded steps; None where they are found one by one only."""
        return None

    def element_results(self, state: Any) -> FloatArray:
        """Results of the bit, zero on ranks without it: weight [N] and torque [N m] first."""
        return np.array(self.weight_and_torque(state))

    @abstractmethod
    def depth_of_face(self, state: Any) -> tuple[float, FloatArray]:
        """Compute the depth of the face below the end of the hole [m] and its gradient (n,) by the local unknowns."""

    @abstractmethod
    def depth_for(self, weight: float) -> float:
        """Compute the depth [m] at which the resting bit carries ``weight`` [N]."""

    @abstractmethod
    def torque_for(self, weight: float, spin: float) -> float:
        """Compute the torque [N m] of the bit that turns with ``spin`` [rad/s] under ``weight`` [N].

        It is not negative; it brakes the rotation.
        """

    @abstractmethod
    @contextmanager
    def preloaded(self, weight: float, travel: float) -> Iterator[None]:
        """Context in which a soft spring replaces the bottom.

        It carries ``weight`` [N] after ``travel`` [m].
        """

    @abstractmethod
    def copy_sliding_direction(self, other: Any) -> None:
        """Copy the sliding direction that statics imposed on the bit of another model."""

    def rate_under(
        self, force: FloatArray, axis: FloatArray, omega: float, drilled: float = 0.0
    ) -> FloatArray:
        """(3,) rate of penetration [m/s] under ``force`` (3,) of the bit on the rock [N]; zero without rock.

        axis: (3,) of the bit; omega: its rotation [rad/s]; drilled: length of new hole [m].
        """
        return np.zeros(3)

    def first_cut(self, state: Any) -> None:
        """Set the rates of a bit that begins to drill from its weight and speed."""

    def progress(self, state: Any) -> tuple[float, float]:
        """Length drilled since the start [m] and rate of penetration [m/s], zero on ranks without the bit."""
        return 0.0, 0.0

    @property
    def side_strength(self) -> float | None:
        """Force at which the rock beside the bit gives way [N]; None where it does not."""
        return None

    def orbit_and_overgauge(self, state: Any) -> tuple[float, float]:
        """Distance of the bit's centre from the axis of its hole and radius of the hole beside the bit less that of the bit [m].

        Zero on ranks without the bit, and without rock.
        """
        return 0.0, 0.0

    def drilled_hole(self) -> Well | None:
        """Return the hole with its new part; None where nothing is drilled."""
        return None

    @property
    def drills(self) -> bool:
        """Whether the bit cuts rock."""
        return self.hole is not None


class WallContact(Component):
    """Contact of the string with the wall of the hole."""

    @abstractmethod
    def element_results(self, state: Any) -> tuple[FloatArray, FloatArray]:
        """(nc, columns) per local cell and (nb, columns) per local rigid item: those of ``physics.contact.RESULTS``."""

    @abstractmethod
    def item_results(self, state: Any) -> FloatArray:
        """(bodies, columns) results of each rigid item, like ``element_results``, zero where another rank has it."""

    @abstractmethod
    def normal_force(self, cell: int) -> float:
        """Normal force on a local cell in the last residual [N]."""

    @abstractmethod
    def item_results_of(self, steps: Any) -> FloatArray:
        """(k, bodies, columns) ``item_results`` after each of k recorded steps."""

    @abstractmethod
    def normal_force_of(self, cell: int, steps: Any) -> FloatArray:
        """(k,) ``normal_force`` after each of k recorded steps."""

    @abstractmethod
    def copy_sliding_direction(self, other: Any) -> None:
        """Take over the sliding direction that statics imposed on the contact of another model."""


class Drive(Component):
    """A drive that turns the upper end.

    ``free_angle``: the drive has no angle to return to, so the whole string may stand at any angle.
    """

    free_angle: bool = False

    @abstractmethod
    def torque(self, t: float, state: Any) -> float:
        """Torque of the drive on the string [N m], this rank's share."""

    def results(self, state: Any) -> FloatArray:
        """Results of the drive on the rank with the top, zero elsewhere; empty for a drive without any."""
        return np.zeros(0)

    def figures(self, t: float, state: Any) -> FloatArray:
        """Numbers of its quantities at the time ``t`` [s], this rank's share; empty for a drive without any."""
        return np.zeros(0)

    def hold(self) -> None:
        """Hold the top for statics, where a drive would not."""

    def start(self, state: Any, at_rest: bool = False) -> None:
        """Begin the motion from statics; the drive goes on with the static torque.

        at_rest: without rotation, for the modes about rest.
        """


class Hoist(Component):
    """Block, drum and what turns it, above the top.

    ``sensors``: measurements that are not known to the component, by name: this rank's share as a function of
    the time [s] and the state.
    """

    sensors: Mapping[str, Callable[[float, Any], float]] = {}

    @abstractmethod
    def figures(self, t: float, state: Any) -> FloatArray:
        """Numbers of its quantities at the time ``t`` [s] (``physics.hoist.FIGURES``), this rank's share."""

    def hook_load(self, t: float, state: Any) -> float | None:
        """Pull on the string [N], this rank's share; None where it is the reaction of a prescribed top."""
        return None

    def hold(self) -> None:
        """Prescribe the axial position of the top, for statics; the line takes no part."""

    def start(self, state: Any, hook_load: float, shared: FloatArray, at_rest: bool = False) -> None:
        """Begin the motion after ``hold``: the line is stretched by the static load.

        hook_load: static [N]; shared: sum of ``local_update`` over all ranks; at_rest: the drum stands still.
        """

    def balance(self, state: Any) -> str:
        """Close the loop in charge about the present state, inside the limits, for linear models; returns what was done.

        Empty without an autodriller.
        """
        return ""

    def sensed_loop(self) -> str | None:
        """Loop in charge after ``balance`` whose measurement is one of ``sensors``; None without."""
        return None

    def set_measured(self, kind: str, value: float) -> float:
        """Set the measurement of a loop of ``sensors``; returns the one before, on the rank with the block."""
        return 0.0


class ReamingTool(Component):
    """Cutters above the bit that widen the hole.

    node: that carries the reamer; ring: area of the rock that it takes from the wall [m2]; depth_field: its unknown metres
    reamed; shoulder: measured depth of the shoulder at the start [m].
    """

    node: int
    ring: float
    depth_field: str
    shoulder: float

    @abstractmethod
    def weight_and_torque_at(self, depth: float) -> tuple[float, float]:
        """Weight [N] and torque, not negative [N m], at the start of a reamer whose node rests at measured depth ``depth`` [m]."""

    @property
    @abstractmethod
    def reamed(self) -> float:
        """Metres reamed after the last accepted step."""

    @property
    @abstractmethod
    def stands(self) -> bool:
        """Whether the cutters stand on the shoulder."""

    @abstractmethod
    def element_results(self, state: Any) -> FloatArray:
        """(5,) weight [N], torque [N m], rate [m/s], stored energy [J], power into the rock [W]; zero on other ranks."""

    @abstractmethod
    def depth(self, state: Any) -> float:
        """Measured depth of the shoulder [m] on the rank with the reamer, 0 elsewhere."""

    @abstractmethod
    def first_cut(self, state: Any) -> None:
        """Set profile and rate so that the cutters carry their static weight at the start of the motion."""


class SteeringTool(Component):
    """A rotary steerable tool."""

    @abstractmethod
    def share(self, t: float) -> float:
        """Commanded share of force or tilt [-] at the time ``t`` [s] on the rank with the tool, 0 elsewhere."""

    @abstractmethod
    def tool_face(self, t: float) -> float:
        """Commanded tool face [rad] at the time ``t`` [s] on the rank with the tool, 0 elsewhere."""

    def stress_free_curvature(self) -> tuple[IntArray, FloatArray]:
        """Local elements (k,) that it bends without stress, and their curvature towards the tool face (k, 3) [1/m].

        Of the last evaluation; empty for pads.
        """
        return np.zeros(0, dtype=np.int32), np.zeros((0, 3))


class Motor(Component):
    """A downhole motor, which turns what is below it in the string.  ``cell``: of its joint."""

    cell: int
    #: mass of the rotor, at the node above the joint and not in the mesh [kg]
    rotor_mass: float = 0.0

    @property
    @abstractmethod
    def static_speed(self) -> float:
        """Speed of the rotor from the stator in statics [rad/s]; friction below the motor takes its direction from it."""

    @property
    @abstractmethod
    def start_speed(self) -> float:
        """Speed of the rotor from the stator at the start of a run [rad/s]."""

    @abstractmethod
    def run_statically(self, flow: float) -> None:
        """Turn in statics as without torque at a flow rate [m3/s]; at 0 the motor stands."""

    @abstractmethod
    def update_static_speed(self, torque: float, flow: float) -> float:
        """Set the speeds by the torque [N m] and flow rate [m3/s] of a static state.

        Returns the larger change: of the speed as a share of the free speed, of the torque of that of the stall.
        """

    @abstractmethod
    def static_warnings(self, torque: float, flow: float, units: System) -> list[str]:
        """What the user should know of a static state under a torque [N m] at a flow rate [m3/s], in a system of units."""

    @abstractmethod
    def hold(self) -> None:
        """Hold the rotor for statics, which finds its torque."""

    @abstractmethod
    def start(self, state: Any) -> None:
        """Begin the motion from statics with the static torque."""

    #: lobes of the rotor, whose orbit turns back by so many turns for each of the rotor's; unbalance of the orbit [kg m]
    lobes: int = 1
    orbit_unbalance: float = 0.0

    @abstractmethod
    def balance_orbit(self, balanced: bool = True) -> None:
        """Leave out the turning force of the rotor's orbit, for linear models, or take it in again."""

    @abstractmethod
    def orbit_speed(self, t: float, state: Any) -> float:
        """Speed of the orbit in space [rad/s], clockwise positive; on the rank with the motor, 0 elsewhere."""

    @abstractmethod
    def figures(self, t: float, state: Any) -> FloatArray:
        """Numbers of its quantities at the time ``t`` [s] (``physics.tools.mud_motor.RESULTS``), this rank's share."""

    @abstractmethod
    def thrust(self, t: float, state: Any) -> float:
        """Load of the thrust bearing [N], this rank's share; positive while mud and weight push the rotor down."""

    @abstractmethod
    def housing(self, state: Any) -> FloatArray:
        """(6,) tangent and direction of the bend of the housing at its node, this rank's share."""

    @staticmethod
    @abstractmethod
    def tool_face(values: FloatArray) -> float:
        """Tool face [rad], between -pi and pi, of what ``housing`` returns."""

    @abstractmethod
    def torque_and_flow(self, t: float, state: Any) -> FloatArray:
        """(2,) torque of the motor [N m] and flow rate through it [m3/s] at the time ``t`` [s], this rank's share."""


class PulsedTool(Component):
    """A tool whose valve pulses the mud."""

    @abstractmethod
    def hold(self) -> None:
        """Let the valve stand, for statics."""

    @abstractmethod
    def start(self, state: Any) -> None:
        """Begin the motion from statics."""

    @abstractmethod
    def figures(self, t: float, state: Any) -> FloatArray:
        """Numbers of its quantities at the time ``t`` [s] (``physics.tools.agitator.RESULTS``), this rank's share."""


class JointSet(Component):
    """All joints of the string.  ``joints``: their places; RESULTS: columns of ``element_results``."""

    joints: tuple[StringJoint, ...]
    RESULTS: tuple[str, ...]

    @abstractmethod
    def lock(self, cell: int, locked: bool) -> None:
        """Hold all motions in the joint of a ``cell``, or let it move as its kind does."""

    @abstractmethod
    def element_results(self, state: Any) -> FloatArray:
        """(joints, 12) results of all joints, zero on ranks without the joint: columns of ``physics.joints.RESULT_NAMES``."""

    @abstractmethod
    def jar_figures(self, state: Any) -> FloatArray:
        """(4 k,) state, travel [m], force of the stops [N] and number of shots of each jar, zero on ranks without it."""
