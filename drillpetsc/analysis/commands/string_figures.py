"""Lines of `check` on the figures of the string that the case did not give: each with its value, and where it is from."""

from __future__ import annotations

import math

from drillpetsc.case.blocks.items.string import Stabilizer
from drillpetsc.case.blocks.items.tubulars import DrillPipe, Jointed, Tubular
from drillpetsc.case.case import Case
from drillpetsc.case.catalogue.formulas import tensile_strength, torsional_strength
from drillpetsc.case.catalogue.sizes import FT_LBF, INCH, KSI, LB_PER_FT, LBF, inch_text
from drillpetsc.case.pipe.figures import Figure
from drillpetsc.case.pipe.section import ring, tubular_section
from drillpetsc.unit_systems import System, shown

#: SI unit -> unit of the trade, value of one of it in SI
FIELD = {
    "N m": ("ft-lbf", FT_LBF),
    "kg/m": ("lb/ft", LB_PER_FT),
    "Pa": ("ksi", KSI),
    "m^2": ("in2", INCH**2),
    "kg": ("lb", 0.45359237),
}
LONG = 1.0  # lengths from here on are shown in feet, below in inches [m]
#: exponent of the diameter in the friction loss of turbulent flow at a given flow rate (Blasius)
TURBULENT = 4.75


def figure_lines(case: Case, units: System) -> list[str]:
    """Lines for the user; none where the case gives all figures itself.

    units: field: in units of the field alone; others: in SI, and in units of the field behind, in which catalogues are written.
    """
    figures = case.figures
    lines: list[str] = []
    for number, item in enumerate(case.string):
        found = figures.of_item.get(number, ())
        if not found and not isinstance(item, Tubular):
            continue
        reference = figures.references.get(number)
        lines.append(f"    string[{number}] {item.name}" + (f' "{reference}"' if reference else "") + ":")
        lines += [f"      {_figure(figure, units)}" for figure in found]
        if isinstance(item, Tubular):
            lines += [f"      {line}" for line in _section_lines(case, item, units)]
        if isinstance(item, Stabilizer) and item.blade_length is not None:
            lines.append(
                f"      touches the hole over its blades, {shown(item.blade_length, 'length', units)}, not with its body"
            )
    return (
        ["  figures of the string that the case does not give, and where they are from:", *lines]
        if lines
        else []
    )


def short_figure_lines(case: Case, units: System) -> list[str]:
    """A line for each item with figures that the case does not give, without their sources."""
    lines = []
    for number, item in enumerate(case.string):
        found = case.figures.of_item.get(number, ())
        if found:
            values = ", ".join(
                f"{figure.key} {_value(figure, units)}{' (unverified)' if 'unverified' in figure.source else ''}"
                for figure in found
            )
            lines.append(f"    string[{number}] {item.name}: {values}")
    return ["  figures of the string that the case does not give:", *lines] if lines else []


def _figure(figure: Figure, units: System) -> str:
    return f"{figure.key} {_value(figure, units)}: {figure.source}"


def _value(figure: Figure, units: System) -> str:
    value = figure.value
    if not isinstance(value, float):
        return str(value)
    return _with_field(f"{value:.6g} {figure.unit}".rstrip(), _in_field_units(value, figure.unit), units)


def _with_field(text: str, field: str, units: System) -> str:
    """A figure in SI and in units of the field, or in the latter alone for those who work in them."""
    if not field:
        return text
    return field if units == "field" else f"{text} ({field})"


def _in_field_units(value: float, unit: str) -> str:
    if unit == "m":
        return f"{value / 0.3048:.5g} ft" if value >= LONG else inch_text(value / INCH)
    if unit not in FIELD:
        return ""
    name, factor = FIELD[unit]
    return f"{value / factor:.5g} {name}"


def _section_lines(case: Case, item: Tubular, units: System) -> list[str]:
    """What becomes of an item in the beam."""
    s = tubular_section(item)
    areas: System = "field" if units == "field" else "metric"
    area, moment = ring(item.od, item.id)
    young = item.material.young
    way = ""
    if isinstance(item, Jointed):
        way = " (tube alone)"
        if item.stiffness == "series":
            more = [
                100 * (q - 1)
                for q in (s.axial_stiffness / (young * area), s.bending_stiffness / (young * moment))
            ]
            way = f" (tube and tool joints in series: EA {more[0]:+.1f} %, EI and GJ {more[1]:+.1f} % over the tube)"
    lines = [
        f"EA {shown(s.axial_stiffness, 'force', units, 5)}, EI {shown(s.bending_stiffness, 'section_stiffness', units, 5)}, "
        f"GJ {shown(s.torsional_stiffness, 'section_stiffness', units, 5)}: "
        f"from the dimensions{way}",
        f"areas: bore {shown(s.bore_area, 'flow_area', areas, 6)}, outside {shown(s.outer_area, 'flow_area', areas, 6)}: mean over a joint; "
        "bore and mass over density",
    ]
    if item.contact_od != item.od:
        upset = ", the centre upset is inside it" if getattr(item, "center_upset", None) is not None else ""
        lines.append(
            f"touches the hole with {_length(s.contact_diameter, units)}: diameter of the tool joint{upset}"
        )
    else:
        lines.append(f"touches the hole with {_length(s.contact_diameter, units)}: diameter of the body")
    if math.isnan(s.yield_strength):
        lines.append("no limits: no grade and no yield_strength given")
    else:
        pull = tensile_strength(s.worn_diameter / INCH, item.id / INCH, s.yield_strength / (KSI / 1e3))
        torque = torsional_strength(s.worn_diameter / INCH, item.id / INCH, s.yield_strength / (KSI / 1e3))
        worn = (
            f"tube worn to {_length(s.worn_diameter, units)}" if isinstance(item, DrillPipe) else "new tube"
        )
        lines.append(
            f"yields at {_with_field(f'{pull * LBF / 1e3:.5g} kN', f'{pull:,.0f} lbf', units)} or "
            f"{_with_field(f'{torque * FT_LBF / 1e3:.5g} kN m', f'{torque:,.0f} ft-lbf', units)}: "
            f"formulas of API RP 7G, {worn}, connections not counted"
        )
    if case.fluid is not None and s.joint_share > 0:
        extra = s.joint_share * ((item.id / s.joint_bore) ** TURBULENT - 1)
        lines.append(
            f"friction of the mud: tube and tool joints in series (bore: {100 * extra:+.0f} % over the tube in turbulent flow)"
        )
    return lines


def _length(value: float, units: System) -> str:
    return _with_field(f"{1e3 * value:.5g} mm", inch_text(value / INCH), units)
