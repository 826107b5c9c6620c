"""Derivatives of the outputs of a solution by keys of its case, with flags at kinks and a check by full solutions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from drillpetsc.analysis.sensitivities.doubts import Checked
from drillpetsc.analysis.sensitivities.keys import Key
from drillpetsc.analysis.sensitivities.points import Point, difference, points_of
from drillpetsc.analysis.sensitivities.solution import Found, Output, Solution
from drillpetsc.arrays import FloatArray
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError, SolveError

CURVED = 0.01  # second over first difference at the step, above which there is a kink inside it [-]
CHECK_STEPS = 1e-3, 1e-4  # relative, of the differences of full solutions
ONE_SIDED, LIMIT, DIFFERENCES = "one-sided", "limit", "differences"
Values = Callable[[Case], FloatArray]
"""Outputs (m,) of another case by a full solution; collective. Raises SolveError if it has none."""


@dataclass(frozen=True)
class Derivative:
    """One output by one key; numbers in the SI units of both.

    value: of the output; slope: derivative; flag: one-sided: a kink lies closer than the stated change; limit: the key has a limit
    there, and the derivative is that of the allowed side; differences: of full solutions, as the elements do not correspond or the string stands in mud.
    below, above: effects of the stated change to either side by full solutions, nan where they were not computed.
    """

    output: Output
    key: Key
    value: float
    slope: float
    flag: str = ""
    below: float = np.nan
    above: float = np.nan

    @property
    def effect(self) -> float:
        """Change of the output by the stated change of the key."""
        return self.slope * self.key.per

    @property
    def relative(self) -> float:
        """Share of change over share of change [-]; nan where the output or the key is zero."""
        return self.slope * self.key.value / self.value if self.value and self.key.value else np.nan


def derivatives(
    case: Case, solution: Solution, chosen: Sequence[int], keys: Sequence[Key]
) -> list[Derivative]:
    """Derivatives of the outputs with numbers ``chosen`` by the keys, key by key; collective.

    Raises CaseError for a key that cannot be changed.
    """
    out, full = [], values_of(solution)
    for key in keys:
        slopes, flags = _slopes(case, solution, key)
        flagged = [i for i in chosen if flags[i].startswith(ONE_SIDED)]
        sides = np.full((2, len(flags)), np.nan)
        if flagged:
            sides[:, flagged] = both_sides(case, key, full, solution.found.values)[:, flagged]
        for i in chosen:
            value = float(solution.found.values[i])
            out.append(
                Derivative(solution.outputs[i], key, value, float(slopes[i]), flags[i], *sides[:, i].tolist())
            )
    return out


def values_of(solution: Solution) -> Values:
    """The outputs of other cases, solved as the one of the solution."""
    return lambda case: solution.solved(case).values


def _slopes(case: Case, solution: Solution, key: Key) -> tuple[FloatArray, list[str]]:
    """Derivative (m,) of each output by a key, and its flag."""
    points, limited = points_of(case, key, CHECK_STEPS[0]) if solution.by_solutions else points_of(case, key)
    far = [] if limited or not solution.far else _far(case, key)
    word = LIMIT if limited else ""
    base = solution.found
    try:
        found = [] if solution.by_solutions else solution.near([*points, *far])
    except ValueError:
        found = []
    if not found:
        found, word = [solution.solved(point.case) for point in points], DIFFERENCES
    near = found[: len(points)]
    slopes, sizes = difference(points, [f.values for f in near]), largest_size(base, solution.outputs)
    # changes below the resolution of the solution are no effect
    with np.errstate(invalid="ignore", divide="ignore"):
        slopes = np.where(np.abs(slopes) * key.size < solution.resolution * sizes, 0.0, slopes)
        spread = near[0].values + near[-1].values - 2 * base.values
        bent = np.abs(spread) > CURVED * np.abs(near[-1].values - near[0].values)
        bent &= np.abs(spread) * key.size > solution.resolution * sizes * points[-1].change
    flags = []
    for i in range(len(slopes)):
        kink = any(f.states[i] != base.states[i] for f in found) or (not limited and bool(bent[i]))
        flags.append(", ".join(filter(None, [ONE_SIDED if kink and slopes[i] else "", word])))
    return slopes, flags


def _far(case: Case, key: Key) -> list[Point]:
    """Points at the stated change on either side, where it is allowed."""
    out = []
    for change in (-key.per, key.per):
        try:
            out.append(Point(key.changed(case, key.value + change), key, change, 0.0))
        except CaseError:
            continue
    return out


def both_sides(case: Case, key: Key, values: Values, base: FloatArray) -> FloatArray:
    """Effects (2, m) of the stated change below and above on the outputs ``base``; nan where there is none."""
    out = []
    for sign in (-1.0, 1.0):
        try:
            out.append(sign * (values(key.changed(case, key.value + sign * key.per)) - base))
        except (CaseError, SolveError):
            out.append(np.full(len(base), np.nan))
    return np.array(out)


def checked(case: Case, solution: Solution, found: Sequence[Derivative], count: int) -> list[Checked]:
    """Compare ``count`` derivatives with differences of full solutions: the largest, the median and others at random; collective."""
    places = {id(output): i for i, output in enumerate(solution.outputs)}
    able = [d for d in found if not d.flag and d.slope and np.isfinite(d.relative)]
    able.sort(key=lambda d: -abs(d.relative))
    others = np.random.default_rng(1).permutation(len(able))
    order = dict.fromkeys([0, len(able) // 2, *others.tolist()]) if able else {}
    out, known = [], {}
    for d in [able[i] for i in order][:count]:
        if d.key.name not in known:
            known[d.key.name], _ = full_difference(case, d.key, values_of(solution))
        full = float(known[d.key.name][places[id(d.output)]])
        out.append(Checked(case, d.output.label, d.key.name, d.relative, full * d.key.value / d.value))
    return out


def full_difference(
    case: Case, key: Key, values: Values, steps: tuple[float, float] = CHECK_STEPS
) -> tuple[FloatArray, FloatArray]:
    """Derivative (m,) by central differences of full solutions with two relative steps, extrapolated (Richardson), and that of the
    first step; collective."""
    slopes = []
    for step in steps:
        points, _ = points_of(case, key, step)
        slopes.append(np.asarray(difference(points, [values(point.case) for point in points])))
    square = (steps[0] / steps[1]) ** 2
    return (square * slopes[1] - slopes[0]) / (square - 1), slopes[0]


def largest_size(found: Found, outputs: Sequence[Output]) -> FloatArray:
    """(m,) size of each output: its value, or a thousandth of the largest with its unit if that is more."""
    sizes, values = np.abs(found.values), np.nan_to_num(np.abs(found.values))
    units = np.array([output.quantity.unit for output in outputs])
    for unit in set(units):
        mine = units == unit
        sizes[mine] = np.fmax(sizes[mine], 1e-3 * values[mine].max())
    return np.asarray(sizes)
