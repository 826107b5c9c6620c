"""Lists of numbers with a unit on the command line: `400,500,600 gpm`, `20..200 ft/min`, `30 l/s, 500 gpm`."""

from __future__ import annotations

import re

import numpy as np
from pydantic_core import PydanticCustomError

from drillpetsc.case.quantities import Quantity
from drillpetsc.errors import CaseError
from drillpetsc.units import UnitError, to_si

RANGE_COUNT = 10  # values of a range
_RANGE = re.compile(r"(.+?)\.\.(.+)")
_BARE = re.compile(r"\s*[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?\s*")


def read_numbers(text: str, quantity: Quantity, at: str, example: str) -> tuple[float, ...]:
    """Read numbers [SI] from text; one without a unit has that of the next number that has one.

    text: numbers with commas between them; `a..b` stands for ten equal steps from a to b.
    quantity: unit and bounds of each number.
    at, example: name of the option and an example, for messages.
    Raises CaseError.
    """
    parts = [part.strip() for part in text.split(",")]
    if not all(parts):
        raise CaseError(at=at, got=text, want=f"numbers with commas between them, such as {example}")
    words = [word.strip() for part in parts for word in _ends(part)]
    unit = ""
    for k in range(len(words) - 1, -1, -1):
        if _BARE.fullmatch(words[k]):
            words[k] = f"{words[k]} {unit}".strip()
        else:
            unit = re.sub(_BARE, "", words[k], count=1)
    numbers = iter([_number(word, quantity, at, example) for word in words])
    out: list[float] = []
    for part in parts:
        if not _RANGE.fullmatch(part):
            out.append(next(numbers))
            continue
        first, last = next(numbers), next(numbers)
        if last <= first:
            raise CaseError(at=at, got=part, want="a range from a smaller to a larger number")
        out += [float(f"{value:.12g}") for value in np.linspace(first, last, RANGE_COUNT)]
    return tuple(out)


def _ends(part: str) -> tuple[str, ...]:
    match = _RANGE.fullmatch(part)
    return match.groups() if match else (part,)


def _number(word: str, quantity: Quantity, at: str, example: str) -> float:
    bare = _BARE.fullmatch(word) is not None
    try:
        value = to_si(float(word) if bare else word, quantity.unit)
    except (UnitError, PydanticCustomError) as error:
        want = error.want if isinstance(error, UnitError) else str(error)
        hint = error.hint if isinstance(error, UnitError) else ""
        raise CaseError(at=at, got=word, want=want, hint=hint) from None
    if not quantity.inside(value):
        hint = f"a bare number is in {quantity.unit}; such as {example}" if bare else ""
        raise CaseError(at=at, got=word, want=f"a number {quantity.allowed()}", hint=hint)
    return value
