"""A model that is advanced step by step from Python, with inputs set and outputs read in between.

Manual: sec-session.
"""

from __future__ import annotations

import time as clock
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from petsc4py import PETSc

from drillpetsc.analysis.motion import checkpoint
from drillpetsc.analysis.motion.initial_state import initial_state
from drillpetsc.analysis.motion.integrator_choice import make_integrator
from drillpetsc.analysis.motion.session.live_input import LiveInput
from drillpetsc.analysis.motion.session.live_outputs import LiveOutputs, LiveSensors, SessionOutput, unknown
from drillpetsc.case.case import Case
from drillpetsc.case.options.case_inputs import SessionInput, describe, inputs_of, with_inputs
from drillpetsc.doubts import doubts_at
from drillpetsc.doubts.moments import Start
from drillpetsc.errors import CaseError
from drillpetsc.model.drilling_model import build_model, is_quasi_static
from drillpetsc.output.recorder import Recorder
from drillpetsc.solvers import petsc_options as options
from drillpetsc.units import UnitError, to_si

#: jump of an input, as a fraction of its largest value so far, from which the time formula restarts
JUMP = 0.05
FACTOR_WINDOW = 1.0  # simulated time over which ``Session.factor`` is measured [s]


@dataclass(frozen=True)
class SessionState:
    """State of a session: a checkpoint with the inputs that were set."""

    checkpoint: checkpoint.Checkpoint
    inputs: dict[str, list[float] | None]
    largest: dict[str, float]
    sensed: dict[str, float] = field(default_factory=dict)
    jumped: bool = False


@dataclass(frozen=True)
class StepReport:
    """What ``Session.step_until`` reached: the time [s], and whether the wall time ended the step before its end."""

    time: float
    late: bool


class Session:
    """A model that is advanced step by step.

    case: a Case, the path of a case file, or a run folder whose checkpoint is continued.
    estimate_error: estimate the time error of the main outputs at every inner step, for ``error_estimate``.
    interpolate: ``held``, an input is constant from its ``set`` on; ``linear``, it goes to the new value over the next step.
    comm: PETSc communicator, all ranks by default; then every call is collective.

    Raises CaseError for bad input and SolveError if no static state is found or no step can be taken.  A session is a
    context manager; ``close`` frees its memory.
    """

    def __init__(
        self,
        case: Case | str | Path,
        *,
        interpolate: str = "held",
        estimate_error: bool = False,
        comm: PETSc.Comm | None = None,
    ) -> None:
        if interpolate not in ("held", "linear"):
            raise CaseError(at="interpolate", got=interpolate, want="held or linear")
        comm = comm or PETSc.COMM_WORLD
        case, saved = _loaded(case, comm)
        if case.time is not None and is_quasi_static(case):
            raise CaseError(at="time.mode", got="quasi_static", want="dynamic in a session")
        self._linear, self._waiting = interpolate == "linear", dict[str, float]()
        with options.applied(case.petsc):
            self._given = inputs_of(case)
            self._live = {name: LiveInput(given) for name, given in self._given.items()}
            self._model = build_model(with_inputs(case, self._live), comm)
            self._recorder = Recorder(self._model)
            self._model.case = case  # checkpoints hold the case as it was given
            self._integrator = make_integrator(self._model)
        self.time = saved.time if saved is not None else 0.0
        initial_state(self._model, case, saved, None)
        if saved is not None:
            self._integrator.set_state(saved.stepper)
        self.warnings = doubts_at(Start(model=self._model, continued=saved is not None))
        sensors = self._recorder.sensors
        self._senses = None if sensors is None else LiveSensors(sensors, self.time, saved)
        self._largest = {name: abs(live.value(self.time)) for name, live in self._live.items()}
        self._started, self._jumped = False, False
        self._wall: deque[tuple[float, float]] = deque()
        self._deadline, self._closed = np.inf, False
        self._outputs = LiveOutputs(self._recorder)
        if self._senses is not None:
            self._integrator.after_step.append(self._sense)
        self._estimated_from = self.time
        if estimate_error:
            formula = self._integrator.output_errors()
            if formula is None:
                raise CaseError(
                    at="estimate_error", got="True", want="False: this time integrator has no estimate"
                )
            self._recorder.estimate_time_error(formula)
            self._integrator.after_step.append(self._count_error)
        self._integrator.on_step_end.append(self._watch)

    # ------------------------------------------------------------------ what there is
    @property
    def inputs(self) -> tuple[SessionInput, ...]:
        """Inputs that ``set`` takes."""
        return tuple(describe(self._model.case, name) for name in self._live)

    @property
    def outputs(self) -> tuple[SessionOutput, ...]:
        """Outputs that ``get`` gives."""
        sensed = self._senses.outputs if self._senses is not None else {}
        return self._outputs.described() + tuple(SessionOutput(n, *about) for n, about in sensed.items())

    @property
    def factor(self) -> float:
        """Simulated time over wall time of the steps of the last simulated second; nan before the first step."""
        if not self._wall:
            return float("nan")
        simulated, wall = (sum(q[k] for q in self._wall) for k in (0, 1))
        return simulated / wall if wall > 0 else float("inf")

    @property
    def error_estimate(self) -> dict[str, Any]:
        """Estimated time error of the main outputs since the start, as `error_estimate.outputs` of a run's summary; collective.

        Raises ValueError in a session without ``estimate_error``.
        """
        self._check_open()
        estimate = self._recorder.time_error
        if estimate is None:
            raise ValueError("error_estimate: open the session with estimate_error=True")
        return {"since": self._estimated_from, **estimate.summary(), "damped_above": estimate.damped_above()}

    # ------------------------------------------------------------------ inputs and outputs
    def set(self, name: str, value: float | str) -> None:
        """Set an input from now on: a number in SI, or text with a unit such as ``60 rpm``.

        Raises LookupError for an unknown name and ValueError for a value outside the range of the input.
        """
        self._check_open()
        live = self._live.get(name)
        if live is None:
            raise LookupError(unknown("set", "input", name, self._live))
        about = describe(self._model.case, name)
        try:
            value = to_si(value, about.unit)
        except UnitError as error:
            raise ValueError(f"set: {name} cannot be {error.got!r}; allowed: {error.want}") from None
        least = about.minimum
        if least is not None and value < least:
            raise ValueError(f"set: {name} cannot be {value:g} {about.unit}; allowed: at least {least:g}")
        if self._linear:
            self._waiting[name] = value
            return
        jump = live.set(self.time, value)
        self._jumped |= abs(jump) > JUMP * max(self._largest[name], abs(value))
        self._largest[name] = max(self._largest[name], abs(value))
        self._outputs.changed()

    def get(self, name: str) -> float:
        """An output at the present time, in SI.  Raises LookupError for an unknown name."""
        return self.get_many([name])[0]

    def get_many(self, names: Iterable[str]) -> list[float]:
        """Several outputs at the present time, in SI.  Raises LookupError for an unknown name."""
        self._check_open()
        names, latest = list(names), {} if self._senses is None else self._senses.latest
        others = [name for name in names if name not in latest]
        found = iter(self._outputs.read(self._outputs.find(others, latest), self.time))
        return [latest[name] if name in latest else next(found) for name in names]

    # ------------------------------------------------------------------ time
    def step(self, dt: float) -> None:
        """Advance by ``dt`` [s], which is met exactly, in steps that the integrator chooses."""
        if not (np.isfinite(dt) and dt > 0):
            raise ValueError(f"step: dt must be above 0 s, not {dt:g}")
        self._advance(self.time + float(dt))

    def step_until(self, t: float, wall_budget: float = np.inf) -> StepReport:
        """Advance to the time ``t`` [s], or until ``wall_budget`` [s] of wall time are over, after whole inner steps."""
        if not (np.isfinite(t) and t > self.time):
            raise ValueError(f"step_until: t must be above the present time, {self.time:g} s, not {t:g}")
        self._deadline = clock.perf_counter() + wall_budget
        try:
            self._advance(float(t))
        finally:
            self._deadline = np.inf
        return StepReport(self.time, self.time < t)

    def _count_error(self, t: float, dt: float) -> None:
        """After every inner step: add its local error to the estimate."""
        integrator = self._integrator
        self._recorder.count_time_error(t, dt, integrator.input_time(t), integrator.fresh)

    def _sense(self, t: float, dt: float) -> None:
        """After every inner step: record it for the sensors."""
        assert self._senses is not None
        self._senses.step(t, dt, self._integrator.fresh)

    def _watch(self, t: float) -> None:
        """After every inner step: end the advance if its wall time is over; the first rank decides."""
        self.time = t
        if self._senses is not None and self._integrator.fresh:  # in other reference frames
            self._senses.renew()
        if self._deadline == np.inf:
            return
        late = clock.perf_counter() > self._deadline
        if self._recorder.comm.size > 1:
            late = self._recorder.comm.bcast(late)
        if late:
            self._integrator.stop()

    def _advance(self, end: float) -> None:
        self._check_open()
        start, began = self.time, clock.perf_counter()
        for name, value in self._waiting.items():
            self._live[name].set(start, value, end)
        self._waiting.clear()
        integrator = self._integrator
        integrator.stopped = False
        breaks = self._model.breaks
        if self._jumped:
            breaks = (*breaks, start)
        integrator.run(start, end, breaks, resume=self._started)
        self._started, self._jumped = True, False
        self._outputs.changed()
        if self._senses is not None:
            self._senses.take()
        if not integrator.stopped:
            self.time = end
        self._wall.append((self.time - start, clock.perf_counter() - began))
        while len(self._wall) > 1 and sum(q[0] for q in list(self._wall)[1:]) >= FACTOR_WINDOW:
            self._wall.popleft()

    # ------------------------------------------------------------------ state
    def state(self) -> SessionState:
        """The whole state, for ``set_state`` of this session; collective."""
        self._check_open()
        c = checkpoint.take(self._model, self._recorder, self._integrator, self.time)
        if self._recorder.comm.size > 1:
            c = self._recorder.comm.bcast(c)
        assert c is not None
        c = checkpoint.lasting(c)
        sensed = {} if self._senses is None else dict(self._senses.latest)
        return SessionState(
            c, {n: q.get_state() for n, q in self._live.items()}, dict(self._largest), sensed, self._jumped
        )

    def set_state(self, state: SessionState) -> None:
        """Go back to a ``state`` of this session; the steps that follow repeat the earlier ones to the last bit.

        Raises TypeError for anything but the result of ``state``, CaseError for a state of another string and
        ValueError for one with other inputs.
        """
        self._check_open()
        if not isinstance(state, SessionState):
            raise TypeError(
                f"set_state: {type(state).__name__} is not a state; allowed: what state() returned"
            )
        if state.inputs.keys() != self._live.keys():
            raise ValueError(
                f"set_state: the state has the inputs {', '.join(state.inputs) or 'none'}; "
                f"this session has {', '.join(self._live) or 'none'}"
            )
        c = state.checkpoint
        checkpoint.restore(self._model, c, at="set_state")
        self._integrator.set_state(c.stepper)
        if self._senses is not None:
            self._senses.set_state(c, state.sensed)
        if self._recorder.time_error is not None:
            self._recorder.time_error.set_state(c.recorder)
        for name, live in self._live.items():
            live.set_state(state.inputs[name], self._given[name])
        self.time, self._largest = c.time, dict(state.largest)
        self._started, self._jumped = False, state.jumped
        self._outputs.changed()
        self._waiting.clear()

    def close(self) -> None:
        """Free the memory; a closed session refuses every call."""
        if self._closed:
            return
        self._closed = True
        self._integrator.close()
        del self._integrator, self._recorder, self._model, self._outputs, self._senses

    def _check_open(self) -> None:
        if self._closed:
            raise RuntimeError("the session is closed")

    def __enter__(self) -> Session:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _loaded(case: Case | str | Path, comm: PETSc.Comm) -> tuple[Case, checkpoint.Checkpoint | None]:
    """Case and, for a run folder, checkpoint."""
    from drillpetsc.case import load_case

    if isinstance(case, Case):
        return case, None
    path = Path(case)
    if not path.is_dir():
        return load_case(path), None
    return load_case(path / "case.yaml"), checkpoint.read(path / "checkpoint.h5")
