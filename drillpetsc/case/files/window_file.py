"""Pressure window from a CSV file: columns tvd, pore, frac in any order, others ignored."""

from __future__ import annotations

from drillpetsc.case.files.quantity_file import QuantityColumn, QuantityFile

_FILE = QuantityFile(
    {
        "tvd": QuantityColumn("m", ("tvd",), {}),
        "pore": QuantityColumn("kg/m^3", ("pore",), {}),
        "frac": QuantityColumn("kg/m^3", ("frac",), {}),
    },
    "tvd [ft], pore [ppg], frac [ppg]",
    "{pore: ..., frac: ...}, or {tvd: [...], pore: [...], frac: [...]}",
    bare=True,
)


def read_window(name: str) -> dict[str, list[float]]:
    """{tvd: [m], pore: [kg/m3], frac: [kg/m3]} from a CSV file, see ``QuantityFile.read``.

    A column without a unit has the unit of the case's bare numbers.
    """
    return _FILE.read(name)
