"""Rows of the catalogue to read: the command `drillpetsc catalogue` and the function of the same name."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from drillpetsc.case.catalogue.reference import (
    INTERCHANGE,
    SIZE_TOLERANCE,
    WEIGHT_TOLERANCE,
    ReferenceProblem,
    find_pipe,
    parse,
    same_connection,
)
from drillpetsc.case.catalogue.sizes import FT_LBF, KSI, LB_PER_FT, LBF, inch_text, size_at_start
from drillpetsc.case.catalogue.tables import TABLES, Catalogue, Row, units_of
from drillpetsc.case.html_table import html_table
from drillpetsc.errors import CaseError

TITLES = {
    "drill_pipe": "Drill pipe, tubes",
    "tool_joint": "Drill pipe, tool joints",
    "hwdp": "Heavy-wall drill pipe",
    "drill_collar": "Drill collars",
    "connection": "Threads of connections",
    "casing": "Casing",
    "grade": "Grades",
    "class": "Classes of used drill pipe",
}
#: unit of a table -> metric unit, factor
METRIC: dict[str, tuple[str, float]] = {
    "in": ("mm", 25.4),
    "lb/ft": ("kg/m", LB_PER_FT),
    "lbf": ("kN", LBF / 1e3),
    "ft-lbf": ("kN m", FT_LBF / 1e3),
    "lb": ("kg", 0.45359237),
    "ksi": ("MPa", KSI / 1e6),
}


UNVERIFIED = (
    "Rows marked NO hold figures that were not compared with their source. Compare them with the maker's data sheet, or give\n"
    "your own: od, id, tool_joint, adjusted_weight in the case, or a CSV file with the key catalogue."
)


class CatalogueRows(Sequence[Row]):
    """Rows that were found; printed as tables in field and metric units with their sources.

    A row is read like a mapping, in the units of the table: `rows[0]["size"]`.
    """

    def __init__(self, rows: Sequence[Row]) -> None:
        self._rows = tuple(rows)

    def __getitem__(self, index: Any) -> Any:
        return self._rows[index]

    def __len__(self) -> int:
        return len(self._rows)

    def tables(self) -> Iterator[tuple[str, list[str], list[list[str]]]]:
        """(title, names of the columns, cells of two lines a row: field units and source, then metric units)."""
        for table in TABLES:
            rows = [row for row in self._rows if row.table == table]
            if not rows:
                continue
            units = {column: unit for column, unit in units_of(table).items() if column != "source"}
            cells = []
            for row in rows:
                mark = "yes" if row.verified else "NO"
                cells.append([*(_field(row[c], unit) for c, unit in units.items()), mark, row.source])
                cells.append(
                    [*(_metric(row[c], unit) for c, unit in units.items()), "", f"{row.file} line {row.line}"]
                )
            yield TITLES[table], [*units, "verified", "source"], cells

    def __str__(self) -> str:
        if not self._rows:
            return "no row of the catalogue"
        blocks = []
        for title, columns, cells in self.tables():
            widths = [max(len(line[i]) for line in [columns, *cells]) for i in range(len(columns))]
            lines = [
                "  " + "  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip()
                for line in [columns, *cells]
            ]
            blocks.append("\n".join([title, *lines]))
        if not all(row.verified for row in self._rows):
            blocks.append(UNVERIFIED)
        return "\n\n".join(blocks)

    __repr__ = __str__

    def _repr_html_(self) -> str:
        """Tables for a notebook."""
        parts = [html_table(columns, cells, title) for title, columns, cells in self.tables()]
        return "".join(parts) or "<p>no row of the catalogue</p>"


def _field(value: Any, unit: str) -> str:
    if value is None:
        return "-"
    if not isinstance(value, float):
        return str(value)
    if unit == "in":
        return inch_text(value)
    return f"{value:,.0f} {unit}" if value >= 1000 else f"{value:.2f} {unit}".rstrip()


def _metric(value: Any, unit: str) -> str:
    if value is None or unit not in METRIC:
        return ""
    name, factor = METRIC[unit]
    return f"{value * factor:.4g} {name}"


def catalogue(text: str = "", path: str | Path | None = None) -> CatalogueRows:
    """Rows of the catalogue of tubulars that match a text; all rows for an empty text.

    text: a size (`5in`), a size and a weight, and words that a row must contain: `5in 19.50 S NC50`, `HWDP`,
    `drill_collar 8in`
    path: a folder with CSV files, or one CSV file, whose rows come before the built-in ones
    Raises CaseError if nothing matches.
    """
    whole = Catalogue.built_in()
    if path is not None:
        whole = whole.with_files(Path(path))
    found = _referred(whole, text)
    if not found:
        tests = _tests(text.strip())
        found = [row for row in whole if all(test(row) for test in tests)]
    if not found:
        sizes = sorted({row["size"] for row in whole.rows["drill_pipe"]})
        raise CaseError(
            at="catalogue",
            got=text,
            want="a text that rows fit, such as 5in, 5in 19.50, NC50, hwdp, 8 x 3 drill_collar",
            hint=f"sizes of drill pipe: {', '.join(inch_text(s).removesuffix(' in') for s in sizes)} in",
        )
    return CatalogueRows(found)


def _referred(whole: Catalogue, text: str) -> list[Row]:
    """Rows that a reference with words behind size and weight names: tube, tool joint, grade, class; else none."""
    try:
        reference = parse(whole, text)
        words = [w for w in (reference.grade, reference.upset, reference.connection, reference.wear) if w]
        if not words:
            return []
        choice = find_pipe(whole, reference, joint_needed=reference.grade is not None)
    except ReferenceProblem:
        return []
    joints = [choice.joint] if reference.grade is not None and choice.joint else []
    if reference.grade is None:  # of all grades
        joints = [
            row
            for row in choice.joints_nearby
            if (reference.upset in (None, row["upset"]))
            and (not reference.connection or same_connection(whole, reference.connection, row["connection"]))
        ]
    rows = [choice.tube, *joints]
    names = (("grade", reference.grade), ("class", reference.wear))
    return (
        rows + [row for table, word in names for row in whole.rows[table] if word and row[table] == word][:2]
    )


def _tests(text: str) -> list[Callable[[Row], bool]]:
    """Conditions that the words of a text put on a row."""
    tests: list[Callable[[Row], bool]] = []
    if old := next((name for name in INTERCHANGE if text.upper().replace("-", " ") == name), None):
        text = INTERCHANGE[old]
    words = text
    sized = size_at_start(text)
    if sized is not None and re.match(r"[\s,x]|$", sized[1]):
        size, words = sized
        tests.append(lambda row: _near(row["size"] or row["od"], size))
        match = re.match(r"\s*x\s*", words)  # 8 x 3: outer and inner diameter
        inner = size_at_start(words[match.end() :]) if match else None
        if inner is not None:
            bore, words = inner
            tests.append(lambda row: _near(row["id"], bore))
        match = re.match(r"\s*(\d+(?:\.\d+)?)\s*(?:#|lb/ft|ppf)?(?=\s|$)", words)
        if match:
            weight, words = float(match[1]), words[match.end() :]
            tests.append(lambda row: _has_weight(row, weight))
    tests += [partial(_has_word, word=word) for word in re.split(r"[\s,]+", words) if word]
    return tests


def _near(value: Any, size: float) -> bool:
    return isinstance(value, float) and abs(value - size) <= SIZE_TOLERANCE * value


def _has_weight(row: Row, weight: float) -> bool:
    columns = ("nominal", "weight")
    return any(row[c] is not None and abs(row[c] - weight) <= WEIGHT_TOLERANCE for c in columns)


def _has_word(row: Row, word: str) -> bool:
    """Whether a cell is the word, or the name of the table contains it; case and dashes do not count."""
    bare = re.sub(r"[\s_\-]", "", word).lower()
    cells = [str(value) for key, value in row.cells.items() if key != "source" and isinstance(value, str)]
    spelled = [re.sub(r"[\s_\-]", "", cell).lower() for cell in cells]
    if bare in spelled or bare in row.table.replace("_", ""):
        return True
    # E-75 is the grade E of a tool joint; a class or grade says nothing on a row without one
    return row.table in ("tool_joint",) and re.fullmatch(r"[a-z]\d+", bare) is not None and bare[0] in spelled
