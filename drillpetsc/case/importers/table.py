"""A table of texts out of a file: CSV and its relatives, xlsx, LAS. Names of survey columns and their units.

What is in the columns is read by `stations.py`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from drillpetsc.case.files.named_file import cells_of, is_comment, lines_of, text_of
from drillpetsc.errors import CaseError
from drillpetsc.units import UnitError, to_si

MAX_BYTES = 50_000_000  # of a file
MAX_ROWS = 100_000  # stations
TITLE_LINES = 30  # lines before the header

SI_UNIT = {"md": "m", "inclination": "rad", "azimuth": "rad", "tvd": "m", "ns": "m", "ew": "m", "dls": "1/m"}
NEEDED = ("md", "inclination", "azimuth")

# names in small letters without blanks and _ . - #; the first names of a column beat those behind the bar
_ALIASES = {
    "md": "md measureddepth measdepth depth dept dmea | surveydepth mdrt mdkb mdrkb mddf bitdepth",
    "inclination": "inc incl inclination angle dev deviation drift theta",
    "azimuth": "azi az azim azimuth azm hazi bearing | aztrue azgrid azitrue azigrid azimuthtrue azimuthgrid azimtrue azimgrid azimag "
    "azmag azimuthmag azimuthmagnetic",
    "tvd": "tvd | tvdrt tvdkb tvdrkb trueverticaldepth verticaldepth vertdepth truevertdepth",
    "ns": "ns n/s n/ns northing north +n/s +ns",
    "ew": "ew e/w easting east +e/w +ew",
    "dls": "dls dogleg doglegseverity dlseverity",
}
_RANK = {
    name: (column, rank)
    for column, names in _ALIASES.items()
    for rank, part in enumerate(names.split("|"))
    for name in part.split()
}
_IN_BRACKETS = re.compile(r"[\[({]\s*([^\])}]*?)\s*[\])}]")
_REFERENCES = ("rkb", "rt", "kb", "df", "grid", "true", "mag", "magnetic")
_UNIT_WORDS = {
    "usft": "ftUS",
    "sft": "ftUS",
    "feetus": "ftUS",
    "deg.": "deg",
    "ft.": "ft",
    "m.": "m",
    "metre": "m",
    "meter": "m",
}
_COMMENT_UNIT = re.compile(
    r"\b(?:depth|md|length)s?\b[^\n]{0,20}\b(?:unit|in)s?\b\W*(ft|feet|foot|usft|m|metres?|meters?)\b"
    r"|\bunits?\b\W*(ft|feet|foot|usft|m|metres?|meters?)\b",
    re.IGNORECASE,
)


@dataclass
class Table:
    """Columns and rows of a survey.

    file: the file; counted: unit of row numbers, `line` or `row`
    heads: titles of the columns as in the file
    head_at: number of the header
    columns: quantity -> (index of its column, unit text or "")
    rows: (number, cells as texts)
    comma: meaning of a comma in a number: `decimal`, `thousands`, or "" for a file without
    depth_unit: unit of depths that comments give, or ""
    remarks: what was assumed
    uids: names of the rows, where the file has them
    """

    file: Path
    heads: list[str]
    head_at: int
    columns: dict[str, tuple[int, str]]
    rows: list[tuple[int, list[str]]]
    counted: str = "line"
    comma: str = ""
    depth_unit: str = ""
    remarks: list[str] = field(default_factory=list)
    uids: list[str] = field(default_factory=list)

    def line(self, place: int) -> int:
        """Number in the file of the row at a place in the list; the header's for -1, a station of no row."""
        return self.rows[place][0] if place >= 0 else self.head_at

    def told(self, place: int) -> str:
        """A row in words: its name, or its number in the file."""
        named = place >= 0 and self.uids and self.uids[place]
        return f"station '{self.uids[place]}'" if named else f"{self.counted} {self.line(place)}"

    def at(self, place: int, column: str) -> str:
        """A cell in words, for the key of a message."""
        named = place >= 0 and self.uids and self.uids[place]
        return f"trajectoryStation '{self.uids[place]}': {column}" if named else column


# ---------------------------------------------------------------------- names and units of columns
def unit_text(text: str) -> str:
    """A unit as a header spells it, as `to_si` reads it."""
    text = text.strip()
    return _UNIT_WORDS.get(text.casefold(), text.rstrip(".")) if text else ""


def is_unit(text: str, column: str) -> bool:
    """Whether a text is a unit of the quantity in a column."""
    if not text or not re.match(r"[A-Za-z°'\"]", text):
        return False
    try:
        to_si(f"1 {unit_text(text)}", SI_UNIT[column])
    except UnitError:
        return False
    return True


def named(title: str) -> tuple[str, int, str] | None:
    """(quantity, rank of the name, unit text or "") of the title of a column; None for one that is not used."""
    unit, name = "", _IN_BRACKETS.sub("", title)
    for inside in _IN_BRACKETS.findall(title):
        if inside.casefold() in _REFERENCES:
            name += inside
        elif unit:
            return None
        else:
            unit = inside
    found = _RANK.get(_short(name))
    if found is None:  # MD, ft or MD/ft or MD_ft
        mark = next((mark for mark in ",/_" if mark in name), "")
        name, _, tail = name.rpartition(mark) if mark else ("", "", "")
        found = _RANK.get(_short(name))
        if found is None or unit or (mark == "_" and not is_unit(tail.strip(), found[0])):
            return None
        unit = tail.strip()
    return *found, unit_text(unit)


def unit_of_title(title: str, column: str) -> str:
    """The unit in a title whatever its name: in brackets, or behind the last of `, / _`; "" without one."""
    inside = [text for text in _IN_BRACKETS.findall(title) if is_unit(text, column)]
    tail = re.split(r"[,/_]", title)[-1].strip()
    return unit_text(inside[0] if inside else tail if is_unit(tail, column) else "")


def _short(name: str) -> str:
    return re.sub(r"[\s_.#-]", "", name.strip().strip("\"'")).casefold()


def columns_of(
    heads: Sequence[str], file: Path, line: int, remarks: list[str], given: Mapping[str, str] | None = None
) -> dict[str, tuple[int, str]] | None:
    """Column and unit of each quantity; None unless measured depth, inclination and azimuth are named.

    given: quantity -> title of its column, for titles that are not known; a unit in brackets may be left out
    """
    found: dict[str, list[tuple[int, int, str]]] = {}
    titles, taken = {title.strip().casefold(): column for column, title in (given or {}).items()}, set()
    for i, title in enumerate(heads):
        whole = title.strip().casefold()
        column = titles.get(whole) or titles.get(_IN_BRACKETS.sub("", whole).strip())
        if column is not None:
            found.setdefault(column, []).append(
                (-2 if whole in titles else -1, i, unit_of_title(title, column))
            )
            taken.add(i)
    if len(found) < len(titles):
        return None
    for i, title in enumerate(heads):
        if i in taken:
            continue
        match = named(title) if len(title) <= 80 else None
        if match:
            column, rank, unit = match
            if column not in (given or {}):
                found.setdefault(column, []).append((rank, i, unit))
    if not all(column in found for column in NEEDED):
        return None
    columns = {}
    for column, several in found.items():
        several.sort()
        rank, i, unit = several[0]
        same = [heads[j].strip() for other, j, _ in several if other == rank]
        if len(same) > 1:
            if column not in NEEDED:
                continue  # not checked
            raise CaseError(
                at=column,
                got=", ".join(same),
                want=f"one column of {column}",
                hint="several columns fit; rename the others",
                file=file,
                line=line,
            )
        if len(several) > 1:
            others = ", ".join(heads[j].strip() for _, j, _ in several[1:])
            remarks.append(f"{column} is column '{heads[i].strip()}', not '{others}'")
        if unit and not is_unit(unit, column):
            if column not in NEEDED:
                continue
            want = {"md": "a length, such as m or ft"}.get(column, "an angle: deg or rad")
            raise CaseError(at=column, got=heads[i].strip(), want=want, file=file, line=line)
        columns[column] = (i, unit)
    return columns


def units_below(
    cells: Sequence[str], columns: dict[str, tuple[int, str]]
) -> dict[str, tuple[int, str]] | None:
    """Columns with the units of a second header line; None if the line holds none."""
    out = dict(columns)
    seen = False
    for column, (i, unit) in columns.items():
        text = cells[i].strip().strip("[](){}") if i < len(cells) else ""
        if not text:
            continue
        if not is_unit(text, column):
            return None
        out[column] = (i, unit or unit_text(text))
        seen = True
    return out if seen else None


# ---------------------------------------------------------------------- text
def table_of_text(file: Path, given: Mapping[str, str] | None = None) -> Table:
    """The table of a text file with commas, semicolons, tabs or blanks between its cells, or of a print.

    given: quantity -> title of its column, for titles that are not known
    """
    remarks: list[str] = []
    lines = _lines(file, remarks)
    if not any(line.strip() for line in lines):
        raise CaseError(
            file=file,
            line=1,
            got="an empty file",
            want="a header md, inclination, azimuth and at least two stations",
        )
    head = _header(lines, file, remarks, given)
    if head is None:
        table = printed_table(lines, file, remarks, given)
        if table is None:
            raise _no_header(lines, file, given)
        return table
    at, separator, heads, columns = head
    comments = [line for line in lines[:at] if _is_comment(line, separator)]
    table = Table(file, heads, at, columns, [], depth_unit=unit_in_comments(comments), remarks=remarks)
    rows = list(_rows(lines, at, separator, file))
    if rows:
        below = units_below(rows[0][1], columns)
        if below is not None:
            table.columns, rows = below, rows[1:]
    if separator == " ":
        for number, cells in rows:
            if len(cells) != len(heads):
                want = f"{len(heads)} cells as in the header, with blanks between them"
                raise CaseError(got=f"{len(cells)} cells", want=want, file=file, line=number)
    if len(rows) > MAX_ROWS:
        raise CaseError(got="more", want=f"at most {MAX_ROWS} stations", file=file, line=at)
    table.rows = rows
    table.comma = comma_in_numbers(file, table.rows, [i for i, _ in table.columns.values()], separator)
    return table


def _lines(file: Path, remarks: list[str]) -> list[str]:
    text, is_unicode = text_of(file, MAX_BYTES)
    if not is_unicode:
        remarks.append("the file is not UTF-8: read as Windows-1252")
    return lines_of(text)


def _is_comment(line: str, separator: str) -> bool:
    return is_comment(line) or (line.lstrip("\ufeff \t").startswith(";") and separator != ";")


def _cells(line: str, separator: str, file: Path, number: int) -> list[str]:
    cells = cells_of(line, separator, file, number)
    while cells and not cells[-1]:
        cells.pop()
    return cells


def _header(
    lines: list[str], file: Path, remarks: list[str], given: Mapping[str, str] | None
) -> tuple[int, str, list[str], dict[str, tuple[int, str]]] | None:
    """(line number, separator, titles, columns) of the first line that names a survey's columns.

    A header may be in a comment line if no other line is a header.
    """
    for in_comments in (False, True):
        tried = 0
        for number, line in enumerate(lines, 1):
            if not line.strip() or _is_comment(line, ",") != in_comments or len(line) > 10_000:
                continue
            if tried > TITLE_LINES:
                break
            tried += 1
            text = line.lstrip("\ufeff \t#/!;") if in_comments else line
            separators = [mark for mark in ("\t", ";", ",") if mark in text] + [" "]
            for separator in separators:
                for cells in _split_head(text, separator, file, number):
                    columns = columns_of(cells, file, number, remarks, given)
                    if columns:
                        return number, separator, [cell.strip() for cell in cells], columns
    return None


def _split_head(text: str, separator: str, file: Path, number: int) -> Iterator[list[str]]:
    """Titles of a header line. With blanks between them, titles of two words have two blanks around them."""
    if separator != " ":
        yield _cells(text, separator, file, number)
    else:
        yield re.split(r"\s{2,}", text.strip())
        yield re.sub(r"\s+([\[({])", r"\1", text.strip()).split()


def _rows(lines: list[str], at: int, separator: str, file: Path) -> Iterator[tuple[int, list[str]]]:
    for number, line in enumerate(lines[at:], at + 1):
        if line.strip() and not _is_comment(line, separator):
            cells = _cells(line, separator, file, number)
            if cells:
                yield number, cells


def _no_header(lines: list[str], file: Path, given: Mapping[str, str] | None) -> CaseError:
    """The error for a file in which no line names the three columns.

    The line itself is not shown if the file is not a survey: it may be anything, even a password.
    """
    want = "a header with md, inclination, azimuth, such as: md [m], inclination [deg], azimuth [deg]"
    if given:
        want = f"a header with the titles {', '.join(given.values())}, and md, inclination, azimuth"
        return CaseError(at="columns", got="lines without these titles", want=want, file=file, line=1)
    hint = (
        "or name the columns: survey: {file: .., columns: {md: Tiefe, inclination: Neigung, azimuth: Azimut}}"
    )
    for number, line in enumerate(lines[: 2 * TITLE_LINES], 1):
        for mark in ("\t", ";", ",", " "):
            cells = line[:10_000].split(mark)
            known = {match[0] for cell in cells if len(cell) <= 80 and (match := named(cell))}
            missing = [column for column in NEEDED if column not in known]
            if len(missing) < len(NEEDED) and len(known) > 1:
                got = ", ".join(cell.strip() for cell in cells)
                if not missing:
                    want = f"the header within {TITLE_LINES} lines"
                return CaseError(
                    at=(*missing, *NEEDED)[0], got=got, want=want, hint=hint, file=file, line=number
                )
    number = next((i for i, line in enumerate(lines, 1) if line.strip()), 1)
    return CaseError(at="md", got="lines without these names", want=want, hint=hint, file=file, line=number)


# ---------------------------------------------------------------------- prints
_TOKEN = re.compile(r"\S+")
_CHUNK = re.compile(r"\S+(?: \S+)*")
_PLAIN = re.compile(r"[+-]?(?:\d{1,3}(?:,\d{3})+|\d+)?(?:\.\d*)?")
_RULE = re.compile(r"[\s=_|+-]*")
HEADING_LINES = 6  # of a print


def _is_row(line: str) -> bool:
    tokens = line.split()
    return len(tokens) >= len(NEEDED) and all(
        _PLAIN.fullmatch(q) and any(map(str.isdigit, q)) for q in tokens
    )


def printed_table(
    lines: list[str], file: Path, remarks: list[str], given: Mapping[str, str] | None = None
) -> Table | None:
    """The table of a print: aligned columns of numbers below headings of several lines; None for another text.

    Lines between the rows that are not rows, such as the headings of a new page, are left out with a remark.
    """
    rows = [i for i, line in enumerate(lines) if _is_row(line)]
    if len(rows) < 2:
        return None
    count = len(lines[rows[0]].split())
    edges = _edges([lines[i] for i in rows if len(lines[i].split()) == count])
    above = [line for line in lines[: rows[0]] if line.strip() and not _RULE.fullmatch(line)][-HEADING_LINES:]
    best: tuple[dict[str, tuple[int, str]], list[str], list[str]] | None = None
    for first in range(len(above) - 1, -1, -1):
        heads, said = _headings(above[first:], edges), list[str]()
        try:
            columns = columns_of(heads, file, rows[0], said, given)
        except CaseError:  # two columns of one name: the line above may tell them apart
            continue
        if columns and (best is None or len(columns) > len(best[0])):
            best = columns, heads, said
    if best is None:
        return None
    cells: list[tuple[int, list[str]]] = []
    for i in rows:
        cells.append((i + 1, lines[i].split()))
        if len(cells[-1][1]) != count:
            want = f"{count} numbers, as in the rows above"
            raise CaseError(got=f"{len(cells[-1][1])} numbers", want=want, file=file, line=i + 1)
    between = set(range(rows[0], rows[-1])) - set(rows)
    left_out = sorted(i + 1 for i in between if lines[i].strip() and not _RULE.fullmatch(lines[i]))
    if left_out:
        shown = ", ".join(map(str, left_out[:8])) + (", ..." if len(left_out) > 8 else "")
        remarks.append(f"{len(left_out)} lines between the rows left out (lines {shown})")
    remarks += best[2]
    comma = "thousands" if any("," in cell for _, row in cells for cell in row) else ""
    unit = unit_in_comments(lines[: rows[0]])
    return Table(file, best[1], rows[0], best[0], cells, comma=comma, depth_unit=unit, remarks=remarks)


def _edges(rows: Sequence[str]) -> list[float]:
    """Positions between the columns of aligned rows [letters]: the middles between the numbers of two columns."""
    spans = [[match.span() for match in _TOKEN.finditer(row)] for row in rows]
    left = [min(row[k][0] for row in spans) for k in range(len(spans[0]))]
    right = [max(row[k][1] for row in spans) for k in range(len(spans[0]))]
    return [0.5 * (a + b) for a, b in zip(right, left[1:], strict=False)]


def _headings(lines: Sequence[str], edges: Sequence[float]) -> list[str]:
    """Titles of the columns between the edges: the words of the lines above each other."""
    titles: list[list[str]] = [[] for _ in range(len(edges) + 1)]
    for line in lines:
        for chunk in _CHUNK.finditer(line):
            crossed = [edge for edge in edges if chunk.start() < edge < chunk.end()]
            parts = _TOKEN.finditer(line, chunk.start(), chunk.end()) if len(crossed) > 1 else [chunk]
            for part in parts:
                middle = 0.5 * (part.start() + part.end())
                titles[sum(edge < middle for edge in edges)].append(part.group().strip(":|"))
    return [" ".join(words) for words in titles]


def unit_in_comments(comments: Sequence[str]) -> str:
    """Unit of depths that comment lines give, as in `# Depth unit: ft`; "" if they give none, or two."""
    found = {
        "m" if unit.casefold().startswith("m") else unit_text(unit).casefold().replace("ftus", "ftUS")
        for line in comments
        for match in [_COMMENT_UNIT.search(line[:500])]
        if match
        for unit in [match.group(1) or match.group(2)]
    }
    return found.pop().replace("feet", "ft").replace("foot", "ft") if len(found) == 1 else ""


_THOUSANDS = re.compile(r"[+-]?\d{1,3}(?:,\d{3})+(?:\.\d*)?")
#: 1.200: with decimal commas it is 1200
_POINTED = re.compile(r"[+-]?[1-9]\d{0,2}(?:\.\d{3})+")


def comma_in_numbers(
    file: Path, rows: list[tuple[int, list[str]]], columns: Iterable[int], separator: str
) -> str:
    """Meaning of commas in numbers: decimal, thousands, or "" without any.

    Between cells that a comma does not separate it may be either, and the file must show which; CaseError if it does not.
    """
    texts = [(number, cells[i].strip()) for number, cells in rows for i in columns if i < len(cells)]
    with_comma = [(number, text) for number, text in texts if "," in text]
    if not with_comma:
        return ""
    if separator == ",":
        return "thousands"
    both = [text for _, text in with_comma if "." in text]
    if both:
        return "thousands" if all(_THOUSANDS.fullmatch(text) for text in both) else "decimal"
    want, unclear = "a decimal point, or numbers that show what the comma is", with_comma
    points = [(number, text) for number, text in texts if "." in text]
    if any(not _THOUSANDS.fullmatch(text) or text.lstrip("+-").startswith("0") for _, text in with_comma):
        want = "numbers without points beside those with decimal commas"
        unclear = [(number, text) for number, text in points if _POINTED.fullmatch(text)]
        if not unclear:
            return "decimal"
    elif any(re.fullmatch(r"[+-]?\d*\.\d+", text) and not _POINTED.fullmatch(text) for _, text in points):
        return "thousands"
    number, text = unclear[0]
    hint = f"{text} may be {re.sub('[.,]', '', text)} or {text.replace(',', '.')}"
    raise CaseError(got=text, want=want, hint=hint, file=file, line=number)
