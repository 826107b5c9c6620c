"""A tally or string sheet: a table in CSV or xlsx with diameters, lengths and weights, as items of a string."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from drillpetsc.case.importers.components import Component, Kind, items_of
from drillpetsc.case.importers.stations import number_of, together
from drillpetsc.case.importers.table import _cells, _is_comment, _lines, comma_in_numbers, unit_text
from drillpetsc.case.importers.witsml import Imported
from drillpetsc.errors import CaseError
from drillpetsc.units import UnitError, bare_number, to_si

HEADER_LINES = 40
#: column -> names in small letters without blanks and marks, first the best
NAMES = {
    "length": "length len totallength itemlength".split(),
    "od": "od outerdiameter outsidediameter odbody bodyod".split(),
    "bore": "id innerdiameter insidediameter bore idbody bodyid".split(),
    "weight": "weightinair weight wt linearweight unitweight weightperlength adjustedweight approximateweight".split(),
    "blade": "bladeod gaugeod oddblade maxod".split(),
    "name": "description component item name type kind tool element".split(),
    "order": "frombit orderfrombottom frombottom".split(),
    "string": "assembly bha run string".split(),
}
UNIT = {"length": "m", "od": "m", "bore": "m", "weight": "kg/m", "blade": "m"}
NEEDED = ("length", "od")
_UNITS = {
    "lbft": "lb/ft",
    "lbsft": "lb/ft",
    "lbfft": "lb/ft",
    "kgm": "kg/m",
    "nm": "N/m",
    "knm": "kN/m",
    "inch": "in",
}
#: a row that begins with an error of a spreadsheet is not a comment
_SPOILT = re.compile(r"\s*#(?:REF|N/A|VALUE|DIV/0|NAME|NUM|NULL)")
#: kind of an item -> the words of a sheet for it; the first that fits
KINDS: tuple[tuple[Kind, str], ...] = (
    ("other", r"\b(?:sub|motor|mwd|lwd|jars?|xo|x.?over|cross.?over|box|stab\w*|reamer)\b"),
    ("hwdp", r"\bhwdp\b|\bhw\b|heavy.?(?:wall|weight)|hevi"),
    ("bit", r"\bbit\b"),
    ("drill_collar", r"\bcollars?\b|\b(?:nm)?dc\d*\b|\bnmdc\b"),
    ("drill_pipe", r"\bdrill ?pipe\b|\bdp\b"),
)


@dataclass(frozen=True)
class _Sheet:
    """A table: number of its header, columns (quantity -> index, unit), rows with their numbers, titles not read.

    separator: between cells, "" in a workbook; comma: what one in a number means.
    """

    file: Path
    head_at: int
    columns: dict[str, tuple[int, str]]
    rows: list[tuple[int, list[str]]]
    unread: list[str]
    separator: str
    comma: str = ""


def _column(title: str) -> tuple[str, int, str] | None:
    """(quantity, rank of its name, unit or "") of a title such as `OD [in]`, `length_m`, `weight_in_air_N_per_m`."""
    inside = re.search(r"[\[({]\s*(.*?)\s*[\])}]", title)
    words = [q for q in re.split(r"[\s_.,/#-]+", re.sub(r"[\[({].*", "", title).casefold()) if q]
    written = re.split(r"[\s_,]+", re.sub(r"[\[({].*", "", title).strip())
    for count in range(len(words), 0, -1):
        name = "".join(words[:count])
        for quantity, names in NAMES.items():
            if name in names:
                unit = inside.group(1) if inside else " ".join(written[count:])
                return quantity, names.index(name), unit
    return None


def _unit(text: str, quantity: str) -> str | None:
    """The unit of a title as `to_si` reads it, "" without one; None for a text that is not a unit of the quantity."""
    text = text.strip().replace(" per ", "/").replace(" ", "/") if text else ""
    text = _UNITS.get(text.replace("/", "").casefold(), unit_text(text))
    if not text or quantity not in UNIT:
        return ""
    try:
        to_si(f"1 {text}", UNIT[quantity])
    except UnitError:
        return None
    return text


def _columns(heads: Sequence[str]) -> tuple[dict[str, tuple[int, str]], list[str]] | None:
    """(columns, titles that are not read) of a header; None if it is not the header of a tally."""
    found: dict[str, list[tuple[int, int, str]]] = {}
    for i, title in enumerate(heads):
        column = _column(title) if 0 < len(title) <= 80 else None
        unit = _unit(column[2], column[0]) if column else None
        if column and unit is not None:
            found.setdefault(column[0], []).append((column[1], i, unit))
    if not all(quantity in found for quantity in NEEDED):
        return None
    columns = {quantity: (i, unit) for quantity, several in found.items() for _, i, unit in [min(several)]}
    read = {i for i, _ in columns.values()}
    return columns, [title for i, title in enumerate(heads) if i not in read and title.strip()]


def _sheet(file: Path) -> _Sheet | None:
    """The first table of a tally in a file; None if there is none."""
    if file.suffix.casefold() in (".xlsx", ".xlsm"):
        from drillpetsc.case.importers.sheet import sheets_of

        tables = [("", [(i, row) for i, row in enumerate(rows, 1)]) for rows in sheets_of(file).values()]
    else:
        lines = _lines(file, [])
        lines = ["" if _is_comment(line, ";") and not _SPOILT.match(line) else line for line in lines]
        tables = [
            (mark, [(i, _cells(line, mark, file, i)) for i, line in enumerate(lines, 1) if line.strip()])
            for mark in ("\t", ";", ",")
        ]
    for mark, rows in tables:
        for k, (number, heads) in enumerate(rows[:HEADER_LINES]):
            found = _columns(heads)
            if found is not None:
                below = [(i, row) for i, row in rows[k + 1 :] if any(cell.strip() for cell in row)]
                return _Sheet(file, number, found[0], below, found[1], mark)
    return None


def is_tally(file: Path) -> bool:
    """Whether a text file or workbook has the columns of a tally: name, length and outer diameter."""
    return file.suffix.casefold() not in (".xml", ".las") and _sheet(file) is not None


def import_tally(file: Path, assembly: str | None) -> Imported:
    """The string of a tally, from the rig down.

    assembly: name of the string in a sheet with several
    Raises CaseError for bad cells (ten at once), for several strings, and for a sheet whose order is not known.
    """
    sheet = _sheet(file)
    assert sheet is not None
    out = Imported()
    if not sheet.rows:
        raise CaseError(got="no rows", want="a row for each item", file=file, line=sheet.head_at)
    for quantity, unit in UNIT.items():
        if quantity in sheet.columns and not sheet.columns[quantity][1]:
            want = f"a unit in the title, such as {quantity if quantity != 'bore' else 'id'} [{unit}]"
            at = "id" if quantity == "bore" else quantity
            raise CaseError(at=at, got="no unit", want=want, file=file, line=sheet.head_at)
    numbers = [sheet.columns[quantity][0] for quantity in UNIT if quantity in sheet.columns]
    sheet = replace(sheet, comma=comma_in_numbers(sheet.file, sheet.rows, numbers, sheet.separator))
    sheet = _with_names(sheet, out.remarks)
    rows = _of_one_string(sheet, assembly)
    components, errors = [], []
    for number, cells in rows:
        try:
            components.append(_component(sheet, number, cells))
        except CaseError as error:
            errors.append(error)
    if errors:
        raise together(errors[:10])
    out.string = items_of(_from_the_top(sheet, rows, components, out.remarks), out.remarks)
    without = [
        component.name for component in components if component.weight is None and component.kind != "bit"
    ]
    if without:
        out.remarks.append(f"no weight in the sheet: steel of their size taken for {', '.join(without)}")
    if sheet.unread:
        out.remarks.append(f"columns not read: {', '.join(sheet.unread)}")
    return out


def _with_names(sheet: _Sheet, remarks: list[str]) -> _Sheet:
    """The sheet with a column of names: the only one of texts, if no title says so."""
    if "name" in sheet.columns:
        return sheet
    used = {i for i, _ in sheet.columns.values()}
    count = max(len(cells) for _, cells in sheet.rows) if sheet.rows else 0
    texts = [
        i
        for i in set(range(count)) - used
        if all(i < len(cells) and re.search("[A-Za-z]{2}", cells[i]) for _, cells in sheet.rows)
    ]
    if len(texts) != 1:
        want = "a column 'name' or 'description' that says what the items are"
        raise CaseError(at="name", got="no such title", want=want, file=sheet.file, line=sheet.head_at)
    remarks.append(f"names of the items from column {texts[0] + 1}")
    return replace(sheet, columns=sheet.columns | {"name": (texts[0], "")})


def _cell(sheet: _Sheet, cells: Sequence[str], quantity: str) -> str:
    i = sheet.columns.get(quantity, (len(cells), ""))[0]
    return cells[i].strip() if i < len(cells) else ""


def _of_one_string(sheet: _Sheet, assembly: str | None) -> list[tuple[int, list[str]]]:
    """Rows of one string: of the assembly, or all of them if the sheet has one."""
    names = list(dict.fromkeys(_cell(sheet, cells, "string") for _, cells in sheet.rows))
    if assembly is not None and assembly not in names:
        raise CaseError(at="--assembly", got=assembly, want=f"one of {', '.join(names)}")
    if assembly is None and len(names) > 1:
        want = f"one string, or --assembly with {' or '.join(names)}"
        got = f"{len(names)} strings"
        raise CaseError(got=got, want=want, file=sheet.file, line=sheet.rows[0][0])
    return [row for row in sheet.rows if assembly is None or _cell(sheet, row[1], "string") == assembly]


def _component(sheet: _Sheet, number: int, cells: Sequence[str]) -> Component:
    values: dict[str, float | None] = {}
    for quantity, si in UNIT.items():
        text = _cell(sheet, cells, quantity)
        values[quantity] = None
        if not text:
            continue
        value = number_of(text, sheet.comma)
        if value is None and "/" in text:  # 8 1/2
            value = bare_number(text.strip("\"' "))
        at = "id" if quantity == "bore" else quantity
        if value is None or value < 0:
            raise CaseError(
                at=at,
                got=text,
                want="a number, 0 or above, such as 8.5 or 8 1/2",
                file=sheet.file,
                line=number,
            )
        values[quantity] = to_si(f"{value!r} {sheet.columns[quantity][1]}", si) or None
    name = _cell(sheet, cells, "name")
    if not name:
        raise CaseError(at="name", got="an empty cell", want="what the item is", file=sheet.file, line=number)
    words = name.casefold()
    kind: Kind = next((kind for kind, pattern in KINDS if re.search(pattern, words)), "other")
    if values["blade"] and re.search(r"\bstab", words):
        kind = "stabilizer"
    return Component(
        kind=kind,
        words=name,
        name=name[:60],
        length=values["length"],
        od=values["od"],
        bore=values["bore"] or 0.0,
        weight=values["weight"],
        blade=values["blade"],
        nonmagnetic=bool(re.search(r"\bnm|non.?mag|monel", words)),
        tube=bool(re.search(r"\b(?:casing|liner|tubing)\b", words)),
        file=sheet.file,
        line=number,
    )


def _from_the_top(
    sheet: _Sheet, rows: Sequence[tuple[int, list[str]]], components: list[Component], remarks: list[str]
) -> list[Component]:
    """The components from the rig down: by a column of numbers from the bit, by the bit, or by the longest item."""
    if "order" in sheet.columns:
        read = [number_of(_cell(sheet, cells, "order") or "x", "") for _, cells in rows]
        order = [number for number in read if number is not None]
        if len(set(order)) < len(read):
            want = "a number in each row, each once"
            raise CaseError(
                at="order from the bit", got="other cells", want=want, file=sheet.file, line=rows[0][0]
            )
        pairs = sorted(zip(order, range(len(order)), strict=True), reverse=True)
        return [components[i] for _, i in pairs]
    bits = [i for i, component in enumerate(components) if component.kind == "bit"]
    last = len(components) - 1
    if len(components) == 1 or bits == [last]:
        return components
    if bits == [0]:
        return components[::-1]
    if bits:
        want = "the bit in the first or in the last row"
        raise CaseError(got=f"bit in row {bits[0] + 1}", want=want, file=sheet.file, line=rows[bits[0]][0])
    longest = max(range(len(components)), key=lambda i: components[i].length or 0.0)
    if longest not in (0, last):
        want = "a bit in the first or last row, or a column 'from bit' with 1, 2, .."
        raise CaseError(got="no bit, no order", want=want, file=sheet.file, line=rows[0][0])
    way = "rig down" if longest == 0 else "bit up"
    remarks.append(
        f"no bit and no order in the sheet: listed from the {way}, because its longest item is at that end"
    )
    return components if longest == 0 else components[::-1]
