"""Time integration: PETSc's TS around the condensed Newton method, or around the assembled first-order system.

Manual: sec-time-condensed, sec-time-call, sec-time-error, sec-time-jumps.  PETSc options select the
first-order system.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, ClassVar, Protocol

import numpy as np
from petsc4py import PETSc

from drillpetsc import petsc_compat
from drillpetsc.arrays import FloatArray
from drillpetsc.errors import SolveError
from drillpetsc.fem.component import Component, Field
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.kernels.denormals import flushed_denormals
from drillpetsc.parallel import total
from drillpetsc.solvers.petsc_options import refused_by_petsc
from drillpetsc.solvers.time.bdf_history import BdfHistory, local, nodal
from drillpetsc.solvers.time.first_order_system import FirstOrderSystem, refuse_integrator
from drillpetsc.solvers.time.local_error import BdfOutputErrors, OutputErrors
from drillpetsc.solvers.time.newton import CondensedNewton
from drillpetsc.solvers.time.newton_work import SHARE, ResidualWork

MASKED = 1.0e20  # tolerance of a row without error control
DEFAULTS = {
    "ts_type": "bdf",
    # from order 3 on weakly damped vibrations are unstable (manual: sec-time-error)
    "ts_bdf_order": 2,
    "ts_adapt_type": "basic",
    "ts_adapt_clip": "0.2,2.0",
    # a step ends on each jump of an input (manual: sec-time-jumps)
    "ts_exact_final_time": "matchstep",
    "ts_max_snes_failures": -1,  # this module counts consecutive failures; PETSc counts all failures of the run
    "ts_error_if_step_fails": 0,  # this module raises an error with place and cure
}
TOLERANCE = 1.0e-4  # default of -ts_rtol
CURE = "check the inputs at this time and place; a smaller -ts_rtol, softer contact or -q_snes_linesearch_type bt may help"
CONSECUTIVE_FAILURES = 25
#: factor of Newton's tolerance with multipliers, whose constraint errors are a misfit of the parts
CONSTRAINT_TOLERANCE_FACTOR = 1.0e-3
END_TOLERANCE = 1.0e-11  # a run has ended within this fraction of the time
REFRAME_INTERVAL = 4  # steps between two checks of the reference directions
EVENT_STEP = 1.0e-6  # longest step over an event, by which it is located in time [s]
SHORTEST_STEP = 1.0e-11  # a step of this length that fails would fail at any length [s]


@dataclass
class Counters:
    """Numbers of accepted and of rejected steps."""

    steps: int = 0
    rejected: int = 0


class Follower(Protocol):
    """Follows the states of a run in its steps, such as their derivatives (``step_tangent``)."""

    def change_states(self, t: float, changed: bool) -> None:
        """Components were called where an input jumps or bends, at ``t`` [s]; changed: states have."""

    def start(self, t: float, jumped: bool) -> None:
        """The formula has started at ``t`` [s]; jumped: a prescribed velocity jumps there."""

    def stage(self, t: float, step: float) -> None:
        """A stage of the first ``step`` [s] after a start is solved, at ``t`` [s]."""

    def change_law(self, t: float, component: Component, numbers: FloatArray) -> None:
        """Let ``component`` change its law at ``t`` [s] with its ``event_numbers``; the formula starts again."""

    def step(self, t: float) -> None:
        """A step to ``t`` [s] is solved and accepted; what components carry from step to step is still that of its solution."""


class Sampler(Protocol):
    """A function called at regular times of a run."""

    period: float

    def __call__(self, t: float) -> None: ...


@dataclass
class TimeIntegrator:
    """Time integrator of a discrete system, from the state in its assembly.

    system: the discrete system.
    after_step(t, dt): called after every accepted step, with x, y, a of the assembly at ``t`` [s].
    at_jump(t): called when the rate of a prescribed motion jumps, before the step that follows.
    on_failure(): called on all ranks before the error that ends a run.
    cure: hint of that error.
    before_event(t), after_event(t): called when a component changes its law, with the state at ``t`` [s].
    before_solve(t): called before the solve of a step that ends at ``t`` [s].
    on_step_end(t): called last after a step; here ``get_state`` and ``stop`` may be called.
    first_step: length of the first step [s].
    controlled(field): whether a field takes part in the error control.
    defaults: further PETSc options, below those of the user.
    after_sample(t): called after a sampler, if the formula assumes that its forces jump at ``t`` [s].
    sampler(t): called at the multiples of ``sampler.period`` [s], where a step ends, with the state before the step that follows;
    the formula does not restart there.
    follower: of the states in all steps.
    step_limit(wanted): the next step [s], not above the ``wanted`` one, the same on all ranks; generalised-alpha only.
    inertia: whether the string has inertia; without it, forces have no power to which Newton's remainder could
    be compared.

    ``max_steps`` is the option -ts_max_steps, for the caller.
    ``is_bdf`` is true for backward differentiation formulas, of the order ``order``.
    ``user_options`` are the PETSc options that the user gave, ``options`` the options in effect.
    ``jumped`` is true in after_step for the steps whose time formula reaches over a jump (manual:
    sec-time-jumps). ``fresh`` is true for the first step after a restart of the formula.
    """

    system: DiscreteSystem
    after_step: list[Callable[[float, float], None]] = field(default_factory=list)
    at_jump: list[Callable[[float], None]] = field(default_factory=list)
    before_event: list[Callable[[float], None]] = field(default_factory=list)
    on_failure: list[Callable[[], None]] = field(default_factory=list)
    cure: str = CURE
    after_event: list[Callable[[float], None]] = field(default_factory=list)
    after_sample: list[Callable[[float], None]] = field(default_factory=list)
    before_solve: list[Callable[[float], None]] = field(default_factory=list)
    on_step_end: list[Callable[[float], None]] = field(default_factory=list)
    first_step: float = 1.0e-4
    controlled: Callable[[Field], bool] = field(default=lambda field: True)
    defaults: dict[str, Any] = field(default_factory=dict)
    sampler: Sampler | None = None
    inertia: bool = True
    step_limit: Callable[[float], float] | None = None
    follower: Follower | None = None

    own_defaults: ClassVar[dict[str, Any]] = DEFAULTS
    condensed_kinds: ClassVar[tuple[str, ...]] = ("bdf",)

    def __post_init__(self) -> None:
        options, system = PETSc.Options(), self.system
        petsc_compat.rename_time_step(options)
        self.user_options = dict(options.getAll())
        given, rejections = set(self.user_options), petsc_compat.max_rejections_option()
        for key, value in {**self.own_defaults, rejections: 60, **self.defaults}.items():
            if key not in given:
                options.setValue(key, value)
        self.first_step = options.getReal(petsc_compat.time_step_option(), self.first_step)
        adaption, kind = options.getString("ts_adapt_type", "basic"), options.getString("ts_type", "bdf")
        self._fixed, self.tolerance = adaption == "none", options.getReal("ts_rtol", TOLERANCE)
        self.is_bdf, python = kind == "bdf", options.getString("snes_type", "python") == "python"
        self.condensed = kind in self.condensed_kinds and python
        self._refuse(options)
        # _steps_over_jump: number of coming steps whose formula reaches over a jump
        self.counters, self.last_step, self.fresh, self.stopped = Counters(), 0.0, True, False
        self._consecutive_failures, self._steps_over_jump, self._step_number = 0, 0, 0
        self.max_steps = options.getInt("ts_max_steps", 2**31 - 1)  # the caller of ``run`` ends it
        self.order = options.getInt("ts_bdf_order", 2)
        self._last, self._t, self._jump, self._stop = 0.0, 0.0, np.inf, np.inf
        # _requested_step: requested length of the last solved step [s]
        self._mud_masked, self._requested_step, self._next_step = False, 0.0, 0.0
        self._frozen: list[float] | None = None
        self._restored: dict[str, FloatArray] | None = None
        self._accelerations: FloatArray | None = None  # of a checkpoint, by node
        # formulas whose history can be rebuilt; the others restart at every checkpoint, also in uninterrupted
        # runs
        self.keeps_history = self.condensed and adaption in ("basic", "none")
        self.history = BdfHistory(self.order + 1)
        self._eventful = [c for c in system.components if c.has_events]
        self.work: ResidualWork | None = None  # limit of the work that Newton's residual leaves
        self.estimate: Any = None  # of the local errors: has get_state and set_state
        self.state = system.new_state()
        if self.condensed:
            factor = CONSTRAINT_TOLERANCE_FACTOR if system.multipliers else 1.0
            if self.inertia:
                share = options.getReal("drillpetsc_newton_work", SHARE)
                self.work = ResidualWork(system, share) if share > 0 else None
            self.newton = CondensedNewton(system, tolerance=0.02 * self.tolerance * factor, work=self.work)
            # these components restore their constraints within the solve: PETSc restarts the formula where a
            # solution changes after the step
            self._restoring = [c for c in system.components if c.restores_constraints]
        self._make(options)
        self.options = dict(options.getAll())  # in effect, defaults included
        for key in set(self.options) - given:  # the next integrator in this process has other defaults
            options.delValue(key)

    def _refuse(self, options: PETSc.Options) -> None:
        """Raise OptionError for options that this integrator cannot follow."""
        refuse_integrator(options.getString("ts_type", "bdf"), self.system.constrained)

    def _make(self, options: PETSc.Options) -> None:
        """Create the TS with its callbacks."""
        system = self.system
        self.ts = PETSc.TS().create(comm=system.comm)
        self.ts.setProblemType(PETSc.TS.ProblemType.NONLINEAR)
        self._f = system.new_state()
        if self.condensed:
            if not options.hasName("snes_type"):
                options.setValue("snes_type", "python")
            matrix = PETSc.Mat().createPython(
                (self.state.getSizes(), self.state.getSizes()), context=self, comm=system.comm
            )
            matrix.setUp()
            self.ts.setIFunction(self._catch_rate, self._f)
            self.ts.setIJacobian(self._catch_shift, matrix)
            self._matrix = matrix
            snes = self.ts.getSNES()
            snes.setType("python")
            snes.setPythonContext(self)
        else:
            self.first_order = FirstOrderSystem(system)
            self.first_order.default_solver(options)
            rows, matrix = (
                petsc_compat.callback(lambda ts, t, *rest, call=call: call(ts, self.input_time(t), *rest))
                for call in (self.first_order.function, self.first_order.jacobian)
            )
            self.ts.setIFunction(rows, self._f)
            self.ts.setIJacobian(matrix, self.first_order.matrix)
            # without this PETSc assumes a unit mass matrix, and arkimex gives wrong results without an error
            kinds = PETSc.TS.EquationType
            constrained = kinds.DAE_IMPLICIT_INDEXHI if system.constrained else kinds.DAE_IMPLICIT_INDEX1
            self.ts.setEquationType(
                constrained if system.assembly.row_replacements or system.constrained else kinds.IMPLICIT
            )
        with refused_by_petsc():
            self.ts.setFromOptions()
        self._zero = system.new_state()
        self._set_tolerances(False)
        self.ts.setPostStep(self._post_step)
        self.ts.setMaxSteps(2**31 - 1)

    def _set_tolerances(self, jumped: bool) -> None:
        """Set the tolerances of the error control; after a jump without tolerances for the mud.

        Manual: sec-time-jumps.

        If a prescribed motion jumps, the flow relative to the pipe jumps as well, and its error control
        would reject every step length.
        """
        self._mud_masked = jumped
        # no relative tolerance: a share of 2000 m of depth, or of many turns, is of no use (manual: sec-time-error)
        self.ts.setTolerances(rtol=self._zero, atol=self.tolerance_vector(fluid=not jumped))

    def tolerance_vector(self, fluid: bool = True) -> PETSc.Vec:
        """Return the absolute tolerance of each row of the state (manual: eq-time-tolerance).

        It is -ts_rtol times the field's scale.  Rates and algebraic rows are masked; without ``fluid`` also
        the mud.
        """
        layout, vector = self.system.layout, self.system.new_state()
        values = vector.getArray()
        values[:] = MASKED
        if self._frozen is None:
            scale = self.tolerance * self.system.scale[layout.local_of_owned]
            values[layout.x_owned] = np.where(self._is_controlled(fluid), scale, MASKED)
        vector.assemble()
        return vector

    def _is_controlled(self, fluid: bool) -> np.ndarray:
        """Whether each owned unknown has error control; fluid: also those of the mud."""
        # errors of rates and multipliers follow from the other unknowns; under control, multipliers would reject every step
        # (manual: sec-time-error)
        layout = self.system.layout
        controlled = [
            f.differential and self.controlled(f) and (fluid or f.physics == "string") for f in layout.fields
        ]
        return np.array(controlled)[layout.field_of[layout.local_of_owned]]

    @property
    def next_step(self) -> float:
        """Length of the step that follows an accepted one [s], if it is neither rejected nor shortened; for use in ``after_step``."""
        return self.ts.getTimeStep()

    def input_time(self, t: float) -> float:
        """Return the time [s] at which inputs are evaluated for a step to ``t`` [s].

        A step that ends at a jump of an input uses the value before the jump (manual: sec-time-jumps).
        """
        return t if t < self._jump else float(np.nextafter(self._jump, -np.inf))

    # ------------------------------------------------------------------ condensed step, called by the outer SNES
    def _catch_rate(self, ts, t, x, xdot, f) -> None:
        self._t, self._stage = self.input_time(t), t
        self._rate = xdot  # TSBDF keeps it for the next call

    def _catch_shift(self, ts, t, x, xdot, shift, J, P) -> None:
        self._shift = shift

    @petsc_compat.callback
    def solve(self, snes, b, x) -> None:
        """Solve a step for the outer python SNES, whose unknown is the whole state (manual: sec-time-call).

        The condensed Newton method computes the unknowns; the rates follow from them.
        Raises SolveError after too many consecutive failures.
        """
        if self.history.replayed:  # a restarted run steps through its history
            self.history.return_state(self.system, snes, x)
            return
        # PETSc's time formula gives rate and shift only to these callbacks (see _catch_rate and _catch_shift)
        snes.computeFunction(x, self._f)
        snes.computeJacobian(x, self._matrix)
        self.system.load_step(x, self._rate, self._shift)
        for call in self.before_solve:
            call(self._t)
        reason = self.newton.solve(self._t, self._shift)
        for component in self._restoring:
            component.restore_constraints(self.system.assembly)
        self.system.store_state(x)
        snes.setIterationNumber(self.newton.last_iterations)
        snes.setConvergedReason(reason)
        self._requested_step = self.ts.getTimeStep()
        if reason > 0 and self._eventful and self.ts.getTimeStep() > EVENT_STEP and self._events():
            # shorter steps lead up to the event
            snes.setConvergedReason(PETSc.SNES.ConvergedReason.DIVERGED_FUNCTION_DOMAIN)
            self._consecutive_failures = 0
            return
        if reason > 0:
            self.history.add_stage(self.system.assembly.x, self.system.assembly.y)
            if self.follower is not None and self.fresh:
                self.follower.stage(self._stage, self.ts.getTimeStep())
        self._count_failure(reason, self.ts.getTimeStep())

    def _count_failure(self, reason: int, step: float) -> None:
        """Count a solve of a ``step`` [s] that did not converge, and raise SolveError after too many in a row."""
        self._consecutive_failures = self._consecutive_failures + 1 if reason < 0 else 0
        if self._consecutive_failures > CONSECUTIVE_FAILURES or (reason < 0 and step < SHORTEST_STEP):
            raise self.failure(
                f"Newton's method failed {self._consecutive_failures} times in a row ({_reason(reason, PETSc.SNES)}), "
                f"at last with a step of {step:.2g} s"
            )

    def _events(self) -> list[tuple[Component, FloatArray]]:
        """Components whose law ends at the present state, with the figures that show it; the same on all ranks, collective."""
        out = []
        for component in self._eventful:
            numbers = component.event_numbers(self.system.assembly)
            numbers = total(self.system.comm, numbers)
            if component.event_passed(numbers):
                out.append((component, numbers))
        return out

    def _change_laws(self, t: float) -> bool:
        """Change the laws that end at the present state at ``t`` [s], and restart the formula; True if any does."""
        passed = self._events()
        if not passed:
            return False
        for call in self.before_event:
            call(t)
        for component, numbers in passed:
            if self.follower is None:
                component.change_law(numbers)
            else:
                self.follower.change_law(t, component, numbers)
        for call in self.after_event:
            call(t)
        self._restart_after_event(t)
        return True

    def _restart_after_event(self, t: float) -> None:
        """Restart the formula after a law has changed at ``t`` [s]."""
        self._restart(t)
        self.ts.setTimeStep(max(min(self.first_step, self._stop - t), SHORTEST_STEP))

    def freeze(self, steps: FloatArray) -> None:
        """Take these ``steps`` [s] from the start on, without step control; they end at every stop of the run."""
        self._frozen, self._fixed = list(map(float, steps)), True
        self.first_step = self._frozen[0]
        self._set_tolerances(False)  # which reject no step

    def _frozen_step(self) -> float:
        """Length of the next step of ``freeze`` [s]."""
        assert self._frozen is not None
        return self._frozen[min(self.counters.steps, len(self._frozen) - 1)]

    def failure(self, what: str) -> SolveError:
        """Return the error that ends a run, with the place of the largest residual; collective."""
        for call in self.on_failure:
            call()
        place = (
            self.system.locate_largest_residual(self._t)
            if self.condensed
            else self.first_order.locate_largest_residual()
        )
        return SolveError(
            what,
            time=self._last,
            hint=self.cure,
            **place,
        )

    def newton_iterations(self) -> int:
        """Number of Newton iterations so far, rejected steps included."""
        return self.newton.iterations if self.condensed else self.ts.getSNESIterations()

    def jacobian_count(self) -> int:
        """Number of Jacobians so far."""
        return self.newton.jacobians if self.condensed else self.first_order.jacobians

    def failure_count(self) -> int:
        """Number of Newton solves so far that did not converge."""
        return self.newton.failures if self.condensed else self.ts.getSNESFailures()

    def compiled_seconds(self) -> dict[str, float]:
        """Wall time so far of the phases of Newton's method in compiled code [s]; PETSc's log has the time of all others."""
        return self.newton.iteration.seconds if self.condensed else {}

    def linear_iterations(self) -> int:
        """Number of linear iterations so far."""
        return self.newton.linear_iterations if self.condensed else self.ts.getKSPIterations()

    def output_errors(self) -> OutputErrors | None:
        """Return the errors of the formula in outputs; None for formulas without an estimate."""
        return BdfOutputErrors(self.order) if self.is_bdf else None

    def damped_above(self) -> float | None:
        """Frequency [Hz] above which the formula damps; None: the estimate of the outputs has it."""
        return None

    def damped_product(self) -> float | None:
        """Product of that frequency and the step [-]; None: the estimate of the outputs has it."""
        return None

    # ------------------------------------------------------------------ run
    @petsc_compat.callback
    def _post_step(self, ts) -> None:
        """Finish an accepted step: history, callbacks, reference frames (manual: sec-time-update)."""
        if ts.getConvergedReason() < 0:  # PETSc also calls this after a step that failed for good
            self.system.load_state(ts.getSolution())
            return
        if not self.condensed:
            self.first_order.accept(ts)
        before, self._last = self._last, ts.getTime()
        dt = self.last_step = self._last - before
        # a remainder below rounding is not integrated; PETSc has chosen it as the next step
        if abs(self._stop - self._last) < END_TOLERANCE * max(1.0, abs(self._stop)):
            ts.setConvergedReason(PETSc.TS.ConvergedReason.CONVERGED_TIME)
            if ts.getTimeStep() < SHORTEST_STEP:
                ts.setTimeStep(max(dt, SHORTEST_STEP))
        self.counters.steps += 1
        self._step_number += 1
        if (
            self._frozen is None and self._fixed and ts.getTimeStep() < self.first_step
        ):  # a fixed step that was shortened grows again
            remainder = self._stop - self._last
            ts.setTimeStep(
                min(self.first_step, 2 * ts.getTimeStep(), remainder if remainder > SHORTEST_STEP else np.inf)
            )
        if self._frozen is not None:
            ts.setTimeStep(self._frozen_step())
        self._finish(dt)
        if self.stopped:
            ts.setConvergedReason(PETSc.TS.ConvergedReason.CONVERGED_USER)

    def _finish(self, dt: float) -> None:
        """Finish an accepted step of ``dt`` [s]: callbacks, reference frames (manual: sec-time-update)."""
        t, asm = self._last, self.system.assembly
        if self.follower is not None:
            self.follower.step(t)
        self.system.accept(t)
        with asm.unchanged():  # results of the step are shared by all that follows
            for call in self.after_step:
                call(t, dt)
            # last, since it uses the results that the others have computed
            if self.work is not None:
                self.work.after_step(t, dt, self.newton.arrays[1], self.input_time(t), self.jumped)
            # the limit by whirl is for the contacts of the accepted state (manual: sec-time-choice)
            if self.step_limit is not None and not self._fixed:
                self._next_step = self.step_limit(self._next_step)
        self._steps_over_jump, self.fresh = max(0, self._steps_over_jump - 1), False
        if self._mud_masked and not self._steps_over_jump:  # the mud has error control again
            self._set_tolerances(False)
        changed = bool(self._eventful) and self._change_laws(t)
        # a tangent far from its reference direction gets a new one, 60 degrees before the singularity
        # (manual: eq-beam-update-criterion)
        if not changed and self._step_number % REFRAME_INTERVAL == 0:
            earlier = asm.reference.copy()
            changed = self.system.renew_reference_frames()
            if changed:
                self._reframe(earlier)
        self._keep_step(changed)
        for finish in self.on_step_end:
            finish(t)

    def _reframe(self, earlier: FloatArray) -> None:
        """Go on with new reference directions, after the ``earlier`` ones (nv, 3): the formula restarts."""
        self.system.store_state(self.ts.getSolution())
        self._restart(self._last)

    def _restart(self, t: float) -> None:
        """Restart the formula at ``t`` [s], without its history."""
        self._discard_factor()
        self.ts.restartStep()
        self.fresh = True
        self.history.start(t, self.system.assembly.x, self.system.assembly.y)

    def _keep_step(self, restarted: bool) -> None:
        """Record an accepted step, unless the formula has restarted after it."""
        if self.keeps_history and not restarted:
            asm = self.system.assembly
            self.history.add_step(self._last, self._requested_step, asm.x, asm.y)

    @property
    def jumped(self) -> bool:
        """Whether the formula of the current step reaches over a jump of a prescribed velocity."""
        return self._steps_over_jump > 0

    def _rates_jump(self, t: float) -> bool:
        """Whether a prescribed velocity jumps at ``t`` [s]; the same on all ranks, collective."""
        before = float(np.nextafter(t, -np.inf))
        local = any(
            not np.allclose(f.condition.rate(before), f.condition.rate(t), rtol=1e-9, atol=1e-12)
            for f in self.system.assembly.row_replacements
            if f.owned
        )
        return bool(total(self.system.comm, local))

    @flushed_denormals()
    def run(self, start: float, end: float, breaks: tuple[float, ...] = (), resume: bool = False) -> None:
        """Integrate from ``start`` to ``end`` [s]; collective.

        resume: go on from the end of the last ``run``, at ``start``, with the formula's history unless an input jumps there.

        breaks: times at which inputs jump or bend [s].  A step ends at each of them, and the formula restarts
        there (manual: sec-time-jumps).

        Raises SolveError if no step can be taken.  The assembly then contains the last accepted state.
        """
        self.system.assembly.invalidate_prescribed_values()
        if not resume:
            self.system.accept(start)
            self.system.store_state(self.state)
        # a break this near the start or the end coincides with it (0.1 + 0.2 and 0.3)
        near = END_TOLERANCE * max(1.0, abs(end))
        stops = sorted({b for b in breaks if start + near < b < end - near} | {end})
        jumps = {s for s in stops if any(abs(b - s) <= near for b in breaks)}
        self._last = t = start
        if self.work is not None:
            self.work.start(start)
        first, at_break = not resume, any(abs(b - start) <= near for b in breaks)
        self._take_up(at_break)
        for stop in self._with_samples(start, end, near, stops):
            if at_break:
                self._change_states(t)
            self._stop, self._jump = stop, stop if stop in jumps else np.inf
            self._begin(t, first, at_break, self._is_sample(t, near))
            first, at_break = False, stop in jumps
            t = self._advance(t)
            if self.stopped:
                return

    def _take_up(self, at_break: bool) -> None:
        """Take up a checkpoint before components see its state; at_break: an input jumps or bends there."""
        found, self._accelerations = self._accelerations, None
        if at_break and found is not None:  # for a controller that takes over without a jump of its torque
            asm = self.system.assembly
            asm.a[:] = local(self.system, found, asm.a)

    def _begin(self, t: float, first: bool, at_break: bool, at_sample: bool) -> None:
        """Begin the stretch of a run from ``t`` [s] to the next stop; first: of the run, without the history of an earlier one."""
        if at_sample and self.sampler is not None:
            self.sampler(t)
        if first:
            self.ts.setTime(t)
        if self._restored is not None and not at_break:
            self._replay_history()
        elif first or at_break:
            self._restored = None
            self._start_formula()
        if self.ts.getTime() != t:  # by the remainder that was not integrated; it must not add up
            self.ts.setTime(t)

    def _advance(self, t: float) -> float:
        """Take steps from ``t`` [s] to the next stop, and return its time."""
        ts = self.ts
        ts.setMaxTime(self._stop)
        rejected = ts.getStepRejections()
        with petsc_compat.own_errors():
            ts.solve(self.state)
        if ts.getConvergedReason() < 0:
            raise self.failure(f"the time integrator stopped: {_reason(ts.getConvergedReason(), PETSc.TS)}")
        self.counters.rejected += ts.getStepRejections() - rejected
        return self._stop

    def _with_samples(self, start: float, end: float, near: float, stops: list[float]) -> list[float]:
        """The ``stops``, and the samples between start and end [s] that do not coincide with one."""
        if self.sampler is None:
            return stops
        period = self.sampler.period
        first, last = int(np.floor(start / period)) + 1, int(np.ceil(end / period))
        samples = [k * period for k in range(first, last)]
        apart = [s for s in samples if s > start + near and all(abs(s - q) > near for q in stops)]
        return sorted({*stops, *apart})

    def _is_sample(self, t: float, near: float) -> bool:
        if self.sampler is None:
            return False
        period = self.sampler.period
        return abs(t - round(t / period) * period) <= near

    def _change_states(self, t: float) -> None:
        """Let components change their states where an input jumps or bends at ``t`` [s]."""
        changed = False
        for component in self.system.components:
            changed |= component.at_break(t, self.system.assembly)
        if changed:
            self.system.store_state(self.state)
        if self.follower is not None:
            self.follower.change_states(t, changed)

    def _start_formula(self) -> None:
        """Restart the formula without history, e.g. after a discontinuity."""
        ts, t = self.ts, self.ts.getTime()
        # the formulas of these steps reach back over the jump (manual: sec-time-jumps)
        self._jump_rates(t, 1 + self.order)
        self._restart(t)
        step = self.first_step if self._frozen is None else self._frozen_step()
        ts.setTimeStep(min(step, self._stop - t))
        if self.follower is not None:
            self.follower.start(t, self.jumped)

    def _jump_rates(self, t: float, reach: int) -> bool:
        """Whether a prescribed velocity jumps at ``t`` [s]; the formula then spans the jump in ``reach`` steps; collective."""
        self._discard_factor()
        if not self._rates_jump(t):
            return False
        self._steps_over_jump = reach
        self._set_tolerances(True)
        for call in self.at_jump:
            call(t)
        return True

    def close(self) -> None:
        """Free the solvers and vectors of PETSc; the integrator cannot be used afterwards."""
        self.ts.destroy()
        if self.condensed:
            self._matrix.destroy()
        for vector in (self.state, self._f, self._zero):
            vector.destroy()

    def stop(self) -> None:
        """End the run after this step; to be called from on_step_end, on all ranks."""
        self.stopped = True

    # ------------------------------------------------------------------ checkpoints
    def get_state(self) -> dict[str, FloatArray]:
        """Return the data that a restart needs besides the state, for use in on_step_end; complete on rank 0; collective.

        clock: next step [s], number of steps, coming steps over a jump, whether the mud has no error control.
        accelerations: (nodes, m) of all fields.
        Further entries: see ``BdfHistory.get_state`` and ``CondensedNewton.get_state``.
        An integrator whose history cannot be rebuilt has first_step [s] in place of clock and those.
        """
        gathered = self.system.gather(nodal(self.system, self.system.assembly.a))
        own = self._work_state() | ({} if gathered is None else {"accelerations": gathered})
        if not self.keeps_history:  # the formula restarts here, in this run and in a restarted one
            self.first_step = max(self.first_step, 0.1 * self.last_step)
            return {"first_step": np.array(self.first_step)} | own
        clock = np.array(
            [self.ts.getTimeStep(), self._step_number, self._steps_over_jump, self._mud_masked], dtype=float
        )
        return {"clock": clock} | self.history.get_state(self.system) | self.newton.get_state() | own

    def _work_state(self) -> dict[str, FloatArray]:
        work = self.work.get_state() if self.work is not None else {}
        return work | (self.estimate.get_state() if self.estimate is not None else {})

    def set_state(self, state: dict[str, FloatArray]) -> None:
        """Continue from a checkpoint with the next ``run``: ``state`` as returned by ``get_state``.

        With the checkpoint of another kind of integrator the formula restarts.
        """
        if self.work is not None:
            self.work.set_state(state)
        self._accelerations = state.get("accelerations")
        if not self.keeps_history:
            self.first_step = float(state.get("first_step", self.first_step))
        elif "times" in state:
            self.history.set_state(self.system, state)
            self._next_step, self._step_number, self._steps_over_jump = (
                float(state["clock"][0]),
                int(state["clock"][1]),
                int(state["clock"][2]),
            )
            self._set_tolerances(bool(state["clock"][3]))
            self._restored = state
        if self.estimate is not None:
            self.estimate.set_state(state)

    def _replay_history(self) -> None:
        """Rebuild the history of TSBDF: repeat each recorded step, with the recorded state as its solution.

        Manual: sec-time-restart.
        """
        ts, history = self.ts, self.history
        assert self._restored is not None
        masked = self.system.new_state()
        masked.set(MASKED)
        ts.setTolerances(rtol=self._zero, atol=masked)  # no step is rejected
        ts.setMaxTime(MASKED)  # no step is shortened
        self.fresh = not history.steps
        history.replay(ts, self.system, self.state)
        ts.setTimeStep(self._next_step)
        self._set_tolerances(self._mud_masked)
        # the kept Jacobian too: a restarted run repeats the uninterrupted one to the last bit (manual: sec-time-restart)
        self.newton.set_state(self._restored)
        self._restored = None

    def _discard_factor(self) -> None:
        """Discard earlier factorisations, so that a restarted run takes the same steps as an uninterrupted one."""
        if self.condensed:
            self.newton.discard_factor()


def _reason(value: int, solver: Any) -> str:
    names = {v: k for k, v in vars(solver.ConvergedReason).items() if isinstance(v, int)}
    return names.get(value, str(value))
