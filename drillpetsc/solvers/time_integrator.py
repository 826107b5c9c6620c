"""Motion in time: PETSc's TS around the condensed Newton, or around a plain assembled system when options ask
for one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from petsc4py import PETSc

from drillpetsc import petsc_compat
from drillpetsc.arrays import FloatArray
from drillpetsc.errors import SolveError
from drillpetsc.fem.component import Field
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.solvers.bdf_history import BdfHistory, State
from drillpetsc.solvers.first_order_system import FirstOrderSystem, refuse_integrator
from drillpetsc.solvers.newton import CondensedNewton

MASKED = 1.0e20  # tolerance of a row that the error control leaves out
DEFAULTS = {
    "ts_type": "bdf",
    "ts_bdf_order": 2,
    "ts_adapt_type": "basic",
    "ts_adapt_clip": "0.2,2.0",
    "ts_exact_final_time": "matchstep",
    "ts_max_snes_failures": -1,  # counted here, consecutive ones; PETSc's count is over the whole run
    "ts_error_if_step_fails": 0,  # told in our words
}
TOLERANCE = 1.0e-4  # default of -ts_rtol
CONSECUTIVE_FAILURES = 25
# with multipliers Newton's tolerance is this much smaller: what it leaves of a constraint is a misfit of the
# parts
CONSTRAINED = 1.0e-3
NOTHING_LEFT = 1.0e-11  # share of the time at which a run has reached its end
SHORTEST_STEP = 1.0e-11  # a step that fails at this length fails at any [s]


@dataclass
class Counters:
    steps: int = 0
    rejected: int = 0


@dataclass
class TimeIntegrator:
    """Integrates a model from the state in its assembly.

    after_step(t, dt) is called after every accepted step, with x, y, a of the assembly at t; before_solve(t)
    before a step that ends at t is solved for.  first_step [s].  controlled(field): whether a field takes part
    in the error control; defaults: PETSc options beside DEFAULTS.   at_jump(t) is called where
    the rate of a prescribed motion jumps, before the step that follows; ``jumped`` is true while after_step
    is called for the steps whose time formula still reaches over the jump.  at_rest(t) comes last of all,
    when nothing of the step is left to do: there ``memory`` may be taken and ``stop`` called.
    """

    system: DiscreteSystem
    after_step: list[Callable[[float, float], None]] = field(default_factory=list)
    at_jump: list[Callable[[float], None]] = field(default_factory=list)
    before_solve: list[Callable[[float], None]] = field(default_factory=list)
    at_rest: list[Callable[[float], None]] = field(default_factory=list)
    first_step: float = 1.0e-4
    controlled: Callable[[Field], bool] = field(default=lambda field: True)
    defaults: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        options = PETSc.Options()
        petsc_compat.rename_time_step(options)
        given = set(options.getAll())
        for key, value in {**DEFAULTS, petsc_compat.max_rejections_option(): 60, **self.defaults}.items():
            if key not in given:
                options.setValue(key, value)
        self.first_step = options.getReal(petsc_compat.time_step_option(), self.first_step)
        self._fixed = options.getString("ts_adapt_type", "basic") == "none"
        self.tolerance = options.getReal("ts_rtol", TOLERANCE)
        self.condensed = (
            options.getString("ts_type", "bdf") == "bdf"
            and options.getString("snes_type", "python") == "python"
        )
        refuse_integrator(options.getString("ts_type", "bdf"), self.system.constrained)
        self.counters, self._in_a_row, self.last_step, self._reach = Counters(), 0, 0.0, 0
        self._order, self.fresh = (
            options.getInt("ts_bdf_order", 2),
            True,
        )  # fresh: the next step is the first of its formula
        self._last, self._t, self._jump, self._stop = 0.0, 0.0, np.inf, np.inf
        # the formulas whose history can be put back; the others start afresh at every checkpoint, also where
        # nothing interrupts them
        self.remembers = self.condensed and options.getString("ts_adapt_type", "basic") in ("basic", "none")
        self.past, self.stopped, self._age, self._tried, self._next_step = (
            BdfHistory(self._order + 1),
            False,
            0,
            0.0,
            0.0,
        )
        self._told: list[State] | None = (
            None  # what solve hands out while a continued run steps through its past
        )
        self._resumed: dict[str, FloatArray] | None = None
        self._make(options)
        self.options = dict(options.getAll())  # in effect, defaults included
        for key in set(self.options) - given:  # the next scene has defaults of its own
            options.delValue(key)

    def _make(self, options: PETSc.Options) -> None:
        system = self.system
        self.state = system.new_state()
        self.ts = PETSc.TS().create(comm=system.comm)
        self.ts.setProblemType(PETSc.TS.ProblemType.NONLINEAR)
        self._f = system.new_state()
        if self.condensed:
            if not options.hasName("snes_type"):
                options.setValue("snes_type", "python")
            share = CONSTRAINED if system.multipliers else 1.0
            self.newton = CondensedNewton(system, tolerance=0.02 * self.tolerance * share)
            # not after the step: PETSc starts the formula afresh where a solution was changed by another than
            # its solver
            self._restoring = [c for c in system.components if c.restores_constraints]
            matrix = PETSc.Mat().createPython(
                (self.state.getSizes(), self.state.getSizes()), context=self, comm=system.comm
            )
            matrix.setUp()
            self._xdot = system.new_state()
            self.ts.setIFunction(self._catch_rate, self._f)
            self.ts.setIJacobian(self._catch_shift, matrix)
            self._matrix = matrix
            snes = self.ts.getSNES()
            snes.setType("python")
            snes.setPythonContext(self)
        else:
            self.plain = FirstOrderSystem(system)
            self.plain.default_solver(options)
            self.ts.setIFunction(
                lambda ts, t, *rest: self.plain.function(ts, self.input_time(t), *rest), self._f
            )
            self.ts.setIJacobian(
                lambda ts, t, *rest: self.plain.jacobian(ts, self.input_time(t), *rest), self.plain.matrix
            )
            # PETSc takes the mass matrix for one without this, and arkimex goes wrong in silence
            kinds = PETSc.TS.EquationType
            constrained = kinds.DAE_IMPLICIT_INDEXHI if system.constrained else kinds.DAE_IMPLICIT_INDEX1
            self.ts.setEquationType(
                constrained if system.assembly.row_replacements or system.constrained else kinds.IMPLICIT
            )
        self.ts.setFromOptions()
        self._nothing = system.new_state()
        self._relax(False)
        self.ts.setPostStep(self._post_step)

    def _relax(self, jumped: bool) -> None:
        """Where a prescribed motion jumps, flow relative to the pipe jumps as well: no step is short enough
        for its error control."""
        self._relaxed = jumped
        self.ts.setTolerances(rtol=self._nothing, atol=self.tolerance_vector(fluid=not jumped))

    def tolerance_vector(self, fluid: bool = True) -> PETSc.Vec:
        """Absolute tolerance per row of the state: -ts_rtol times the field's scale; rates and algebraic rows
        are masked, and without ``fluid`` those of the mud."""
        layout, vector = self.system.layout, self.system.new_state()
        controlled = np.array(
            [
                f.differential and self.controlled(f) and (fluid or f.physics == "string")
                for f in layout.fields
            ]
        )
        differential = controlled[layout.field_of[layout.local_of_owned]]
        values = vector.getArray()
        values[:] = MASKED
        values[layout.x_owned] = np.where(
            differential, self.tolerance * self.system.scale[layout.local_of_owned], MASKED
        )
        vector.assemble()
        return vector

    def input_time(self, t: float) -> float:
        """Time at which inputs are looked up: a step that ends where one jumps still sees the value before
        the jump."""
        return t if t < self._jump else float(np.nextafter(self._jump, -np.inf))

    # ------------------------------------------------------------------ condensed step, called by the outer
    # SNES
    def _catch_rate(self, ts, t, x, xdot, f) -> None:
        self._t = self.input_time(t)
        xdot.copy(self._xdot)

    def _catch_shift(self, ts, t, x, xdot, shift, J, P) -> None:
        self._shift = shift

    def solve(self, snes, b, x) -> None:
        """Solve of the outer python SNES: its unknown is the whole state, of which the condensed Newton finds
        the positions."""
        if self._told is not None:
            self._hand_out(snes, x)
            return
        snes.computeFunction(x, self._f)
        snes.computeJacobian(x, self._matrix)
        self._xdot.axpy(-self._shift, x)  # constant part of the time formula
        self.system.load_history(self._xdot)
        self.system.load_state(x)
        for call in self.before_solve:
            call(self._t)
        reason = self.newton.solve(self._t, self._shift)
        for component in self._restoring:
            component.restore_constraints(self.system.assembly)
        self.system.store_state(x)
        snes.setIterationNumber(self.newton.snes.getIterationNumber())
        snes.setConvergedReason(reason)
        self._tried = self.ts.getTimeStep()
        if reason > 0:
            self.past.solved(self.system.assembly.x, self.system.assembly.y)
        self._in_a_row = self._in_a_row + 1 if reason < 0 else 0
        if self._in_a_row > CONSECUTIVE_FAILURES or (reason < 0 and self.ts.getTimeStep() < SHORTEST_STEP):
            raise self.collapse(
                f"Newton's method failed {self._in_a_row} times in a row ({_reason(reason, PETSc.SNES)}), "
                f"at last with a step of {self.ts.getTimeStep():.2g} s"
            )

    def collapse(self, what: str) -> SolveError:
        """The error that ends a run, with the place where the rows are worst."""
        place = (
            self.system.locate_largest_residual(self._t)
            if self.condensed
            else self.plain.locate_largest_residual()
        )
        return SolveError(
            what,
            time=self.ts.getTime(),
            hint="look at the inputs at this time and place; a smaller -ts_rtol, softer "
            "contact or -q_snes_linesearch_type bt may help",
            **place,
        )

    def newton_iterations(self) -> int:
        """Newton iterations so far, rejected steps included."""
        return self.newton.newton if self.condensed else self.ts.getSNESIterations()

    def jacobian_count(self) -> int:
        return self.newton.jacobians if self.condensed else self.plain.jacobians

    def failure_count(self) -> int:
        return self.newton.failures if self.condensed else self.ts.getSNESFailures()

    def linear_iterations(self) -> int:
        return self.newton.linear if self.condensed else self.ts.getKSPIterations()

    # ------------------------------------------------------------------ run
    def _post_step(self, ts) -> None:
        if not self.condensed:
            self.plain.accept(ts)
        dt = self.last_step = ts.getTime() - self._last
        self._last = ts.getTime()
        if abs(self._stop - self._last) < NOTHING_LEFT * max(
            1.0, abs(self._stop)
        ):  # a rest below rounding is no step
            ts.setConvergedReason(PETSc.TS.ConvergedReason.CONVERGED_TIME)
        self.counters.steps += 1
        self._age += 1
        if self._fixed and ts.getTimeStep() < self.first_step:  # a step that was cut does not stay short
            left = self._stop - self._last
            ts.setTimeStep(
                min(self.first_step, 2 * ts.getTimeStep(), left if left > SHORTEST_STEP else np.inf)
            )
        self.system.accept()
        for call in self.after_step:
            call(self._last, dt)
        self._reach, self.fresh = max(0, self._reach - 1), False
        if self._relaxed and not self._reach:
            self._relax(False)
        # a tangent that has turned far from its reference direction gets a new one, and the history starts
        # afresh; 60 degrees are left when it is due
        asm = self.system.assembly
        if self._age % 4 == 0 and self.system.renew_reference_frames():
            self.system.store_state(ts.getSolution())
            self._forget()
            ts.restartStep()
            self.fresh = True
            self.past.begin(self._last, asm.x, asm.y)
        elif self.remembers:
            self.past.add(self._last, self._tried, asm.x, asm.y)
        for finish in self.at_rest:
            finish(self._last)
        if self.stopped:
            ts.setConvergedReason(PETSc.TS.ConvergedReason.CONVERGED_USER)

    @property
    def jumped(self) -> bool:
        return self._reach > 0

    def _rates_jump(self, t: float) -> bool:
        """Whether a prescribed motion changes its rate at once at ``t``; the same on all ranks."""
        before = float(np.nextafter(t, -np.inf))
        on_rank = any(
            not np.allclose(f.condition.rate(before), f.condition.rate(t), rtol=1e-9, atol=1e-12)
            for f in self.system.assembly.row_replacements
            if f.owned
        )
        return (
            on_rank
            if self.system.comm.size == 1
            else bool(self.system.comm.tompi4py().allreduce(int(on_rank)))
        )

    def run(self, start: float, end: float, breaks: tuple[float, ...] = ()) -> None:
        """From ``start`` to ``end`` [s], landing on every break and starting the formula afresh there.

        Raises SolveError when no step can be taken; everything up to the last accepted step stands in the
        assembly.
        """
        system, ts = self.system, self.ts
        system.assembly.invalidate_prescribed_values()
        self.system.accept()
        system.store_state(self.state)
        near = NOTHING_LEFT * max(
            1.0, abs(end)
        )  # a break this near the end or the start is at it (0.1 + 0.2 and 0.3)
        stops = sorted({b for b in breaks if start + near < b < end - near} | {end})
        jumps = {s for s in stops if any(abs(b - s) <= near for b in breaks)}
        ts.setTime(start)
        ts.setTimeStep(self.first_step)
        ts.setMaxSteps(2**31 - 1)
        self._last = start
        goes_on = self._resumed is not None and not any(abs(b - start) <= near for b in breaks)
        for stop in stops:
            self._stop, self._jump = stop, stop if stop in jumps else np.inf
            if goes_on:
                self._step_through_past()
            else:
                self._start_formula(stop)
            goes_on = False
            ts.setMaxTime(stop)
            rejected = ts.getStepRejections()
            with petsc_compat.own_errors():
                ts.solve(self.state)
            if ts.getConvergedReason() < 0:
                raise self.collapse(
                    f"the time integrator stopped: {_reason(ts.getConvergedReason(), PETSc.TS)}"
                )
            self.counters.rejected += ts.getStepRejections() - rejected
            if self.stopped:
                return

    def _start_formula(self, stop: float) -> None:
        """Begin at a state that earlier ones say nothing about."""
        ts, asm = self.ts, self.system.assembly
        self._forget()
        if self._rates_jump(ts.getTime()):
            self._reach = 1 + self._order
            self._relax(True)
            for call in self.at_jump:
                call(ts.getTime())
        ts.restartStep()
        self.fresh = True
        self.past.begin(ts.getTime(), asm.x, asm.y)
        ts.setTimeStep(min(self.first_step, stop - ts.getTime()))

    def stop(self) -> None:
        """End the run after this step; to be called from at_rest, on all ranks."""
        self.stopped = True

    # ------------------------------------------------------------------ checkpoints
    def get_state(self) -> dict[str, FloatArray]:
        """What a continued run needs beside the state, for at_rest; whole on rank 0.  Collective."""
        if not self.remembers:  # here and in the continued run the formula starts afresh
            self.first_step = max(self.first_step, 0.1 * self.last_step)
            return {"first_step": np.array(self.first_step)}
        clock = np.array([self.ts.getTimeStep(), self._age, self._reach, self._relaxed], dtype=float)
        return {"clock": clock} | self.past.get_state(self.system) | self.newton.get_state()

    def set_state(self, memory: dict[str, FloatArray]) -> None:
        """Go on from a checkpoint's memory, with the next ``run``; a checkpoint of another kind of integrator
        leaves a fresh start."""
        if not self.remembers:
            self.first_step = float(memory.get("first_step", self.first_step))
        elif "times" in memory:
            self.past.set_state(self.system, memory)
            self._next_step, self._age, self._reach = (
                float(memory["clock"][0]),
                int(memory["clock"][1]),
                int(memory["clock"][2]),
            )
            self._relax(bool(memory["clock"][3]))
            self._resumed = memory

    def _step_through_past(self) -> None:
        """Give TSBDF the history of a checkpoint: each noted step is taken again, with its result for a
        solution."""
        ts, system, past = self.ts, self.system, self.past
        assert self._resumed is not None
        everything = system.new_state()
        everything.set(MASKED)
        ts.setTolerances(rtol=self._nothing, atol=everything)  # no step is refused
        ts.setMaxTime(MASKED)  # none is cut to fit
        self._put(past.states[0])
        system.store_state(self.state)
        ts.setSolution(self.state)
        ts.setTime(past.times[0])
        ts.restartStep()
        self.fresh = not past.steps
        for k, step in enumerate(past.steps):
            self._told = [past.states[k + 1]] if k else [past.half or past.states[0], past.states[1]]
            ts.setTimeStep(step)
            with petsc_compat.own_errors():
                ts.step()
        self._told = None
        if ts.getTime() != past.times[-1]:
            raise SolveError(
                f"the history of the checkpoint leads to {ts.getTime()!r} s, not to {past.times[-1]!r} s"
            )
        self._put(past.states[-1])
        ts.setTimeStep(self._next_step)
        self._relax(self._relaxed)
        self.newton.set_state(self._resumed)
        self._resumed = None

    def _hand_out(self, snes, x) -> None:
        """Solve of a step that is known."""
        assert self._told
        self._put(self._told.pop(0))
        self.system.store_state(x)
        snes.setIterationNumber(1)
        snes.setConvergedReason(PETSc.SNES.ConvergedReason.CONVERGED_ITS)

    def _put(self, state: State) -> None:
        asm = self.system.assembly
        asm.x[:], asm.y[:] = state

    def _forget(self) -> None:
        """Start without memory of earlier factors, so that a continued run takes the same steps as an
        uninterrupted one."""
        if self.condensed:
            self.newton.forget()


def _reason(value: int, solver: Any) -> str:
    names = {v: k for k, v in vars(solver.ConvergedReason).items() if isinstance(v, int)}
    return names.get(value, str(value))
