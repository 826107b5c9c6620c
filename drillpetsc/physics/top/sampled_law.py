"""The laws of built-in speed controllers in a computer that samples: held output, delay, limits (manual: sec-top-drive-sampled)."""

from __future__ import annotations

import math
from collections.abc import Mapping, MutableMapping, Sequence

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.physics.top.control import Law, Motor


class SampledLaw:
    """Torque of a controller from the measurements at its samples; it acts until the next sample.

    laws: by the time from which they act; delays: of their output [s], multiples of ``sample`` [s].
    motor: its limits stop the integrator.
    """

    def __init__(self, laws: Sequence[Law], delays: Sequence[float], sample: float, motor: Motor) -> None:
        self.laws, self.sample, self.motor = tuple(laws), sample, motor
        self._late = [round(delay / sample) for delay in delays]
        self._starts = np.array([law.start for law in laws])

    def phase(self, t: float) -> int:
        """Number of the law that acts at the sample ``t`` [s]."""
        return max(0, int(np.searchsorted(self._starts, t + 1e-6 * self.sample, side="right")) - 1)

    def torque(self, t: float, measured: Mapping[str, float], memory: MutableMapping[str, float]) -> float:
        """Return the torque [N m] from the sample ``t`` [s] on.

        measured: top_speed, set_point [rad/s], motor_torque, pipe_torque, start_torque [N m].
        memory: numbers by name, kept from sample to sample.
        """
        k, h = self.phase(t), self.sample
        law, speed = self.laws[k], measured["top_speed"]
        if "integral" not in memory:
            self._begin(measured, memory)
        acceleration = (speed - memory["speed"]) / h
        memory["speed"] = speed
        error = measured["set_point"] - speed - law.coupling * self._filtered(measured, acceleration, memory)
        free = law.p * error + law.compensation * acceleration  # without the integral
        if memory["phase"] != k:
            memory["phase"] = float(k)
            memory["integral"] = memory["output"] - free if law.i else 0.0
        else:
            integral = memory["integral"] + law.i * error * h
            wanted, low, high = free + integral, *self._limits(speed)
            if low <= wanted <= high or (wanted > high and error < 0) or (wanted < low and error > 0):
                memory["integral"] = integral
        memory["output"] = free + memory["integral"]
        return self._delayed(memory["output"], self._late[k], memory)

    def _begin(self, measured: Mapping[str, float], memory: MutableMapping[str, float]) -> None:
        """Integrator, filters and delayed outputs at the first sample carry the static torque."""
        start = measured["start_torque"]
        estimated = any(law.filters and law.estimated for law in self.laws)
        values = {
            "integral": start if self.laws[0].i else 0.0,
            "low_passed": 0.0 if estimated else start,
            "high_passed": start,
            "speed": measured["top_speed"],
            "output": start,
            "phase": 0.0,
        }
        memory.update(values)
        for n in range(max(self._late)):
            memory[f"late.{n}"] = start

    def _filtered(
        self, measured: Mapping[str, float], acceleration: float, memory: MutableMapping[str, float]
    ) -> float:
        """Low-passed and high-passed torque of the pipe [N m]; 0 for laws without filters, while the filters go on."""
        law = next((q for q in self.laws if q.filters), None)
        if law is None:
            return 0.0
        source = self.motor.inertia * acceleration if law.estimated else measured["pipe_torque"]
        memory["low_passed"] += self._share(law.low_pass) * (source - memory["low_passed"])
        torque = memory["low_passed"]
        if law.estimated:
            torque = measured["motor_torque"] - torque
        memory["high_passed"] += self._share(law.high_pass) * (torque - memory["high_passed"])
        return torque - memory["high_passed"] if law.high_pass else torque

    def _share(self, constant: float) -> float:
        """Share of the way to its input that a filter of first order goes in a sample."""
        return 1.0 - math.exp(-self.sample / constant) if constant > 0 else 1.0

    def _limits(self, speed: float) -> tuple[float, float]:
        """Least and largest torque of the motor at ``speed`` [rad/s]."""
        m = self.motor
        if not m.max_torque:
            return -math.inf, math.inf
        most = m.power / abs(speed) if m.power and speed else math.inf
        return max(m.min_torque, -most), min(m.max_torque, most)

    def _delayed(self, output: float, late: int, memory: MutableMapping[str, float]) -> float:
        """The output of ``late`` samples ago; the last outputs are kept for the longest delay of all laws."""
        kept = max(self._late)
        row = [output, *(memory[f"late.{n}"] for n in range(kept))]
        for n in range(kept):
            memory[f"late.{n}"] = row[n]
        return row[late]


class SampledTorque:
    """An input over time (``drillpetsc.time_function``) that is constant between samples.

    torque: now [N m]; kind: of the controller that acts; memory: numbers by name that the controller keeps from sample to sample.
    measured: (2,) torque of the motor and on the pipe at the end of the last step [N m]; resumed: they come from a checkpoint,
    which has no accelerations to compute them from.
    """

    def __init__(self) -> None:
        self.torque, self.kind = 0.0, "python"
        self.memory: dict[str, float] = {}
        self.measured, self.resumed = np.zeros(2), False

    def value(self, t: float, before: bool = False) -> float:
        return self.torque

    def rate(self, t: float, before: bool = False) -> float:
        return 0.0

    def integral(self, t: float) -> float:
        return self.torque * t

    def breaks(self) -> tuple[float, ...]:
        return ()

    def jumps(self) -> tuple[float, ...]:
        return ()

    def get_state(self) -> dict[str, FloatArray]:
        """Torque and memory for a checkpoint."""
        out = {f"memory.{name}": np.array([value]) for name, value in self.memory.items()}
        return {"torque": np.array([self.torque]), "measured": self.measured.copy()} | out

    def set_state(self, state: dict[str, FloatArray]) -> None:
        """Continue from ``get_state``."""
        self.torque = float(np.ravel(state["torque"])[0])
        if "measured" in state:
            self.measured, self.resumed = np.array(state["measured"]), True
        self.memory.clear()
        for name, value in state.items():
            if name.startswith("memory."):
                self.memory[name.removeprefix("memory.")] = float(np.ravel(value)[0])
