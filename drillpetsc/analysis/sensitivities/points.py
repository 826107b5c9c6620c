"""Cases beside the case of a solution, at which its equations and outputs are evaluated (manual: sec-sensitivities).

The derivative by a key is a weighted sum over the points: of residuals at the solution, of outputs at the solution moved
along its derivative.  No point is solved.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from drillpetsc.analysis.sensitivities.keys import STEP, Key
from drillpetsc.arrays import FloatArray
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError

Value = TypeVar("Value", float, np.ndarray)
MOST_ROUNDS, EXACT = 6, 1e-10  # of solving with a matrix that is not exact; last correction, relative
MOVE = 1e-5  # of the unknowns in their scales, over which the residual is differenced
#: steps and weights, over the size of a step: of central differences, and of those to one side at a limit of the key
CENTRAL = ((-1.0, -0.5), (1.0, 0.5))
UPWARDS = ((0.0, -1.5), (1.0, 2.0), (2.0, -0.5))
DOWNWARDS = tuple((-step, -weight) for step, weight in UPWARDS)


@dataclass(frozen=True)
class Point:
    """A case beside that of the solution.

    key: the number in which it differs; change: of it [SI of the key]; weight: in the derivative [1/SI of the key].
    """

    case: Case
    key: Key
    change: float
    weight: float


def points_of(case: Case, key: Key, step: float = STEP) -> tuple[list[Point], bool]:
    """Points for the derivative by a key, and whether the key is at a limit, so that they lie on one side.

    step: relative.  Raises CaseError if the key cannot be changed to either side.
    """
    size, errors = step * key.size, []
    for stencil in (CENTRAL, UPWARDS, DOWNWARDS):
        try:
            cases = [key.changed(case, key.value + size * q) for q, _ in stencil]
        except CaseError as error:
            errors.append(error)
            continue
        points = [Point(c, key, size * q, w / size) for c, (q, w) in zip(cases, stencil, strict=True)]
        return points, stencil is not CENTRAL
    raise refusal_of(key, errors[0])


def refusal_of(key: Key, error: CaseError) -> CaseError:
    """What the user reads if a case with a changed key is refused."""
    if error.at == "--to":
        return error
    want = f"a number that can change a little: {error.at} {error.want}"
    return CaseError(at="--to", got=key.name, want=want, hint=error.hint)


def solve_exactly(
    solve: Callable[[FloatArray], FloatArray],
    left: Callable[[FloatArray], FloatArray],
    source: FloatArray,
    size: Callable[[FloatArray], float],
) -> FloatArray:
    """Solve J s = source (n,) with a factored matrix that leaves out a little of J.

    solve(rows): the step with that matrix; left(s): what J s lacks of the source.
    size(step): largest component in the fields' scales, the same on all ranks.
    """
    step = last = solve(source)
    for _ in range(MOST_ROUNDS):
        if not EXACT * size(step) < size(last):
            break
        more = solve(left(step))
        if not size(more) < 0.5 * size(last):  # rounding
            break
        step, last = step + more, more
    return step


def difference(points: Sequence[Point], values: Sequence[Value]) -> Value:
    """The derivative by the key of the values at the points."""
    total = points[0].weight * values[0]
    for point, value in zip(points[1:], values[1:], strict=True):
        total = total + point.weight * value
    return total
