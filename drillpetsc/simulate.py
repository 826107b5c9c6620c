"""A whole run: from a case to a run folder."""

from __future__ import annotations

import time as clock
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from petsc4py import PETSc

from drillpetsc import checkpoint, options, summary
from drillpetsc.case.scene import Case
from drillpetsc.errors import CaseError
from drillpetsc.output import FieldWriter, RunFolder, Table, write_summary, write_table, write_well
from drillpetsc.progress import Progress
from drillpetsc.quasi_static import QuasiStatic
from drillpetsc.recorder import Recorder
from drillpetsc.scene import Scene, build_scene, is_quasi_static
from drillpetsc.solve.dynamics import Dynamics
from drillpetsc.solve.hydraulics import fluid_unknowns, is_fluid
from drillpetsc.start import StaticState, find_equilibrium, move_rigidly, place_along_hole, release

TINY = 1e-9  # output times closer than this share of the interval are one


@dataclass
class RunResult:
    """Where the results lie and what they come to; the same on all ranks."""

    folder: Path
    summary: dict[str, Any] = field(default_factory=dict)


class _Writer:
    """Files of a run, on rank 0; silent elsewhere.  Rows and frames are taken as their times are passed."""

    def __init__(self, scene: Scene, recorder: Recorder, folder: RunFolder | None, restart_time: float | None):
        self.scene, self.recorder, self.folder = scene, recorder, folder
        out = scene.case.output
        self.every = (float(out.history_every), float(out.field_every))  # type: ignore[arg-type]
        start = restart_time or 0.0
        self.next_row = self._after(start, self.every[0], restart_time is None)
        self.next_frame = self._after(start, self.every[1], restart_time is None)
        self.event = PETSc.Log.Event("Output")
        if folder is not None:
            self.history = Table(folder.history, recorder.columns, restart_time=restart_time)
            self.probes = Table(folder.probes, recorder.probe_columns, restart_time=restart_time) if recorder.probes else None
            self.frames = FieldWriter(folder.path, restart_time=restart_time)

    @staticmethod
    def _after(t: float, interval: float, here: bool) -> int:
        """Number of the next multiple of the interval; at a fresh start the one at t itself."""
        return round(t / interval) if here else int(np.floor(t / interval * (1 + TINY))) + 1

    def take(self, t: float, dt: float, newton: int) -> None:
        """Write all rows and the frame that are due at ``t``; collective."""
        row_due = self.next_row * self.every[0] <= t * (1 + 1e-12) + 1e-15
        frame_due = self.next_frame * self.every[1] <= t * (1 + 1e-12) + 1e-15
        if not row_due and not frame_due:
            return
        self.event.begin()
        if row_due:
            self.recorder.audit(t)
        while row_due and self.next_row * self.every[0] <= t * (1 + 1e-12) + 1e-15:
            at = self.next_row * self.every[0]
            if self.folder is not None:
                self.history.add(self.recorder.history_row(at, dt, newton))
                if self.probes is not None:
                    self.probes.add(self.recorder.probe_row(at))
            self.next_row += 1
        if frame_due:
            data = self.recorder.fields(t)
            if data is not None and self.folder is not None:
                self.frames.write(t, *data)
            self.next_frame = int(np.floor(t / self.every[1] * (1 + TINY))) + 1
        self.event.end()

    def close(self) -> None:
        if self.folder is not None:
            self.history.close()
            if self.probes is not None:
                self.probes.close()


def run(case: Case | str | Path, out: str | Path | None = None, *, restart: bool = False, overwrite: bool = False, name: str | None = None,
        comm: PETSc.Comm | None = None, progress: str = "auto") -> RunResult:
    """Simulate ``case`` (a Case or the path of a case file) and write its run folder; collective over ``comm``.

    Raises CaseError for bad input (nothing is written) and SolveError when the run cannot go on (what was written stays).
    """
    comm = comm or PETSc.COMM_WORLD
    if not isinstance(case, Case):
        from drillpetsc.case import load_case

        name, case = name or Path(case).stem, load_case(case)
    if case.time is None:
        raise CaseError(at="time", want="a block {end: ...}", hint="for the static state alone use: drillpetsc statics")
    began = clock.perf_counter(), clock.process_time()
    with options.applied(case.petsc) as used:
        scene = build_scene(case, comm)
        quasi = QuasiStatic(scene) if is_quasi_static(case) else None
        recorder, dynamics = Recorder(scene), make_dynamics(scene, quasi)
        options.refuse_unread(used)
        folder = make_folder(comm, name or "case", out, restart, overwrite)
        saved = _saved(comm, folder, restart)
        state = _initial(scene, case, saved, quasi)
        return _integrate(scene, recorder, dynamics, folder, saved, state, began, progress)


def make_dynamics(scene: Scene, quasi: QuasiStatic | None = None) -> Dynamics:
    """The integrator that the case asks for."""
    if quasi is not None:
        return quasi.dynamics()
    model, mud = scene.model, scene.case.fluid
    if mud is not None and mud.dynamics == "quasi_steady":  # the mud follows the string without delay
        model.assembly.take_rates_from(np.zeros(model.layout.size + 1), fluid_unknowns(model))
        return Dynamics(model, controlled=lambda name: not is_fluid(name))
    return Dynamics(model)


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
    if not restart:
        return None
    answer: Any = None
    if comm.rank == 0:
        try:
            answer = checkpoint.read(folder.checkpoint)
        except CaseError as error:
            answer = error
    answer = comm.tompi4py().bcast(answer)
    if isinstance(answer, CaseError):
        raise answer
    return answer


def _initial(scene: Scene, case: Case, saved: checkpoint.Checkpoint | None, quasi: QuasiStatic | None) -> StaticState | None:
    """Bring the scene to its state at the start."""
    if saved is not None:
        checkpoint.restore(scene, saved)
        if quasi is not None:
            quasi.begin(saved.time)
        return None
    state = None
    if case.initial.from_ == "statics":
        state = find_equilibrium(scene)
    elif case.initial.from_ in ("rest", "straight"):
        place_along_hole(scene)
    else:
        other = checkpoint.read(Path(case.initial.from_) / "checkpoint.h5")
        checkpoint.restore(scene, other)
        if quasi is None:
            release(scene)
        else:
            quasi.begin()
        return None
    if quasi is not None:
        quasi.begin(share=state.side if state is not None else 1.0)
        return state
    release(scene)
    move_rigidly(scene)
    return state


def _integrate(scene, recorder, dynamics, folder, saved, state, began, progress) -> RunResult:
    case, comm = scene.case, scene.model.comm
    first = comm.rank == 0
    start = saved.time if saved is not None else 0.0
    if saved is not None:
        recorder.resume(saved.books)
        dynamics.first_step = saved.step
    else:
        recorder.begin(0.0)
    writer = _Writer(scene, recorder, folder if first else None, start if saved is not None else None)
    if first and saved is None:
        _write_scene(scene, folder, state)
    bar = Progress(case.time.end, start, mode=progress if first else "silent")  # type: ignore[arg-type]
    last = {"t": start, "newton": 0}

    def after(t: float, dt: float) -> None:
        recorder.step(t, dt, writer.next_row * writer.every[0], dynamics.input_time(t), dynamics.fresh)
        if dynamics.jumped:
            recorder.book_impulse(t)
        newton = dynamics.newton_iterations()
        writer.take(t, dt, newton - last["newton"])
        last["t"], last["newton"] = t, newton
        bar.update(t, dynamics.counters.steps, dt)

    dynamics.after_step.append(after)
    dynamics.at_jump.append(recorder.at_jump)
    if saved is None:
        writer.take(0.0, 0.0, 0)
    marks = clock.perf_counter(), clock.process_time()
    error: BaseException | None = None
    try:
        for stop in _checkpoint_times(case, start):
            dynamics.run(last["t"], stop, scene.breaks)
            if stop < case.time.end or case.output.checkpoint_every:
                _checkpoint(scene, recorder, dynamics, folder if first else None, stop)
    except BaseException as failure:
        error = failure
        raise
    finally:
        writer.close()
        if first and scene.drilling is not None:
            write_well_files(scene, folder)
        bar.finish(last["t"], dynamics.counters.steps)
        result = summary.of_run(scene, recorder, dynamics, state, last["t"], start, began, marks, error)
        if first:
            write_summary(folder.summary, result)
    return RunResult(folder.path, result)


def _checkpoint_times(case: Case, start: float) -> list[float]:
    every, end = case.output.checkpoint_every, case.time.end  # type: ignore[union-attr]
    if not every:
        return [end]
    first = int(np.floor(start / every * (1 + TINY))) + 1
    times = [k * every for k in range(first, int(np.ceil(end / every)) + 1) if k * every < end * (1 - TINY)]
    return [*times, end]


def _checkpoint(scene, recorder, dynamics, folder, t: float) -> None:
    step = max(dynamics.first_step, 0.1 * dynamics.last_step)
    dynamics.first_step = step
    c = checkpoint.take(scene, recorder, t, step)
    if c is not None and folder is not None:
        checkpoint.write(folder.checkpoint, c)


def _write_scene(scene: Scene, folder: RunFolder, state: StaticState | None) -> None:
    """Files that do not change during a run."""
    scene.case.dump(folder.case)
    if scene.well is not None:
        write_well_files(scene, folder)
    del state


def write_well_files(scene: Scene, folder: RunFolder) -> None:
    """trajectory.csv and well.vtu."""
    well = scene.drilling.hole.whole() if scene.drilling is not None else scene.well
    assert well is not None
    old, end = scene.case.well.survey.md[-1], well.depth  # type: ignore[union-attr]
    md = np.unique(np.concatenate([np.linspace(0.0, old, max(2, int(np.ceil(old / 10)) + 1)), [q.to for q in scene.case.well.sections],  # type: ignore[union-attr]
                                   well.node_md[well.node_md > old], [end]]))
    position, _, _ = well.at(md)
    degrees = 180 / np.pi
    columns = [("md", "m"), ("inclination", "deg"), ("azimuth", "deg"), ("north", "m"), ("east", "m"), ("tvd", "m")]
    write_table(folder.trajectory, columns, [md, np.asarray(well.inclination(md)) * degrees, np.asarray(well.azimuth(md)) * degrees,
                                             *np.asarray(position).T])
    write_well(folder.well, md, np.asarray(position), np.asarray(well.radius(md)), np.asarray(well.friction(md)))
