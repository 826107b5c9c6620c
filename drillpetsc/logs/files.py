"""Tables of texts out of the files of a log: CSV and its relatives, xlsx, LAS 1.2 to 3.0, WITSML 1.4.1.1."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from drillpetsc.case.files.named_file import cells_of, is_comment, lines_of, text_of
from drillpetsc.case.importers.las import curves_of
from drillpetsc.case.importers.sheet import cell_text, workbook
from drillpetsc.case.importers.xml_tree import Element, read_xml
from drillpetsc.errors import CaseError
from drillpetsc.logs.channels import DEPTHS, Heading, heading_of, unit_of

MAX_BYTES, MAX_ROWS, TITLE_LINES = 200_000_000, 1_000_000, 40
WITSML = "http://www.witsml.org/schemas/1series"


@dataclass
class Sheet:
    """A table of texts.

    file; at: number of the row of the headings; titles: of the columns; headings: what they say.
    columns: texts of each column; first: number of the first row of data; null: text of the file for no value.
    """

    file: Path
    at: int
    titles: list[str]
    headings: list[Heading]
    columns: list[list[str]]
    first: int
    null: str = ""

    @property
    def place(self) -> dict[str, Any]:
        """File and row of the headings, for messages."""
        return {"file": self.file, "line": self.at}


def sheet_of(file: Path) -> Sheet:
    """The table of a file; raises CaseError for a file that cannot be read or has no log."""
    try:
        if not file.is_file():
            raise CaseError(at="FILE", got=str(file), want="a log that exists: CSV, xlsx, LAS or WITSML")
        if file.stat().st_size > MAX_BYTES:
            raise CaseError(file=file, got="a larger one", want=f"a file of at most {MAX_BYTES // 10**6} MB")
        kind = file.suffix.casefold()
        reader = {".xlsx": _workbook, ".xlsm": _workbook, ".las": _las, ".xml": _witsml}.get(kind, _text)
        return reader(file)
    except OSError as error:
        raise CaseError(at="FILE", got=str(file), want="a log that can be read", hint=str(error)) from None


def is_log(headings: Sequence[Heading]) -> bool:
    """Whether headings have an index and a channel beside it."""
    found = {heading.channel for heading in headings}
    readings = found - {"", "time", "date"}
    return bool(found & {"time", *DEPTHS}) and len(readings) > (0 if "time" in found else 1)


def not_a_log(file: Path, line: int, got: str = "lines without these names") -> CaseError:
    want = "a heading with time or depth and a reading, such as: time, bit depth [m], hook load [t], rpm, flow in [l/min]"
    return CaseError(at="heading", got=got, want=want, file=file, line=line)


# ---------------------------------------------------------------------- text
def _text(file: Path) -> Sheet:
    lines = lines_of(text_of(file, MAX_BYTES)[0])
    some = [(i, line) for i, line in enumerate(lines, 1) if line.strip() and not is_comment(line)]
    for place, (number, line) in enumerate(some[:TITLE_LINES]):
        for mark, titles, headings in possible_headings(line, file, number):
            if is_log(headings):
                rows = [(i, cells_of(text, mark, file, i)) for i, text in some[place + 1 :]]
                return _sheet(file, number, titles, headings, rows)
    raise not_a_log(file, some[0][0] if some else 1)


def possible_headings(line: str, file: Path, number: int) -> Iterator[tuple[str, list[str], list[Heading]]]:
    """(mark between cells, cells, what they say as headings) of a line, for each mark that it may have."""
    for mark in [m for m in ("\t", ";", "|", ",") if m in line] + [" "]:
        titles = cells_of(line, mark, file, number)
        yield mark, titles, [heading_of(title) for title in titles]


def _sheet(
    file: Path,
    at: int,
    titles: list[str],
    headings: list[Heading],
    rows: list[tuple[int, list[str]]],
    null: str = "",
) -> Sheet:
    """The table of rows of cells; a first row with units gives them to headings without."""
    width = len(titles)
    if rows:
        below = units_below(headings, rows[0][1])
        if below is not None:
            headings, rows = below, rows[1:]
    for number, cells in rows:
        if len([q for q in cells if q]) and len(cells) != width and any(cells[width:]):
            got, want = f"{len(cells)} cells", f"{width} cells, as in the headings"
            raise CaseError(got=got, want=want, hint="a comma inside a number?", file=file, line=number)
    if not rows:
        raise CaseError(file=file, line=at, got="no rows", want="at least one row of readings")
    if len(rows) > MAX_ROWS:
        raise CaseError(file=file, line=at, got="more", want=f"at most {MAX_ROWS} rows")
    columns = [[cells[j] if j < len(cells) else "" for _, cells in rows] for j in range(width)]
    return Sheet(file, at, titles, headings, columns, rows[0][0], null)


def units_below(headings: list[Heading], cells: list[str]) -> list[Heading] | None:
    """Headings with the units of a second line; None for a line that has numbers or no unit."""
    from drillpetsc.logs.channels import CHANNELS

    out, seen = list(headings), False
    for i, (heading, cell) in enumerate(zip(headings, cells, strict=False)):
        text = cell.strip().strip("[](){}")
        if re.match(r"[+-]?\.?\d", text):
            return None
        if heading.channel and CHANNELS[heading.channel].unit and text:
            unit = unit_of(text, CHANNELS[heading.channel].unit)
            if unit is None:
                return None
            out[i] = Heading(heading.channel, heading.unit or unit, heading.window)
            seen |= bool(unit)
    return out if seen else None


# ---------------------------------------------------------------------- xlsx
def _workbook(file: Path) -> Sheet:
    found: list[Sheet] = []
    with workbook(file, MAX_BYTES) as book:
        for page in book.worksheets:
            rows = [
                [_cell(q) for q in row]
                for row in page.iter_rows(max_row=MAX_ROWS, max_col=300, values_only=True)
            ]
            some = [(i, row) for i, row in enumerate(rows, 1) if any(row)]
            for place, (number, titles) in enumerate(some[:TITLE_LINES]):
                headings = [heading_of(title) for title in titles]
                if is_log(headings):
                    found.append(_sheet(file, number, titles, headings, some[place + 1 :]))
                    break
    if not found:
        raise not_a_log(file, 1, "sheets without these names")
    if len(found) > 1:
        raise CaseError(file=file, line=1, got=f"{len(found)} sheets with a log", want="one sheet with a log")
    return found[0]


def _cell(value: Any) -> str:
    return str(value.isoformat()) if hasattr(value, "isoformat") else cell_text(value)


# ---------------------------------------------------------------------- LAS
def _las(file: Path) -> Sheet:
    text = text_of(file, MAX_BYTES)[0]
    version = re.search(r"^\s*VERS\s*\.\s*([\d.]+)", text, re.MULTILINE | re.IGNORECASE)
    if version and version.group(1).startswith("3"):
        curves, null = _las3(file, text)
    else:
        read = curves_of(file, text, "1.2, 2.0 or 3.0")
        curves, null = [(name, unit, [_cell(v) for v in data]) for name, unit, data in read], ""
    titles = [name.partition(":")[0] for name, _, _ in curves]  # lasio numbers equal names: HKLD:1, HKLD:2
    headings = [heading_of(name, unit) for name, unit, _ in curves]
    if not is_log(headings):
        raise not_a_log(file, 1, ", ".join(titles)[:200] or "no curves")
    rows = [
        (i, list(cells)) for i, cells in enumerate(zip(*(data for _, _, data in curves), strict=False), 1)
    ]
    return _sheet(file, 1, titles, headings, rows, null)


Curves = list[tuple[str, str, list[str]]]


def _las3(file: Path, text: str) -> tuple[Curves, str]:
    """Curves of the sections ~Log_Definition and ~Log_Data of version 3, which lasio does not read."""
    section, mark, null = "", ",", ""
    curves: list[tuple[str, str]] = []
    data: list[tuple[int, list[str]]] = []
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        if line.lstrip().startswith("~"):
            section = re.split(r"[|\s]", line.strip()[1:].casefold())[0]
            continue
        if section in ("log_data", "ascii", "a"):
            data.append((number, cells_of(line, mark, file, number)))
            continue
        match = re.match(r"\s*([^.\s:]+)\s*\.(\S*)\s*(.*?)\s*(?::.*)?$", line)
        if match and section in ("log_definition", "curve", "c"):
            curves.append((match.group(1), match.group(2)))
        elif match and match.group(1).upper() == "DLM":
            mark = {"TAB": "\t", "SPACE": " "}.get((match.group(2) or match.group(3)).upper(), ",")
        elif match and match.group(1).upper() == "NULL":
            null = match.group(3)
    for number, cells in data:
        if len(cells) != len(curves):
            raise CaseError(
                got=f"{len(cells)} values", want=f"{len(curves)}, as there are curves", file=file, line=number
            )
    return [(name, unit, [cells[j] for _, cells in data]) for j, (name, unit) in enumerate(curves)], null


# ---------------------------------------------------------------------- WITSML
@dataclass(frozen=True)
class DataTable:
    """The data of a log: names of its columns and what they say; rows as (line, cells), the index first.

    null: text for no value; unit: of the index.
    """

    titles: list[str]
    headings: list[Heading]
    rows: list[tuple[int, list[str]]]
    null: str
    unit: str


def _witsml(file: Path) -> Sheet:
    """The log of a document; its chunks of data are put one after another."""
    root = read_xml(file)
    logs = witsml_logs(root, file)
    if len(logs) != 1:
        uids = ", ".join(q.attributes.get("uid", "?") for q in logs)[:120]
        raise CaseError(at="logs", got=f"{len(logs)} ({uids})", want="one log", file=file, line=root.line)
    found = witsml_table(logs[0], file)
    if found is None:
        raise not_a_log(file, logs[0].line, "no logData")
    return _sheet(file, logs[0].line, found.titles, found.headings, found.rows, found.null)


def witsml_logs(root: Element, file: Path) -> list[Element]:
    """The logs of a document.  Raises CaseError for another document."""
    version = root.attributes.get("version", "")
    if root.name != "logs" or root.space != WITSML or not version.startswith("1.4.1"):
        got = f"<{root.name}> of version {version or 'unknown'}, namespace {root.space or 'none'}"
        raise CaseError(
            got=got[:160], want=f"logs of WITSML 1.4.1, namespace {WITSML}", file=file, line=root.line
        )
    return list(root.all("log"))


def witsml_table(log: Element, file: Path) -> DataTable | None:
    """The data of a log, None without any.  Raises CaseError for data without the columns of a log."""
    units = {q.word("mnemonic"): (q.word("unit"), q.word("nullValue")) for q in log.all("logCurveInfo")}
    titles: list[str] = []
    rows: list[tuple[int, list[str]]] = []
    nulls = {log.word("nullValue"), *(null for _, null in units.values())} - {""}
    for chunk in log.all("logData"):
        names, own = (
            [q.strip() for q in chunk.word(name).split(",")] for name in ("mnemonicList", "unitList")
        )
        names = names if any(names) else list(units)
        if titles and names != titles:
            got, want = ", ".join(names)[:120], f"{', '.join(titles)[:120]}, as in the chunk before"
            raise CaseError(at="mnemonicList", got=got, want=want, file=file, line=chunk.line)
        titles = names
        for name, unit in zip(names, own, strict=False):
            units[name] = (unit or units.get(name, ("", ""))[0], "")
        rows += _values(chunk, len(names), file)
    if not rows:
        return None
    headings = [heading_of(name, units.get(name, ("", ""))[0]) for name in titles]
    if not is_log(headings):
        raise not_a_log(file, log.line, ", ".join(titles)[:200])
    return DataTable(titles, headings, rows, nulls.pop() if len(nulls) == 1 else "", units[titles[0]][0])


def _values(chunk: Element, width: int, file: Path) -> Iterator[tuple[int, list[str]]]:
    for data in chunk.all("data"):
        cells = [q.strip() for q in data.text.split(",")]
        if len(cells) != width:
            raise CaseError(
                at="data", got=f"{len(cells)} values", want=f"{width} values", file=file, line=data.line
            )
        yield data.line, cells
