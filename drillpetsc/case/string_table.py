"""The string of a case as a table to read: an item a row, from the top down."""

from __future__ import annotations

import html
from typing import Any

from drillpetsc.case.blocks.string import Beam, Rigid, Tube
from drillpetsc.case.blocks.tubulars import Tubular
from drillpetsc.case.section import ring, tubular_section
from drillpetsc.unit_systems import System, display

#: heading of a column, kind of its unit
COLUMNS = (
    ("from", "length"),
    ("to", "length"),
    ("outer diameter", "diameter"),
    ("inner diameter", "diameter"),
    ("mass per length", "weight_per_length"),
)


def mass_per_length(item: Any) -> float | None:
    """Mass per length of an item in air [kg/m]; None for an item without length."""
    if isinstance(item, Tubular):
        return float(tubular_section(item).mass)
    if isinstance(item, Beam):
        return item.mass
    if isinstance(item, Rigid):
        return item.mass / item.length if item.length else None
    assert isinstance(item, Tube)
    return float(ring(item.od, item.id)[0]) * float(item.material.density)


def string_rows(case: Any, units: System | None = None) -> tuple[list[str], list[list[str]]]:
    """(headings with units, cells) of the string table; an empty cell where an item has no such figure.

    units: field, metric, metric_t or SI; by default those of the case, metric where it has none
    """
    system: System = units or case.output.units or "metric"
    rows = []
    for number, (item, (upper, lower)) in enumerate(zip(case.string, case.item_depths, strict=True)):
        figures = (upper, lower, item.od, item.id if item.od else None, mass_per_length(item))
        cells = [
            "" if value is None else f"{display(value, kind, system)[0]:.5g}"
            for value, (_, kind) in zip(figures, COLUMNS, strict=True)
        ]
        rows.append([item.name, case.figures.references.get(number, item.kind.replace("_", " ")), *cells])
    heads = [f"{name} [{display(0.0, kind, system)[1]}]" for name, kind in COLUMNS]
    return ["item", "kind", *heads], rows


def case_html(case: Any) -> str:
    """The case for a notebook: title, string table, hole, ends."""
    heads, rows = string_rows(case)
    system: System = case.output.units or "metric"
    head = "".join(f"<th>{html.escape(name)}</th>" for name in heads)
    body = "".join(
        "<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>" for row in rows
    )
    parts = [f"top: {case.top.kind}", f"bottom: {case.bottom.kind}"]
    if case.well is not None:
        depth, unit = display(float(case.well.survey.md[-1]), "length", system)
        parts.insert(0, f"hole to MD {depth:.6g} {unit}, {len(case.well.sections)} sections")
    if case.fluid is not None:
        density, unit = display(case.fluid.density, "mud_weight", system)
        parts.append(f"mud {density:.4g} {unit}")
    return (
        f"<p><b>{html.escape(case.title or 'case')}</b></p>"
        f"<table><tr>{head}</tr>{body}</table><p>{html.escape('; '.join(parts))}</p>"
    )
