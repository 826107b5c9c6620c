"""The string of a case as a table to read: an item a row, from the top down."""

from __future__ import annotations

import html
import math
from typing import Any

from drillpetsc.case.blocks.items.string import Beam, Rigid, Tube
from drillpetsc.case.blocks.items.tubulars import Tubular
from drillpetsc.case.html_table import html_table
from drillpetsc.case.pipe.section import ring, tubular_section
from drillpetsc.unit_systems import System, display

WIDTH, HEIGHT, SMALLEST = 60, 240.0, 14.0  # of the schematic, and of an item in it [pixels]
MOST_DRAWN = 60  # items
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


def string_rows(case: Any) -> tuple[list[str], list[list[str]]]:
    """(headings with units, cells) of the string table; an empty cell if an item has no such figure."""
    system: System = case.shown_units
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


def schematic(case: Any) -> str:
    """The string as an SVG element: diameters to scale; an item is as high as the square root of its length, SMALLEST at least."""
    items = case.string
    if len(items) > MOST_DRAWN:
        return f"<p>no schematic: {len(items)} items, above {MOST_DRAWN}</p>"
    widest = max((item.od or 0.0 for item in items), default=0.0)
    if not widest > 0:
        return ""
    unit = HEIGHT / sum(math.sqrt(item.length) for item in items) if any(i.length for i in items) else 0.0
    y, parts = 0.0, []
    for item in items:
        high = max(unit * math.sqrt(item.length), SMALLEST)
        wide, bore = (WIDTH * (size or 0.0) / widest for size in (item.od, item.id if item.od else None))
        fill = "#c94f1d" if isinstance(item, Rigid) else "#8899b0"
        for size, colour in ((wide, fill), (bore, "#eef1f5")):
            if size > 0:
                x = 0.5 * (WIDTH - size)
                parts.append(
                    f'<rect x="{x:.1f}" y="{y:.1f}" width="{size:.1f}" height="{high:.1f}" fill="{colour}"/>'
                )
        label = f'<text x="{WIDTH + 8}" y="{y + 0.5 * high + 4:.1f}" font-size="11">{html.escape(item.name)}</text>'
        parts.append(label)
        y += high
    return f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH + 200}" height="{y:.0f}">{"".join(parts)}</svg>'


def case_html(case: Any) -> str:
    """The case for a notebook: title, string table, schematic, hole, ends."""
    heads, rows = string_rows(case)
    system: System = case.shown_units
    parts = [f"top: {case.top.kind}", f"bottom: {case.bottom.kind}"]
    if case.well is not None:
        depth, unit = display(float(case.well.survey.md[-1]), "length", system)
        parts.insert(0, f"hole to MD {depth:.6g} {unit}, {len(case.well.sections)} sections")
    if case.fluid is not None:
        density, unit = display(case.fluid.density, "mud_weight", system)
        parts.append(f"mud {density:.4g} {unit}")
    return (
        f"<p><b>{html.escape(case.title or 'case')}</b></p>"
        f"{html_table(heads, rows)}{schematic(case)}<p>{html.escape('; '.join(parts))}</p>"
    )
