"""Tables of the catalogue: CSV files with units in the header, one source a row; read and checked cell by cell."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

from drillpetsc.case.catalogue import formulas
from drillpetsc.case.catalogue.sizes import inches
from drillpetsc.case.files.named_file import bytes_of
from drillpetsc.errors import CaseError

FOLDER = Path(__file__).parent
MAX_BYTES = 5_000_000  # of a table
CONSISTENT = 0.02  # allowed relative difference between a weight and the weight computed from the dimensions

#: columns that each row of a table needs; the others may be empty or left out, and are computed if possible
TABLES = {
    "drill_pipe": ("size", "nominal"),
    "tool_joint": ("size", "nominal", "grade", "connection", "od", "id", "length"),
    "connection": tuple(
        "connection taper threads thread_height root pitch_diameter pin_length counterbore".split()
    ),
    "hwdp": tuple("size id connection tool_joint_od tool_joint_id tool_joint_length weight".split()),
    "drill_collar": ("od", "id"),
    "casing": ("size", "nominal"),
    "grade": ("grade", "kind", "yield"),
    "class": ("class", "wall"),
}
#: columns without a unit that hold numbers
NUMBERS = {("class", "wall")}
#: columns that may be 0
MAY_BE_ZERO = {"upset_weight", "center_upset_length"}

_HEAD = re.compile(r"\s*([A-Za-z_0-9]+)\s*(?:\[([^\]]*)\])?\s*")


@dataclass(frozen=True)
class Row:
    """One row of a table.

    table: its name; file, line: its location; cells: column -> number in the unit of the table, or text.
    """

    table: str
    file: str
    line: int
    cells: Mapping[str, Any] = field(hash=False)

    def __getitem__(self, column: str) -> Any:
        return self.cells.get(column)

    @property
    def verified(self) -> bool:
        """Whether the figures were seen in a copy of their source, or follow from others by a formula."""
        return "unverified" not in self.source

    @property
    def place(self) -> str:
        """`catalogue drill_pipe.csv line 16`, for a list of sources; says so if the row is not verified."""
        return f"catalogue {self.file} line {self.line}{'' if self.verified else ' (unverified)'}"

    @property
    def source(self) -> str:
        """Source that the row names."""
        return str(self.cells.get("source") or "")


@dataclass(frozen=True)
class Catalogue:
    """Rows of all tables, the user's files first."""

    rows: Mapping[str, tuple[Row, ...]]

    @classmethod
    @lru_cache(maxsize=1)
    def built_in(cls) -> Catalogue:
        """The tables of the package."""
        return cls({name: read_table(FOLDER / f"{name}.csv", name) for name in TABLES})

    def with_files(self, path: Path) -> Catalogue:
        """The catalogue with the rows of a user's folder, or of one CSV file, before the built-in ones.

        A file is named after the table that it extends: drill_pipe.csv, or drill_pipe-rig-7.csv.
        """
        rows = dict(self.rows)
        for file in _user_files(path):
            name = _table_of(file)
            rows[name] = read_table(file, name) + rows[name]
        return Catalogue(rows)

    def __iter__(self) -> Iterator[Row]:
        for table in self.rows.values():
            yield from table

    def wall_fraction(self, word: str) -> float:
        """Fraction of the wall that is left in a class."""
        return float(next(row["wall"] for row in self.rows["class"] if row["class"] == word))


def _user_files(path: Path) -> list[Path]:
    if not path.is_dir():
        return [path]
    files = sorted(file for file in path.glob("*.csv"))
    if not files:
        raise CaseError(
            at="catalogue",
            got=str(path),
            want=f"a folder with CSV files named {', '.join(f'{name}.csv' for name in TABLES)}",
        )
    return files


def _table_of(file: Path) -> str:
    """Name of the table that a user's file adds to."""
    stem = file.stem.lower()
    for name in sorted(TABLES, key=len, reverse=True):
        if stem == name or re.match(rf"{name}[^a-z]", stem):
            return name
    raise CaseError(
        at="catalogue",
        got=file.name,
        want=f"a file named like the table that it adds to: {', '.join(f'{name}.csv' for name in TABLES)}",
    )


def read_table(path: Path, name: str) -> tuple[Row, ...]:
    """Rows of a CSV file; raises CaseError with file, line and column if a cell cannot be right."""
    try:
        text = bytes_of(path, MAX_BYTES).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise CaseError(file=path, want="a CSV text file in UTF-8") from None
    except OSError as error:
        raise CaseError(
            at="catalogue", got=str(path), want=f"a file that can be read ({error.strerror})"
        ) from None
    lines = _lines(text)
    if not lines:
        raise CaseError(file=path, line=1, want=f"a header such as: {_header_of(name)}")
    columns = _columns(path, name, *lines[0])
    return tuple(_row(path, name, columns, i, line) for i, line in lines[1:])


def _lines(text: str) -> list[tuple[int, str]]:
    """Lines that are not empty and no comments, with their numbers."""
    return [
        (i, line)
        for i, line in enumerate(text.splitlines(), 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]


@cache
def units_of(name: str) -> dict[str, str]:
    """Unit of each column of a table, "" of texts: the header of the package's own table."""
    file = FOLDER / f"{name}.csv"
    titles = _cells(file, *_lines(file.read_text(encoding="utf-8"))[0])
    return {match[1]: match[2] or "" for match in map(_HEAD.fullmatch, titles) if match}


def _header_of(name: str) -> str:
    return ", ".join(column + (f" [{unit}]" if unit else "") for column, unit in units_of(name).items())


def _cells(path: Path, line: int, text: str) -> list[str]:
    try:
        return [cell.strip() for cell in next(csv.reader([text]))]
    except csv.Error as error:
        raise CaseError(
            got=text, want="cells between commas", hint=str(error), file=path, line=line
        ) from None


def _columns(path: Path, name: str, line: int, text: str) -> list[str]:
    """Names of the columns, from the header."""
    known = units_of(name)
    columns: list[str] = []
    for title in _cells(path, line, text):
        match = _HEAD.fullmatch(title)
        column = match[1].lower() if match else title
        if match is None or column not in known or column in columns:
            want = f"each column once, of: {_header_of(name)}"
            raise CaseError(at=column, got=text, want=want, file=path, line=line, longest=200)
        if match[2] is not None and match[2].replace(" ", "") != known[column]:
            want = f"{column} [{known[column]}]" if known[column] else f"{column} without a unit"
            raise CaseError(
                at=column, got=title, want=want, hint="tables are in field units", file=path, line=line
            )
        columns.append(column)
    missing = [c for c in TABLES[name] if c not in columns]
    if missing:
        raise CaseError(
            at=missing[0],
            got=text,
            want=f"a column {missing[0]}: {_header_of(name)}",
            file=path,
            line=line,
            longest=200,
        )
    return columns


def _row(path: Path, name: str, columns: list[str], line: int, text: str) -> Row:
    given = _cells(path, line, text)
    if len(given) != len(columns):
        raise CaseError(
            got=text, want=f"{len(columns)} cells, as the header has", file=path, line=line, longest=200
        )
    cells: dict[str, Any] = {}
    units = units_of(name)
    for column, cell in zip(columns, given, strict=True):
        if not cell:
            if column not in TABLES[name]:
                continue
            raise CaseError(at=column, got="an empty cell", want="a value", file=path, line=line)
        is_number = bool(units[column]) or (name, column) in NUMBERS
        cells[column] = _number(path, line, column, units[column], cell) if is_number else cell
    if "source" not in cells:
        cells["source"] = f"{path.name}, no source given"
    row = Row(name, path.name, line, cells)
    _complete(path, row, cells)
    return row


def _number(path: Path, line: int, column: str, unit: str, cell: str) -> float:
    if unit == "in":
        value = inches(cell)
    else:
        try:
            value = float(cell) if "_" not in cell else None
        except ValueError:
            value = None
    least = column in MAY_BE_ZERO
    if value is None or not math.isfinite(value) or value < 0 or (value == 0 and not least):
        want = f"a number {'of at least 0' if least else 'above 0'}" + (f" in {unit}" if unit else "")
        raise CaseError(at=column, got=cell, want=want, file=path, line=line)
    return value


def _complete(path: Path, row: Row, cells: dict[str, Any]) -> None:
    """Compute the cells that follow from others, and refuse figures that contradict each other."""

    def refuse(column: str, want: str, hint: str = "") -> CaseError:
        return CaseError(at=column, got=cells.get(column), want=want, hint=hint, file=path, line=row.line)

    def agree(column: str, computed: float) -> None:
        if column not in cells:
            cells[column] = round(computed, 4)
        elif abs(cells[column] - computed) > CONSISTENT * computed:
            raise refuse(column, f"{computed:.4g}, from the dimensions of the row, within {CONSISTENT:.0%}")

    if row.table in ("drill_pipe", "casing"):
        outer = cells["size"]
        if "id" not in cells and "wall" not in cells:
            raise refuse("id", "an inner diameter or a wall")
        cells.setdefault("id", round(outer - 2 * cells.get("wall", 0.0), 4))
        agree("wall", (outer - cells["id"]) / 2)
        if cells["id"] >= outer or cells["wall"] >= outer / 2:
            raise refuse("id", f"an inner diameter below the outer, {outer:g} in")
    if row.table == "drill_pipe":
        agree("plain_end", formulas.plain_end_weight(cells["size"], cells["id"]))
    if row.table == "tool_joint":
        if cells["id"] >= cells["od"]:
            raise refuse("id", f"an inner diameter below the outer, {cells['od']:g} in")
        if cells["od"] < cells["size"]:
            raise refuse("od", f"at least the size of the pipe, {cells['size']:g} in")
    if row.table == "hwdp":
        if cells["id"] >= cells["size"]:
            raise refuse("id", f"an inner diameter below the outer, {cells['size']:g} in")
        agree("tube", formulas.plain_end_weight(cells["size"], cells["id"]))
        if cells["tool_joint_id"] >= cells["tool_joint_od"]:
            raise refuse("tool_joint_id", "an inner diameter below the outer one")
        if cells["weight"] < cells["tube"]:
            raise refuse("weight", f"at least the weight of the plain tube, {cells['tube']:.4g} lb/ft")
    if row.table == "drill_collar":
        if cells["id"] >= cells["od"]:
            raise refuse("id", f"an inner diameter below the outer, {cells['od']:g} in")
        agree("weight", formulas.plain_end_weight(cells["od"], cells["id"]))
    if row.table == "connection" and not cells["pitch_diameter"] < cells["counterbore"]:
        raise refuse("pitch_diameter", f"less than the counterbore, {cells['counterbore']:g} in")
    if row.table == "class" and not 0 < cells["wall"] <= 1:
        raise refuse("wall", "a fraction of the wall, above 0 and at most 1")
