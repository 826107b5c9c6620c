"""Old words of the case file. A case that uses one is refused with the new word.

A renamed key or value needs one line in a table below.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from drillpetsc.case.key_paths import Path, written
from drillpetsc.errors import CaseError

EACH = "[]"
"""Stands for every entry of a list in the paths below: ("string", EACH, "od")."""

RENAMED_KEYS: dict[Path, str] = {
    ("formation", "freeze_interval"): "node_spacing",
}
"""Path of an old key -> new key in the same block."""

RENAMED_VALUES: dict[Path, dict[str, str]] = {
    ("beam", "formulation"): {"gauge": "ancf"},
}
"""Path of a key -> old value -> new value."""


def check_old_words(data: Mapping[str, Any]) -> None:
    """Raise CaseError for the first old key or value in the data of a case."""
    for pattern, new in RENAMED_KEYS.items():
        for path, value in _found(data, pattern):
            old = str(path[-1])
            raise CaseError(at=written(path), got=value, want=new, hint=f"{old} is now called {new}")
    for pattern, new_of in RENAMED_VALUES.items():
        for path, value in _found(data, pattern):
            if isinstance(value, str) and value in new_of:
                hint = f"{value} is now called {new_of[value]}"
                raise CaseError(at=written(path), got=value, want=new_of[value], hint=hint)


def _found(data: Any, pattern: Path, at: Path = ()) -> Iterator[tuple[Path, Any]]:
    """(path, value) of everything in the data that a path with EACH describes."""
    if not pattern:
        yield at, data
    elif pattern[0] == EACH and isinstance(data, (list, tuple)):
        for i, entry in enumerate(data):
            yield from _found(entry, pattern[1:], (*at, i))
    elif isinstance(data, Mapping) and pattern[0] in data:
        yield from _found(data[pattern[0]], pattern[1:], (*at, pattern[0]))
