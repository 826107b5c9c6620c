"""What an item of the string weighs and displaces, and how stiff it is: the same for elements, soft strings and mud."""

from __future__ import annotations

from dataclasses import fields

from drillpetsc.case.blocks.items.string import Beam, Flexible, Rigid, Stabilizer, Tool, Tube
from drillpetsc.case.blocks.items.tubulars import Tubular
from drillpetsc.case.blocks.well import Well as WellCase
from drillpetsc.case.pipe.section import metal_past, tubular_section
from drillpetsc.fem.string_mesh import StringMesh, plain_sizes, tube

STIFFNESSES = ("axial_stiffness", "bending_stiffness", "torsional_stiffness")


def section_of(item: Flexible) -> dict[str, float]:
    """Section values of a flexible item, by the names and in the units of ``StringMesh``."""
    if isinstance(item, Tubular):
        columns = {q.name for q in fields(StringMesh)}
        values = {key: value for key, value in vars(tubular_section(item)).items() if key in columns}
        damping = item.material.damping
    elif isinstance(item, Tube):
        m = item.material
        values = tube(item.od, item.id, m.young, m.poisson, m.density)
        damping = m.damping
        if isinstance(item, Tool):
            values |= item.given_stiffness
    else:
        assert isinstance(item, Beam)
        values = {k: getattr(item, k) for k in (*STIFFNESSES, "mass", "polar_inertia")}
        damping = item.damping
    values |= {"stiffness_damping": damping.stiffness, "mass_damping": damping.mass}
    sizes = plain_sizes(item.od or 0.0, item.id)
    if item.annulus_od is not None:
        sizes |= dict.fromkeys(("outer_area", "tube_outer_area"), item.outer_section)
    if item.bore_volume is not None:
        sizes |= dict.fromkeys(("bore_area", "tube_bore_area"), item.bore_section)
    return {**sizes, **values}


def metal_of(item: Rigid, bore: float, well: WellCase | None, depth: float) -> float:
    """Volume of the metal of a rigid item [m3], which displaces mud.

    bore: its mean area inside [m2]; depth: of its middle [m].
    """
    if item.annulus_od is not None:
        return item.outer_section * item.length - bore * item.length
    if isinstance(item, Stabilizer) and item.bypass_area is not None and well is not None:
        return metal_past(item, well.diameter_at(depth))
    return item.mass / item.material.density
