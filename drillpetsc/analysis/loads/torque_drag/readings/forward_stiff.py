"""The beam of measured points: static equilibria, and their derivatives from the factored stiffness of each."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
from petsc4py import PETSc

from drillpetsc.analysis.loads.torque_drag import stiff
from drillpetsc.analysis.loads.torque_drag.operations import Load, Pair
from drillpetsc.analysis.loads.torque_drag.readings.forward_soft import SoftForward, Values
from drillpetsc.analysis.sensitivities.keys import STEP, Key
from drillpetsc.analysis.sensitivities.points import CENTRAL, DOWNWARDS, UPWARDS, Point, difference
from drillpetsc.analysis.sensitivities.static_tangent import RESIDUAL_STEP, StaticTangent
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.analysis.statics.static_problem import StaticState
from drillpetsc.arrays import FloatArray
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.model.drilling_model import DrillingModel, build_model
from drillpetsc.model.mesh import MeshOf
from drillpetsc.unit_systems import shown

FULL_STEP = 1e-3  # of differences of full solutions, where a state has no tangent, relative [-]
#: share of the widest interval that tells something, within which derivatives are kept
KEPT = 0.01
Named = tuple[tuple[str, float], ...]


@dataclass(frozen=True)
class _Solved:
    """The state of a point: its tangent, None at the end of a path of friction; tension and torque at the top."""

    tangent: StaticTangent | None
    ends: tuple[float, float]


class StiffForward:
    """Static equilibria of the beam at measured points, which the ranks share out.

    soft: the soft strings of the points, from which the buoyed weights and the flow come; first: parameters at which states are
    sought first.  Raises CaseError for a case that the beam does not cover, and for a point without a state there.
    """

    def __init__(self, soft: SoftForward, comm: PETSc.Comm, first: Values = MappingProxyType({})) -> None:
        stiff.need_beam(soft.case)
        self.soft, self._comm = soft, comm
        self._known: dict[Named, FloatArray] = {}
        self._at: Named | None = None  # parameters of the states
        self._states: dict[int, _Solved] = {}
        self._last: dict[int, _Solved] = {}  # where the search for the next states begins
        self._derivatives: dict[str, FloatArray] = {}
        self._derived: Values | None = None  # parameters of the derivatives
        self._failed: dict[int, str] = {}
        self._need_states(first)

    def ends(self, sets: Sequence[Values]) -> tuple[FloatArray, FloatArray]:
        """As of ``Forward``; collective."""
        found = np.array([self._ends_of(self._named(values)) for values in sets])
        return found[:, 0], found[:, 1]

    def near(self, base: Values, sets: Sequence[Values]) -> tuple[FloatArray, FloatArray]:
        """As of ``Forward``: along the tangents of the states at ``base``; collective."""
        at = dict(self._named(base))
        changes = [{q: v for q, v in self._named(values) if v != at.get(q)} for values in sets]
        names = tuple(dict.fromkeys(q for some in changes for q in some))
        slopes = self._slopes(at, names)
        out = np.tile(self._ends_of(self._named(base)), (len(sets), 1, 1))
        for row, some in zip(out, changes, strict=True):
            for name, value in some.items():
                row += (value - at.get(name, self._default(name))) * slopes[name]
        return out[:, 0], out[:, 1]

    # ------------------------------------------------------------------ states
    def _named(self, values: Values) -> Named:
        """Parameters that change the string."""
        return tuple(sorted((q, float(v)) for q, v in values.items() if self.soft.parameter(q).of_string))

    def _default(self, name: str) -> float:
        key = self.soft.parameter(name).key
        if key is not None:
            return key.value
        return 1.0 if name == "weight_factor" else self.soft.groups.last[name]

    def model_of(self, i: int) -> DrillingModel | None:
        """The model in the latest state of a point; None at the end of a path of friction, and on the other ranks."""
        solved = self._states.get(i)
        return None if solved is None or solved.tangent is None else solved.tangent.model

    def _need_states(self, first: Values) -> None:
        """Raise CaseError for the first point without a state."""
        self._ends_of(self._named(first))
        for i, reason in sorted(self._failed.items()):
            point, units = self.soft.points[i], self.soft.case.shown_units
            got = f"{point.operation} at {shown(point.bit_depth, 'length', units, 6)}"
            want = "a state of the beam that can be trusted; leave the point out, or --model soft"
            raise CaseError(at=f"measured[{i}]", got=got, want=want, hint=" ".join(reason.split()))

    def _ends_of(self, named: Named) -> FloatArray:
        """(2, n) tension and torque, nan where there is no state; the states are kept until others are sought."""
        if named not in self._known:
            self._last |= self._states
            self._at, self._states, failed = named, {}, {}
            mine: dict[int, tuple[float, float]] = {}
            for i in self._own_points():
                try:
                    self._states[i] = self._solved(dict(named), i)
                    mine[i] = self._states[i].ends
                except (CaseError, SolveError) as error:
                    mine[i], failed[i] = (np.nan, np.nan), str(error)
            self._failed = self._together(failed)
            every = self._together(mine)
            self._known[named] = np.array([every[i] for i in range(len(self.soft.points))]).T
        return self._known[named]

    def _own_points(self) -> range:
        return range(self._comm.rank, len(self.soft.points), self._comm.size)

    def _together(self, mine: dict) -> dict:
        """What all ranks have found; collective."""
        parts = [mine] if self._comm.size == 1 else self._comm.tompi4py().allgather(mine)
        return {key: value for part in parts for key, value in part.items()}

    def _job(self, values: Values, i: int) -> stiff.Job:
        soft = self.soft.at(values)
        rows, load = soft.rows[soft.placed[i]], soft.loads[i]
        factor = values.get("weight_factor", 1.0)
        rows = replace(rows, weight=factor * rows.weight, end_weight=factor * rows.end_weight)
        friction = Pair(np.nan, np.nan, soft.groups.friction(values))
        return stiff.Job(rows, friction, Load(*map(float, load)), flow=soft.flow_at(i))

    def _case(self, values: Values, i: int) -> Case:
        """Case of the string at a point; raises CaseError where an item floats."""
        soft = self.soft.at(values)
        return stiff.stiff_case(soft.case, soft.well, self._job(values, i))

    def _solved(self, values: Values, i: int) -> _Solved:
        """Raises CaseError or SolveError for a point without a state."""
        case, load = self._case(values, i), self.soft.at(values).loads[i]
        motion = -float(load[2]), float(load[3])
        beside = self._beside(case, i)
        if beside is None:
            model = build_model(case, PETSc.COMM_SELF, motion)
            start = model.top.anchor.copy()
            state = find_equilibrium(model, motion, False)
            if not state.stable and state.path is None:
                raise SolveError(
                    f"the state is not stable ({state.equilibrium.negative_pivots} negative pivots)"
                )
            ends = self._read(model, values, i)
            try:
                return _Solved(StaticTangent(model, state, start, motion), ends)
            except CaseError:
                return _Solved(None, ends)
        model, state, start = beside
        return _Solved(StaticTangent(model, state, start, motion), self._read(model, values, i))

    def _beside(self, case: Case, i: int) -> tuple[DrillingModel, StaticState, FloatArray] | None:
        """Model, state and place of its top before, from the last state of a point; None if there is none nearby."""
        last = self._last.get(i)
        if last is None or last.tangent is None:
            return None
        like = MeshOf(last.tangent.model.case, last.tangent.model.mesh)
        try:
            model = build_model(case, PETSc.COMM_SELF, last.tangent.motion, like=like)
            start = model.top.anchor.copy()
            return model, last.tangent.solved(model), start
        except (SolveError, ValueError):
            return None

    def _read(self, model: DrillingModel, values: Values, i: int) -> tuple[float, float]:
        """Tension and torque at the top; the torque on bit twists the string alike from end to end."""
        system, torque = model.system, float(self.soft.at(values).loads[i, 1])
        return -system.reaction("top.axial_reaction"), system.reaction("top.torque_reaction") + torque

    # ------------------------------------------------------------------ derivatives
    def _slopes(self, at: Values, names: Sequence[str]) -> dict[str, FloatArray]:
        """(2, n) derivative of tension and torque by each parameter; collective."""
        named = tuple(sorted(at.items()))
        if (
            self._derived is not None
            and self._alike(at, self._derived)
            and self._derivatives.keys() >= set(names)
        ):
            return self._derivatives
        if self._at != named:
            self._known.pop(named, None)
            self._ends_of(named)
        mine: dict[tuple[str, int], tuple[float, float]] = {}
        for i in self._own_points():
            solved = self._states.get(i)
            if solved is None:
                mine |= {(name, i): (np.nan, np.nan) for name in names}
                continue
            mine |= {(name, i): self._slope(solved.tangent, at, name, i) for name in names}
        every, n = self._together(mine), len(self.soft.points)
        self._derived = dict(at)
        self._derivatives = {name: np.array([every[name, i] for i in range(n)]).T for name in names}
        return self._derivatives

    def _alike(self, at: Values, other: Values) -> bool:
        """Whether parameters are so near others that the derivatives there serve."""

        def near(name: str) -> bool:
            away = at.get(name, self._default(name)) - other.get(name, self._default(name))
            return abs(away) <= KEPT * (self.soft.parameter(name).widest or np.inf)

        return all(near(name) for name in {*at, *other})

    def _slope(self, tangent: StaticTangent | None, at: Values, name: str, i: int) -> tuple[float, float]:
        """Derivative of tension and torque of a point; by full solutions if the state has no tangent."""
        value = at.get(name, self._default(name))
        if tangent is not None:
            points = sources = self._points(at, name, value, i, STEP)
            if self.soft.parameter(name).key is not None:  # which may be a diameter, that opens contacts
                sources = self._points(at, name, value, i, RESIDUAL_STEP)
            like = MeshOf(tangent.model.case, tangent.model.mesh)
            build: Callable[[Case], DrillingModel] = lambda case: build_model(  # noqa: E731
                case, PETSc.COMM_SELF, tangent.motion, like=like
            )
            try:
                models = [tangent.model] * len(points)
                if any(
                    q.case != tangent.model.case for q in points
                ):  # else it changes no more than a load at the end
                    models, _ = tangent.near(points, sources, build)
            except ValueError:  # the elements do not correspond
                return self._slope(None, at, name, i)
            ends = [
                np.array(self._read(model, {**at, name: value + point.change}, i))
                for model, point in zip(models, points, strict=True)
            ]
        else:
            points = self._points(at, name, value, i, FULL_STEP)
            try:
                ends = [np.array(self._solved({**at, name: value + q.change}, i).ends) for q in points]
            except (CaseError, SolveError):
                return np.nan, np.nan
        tension, torque = difference(points, ends)
        return float(tension), float(torque)

    def _points(self, at: Values, name: str, value: float, i: int, step: float) -> list[Point]:
        """Cases beside that of a point, for the derivative by a parameter; step: relative."""
        p = self.soft.parameter(name)
        size, (low, high) = step * p.size(value), p.bounds
        stencil = (
            CENTRAL if low + size <= value <= high - size else UPWARDS if value < high - size else DOWNWARDS
        )
        key = Key(name, value, "")
        return [
            Point(self._case({**at, name: value + size * q}, i), key, size * q, w / size) for q, w in stencil
        ]
