"""Columns of history.csv after chosen steps, copied after each of them and computed for many at once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray, IntArray
from drillpetsc.fem.step_record import StepRecord
from drillpetsc.kernels import function
from drillpetsc.kernels.parameters import structure
from drillpetsc.output.recorder import STEPS_AT_ONCE, Recorder
from drillpetsc.output.table_rows import TableColumn
from drillpetsc.parallel import total_in_order

_RecordCall = structure("record_call")
_record_steps = function("record_steps", "ipi")


class ColumnSeries:
    """Values of some columns of a model, one row for each call of ``add``.  recorder: of the model."""

    def __init__(self, recorder: Recorder, columns: Sequence[TableColumn]) -> None:
        self._recorder, self._row = recorder, recorder.row_of(columns)
        self._record = StepRecord(recorder.system, STEPS_AT_ONCE)
        self._slots = list({c.slot.start: c.slot for c in columns if c.slot is not None}.values())
        self._now: list[list[float]] = []
        self._rows = [np.zeros((0, len(columns)))]

    def add(self, t: float) -> None:
        """Keep what the columns need of the present state; ``t``: of its inputs [s]; collective."""
        with self._recorder.system.assembly.unchanged():
            if self._record.is_open:  # names the numbers that are kept
                self._record.times = [t]
                for slot in self._slots:
                    slot.of(self._record)
                self._record.clear()
            self._record.add(t)
        self._now.append(self._row.numbers_now())
        if len(self._record) >= self._record.capacity:
            self._catch_up()

    def before_hole_changes(self, call: Callable[[], None]) -> None:
        """Call a function before the hole of the model grows."""
        if (bit := self._recorder.model.bit) is not None and bit.hole is not None:
            bit.hole.before_change.append(call)

    @property
    def unknowns_read(self) -> IntArray | None:
        """Unknowns on which the rows depend, after the first one; None if they depend on more than compiled code copies."""
        return None if self._now[-1] else self._record.unknowns_read

    def rows(self) -> FloatArray:
        """(m, columns) the rows, the same on all ranks; collective."""
        self._catch_up()
        self._rows = [np.concatenate(self._rows)]
        return self._rows[0]

    def fill(self, call: Any) -> None:
        """As of ``StepRecord``."""
        self._record.fill(call)

    def take(self, times: Sequence[float]) -> None:
        """Go on with steps that a compiled call has recorded; times: of their inputs [s]."""
        self._record.times += times
        self._now += [[] for _ in times]
        self._catch_up()

    def _catch_up(self) -> None:
        if not len(self._record):
            return
        samples = np.zeros((len(self._record), self._recorder.layout.width))
        for slot in self._slots:
            samples[:, slot.span] = slot.of(self._record)
        self._rows.append(self._row.rows(total_in_order(self._recorder.comm, samples), self._now))
        self._record.clear()
        self._now = []


class ColumnSeriesOfSystems:
    """Series of several models that are read after the same steps, in one compiled call if that suffices."""

    def __init__(self, series: Sequence[ColumnSeries]) -> None:
        self.series = series
        self._calls = (_RecordCall * len(series))()
        self._times: list[float] = []  # of steps that the series do not know yet
        self._before = 0  # steps that they know
        #: whether the first step was read; unknowns on which all rows depend, None if compiled code does not suffice
        self.is_read = False
        self.unknowns_read: IntArray | None = None
        # places are found in the hole at their time; the hole of the first model is the first to grow
        series[0].before_hole_changes(self._hand_over)

    def add(self, t: float) -> None:
        """Read the present states of all models; ``t``: of their inputs [s]; collective."""
        if self.unknowns_read is None:
            for one in self.series:
                one.add(t)
            if not self.is_read:
                self._look()
            return
        _record_steps(len(self._calls), self._calls, self._before + len(self._times))
        self._times.append(t)
        if self._before + len(self._times) >= STEPS_AT_ONCE:
            self._hand_over()

    def _look(self) -> None:
        """Find whether compiled code suffices, after the first step."""
        self.is_read, self._before = True, 1
        found = [one.unknowns_read for one in self.series]
        places = [q for q in found if q is not None]
        if len(places) < len(found):
            return
        self.unknowns_read = np.unique(np.concatenate(places))
        for call, one in zip(self._calls, self.series, strict=True):
            one.fill(call)

    def _hand_over(self) -> None:
        for one in self.series:
            one.take(self._times)
        self._times, self._before = [], 0

    def rows(self) -> list[FloatArray]:
        """(m, columns) the rows of each model, the same on all ranks; collective."""
        self._hand_over()
        return [one.rows() for one in self.series]
