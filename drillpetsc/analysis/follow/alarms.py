"""Alarms: sums of standardised errors of the forecast that was made one stand earlier, and of the level of the pump pressure.

Manual: sec-follow-alarms, sec-follow-pressure.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

PULL, RUN_IN, TORQUE, WEIGHT, PRESSURE, PRESSURE_LOST = (
    "drag on pull", "drag on run in", "torque", "weight lost", "pressure", "pressure lost",
)  # fmt: skip
INSIDE = 1.645  # standard deviations of a 90 % band
ROW = 5.0  # length of a row while the string turns on bottom [m]
SUSPECT = 1.0  # of a sum, beyond which rows do not teach the filter
#: (drift, height) of the one-sided sum max(0, g + e - drift): by stands, and by rows of `ROW`, whose errors are alike
BY_STANDS, BY_ROWS = (0.7, 5.0), (1.0, 10.0)
#: operation -> (kind, reading, sign of the error that counts)
WATCHED: dict[str, tuple[tuple[str, str, int], ...]] = {
    "trip_out": ((PULL, "hook_load", 1), (WEIGHT, "hook_load", -1)),
    "trip_in": ((RUN_IN, "hook_load", -1),),
    "backreaming": ((PULL, "hook_load", 1), (TORQUE, "torque", 1), (WEIGHT, "hook_load", -1)),
    "rotate_off_bottom": ((TORQUE, "torque", 1), (WEIGHT, "hook_load", -1)),
    "drilling": ((TORQUE, "torque", 1), (WEIGHT, "hook_load", -1)),
    "sliding": ((WEIGHT, "hook_load", -1),),
}
PUMPED = ((PRESSURE, "pump_pressure", 1), (PRESSURE_LOST, "pump_pressure", -1))


@dataclass(frozen=True)
class Error:
    """A reading beside the forecast made one stand earlier: both [SI], and the standard deviation of the difference."""

    reading: float
    forecast: float
    sd: float

    @property
    def standard(self) -> float:
        """The error in standard deviations."""
        return (self.reading - self.forecast) / self.sd


@dataclass(frozen=True)
class Alarm:
    """What has passed its bound.

    kind; operation; bit_depth, since: measured depths [m] now and where the sum left zero.
    excess: of the reading over the forecast [N], [N m] or [Pa], negative if it is lower; share: of the forecast.
    """

    kind: str
    operation: str
    bit_depth: float
    since: float
    excess: float
    share: float


@dataclass
class _Sum:
    g: float = 0.0
    since: float = float("nan")


@dataclass
class _Row:
    """Errors of a row that is not yet full."""

    start: float
    errors: list[tuple[float, float, float]] = field(default_factory=list)


class Watch:
    """The sums of all kinds of alarms."""

    def __init__(self) -> None:
        self._sums: dict[str, _Sum] = {}
        self._rows: dict[str, _Row] = {}

    @property
    def suspect(self) -> bool:
        """Whether a sum is so high that the latest rows must not teach the filter."""
        return any(q.g > SUSPECT for q in self._sums.values())

    def see(self, operation: str, depth: float, errors: dict[str, Error]) -> list[Alarm]:
        """Add the errors of a row; returns the alarms that it raises.  errors: reading -> its error."""
        out = []
        kinds = (*WATCHED.get(operation, ()), *PUMPED)
        by_rows = operation in ("drilling", "sliding")
        for kind, reading, sign in kinds:
            if reading not in errors:
                continue
            found: Error | None = errors[reading]
            key = f"{kind}, {'drilling' if by_rows else operation}"
            if by_rows:
                found = self._full_row(key, depth, errors[reading])
            if found is not None:
                out += self._add(key, kind, operation, depth, sign, found, BY_ROWS if by_rows else BY_STANDS)
        return out

    def _full_row(self, key: str, depth: float, error: Error) -> Error | None:
        row = self._rows.setdefault(key, _Row(depth))
        row.errors.append((error.reading, error.forecast, error.sd))
        if abs(depth - row.start) < ROW - 1e-6:
            return None
        self._rows[key] = _Row(depth)
        return Error(*(float(q) for q in np.mean(row.errors, axis=0)))

    def _add(
        self,
        key: str,
        kind: str,
        operation: str,
        depth: float,
        sign: int,
        error: Error,
        bounds: tuple[float, float],
    ) -> list[Alarm]:
        drift, height = bounds
        own = self._sums.setdefault(key, _Sum())
        before = own.g
        own.g = max(0.0, own.g + sign * error.standard - drift)
        if own.g and not before:
            own.since = depth
        if own.g <= height:
            return []
        since, own.g = own.since, 0.0
        excess = error.reading - error.forecast
        return [Alarm(kind, operation, depth, since, excess, excess / abs(error.forecast))]

    # ------------------------------------------------------------------ restart
    def saved(self) -> dict[str, Any]:
        """Everything that a restart needs, in JSON types."""
        rows = {key: [row.start, [list(q) for q in row.errors]] for key, row in self._rows.items()}
        return {"sums": {key: [q.g, q.since] for key, q in self._sums.items()}, "rows": rows}

    def restore(self, saved: dict[str, Any]) -> None:
        """Continue from what was saved."""
        self._sums = {
            key: _Sum(g, np.nan if since is None else since) for key, (g, since) in saved["sums"].items()
        }
        self._rows = {
            key: _Row(start, [(a, b, c) for a, b, c in errors])
            for key, (start, errors) in saved["rows"].items()
        }


EXPONENT = 1.85  # of the flow rate: 1.75 of turbulent friction (Blasius), 2 of nozzles and tools
NOISE = 0.01  # relative standard error of a reading
WALK = 0.003  # change of the logarithm per square root of a metre: a deeper string, mud that is treated [1/sqrt(m)]
LENGTHENED = 0.4  # share of the pressure that is lost along a string, and so changes with its length


class PressureTrack:
    """Estimate of z = ln(p / Q^1.85) [SI], which walks along the hole; a Kalman filter of one state."""

    def __init__(self) -> None:
        self.level, self.variance = float("nan"), 0.0

    def walk(self, distance: float) -> None:
        """Let the level wander over a distance [m]."""
        self.variance += WALK**2 * distance

    def see(self, pressure: float, flow: float, teaches: bool) -> None:
        """Correct the level by a pump pressure [Pa] at a flow rate [m3/s]."""
        if not teaches or not (pressure > 0 and flow > 0):
            return
        z = float(np.log(pressure) - EXPONENT * np.log(flow))
        if np.isnan(self.level):
            self.level, self.variance = z, NOISE**2
            return
        gain = self.variance / (self.variance + NOISE**2)
        self.level += gain * (z - self.level)
        self.variance *= 1 - gain

    def error(
        self, pressure: float, flow: float, before: float | None, distance: float, length: float
    ) -> Error | None:
        """A pump pressure [Pa] and its forecast from the level ``before``, which was estimated ``distance`` [m] earlier.

        length: of the string [m]; near the surface the distance is much of it.  None if there was no level, pressure or flow.
        """
        if before is None or np.isnan(before) or not (pressure > 0 and flow > 0):
            return None
        forecast = float(np.exp(before + EXPONENT * np.log(flow)))
        grown = LENGTHENED * distance / max(length, 1e-3)
        return Error(
            pressure, forecast, forecast * float(np.sqrt(WALK**2 * distance + grown**2 + 2 * NOISE**2))
        )

    def saved(self) -> dict[str, Any]:
        """Everything that a restart needs."""
        return dict(vars(self))

    def restore(self, saved: dict[str, Any]) -> None:
        """Continue from what was saved."""
        self.level = float("nan") if saved["level"] is None else saved["level"]
        self.variance = saved["variance"]
