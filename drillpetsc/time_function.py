"""Inputs over time: constant, piecewise linear with jumps, half-cosine ramp.

Each has these methods, with t in seconds:
value(t): the value; at a jump the one after it, with before=True the one before it
rate(t): d value/dt, at a break as for value
integral(t): exact integral from 0 to t
breaks(): times at which the value or a derivative jumps; time steps must end there
jumps(): times at which the value itself jumps
"""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from dataclasses import dataclass
from functools import cached_property


@dataclass(frozen=True)
class Constant:
    """The same value at all times."""

    constant: float

    def value(self, t: float, before: bool = False) -> float:
        return self.constant

    def rate(self, t: float, before: bool = False) -> float:
        return 0.0

    def integral(self, t: float) -> float:
        return self.constant * t

    def breaks(self) -> tuple[float, ...]:
        return ()

    def jumps(self) -> tuple[float, ...]:
        return ()


@dataclass(frozen=True)
class PiecewiseLinear:
    """Straight lines between (time, value) pairs, constant outside; a time given twice is a jump.

    times: (n,) never falling, each at most twice [s]
    values: (n,) [unit of the input]
    """

    times: tuple[float, ...]
    values: tuple[float, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "times", tuple(map(float, self.times)))
        object.__setattr__(self, "values", tuple(map(float, self.values)))
        if not self.times or len(self.times) != len(self.values):
            raise ValueError("time and value must be lists of the same length, at least 1")
        for a, b in zip(self.times, self.times[1:], strict=False):
            if b < a:
                raise ValueError(f"time must not fall: {b:g} s follows {a:g} s")
        for a, c in zip(self.times, self.times[2:], strict=False):
            if a == c:
                raise ValueError(f"time {a:g} s stands more than twice")

    def _interval(self, t: float, before: bool) -> int:
        """Number of times passed: t lies between times[k - 1] and times[k]."""
        return bisect_left(self.times, t) if before else bisect_right(self.times, t)

    def _slope(self, k: int) -> float:
        return (self.values[k] - self.values[k - 1]) / (self.times[k] - self.times[k - 1])

    def value(self, t: float, before: bool = False) -> float:
        k = self._interval(t, before)
        if k == 0:
            return self.values[0]
        if k == len(self.times):
            return self.values[-1]
        # weights sum to 1 and lie in [0, 1], so the value never leaves the range of its two ends
        weight = (t - self.times[k - 1]) / (self.times[k] - self.times[k - 1])
        return (1.0 - weight) * self.values[k - 1] + weight * self.values[k]

    def rate(self, t: float, before: bool = False) -> float:
        k = self._interval(t, before)
        return 0.0 if k in (0, len(self.times)) else self._slope(k)

    @cached_property
    def _areas(self) -> tuple[float, ...]:
        """(n,) integral from times[0] to each time, by trapezoids (exact for straight lines)."""
        area, areas = 0.0, [0.0]
        for k in range(1, len(self.times)):
            area += 0.5 * (self.values[k] + self.values[k - 1]) * (self.times[k] - self.times[k - 1])
            areas.append(area)
        return tuple(areas)

    def _primitive(self, t: float) -> float:
        """Integral from times[0] to t."""
        k = self._interval(t, before=False)
        if k == 0:
            return self.values[0] * (t - self.times[0])
        start = self.values[k - 1]
        return self._areas[k - 1] + 0.5 * (start + self.value(t)) * (t - self.times[k - 1])

    def integral(self, t: float) -> float:
        return self._primitive(t) - self._primitive(0.0)

    def jumps(self) -> tuple[float, ...]:
        pairs = range(1, len(self.times))
        return tuple(
            self.times[k]
            for k in pairs
            if self.times[k] == self.times[k - 1] and self.values[k] != self.values[k - 1]
        )

    def breaks(self) -> tuple[float, ...]:
        jumps = set(self.jumps())
        return tuple(
            t for t in sorted(set(self.times)) if t in jumps or self.rate(t) != self.rate(t, before=True)
        )


@dataclass(frozen=True)
class Ramp:
    """Half a cosine from zero to a final value: final (1 - cos(pi t/duration))/2, then constant.

    Zero before t = 0. Value and rate are continuous; the second derivative jumps at both ends.

    duration: [s]
    final: [unit of the input]
    """

    duration: float
    final: float

    def __post_init__(self) -> None:
        if not self.duration > 0:
            raise ValueError("a ramp lasts longer than 0 s")

    def value(self, t: float, before: bool = False) -> float:
        if t <= 0.0:
            return 0.0
        if t >= self.duration:
            return self.final
        return (
            self.final * math.sin(0.5 * math.pi * t / self.duration) ** 2
        )  # = (1 - cos)/2 without cancellation

    def rate(self, t: float, before: bool = False) -> float:
        if not 0.0 < t < self.duration:
            return 0.0
        return 0.5 * self.final * math.pi / self.duration * math.sin(math.pi * t / self.duration)

    def integral(self, t: float) -> float:
        if t <= 0.0:
            return 0.0
        if t >= self.duration:
            return self.final * (t - 0.5 * self.duration)
        half_wave = self.duration / math.pi * math.sin(math.pi * t / self.duration)
        return 0.5 * self.final * (t - half_wave)

    def breaks(self) -> tuple[float, ...]:
        return (0.0, self.duration)

    def jumps(self) -> tuple[float, ...]:
        return ()


TimeFunction = Constant | PiecewiseLinear | Ramp
