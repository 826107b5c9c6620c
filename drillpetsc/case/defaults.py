"""Defaults that follow from other keys: materials of items, masses and inertias of rigid items, output
intervals."""

from __future__ import annotations

import math

from drillpetsc.case.block import overlaid
from drillpetsc.case.blocks.case_blocks import CaseBlocks
from drillpetsc.case.blocks.contact import Contact
from drillpetsc.case.blocks.fluid import PowerLaw
from drillpetsc.case.blocks.items.string import Beam, Bit, Inertia, Item, Material, Rigid, Tube
from drillpetsc.case.files.mud_report import api_annulus
from drillpetsc.case.quantities import largest, slowest

LARGEST_SLIP, LEAST_SLIP = 0.01, 1e-5  # [m/s]
UNKNOWN_RATE = 5 / 3600  # [m/s] of sliding, where an autodriller finds it
FULL_DRAG = 0.05  # slip velocity over the speed of sliding, at which friction lacks 0.12 %


def fill_presence_defaults(case: CaseBlocks) -> None:
    """Fill in defaults that follow from the presence of another block: contact with a hole, an annulus in
    it."""
    if case.hold_string:
        case.fill_defaults(contact=None)
    elif case.well is not None and "contact" not in case.model_fields_set:
        case.fill_defaults(contact=Contact())
    if case.contact is not None and case.contact.slip_velocity is None:
        contact = case.contact.model_copy(update={"slip_velocity": _slip_velocity(case)})
        case.fill_defaults(contact=contact)
    if case.fluid is not None:
        annulus = case.well is not None if case.fluid.annulus is None else case.fluid.annulus
        speed = case.fluid.lateral_damping_speed or largest(case.top.rotation) or 1.0
        in_string, around = case.fluid.rheology, case.fluid.annulus_rheology
        if annulus and around is None and in_string.law == "api" and in_string.fit and in_string.dial:
            found = api_annulus(in_string.dial)
            if found:
                consistency, index = found
                around = PowerLaw(
                    model="power_law",
                    law="api",
                    consistency=consistency,
                    index=index,
                    shear_rate=in_string.shear_rate,
                    dial=in_string.dial,
                    fit="api",
                )
        case.fill_defaults(
            fluid=case.fluid.model_copy(
                update={"annulus": annulus, "lateral_damping_speed": speed, "annulus_rheology": around}
            )
        )


def _slip_velocity(case: CaseBlocks) -> float:
    """Slip speed over which friction builds up [m/s], so small that a string that slides at the rate of drilling has its full drag."""
    top = case.top
    if largest(top.rotation) or top.torque is not None or top.force is not None:
        return LARGEST_SLIP
    drill = top.autodriller
    found = () if drill is None else (slowest(drill.rop) or UNKNOWN_RATE,)
    slow = min(
        (speed for speed in (slowest(top.lowering), *found) if speed), default=LARGEST_SLIP / FULL_DRAG
    )
    return min(LARGEST_SLIP, max(slow * FULL_DRAG, LEAST_SLIP))


def fill_case_defaults(case: CaseBlocks) -> None:
    """Fill in defaults that follow from the values of other keys."""
    if case.formation is not None and case.formation.bit_law.stiffness is not None:
        case.fill_defaults(
            bottom=case.bottom.model_copy(update={"stiffness": case.formation.bit_law.stiffness})
        )
    case.fill_defaults(string=tuple(_with_defaults(item, case.material) for item in case.string))
    bit = case.string[-1] if case.string else None
    if isinstance(bit, Bit) and bit.side is None:
        cuts = case.formation is not None and case.formation.strength is not None
        side = bit.model_copy(update={"side": "cutting" if cuts else "guided"})
        case.fill_defaults(string=(*case.string[:-1], side))
    if case.time is not None:
        case.fill_defaults(output=case.output.with_intervals(case.time.end, case.time.mode == "dynamic"))


def _with_defaults(item: Item, material: Material) -> Item:
    """A copy of the item with its material and, if it is rigid, its mass and inertia."""
    if isinstance(item, Tube):
        own = overlaid(material, item.material)
        mass = getattr(item, "mass", None)
        if mass is not None:  # of a tool: the density that gives its tube the mass
            density = mass / (item.length * math.pi / 4 * (item.od**2 - item.id**2))
            own = own.model_copy(update={"density": density})
        return item.model_copy(update={"material": own})
    if isinstance(item, Beam):
        return item.model_copy(update={"damping": overlaid(material.damping, item.damping)})
    if isinstance(item, Rigid):
        own = overlaid(material, item.material)
        mass = tube_mass(item, own.density) if item.mass is None else item.mass
        return item.model_copy(update={"material": own, "mass": mass, "inertia": tube_inertia(item, mass)})
    return item


def tube_mass(item: Rigid, density: float) -> float:
    """Mass of a tube of the item's size [kg]: density pi/4 (od^2 - id^2) length.

    density: [kg/m3]
    """
    outer = item.od or 0.0  # an item without a diameter has a mass key
    return density * math.pi / 4 * (outer**2 - item.id**2) * item.length


def tube_inertia(item: Rigid, mass: float) -> Inertia:
    """Moments of inertia [kg m2]: as given, otherwise of a thick-walled tube about its centre.

    axial m (od^2 + id^2)/8; transverse m (3 (ro^2 + ri^2) + length^2)/12 (any table of moments of inertia).
    An item without a diameter is treated as a thin rod.

    mass: [kg]
    """
    squares = 0.0 if item.od is None else (item.od**2 + item.id**2) / 4
    axial = mass * squares / 2
    transverse = mass * (3 * squares + item.length**2) / 12
    given = item.inertia
    return Inertia(
        axial=axial if given.axial is None else given.axial,
        transverse=transverse if given.transverse is None else given.transverse,
    )
