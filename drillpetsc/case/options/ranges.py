"""Numbers and words of options: lists such as `400,500,600 gpm` and `30 l/s, 500 gpm`, ranges `20..200 ft/min` and `0:240:10 rpm`."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

import numpy as np

from drillpetsc.case.key_paths import suggestion
from drillpetsc.case.quantities import Quantity
from drillpetsc.errors import CaseError
from drillpetsc.unit_systems import System, unit_of_bare_number
from drillpetsc.units import UnitError, to_si

Numbers = str | float | Sequence[str | float]

RANGE_COUNT = 10  # values of a range a..b
MOST_VALUES = 2000  # values of a range a:b:step
SPEED = Quantity("rad/s", at_least=0, at_most=1e3, why="the string turns clockwise", kind="none")
_RANGE = re.compile(r"(.+?)\.\.(.+)")
_STEPS = re.compile(r"([^:]+):([^:]+):([^:]+)")
_BARE = re.compile(r"\s*[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?\s*")
WITH_UNIT = re.compile(r".*\d\.?\s*[a-zA-Z].*")


def read_numbers(
    text: Numbers, quantity: Quantity, at: str, example: str, units: System = "SI"
) -> tuple[float, ...]:
    """Read numbers [SI] from text; one without a unit takes the unit of the next number that has one.

    text: numbers with commas between them; `a..b` stands for ten values in equal steps from a to b, `a:b:step` for those from a to b in
    steps.  From Python also a number in SI, or a list of numbers and texts.
    quantity: unit and bounds of each number.
    at, example: name of the option and an example, for messages.
    units: of bare numbers in text; numbers from Python are in SI.
    Raises CaseError.
    """
    if not isinstance(text, str):
        given = text if isinstance(text, Iterable) else [text]
        return tuple(v for part in given for v in _of_python(part, quantity, at, example, units))
    parts = [_ends(part) for part in text.split(",")]
    if not all(word for part in parts for word in part):
        raise CaseError(at=at, got=text, want=f"numbers with commas between them, such as {example}")
    unit = ""
    for part in reversed(parts):
        for k in reversed(range(len(part))):
            if _BARE.fullmatch(part[k]):
                part[k] = f"{part[k]} {unit}".strip()
            else:
                unit = re.sub(_BARE, "", part[k], count=1)
    free = Quantity(quantity.unit, kind=quantity.kind)  # of steps: no bounds
    out: list[float] = []
    for part, given in zip(parts, text.split(","), strict=True):
        ends = [_number(word, quantity, at, example, units) for word in part[:2]]
        if len(part) == 1:
            out += ends
        elif ends[1] <= ends[0]:
            raise CaseError(at=at, got=given.strip(), want="a range from a smaller to a larger number")
        else:
            steps = [_number(word, free, at, example, units) for word in part[2:]]
            out += _values(ends, steps, at, given.strip())
    return tuple(out)


def _ends(part: str) -> list[str]:
    """The words of a number or a range."""
    match = _STEPS.fullmatch(part) or _RANGE.fullmatch(part)
    return [word.strip() for word in (match.groups() if match else (part,))]


def _values(ends: list[float], steps: list[float], at: str, text: str) -> list[float]:
    """The values of a range.  steps: its step, empty for ten values."""
    first, last = ends
    if not steps:
        return [float(f"{value:.12g}") for value in np.linspace(first, last, RANGE_COUNT)]
    (step,) = steps
    if not 0 < step <= (last - first) * (1 + 1e-9):
        raise CaseError(at=at, got=text, want="a step above 0, not larger than the range")
    if round((last - first) / step) + 1 > MOST_VALUES:
        raise CaseError(at=at, got=text, want=f"at most {MOST_VALUES} values")
    values = first + step * np.arange(int(np.floor((last - first) / step * (1 + 1e-9))) + 1)
    return [float(f"{value:.12g}") for value in values]


def _of_python(
    value: str | float, quantity: Quantity, at: str, example: str, units: System
) -> tuple[float, ...]:
    if isinstance(value, str):
        return read_numbers(value, quantity, at, example, units)
    return read_numbers(repr(float(value)), quantity, at, example)


def _number(word: str, quantity: Quantity, at: str, example: str, units: System) -> float:
    bare = _BARE.fullmatch(word) is not None
    own = unit_of_bare_number(quantity.unit, quantity.kind, units) or quantity.unit
    try:
        value = to_si(f"{word.strip()} {own}" if bare else word, quantity.unit)
    except UnitError as error:
        raise CaseError(at=at, got=word, want=error.want, hint=error.hint) from None
    if not quantity.inside(value):
        unit = f"a bare number is in {own}; " if own else ""
        hint = f"{unit}such as {example}" if bare else quantity.why
        raise CaseError(at=at, got=word, want=f"a number {quantity.allowed()}", hint=hint)
    return value


def read_speeds(text: Numbers, at: str, lowest_above_zero: bool = False) -> tuple[float, ...]:
    """Read rotary speeds [rad/s], ascending, from text such as ``0:240:10 rpm`` (first:last:step) or ``60,90,120 rpm``.

    text: speeds with a unit; from Python also numbers in rad/s.
    at: name of the option, for messages; lowest_above_zero: a speed of zero is refused.
    Raises CaseError.
    """
    if isinstance(text, str) and not WITH_UNIT.fullmatch(text):
        raise CaseError(at=at, got=text, want="rotary speeds with a unit, such as 0:240:10 rpm or 60,90 rpm")
    values = read_numbers(text, SPEED, at, "60,90,120 rpm")
    if any(b <= a for a, b in zip(values, values[1:], strict=False)):
        raise CaseError(at=at, got=str(text), want="speeds in ascending order, each once")
    if lowest_above_zero and values[0] == 0:
        raise CaseError(at=at, got=str(text), want="speeds above 0: at rest nothing is excited")
    return values


def read_words(text: str | Sequence[str], allowed: tuple[str, ...], at: str) -> tuple[str, ...]:
    """Read words with commas between them, each once; CaseError for one that is not allowed."""
    words = tuple(
        dict.fromkeys(word.strip() for word in (text.split(",") if isinstance(text, str) else text))
    )
    for word in words:
        if word not in allowed:
            raise CaseError(
                at=at, got=word, want=f"one or more of {', '.join(allowed)}", hint=suggestion(word, allowed)
            )
    return words


def time_or_depth(text: str, at: str) -> float:
    """A time [s] or a depth [m] out of text with its unit; raises CaseError."""
    for unit in ("s", "m"):
        try:
            return to_si(text, unit)
        except UnitError:
            continue
    raise CaseError(at=at, got=text, want="a time, such as 2 h, or a depth, such as 2100 m")
