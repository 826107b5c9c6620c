"""Modes beside the excitation lines, above the lowest modes: the search of critical speeds there (manual: sec-campbell-lines)."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from drillpetsc.solvers.linear.quadratic_eigenproblem import (
    Eigenvalues,
    QuadraticEigenproblem,
    Selection,
    eigenvalues_near,
)

FIRST = 12  # eigenvalues that the first search about a line computes
WIDER = 1.4  # half width of a search over the way of the line to the next speed: the modes move, too
DAMPED = 0.1  # damping ratio up to which modes are seen there


@dataclass(frozen=True)
class Band:
    """Search about a line at one rotary speed: all modes in a disc of the plane of s.

    middle: frequency of the line; radius: of the disc about i middle; width: the radius that was wanted [rad/s].
    """

    middle: float
    radius: float
    width: float

    def holds(self, s: Any) -> Any:
        """Whether eigenvalues [1/s] lie inside."""
        return np.abs(s - 1j * self.middle) < self.radius


def in_bands(bands: Iterable[Band], s: np.ndarray) -> np.ndarray:
    """(m,) mask of the eigenvalues s (m,) that lie in one of the discs."""
    inside = np.zeros(len(s), dtype=bool)
    for band in bands:
        inside |= band.holds(s)
    return inside


def half_widths(rates: list[float], speed: float, step: float) -> list[tuple[float, float]]:
    """(frequency, half width of the search) of each line [rad/s].

    rates: frequencies of the lines at the rotary ``speed``; step: distance to the farther of the speeds beside it [rad/s].
    """
    return [
        (r, float(np.hypot(WIDER * r * step / speed, DAMPED * r))) for r in rates if np.isfinite(r) and r > 0
    ]


def with_modes_beside(
    problem: QuadraticEigenproblem,
    lowest: Eigenvalues,
    top: float,
    lines: list[tuple[float, float]],
    most: int,
    selected: Selection | None,
) -> tuple[Eigenvalues, tuple[Band, ...]]:
    """The lowest modes and those about the lines above them, with the searches.

    top: frequency [rad/s] up to which ``lowest`` has all modes; lines: from ``half_widths``, those above the modes that were asked for.
    most: eigenvalues that the search about one line may compute; selected: which count.
    """
    parts: list[Eigenvalues] = []
    bands: list[Band] = []
    whole: Eigenvalues | None = None  # of a small system, whose search about any line finds all
    for middle, width in lines:
        if middle + width <= top:
            bands.append(Band(middle, width, width))
            continue
        count = min(FIRST, most)
        near = whole or eigenvalues_near(problem, 1j * middle, count)
        while near.radius < width and count < most:
            # modes follow each other along the axis: their number grows with the radius, and each search starts anew
            count = min(max(2 * count, int(count * min(width / near.radius, most))), most)
            near = eigenvalues_near(problem, 1j * middle, count)
        whole = near if np.isinf(near.radius) else None
        band = Band(middle, min(near.radius, width), width)
        inside = (near.s.imag > top) & band.holds(near.s)
        near = near.subset(inside & ~in_bands(bands, near.s))
        parts.append(near.subset(selected(near)) if selected and len(near.s) else near)
        bands.append(band)
    # beyond the top, ``lowest`` has growing modes alone
    twice = (lowest.s.imag > top) & in_bands(bands, lowest.s)
    parts.insert(0, lowest.subset(~twice))
    s, u, error = (np.concatenate([getattr(q, name) for q in parts], axis=-1) for name in ("s", "u", "error"))
    return Eigenvalues(s, u, error), tuple(bands)


def step_at(speeds: tuple[float, ...]) -> Callable[[float], float]:
    """The farther of the distances from a speed to those beside it in an ascending list [rad/s]; inside a step the step itself."""
    given = np.asarray(speeds)

    def step(speed: float) -> float:
        k, m = (int(np.searchsorted(given, speed, side)) for side in ("left", "right"))
        ends = given[max(k - 1, 0)], given[min(m, len(given) - 1)]
        return float(max(speed - ends[0], ends[1] - speed))

    return step
