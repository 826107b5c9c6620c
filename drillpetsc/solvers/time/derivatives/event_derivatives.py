"""Derivatives where a component changes its law at a state of the run, such as a jar that fires (manual: sec-sensitivities-events)."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.errors import SolveError
from drillpetsc.fem.component import Component
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.parallel import total
from drillpetsc.solvers.time.consistent_start import ConsistentStart
from drillpetsc.solvers.time.derivatives.beside_systems import Beside

AHEAD = 1.0e-5  # of the difference that is the rate of the distance to the event [s]
LATE = 1.0e-5  # the law of a state further beyond its limit than this has ended before: its event is not moved by parameters [s]


class EventDerivatives:
    """The time of an event by k parameters, and what the change of the law does to derivatives at a fixed time.

    start: accelerations of the run's system; groups: as of ``StepTangent``.
    """

    def __init__(self, start: ConsistentStart, groups: Sequence[Sequence[Beside]]) -> None:
        self.begin, self.system, self.groups = start, start.system, groups

    def jump(
        self, t: float, component: Component, numbers: FloatArray, change: Callable[[], None]
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Derivatives (k,) of the time ``t`` [s] of an event, and jumps (k, n) of the derivatives of x and y over it, with the law of
        ``component`` changed; collective.

        numbers: of the component; change: changes its law.  The systems beside the run are in its state, moved along the derivatives; their laws
        change with it.  Raises SolveError if the event is only grazed.
        """
        at = next(i for i, c in enumerate(self.system.components) if c is component)
        before = self._rates(t)
        shifts = self._times(t, at, numbers, before[1])
        change()
        for group in self.groups:
            for beside in group:
                theirs = beside.system.components[at]
                theirs.follow_law(component, self._numbers(beside.system, theirs))
        after = self._rates(t)
        of_x, of_y = (np.outer(shifts, old - new) for old, new in zip(before, after, strict=True))
        return shifts, of_x, of_y

    @staticmethod
    def _numbers(system: DiscreteSystem, component: Component) -> FloatArray:
        return np.asarray(total(system.comm, component.event_numbers(system.assembly)))

    def _times(self, t: float, at: int, numbers: FloatArray, accelerations: FloatArray) -> FloatArray:
        """Derivatives (k,) of the time of the event: dt*/dp = -(dg/dp)/(dg/dt), g its distance."""
        asm, n = self.system.assembly, self.system.layout.size
        component, x, y = self.system.components[at], asm.x.copy(), asm.y.copy()
        sides = []
        for ahead in (-AHEAD, AHEAD):
            asm.x[:n] = x[:n] + ahead * np.where(self.begin.second, y[:n], 0.0)
            asm.y[:n] = y[:n] + ahead * accelerations
            sides.append(self._numbers(self.system, component))
        asm.x[:], asm.y[:] = x, y
        low, high = (component.event_distance(numbers, moved, component) for moved in sides)
        rate, out = (high - low) / (2 * AHEAD), np.zeros(len(self.groups))
        if component.event_distance(numbers, numbers, component) > LATE * abs(rate):
            return out
        if not rate > 0.0:
            raise SolveError("an event that is only grazed has no derivative", time=t)
        for k, group in enumerate(self.groups):
            for beside in group:
                theirs = beside.system.components[at]
                own = self._numbers(beside.system, theirs)
                out[k] -= beside.weight * theirs.event_distance(numbers, own, component) / rate
        return out

    def _rates(self, t: float) -> tuple[FloatArray, FloatArray]:
        """Rates (n,) of x of first-order unknowns, and accelerations (n,) of the others, by the present law; the state stays."""
        asm, n, begin = self.system.assembly, self.system.layout.size, self.begin
        saved = asm.x.copy(), asm.y.copy(), asm.a.copy()
        begin.accelerations(t)
        rates = np.where(begin.first, asm.y[:n], 0.0), np.where(begin.second, asm.a[:n], 0.0)
        asm.x[:], asm.y[:], asm.a[:] = saved
        asm.invalidate_prescribed_values()
        asm.residual(t)
        return rates
