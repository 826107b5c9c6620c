"""Samples of a run after its steps, and rows of history.csv and probes.csv at the times between them."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import groupby
from typing import Any

import numpy as np

from drillpetsc.errors import CaseError
from drillpetsc.fem.component import FloatArray
from drillpetsc.fem.quantity import Quantity, Sample, Source
from drillpetsc.model.drilling_model import DrillingModel, is_quasi_static
from drillpetsc.output import quantities as declared
from drillpetsc.output.catalogue import in_order
from drillpetsc.output.energy_balance import EnergyBalance
from drillpetsc.output.files.tables import Column
from drillpetsc.output.flow_recorder import FlowRecorder
from drillpetsc.output.mass_balance import MassBalance
from drillpetsc.output.probes import Probes
from drillpetsc.output.rigid_items import RigidItems
from drillpetsc.output.sensors.sensors import Sensors
from drillpetsc.output.string_ends import DrilledHole, LowerEnd, TopEnd
from drillpetsc.output.time_error import TimeError
from drillpetsc.parallel import total
from drillpetsc.solvers.local_error import OutputErrors

STEPS_AHEAD = 3.0  # a step at most doubles: with it, the step before the one that passes a row is sampled


@dataclass
class Row:
    """What a row of the history contains about itself: time [s], last step [s], its Newton iterations."""

    time: float = 0.0
    step: float = 0.0
    newton: float = 0.0

    def quantities(self) -> tuple[Quantity, ...]:
        return declared.ROW_START + declared.ROW_END


@dataclass(frozen=True)
class Slot:
    """Part ``span`` of a sample that one value fills, with ``size`` numbers per entity.  Quantities with the same
    value share a slot.

    is_number: the value is a number, not an array.
    """

    source: Any
    value: Callable[[Any, Sample], Any]
    span: slice
    size: int
    motion: bool
    is_number: bool

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
            self.slots[key] = Slot(source, quantity.value, span, quantity.size, motion, is_number)
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
    """A column of a table: a quantity, of one joint, probe or rigid item where it has several.

    slot: of the sampled value; None where the value is that at the time of writing.
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
        self._now = [(i, c.quantity.value, c.source) for i, c in enumerate(columns) if c.slot is None]
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
        return [value(source, None) for _, value, source in self._now]  # type: ignore[misc]

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
            row[i] = value(source, None)  # type: ignore[misc]
        return row.tolist()


class Recorder:
    """Samples a model; every rank calls it and has the same values.

    columns, probe_columns: names and units of history.csv and probes.csv.
    energy: energy balance; None without inertia, where work goes into motion that is not computed.
    mass: mass balance of the mud; None without mud.
    sensors: downhole sensors; None without any.
    """

    def __init__(self, model: DrillingModel) -> None:
        self.model, self.system = model, model.system
        self.comm = self.system.comm.tompi4py()
        self.probes = Probes(model)
        self.mud = FlowRecorder(model.system, model.fluid) if model.fluid is not None else None
        self.energy = None if is_quasi_static(model.case) else EnergyBalance(model.system)
        self.mass = MassBalance() if self.mud is not None else None
        self.sensors = Sensors(model, self.mud) if model.case.output.sensors else None
        self._row = Row()
        joints = [j.depth for j in model.mesh.joints] if model.beam is not None else []
        self._items = RigidItems(model)
        self._depths = {
            "joint": tuple(joints),
            "probe": self.probes.depths,
            "rigid_item": self._items.depths,
        }
        self.layout = SampleLayout({"scalar": 1, **{on: len(d) for on, d in self._depths.items()}})
        sources = (self._row, TopEnd(model), *model.components, LowerEnd(model), DrilledHole(model))
        optional = tuple(s for s in (self.mud, self._items, self.energy) if s is not None)
        declared_by: list[tuple[Source, Quantity]] = [
            (source, q)
            for source in (*sources, *optional)
            for q in source.quantities()
            if q.on in ("scalar", "joint", "rigid_item")
        ]
        self._history = self._table(in_order(declared_by, "history.csv"))
        self._probe_table = self._table(
            [(self._row, declared.TIME), *((self.probes, q) for q in self.probes.quantities())]
        )
        self._history_row = TableRow(self._history, self._depths)
        self._probe_row = TableRow(self._probe_table, self._depths)
        self.columns: list[Column] = [c.title for c in self._history]
        self.probe_columns: list[Column] = [c.title for c in self._probe_table]
        self._powers = (
            self.layout.add(self.energy, declared.POWERS).span if self.energy is not None else slice(0)
        )
        self._side_forces = self.layout.add(self._items, declared.SIDE_FORCE).span
        self._rates, self._content = np.zeros(0, dtype=int), 0
        if self.mud is not None:
            inputs = (declared.PUMP_FLOW, declared.OUTLET_FLOW, declared.CUTTINGS_FLOW, declared.MUD_CONTENT)
            *rates, self._content = (self.layout.add(self.mud, q).start for q in inputs)
            self._rates = np.array(rates)
        self._motion = self.layout.motion()
        filled = [s for s in self.layout.slots.values() if s.span.stop > s.span.start]
        self._numbers, self._arrays = ([s for s in filled if s.is_number is kind] for kind in (True, False))
        self._number_at = np.array([s.start for s in self._numbers], dtype=int)
        main = [c for c in self._history if c.quantity.interest and c.quantity.on == "scalar"]
        self._main = [(c, slot) for c in main if (slot := self.layout.slot_at(c.start)) is not None]
        spans = [np.arange(slot.span.start, slot.span.stop) for _, slot in self._main]
        self._main_at = np.concatenate([np.zeros(0, dtype=int), *spans])  # in a sample
        #: estimated time error of the main outputs; None without an estimate
        self.time_error: TimeError | None = None
        self._samples: deque[tuple[float, FloatArray]] = deque(maxlen=3)
        self._kept: list[tuple[FloatArray, list[float], list[float]]] = []  # see ``keep_row``
        #: the last time and result of ``at``, which all tables share, and the last sample then
        self._found: tuple[float, FloatArray, FloatArray] | None = None

    def _table(self, pairs: Sequence[tuple[Source, Quantity]]) -> list[TableColumn]:
        """Columns of (source, quantity) pairs; neighbours on joints or probes are ordered by depth first."""
        columns = []
        for on, group in groupby(pairs, key=lambda pair: pair[1].on):
            together = [
                (source, q, None if q.interpolate == "none" else self.layout.add(source, q))
                for source, q in group
            ]
            for number, depth in enumerate(self._depths.get(on, (0.0,))):
                columns += [TableColumn(source, q, slot, number, depth) for source, q, slot in together]
        return columns

    @property
    def history_columns(self) -> tuple[TableColumn, ...]:
        """Columns of history.csv."""
        return tuple(self._history)

    def row_of(self, columns: Sequence[TableColumn]) -> TableRow:
        """A row of some columns of history.csv."""
        return TableRow(columns, self._depths)

    # ------------------------------------------------------------------ sampling
    def sample(self, t: float) -> FloatArray:
        """(width,) all sampled values at the assembly's state and inputs at ``t`` [s], the same on all ranks."""
        sample, v = Sample(self.system, t), np.zeros(self.layout.width)
        with self.system.assembly.unchanged():
            v[self._number_at] = [slot.value(slot.source, sample) for slot in self._numbers]
            for slot in self._arrays:
                v[slot.span] = slot.value(slot.source, sample).ravel()
        return np.asarray(total(self.comm, v))

    def value(self, sample: FloatArray, name: str) -> float:
        """The number of the history's column ``name`` in a sample, e.g. ``hook_load``."""
        return self._history_row.numbers(sample)[[c.title[0] for c in self._history].index(name)]

    def start(self, t: float) -> None:
        """Start the energy and mass balances at the present state."""
        v = self.sample(t)
        self._samples.append((t, v))
        if self.sensors is not None:
            self.sensors.start(t)
        if self.mass is not None:
            self.mass.start(float(v[self._content]))
        if self.energy is not None:
            self.energy.start(t, self._powers_of(v))

    def step(
        self, t: float, dt: float, next_row: float, inputs_at: float | None = None, fresh: bool = False
    ) -> None:
        """Count an accepted step of ``dt`` [s] that ends at ``t`` [s]; collective.

        next_row: time at which a row is due next [s]; a step far from it is not sampled, unless there is mud.
        inputs_at: time at which the step saw its inputs [s]: just before a jump where it ends on one.
        fresh: the first step of the time formula after a start.
        """
        seen = t if inputs_at is None else inputs_at
        if t + STEPS_AHEAD * dt >= next_row or self.mass is not None:
            v = self.sample(seen)
            self._samples.append((t, v))
            if self.mass is not None:
                self.mass.step(v[self._rates], dt, fresh)
            if self.energy is not None:
                self.energy.step(t, dt, self._powers_of(v))
        elif self.energy is not None:
            self.energy.step(t, dt, self.system.powers(seen))

    def estimate_time_error(self, formula: OutputErrors) -> None:
        """Estimate the time error of the main outputs of a run with this time formula."""
        titles = [c.title for c, _ in self._main]
        sizes = [slot.span.stop - slot.start for _, slot in self._main]
        if titles:
            self.time_error = TimeError(formula, [t[0] for t in titles], [t[1] for t in titles], sizes)

    def count_time_error(self, t: float, dt: float, inputs_at: float, fresh: bool) -> None:
        """Count an accepted step in the estimate of the time error, after ``step``; collective."""
        if self.time_error is not None:
            self.time_error.step(t, dt, self._main_values(t, inputs_at), fresh)

    def _main_values(self, t: float, inputs_at: float) -> FloatArray:
        """Values of the main outputs at ``t`` [s], the same on all ranks; from the last sample, if it is of this time."""
        if self._samples and self._samples[-1][0] == t:
            return self._samples[-1][1][self._main_at]
        sample, parts = Sample(self.system, inputs_at), []
        for _, slot in self._main:
            values = slot.value(slot.source, sample)
            parts.append(np.array([values]) if slot.is_number else np.asarray(values, dtype=float).ravel())
        v = np.concatenate(parts)
        return np.asarray(total(self.comm, v))

    def _powers_of(self, sample: FloatArray) -> tuple[float, float]:
        """Dissipated and supplied power [W] in a sample."""
        dissipated, supplied = sample[self._powers]
        return float(dissipated), float(supplied)

    def mass_balance(self) -> dict[str, float]:
        """Volumes of mud since the start [m3], at the last sample; empty without mud."""
        if self.mass is None:
            return {}
        return self.mass.balance(float(self._samples[-1][1][self._content]))

    def rigid_items(self, top: float) -> list[dict[str, Any]]:
        """Name, measured depth [m] and side force [N] of every rigid item, at the last sample.

        top: measured depth of the upper end of the unstrained string [m].
        """
        return self._items.listed(self._samples[-1][1][self._side_forces], top)

    # ------------------------------------------------------------------ checkpoints
    def get_state(self) -> dict[str, FloatArray]:
        """What a continued run needs, the same on all ranks."""
        samples = {"samples": np.array([[t, *v] for t, v in self._samples])}
        energy = self.energy.get_state() if self.energy is not None else {}
        error = self.time_error.get_state() if self.time_error is not None else {}
        sensors = self.sensors.get_state() if self.sensors is not None else {}
        return energy | samples | error | sensors | (self.mass.get_state() if self.mass is not None else {})

    def set_state(self, saved: dict[str, FloatArray]) -> None:
        """Continue from a checkpoint; raises CaseError if the run that wrote it had other probes."""
        if saved["samples"].shape[1] != 1 + self.layout.width:
            raise CaseError(at="output.probes", want="the probes of the run that is continued")
        self._samples.extend((float(row[0]), np.array(row[1:])) for row in saved["samples"])
        if self.energy is not None:
            self.energy.set_state(saved)
        if self.mass is not None:
            self.mass.set_state(saved)
        if self.time_error is not None:
            self.time_error.set_state(saved)
        if self.sensors is not None:
            self.sensors.set_state(saved)

    # ------------------------------------------------------------------ rows
    def at(self, t: float) -> FloatArray:
        """Sample at an output time within the last step: motion by a parabola through three steps, everything else
        by a straight line."""
        t1, v1 = self._samples[-1]
        if len(self._samples) == 1 or t >= t1:
            return v1
        if self._found is not None and self._found[0] == t and self._found[2] is v1:
            return self._found[1]
        t0, v0 = self._samples[-2]
        w = (t - t0) / (t1 - t0)
        out = (1 - w) * v0 + w * v1
        if len(self._samples) == 3:
            ta, va = self._samples[0]
            second = ((v1 - v0) / (t1 - t0) - (v0 - va) / (t0 - ta)) / (t1 - ta)
            bend = (t - t0) * (t - t1) * second
            out[self._motion] += bend[self._motion]
        self._found = t, out, v1
        return out

    def history_row(self, t: float, step: float, newton: float) -> list[float]:
        """Row of history.csv at ``t`` [s]; step, newton: last step [s] and its Newton iterations."""
        self._row.time, self._row.step, self._row.newton = t, step, newton
        return self._history_row.numbers(self.at(t))

    def keep_row(self, t: float, step: float, newton: float) -> None:
        """Keep what the rows of both tables at ``t`` [s] need, for ``kept_rows``; arguments as for ``history_row``."""
        self._row.time, self._row.step, self._row.newton = t, step, newton
        self._kept.append((self.at(t), self._history_row.numbers_now(), self._probe_row.numbers_now()))

    @property
    def kept(self) -> int:
        """Number of rows kept."""
        return len(self._kept)

    def kept_rows(self) -> tuple[FloatArray, FloatArray]:
        """(k, columns) rows of history.csv and of probes.csv that have been kept, which are then forgotten."""
        samples, history, probes = zip(*self._kept, strict=True)
        self._kept, values = [], np.array(samples)
        return self._history_row.rows(values, history), self._probe_row.rows(values, probes)

    def probe_row(self, t: float) -> list[float]:
        """Row of probes.csv at ``t`` [s]."""
        self._row.time = t
        return self._probe_row.numbers(self.at(t))
