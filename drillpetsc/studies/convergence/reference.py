"""What the points of a study are measured against: a closed form, or a separately integrated finer run; never
one of the points."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from drillpetsc.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.studies.convergence.error_norms import errors_of, extent, richardson
from drillpetsc.studies.convergence.exact_solutions import exact_outputs
from drillpetsc.studies.convergence.plan import (
    INTEGRATORS,
    TIGHTEST,
    Base,
    Point,
    case_of,
    finest_tolerance,
    mesh_changes,
)
from drillpetsc.studies.convergence.runs import Measured, Runner, measure, outputs_of

FloatArray = npt.NDArray[np.float64]
#: a closed form from outside: case, times (k,) [s] -> outputs name -> (k,), or None
Exact = Callable[[Case, FloatArray], dict[str, FloatArray] | None]

FINER = 0.1  # tolerance of the reference over the finest of the points
REFERENCE_TIME_FACTOR = 3.0  # a run of the reference may take so many times longer than a point's
LOOSER = 10.0  # of the run by which the reference's own error is estimated
ROWS_PER_STEP = 0.25  # longest step of the reference over the interval of the rows, which lie between steps
ACCEPTED_REFERENCE_ERROR = 0.02  # own error below which a reference needs no other beside it
CANDIDATES = ("arkimex", "bdf3", "bdf2")  # the first that can treat the scene within the time limit


@dataclass(frozen=True)
class Reference:
    """times: (k,) [s]; values: name -> (k,) [SI]; words: what it is; exact: whether a closed form.

    errors: its own error by output, as a share of the output's range, rms (NaN: not estimated); refused: what
    else was tried.
    """

    times: FloatArray
    values: dict[str, FloatArray]
    words: str
    exact: bool = False
    errors: dict[str, float] = field(default_factory=dict)
    orders: dict[str, float] = field(default_factory=dict)  # of a mesh extrapolation
    refused: tuple[str, ...] = ()

    def floor(self, name: str) -> float:
        value = self.errors.get(name, math.nan)
        return value if math.isfinite(value) else 0.0


@dataclass(frozen=True)
class Bench:
    """Where and how the runs of a study are made."""

    base: Base
    out: Path
    limit: float
    run: Runner
    keep: bool
    say: Callable[[str], None]

    def one(self, point: Point, limit: float | None = None) -> Measured:
        return measure(self.base, point, self.out, 1, limit or self.limit, self.run, self.keep)


def find_reference(
    bench: Bench,
    vary: str,
    points: Sequence[Point],
    choice: str,
    times: FloatArray,
    exact: Exact | None = None,
) -> Reference | None:
    """The reference that ``choice`` asks for (auto, exact, arkimex, bdf3, bdf2 or a run folder); None where
    no run of it comes to an end.

    times: (k,) [s] of the history's rows.
    """
    if vary == "ranks" and choice == "auto":  # what is asked is whether the results agree
        return _of_run(bench, Point("reference", "one-rank", 1.0), "a separate run on one rank")
    if choice in ("auto", "exact"):
        found = _closed_form(bench, times, exact)
        if found is not None:
            return found
        if choice == "exact":
            raise CaseError(
                at="--reference",
                got="exact",
                want="a scene with a closed form",
                hint="auto takes a fine run instead",
            )
    if choice not in ("auto", *CANDIDATES):
        return _of_folder(Path(choice))
    if vary == "mesh":
        return _extrapolated(bench, points, "bdf2" if choice == "auto" else choice)
    return _integrated(bench, points, CANDIDATES if choice == "auto" else (choice,))


def _closed_form(bench: Bench, times: FloatArray, exact: Exact | None) -> Reference | None:
    case = case_of(bench.base, Point("", "", 0.0))
    if exact is not None:
        values = exact(case, times)
        return None if values is None else Reference(times, values, "closed form", exact=True)
    found = exact_outputs(case, times)
    return None if found is None else Reference(times, found[0], f"closed form: {found[1]}", exact=True)


def _of_folder(folder: Path) -> Reference:
    try:
        times, values, _ = outputs_of(folder)
    except (OSError, ValueError, KeyError) as error:
        raise CaseError(
            at="--reference", got=str(folder), want="a run folder with a history.csv", hint=str(error)
        ) from None
    return Reference(times, values, f"the run {folder.name}, given")


def _of_run(bench: Bench, point: Point, words: str, limit: float | None = None) -> Reference | None:
    made = bench.one(point, limit)
    if not made.done:
        bench.say(f"reference, {words}: {made.message}")
        return None
    times, values, _ = outputs_of(bench.out / made.folder)
    return Reference(times, values, f"{words} ({made.counts['steps']} steps, {made.median('cpu'):.3g} CPU s)")


def _integrated(bench: Bench, points: Sequence[Point], candidates: Sequence[str]) -> Reference | None:
    """A run by another integrator at a tenth of the finest tolerance, and its distance to one ten times
    looser as its own error.

    The first candidate that is sure of itself (a formula that is not stable for the scene comes to its end
    far off), else the surest.
    """
    surest: Reference | None = None
    tolerance = max(FINER * finest_tolerance(points, bench.base), TIGHTEST)
    refused: list[str] = []
    longest = repr(ROWS_PER_STEP * bench.base.history_every)
    for name in candidates:
        petsc = {**INTEGRATORS[name][0], "ts_adapt_type": "basic", "ts_adapt_dt_max": longest}
        both = LOOSER * tolerance, tolerance
        pair = [
            Point("reference", f"{name}-{tol:.3g}", tol, petsc={**petsc, "ts_rtol": repr(tol)})
            for tol in both
        ]
        bench.say(f"reference by {name} at a tolerance of {tolerance:.3g} ...")
        loose = _of_run(
            bench,
            pair[0],
            f"{name}, tolerance {LOOSER * tolerance:.3g}",
            0.5 * REFERENCE_TIME_FACTOR * bench.limit,
        )
        tight = (
            _of_run(bench, pair[1], f"{name}, tolerance {tolerance:.3g}", REFERENCE_TIME_FACTOR * bench.limit)
            if loose is not None
            else None
        )
        if loose is None or tight is None:
            refused.append(name)
            continue
        used = (
            " (an integrator of the curves, too)"
            if any(_integrator(p, bench.base) == name for p in points)
            else ""
        )
        own = distance(loose.values, tight.values)
        found = replace(
            tight, words=f"separate run by {tight.words}{used}", errors=own, refused=tuple(refused)
        )
        if max(own.values(), default=0.0) < ACCEPTED_REFERENCE_ERROR:
            return found
        bench.say(
            f"reference, {name}: off by {max(own.values()):.2g} of the range from itself at {LOOSER:g} times the tolerance"
        )
        if surest is None or max(own.values()) < max(surest.errors.values()):
            surest = found
    return surest


def _integrator(point: Point, base: Base) -> str:
    options = {**base.own_options, **point.petsc}
    return (
        f"bdf{options.get('ts_bdf_order', 2)}"
        if options.get("ts_type", "bdf") == "bdf"
        else str(options["ts_type"])
    )


def distance(a: dict[str, FloatArray], b: dict[str, FloatArray]) -> dict[str, float]:
    """Rms difference of the outputs of two runs, as a share of the range in the second; outputs that stand
    still are left out."""
    return {
        name: errors_of(a[name], b[name])["rms"]
        for name in b
        if name in a and len(a[name]) == len(b[name]) and extent(b[name]) > 0
    }


def _extrapolated(bench: Bench, points: Sequence[Point], integrator: str) -> Reference | None:
    """Richardson from three meshes: the finest of the points, and two and four times finer ones; separate
    runs at a tenth of the points' tolerance."""
    finest = min(p.value for p in points)
    tolerance = max(FINER * finest_tolerance(points, bench.base), TIGHTEST)
    runs: list[Reference] = []
    for part in (1.0, 0.5, 0.25):
        petsc = {**INTEGRATORS[integrator][0], "ts_adapt_type": "basic", "ts_rtol": repr(tolerance)}
        point = Point(
            "reference",
            f"mesh-{part * finest:g}",
            part * finest,
            mesh_changes(bench.base, part * finest),
            petsc,
        )
        bench.say(f"reference on elements of {part * finest:g} times the case's length ...")
        made = _of_run(
            bench, point, f"{integrator}, tolerance {tolerance:.3g}", REFERENCE_TIME_FACTOR * bench.limit
        )
        if made is None:
            return None
        runs.append(made)
    values, errors, orders = {}, {}, {}
    for name in runs[-1].values:
        coarse, middle, fine = (r.values[name] for r in runs)
        found = richardson(coarse, middle, fine)
        span = extent(found.values)
        values[name], orders[name] = found.values, found.order
        errors[name] = found.error / span if span else math.nan
    return Reference(
        runs[-1].times,
        values,
        f"Richardson from three meshes, elements {finest:g}, {finest / 2:g}, {finest / 4:g} times the "
        f"case's; the finest by {runs[-1].words}",
        errors=errors,
        orders=orders,
    )
