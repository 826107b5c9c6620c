"""Survey from a CSV file: columns md, inclination, azimuth in any order, others ignored."""

from __future__ import annotations

import csv
import re
from contextvars import ContextVar
from pathlib import Path

from drillpetsc.case.keys import near, refuse
from drillpetsc.errors import CaseError
from drillpetsc.units import UnitError, to_si

FOLDER: ContextVar[Path] = ContextVar("FOLDER", default=Path())
"""Folder that relative file names in a case start from: the case file's, else the working directory."""

_COLUMNS = {"md": ("m", "m"), "inclination": ("rad", "deg"), "azimuth": ("rad", "deg")}
_HEADER = re.compile(r"\s*([A-Za-z_ ]+?)\s*(?:[\[(]\s*([^\])]+?)\s*[\])])?\s*")


def read_survey(name: str) -> dict[str, list[float]]:
    """{md: [m], inclination: [rad], azimuth: [rad]} from a CSV file.

    The first line names the columns, with a unit in brackets if wanted: `md [ft], inclination [deg], azimuth [deg]`.
    Without a unit, md is in metres and angles are in degrees, as surveys are written. `#` starts a comment line.
    """
    path = FOLDER.get() / name
    try:
        found = path.is_file()
    except OSError:  # a name longer than any file's
        found = False
    if not found:
        folder = str(FOLDER.get())
        seen = [other.name for other in FOLDER.get().glob("*.csv")]
        hint = near(name, seen) or f"looked in {'the working directory' if folder == '.' else folder}"
        want = "a survey file that exists, or {md: [...], inclination: [...], azimuth: [...]}"
        raise refuse(got=name, want=want, hint=hint)
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise CaseError(file=path, want="a CSV text file in UTF-8") from None
    except OSError as error:
        raise refuse(got=name, want="a survey file that can be read", hint=str(error)) from None
    numbered = [(i, line) for i, line in enumerate(lines, 1) if line.strip() and not line.lstrip().startswith("#")]
    if not numbered:
        raise CaseError(file=path, line=1, want="a header md, inclination, azimuth and at least two stations")
    head_line, head = numbered[0]
    delimiter = next((mark for mark in (";", "\t") if mark in head), ",")
    columns = _columns(path, head_line, next(csv.reader([head], delimiter=delimiter)))
    survey: dict[str, list[float]] = {key: [] for key in _COLUMNS}
    for line, text in numbered[1:]:
        cells = next(csv.reader([text], delimiter=delimiter))
        for key, (column, unit) in columns.items():
            survey[key].append(_cell(path, line, key, cells, column, unit))
        _rising(path, line, survey["md"])
    if len(survey["md"]) < 2:
        raise CaseError(file=path, line=head_line, want="at least two stations")
    return survey


def _columns(path: Path, line: int, head: list[str]) -> dict[str, tuple[int, str]]:
    """Column number and unit of each of md, inclination, azimuth."""
    columns: dict[str, tuple[int, str]] = {}
    for i, title in enumerate(head):
        match = _HEADER.fullmatch(title)
        name = match.group(1).lower() if match else ""
        if match and name in _COLUMNS:
            unit = match.group(2) or _COLUMNS[name][1]
            try:
                to_si(f"1 {unit}", _COLUMNS[name][0])
            except UnitError as error:
                raise CaseError(at=name, got=title, want=error.want, hint=error.hint, file=path, line=line) from None
            columns[name] = (i, unit)
    missing = [key for key in _COLUMNS if key not in columns]
    if missing:
        want = "a header with md, inclination, azimuth, such as: md [m], inclination [deg], azimuth [deg]"
        raise CaseError(at=missing[0], got=", ".join(head), want=want, file=path, line=line)
    return columns


def _cell(path: Path, line: int, key: str, cells: list[str], column: int, unit: str) -> float:
    text = cells[column].strip() if column < len(cells) else ""
    try:
        return to_si(f"{float(text)!r} {unit}", _COLUMNS[key][0])
    except ValueError as error:
        want = error.want if isinstance(error, UnitError) else f"a number in {unit}"
        raise CaseError(at=key, got=text or "an empty cell", want=want, file=path, line=line) from None


def _rising(path: Path, line: int, md: list[float]) -> None:
    if len(md) == 1 and md[0] != 0:
        want = "a first station at 0 m (the rotary table)"
        raise CaseError(at="md", got=md[0], want=want, file=path, line=line)
    if len(md) > 1 and md[-1] <= md[-2]:
        want = f"rising depths: above {md[-2]:g} m, the station before"
        raise CaseError(at="md", got=md[-1], want=want, file=path, line=line)
