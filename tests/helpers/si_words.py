"""Figures in SI units that stand in a text for people: a number with such a unit behind it, or the unit in brackets."""

from __future__ import annotations

import re

ONE = (
    r"k?N m/rad|k?N m s/rad|k?N m2|k?N m|k?N/m|MN/m|[kM]?N s/m|[kMd]?N|m/s2|m/s\^2|mm/s|m/s|m/h|m/min|mm2|m2|m\^2|m3/s|m3|m\^3|mm|cm|"
    r"kg m2|kg/m3|kg/m\^3|kg/m|kg|[kMG]?Pa s\^n|m?Pa s|[kMG]?Pa/m|[kMG]?Pa|bar|rad/s|rad/m|deg/30 ?m|1/m|l/min|l/s|k?J|k?W/m|k?W|K|degC|m"
)
_BEHIND_A_NUMBER = re.compile(rf"(?<![\w.])-?\d[\d.,]*(?:e[+-]?\d+)? ({ONE})(?![\w/^*]|\.\w| of\b)")
_IN_BRACKETS = re.compile(rf"\[({ONE})\]")


def si_units(text: str) -> list[str]:
    """Every such figure or bracket with the words about it."""
    found = [m for pattern in (_BEHIND_A_NUMBER, _IN_BRACKETS) for m in pattern.finditer(text)]
    return [" ".join(text[max(0, m.start() - 60) : m.end() + 30].split()) for m in found]
