"""The formula of a step, differentiated by parameters: constants of the derivatives of its rates (manual: sec-sensitivities-steps).

The formulas are linear in the states, so the derivatives of the states follow the same formula, with the same steps.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.kernels import pointer
from drillpetsc.solvers.time.alpha_formula import AlphaFormula, AlphaHistory


class FormulaDerivatives(Protocol):
    """What the formula carries from step to step of the derivatives of x, y, a by k parameters, (k, n) each."""

    def constants(self, t: float) -> tuple[float, FloatArray, FloatArray]:
        """Shift [1/s] of the step to ``t`` [s], and the derivatives (k, n) of v0 and v1."""

    def advance(self, t: float, x: FloatArray, y: FloatArray, a: FloatArray) -> None:
        """Go on to the derivatives (k, n) at ``t`` [s]."""

    def try_stage(self, t: float, x: FloatArray, y: FloatArray, a: FloatArray) -> None:
        """Note the derivatives (k, n) of a stage of the first step."""


class BdfDerivatives:
    """Backward differentiation of variable steps.

    order: of the formula; second_order: (n,) mask of the unknowns that have rates in the state.
    """

    def __init__(self, order: int, second_order: np.ndarray) -> None:
        self.order, self._two = order, second_order
        self._nodes: list[tuple[float, FloatArray, FloatArray]] = []
        self._half: tuple[float, FloatArray, FloatArray] | None = None
        self._steps = 0

    def start(self, t: float, x: FloatArray, y: FloatArray) -> None:
        """Begin at the derivatives x, y (k, n) at ``t`` [s]."""
        self._nodes, self._half, self._steps = [(t, x.copy(), y * self._two)], None, 0

    def constants(self, t: float) -> tuple[float, FloatArray, FloatArray]:
        """As of ``FormulaDerivatives``."""
        nodes = [*self._nodes, *([self._half] if self._half is not None else [])][: self.order]
        weights = _derivative_weights(t, [q[0] for q in nodes])
        v0, v1 = (sum(w * q[i] for w, q in zip(weights[1:], nodes, strict=True)) for i in (1, 2))
        return float(weights[0]), np.asarray(v0), np.asarray(v1)

    def begins_with_half(self, t: float, step: float) -> bool:
        """Whether a stage that ends at ``t`` [s] is the half of a first ``step`` [s], which PETSc takes before the whole one."""
        half = self.order > 1 and not self._steps and abs(t - self._nodes[0][0] - 0.5 * step) < 0.25 * step
        if half:  # a first step that was rejected begins again
            self._half = None
        return half

    def try_stage(self, t: float, x: FloatArray, y: FloatArray, a: FloatArray) -> None:
        """As of ``FormulaDerivatives``: the half step of backward Euler with which PETSc starts."""
        self._half = t, x.copy(), y * self._two

    def advance(self, t: float, x: FloatArray, y: FloatArray, a: FloatArray) -> None:
        """As of ``FormulaDerivatives``."""
        self._nodes, self._steps = [(t, x.copy(), y * self._two), *self._nodes][: self.order], self._steps + 1
        if len(self._nodes) >= self.order:
            self._half = None


class AlphaDerivatives:
    """Generalised-alpha.  formula: its coefficients; second_order: (n,) mask; count: of the parameters."""

    def __init__(self, formula: AlphaFormula, second_order: np.ndarray, count: int) -> None:
        self.formula, self._t = formula, 0.0
        self._histories = [AlphaHistory(formula, second_order) for _ in range(count)]
        self._v0, self._v1, self._guess = (np.zeros((count, len(second_order))) for _ in range(3))

    def start(
        self, t: float, x: FloatArray, y: FloatArray, a: FloatArray, rate: FloatArray, second: FloatArray
    ) -> None:
        """Begin at the derivatives (k, n) of what ``AlphaHistory.start`` has, at ``t`` [s]."""
        self._t = t
        for history, *parts in zip(self._histories, x, y, a, rate, second, strict=True):
            history.start(*parts)

    def constants(self, t: float) -> tuple[float, FloatArray, FloatArray]:
        """As of ``FormulaDerivatives``."""
        h = t - self._t
        for history, *arrays in zip(self._histories, self._v0, self._v1, self._guess, strict=True):
            history.begin(h, *map(pointer, arrays))
        return self.formula.shifts(h)[0], self._v0, self._v1

    def try_stage(self, t: float, x: FloatArray, y: FloatArray, a: FloatArray) -> None:
        """As of ``FormulaDerivatives``: the trial of the first step, which gives the derivative by which a_0 leads."""
        self._try(t, x, y, a)
        for history in self._histories:
            history.lead_by_trial()

    def advance(self, t: float, x: FloatArray, y: FloatArray, a: FloatArray) -> None:
        """As of ``FormulaDerivatives``."""
        self._try(t, x, y, a)
        self._t = t
        for history in self._histories:
            history.accept()

    def _try(self, t: float, *state: FloatArray) -> None:
        self._tried = [np.ascontiguousarray(q) for q in state]  # until the histories have taken the step
        for history, *parts in zip(self._histories, *self._tried, strict=True):
            history.advance(t - self._t, *map(pointer, parts))


def _derivative_weights(t: float, times: list[float]) -> FloatArray:
    """Weights (1 + k,) of the values at ``t`` and at ``times`` (k,) [s] in the derivative at ``t`` of their polynomial."""
    every = np.array([t, *times])
    out = np.zeros(len(every))
    for j in range(1, len(every)):
        others = np.array([q for i, q in enumerate(every) if i not in (0, j)])
        out[j] = np.prod((t - others) / (every[j] - others)) / (every[j] - t)
    out[0] = np.sum(1.0 / (t - every[1:]))
    return out
