"""From a case to a drilling model: mesh, hole, components, discrete system, initial position of the string."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple, TypeVar

import numpy as np
from petsc4py import PETSc

from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.ends import BitBottom, DrivenTop, ForcedBottom, HeldBottom, HeldTop, LineLoad
from drillpetsc.case.blocks.ends import TopDrive as TopDriveCase
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.fem.component import Component
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.frames import Frames, transported_frames
from drillpetsc.geometry.growing_hole import GrowingHole
from drillpetsc.geometry.well import StraightAxis, Well
from drillpetsc.model.fluid import FluidComponents, StringInMud, build_fluid
from drillpetsc.model.hole import axis_of, build_well, hole_depth
from drillpetsc.model.mesh import MeshOf, build_mesh, curvature_by_tool_face
from drillpetsc.model.own_components import Site, own_components
from drillpetsc.model.quaternion import quaternion_components
from drillpetsc.model.rock_bit import build_rock_bit
from drillpetsc.model.tools.agitator import build_agitators
from drillpetsc.model.tools.mud_motor import build_mud_motor
from drillpetsc.model.tools.reamer import build_reamers, well_of_reamer
from drillpetsc.model.tools.steering import build_steering
from drillpetsc.model.top import build_drive, build_hoist, connect_sensors
from drillpetsc.model.wall import mean_and_hardness
from drillpetsc.physics import interfaces
from drillpetsc.physics.beam import AncfBeam
from drillpetsc.physics.bit.bit_on_bottom import BitOnBottom
from drillpetsc.physics.bit.rock_bit import RockBit
from drillpetsc.physics.contact import Contact, ContactLaw
from drillpetsc.physics.end_conditions import EndPlace, FixedEnd, Loads, NodeLoad, RotaryDrive, TopDrive
from drillpetsc.physics.fluid.annulus_flow import AnnulusFlow
from drillpetsc.physics.held_string import HeldString
from drillpetsc.physics.hole_path import HolePath, is_curved
from drillpetsc.physics.joints import Joints
from drillpetsc.physics.own_law import FRICTION, OwnLaw
from drillpetsc.physics.precurvature import Precurvature
from drillpetsc.physics.quaternion.contact import QuaternionContact
from drillpetsc.physics.rigid_bodies import RigidBodies
from drillpetsc.physics.tools.mud_motor import MudMotor
from drillpetsc.physics.tools.reamer import Reamer
from drillpetsc.physics.top.hoist import Hoist
from drillpetsc.time_function import Constant
from drillpetsc.unit_systems import shown

Part = TypeVar("Part")


GAUSS = np.polynomial.legendre.leggauss(4)  # exact to degree 7


@dataclass
class DrillingModel:
    """All parts of a model.

    case: the user's case; mesh: of the string.
    well: the present hole, its newly drilled part included; None without a hole.
    frames: reference frames of the nodes.
    position: (n_nodes, 3) unstrained string along the axis of the hole [m]; tangent: (n_nodes, 3) unit
    tangents.
    components: all components, in the order of the discrete system.
    beam: the string; top: its upper end.
    contact, bit: the components of these kinds, None if absent.  A contact is between a string and a hole, its ``well``.
    system: the discrete system.
    fluid: components of the drilling fluid, None in a dry model.

    Machines (drive, hoist, tools) are components like any other: hooks of ``Component`` hold, start and balance them, and
    ``parts`` finds one by its class if its numbers are needed.
    """

    case: Case
    mesh: StringMesh
    well: Well | None
    frames: Frames
    position: FloatArray
    tangent: FloatArray
    components: tuple
    beam: interfaces.Beam
    top: interfaces.Top
    contact: Contact | None
    bit: interfaces.Bit | None
    system: DiscreteSystem
    fluid: FluidComponents | None = None

    def parts(self, kind: type[Part]) -> tuple[Part, ...]:
        """The components of a class, from the top."""
        return tuple(part for part in self.components if isinstance(part, kind))

    def part(self, kind: type[Part]) -> Part | None:
        """The component of a class that a string has once, None if absent."""
        return next((part for part in self.components if isinstance(part, kind)), None)

    @property
    def conservative(self) -> bool:
        """Whether all loads have a potential; moments in space and loads that turn with the section have none."""
        return all(component.conservative for component in self.components)

    @property
    def effective_mass(self) -> FloatArray:
        """(n,) effective mass per length [kg/m]: steel and mud in the bore, minus the displaced mud.

        Manual: eq-mud-buoyed-weight.
        """
        mass = self.mesh.mass.copy()
        for motor in self.parts(MudMotor):  # its rotor, over the element above its joint
            mass[motor.cell - 1] += motor.rotor.mass / self.mesh.length[motor.cell - 1]
        mud = self.fluid
        if mud is not None:
            mass += mud.constants.density * mud.bore.bore.area if mud.bore is not None else 0.0
            mass -= mud.constants.density * mud.annulus.annulus.outer if mud.annulus is not None else 0.0
        return mass

    @property
    def given_well(self) -> Well:
        """``well`` of a model with a hole."""
        assert self.well is not None
        return self.well

    @property
    def given_contact(self) -> Contact:
        """``contact`` of a string that touches its hole."""
        assert self.contact is not None
        return self.contact

    @property
    def axis(self) -> Well | StraightAxis:
        """The axis of the hole, or the straight line of a string without a hole."""
        return self.well or StraightAxis(self.position[0], self.tangent[0])

    @property
    def annulus(self) -> AnnulusFlow | None:
        """The flow around the string, None without one."""
        return None if self.fluid is None else self.fluid.annulus

    @property
    def motor_speed(self) -> float:
        """What a downhole motor adds in statics to the rotation of the string below it [rad/s]; 0 without one."""
        return sum(motor.static_speed for motor in self.parts(MudMotor))

    def copy_sliding_direction(self, other: DrillingModel) -> None:
        """Take over the sliding directions that statics imposed on another model of the same string."""
        theirs = {part.name: part for part in other.components}
        for part in self.components:
            if part.name in theirs:
                part.copy_sliding_direction(theirs[part.name])

    @property
    def drilling(self) -> interfaces.Bit | None:
        """The bit if it cuts rock, otherwise None."""
        return self.bit if self.bit is not None and self.bit.drills else None

    @property
    def breaks(self) -> tuple[float, ...]:
        """Times at which an input jumps or bends [s]."""
        rotation = self.case.top.rotation if is_quasi_static(self.case) else None
        return tuple(
            sorted(
                {b for component in self.components for b in component.breaks()}
                | set(rotation.breaks() if rotation is not None else ())
            )
        )


def build_model(
    case: Case,
    comm: PETSc.Comm | None = None,
    motion: tuple[float, float] | None = None,
    balanced: bool = False,
    like: MeshOf | None = None,
) -> DrillingModel:
    """Create the model of ``case``; collective.

    comm: PETSc communicator, all ranks by default.
    motion: of a static question, for automatic element lengths (see ``build_mesh``).
    balanced: leave out what turns with the section: eccentric mass, unbalance, bends and stress-free curvature.
    like: the mesh of nearly the same case, whose elements are taken.
    Raises CaseError if mesh or hole are impossible.
    """
    for key in ("level_in_string", "floated_length"):
        given = None if case.fluid is None else getattr(case.fluid, key)
        if given is not None:
            want = f"no {key}, except in roadmap and calibrate with the soft string"
            hint = (
                "a plugged string without it is empty; an item that holds mud can have a weight that contains it, density times "
                "area of the bore more: loads and contact are right then, wall tension and stresses without that mud's pressure"
            )
            got = shown(given, "length", case.shown_units, 6)
            raise CaseError(at=f"fluid.{key}", got=got, want=want, hint=hint)
    if case.components and (case.hold_string or case.beam.formulation == "quaternion"):
        want = "no components of the user with hold_string, or with beam.formulation quaternion"
        raise CaseError(at="components", want=want)
    well = well_of_reamer(case, build_well(case))
    mesh = build_mesh(case, well, motion, like)
    position, tangent = axis_of(case, well).at(mesh.node_depth)[:2]
    frames = transported_frames(tangent)
    mesh = _balanced(mesh) if balanced else curvature_by_tool_face(mesh, frames)
    string = _NO_STRING
    if case.beam.formulation == "quaternion":
        mesh = _with_one_strain(mesh)
        if is_quasi_static(case):  # a section that turns in place has no strain rate on average over a turn
            mesh = replace(mesh, stiffness_damping=np.zeros_like(mesh.stiffness_damping))
        string = _quaternion_string(case, mesh, well, frames, position, tangent)
    elif not case.hold_string:
        string = _ancf_string(case, mesh, well, frames, position, tangent, balanced)
    bit, components = string.bit, list(string.components)
    hole = bit.hole if bit is not None else None
    fluid = build_fluid(StringInMud(case, mesh, well, position, tangent, hole, string.reamers))
    components += fluid.components if fluid is not None else ()
    system = DiscreteSystem(mesh, frames, components, comm)
    system.item_names = tuple(item.name or item.kind for item in case.string)
    system.units = case.said_units
    model = DrillingModel(
        case,
        mesh,
        well,
        frames,
        position,
        tangent,
        tuple(components),
        string.beam or HeldString(position, tangent, system.chain.vertices),
        string.top,
        string.contact,
        bit,
        system,
        fluid,
    )
    hoist = model.part(Hoist)
    if hoist is not None:
        connect_sensors(hoist, model.part(interfaces.Drive), bit, fluid)
    if bit is not None and bit.hole is not None:
        _subscribe_to_hole(model, bit.hole)
    return model


class _String(NamedTuple):
    """The components of a string and its ends; the named ones are also among ``components`` as well."""

    components: tuple[Component, ...] = ()
    beam: interfaces.Beam | None = None
    top: interfaces.Top = interfaces.FreeTop()
    contact: Contact | None = None
    bit: BitOnBottom | RockBit | None = None
    reamers: tuple[Reamer, ...] = ()


_NO_STRING = _String()  # of a string that is held: mud alone flows


def _present(*components: Component | None) -> tuple[Component, ...]:
    return tuple(component for component in components if component is not None)


def _ancf_string(
    case: Case,
    mesh: StringMesh,
    well: Well | None,
    frames: Frames,
    position: FloatArray,
    tangent: FloatArray,
    balanced: bool,
) -> _String:
    """Create the components of a string of ANCF elements."""
    gravity = np.array(case.gravity, dtype=float)
    contact, bit = _contact(case, mesh, well), _bit(case, mesh, well)
    beam = AncfBeam(mesh, frames, gravity, contact.impact_depth if contact is not None else np.inf)
    joints: tuple[Component, ...] = ()
    if mesh.joints:
        held = Joints(mesh, frames)
        motor = build_mud_motor(case, held, gravity, balanced)
        joints = (held, *_present(motor), *build_agitators(case, mesh))
    top, machines = _top_components(
        case, mesh, EndPlace(position[0], tangent[0], path=_top_path(well, frames), frames=frames)
    )
    loads = _loads(case, mesh, tangent)
    breaks = tuple(b for q in case.loads for b in q.value_over.breaks()) + _top_breaks(case)
    reamers = build_reamers(case, mesh, well, bit)
    components: tuple[Component, ...] = (
        beam,
        *_optional_components(mesh, frames, gravity, balanced=is_quasi_static(case)),
        *joints,
        *_present(top if top.prescribes else None, *machines),
        *_bottom_components(case, EndPlace(position[-1], tangent[-1], mesh.nodes - 1)),
        *((Loads(loads, frames, breaks),) if loads else ()),
        *_present(contact, bit, *reamers, build_steering(case, mesh, well, frames, tangent)),
    )
    site = Site(case, mesh, frames, well, position, tangent)
    components += own_components(site, (component.name for component in components))
    return _String(components, beam, top, contact, bit, reamers)


def _quaternion_string(
    case: Case,
    mesh: StringMesh,
    well: Well | None,
    frames: Frames,
    position: FloatArray,
    tangent: FloatArray,
) -> _String:
    """Create the components of a string of quaternion elements."""
    contact, bit = _contact(case, mesh, well, QuaternionContact), _bit(case, mesh, well)
    beam, top, components = quaternion_components(
        case,
        mesh,
        frames,
        ends=(
            EndPlace(position[0], tangent[0], path=_top_path(well, frames)),
            EndPlace(position[-1], tangent[-1], mesh.nodes - 1),
        ),
        loads=_loads(case, mesh, tangent),
        breaks=tuple(b for q in case.loads for b in q.value_over.breaks()) + _top_breaks(case),
        contact=contact,
    )
    still, reamers = is_quasi_static(case), build_reamers(case, mesh, well, bit)
    if mesh.bodies or (mesh.eccentricity.any() and not still):
        components.append(RigidBodies(mesh, frames, np.array(case.gravity, dtype=float), still))
    if mesh.joints:
        components.append(Joints(mesh, frames))
    tools = _present(bit, build_steering(case, mesh, well, frames, tangent), *reamers)
    return _String((*components, *tools), beam, top, contact, bit, reamers)


def _with_one_strain(mesh: StringMesh) -> StringMesh:
    """The mesh of the quaternion element: one strain on both sides of a change of section.

    Pipes above and below a rigid item have different strains.
    """
    items = np.zeros(mesh.nodes, dtype=bool)
    items[[body.node for body in mesh.bodies]] = True
    items[:-1] |= mesh.rigid_above > 0
    return replace(mesh, junction=mesh.junction & items)


def _balanced(mesh: StringMesh) -> StringMesh:
    """The mesh of a string that is straight and balanced, with the same elements."""
    nothing = np.zeros_like(mesh.eccentricity)
    bodies = tuple(replace(b, offset=(0.0, 0.0)) for b in mesh.bodies)
    return replace(mesh, eccentricity=nothing, curvature=nothing.copy(), bent=(), bodies=bodies)


def _subscribe_to_hole(model: DrillingModel, hole: GrowingHole) -> None:
    """Subscribe the model and its components to borehole growth."""

    def update_well(well: Well) -> None:
        model.well = well

    hole.followers.append(update_well)
    for component in model.components:
        hole.followers.append(component.follow_hole)


def is_quasi_static(case: Case) -> bool:
    """Whether the string of the case moves without inertia."""
    return case.time is not None and case.time.mode == "quasi_static"


def _optional_components(mesh: StringMesh, frames: Frames, gravity: FloatArray, balanced: bool) -> list:
    """Create the components for rigid bodies, eccentric mass, and stress-free curvature, if present.

    balanced: leave out eccentric mass and unbalance.
    """
    components: list = []
    if mesh.bodies or (mesh.eccentricity.any() and not balanced):
        components.append(RigidBodies(mesh, frames, gravity, balanced))
    if mesh.curvature.any():
        components.append(Precurvature(mesh, frames))
    return components


# ---------------------------------------------------------------------- ends
def _top_path(well: Well | None, frames: Frames) -> HolePath | None:
    """Create the path along which the top moves; None if it is one straight line."""
    if well is None or not is_curved(well):
        return None
    return HolePath(well, 0.0, frames.second_director[0])


def _top_components(
    case: Case, mesh: StringMesh, place: EndPlace
) -> tuple[interfaces.Top, tuple[Component, ...]]:
    """Create the top end and the machines above it: a drive of its rotation, a hoist."""
    top = case.top
    if isinstance(top, HeldTop):
        if top.kind == "free":
            return interfaces.FreeTop(), ()
        return FixedEnd(place, top.kind), ()
    if isinstance(top, TopDriveCase):
        # without inertia rotation acts through the direction of friction only
        still = is_quasi_static(case)
        motor = top.motor is not None and not still
        rotation = None if motor else Constant(0.0) if still else top.rotation
        machines = (build_drive(case, mesh),) if motor else ()
        if top.hoist is not None and not still:
            guided, hoist = build_hoist(case, mesh.nodes, place, rotation)
            return guided, (*machines, hoist)
        lowering = None if top.force is not None else top.lowering
        return TopDrive(place, rotation, lowering, top.hinged, top.guided), machines
    assert isinstance(top, DrivenTop)
    driven = TopDrive(place, None, top.lowering)
    return driven, (RotaryDrive(top.rotation, top.stiffness, top.damping, top.inertia),)


def _top_breaks(case: Case) -> tuple[float, ...]:
    force = case.top.force
    return force.breaks() if force is not None else ()


def _bottom_components(case: Case, place: EndPlace) -> list[FixedEnd]:
    """Create the fixed lower end of a clamped or pinned string."""
    bottom = case.bottom
    if not isinstance(bottom, HeldBottom) or bottom.kind == "free":
        return []
    return [FixedEnd(place, bottom.kind, spin=bottom.kind == "clamped")]


def _contact(
    case: Case, mesh: StringMesh, well: Well | None, kind: type[Contact] = Contact
) -> Contact | None:
    """Create the wall contact of the string, None without one; ``kind``: its class."""
    c = case.contact
    if c is None or well is None:
        return None
    ratio, speed = 1.0, 1.0
    if c.stribeck is not None:
        kinetic = max(q.friction for q in case.given_well.sections)
        ratio, speed = (c.stribeck.static / kinetic if kinetic > 0 else 1.0), c.stribeck.speed
    q = c.friction_law
    own = None if q is None else OwnLaw(FRICTION, q.function, q.call, q.parameters)
    stiffness, hardness = (
        mean_and_hardness(case, mesh, well) if c.stiffness == "physical" else (c.stiffness, None)
    )
    law = ContactLaw(
        stiffness,
        c.law,
        c.restitution,
        c.restitution_speed,
        c.slip_velocity,
        ratio,
        speed,
        c.points_per_element,
        own,
    )
    return kind(mesh, well, law, case.formation is None, case.top.kind == "free", hardness)


def _bit(case: Case, mesh: StringMesh, well: Well | None) -> BitOnBottom | RockBit | None:
    """Create the bit of a string on bottom, None without one."""
    bottom = case.bottom
    if not isinstance(bottom, BitBottom) or well is None:
        return None
    if case.formation is not None:
        return build_rock_bit(case, mesh, well)
    end, axis, _ = well.at(np.array([hole_depth(case)]))
    face = mesh.total_length - mesh.node_depth[-1]
    radius = next((b.radius for b in reversed(mesh.bodies) if b.kind == "bit"), 0.5 * mesh.outer_diameter[-1])
    slip = case.contact.slip_velocity if case.contact else 0.01
    return BitOnBottom(
        mesh.nodes - 1,
        face,
        radius,
        bottom.stiffness,
        bottom.friction,
        np.asarray(end)[0],
        np.asarray(axis)[0],
        slip,
    )


# ---------------------------------------------------------------------- loads
def _loads(case: Case, mesh: StringMesh, tangent: FloatArray) -> tuple[NodeLoad, ...]:
    """Create the nodal loads of the case, including loads at the ends."""
    out: list[NodeLoad] = []
    for load in case.loads:
        factor = (
            None
            if isinstance(load.value_over, Constant) and load.value_over.constant == 1.0
            else load.value_over.value
        )
        section = load.frame == "section"
        if isinstance(load, LineLoad):
            out += _line_load(load, mesh, section, factor)
        else:
            node = mesh.nearest_node(load.at)
            out.append(NodeLoad(node, load.force, load.moment, section=section, factor=factor))
    if isinstance(case.bottom, ForcedBottom):
        out.append(NodeLoad(mesh.nodes - 1, case.bottom.force, case.bottom.moment))
    force = case.top.force
    if force is not None:  # tension positive: the drive pulls the top node up along the axis
        out.append(NodeLoad(0, tuple(-tangent[0]), factor=force.value))
    return tuple(out)


def _line_load(load: LineLoad, mesh: StringMesh, section: bool, factor) -> list[NodeLoad]:
    """Compute consistent nodal loads of a uniform load between two depths (manual: eq-beam-node-load).

    They are integrals of the cubic shape functions over the loaded part.  In section axes, which turn with
    the pipe, force and moment are distributed linearly between an element's nodes.

    section: the load is given in section axes.
    factor: its factor as a function of time [s], None: constant.
    """
    f, m, out = np.array(load.force), np.array(load.moment), []
    reached = np.minimum(load.to, mesh.lower) > np.maximum(load.from_, mesh.upper)  # a joint has no length
    for e in np.flatnonzero(reached).tolist():
        upper, lower = mesh.upper[e], mesh.lower[e]
        a, b, L = max(load.from_, upper), min(load.to, lower), lower - upper
        x, w = GAUSS
        x = ((b - a) * x / 2 + (a + b) / 2 - upper) / L
        w = w * (b - a) / 2
        if section:
            shares, slopes = (w @ (1 - x), w @ x), (0.0, 0.0)
        else:
            shares = (w @ (1 - 3 * x**2 + 2 * x**3), w @ (3 * x**2 - 2 * x**3))
            slopes = (L * (w @ (x - 2 * x**2 + x**3)), L * (w @ (x**3 - x**2)))
        linear = (w @ (1 - x), w @ x)
        for end in (0, 1):
            out.append(
                NodeLoad(
                    e + end,
                    tuple(shares[end] * f),
                    tuple(linear[end] * m),
                    tuple(slopes[end] * f),
                    section,
                    factor,
                    e,
                )
            )
    return out
