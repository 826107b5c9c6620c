"""Warnings about valid but unlikely values, which suggest another unit."""

from __future__ import annotations

import itertools
import math

from drillpetsc.case.blocks.case_blocks import CaseBlocks
from drillpetsc.case.blocks.ends import BitBottom
from drillpetsc.case.blocks.fluid import Bingham, Casson, Newtonian, Rheology
from drillpetsc.case.blocks.items.tools import ShockSub
from drillpetsc.case.blocks.well import Survey
from drillpetsc.case.importers.stations import dogleg
from drillpetsc.case.plausible.plausible_operations import casings, flows, intervals, readings, torques
from drillpetsc.case.plausible.plausible_string import (
    beyond_curves,
    beyond_lower_part,
    idle_mesh,
    listed_upwards,
    lumped_masses,
    odd_densities,
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
HEAVIEST_BLOCK = 3e6  # [N] 300 t, twice those of the largest rigs
STEEPEST = math.radians(120)
LEAST_TILT, LEAST_STATIONS = (
    0.05,
    4,
)  # [rad of a survey that is read in degrees], stations of it that are inclined
LEAST_RISING = 6  # stations of a plan with one azimuth, which rise by chance once in 720 wells
SHARPEST_BEND = math.radians(10) / 30  # [rad/m] of a hole
FASTEST_ROTATION = 40.0  # [rad/s] 380 rpm
LARGEST_FLOW, LARGEST_PUMP_PRESSURE = 0.15, 120e6  # [m3/s], [Pa]
THICKEST_MUD = 1.0  # [Pa s] of the viscosity at high shear rates
THINNEST_PIPE = 0.02  # [m]
STIFFEST_GEL, SOFTEST_MUD = 100.0, 1e8  # [Pa] of the yield stress (200 lbf/100 ft2), of the bulk modulus
FASTEST_TRIP = 5.0  # [m/s] of the top
EARTH = (9.7, 9.9)  # [m/s2]
FULL_FRICTION = 0.95  # share of friction below which it is reported as rounded
SMALLEST_PUMP_PRESSURE = 2e4  # [Pa] of a number that was meant as bar or psi


def plausibility(case: CaseBlocks) -> list[str]:
    """One line for each value that looks like a number in another unit, with the place and the value as read."""
    checks = (
        _hole,
        _string_friction,
        _preloads,
        _fluid,
        _thin_pipe,
        short_of_hole,
        listed_upwards,
        idle_mesh,
        beyond_lower_part,
        pumping_valves,
        beyond_curves,
        torques,
        flows,
        intervals,
        lumped_masses,
        odd_densities,
        casings,
        standing_bit,
        _measured,
        _motion,
        _gravity,
        _rounded_friction,
    )
    return [line for check in checks for line in check(case)]


def _doubt(at: str, value: str, why: str) -> str:
    return f"{at} is {value}: {why}"


def _hole(case: CaseBlocks) -> list[str]:
    """Doubts about the hole: width, friction, depth and angles."""
    if case.well is None:
        return []
    out, units = [], case.said_units
    for i, section in enumerate(case.well.sections):
        if section.diameter > WIDEST_HOLE:
            inches = f"; {section.diameter:g} in?" if units == "SI" and section.diameter < 50 else ""
            value = said(section.diameter, "diameter", units)
            out.append(_doubt(f"well.sections[{i}].diameter", value, f"holes are not that wide{inches}"))
        if section.friction > ROUGHEST:
            out.append(
                _doubt(f"well.sections[{i}].friction", f"{section.friction:g}", _rough(section.friction))
            )
    survey = case.well.survey
    if survey.md[-1] > DEEPEST:
        why = "deeper than any well" + ("" if units == "field" else "; feet?")
        out.append(_doubt("well.survey", f"{said(survey.md[-1], 'length', units)} deep", why))
    steepest, largest_azimuth = max(survey.inclination), max(map(abs, survey.azimuth))
    if steepest > STEEPEST:
        why = "the hole climbs there"
        if units == "SI":
            why += f"; bare numbers are in rad, were {steepest:g} deg meant?"
        out.append(_doubt("well.survey.inclination", f"up to {math.degrees(steepest):.4g} deg", why))
    if _reads_as_radians(survey):
        value = f"at most {math.degrees(steepest):.3g} deg, all azimuths below 6.3 deg"
        out.append(
            _doubt(
                "well.survey.inclination", value, "the numbers read as a smooth well in rad; were rad meant?"
            )
        )
    if steepest > math.radians(30) and 0 < largest_azimuth < math.radians(0.1):
        value = f"at most {math.degrees(largest_azimuth):.2g} deg"
        out.append(_doubt("well.survey.azimuth", value, "angles in another unit?"))
    return out


def _reads_as_radians(survey: Survey) -> bool:
    """Whether the numbers of a survey in degrees are those of a well in radians.

    Inclinations of at most pi/2 degrees are a nearly vertical hole, whose measured azimuths lie all around.  That several, not all
    the same, lie below 2 pi degrees, and that the numbers are a smooth hole in radians, is no chance.  A plan may have one azimuth:
    then many inclinations that only rise, to what would be a well of 30 degrees or more, are none either.
    """
    inclination, azimuth = (
        [math.degrees(q) for q in angles] for angles in (survey.inclination, survey.azimuth)
    )
    tilted = [i for i, angle in enumerate(inclination) if angle > LEAST_TILT]
    if len(tilted) < LEAST_STATIONS or max(inclination) > math.pi / 2:
        return False
    turns = [azimuth[i] for i in tilted]
    if min(turns) < 0 or max(turns) > 2 * math.pi:
        return False
    if max(turns) - min(turns) < 1e-3 and (
        len(tilted) < LEAST_RISING
        or max(inclination) < math.radians(30)
        or any(inclination[k] < inclination[i] for i, k in itertools.pairwise(tilted))
        or len({inclination[i] for i in tilted}) < LEAST_RISING - 1  # a hold at the end
    ):
        return False
    return all(
        dogleg(inclination[i], azimuth[i], inclination[k], azimuth[k])
        <= SHARPEST_BEND * (survey.md[k] - survey.md[i])
        for i, k in itertools.pairwise(tilted)
    )


def _string_friction(case: CaseBlocks) -> list[str]:
    return [
        _doubt(f"string[{i}].friction", f"{item.friction:g}", _rough(item.friction))
        for i, item in enumerate(case.string)
        if item.friction is not None and item.friction > ROUGHEST
    ]


def _preloads(case: CaseBlocks) -> list[str]:
    """Effect of a preload without an opposite load on a shock sub."""
    out, units = [], case.shown_units
    for i, tool, _ in case.tools:
        held = tool.held_by if isinstance(tool, ShockSub) else None
        if held is not None:
            does = "opens" if held < 0 else "closes"
            load = f"a {'push' if held < 0 else 'pull'} above {shown(abs(held), 'force', units)}"
            out.append(f"string[{i}] shock_sub: preload {does} the stroke: acts as rigid without {load}")
    return out


def _fluid(case: CaseBlocks) -> list[str]:
    """Doubts about density, flow rate, pressure and viscosity of the mud."""
    f, units = case.fluid, case.said_units
    if f is None:
        return []
    out, density = [], f.density
    if 0.5 < density < LIGHTEST_MUD:
        unit = "" if units != "SI" else "ppg" if 6 <= density <= 25 else "sg" if density < 3 else ""
        why = "lighter than any mud" + (f"; {density:g} {unit}?" if unit else "")
        out.append(_doubt("fluid.density", said(density, "mud_weight", units), why))
    if density > HEAVIEST_MUD:
        out.append(_doubt("fluid.density", said(density, "mud_weight", units), "heavier than any mud"))
    flow, pressure = largest(f.flow_rate), largest(f.pump_pressure)
    if flow > LARGEST_FLOW:
        why = "more than rig pumps deliver"
        out.append(_doubt("fluid.flow_rate", shown(flow, "flow", case.shown_units), why))
    if pressure > LARGEST_PUMP_PRESSURE or 0 < pressure < SMALLEST_PUMP_PRESSURE:
        why = "not a usual pump pressure; bar or psi?"
        out.append(_doubt("fluid.pump_pressure", said(pressure, "pressure", units), why))
    if f.bulk_modulus < SOFTEST_MUD:
        why = "softer than any mud; 2 GPa is water"
        out.append(_doubt("fluid.bulk_modulus", said(f.bulk_modulus, "pressure", units), why))
    for key, rheology in (("rheology", f.rheology), ("annulus_rheology", f.annulus_rheology)):
        viscosity = 0.0 if rheology is None else _viscosity(rheology)
        if viscosity > THICKEST_MUD:
            why = "thicker than any mud" + (f"; {viscosity:g} cP?" if units == "SI" else "")
            value = f"a fluid of {said(viscosity, 'viscosity', units)}"
            out.append(_doubt(f"fluid.{key}", value, why))
        stress = getattr(rheology, "yield_stress", 0.0)
        if stress > STIFFEST_GEL:
            why = "stiffer than any mud that is pumped"
            out.append(_doubt(f"fluid.{key}.yield_stress", said(stress, "yield_point", units), why))
    return out


def _thin_pipe(case: CaseBlocks) -> list[str]:
    units = case.output.units
    if units not in ("field", "metric", "metric_t"):
        return []
    return [
        _doubt(f"string[{i}].od", shown(item.od, "diameter", units), "metres without their unit?")
        for i, item in enumerate(case.string)
        if item.od is not None and item.od < THINNEST_PIPE
    ]


def _measured(case: CaseBlocks) -> list[str]:
    if case.roadmap is None or not case.roadmap.measured:
        return []
    hole = None if case.well is None else case.well.survey.md[-1]
    return readings(case.roadmap.measured, hole, case.shown_units)


def _motion(case: CaseBlocks) -> list[str]:
    """Doubts about the weights on bit and of the block, and the rotation."""
    out, units, wob = [], case.shown_units, case.initial.wob
    if wob is not None and wob > LARGEST_WEIGHT:
        most = f"{shown(LARGEST_WEIGHT, 'force', units)} are the most"
        why = f"more than bits carry; {most if units != 'field' else 'lbf need their unit'}"
        out.append(_doubt("initial.wob", shown(wob, "force", units), why))
    block = 0.0 if case.rig is None else case.rig.block_weight or 0.0
    if block > HEAVIEST_BLOCK:
        most = shown(HEAVIEST_BLOCK, "force", units)
        why = f"more than any block with its top drive, {most} at most: is the unit right?"
        out.append(_doubt("rig.block_weight", shown(block, "force", units), why))
    speed = largest(case.top.lowering)
    if speed > FASTEST_TRIP:
        out.append(
            _doubt("top.lowering", shown(speed, "trip_speed", units), "faster than any hoist; per minute?")
        )
    if isinstance(case.bottom, BitBottom) and case.bottom.friction > ROUGHEST:
        out.append(_doubt("bottom.friction", f"{case.bottom.friction:g}", _rough(case.bottom.friction)))
    rotation = largest(case.top.rotation)
    if rotation > FASTEST_ROTATION:
        meant = (
            f"; bare numbers are in rad/s, were {rotation:g} rpm meant?" if case.said_units == "SI" else ""
        )
        why = f"faster than drillstrings turn{meant}"
        out.append(_doubt("top.rotation", f"{rotation * 30 / math.pi:.4g} rpm", why))
    return out


def _gravity(case: CaseBlocks) -> list[str]:
    """Doubts about gravity other than that of the Earth; none and a given direction are wanted."""
    north, east, down = case.gravity
    if north or east or not down or EARTH[0] <= down <= EARTH[1]:
        return []
    why = "the string falls upward" if down < 0 else "9.81 m/s2 is the Earth's"
    return [_doubt("gravity", f"{down:g} m/s2 downward", why)]


def _rounded_friction(case: CaseBlocks) -> list[str]:
    """A doubt where the string slides too slowly for its friction to build up in a run."""
    if case.contact is None or case.time is None or case.time.mode != "dynamic":
        return []
    od = max((item.od or 0.0 for item in case.string), default=0.0)
    speed = math.hypot(largest(case.top.lowering), largest(case.top.rotation) * od / 2)
    slip, units = case.contact.slip_velocity, case.shown_units
    share = speed / math.hypot(speed, slip)
    if not speed or share >= FULL_FRICTION:
        return []
    why = f"a string that slides at {shown(speed, 'creep', units, 3)} has {100 * share:.2g} % of its friction in a run"
    return [_doubt("contact.slip_velocity", shown(slip, "creep", units, 3), why)]


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
