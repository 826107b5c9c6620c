"""Columns of the tables that commands write: `tables.csv` has a row for each column.

A row with a name alone is a quantity that is declared above it, or that is also measured along the string or during a run.
"""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

from drillpetsc.fem.quantity import Quantity
from drillpetsc.output.quantities.along_string import STRING_FIELDS
from drillpetsc.output.quantities.history import HOOK_LOAD_TOTAL, LOWER_END, TIME, TOP_END, TOP_TRAVEL
from drillpetsc.output.quantities.mud import MUD, MUD_FIELDS, SIDE_FLOW
from drillpetsc.physics.quantities import BIT, CONTACT

_ENDS = (*TOP_END, HOOK_LOAD_TOTAL, TOP_TRAVEL, *LOWER_END, *BIT)
_MEASURED = (TIME, *STRING_FIELDS, *CONTACT, *_ENDS, *MUD, SIDE_FLOW, *MUD_FIELDS)


def _read() -> dict[str, tuple[Quantity, ...]]:
    known = {q.name: q for q in _MEASURED}
    columns: dict[str, tuple[Quantity, ...]] = {}
    with open(Path(__file__).with_name("tables.csv"), encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            cells: dict[str, Any] = dict(row)
            table, name = cells.pop("table"), cells["name"]
            if cells["unit"]:
                known[name] = Quantity(**cells)
            columns[table] = (*columns.get(table, ()), known[name])
    return columns


#: columns by table
COLUMNS = _read()
