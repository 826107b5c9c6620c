"""Figures in the units of the case, with the label of their quantity."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from drillpetsc.output import catalogue
from drillpetsc.output.files.tables import split_name
from drillpetsc.output.shown_units import unit_of
from drillpetsc.unit_systems import System

DIGITS = 5  # significant digits of the largest figure of a column


def label_of(title: str, system: System) -> str:
    """Words for a column, a depth in them in a system of units: the label of its quantity, else its name."""
    name, _ = split_name(title)
    return catalogue.label(name, system) or name.replace("_", " ").capitalize()


def heading_of(title: str, system: System) -> str:
    """Words and unit: `Hook load [klbf]`."""
    text = unit_of(title, system)[2]
    return f"{label_of(title, system)} [{text}]" if text else label_of(title, system)


def in_units(title: str, values: Any, system: System) -> np.ndarray:
    """Values (n,) of a column in the unit of `unit_of`."""
    size, zero, _ = unit_of(title, system)
    return (np.asarray(values, dtype=float) - zero) / size


def texts(values: np.ndarray, digits: int = DIGITS) -> list[str]:
    """Numbers (n,) as texts with a common count of decimals; `-` for values that are not numbers."""
    finite = np.abs(values[np.isfinite(values)])
    largest = float(finite.max()) if finite.size else 0.0
    whole = np.allclose(finite, np.round(finite), rtol=1e-9, atol=0.0)  # up to the rounding of units
    if finite.size and whole and largest < 1e9:
        decimals = 0
    else:
        decimals = 0 if largest == 0 else digits - 1 - math.floor(math.log10(largest))
    if decimals > 9:
        return [f"{value:.{digits}g}" if math.isfinite(value) else "-" for value in values]
    decimals = max(decimals, 0)
    shown = [f"{value:.{decimals}f}" if math.isfinite(value) else "-" for value in values]
    return [
        text[1:] if text.startswith("-") and not text.strip("-0.") and text != "-" else text for text in shown
    ]


def number(value: Any, title: str, system: System) -> tuple[str, str]:
    """(number as text, unit text) of a single figure in SI."""
    _, _, text = unit_of(title, system)
    if value is None:
        return "-", text
    return texts(in_units(title, [value], system))[0], text
