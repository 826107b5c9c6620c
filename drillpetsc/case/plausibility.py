"""Warnings about values that look like another unit: valid, but hardly meant."""

from __future__ import annotations

import math

from drillpetsc.case.blocks.case_blocks import CaseBlocks
from drillpetsc.case.blocks.fluid import Bingham, Casson, Newtonian, Rheology
from drillpetsc.case.blocks.tools import ShockSub
from drillpetsc.case.plausible_operations import casings, flows, intervals, readings, torques
from drillpetsc.case.plausible_string import (
    beyond_curves,
    beyond_lower_part,
    listed_upwards,
    lumped_masses,
    pumping_valves,
    short_of_hole,
    standing_bit,
)
from drillpetsc.case.quantities import largest, said
from drillpetsc.unit_systems import shown

ROUGHEST = 1.0  # friction factor: 0.1 to 0.5 are usual
WIDEST_HOLE = 1.2  # [m] 36 in holes and 42 in conductors are below it
LIGHTEST_MUD, HEAVIEST_MUD = 500.0, 2900.0  # [kg/m3] foam of 4 ppg, 24 ppg
DEEPEST = 15e3  # [m]
LARGEST_WEIGHT = 500e3  # [N] on a bit
STEEPEST = math.radians(120)
FASTEST_ROTATION = 40.0  # [rad/s] 380 rpm
LARGEST_FLOW, LARGEST_PUMP_PRESSURE = 0.15, 120e6  # [m3/s], [Pa]
THICKEST_MUD = 1.0  # [Pa s] of the viscosity at high shear rates
THINNEST_PIPE = 0.02  # [m]
SMALLEST_PUMP_PRESSURE = 2e4  # [Pa] of a number that was meant as bar or psi


def plausibility(case: CaseBlocks) -> list[str]:
    """One line for each value that looks like a number in another unit, with the place and the value as read."""
    out: list[str] = []
    units = case.output.units or "SI"

    def doubt(at: str, value: str, why: str) -> None:
        out.append(f"{at} is {value}: {why}")

    if case.well is not None:
        for i, section in enumerate(case.well.sections):
            if section.diameter > WIDEST_HOLE:
                inches = f"; {section.diameter:g} in?" if units == "SI" and section.diameter < 50 else ""
                doubt(
                    f"well.sections[{i}].diameter",
                    said(section.diameter, "diameter", units),
                    f"no hole is that wide{inches}",
                )
            if section.friction > ROUGHEST:
                doubt(f"well.sections[{i}].friction", f"{section.friction:g}", _rough(section.friction))
        survey = case.well.survey
        if survey.md[-1] > DEEPEST:
            doubt(
                "well.survey",
                f"{said(survey.md[-1], 'length', units)} deep",
                "deeper than any well" + ("" if units == "field" else "; feet?"),
            )
        steepest = max(survey.inclination)
        if steepest > STEEPEST:
            doubt(
                "well.survey.inclination",
                f"up to {math.degrees(steepest):.4g} deg",
                f"the hole climbs there; bare numbers are in rad, were {steepest:g} deg meant?"
                if units == "SI"
                else "the hole climbs there",
            )
        largest_azimuth = max(map(abs, survey.azimuth))
        if steepest > math.radians(30) and 0 < largest_azimuth < math.radians(0.1):
            doubt(
                "well.survey.azimuth",
                f"at most {math.degrees(largest_azimuth):.2g} deg",
                "angles in another unit?",
            )
    for i, item in enumerate(case.string):
        own = item.friction
        if own is not None and own > ROUGHEST:
            doubt(f"string[{i}].friction", f"{own:g}", _rough(own))
    for i, tool, _ in case.tools:
        held = tool.held_by if isinstance(tool, ShockSub) else None
        if held is not None:
            does = "opens" if held < 0 else "closes"
            load = f"a {'push' if held < 0 else 'pull'} above {shown(abs(held), 'force', case.output.units or 'metric')}"
            out.append(f"string[{i}] shock_sub: preload {does} the stroke: acts as rigid without {load}")
    if case.fluid is not None:
        density = case.fluid.density
        if density < LIGHTEST_MUD and density > 0.5:
            unit = "" if units != "SI" else "ppg" if 6 <= density <= 25 else "sg" if density < 3 else ""
            doubt(
                "fluid.density",
                said(density, "mud_weight", units),
                "lighter than any mud" + (f"; {density:g} {unit}?" if unit else ""),
            )
        if density > HEAVIEST_MUD:
            doubt("fluid.density", said(density, "mud_weight", units), "heavier than any mud")
        flow = largest(case.fluid.flow_rate)
        if flow > LARGEST_FLOW:
            doubt(
                "fluid.flow_rate",
                shown(flow, "flow", case.shown_units),
                "more than rig pumps deliver",
            )
        pressure = largest(case.fluid.pump_pressure)
        if pressure > LARGEST_PUMP_PRESSURE or 0 < pressure < SMALLEST_PUMP_PRESSURE:
            doubt(
                "fluid.pump_pressure",
                said(pressure, "pressure", units),
                "no usual pump pressure; bar or psi?",
            )
        for key, rheology in (
            ("rheology", case.fluid.rheology),
            ("annulus_rheology", case.fluid.annulus_rheology),
        ):
            viscosity = 0.0 if rheology is None else _viscosity(rheology)
            if viscosity > THICKEST_MUD:
                doubt(
                    f"fluid.{key}",
                    f"a fluid of {said(viscosity, 'viscosity', units)}",
                    "thicker than any mud" + (f"; {viscosity:g} cP?" if units == "SI" else ""),
                )
    if case.output.units in ("field", "metric", "metric_t"):
        for i, item in enumerate(case.string):
            if item.od is not None and item.od < THINNEST_PIPE:
                doubt(
                    f"string[{i}].od",
                    shown(item.od, "diameter", case.output.units),
                    "metres without their unit?",
                )
    out += [*short_of_hole(case), *listed_upwards(case), *beyond_lower_part(case), *pumping_valves(case)]
    out += beyond_curves(case)
    out += [
        *torques(case),
        *flows(case),
        *intervals(case),
        *lumped_masses(case),
        *casings(case),
        *standing_bit(case),
    ]
    if case.roadmap is not None and case.roadmap.measured:
        hole = None if case.well is None else case.well.survey.md[-1]
        out += readings(case.roadmap.measured, hole, case.shown_units)
    if case.initial.wob is not None and case.initial.wob > LARGEST_WEIGHT:
        units = case.shown_units
        more = (
            f"; {shown(LARGEST_WEIGHT, 'force', units)} are the most"
            if units != "field"
            else "; lbf need their unit"
        )
        doubt("initial.wob", shown(case.initial.wob, "force", units), f"more than bits carry{more}")
    rotation = largest(case.top.rotation)
    if rotation > FASTEST_ROTATION:
        doubt(
            "top.rotation",
            f"{rotation * 30 / math.pi:.4g} rpm",
            f"faster than drillstrings turn; {rotation:g} rpm?",
        )
    return out


def _rough(friction: float) -> str:
    return "rougher than steel on rock" + (
        f"; {friction:g} %?" if friction >= 5 else "; 0.1 to 0.5 are usual"
    )


def _viscosity(rheology: Rheology) -> float:
    """Viscosity or plastic viscosity [Pa s]; 0 for models of another kind."""
    if isinstance(rheology, Newtonian):
        return rheology.viscosity
    return rheology.plastic_viscosity if isinstance(rheology, (Bingham, Casson)) else 0.0


def notes(case: CaseBlocks) -> list[str]:
    """Lines for the user about how the case was read: warnings first, then remarks of the readers of files."""
    remarks = list(case.well.survey.remarks) if case.well is not None else []
    warned = [remark.removeprefix("WARNING: ") for remark in remarks if remark.startswith("WARNING")]
    lines = [f"WARNING: {text}" for text in (*plausibility(case), *warned)]
    return lines + [f"survey: {remark}" for remark in remarks if not remark.startswith("WARNING")]
