"""A whole run: from a case to a run folder."""

from __future__ import annotations

import sys
import time as clock
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np
from petsc4py import PETSc

from drillpetsc.analysis.motion import checkpoint, provenance, summary
from drillpetsc.analysis.motion.checkpoint import ROUNDING, check_restart, is_finished, saved_state
from drillpetsc.analysis.motion.initial_state import begin_new_states, initial_state
from drillpetsc.analysis.motion.integrator_choice import make_integrator, whirl_steps_of
from drillpetsc.analysis.motion.memory import Memory, give_back
from drillpetsc.analysis.motion.quasi_static import QuasiStatic
from drillpetsc.analysis.motion.run_control import (
    FAILED,
    NOTHING,
    STOP,
    WRITE,
    RunControl,
)
from drillpetsc.analysis.motion.time_scales import time_scales
from drillpetsc.analysis.statics.answer import flow_summary
from drillpetsc.analysis.statics.checks.freed_weight import freed_weight
from drillpetsc.analysis.statics.equilibrium import StaticState
from drillpetsc.analysis.statics.placement import motion_of_top
from drillpetsc.case.blocks.settings import STARTS
from drillpetsc.case.case import Case
from drillpetsc.case.quantities import largest
from drillpetsc.doubts import doubts_at
from drillpetsc.doubts.moments import End, Start
from drillpetsc.doubts.motion import FREED_WEIGHT
from drillpetsc.doubts.state import top_push
from drillpetsc.errors import RESTART_HINT, CaseError, Interrupted, SolveError, cannot_write
from drillpetsc.model.drilling_model import DrillingModel, build_model, is_quasi_static
from drillpetsc.output import RunFolder, read_summary, write_summary
from drillpetsc.output.balances.energy_balance import EnergyBalance, EnergyGainMonitor
from drillpetsc.output.files.run_folder import make_folder
from drillpetsc.output.files.run_writer import RunWriter, after, passed
from drillpetsc.output.files.well_files import write_well_files
from drillpetsc.output.indices import indices
from drillpetsc.output.job import RunResult
from drillpetsc.output.measured.motion_classes import MotionClasses
from drillpetsc.output.progress import Progress, Receiver, check_progress
from drillpetsc.output.recorder import Recorder
from drillpetsc.output.watches.monitors import Monitors
from drillpetsc.parallel import first_rank_does
from drillpetsc.solvers import petsc_options as options
from drillpetsc.solvers.time.local_error import LocalErrorEstimate
from drillpetsc.solvers.time.time_integrator import TimeIntegrator


def run(
    case: Case | str | Path,
    out: str | Path | None = None,
    *,
    restart: bool = False,
    overwrite: bool = False,
    accept_changes: bool = False,
    name: str | None = None,
    comm: PETSc.Comm | None = None,
    progress: str | Receiver = "auto",
    watch_motion: bool = False,
) -> RunResult:
    """Simulate a case and write its run folder; collective over ``comm``.

    case: a Case, or the path of a case file.
    out: the run folder; None: a new folder named after the case.
    restart: continue from the checkpoint in ``out``; overwrite: replace the results in ``out``.
    accept_changes: continue although the case, the PETSc options or the version of drillpetsc have changed.
    name: of the case, for the folder's name.
    progress: auto, live, log or silent, or a function of (share done, text) that the first rank calls.
    watch_motion: add the classes of motion to the summary, as `motion`; not with ``restart``.

    Raises CaseError for bad input, before anything is written, and SolveError for a failed computation, whose files stay.
    """
    comm = comm or PETSc.COMM_WORLD
    check_progress(progress, ("auto", "live", "log", "silent"))
    if not isinstance(case, Case):
        from drillpetsc.case import load_case

        name, case = name or Path(case).stem, load_case(case)
    if watch_motion and restart:
        raise CaseError(at="--check-tolerance", want="a run from its start: no --restart")
    if case.time is None:
        raise CaseError(
            at="time", want="a block {end: ...}", hint="for the static state alone use: drillpetsc statics"
        )
    began = clock.perf_counter(), clock.process_time()
    with options.applied(case.petsc) as used:
        options.refuse_integrator_of_run(PETSc.Options().getAll())
        model = build_model(case, comm)
        quasi = QuasiStatic(model) if is_quasi_static(case) else None
        recorder, integrator = Recorder(model), make_integrator(model, quasi)
        gain = EnergyGainMonitor(recorder.energy)
        options.refuse_unread(used)
        folder = make_folder(comm, name or "case", out, restart, overwrite)
        try:
            saved = saved_state(comm, folder, restart)
            accepted = check_restart(comm, saved, folder, case, recorder, integrator, accept_changes)
            if saved is not None and is_finished(saved.time, case.time.end):
                done = _result_of_finished_run(comm, folder)
                if done is not None:
                    return done
            if restart and saved is None and comm.rank == 0 and progress != "silent":
                print(
                    f"{folder.path}: no checkpoint yet, so the run starts from its beginning", file=sys.stderr
                )
            state = initial_state(model, case, saved, quasi)
            afresh = saved is not None and bool(accepted) and begin_new_states(model, saved.time)
            give_back()
            return TransientRun(
                model=model,
                recorder=recorder,
                integrator=integrator,
                gain=gain,
                folder=folder,
                saved=saved,
                notes=_notes(saved, state, quasi, accepted),
                fixed_step=_fixed_step(integrator, quasi),
                began=began,
                progress=progress,
                watch_motion=watch_motion,
                afresh=afresh,
            ).run()
        finally:
            folder.release()


def _result_of_finished_run(comm, folder: RunFolder) -> RunResult | None:
    """Result of a run that has reached its end; None if its summary is not written yet; collective."""
    found: dict[str, Any] | None = None
    if comm.rank == 0 and folder.summary.is_file():
        with suppress(CaseError):  # a damaged one is written again
            found = read_summary(folder.summary)
    found = comm.tompi4py().bcast(found)
    if found is None or found.get("status") != "done":
        return None
    return RunResult(folder.path, found | {"nothing_left": True})


def _notes(
    saved: checkpoint.Checkpoint | None,
    state: StaticState | None,
    quasi: QuasiStatic | None,
    accepted: list[str],
) -> dict[str, Any]:
    """Notes that the summary reports and checkpoints keep.

    accepted: changes since the checkpoint that the user has accepted.
    """
    notes = dict(saved.notes) if saved is not None else summary.static_notes(state)
    if saved is not None and accepted:
        earlier = notes.get("accepted_changes", [])
        notes["accepted_changes"] = [*earlier, *(f"at {saved.time:.6g} s: {text}" for text in accepted)]
    return notes | ({"share": quasi.lateral_fraction} if quasi is not None else {})


def _fixed_step(integrator: TimeIntegrator, quasi: QuasiStatic | None) -> float | None:
    """The step [s] of an integrator with fixed steps; None if steps are adapted, or without inertia."""
    fixed = integrator.options.get("ts_adapt_type") == "none" and quasi is None
    return integrator.first_step if fixed else None


@dataclass(kw_only=True)
class TransientRun:
    """The motion from the start, or from a checkpoint, to the end, with its files.

    saved: checkpoint that is continued, None at a start.
    notes: for the summary and for checkpoints.
    fixed_step: [s] of an integrator with fixed steps.
    began: wall and processor clock at the start of the program [s].
    watch_motion: find the classes of motion.
    afresh: a continued run has other states than its checkpoint, so that the time formula begins without its history.
    """

    model: DrillingModel
    recorder: Recorder
    integrator: TimeIntegrator
    gain: EnergyGainMonitor
    folder: RunFolder
    saved: checkpoint.Checkpoint | None
    notes: dict[str, Any]
    fixed_step: float | None
    began: tuple[float, float]
    progress: str | Receiver
    watch_motion: bool = False
    afresh: bool = False

    def __post_init__(self) -> None:
        self.case, self.mpi = self.model.case, self.model.system.comm.tompi4py()
        self.first = self.mpi.rank == 0
        self.start = self.t = self.saved.time if self.saved is not None else 0.0
        self.end = float(self.case.given_time.end)
        start = self._doubtful_start()
        self.notes["warnings"] = doubts_at(start)
        self._pushed_at_start = bool(top_push.look(start))
        self.monitors = Monitors(self.model)
        if self.saved is not None:
            self.monitors.set_notes(self.saved.notes.get("monitors", {}))
        else:
            self.monitors.update(0.0)
        self.classes = MotionClasses(self.model, 0.5 * self.end) if self.watch_motion else None
        self.whirl = whirl_steps_of(self.model, self.integrator)
        self.newton, self.moving_since = 0, self.began
        mode: Any = self.progress if self.first else "silent"
        self.bar = Progress(self.end, self.start, mode=mode)
        self.control = RunControl(self.mpi)

    def _doubtful_start(self) -> Start:
        """What is known before the first step; collective."""
        model, saved, from_statics = self.model, self.saved, self.case.initial.from_ == "statics"
        from_run = saved is None and self.case.initial.from_ not in STARTS
        return Start(
            model=model,
            figures={"hook_load": -model.system.reaction("top.axial_reaction"), **flow_summary(model)}
            if saved is None and from_statics
            else {},
            fixed_step=self.fixed_step,
            impact=np.inf if self.fixed_step is None else time_scales(model).impact,
            freed_weight=freed_weight(model, FREED_WEIGHT) if saved is None and from_statics else None,
            libraries=() if saved is None else provenance.changed_libraries(saved.provenance),
            continued=saved is not None,
            accepted=bool(self.notes.get("accepted_changes")),
            found=motion_of_top(model) if from_run and not is_quasi_static(self.case) else None,
        )

    def run(self) -> RunResult:
        """Compute all steps; files that were written stay even if the computation fails."""
        integrator, recorder, saved = self.integrator, self.recorder, self.saved
        formula = integrator.output_errors()
        if (
            formula is not None and integrator.inertia
        ):  # without inertia the outputs follow the inputs at once
            recorder.estimate_time_error(formula)
        self.estimate = LocalErrorEstimate(integrator)
        if saved is not None:
            recorder.set_state(saved.recorder)
            integrator.set_state(saved.stepper)
        else:
            recorder.start(0.0)
        first_rank_does(self.mpi, str(self.folder.path), self._open)
        if not self.first:
            self._open()
        integrator.after_step.append(self._after_step)
        if recorder.energy is not None:
            integrator.at_jump.append(partial(recorder.tell_energy, EnergyBalance.at_jump))
            integrator.after_sample.append(partial(recorder.tell_energy, EnergyBalance.after_sample))
            integrator.before_event.append(partial(recorder.tell_energy, EnergyBalance.before_event))
            integrator.after_event.append(partial(recorder.tell_energy, EnergyBalance.after_event))
        integrator.on_step_end.append(self._finish_step)
        integrator.on_failure.append(recorder.catch_up)
        self.memory = Memory(self.mpi, self.start, self.end)
        self._warn(self.notes["warnings"])
        self.moving_since = clock.perf_counter(), clock.process_time()
        error: BaseException | None = None
        try:
            with self.control:
                if saved is None:
                    self.writer.write(0.0, 0.0, 0, self.control)
                    self._save(0.0)
                self._move()
        except BaseException as failure:
            error = failure
            raise
        finally:
            result = self._close(error)
        integrator.close()  # PETSc's solver holds the run by its callbacks, where Python's collector does not see it
        return RunResult(self.folder.path, result)

    def _warn(self, warnings: list[str]) -> None:
        if self.first and self.progress != "silent":
            for warning in warnings:
                self.bar.message(f"warning: {warning}")

    def _open(self) -> None:
        self.writer = RunWriter(
            self.model,
            self.recorder,
            self.folder if self.first else None,
            None if self.saved is None else self.start,
        )
        if self.saved is not None:
            self.writer.last_row = self.saved.notes["last_row"]
            self.writer.watch.set_notes(self.saved.notes.get("watch", {}))
        if self.first:
            if self.saved is None:
                _write_model(self.model, self.folder)
            else:  # with a later end, or accepted changes
                self.folder.write_case(self.model.case)

    def _move(self) -> None:
        """Compute all steps.  The integrator passes the times of checkpoints, or stops there if its formula cannot be
        restored at other times."""
        every, end = self._checkpoint_interval, self.end
        if is_finished(self.start, end):
            return
        k = after(self.start, every)
        stops = (
            []
            if self.integrator.keeps_history
            else [j * every for j in range(k, after(end, every)) if j * every < end * (1 - ROUNDING)]
        )
        self.next_save = k
        breaks = (*self.model.breaks, *((self.start,) if self.afresh else ()))
        for stop in [*stops, end]:
            try:
                self.integrator.run(self.t, stop, breaks)
            finally:
                self.memory.end()
            if self.integrator.stopped:
                self.recorder.end_at(self.t)
                raise Interrupted(self.control.name, self.t, self.folder.path)
            self._save(stop)

    @cached_property
    def _checkpoint_interval(self) -> float:
        """Simulated time between two checkpoints [s]."""
        every = self.case.output.checkpoint_every
        assert every is not None  # a default fills it
        return float(every)

    def _after_step(self, t: float, dt: float) -> None:
        self._record(t, dt)
        self.memory.update(t)
        self.bar.update(t, self.integrator.counters.steps, dt)

    def _record(self, t: float, dt: float) -> None:
        """Sample the step, and write the rows that are due."""
        recorder, integrator, writer = self.recorder, self.integrator, self.writer
        recorder.step(
            t, dt, writer.next_row_time, integrator.input_time(t), integrator.fresh, integrator.next_step
        )
        if integrator.jumped:
            recorder.tell_energy(EnergyBalance.add_impulse_work, t)
        if self.classes is not None:
            self.classes.step(t, dt)
        newton = integrator.newton_iterations()
        self.due = writer.write(t, dt, newton - self.newton, self.control)
        if recorder.sensors is not None and recorder.sensors.step(t, dt, integrator.fresh):
            writer.write_samples(self.control)
        self.monitors.update(t)
        if self.due:
            self.monitors.share()
        self.t, self.newton = t, newton

    def _finish_step(self, t: float) -> None:
        """After all calls of a step: act on signals and write errors, write a checkpoint that is due."""
        if self.recorder.sensors is not None and self.integrator.fresh:  # in other reference frames
            self.recorder.sensors.renew()
        # one rank has written what was overdue
        overdue = self.mpi.size > 1 and self.writer.is_overdue
        every, asked = self._checkpoint_interval, self.control.poll(self.due, overdue)
        if asked == WRITE:
            self.writer.write_waiting(self.control)
            asked = NOTHING
        if asked == FAILED:
            self.recorder.catch_up()
            reported = self.mpi.allreduce(self.control.error)  # a text on one rank only
            raise SolveError(reported, time=t, hint=RESTART_HINT)
        due = (
            self.integrator.keeps_history
            and passed(self.next_save * every, t)
            and t < self.end * (1 - ROUNDING)
        )
        if due or asked != NOTHING:
            self._save(t)
        if due:
            self.next_save = after(t, every)
        if self.due and self.gain.stops:
            self.recorder.catch_up()
            self.gain.check(t)
        if asked == STOP:
            self.integrator.stop()
        elif self.integrator.counters.steps >= self.integrator.max_steps and not is_finished(t, self.end):
            self._save(t)
            raise SolveError(
                f"the run has taken the {self.integrator.max_steps} steps of -ts_max_steps before its end at {self.end:.6g} s",
                time=t,
                hint="--restart continues; a larger -ts_max_steps, or none, takes it further",
            )

    def _save(self, t: float) -> None:
        """Write a checkpoint; collective."""
        self.recorder.catch_up()
        self.monitors.share()
        self.writer.write_samples(self.control)
        self.notes["last_row"], self.notes["monitors"] = self.writer.last_row, self.monitors.get_notes()
        c = checkpoint.take(self.model, self.recorder, self.integrator, t, self.notes)

        def put() -> None:
            assert c is not None
            self.writer.flush()
            c.notes["watch"] = self.writer.watch.get_notes()  # of all rows, which are written now
            c.notes["tables"] = self.writer.written
            checkpoint.write(self.folder.checkpoint, c)

        first_rank_does(self.mpi, str(self.folder.checkpoint), put, t)

    def _close(self, error: BaseException | None) -> dict[str, Any]:
        """Close the files and write the summary."""
        model, folder = self.model, self.folder
        if self.mpi.size == 1 or error is None:
            self.recorder.catch_up()
        else:  # another rank may not come here; after an error of all ranks nothing waits
            self.recorder.forget_waiting()
        if error is None and self.t > self.start:
            self.recorder.end_at(self.t)
        if error is not None and self.mpi.size == 1:
            self.writer.write_samples(self.control)
        self.writer.close()
        self.bar.finish(self.t, self.integrator.counters.steps)
        result = self._summary(error)

        def put() -> None:
            if model.drilling is not None:
                write_well_files(model, folder)
            if error is None and self.case.output.indices is not None and model.beam.moves:
                self._find_indices(result, *self.case.output.indices.span)
            write_summary(folder.summary, result)

        if error is None:
            first_rank_does(self.mpi, str(folder.summary), put, self.t)
        elif self.first:
            try:
                put()
            except OSError as failure:  # the run ends with a separate message
                self.bar.message(cannot_write(failure, str(folder.summary)))
            except SolveError:  # the folder is gone, which the error says already
                pass
        return result

    def _summary(self, error: BaseException | None) -> dict[str, Any]:
        """The results of the run, with all doubts about them; collective unless it ended with an error."""
        model = self.model
        clocks = summary.Clocks(self.began, self.moving_since)
        result = summary.run_summary(model, self.integrator, error)
        result |= summary.timing(self.integrator, clocks, self.start, self.t, error)
        work = self.integrator.work
        left = work.total_left() if work is not None and error is None else None
        if self.case.fluid is not None and self.case.fluid.formulation == "hermite":
            left = None  # the rest is not the time formula's alone (doubts/motion.py, unbalanced_volumes)
        result |= summary.outcome(model, self.recorder, self.notes, self.t, error, left)
        result |= self.estimate.as_dict(error is None) | {"memory": self.memory.as_dict(error is None)}
        damping_step = self._take_time_error(result)
        whirl = None
        if error is None:
            limited = self.whirl.summary(self.integrator.counters.steps)
            result |= {} if limited is None else {"steps_limited_by": limited}
            if damping_step is not None and self.integrator.step_limit is not self.whirl:
                whirl = self.whirl.damped(damping_step, largest(self.case.top.rotation))
        if self.classes is not None:
            result["motion"] = self.classes.summary()
        if self.recorder.sensors is not None:
            result["sensors"] = self.recorder.sensors.summary()
        if "energy" in result:
            result["energy"] |= self.gain.summary()
        said = doubts_at(
            End(
                model=model,
                time=self.t,
                finished=error is None,
                recorder=self.recorder,
                monitors=self.monitors,
                watch=self.writer.watch,
                gain=self.gain,
                pushed_at_start=self._pushed_at_start,
                whirl=whirl,
            )
        )
        self._warn(said)
        return result | {"warnings": [*result["warnings"], *said]}

    def _take_time_error(self, result: dict[str, Any]) -> float | None:
        """Write the known errors in time into the summary; returns the length of the steps [s] that damp short motions,
        None if unknown."""
        by_outputs, entry = self.recorder.time_error, result.get("error_estimate")
        if entry is not None and by_outputs is not None:
            entry |= {"outputs": by_outputs.summary(), "damped_above": by_outputs.damped_above()}
        frequency, product = self.integrator.damped_above(), self.integrator.damped_product()
        if frequency is not None:
            result["error_estimate"] = (entry or {}) | {"damped_above": frequency}
        elif by_outputs is not None:
            frequency, product = by_outputs.damped_above(), by_outputs.damped_product()
        return product / frequency if product is not None and frequency else None

    def _find_indices(self, result: dict[str, Any], window: float, every: float) -> None:
        """Write indices.csv and put the indices into the summary; a run without enough rows for them is done all the same."""
        try:
            found = indices(self.folder.path, self.case, window, every)
        except CaseError as error:
            warnings = [f"indices: none: {' '.join(str(error).split())}"]
        else:
            found.write(self.folder.path)
            result["vibration"], warnings = found.summary, found.warnings
        result["warnings"] = [*result["warnings"], *warnings]
        self._warn(warnings)


def _write_model(model: DrillingModel, folder: RunFolder) -> None:
    """Write the case and the hole at the start."""
    folder.write_case(model.case)
    write_well_files(model, folder)
