"""A run with the derivatives of its history by numbers of its case, computed in its steps (manual: sec-sensitivities-steps)."""

from __future__ import annotations

import time as clock
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np
from petsc4py import PETSc

from drillpetsc.analysis.motion.integrator_choice import make_integrator
from drillpetsc.analysis.motion.session.live_outputs import LiveOutputs
from drillpetsc.analysis.sensitivities.derivatives import LIMIT, ONE_SIDED
from drillpetsc.analysis.sensitivities.keys import Key
from drillpetsc.analysis.sensitivities.points import Point, points_of, refusal_of
from drillpetsc.analysis.sensitivities.static_tangent import RESIDUAL_STEP, StaticTangent
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.analysis.statics.imperfection import add_imperfection_of_rest
from drillpetsc.analysis.statics.placement import find_reactions, move_rigidly, place_along_hole, release
from drillpetsc.arrays import FloatArray
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.model.drilling_model import DrillingModel, build_model, is_quasi_static
from drillpetsc.model.mesh import MeshOf
from drillpetsc.output.column_series import ColumnSeries, ColumnSeriesOfSystems
from drillpetsc.output.progress import Progress
from drillpetsc.output.recorder import Recorder
from drillpetsc.parallel import total
from drillpetsc.physics.tools.mud_motor import MudMotor
from drillpetsc.solvers.time.derivatives.beside_systems import Beside
from drillpetsc.solvers.time.derivatives.step_tangent import StepTangent
from drillpetsc.solvers.time.generalized_alpha import GeneralizedAlpha
from drillpetsc.solvers.time.time_integrator import TimeIntegrator

#: of the cases beside the run, relative: contacts yield by micrometres, and rates are smooth over so little
STEP = 3e-6
#: what the mean of both sides lacks of the run, over half of their difference; rounding in the fields' scales
JUMPS, NOISE = 0.1, 1e-10
ROUGH = 1e-11  # last increment of the steady flow at the start, in its scales, that a difference over STEP would show
TOLERANCE, NEWTON = "q_snes_stol", 1e-12  # of Newton's method, at most


@dataclass(frozen=True)
class RunSeries:
    """Columns of a history at the ends of all steps.

    times: (m,) [s]; values: (m, columns) [SI]; slopes: (m, columns, keys) derivatives.
    steps: lengths of all steps [s]; seconds: processor time of the steps, with the derivatives [s].
    keys, flags: those that were followed, and the flag of each; skipped: the others, with the reasons.
    events: times at which a law changes, such as of a jar, where columns may jump [s], with their derivatives (keys,).
    """

    times: FloatArray
    values: FloatArray
    slopes: FloatArray
    steps: FloatArray
    seconds: float
    keys: list[Key]
    flags: list[str]
    skipped: dict[str, str]
    events: list[tuple[float, FloatArray]]


@dataclass(frozen=True)
class Neighbours:
    """Models beside the run, whose ``points`` differ in a key.  flag: of the derivatives of the state at the start."""

    points: list[Point]
    models: list[DrillingModel]
    flag: str


def _refuse(case: Case, model: DrillingModel, integrator: TimeIntegrator | None = None) -> None:
    """Raise CaseError for what the derivatives do not follow, in the run or beside it.  integrator: of the run."""
    system, mud = model.system, case.fluid
    has = {
        "a controller that samples": integrator is not None and integrator.sampler is not None,
        "an autodriller": case.top.autodriller is not None,
        "functions of the user": any(c.own_laws for c in system.components) or bool(case.components),
        "constraints of the quaternion element, or of stabilised joints": system.assembly.derive is not None
        or system.assembly.stabilized
        or any(c.has_constraints for c in system.components),
        "a downhole motor": bool(model.parts(MudMotor)),
        "joints and generalised-alpha together (time.integrator: bdf)": system.multipliers > 0
        and isinstance(integrator, GeneralizedAlpha),
        "drilling fluid with formulation: hermite, or with dynamics: quasi_steady": mud is not None
        and (mud.formulation, mud.dynamics) != ("mixed", "full"),
        "a reamer in drilling fluid": model.fluid is not None and model.fluid.rings is not None,
        "a solver or integrator of PETSc in place of its own": integrator is not None
        and not (integrator.condensed and integrator.newton.direct),
    }
    for what, present in has.items():
        if present:
            raise CaseError(at="--analysis", got="run", want=f"a run without: {what}")


def refuse_run(case: Case) -> None:
    """Raise CaseError for a case without a run whose derivatives could be computed."""
    if case.time is None:
        raise CaseError(at="time", want="a block {end: ...}")
    if is_quasi_static(case):
        raise CaseError(at="time.mode", got="quasi_static", want="dynamic for sensitivities of a run")
    if case.initial.from_ not in ("statics", "rest", "straight"):
        raise CaseError(
            at="initial.from", got=str(case.initial.from_), want="statics or rest for sensitivities of a run"
        )


@contextmanager
def converged() -> Iterator[None]:
    """Newton's method converged, whatever the tolerance of the case: the remainder of an iteration has another derivative."""
    database = PETSc.Options()
    given = database.getString(TOLERANCE, "") if database.hasName(TOLERANCE) else ""
    if not given or float(given) > NEWTON:
        database.setValue(TOLERANCE, str(NEWTON))
    try:
        yield
    finally:
        if given:
            database.setValue(TOLERANCE, given)
        else:
            database.delValue(TOLERANCE)


class RunOfCase:
    """The model of a case and the integrator of its run.  Raises CaseError for a run whose derivatives are not computed."""

    def __init__(self, case: Case, comm: PETSc.Comm, like: MeshOf | None = None) -> None:
        refuse_run(case)
        self.case, self.comm = case, comm
        self.model = build_model(case, comm, like=like)
        self.integrator = make_integrator(self.model)
        _refuse(case, self.model, self.integrator)
        self.recorder = Recorder(self.model)
        self.outputs = LiveOutputs(self.recorder)
        self.names = [q.name for q in self.outputs.described()]

    def freeze(self, steps: FloatArray) -> None:
        """Take these ``steps`` [s] instead of those of the step control."""
        self.integrator.freeze(steps)

    @property
    def has_events(self) -> bool:
        """Whether laws may change at states of the run, such as that of a jar: changed cases have them at other times."""
        return any(c.has_events for c in self.model.system.components)

    @property
    def mesh(self) -> MeshOf:
        """The elements, for the cases beside it."""
        return MeshOf(self.case, self.model.mesh)

    def begin(self, keys: Sequence[Key], skips: bool = False) -> tuple[list[Neighbours], dict[str, str]]:
        """Put the model into its state at the start, and models beside it into theirs; collective.

        skips: keys that cannot be followed are left out, with the reasons; else CaseError is raised.
        """
        model, tangent = self.model, None
        # a held string has no state of its own, and the flow is found below
        if self.case.initial.from_ == "statics" and model.beam.moves:
            start = model.top.anchor.copy()
            state = find_equilibrium(model)
            tangent = StaticTangent(model, state, start, None) if keys else None
        else:
            _rest(model)
        found, skipped = [], {}
        for key in keys:
            try:
                found.append(self._neighbours(key, tangent))
            except CaseError as error:
                if not skips:
                    raise refusal_of(key, error) from None
                skipped[key.name] = error.want
        for each in (model, *(m for n in found for m in n.models)):
            _begin_motion(each)
        return [self._with_kinks(n) for n in found], skipped

    def _with_kinks(self, n: Neighbours) -> Neighbours:
        """The models beside the run, flagged if the velocities at the start jump between them, as where a bend of the hole ends; collective."""
        system = self.model.system
        size, bends = system.layout.size, False
        if ONE_SIDED not in n.flag and LIMIT not in n.flag:
            low, high, here = (m.system.assembly.y[:size] for m in (*n.models, self.model))
            lacks, half = np.abs(0.5 * (low + high) - here), 0.5 * np.abs(high - low)
            bends = bool((lacks > JUMPS * half + NOISE * system.scale).any())
        if not total(self.comm, float(bends)):
            return n
        return replace(n, flag=", ".join(filter(None, [n.flag, ONE_SIDED])))

    def _neighbours(self, key: Key, tangent: StaticTangent | None) -> Neighbours:
        """Models beside the run; with a ``tangent`` of the static state, else at rest.  Raises CaseError for a key that cannot be followed."""
        mesh, bends = self.mesh, False
        points, limited = points_of(self.case, key, STEP)

        def build(case: Case) -> DrillingModel:
            model = build_model(case, self.comm, like=mesh)
            _refuse(case, model)
            if _unknowns(model) != _unknowns(self.model):
                raise CaseError(
                    at="--to", got=key.name, want="a number that neither adds nor removes an element"
                )
            if model.breaks != self.model.breaks:
                want = "a number that does not move a time at which an input jumps or bends"
                raise CaseError(at="--to", got=key.name, want=want)
            return model

        if tangent is None:
            models = [build(point.case) for point in points]
            for model in models:
                _rest(model)
        else:
            sources, _ = points_of(self.case, key, RESIDUAL_STEP)
            models, bends = tangent.near(points, sources, build)
        flags = [word for word, holds in ((ONE_SIDED, bends), (LIMIT, limited)) if holds]
        return Neighbours(points, models, ", ".join(flags))

    def series(
        self, keys: Sequence[Key], columns: Sequence[str], skips: bool = False, end: float | None = None
    ) -> RunSeries:
        """Run with the derivatives of columns of the history by keys; collective.

        skips: as of ``begin``; end: of the run [s], None: the case's.
        """
        return _Run(self, keys, columns, skips).series(
            float(self.case.given_time.end) if end is None else end
        )


def _unknowns(model: DrillingModel) -> tuple[object, ...]:
    """What must be equal for the unknowns to correspond, the same on all ranks."""
    return model.mesh.nodes, *((f.name, f.size) for f in model.system.layout.fields)


def _begin_motion(model: DrillingModel) -> None:
    """Change from statics to motion; collective.  Raises CaseError if the flow at the start is too rough to be differenced."""
    release(model)
    for component in model.components:
        component.forget_hole()  # statics has evaluated it at places on its way
    if move_rigidly(model).increment > ROUGH:
        want = "a steady flow at the start that Newton's method finds to rounding: a larger fluid.rheology.shear_rate smooths a yield stress"
        raise CaseError(at="--analysis", got="run", want=want)
    for component in model.components:
        component.settle(0.0, model.system.assembly)
    find_reactions(model)


def _rest(model: DrillingModel) -> None:
    place_along_hole(model)
    add_imperfection_of_rest(model)


class _Run:
    """A run that records columns and their derivatives."""

    def __init__(self, run: RunOfCase, keys: Sequence[Key], columns: Sequence[str], skips: bool) -> None:
        self.run, self.integrator = run, run.integrator
        found, self.skipped = run.begin(keys, skips)
        self.keys, self.flags = [n.points[0].key for n in found], [n.flag for n in found]
        self.beside = [
            [Beside(m.system, p.change, p.weight) for m, p in zip(n.models, n.points, strict=True)]
            for n in found
        ]
        self.tangent = StepTangent(self.integrator, self.beside) if found else None
        recorders = [run.recorder, *(Recorder(m) for n in found for m in n.models)]
        self.readers = ColumnSeriesOfSystems(
            [ColumnSeries(r, LiveOutputs(r).find(columns)) for r in recorders]
        )
        self.times: list[float] = []
        self.steps: list[float] = []
        self.bar = Progress(0.0, mode="silent")
        self.integrator.after_step.append(self._after_step)

    def _after_step(self, t: float, dt: float) -> None:
        """Read the columns at the state of a step to ``t`` [s]: of each step, so that no output depends on the rows of the history."""
        self.steps.append(dt)
        self.times.append(t)
        self.bar.update(t, len(self.steps), dt)
        if self.tangent is not None:
            self.tangent.balance()
        first = not self.readers.is_read
        self.readers.add(self.integrator.newton.t)
        if first and self.tangent is not None:
            self.tangent.read_only(self.readers.unknowns_read)

    def series(self, end: float) -> RunSeries:
        """Integrate to the ``end`` [s]; collective."""
        began = clock.process_time()
        label = f"run with derivatives by {len(self.keys)} keys" if self.keys else "run"
        self.bar = Progress(end, mode="silent" if self.run.comm.rank else "auto", label=label)
        self.integrator.run(0.0, end, self.run.model.breaks)
        self.bar.clear()
        base, *beside = self.readers.rows()
        slopes, rows = np.zeros((*base.shape, len(self.keys))), iter(beside)
        for k, group in enumerate(self.beside):
            for one in group:
                slopes[:, :, k] += one.weight * next(rows)
        times = np.array(self.times)
        for k, lost in self.tangent.lost.items() if self.tangent is not None else ():
            slopes[times >= lost, :, k] = np.nan
        spent = clock.process_time() - began
        return RunSeries(
            times,
            base,
            slopes,
            np.array(self.steps),
            spent,
            self.keys,
            self.flags,
            self.skipped,
            [] if self.tangent is None else self.tangent.events,
        )
