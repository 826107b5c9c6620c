"""Pressure window from a CSV file: columns tvd, pore, frac in any order, others ignored."""

from __future__ import annotations

import csv
import os
import re
from pathlib import Path

from drillpetsc.case.key_paths import refuse, suggestion
from drillpetsc.case.quantities import InSI
from drillpetsc.case.survey_file import FOLDER
from drillpetsc.errors import CaseError
from drillpetsc.units import UnitError, to_si

_COLUMNS = {"tvd": "m", "pore": "kg/m^3", "frac": "kg/m^3"}
_HEADER = re.compile(r"\s*([A-Za-z_ ]+?)\s*(?:[\[(]\s*([^\])]+?)\s*[\])])?\s*")
_EXAMPLE = "tvd [ft], pore [ppg], frac [ppg]"


def read_window(name: str) -> dict[str, list[float]]:
    """{tvd: [m], pore: [kg/m3], frac: [kg/m3]} from a CSV file beside the case file or in the working directory.

    The first line names the columns, with a unit in brackets if wanted: `tvd [ft], pore [ppg], frac [ppg]`.  Without
    a unit a column has that of the case's bare numbers.  `#` starts a comment line.
    """
    path = _file(name)
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise CaseError(file=path, want="a CSV text file in UTF-8") from None
    except OSError as error:
        raise refuse(got=name, want="a file that can be read", hint=str(error)) from None
    rows = [
        (i, line) for i, line in enumerate(lines, 1) if line.strip() and not line.lstrip().startswith("#")
    ]
    if not rows:
        raise CaseError(file=path, line=1, want=f"a header such as {_EXAMPLE}, and rows below it")
    line, head = rows[0]
    mark = next((m for m in (";", "\t") if m in head), ",")
    columns = _columns(path, line, next(csv.reader([head], delimiter=mark)))
    window: dict[str, list[float]] = {key: [] for key in _COLUMNS}
    for line, text in rows[1:]:
        cells = next(csv.reader([text], delimiter=mark))
        for key, (column, unit) in columns.items():
            cell = cells[column].strip() if column < len(cells) else ""
            try:
                number = float(cell)
                window[key].append(InSI(to_si(f"{number!r} {unit}", _COLUMNS[key])) if unit else number)
            except (UnitError, ValueError):
                raise CaseError(
                    at=key,
                    got=cell or "an empty cell",
                    want=f"a number in {unit}" if unit else "a number",
                    file=path,
                    line=line,
                ) from None
    return window


def _file(name: str) -> Path:
    folder = FOLDER.get()
    for path in (folder / name, Path(name)):
        if os.path.isfile(path):
            return path
    hint = suggestion(name, [other.name for other in folder.glob("*.csv")])
    raise refuse(
        got=name,
        want="a CSV file that exists, or {pore: ..., frac: ...}, or {tvd: [...], pore: [...], frac: [...]}",
        hint=hint or f"looked in {'' if str(folder) == '.' else f'{folder} and '}the working directory",
    )


def _columns(path: Path, line: int, head: list[str]) -> dict[str, tuple[int, str]]:
    """Number and unit of each column."""
    columns: dict[str, tuple[int, str]] = {}
    for i, title in enumerate(head):
        match = _HEADER.fullmatch(title)
        name = match.group(1).lower() if match else ""
        if match is None or name not in _COLUMNS:
            continue
        if name in columns:
            raise CaseError(at=name, want="each of tvd, pore, frac once", file=path, line=line)
        unit = match.group(2) or ""
        try:
            to_si(f"1 {unit}", _COLUMNS[name])
        except UnitError as error:
            raise CaseError(
                at=name, got=title, want=error.want, hint=error.hint, file=path, line=line
            ) from None
        columns[name] = (i, unit)
    missing = [key for key in _COLUMNS if key not in columns]
    if missing:
        got = ", ".join(head) if columns else "a line without these names"
        raise CaseError(at=missing[0], got=got, want=f"a header such as {_EXAMPLE}", file=path, line=line)
    return columns
