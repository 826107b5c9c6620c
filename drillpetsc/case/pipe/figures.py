"""Figures that a case did not give itself, each with its source: from the catalogue, a default, or a formula."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Figure:
    """A figure of a string item.

    key: path below the item, as in the case file; value: in SI, or a word; unit: of the value; source: its origin.
    """

    key: str
    value: float | str | bool | tuple[float, ...]
    unit: str
    source: str


@dataclass(frozen=True)
class Figures:
    """Figures of a case by the number of the string item. Two cases are equal whatever the sources of their figures."""

    of_item: Mapping[int, tuple[Figure, ...]] = field(default_factory=dict, compare=False)
    references: Mapping[int, str] = field(default_factory=dict, compare=False)
    """Text references of the items, as written in the case."""
