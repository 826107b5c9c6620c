"""Errors of a run in named outputs, observed orders, time for a given error: plain numbers, no runs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

NORMS = ("max", "rms", "end", "mean")
UNRESOLVED = 0.3  # of the range: above it a run has little to do with the reference, and no order shows
CLEAR = 3.0  # an error is the run's own where it is so many times larger than that of the reference
FURTHER, FLAT = (
    4.0,
    0.4,
)  # how far a curve of error over time is continued beyond its last point, and how steep it must be
SAME = 1e-9  # a range below this share of the size is rounding: the output stands still


def extent(reference: FloatArray) -> float:
    """Largest less smallest value of an output; 0 where it stands still but for rounding."""
    span, size = float(np.ptp(reference)), float(np.abs(reference).max())
    return span if span > SAME * size else 0.0


def moves(values: FloatArray) -> bool:
    """Whether an output (k,) changes by more than a millionth of its size, and more than rounding may leave
    of nothing (1e-12 in SI)."""
    return extent(values) > max(1e-6 * float(np.abs(values).max()), 1e-12)


def errors_of(values: FloatArray, reference: FloatArray) -> dict[str, float]:
    """Errors of values (k,) against the reference (k,), as shares of the reference's range: largest, root
    mean square over the rows, in the last row, and of the mean over the rows (the norm that is left for
    chaotic motion)."""
    span = extent(reference)
    if span == 0.0:
        raise ValueError(
            "the output stands still in the reference: there is no range that errors could be relative to"
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
    """Slope of log(error) over log(step), the ends of its 95 % confidence interval, and how many points it is
    from."""

    value: float
    low: float
    high: float
    points: int

    def __str__(self) -> str:
        return f"{self.value:.2f} ({self.low:.2f} to {self.high:.2f}, {self.points} points)"


def observed_order(steps: FloatArray, errors: FloatArray, floor: float = 0.0) -> Order | None:
    """Least squares through log(error) over log(step) (scipy.stats.linregress), of points (n,) that show an
    order: finite errors below UNRESOLVED and CLEAR above ``floor``, the error of the reference itself.  None
    where fewer than three are left.

    The interval is slope +- t standard error, t the 97.5 % quantile of Student's distribution for points - 2
    degrees of freedom.
    """
    from scipy import stats

    steps, errors = np.asarray(steps, dtype=float), np.asarray(errors, dtype=float)
    good = (
        np.isfinite(errors)
        & np.isfinite(steps)
        & (errors > max(CLEAR * floor, 0.0))
        & (errors < UNRESOLVED)
        & (steps > 0)
    )
    if good.sum() < 3 or len(np.unique(steps[good])) < 3:
        return None
    fit = stats.linregress(np.log(steps[good]), np.log(errors[good]))
    half = float(stats.t.ppf(0.975, int(good.sum()) - 2) * fit.stderr)
    return Order(float(fit.slope), float(fit.slope) - half, float(fit.slope) + half, int(good.sum()))


@dataclass(frozen=True)
class Cost:
    """Seconds for an error; how: `between` two points, `below` the cheapest point (it is already better), or
    `beyond` the best point, by its curve's last slope."""

    seconds: float
    how: str

    def __str__(self) -> str:
        return {"between": "", "below": "< ", "beyond": "~ "}[self.how] + f"{self.seconds:.3g} s"


def cost_of(target: float, errors: FloatArray, seconds: FloatArray) -> Cost | None:
    """What an error of ``target`` costs on a curve of errors (n,) and seconds (n,) [s]: straight lines
    between points in logarithms.

    Only points that no cheaper point beats count.  `beyond` is at most FURTHER away in error, on a curve that
    still falls by more than time^-FLAT; None where the curve tells nothing.
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
    if len(best) < 2 or best[-1][1] > FURTHER * target:
        return None
    (s0, e0), (s1, e1) = best[-2:]
    if np.log(e0 / e1) < FLAT * np.log(s1 / s0):
        return None
    return Cost(_log_line(target, e0, s0, e1, s1), "beyond")


def _log_line(x: float, xa: float, ya: float, xb: float, yb: float) -> float:
    share = np.log(x / xa) / np.log(xb / xa)
    return float(np.exp(np.log(ya) + share * np.log(yb / ya)))


@dataclass(frozen=True)
class Extrapolated:
    """values (k,) for mesh size 0; order: as seen from three meshes (NaN where their differences do not
    shrink); error: of the values as estimated, rms over the rows, in the unit of the values."""

    values: FloatArray
    order: float
    error: float


def richardson(coarse: FloatArray, middle: FloatArray, fine: FloatArray, ratio: float = 2.0) -> Extrapolated:
    """Values (k,) at three meshes, each ``ratio`` times finer than the one before, extrapolated to mesh size
    0.

    With an error C h^p: p = log(|coarse - middle|/|middle - fine|)/log(ratio), limit = fine + (fine -
    middle)/(ratio^p - 1) (Roache, Verification and Validation in Computational Science and Engineering,
    1998).  Where the differences do not shrink, the finest mesh stands, with its distance to the middle one
    as error.
    """

    def size(v: FloatArray) -> float:
        return float(np.sqrt(np.mean(v**2)))

    first, second = size(coarse - middle), size(middle - fine)
    if second == 0.0:
        return Extrapolated(fine, float("nan"), 0.0)
    if first <= second:
        return Extrapolated(fine, float("nan"), second)
    p = float(np.log(first / second) / np.log(ratio))
    step = (fine - middle) / (ratio**p - 1)
    return Extrapolated(fine + step, p, size(step))


def plain_order(order: Order | None) -> dict[str, Any] | None:
    return (
        None
        if order is None
        else {"order": order.value, "low": order.low, "high": order.high, "points": order.points}
    )
