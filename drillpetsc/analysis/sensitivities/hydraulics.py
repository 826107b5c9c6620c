"""Steady flow of a case as a solution, at its flow rate or at its pump pressure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from drillpetsc.analysis.hydraulics.flow_model import FlowModel, whole_string
from drillpetsc.analysis.hydraulics.hydraulics import Hydraulics, default_flow, flow_at_pressure, flow_figures
from drillpetsc.analysis.hydraulics.losses import loss_rows
from drillpetsc.analysis.hydraulics.open_hole import open_hole, shoe_depth
from drillpetsc.analysis.sensitivities.flow import FlowTangent
from drillpetsc.analysis.sensitivities.points import Point, difference
from drillpetsc.analysis.sensitivities.solution import Found, Output, number
from drillpetsc.case.case import Case
from drillpetsc.output.quantities.tables import COLUMNS

RATE_STEP = 1e-4  # of differences by the flow rate, relative [-]
PUMP_PRESSURE = "fluid.pump_pressure"


class SteadyHydraulics:
    """Steady flow of a case.

    With a pump pressure the flow rate q is an unknown: its equation is that the pressure p_s of the pump in the string is as
    given, dq/dp = (dP/dp - dp_s/dp)/(dp_s/dq).
    """

    resolution, far, by_solutions = 1e-9, True, False

    def __init__(self, case: Case) -> None:
        self.notes: list[str] = []
        self.left_out: dict[float, str] = {}
        hydraulics = Hydraulics(case)
        self._flow, self._rate = hydraulics.flow, self._solve(case, hydraulics.flow)
        self._tangent = FlowTangent(self._flow, self._rate)
        self.outputs = [Output(q) for q in COLUMNS["summary.json of hydraulics"]]
        self.found = self._at(self._flow, self._rate)

    def near(self, points: Sequence[Point]) -> list[Found]:
        """As of ``Solution``."""
        if _pressure(points[0].case) is None:
            rates = [default_flow(point.case, []) for point in points]
            return self._found(points, rates)
        # at the rate of the solution, then by the rate
        own = self._found(points, [self._rate] * len(points))
        names = [q.name for q in COLUMNS["summary.json of hydraulics"]]
        pump, line = names.index("pump_pressure"), names.index("surface_line_loss")
        used = [point for point in points if point.weight]
        excess = [
            f.values[pump] - f.values[line] - (_pressure(point.case) or 0.0)
            for f, point in zip(own, points, strict=True)
            if point.weight
        ]
        h, key = RATE_STEP * self._rate, points[0].key
        sides = [Point(self._flow.case, key, change, change / (2 * h * h)) for change in (-h, h)]
        by_rate = self._found(sides, [self._rate + side.change for side in sides])
        slope = difference(sides, [f.values[pump] - f.values[line] for f in by_rate])
        turn = -difference(used, excess) / slope
        moved = [self._rate + point.change * turn for point in points]
        gradient = difference(sides, [f.values for f in by_rate])
        return [
            replace(f, values=f.values + (rate - self._rate) * gradient)
            for f, rate in zip(own, moved, strict=True)
        ]

    def solved(self, case: Case) -> Found:
        """As of ``Solution``."""
        flow = self._model(case)
        return self._at(flow, self._solve(case, flow))

    # ------------------------------------------------------------------ pieces
    def _model(self, case: Case) -> FlowModel:
        return FlowModel(case, whole_string(case), "pumping", like=self._flow)

    @staticmethod
    def _solve(case: Case, flow: FlowModel) -> float:
        """Solve at the case's flow rate, or pump pressure; returns the rate [m3/s]."""
        pressure = _pressure(case)
        rate = default_flow(case, []) if pressure is None else flow_at_pressure(flow, pressure, PUMP_PRESSURE)
        flow.solve(rate)
        return rate

    def _found(self, points: Sequence[Point], rates: Sequence[float]) -> list[Found]:
        """Outputs at the points, at given flow rates [m3/s]."""

        def build(i: int) -> tuple[FlowModel, float, float]:
            return self._model(points[i].case), rates[i], 0.0

        return [
            self._at(flow, rate) for flow, rate in zip(self._tangent.near(points, build), rates, strict=True)
        ]

    @staticmethod
    def _at(flow: FlowModel, rate: float) -> Found:
        case, rows = flow.case, loss_rows(flow)
        end = None if case.well is None else float(case.well.survey.md[-1])
        figures = flow_figures(flow, rate, rows, shoe_depth(case), end, open_hole(case, case.window))
        regimes = tuple(row.regime for row in rows)
        values = np.array([number(figures[q.name]) for q in COLUMNS["summary.json of hydraulics"]])
        return Found(values, (regimes,) * len(values))


def _pressure(case: Case) -> float | None:
    """Pump pressure of a case at time 0 [Pa]; None for one that gives a flow rate."""
    given = case.given_fluid.pump_pressure
    return None if given is None else float(given.value(0.0))
