"""A whole run: from a case to a run folder."""

from __future__ import annotations

import sys
import time as clock
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from petsc4py import PETSc

from drillpetsc import petsc_compat
from drillpetsc.analysis import checkpoint, summary
from drillpetsc.analysis.initial_state import initial_state
from drillpetsc.analysis.memory import Memory
from drillpetsc.analysis.quasi_static import QuasiStatic
from drillpetsc.analysis.run_control import (
    FAILED,
    NOTHING,
    RESTART_HINT,
    STOP,
    RunControl,
    cannot_write,
    first_rank_does,
)
from drillpetsc.analysis.steady_flow import fluid_unknowns
from drillpetsc.analysis.time_scales import longest_strict_step, step_warnings
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError, Interrupted, SolveError
from drillpetsc.model.drilling_model import DrillingModel, build_model, is_quasi_static
from drillpetsc.output import FieldWriter, RunFolder, Table, write_summary
from drillpetsc.output.energy_balance import EnergyGainMonitor
from drillpetsc.output.progress import Progress
from drillpetsc.output.recorder import Recorder
from drillpetsc.output.well_files import write_well_files
from drillpetsc.solvers import petsc_options as options
from drillpetsc.solvers.local_error import LocalErrorEstimate
from drillpetsc.solvers.time_integrator import TimeIntegrator

TINY = 1e-9  # output times closer than this share of the interval are one


@dataclass
class RunResult:
    """Where the results lie and what they come to; the same on all ranks."""

    folder: Path
    summary: dict[str, Any] = field(default_factory=dict)


class _Writer:
    """Files of a run, on rank 0; silent elsewhere.  Rows and frames are taken as their times are passed."""

    def __init__(
        self, model: DrillingModel, recorder: Recorder, folder: RunFolder | None, restart_time: float | None
    ):
        self.model, self.recorder, self.folder = model, recorder, folder
        out = model.case.output
        self.every = (float(out.history_every), float(out.field_every))  # type: ignore[arg-type]
        self.next_row, self.next_frame = (
            (0, 0) if restart_time is None else (after(restart_time, e) for e in self.every)
        )
        self.event = PETSc.Log.Event("Output")
        if folder is not None:
            self.history = Table(folder.history, recorder.columns, restart_time=restart_time)
            self.probes = (
                Table(folder.probes, recorder.probe_columns, restart_time=restart_time)
                if recorder.probes
                else None
            )
            self.frames = FieldWriter(folder.path, restart_time=restart_time)

    def take(self, t: float, dt: float, newton: int, control: RunControl) -> bool:
        """Write all rows and the frame that are due at ``t``, and tell whether any was; collective.
        ``control`` hears what goes wrong."""
        row_due, frame_due = (
            passed(self.next_row * self.every[0], t),
            passed(self.next_frame * self.every[1], t),
        )
        if not row_due and not frame_due:
            return False
        self.event.begin()
        if row_due:
            self.recorder.audit(t)
        data = self.recorder.fields(t) if frame_due else None
        rows = range(self.next_row, after(t, self.every[0]) if row_due else self.next_row)
        try:
            self._write([row * self.every[0] for row in rows], t, dt, newton, data)
        except OSError as error:
            control.report_write_error(error, error.filename or str(self.folder.path))  # type: ignore[union-attr]
        self.next_row = rows.stop
        if frame_due:
            self.next_frame = after(t, self.every[1])
        self.event.end()
        return True

    def _write(self, times: list[float], t: float, dt: float, newton: int, data) -> None:
        if self.folder is None:
            return
        for at in times:
            self.history.add(self.recorder.history_row(at, dt, newton))
            if self.probes is not None:
                self.probes.add(self.recorder.probe_row(at))
        if data is not None:
            self.frames.write(t, *data)

    def flush(self) -> None:
        """Have everything on the disk, for a checkpoint that counts on it."""
        if self.folder is not None:
            self.history.flush()
            if self.probes is not None:
                self.probes.flush()
            self.frames.flush()

    def close(self) -> None:
        if self.folder is not None:
            self.history.close()
            if self.probes is not None:
                self.probes.close()


def passed(due: float, t: float) -> bool:
    """Whether output that is due at a time is to be written at ``t``, rounding apart."""
    return due <= t * (1 + 1e-12) + 1e-15


def after(t: float, interval: float) -> int:
    """Number of the first multiple of the interval that ``t`` has not passed; the same whether a run comes
    from afar or starts here."""
    k = max(0, int(t / interval) - 1)
    while passed(k * interval, t):
        k += 1
    return k


def run(
    case: Case | str | Path,
    out: str | Path | None = None,
    *,
    restart: bool = False,
    overwrite: bool = False,
    name: str | None = None,
    comm: PETSc.Comm | None = None,
    progress: str = "auto",
) -> RunResult:
    """Simulate ``case`` (a Case or the path of a case file) and write its run folder; collective over
    ``comm``.

    Raises CaseError for bad input (nothing is written) and SolveError when the run cannot go on (what was
    written stays).
    """
    comm = comm or PETSc.COMM_WORLD
    if not isinstance(case, Case):
        from drillpetsc.case import load_case

        name, case = name or Path(case).stem, load_case(case)
    if case.time is None:
        raise CaseError(
            at="time", want="a block {end: ...}", hint="for the static state alone use: drillpetsc statics"
        )
    began = clock.perf_counter(), clock.process_time()
    with options.applied(case.petsc) as used:
        model = build_model(case, comm)
        quasi = QuasiStatic(model) if is_quasi_static(case) else None
        recorder, integrator = Recorder(model), make_integrator(model, quasi)
        gain = EnergyGainMonitor(recorder)
        options.refuse_unread(used)
        folder = make_folder(comm, name or "case", out, restart, overwrite)
        try:
            saved = _saved(comm, folder, restart)
            if restart and saved is None and comm.rank == 0 and progress != "silent":
                print(
                    f"{folder.path}: no checkpoint yet, so the run starts from its beginning", file=sys.stderr
                )
            state = initial_state(model, case, saved, quasi)
            return _Run(
                model, recorder, integrator, folder, saved, state, quasi, gain, began, progress
            ).whole()
        finally:
            folder.release()


def make_integrator(model: DrillingModel, quasi: QuasiStatic | None = None) -> TimeIntegrator:
    """The integrator that the case asks for."""
    if quasi is not None:
        return quasi.integrator()
    system, mud = model.system, model.case.fluid
    kept = _step_limits(model)
    if mud is not None and mud.dynamics == "quasi_steady":  # the mud follows the string without delay
        system.assembly.set_imposed_rates(np.zeros(system.layout.size + 1), fluid_unknowns(system))
        return TimeIntegrator(system, controlled=lambda field: field.physics != "fluid", defaults=kept)
    return TimeIntegrator(system, defaults=kept)


def _step_limits(model: DrillingModel) -> dict[str, Any]:
    """PETSc options that cap the step where contact.energy_strict (or -drillpetsc_energy_strict) asks for
    it."""
    options, contact = PETSc.Options(), model.case.contact
    strict = options.getBool("drillpetsc_energy_strict", contact is not None and contact.energy_strict)
    longest = longest_strict_step(model) if strict else np.inf
    if not np.isfinite(longest):
        return {}
    fixed = (
        options.getReal(petsc_compat.time_step_option(), 0.0)
        if options.getString("ts_adapt_type", "basic") == "none"
        else 0.0
    )
    if fixed > longest:
        raise CaseError(
            at="petsc.ts_dt",
            got=f"{fixed:g} s",
            want=f"at most {longest:.3g} s, half the shortest impact",
            hint="contact.energy_strict asks for it",
        )
    return {"ts_adapt_dt_max": longest}


def make_folder(comm, name: str, out, restart: bool, overwrite: bool) -> RunFolder:
    """The run folder, made by rank 0; a refusal reaches every rank."""
    mpi = comm.tompi4py()
    answer: Any = None
    if comm.rank == 0:
        try:
            answer = RunFolder.create(name, out, restart=restart, overwrite=overwrite)
        except OSError as error:
            answer = CaseError(at="--out", got=str(out) if out else "", want=str(error))
    answer = mpi.bcast(answer)
    if isinstance(answer, CaseError):
        raise answer
    return answer


def _saved(comm, folder: RunFolder, restart: bool) -> checkpoint.Checkpoint | None:
    """The checkpoint to go on from; None where there is none (yet)."""
    if not restart:
        return None
    answer: Any = None
    if comm.rank == 0 and folder.checkpoint.exists():
        try:
            answer = checkpoint.read(folder.checkpoint)
        except CaseError as error:
            answer = error
    answer = comm.tompi4py().bcast(answer)
    if isinstance(answer, CaseError):
        raise answer
    return answer


class _Run:
    """The motion from the start, or from a checkpoint, to the end, with its files."""

    def __init__(self, model, recorder, integrator, folder, saved, state, quasi, gain, began, progress):
        self.model, self.recorder, self.integrator, self.folder, self.saved = (
            model,
            recorder,
            integrator,
            folder,
            saved,
        )
        self.case, self.mpi, self.began = model.case, model.system.comm.tompi4py(), began
        self.first = self.mpi.rank == 0
        self.start = self.t = saved.time if saved is not None else 0.0
        self.notes: dict[str, Any] = saved.notes if saved is not None else summary.notes_of(state)
        if quasi is not None:
            self.notes["share"] = quasi.lateral_fraction
        fixed = (
            integrator.first_step
            if integrator.options.get("ts_adapt_type") == "none" and quasi is None
            else None
        )
        self.notes["warnings"] = step_warnings(model, fixed)
        self.gain = gain
        self.newton, self.marks, self.progress = 0, began, progress
        self.bar = Progress(self.case.time.end, self.start, mode=progress if self.first else "silent")
        self.control = RunControl(self.mpi)

    def whole(self) -> RunResult:
        """Run it; what was written stays whatever happens."""
        integrator, recorder, saved = self.integrator, self.recorder, self.saved
        if saved is not None:
            recorder.set_state(saved.recorder)
            integrator.set_state(saved.stepper)
        else:
            recorder.begin(0.0)
        first_rank_does(self.mpi, str(self.folder.path), self._open)
        if not self.first:
            self._open()
        integrator.after_step.append(self._after_step)
        integrator.at_jump.append(recorder.at_jump)
        integrator.at_rest.append(self._at_rest)
        self.estimate, self.memory = (
            LocalErrorEstimate(integrator),
            Memory(self.mpi, self.start, self.case.time.end),
        )
        self._warn(self.notes["warnings"])
        self.marks = clock.perf_counter(), clock.process_time()
        error: BaseException | None = None
        try:
            with self.control:
                if saved is None:
                    self.writer.take(0.0, 0.0, 0, self.control)
                    self._save(0.0)
                self._move()
        except BaseException as failure:
            error = failure
            raise
        finally:
            result = self._close(error)
        return RunResult(self.folder.path, result)

    def _warn(self, warnings: list[str]) -> None:
        if self.first and self.progress != "silent":
            for words in warnings:
                self.bar.message(f"warning: {words}")

    def _open(self) -> None:
        self.writer = _Writer(
            self.model,
            self.recorder,
            self.folder if self.first else None,
            None if self.saved is None else self.start,
        )
        if self.first and self.saved is None:
            _write_scene(self.model, self.folder)

    def _move(self) -> None:
        """All steps; checkpoints are passed on the way, or landed on where the formula cannot be put back."""
        every, end = self.case.output.checkpoint_every, self.case.time.end
        if self.start >= end * (1 - TINY):  # nothing is left to do
            return
        k = after(self.start, every)
        stops = (
            []
            if self.integrator.remembers
            else [j * every for j in range(k, after(end, every)) if j * every < end * (1 - TINY)]
        )
        self.next_save = k
        for stop in [*stops, end]:
            self.integrator.run(self.t, stop, self.model.breaks)
            if self.integrator.stopped:
                self.recorder.audit(self.t)
                raise Interrupted(self.control.name, self.t, self.folder.path)
            self._save(stop)

    def _after_step(self, t: float, dt: float) -> None:
        recorder, integrator, writer = self.recorder, self.integrator, self.writer
        recorder.step(t, dt, writer.next_row * writer.every[0], integrator.input_time(t), integrator.fresh)
        if integrator.jumped:
            recorder.add_impulse_work(t)
        newton = integrator.newton_iterations()
        self.due = writer.take(t, dt, newton - self.newton, self.control)
        self.t, self.newton = t, newton
        self.memory.update(t)
        self.bar.update(t, integrator.counters.steps, dt)

    def _at_rest(self, t: float) -> None:
        """The step is done with: look at what came from outside, and save what is due."""
        every, asked = self.case.output.checkpoint_every, self.control.poll(self.due)
        if asked == FAILED:
            reported = self.mpi.allreduce(self.control.error)  # of one rank only
            raise SolveError(reported, time=t, hint=RESTART_HINT)
        due = (
            self.integrator.remembers
            and passed(self.next_save * every, t)
            and t < self.case.time.end * (1 - TINY)
        )
        if due or asked != NOTHING:
            self._save(t)
        if due:
            self.next_save = after(t, every)
        if self.due:
            self.gain.check(t)
        if asked == STOP:
            self.integrator.stop()

    def _save(self, t: float) -> None:
        """Write a checkpoint; collective."""
        c = checkpoint.take(self.model, self.recorder, self.integrator, t, self.notes)

        def put() -> None:
            assert c is not None
            self.writer.flush()
            checkpoint.write(self.folder.checkpoint, c)

        first_rank_does(self.mpi, str(self.folder.checkpoint), put, t)

    def _close(self, error: BaseException | None) -> dict[str, Any]:
        """Close the files and sum up."""
        model, folder = self.model, self.folder
        self.writer.close()
        self.bar.finish(self.t, self.integrator.counters.steps)
        result = summary.of_run(
            model,
            self.recorder,
            self.integrator,
            self.notes,
            self.t,
            self.start,
            self.began,
            self.marks,
            error,
        )
        result |= self.estimate.as_dict(error is None) | {"memory": self.memory.as_dict(error is None)}
        if "energy" in result:
            result["energy"] |= self.gain.summary()
            if result["energy"]["flag"]:
                result["warnings"] = [*result["warnings"], self.gain.message()]
                self._warn(result["warnings"][-1:])

        def put() -> None:
            if model.drilling is not None:
                write_well_files(model, folder)
            write_summary(folder.summary, result)

        if error is None:
            first_rank_does(self.mpi, str(folder.summary), put, self.t)
        elif self.first:
            try:
                put()
            except OSError as full:  # the run ends with its own message
                self.bar.message(cannot_write(full, str(folder.summary)))
        return result


def _write_scene(model: DrillingModel, folder: RunFolder) -> None:
    """Files that do not change during a run."""
    model.case.dump(folder.case)
    if model.well is not None:
        write_well_files(model, folder)
