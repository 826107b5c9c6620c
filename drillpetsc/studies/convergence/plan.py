"""Plan of a study: curves of points. A point is the case with changed keys and PETSc options.

Steps lie around the mean step of a run of the unchanged case (the pilot), tolerances around its tolerance.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.analysis.motion.integrator_choice import is_alpha
from drillpetsc.case import Case, case_from_data, data_of_case, override
from drillpetsc.case.blocks.items.string import Flexible
from drillpetsc.errors import CaseError
from drillpetsc.units import is_number

Options = dict[str, str]

VARIED = ("time-step", "tolerance", "order", "mesh", "formulation", "integrator", "solver", "ranks")
TOLERANCE = 1e-4  # of a case without -ts_rtol
STEP_FACTORS = (8.0, 4.0, 2.0, 1.0, 0.5, 0.25)  # multiples of the pilot's mean step
TOLERANCE_FACTORS = (100.0, 10.0, 1.0, 0.1, 0.01)
MESH_FACTORS = (4.0, 3.0, 2.0, 1.5, 1.0)  # multiples of the case's element lengths
MESH_TOLERANCE = 0.01  # tolerance of a study of the mesh, over the case's tolerance
LOOSEST_TOLERANCE = 0.1
TIGHTEST_TOLERANCE = 1e-10  # reachable by Newton's method in double precision
FEWEST_ROWS = 50  # rows of the history, for norms over time

#: integrator -> PETSc options, and whether it can control its step size
INTEGRATORS: dict[str, tuple[Options, bool]] = {
    "bdf1": ({"ts_type": "bdf", "ts_bdf_order": "1"}, True),
    "bdf2": ({"ts_type": "bdf", "ts_bdf_order": "2"}, True),
    # the clip keeps variable-step BDF3 zero-stable
    "bdf3": ({"ts_type": "bdf", "ts_bdf_order": "3", "ts_adapt_clip": "0.2,1.5"}, True),
    "arkimex": ({"ts_type": "arkimex", "ts_arkimex_type": "4", "ts_arkimex_fully_implicit": "true"}, True),
    "arkimex3": ({"ts_type": "arkimex", "ts_arkimex_type": "3", "ts_arkimex_fully_implicit": "true"}, True),
    "cn": ({"ts_type": "cn"}, False),
    "beuler": ({"ts_type": "beuler"}, False),
    "alpha": ({"ts_type": "alpha"}, False),
    "alpha2": ({"ts_type": "alpha2"}, True),
}
SOLVERS: dict[str, Options] = {
    "condensed": {},
    "petsc-lu": {"q_pc_type": "lu"},
    "line-search-bt": {"q_snes_linesearch_type": "bt"},
    "line-search-basic": {"q_snes_linesearch_type": "basic"},
    "assembled": {"snes_type": "newtonls"},
}
DEFAULT_SOLVERS = ("condensed", "petsc-lu", "line-search-bt", "assembled")
DEFAULT_INTEGRATORS = ("bdf1", "bdf2", "bdf3", "alpha2", "arkimex", "cn")
FORMULATIONS = ("ancf", "quaternion")
#: curves of --curves: name -> (integrator, whether it controls its step size, formulation; empty for that of
#: the case)
CURVES: dict[str, tuple[str, bool, str]] = {
    "bdf1-fixed": ("bdf1", False, ""),
    "bdf2-fixed": ("bdf2", False, ""),
    "bdf3-fixed": ("bdf3", False, ""),
    "bdf2": ("bdf2", True, ""),
    "bdf3": ("bdf3", True, ""),
    "alpha2-fixed": ("alpha2", False, ""),
    "alpha2": ("alpha2", True, ""),
    "arkimex": ("arkimex", True, ""),
    "quaternion-bdf1-fixed": ("bdf1", False, "quaternion"),
    "quaternion-bdf2-fixed": ("bdf2", False, "quaternion"),
    "quaternion-bdf2": ("bdf2", True, "quaternion"),
}
DEFAULT_CURVES = tuple(CURVES)[:-1]


@dataclass(frozen=True)
class Point:
    """One point of a curve.

    curve, label: names of the curve and of the point.
    value: quantity that varies along the curve (step [s], tolerance, factor on the element lengths, ranks).
    changes: changed keys of the case (`key=value`).
    petsc: PETSc options in addition to the case's.
    ranks: number of ranks of the run.
    """

    curve: str
    label: str
    value: float
    changes: tuple[str, ...] = ()
    petsc: Options = field(default_factory=dict)
    ranks: int = 1


@dataclass(frozen=True)
class Base:
    """The case of a study, and the scales from which its points are chosen.

    path, data, lines: file of the case, its data and line numbers.
    options: PETSc options of the command line.
    end: end of the simulated time [s].
    tolerance: -ts_rtol of the case.
    history_every: interval of the rows of the history [s].
    step: mean step of the pilot [s]; 0 if unknown.
    steps, tolerances: steps [s] and tolerances of all curves, if given.
    """

    path: Path
    data: dict[str, Any]
    lines: Any
    options: Options
    end: float
    tolerance: float
    history_every: float
    step: float = 0.0
    steps: tuple[float, ...] = ()
    tolerances: tuple[float, ...] = ()

    @property
    def own_options(self) -> dict[str, Any]:
        """PETSc options of the case, overridden by the command line."""
        return {**(self.data.get("petsc") or {}), **self.options}


def read_base(
    case: Case | str | Path,
    options: Options,
    changes: Sequence[str] = (),
    steps: Sequence[str] = (),
    tolerances: Sequence[str] = (),
) -> Base:
    """Read the case file of a study; raises CaseError for a case that cannot run."""
    path, data, lines = data_of_case(case)
    for change in changes:
        data = override(data, change)
    case = case_from_data(data, path, lines)
    if case.time is None:
        raise CaseError(at="time", want="a block {end: ...}", file=path)
    end = case.time.end
    # the integrator as options, which the points of a curve replace
    chosen: dict[str, Any] = {}
    if is_alpha(case, case.petsc) and "ts_type" not in case.petsc:
        radius = case.time.spectral_radius
        chosen = {"ts_type": "alpha2"} | ({} if radius is None else {"ts_alpha_radius": radius})
    time = {k: v for k, v in data["time"].items() if k != "spectral_radius"} | {"integrator": "bdf"}
    data = {**data, "time": time, "petsc": {**data.get("petsc", {}), **chosen}}
    every = case.output.with_intervals(end).history_every
    assert every is not None
    petsc = {**case.petsc, **options}
    return Base(
        path,
        data,
        lines,
        options,
        end,
        float(petsc.get("ts_rtol", TOLERANCE)),
        min(every, end / FEWEST_ROWS),
        steps=tuple(numbers("time-step", steps, "--steps")),
        tolerances=tuple(numbers("tolerance", tolerances, "--tolerances")),
    )


def case_of(base: Base, point: Point) -> Case:
    """The case of a point, with all options in its `petsc` block; raises CaseError for an invalid point."""
    data = base.data
    every = {
        "output.history_every": base.history_every,
        "output.field_every": base.end,
        "output.checkpoint_every": base.end,
    }
    for change in (*(f"{key}={value!r}" for key, value in every.items()), *point.changes):
        data = override(data, change)
    return case_from_data(
        {**data, "petsc": _fitting({**base.own_options, **point.petsc})}, base.path, base.lines
    )


def _fitting(petsc: dict[str, Any]) -> dict[str, Any]:
    """Options that the chosen integrator and solver read; a run would refuse the others."""
    kind = str(petsc.get("ts_type", "bdf"))
    condensed = kind in ("bdf", "alpha2", "genalpha") and str(petsc.get("snes_type", "python")) == "python"

    def fits(name: str) -> bool:
        if name.startswith("q_"):
            return condensed
        if name.startswith("ts_bdf_"):
            return kind == "bdf"
        if name.startswith("ts_alpha_"):
            return kind in ("alpha", "alpha2", "genalpha")
        return not (name == "ts_adapt_clip" and petsc.get("ts_adapt_type") == "none")

    return {name: value for name, value in petsc.items() if fits(name)}


def mesh_changes(base: Base, factor: float) -> tuple[str, ...]:
    """Changes that make every element ``factor`` times as long; an item keeps at least one element."""
    case = case_from_data(base.data, base.path, base.lines)
    flexible = [(i, item) for i, item in enumerate(case.string) if isinstance(item, Flexible)]
    changes = [
        f"string[{i}].element_length={min(factor * item.element_length, item.length)!r}"
        for i, item in flexible
        if not isinstance(item.element_length, str)
    ]
    if len(changes) < len(flexible):
        changes.append(f"mesh.refinement={case.mesh.refinement / factor!r}")
    return tuple(changes)


# ---------------------------------------------------------------------- values along a curve
def default_steps(base: Base) -> list[float]:
    """Fixed steps [s] around the pilot's mean step.

    They are the interval of the rows times powers of two, so that steps end at rows.
    """
    if base.steps:
        return list(base.steps)
    mean = base.step or base.history_every
    power = round(float(np.log2(mean / base.history_every)))
    return [
        base.history_every * 2.0**power * f
        for f in STEP_FACTORS
        if base.history_every * 2.0**power * f <= base.end / 4
    ]


def default_tolerances(base: Base) -> list[float]:
    """Tolerances over four decades around the case's, none above LOOSEST_TOLERANCE."""
    if base.tolerances:
        return list(base.tolerances)
    top = min(TOLERANCE_FACTORS[0] * base.tolerance, LOOSEST_TOLERANCE)
    return [float(f"{top * f / TOLERANCE_FACTORS[0]:.4g}") for f in TOLERANCE_FACTORS]


def newton_tolerance(base: Base, step: float, order: int) -> float:
    """-ts_rtol of a run with fixed steps, in which it controls the Newton iteration only.

    It is the expected local error of the step, tolerance (step/mean step)^(order + 1), and at most the
    tolerance of the case. A larger one would hide the order of convergence.
    """
    mean = base.step or base.history_every
    return float(np.clip(base.tolerance * (step / mean) ** (order + 1), TIGHTEST_TOLERANCE, base.tolerance))


def fixed_points(
    curve: str, base: Base, steps: Sequence[float], petsc: Options, changes: tuple[str, ...] = ()
) -> list[Point]:
    order = int(petsc.get("ts_bdf_order", 4 if "arkimex" in petsc.get("ts_type", "") else 2))
    return [
        Point(
            curve,
            f"{h:.6g}s",
            h,
            changes,
            {
                **petsc,
                "ts_adapt_type": "none",
                "ts_dt": repr(float(h)),
                "ts_rtol": repr(newton_tolerance(base, h, order)),
            },
        )
        for h in steps
    ]


def adaptive_points(
    curve: str, tolerances: Sequence[float], petsc: Options, changes: tuple[str, ...] = ()
) -> list[Point]:
    petsc = {**petsc, "ts_adapt_type": "basic"}
    return [
        Point(curve, f"{tol:.6g}", tol, changes, {**petsc, "ts_rtol": repr(float(tol))}) for tol in tolerances
    ]


# ---------------------------------------------------------------------- plans
def plan_of(vary: str, base: Base, values: Sequence[str] = ()) -> list[Point]:
    """Points of ``--vary``.

    values: values along the curve; for order, formulation, integrator and solver the names of the curves.
    """
    if vary in ("time-step", "tolerance", "mesh", "ranks"):
        return _one_curve(vary, base, numbers(vary, values))
    return plan_curves(vary, values, base)


def integrator_of(options: Mapping[str, Any]) -> str:
    """Name of the integrator that options choose: bdf with its order, or a -ts_type."""
    kind = str(options.get("ts_type", "bdf"))
    return f"bdf{options.get('ts_bdf_order', 2)}" if kind == "bdf" else kind


def _one_curve(vary: str, base: Base, values: Sequence[float]) -> list[Point]:
    own = base.own_options
    name = integrator_of(own)
    if vary == "time-step":
        petsc: Options = {k: str(v) for k, v in own.items() if k in ("ts_type", "ts_bdf_order")}
        return fixed_points(f"{name}-fixed", base, values or default_steps(base), petsc)
    if vary == "tolerance":
        return adaptive_points(name, values or default_tolerances(base), {})
    if vary == "mesh":  # the time error is equal at all points, and small
        petsc = {"ts_rtol": repr(max(MESH_TOLERANCE * base.tolerance, TIGHTEST_TOLERANCE))}
        return [Point("mesh", f"{f:g}", f, mesh_changes(base, f), petsc) for f in values or MESH_FACTORS]
    ranks = [int(v) for v in values or (1, 2)]
    return [Point("ranks", str(n), float(n), ranks=n) for n in ranks]


#: what several curves may vary: the words that are allowed, and those without a choice of the user
_CHOICES: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "order": (tuple("123456"), tuple("123")),
    "formulation": (FORMULATIONS, FORMULATIONS),
    "integrator": (tuple(INTEGRATORS), DEFAULT_INTEGRATORS),
    "solver": (tuple(SOLVERS), DEFAULT_SOLVERS),
    "curves": (tuple(CURVES), DEFAULT_CURVES),
}


def _curve(vary: str, word: str) -> tuple[str, Options, bool, str]:
    """A curve: its name, its options, whether its tolerance varies instead of its step, and the formulation if it is not the case's."""
    if vary == "order":
        return f"bdf{word}-fixed", {"ts_type": "bdf", "ts_bdf_order": word}, False, ""
    if vary == "formulation":
        return f"{word}-bdf2-fixed", INTEGRATORS["bdf2"][0], False, word
    if vary == "integrator":
        petsc, adaptive = INTEGRATORS[word]
        return word if adaptive else f"{word}-fixed", petsc, adaptive, ""
    if vary == "curves":
        integrator, adaptive, formulation = CURVES[word]
        return word, INTEGRATORS[integrator][0], adaptive, formulation
    return word.replace(" ", "_"), SOLVERS.get(word) or options_of(word.split()), True, ""


def plan_curves(vary: str, words: Sequence[str], base: Base, few: bool = False) -> list[Point]:
    """Points of several curves, which differ in order, formulation, integrator or solver, or are named; few: three a curve."""
    steps, tolerances = default_steps(base), default_tolerances(base)
    if few:
        steps, tolerances = steps[:3], tolerances[:3]
    allowed, usual = _CHOICES[vary]
    points: list[Point] = []
    for word in words or usual:
        if word not in allowed and not (vary == "solver" and word.startswith("-")):
            at = "--curves" if vary == "curves" else "--values"
            raise CaseError(at=at, got=word, want=" | ".join(allowed))
        name, petsc, adaptive, formulation = _curve(vary, word)
        changes = (f"beam.formulation={formulation}",) if formulation else ()
        points += (
            adaptive_points(name, tolerances, petsc, changes)
            if adaptive
            else fixed_points(name, base, steps, petsc, changes)
        )
    return points


def numbers(vary: str, words: Sequence[str], option: str = "--values") -> list[float]:
    """Convert words to numbers above 0; time steps may have a unit."""
    found = []
    for word in words:
        try:
            value = _seconds(word) if vary == "time-step" else float(word)
        except (ValueError, CaseError):
            value = float("nan")
        if not value > 0 or (vary == "ranks" and value != int(value)):
            kind = {"time-step": "times above 0, such as 1 ms", "ranks": "whole numbers above 0"}.get(
                vary, "numbers above 0"
            )
            raise CaseError(at=option, got=word, want=kind)
        found.append(value)
    return found


def _seconds(word: str) -> float:
    try:
        return float(word)
    except ValueError:
        from drillpetsc.units import to_si

        return float(to_si(word, "s"))


def options_of(words: Sequence[str]) -> Options:
    """Mapping name -> value from PETSc options on the command line, -name [value]."""
    found: Options = {}
    name = ""
    for word in words:
        if word.startswith("-") and not is_number(word):
            name = word[1:]
            found[name] = ""
        elif name:
            found[name] = word
    return found


def finest_tolerance(points: Sequence[Point], base: Base) -> float:
    """Smallest -ts_rtol among the points with error control.

    Without such points, the tolerance that corresponds to the shortest fixed step: the local error of the
    default formula has order 3.
    """
    controlled = [
        float(p.petsc.get("ts_rtol", base.tolerance))
        for p in points
        if p.petsc.get("ts_adapt_type") != "none"
    ]
    if controlled:
        return min(controlled)
    return min((newton_tolerance(base, p.value, 2) for p in points), default=base.tolerance)
