"""Samples of a run after its steps, and rows of history.csv and probes.csv at the times between them."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import groupby
from typing import Any

import numpy as np
from petsc4py import PETSc

from drillpetsc.errors import CaseError
from drillpetsc.fem.component import FloatArray
from drillpetsc.fem.quantity import Quantity, Sample, Source
from drillpetsc.fem.step_record import StepRecord
from drillpetsc.model.drilling_model import DrillingModel, is_quasi_static
from drillpetsc.output.balances.energy_balance import EnergyBalance
from drillpetsc.output.balances.mass_balance import MassBalance
from drillpetsc.output.balances.time_error import TimeError
from drillpetsc.output.catalogue import in_order
from drillpetsc.output.files.tables import Column
from drillpetsc.output.measured.flow_recorder import flow_recorder
from drillpetsc.output.measured.probes import Probes
from drillpetsc.output.measured.rigid_items import RigidItems
from drillpetsc.output.measured.string_ends import DrilledHole, LowerEnd, TopEnd
from drillpetsc.output.quantities.history import POWERS, ROW_END, ROW_START, TIME
from drillpetsc.output.quantities.mud import CUTTINGS_FLOW, MUD_CONTENT, OUTLET_FLOW, PUMP_FLOW
from drillpetsc.output.quantities.probes import SIDE_FORCES
from drillpetsc.output.sensors.sensors import Sensors
from drillpetsc.output.table_rows import SampleLayout, TableColumn, TableRow, between
from drillpetsc.parallel import total, total_in_order
from drillpetsc.solvers.time.local_error import OutputErrors

STEPS_AT_ONCE = 256  # most steps whose outputs are computed together
#: the next step and the one after it, in next steps: a step at most doubles, and the last one before a stop is stretched a little.
#: With it, the three steps that a row is interpolated from are sampled
STEPS_AHEAD = 3.05


@dataclass
class Row:
    """Header of a row of the history: time [s], last step [s], its Newton iterations."""

    time: float = 0.0
    step: float = 0.0
    newton: float = 0.0

    def quantities(self) -> tuple[Quantity, ...]:
        return ROW_START + ROW_END


@dataclass(slots=True)
class _Step:
    """An accepted step whose outputs are not computed yet.

    time: of its end [s]; length: [s]; fresh: the first one of the formula; sampled: rows may need it.
    followed: energy that mud takes up at once [J].
    rows: times of the rows that are due after it [s]; newton: its Newton iterations.
    """

    time: float
    length: float
    fresh: bool
    sampled: bool
    followed: float
    rows: list[float] = field(default_factory=list)
    newton: float = 0.0


class Recorder:
    """Samples a model; every rank calls it and has the same values.

    Steps are recorded one by one and evaluated together, at the latest when their results are needed.

    columns, probe_columns: names and units of history.csv and probes.csv.
    energy: energy balance; None without inertia, because work then becomes motion that is not computed.
    mass: mass balance of the mud; None without mud.
    sensors: downhole sensors; None without any.
    """

    def __init__(self, model: DrillingModel) -> None:
        self.model, self.system = model, model.system
        self.comm = self.system.comm.tompi4py()
        self.probes = Probes(model)
        self.mud = flow_recorder(model)
        self.energy = None if is_quasi_static(model.case) else EnergyBalance(model.system)
        self._energies_at: float | None = None  # time [s] of the last row for which energies were taken
        self.mass = MassBalance() if self.mud is not None else None
        self.sensors = Sensors(model, self.mud) if model.case.output.sensors else None
        self._row = Row()
        joints = [j.depth for j in model.mesh.joints] if model.beam.moves else []
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
            [(self._row, TIME), *((self.probes, q) for q in self.probes.quantities())]
        )
        self._history_row = TableRow(self._history, self._depths)
        self._probe_row = TableRow(self._probe_table, self._depths)
        self.columns: list[Column] = [c.title for c in self._history]
        self.probe_columns: list[Column] = [c.title for c in self._probe_table]
        self._powers = self.layout.add(self.energy, POWERS).span if self.energy is not None else slice(0)
        self._wall_loads = self.layout.add(self._items, SIDE_FORCES[0]).span
        self._rates, self._content = np.zeros(0, dtype=int), 0
        if self.mud is not None:
            inputs = (PUMP_FLOW, OUTLET_FLOW, CUTTINGS_FLOW, MUD_CONTENT)
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
        #: rows that are due and not computed: samples at their times, and numbers of both tables taken at the time of writing
        self._kept: list[FloatArray] = []
        self._now: list[tuple[list[float], list[float]]] = []
        self._rows: list[tuple[FloatArray, FloatArray]] = []  # that are computed: of both tables
        self._keeps = False
        self._record = StepRecord(self.system, STEPS_AT_ONCE)  # steps whose outputs are not computed yet
        self._follow_hole()
        self._waiting: list[_Step] = []
        self._event = PETSc.Log.Event("Output")

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
        self,
        t: float,
        dt: float,
        next_row: float,
        inputs_at: float | None = None,
        fresh: bool = False,
        next_step: float | None = None,
    ) -> None:
        """Count an accepted step of ``dt`` [s] that ends at ``t`` [s]; collective.

        next_row: time at which a row is due next [s]; a step far from it is not sampled.
        inputs_at: time at which the step saw its inputs [s]: just before a jump if it ends on one.
        fresh: the first step of the time formula after a start; next_step: length of the next step [s], ``dt`` unless given.
        """
        seen, asm = t if inputs_at is None else inputs_at, self.system.assembly
        for f in asm.row_replacements:
            if f.owned:
                f.evaluate(seen, asm.x)
        sampled = t + STEPS_AHEAD * (dt if next_step is None else next_step) >= next_row
        if asm.kept is not None:
            self._add(seen, sampled)
        else:
            with asm.unchanged():
                self._add(seen, sampled)
        followed = self.energy.follow(t) if self.energy is not None else 0.0
        self._waiting.append(_Step(t, dt, fresh, sampled, followed))
        if len(self._waiting) >= self._record.capacity:
            self.catch_up()

    def _add(self, seen: float, sampled: bool) -> None:
        """Record the present state.  Arguments as of ``StepRecord.add``."""
        if self._record.is_open:
            self._ask(seen)
        self._record.add(seen, sampled)

    def rows_due(self, times: Sequence[float], t: float, newton: float, dt: float, keep: bool) -> None:
        """Note that rows at ``times`` [s] are due after the last step, to ``t`` [s]; collective.

        newton, dt: of the step, its Newton iterations and length [s]; keep: keep the rows for ``kept_rows``, on this rank.
        """
        self._keeps = keep
        if self._waiting and self._waiting[-1].time == t:
            self._waiting[-1].rows, self._waiting[-1].newton = list(times), newton
            return
        if self.energy is not None:
            self.energy.update(t)
            self._energies_at = t
        if self._keeps and times:
            self._note_rows(times, dt, newton)
            self._kept.append(np.array([self._at(t) for t in times]))

    @property
    def recorded(self) -> int:
        """Number of steps that are recorded and not evaluated."""
        return len(self._waiting)

    # ------------------------------------------------------------------ recorded steps
    def _ask(self, t: float) -> None:
        """Set the numbers that the outputs need from the record.  t: time of inputs [s]."""
        every = [*self._numbers, *self._arrays]
        main = [slot for _, slot in self._main] if self.time_error is not None else []
        balanced = {*self._rates, self._content} if self.mass is not None else set()
        if self.energy is not None:
            balanced.add(self._powers.start)
        self._first = [s for s in every if s.start in balanced or any(s is m for m in main)]
        self._others = [s for s in every if not any(s is f for f in self._first)]
        self._record.times = [t]
        with np.errstate(all="ignore"):
            self._evaluated()
        self._record.clear()

    def _evaluated(self) -> FloatArray:
        """(k, width + 3) samples and stored energies [J] of the recorded steps, this rank's share."""
        steps, width = self._record, self.layout.width
        out = np.zeros((len(steps), width + 3))
        for slot in self._first:
            out[:, slot.span] = slot.of(steps)
        if steps.is_open:
            steps.only_sampled()
        for slot in self._others:
            out[:, slot.span] = slot.of(steps)
        if self.energy is not None:
            out[:, width:] = self.system.energies_of(steps)
        return out

    def catch_up(self) -> None:
        """Evaluate the steps that wait: samples, balances, time error and rows; collective."""
        if not self._waiting:
            return
        self._event.begin()
        waiting, self._waiting = self._waiting, []
        with np.errstate(all="ignore"):  # steps that are not sampled have no numbers in some columns
            values = total_in_order(self.comm, self._evaluated())
        self._record.clear()
        width = self.layout.width
        samples = values[:, :width]
        rates, powers, energies = (
            part.tolist() for part in (samples[:, self._rates], samples[:, self._powers], values[:, width:])
        )
        content = samples[:, self._content].tolist()
        main = samples[:, self._main_at]
        times, rows = [], []  # of the rows: times, samples (in what follows) that they come before
        taken = [t for t, _ in self._samples], [v for _, v in self._samples]
        for k, step in enumerate(waiting):
            if step.sampled:
                taken[0].append(step.time)
                taken[1].append(samples[k])
            if self.mass is not None:
                self.mass.step(rates[k], step.length, step.fresh)
                self.mass.content = content[k]
            if self.energy is not None:
                self.energy.add(step.length, powers[k], step.followed)
            if self.time_error is not None:
                self.time_error.step(step.time, step.length, main[k], step.fresh)
            if step.rows:
                if self.energy is not None:
                    self.energy.take(energies[k])
                    self._energies_at = step.time
                times += step.rows
                rows += [len(taken[0]) - 1] * len(step.rows)
                self._note_rows(step.rows, step.length, step.newton)
        self._samples = deque(zip(*(part[-3:] for part in taken), strict=True), maxlen=3)
        if times and self._keeps:
            self._kept.append(between(*taken, np.array(times), np.array(rows), self._motion))
        self._event.end()

    def end_at(self, t: float) -> None:
        """Sample the end of the run, ``t`` [s], and take the energies there, if no row was due; collective."""
        self.catch_up()
        if self._samples and self._samples[-1][0] != t:
            self._samples.append((t, self.sample(t)))
        if self.energy is not None and self._energies_at != t:
            self.energy.update(t)
            self._energies_at = t

    def forget_waiting(self) -> None:
        """Drop the steps that wait: their outputs are lost."""
        self._waiting = []
        self._record.clear()

    def _note_rows(self, times: Sequence[float], dt: float, newton: float) -> None:
        """Keep the numbers of rows at ``times`` [s] that do not come from a sample."""
        if self._keeps:
            for t in times:
                self._row.time, self._row.step, self._row.newton = t, dt, newton
                self._now.append((self._history_row.numbers_now(), self._probe_row.numbers_now()))

    def tell_energy(self, event: Callable[[EnergyBalance, float], None], t: float) -> None:
        """Let the energy balance, if there is one, take an ``event`` at ``t`` [s] after the steps that wait."""
        self.catch_up()
        if self.energy is not None:
            event(self.energy, t)

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
        """Volumes of mud since the start [m3]; empty without mud."""
        self.catch_up()
        return {} if self.mass is None else self.mass.balance()

    def rigid_items(self, top: float) -> list[dict[str, Any]]:
        """Name, measured depth [m] and forces of the wall of every rigid item, at the last sample.

        top: measured depth of the upper end of the unstrained string [m].
        """
        self.catch_up()
        return self._items.listed(self._samples[-1][1][self._wall_loads], top)

    # ------------------------------------------------------------------ checkpoints
    def get_state(self) -> dict[str, FloatArray]:
        """Data for a continued run, the same on all ranks; collective."""
        self.catch_up()
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
        by a straight line.  Collective."""
        self.catch_up()
        return self._at(t)

    def _at(self, t: float) -> FloatArray:
        times, samples = zip(*self._samples, strict=True)
        return between(times, samples, np.array([t]), np.array([len(times) - 1]), self._motion)[0]

    def history_row(self, t: float, step: float, newton: float) -> list[float]:
        """Row of history.csv at ``t`` [s]; step, newton: last step [s] and its Newton iterations.  Collective."""
        self._row.time, self._row.step, self._row.newton = t, step, newton
        return self._history_row.numbers(self.at(t))

    @property
    def kept(self) -> int:
        """Number of rows kept."""
        return len(self._now) + sum(len(rows) for rows, _ in self._rows)

    def kept_rows(self) -> tuple[FloatArray, FloatArray]:
        """(k, columns) rows of history.csv and of probes.csv that have been kept, which are then forgotten."""
        self._compute_rows()
        history, probes = (np.concatenate(parts) for parts in zip(*self._rows, strict=True))
        self._rows = []
        return history, probes

    def _compute_rows(self) -> None:
        """Compute the rows of the samples that have been kept."""
        if self._now:
            history, probes = zip(*self._now, strict=True)
            values = np.concatenate(self._kept)
            self._kept, self._now = [], []
            self._rows.append((self._history_row.rows(values, history), self._probe_row.rows(values, probes)))

    def _follow_hole(self) -> None:
        """Find places in a hole that grows in the hole at their time."""
        bit = self.model.bit
        if bit is not None and bit.hole is not None:
            bit.hole.before_change.append(self._before_hole_changes)

    def _before_hole_changes(self) -> None:
        self.catch_up()
        self._compute_rows()
