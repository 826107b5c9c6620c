"""What a multistep formula knows of earlier steps, so that a run continued from a checkpoint takes the steps
of one that never stopped.

PETSc shows nobody the history of its BDF.  The accepted states are therefore noted here, and a continued run
steps through them with a solver that only hands out what was noted: TSBDF then holds the same times and
vectors, bit for bit.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.discrete_system import DiscreteSystem

State = tuple[FloatArray, FloatArray]  # unknowns and rates (n+1,) of an assembly


@dataclass
class BdfHistory:
    """Accepted states since the formula was started, the last ``depth`` of them.

    depth: a formula of order p, its predictor and its error estimate see p + 1 earlier states.  times [s];
    steps [s]: what PETSc was asked for from each state to the next, which is not the rounded difference of
    the times; half: the state in the middle of the first step, which TSBDF computes at each start and sees
    until it has enough others.
    """

    depth: int
    times: list[float] = field(default_factory=list)
    steps: list[float] = field(default_factory=list)
    states: list[State] = field(default_factory=list)
    half: State | None = None
    _solved: list[State] = field(default_factory=list)

    def begin(self, t: float, x: FloatArray, y: FloatArray) -> None:
        """The formula starts afresh from this state."""
        self.times, self.steps, self.states, self.half, self._solved = (
            [t],
            [],
            [(x.copy(), y.copy())],
            None,
            [],
        )

    def solved(self, x: FloatArray, y: FloatArray) -> None:
        """A stage was solved for; of the first step the two last stages count, the half and the whole one."""
        if len(self.states) == 1:
            self._solved = [*self._solved[-1:], (x.copy(), y.copy())]

    def add(self, t: float, step: float, x: FloatArray, y: FloatArray) -> None:
        """A step was accepted."""
        if len(self._solved) == 2:
            self.half = self._solved[0]
        self._solved = []
        self.times.append(t)
        self.steps.append(step)
        self.states.append((x.copy(), y.copy()))
        if len(self.states) > self.depth:
            self.half = None  # out of sight
            del self.times[0], self.steps[0], self.states[0]

    # ------------------------------------------------------------------ checkpoints
    def get_state(self, system: DiscreteSystem) -> dict[str, FloatArray]:
        """times (k,), steps (k - 1,), states (k or k + 1, 2, nodes, m): unknowns and rates of all fields, the
        half step last; on rank 0. Collective.  Empty before the first start."""
        if not self.states:
            return {}
        states = self.states if self.half is None else [*self.states, self.half]
        columns = [_nodal(system, part) for state in states for part in state]
        whole = system.gather(np.stack(columns, axis=1))
        if whole is None:
            return {}
        whole = whole.reshape(len(whole), len(states), 2, -1)
        return {
            "times": np.array(self.times),
            "steps": np.array(self.steps),
            "states": np.moveaxis(whole, 0, 2),
        }

    def set_state(self, system: DiscreteSystem, memory: dict[str, FloatArray]) -> None:
        """Take up a checkpoint's memory."""
        self.times, self.steps = memory["times"].tolist(), memory["steps"].tolist()
        states = [
            (_local(system, x, system.assembly.x), _local(system, y, system.assembly.y))
            for x, y in memory["states"]
        ]
        self.states, rest = states[: len(self.times)], states[len(self.times) :]
        self.half, self._solved = (rest[0] if rest else None), []


def _nodal(system: DiscreteSystem, values: FloatArray) -> FloatArray:
    """(nv, m) of local values (n+1,): all components of all fields, zero where a field is absent."""
    places = np.hstack([system.layout.dofs[f.name] for f in system.layout.fields])
    return np.where(places >= 0, values[np.maximum(places, 0)], 0.0)


def _local(system: DiscreteSystem, whole: FloatArray, like: FloatArray) -> FloatArray:
    """(n+1,) local values from (nodes, m) of ``_nodal``; the place behind the last as in ``like``."""
    places = np.hstack([system.layout.dofs[f.name] for f in system.layout.fields])
    out = like.copy()
    out[places[places >= 0]] = whole[system.chain.vertices][places >= 0]
    return out
