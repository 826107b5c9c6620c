"""BDF history for checkpoints: a restarted run reproduces an uninterrupted one bit for bit.

PETSc does not expose the history of TSBDF.  The accepted states are therefore recorded here.  A restarted run
first steps through this record with a solver that returns the recorded states. So TSBDF rebuilds the same times and
vectors (manual: sec-time-restart).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from petsc4py import PETSc

from drillpetsc import petsc_compat
from drillpetsc.arrays import FloatArray
from drillpetsc.errors import SolveError
from drillpetsc.fem.discrete_system import DiscreteSystem

State = tuple[FloatArray, FloatArray]  # unknowns x and rates y (array_length,) of an assembly


@dataclass
class BdfHistory:
    """The last ``depth`` accepted states since the formula was started.

    depth: a formula of order p, its predictor and its error estimate use p + 1 earlier states.
    times: (k,) times of the states [s].
    steps: (k - 1,) requested step from each state to the next [s]; rounding makes it differ from the difference
    of the times.
    states: unknowns and rates at these times.
    half: state in the middle of the first step.  TSBDF computes it at each start, and uses it until it has
    enough other states.
    replayed: recorded states that the solver still returns, while a restarted run steps through the record.
    """

    depth: int
    times: list[float] = field(default_factory=list)
    steps: list[float] = field(default_factory=list)
    states: list[State] = field(default_factory=list)
    half: State | None = None
    replayed: list[State] = field(default_factory=list)
    _stages: list[State] = field(default_factory=list)

    def start(self, t: float, x: FloatArray, y: FloatArray) -> None:
        """Restart the record at a state x, y (array_length,) at ``t`` [s]."""
        self.times, self.steps, self.states, self.half, self._stages = (
            [t],
            [],
            [(x.copy(), y.copy())],
            None,
            [],
        )

    def add_stage(self, x: FloatArray, y: FloatArray) -> None:
        """Record a solved stage; in the first step the last two are used: the half step and the whole step."""
        if len(self.states) == 1:
            self._stages = [*self._stages[-1:], (x.copy(), y.copy())]

    def add_step(self, t: float, step: float, x: FloatArray, y: FloatArray) -> None:
        """Record an accepted state x, y (array_length,) at ``t`` [s]; ``step``: requested step [s]."""
        # PETSc starts with a half step of backward Euler, then takes order two (manual: sec-time-error)
        if len(self._stages) == 2:
            self.half = self._stages[0]
        self._stages = []
        self.times.append(t)
        self.steps.append(step)
        if len(self.states) < self.depth:
            self.states.append((x.copy(), y.copy()))
            return
        self.half = None  # the formula no longer uses it
        del self.times[0], self.steps[0]
        oldest = self.states.pop(0)  # its memory serves again
        oldest[0][:], oldest[1][:] = x, y
        self.states.append(oldest)

    # ------------------------------------------------------------------ checkpoints
    def get_state(self, system: DiscreteSystem) -> dict[str, FloatArray]:
        """Return the record for a checkpoint on rank 0; empty before the first start and on other ranks.

        Collective.

        times: (k,) [s]; steps: (k - 1,) [s].
        states: (k or k + 1, 2, nodes, m) unknowns and rates of all fields; the half step is the last one.
        """
        if not self.states:
            return {}
        states = self.states if self.half is None else [*self.states, self.half]
        columns = [nodal(system, part) for state in states for part in state]
        # by node, so that a run may continue on another number of ranks
        gathered = system.gather(np.stack(columns, axis=1))
        if gathered is None:
            return {}
        gathered = gathered.reshape(len(gathered), len(states), 2, -1)
        return {
            "times": np.array(self.times),
            "steps": np.array(self.steps),
            "states": np.moveaxis(gathered, 0, 2),
        }

    def set_state(self, system: DiscreteSystem, state: dict[str, FloatArray]) -> None:
        """Restore the record from a checkpoint: ``state`` as returned by ``get_state``."""
        self.times, self.steps = state["times"].tolist(), state["steps"].tolist()
        states = [
            (local(system, x, system.assembly.x), local(system, y, system.assembly.y))
            for x, y in state["states"]
        ]
        self.states, last = states[: len(self.times)], states[len(self.times) :]
        self.half, self._stages = (last[0] if last else None), []

    def replay(self, ts: PETSc.TS, system: DiscreteSystem, solution: PETSc.Vec) -> None:
        """Rebuild the history of TSBDF: repeat each recorded step, with the recorded state as its solution.

        ts: must neither reject nor shorten a step; its solver calls ``return_state`` while ``replayed`` has states.
        solution: vector in which the formula keeps its state. The assembly then contains the last one.

        Manual: sec-time-restart.
        """
        _put(self.states[0], system, solution)
        ts.setSolution(solution)
        ts.setTime(self.times[0])
        ts.restartStep()
        for k, step in enumerate(self.steps):
            self.replayed = [self.states[k + 1]] if k else [self.half or self.states[0], self.states[1]]
            ts.setTimeStep(step)
            with petsc_compat.own_errors():
                ts.step()
        self.replayed = []
        if ts.getTime() != self.times[-1]:
            raise SolveError(
                f"the history of the checkpoint leads to {ts.getTime()!r} s, not to {self.times[-1]!r} s"
            )
        system.assembly.x[:], system.assembly.y[:] = self.states[-1]

    def return_state(self, system: DiscreteSystem, snes: PETSc.SNES, x: PETSc.Vec) -> None:
        """Return the next recorded state as the solution of the step."""
        _put(self.replayed.pop(0), system, x)
        snes.setIterationNumber(1)
        snes.setConvergedReason(PETSc.SNES.ConvergedReason.CONVERGED_ITS)


def _put(state: State, system: DiscreteSystem, vector: PETSc.Vec) -> None:
    """Copy unknowns and rates into the assembly and the vector."""
    system.assembly.x[:], system.assembly.y[:] = state
    system.store_state(vector)


def nodal(system: DiscreteSystem, values: FloatArray) -> FloatArray:
    """Arrange local values (array_length,) by node: (nv, m) components of all fields.

    Zero if a field is absent.
    """
    dofs = np.hstack([system.layout.dofs[f.name] for f in system.layout.fields])
    return np.where(dofs >= 0, values[np.maximum(dofs, 0)], 0.0)


def local(system: DiscreteSystem, at_nodes: FloatArray, like: FloatArray) -> FloatArray:
    """Return local values (array_length,) from ``at_nodes`` (nodes, m).

    Entries that are not unknowns are taken from ``like``.
    """
    dofs = np.hstack([system.layout.dofs[f.name] for f in system.layout.fields])
    out = like.copy()
    out[dofs[dofs >= 0]] = at_nodes[system.chain.vertices][dofs >= 0]
    return out
