"""The formula of a step, differentiated by parameters: constants of the derivatives of its rates (manual: sec-sensitivities-steps).

The formulas are linear in the states, so the derivatives of the states follow the same formula, with the same steps.
"""

from __future__ import annotations

from ctypes import addressof, c_double, c_void_p
from math import prod
from typing import Protocol

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.kernels import pointer
from drillpetsc.kernels.parameters import structure
from drillpetsc.solvers.time.alpha_formula import AlphaFormula, AlphaHistory

_FormulaSums = structure("formula_sums")


class FormulaDerivatives(Protocol):
    """What the formula carries from step to step of the derivatives of x, y, a by k parameters, (k, n) each; kept arrays are not copied."""

    #: address of the sums that are v0 and v1; None: ``constants`` computes these
    sums_at: int | None

    def constants(self, t: float, v0: int, v1: int) -> float:
        """Shift [1/s] of the step to ``t`` [s]; without sums, the derivatives of v0 and v1 go to the addresses of arrays (k, n)."""

    def advance(self, t: float, x: FloatArray, y: FloatArray, a: FloatArray) -> None:
        """Go on to the derivatives (k, n) at ``t`` [s]."""

    def try_stage(self, t: float, x: FloatArray, y: FloatArray, a: FloatArray) -> None:
        """Note the derivatives (k, n) of a stage of the first step."""


class BdfDerivatives:
    """Backward differentiation of variable steps.

    order: of the formula.
    """

    def __init__(self, order: int) -> None:
        self.order = order
        self._arrays = (c_double * order)(), (c_void_p * order)(), (c_void_p * order)()
        self._sums = _FormulaSums()
        self._sums.weights, self._sums.x, self._sums.y = (addressof(q) for q in self._arrays)
        self.sums_at: int | None = addressof(self._sums)
        self._nodes: list[tuple[float, FloatArray, FloatArray]] = []
        self._half: tuple[float, FloatArray, FloatArray] | None = None
        self._steps = 0

    def start(self, t: float, x: FloatArray, y: FloatArray) -> None:
        """Begin at the derivatives x, y (k, n) at ``t`` [s]."""
        self._nodes, self._half, self._steps = [(t, x.copy(), y.copy())], None, 0

    def constants(self, t: float, v0: int, v1: int) -> float:
        """As of ``FormulaDerivatives``."""
        nodes = [*self._nodes, *([self._half] if self._half is not None else [])][: self.order]
        shift, *weights = derivative_weights(t, [q[0] for q in nodes])
        by_node, at_x, at_y = self._arrays
        for i, (weight, (_, x, y)) in enumerate(zip(weights, nodes, strict=True)):
            by_node[i], at_x[i], at_y[i] = weight, pointer(x), pointer(y)
        self._sums.count = len(nodes)
        return shift

    def begins_with_half(self, t: float, step: float) -> bool:
        """Whether a stage that ends at ``t`` [s] is the half of a first ``step`` [s], which PETSc takes before the whole one."""
        half = self.order > 1 and not self._steps and abs(t - self._nodes[0][0] - 0.5 * step) < 0.25 * step
        if half:  # a first step that was rejected begins again
            self._half = None
        return half

    def try_stage(self, t: float, x: FloatArray, y: FloatArray, a: FloatArray) -> None:
        """As of ``FormulaDerivatives``: the half step of backward Euler with which PETSc starts."""
        self._half = t, x, y

    def advance(self, t: float, x: FloatArray, y: FloatArray, a: FloatArray) -> None:
        """As of ``FormulaDerivatives``."""
        self._nodes, self._steps = [(t, x, y), *self._nodes][: self.order], self._steps + 1
        if len(self._nodes) >= self.order:
            self._half = None


class AlphaDerivatives:
    """Generalised-alpha.  formula: its coefficients; second_order: (n,) mask; count: of the parameters."""

    def __init__(self, formula: AlphaFormula, second_order: np.ndarray, count: int) -> None:
        self.formula, self._t = formula, 0.0
        self.sums_at: int | None = None
        # the unknowns of all parameters one after the other
        self._history = AlphaHistory(formula, np.tile(second_order, count))
        self._guess = np.zeros(count * len(second_order))  # not used

    def start(
        self, t: float, x: FloatArray, y: FloatArray, a: FloatArray, rate: FloatArray, second: FloatArray
    ) -> None:
        """Begin at the derivatives (k, n) of what ``AlphaHistory.start`` has, at ``t`` [s]."""
        self._t = t
        self._history.start(*(q.ravel() for q in (x, y, a, rate, second)))

    def constants(self, t: float, v0: int, v1: int) -> float:
        """As of ``FormulaDerivatives``."""
        return self._history.begin(t - self._t, v0, v1, pointer(self._guess))[0]

    def try_stage(self, t: float, x: FloatArray, y: FloatArray, a: FloatArray) -> None:
        """As of ``FormulaDerivatives``: the trial of the first step, which gives the derivative by which a_0 leads."""
        self._try(t, x, y, a)
        self._history.lead_by_trial()

    def advance(self, t: float, x: FloatArray, y: FloatArray, a: FloatArray) -> None:
        """As of ``FormulaDerivatives``."""
        self._try(t, x, y, a)
        self._t = t
        self._history.accept()

    def _try(self, t: float, x: FloatArray, y: FloatArray, a: FloatArray) -> None:
        self._tried = x, y, a  # until the history has taken the step
        self._history.take(t - self._t, pointer(x), pointer(y), pointer(a))


def derivative_weights(t: float, times: list[float]) -> list[float]:
    """Weights (1 + k,) of the values at ``t`` and at ``times`` (k,) [s] in the derivative at ``t`` of their polynomial."""
    every, out = [t, *times], [sum(1.0 / (t - q) for q in times)]
    for j in range(1, len(every)):
        others = [q for i, q in enumerate(every) if i not in (0, j)]
        out.append(prod((t - q) / (every[j] - q) for q in others) / (every[j] - t))
    return out
