"""The `modes` command: natural frequencies, damping and stability of a scene about its static or steadily
turning state.

    scene = build_model(case)
    settle(scene)                  # equilibrium, then the steady motion that the top prescribes
    found = modes(scene, count=20)

What is linearised is the scene as it stands: contacts that are closed are springs, open ones are not there;
friction has the slope it has at the present sliding speed.  About rest its regularised law is a stiff damper
at closed contacts (mu N over slip_velocity), which holds the string there but for a slow creep: real roots
near zero.  About a turning state the directions of the pipe's section are frozen, which is exact for a string
that is round (gyroscopic terms, damping that turns with the pipe) and a snapshot for one that is bent or
eccentric.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from petsc4py import PETSc

from drillpetsc.analysis.equilibrium import StaticState
from drillpetsc.analysis.initial_state import find_equilibrium
from drillpetsc.analysis.placement import move_rigidly, prescribed_motion, release
from drillpetsc.analysis.steady_flow import release_flow
from drillpetsc.analysis.time_scales import time_scales
from drillpetsc.analysis.transient import RunResult, make_folder
from drillpetsc.case.case import Case
from drillpetsc.case.checks.limits import refuse_quaternion
from drillpetsc.errors import CaseError, DrillError
from drillpetsc.fem.component import FloatArray
from drillpetsc.model.drilling_model import DrillingModel, build_model
from drillpetsc.output import FieldWriter, RunFolder, write_summary, write_table
from drillpetsc.output.field_output import FieldOutput
from drillpetsc.output.files.atomic import replace_file
from drillpetsc.output.files.fields import _write_vtu
from drillpetsc.output.quantities import MODE_KINDS as KINDS
from drillpetsc.output.quantities import MODES
from drillpetsc.output.well_files import write_well_files
from drillpetsc.solvers import petsc_options as options
from drillpetsc.solvers.linearization import Linearised, linearise
from drillpetsc.solvers.quadratic_eigenproblem import (
    NEUTRAL,
    Eigenvalues,
    eigenvalues_near,
    lowest_eigenvalues,
)

STATES = ("steady", "rest")
ZERO = 1e-3  # roots below this share of the reference rate are zero: what nothing holds
ROW_WEIGHT = {
    "pressure": 1e6,
    "flow": 1e-2,
}  # of the fluid's rows [per m3/s] and [per Pa] (kernels/fluid/flow.hpp)
UNBALANCED = 1.0  # force that is worth a note [N]
PRESSURE = 1e5  # largest pressure in the shape of a mode of the fluid [Pa]


@dataclass(frozen=True)
class Modes:
    """Modes exp(s t), s = growth + i 2 pi frequency, sorted by frequency; real roots (frequency 0) first, of
    them the fastest growing.

    frequency (m,) [Hz]; growth (m,) [1/s]; damping_ratio (m,) -growth/|s| (nan at zero); share (m, 4): of the
    mode's energy in the columns of ``KINDS``; kind: the largest; error (m,): backward error of the root;
    shapes: {field: (m, nodes, size)} complex, the largest displacement 1 m, or spin angle 1 rad, or pressure
    1 bar, and real.  imbalance [N]: largest force on a node that the state leaves over. zero [1/s]: what
    counts as a root zero; lowering [m/s] and rotation [rad/s] of the state.
    """

    eigenvalue: np.ndarray
    frequency: FloatArray
    growth: FloatArray
    damping_ratio: FloatArray
    kind: tuple[str, ...]
    share: FloatArray
    error: FloatArray
    shapes: dict[str, np.ndarray]
    imbalance: float
    zero: float
    lowering: float
    rotation: float

    @property
    def count(self) -> int:
        return len(self.eigenvalue)

    @property
    def margin(self) -> float:
        """Largest growth [1/s]: negative where every mode found dies out."""
        return float(self.growth.max(initial=-np.inf))

    @property
    def _grows(self) -> np.ndarray:
        size = np.abs(self.eigenvalue)
        return (self.growth > NEUTRAL * size) & (size > self.zero)

    @property
    def diverging(self) -> int:
        """Modes that grow without oscillation."""
        return int((self._grows & (self.frequency == 0)).sum())

    @property
    def fluttering(self) -> int:
        """Modes that grow as they oscillate."""
        return int((self._grows & (self.frequency > 0)).sum())

    @property
    def unstable(self) -> int:
        return self.diverging + self.fluttering

    @property
    def zeros(self) -> int:
        """Eigenvalues that are zero: motions that nothing holds, or a load at which the string just
        buckles."""
        return int((np.abs(self.eigenvalue) <= self.zero).sum())

    @property
    def smallest(self) -> float:
        """Smallest |s| [rad/s]."""
        return float(np.abs(self.eigenvalue).min(initial=np.inf))


# ---------------------------------------------------------------------- state
def settle(model: DrillingModel, about: str = "steady") -> StaticState:
    """Bring the scene to the state to linearise about; collective.

    steady: as a run starts, in equilibrium under friction against the motion that the top prescribes at time
    0, and in that motion.
    rest: in equilibrium without friction, at rest.
    """
    if about == "steady" and prescribed_motion(model) != (0.0, 0.0):
        state = find_equilibrium(model)
        release(model)
        move_rigidly(model)
        return state
    state = find_equilibrium(model, (0.0, 0.0))
    release(model)
    model.system.assembly.y[:] = 0.0
    release_flow(model)
    return state


def reference_rate(model: DrillingModel) -> float:
    """A slow rate of the scene [1/s]: lowest bending of the whole string between hinges and its swing as a
    pendulum; the passage of sound along it where the string is held."""
    mesh, length = model.mesh, model.mesh.total_length
    if model.beam is None and model.fluid is not None:
        fluid = model.fluid.constants
        return float(np.sqrt(fluid.bulk_modulus / fluid.density) / length)
    mass = float(mesh.mass @ mesh.length + sum(b.mass for b in mesh.bodies)) / length
    bending = np.pi**4 * float(mesh.bending_stiffness.min()) / (length**4 * mass)
    return float(np.sqrt(bending + np.linalg.norm(model.case.gravity) / length))


def _imbalance(model: DrillingModel) -> float:
    """Largest force on an unknown position that the rows leave over [N]; 0 without a string."""
    system = model.system
    rows = system.new_condensed()
    system.sum_residual(0.0, rows)
    on_rank = system.layout.local_of_owned
    position = np.array([f.name == "string.position" for f in system.layout.fields])[
        system.layout.field_of[on_rank]
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
    """Modes of the scene about the state it is in (see ``settle``), the same on all ranks; collective.

    Without a shift: the ``count`` lowest oscillating ones, all growing ones found beside them, and a few of
    the slowest that do not oscillate.  kind: of one of ``KINDS`` alone, so that stability is known for that
    kind only.  shift [Hz]: the ``count`` nearest to that frequency.  engine: as in
    solve.pencil.eigenvalues_near.
    """
    system, reference = model.system, reference_rate(model)
    imbalance, linearised = _imbalance(model), linearise(system)
    answer: Any = None
    if linearised is not None:
        try:
            pencil = linearised.pencil(reference)
            if shift is None:
                roots = lowest_eigenvalues(
                    pencil, count, engine, _of_kind(model, linearised, kind) if kind else None
                )
            else:
                roots = _nearest(
                    eigenvalues_near(pencil, 2j * np.pi * shift, 2 * count, engine), shift, count
                )
            answer = _describe(model, linearised, roots)
        except DrillError as failure:
            answer = failure
    if system.comm.size > 1:
        answer = system.comm.tompi4py().bcast(answer)
    if isinstance(answer, DrillError):
        raise answer
    s, share, error, shapes = answer
    size = np.abs(s)
    ratio = np.divide(-s.real, size, out=np.full(len(s), np.nan), where=size > 0)
    kinds = tuple(KINDS[i] for i in share.argmax(axis=1))
    motion = (
        prescribed_motion(model) if system.assembly.y.any() else (0.0, 0.0)
    )  # a rigid motion: seen by every rank
    return Modes(
        s,
        s.imag / (2 * np.pi),
        s.real,
        ratio,
        kinds,
        share,
        error,
        shapes,
        imbalance,
        ZERO * reference,
        *motion,
    )


def _of_kind(model: DrillingModel, linearised: Linearised, kind: str):
    """Function that says which roots are of a kind."""

    def wanted(roots: Eigenvalues) -> np.ndarray:
        return _shares(model, linearised, roots.s, linearised.T @ roots.u).argmax(axis=1) == KINDS.index(kind)

    return wanted


def _nearest(roots: Eigenvalues, shift: float, count: int) -> Eigenvalues:
    near = np.argsort(np.abs(roots.s - 2j * np.pi * shift), kind="stable")[:count]
    return roots.chosen(near[np.lexsort((-roots.s.real[near], roots.s.imag[near]))])


def _describe(model: DrillingModel, linearised: Linearised, roots: Eigenvalues):
    """Eigenvalues, energy shares, errors and shapes, on the rank that has the system."""
    u = linearised.T @ roots.u
    fields, nodes = model.system.layout.fields, model.mesh.nodes
    shapes = {f.name: linearised.of_field(i, u, nodes, f.size) for i, f in enumerate(fields)}
    share = _shares(model, linearised, roots.s, u)
    factor = np.array([_factor(shapes, m, KINDS[share[m].argmax()]) for m in range(len(roots.s))])
    return (
        roots.s,
        share,
        roots.error,
        {name: values * factor[:, None, None] for name, values in shapes.items()},
    )


def _shares(model: DrillingModel, linearised: Linearised, s: np.ndarray, u: np.ndarray) -> FloatArray:
    """(m, 4) share of the kinds in the energy of each mode: (|s|^2 u*Mu + |u*Ku|)/2 of the string's motion
    across and along its tangent and about it, c |u|^2/2 summed over the fluid's pressures and flows (c: what
    they store, from the diagonal of C)."""
    names = [f.name for f in model.system.layout.fields]
    parts = np.zeros((len(KINDS), *u.shape), dtype=complex)
    for i, name in enumerate(names):
        on_rank = np.flatnonzero(linearised.field == i)
        if name in ("string.position", "string.tangent"):
            values, t = linearised.of_field(i, u, model.mesh.nodes, 3), model.tangent
            along = np.sum(values * t, axis=2, keepdims=True) * t
            parts[1][on_rank] = along[:, linearised.node[on_rank], linearised.component[on_rank]].T
            parts[0][on_rank] = u[on_rank] - parts[1][on_rank]
        elif name.startswith("string."):
            parts[2 if name == "string.spin" else 1][on_rank] = u[on_rank]
    energy = np.zeros((u.shape[1], len(KINDS)))
    for k in range(3):
        kinetic, strain = (
            np.abs(np.sum(parts[k].conj() * (A @ parts[k]), axis=0)) for A in (linearised.M, linearised.K)
        )
        energy[:, k] = 0.5 * (np.maximum(np.abs(s), ZERO * reference_rate(model)) ** 2 * kinetic + strain)
    stored = np.abs(linearised.C.diagonal())
    for i, name in enumerate(names):
        on_rank = np.flatnonzero((linearised.field == i) & ~linearised.second)
        energy[:, 3] += (
            0.5 * (stored[on_rank] / ROW_WEIGHT.get(name.split(".")[-1], 1.0)) @ np.abs(u[on_rank]) ** 2
        )
    return energy / np.maximum(energy.sum(axis=1, keepdims=True), 1e-300)


def _factor(shapes: dict[str, np.ndarray], m: int, kind: str) -> complex:
    """What makes the largest displacement (spin angle, pressure) of mode m one, and real."""
    name = {"torsional": "string.spin", "fluid": ""}.get(kind, "string.position")
    size = 1.0
    if not name:
        pressures = [v for k, v in shapes.items() if k.endswith("pressure")]
        values, size = (
            np.concatenate([p[m].ravel() for p in pressures] or [v[m].ravel() for v in shapes.values()]),
            PRESSURE,
        )
    else:
        values = shapes[name][m].ravel()
    largest = values[np.abs(values).argmax()]
    return size / largest if largest else 1.0


# ---------------------------------------------------------------------- command
def run_modes(
    case: Case,
    out: str | Path | None = None,
    count: int = 20,
    shift: float | None = None,
    kind: str | None = None,
    about: str = "steady",
    overwrite: bool = False,
    name: str = "case",
    comm: PETSc.Comm | None = None,
) -> RunResult:
    """Find the modes of a case, write modes.csv, modes/mode_NN.vtu, string.pvd and summary.json (collective)."""
    refuse_quaternion(case, "modes")
    comm = comm or PETSc.COMM_WORLD
    if count < 1:
        raise CaseError(at="--count", got=count, want="a number of modes, at least 1")
    if shift is not None and (kind or shift < 0):
        raise CaseError(
            at="--shift", got=shift, want="a frequency in Hz, at least 0, and not together with --kind"
        )
    with options.applied(case.petsc):
        model = build_model(case, comm)
        folder = make_folder(comm, name, out, False, overwrite)
        state = settle(model, about)
        fields = FieldOutput(model).fields(0.0)
        found = modes(model, count, shift, kind)
        searched = (
            f"{count} lowest{' ' + kind if kind else ''}"
            if shift is None
            else f"{count} nearest to {shift:g} Hz"
        )
        summary = {
            "title": case.title,
            "searched": searched,
            **mode_summary(found, state),
            "time_scales": time_scales(model).lines(),
        }
        if comm.rank == 0:
            _write(model, folder, found, summary, fields)
    return RunResult(folder.path, summary, _lines(case, folder, found, summary))


def mode_summary(found: Modes, state: StaticState) -> dict[str, Any]:
    """Figures of all modes together."""
    moves = [f"rotation at {found.rotation:g} rad/s"] if found.rotation else []
    moves += [f"lowering at {found.lowering:g} m/s"] if found.lowering else []
    return {
        "about": " and ".join(moves) or "rest",
        "lowering": found.lowering,
        "rotation": found.rotation,
        "modes": found.count,
        "stable": found.unstable == 0 and found.zeros == 0,
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
        "warnings": list(state.warnings),
    }


def _write(model: DrillingModel, folder: RunFolder, found: Modes, summary: dict[str, Any], fields) -> None:
    model.case.dump(folder.case)
    numbers = np.arange(1, found.count + 1)
    write_table(
        folder.path / "modes.csv",
        [q.column for q in MODES],
        [
            numbers,
            found.frequency,
            60 * found.frequency,
            found.damping_ratio,
            found.growth,
            np.array(found.kind),
            *found.share.T,
            found.error,
        ],
    )
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
            replace_file(shapes / f"mode_{m + 1:02d}.vtu", partial(_write_shape, points, lines, data))
    if model.well is not None:
        write_well_files(model, folder)
    write_summary(folder.summary, summary)


def _write_shape(points: FloatArray, lines: np.ndarray, data: dict[str, FloatArray], file: Path) -> None:
    _write_vtu(file, points, "line", lines, data, {}, False)


def _point_data(model: DrillingModel, found: Modes, m: int) -> dict[str, FloatArray]:
    """Real and imaginary part of a mode's shape: the motion is real cos(wt) - imaginary sin(wt), growing with
    the mode."""
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


def _lines(case: Case, folder: RunFolder, found: Modes, summary: dict[str, Any]) -> list[str]:
    lines = [
        f"{case.title or 'case'}: modes about {summary['about']}, the {summary['searched']}",
        "  mode   frequency [Hz]        [rpm]   damping ratio   growth [1/s]   kind",
    ]
    for m in range(found.count):
        mark = (
            "  <- grows" if found._grows[m] else "  <- zero" if abs(found.eigenvalue[m]) <= found.zero else ""
        )
        lines.append(
            f"  {m + 1:>4}   {found.frequency[m]:>14.6g} {60 * found.frequency[m]:>12.5g}   {found.damping_ratio[m]:>13.4g}   "
            f"{found.growth[m]:>12.4g}   {found.kind[m]}{mark}"
        )
    words = (
        "stable"
        if summary["stable"]
        else f"{found.diverging} diverging, {found.fluttering} fluttering, {found.zeros} at zero"
    )
    lines.append(f"  {words}; largest growth {found.margin:.4g} 1/s, smallest |s| {found.smallest:.4g} rad/s")
    if found.imbalance > UNBALANCED:
        lines.append(
            f"  note: forces up to {found.imbalance:.3g} N are left over: this motion is steady but for them"
        )
    lines += [f"  {words}" for words in summary["time_scales"]]
    lines += [f"  note: {w}" for w in summary["warnings"]]
    lines.append(f"  results: {folder.path}")
    return lines
