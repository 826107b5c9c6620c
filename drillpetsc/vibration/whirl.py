"""Whirl of the string's centre in the hole: its ratio to the rotation, and its class (manual: sec-vibration-whirl)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.arrays import FloatArray

#: classes, in the order of their numbers in indices.csv
CLASSES = (
    "none",
    "forward synchronous",
    "forward",
    "backward rolling",
    "backward slipping",
    "chaotic",
    "unresolved",
)
REVOLUTIONS = 3.0  # of the string, in a window
SYNCHRONOUS = (0.9, 1.1)
ROLLING = 0.1  # part of the rolling ratio within which whirl is rolling
SMALL = 0.05  # radius of an orbit, as a part of the clearance, below which there is no whirl
SLOW = 0.1  # turns about the hole by turns of the string below which the string does not whirl
COHERENT = 0.5  # net turns about the hole by all turns, forth and back, below which the motion is chaotic
ROWS_PER_TURN = 4  # rows in a turn about the hole that are needed to see which way it goes


def rolling_ratio(outer_diameter: float, hole_diameter: float) -> float:
    """Turns about the hole by turns of the string for a string that rolls on the wall: -D_o/(D_h - D_o)."""
    return -outer_diameter / (hole_diameter - outer_diameter)


@dataclass(frozen=True)
class Whirl:
    """Whirl in the windows that end at k times.

    number: (k,) of its class in CLASSES; ratio: (k,) turns about the hole by turns of the string, nan without whole window.
    radius: (k,) mean distance from the hole's axis [m].
    """

    number: np.ndarray
    ratio: FloatArray
    radius: FloatArray


def whirl(
    time: FloatArray,
    x: FloatArray,
    y: FloatArray,
    spin: FloatArray,
    outer_radius: float,
    clearance: float,
    at: FloatArray,
) -> Whirl:
    """Whirl in the window of three revolutions of the string before each of the times ``at`` (k,) [s].

    time: (n,) [s]; x, y: (n,) offset from the hole's axis [m], y to the right of x looking down; spin: (n,) rotation [rad/s],
    clockwise looking down; outer_radius, clearance: of the string where it would touch [m]; nan where not known.

    A window with too few rows to follow a rolling string is ``unresolved``; so is one before three revolutions are over.
    """
    x, y = np.ascontiguousarray(x), np.ascontiguousarray(y)  # see ``arrays.components``
    angle, radii = np.unwrap(np.arctan2(y, x)), np.hypot(x, y)
    step = np.diff(time)
    turned = _running(0.5 * (spin[1:] + spin[:-1]) * step)
    ways = _running(0.5 * np.abs(spin[1:] + spin[:-1]) * step)
    swept = _running(np.abs(np.diff(angle)))
    total = _running(0.5 * (radii[1:] + radii[:-1]) * step)
    k = len(at)
    number, ratio, radius = np.full(k, CLASSES.index("unresolved")), np.full(k, np.nan), np.full(k, np.nan)
    for i, end in enumerate(np.searchsorted(time, np.asarray(at) * (1 + 1e-12), side="right") - 1):
        begin = int(np.searchsorted(ways, ways[end] - REVOLUTIONS * 2 * np.pi, side="right")) - 1
        if end <= 0 or begin < 0 or ways[end] - ways[begin] < REVOLUTIONS * 2 * np.pi * (1 - 1e-9):
            continue
        radius[i] = (total[end] - total[begin]) / (time[end] - time[begin])
        about, rotation = angle[end] - angle[begin], turned[end] - turned[begin]
        if abs(rotation) > SLOW * REVOLUTIONS * 2 * np.pi:
            ratio[i] = about / rotation
        rows = (end - begin) / REVOLUTIONS
        name = _class(
            ratio[i], radius[i], swept[end] - swept[begin], abs(about), rows, outer_radius, clearance
        )
        number[i] = CLASSES.index(name)
    return Whirl(number, ratio, radius)


def _running(parts: FloatArray) -> FloatArray:
    """(n,) sums of the first 0 to n - 1 parts."""
    return np.concatenate([[0.0], np.cumsum(parts)])


def _class(
    ratio: float,
    radius: float,
    swept: float,
    about: float,
    rows: float,
    outer_radius: float,
    clearance: float,
) -> str:
    """Class of a window: rows in a turn of the string, ``swept`` and ``about`` [rad] all and net turns about the hole."""
    if np.isfinite(clearance) and radius < SMALL * clearance:
        return "none"
    known = radius > 0 and np.isfinite(outer_radius)
    rolling = -outer_radius / radius if known else -1.0
    fastest = outer_radius / np.nanmax([radius, clearance]) if known else 1.0  # where it touches the wall
    if rows < ROWS_PER_TURN * max(1.0, fastest) or not np.isfinite(ratio):
        return "unresolved"
    if swept < SLOW * REVOLUTIONS * 2 * np.pi:
        return "none"
    if about < COHERENT * swept:
        return "chaotic"
    if SYNCHRONOUS[0] <= ratio <= SYNCHRONOUS[1]:
        return "forward synchronous"
    if ratio > 0:
        return "forward"
    return "backward rolling" if abs(ratio / rolling - 1.0) <= ROLLING else "backward slipping"
