"""Columns of numbers with units from a CSV file that a case names."""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from drillpetsc.case.files.named_file import named_file
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import InSI
from drillpetsc.errors import CaseError
from drillpetsc.units import UnitError, to_si

_HEADER = re.compile(r"\s*([A-Za-z_ ]+?)\s*(?:[\[(]\s*([^\])]+?)\s*[\])])?\s*")


@dataclass(frozen=True)
class QuantityColumn:
    """A column of a file.

    unit: SI, empty for pure numbers; names: in headers, in small letters without blanks and `_`; implied: unit that a name without one has.
    """

    unit: str
    names: tuple[str, ...]
    implied: Mapping[str, str]


@dataclass(frozen=True)
class QuantityFile:
    """A kind of file.

    columns: by key; example: of a header; otherwise: what a case may give instead of the file.
    bare: a column without a unit is allowed; its numbers are in the units of the case.
    """

    columns: Mapping[str, QuantityColumn]
    example: str
    otherwise: str
    bare: bool = False

    def read_if_named(self, given: Any) -> Any:
        """The columns of the file that ``given`` names (``read``); what is not a text unchanged."""
        return self.read(given) if isinstance(given, str) else given

    def read(self, name: str) -> dict[str, list[float]]:
        """Columns by key, in SI unless bare, of a file beside the case file or in the working directory.

        The first line names the columns, in any order, with a unit in brackets; others are ignored.  `#` starts a comment
        line.  Raises CaseError with the place of what cannot be read.
        """
        path, _ = named_file(name, f"a CSV file that exists, or {self.otherwise}")
        try:
            lines = path.read_text(encoding="utf-8-sig").splitlines()
        except UnicodeDecodeError:
            raise CaseError(file=path, want="a CSV text file in UTF-8") from None
        except OSError as error:
            raise refuse(got=name, want="a file that can be read", hint=str(error)) from None
        rows = [(i, s) for i, s in enumerate(lines, 1) if s.strip() and not s.lstrip().startswith("#")]
        if not rows:
            raise CaseError(file=path, line=1, want=f"a header such as {self.example}, and rows below it")
        line, head = rows[0]
        mark = next((m for m in (";", "\t") if m in head), ",")
        columns = self._places(path, line, next(csv.reader([head], delimiter=mark)))
        found: dict[str, list[float]] = {key: [] for key in self.columns}
        for line, text in rows[1:]:
            cells = next(csv.reader([text], delimiter=mark))
            for key, (column, unit) in columns.items():
                cell = cells[column].strip() if column < len(cells) else ""
                try:
                    number = float(cell)
                    si = self.columns[key].unit
                    found[key].append(InSI(to_si(f"{number!r} {unit}", si)) if unit else number)
                except (UnitError, ValueError):
                    want = f"a number in {unit}" if unit else "a number"
                    got = cell or "an empty cell"
                    raise CaseError(at=key, got=got, want=want, file=path, line=line) from None
        return found

    def _places(self, path: Path, line: int, head: list[str]) -> dict[str, tuple[int, str]]:
        """Number and unit of each column, the unit empty for bare numbers."""
        columns: dict[str, tuple[int, str]] = {}
        for i, title in enumerate(head):
            match = _HEADER.fullmatch(title)
            word = re.sub(r"[\s_]", "", match.group(1)).casefold() if match else ""
            key = next((k for k, column in self.columns.items() if word in column.names), None)
            if match is None or key is None:
                continue
            if key in columns:
                want = f"each of {', '.join(self.columns)} once"
                raise CaseError(at=key, want=want, file=path, line=line)
            unit = match.group(2) or self.columns[key].implied.get(word, "")
            if unit == "-" and not self.columns[key].unit:  # pure numbers, as tables of results have them
                unit = ""
            if not unit and not self.bare and self.columns[key].unit:
                want = f"a unit in brackets: {self.example}"
                raise CaseError(at=key, got=title, want=want, file=path, line=line)
            try:
                to_si(f"1 {unit}", self.columns[key].unit)
            except UnitError as error:
                raise CaseError(
                    at=key, got=title, want=error.want, hint=error.hint, file=path, line=line
                ) from None
            columns[key] = (i, unit)
        missing = [key for key in self.columns if key not in columns]
        if missing:
            got = ", ".join(head) if columns else "a line without these names"
            want = f"a header such as {self.example}"
            raise CaseError(at=missing[0], got=got, want=want, file=path, line=line)
        return columns
