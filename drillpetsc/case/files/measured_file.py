"""Measured hook loads and torques from a file: CSV and other text tables, xlsx, LAS.  Columns are found by aliases."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from drillpetsc.case.files.named_file import SHEETS, cells_of, is_comment, lines_of, named_file, text_of
from drillpetsc.case.importers.stations import MISSING, number_of, together
from drillpetsc.case.importers.table import comma_in_numbers, unit_text
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import BARE_NUMBERS, InSI
from drillpetsc.errors import CaseError
from drillpetsc.unit_systems import unit_of_bare_number
from drillpetsc.units import UnitError, to_si

OPERATIONS = ("trip_in", "trip_out", "rotate_off_bottom", "drilling", "sliding", "backreaming")
MAX_BYTES, MAX_POINTS, TITLE_LINES, MOST_ERRORS = 20_000_000, 2_000, 30, 10

_WORDS = {
    "trip_in": "tripin so slackoff slackingoff rih runin runningin runinhole lowering lower",
    "trip_out": "tripout pu pickup pickingup pooh pullout pullingout pulloutofhole hoisting hoist",
    "rotate_off_bottom": "rotateoffbottom rob rotatingoffbottom freerotating rotfree freerotation rotoffbottom",
    "drilling": "drilling drill onbottomrotating rotatingonbottom rotarydrilling rotary",
    "sliding": "sliding slide slidedrilling orienteddrilling",
    "backreaming": "backreaming backream",
}
_OPERATION = {alias: word for word, aliases in _WORDS.items() for alias in aliases.split()}

# column -> (SI unit, kind, aliases in small letters without blanks and _ . - #)
_COLUMNS: dict[str, tuple[str, str, str]] = {
    "bit_depth": (
        "m",
        "",
        "bitdepth dbtm depth md bitmd depthbit depthbitmd dept measureddepth bitmeasureddepth",
    ),
    "operation": ("", "", "operation op activity mode state rigactivity rigstate"),
    "hook_load": ("N", "", "hookload hkld hkla woh hkldav hookloadtotal weightonhook hl hookloadaverage"),
    "torque": ("N m", "", "torque tq stor surfacetorque tqa trq rotarytorque"),
    "wob": ("N", "", "wob weightonbit swob"),
    "tob": ("N m", "", "tob torqueonbit bittorque"),
    "rpm": ("rad/s", "", "rpm rotation surfacerpm rpma srpm"),
    "speed": ("m/s", "trip_speed", "blockspeed speed tripspeed bvel"),
    "flow_rate": ("m^3/s", "", "flow flowrate flowin pumprate mudflow mudflowin tflo mfia flwi"),
    "sigma": ("N", "", "sigma standarderror stderror uncertainty"),
}
_NAMES = {alias: column for column, (_, _, aliases) in _COLUMNS.items() for alias in aliases.split()}
_EXAMPLE = "bit depth [ft], operation, hook load [klbf], torque [kft-lbf]"
_BRACKETS = re.compile(r"[\[({]\s*([^\])}]*?)\s*[\])}]")


def _short(text: str) -> str:
    return re.sub(r"[\s_.#\-\"']", "", text).casefold()


def operation_word(text: str) -> str | None:
    """The operation that a word of the rig means; None for a word that means none."""
    return _OPERATION.get(_short(text.replace("/", "")))


@dataclass(frozen=True)
class Reading:
    """One measured point, SI, with the keys of `MeasuredPoint`."""

    values: dict[str, Any]

    def as_dict(self) -> dict[str, Any]:
        """Keys of a point in a case, numbers marked as SI."""
        return {key: v if isinstance(v, str) else InSI(v) for key, v in self.values.items()}


def read_measured(name: str) -> tuple[list[Reading], list[str]]:
    """(points, remarks) of a file beside the case file or in the working directory.

    name: of the file, or `points.xlsx#Sheet2`.
    Raises CaseError for bad cells, at most ten at once.
    """
    path, sheet = named_file(name, "a file of measured points that exists: CSV, xlsx or LAS")
    remarks: list[str] = []
    try:
        kind, mark = path.suffix.casefold(), ","
        if kind in SHEETS:
            rows = _sheet_rows(path, sheet)
        elif kind == ".las":
            rows = _las_rows(path)
        else:
            rows, mark = _text_rows(path)
    except OSError as error:
        raise refuse(got=name, want="a file of measured points that can be read", hint=str(error)) from None
    return _points(path, rows, mark, remarks), remarks


# ---------------------------------------------------------------------- rows of texts
Rows = list[tuple[int, list[str]]]


def _text_rows(path: Path) -> tuple[Rows, str]:
    """((line number, cells) of a text table, without comments and empty lines; what separates the cells)."""
    text, _ = text_of(path, MAX_BYTES)
    lines = [(i, q) for i, q in enumerate(lines_of(text), 1) if q.strip() and not is_comment(q)]
    head = next((line for _, line in lines[:TITLE_LINES] if _named(re.split(r"[,;\t]", line))), "")
    mark = next((m for m in ("\t", ";", ",") if m in head), ",")
    return [(i, cells_of(line, mark, path, i)) for i, line in lines], mark


def _sheet_rows(path: Path, sheet: str) -> Rows:
    from drillpetsc.case.importers.sheet import sheets_of

    sheets = sheets_of(path, sheet, 1).values()
    return [(i, row) for rows in sheets for i, row in enumerate(rows, 1) if any(row)]


def _las_rows(path: Path) -> Rows:
    """Header, units and rows of a LAS file; its numbers are counted from the first row of the data."""
    from drillpetsc.case.importers.las import cell_of, curves_of

    curves = curves_of(path)
    heads = [
        f"{name} [{_LAS_UNITS.get(unit.casefold(), unit)}]" if unit else name for name, unit, _ in curves
    ]
    count = min((len(data) for _, _, data in curves), default=0)
    return [(0, heads), *((k + 1, [cell_of(data[k]) for _, _, data in curves]) for k in range(count))]


_LAS_UNITS = {"f": "ft", "m": "m", "1000 lbf": "klbf", "rev/min": "rpm"}


# ---------------------------------------------------------------------- points
def _named(heads: Sequence[str]) -> dict[str, tuple[int, str]] | None:
    """column -> (index, unit text or ""); None unless bit depth, operation and a reading are named."""
    found: dict[str, tuple[int, str]] = {}
    for i, title in enumerate(heads):
        if len(title) > 80:
            continue
        units = _BRACKETS.findall(title)
        column = _NAMES.get(_short(_BRACKETS.sub("", title)))
        if column is not None and column not in found:
            found[column] = i, units[0] if units else ""
    if {"bit_depth", "operation"} <= set(found) and ("hook_load" in found or "torque" in found):
        return found
    return None


def _points(path: Path, rows: Rows, mark: str, remarks: list[str]) -> list[Reading]:
    at = next((i for i, (_, heads) in enumerate(rows[:TITLE_LINES]) if _named(heads)), None)
    if at is None:
        line = rows[0][0] if rows else 1
        known = sorted(
            {
                column
                for _, heads in rows[:TITLE_LINES]
                for t in heads[:50]
                if (column := _NAMES.get(_short(_BRACKETS.sub("", t[:80]))))
            }
        )
        got = f"only {', '.join(known)}" if known else "lines without these names"
        want = f"a header with bit depth, operation, and hook load or torque, such as {_EXAMPLE}"
        raise CaseError(at="bit_depth", got=got, want=want, file=path, line=line)
    head_line, heads = rows[at]
    columns = _named(heads) or {}
    data = rows[at + 1 :]
    below = _units_below(data[0][1], columns) if data else None
    if below is not None:
        columns, data = below, data[1:]
    units = _units(path, head_line, heads, columns, remarks)
    numbers = [i for column, (i, _) in columns.items() if column != "operation"]
    comma = comma_in_numbers(path, data, numbers, mark) or "thousands"
    readings: list[Reading] = []
    errors: list[CaseError] = []
    for line, cells in data:
        try:
            readings.append(_reading(path, line, cells, comma, columns, units))
        except CaseError as error:
            errors.append(error)
            if len(errors) >= MOST_ERRORS:
                break
    if errors:
        raise together(errors)
    if not readings:
        raise CaseError(file=path, line=head_line, got="no rows", want="at least one measured point")
    if len(readings) > MAX_POINTS:
        raise CaseError(file=path, line=head_line, got="more", want=f"at most {MAX_POINTS} points")
    return readings


def _units_below(
    cells: Sequence[str], columns: dict[str, tuple[int, str]]
) -> dict[str, tuple[int, str]] | None:
    """Columns with the units of a second header line; None if the line holds a number or no unit."""
    out, seen = dict(columns), False
    for column, (i, unit) in columns.items():
        text = cells[i].strip("[](){} ") if i < len(cells) else ""
        if column == "operation":
            if operation_word(text):
                return None
            continue
        if not text or text == "-":
            continue
        if number_of(text, "thousands") is not None:
            return None
        out[column], seen = (i, unit or text), True
    return out if seen else None


def _units(
    path: Path, line: int, heads: Sequence[str], columns: dict[str, tuple[int, str]], remarks: list[str]
) -> dict[str, str]:
    """Unit text of each column: as given, otherwise from the case's units."""
    units: dict[str, str] = {}
    system = BARE_NUMBERS.get()
    assumed: list[str] = []
    for column, (i, unit) in columns.items():
        si, kind, _ = _COLUMNS[column]
        if not si:
            continue
        if not unit:
            unit = "rpm" if column == "rpm" else unit_of_bare_number(si, kind, system) or si
            assumed.append(f"{column} in {unit}")
        unit = unit_text(unit)
        try:
            to_si(f"1 {unit}", si)
        except UnitError as error:
            raise CaseError(
                at=column, got=heads[i], want=error.want, hint=error.hint, file=path, line=line
            ) from None
        units[column] = unit
    if assumed:
        remarks.append(f"columns without a unit: {', '.join(assumed)} taken")
    return units


def _reading(
    path: Path, line: int, cells: Sequence[str], comma: str,
    columns: dict[str, tuple[int, str]], units: dict[str, str],
) -> Reading:  # fmt: skip
    values: dict[str, Any] = {}
    for column, (i, _) in columns.items():
        text = cells[i].strip() if i < len(cells) else ""
        if column == "operation":
            word = operation_word(text)
            if word is None:
                want = f"one of {', '.join(OPERATIONS)}, or a word such as PU, SO, ROB, RIH, POOH"
                raise CaseError(at="operation", got=text or "an empty cell", want=want, file=path, line=line)
            values["operation"] = word
            continue
        number = number_of(text, comma) if text else None
        if not text or number in MISSING:
            if column == "bit_depth":
                raise CaseError(
                    at=column, got="an empty cell", want="a depth of the bit", file=path, line=line
                )
            continue
        if number is None or not math.isfinite(number):
            want = f"a number in {units[column]}" if column in units else "a number"
            raise CaseError(at=column, got=text, want=want, file=path, line=line)
        values[column] = to_si(f"{number!r} {units[column]}", _COLUMNS[column][0])
    if "hook_load" not in values and "torque" not in values:
        raise CaseError(
            at="hook_load", got="an empty cell", want="a hook load or a torque", file=path, line=line
        )
    return Reading(values)
