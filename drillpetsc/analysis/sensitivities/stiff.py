"""Rows of a roadmap with the beam as a solution: each row is a static equilibrium of its own, with its own tangent."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from drillpetsc.analysis.loads.torque_drag import stiff
from drillpetsc.analysis.loads.torque_drag.readings.reading import sensor_of
from drillpetsc.analysis.loads.torque_drag.roadmap import (
    RowsAsked,
    add_readings,
    circulations,
    densities_of,
)
from drillpetsc.analysis.sensitivities.points import Point, points_of
from drillpetsc.analysis.sensitivities.roadmap import QUANTITIES, SoftRoadmap, outputs_of, own_friction
from drillpetsc.analysis.sensitivities.solution import Found, number
from drillpetsc.analysis.sensitivities.static_tangent import RESIDUAL_STEP, StaticTangent
from drillpetsc.analysis.sensitivities.statics import RESOLUTION
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.model.mesh import MeshOf


class StiffRoadmap:
    """Static equilibria of the beam, a row of a roadmap each; every rank computes all of them.

    deepest: only those of the deepest bit depth.
    """

    resolution, far, by_solutions = RESOLUTION, False, False

    def __init__(self, case: Case, deepest: bool = True) -> None:
        self._case, self._deepest = case, deepest
        self._soft = SoftRoadmap(case, deepest)  # for the flow of the mud
        self.asked = asked = own_friction(case, deepest, "stiff")
        stiff.need_beam(asked.case)
        self.notes = asked.notes
        self.left_out: dict[float, str] = {}
        self._tangents: list[StaticTangent | None] = []
        rows = [self._solved(job) for job in self._jobs(asked, self._soft.flows)]
        rows = self._read(asked, rows)
        self.outputs = outputs_of(asked, rows)
        self.found = self._found(rows, [False] * len(rows))

    def near(self, points: Sequence[Point]) -> list[Found]:
        """As of ``Solution``."""
        sources, _ = points_of(self._case, points[0].key, RESIDUAL_STEP)
        asked, jobs = {}, {}
        for group in (points, sources):
            for point, a, flows in zip(group, *self._soft.beside(group), strict=True):
                asked[id(point.case)], jobs[id(point.case)] = a, self._jobs(a, flows)
        rows: list[list[dict[str, Any]]] = [[] for _ in points]
        bends = []
        for r, tangent in enumerate(self._tangents):
            if tangent is None:
                bends.append(False)
                for row in rows:
                    row.append({})
                continue
            mesh = MeshOf(tangent.model.case, tangent.model.mesh)

            def build(case: Case, r: int = r, mesh: MeshOf = mesh) -> Any:
                a = asked[id(case)]
                return stiff.model_of(a.case, a.well, jobs[id(case)][r], mesh)

            models, bend = tangent.near(points, sources, build)
            bends.append(bend)
            for i, (point, model) in enumerate(zip(points, models, strict=True)):
                rows[i].append(stiff.values_of(model, jobs[id(point.case)][r]))
        return [
            self._found(self._read(asked[id(point.case)], own), bends)
            for point, own in zip(points, rows, strict=True)
        ]

    def solved(self, case: Case) -> Found:
        """As of ``Solution``."""
        asked = own_friction(case, self._deepest, "stiff")
        flows = circulations(asked.case, asked.strings, asked.loads())
        rows: list[dict[str, Any]] = []
        for tangent, job in zip(self._tangents, self._jobs(asked, flows), strict=True):
            rows.append({})
            if tangent is not None:
                model = stiff.model_of(
                    asked.case, asked.well, job, MeshOf(tangent.model.case, tangent.model.mesh)
                )
                find_equilibrium(model, stiff.motion_of(job), False)
                rows[-1] = stiff.values_of(model, job)
        return self._found(self._read(asked, rows), [False] * len(rows))

    # ------------------------------------------------------------------ pieces
    @staticmethod
    def _jobs(asked: RowsAsked, flows: Any) -> list[stiff.Job]:
        loads, block, densities = asked.loads(), asked.block_weight or 0.0, densities_of(asked.case)
        return [
            stiff.Job(asked.strings[d], asked.pairs[p], loads[o], block, densities, flows.get((o, d)))
            for o, p, d in asked.keys()
        ]

    def _solved(self, job: stiff.Job) -> dict[str, Any]:
        """Values of a row, whose tangent is kept; none, with a note, if it has no differentiable state."""
        motion = stiff.motion_of(job)
        try:
            if job.rows.misfit or isinstance(job.flow, SolveError):
                raise CaseError(at="roadmap", want=job.rows.misfit or f"a steady flow: {job.flow}")
            model = stiff.model_of(self.asked.case, self.asked.well, job)
            start = model.top.anchor.copy()
            state = find_equilibrium(model, motion, False)
            values = stiff.values_of(model, job)
            self._tangents.append(StaticTangent(model, state, start, motion))
        except (CaseError, SolveError) as error:
            self._tangents.append(None)
            self.left_out[job.rows.depth] = " ".join(str(error).split())
            return {}
        return values

    @staticmethod
    def _read(asked: RowsAsked, rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
        """The rows with what names them and with the readings of the rig."""
        nothing = dict.fromkeys((q.name for q in QUANTITIES if not q.name.startswith("hook_load_")), np.nan)
        named = asked.named([nothing | row for row in rows])
        add_readings(asked, sensor_of(asked.case), named)
        return named

    @staticmethod
    def _found(rows: Sequence[dict[str, Any]], bends: Sequence[bool]) -> Found:
        names = [q.name for q in QUANTITIES if q.name in rows[0]]
        values = np.array([number(row[name]) for row in rows for name in names])
        return Found(values, tuple(bend for bend in bends for _ in names))
