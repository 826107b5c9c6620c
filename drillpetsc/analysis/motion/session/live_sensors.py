"""Sensors of a session: their latest samples, as outputs named SENSOR.COLUMN (manual: sec-session)."""

from __future__ import annotations

from drillpetsc.analysis.motion.checkpoint import Checkpoint
from drillpetsc.output.sensors.sensors import Sensors


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
