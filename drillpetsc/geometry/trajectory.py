"""Figures of a hole's path: inclination, azimuth, doglegs, average build rate of a newly drilled stretch."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from drillpetsc.arrays import FloatArray
from drillpetsc.geometry.well import Well

COURSE = 30.0  # length that build rates refer to [m]
FAITHFUL = 1e-4  # how far a survey may miss the hole from one station to the next [m]


@dataclass(frozen=True)
class NewHole:
    """What was drilled: angles in rad, rates in rad per metre, lengths in m.

    aside: (2,) how far its end lies from the straight continuation of the old hole: towards its high side,
    and to the right looking down.
    """

    length: float
    inclination: tuple[float, float]
    azimuth: tuple[float, float]
    dogleg_severity: float
    build_rate: float
    turn_rate: float
    aside: tuple[float, float]


def angles(tangent: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Inclination and azimuth (...) [rad] of unit vectors (..., 3), azimuth from 0 to 2 pi and 0 where the
    hole is vertical."""
    t = np.asarray(tangent, dtype=float)
    across = np.hypot(t[..., 0], t[..., 1])
    azimuth = np.where(across > 1e-9, np.arctan2(t[..., 1], t[..., 0]) % (2 * np.pi), 0.0)
    return np.arctan2(across, t[..., 2]), azimuth


def dogleg(one: ArrayLike, two: ArrayLike) -> FloatArray:
    """Angle (...) [rad] between unit vectors (..., 3)."""
    a, b = np.asarray(one, dtype=float), np.asarray(two, dtype=float)
    return 2 * np.arctan2(np.linalg.norm(b - a, axis=-1), np.linalg.norm(a + b, axis=-1))


def dogleg_severity(md: ArrayLike, tangent: ArrayLike, course: float = COURSE) -> FloatArray:
    """(n,) change of direction per metre [rad/m] at stations md (n,) [m] with tangents (n, 3), over the
    ``course`` [m] above each (from the first station on where there is less, from the station above where
    they lie further apart)."""
    s, t = np.asarray(md, dtype=float), np.asarray(tangent, dtype=float)
    out = np.zeros(len(s))
    for i in range(1, len(s)):
        above = min(i - 1, int(np.searchsorted(s, s[i] - course - 1e-9)))
        out[i] = float(dogleg(t[above], t[i])) / (s[i] - s[above])
    return out


def faithful(well: Well, md: ArrayLike, within: float = FAITHFUL) -> FloatArray:
    """Stations md (n,) [m], and more of them where minimum curvature would miss the way from one to the next
    by more than ``within`` [m].

    The arc between stations h apart is the trapezoidal rule for the directions, but exact where the curvature
    does not change; so it misses by h^2/12 times the change of curvature, and k equal pieces miss by 1/k^2 of
    that.
    """
    s = np.asarray(md, dtype=float)
    x, t, _ = well.at(s)
    half = np.maximum(0.5 * dogleg(t[:-1], t[1:]), 1e-9)  # tan(x)/x is 1 from there down
    arc = 0.5 * (np.diff(s) * np.tan(half) / half)[:, None] * (t[:-1] + t[1:])
    missed = np.linalg.norm(np.diff(x, axis=0) - arc, axis=1)
    pieces = np.maximum(np.ceil(np.sqrt(missed / within)), 1).astype(int)
    between = [np.linspace(a, b, k, endpoint=False) for a, b, k in zip(s[:-1], s[1:], pieces, strict=True)]
    return np.concatenate([*between, s[-1:]])


def new_hole(well: Well, start: float) -> NewHole | None:
    """Figures of the part of ``well`` below ``start`` [m]; None where nothing was drilled.

    Average build rate K = arccos(t1.t2)/dS of the directions of old hole and new end, its build part (I2 -
    I1)/dS and its turn part (A2 - A1) sin(I)/dS with the mean inclination (model, contact-bit-statics 4.2).
    """
    length = well.depth - start
    if length <= 0:
        return None
    (x0, x1), (t0, t1), _ = well.at(np.array([start, well.depth]))
    inclination, azimuth = angles(np.array([t0, t1]))
    turn = (azimuth[1] - azimuth[0] + np.pi) % (2 * np.pi) - np.pi if inclination.min() > 1e-9 else 0.0
    return NewHole(
        float(length),
        (float(inclination[0]), float(inclination[1])),
        (float(azimuth[0]), float(azimuth[1])),
        float(dogleg(t0, t1)) / length,
        float(inclination[1] - inclination[0]) / length,
        float(turn * np.sin(0.5 * inclination.sum())) / length,
        _aside(x0, t0, x1),
    )


def _aside(start: FloatArray, tangent: FloatArray, end: FloatArray) -> tuple[float, float]:
    from drillpetsc.geometry.frames import high_side

    up = high_side(tangent)
    away = end - start
    return float(away @ up), float(away @ np.cross(tangent, up))


def as_dict(hole: NewHole) -> dict[str, float]:
    """The figures with their units, as summaries and tables have them."""
    per_course = np.degrees(COURSE)
    return {
        "drilled [m]": hole.length,
        "inclination_start [deg]": np.degrees(hole.inclination[0]),
        "inclination_end [deg]": np.degrees(hole.inclination[1]),
        "azimuth_start [deg]": np.degrees(hole.azimuth[0]),
        "azimuth_end [deg]": np.degrees(hole.azimuth[1]),
        "build_rate [deg/30m]": hole.build_rate * per_course,
        "turn_rate [deg/30m]": hole.turn_rate * per_course,
        "dogleg_severity [deg/30m]": hole.dogleg_severity * per_course,
        "end_above [m]": hole.aside[0],
        "end_right [m]": hole.aside[1],
    }
