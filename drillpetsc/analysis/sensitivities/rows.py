"""Rows of sensitivities.csv and of summary.json."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from drillpetsc.analysis.sensitivities.derivatives import Derivative
from drillpetsc.analysis.sensitivities.doubts import Checked


def row_of(d: Derivative) -> dict[str, Any]:
    """A row of sensitivities.csv."""
    return {
        "output": d.output.name,
        "output_unit": d.output.quantity.unit,
        "bit_depth": d.output.bit_depth,
        "value": d.value,
        "key": d.key.name,
        "key_unit": d.key.unit or "-",
        "key_value": d.key.value,
        "derivative": d.slope,
        "relative": d.relative,
        "per": d.key.per,
        "effect": d.effect,
        "effect_below": d.below,
        "effect_above": d.above,
        "flag": d.flag,
    }


def row_of_check(at: Checked) -> dict[str, Any]:
    """A derivative and its difference, for summary.json."""
    return {
        "output": at.output,
        "key": at.key,
        "derivative": at.derivative,
        "difference": at.difference,
        "error": at.error,
    }


def zero_flows(found: Sequence[Derivative]) -> list[str]:
    """Keys that are flow rates of zero."""
    return list(dict.fromkeys(d.key.name for d in found if d.key.unit == "m3/s" and not d.key.value))


def without_effect(found: Sequence[Derivative]) -> list[str]:
    """Keys that change none of the outputs."""
    effective = {d.key.name for d in found if d.slope}
    return list(dict.fromkeys(d.key.name for d in found if d.key.name not in effective))
