"""Sections on the inputs: well, string, mud, from the plain data of a case."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from drillpetsc.case.blocks.fluid import flow_constants
from drillpetsc.case.blocks.items.tubulars import Jointed, Tubular
from drillpetsc.case.blocks.rig import STANDARD_GRAVITY
from drillpetsc.case.case import Case
from drillpetsc.case.importers.stations import dogleg, minimum_curvature_step
from drillpetsc.case.pipe.section import tubular_section
from drillpetsc.output.files.tables import Column
from drillpetsc.plotting.run.well_views import Path, Piece, schematic, section_and_plan
from drillpetsc.reporting.page import Grid, Section, drawn_title, facts, grid_of, picture
from drillpetsc.reporting.units import number, texts
from drillpetsc.time_function import Constant
from drillpetsc.unit_systems import System, display, display_unit

COURSE = 30.0  # length to which doglegs refer [m]
FROM_CASE = "case"


def survey_table(case: Case) -> dict[str, np.ndarray]:
    """Stations of the survey with positions by minimum curvature, as columns of trajectory.csv."""
    q = case.given_well.survey
    at, severity = [np.zeros(3)], [0.0]
    for i in range(1, len(q.md)):
        ends = q.inclination[i - 1], q.azimuth[i - 1], q.inclination[i], q.azimuth[i]
        length = q.md[i] - q.md[i - 1]
        at.append(at[-1] + minimum_curvature_step(length, *ends))
        severity.append(math.degrees(dogleg(*ends)) * COURSE / length)
    north, east, tvd = np.array(at).T
    elevation = None if case.rig is None else case.rig.elevation
    return {
        "md [m]": np.array(q.md),
        "inclination [deg]": np.degrees(q.inclination),
        "azimuth [deg]": np.degrees(q.azimuth) % 360.0,
        "tvd [m]": tvd,
        **({} if elevation is None else {"tvd_below_reference [m]": tvd - elevation}),
        "north [m]": north,
        "east [m]": east,
        "dogleg_severity [deg/30m]": np.array(severity),
    }


def well_section(case: Case, system: System, title: str) -> Section:
    """Hole sections, vertical section and plan, and the survey."""
    section = Section("well", "Well")
    if case.well is None:
        section.missing = "no well in this case"
        return section
    table = survey_table(case)
    md, end = table["md [m]"], case.well.survey.md[-1]
    deepest = float(table["inclination [deg]"].max())
    rows = [
        ("Measured depth of the survey's end", *number(end, "md [m]", system)),
        ("True vertical depth there", *number(table["tvd [m]"][-1], "tvd [m]", system)),
        ("Largest inclination", f"{deepest:.2f}", "deg"),
        ("Largest dogleg severity between stations", *_largest(table, system)),
    ]
    if case.rig is not None and case.rig.elevation is not None:
        above = (
            f"Height of the datum above {case.rig.elevation_ref or 'MSL'}, the reference of the survey table"
        )
        rows.append((above, *number(case.rig.elevation, "tvd_below_reference [m]", system)))
    north = case.well.survey.north
    if north is not None:
        rows.append(("Azimuths are measured from", f"{north} north", ""))
    for name, angle in (
        ("convergence", case.well.survey.convergence),
        ("declination", case.well.survey.declination),
    ):
        if angle is not None:
            rows.append((f"{name.capitalize()}, applied to nothing", f"{math.degrees(angle):.3f}", "deg"))
    section.grids.append(facts(rows, source=FROM_CASE))
    section.grids.append(_hole(case, system))
    shoes = [s.to for s in case.well.sections if s.kind == "casing"]
    path = Path(md, table["north [m]"], table["east [m]"], table["tvd [m]"])
    words = f"{drawn_title(title)}: path of the well" + ("; casing shoes are marked" if shoes else "")
    section.pictures.append(picture(section_and_plan(path, shoes, words), words, "survey of the case"))
    section.grids.append(
        grid_of(
            table,
            system,
            "Survey; positions by minimum curvature",
            FROM_CASE,
            csv_name="survey.csv",
            folded=True,
        )
    )
    if len(md) > 2:
        section.text += [
            f"Survey: {remark.removeprefix('WARNING: ')}." for remark in case.well.survey.remarks
        ]
    return section


def _largest(table: dict[str, np.ndarray], system: System) -> tuple[str, str]:
    return number(float(table["dogleg_severity [deg/30m]"].max()), "dogleg_severity [deg/30m]", system)


def _hole(case: Case, system: System) -> Grid:
    length, _, depth = display_unit("length", system)
    size, _, across = display_unit("diameter", system)
    heads = ("Hole section", f"from [{depth}]", f"to [{depth}]", f"Diameter [{across}]", "Friction factor")
    rows, top = [], 0.0
    for s in case.given_well.sections:
        rows.append(
            (
                {"casing": "cased", "riser": "riser"}.get(s.kind, "open hole"),
                f"{top / length:.1f}",
                f"{s.to / length:.1f}",
                f"{s.diameter / size:.5g}",
                f"{s.friction:g}",
            )
        )
        top = s.to
    return Grid(heads, rows, "Sections of the hole", FROM_CASE, numeric=(False, True, True, True, True))


def string_section(case: Case, system: System, title: str) -> Section:
    """Items of the string from the rig down, and the schematic."""
    section = Section("string", "String")
    table = string_table(case)
    section.grids.append(
        grid_of(table, system, "Items from the rig down", FROM_CASE, csv_name="string.csv", folded=False)
    )
    pieces, top = [], 0.0
    for item in case.string:
        pieces.append(Piece(item.kind, item.name, top, top + item.length, float(item.od or 0.0), item.id))
        top += item.length
    hole, above = [], 0.0
    for s in case.well.sections if case.well is not None else ():
        hole.append(Piece(s.kind, s.kind, above, s.to, s.diameter))
        above = s.to
    words = f"{drawn_title(title)}: string"
    section.pictures.append(picture(schematic(pieces, hole, words), words, "string and well of the case"))
    return section


def string_table(case: Case) -> dict[str, np.ndarray]:
    """Items from the top down: `name [unit]` -> (n,)."""
    rows: list[dict[Column, Any]] = []
    top = 0.0
    for item in case.string:
        row: dict[Column, Any] = {
            ("item", "-"): item.name,
            ("length", "m"): item.length,
            ("to", "m"): top + item.length,
            ("od", "m"): float(item.od or math.nan),
            ("id", "m"): float(item.id),
            ("contact_diameter", "m"): float(item.contact_od or math.nan),
            ("weight_in_air", "kg/m"): _mass(item),
            ("grade", "-"): "-",
            ("yield_strength", "Pa"): math.nan,
            ("connection", "-"): "-",
        }
        if isinstance(item, Tubular):
            row["yield_strength", "Pa"] = float(tubular_section(item).yield_strength)
            worn = getattr(item, "class_", None)
            row["grade", "-"] = " ".join(filter(None, (item.grade, worn))) or "-"
        if isinstance(item, Jointed) and item.tool_joint.connection:
            row["connection", "-"] = item.tool_joint.connection
        rows.append(row)
        top += item.length
    table = {f"{name} [{unit}]": np.array([row[name, unit] for row in rows]) for name, unit in rows[0]}
    lengths = table["length [m]"]
    weights = STANDARD_GRAVITY * lengths * np.nan_to_num(table["weight_in_air [kg/m]"])
    table["weight_in_air_to_here [N]"] = np.cumsum(weights)
    return table


def _mass(item: Any) -> float:
    """Mass per length [kg/m]; nan if an item has no length."""
    if isinstance(item, Tubular):
        return float(tubular_section(item).mass)
    mass = getattr(item, "mass", None)
    if mass is not None:
        return float(mass) / item.length if item.length > 0 else math.nan
    return float(item.material.density * math.pi / 4 * (item.od**2 - item.id**2))


def mud_section(case: Case, system: System) -> Section:
    """Density, rheology, pump, nozzles."""
    section = Section("mud", "Mud")
    if case.fluid is None:
        section.missing = "no mud in this case"
        return section
    mud = case.fluid
    consistency, index, stress = flow_constants(mud.rheology)
    rows = [
        ("Density", *_split(mud.density, "mud_weight", system)),
        ("Flow curve", f"{mud.rheology.model.replace('_', ' ')}, law {mud.rheology.law}", ""),
        ("Yield stress", *_split(stress, "yield_point", system)),
        ("Consistency", *_split(consistency, "consistency", system)),
        ("Flow index", f"{index:.4g}", ""),
    ]
    if isinstance(mud.flow_rate, Constant):
        rows.append(("Flow rate", *_split(mud.flow_rate.value(0.0), "flow", system)))
    elif mud.pump_pressure is None:
        rows.append(("Flow rate", "varies over time", ""))
    else:
        rows.append(("Pump", "a given pressure", ""))
    above = dict(case.side_nozzles)
    for i, item in enumerate(case.string):
        if item.nozzle_area:
            label = f"Nozzle area of {item.name}" if i in above else "Nozzle area"
            rows.append((label, *_split(float(item.nozzle_area), "flow_area", system)))
    line = mud.surface_line
    if line is not None:
        if line.length is not None and line.id is not None:
            rows.append(("Length of the surface line", *_split(line.length, "length", system)))
            rows.append(("Bore of the surface line", *_split(line.id, "diameter", system)))
        if line.loss is not None and line.at is not None:
            rows.append(("Loss of the surface line", *_split(line.loss, "pressure", system)))
            rows.append(("at a flow rate of", *_split(line.at, "flow", system)))
    section.grids.append(facts(rows, source=FROM_CASE))
    if mud.rheology.dial:
        readings = [(rpm, f"{value:g}") for rpm, value in mud.rheology.dial.items()]
        section.grids.append(
            Grid(
                ("Viscometer speed [rpm]", "Reading [deg]"),
                readings,
                f"Dial readings, fitted: {mud.rheology.fit or 'given'}",
                FROM_CASE,
                numeric=(True, True),
            )
        )
    return section


def _split(value: float, kind: str, system: System) -> tuple[str, str]:
    figure, unit = display(value, kind, system)
    return texts(np.array([figure]))[0], unit


def rig_rows(case: Case, system: System) -> list[tuple[str, str, str]]:
    """Facts of the rig; empty if the case has none."""
    if case.rig is None:
        return []
    kinds = (
        ("Weight of block and top drive", case.rig.block_weight, "force"),
        ("Largest hook load of the rig", case.rig.max_hookload, "force"),
        ("Largest surface torque of the rig", case.rig.max_surface_torque, "torque"),
        ("Largest standpipe pressure of the rig", case.rig.max_spp, "pressure"),
    )
    return [(name, *_split(value, kind, system)) for name, value, kind in kinds if value is not None]
