"""Performance of a downhole motor from a CSV file: columns flow, differential pressure, torque and speed, in any order."""

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

# column -> (SI unit, names in small letters without blanks and _)
_COLUMNS = {
    "flow_rate": ("m^3/s", ("flow", "flowrate", "q")),
    "differential_pressure": ("Pa", ("differentialpressure", "pressure", "dp", "diffpressure")),
    "torque": ("N m", ("torque",)),
    "speed": ("rad/s", ("speed", "rpm")),
}
_HEADER = re.compile(r"\s*([A-Za-z_ ]+?)\s*(?:[\[(]\s*([^\])]+?)\s*[\])])?\s*")
_EXAMPLE = "flow [gpm], differential_pressure [psi], torque [ft lbf], speed [rpm]"


def read_motor_curve(name: str) -> dict[str, list[float]]:
    """Columns flow_rate [m3/s], differential_pressure [Pa], torque [N m], speed [rad/s] of a CSV file.

    The file stands beside the case file or in the working directory. Its first line names the columns, each with a
    unit in brackets; a column named `rpm` needs none. `#` starts a comment line.
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
    found: dict[str, list[float]] = {key: [] for key in _COLUMNS}
    for line, text in rows[1:]:
        cells = next(csv.reader([text], delimiter=mark))
        for key, (column, unit) in columns.items():
            cell = cells[column].strip() if column < len(cells) else ""
            try:
                found[key].append(InSI(to_si(f"{float(cell)!r} {unit}", _COLUMNS[key][0])))
            except (UnitError, ValueError):
                raise CaseError(
                    at=key, got=cell or "an empty cell", want=f"a number in {unit}", file=path, line=line
                ) from None
    return found


def _file(name: str) -> Path:
    folder = FOLDER.get()
    for path in (folder / name, Path(name)):
        if os.path.isfile(path):
            return path
    raise refuse(
        got=name,
        want="a CSV file that exists, or {flow_rate: [...], differential_pressure: [...], torque: [...], speed: [...]}",
        hint=suggestion(name, [other.name for other in folder.glob("*.csv")])
        or f"looked in {'' if str(folder) == '.' else f'{folder} and '}the working directory",
    )


def _columns(path: Path, line: int, head: list[str]) -> dict[str, tuple[int, str]]:
    """Number and unit of each column."""
    columns: dict[str, tuple[int, str]] = {}
    for i, title in enumerate(head):
        match = _HEADER.fullmatch(title)
        word = re.sub(r"[\s_]", "", match.group(1)).casefold() if match else ""
        key = next((k for k, (_, names) in _COLUMNS.items() if word in names), None)
        if match is None or key is None:
            continue
        if key in columns:
            raise CaseError(at=key, want="one column of each quantity", file=path, line=line)
        unit = match.group(2) or ("rpm" if word == "rpm" else "")
        if not unit:
            raise CaseError(at=key, got=title, want=f"a unit in brackets: {_EXAMPLE}", file=path, line=line)
        try:
            to_si(f"1 {unit}", _COLUMNS[key][0])
        except UnitError as error:
            raise CaseError(
                at=key, got=title, want=error.want, hint=error.hint, file=path, line=line
            ) from None
        columns[key] = (i, unit)
    missing = [key for key in _COLUMNS if key not in columns]
    if missing:
        got = ", ".join(head) if columns else "a line without these names"
        raise CaseError(at=missing[0], got=got, want=f"a header such as {_EXAMPLE}", file=path, line=line)
    return columns
