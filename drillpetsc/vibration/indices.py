"""Indices of drilling dynamics over a window of time (manual: sec-vibration-indices).

An index that is not defined is nan: stick-slip of a string that does not turn, energy of a bit that does not drill.
"""

from __future__ import annotations

import numpy as np

from drillpetsc.arrays import FloatArray

STUCK = 2 * np.pi / 60  # speed below which the bit counts as stuck [rad/s], 1 rpm
NO_PROGRESS = 1e-9  # rate of penetration below which a bit does not drill [m/s], 4 micrometres an hour


def time_mean(time: FloatArray | None, values: FloatArray) -> float:
    """Mean over the time (k,) [s] of values (k,) that are straight between their points; evenly spaced without a time.

    nan without values.
    """
    values = np.asarray(values, dtype=float)
    if len(values) < 2:
        return float(values[0]) if len(values) else np.nan
    step = np.ones(len(values) - 1) if time is None else np.diff(time)
    return float(np.sum(0.5 * (values[1:] + values[:-1]) * step) / np.sum(step))


def stick_slip_index(speed: FloatArray, time: FloatArray | None = None) -> float:
    """(max - min)/(2 mean) of a rotation speed (k,) [rad/s] at times (k,) [s]; nan where its mean is below 1 rpm.

    1 is full stick-slip: the bit just stops.  Without times the speeds are evenly spaced.
    """
    speed = np.asarray(speed, dtype=float)
    mean = abs(time_mean(time, speed))
    if not mean >= STUCK:
        return np.nan
    return float(np.ptp(speed)) / (2 * mean)


def stuck_share(time: FloatArray, speed: FloatArray) -> float:
    """Share of the time (k,) [s] in which the size of a speed (k,) [rad/s], straight between its points, is below 1 rpm."""
    t, w = np.asarray(time, dtype=float), np.asarray(speed, dtype=float)
    if len(t) < 2:
        return float(np.abs(w[0]) < STUCK) if len(w) else np.nan
    low, high = np.minimum(w[:-1], w[1:]), np.maximum(w[:-1], w[1:])
    span = high - low
    inside = np.minimum(high, STUCK) - np.maximum(low, -STUCK)
    level = (np.abs(low) < STUCK).astype(float)
    share = np.where(span > 0, np.clip(inside, 0.0, None) / np.where(span > 0, span, 1.0), level)
    return float(np.sum(share * np.diff(t)) / (t[-1] - t[0]))


def mechanical_specific_energy(
    weight: float, torque: float, speed: float, rop: float, diameter: float
) -> float:
    """Energy per volume of rock [Pa] (Teale, Int. J. Rock Mech. Min. Sci. 2, 1965): W/A + w T/(A rop).

    weight on bit [N], torque [N m], rotation [rad/s], rate of penetration [m/s], diameter of the bit [m].
    nan where the bit does not drill.
    """
    if not rop > NO_PROGRESS:
        return np.nan
    area = np.pi / 4 * diameter**2
    return weight / area + speed * torque / (area * rop)


def drilling_efficiency(strength: float, energy: float) -> float:
    """Strength of the rock [Pa] over the mechanical specific energy [Pa]; nan where there is none."""
    return strength / energy if energy > 0 else np.nan


def depth_of_cut(rop: float, speed: float) -> float:
    """Length drilled in a turn [m]; rate of penetration [m/s], rotation [rad/s].  nan below 1 rpm."""
    return 2 * np.pi * rop / abs(speed) if abs(speed) >= STUCK else np.nan


def root_mean_square(values: FloatArray) -> float:
    """Root of the mean square of values (k,), or of the length of vectors (k, m); nan without values."""
    values = np.asarray(values, dtype=float)
    if not len(values):
        return np.nan
    return float(np.sqrt(np.mean(np.sum(values.reshape(len(values), -1) ** 2, axis=1))))


def exceedances(values: FloatArray, level: float) -> int:
    """How often values (k,) rise above a level; values that begin above it count once."""
    above = np.asarray(values, dtype=float) > level
    return int(np.sum(above[1:] & ~above[:-1])) + int(bool(len(above)) and bool(above[0]))
