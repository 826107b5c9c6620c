"""Parts of a report as plain data: sections, tables, pictures. The template turns them into HTML."""

from __future__ import annotations

import base64
import contextlib
import contextvars
import io
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.errors import CaseError
from drillpetsc.output.files.tables import csv_text, read_table
from drillpetsc.output.shown_units import lengths_shown
from drillpetsc.reporting.units import heading_of, in_units, label_of, texts, unit_of
from drillpetsc.unit_systems import System

WHOLE = 40  # rows of a table up to which it is shown unfolded
SHOWN = 120  # rows of a longer table that are shown
MOST_CSV = 200_000  # bytes of a table that goes along as CSV
MIXED = "[N or N m]"  # unit of columns with forces and torques; the column COMPARED says which
COMPARED, TRIP_SPEED, LIMITED_BY = "compared [-]", "max_trip_speed [m/s]", "limited_by [-]"
MOST_SVG = 180_000  # bytes of a picture above which it is embedded as PNG
MOST_POINTS = 8_000  # points of lines above which SVG is not tried


@dataclass(frozen=True)
class Picture:
    """A picture in the file: data URI, words for those who do not see it, and the files it is drawn from.

    plot: the same curves as JSON of a figure of plotly, empty if the picture does not zoom.
    """

    uri: str
    words: str
    source: str
    plot: str = ""


@dataclass(frozen=True)
class Grid:
    """A table of texts.

    heads: of the columns; rows: of texts; numeric: columns set flush right; caption; source: file with the figures;
    folded: shown after a click; csv: data URI of the whole table in SI, may be empty; note: what is left out.
    """

    heads: Sequence[str]
    rows: Sequence[Sequence[str]]
    caption: str = ""
    source: str = ""
    folded: bool = False
    csv: str = ""
    csv_name: str = ""
    numeric: Sequence[bool] = ()
    note: str = ""


@dataclass
class Section:
    """A section of a report; `missing` says why it is empty."""

    key: str
    title: str
    text: list[str] = field(default_factory=list)
    grids: list[Grid] = field(default_factory=list)
    pictures: list[Picture] = field(default_factory=list)
    verbatim: list[tuple[str, str]] = field(default_factory=list)
    """(heading, text) shown as they are, folded."""
    missing: str = ""

    @property
    def anchor(self) -> str:
        """Target of links within the page."""
        return "".join(c if c.isalnum() else "-" for c in f"{self.key}-{self.title}".lower())


def data_uri(kind: str, content: bytes) -> str:
    """Bytes of a media type as a text that a page can hold."""
    return f"data:{kind};base64,{base64.b64encode(content).decode('ascii')}"


_zooms: contextvars.ContextVar[bool] = contextvars.ContextVar("pictures that zoom", default=False)


@contextlib.contextmanager
def pictures_that_zoom(wanted: bool) -> Iterator[None]:
    """Within this context `picture` adds a figure of plotly, if ``wanted``.

    Raises CaseError if plotly is missing.
    """
    if wanted:
        from drillpetsc.plotting.interactive import plotly_script

        plotly_script()
    token = _zooms.set(wanted)
    try:
        yield
    finally:
        _zooms.reset(token)


def picture(drawing: Any, words: str, source: str) -> Picture:
    """A figure as SVG, or as PNG if that is smaller. Equal figures give equal bytes.

    drawing: figure of matplotlib; call it within `plotting.style.look()`
    """
    uri = _image(drawing)
    if not _zooms.get():
        return Picture(uri, words, source)
    from drillpetsc.plotting.interactive import plotly_figure

    try:
        plot = plotly_figure(drawing).to_json()
    except CaseError:  # a picture with surfaces, which matplotlib alone draws
        plot = ""
    return Picture(uri, words, source, plot.replace("<", "\\u003c"))  # no text of a case ends the script


def _image(drawing: Any) -> str:
    """Data URI of a figure."""
    import matplotlib as mpl

    with mpl.rc_context({"svg.hashsalt": "drillpetsc"}):  # else identifiers are random
        out = io.BytesIO()
        if sum(len(line.get_xdata()) for axes in drawing.axes for line in axes.lines) <= MOST_POINTS:
            drawing.savefig(out, format="svg", metadata={"Date": None, "Creator": None})
            if out.tell() <= MOST_SVG:
                return data_uri("image/svg+xml", out.getvalue())
        out = io.BytesIO()
        drawing.savefig(out, format="png", metadata={"Software": None})
    return data_uri("image/png", out.getvalue())


def facts(rows: Sequence[tuple[str, str, str]], caption: str = "", source: str = "") -> Grid:
    """A table of (quantity, value, unit)."""
    return Grid(("Quantity", "Value", "Unit"), rows, caption, source, numeric=(False, True, False))


def grid_of(
    table: Mapping[str, np.ndarray],
    system: System,
    caption: str,
    source: str,
    columns: Sequence[str] = (),
    csv_bytes: bytes = b"",
    csv_name: str = "",
    folded: bool | None = None,
) -> Grid:
    """A table `name [unit]` -> (n,) in the units of a system. Of more than SHOWN rows, evenly spaced ones are shown, and the rows of
    the deepest bit.

    columns: names to be shown; by default all that have a value
    csv_bytes: the whole table as it goes along, in SI; by default made from the table
    folded: by default, tables of more than WHOLE rows
    """
    titles = [t for t in table if not columns or t.partition(" [")[0] in columns]
    titles = [t for t in titles if table[t].dtype.kind != "f" or np.isfinite(table[t]).any()]
    count, kept = len(next(iter(table.values()), ())), _kept_rows(table)
    shown = [_cells(table, title, kept, system) for title in titles]
    notes = []
    if len(kept) < count:
        notes.append(f"{len(kept)} of {count} rows")
    if len(titles) < len(table):
        notes.append(f"{len(titles)} of {len(table)} columns")
    content = csv_bytes or csv_of(table)
    small = len(content) <= MOST_CSV
    if not small:
        notes.append(f"the whole table is in {source}" if source else "too large to include as CSV")
    return Grid(
        [label_of(title, system) if title.endswith(MIXED) else heading_of(title, system) for title in titles],
        list(zip(*shown, strict=True)),
        caption,
        source,
        count > WHOLE if folded is None else folded,
        data_uri("text/csv", content) if small else "",
        csv_name or Path(source.split(":")[-1]).name or "table.csv",
        [table[title].dtype.kind == "f" for title in titles],
        "; ".join(notes),
    )


def _kept_rows(table: Mapping[str, np.ndarray]) -> np.ndarray:
    """Numbers of the rows that are shown."""
    count = len(next(iter(table.values()), ()))
    if count <= SHOWN:
        return np.arange(count)
    kept, depth = np.linspace(0, count - 1, SHOWN).round().astype(int), table.get("bit_depth [m]")
    if depth is None:
        return np.unique(kept)
    deepest = np.flatnonzero(
        depth >= np.nanmax(depth) - 1e-6
    )  # a curve an operation: each with its deepest row
    return np.unique(np.concatenate([kept, deepest[:SHOWN]]))


def _cells(table: Mapping[str, np.ndarray], title: str, kept: np.ndarray, system: System) -> list[str]:
    """Texts of the ``kept`` rows of a column."""
    values = table[title][kept]
    if title.endswith(MIXED) and COMPARED in table:
        return _mixed(values, table[COMPARED][kept], system)
    if values.dtype.kind != "f":
        return [lengths_shown(str(value), system) for value in values]
    cells = list(texts(in_units(title, values, system)))
    if title == TRIP_SPEED and LIMITED_BY in table:  # limits above the fastest speed tried
        free = np.isin(table[LIMITED_BY][kept].astype(str), ("none", "-"))
        cells = [f"> {q}" if f else q for q, f in zip(cells, free, strict=True)]
    return cells


def _mixed(values: np.ndarray, names: np.ndarray, system: System) -> list[str]:
    """Numbers (n,) with their units, of columns that hold forces and torques, by the name of the reading of each row."""
    out = []
    for value, name in zip(values, names, strict=True):
        title = f"{name} [N m]" if "torque" in str(name) else f"{name} [N]"
        unit = unit_of(title, system)[2]
        number = float(in_units(title, value, system))
        text = f"{number:.0f}" if abs(number) >= 1000 else f"{number:.4g}"
        out.append(f"{text} {unit}" if np.isfinite(value) else "-")
    return out


def csv_of(table: Mapping[str, np.ndarray]) -> bytes:
    """A table as CSV in SI."""
    return csv_text(table, zip(*(values.tolist() for values in table.values()), strict=True)).encode()


def file_grid(
    file: Path, system: System, caption: str, source: str, columns: Sequence[str] = ()
) -> Grid | None:
    """A table of a run folder; None if it has no rows."""
    table = read_table(file)
    if not table or not len(next(iter(table.values()))):
        return None
    return grid_of(table, system, caption, source, columns, file.read_bytes(), file.name)


def drawn_title(title: str) -> str:
    """A title short enough for a heading."""
    return textwrap.shorten(title, 160, placeholder=" ...") if title.strip() else "case"
