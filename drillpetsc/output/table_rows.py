"""Values that a run samples, and the rows of tables that are computed from the samples."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.quantity import Quantity, Sample
from drillpetsc.fem.step_record import StepRecord
from drillpetsc.output.files.tables import Column


@dataclass(frozen=True)
class Slot:
    """Part ``span`` of a sample that one value fills, with ``size`` numbers per entity.  Quantities with the same
    value share a slot.

    is_number: the value is a number, not an array.
    values: the same for many steps, None if there is no such function.
    """

    source: Any
    value: Callable[[Any, Sample], Any]
    span: slice
    size: int
    motion: bool
    is_number: bool
    values: Callable[[Any, StepRecord], Any] | None = None

    def of(self, steps: StepRecord) -> FloatArray:
        """(k, width) the value after each of k recorded steps, this rank's share."""
        # unknowns that are derived from others are found one step at a time
        if self.values is not None and steps.assembly.derive is None:
            found = self.values(self.source, steps)
        else:
            width = self.span.stop - self.span.start
            found = steps.computed(
                lambda sample: np.ravel(self.value(self.source, sample)), width, "slot", self.start
            )
        return np.asarray(found).reshape(len(steps), -1)

    @property
    def start(self) -> int:
        return int(self.span.start)


@dataclass
class SampleLayout:
    """Slots of all values that a run samples.  counts: entities of each kind."""

    counts: dict[str, int]
    slots: dict[tuple[int, Any], Slot] = field(default_factory=dict)
    width: int = 0

    def add(self, source: Any, quantity: Quantity) -> Slot:
        """The slot of a quantity, a new one if no other quantity has its value."""
        key = id(source), quantity.value
        if key not in self.slots:
            assert quantity.value is not None
            span = slice(self.width, self.width + self.counts[quantity.on] * quantity.size)
            is_number, motion = (
                quantity.on == "scalar" and quantity.size == 1,
                quantity.interpolate == "motion",
            )
            self.slots[key] = Slot(
                source, quantity.value, span, quantity.size, motion, is_number, quantity.values
            )
            self.width = span.stop
        return self.slots[key]

    def slot_at(self, start: int) -> Slot | None:
        """The slot that begins at ``start``."""
        return next((s for s in self.slots.values() if s.start == start), None)

    def motion(self) -> np.ndarray:
        """Positions of the numbers that are interpolated as motion."""
        spans = [np.arange(s.span.start, s.span.stop) for s in self.slots.values() if s.motion]
        return np.concatenate([np.zeros(0, dtype=int), *spans])


class TableColumn:
    """A column of a table: a quantity, for one joint, probe or rigid item if there are several.

    slot: of the sampled value; None if the value is taken at the time of writing.
    number: of the joint or probe, at ``depth`` [m].
    """

    def __init__(self, source: Any, quantity: Quantity, slot: Slot | None, number: int, depth: float) -> None:
        self.title: Column = quantity.at(depth)
        self.source, self.quantity, self.slot, self.entity, self.depth = source, quantity, slot, number, depth
        self.start = slot.start + number * slot.size if slot is not None else 0


@dataclass(frozen=True)
class _Finished:
    """Columns whose numbers one call of ``Quantity.finish`` computes.

    quantity: one of them; span: the values in a sample; depths: (k,) of the entities [m].
    columns, entities, indices: (m,) of the columns: position in the row, entity, number of its result.
    """

    source: Any
    quantity: Quantity
    span: slice
    depths: FloatArray
    columns: list[int]
    entities: list[int]
    indices: list[int]

    @cached_property
    def by_entity(self) -> dict[int, list[tuple[int, int]]]:
        """Columns and numbers of the results of each entity."""
        found: dict[int, list[tuple[int, int]]] = {k: [] for k in sorted(set(self.entities))}
        for column, entity, index in zip(self.columns, self.entities, self.indices, strict=True):
            found[entity].append((column, index))
        return found

    def write(self, sample: FloatArray, row: FloatArray) -> None:
        """Compute the numbers from a sample and put them into a row."""
        q, values = self.quantity, sample[self.span]
        assert q.finish is not None
        if q.on == "probe":
            numbers = q.finish(self.source, values.reshape(-1, q.size), self.depths)
            row[self.columns] = numbers[self.entities, self.indices]
            return
        for k, places in self.by_entity.items():
            one = q.finish(self.source, values[k * q.size : (k + 1) * q.size], self.depths[k])
            for column, index in places:
                row[column] = one[index]

    def write_rows(self, samples: FloatArray, rows: FloatArray) -> None:
        """The same from samples (k, width) into rows (k, columns)."""
        q, count = self.quantity, len(samples)
        values = np.ascontiguousarray(samples[:, self.span])
        if q.on == "probe":
            assert q.finish is not None
            numbers = q.finish(self.source, values.reshape(-1, q.size), np.tile(self.depths, count))
            numbers = numbers.reshape(count, len(self.depths), -1)
            rows[:, self.columns] = numbers[:, self.entities, self.indices]
        elif q.finish_rows is not None:
            rows[:, self.columns] = q.finish_rows(self.source, values)[:, self.indices]
        else:
            for sample, row in zip(samples, rows, strict=True):
                self.write(sample, row)


class TableRow:
    """Computes the rows of a table from samples.  columns: of the table; depths: of the entities, by kind [m]."""

    def __init__(self, columns: Sequence[TableColumn], depths: dict[str, tuple[float, ...]]) -> None:
        self.width = len(columns)
        self._now: list[tuple[int, Any, Any]] = [
            (i, c.quantity.value, c.source) for i, c in enumerate(columns) if c.slot is None
        ]
        plain = [i for i, c in enumerate(columns) if c.slot is not None and c.quantity.finish is None]
        self._plain = np.array(plain, dtype=int)
        self._plain_at = np.array(
            [columns[i].start + (columns[i].quantity.index or 0) for i in plain], dtype=int
        )
        found: dict[tuple[Any, ...], _Finished] = {}
        for i, c in enumerate(columns):
            if c.slot is None or c.quantity.finish is None:
                continue
            key = id(c.source), c.quantity.finish, c.slot.start
            if key not in found:
                at = np.array(depths.get(c.quantity.on, (0.0,)))
                found[key] = _Finished(c.source, c.quantity, c.slot.span, at, [], [], [])
            found[key].columns.append(i)
            found[key].entities.append(c.entity)
            found[key].indices.append(c.quantity.index or 0)
        self._finished = list(found.values())

    def numbers_now(self) -> list[float]:
        """Numbers of a row that do not come from a sample, at the time of writing."""
        return [value(source, None) for _, value, source in self._now]

    def rows(self, samples: FloatArray, now: Sequence[Sequence[float]]) -> FloatArray:
        """(k, columns) rows from samples (k, width) and the ``numbers_now`` of each."""
        rows = np.empty((len(samples), self.width))
        rows[:, self._plain] = samples[:, self._plain_at]
        for group in self._finished:
            group.write_rows(samples, rows)
        rows[:, [i for i, _, _ in self._now]] = now
        return rows

    def numbers(self, sample: FloatArray) -> list[float]:
        """(width,) the numbers of a row."""
        row = np.empty(self.width)
        row[self._plain] = sample[self._plain_at]
        for group in self._finished:
            group.write(sample, row)
        for i, value, source in self._now:
            row[i] = value(source, None)
        return row.tolist()


def between(
    times: Sequence[float],
    samples: Sequence[FloatArray],
    due: FloatArray,
    last: np.ndarray,
    motion: np.ndarray,
) -> FloatArray:
    """(k, width) samples at the times ``due`` (k,) [s], each up to the sample of number ``last`` (k,).

    Motion by a parabola through three samples, everything else by a straight line; at the first sample and after the last one it is that.

    times: of the ``samples`` (width,) [s]; motion: places of the numbers that are interpolated as motion.
    """
    t, v = np.array(times), np.array(samples)
    first, before = np.maximum(last - 1, 0), np.maximum(last - 2, 0)
    out, inside = v[last], np.flatnonzero((due < t[last]) & (last > 0))
    if len(inside):
        i1, i0, s = last[inside], first[inside], due[inside]
        w = ((s - t[i0]) / (t[i1] - t[i0]))[:, None]
        out[inside] = (1 - w) * v[i0] + w * v[i1]
    curved = inside[last[inside] > 1]
    if len(curved) and len(motion):
        i1, i0, ia, s = last[curved], first[curved], before[curved], due[curved]
        t1, t0, ta = (t[i][:, None] for i in (i1, i0, ia))
        v1, v0, va = (v[i][:, motion] for i in (i1, i0, ia))
        second = ((v1 - v0) / (t1 - t0) - (v0 - va) / (t0 - ta)) / (t1 - ta)
        out[np.ix_(curved, motion)] += ((s - t[i0]) * (s - t[i1]))[:, None] * second
    return out
