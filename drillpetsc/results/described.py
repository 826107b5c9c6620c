"""Description of a column of a table: its words, its unit for other programs, and its unit in a system of units."""

from __future__ import annotations

import re
from functools import cache
from typing import Any

import numpy as np

from drillpetsc.fem.quantity import DEPTH, NAME, Quantity
from drillpetsc.output.catalogue import all_quantities, outputs_by_file
from drillpetsc.output.files.run_folder import HYDRAULICS_TABLES
from drillpetsc.output.files.tables import split_name
from drillpetsc.output.shown_units import shown_unit
from drillpetsc.unit_systems import System, display, kind_of
from drillpetsc.units import to_si

_DOGLEG = "deg/30m"


@cache
def quantity_of(name: str, file: str) -> Quantity | None:
    """The quantity of a column of a file, else the quantity of this name in any file; None if there is none."""
    own = outputs_by_file().get(file, ())
    return next((q for q in (*own, *all_quantities()) if q.matches(name)), None)


def attributes(title: str, file: str, words: bool = False) -> dict[str, str]:
    """Attributes of a column: units, long_name, label, mnemonic, sign, description; only those that it has.

    title: heading of the column, `wob [N]`; file: its table, `history.csv`; words: the column has words, which have no unit.
    """
    name, unit = split_name(title)
    found = {} if words or not unit else {"units": readable_unit(unit)}
    q = quantity_of(name, file)
    if q is None:
        return found | {"long_name": name.replace("_", " ")}
    place = q.place(name) or ""
    if q.tool and place:
        q = q.numbered(int(place))
    texts = {
        "long_name": q.label,
        "label": q.label,
        "mnemonic": q.mnemonic,
        "sign": q.sign,
        "description": q.doc,
    }
    return found | {
        key: text.replace(DEPTH, place).replace(NAME, place) if place else text
        for key, text in texts.items()
        if text
    }


def readable_unit(unit: str) -> str:
    """A unit of a heading as pint and UDUNITS read it: `m3/s` is `m^3/s`, `-` is `1`."""
    if unit == "-":
        return "1"
    if unit == _DOGLEG:
        return "deg/(30 m)"
    return re.sub(r"(?<=[A-Za-z])(\d)(?!\d)", r"^\1", unit)


def in_system(title: str, values: np.ndarray, file: str, system: System) -> tuple[str, np.ndarray]:
    """(heading with unit, values) of a column in a system of units; no unit for words and pure numbers.

    title, file: as for `attributes`; values: (n,) in the unit of the heading
    """
    name, unit = split_name(title)
    if values.dtype.kind not in "fiu" or unit in ("-", ""):
        return name, values
    if system != "SI":
        if file in HYDRAULICS_TABLES:
            size, unit = shown_unit(name, unit, system)
            return f"{name} [{unit}]", values / size
        if unit == _DOGLEG:
            values, unit = values * to_si(f"1 {_DOGLEG}", "1/m"), "1/m"
        q = quantity_of(name, file)
        kind = kind_of(unit, q.kind if q is not None else "")
        if kind:
            shown: Any = display(values, kind, system)
            values, unit = shown
    return f"{name} [{unit}]", values
