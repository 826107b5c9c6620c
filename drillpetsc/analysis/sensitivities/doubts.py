"""Doubts about derivatives."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from drillpetsc.case.case import Case
from drillpetsc.doubts.doubt import Doubt
from drillpetsc.unit_systems import System

DISAGREES = 1e-4  # error of a derivative, relative, above which it is reported
SMALL = 1e-4  # relative derivatives below it are judged by their absolute error


@dataclass(frozen=True)
class Checked:
    """A derivative is compared with differences of full solutions.

    output, key: their names; derivative, difference: relative [-].
    """

    case: Case
    output: str
    key: str
    derivative: float
    difference: float

    @property
    def units(self) -> System:
        """Units of the reader."""
        return self.case.shown_units

    @property
    def error(self) -> float:
        """Of the derivative, relative to the difference, or to ``SMALL`` if that is smaller."""
        return abs(self.derivative - self.difference) / max(abs(self.difference), SMALL)


class Disagrees(Doubt):
    """A derivative differs from central differences of full solutions by more than 1e-4.

    Both numbers are relative: the share by which the output changes over the share by which the key changes.
    """

    about = (Checked,)
    sentence = "the derivative of {output} by {key} is {derivative:.6g}, full solutions give {difference:.6g} (relative numbers)"
    remedy = "Use the differences: a contact, a regime or a place changes within the step of the key."

    def look(self, at: Checked) -> Iterable[dict[str, Any]]:
        if at.error > DISAGREES:
            yield {
                "output": at.output,
                "key": at.key,
                "derivative": at.derivative,
                "difference": at.difference,
            }
