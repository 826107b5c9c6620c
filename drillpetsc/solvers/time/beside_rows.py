"""Rows of systems beside a run, each in the state of the run moved along the derivatives by its parameter (manual: sec-sensitivities-steps)."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.kernels import function, pointer
from drillpetsc.kernels.parameters import structure

_BesideCall, _BesideState = structure("beside_call"), structure("beside_state")
_beside_rows = function("beside_rows", "ipp")


@dataclass(frozen=True)
class Beside:
    """A system with a parameter changed.  change: of the parameter [its SI unit]; weight: in a derivative by it [1/SI]."""

    system: DiscreteSystem
    change: float
    weight: float


class BesideRows:
    """Rows of the systems of each parameter: one compiled call on one rank, unless a step needs more than that.

    system: of the run; groups: of each of k parameters, the systems beside it.
    """

    def __init__(self, system: DiscreteSystem, groups: Sequence[Sequence[Beside]]) -> None:
        self.system = system
        self.every = [(k, beside) for k, group in enumerate(groups) for beside in group]
        n = len(system.layout.local_of_owned)
        self._rows, self._sums = system.new_condensed(), np.zeros((len(groups), n))
        self._calls = (_BesideCall * len(self.every))()
        x, y, a, _ = system.assembly.state_at
        self._state = _BesideState(x=x, y=y, a=a)
        self._work = np.zeros(n)
        self._state_at = ctypes.addressof(self._state)
        self._compiled = False
        ends = [f for f in system.assembly.row_replacements if f.condition.along_path is None]
        theirs = [[b.system.assembly.row_replacements for b in group] for group in groups]
        straight = len(ends) == len(system.assembly.row_replacements) and all(
            np.array_equal(f.D, ends[i].D) for group in theirs for some in group for i, f in enumerate(some)
        )
        #: of each end with constant and common directions, those of the systems beside the run; None if directions change
        self._ends = (
            [[[some[i] for some in g] for g in theirs] for i in range(len(ends))] if straight else None
        )
        self._weights = [np.array([b.weight for b in group]) for group in groups]

    def prescribed(self, t: float) -> FloatArray:
        """Derivatives (k, n) of the prescribed unknowns at ``t`` [s], zero elsewhere."""
        asm, n = self.system.assembly, self.system.layout.size
        x = np.zeros((len(self._sums), n))
        if self._ends is not None:
            for f, groups in zip(asm.row_replacements, self._ends, strict=True):
                for k, group in enumerate(groups):
                    for end in group:
                        end.evaluate(t, asm.x)
                    # the weights sum to zero, so the position of the run itself drops out
                    x[k, f.rows] += self._weights[k] @ np.array([end.value for end in group]) @ f.D
            return x
        for k, beside in self.every:
            for f in beside.system.assembly.row_replacements:
                f.evaluate(t, asm.x)
                x[k, f.rows] += beside.weight * (f.D.T @ (f.value - f.D @ asm.x[f.rows]))
        return x

    def prepare(self, t: float, shift: float, second: float) -> None:
        """Evaluate the inputs at ``t`` [s] of a step with these shifts [1/s]."""
        self._compiled = self.system.comm.size == 1
        for call, (k, beside) in zip(self._calls, self.every, strict=True):
            calls = beside.system.assembly.prepare_step(t, shift, second) if self._compiled else None
            if calls is None:
                self._compiled = False
                return
            call.step, call.change, call.weight, call.key = calls.step_at, beside.change, beside.weight, k

    def derivative(
        self, moved: tuple[FloatArray, FloatArray, FloatArray, FloatArray], t: float, second: float
    ) -> FloatArray:
        """Derivatives (k, owned) of the rows with derivatives (k, n) of x, y, a, v1; the next call overwrites them.

        Rates along prescribed directions are the given ones.  t: of the inputs [s]; second: da/dy [1/s].
        """
        self._sums[:] = 0.0
        if self._compiled:
            kept = [np.ascontiguousarray(q) for q in moved]
            s = self._state
            s.moved_x, s.moved_y, s.moved_a, s.moved_v1 = map(pointer, kept)
            s.v1, s.sums, s.rows = (
                self.system.assembly.history_at[1],
                pointer(self._sums),
                pointer(self._work),
            )
            s.second = second
            _beside_rows(len(self._calls), self._calls, self._state_at)
            return self._sums
        ours, n = self.system.assembly, self.system.layout.size
        for k, beside in self.every:
            theirs = beside.system.assembly
            self.place(beside, *(q[k] for q in moved[:3]))
            if theirs.row_replacements:
                theirs.v1[:n] = ours.v1[:n] + beside.change * moved[3][k]
                theirs.apply_prescribed_rates(t, second)
            beside.system.sum_residual(t, self._rows)
            self._sums[k] += beside.weight * self._rows.getArray(readonly=1)
        return self._sums

    def balance(self, x: FloatArray, y: FloatArray, a: FloatArray, t: float) -> None:
        """Move all systems along the derivatives (k, n) of x, y, a, and find their reactions; ``t``: of the inputs [s]."""
        if self._compiled:
            self._move(x, y, a, pointer(self._work))
            return
        for k, beside in self.every:
            self.place(beside, x[k], y[k], a[k])
            beside.system.sum_residual(t, self._rows)

    def place(self, beside: Beside, x: FloatArray, y: FloatArray, a: FloatArray) -> None:
        """Put a system into the state of the run, moved along the derivatives (n,) of x, y, a."""
        ours, theirs, n = self.system.assembly, beside.system.assembly, self.system.layout.size
        theirs.x[:n] = ours.x[:n] + beside.change * x
        theirs.y[:n] = ours.y[:n] + beside.change * y
        theirs.a[:n] = ours.a[:n] + beside.change * a

    def place_all(self, x: FloatArray, y: FloatArray, a: FloatArray) -> None:
        """Put all systems into the state of the run, moved along the derivatives (k, n) of x, y, a."""
        if self._compiled:
            self._move(x, y, a, None)
            return
        for k, beside in self.every:
            self.place(beside, x[k], y[k], a[k])

    def _move(self, x: FloatArray, y: FloatArray, a: FloatArray, rows: int | None) -> None:
        """The compiled call that moves all systems; rows: address at which their rows are found, None: they are not."""
        kept = [np.ascontiguousarray(q) for q in (x, y, a)]
        s = self._state
        s.moved_x, s.moved_y, s.moved_a = map(pointer, kept)
        s.v1, s.sums, s.rows = None, None, rows
        _beside_rows(len(self._calls), self._calls, self._state_at)
