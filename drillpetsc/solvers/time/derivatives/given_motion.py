"""Derivatives of prescribed motion by parameters (manual: sec-sensitivities-steps)."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.bound_parts import RowReplacement
from drillpetsc.kernels import pointer
from drillpetsc.kernels.parameters import structure
from drillpetsc.solvers.time.derivatives.beside_systems import Beside

GivenCall = structure("given_call")


class GivenMotion:
    """Derivatives by k parameters of one prescribed motion, in the unknowns of its node.

    f: of the run; others: of each parameter the same motion of the systems beside the run, with the weights of these.

    position, rate: (k, 7) along the prescribed directions; turning: (k, 7) of the rows, by the reactions as the directions turn.
    """

    def __init__(
        self,
        f: RowReplacement,
        others: Sequence[Sequence[tuple[RowReplacement, Beside]]],
        follows: Sequence[bool],
    ) -> None:
        """follows: as of ``BesideSystems``."""
        self.f, self.others, self._follows = f, others, follows
        k = len(others)
        self.position, self.rate, self.turning = (np.zeros((k, 7)) for _ in range(3))
        self._turns = f.condition.along_path is not None or not all(
            np.array_equal(g.D, f.D) for group in others for g, _ in group
        )
        self._free = np.zeros((2, k, 7))  # work
        self._known = False
        self._index = (ctypes.c_void_p * max(1, len(f.elements)))(
            *(pointer(b.index) + 4 * e * b.width for b, e, _ in f.elements)
        )

    def fill(self, call: Any) -> None:
        """Fill the record for compiled code."""
        call.position, call.rate = pointer(self.position), pointer(self.rate)
        call.free = pointer(self._free)
        call.turning = pointer(self.turning) if self._turns else None
        call.index = ctypes.addressof(self._index)

    def forget(self) -> None:
        """Evaluate constant derivatives again, after ends were moved."""
        self._known = False

    def evaluate(self, t: float, x: FloatArray, y: FloatArray) -> None:
        """Take the derivatives at the inputs of ``t`` [s]; x, y: unknowns and rates of the run."""
        f = self.f
        for k, group in enumerate(self.others):
            if self._follows[k] and self._known:
                continue
            for g, _ in group:
                g.evaluate(t, x, y)
            if not self._turns and not self._follows[k]:
                continue  # compiled code adds them up
            weights = np.array([beside.weight for _, beside in group])
            # the weights sum to zero, so what is common drops out, without rounding
            position, rate, turn = (
                np.tensordot(weights[1:], np.array(parts[1:]) - parts[0], 1)
                for parts in (
                    [g.value for g, _ in group],
                    [g.rate for g, _ in group],
                    [g.D for g, _ in group],
                )
            )
            self.position[k], self.rate[k] = position @ f.D, rate @ f.D
            if self._turns:
                self.position[k] -= f.D.T @ (turn @ x[f.rows])
                across = -(turn.T @ f.D + f.D.T @ turn)
                self.rate[k] += across @ y[f.rows] + turn.T @ f.rate
                self.turning[k] = across @ (f.D.T @ f.reaction)
        self._known = True
