"""Soft strings of a roadmap as a solution: its derivatives are those of each step, carried from the bit up.

The force T_i at the upper end of a step follows from that at its lower end, T_i = S_i(T_(i+1), p).  A change of the key adds
dS_i/dp at the fixed force below, and what comes from below grows by dS_i/dT (manual: eq-sensitivities-scan).
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from typing import Any

import numpy as np

from drillpetsc.analysis.loads.torque_drag.batch import Batch, Steps, soft_strings
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
from drillpetsc.analysis.sensitivities.points import Point, difference
from drillpetsc.analysis.sensitivities.solution import Found, Output, number
from drillpetsc.case.case import Case
from drillpetsc.errors import SolveError
from drillpetsc.output.quantities.tables import COLUMNS

FORCE_STEP = 1e-6  # of the differences by the force below a step, relative to the largest force [-]
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
        self._hole, batch = problem.hole, soft_strings(problem.hole, problem.columns)
        rows = self._rows(problem, batch)
        self.outputs = outputs_of(asked, rows)
        self.found = self._found(rows, batch)
        self.notes = asked.notes
        self.left_out: dict[float, str] = {}
        steps = Steps(problem.hole, problem.columns)
        self._tension = np.where(np.isnan(batch.tension), steps.end, batch.tension)
        below, h = self._tension[1:], FORCE_STEP * max(float(np.abs(self._tension).max()), 1.0)
        ends = [steps.from_below(below + sign * h).above for sign in (1.0, -1.0)]
        self._growth = (ends[0] - ends[1]) / (2 * h)

    def near(self, points: Sequence[Point]) -> list[Found]:
        """As of ``Solution``."""
        problems = self._problems(points)
        steps = [Steps(q.hole, q.columns) for q in problems]
        chosen = [i for i, point in enumerate(points) if point.weight]
        used = [points[i] for i in chosen]
        source = difference(used, [steps[i].from_below(self._tension[1:]).above for i in chosen])
        slope = np.empty_like(self._tension)
        slope[-1] = difference(used, [steps[i].end for i in chosen])
        for i in range(len(source) - 1, -1, -1):
            slope[i] = self._growth[i] * slope[i + 1] + source[i]
        out = []
        for point, problem, step in zip(points, problems, steps, strict=True):
            tension = self._tension + point.change * slope
            batch = step.batch(tension, step.from_below(tension[1:]))
            out.append(self._found(self._rows(problem, batch), batch))
        return out

    def solved(self, case: Case) -> Found:
        """As of ``Solution``."""
        asked = own_friction(case, self._deepest)
        flows = circulations(asked.case, asked.strings, asked.loads())
        problem = soft_problem(asked, flows, self._hole)
        batch = soft_strings(problem.hole, problem.columns)
        return self._found(self._rows(problem, batch), batch)

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

    def _problems(self, points: Sequence[Point]) -> list[SoftProblem]:
        """Soft strings at the points, the flow moved along its derivative."""
        return [soft_problem(a, f, self._hole) for a, f in zip(*self.beside(points), strict=True)]

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

    def _rows(self, problem: SoftProblem, batch: Batch) -> list[dict[str, Any]]:
        rows = problem.rows(batch)
        add_readings(problem.asked, sensor_of(problem.asked.case), rows)
        return rows

    def _found(self, rows: Sequence[dict[str, Any]], batch: Batch) -> Found:
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
