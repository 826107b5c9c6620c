"""Numbers of the distributions of `uncertain` in SI: each has the units of its key."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from drillpetsc.case.blocks.uncertain import FORMS
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import BARE_NUMBERS
from drillpetsc.case.schema import bare_unit_of
from drillpetsc.units import UnitError, bare_number, to_si

_WITH_UNIT = re.compile(r"\s*([-+]?[\d.]+(?:[eE][-+]?\d+)?)\s+(\S.*)")


def spreads_in_si(value: Any) -> Any:
    """Distributions with their numbers in SI; what is not of their form is left to the block's own checks."""
    if not isinstance(value, Mapping):
        return value
    return {name: _in_si(name, spread) for name, spread in value.items()}


def _in_si(name: Any, spread: Any) -> Any:
    if not isinstance(spread, Mapping):
        return spread
    path = re.sub(r"\[[^\]]*\]", "[0]", str(name))  # an item of the string may be named
    unit, own = bare_unit_of(path, "SI"), bare_unit_of(path, BARE_NUMBERS.get())
    out = dict(spread)
    for form, count in FORMS.items():
        values = spread.get(form)
        if not isinstance(values, list | tuple) or len(values) != count:
            continue
        out[form] = [
            _number(v, unit, own, (name, form, i), width=form.endswith("normal") and i == 1)
            for i, v in enumerate(values)
        ]
    return out


def _number(value: Any, unit: str, own: str, at: tuple[str | int, ...], width: bool) -> float:
    """A number in SI.  own: unit of one without a unit; width: a difference, which no zero of the unit shifts."""
    bare = bare_number(value)
    match = _WITH_UNIT.fullmatch(value) if isinstance(value, str) and bare is None else None
    if bare is None and match is None:
        raise refuse(*at, got=value, want="a number")
    number, word = (float(bare), own) if match is None else (float(match[1]), match[2])  # type: ignore[arg-type]
    if not word:
        return number
    try:
        zero = float(to_si(f"0 {word}", unit)) if width else 0.0
        return float(to_si(f"{number!r} {word}", unit)) - zero
    except (UnitError, ValueError):
        raise refuse(
            *at, got=value, want=f"a number in {unit}, or another unit of it" if unit else "a pure number"
        ) from None
