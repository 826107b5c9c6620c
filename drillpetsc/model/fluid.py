"""From the fluid of a case to its components: bore, annulus and bit (manual: sec-mud)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from itertools import pairwise
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.fluid import OwnRheology, flow_constants
from drillpetsc.case.blocks.items.motor import PositiveDisplacementMotor
from drillpetsc.case.blocks.items.string import Rigid
from drillpetsc.case.case import Case
from drillpetsc.case.quantities import largest
from drillpetsc.errors import CaseError
from drillpetsc.fem.quantity import OneStep
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.growing_hole import GrowingHole
from drillpetsc.geometry.well import Well
from drillpetsc.kernels.parameters import constant
from drillpetsc.model.hole import top_of_string
from drillpetsc.model.mud_sections import build_bore, build_walls, loss_tables, metal_below, poisson
from drillpetsc.physics.fluid.added_mass import (
    chi_confined,
    chi_eccentric,
    lateral_damping,
    stokes_coefficients,
)
from drillpetsc.physics.fluid.annulus_flow import AnnulusFlow, FlowLine, HoleAround
from drillpetsc.physics.fluid.bit_flow import BitEnd, BitFlow
from drillpetsc.physics.fluid.bore_flow import BoreFlow
from drillpetsc.physics.fluid.channel_flow import FLOW_SCALE, PRESSURE_SCALE, FluidConstants
from drillpetsc.physics.fluid.channels import Annulus, AnnulusWalls, HoleVolume
from drillpetsc.physics.fluid.hermite.flow import HermiteAnnulus, HermiteBit, HermiteBore, volumes_at_rest
from drillpetsc.physics.fluid.joint_seals import JointSeals
from drillpetsc.physics.fluid.moving_hole import LateralCoefficients, MovingHole
from drillpetsc.physics.fluid.mud_items import MudItem, MudItems, end_leakage
from drillpetsc.physics.fluid.own_rheology import flow_curve
from drillpetsc.physics.fluid.reamed_rings import ReamedRings
from drillpetsc.physics.fluid.rheology import Rheology, wall_shear
from drillpetsc.physics.fluid.side_nozzles import SideLink, SideNozzles
from drillpetsc.physics.fluid.swirl import steady_share
from drillpetsc.physics.fluid.tool_losses import SurfaceLine, ToolLosses
from drillpetsc.physics.own_law import RHEOLOGY, OwnLaw
from drillpetsc.physics.tools.reamer import Reamer
from drillpetsc.time_function import Constant
from drillpetsc.unit_systems import shown

LEAST_OPEN = 1e-4  # share of the hole that must be open around a rigid item
LEAST_BESIDE = 0.25  # share of the hole that bits and stabilizers leave open to mud that moves across it
LARGEST_STRETCH = 0.005  # of a string over its length; steel yields before
LARGEST_ECCENTRICITY = 0.98  # eccentricity [-] up to which the added mass is fitted
CHI_ROUNDING = constant("chi_rounding")

#: smallest flow rate of a pump to which tolerances refer, of the usual flow rate [-]
LEAST_PUMPED = 0.05


@dataclass(frozen=True)
class FluidComponents:
    """Components of the drilling fluid.

    constants: of the fluid.
    bore, annulus, bit: None if the model has no such channel.
    volumes(pressure): nodal volumes (n+1,) [m3] by field of fluid at rest under a pressure at the top [Pa];
    only with formulation hermite.
    surface_line: between pump and string, None without one.
    seals: of telescoping joints, None without any.
    side: nozzles above the bit, None without any; rings: that reamers cut out of the wall, None without any.
    losses: of tools by a table, None without any.
    items: mud across the hole beside rigid items, None without any.
    """

    constants: FluidConstants
    bore: BoreFlow | None
    annulus: AnnulusFlow | None
    bit: BitFlow | None
    volumes: Callable[[float], dict[str, FloatArray]] | None = None
    surface_line: SurfaceLine | None = None
    seals: JointSeals | None = None
    side: SideNozzles | None = None
    rings: ReamedRings | None = None
    losses: ToolLosses | None = None
    items: MudItems | None = None

    @property
    def components(self) -> tuple:
        """The components that are present."""
        parts = (
            self.bore,
            self.annulus,
            self.bit,
            self.seals,
            self.side,
            self.rings,
            self.losses,
            self.items,
        )
        return tuple(r for r in parts if r is not None)

    def pump_pressure_of(self, steps: OneStep) -> FloatArray:
        """(k,) pressure at the upper end of the bore, plus the loss of the surface line [Pa]; zero if another rank has the end."""
        flow = None if self.bore is None else self.bore.pumped_of(steps)
        if self.bore is None or flow is None:
            return np.zeros(len(steps))
        pressure, line = self.bore.upper_pressure_of(steps), self.surface_line
        if line is None:
            return pressure
        rates = flow.tolist()
        lost = {q: line.loss(q) for q in dict.fromkeys(rates)}  # a pump's flow is the same in most steps
        return np.asarray(pressure + [lost[q] for q in rates])


def usual_sizes(case: Case, mesh: StringMesh) -> tuple[float, float]:
    """Return the pressure [Pa] and the flow rate [m3/s] to which the tolerances of the mud refer.

    The flow is at most half of the pump's largest flow. The pressure is at most the wave pressure of this flow in the
    narrowest bore, rho c Q/A (Joukowsky): a small pump's waves are small as well (manual: sec-time-error).  A trickle counts
    as ``LEAST_PUMPED`` of the usual flow, since the string moves the mud too.
    """
    f = case.fluid
    assert f is not None
    pumped = 0.0 if f.pump_pressure is not None or not case.has_bore else 0.5 * largest(f.flow_rate)
    areas = mesh.bore_area[mesh.bore_area > 0.0]
    if pumped <= 0.0 or not len(areas):
        return PRESSURE_SCALE, FLOW_SCALE
    pumped = max(pumped, LEAST_PUMPED * FLOW_SCALE)
    wave = float(np.sqrt(f.density * f.bulk_modulus) * pumped / areas.min())
    return min(PRESSURE_SCALE, wave), min(FLOW_SCALE, pumped)


def build_rheology(case: Case, annulus: bool = False) -> Rheology:
    """Create the rheology of the case's fluid, in the string or in the annulus."""
    q = (case.given_fluid.annulus_rheology if annulus else None) or case.given_fluid.rheology
    curve = None
    if isinstance(q, OwnRheology):
        curve = flow_curve(OwnLaw(RHEOLOGY, q.function, q.call, q.parameters))
    consistency, index, yield_stress = flow_constants(q)
    return Rheology(
        q.model,
        law=q.law,
        consistency=consistency,
        index=index,
        yield_stress=yield_stress,
        shear_rate_eps=q.shear_rate,
        curve=curve,
    )


@dataclass(frozen=True)
class StringInMud:
    """What the mud flows through: the string, and the hole around it.

    position, tangent: (n+1, 3) of the nodes along the hole [m, -].
    hole: the growing hole of a bit that drills, else None; reamers: that widen it.
    """

    case: Case
    mesh: StringMesh
    well: Well | None
    position: FloatArray
    tangent: FloatArray
    hole: GrowingHole | None
    reamers: tuple[Reamer, ...]

    @property
    def held_at(self) -> FloatArray | None:
        """(n+1, 3) positions of the nodes of a held string [m], None for a string that moves."""
        return self.position if self.case.hold_string else None

    def present_well(self) -> Well:
        """The well as it is drilled now."""
        well = self.well if self.hole is None else self.hole.well
        assert well is not None
        return well


def build_fluid(string: StringInMud) -> FluidComponents | None:
    """Create the components of the case's fluid, None without one."""
    case, mesh, f = string.case, string.mesh, string.case.fluid
    if f is None:
        return None
    constants = FluidConstants(
        f.density,
        f.bulk_modulus,
        np.array(case.gravity, dtype=float),
        build_rheology(case).parameters(),
        f.clinging,
        *usual_sizes(case, mesh),
    )
    bore_flow = _bore_flow(string, constants) if case.has_bore else None
    annulus = _annulus_flow(string, constants) if case.has_annulus else None
    bit: BitFlow | None = None
    if bore_flow is not None and not case.bottom.plugged or annulus is not None:
        bit = _bit_flow(string, constants, bore_flow, annulus)
    volumes = _volumes_at_rest(string, bore_flow, annulus, bit) if f.formulation == "hermite" else None
    seals = None
    if any(joint.seal_area > 0 for joint in mesh.joints):
        seals = JointSeals(mesh, constants, bore_flow is not None, annulus is not None, f.outlet_pressure)
    side = None
    if case.side_nozzles and isinstance(bore_flow, BoreFlow):
        side = SideNozzles(
            mesh,
            side_links(case, mesh),
            f.discharge_coefficient,
            bore_flow,
            annulus,
            f.outlet_pressure,
            _lower_end_area(case, mesh),
        )
    rings = items = None
    if annulus is not None and not case.hold_string:
        if string.reamers:
            rings = ReamedRings(mesh.nodes - 1, string.reamers, constants, f.cuttings == "returned")
        found = _mud_items(case, mesh, annulus.annulus)
        items = MudItems(found, string.present_well) if found else None
    curves = loss_tables(case, mesh) if bore_flow is not None else ()
    losses = ToolLosses(curves, constants) if curves else None
    line = _surface_line(case)
    return FluidComponents(
        constants, bore_flow, annulus, bit, volumes, line, seals, side, rings, losses, items
    )


def _bore_flow(string: StringInMud, constants: FluidConstants) -> BoreFlow:
    """Create the flow in the string."""
    case, mesh, f = string.case, string.mesh, string.case.given_fluid
    bore, narrowing = build_bore(case, mesh), poisson(case, mesh)
    if f.formulation == "hermite":
        return HermiteBore(mesh, bore, constants, narrowing, f.flow_rate, case.bottom.plugged, string.held_at)
    flow = None if f.pump_pressure is not None else f.flow_rate
    return BoreFlow(mesh, bore, constants, narrowing, flow, f.pump_pressure, string.held_at)


def _annulus_flow(string: StringInMud, constants: FluidConstants) -> AnnulusFlow:
    """Create the flow around the string; constants: of the fluid, with its rheology in the string."""
    case, mesh, well, f = string.case, string.mesh, string.well, string.case.given_fluid
    assert well is not None
    if f.annulus_rheology is not None:
        constants = replace(constants, rheology=build_rheology(case, annulus=True).parameters())
    walls = build_walls(case, mesh)
    top = top_of_string(case, mesh.total_length)
    sizes = walls.annulus(HoleVolume(well), np.arange(len(mesh.upper)), top + mesh.upper, top + mesh.lower)
    if not case.hold_string:  # the flow past a held string does not include rigid items
        _refuse_closed_annulus(case, mesh, sizes)
    moving_hole = None
    if not case.hold_string and (string.hole is not None or not _is_uniform(well, walls)):
        lateral = partial(_lateral_coefficients, case)
        moving_hole = MovingHole(mesh, walls, string.present_well, lateral, string.reamers)
    choke = 0.0 if f.choke is None else 1 / (2 * f.choke.discharge_coefficient**2 * f.choke.area**2)
    arguments = (
        mesh,
        HoleAround(sizes, well, moving_hole, top),
        constants,
        poisson(case, mesh),
        _lateral_coefficients(case, sizes),
        FlowLine(f.outlet_pressure, f.flow_line, choke),
        string.held_at,
    )
    if f.formulation == "hermite":
        return HermiteAnnulus(*arguments, pump=f.flow_rate)
    return AnnulusFlow(*arguments)


def _bit_flow(
    string: StringInMud, constants: FluidConstants, bore_flow: BoreFlow | None, annulus: AnnulusFlow | None
) -> BitFlow:
    """Create the flow at the lower end."""
    f, hole, last = string.case.given_fluid, string.hole, string.mesh.nodes - 1
    end = _bit_end(string, annulus)
    if hole is not None:
        end = _in_growing_hole(end, hole, f.cuttings == "returned")
    way = _lowered(string.case)
    if f.formulation == "hermite":
        pair: Any = (bore_flow, annulus)  # both are Hermite channels
        more = _continued(string, end, way)
        end = replace(end, volume=end.volume + end.hole * more, more=more)
        return HermiteBit(last, end, constants, f.flow_rate, pair, string.position[-1], string.held_at)
    if way > 0.0:  # stretch alone may close the bottom
        more = _continued(string, end, way)
        end = replace(end, end=end.end + more * np.asarray(end.axis), more=more)
    moving_hole = annulus.moving_hole if annulus is not None else None
    return BitFlow(last, end, constants, string.held_at, moving_hole, hole)


def _lowered(case: Case) -> float:
    """Largest way [m] by which a run lowers its top."""
    lowering, time = case.top.lowering, case.time
    if lowering is None or time is None or time.end is None:
        return 0.0
    times = [0.0, *(t for t in lowering.breaks() if 0.0 < t < time.end), time.end]
    ways = [lowering.integral(t) for t in times]
    for start, end in pairwise(times):  # where a speed that falls along a line turns round
        first, last = lowering.value(start), lowering.value(end, before=True)
        if first > 0.0 > last:
            ways.append(lowering.integral(start + (end - start) * first / (first - last)))
    return max(ways)


def _continued(string: StringInMud, end: BitEnd, way: float) -> float:
    """Length [m] of hole below a free lower end that its stretch or a ``way`` of its top [m] brings below the end of the hole.

    There mud has to give way to the end; without it nothing would press on its face.
    """
    if not end.hole or string.held_at is not None or string.case.bottom.kind not in ("free", "force"):
        return 0.0
    above = float((end.end - string.position[-1]) @ end.axis) - end.face
    return max(0.0, LARGEST_STRETCH * string.mesh.total_length + way - above)


def _volumes_at_rest(
    string: StringInMud, bore_flow: BoreFlow | None, annulus: AnnulusFlow | None, bit: BitFlow | None
) -> Callable[[float], dict[str, FloatArray]]:
    """Create ``FluidComponents.volumes``; a closed bore keeps its volume at rest."""
    case, f, position = string.case, string.case.given_fluid, string.position
    head = f.density * ((position - position[0]) @ np.array(case.gravity, dtype=float))
    volumes = partial(volumes_at_rest, bore_flow, annulus, bit, head)  # type: ignore[arg-type]
    if isinstance(bore_flow, HermiteBore) and bore_flow.closed:
        under = f.outlet_pressure.value(0.0) if annulus is not None else 0.0
        bore_flow.kept = float(volumes(under)["bore.volume"][-1])
    return volumes


def _mud_items(case: Case, mesh: StringMesh, sizes: Annulus) -> tuple[MudItem, ...]:
    """Mud across the hole beside the rigid items that have a length and an outer diameter (manual: sec-mud-items).

    An item counts as a cylinder with the same open area around it. Bits and stabilizers leave open at least
    ``LEAST_BESIDE`` of the hole.
    """
    bodies = [b for b in mesh.bodies if b.length > 0 and b.radius > 0]
    if not bodies:
        return ()
    node = np.array([min(b.node, len(mesh.upper) - 1) for b in bodies])
    hole = np.sqrt(
        4 / np.pi * np.where(mesh.rigid_above[node] > 0, sizes.hole_around[node], sizes.hole[node])
    )
    length, area = np.array([b.length for b in bodies]), np.pi / 4 * hole**2
    metal = np.array([np.pi * b.radius**2 for b in bodies])
    beside = (mesh.rigid_above[node] > 0) & (np.array([b.node for b in bodies]) < len(mesh.upper))
    metal = np.where(beside, sizes.outer_above[node], metal)
    bladed = np.array([b.kind in ("bit", "stabilizer") for b in bodies])
    least = np.where(bladed, LEAST_BESIDE, LEAST_OPEN) * area
    outer = np.sqrt(4 / np.pi * (area - np.maximum(area - metal, least)))
    whole = Annulus(np.pi / 4 * outer**2, area, np.zeros(len(outer)), np.zeros(len(outer)))
    side = _lateral_coefficients(case, whole)
    share = end_leakage(length, outer, hole)
    mass = share * side.added * case.given_fluid.density * whole.outer * length
    damping = share * side.damping * length
    return tuple(
        MudItem(b.node, b.above + 0.5 * b.length, *map(float, row))
        for b, *row in zip(bodies, mass, damping, side.swirl, strict=True)
        if row[0] > 0 or row[1] > 0
    )


def _refuse_closed_annulus(case: Case, mesh: StringMesh, sizes: Annulus) -> None:
    """Raise CaseError if the metal of rigid items fills the hole around them: that over them and the element below."""
    narrow = np.flatnonzero(sizes.hole - sizes.outer <= LEAST_OPEN * sizes.hole)
    for number in dict.fromkeys(mesh.item[narrow].tolist()):
        if case.string[number].annulus_od is not None:
            units = case.shown_units
            k = int(narrow[mesh.item[narrow] == number][0])
            raise CaseError(
                at=f"string[{number}].annulus_od",
                got=shown(case.string[number].annulus_od, "diameter", units),
                want=f"less than the hole around it, {shown(2 * np.sqrt(sizes.hole[k] / np.pi), 'diameter', units)}: the mud must get past",
            )
    left = np.where(mesh.rigid_above > 0, sizes.hole_around - sizes.outer_above, np.inf)
    k = int(np.argmin(left / sizes.hole_around))
    if left[k] > LEAST_OPEN * sizes.hole_around[k]:
        return
    names = ", ".join(b.name for b in mesh.bodies if b.node == k)
    numbers = [i for i, item in enumerate(case.string) if isinstance(item, Rigid)]
    number = next(i for i, b in zip(numbers, mesh.bodies, strict=True) if b.node == k)
    units = case.shown_units
    raise CaseError(
        at=f"string[{number}]",
        got=f"{names}: metal and bore of {shown(sizes.outer_above[k], 'flow_area', units)}",
        want=f"less than the hole around it, {shown(sizes.hole_around[k], 'flow_area', units)}: the mud must get past",
        hint="body_od and blade_length, or mass, set the volume of its metal. If the hole narrows beside the item, its mean diameter counts: "
        "end the wide section lower",
    )


def side_links(case: Case, mesh: StringMesh) -> tuple[SideLink, ...]:
    """Nozzles above the bit by their nodes, from the top down: nozzles of an item are at its upper end, or at the upper end of
    the rigid items right above it."""
    areas, bodies = dict(case.side_nozzles), iter(mesh.bodies)
    found: dict[int, list[tuple[int, float]]] = {}
    for number, item in enumerate(case.string):
        body = next(bodies) if isinstance(item, Rigid) else None
        if body is not None and number in areas:
            found.setdefault(body.node, []).append((number, areas[number]))
    return tuple(SideLink(node, sum(a for _, a in group), tuple(group)) for node, group in found.items())


def _lower_end_area(case: Case, mesh: StringMesh) -> tuple[float, float]:
    """Flow area [m2] and discharge coefficient [-] of the string's lower end; area 0: closed."""
    if case.bottom.plugged:
        return 0.0, 1.0
    nozzle = case.string[-1].nozzle_area
    return (nozzle, case.given_fluid.discharge_coefficient) if nozzle else (float(mesh.bore_area[-1]), 1.0)


def _surface_line(case: Case) -> SurfaceLine | None:
    """The lines between pump and string, None without them."""
    line = case.given_fluid.surface_line
    if line is None:
        return None
    return SurfaceLine(
        build_rheology(case),
        case.given_fluid.density,
        line.length or 0.0,
        line.id or 0.0,
        line.loss or 0.0,
        line.at or 0.0,
    )


def _added_mass(case: Case, sizes: Annulus) -> FloatArray:
    """Compute the added-mass coefficient chi (n,) [-] of the elements (manual: eq-mud-chi)."""
    kind = case.given_fluid.added_mass
    if kind in ("confined", "eccentric"):
        return np.asarray(chi_confined(sizes.outer_diameter, sizes.hole_diameter))
    if kind == "paper_plug":
        return sizes.outer / (sizes.hole - sizes.outer)
    if kind == "stokes":
        return _stokes_mass(case, sizes)
    return np.full(len(sizes.outer), float(kind))


def _stokes_mass(case: Case, sizes: Annulus) -> FloatArray:
    """Compute C_m (n,) [-] at the reference frequency (manual: eq-mud-stokes-coefficients); chi without viscosity."""
    f = case.fluid
    assert f is not None
    ratio = sizes.hole_diameter / sizes.outer_diameter
    viscosity = lateral_viscosity(case, sizes.outer_diameter, sizes.hole_diameter)
    chi = np.asarray(chi_confined(sizes.outer_diameter, sizes.hole_diameter))
    viscous = viscosity > 0
    if viscous.any():
        number = (
            f.density
            * f.lateral_damping_speed
            * sizes.outer_diameter[viscous] ** 2
            / (4 * viscosity[viscous])
        )
        chi[viscous] = stokes_coefficients(number, ratio[viscous])[0]
    return chi


def lateral_viscosity(case: Case, inner: FloatArray, outer: FloatArray) -> FloatArray:
    """Apparent viscosity (n,) [Pa s] at the wall of a pipe that turns at the reference speed omega, with the shear rate
    2 omega/(1 - (Do/Dw)^2) (Couette).  inner, outer: diameters of string and hole [m]."""
    return shear_viscosity(case, 2 * case.given_fluid.lateral_damping_speed / (1 - (inner / outer) ** 2))


@lru_cache(maxsize=256)
def _chi_coefficients(inner: float, outer: float) -> FloatArray:
    """Fit the added mass [-] by the eccentricity, up to ``LARGEST_ECCENTRICITY`` (manual: eq-mud-chi-place).

    inner, outer: diameters of string and hole [m].  Returns (5,): of r to the powers -1 to 3; relative errors are below 5e-4.
    """
    eccentricity = LARGEST_ECCENTRICITY * np.sin(np.linspace(0, np.pi / 2, 60))
    chi = np.array([chi_eccentric(inner, outer, e) for e in eccentricity])
    powers = place_radius(eccentricity)[:, None] ** np.arange(-1, 4)
    return np.asarray(np.linalg.lstsq(powers / chi[:, None], np.ones(60), rcond=None)[0])


def place_radius(eccentricity: FloatArray) -> FloatArray:
    """r (k,) [-] of kernels/fluid/annulus_flow.hpp at eccentricities (k,) [-]: sqrt(1 - e^2), rounded at and beyond the wall."""
    z = 1.0 - np.asarray(eccentricity) ** 2
    return np.asarray(np.sqrt(CHI_ROUNDING + 0.5 * (z + np.sqrt(z * z + 4.0 * CHI_ROUNDING**2))))


def _chi_by_place(inner: FloatArray, outer: FloatArray) -> FloatArray:
    """Coefficients (k, 5) of elements of outer diameters (k,) in holes of diameters (k,) [m], both rounded to 0.1 mm."""
    sizes, which = np.unique(np.round(np.column_stack([inner, outer]), 4), axis=0, return_inverse=True)
    each = np.array([_chi_coefficients(float(d), float(w)) for d, w in sizes]).reshape(-1, 5)
    return each[np.ravel(which)]


def shear_viscosity(case: Case, shear_rate: FloatArray) -> FloatArray:
    """Compute the apparent viscosity (n,) [Pa s] of the fluid in the annulus at shear rates (n,) [1/s]."""
    rheology = case.given_fluid.annulus_rheology or case.given_fluid.rheology
    consistency, index, yield_stress = flow_constants(rheology)
    if isinstance(rheology, OwnRheology):
        return np.asarray(rheology.stress(shear_rate) / shear_rate)
    if rheology.model == "casson":
        return (np.sqrt(yield_stress) + np.sqrt(consistency * shear_rate)) ** 2 / shear_rate
    return yield_stress / shear_rate + consistency * shear_rate ** (index - 1)


def _lateral_coefficients(case: Case, sizes: Annulus) -> LateralCoefficients:
    """Compute added mass, lateral damping (manual: eq-mud-stokes-coefficients) and rotational drag of the elements.

    The viscosity is taken from ``lateral_viscosity``.
    """
    f = case.fluid
    assert f is not None
    inner, outer, speed = sizes.outer_diameter, sizes.hole_diameter, f.lateral_damping_speed
    viscosity = lateral_viscosity(case, inner, outer)
    if f.lateral_damping == "stokes":
        (d, w, mu), where = np.unique(np.array([inner, outer, viscosity]), axis=1, return_inverse=True)
        each, viscous = np.zeros(len(mu)), mu > 0
        each[viscous] = lateral_damping(d[viscous], w[viscous], f.density, mu[viscous], speed)
        damping = each[np.ravel(where)]
    else:
        damping = np.full(len(inner), float(f.lateral_damping))
    rotation_drag = np.zeros(len(inner))
    if f.rotation_drag:  # 4 pi mu Ro^2 Rw^2/(Rw^2 - Ro^2) per length and spin (Couette)
        rotation_drag = np.pi * viscosity * inner**2 * outer**2 / (outer**2 - inner**2)
    swirl = np.zeros(len(inner))
    if may_turn(case):
        carried = np.where(
            viscosity > 0, steady_share(inner, outer), 0.0
        )  # nothing turns mud without viscosity
        swirl = carried if f.swirl == "auto" else np.full(len(inner), float(f.swirl))
    return LateralCoefficients(
        _added_mass(case, sizes),
        damping,
        rotation_drag,
        swirl,
        partial(_following, case, build_rheology(case, annulus=True)) if f.swirl_lag else None,
        _chi_by_place if f.added_mass == "eccentric" else None,
    )


def may_turn(case: Case) -> bool:
    """Whether the string or a part of it may turn during a motion with inertia."""
    if case.hold_string or case.time is not None and case.time.mode == "quasi_static":
        return False
    top = case.top
    driven = getattr(top, "torque", None) is not None or getattr(top, "motor", None) is not None
    rotation = getattr(top, "rotation", None)
    still = rotation is None or (isinstance(rotation, Constant) and rotation.constant == 0.0)
    return driven or not still or any(isinstance(item, PositiveDisplacementMotor) for item in case.string)


def _following(
    case: Case, rheology: Rheology, speed: FloatArray, inner: FloatArray, outer: FloatArray
) -> FloatArray:
    """Rates (k,) [1/s] at which the mud's swirl follows the spin of the string (manual: eq-mud-swirl-lag).

    speed: (k,) of the flow along the hole [m/s]; inner, outer: (k,) diameters of string and hole [m].
    """
    density, gap = case.given_fluid.density, 0.5 * (outer - inner)
    viscous = np.pi**2 * lateral_viscosity(case, inner, outer) / density / gap**2
    moving = np.maximum(np.abs(speed), 1e-6)
    stress = wall_shear(rheology, moving, 2 * gap, True, density)
    return np.asarray(viscous + 2 * stress / (density * moving * gap))


def _is_uniform(well: Well, walls: AnnulusWalls) -> bool:
    """Whether size, direction and wall compliance of the hole are the same at every depth."""
    straight = np.allclose(well.node_tangent, well.node_tangent[0], atol=1e-12)
    return bool(straight) and not len(well.transitions) and len(set(walls.give)) == 1


def _bit_end(string: StringInMud, annulus: AnnulusFlow | None) -> BitEnd:
    """Create the data of the flow at the lower end, in the hole as it is at the start."""
    case, mesh, well = string.case, string.mesh, string.well
    f, last = case.given_fluid, case.string[-1]
    sizes = None if annulus is None else annulus.annulus
    open_end = case.has_bore and not case.bottom.plugged
    nozzle = last.nozzle_area or 0.0
    end, axis = string.position[-1], string.tangent[-1]
    if sizes is not None and well is not None:
        points, directions, _ = well.at(np.array([case.given_well.survey.md[-1]]))
        end, axis = np.asarray(points)[0], np.asarray(directions)[0]
    rock = case.well.sections[-1].compliance if case.well is not None and f.elastic_walls else None
    hole = (0.0, 0.0, 0.0)
    if sizes is not None:
        hole = float(sizes.hole[-1]), float(sizes.hole[-1] - sizes.outer[-1]), float(sizes.outer[-1])
    return BitEnd(
        bore=float(mesh.bore_area[-1]) if open_end else 0.0,
        nozzle=nozzle,
        discharge_coefficient=f.discharge_coefficient,
        check_valve=f.check_valve,
        ambient=f.outlet_pressure,
        hole=hole[0],
        open=hole[1],
        outer=hole[2],
        elasticity=2 * (1 + rock.poisson) / rock.young if rock else 0.0,
        volume=f.bit_volume,
        face=mesh.total_length - float(mesh.node_depth[-1]),
        added=0.0 if annulus is None else float(annulus.lateral.added[-1]),
        metal=metal_below(case, mesh),
        end=end,
        axis=axis,
        tangent=string.tangent[-1],
    )


def _in_growing_hole(end: BitEnd, hole: GrowingHole, returned: bool) -> BitEnd:
    """Return ``end`` for a growing hole, whose end is the centre of the bit on bottom.

    returned: the mud returns the cuttings (manual: sec-mud-cuttings).
    """
    return replace(
        end,
        end=hole.start_point,
        axis=hole.direction,
        face=end.face - hole.half,
        cut=np.pi * hole.radius**2 if returned else 0.0,
    )


# ---------------------------------------------------------------------- channels of a case
