"""A static state with its factored stiffness, from which each key costs one back-substitution."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace

import numpy as np

from drillpetsc.analysis.sensitivities.points import Point, difference
from drillpetsc.analysis.statics.equilibrium import set_weight_on_bit
from drillpetsc.analysis.statics.flow_coupling import surge_rates
from drillpetsc.analysis.statics.placement import (
    place_along_hole,
    prescribed_motion,
    take_unknowns,
    top_depth,
)
from drillpetsc.analysis.statics.static_problem import StaticState
from drillpetsc.analysis.statics.steady_flow import STORAGE_WEIGHT
from drillpetsc.analysis.statics.top_on_wall import ACROSS, hold_where_it_lies
from drillpetsc.arrays import FloatArray
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.physics.tools.mud_motor import MudMotor
from drillpetsc.solvers.static.static_newton import Equilibrium, StaticNewton

#: of differences of the residual, relative: the wall yields by micrometres, beyond which a change of a diameter opens contacts
RESIDUAL_STEP = 1e-7
BENT, NOISE = (
    1e-3,
    1e-9,
)  # share of a derivative that the residual beside the state may lack; rounding in the fields' scales
Motion = tuple[float, float] | None


def refuse_history(model: DrillingModel, state: StaticState) -> None:
    """Raise CaseError for a state that is not differentiable here."""
    if state.path is not None:
        want = "a state that Newton's method finds: this one has a history of friction, which the derivative must follow"
        raise CaseError(at="statics", got="the end of a path", want=want)
    if model.parts(MudMotor):
        raise CaseError(
            at="string", got="pdm", want="a string without a downhole motor, or --analysis roadmap"
        )


class StaticTangent:
    """A static state and its factored stiffness.

    start: (m,) place of the top before the state was sought; motion: that friction opposes, None: that of the top.
    Raises CaseError for a state that is not differentiable here.
    """

    def __init__(self, model: DrillingModel, state: StaticState, start: FloatArray, motion: Motion) -> None:
        refuse_history(model, state)
        self.model, self.state, self.motion = model, state, motion
        self.top = model.top.anchor - start
        self.x = model.system.assembly.x.copy()
        self.solver = self._solver(model)
        with self._top_free(model):
            self.solver.rows()
            self.solver.factor_here()
        self._contacts = [flags.values.copy() for flags in model.system.contact_flags]

    def _solver(self, model: DrillingModel) -> StaticNewton:
        """Equations of a model at the state, with the friction of its motion."""
        self._oppose(model)
        solver = StaticNewton(model.system, symmetric=model.conservative)
        if model.fluid is not None:  # string and flow together, as their state was found
            solver.rate_weight = STORAGE_WEIGHT
            solver.rates = surge_rates(model, prescribed_motion(model)[0] if self.motion is None else 0.0)
        if model.case.initial.wob is not None:
            set_weight_on_bit(model, solver, model.case.initial.wob)
        return solver

    def _oppose(self, model: DrillingModel) -> None:
        """Let the friction of a model oppose the motion."""
        motion = prescribed_motion(model) if self.motion is None else self.motion
        for component in model.components:
            component.impose_sliding_direction(*motion, self.state.lateral_fraction, 0.0)

    @property
    def _top_held(self) -> bool:
        """Whether the top lies where the march put it, which depends on the key: its place was not found by the equilibrium."""
        moved = len(self.top) > 2 and bool(np.abs(self.top[1:3]).max() > 1e-9)
        return moved and not self.state.top_lies

    @contextmanager
    def _top_free(self, *models: DrillingModel) -> Iterator[None]:
        """Leave the place across the hole of a top that lies on the wall to the equilibrium, as statics did."""
        for model in models:
            model.system.assembly.release(ACROSS if self.state.top_lies else ())
        yield
        for model in models:
            model.system.assembly.release(())
            if self.state.top_lies:
                hold_where_it_lies(model)

    def near(
        self,
        points: Sequence[Point],
        sources: Sequence[Point],
        build: Callable[[Case], DrillingModel],
    ) -> tuple[list[DrillingModel], bool]:
        """Models at the points, with the state moved along its derivative, and whether it has a kink there; collective.

        sources: points so near that no contact of the state opens there, which may be ``points``; build: model of a case, with the elements of the state.
        """
        models = [build(point.case) for point in points]
        near = models if sources is points else [build(q.case) for q in sources]
        with self._top_free(self.model, *models, *near):
            self.solver.rows()
            fresh = [model.top.anchor.copy() for model in near]
            along, gradients, moved = self._along_hole(sources, near), [], []
            for point, model, anchor in zip(sources, near, fresh, strict=True):
                model.top.anchor[:] = anchor
                gradients.append(self._rows_of(self._take(model, self.x[:-1] + point.change * along)))
                # as rounded, which the rows know
                moved.append(model.system.assembly.x[: len(along)] - self.x[:-1])
                model.top.anchor[:] = anchor
            step = self._solve(-difference(sources, gradients))
            step[:-1] += difference(sources, moved)
            rows = []
            for point, model in zip(points, models, strict=True):
                solver = self._take(model, self.x[:-1] + point.change * step[:-1], point.change * step[-1])
                rows.append(self._rows_of(solver))
            bends = self._bends(points, rows, step) or self._opens(models)
        return models, bends or self._top_held

    def _along_hole(self, points: Sequence[Point], models: Sequence[DrillingModel]) -> FloatArray:
        """(n,) derivative of the unstrained string along the hole by the key: a guess with which contacts stay closed where the hole moves."""
        placed = []
        for model in models:
            place_along_hole(model, top_depth(model))
            placed.append(model.system.assembly.x[: len(self.x) - 1] - self.x[:-1])
        layout, names = self.model.system.layout, ("string.position", "string.tangent")
        follows = np.array([f.name in names for f in layout.fields])[layout.field_of]
        return np.where(follows, difference(points, placed), 0.0)

    def solved(self, model: DrillingModel) -> StaticState:
        """Put a model beside that of the state into its own equilibrium, by Newton's method from here; collective.

        Raises SolveError if no stable state is near, or if the place of the top is part of the state.
        """
        if self.state.top_lies or self._top_held:
            raise SolveError("the top lies on the wall")
        solver, report = self._take(model, self.x), Equilibrium()
        solver.newton(report, near=True)
        for component in model.components:  # stability is counted without friction
            component.impose_sliding_direction(0.0, 0.0)
        if solver.negative_pivots():
            raise SolveError("the state nearby is not stable")
        self._oppose(model)
        self._rows_of(solver)
        return replace(self.state, equilibrium=report)

    def _take(self, model: DrillingModel, x: FloatArray, move: float = 0.0) -> StaticNewton:
        """Put a new model into the state with unknowns ``x``, its top ``move`` [m] further down; returns its equations."""
        place_along_hole(model, top_depth(model))
        take_unknowns(model, self.model)
        model.top.anchor += self.top
        asm, n = model.system.assembly, model.system.layout.size
        asm.x[:n] = x[:n]
        for component in model.components:
            component.forget_hole()  # it was evaluated at other places of the string
            component.locate_hole(asm)
        solver = self._solver(model)  # whose rates follow the hole
        if move:
            model.top.shift(move)
        asm.invalidate_prescribed_values()
        return solver

    @staticmethod
    def _rows_of(solver: StaticNewton) -> FloatArray:
        """Residual (n + 1,): the gradient, and less the way of the bit to its depth."""
        return np.append(solver.gradient(), -solver.missing_depth())

    def _solve(self, rows: FloatArray) -> FloatArray:
        step, move = self.solver.step_for(rows[:-1], float(rows[-1]))
        return np.append(step, move)

    def _bends(self, points: Sequence[Point], rows: Sequence[FloatArray], step: FloatArray) -> bool:
        """Whether the state bends within the steps of the key, so that its derivative is not that of the outputs; collective.

        rows: (n + 1,) residual at each point.  What they require as a change of the derivative is compared field by field.
        """
        wanted, layout = self._solve(-difference(points, rows)), self.model.system.layout
        of = layout.field_of
        for field in range(len(layout.fields)):
            mine = np.flatnonzero(of == field)
            own, more = (float(np.abs(q[mine]).max(initial=0.0)) for q in (step, wanted))
            own, more = self.solver.largest(own), self.solver.largest(more)
            noise = NOISE * layout.fields[field].scale / abs(points[-1].change)
            if more > BENT * own + noise:
                return True
        return False

    def _opens(self, models: Sequence[DrillingModel]) -> bool:
        """Whether contacts of a model are open that are closed in the state, or closed that are open there; collective.

        The matrix has closed contacts, which hide in ``_bends`` how far an open one moves.
        """
        changed = 0
        for model in models:
            flags = model.system.contact_flags
            # pipes of one diameter have no contact of their own at the end between them
            pairs = zip(flags, self._contacts, strict=False)
            changed += len(flags) != len(self._contacts) or not all(
                np.array_equal(f.values, own) for f, own in pairs
            )
        return self.solver.sum(float(changed)) > 0
