"""Options of `freepoint`: pairs of stretch and pull, such as `10,24 in` and `12,30 klb`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from drillpetsc.case.blocks.rig import STANDARD_GRAVITY
from drillpetsc.case.options.ranges import read_numbers
from drillpetsc.case.quantities import Quantity
from drillpetsc.errors import CaseError

STRETCH = Quantity("m", above=0, at_most=100)
PULL = Quantity("N", above=0, at_most=1e8)
MASS = Quantity("kg", above=0, at_most=1e7)


@dataclass(frozen=True)
class Pair:
    """Stretch [m] of the string at the surface under a pull [N] in excess of its free weight."""

    stretch: float
    pull: float


def read_pairs(
    stretch: str | float | Sequence[str | float], pull: str | float | Sequence[str | float]
) -> tuple[Pair, ...]:
    """Read stretches and pulls; a pull with a unit of mass is multiplied by standard gravity, as in `30 klb`.

    From Python also numbers in SI.
    Raises CaseError if a number is wrong, or the two lists differ in length.
    """
    for at, text, example in (("--stretch", stretch, "24 in"), ("--pull", pull, "30 klb")):
        if isinstance(text, str) and not any(letter.isalpha() for letter in text.rpartition(",")[2]):
            raise CaseError(at=at, got=text, want=f"a number with a unit, such as {example}")
    stretches = read_numbers(stretch, STRETCH, "--stretch", "24 in")
    try:
        pulls = read_numbers(pull, PULL, "--pull", "30 klbf")
    except CaseError as error:
        if not isinstance(pull, str):
            raise
        try:
            pulls = tuple(STANDARD_GRAVITY * m for m in read_numbers(pull, MASS, "--pull", "30 klbf"))
        except CaseError:
            raise error from None
    if len(stretches) != len(pulls):
        raise CaseError(
            at="--pull",
            got=f"{len(pulls)} pulls for {len(stretches)} stretches",
            want="a pull for each stretch",
        )
    return tuple(Pair(e, f) for e, f in zip(stretches, pulls, strict=True))
