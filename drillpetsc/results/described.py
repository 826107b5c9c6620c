"""Description of a column of a table: its words, its unit for other programs, and its unit in a system of units."""

from __future__ import annotations

import re
from functools import cache

import numpy as np

from drillpetsc.fem.quantity import DEPTH, NAME, Quantity
from drillpetsc.output.catalogue import all_quantities, outputs_by_file
from drillpetsc.output.files.tables import split_name
from drillpetsc.output.shown_units import unit_of
from drillpetsc.unit_systems import System

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


def in_system(title: str, values: np.ndarray, system: System) -> tuple[str, np.ndarray]:
    """(heading with unit, values) of a column in a system of units; no unit for words and pure numbers.

    title: heading with the unit of the file; values: (n,) in that unit.
    """
    name, unit = split_name(title)
    if values.dtype.kind not in "fiu" or unit in ("-", ""):
        return name, values
    size, zero, text = unit_of(title, system) if system != "SI" else (1.0, 0.0, unit)
    return f"{name} [{text}]", (values - zero) / size
