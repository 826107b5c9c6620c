"""Judgement of a Newton iteration for statics: whether it has converged, and whether it is worth another step.

Manual: sec-statics-newton.
"""

from __future__ import annotations

import numpy as np

CONVERGED_INCREMENT = 2.0e-9  # largest increment of a converged state, in the fields' scales
#: increment below which a state counts as converged if rounding stops the descent
ROUNDING_INCREMENT = 1.0e-5
ROUNDING_RATIO = 0.1  # an increment below it that is not this much smaller than all before it is rounding
ROUNDED_STEPS = 8  # of shortened steps of rounding in turn, which are not full ones
FAR_LIMIT = 2.0  # factor of a step without drag below which it would move a node by its clearance
MORE_STEPS = 10  # beyond the number that is allowed, while each halves what is left
#: full steps without a smaller increment before the iteration ends; contacts may open and close without end
STALL_WINDOW = 8
#: factor below which a step with drag crawls, and such steps in turn before it is given up: a shorter one costs less
CRAWL, CRAWLS = 0.1, 3


class NewtonProgress:
    """Judge the increments of one iteration.

    tolerance: largest increment of a converged state, in the fields' scales.
    most: number of steps.
    near: the start is near its state: give up if two consecutive steps exceed the radial clearance.
    """

    def __init__(self, tolerance: float, most: int, near: bool):
        self.tolerance, self.most, self.near = tolerance, most, near
        self.count = self.far = self.rounded = self.crawls = 0
        self.smallest, self.full_steps = np.inf, list[float]()
        #: the last step before it was shortened, and whether it halved what is left
        self.full, self.shrinks = np.inf, True

    def goes_on(self) -> bool:
        """Whether another step may be taken: up to ``most``, and some more while each halves what is left."""
        self.count += 1
        return self.count <= self.most or (self.shrinks and self.count <= self.most + MORE_STEPS)

    def leaves(self, longest: float) -> bool:
        """Whether a start that is near its state asks for the second motion across the hole; ``longest``: factor of the step."""
        self.far = self.far + 1 if longest < FAR_LIMIT else 0
        return self.near and self.far > 1

    def take(self, full: float) -> None:
        """Take note of the increment ``full`` of a step before it is shortened."""
        self.shrinks, self.full = full < 0.5 * self.full, full

    def converged(self, size: float, alpha: float) -> bool:
        """Whether the increment ``size`` of a step shortened by ``alpha`` ends the iteration."""
        full_step, last = alpha == 1.0, self.full_steps[-1] if self.full_steps and alpha == 1.0 else np.inf
        # error left by a linear contraction at the last ratio; Newton's own is smaller
        contracts = size < min(0.1 * last, ROUNDING_INCREMENT) and last < np.inf
        left = size * size / last if contracts else np.inf
        self.full_steps = [*self.full_steps, size] if full_step else []
        # a small increment that a further step no longer shrinks is rounding
        is_rounding = size < ROUNDING_INCREMENT and size > ROUNDING_RATIO * self.smallest
        self.rounded = self.rounded + 1 if is_rounding else 0
        self.smallest = min(self.smallest, size)
        return bool(
            full_step
            and (size < self.tolerance or left < 0.1 * self.tolerance or self.rounded)
            # a rough state is judged by the step that the search shortens
            or self.full < self.tolerance > ROUNDING_INCREMENT
            or self.rounded >= ROUNDED_STEPS
            and size < CONVERGED_INCREMENT
        )

    def stalls(self, alpha: float, with_drag: bool) -> bool:
        """Whether further steps are not worth their cost."""
        self.crawls = self.crawls + 1 if with_drag and alpha < CRAWL else 0
        sizes = self.full_steps
        if self.crawls >= CRAWLS or len(sizes) <= 2 * STALL_WINDOW:
            return self.crawls >= CRAWLS
        return min(sizes[-STALL_WINDOW:]) > 0.5 * min(sizes[:-STALL_WINDOW])
