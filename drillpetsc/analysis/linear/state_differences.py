"""Central differences of numbers that a model computes from its state, by all unknowns, rates and accelerations."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.solvers.linear.linearization import Linearised

#: steps in usual sizes of unknowns, rates [1/s] and accelerations [1/s2].  A bit with little weight leaves the bottom after
#: a few micrometres; equations are linear in accelerations
PLACE_STEP, RATE_STEP, ACCELERATION_STEP = 3e-5, 1e-3, 1e2
ROUNDINGS = 4  # random changes of the last digit, from which rounding is estimated
NOISE = 1e-7  # derivatives below this fraction of the largest, in usual sizes, are rounding


class StateDifferences:
    """Central differences about the present state of a model; every call is collective.

    values: the numbers (p,), the same on all ranks; reactions and contact forces in them are those of the last residual.
    """

    def __init__(self, model: DrillingModel, values: Callable[[], FloatArray]) -> None:
        self.system, self.values = model.system, values
        self.asm, self.layout = model.system.assembly, model.system.layout
        self.numbers = self.layout.condensed_dm.getLGMap().getIndices()
        self.rows = self.system.new_condensed()
        self.size = self.rows.getSize()
        self.scale = self.whole(self.system.scale[self.layout.local_of_owned])
        self.noise = self._noise()

    def _noise(self) -> FloatArray:
        """Changes of the numbers (p,) by the rounding of the unknowns."""
        asm, start, n = self.asm, self.asm.x.copy(), self.layout.size
        value = self.read()
        out = np.zeros(len(value))
        rng = np.random.default_rng(2)
        for _ in range(ROUNDINGS):
            ulps = rng.choice([-1.0, 1.0], self.size)[self.numbers]
            asm.x[:n] = start[:n] + ulps * np.spacing(start[:n])
            out = np.maximum(out, np.abs(self.read() - value))
        asm.x[:] = start
        return 4.0 * out + 4e-16 * np.abs(value)

    def read(self) -> FloatArray:
        """Numbers (p,) at the present state."""
        self.asm.invalidate_prescribed_values()
        self.system.sum_residual(0.0, self.rows)
        return self.values()

    def owned_rows(self) -> FloatArray:
        """Residual of the owned unknowns now."""
        self.asm.invalidate_prescribed_values()
        self.system.sum_residual(0.0, self.rows)
        return np.array(self.rows.getArray(readonly=1))

    def whole(self, owned: FloatArray) -> FloatArray:
        """All unknowns (n,) on every rank from the owned ones."""
        return (
            owned
            if self.system.comm.size == 1
            else np.concatenate(self.system.comm.tompi4py().allgather(owned))
        )

    def by_state(self, chosen: np.ndarray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Numbers by the unknowns ``chosen``, their rates and accelerations: (p, n) each."""
        arrays = (self.asm.x, PLACE_STEP), (self.asm.y, RATE_STEP), (self.asm.a, ACCELERATION_STEP)
        x, y, a = (self._by(array, step * self.scale, chosen) for array, step in arrays)
        return x, y, a

    def _by(self, array: FloatArray, steps: FloatArray, chosen: np.ndarray) -> FloatArray:
        """Numbers (p, n) by the unknowns ``chosen`` of one of the arrays of the assembly.

        steps: (n,) of all unknowns.  A group is changed at once; where no number changes, none of it matters.
        """
        out = np.zeros((len(self.noise), self.size))
        direction = np.random.default_rng(1).uniform(0.5, 1.0, self.size) * steps
        start, n = array.copy(), self.layout.size
        change = np.zeros(self.size)

        def difference(group: np.ndarray) -> FloatArray:
            change[group] = direction[group]
            values = []
            for sign in (1.0, -1.0):
                array[:n] = start[:n] + sign * change[self.numbers]
                values.append(self.read())
            change[group], array[:] = 0.0, start
            d = values[0] - values[1]
            return np.where(np.abs(d) > self.noise, d, 0.0)

        groups = [chosen] if len(chosen) else []
        while groups:
            group = groups.pop()
            d = difference(group)
            if not d.any():
                continue
            if len(group) == 1:
                out[:, group[0]] = d / (2 * direction[group[0]])
            else:
                groups += [group[: len(group) // 2], group[len(group) // 2 :]]
        relative = np.abs(out) * steps
        out[relative < NOISE * relative.max(axis=1, initial=0.0)[:, None]] = 0.0
        return out


def of_motion(
    q: Linearised, x: FloatArray, y: FloatArray, a: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """From derivatives by unknowns, rates and accelerations (p, n) to those by u, u' and u'' (manual: eq-eigen-rates)."""
    return x + y @ q.G, y @ q.P + a @ q.G, a @ q.P
