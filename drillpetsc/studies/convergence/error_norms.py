"""Error norms, observed orders, cost of a given error, and Richardson extrapolation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.arrays import FloatArray

NUMERICS = ("time", "step", "newton", "energy_error")  # columns about the computation, not about the well
NORMS = ("max", "rms", "end", "mean")
UNRESOLVED_ERROR = 0.3  # error over range above which a run does not resolve the solution and shows no order
CLEAR_OF_REFERENCE = 3.0  # smallest ratio of a point's error to the reference's error, for an observed order
EXTRAPOLATION_LIMIT = 4.0  # largest ratio of errors over which a curve of error over time is extrapolated
LEAST_COST_SLOPE = 0.4  # smallest slope of log(error) over log(time) of a curve that is extrapolated
ROUNDING_RANGE = 1e-9  # range over size below which a change of an output is rounding


def extent(reference: FloatArray) -> float:
    """Range of an output (k,); 0 if it is constant to rounding."""
    span, size = float(np.ptp(reference)), float(np.abs(reference).max())
    return span if span > ROUNDING_RANGE * size else 0.0


def moves(values: FloatArray) -> bool:
    """Whether the range of an output (k,) exceeds a millionth of its size, and 1e-12 in SI."""
    return extent(values) > max(1e-6 * float(np.abs(values).max()), 1e-12)


def errors_of(values: FloatArray, reference: FloatArray) -> dict[str, float]:
    """Errors of values (k,) against a reference (k,), as fractions of the range of the reference.

    max: largest error. rms: root mean square over the rows. end: error in the last row. mean: error of the
    mean over the rows, the only useful norm for chaotic motion.
    """
    span = extent(reference)
    if span == 0.0:
        raise ValueError(
            "the output is constant in the reference, so errors relative to its range are not defined"
        )
    off = (values - reference) / span
    return {
        "max": float(np.abs(off).max()),
        "rms": float(np.sqrt(np.mean(off**2))),
        "end": float(abs(off[-1])),
        "mean": float(abs(off.mean())),
    }


@dataclass(frozen=True)
class Order:
    """Observed order of convergence: slope of log(error) over log(step).

    low, high: ends of the 95 % confidence interval. points: number of points of the fit.
    """

    order: float
    low: float
    high: float
    points: int


def observed_order(steps: FloatArray, errors: FloatArray, floor: float = 0.0) -> Order | None:
    """Fit the order of convergence to steps (n,) and errors (n,); None if fewer than three points are usable.

    floor: error of the reference.

    Least squares of log(error) over log(step) (scipy.stats.linregress) through the points whose error lies
    below UNRESOLVED_ERROR and above CLEAR_OF_REFERENCE times ``floor``. The confidence interval is slope +- t
    standard error, with t the 97.5 % quantile of Student's distribution for points - 2 degrees of freedom.
    """
    from scipy import stats

    steps, errors = np.asarray(steps, dtype=float), np.asarray(errors, dtype=float)
    good = (
        np.isfinite(errors)
        & np.isfinite(steps)
        & (errors > max(CLEAR_OF_REFERENCE * floor, 0.0))
        & (errors < UNRESOLVED_ERROR)
        & (steps > 0)
    )
    if good.sum() < 3 or len(np.unique(steps[good])) < 3:
        return None
    fit = stats.linregress(np.log(steps[good]), np.log(errors[good]))
    half = float(stats.t.ppf(0.975, int(good.sum()) - 2) * fit.stderr)
    return Order(float(fit.slope), float(fit.slope) - half, float(fit.slope) + half, int(good.sum()))


@dataclass(frozen=True)
class Cost:
    """CPU time of a given error.

    how: `between` two points; `below` the cheapest point, which is already more accurate; or `beyond` the most
    accurate point, extrapolated with the last slope of the curve.
    """

    seconds: float
    how: str


def cost_of(target: float, errors: FloatArray, seconds: FloatArray) -> Cost | None:
    """CPU time of an error of ``target`` on a curve of errors (n,) and seconds (n,) [s]; None if unknown.

    Linear interpolation of logarithms between the points for which no cheaper point is more accurate.
    Extrapolation is limited to errors within EXTRAPOLATION_LIMIT of the target, and to curves that fall by
    more than time^-LEAST_COST_SLOPE.
    """
    errors, seconds = np.asarray(errors, dtype=float), np.asarray(seconds, dtype=float)
    good = np.isfinite(errors) & np.isfinite(seconds) & (errors > 0) & (seconds > 0)
    order = np.argsort(seconds[good])
    best: list[tuple[float, float]] = []
    for s, e in zip(seconds[good][order], errors[good][order], strict=True):
        if not best or e < best[-1][1]:
            best.append((float(s), float(e)))
    if not best:
        return None
    if best[0][1] <= target:
        return Cost(best[0][0], "below")
    for (s0, e0), (s1, e1) in zip(best, best[1:], strict=False):
        if e1 <= target:
            return Cost(_log_line(target, e0, s0, e1, s1), "between")
    if len(best) < 2 or best[-1][1] > EXTRAPOLATION_LIMIT * target:
        return None
    (s0, e0), (s1, e1) = best[-2:]
    if np.log(e0 / e1) < LEAST_COST_SLOPE * np.log(s1 / s0):
        return None
    return Cost(_log_line(target, e0, s0, e1, s1), "beyond")


def _log_line(x: float, xa: float, ya: float, xb: float, yb: float) -> float:
    share = np.log(x / xa) / np.log(xb / xa)
    return float(np.exp(np.log(ya) + share * np.log(yb / ya)))


@dataclass(frozen=True)
class Extrapolated:
    """Values extrapolated to mesh size 0.

    values: (k,).
    order: observed on three meshes; NaN if the differences between the meshes do not decrease.
    error: estimated error of the values, rms over the rows, in the unit of the values.
    """

    values: FloatArray
    order: float
    error: float


def richardson(coarse: FloatArray, middle: FloatArray, fine: FloatArray) -> Extrapolated:
    """Extrapolate values (k,) on three meshes, each twice as fine as the previous one, to mesh size 0.

    With an error C h^p: p = log2(|coarse - middle|/|middle - fine|), limit = fine + (fine -
    middle)/(2^p - 1) (Roache, Verification and Validation in Computational Science and Engineering,
    1998). If the differences do not decrease, the values of the finest mesh are returned, with their
    difference from the middle mesh as error.
    """

    def size(v: FloatArray) -> float:
        return float(np.sqrt(np.mean(v**2)))

    first, second = size(coarse - middle), size(middle - fine)
    if second == 0.0:
        return Extrapolated(fine, float("nan"), 0.0)
    if first <= second:
        return Extrapolated(fine, float("nan"), second)
    p = float(np.log2(first / second))
    step = (fine - middle) / (2.0**p - 1)
    return Extrapolated(fine + step, p, size(step))
