"""Reference solution of a study: a closed form or a separate, finer run; never one of the points."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from drillpetsc.arrays import FloatArray
from drillpetsc.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.studies.convergence.error_norms import NUMERICS, errors_of, extent, richardson
from drillpetsc.studies.convergence.exact_solutions import exact_outputs
from drillpetsc.studies.convergence.plan import (
    INTEGRATORS,
    TIGHTEST_TOLERANCE,
    Base,
    Point,
    case_of,
    finest_tolerance,
    integrator_of,
    mesh_changes,
)
from drillpetsc.studies.convergence.runs import Measured, Runner, measure, outputs_of

#: closed form given by the caller: case, times (k,) [s] -> outputs name -> (k,) [SI], or None
Exact = Callable[[Case, FloatArray], dict[str, FloatArray] | None]

REFERENCE_TOLERANCE_FACTOR = 0.1  # tolerance of the reference over the smallest of the points
REFERENCE_TIME_FACTOR = 3.0  # time limit of a run of the reference over the time limit of a point
CONTROL_TOLERANCE_FACTOR = (
    10.0  # tolerance of the control run for the error of the reference, over the reference's
)
LONGEST_REFERENCE_STEP = 0.25  # over the interval of the rows, which are interpolated between steps
ACCEPTED_REFERENCE_ERROR = 0.02  # estimated error of a reference that is accepted without trying another
CANDIDATES = ("arkimex", "bdf3", "bdf2")  # integrators of the reference, in the order in which they are tried


@dataclass(frozen=True)
class Reference:
    """Reference solution.

    times: (k,) [s].
    values: name -> (k,) [SI].
    description: text for the report.
    exact: whether it is a closed form.
    errors: output -> estimated rms error of the reference over the output's range; NaN if not estimated.
    orders: output -> observed order of a mesh extrapolation.
    refused: integrators that were tried before and failed.
    """

    times: FloatArray
    values: dict[str, FloatArray]
    description: str
    exact: bool = False
    errors: dict[str, float] = field(default_factory=dict)
    orders: dict[str, float] = field(default_factory=dict)
    refused: tuple[str, ...] = ()

    def floor(self, name: str) -> float:
        """Estimated error of an output over its range; 0 if not estimated."""
        value = self.errors.get(name, math.nan)
        return value if math.isfinite(value) else 0.0


@dataclass(frozen=True)
class StudyRuns:
    """How the runs of a study are made.

    base: the case.
    out: folder of the study.
    limit: longest wall time of a run [s].
    run: function that runs one job.
    keep: whether finished runs of the same case are kept.
    say: receives lines of progress.
    """

    base: Base
    out: Path
    limit: float
    run: Runner
    keep: bool
    say: Callable[[str], None]

    def one(self, point: Point, limit: float | None = None) -> Measured:
        return measure(self.base, point, self.out, 1, limit or self.limit, self.run, self.keep)


def find_reference(
    runs: StudyRuns,
    vary: str,
    points: Sequence[Point],
    choice: str,
    times: FloatArray,
    exact: Exact | None = None,
) -> Reference | None:
    """Compute the reference; None if none of its runs is completed.

    choice: auto, exact, arkimex, bdf3, bdf2 or a run folder.
    times: (k,) [s] of the rows of the history.
    exact: closed form given by the caller.
    """
    if vary == "ranks" and choice == "auto":  # the results should not depend on the ranks
        return _of_run(runs, Point("reference", "one-rank", 1.0), "a separate run on one rank")
    if choice in ("auto", "exact"):
        found = _closed_form(runs, times, exact)
        if found is not None:
            return found
        if choice == "exact":
            raise CaseError(
                at="--reference",
                got="exact",
                want="a case with a closed form",
                hint="auto uses a fine run instead",
            )
    if choice not in ("auto", *CANDIDATES):
        return _of_folder(Path(choice))
    if vary == "mesh":
        return _extrapolated(runs, points, "bdf2" if choice == "auto" else choice)
    return _integrated(runs, points, CANDIDATES if choice == "auto" else (choice,))


def _closed_form(runs: StudyRuns, times: FloatArray, exact: Exact | None) -> Reference | None:
    case = case_of(runs.base, Point("", "", 0.0))
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


def _of_run(runs: StudyRuns, point: Point, description: str, limit: float | None = None) -> Reference | None:
    made = runs.one(point, limit)
    if not made.done:
        runs.say(f"reference, {description}: {made.message}")
        return None
    times, values, _ = outputs_of(runs.out / made.folder)
    return Reference(
        times, values, f"{description} ({made.counts['steps']} steps, {made.median('cpu'):.3g} CPU s)"
    )


def _integrated(runs: StudyRuns, points: Sequence[Point], candidates: Sequence[str]) -> Reference | None:
    """Compute a reference with one of ``candidates`` at a tenth of the smallest tolerance.

    Its error is estimated by the difference from a control run with a ten times larger tolerance. Returns the
    first candidate whose error is accepted, otherwise the one with the smallest error. A formula that is
    unstable for the case completes both runs, but with a large difference.
    """
    best: Reference | None = None
    tolerance = max(REFERENCE_TOLERANCE_FACTOR * finest_tolerance(points, runs.base), TIGHTEST_TOLERANCE)
    refused: list[str] = []
    longest = repr(LONGEST_REFERENCE_STEP * runs.base.history_every)
    for name in candidates:
        petsc = {**INTEGRATORS[name][0], "ts_adapt_type": "basic", "ts_adapt_dt_max": longest}
        both = CONTROL_TOLERANCE_FACTOR * tolerance, tolerance
        pair = [
            Point("reference", f"{name}-{tol:.3g}", tol, petsc={**petsc, "ts_rtol": repr(tol)})
            for tol in both
        ]
        runs.say(f"reference by {name} at a tolerance of {tolerance:.3g} ...")
        loose = _of_run(
            runs,
            pair[0],
            f"{name}, tolerance {CONTROL_TOLERANCE_FACTOR * tolerance:.3g}",
            0.5 * REFERENCE_TIME_FACTOR * runs.limit,
        )
        tight = (
            _of_run(runs, pair[1], f"{name}, tolerance {tolerance:.3g}", REFERENCE_TIME_FACTOR * runs.limit)
            if loose is not None
            else None
        )
        if loose is None or tight is None:
            refused.append(name)
            continue
        used = (
            " (also an integrator of the curves)"
            if any(integrator_of({**runs.base.own_options, **p.petsc}) == name for p in points)
            else ""
        )
        own = distance(loose.values, tight.values)
        found = replace(
            tight,
            description=f"separate run by {tight.description}{used}",
            errors=own,
            refused=tuple(refused),
        )
        if max(own.values(), default=0.0) < ACCEPTED_REFERENCE_ERROR:
            return found
        runs.say(
            f"reference, {name}: differs by {max(own.values()):.2g} of the range from its run at {CONTROL_TOLERANCE_FACTOR:g} times the tolerance"
        )
        if best is None or max(own.values()) < max(best.errors.values()):
            best = found
    return best


def distance(a: dict[str, FloatArray], b: dict[str, FloatArray]) -> dict[str, float]:
    """Rms difference of the outputs of two runs, over the range in the second.

    Constant outputs, and columns about the computation such as the step, are left out.
    """
    return {
        name: errors_of(a[name], b[name])["rms"]
        for name in b
        if name not in NUMERICS and name in a and len(a[name]) == len(b[name]) and extent(b[name]) > 0
    }


def _extrapolated(runs: StudyRuns, points: Sequence[Point], integrator: str) -> Reference | None:
    """Richardson extrapolation from three meshes: the finest of the points, and two and four times finer ones.

    The runs are separate, at a tenth of the points' tolerance.
    """
    finest = min(p.value for p in points)
    tolerance = max(REFERENCE_TOLERANCE_FACTOR * finest_tolerance(points, runs.base), TIGHTEST_TOLERANCE)
    meshes: list[Reference] = []
    for part in (1.0, 0.5, 0.25):
        petsc = {**INTEGRATORS[integrator][0], "ts_adapt_type": "basic", "ts_rtol": repr(tolerance)}
        point = Point(
            "reference",
            f"mesh-{part * finest:g}",
            part * finest,
            mesh_changes(runs.base, part * finest),
            petsc,
        )
        runs.say(f"reference on elements of {part * finest:g} times the case's length ...")
        made = _of_run(
            runs, point, f"{integrator}, tolerance {tolerance:.3g}", REFERENCE_TIME_FACTOR * runs.limit
        )
        if made is None:
            return None
        meshes.append(made)
    values, errors, orders = {}, {}, {}
    for name in meshes[-1].values:
        coarse, middle, fine = (mesh.values[name] for mesh in meshes)
        found = richardson(coarse, middle, fine)
        span = extent(found.values)
        values[name], orders[name] = found.values, found.order
        errors[name] = found.error / span if span else math.nan
    return Reference(
        meshes[-1].times,
        values,
        f"Richardson from three meshes, elements {finest:g}, {finest / 2:g}, {finest / 4:g} times the "
        f"case's; the finest by {meshes[-1].description}",
        errors=errors,
        orders=orders,
    )
