"""Static equilibrium as a solution of which each key costs one back-substitution."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from petsc4py import PETSc

from drillpetsc.analysis.commands.statics import question_of
from drillpetsc.analysis.sensitivities.points import Point, points_of
from drillpetsc.analysis.sensitivities.solution import Found, Output, number
from drillpetsc.analysis.sensitivities.static_tangent import (
    RESIDUAL_STEP,
    Motion,
    StaticTangent,
    refuse_history,
)
from drillpetsc.analysis.statics.answer import static_summary
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.fem.quantity import Quantity
from drillpetsc.model.drilling_model import DrillingModel, build_model
from drillpetsc.model.mesh import MeshOf
from drillpetsc.output.quantities.mud import MUD
from drillpetsc.output.quantities.tables import COLUMNS

RESOLUTION, RESOLUTION_IN_MUD = (
    1e-5,
    5e-4,
)  # relative changes of outputs that are rounding, alone and with flow [-]
HIDDEN = ("top_travel",)  # where the top is, not what the rig reads
QUANTITIES: tuple[Quantity, ...] = (
    *(q for q in COLUMNS["static_summary"] if q.name not in HIDDEN),
    *MUD,
    *COLUMNS["ecd"],
)


class StaticsSolution:
    """Static equilibrium of a case.  With mud its derivatives are differences of full solutions: string and flow are solved
    in turn, and no single matrix has both.

    motion, operation: as in ``run_statics``.
    """

    far = False

    def __init__(
        self, case: Case, comm: PETSc.Comm, motion: str | None = None, operation: str | None = None
    ) -> None:
        self.notes: list[str] = []
        self.left_out: dict[float, str] = {}
        self._case = case
        self._comm, self._words = comm, (motion, operation)
        posed, moving = question_of(case, *self._words)
        if posed.hold_string:
            raise CaseError(
                at="--analysis", got="statics", want="a string that is not held, or --analysis hydraulics"
            )
        model = build_model(posed, comm, moving)
        self.resolution = RESOLUTION if model.fluid is None else RESOLUTION_IN_MUD
        self._mesh = MeshOf(posed, model.mesh)
        start = model.top.anchor.copy()
        state = find_equilibrium(model, moving, False)
        figures = static_summary(model, state)
        self.outputs = [Output(q) for q in QUANTITIES if np.isfinite(number(figures.get(q.name)))]
        self.found = self._found(figures)
        refuse_history(model, state)
        self.by_solutions = model.fluid is not None
        self._tangent = None if self.by_solutions else StaticTangent(model, state, start, moving)

    def near(self, points: Sequence[Point]) -> list[Found]:
        """As of ``Solution``; collective."""
        assert self._tangent is not None
        sources, _ = points_of(self._case, points[0].key, RESIDUAL_STEP)
        models, bends = self._tangent.near(points, sources, lambda case: self._built(case)[0])
        return [self._found(static_summary(model, self._tangent.state), bends) for model in models]

    def solved(self, case: Case) -> Found:
        """As of ``Solution``; collective."""
        model, moving = self._built(case)
        return self._found(static_summary(model, find_equilibrium(model, moving, False)))

    def _built(self, case: Case) -> tuple[DrillingModel, Motion]:
        posed, moving = question_of(case, *self._words)
        return build_model(posed, self._comm, moving, like=self._mesh), moving

    def _found(self, figures: dict[str, Any], bends: bool = False) -> Found:
        values = np.array([number(figures.get(output.quantity.name)) for output in self.outputs])
        return Found(values, (bends,) * len(values))
