"""Soft strings of a roadmap as a solution, with the flow of the mud moved along its derivative (manual: sec-sensitivities-scan)."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from typing import Any

import numpy as np

from drillpetsc.analysis.loads.torque_drag.batch import Batch, soft_strings
from drillpetsc.analysis.loads.torque_drag.circulation import Circulation, flow_of_row, forces_of
from drillpetsc.analysis.loads.torque_drag.operations import FACTORS, Load, pairs_of, plan_of, running_speed
from drillpetsc.analysis.loads.torque_drag.readings.reading import sensor_of
from drillpetsc.analysis.loads.torque_drag.roadmap import (
    RowsAsked,
    SoftProblem,
    add_readings,
    circulations,
    rows_asked,
    soft_problem,
)
from drillpetsc.analysis.loads.torque_drag.table import FOUND
from drillpetsc.analysis.sensitivities.flow import FlowTangent
from drillpetsc.analysis.sensitivities.points import Point
from drillpetsc.analysis.sensitivities.solution import Found, Output, number
from drillpetsc.case.case import Case
from drillpetsc.errors import SolveError
from drillpetsc.output.quantities.tables import COLUMNS

#: outputs of a row; the place of a smallest force jumps from node to node
NAMES = (*(name for name in FOUND if name != "md_of_min"), "hook_load_total", "hook_load_reading")
QUANTITIES = tuple(q for q in COLUMNS["roadmap.csv"] if q.name in NAMES)
RATIOS = ("sinusoidal_ratio", "helical_ratio")


def own_friction(case: Case, deepest: bool, model: str = "soft") -> RowsAsked:
    """Rows of the case's roadmap with the friction of its sections alone, which is then a key like any other.

    deepest: only those of the deepest bit depth.
    """
    plan = plan_of(case).model_copy(update={"friction_factor": None})
    asked = rows_asked(case.model_copy(update={"roadmap": plan}), model)
    pair = pairs_of(asked.case, plan, [])[FACTORS.index(1.0)]
    strings = asked.strings[-1:] if deepest else asked.strings
    return RowsAsked(asked.case, asked.well, [pair], strings, asked.notes)


def outputs_of(asked: RowsAsked, rows: Sequence[dict[str, Any]]) -> list[Output]:
    """Outputs of all rows, in their order."""
    present = [q for q in QUANTITIES if q.name in rows[0]]
    return [Output(q, row["operation"], row["bit_depth"]) for row in rows for q in present]


class SoftRoadmap:
    """Soft strings of a roadmap at the friction of the hole's sections.

    deepest: only at the deepest bit depth.
    """

    resolution, far, by_solutions = 1e-9, True, False

    def __init__(self, case: Case, deepest: bool = False) -> None:
        self._deepest = deepest
        self.asked = asked = own_friction(case, deepest)
        self._tangents: dict[tuple[int, float, float], FlowTangent] = {}
        self.flows = self._flows_here()
        problem = soft_problem(asked, self.flows)
        self._hole = problem.hole
        rows, batch = self._rows(problem)
        self.outputs = outputs_of(asked, rows)
        self.found = self._found(rows, batch)
        self.notes = asked.notes
        self.left_out: dict[float, str] = {}

    def near(self, points: Sequence[Point]) -> list[Found]:
        """As of ``Solution``."""
        beside = zip(*self.beside(points), strict=True)
        return [self._found(*self._rows(soft_problem(a, f, self._hole))) for a, f in beside]

    def solved(self, case: Case) -> Found:
        """As of ``Solution``."""
        asked = own_friction(case, self._deepest)
        flows = circulations(asked.case, asked.strings, asked.loads())
        return self._found(*self._rows(soft_problem(asked, flows, self._hole)))

    # ------------------------------------------------------------------ pieces
    def _flows_here(self) -> dict[tuple[str, int], Circulation | SolveError]:
        """Forces of the mud by operation and string, whose solutions are kept."""
        out: dict[tuple[str, int], Circulation | SolveError] = {}
        for (operation, d), (load, speed) in self._moved(self.asked).items():
            key = d, load.flow, speed
            try:
                if key not in self._tangents:
                    model = flow_of_row(self.asked.case, self.asked.strings[d].depth, load.flow, speed)
                    model.solve(load.flow, speed)
                    self._tangents[key] = FlowTangent(model, load.flow)
                out[operation, d] = forces_of(self._tangents[key].flow, speed)
            except SolveError as error:
                out[operation, d] = error
        return out

    @staticmethod
    def _moved(asked: RowsAsked) -> dict[tuple[str, int], tuple[Load, float]]:
        """Load and speed in the mud [m/s, down] of the rows around which mud moves."""
        out = {}
        for operation, load in asked.loads().items():
            speed = running_speed(asked.case, operation, load.axial_velocity)
            for d, rows in enumerate(asked.strings):
                if (load.flow or speed) and not rows.misfit:
                    out[operation, d] = load, speed
        return out

    def beside(
        self, points: Sequence[Point]
    ) -> tuple[list[RowsAsked], list[dict[tuple[str, int], Circulation | SolveError]]]:
        """What the rows are computed for at the points, and forces of the mud by operation and string, moved along their derivative."""
        asked = [own_friction(point.case, self._deepest) for point in points]
        flows: list[dict[tuple[str, int], Circulation | SolveError]] = [{} for _ in points]
        moved = [self._moved(q) for q in asked]
        shared: dict[tuple[int, float, float], list[Circulation]] = {}
        for (operation, d), (load, speed) in self._moved(self.asked).items():
            key = d, load.flow, speed
            tangent = self._tangents.get(key)
            if tangent is None:
                continue
            if key not in shared:
                at = [(a, *m[operation, d]) for a, m in zip(asked, moved, strict=True)]

                def build(i: int, d: int = d, at: Any = at, tangent: FlowTangent = tangent) -> Any:
                    a, load, speed = at[i]
                    flow = flow_of_row(a.case, a.strings[d].depth, load.flow, speed, tangent.flow)
                    return flow, load.flow, speed

                models = tangent.near(points, build)
                shared[key] = [forces_of(model, q[2]) for model, q in zip(models, at, strict=True)]
            for i, forces in enumerate(shared[key]):
                flows[i][operation, d] = forces
        return asked, flows

    @staticmethod
    def _rows(problem: SoftProblem) -> tuple[list[dict[str, Any]], Batch]:
        batch = soft_strings(problem.hole, problem.columns)
        rows = problem.rows(batch)
        add_readings(problem.asked, sensor_of(problem.asked.case), rows)
        return rows, batch

    @staticmethod
    def _found(rows: Sequence[dict[str, Any]], batch: Batch) -> Found:
        names = [q.name for q in QUANTITIES if q.name in rows[0]]
        values = [number(row[name]) for row in rows for name in names]
        states: list[Hashable] = []
        lowest = np.argmin(np.nan_to_num(batch.tension, nan=np.inf), axis=0)
        nearest = batch.ratios.argmax(axis=1)
        for c in range(len(rows)):
            # a sinusoidal buckle changes no force
            buckled = (batch.state[:, c] == 2).tobytes(), bool(np.isnan(batch.locked[c]))
            crossing = _first(batch.tension[:, c] <= 0)
            places = {"min_effective_tension": int(lowest[c]), "neutral_point": crossing}
            places |= {name: int(at[c]) for name, at in zip(RATIOS, nearest, strict=True)}
            states += [(buckled, places.get(name, 0)) for name in names]
        return Found(np.array(values), tuple(states))


def _first(mask: np.ndarray) -> int:
    """Index of the first True, -1 without one."""
    return int(np.argmax(mask)) if mask.any() else -1
