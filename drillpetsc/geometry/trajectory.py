"""Angles and rates of a hole's path: inclination, azimuth, doglegs, build and turn rates of newly drilled hole.

Manual: sec-borehole-trajectory, sec-borehole-rates.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from drillpetsc.arrays import FloatArray, components
from drillpetsc.geometry.well import Well

COURSE = 30.0  # course length to which build rates refer [m]
SURVEY_TOLERANCE = 1e-4  # largest error of a survey's path from one station to the next [m]


@dataclass(frozen=True)
class NewHole:
    """Results of the newly drilled part of a hole.

    length: of the new hole [m].
    inclination, azimuth: (2,) at its start and at its end [rad].
    dogleg_severity, build_rate, turn_rate: averages [rad/m] (manual: eq-borehole-rates).
    offset: (2,) offset of its end from the straight continuation of the old hole, towards the old hole's high
    side and to the right looking down [m].
    """

    length: float
    inclination: tuple[float, float]
    azimuth: tuple[float, float]
    dogleg_severity: float
    build_rate: float
    turn_rate: float
    offset: tuple[float, float]


def angles(tangent: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Compute inclination and azimuth (...) [rad] of unit vectors ``tangent`` (..., 3).

    The azimuth is between 0 and 2 pi, and 0 if the hole is vertical.
    """
    north, east, down = components(tangent)
    across = np.hypot(north, east)
    azimuth = np.where(across > 1e-9, np.arctan2(east, north) % (2 * np.pi), 0.0)
    return np.arctan2(across, down), azimuth


def dogleg(one: ArrayLike, two: ArrayLike) -> FloatArray:
    """Compute the angle (...) [rad] between unit vectors (..., 3)."""
    a, b = np.asarray(one, dtype=float), np.asarray(two, dtype=float)
    return 2 * np.arctan2(np.linalg.norm(b - a, axis=-1), np.linalg.norm(a + b, axis=-1))


def dogleg_severity(md: ArrayLike, tangent: ArrayLike, course: float = COURSE) -> FloatArray:
    """Compute the dogleg severity (n,) [rad/m] over the course length above each station.

    md: (n,) measured depths of the stations [m].
    tangent: (n, 3) unit tangents.
    course: length [m].  It is cut at the first station; if stations are further apart, it extends to the
    station above.
    """
    s, t = np.asarray(md, dtype=float), np.asarray(tangent, dtype=float)
    out = np.zeros(len(s))
    for i in range(1, len(s)):
        above = min(i - 1, int(np.searchsorted(s, s[i] - course - 1e-9)))
        out[i] = float(dogleg(t[above], t[i])) / (s[i] - s[above])
    return out


def refine_stations(well: Well, md: ArrayLike) -> FloatArray:
    """Add stations at which minimum curvature would miss the path of the well; returns all stations (m,) [m].

    Minimum curvature integrates the directions by the trapezoidal rule, and is exact at constant curvature.
    Between stations h apart its error is h^2/12 times the change of curvature; k equal pieces reduce the error
    by 1/k^2 (manual: eq-borehole-survey-error).

    md: (n,) measured depths of the stations [m].
    """
    s = np.asarray(md, dtype=float)
    x, t, _ = well.at(s)
    half = np.maximum(0.5 * dogleg(t[:-1], t[1:]), 1e-9)  # below this tan(x)/x is 1 up to rounding
    arc = 0.5 * (np.diff(s) * np.tan(half) / half)[:, None] * (t[:-1] + t[1:])
    missed = np.linalg.norm(np.diff(x, axis=0) - arc, axis=1)
    pieces = np.maximum(np.ceil(np.sqrt(missed / SURVEY_TOLERANCE)), 1).astype(int)
    between = [np.linspace(a, b, k, endpoint=False) for a, b, k in zip(s[:-1], s[1:], pieces, strict=True)]
    return np.concatenate([*between, s[-1:]])


def new_hole(well: Well, start: float, original: Well | None = None) -> NewHole | None:
    """Compute angles and rates of the part of ``well`` below ``start`` [m]; None if nothing was drilled.

    With the directions t1 of the old hole and t2 of the new end, the dogleg severity is arccos(t1.t2)/dS, the
    build rate (I2 - I1)/dS, and the turn rate (A2 - A1) sin(I)/dS with the mean inclination I (manual:
    eq-borehole-rates).

    original: the hole before it grew, for the direction at its end; by default the upper part of ``well``.
    """
    original = original or well
    length = well.depth - start
    if length <= 0:
        return None
    (x0, x1), (t0, t1), _ = (np.array(q) for q in zip(original.at(start), well.at(well.depth), strict=True))
    inclination, azimuth = angles(np.array([t0, t1]))
    turn = (azimuth[1] - azimuth[0] + np.pi) % (2 * np.pi) - np.pi if inclination.min() > 1e-9 else 0.0
    return NewHole(
        float(length),
        (float(inclination[0]), float(inclination[1])),
        (float(azimuth[0]), float(azimuth[1])),
        float(dogleg(t0, t1)) / length,
        float(inclination[1] - inclination[0]) / length,
        float(turn * np.sin(0.5 * inclination.sum())) / length,
        _offset(x0, t0, x1),
    )


def _offset(start: FloatArray, tangent: FloatArray, end: FloatArray) -> tuple[float, float]:
    """Compute the offset of ``end`` (3,) from the line through ``start`` along ``tangent``: high side, right [m]."""
    from drillpetsc.geometry.frames import high_side

    up = high_side(tangent)
    difference = end - start
    return float(difference @ up), float(difference @ np.cross(tangent, up))


def as_dict(hole: NewHole) -> dict[str, float]:
    """Return the results with their units in the keys, for summaries and tables."""
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
        "end_above [m]": hole.offset[0],
        "end_right [m]": hole.offset[1],
    }
