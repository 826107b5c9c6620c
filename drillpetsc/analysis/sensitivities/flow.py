"""Derivatives of a steady flow by a key of its case."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from drillpetsc.analysis.hydraulics.flow_model import FlowModel
from drillpetsc.analysis.sensitivities.points import MOVE, Point, difference, solve_exactly
from drillpetsc.analysis.statics.steady_flow import flow_rows
from drillpetsc.arrays import FloatArray
from drillpetsc.solvers.time.newton import shared_factor


class FlowTangent:
    """A solved flow model and the matrix of its equations, factored once.

    rate: flow rate of the pump [m3/s].
    """

    def __init__(self, flow: FlowModel, rate: float) -> None:
        self.flow = flow
        self._unknowns = flow.system.assembly.x.copy()
        self._rate = rate
        flow_rows(flow.system, rate, factor=True)
        self._factor = shared_factor(flow.system)

    def near(
        self,
        points: Sequence[Point],
        build: Callable[[int], tuple[FlowModel, float, float]],
    ) -> list[FlowModel]:
        """Flow models at the points, with the solution moved along its derivative, J s = -R_p (manual: eq-sensitivities-direct).

        build: model, flow rate [m3/s] and speed [m/s] of the point of a number.
        """
        built, used, rows, n = [], [], [], self.flow.system.layout.size
        for i, point in enumerate(points):
            model, rate, speed = build(i)
            model.place(rate, speed)
            model.take_flow(self._unknowns)
            if point.weight:
                used.append(point)
                rows.append(flow_rows(model.system, rate))
            built.append(model)
        source = -difference(used, rows)

        def left(step: FloatArray) -> FloatArray:
            """The source less J s, which is the difference of the residual along s: the steady matrix has a little of a rate's."""
            part = MOVE / self._size(step)
            return source - (self._rows(part * step) - self._rows(-part * step)) / (2 * part)

        step = solve_exactly(self._solve, left, source, self._size)
        for point, model in zip(points, built, strict=True):
            model.take_flow(self._unknowns[:n] + point.change * step)
        return built

    def _solve(self, rows: FloatArray) -> FloatArray:
        step = np.zeros(len(rows))
        self._factor.solve_owned(rows, step)
        return step

    def _rows(self, step: FloatArray) -> FloatArray:
        """Residual of the solution moved by a step; the model then has the solution again."""
        n = len(step)
        self.flow.take_flow(self._unknowns[:n] + step)
        rows = flow_rows(self.flow.system, self._rate)
        self.flow.take_flow(self._unknowns)
        return rows

    def _size(self, step: FloatArray) -> float:
        return float(np.max(np.abs(step) / self.flow.system.scale, initial=0.0))
