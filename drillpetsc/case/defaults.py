"""Defaults that follow from other keys: materials of items, masses and inertias of rigid items, output
intervals."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypeVar

from drillpetsc.case.block import Block
from drillpetsc.case.blocks.string import Beam, Inertia, Item, Material, Pipe, Rigid
from drillpetsc.case.blocks.well import Contact
from drillpetsc.time_function import Constant, Ramp, TimeFunction

if TYPE_CHECKING:
    from drillpetsc.case.case import Case

AnyBlock = TypeVar("AnyBlock", bound=Block)


def settle_presence(case: Case) -> None:
    """Fill in what the presence of one block says of another: contact with a hole, an annulus in it."""
    if case.hold_string:
        case.fill_defaults(contact=None)
    elif case.well is not None and "contact" not in case.model_fields_set:
        case.fill_defaults(contact=Contact())
    if case.fluid is not None:
        annulus = case.well is not None if case.fluid.annulus is None else case.fluid.annulus
        speed = case.fluid.lateral_damping_speed or largest(getattr(case.top, "rotation", None)) or 1.0
        case.fill_defaults(
            fluid=case.fluid.model_copy(update={"annulus": annulus, "lateral_damping_speed": speed})
        )


def settle_scene(case: Case) -> None:
    """Fill in what the case leaves to its other keys."""
    if case.formation is not None and case.formation.bit_law.stiffness is not None:
        case.fill_defaults(
            bottom=case.bottom.model_copy(update={"stiffness": case.formation.bit_law.stiffness})
        )
    case.fill_defaults(string=tuple(_settled(item, case.material) for item in case.string))
    if case.time is not None:
        case.fill_defaults(output=case.output.settled(case.time.end, case.time.mode == "dynamic"))


def largest(function: TimeFunction | None) -> float:
    """The largest magnitude that an input reaches, in its unit; 0 without an input."""
    if function is None:
        return 0.0
    if isinstance(function, Constant):
        return abs(function.constant)
    if isinstance(function, Ramp):
        return abs(function.final)
    return max(abs(value) for value in function.values)


def _settled(item: Item, material: Material) -> Item:
    """A copy of the item with its material and, when rigid, its mass and inertia."""
    if isinstance(item, Pipe):
        return item.model_copy(update={"material": overlaid(material, item.material)})
    if isinstance(item, Beam):
        return item.model_copy(update={"damping": overlaid(material.damping, item.damping)})
    if isinstance(item, Rigid):
        own = overlaid(material, item.material)
        mass = tube_mass(item, own.density) if item.mass is None else item.mass
        return item.model_copy(update={"material": own, "mass": mass, "inertia": tube_inertia(item, mass)})
    return item


def overlaid(below: AnyBlock, above: AnyBlock | None) -> AnyBlock:
    """The block `below` with the keys that `above` gives in its stead, blocks inside blocks likewise."""
    if above is None:
        return below
    given = {key: getattr(above, key) for key in above.model_fields_set}
    for key, value in given.items():
        if isinstance(value, Block):
            given[key] = overlaid(getattr(below, key), value)
    return below.model_copy(update=given)


def tube_mass(item: Rigid, density: float) -> float:
    """Mass of a tube of the item's size [kg]: density pi/4 (od^2 - id^2) length."""
    outer = item.od or 0.0  # Rigid demands a mass where there is no diameter
    return density * math.pi / 4 * (outer**2 - item.id**2) * item.length


def tube_inertia(item: Rigid, mass: float) -> Inertia:
    """Given moments of inertia, else those of a thick-walled tube about its centre [kg m2]; a rod's without a
    diameter.

    axial m (od^2 + id^2)/8; transverse m (3 (ro^2 + ri^2) + length^2)/12 (any table of moments of inertia).
    """
    squares = 0.0 if item.od is None else (item.od**2 + item.id**2) / 4
    axial = mass * squares / 2
    transverse = mass * (3 * squares + item.length**2) / 12
    given = item.inertia
    return Inertia(
        axial=axial if given.axial is None else given.axial,
        transverse=transverse if given.transverse is None else given.transverse,
    )
