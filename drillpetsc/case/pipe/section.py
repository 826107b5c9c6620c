"""Section of pipe of the trade, smeared over a joint: stiffnesses, mass, areas, diameters for contact and limits.

A joint has the tube over the share 1 - f of its length and the tool joint over f (manual: sec-tubulars-section).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from drillpetsc.case.blocks.items.string import Stabilizer
from drillpetsc.case.blocks.items.tubulars import DrillCollar, DrillPipe, Jointed, Tubular
from drillpetsc.case.catalogue.formulas import worn_diameter


@dataclass(frozen=True)
class TubularSection:
    """Mean section of an item.

    axial_stiffness EA [N], bending_stiffness EI, torsional_stiffness GJ [N m2].
    mass per length [kg/m]; polar_inertia: polar mass moment per length [kg m].
    bore_area, outer_area [m2]: for the weight of the mud and for buoyancy.
    tube_bore_area, tube_outer_area [m2]: of the tube between tool joints or couplings, for the tension of its wall.
    contact_diameter; clearance_diameter: for buckling loads [m]; worn_diameter: outer diameter of the worn tube, for limits [m].
    joint_length [m], yield_strength [Pa]: nan if unknown.
    joint_share: f [-]; joint_bore, joint_od: diameters of the tool joint [m].
    """

    axial_stiffness: float
    bending_stiffness: float
    torsional_stiffness: float
    mass: float
    polar_inertia: float
    bore_area: float
    outer_area: float
    tube_bore_area: float
    tube_outer_area: float
    contact_diameter: float
    clearance_diameter: float
    worn_diameter: float
    joint_length: float
    yield_strength: float
    joint_share: float
    joint_bore: float
    joint_od: float


def ring(outer: float, inner: float) -> tuple[float, float]:
    """Area [m2] and second moment of area [m4] of a ring of diameters [m]."""
    return math.pi / 4 * (outer**2 - inner**2), math.pi / 64 * (outer**4 - inner**4)


def tubular_section(item: Tubular) -> TubularSection:
    """Mean section of an item whose figures are complete."""
    m = item.material
    shear = m.young / (2 * (1 + m.poisson))
    area, moment = ring(item.od, item.id)
    share, joint_bore, joint_od = 0.0, item.id, item.od
    joint_area, joint_moment = area, moment
    if isinstance(item, Jointed):
        joint = item.tool_joint
        share, joint_bore, joint_od = joint.length / item.joint_length, joint.id, joint.od
        joint_area, joint_moment = ring(joint.od, joint.id)

    def mean(tube: float, joint: float) -> float:
        return (1 - share) * tube + share * joint

    def series(tube: float, joint: float) -> float:
        if not share or (isinstance(item, Jointed) and item.stiffness == "body"):
            return tube
        return 1 / mean(1 / tube, 1 / joint)

    mass = item.adjusted_weight
    metal = m.density * mean(area, joint_area)
    bore = mean(math.pi / 4 * item.id**2, math.pi / 4 * joint_bore**2)
    wall = item.remaining_wall if isinstance(item, DrillPipe) else 1.0
    outer = bore + mass / m.density
    spiral = isinstance(item, DrillCollar)  # its grooves run over the whole length
    joint_length = item.joint_length if isinstance(item, (Jointed, DrillCollar)) else math.nan
    return TubularSection(
        axial_stiffness=m.young * series(area, joint_area),
        bending_stiffness=m.young * series(moment, joint_moment),
        torsional_stiffness=shear * series(2 * moment, 2 * joint_moment),
        mass=mass,
        polar_inertia=m.density * mean(2 * moment, 2 * joint_moment) * mass / metal,
        bore_area=bore,
        outer_area=outer,
        tube_bore_area=bore if spiral else math.pi / 4 * item.id**2,
        tube_outer_area=outer if spiral else math.pi / 4 * item.od**2,
        contact_diameter=item.contact_od or item.od,
        clearance_diameter=item.clearance_od or item.od,
        worn_diameter=worn_diameter(item.od, item.id, wall),
        joint_length=joint_length,
        yield_strength=math.nan if item.yield_strength is None else item.yield_strength,
        joint_share=share,
        joint_bore=joint_bore,
        joint_od=joint_od,
    )


BLADE_METAL = 0.45  # share of the ring between body and blade diameter that blades fill


def stabilizer_metal(item: Stabilizer, outer: float) -> float:
    """Volume of the metal of body and blades [m3].

    outer: diameter over the blades [m]
    """
    body = item.body_od or outer
    blades = item.blade_length if item.blade_length is not None else item.length
    return ring(body, item.id)[0] * item.length + BLADE_METAL * ring(outer, body)[0] * blades


def metal_past(item: Stabilizer, hole: float) -> float:
    """Volume of metal [m3] that leaves the item's bypass_area beside the blades, in a hole of a diameter [m]."""
    assert item.bypass_area is not None and item.blade_length is not None
    body = item.body_od or item.od
    at_blades = math.pi / 4 * (hole**2 - item.id**2) - item.bypass_area
    return at_blades * item.blade_length + ring(body, item.id)[0] * (item.length - item.blade_length)
