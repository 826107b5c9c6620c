"""Columns of history.csv after chosen steps, copied after each of them and computed for many at once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.step_record import StepRecord
from drillpetsc.output.recorder import STEPS_AT_ONCE, Recorder
from drillpetsc.output.table_rows import TableColumn
from drillpetsc.parallel import total_in_order


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

    def rows(self) -> FloatArray:
        """(m, columns) the rows, the same on all ranks; collective."""
        self._catch_up()
        self._rows = [np.concatenate(self._rows)]
        return self._rows[0]

    def _catch_up(self) -> None:
        if not len(self._record):
            return
        samples = np.zeros((len(self._record), self._recorder.layout.width))
        for slot in self._slots:
            samples[:, slot.span] = slot.of(self._record)
        self._rows.append(self._row.rows(total_in_order(self._recorder.comm, samples), self._now))
        self._record.clear()
        self._now = []
