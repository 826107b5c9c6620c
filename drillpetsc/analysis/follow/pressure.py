"""The level of the pump pressure over a power of the flow rate, for alarms (manual: sec-follow-pressure)."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.analysis.follow.alarms import Error

EXPONENT = 1.85  # of the flow rate: 1.75 of turbulent friction (Blasius), 2 of nozzles and tools
NOISE = 0.01  # relative standard error of a reading
WALK = 0.003  # change of the logarithm per square root of a metre: a deeper string, mud that is treated [1/sqrt(m)]


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

    def error(self, pressure: float, flow: float, before: float | None, distance: float) -> Error | None:
        """A pump pressure [Pa] and its forecast from the level ``before``, which was estimated ``distance`` [m] earlier.

        None if there was no level, pressure or flow.
        """
        if before is None or np.isnan(before) or not (pressure > 0 and flow > 0):
            return None
        forecast = float(np.exp(before + EXPONENT * np.log(flow)))
        return Error(pressure, forecast, forecast * float(np.sqrt(WALK**2 * distance + 2 * NOISE**2)))

    def saved(self) -> dict[str, Any]:
        """Everything that a restart needs."""
        return {"level": self.level, "variance": self.variance}

    def restore(self, saved: dict[str, Any]) -> None:
        """Continue from what was saved."""
        self.level = float("nan") if saved["level"] is None else saved["level"]
        self.variance = saved["variance"]
