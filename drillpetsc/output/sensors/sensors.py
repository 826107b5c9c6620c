"""All sensors of a run: records after every step, samples on the first rank (manual: sec-vibration-sensors)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.sensors import STEPS_PER_PERIOD
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output.files.tables import Column, Table
from drillpetsc.output.measured.flow_recorder import FlowRecorder
from drillpetsc.output.sensors.files import open_samples, sensor_file
from drillpetsc.output.sensors.samples import AT_ONCE, Sampler
from drillpetsc.output.sensors.section import SensorSection

BLOCK = 256  # steps that are recorded before they are sampled
_RAW_ACCELERATIONS = slice(28, 42)  # in a raw record


class Sensors:
    """The sensors of a case; every rank calls it, the first one has the samples.

    model: the drilling model; mud: None without mud.
    """

    def __init__(self, model: DrillingModel, mud: FlowRecorder | None) -> None:
        self.model, self.comm = model, model.system.comm.tompi4py()
        case = model.case
        given = case.output.sensors
        self.sections = [SensorSection(model, sensor, mud) for sensor in given]
        channels = tuple(mud.channels()) if mud is not None else ()
        self.samplers = [
            Sampler(
                s, np.array(case.gravity), p.stiffness, p.curvature, channels, case.output.indices is not None
            )
            for s, p in zip(given, self.sections, strict=True)
        ]
        self._times: list[float] = []
        self._starts: list[list[FloatArray]] = []
        self._ends: list[list[FloatArray]] = []
        self._now: list[FloatArray] = []
        self._saved: list[FloatArray] = []  # raw records at the last sampled step, on the first rank
        self._longest = np.zeros(len(given))  # longest step [s] that each sensor does not resolve
        self._coarse = np.zeros(len(given))  # time in such steps [s]
        self._over = 0.0  # time of all steps [s]
        self._files: list[Any] = []

    def _raw(self) -> list[FloatArray]:
        return [p.raw() for p in self.sections if p.is_here]

    def start(self, t: float) -> None:
        """Record the present state at the time ``t`` [s]."""
        self._times, self._now = [t], self._raw()

    def begin_at(self, t: float) -> None:
        """Let the first samples be those after a start at another time than 0 [s]."""
        for sampler in self.samplers:
            sampler.next = int(np.ceil(t * sampler.sensor.rate * (1 - 1e-12)))

    def renew(self) -> None:
        """Record the state once more after the unknowns of the last step were written in other reference frames."""
        now = self._raw()
        for new, old in zip(now, self._now, strict=True):
            new[_RAW_ACCELERATIONS] = old[_RAW_ACCELERATIONS]
        self._now = now

    def step(self, t: float, dt: float, fresh: bool) -> bool:
        """Record an accepted step of ``dt`` [s] that ends at ``t`` [s]; True if samples should be taken.

        fresh: the first step of the time formula after a start or a jump, whose initial acceleration is unknown.
        """
        ends = self._raw()
        if fresh:
            self._now = [now.copy() for now in self._now]
            for start, end in zip(self._now, ends, strict=True):
                start[_RAW_ACCELERATIONS] = end[_RAW_ACCELERATIONS]
        self._starts.append(self._now)
        self._ends.append(ends)
        self._times.append(t)
        self._now = ends
        self._over += dt
        for i, sampler in enumerate(self.samplers):
            if dt * STEPS_PER_PERIOD * sampler.sensor.finest > 1 + 1e-9:
                self._longest[i] = max(self._longest[i], dt)
                self._coarse[i] += dt
        waiting = (t - self._times[0]) * max(sampler.sensor.rate for sampler in self.samplers)
        return len(self._ends) >= BLOCK or waiting > AT_ONCE

    def take(self) -> list[FloatArray]:
        """Samples of the recorded steps, an array (k, columns) for each sensor; empty on other ranks; collective."""
        here = [i for i, p in enumerate(self.sections) if p.is_here]
        parts: dict[int, tuple[FloatArray, ...]] = {}
        for j, i in enumerate(here):
            if self._ends:
                records = tuple(
                    self.sections[i].section(np.stack([row[j] for row in rows]))
                    for rows in (self._starts, self._ends)
                )
            else:
                records = (np.zeros((0, 0)),) * 2
            parts[i] = (*records, self._now[j])
        gathered = [parts] if self.comm.size == 1 else self.comm.gather(parts)
        times = np.array(self._times)
        self._starts, self._ends, self._times = [], [], self._times[-1:]
        if gathered is None:
            return []
        every = {i: part for found in gathered for i, part in found.items()}
        self._saved = [every[i][2] for i in range(len(self.samplers))]
        if len(times) < 2:
            return [np.zeros((0, len(s.columns))) for s in self.samplers]
        return [s.samples(times, every[i][0], every[i][1]) for i, s in enumerate(self.samplers)]

    # ------------------------------------------------------------------ files, on the first rank
    def files(self, folder: Path, continued: bool = True) -> list[tuple[Path, list[Column], float]]:
        """File, columns and rate [Hz] of every sensor in a run folder."""
        end = float(self.model.case.given_time.end)
        return [
            (sensor_file(folder, s.sensor.name, s.sensor.rate * end, continued), s.columns, s.sensor.rate)
            for s in self.samplers
        ]

    def open(self, folder: Path, restart_time: float | None) -> None:
        """Open the files in a run folder, new, or continued at a time [s]."""
        self._files = [
            open_samples(path, columns, restart_time)
            for path, columns, _ in self.files(folder, restart_time is not None)
        ]

    def write(self, samples: list[FloatArray]) -> None:
        """Append samples to the files."""
        for file, rows in zip(self._files, samples, strict=False):
            file.add_rows(rows)

    @property
    def tables(self) -> list[Table]:
        """The files of samples that are tables."""
        return [file for file in self._files if isinstance(file, Table)]

    def flush(self) -> None:
        """Wait until the disk has every sample."""
        for file in self._files:
            file.flush()

    def close(self) -> None:
        for file in self._files:
            file.close()

    # ------------------------------------------------------------------ what the summary says
    def summary(self) -> list[dict[str, Any]]:
        """Name, place, samples and resolved frequency of each sensor."""
        out = []
        for i, (s, p) in enumerate(zip(self.samplers, self.sections, strict=True)):
            row: dict[str, Any] = {
                "name": s.sensor.name,
                "md": p.depth,
                "rate": s.sensor.rate,
                "samples": s.next,
            }
            row["finest"] = s.sensor.finest
            coarse = self._longest[i] > 0
            row["resolved_to"] = 1 / (STEPS_PER_PERIOD * self._longest[i]) if coarse else s.sensor.finest
            row["coarse_share"] = self._coarse[i] / self._over if self._over else 0.0
            if s.sensor.range is not None:
                row["clipped"] = s.clipped
            out.append(row)
        return out

    def rows(self) -> list[dict[str, Any]]:
        """``summary`` with the range [m/s2] of each sensor, None without one, and the longest step [s] that resolves its content."""
        return [
            {
                **row,
                "range": s.sensor.range,
                "longest_step": 1 / (STEPS_PER_PERIOD * row["finest"]),
            }
            for row, s in zip(self.summary(), self.samplers, strict=True)
        ]

    # ------------------------------------------------------------------ checkpoints
    def get_state(self) -> dict[str, FloatArray]:
        """Data for a continued run, after ``take``; complete on the first rank."""
        out = {"sensors_steps": np.concatenate([[self._times[-1], self._over], self._longest, self._coarse])}
        for i, (sampler, raw) in enumerate(zip(self.samplers, self._saved, strict=False)):
            out[f"sensor_{i}"], out[f"sensor_{i}_record"] = sampler.get_state(), raw
        return out

    def set_state(self, saved: dict[str, FloatArray]) -> None:
        """Continue from a checkpoint; steps that are recorded and not sampled are forgotten."""
        self._starts, self._ends = [], []
        steps, n = saved["sensors_steps"], len(self.samplers)
        self._times, self._over = [float(steps[0])], float(steps[1])
        self._longest, self._coarse = np.array(steps[2 : 2 + n]), np.array(steps[2 + n : 2 + 2 * n])
        for i, sampler in enumerate(self.samplers):
            sampler.set_state(saved[f"sensor_{i}"])
        self._now = [np.array(saved[f"sensor_{i}_record"]) for i, p in enumerate(self.sections) if p.is_here]
