"""Generalised-alpha as an alternative to BDF: the same condensed Newton method, but separate step control (manual: sec-time-alpha).

PETSc's TSALPHA2 has no first-order rows and no constraints, and it takes forces at an interpolated state. This
integrator therefore takes its steps itself.  It has the interface of ``TimeIntegrator``.
"""

from __future__ import annotations

from math import isfinite, log2, sqrt

import numpy as np
from petsc4py import PETSc

from drillpetsc import petsc_compat
from drillpetsc.arrays import FloatArray
from drillpetsc.errors import OptionError
from drillpetsc.parallel import total
from drillpetsc.solvers.time.alpha_formula import (
    ARRAYS,
    AlphaFormula,
    AlphaHistory,
    AlphaOutputErrors,
    ControlledUnknowns,
    radius_of,
)
from drillpetsc.solvers.time.bdf_history import local, nodal
from drillpetsc.solvers.time.consistent_start import ConsistentStart
from drillpetsc.solvers.time.local_error import OutputErrors
from drillpetsc.solvers.time.time_integrator import (
    CURE,
    END_TOLERANCE,
    EVENT_STEP,
    SHORTEST_STEP,
    TimeIntegrator,
)

NAMES = ("alpha2", "genalpha")  # of -ts_type
RADIUS = 0.8  # default of -ts_alpha_radius
FAILURE_FACTOR = 0.25  # of the step after Newton has failed
SAFETY, REPEATED = 0.9, 0.5  # of the step control; the second once more after a second rejection
#: exponents of the step control by the last error and by the one before (Gustafsson, ACM TOMS 17 (1991) 533)
BY_ERROR, BY_EARLIER = -0.7 / 3, 0.4 / 3
SMALLEST_ERROR = 1e-6  # smaller ones do not let the step grow faster
STRETCH = 1e-3  # the last step may be longer by this fraction instead of being split
#: steps are counted in classes of a quarter of an octave, the first one of 2^-40 s
CLASSES_PER_OCTAVE, FIRST_OCTAVE, CLASSES = 4, -40, 4 * 64


class GeneralizedAlpha(TimeIntegrator):
    """Generalised-alpha in end-point form of a discrete system; parameters as for ``TimeIntegrator``.

    Raises OptionError for options that have no meaning here.
    """

    own_defaults = {"ts_type": NAMES[0], "ts_adapt_type": "basic", "ts_adapt_clip": "0.2,2.0"}
    condensed_kinds = NAMES

    def __post_init__(self) -> None:
        super().__post_init__()
        self.options["ts_alpha_radius"] = repr(self.formula.radius)

    def _refuse(self, options: PETSc.Options) -> None:
        kind = options.getString("ts_adapt_type", "basic")
        if kind not in ("basic", "none"):
            raise OptionError(at="petsc.ts_adapt_type", got=kind, want="basic | none with generalised-alpha")
        order = options.getInt("ts_bdf_order", 2)
        if order != 2:
            raise OptionError(
                at="petsc.ts_bdf_order", got=str(order), want="2, the order of generalised-alpha"
            )
        if options.getString("snes_type", "python") != "python":
            raise OptionError(
                at="petsc.snes_type",
                got=options.getString("snes_type"),
                want="no snes_type: generalised-alpha uses the condensed Newton method",
                hint="-q_snes_type selects its solver",
            )

    def _make(self, options: PETSc.Options) -> None:
        """Create the formula and its step control."""
        system, layout = self.system, self.system.layout
        if self.cure == CURE:
            self.cure = CURE.replace("-ts_rtol", "-ts_rtol or -ts_alpha_radius")
        self.formula = _formula(options)
        self.longest = options.getReal("ts_adapt_dt_max", np.inf)
        self.shortest = options.getReal("ts_adapt_dt_min", 0.0)
        self.safety = options.getReal("ts_adapt_safety", SAFETY)
        low, high = options.getString("ts_adapt_clip", "0.2,2.0").split(",")
        self.clip = float(low), float(high)
        self.max_rejections = options.getInt(petsc_compat.max_rejections_option(), 60)
        self._earlier_error = 1.0
        self.begin = ConsistentStart(self.newton)
        two = np.array([f.second_order for f in layout.fields])[layout.field_of]
        self.alpha = AlphaHistory(self.formula, two)
        self._tolerances = {}  # of the unknowns with error control, by whether the mud has none
        for masked in (False, True):
            rows = layout.local_of_owned[self._is_controlled(fluid=not masked)]
            self._tolerances[masked] = ControlledUnknowns(rows, self.tolerance * system.scale[rows])
        self._monitored = options.hasName("ts_monitor") and system.comm.rank == 0
        self._step_time = np.zeros((2, CLASSES))  # sums of h [s] and of h^2 by class
        self._rows = self.state.getSize()  # PETSc's norm divides by all rows of the state

    def _set_tolerances(self, jumped: bool) -> None:
        self._mud_masked = jumped

    @property
    def next_step(self) -> float:
        """``TimeIntegrator.next_step``."""
        return self._next_step

    # ------------------------------------------------------------------ one step
    def _solve_step(self, t: float, h: float) -> int:
        """Solve the step of length ``h`` [s] that ends at ``t`` [s], which is then tried in the history: reason, negative without a solution."""
        asm = self.system.assembly
        x, y, a, _ = asm.state_at
        shifts = self.alpha.begin(h, *asm.history_at, x)
        self._t = self.input_time(t)
        for call in self.before_solve:
            call(self._t)
        reason = self.newton.solve(self._t, *shifts)
        if reason >= 0:
            for component in self._restoring:
                component.restore_constraints(asm)
            self.alpha.advance(h, x, y, a, self._tolerances[self._mud_masked])
        return reason

    def _load(self) -> None:
        """Put the state at the start of the step back into the assembly."""
        asm, n = self.system.assembly, self.system.layout.size
        q = self.alpha.arrays
        asm.x[:n], asm.y[:n], asm.a[:n] = q["x"], q["y"], q["w"]

    def _error(self) -> float:
        """Return the weighted norm of the local error of the step that was tried; 1 is the tolerance; collective."""
        shares = self._tolerances[self._mud_masked].shares
        squares = float(shares.dot(shares))
        return sqrt(total(self.system.comm, squares) / self._rows)

    def _advance(self, t: float) -> float:
        while self._stop - t > END_TOLERANCE * max(1.0, abs(self._stop)):
            t = self._step(t, self._next_step)
            if self.stopped:
                break
        return t

    def _step(self, t: float, h: float) -> float:
        """Take one step from ``t`` [s], of about ``h`` [s], not beyond the next stop; return the time reached [s]."""
        rejected, stop = 0, self._stop
        if self._frozen is not None:
            h = self._frozen_step()
        while True:
            left = stop - t
            if h >= left * (1 - STRETCH) or left - h < SHORTEST_STEP:
                h = left
            # two equal steps to the stop instead of a whole one and a short remainder
            elif left < 2 * h and not self._fixed:
                h = 0.5 * left
            end = stop if h == left else t + h
            reason = self._solve_step(end, h)
            if reason >= 0 and self.alpha.step == 0.0:
                # the first step gives the derivative by which a_0 leads, and is then repeated
                if self.follower is not None:
                    self.follower.stage(end, h)
                self.alpha.lead_by_trial()
                reason = self._solve_step(end, h)
            if reason < 0:
                h = self._after_failure(reason, t, h)
                rejected += 1
                continue
            self._consecutive_failures = 0
            if self._eventful and h > EVENT_STEP and self._events():  # shorter steps lead up to the event
                h, rejected = max(FAILURE_FACTOR * h, 0.5 * EVENT_STEP), rejected + 1
                self.counters.rejected += 1
                self._load()
                continue
            error = 0.0 if self._fixed else self._error()
            if error <= 1.0 or h <= self.shortest:
                break
            rejected += 1
            self.counters.rejected += 1
            self._load()
            if not isfinite(error) or rejected > self.max_rejections:
                raise self.failure(f"the time integrator stopped: {rejected} rejected steps in a row")
            safety = self.safety * (REPEATED if rejected > 1 else 1.0)
            h = max(self.shortest, h * max(self.clip[0], min(self.safety, safety * error ** (-1 / 3))))
        self.alpha.accept()
        factor = 1.0
        if not self._fixed:
            now = max(error, SMALLEST_ERROR)
            factor = self.safety * now**BY_ERROR * self._earlier_error**BY_EARLIER
            # right after a rejection the step does not grow
            factor = max(self.clip[0], min(1.0 if rejected else self.clip[1], factor))
            self._earlier_error = now
        self._next_step = min(self.longest, h * factor)
        if self._fixed:
            self._next_step = min(self.first_step, 2 * h) if rejected else self.first_step
        self.last_step, self._last = end - self._last, end
        self.counters.steps += 1
        self._step_number += 1
        self._finish(self.last_step)
        return end

    def _after_failure(self, reason: int, t: float, h: float) -> float:
        """Return the step [s] after one of ``h`` [s] in which Newton failed."""
        self.counters.rejected += 1
        self._load()
        self._last = t
        self._count_failure(reason, h)
        return FAILURE_FACTOR * h

    def _finish(self, dt: float) -> None:
        k = int((log2(dt) - FIRST_OCTAVE) * CLASSES_PER_OCTAVE)
        k = min(max(k, 0), CLASSES - 1)
        self._step_time[0, k] += dt
        self._step_time[1, k] += dt * dt
        if self._monitored:
            print(f"{self.counters.steps} TS dt {dt:g} time {self._last:g}", flush=True)
        super()._finish(dt)

    def _keep_step(self, restarted: bool) -> None:
        # a hole that grows after a step
        self.alpha.arrays["x"][:] = self.system.assembly.x[: self.system.layout.size]

    def _reframe(self, earlier: FloatArray) -> None:
        """Measure spin angles from new reference directions, after the ``earlier`` ones (nv, 3), and continue their formula."""
        asm = self.system.assembly
        present, after = asm.reference.copy(), self.begin.second_derivative()
        asm.reference[:] = earlier
        before = self.begin.second_derivative()
        asm.reference[:] = present
        # only spin angles and their derivatives change, so the formula continues (manual: sec-time-alpha-start)
        q = self.alpha.arrays
        change = after - before
        q["second"] += change
        q["ax"] += change
        q["rate"][:] = np.where(self.alpha.second_order, self.begin.rate_of_unknowns(), 0.0)
        self.newton.discard_factor()
        self.fresh = True

    # ------------------------------------------------------------------ run
    def _take_up(self, at_break: bool) -> None:
        if self._restored is not None:
            self._restore(self._restored, at_break)

    def _begin(self, t: float, first: bool, at_break: bool, at_sample: bool) -> None:
        if self._restored is not None:
            first, self._restored = False, None
        if not first and not at_break:
            if at_sample:
                self._let_forces_jump(t)
            return
        if at_sample and self.sampler is not None:
            self.sampler(t)
        jump = self._jump_rates(t, 1)
        if (
            jump
        ):  # free velocities change by the impulse of the prescribed ones (manual: sec-time-alpha-start)
            self.begin.jump(t)
        self._begin_formula(t)
        if self.follower is not None:
            self.follower.start(t, jump)
        if self._fixed or jump or first:
            self._next_step = self.first_step

    def _begin_formula(self, t: float) -> None:
        """Begin at the assembly's positions and rates at ``t`` [s], with accelerations from the equations; collective."""
        asm, n = self.system.assembly, self.system.layout.size
        self.newton.discard_factor()
        # without true accelerations at the start the order is 1 (manual: sec-time-alpha-start)
        self.begin.accelerations(t)
        self.alpha.start(
            asm.x[:n],
            asm.y[:n],
            asm.a[:n],
            self.begin.rate_of_unknowns(),
            self.begin.second_derivative(),
        )
        self.newton.discard_factor()
        self.fresh, self._earlier_error = True, 1.0

    def _let_forces_jump(self, t: float) -> None:
        """Call the sampler at ``t`` [s], and let the accelerations jump by what its forces change; collective."""
        assert self.sampler is not None
        asm, n = self.system.assembly, self.system.layout.size
        rows = self.begin.rows(t)
        self.sampler(t)
        change = self.begin.rows(t) - rows
        if not total(self.system.comm, float(np.abs(change).max(initial=0.0))):
            return
        for call in self.after_sample:
            call(t)
        # with multipliers the jump of the accelerations is not one linear solve (manual: sec-time-alpha-jump)
        if self.system.multipliers:
            self._begin_formula(t)
            return
        # positions and velocities do not jump: the history is kept, and with it order 2 (manual: sec-time-alpha-jump)
        jump, second = self.begin.response(t, change), self.begin.second_derivative()
        asm.a[:n] += np.where(self.alpha.second_order, jump, 0.0)
        self.alpha.jump(jump, self.begin.second_derivative() - second)
        self._load()
        self.newton.discard_factor()

    def _restart_after_event(self, t: float) -> None:
        """Begin the formula again after a law has changed at ``t`` [s]."""
        self._begin_formula(t)
        self._next_step = self.first_step

    def close(self) -> None:
        """Free the vectors of PETSc; the integrator cannot be used afterwards."""
        self.state.destroy()

    def output_errors(self) -> OutputErrors:
        """Return the errors of the formula in outputs."""
        return AlphaOutputErrors(self.formula)

    def damped_above(self) -> float | None:
        """Frequency [Hz] above which the formula takes more than ``LOSS`` of an amplitude in a period.

        It belongs to the median of the steps by time.  None at radius 1, and before the first step.
        """
        product, (spent, moment) = self.damped_product(), self._step_time
        if product is None or not spent.any():
            return None
        passed = np.cumsum(spent)
        k = int(np.searchsorted(passed, 0.5 * passed[-1]))
        return float(product * spent[k] / moment[k])

    def damped_product(self) -> float | None:
        """Product of that frequency and the step [-]; None at radius 1."""
        product = self.formula.damped_product
        return None if product is None else product / (2 * np.pi)

    # ------------------------------------------------------------------ checkpoints
    def get_state(self) -> dict[str, FloatArray]:
        """Return the data that a restart needs besides the state; complete on rank 0; collective.

        alpha_clock: next step, last step [s], number of steps, coming steps over a jump, whether the mud has no
        error control, last error, spectral radius.
        alpha: (len(ARRAYS), nodes, m) history of all fields; alpha_steps: (2, CLASSES) sums of steps by class.
        """
        clock = [
            self._next_step,
            self.alpha.step,
            self._step_number,
            self._steps_over_jump,
            self._mud_masked,
            self._earlier_error,
            self.formula.radius,
        ]
        state = {"alpha_clock": np.array(clock, dtype=float)} | self.newton.get_state() | self._work_state()
        state["alpha_steps"] = self._step_time.copy()
        if self.alpha.begun:
            parts = [nodal(self.system, self.alpha.arrays[key]) for key in ARRAYS]
            gathered = self.system.gather(np.stack(parts, axis=1))
            if gathered is not None:
                state["alpha"] = np.moveaxis(gathered, 0, 1)
        return state

    def set_state(self, state: dict[str, FloatArray]) -> None:
        """Continue from a checkpoint with the next ``run``: ``state`` as returned by ``get_state``.

        With the checkpoint of another integrator, or another spectral radius, the formula restarts.
        """
        if self.work is not None:
            self.work.set_state(state)
        # algorithmic accelerations belong to one spectral radius
        if "alpha" in state and float(state["alpha_clock"][6]) == self.formula.radius:
            self._restored = state
        if self.estimate is not None:
            self.estimate.set_state(state)

    def _restore(self, state: dict[str, FloatArray], at_break: bool) -> None:
        clock, n = state["alpha_clock"], self.system.layout.size
        self._next_step = float(clock[0])
        self._step_number, self._steps_over_jump = int(clock[2]), int(clock[3])
        self._mud_masked, self._earlier_error = bool(clock[4]), float(clock[5])
        self._step_time = np.array(state["alpha_steps"])
        empty = np.zeros(n)
        values = np.array([local(self.system, row, empty) for row in state["alpha"]])
        self.alpha.restore(float(clock[1]), values)
        if at_break:  # the formula starts from the assembly's state, in which others than the checkpoint's may have begun
            self.system.assembly.a[:n] = self.alpha.arrays["w"]
        else:
            self._load()
        self.fresh = self.alpha.step == 0.0
        self.newton.set_state(state)


def integrator_class() -> type[TimeIntegrator]:
    """Return the class that -ts_type selects."""
    return GeneralizedAlpha if selected() else TimeIntegrator


def selected() -> bool:
    """Whether -ts_type selects generalised-alpha."""
    return PETSc.Options().getString("ts_type", "bdf") in NAMES


def _formula(options: PETSc.Options) -> AlphaFormula:
    """Return the formula of -ts_alpha_radius, or of PETSc's parameters one by one."""
    names = ("alpha_m", "alpha_f", "gamma", "beta")
    given = {n: options.getReal(f"ts_alpha_{n}") for n in names if options.hasName(f"ts_alpha_{n}")}
    try:
        if not given:
            return AlphaFormula(options.getReal("ts_alpha_radius", RADIUS))
        if options.hasName("ts_alpha_radius"):
            raise ValueError("-ts_alpha_radius and the single parameters exclude each other")
        if "alpha_m" not in given or "alpha_f" not in given:
            raise ValueError("alpha_m and alpha_f are both needed")
        return AlphaFormula(radius_of(**given))
    except ValueError as error:
        raise OptionError(
            at="petsc.ts_alpha_radius" if not given else "petsc.ts_alpha_alpha_m, ts_alpha_alpha_f",
            got=", ".join(f"{value:g}" for value in given.values()),
            want="-ts_alpha_radius from 0 to 1, or parameters of one radius",
            hint=str(error),
        ) from None
