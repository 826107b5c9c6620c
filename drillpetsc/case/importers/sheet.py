"""Tables of survey columns in a spreadsheet (xlsx), through openpyxl."""

from __future__ import annotations

import io
import math
import warnings
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from drillpetsc.case.files.named_file import bytes_of
from drillpetsc.case.importers.table import (
    MAX_BYTES,
    MAX_ROWS,
    Table,
    columns_of,
    unit_in_comments,
    units_below,
)
from drillpetsc.errors import CaseError

HEADER_ROWS = 40
MAX_UNPACKED = 400_000_000  # bytes of the tables of a workbook
INSTALL = "pip install 'drillpetsc[files]'"


def table_of_sheet(file: Path, sheet: str = "", given: Mapping[str, str] | None = None) -> Table:
    """The table of a sheet; without a name, of the only sheet that has a survey's columns."""
    sheets = sheets_of(file, sheet)
    found = [table for rows in sheets.values() for table in [_table(file, rows, given)] if table]
    if not found:
        want = f"a header with md, inclination, azimuth within {HEADER_ROWS} rows"
        raise CaseError(at="md", got="rows without these names", want=want, file=file, line=1)
    if len(found) > 1:
        want = f"the name of one sheet: {file.name}#{next(iter(sheets))}"
        raise CaseError(at="sheet", got=f"{len(found)} sheets with a survey", want=want, file=file, line=1)
    return found[0]


@contextmanager
def workbook(file: Path, most: int = MAX_BYTES) -> Iterator[Any]:
    """An open workbook, whose sheets are read within this context.

    CaseError without openpyxl, for a file that is no workbook, and for one of more than ``most`` bytes.
    """
    try:
        import openpyxl
    except ImportError:
        want = "a CSV file, unless the package openpyxl is installed"
        raise CaseError(got=file.name, want=want, hint=INSTALL, file=file, line=1) from None
    raw = bytes_of(file, most)
    try:
        size = sum(part.file_size for part in zipfile.ZipFile(io.BytesIO(raw)).infolist())
        if size > max(MAX_UNPACKED, 4 * most):
            raise ValueError(f"{size // 10**6} MB once unpacked")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            book = openpyxl.load_workbook(io.BytesIO(raw), read_only=True, data_only=True)
        try:
            yield book
        finally:
            book.close()
    except (CaseError, OSError):
        raise
    except (
        Exception
    ) as error:  # of zipfile, xml and openpyxl, which reads sheets only when it is asked for them
        hint = " ".join(str(error).split())[:200]
        raise CaseError(
            got=file.name, want="a workbook in the format xlsx", hint=hint, file=file, line=1
        ) from None


def sheets_of(file: Path, sheet: str = "", count: int | None = None) -> dict[str, list[list[str]]]:
    """Cells of the sheets of a workbook as texts, by their names; of one sheet if it is named, else of the first ``count`` or all.

    CaseError for a name that no sheet has.
    """
    with workbook(file) as book:
        names = [name for name in book.sheetnames if hasattr(book[name], "iter_rows")]
        if sheet and sheet not in names:
            raise CaseError(at="sheet", got=sheet, want=f"one of {', '.join(names)}", file=file, line=1)
        most = {"max_row": MAX_ROWS + HEADER_ROWS + 1, "max_col": 200, "values_only": True}
        return {
            name: [[cell_text(cell) for cell in row] for row in book[name].iter_rows(**most)]
            for name in ([sheet] if sheet else names[:count])
        }


def cell_text(cell: Any) -> str:
    """A cell as text: numbers with all digits, empty if there is none."""
    if cell is None or (isinstance(cell, float) and math.isnan(cell)):
        return ""
    return (
        repr(float(cell))
        if isinstance(cell, (int, float)) and not isinstance(cell, bool)
        else str(cell).strip()
    )


def _table(file: Path, rows: list[list[str]], given: Mapping[str, str] | None) -> Table | None:
    remarks: list[str] = []
    for number, heads in enumerate(rows[:HEADER_ROWS], 1):
        columns = columns_of([head[:200] for head in heads], file, number, remarks, given)
        if columns:
            break
    else:
        return None
    unit = unit_in_comments([" ".join(row) for row in rows[: number - 1]])
    below = [(i, row) for i, row in enumerate(rows[number:], number + 1) if any(row)]
    if below:
        units = units_below(below[0][1], columns)
        if units is not None:
            columns, below = units, below[1:]
    if len(below) > MAX_ROWS:
        raise CaseError(got="more", want=f"at most {MAX_ROWS} stations", file=file, line=number)
    comma = "thousands" if any("," in cell for _, row in below for cell in row) else ""
    return Table(file, heads, number, columns, below, "row", comma, unit, remarks)
