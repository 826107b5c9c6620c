"""Sizes as the trade writes them: `5 1/2`, `5-1/2 in`, `5"`, `127 mm`; and units of the tables."""

from __future__ import annotations

import re
from fractions import Fraction

INCH = 0.0254  # [m]
LB_PER_FT = 0.45359237 / 0.3048  # [kg/m]
LBF = 0.45359237 * 9.80665  # [N]
FT_LBF = LBF * 0.3048  # [N m]
KSI = 1e3 * LBF / INCH**2  # [Pa]

LONGEST = 200  # letters of a text that are read

#: `5`, `5.5`, `5 1/2`, `5-1/2`, `1/2`, with an inch or millimetre sign or without
SIZE = re.compile(
    r"""(?:(?:(?P<whole>\d+)(?:\s+|-))?(?P<over>\d+)/(?P<under>\d+)|(?P<number>\d+(?:\.\d*)?|\.\d+))
        \s*(?P<unit>inches|inch|in\b\.?|"|''|mm\b)?""",
    re.VERBOSE | re.IGNORECASE,
)


def size_at_start(text: str) -> tuple[float, str] | None:
    """(size [in], rest of the text) of a text that starts with a size; None if it does not."""
    match = SIZE.match(text[:LONGEST])
    if match is None or (match["under"] and int(match["under"]) == 0):
        return None
    if match["over"]:
        size = float(int(match["whole"] or 0) + Fraction(int(match["over"]), int(match["under"])))
    else:
        size = float(match["number"])
    return size / (25.4 if (match["unit"] or "").lower() == "mm" else 1.0), text[match.end() :]


def inches(text: str) -> float | None:
    """Size [in] of a text that is nothing but a size; None for any other text."""
    found = size_at_start(text.strip())
    return found[0] if found is not None and not found[1].strip() else None


def inch_text(value: float) -> str:
    """Size [in] as text: `5 1/2 in` for multiples of 1/16 in, else `4.276 in`."""
    sixteenths = round(value * 16)
    if abs(value * 16 - sixteenths) > 1e-6:
        return f"{value:.4g} in"
    whole, part = divmod(sixteenths, 16)
    fraction = Fraction(part, 16)
    words = [str(whole)] if whole or not part else []
    return " ".join([*words, *([str(fraction)] if part else [])]) + " in"
