"""Outputs of a model at its present state, by name: columns of history.csv, computed on demand."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from drillpetsc.analysis.motion.checkpoint import Checkpoint
from drillpetsc.fem.quantity import Quantity, Sample
from drillpetsc.output.recorder import Recorder
from drillpetsc.output.sensors.sensors import Sensors
from drillpetsc.output.table_rows import TableColumn, TableRow

#: columns of history.csv on the row itself; the energies, of which no account is kept, are left out, too
LEFT_OUT = ("time", "step", "newton")


@dataclass(frozen=True)
class SessionOutput:
    """An output of a session: a column of history.csv, in SI."""

    name: str
    unit: str
    description: str


class LiveOutputs:
    """Columns of history.csv at the present state.  recorder: of the model."""

    def __init__(self, recorder: Recorder) -> None:
        self._recorder = recorder
        self._rows: dict[tuple[int, ...], TableRow] = {}
        self._columns = {c.title[0]: c for c in recorder.history_columns if c.source is not recorder.energy}
        for name in LEFT_OUT:
            self._columns.pop(name, None)
        self._sample: tuple[float, np.ndarray, Sample] | None = None

    def described(self) -> tuple[SessionOutput, ...]:
        """Name, unit and description of every output."""
        out = []
        for name, column in self._columns.items():
            q: Quantity = column.quantity
            out.append(SessionOutput(name, column.title[1], q.doc))
        return tuple(out)

    def find(self, names: Iterable[str], others: Iterable[str] = ()) -> list[TableColumn]:
        """Columns of the names.  Raises LookupError for an unknown one; others: names that exist besides."""
        columns = []
        for name in names:
            if name not in self._columns:
                raise LookupError(unknown("get", "output", name, [*self._columns, *others]))
            columns.append(self._columns[name])
        return columns

    def changed(self) -> None:
        """Forget the values: the state or an input has changed."""
        self._sample = None

    def read(self, columns: list[TableColumn], t: float) -> list[float]:
        """Values of columns at the present state and at the inputs of the time ``t`` [s]; collective."""
        recorder = self._recorder
        if self._sample is None or self._sample[0] != t:
            self._sample = (t, np.full(recorder.layout.width, np.nan), Sample(recorder.system, t))
        _, v, sample = self._sample
        wanted = {
            c.slot.start: c.slot for c in columns if c.slot is not None and np.isnan(v[c.slot.span]).all()
        }
        mpi = recorder.comm
        with recorder.system.assembly.unchanged():
            for slot in wanted.values():
                values = slot.value(slot.source, sample)
                part = np.atleast_1d(np.asarray(values, dtype=float)).ravel()
                v[slot.span] = part if mpi.size == 1 else mpi.allreduce(part)
        key = tuple(id(c) for c in columns)
        if key not in self._rows:
            self._rows[key] = recorder.row_of(columns)
        return self._rows[key].numbers(v)


def unknown(call: str, what: str, name: str, known: Iterable[str]) -> str:
    """Message on an unknown name."""
    names = list(known)
    near = difflib.get_close_matches(name, names, 1, 0.4)
    return f"{call}: no {what} {name!r}; " + (
        f"nearest: {near[0]}" if near else f"there are {', '.join(names) or 'none'}"
    )


class LiveSensors:
    """The latest samples of the sensors of a model that is advanced step by step; collective.

    sensors: of the recorder; time: of the start [s]; saved: checkpoint that is continued.

    outputs: unit and description by name; latest: samples by name, nan before the first one.
    """

    def __init__(self, sensors: Sensors, time: float, saved: Checkpoint | None) -> None:
        self._sensors = sensors
        self.outputs: dict[str, tuple[str, str]] = {}
        self._names: list[list[str]] = []
        for sampler in sensors.samplers:
            found = {f"{sampler.sensor.name}.{q.name}": (q.unit, q.doc) for q in sampler.quantities[1:]}
            self.outputs |= found
            self._names.append(list(found))
        self.latest = dict.fromkeys(self.outputs, float("nan"))
        if saved is None or "sensors_steps" not in saved.recorder:
            sensors.start(time)
            sensors.begin_at(time)
        else:
            self.set_state(saved)

    def step(self, t: float, dt: float, fresh: bool) -> None:
        """Record an accepted step of ``dt`` [s] that ends at ``t`` [s]; fresh: the first one of the time formula."""
        if self._sensors.step(t, dt, fresh):
            self.take()

    def renew(self) -> None:
        """Record the state in other reference frames."""
        self._sensors.renew()

    def take(self) -> None:
        """Take the samples that are due."""
        rows = [part[-1].tolist() if len(part) else [] for part in self._sensors.take()]
        if self._sensors.comm.size > 1:
            rows = self._sensors.comm.bcast(rows)
        for names, row in zip(self._names, rows, strict=True):
            if row:
                self.latest.update(zip(names, row[1:], strict=True))

    def set_state(self, saved: Checkpoint, latest: dict[str, float] | None = None) -> None:
        """Go on from a checkpoint, with the latest samples at its time where they are known."""
        self._sensors.set_state(saved.recorder)
        self.latest = dict(latest) if latest else dict.fromkeys(self.outputs, float("nan"))
