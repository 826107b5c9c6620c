"""Types of fields that several operations have, and the functions that check and convert their values."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Annotated, Any, Literal

from drillpetsc.errors import CaseError

if TYPE_CHECKING:  # what a user gives; a reader has made numbers and tuples of it when a computation sees it
    Numbers = Any
    Names = Any
else:
    Numbers = str | float | Sequence[str | float]
    Names = str | Sequence[str]
Kind = Annotated[
    Literal["lateral", "axial", "torsional", "fluid"] | None, "modes of this kind alone (default: all)"
]
WithoutControl = Annotated[bool, "leave out motor, hoist and controllers of the top drive, and hold the top"]

Speeds = Annotated[
    Numbers, "RANGE", "rotary speeds: FIRST:LAST:STEP as '60:240:10 rpm', '60..240 rpm', or '60,90,120 rpm'"
]


def holds(test: Callable[[Any], bool], want: str) -> Callable[[Any, str, Any], Any]:
    """A check of a value.  want: what is allowed, for the message."""

    def check(value: Any, at: str, units: Any) -> Any:
        if not test(value):
            raise CaseError(at=at, got=value, want=want)
        return value

    return check


def at_least(least: int, what: str) -> Callable[[Any, str, Any], Any]:
    """A check of a count.  what: that which is counted."""
    return holds(lambda value: value >= least, f"a number of {what}, at least {least}")


Count = Annotated[int, at_least(1, "modes"), "N", "oscillating modes, the lowest, at each speed or point"]


def rotary_speeds(above_zero: bool = False) -> Callable[[Any, str, Any], Any]:
    """Reader of rotary speeds [rad/s], ascending.  above_zero: a speed of zero is refused."""

    def read(value: Any, at: str, units: Any) -> Any:
        from drillpetsc.case.options.ranges import read_speeds

        return read_speeds(value, at, above_zero)

    return read


def numbers(
    unit: str, example: str, ascending: str = "", **bounds: Any
) -> Callable[[Any, str, Any], tuple[float, ...]]:
    """Reader of numbers [SI] from text in any unit.

    unit: in SI; bounds: as of ``Quantity``; example: for messages; ascending: what must come in ascending order.
    """

    def read(value: Any, at: str, units: Any) -> tuple[float, ...]:
        from drillpetsc.case.options.ranges import read_numbers
        from drillpetsc.case.quantities import Quantity

        found = read_numbers(value, Quantity(unit, **bounds), at, example, units)
        if ascending and any(b <= a for a, b in zip(found, found[1:], strict=False)):
            raise CaseError(at=at, got=str(value), want=f"{ascending} in ascending order, each once")
        return found

    return read


def number(unit: str, example: str, **bounds: Any) -> Callable[[Any, str, Any], float]:
    """Reader of one number [SI]; arguments as of ``numbers``."""
    read_all = numbers(unit, example, **bounds)

    def read(value: Any, at: str, units: Any) -> float:
        found = read_all(value, at, units)
        if len(found) != 1:
            raise CaseError(at=at, got=value, want=f"one number, such as {example}")
        return found[0]

    return read


def words(*allowed: str) -> Callable[[Any, str, Any], tuple[str, ...]]:
    """Reader of some of the allowed words, each once."""

    def read(value: Any, at: str, units: Any) -> tuple[str, ...]:
        from drillpetsc.case.options.ranges import read_words

        return read_words(value, allowed, at)

    return read


def names(value: Any, at: str, units: Any) -> list[str]:
    """Read names from text with commas between them; a list of names from Python stays what it is."""
    return (
        [word.strip() for word in value.split(",") if word.strip()] if isinstance(value, str) else list(value)
    )


def entries(value: Any, at: str, units: Any) -> list[str]:
    """Read the entries of a list with commas, which may have commas inside brackets; none of a list that is left out."""
    from drillpetsc.studies.sweep.variations import split_values

    return split_values(value) if value and value is not True else []


def in_unit(unit: str, want: str) -> Callable[[Any, str, Any], float]:
    """Reader of a number above 0 [SI], which has this unit where it has none."""

    def read(value: Any, at: str, units: Any) -> float:
        from drillpetsc.units import to_si

        try:
            found = to_si(value if value.strip()[-1:].isalpha() else f"{value} {unit}", unit)
        except ValueError:
            found = 0.0
        if not 0 < found < 1e9:
            raise CaseError(at=at, got=value, want=want)
        return found

    return read


@contextmanager
def reading(*runs: Any) -> Iterator[None]:
    """While run folders are read: what is wrong with one is said of it."""
    try:
        yield
    except (OSError, ValueError) as error:
        raise CaseError(at="RUN", got=" ".join(map(str, runs)), want=str(error)) from None
