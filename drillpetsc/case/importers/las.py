"""Survey curves of a LAS 1.2 or 2.0 file, through lasio."""

from __future__ import annotations

import io
import logging
import math
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from drillpetsc.case.files.named_file import bytes_of
from drillpetsc.case.importers.sheet import INSTALL
from drillpetsc.case.importers.table import MAX_BYTES, MAX_ROWS, Table, columns_of, is_unit, unit_text
from drillpetsc.errors import CaseError


def curves_of(
    file: Path, text: str | None = None, versions: str = "1.2 or 2.0"
) -> list[tuple[str, str, list[Any]]]:
    """(mnemonic, unit or "", values) of the curves of a LAS file; CaseError without lasio, and for another file.

    text: of the file, where it has been read; versions: that the caller reads, for the message.
    """
    try:
        import lasio
    except ImportError:
        want = "a CSV file, unless the package lasio is installed"
        raise CaseError(got=file.name, want=want, hint=INSTALL, file=file, line=1) from None
    if text is None:
        text = bytes_of(file, MAX_BYTES).decode("utf-8-sig", "replace")
    quiet = logging.root.manager.disable
    logging.disable(logging.CRITICAL)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            las = lasio.read(io.StringIO(text, newline=None), null_policy="strict")
            return [(str(c.mnemonic), str(c.unit or "").strip(), list(c.data)) for c in las.curves]
    except Exception as error:  # lasio raises many kinds for files that are none
        hint = " ".join(str(error).split())[:200]
        want = f"a LAS file of version {versions}"
        raise CaseError(got=file.name, want=want, hint=hint, file=file, line=1) from None
    finally:
        logging.disable(quiet)


def table_of_las(file: Path, given: Mapping[str, str] | None = None) -> Table:
    """The curves of a LAS file. Rows are counted from the first of the data."""
    curves = curves_of(file)
    remarks: list[str] = []
    heads = [name.partition(":")[0] for name, _, _ in curves]  # lasio numbers equal names: AZI:1, AZI:2
    columns = columns_of(heads, file, 1, remarks, given)
    if columns is None:
        want = "curves of measured depth, inclination and azimuth"
        got = ", ".join(heads)[:200] or "no curves"
        raise CaseError(at="md", got=got, want=want, file=file, line=1)
    with_units = {}
    for column, (i, _) in columns.items():
        unit = {"f": "ft", "m": "m"}.get(curves[i][1].casefold(), unit_text(curves[i][1]))
        if unit and not is_unit(unit, column):
            want = {"m": "a length, such as M or FT"}.get(unit, "a unit of this curve")
            raise CaseError(at=column, got=f"{heads[i]}.{curves[i][1]}", want=want, file=file, line=1)
        with_units[column] = (i, unit)
    count = max((len(data) for _, _, data in curves), default=0)
    if count > MAX_ROWS:
        raise CaseError(got="more", want=f"at most {MAX_ROWS} stations", file=file, line=1)
    rows = [
        (k + 1, [cell_of(data[k]) if k < len(data) else "" for _, _, data in curves]) for k in range(count)
    ]
    return Table(file, heads, 1, with_units, rows, "row", "", "", remarks)


def cell_of(value: Any) -> str:
    """A value as text: numbers with all digits, empty if there is none."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        return str(value).strip()
    return "" if math.isnan(number) else repr(number)
