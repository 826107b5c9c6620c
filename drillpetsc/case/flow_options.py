"""Options of hydraulics and surge: lists of numbers such as `400,500,600 gpm`, `20..200 ft/min`, `30 l/s, 500 gpm`."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from drillpetsc.case.blocks.window import Window
from drillpetsc.case.key_paths import suggestion
from drillpetsc.case.quantities import Quantity
from drillpetsc.errors import CaseError
from drillpetsc.unit_systems import System, unit_of_bare_number
from drillpetsc.units import UnitError, to_si

FLOW = Quantity("m^3/s", above=0, at_most=1)
PRESSURE = Quantity("Pa", above=0, at_most=1e9, kind="pressure")
SPEED = Quantity("m/s", above=0, at_most=10, kind="trip_speed")
DEPTH = Quantity("m", above=0, at_most=50e3)
DENSITY = Quantity("kg/m^3", above=0, at_most=5e3, kind="mud_weight")

RANGE_COUNT = 10  # values of a range
_RANGE = re.compile(r"(.+?)\.\.(.+)")
_BARE = re.compile(r"\s*[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?\s*")


def read_numbers(
    text: str | float | Sequence[str | float],
    quantity: Quantity,
    at: str,
    example: str,
    units: System = "SI",
) -> tuple[float, ...]:
    """Read numbers [SI] from text; one without a unit has that of the next number that has one.

    text: numbers with commas between them; `a..b` stands for ten values in equal steps from a to b.  From Python also a
    number in SI, or a list of numbers and texts.
    quantity: unit and bounds of each number.
    at, example: name of the option and an example, for messages.
    units: of bare numbers in text; numbers from Python are in SI.
    Raises CaseError.
    """
    if not isinstance(text, str):
        given = text if isinstance(text, Iterable) else [text]
        return tuple(v for part in given for v in _of_python(part, quantity, at, example, units))
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
    numbers = iter([_number(word, quantity, at, example, units) for word in words])
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


def _of_python(
    value: str | float, quantity: Quantity, at: str, example: str, units: System
) -> tuple[float, ...]:
    if isinstance(value, str):
        return read_numbers(value, quantity, at, example, units)
    return read_numbers(repr(float(value)), quantity, at, example)


def _ends(part: str) -> tuple[str, ...]:
    match = _RANGE.fullmatch(part)
    return match.groups() if match else (part,)


def _number(word: str, quantity: Quantity, at: str, example: str, units: System) -> float:
    bare = _BARE.fullmatch(word) is not None
    own = unit_of_bare_number(quantity.unit, quantity.kind, units) or quantity.unit
    try:
        value = to_si(f"{word.strip()} {own}" if bare else word, quantity.unit)
    except UnitError as error:
        raise CaseError(at=at, got=word, want=error.want, hint=error.hint) from None
    if not quantity.inside(value):
        hint = f"a bare number is in {own}; such as {example}" if bare else ""
        raise CaseError(at=at, got=word, want=f"a number {quantity.allowed()}", hint=hint)
    return value


def read_number(text: str | float, quantity: Quantity, at: str, example: str, units: System = "SI") -> float:
    """Read one number [SI]; arguments and errors as in `read_numbers`."""
    values = read_numbers(text, quantity, at, example, units)
    if len(values) != 1:
        raise CaseError(at=at, got=text, want=f"one number, such as {example}")
    return values[0]


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


# ---------------------------------------------------------------------- options of the commands
OPERATIONS = ("trip_in", "trip_out")
PIPES = ("closed", "open", "pumping")

Numbers = str | float | Sequence[str | float]


@dataclass(frozen=True)
class Trips:
    """What `surge` computes.

    speeds: [m/s]; operations: of OPERATIONS; pipes: of PIPES.
    bit_depths: measured [m], None: the case's own and, with a window, some along the open hole.
    window: instead of the case's; flow: rate of the pump while pumping [m3/s], None: that of the case.
    dynamic: a run from rest for each speed, too.
    """

    speeds: tuple[float, ...]
    operations: tuple[str, ...] = OPERATIONS
    pipes: tuple[str, ...] = ("closed", "open")
    bit_depths: tuple[float, ...] | None = None
    window: Window | None = None
    flow: float | None = None
    dynamic: bool = False


def read_flows(
    flow: Numbers | None, spp: str | float | None, units: System = "SI"
) -> tuple[tuple[float, ...] | None, float | None]:
    """Flow rates [m3/s] and pump pressure [Pa] of the options of `hydraulics`; CaseError for both at once."""
    if flow is not None and spp is not None:
        raise CaseError(at="--spp", want="--flow or --spp, not both")
    return (
        None if flow is None else read_numbers(flow, FLOW, "--flow", "400,500 gpm", units),
        None if spp is None else read_number(spp, PRESSURE, "--spp", "3000 psi", units),
    )


def read_trips(
    speed: Numbers,
    operation: str | Sequence[str] = OPERATIONS,
    pipe: str | Sequence[str] = ("closed", "open"),
    bit_depth: Numbers | None = None,
    window: Numbers | None = None,
    flow: str | float | None = None,
    dynamic: bool = False,
    units: System = "SI",
) -> Trips:
    """Read the options of `surge`; CaseError names the option.  units: of bare numbers in text."""
    pipes = read_words(pipe, PIPES, "--pipe")
    if flow is not None and "pumping" not in pipes:
        raise CaseError(at="--flow", got=flow, want="--flow together with --pipe pumping")
    return Trips(
        read_numbers(speed, SPEED, "--speed", "30,60 ft/min", units),
        read_words(operation, OPERATIONS, "--operation"),
        pipes,
        None if bit_depth is None else read_numbers(bit_depth, DEPTH, "--bit-depth", "1000,2000 m", units),
        None if window is None else _window(window, units),
        None if flow is None else read_number(flow, FLOW, "--flow", "400 gpm", units),
        dynamic,
    )


def _window(text: Numbers, units: System) -> Window:
    """One pair of limits at all depths."""
    values = read_numbers(text, DENSITY, "--window", "11.2,13.8 ppg", units)
    if len(values) != 2 or values[1] <= values[0]:
        want = "two densities, PORE,FRAC, with frac above pore, such as 11.2,13.8 ppg"
        raise CaseError(at="--window", got=str(text), want=want)
    return Window(pore=values[:1], frac=values[1:])
