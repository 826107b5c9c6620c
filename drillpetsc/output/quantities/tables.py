"""Columns of the tables that commands write: `tables.csv` has a row for each column, with the name of its condition in ``conditions``.

A row without a unit is a quantity that is declared above it, or that is also measured along the string or during a run.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from drillpetsc.fem.quantity import Quantity
from drillpetsc.output import conditions
from drillpetsc.output.quantities.along_string import STRING_FIELDS
from drillpetsc.output.quantities.history import HOOK_LOAD_TOTAL, LOWER_END, TIME, TOP_END, TOP_TRAVEL
from drillpetsc.output.quantities.mud import MUD, MUD_FIELDS, SIDE_FLOW
from drillpetsc.physics.quantities import BIT, CONTACT

_ENDS = (*TOP_END, HOOK_LOAD_TOTAL, TOP_TRAVEL, *LOWER_END, *BIT)
_MEASURED = (TIME, *STRING_FIELDS, *CONTACT, *_ENDS, *MUD, SIDE_FLOW, *MUD_FIELDS)


def _condition(cell: str) -> str:
    """The text of one name of ``conditions``, or of several; a cell with small letters is a text itself."""
    return ", ".join(getattr(conditions, name) for name in cell.split()) if cell == cell.upper() else cell


def _read() -> dict[str, dict[Quantity, str]]:
    known = {q.name: q for q in _MEASURED}
    columns: dict[str, dict[Quantity, str]] = {}
    with open(Path(__file__).with_name("tables.csv"), encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            cells: dict[str, Any] = dict(row)
            table, condition, name = cells.pop("table"), cells.pop("condition"), cells["name"]
            if cells["unit"]:
                known[name] = Quantity(**cells)
            columns.setdefault(table, {})[known[name]] = _condition(condition)
    return columns


#: by table, which is a file or a group of columns: what the case must contain for each column to exist; empty: always
CONDITIONS = _read()
#: columns by table
COLUMNS = {table: tuple(columns) for table, columns in CONDITIONS.items()}


def columns_of(file: str, rows: Sequence[Mapping[str, Any] | Sequence[Any]]) -> list[Quantity]:
    """Columns that every such file has, and those beside them that its rows have: by name, or as many as there are cells."""
    if rows and not isinstance(rows[0], Mapping):
        return list(COLUMNS[file][: len(rows[0])])
    own, names = next(iter(CONDITIONS[file].values())), rows[0] if rows else ()
    return [q for q, condition in CONDITIONS[file].items() if condition == own or q.name in names]
