"""Fewer points for pictures of long runs: those that a picture with all points would show."""

from __future__ import annotations

import numpy as np

INTERVALS = 4000  # of a time axis, more than it has pixels
CELLS = 300  # of an orbit's picture in each direction, about as many as it has pixels


def envelope(time: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Times and values (m,) of the points that draw the line through ``values`` (n,) at ``time`` (n,).

    Of a long line these are the smallest and the largest value of each of ``INTERVALS`` intervals with the same number of
    points, so no peak is lost.  Values may be nan.
    """
    each = len(time) // INTERVALS
    if each < 4:
        return time, values
    whole = each * INTERVALS
    known = np.isfinite(values[:whole]).reshape(INTERVALS, each)
    rows = values[:whole].reshape(INTERVALS, each)
    start = each * np.arange(INTERVALS)
    lowest = start + np.where(known, rows, np.inf).argmin(axis=1)
    highest = start + np.where(known, rows, -np.inf).argmax(axis=1)
    rest = np.arange(whole, len(time))
    kept = np.unique(np.concatenate([[0], lowest, highest, rest]))
    return time[kept], values[kept]


def last_passages(points: np.ndarray, half: float) -> np.ndarray:
    """Numbers (m,), in order, of the segments of a path that a picture shows: from each small cell only the last one that begins there.

    points: (n, 2) of the path, segment i leads from point i to i + 1; half: half the width of the picture.
    """
    count = len(points) - 1
    if count < CELLS**2 // 2:
        return np.arange(count)
    cells = np.floor((points[:-1] / half + 1.0) * (CELLS / 2))
    cells = np.clip(np.nan_to_num(cells), 0, CELLS - 1).astype(np.int64)
    _, last = np.unique((cells[:, 0] * CELLS + cells[:, 1])[::-1], return_index=True)
    return np.sort(count - 1 - last)
