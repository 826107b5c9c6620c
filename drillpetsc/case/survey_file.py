"""Survey from a CSV file: columns md, inclination, azimuth in any order, others ignored.

The trajectory.csv of a run is such a file.
"""

from __future__ import annotations

import csv
import os
import re
from contextvars import ContextVar
from pathlib import Path

from drillpetsc.case.key_paths import refuse, suggestion
from drillpetsc.errors import CaseError
from drillpetsc.units import UnitError, to_si

FOLDER: ContextVar[Path] = ContextVar("FOLDER", default=Path())
"""Base of relative file names in a case: the folder of the case file, else the working directory."""

_COLUMNS = {"md": ("m", "m"), "inclination": ("rad", "deg"), "azimuth": ("rad", "deg")}
_HEADER = re.compile(r"\s*([A-Za-z_ ]+?)\s*(?:[\[(]\s*([^\])]+?)\s*[\])])?\s*")


def read_survey(name: str) -> dict[str, list[float]]:
    """{md: [m], inclination: [rad], azimuth: [rad]} from a CSV file, or from the trajectory.csv of a run
    folder.

    The first line names the columns, with a unit in brackets if wanted: `md [ft], inclination [deg], azimuth
    [deg]`. Without a unit, md is in metres and angles are in degrees, as is usual. `#` starts a
    comment line.
    """
    path = _file(name)
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise CaseError(file=path, want="a CSV text file in UTF-8") from None
    except OSError as error:
        raise refuse(got=name, want="a survey file that can be read", hint=str(error)) from None
    numbered = [
        (i, line) for i, line in enumerate(lines, 1) if line.strip() and not line.lstrip().startswith("#")
    ]
    if not numbered:
        raise CaseError(file=path, line=1, want="a header md, inclination, azimuth and at least two stations")
    head_line, head = numbered[0]
    delimiter = next((mark for mark in (";", "\t") if mark in head), ",")
    columns = _columns(path, head_line, _cells(path, head_line, head, delimiter))
    survey: dict[str, list[float]] = {key: [] for key in _COLUMNS}
    for line, text in numbered[1:]:
        cells = _cells(path, line, text, delimiter)
        for key, (column, unit) in columns.items():
            survey[key].append(_cell(path, line, key, cells, column, unit))
        _rising(path, line, survey["md"])
    if len(survey["md"]) < 2:
        raise CaseError(file=path, line=head_line, want="at least two stations")
    return survey


def _file(name: str) -> Path:
    """The survey file, searched beside the case file, then in the working directory."""
    folder = FOLDER.get()
    for path in (folder / name, Path(name)):
        if name.strip() and os.path.isdir(path):  # Path.is_dir raises for a name longer than any file's
            run = path / "trajectory.csv"
            if not run.is_file():
                raise refuse(got=name, want="a survey file, or a run folder that holds a trajectory.csv")
            return run
        if os.path.isfile(path):
            return path
    hint = suggestion(name, [other.name for other in folder.glob("*.csv")])
    hint = hint or f"looked in {'' if str(folder) == '.' else f'{folder} and '}the working directory"
    raise refuse(
        got=name,
        want="a survey file that exists, a run folder, or {md: [...], inclination: [...], azimuth: [...]}",
        hint=hint,
    )


def _cells(path: Path, line: int, text: str, delimiter: str) -> list[str]:
    try:
        return next(csv.reader([text], delimiter=delimiter))
    except csv.Error as error:  # a cell of more than 131072 letters
        raise CaseError(
            got=text, want="cells with a number each", hint=str(error), file=path, line=line
        ) from None


def _columns(path: Path, line: int, head: list[str]) -> dict[str, tuple[int, str]]:
    """Column number and unit of each of md, inclination, azimuth."""
    columns: dict[str, tuple[int, str]] = {}
    for i, title in enumerate(head):
        match = _HEADER.fullmatch(title)
        name = match.group(1).lower() if match else ""
        if match and name in _COLUMNS:
            if name in columns:
                raise CaseError(
                    at=name,
                    got=", ".join(head),
                    want="each of md, inclination, azimuth once",
                    file=path,
                    line=line,
                )
            unit = match.group(2) or _COLUMNS[name][1]
            try:
                to_si(f"1 {unit}", _COLUMNS[name][0])
            except UnitError as error:
                raise CaseError(
                    at=name, got=title, want=error.want, hint=error.hint, file=path, line=line
                ) from None
            columns[name] = (i, unit)
    missing = [key for key in _COLUMNS if key not in columns]
    if missing:
        want = "a header with md, inclination, azimuth, such as: md [m], inclination [deg], azimuth [deg]"
        # the line itself is not shown where the file is no survey: it may be anything, a password too
        got = ", ".join(head) if columns else "a line without these names"
        raise CaseError(at=missing[0], got=got, want=want, file=path, line=line)
    return columns


def _cell(path: Path, line: int, key: str, cells: list[str], column: int, unit: str) -> float:
    text = cells[column].strip() if column < len(cells) else ""
    try:
        return to_si(
            f"{float(text.replace('_', ' '))!r} {unit}", _COLUMNS[key][0]
        )  # Python would read 1_0 as 10
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
