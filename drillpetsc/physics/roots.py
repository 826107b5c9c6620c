"""Root of a function of one variable by the Brent-Dekker method.

scipy.optimize has the same method, but its import takes longer than all other steps of building a model.
"""

from __future__ import annotations

import sys
from collections.abc import Callable

MAX_ITERATIONS = 100


def bracketed_root(
    f: Callable[[float], float],
    left: float,
    right: float,
    absolute: float = 2e-12,
    relative: float = 4 * sys.float_info.epsilon,
) -> float:
    """Root of f between two places where f has opposite signs.

    The method (Brent, Algorithms for Minimization without Derivatives, 1973, chapter 4) takes a secant step, or
    a hyperbolic step through the last three points (Bus and Dekker, ACM TOMS 1, 1975), and bisects if these
    steps are too long.

    absolute, relative: tolerances of the root, as in scipy.optimize.brentq
    """
    before, f_before, best, f_best = left, f(left), right, f(right)
    if f_before == 0.0:
        return before
    if f_best == 0.0:
        return best
    if (f_before < 0) == (f_best < 0):
        raise ValueError("f has the same sign at both ends")
    opposite, f_opposite, step, previous_step = 0.0, 0.0, 0.0, 0.0
    for _ in range(MAX_ITERATIONS):
        if (f_before < 0) != (f_best < 0) and f_before != 0.0 and f_best != 0.0:
            opposite, f_opposite = before, f_before
            step = previous_step = best - before
        if abs(f_opposite) < abs(f_best):
            before, best, opposite = best, opposite, best
            f_before, f_best, f_opposite = f_best, f_opposite, f_best
        tolerance = (absolute + relative * abs(best)) / 2
        half = (opposite - best) / 2
        if f_best == 0.0 or abs(half) < tolerance:
            return best
        trial = None
        if abs(previous_step) > tolerance and abs(f_best) < abs(f_before):
            if before == opposite:
                trial = -f_best * (best - before) / (f_best - f_before)
            else:
                a = (f_before - f_best) / (before - best)
                b = (f_opposite - f_best) / (opposite - best)
                trial = -f_best * (f_opposite * b - f_before * a) / (b * a * (f_opposite - f_before))
            if not 2 * abs(trial) < min(abs(previous_step), 3 * abs(half) - tolerance):
                trial = None
        previous_step, step = (half, half) if trial is None else (step, trial)
        before, f_before = best, f_best
        best += step if abs(step) > tolerance else (tolerance if half > 0 else -tolerance)
        f_best = f(best)
    raise ValueError(f"no root after {MAX_ITERATIONS} iterations")
