"""The `modes` command: natural frequencies, damping and stability about a static or steadily rotating state.

    model = build_model(case)
    prepare_state(model)           # equilibrium, then the steady motion that the top prescribes
    result = modes(model, count=20)

The model is linearised at its present state (manual: sec-eigen-state).  Closed contacts are springs, open
ones are absent.  Friction has the slope of its law at the present sliding speed.  About rest there is no
friction: the regularised law would act as a stiff damper at closed contacts, without sticking or sliding.  About
a rotating state the directions of the pipe's section are frozen.  This is exact
for a round string (gyroscopic terms, damping that turns with the pipe), and an instantaneous picture of a
bent or eccentric one.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from drillpetsc.analysis.linear.doubts import Modal
from drillpetsc.analysis.linear.frequency.stokes import (
    at_own_frequencies,
    frequency_dependent,
    stokes_numbers,
)
from drillpetsc.analysis.linear.linearised_model import linearise_model, mean_over_turn, settle
from drillpetsc.analysis.linear.modes import KINDS, Modes
from drillpetsc.analysis.linear.modes_of_kind import lowest_of_kind
from drillpetsc.analysis.motion.run_options import options_of
from drillpetsc.analysis.motion.time_scales import time_scales
from drillpetsc.analysis.statics.equilibrium import StaticState
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.analysis.statics.placement import motion_text, move_rigidly, prescribed_motion, release
from drillpetsc.analysis.statics.steady_flow import release_flow
from drillpetsc.arrays import FloatArray
from drillpetsc.case.case import Case
from drillpetsc.case.checks.limits import refuse_quaternion
from drillpetsc.doubts import doubts_at
from drillpetsc.errors import CaseError
from drillpetsc.fem.component import DRIVE
from drillpetsc.model.drilling_model import DrillingModel, build_model
from drillpetsc.model.top import continuous_control
from drillpetsc.output import FieldWriter, RunFolder
from drillpetsc.output.files.atomic import replace_file
from drillpetsc.output.files.vtk import write_vtu
from drillpetsc.output.files.well_files import write_well_files
from drillpetsc.output.job import Job, RunResult
from drillpetsc.output.measured.field_output import FieldOutput
from drillpetsc.parallel import first_rank_gives
from drillpetsc.physics.tools.mud_motor import MudMotor
from drillpetsc.solvers.linear.linearization import Linearised
from drillpetsc.solvers.linear.quadratic_eigenproblem import (
    Eigenvalues,
    eigenvalues_near,
    lowest_eigenvalues,
)

STATES = ("steady", "rest")
FREE_SPIN = 1e3  # spin over way above which a vector of a root zero turns freely [rad/m]
ZERO_FRACTION = 1e-3  # eigenvalues below this fraction of the reference rate are zero: unconstrained motions
PAYING = 1e-3  # share of the pay-out in the shape of a free drum, over the share in any other mode about zero
#: weights of the fluid's rows [per m3/s] and [per Pa] (kernels/fluid/flow.hpp)
ROW_WEIGHT = {"pressure": 1e6, "flow": 1e-2}
LATERAL = 1e-6  # share of lateral motion from which the mud's force across the hole matters
SHAPE_PRESSURE = 1e5  # largest pressure in the shape of a mode of the fluid [Pa]


# ---------------------------------------------------------------------- state
def without_motor(case: Case) -> Case:
    """The case with its top held at the prescribed rotation and lowering: no motor, no hoist, no controllers."""
    if case.top.motor is None and case.top.hoist is None:
        return case
    without = {"motor": None, "control": (), "torque": None, "hoist": None, "autodriller": None}
    top = case.top.model_copy(update=without)
    return case.model_copy(update={"top": top})


def prepare_state(model: DrillingModel, about: str = "steady") -> StaticState:
    """Set the model to the state for the linearisation (manual: sec-eigen-state); collective.

    about: ``steady`` or ``rest``.  Steady is the start of a run: in equilibrium with friction against the
    motion that the top prescribes at time 0, and in that motion.  Rest is in equilibrium without friction, at
    rest.

    Raises SolveError if no equilibrium is found.
    """
    if about == "steady" and (prescribed_motion(model) != (0.0, 0.0) or model.parts(MudMotor)):
        state = find_equilibrium(model)
        release(model)
        move_rigidly(model)
        state.warnings += settle(model)
        return state
    state = find_equilibrium(model, (0.0, 0.0))
    state.warnings += rest_of(model)
    return state


def rest_of(model: DrillingModel) -> list[str]:
    """From an equilibrium, set the model to rest without friction; returns notes; collective."""
    release(model, at_rest=True)
    notes = settle(model)
    for part in model.components:
        # no sliding: without friction, which at rest would be a damper of mu N over the slip velocity
        part.impose_sliding_direction(0.0, 0.0)
    model.system.assembly.y[:] = 0.0
    release_flow(model)
    return notes


def reference_rate(model: DrillingModel) -> float:
    """Compute a slow rate of the model [1/s] (manual: eq-eigen-reference).

    It combines the lowest bending frequency of the whole string between hinges and its pendulum frequency.
    For a held string it is the inverse travel time of sound along the string.
    """
    mesh, length = model.mesh, model.mesh.total_length
    if not model.beam.moves and model.fluid is not None:
        fluid = model.fluid.constants
        return float(np.sqrt(fluid.bulk_modulus / fluid.density) / length)
    mass = float(mesh.mass @ mesh.length + sum(b.mass for b in mesh.bodies)) / length
    bending = np.pi**4 * float(mesh.bending_stiffness.min()) / (length**4 * mass)
    return float(np.sqrt(bending + np.linalg.norm(model.case.gravity) / length))


def unbalanced_force(model: DrillingModel) -> float:
    """Compute the largest unbalanced force on a node [N], 0 without unknown positions; collective."""
    system = model.system
    rows = system.new_condensed()
    system.sum_residual(0.0, rows)
    owned = system.layout.local_of_owned
    position = np.array([f.name == "string.position" for f in system.layout.fields])[
        system.layout.field_of[owned]
    ]
    largest = float(np.abs(rows.getArray(readonly=1)[position]).max(initial=0.0))
    return max(system.comm.tompi4py().allgather(largest))


# ---------------------------------------------------------------------- modes
def modes(
    model: DrillingModel,
    count: int = 20,
    shift: float | None = None,
    kind: str | None = None,
    engine: str = "auto",
) -> Modes:
    """Compute the modes of the model about its present state, the same on all ranks; collective.

    Without a shift the result contains the lowest oscillating modes, all growing modes computed with them,
    and a few of the slowest that do not oscillate (manual: sec-eigen-search).

    model: in the state of ``prepare_state``.
    count: number of oscillating modes.
    shift: the ``count`` modes nearest to this frequency [Hz] instead.
    kind: only modes of this one of ``KINDS``; stability is then known for that kind only.
    engine: as in ``eigenvalues_near``.

    Raises SolveError if no eigenvalue converges.
    """
    system, reference = model.system, reference_rate(model)
    imbalance, own = unbalanced_force(model), frequency_dependent(model)
    linearised = linearise_model(model)

    def solve() -> Any:
        assert linearised is not None  # rank 0 has it
        problem = linearised.eigenproblem(reference)
        if shift is None and kind:
            selected = _of_kind(model, linearised, kind)
            eigenvalues = lowest_of_kind(model, linearised, problem, count, kind, selected, engine)
        elif shift is None:
            eigenvalues = lowest_eigenvalues(problem, count, engine)
        else:
            eigenvalues = _nearest(
                eigenvalues_near(problem, 2j * np.pi * shift, 2 * count, engine), shift, count
            )
        for component in model.components:
            for _ in range(component.free_angles):
                eigenvalues = _without_free_angle(model, linearised, eigenvalues)
            if component.free_length:
                eigenvalues = _without_free_length(component.free_length, model, linearised, eigenvalues)
        kept, numbers = 0, None
        if own is not None:
            share = _shares(model, linearised, eigenvalues.s, linearised.vectors(eigenvalues))
            refined = at_own_frequencies(own, eigenvalues, share[:, 0])
            eigenvalues, kept = refined.found, refined.kept
        s, share, error, shapes = _describe(model, linearised, eigenvalues)
        if own is not None:
            numbers = np.where(
                share[:, 0] > LATERAL, stokes_numbers(own, s, shapes["string.position"]), np.nan
            )
        return s, share, error, shapes, numbers, kept

    s, share, error, shapes, numbers, kept = first_rank_gives(system.comm.tompi4py(), solve)
    # a rigid motion has rates on every rank
    motion = prescribed_motion(model) if system.assembly.y.any() else (0.0, 0.0)
    return Modes(s, share, error, shapes, imbalance, ZERO_FRACTION * reference, *motion, numbers, kept)


def _without_free_angle(model: DrillingModel, linearised: Linearised, found: Eigenvalues) -> Eigenvalues:
    """Leave out the zero root of an unrestrained angle: of the whole string under a controlled speed, of a motor's rotor.

    If other roots are zero, such as the root of the drilled length, vectors are mixtures without energy. The one with much more
    spin than displacement is taken.
    """
    small = np.flatnonzero(np.abs(found.s) <= ZERO_FRACTION * reference_rate(model))
    u, names = linearised.vectors(found.subset(small)), [f.name for f in model.system.layout.fields]
    share = _shares(model, linearised, found.s[small], u)
    spin, way = (
        np.abs(u[linearised.field == names.index(f"string.{name}")]).max(axis=0, initial=0.0)
        for name in ("spin", "position")
    )
    turning = small[(share.argmax(axis=1) == KINDS.index("torsional")) | (spin > FREE_SPIN * way)]
    return found if not len(turning) else found.subset(np.arange(len(found.s)) != turning[0])


def _without_free_length(
    field: str, model: DrillingModel, linearised: Linearised, found: Eigenvalues
) -> Eigenvalues:
    """Leave out the root zero of a ``field`` to which nothing returns, such as the pay-out of a drum of given speed."""
    names = [f.name for f in model.system.layout.fields]
    if field not in names:
        return found
    small = np.flatnonzero(np.abs(found.s) <= ZERO_FRACTION * reference_rate(model))
    row = np.flatnonzero(linearised.field == names.index(field))
    u = np.abs(linearised.vectors(found.subset(small)))
    share = (u[row] / np.maximum(u.max(axis=0), 1e-300)).ravel()
    paying = small[share > PAYING]
    return found if not len(paying) else found.subset(np.arange(len(found.s)) != paying[0])


def _of_kind(model: DrillingModel, linearised: Linearised, kind: str):
    """Return a function that selects the eigenvalues of a kind: (m,) mask."""

    def selected(found: Eigenvalues) -> np.ndarray:
        return _shares(model, linearised, found.s, linearised.vectors(found)).argmax(axis=1) == KINDS.index(
            kind
        )

    return selected


def _nearest(found: Eigenvalues, shift: float, count: int) -> Eigenvalues:
    """Select the ``count`` eigenvalues nearest to the frequency ``shift`` [Hz], sorted."""
    near = np.argsort(np.abs(found.s - 2j * np.pi * shift), kind="stable")[:count]
    return found.subset(near[np.lexsort((-found.s.real[near], found.s.imag[near]))])


def _describe(model: DrillingModel, linearised: Linearised, found: Eigenvalues):
    """Return eigenvalues, energy fractions, errors and scaled shapes.

    On the rank that has the linearised system.
    """
    u = linearised.vectors(found)
    fields, nodes = model.system.layout.fields, model.mesh.nodes
    shapes = {f.name: linearised.field_values(i, u, nodes, f.size) for i, f in enumerate(fields)}
    share = _shares(model, linearised, found.s, u)
    factor = np.array([_factor(shapes, m, KINDS[share[m].argmax()]) for m in range(len(found.s))])
    return (
        found.s,
        share,
        found.error,
        {name: values * factor[:, None, None] for name, values in shapes.items()},
    )


def _shares(model: DrillingModel, linearised: Linearised, s: np.ndarray, u: np.ndarray) -> FloatArray:
    """Compute the fractions (m, 4) of the kinds in the energy of each mode (manual: eq-eigen-share).

    The string's energy is (|s|^2 u*Mu + |u*Ku|)/2 of its motion across the tangent, along it and about it.
    The energy of the fluid is c |u|^2/2 summed over pressures and flows, with the storage coefficients c on the
    diagonal of C.

    s: (m,) [1/s]; u: (n, m) vectors of all unknowns.
    """
    names = [f.name for f in model.system.layout.fields]
    parts = np.zeros((len(KINDS), *u.shape), dtype=complex)
    for i, name in enumerate(names):
        unknowns = np.flatnonzero(linearised.field == i)
        if name in ("string.position", "string.tangent"):
            values, t = linearised.field_values(i, u, model.mesh.nodes, 3), model.tangent
            along = np.sum(values * t, axis=2, keepdims=True) * t
            parts[1][unknowns] = along[:, linearised.node[unknowns], linearised.component[unknowns]].T
            parts[0][unknowns] = u[unknowns] - parts[1][unknowns]
        elif name.startswith("string."):
            parts[2 if name == "string.spin" else 1][unknowns] = u[unknowns]
    energy = np.zeros((u.shape[1], len(KINDS)))
    for k in range(3):
        kinetic, strain = (
            np.abs(np.sum(parts[k].conj() * (A @ parts[k]), axis=0)) for A in (linearised.M, linearised.K)
        )
        energy[:, k] = 0.5 * (
            np.maximum(np.abs(s), ZERO_FRACTION * reference_rate(model)) ** 2 * kinetic + strain
        )
    energy[:, 3] = 0.5 * storage(model, linearised) @ np.abs(u) ** 2
    return energy / np.maximum(energy.sum(axis=1, keepdims=True), 1e-300)


def storage(model: DrillingModel, linearised: Linearised) -> FloatArray:
    """Coefficients c (n,) of the energy c |u|^2/2 of pressures and flows; zero for all other unknowns."""
    out, stored = np.zeros(len(linearised.scale)), np.abs(linearised.C.diagonal())
    for i, field in enumerate(model.system.layout.fields):
        if field.physics != DRIVE:
            rows = (linearised.field == i) & ~linearised.second_order
            out[rows] = stored[rows] / ROW_WEIGHT.get(field.name.split(".")[-1], 1.0)
    return out


def _factor(shapes: dict[str, np.ndarray], m: int, kind: str) -> complex:
    """Compute the factor that makes the largest displacement (spin angle, pressure) of mode m real and of unit size."""
    name = {"torsional": "string.spin", "fluid": ""}.get(kind, "string.position")
    size = 1.0
    if not name:
        pressures = [v for k, v in shapes.items() if k.endswith("pressure")]
        values, size = (
            np.concatenate([p[m].ravel() for p in pressures] or [v[m].ravel() for v in shapes.values()]),
            SHAPE_PRESSURE,
        )
    else:
        values = shapes[name][m].ravel()
    largest = values[np.abs(values).argmax()]
    return size / largest if largest else 1.0


# ---------------------------------------------------------------------- command
def run_modes(
    job: Job,
    count: int = 20,
    shift: float | None = None,
    kind: str | None = None,
    about: str = "steady",
    without_control: bool = False,
) -> RunResult:
    """Compute the modes of a case; collective.

    count, kind: as in ``modes``; shift: frequency [Hz]; about: as in ``prepare_state``.
    without_control: leave out motor, hoist and controllers, and hold the top at the prescribed rotation.

    Raises CaseError for wrong arguments, SolveError if no state or mode is found.
    """
    case, comm = job.case, job.comm
    refuse_quaternion(case, "modes")
    if shift is not None and (kind or shift < 0):
        raise CaseError(
            at="--shift", got=shift, want="a frequency in Hz, at least 0, and not together with --kind"
        )
    with options_of(case):
        case = continuous_control(mean_over_turn(case))
        model = build_model(without_motor(case) if without_control else case, comm)
        folder = job.make_folder()
        state = prepare_state(model, about)
        fields = FieldOutput(model).fields(0.0)
        found = modes(model, count, shift, kind)
        searched = (
            f"{count} lowest{' ' + kind if kind else ''}"
            if shift is None
            else f"{count} nearest to {shift:g} Hz"
        )
        if not without_control and any(
            getattr(q, "kind", "") == "python" for q in getattr(case.top, "control", ())
        ):
            left_out = "the controller in Python is left out: its torque stays constant"
            state = replace(state, warnings=[*state.warnings, left_out])
        summary = _summary(model, found, state, searched)
        if comm.rank == 0:
            _write(model, folder, found, fields)
    return job.result(folder, summary, _lines(case, found, summary), {"modes.csv": _rows(found)})


def moment_of(model: DrillingModel, found: Modes) -> Modal:
    """What there is to doubt about modes."""
    return Modal(
        model=model,
        frequency=found.frequency,
        kind=found.kind,
        grows=found.grows,
        kept=found.kept,
        imbalance=found.imbalance,
    )


def missing_growth(model: DrillingModel, found: Modes, state: StaticState) -> bool:
    """Whether the state leaves its equilibrium in a mode that was not computed: fast divergence lies beyond the lowest modes."""
    return bool(state.equilibrium.negative_pivots and model.conservative and not found.unstable)


def _summary(model: DrillingModel, found: Modes, state: StaticState, searched: str) -> dict[str, Any]:
    """Results of all modes together; collective."""
    return {
        "title": model.case.title,
        "searched": searched,
        "about": motion_text(found.lowering, found.rotation, model.case.shown_units),
        "lowering": found.lowering,
        "rotation": found.rotation,
        "modes": found.count,
        "stable": found.unstable == 0 and found.zeros == 0 and not missing_growth(model, found, state),
        "margin": found.margin,
        "unstable": found.unstable,
        "diverging": found.diverging,
        "fluttering": found.fluttering,
        "zero_roots": found.zeros,
        "smallest_eigenvalue": found.smallest,
        "largest_error": float(found.error.max(initial=0.0)),
        "imbalance": found.imbalance,
        "frequency": found.frequency,
        "damping_ratio": found.damping_ratio,
        "growth": found.growth,
        "kind": list(found.kind),
        "negative_pivots": state.equilibrium.negative_pivots,
        "warnings": [*state.warnings, *doubts_at(moment_of(model, found))],
        "time_scales": time_scales(model).lines(),
    }


def _rows(found: Modes) -> list[tuple[Any, ...]]:
    """Rows of modes.csv."""
    stokes = [] if found.stokes_number is None else [found.stokes_number]
    columns = [range(1, found.count + 1), found.frequency, 60 * found.frequency, found.damping_ratio]
    columns += [found.growth, found.kind, *found.share.T, found.error, *stokes]
    return list(zip(*columns, strict=True))


def _write(model: DrillingModel, folder: RunFolder, found: Modes, fields) -> None:
    """Write the shapes; ``fields``: values of the state, None without a string."""
    shapes = folder.path / "modes"
    shapes.mkdir(exist_ok=True)
    for old in shapes.glob("mode_*.vtu"):
        old.unlink()
    if fields is not None:
        points = np.ascontiguousarray(fields[0])
        FieldWriter(folder.path).write(0.0, *fields)
        lines = np.column_stack([np.arange(len(points) - 1), np.arange(1, len(points))])
        for m in range(found.count):
            data = _point_data(model, found, m)
            write = partial(
                write_vtu,
                points=points,
                kind="line",
                cells=lines,
                point_data=data,
                cell_data={},
                compress=False,
            )
            replace_file(shapes / f"mode_{m + 1:02d}.vtu", write)
    write_well_files(model, folder)


def _point_data(model: DrillingModel, found: Modes, m: int) -> dict[str, FloatArray]:
    """Return real and imaginary part of a mode's shape at the nodes.

    The motion is real cos(wt) - imaginary sin(wt), times exp(growth t).
    """
    names = {
        "string.position": ("displacement", "m"),
        "string.spin": ("spin_angle", "rad"),
        "bore.pressure": ("bore_pressure", "Pa"),
        "bore.flow": ("bore_flow", "m3/s"),
        "annulus.pressure": ("annulus_pressure", "Pa"),
        "annulus.flow": ("annulus_flow", "m3/s"),
    }
    data = {"md [m]": np.ascontiguousarray(model.mesh.node_depth)}
    for field, (name, unit) in names.items():
        if field in found.shapes:
            values = found.shapes[field][m]
            values = values[:, 0] if values.shape[1] == 1 else values
            data[f"{name} [{unit}]"] = np.ascontiguousarray(values.real)
            data[f"{name}_imaginary [{unit}]"] = np.ascontiguousarray(values.imag)
    return data


def _lines(case: Case, found: Modes, summary: dict[str, Any]) -> list[str]:
    """Return the lines to show."""
    lines = [
        f"{case.title or 'case'}: modes about {summary['about']}, the {summary['searched']}",
        "  mode   frequency [Hz]        [rpm]   damping ratio   growth [1/s]   kind",
    ]
    for m in range(found.count):
        mark = (
            "  <- grows" if found.grows[m] else "  <- zero" if abs(found.eigenvalue[m]) <= found.zero else ""
        )
        lines.append(
            f"  {m + 1:>4}   {found.frequency[m]:>14.6g} {60 * found.frequency[m]:>12.5g}   {found.damping_ratio[m]:>13.4g}   "
            f"{found.growth[m]:>12.4g}   {found.kind[m]}{mark}"
        )
    stability = (
        "stable"
        if summary["stable"]
        else "the state is unstable, but its growing modes are not among these"
        if not found.unstable and not found.zeros
        else f"{found.diverging} diverging, {found.fluttering} fluttering, {found.zeros} at zero"
    )
    lines.append(
        f"  {stability}; largest growth {found.margin:.4g} 1/s, smallest |s| {found.smallest:.4g} 1/s"
    )
    lines += [f"  {line}" for line in summary["time_scales"]]
    if found.stokes_number is not None:
        known = found.stokes_number[np.isfinite(found.stokes_number)]
        span = f", Stokes numbers {known.min():.3g} to {known.max():.3g}" if len(known) else ""
        lines.append(f"  mud's added mass and damping at each mode's own frequency{span}")
    return lines
