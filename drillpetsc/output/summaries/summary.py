"""A result is a data class: its fields are the keys of summary.json, with unit and meaning.

    @dataclass(frozen=True, kw_only=True)
    class LimitsSummary(Summary):
        hook_load: Annotated[float, "N", "Hook load of the string."]
        hook_load_total: Annotated[float | Missing, "N", "Hook load with the block.", BLOCK] = MISSING

The command creates it, so a key cannot be without a description, nor a description without its key.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from enum import Enum
from typing import Any, get_args, get_type_hints


class Missing(Enum):
    """Value of a key that a result does not have; null is a value of its own."""

    MISSING = "missing"


MISSING = Missing.MISSING
QUANTITIES = "quantities"
"""Metadata of a field whose values are keys of the result itself: quantities, which the catalogue describes."""


@dataclass(frozen=True)
class SummaryKey:
    """One key of summary.json.

    name: path of the key, ``energy.error`` for ``error`` in the block ``energy``; a path may name a whole block.
    unit: as in ``Quantity``; empty for text, blocks and truth values.
    doc: one sentence.
    condition: what the case or the run must contain for the key to exist; empty: always.
    """

    name: str
    unit: str
    doc: str
    condition: str = ""


@dataclass(frozen=True, kw_only=True)
class Summary:
    """A result, or a block of one.

    The metadata of a field are unit, meaning, and the condition under which the key exists; of a field that is a block of its own
    the condition alone.
    """

    def as_dict(self) -> dict[str, Any]:
        """Keys and values for summary.json, in the order of the fields."""
        out: dict[str, Any] = {}
        for name in (q.name for q in fields(self)):
            value = getattr(self, name)
            if name == QUANTITIES:
                out |= value
            elif value is not MISSING:
                out[name] = value.as_dict() if isinstance(value, Summary) else value
        return out

    @classmethod
    def described(cls, path: str = "", condition: str = "") -> tuple[SummaryKey, ...]:
        """The keys.  path: of the block, with its dot; condition: of the block."""
        out: list[SummaryKey] = []
        for name, hint in get_type_hints(cls, include_extras=True).items():
            kind, *metadata = get_args(hint)
            if name == QUANTITIES:
                continue
            blocks = [q for q in (kind, *get_args(kind)) if isinstance(q, type) and issubclass(q, Summary)]
            if blocks:
                out += blocks[0].described(f"{path}{name}.", metadata[0] if metadata else condition)
            else:
                unit, doc, *when = metadata
                out.append(SummaryKey(path + name, unit, doc, when[0] if when else condition))
        return tuple(out)
