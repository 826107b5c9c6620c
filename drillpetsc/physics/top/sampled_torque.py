"""Torque of a motor that a controller sets at its samples and that is held in between."""

from __future__ import annotations

import numpy as np

from drillpetsc.arrays import FloatArray


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
