"""What a derivative is taken of: outputs of a solution, and the states at which they have a kink."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from drillpetsc.analysis.sensitivities.points import Point
from drillpetsc.arrays import FloatArray
from drillpetsc.case.case import Case
from drillpetsc.fem.quantity import Quantity


@dataclass(frozen=True)
class Output:
    """A number of a solution.

    quantity: its name, unit and meaning; operation: of a roadmap, else empty; bit_depth: of the row [m], nan: of the case.
    """

    quantity: Quantity
    operation: str = ""
    bit_depth: float = np.nan

    @property
    def label(self) -> str:
        """The name, with the bit depth of a roadmap's row."""
        return self.name if np.isnan(self.bit_depth) else f"{self.name} at {self.bit_depth:.6g} m"

    @property
    def name(self) -> str:
        """`trip_out.hook_load`, or `pump_pressure`."""
        return f"{self.operation}.{self.quantity.name}" if self.operation else self.quantity.name


@dataclass(frozen=True)
class Found:
    """Outputs of a solution, or at a point beside it.

    values: (m,) [SI], nan where a number does not exist; states: of each output what changes at a kink; equal as long as none lies between.
    """

    values: FloatArray
    states: tuple[Hashable, ...]


class Solution(Protocol):
    """A solved problem of a case, with the matrix of its equations.

    notes: what was assumed; left_out: why rows at a bit depth [m] have no derivative; resolution: relative change of an output [-] that is rounding.
    by_solutions: derivatives are differences of full solutions.
    far: states at the distance of a stated change are worth looking at: they follow from smooth steps, without contacts.
    """

    outputs: list[Output]
    found: Found
    notes: list[str]
    left_out: dict[float, str]
    resolution: float
    far: bool
    by_solutions: bool

    def near(self, points: Sequence[Point]) -> list[Found]:
        """Outputs at the points, of the solution moved along its derivative.  Raises ValueError if the elements do not correspond."""

    def solved(self, case: Case) -> Found:
        """Outputs of another case, solved on the same elements."""


def number(value: Any) -> float:
    """A value of a summary as a number; nan for None and words."""
    return float(value) if isinstance(value, float | int) and not isinstance(value, bool) else np.nan
