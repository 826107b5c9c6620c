"""Swirl of the mud about a turning string, a history variable of the annulus (manual: sec-mud-swirl).

The mud between a string that turns at the rate Omega and a hole that stands turns at Omega_s about the hole's axis.
Steady, Omega_s = share Omega; after a change of the spin it follows within the time that friction takes:

    d(Omega_s)/dt = k (share Omega - Omega_s)                                                  (manual: eq-mud-swirl-lag)

The swirl is constant while Newton's method solves a step: it is found from the spins after the last steps, which are
taken to go on along a straight line.
"""

from __future__ import annotations

import numpy as np

from drillpetsc.arrays import FloatArray

OTHER_FLOW = 0.02  # relative change of the flow after which the rates of following are computed anew


def steady_share(outer_diameter: FloatArray, hole_diameter: FloatArray) -> FloatArray:
    """Compute the share (n,) [-] of the string's spin that the mud has, D_o^2/(D_o^2 + D_w^2) (manual: eq-mud-swirl-share).

    It is the mean of Couette's flow weighted with its angular momentum.  outer_diameter, hole_diameter: (n,) [m].
    """
    inner, outer = outer_diameter**2, hole_diameter**2
    return np.asarray(inner / (inner + outer))


class Swirl:
    """Swirl about the local elements, from the spins at accepted steps.

    count: local elements.  After the last step, (nc,) each: spin, swirl [rad/s], trend of the spin [rad/s2]; time of the step [s].
    follow: (nc,) rate at which the swirl follows [1/s], inf: at once.
    """

    STATE = 6  #: columns of ``get_state``

    def __init__(self, count: int) -> None:
        self.spin, self.swirl, self.trend = np.zeros((3, count))
        self.follow = np.full(count, np.inf)
        self.time: float | None = None  # None: no motion has begun
        self.flow: FloatArray | None = None  # (nc,) to which ``follow`` belongs

    def start(self, t: float, spin: FloatArray, share: FloatArray) -> None:
        """Begin at ``t`` [s] with a steady swirl.  spin: (nc,) [rad/s]; share: (nc,) [-]."""
        self.time, self.spin[:], self.swirl[:], self.trend[:] = t, spin, share * spin, 0.0

    def stop(self) -> None:
        """Return to mud that stands."""
        self.time = None

    def advance(self, t: float, spin: FloatArray, share: FloatArray) -> None:
        """Go on to the accepted step at ``t`` [s] with the spins (nc,) [rad/s] after it."""
        assert self.time is not None
        step = t - self.time
        if step <= 0.0:
            self.spin[:] = spin
            return
        self.trend[:] = (spin - self.spin) / step
        self.swirl[:] = self._at(step, share)[0]
        self.time, self.spin[:] = t, spin

    def at(self, t: float, share: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Swirl (nc,) [rad/s] and its rate (nc,) [rad/s2] at ``t`` [s], the spins going on along their trends."""
        assert self.time is not None
        return self._at(t - self.time, share)

    def _at(self, step: float, share: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The exact solution for a spin on a straight line from ``self.spin``."""
        at_once = np.isinf(self.follow)
        late = np.where(at_once, 0.0, share * self.trend / np.where(at_once, 1.0, self.follow))
        decay = np.where(at_once, 0.0, np.exp(-np.where(at_once, 0.0, self.follow) * step))
        wanted = share * (self.spin + self.trend * step)
        behind = (self.swirl - share * self.spin + late) * decay - late
        rate = share * self.trend - np.where(
            at_once, 0.0, np.where(at_once, 0.0, self.follow) * (behind + late)
        )
        return wanted + behind, rate

    def get_state(self) -> FloatArray:
        """(nc, 6) of a motion: spin, swirl, trend, follow, flow, time."""
        flow = np.zeros(len(self.spin)) if self.flow is None else self.flow
        time = np.full(len(self.spin), np.nan if self.time is None else self.time)
        return np.column_stack([self.spin, self.swirl, self.trend, self.follow, flow, time])

    def set_state(self, saved: FloatArray) -> None:
        """Continue from the result of ``get_state``."""
        self.spin, self.swirl, self.trend, self.follow, self.flow, time = np.array(saved.T, order="C")
        self.time = float(time[0]) if len(time) and not np.isnan(time[0]) else None
