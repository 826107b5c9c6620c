"""The short report of a result: its main figures in a system of units, warnings, and for a notebook a picture."""

from __future__ import annotations

import base64
import html
from collections.abc import Mapping
from typing import Any

import numpy as np

from drillpetsc.case.html_table import html_table
from drillpetsc.output.files.tables import split_name
from drillpetsc.output.quantities.tables import COLUMNS
from drillpetsc.output.shown_units import shown_unit
from drillpetsc.results.datasets import Table
from drillpetsc.results.described import in_system, quantity_of
from drillpetsc.unit_systems import System, display

MOST_ROWS = 20
LARGEST_SVG = 400_000  # letters; larger pictures are shown as PNG

Rows = tuple[list[str], list[list[str]]]
"""Headings, and the cells of each row."""


def main_figures(kind: str, summary: Mapping[str, Any], tables: Mapping[str, Table], system: System) -> Rows:
    """The main figures of a result.

    kind: run, statics, hydraulics, surge, modes; tables: file -> table, as in the files; system: of the figures
    """
    if kind == "statics":
        return ["", "value", "unit"], _statics(summary, system)
    if kind == "run":
        return ["at the end", "value", "unit"], _final(summary.get("final", {}), system)
    if kind == "hydraulics":
        return _flows(summary, system)
    if kind == "calibrate":
        return ["fitted", "value", "95 % from", "to", ""], _fitted(summary)
    for file, table in tables.items():
        return _first_rows(table, file, system)
    return [], []


def _cells(heading: str, value: Any, file: str, system: System) -> list[str]:
    """[label, number, unit] of a figure."""
    title, shown = in_system(heading, np.array([float(value)]), system)
    name, unit = split_name(title)
    q = quantity_of(name, file)
    return [q.label if q is not None else name.replace("_", " "), f"{shown[0]:.6g}", unit]


def _statics(summary: Mapping[str, Any], system: System) -> list[list[str]]:
    file = "summary.json of statics"
    rows = [
        _cells(q.title, summary[q.name], file, system)
        for q in COLUMNS["static_summary"]
        if summary.get(q.name) is not None
    ]
    for item in summary.get("rigid_items", ()):
        force, unit = display(item["side_force [N]"], "force", system)
        depth, length = display(item["md [m]"], "length", system)
        rows.append([f"Side force on {item['name']} at MD {depth:.6g} {length}", f"{force:.6g}", unit])
        couple, unit = display(item["side_couple [N m]"], "torque", system)
        rows.append([f"Couple on {item['name']} at MD {depth:.6g} {length}", f"{couple:.6g}", unit])
    return rows


def _final(final: Mapping[str, Any], system: System) -> list[list[str]]:
    rows = []
    for heading, value in final.items():
        q = quantity_of(split_name(heading)[0], "history.csv")
        if value is not None and (q is None or not q.numerics):
            rows.append(_cells(heading, value, "history.csv", system))
    return rows


def _fitted(summary: Mapping[str, Any]) -> list[list[str]]:
    """Fitted parameters with their intervals; a value that is not determined is not shown."""
    rows = []
    for name, found in summary.get("fit", {}).items():
        known = found.get("status") == "determined" and found.get("interval") is not None
        figures = [found["value"], *found["interval"]] if known else []
        cells = [f"{figure:.4g}" for figure in figures] or ["-", "-", "-"]
        rows.append([name.replace("_", " "), *cells, "" if known else str(found.get("status", ""))])
    return rows


def _flows(summary: Mapping[str, Any], system: System) -> Rows:
    flows = summary.get("flows", ())
    rows = []
    for q in COLUMNS["summary.json of hydraulics"]:
        values = [flow.get(q.name) for flow in flows]
        if not all(isinstance(value, int | float) or value is None for value in values):
            continue
        if any(value is not None for value in values):
            size, unit = shown_unit(q.name, q.unit, system)
            cells = ["" if value is None else f"{value / size:.5g}" for value in values]
            rows.append([q.label, *cells, unit])
    return ["", *("" for _ in flows), "unit"], rows


def _first_rows(table: Table, file: str, system: System) -> Rows:
    columns = [in_system(heading, values, system) for heading, values in table.items()]
    count = len(columns[0][1]) if columns else 0
    rows = [
        [f"{values[i]:.5g}" if values.dtype.kind == "f" else str(values[i]) for _, values in columns]
        for i in range(min(count, MOST_ROWS))
    ]
    if count > MOST_ROWS:
        rows.append([f"... {count} rows", *[""] * (len(columns) - 1)])
    return [heading for heading, _ in columns], rows


def warnings_of(summary: Mapping[str, Any]) -> list[str]:
    """Warnings and notes of a summary, and a status other than done, each once."""
    status = summary.get("status", "done")
    found = [] if status == "done" else [f"the run is not done: {status}"]
    for block in (summary, summary.get("statics", {}), *summary.get("flows", ()), *summary.get("surge", ())):
        if isinstance(block, Mapping):
            found += [str(text) for key in ("warnings", "notes") for text in block.get(key, ())]
    if summary.get("stable") is False and not any("friction" in text for text in found):
        found.append("the state is not stable")
    return list(dict.fromkeys(found))


def text_report(title: str, figures: Rows, warnings: list[str], folder: str) -> str:
    """The report as text."""
    heads, rows = figures
    lines = [title]
    table = [heads, *rows] if any(heads) else rows
    widths = [max((len(row[i]) for row in table), default=0) for i in range(len(heads))]
    lines += [
        "  " + "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in table
    ]
    return "\n".join([*lines, *(f"  note: {text}" for text in warnings), f"  results: {folder}"])


def html_report(title: str, figures: Rows, warnings: list[str], folder: str, picture: Any) -> str:
    """The report for a notebook, without JavaScript.

    picture: figure of matplotlib; None: no picture
    """
    heads, rows = figures
    parts = [f"<p><b>{html.escape(title)}</b></p>"]
    if rows:
        parts.append(html_table(heads, rows))
    if warnings:
        parts.append("<ul>" + "".join(f"<li>{html.escape(text)}</li>" for text in warnings) + "</ul>")
    if picture is not None:
        parts.append(_picture(picture))
    parts.append(f"<p>results: <code>{html.escape(folder)}</code></p>")
    return "<div>" + "".join(parts) + "</div>"


def _picture(drawing: Any) -> str:
    """A figure as SVG; as PNG if the SVG is large."""
    from drillpetsc.plotting.notebook import svg

    text = svg(drawing)
    if len(text) <= LARGEST_SVG:
        return text
    data = base64.b64encode(drawing._repr_png_()).decode()
    return f'<img style="max-width: 100%" alt="picture of the result" src="data:image/png;base64,{data}">'
