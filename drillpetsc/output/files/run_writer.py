"""Files of a run: rows of the tables and frames of the string, written as their times are passed."""

from __future__ import annotations

import queue
import threading
import time as clock
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from petsc4py import PETSc

from drillpetsc.errors import CaseError
from drillpetsc.fem.component import FloatArray
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output import FieldWriter, RunFolder, Table, read_series
from drillpetsc.output.files.fields import frames_written
from drillpetsc.output.files.tables import header, rows_written
from drillpetsc.output.measured.field_output import FieldOutput
from drillpetsc.output.recorder import Recorder
from drillpetsc.output.sensors.files import covered
from drillpetsc.output.watches.operation_watch import OperationWatch

WAITING = 4  # tasks that may wait; a run that writes faster than the disk takes it is held back


class Background:
    """A thread that carries out tasks one after the other; it starts with the first one.

    After an error the tasks that follow are dropped, until ``check`` or ``wait`` has raised it.
    """

    def __init__(self) -> None:
        self._tasks: queue.Queue[Callable[[], object] | None] = queue.Queue(WAITING)
        self._error: BaseException | None = None
        self._thread: threading.Thread | None = None

    def submit(self, task: Callable[[], object]) -> None:
        """Carry out ``task`` later; it must not use data that the caller will change."""
        if self._thread is None:
            self._thread = threading.Thread(target=self._work, name="output", daemon=True)
            self._thread.start()
        self._tasks.put(task)

    def check(self) -> None:
        """Raise the error of an earlier task, if there is one, once."""
        error, self._error = self._error, None
        if error is not None:
            raise error

    def wait(self) -> None:
        """Wait for all tasks; raises as ``check``."""
        self._tasks.join()
        self.check()

    def close(self) -> None:
        """Wait for all tasks and end the thread; raises as ``check``."""
        if self._thread is not None:
            self._tasks.put(None)
            self._thread.join()
            self._thread = None
        self.check()

    def _work(self) -> None:
        while (task := self._tasks.get()) is not None:
            if self._error is None:
                try:
                    task()
                except BaseException as error:
                    self._error = error
            self._tasks.task_done()
        self._tasks.task_done()


#: rows of the tables that are computed and written together, unless the first of them has waited for so long [s]
ROWS_AT_ONCE, ROWS_WAIT = 64, 0.5


class WriteErrors(Protocol):
    """Receives errors of files, to end the run on all ranks."""

    def report_write_error(self, error: OSError, what: str) -> None: ...


class RunWriter:
    """Writes history.csv, probes.csv and string.pvd on rank 0; does not write elsewhere.

    folder: the run folder, None on the other ranks.
    restart_time: time [s] from which a run continues; later rows and frames are removed.

    ``last_row`` is the time of the last row, ``next_row_time`` of the next one [s]; ``watch`` has seen all rows that are written.
    """

    def __init__(
        self, model: DrillingModel, recorder: Recorder, folder: RunFolder | None, restart_time: float | None
    ) -> None:
        self.recorder, self.folder = recorder, folder
        self.field_output = FieldOutput(model)
        out = model.case.output
        assert out.history_every is not None and out.field_every is not None  # defaults fill them
        self.every = (float(out.history_every), float(out.field_every))
        self._next = [0, 0] if restart_time is None else [after(restart_time, e) for e in self.every]
        self._set_next(*self._next)
        self.last_row, self.watch = -1.0, OperationWatch(model.case, recorder.columns)
        self._one_rank = model.system.comm.size == 1
        self._written = clock.monotonic()
        self.event = PETSc.Log.Event("Output")
        if folder is not None:
            self.history = Table(folder.history, recorder.columns, restart_time=restart_time)
            self.probes = (
                Table(folder.probes, recorder.probe_columns, restart_time=restart_time)
                if recorder.probes.depths
                else None
            )
            self.frames, self._background = FieldWriter(folder.path, restart_time=restart_time), Background()
            if recorder.sensors is not None:
                recorder.sensors.open(folder.path, restart_time)

    def _set_next(self, row: int, frame: int) -> None:
        """Set the numbers of the next row and of the next frame."""
        self._next = [row, frame]
        self.next_row_time, self._next_frame_time = row * self.every[0], frame * self.every[1]
        self._next_time = min(self.next_row_time, self._next_frame_time)

    def write(self, t: float, dt: float, newton: int, errors: WriteErrors) -> bool:
        """Write all rows and the frame that are due at ``t`` [s]; True if any was.  Collective.

        dt, newton: last step [s] and its Newton iterations.
        """
        if not passed(self._next_time, t):
            if self._one_rank and self.is_overdue:
                self.write_waiting(errors)
            return False
        row_due, frame_due = passed(self.next_row_time, t), passed(self._next_frame_time, t)
        self.event.begin()
        row, frame = self._next
        rows = range(row, after(t, self.every[0]) if row_due else row)
        if rows:
            times = [row * self.every[0] for row in rows]
            self.recorder.rows_due(times, t, newton, dt, self.folder is not None)
        fields = self.field_output.fields(t) if frame_due else None
        if self._one_rank and self.is_overdue:
            self.recorder.catch_up()
        self._attempt(lambda: self._write(t, fields), errors)
        self._set_next(rows.stop, after(t, self.every[1]) if frame_due else frame)
        self.last_row = rows[-1] * self.every[0] if rows else self.last_row
        self.event.end()
        return True

    @property
    def is_overdue(self) -> bool:
        """Whether rows of this rank that are due have waited so long that they should be written now."""
        waiting = self.recorder.recorded or self.recorder.kept
        return bool(self.folder is not None and waiting and clock.monotonic() > self._written + ROWS_WAIT)

    def write_waiting(self, errors: WriteErrors) -> None:
        """Write the rows that are due; collective."""
        self.event.begin()
        self.recorder.catch_up()
        self._attempt(self._write_rows, errors)
        self.event.end()

    def _attempt(self, task: Callable[[], None], errors: WriteErrors) -> None:
        try:
            task()
        except OSError as error:
            errors.report_write_error(error, error.filename or str(self.folder and self.folder.path))

    def _write(self, t: float, fields: tuple[FloatArray, dict[str, FloatArray]] | None) -> None:
        if self.folder is None:
            return
        self._background.check()
        if self.recorder.kept >= ROWS_AT_ONCE or self.is_overdue:
            self._write_rows()
        if fields is not None:
            self._background.submit(lambda: self.frames.write(t, *fields))

    def _write_rows(self) -> None:
        """Write the rows that wait."""
        self._written = clock.monotonic()
        if self.folder is None or not self.recorder.kept:
            return
        history, probes = self.recorder.kept_rows()
        self.watch.update(history)
        self.history.add_rows(history)
        if self.probes is not None:
            self.probes.add_rows(probes)

    def write_samples(self, errors: WriteErrors) -> None:
        """Take the samples of the recorded steps and write them; collective."""
        sensors = self.recorder.sensors
        if sensors is None:
            return
        self.event.begin()
        samples = sensors.take()
        if self.folder is not None:
            try:
                sensors.write(samples)
            except OSError as error:
                errors.report_write_error(error, error.filename or str(self.folder.path))
        self.event.end()

    def flush(self) -> None:
        """Wait until the disk has everything, for a checkpoint that counts on it."""
        if self.folder is not None:
            self._write_rows()
            self.history.flush()
            if self.probes is not None:
                self.probes.flush()
            self._background.wait()
            self.frames.flush()
            if self.recorder.sensors is not None:
                self.recorder.sensors.flush()

    @property
    def written(self) -> dict[str, tuple[int, str]]:
        """Number and digest of the rows of each table, and of the frames, by the name of the file; empty on the other ranks."""
        if self.folder is None:
            return {}
        sensors = self.recorder.sensors.tables if self.recorder.sensors is not None else []
        tables = [self.history, *([self.probes] if self.probes is not None else []), *sensors]
        frames = {self.folder.string_series.name: self.frames.written}
        return {table.path.name: table.written for table in tables} | frames

    def close(self) -> None:
        if self.folder is not None:
            # errors only of a run that failed: any other has written everything for its last checkpoint
            for end in (self._write_rows, self._background.close):
                with suppress(OSError):
                    end()
            self.history.close()
            if self.probes is not None:
                self.probes.close()
            if self.recorder.sensors is not None:
                self.recorder.sensors.close()


def missing_output(
    folder: RunFolder,
    recorder: Recorder,
    restart_time: float,
    last_row: float,
    written: Mapping[str, Sequence[Any]],
) -> CaseError | None:
    """The error for output of a run folder that cannot be continued, None if it is complete and as it was written.

    restart_time: time of the checkpoint [s].
    last_row: time of the last row before it [s].
    written: rows and digest of each table at the checkpoint, ``RunWriter.written``.
    """
    tables = [(folder.history, recorder.columns)]
    if recorder.probes.depths:
        tables.append((folder.probes, recorder.probe_columns))
    for path, columns in tables:
        if not path.is_file():
            return _gone(path, "no such file")
        first, *lines = _lines(path) or [""]
        if first.rstrip("\n") != ",".join(header(columns)):
            return _gone(path, "other columns than the run has", "the case has changed, or the file")
        times = [_time(line) for line in lines]
        last = max((t for t in times if passed(t, restart_time)), default=-np.inf)
        if not passed(last_row, last):
            got = f"rows up to {last:.9g} s, not up to {last_row:.9g} s" if np.isfinite(last) else "no rows"
            return _gone(path, got)
        changed = _changed(path, lines, len(columns), restart_time, written.get(path.name, (0, "")))
        if changed is not None:
            return changed
    for path, columns, rate in recorder.sensors.files(folder.path) if recorder.sensors is not None else ():
        last_sample = covered(path, columns) if path.is_file() else -np.inf
        if last_sample is None:
            return _gone(path, "other columns than the run has", "the case has changed, or the file")
        if last_sample < np.floor(restart_time * rate * (1 - 1e-9)) / rate * (1 - 1e-9):
            found = f"samples up to {last_sample:.9g} s, not up to {restart_time:.9g} s"
            return _gone(path, found if path.is_file() else "no such file")
        if path.suffix == ".csv":
            lines = _lines(path)[1:]
            changed = _changed(path, lines, len(columns), restart_time, written.get(path.name, (0, "")))
            if changed is not None:
                return changed
    if not folder.string_series.is_file():
        return _gone(folder.string_series, "no such file")
    for time, frame in read_series(folder.path):
        if passed(time, restart_time) and not frame.is_file():
            return _gone(frame, "no such file")
    frames, digest = written[folder.string_series.name]
    there = frames_written(folder.path, restart_time)
    if there != (frames, digest):
        more = f"{there[0]} frames up to {restart_time:.6g} s, {frames} were written"
        return _gone(folder.string_series, more if there[0] != frames else "frames or times that are changed")
    return None


def _lines(path: Path) -> list[str]:
    """Lines of a table with their ends; bytes that are not text, in a damaged one, are replaced."""
    return path.read_text(encoding="utf-8", errors="replace").splitlines(keepends=True)


def _changed(
    path: Path, lines: Sequence[str], width: int, restart_time: float, written: Sequence[Any]
) -> CaseError | None:
    """The error for rows that are not those which the run has written; None if they are."""
    rows, digest = rows_written(lines, width, restart_time)
    if rows < min(written[0], len(lines)):
        return _gone(path, f"a damaged line {rows + 2}, after {rows} of {written[0]} rows")
    if rows != written[0]:
        return _gone(path, f"{rows} rows up to {restart_time:.6g} s, {written[0]} were written")
    return None if digest == written[1] else _gone(path, "rows that are changed or in another order")


def _gone(path: Path, got: str, hint: str = "") -> CaseError:
    return CaseError(
        file=path,
        got=got,
        want="the output of the run up to its checkpoint, which is continued",
        hint=hint or "take the file from a copy of the run folder, or start the run again with --overwrite",
    )


def _time(line: str) -> float:
    """First value of a row; NaN in an incomplete one."""
    try:
        return float(line.partition(",")[0])
    except ValueError:
        return np.nan


def passed(due: float, t: float) -> bool:
    """Whether output that is due at a time [s] is to be written at ``t`` [s], up to rounding."""
    return due <= t * (1 + 1e-12) + 1e-15


def after(t: float, interval: float) -> int:
    """Number of the first multiple of ``interval`` [s] that ``t`` [s] has not passed, the same in a continued run."""
    k = max(0, int(t / interval) - 1)
    while passed(k * interval, t):
        k += 1
    return k
