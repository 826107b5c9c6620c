"""Soft strings of measured points: hook load and torque at the top of the string as a function of the parameters of a calibration."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from drillpetsc.analysis.loads.torque_drag.batch import Columns, Hole, SoftStrings
from drillpetsc.analysis.loads.torque_drag.circulation import Circulation, circulation
from drillpetsc.analysis.loads.torque_drag.operations import groups_of, load_of, plan_of
from drillpetsc.analysis.loads.torque_drag.readings.flow_table import flow_table
from drillpetsc.analysis.loads.torque_drag.readings.parameters import Parameter, parameter_of
from drillpetsc.analysis.loads.torque_drag.string_rows import StringRows, gravity_of, need_well, rows_at
from drillpetsc.analysis.sensitivities.keys import Key, changed_case
from drillpetsc.arrays import FloatArray, IntArray
from drillpetsc.case.blocks.roadmap import MeasuredPoint
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.unit_systems import shown

LONGEST_STEP = 25.0  # of the integration where the hole is straight: there it is exact without a helix [m]
MOST_FLOWS, FLOW_SPACING = 60, 20.0  # steady flows beyond which they are interpolated; between bit depths [m]
FLOW_RANGE = 2.0  # ratio of the rates between which they are
MOST_CASES = 32  # changed cases that are kept
Values = Mapping[str, float]


class SoftForward:
    """Soft strings at the bit depths of measured points.

    case: with a well; points: measured; like: strings of a case that differs in its roadmap only, which are the same.
    Raises CaseError for points that the string cannot reach.
    groups: friction of the hole's sections; factors: names of the groups, each with one friction factor.
    loads: (n, 4) weight on bit, its torque, axial velocity and rotation of each point.
    """

    def __init__(self, case: Case, points: Sequence[MeasuredPoint], like: SoftForward | None = None) -> None:
        self.case, self.points = case, tuple(points)
        self.units = case.shown_units
        if like is None:
            self.well = need_well(case, "calibrate")
            gravity_of(case, "calibrate")
            self.rows, self.placed = self._placed_points()
            self._strings = SoftStrings([Hole(self.well, [rows], LONGEST_STEP) for rows in self.rows])
        else:
            self.well, self.rows, self.placed, self._strings = (
                like.well,
                like.rows,
                like.placed,
                like._strings,
            )
        self.groups = groups_of(case)
        self.factors = tuple(self.groups.last)
        self.loads, self._rates = self._loads_of_points()
        self.pumped = any(flow for flow, _ in self._rates)
        #: operations of points with the pumps off
        self.still = tuple(
            dict.fromkeys(p.operation for p, (flow, _) in zip(points, self._rates, strict=True) if not flow)
        )
        self._flows: dict[tuple[int, float], Circulation] = {} if like is None else like._flows
        self._set_flow(self._rates)
        self._parameters: dict[str, Parameter] = {}
        self._changed: dict[tuple[tuple[Key, float], ...], SoftForward | None] = {}

    def parameter(self, name: str) -> Parameter:
        """A parameter by its name; raises CaseError for one that is neither known nor a number of the case."""
        if name not in self._parameters:
            self._parameters[name] = parameter_of(self.case, name, self.factors)
        return self._parameters[name]

    def ends(self, sets: Sequence[Values]) -> tuple[FloatArray, FloatArray]:
        """(tension [N], torque [N m]) at the top, (s, n) each, for s sets of parameters; nan where there is no string.

        Those not in a set are the case's.
        """
        tension, moment = np.full((2, len(sets), len(self.points)), np.nan)
        alike: dict[tuple[tuple[Key, float], ...], list[int]] = {}
        for j, values in enumerate(sets):
            alike.setdefault(self._changes(values), []).append(j)
        for changes, some in alike.items():
            at = self._with(changes)
            if at is not None:
                tension[some], moment[some] = at._ends([sets[j] for j in some])
        return tension, moment

    def near(self, base: Values, sets: Sequence[Values]) -> tuple[FloatArray, FloatArray]:
        """As ``ends``, for sets beside a ``base`` of which each differs in one parameter."""
        return self.ends(sets)

    def at(self, values: Values) -> SoftForward:
        """The strings with other numbers of the case; raises CaseError or SolveError if there are none."""
        changes = self._changes(values)
        found = self._with(changes)
        return self._made(changes) if found is None else found

    def flow_at(self, i: int) -> Circulation | None:
        """Forces of the mud at a point; None if it stands still there."""
        flow, at = self._rates[i]
        return self._flow(i, flow, at) if flow else None

    # ------------------------------------------------------------------ pieces
    def _changes(self, values: Values) -> tuple[tuple[Key, float], ...]:
        """Numbers of the case among the parameters, without those that are as in the case."""
        keys = ((self.parameter(name).key, value) for name, value in values.items())
        return tuple((key, value) for key, value in keys if key is not None and value != key.value)

    def _with(self, changes: tuple[tuple[Key, float], ...]) -> SoftForward | None:
        """The strings with other numbers of the case; None if the case allows none."""
        if not changes:
            return self
        if changes not in self._changed:
            while len(self._changed) >= MOST_CASES:
                del self._changed[next(iter(self._changed))]
            try:
                self._changed[changes] = self._made(changes)
            except (CaseError, SolveError):
                self._changed[changes] = None
        return self._changed[changes]

    def _made(self, changes: tuple[tuple[Key, float], ...]) -> SoftForward:
        same = all(key.name.startswith("roadmap.") for key, _ in changes)
        return SoftForward(changed_case(self.case, dict(changes)), self.points, self if same else None)

    def _ends(self, sets: Sequence[Values]) -> tuple[FloatArray, FloatArray]:
        """As ``ends``, with the numbers of this case."""
        count, n = len(sets), len(self.points)
        friction = np.array([self.groups.friction(values) for values in sets])
        factor = np.array([values.get("weight_factor", 1.0) for values in sets])
        string, which = np.tile(np.arange(n), count), np.repeat(np.arange(count), n)
        wob, torque, velocity, rotation = self.loads[string].T
        columns = Columns(
            self.placed[string],
            friction[which],
            wob,
            torque,
            velocity,
            rotation,
            weight_factor=factor[which],
            lift=self.lift * count if self.pumped else None,
            thrust=self.thrust[string],
        )
        tension, moment, *_ = self._strings.ends(columns)
        return tension.reshape(count, n), moment.reshape(count, n)

    def _placed_points(self) -> tuple[list[StringRows], IntArray]:
        """The strings at the bit depths of the points, and the number of its string for each point."""
        case, points = self.case, self.points
        end = float(case.given_well.survey.md[-1])
        for i, point in enumerate(points):
            if point.bit_depth > end + 1e-6:
                want = f"at most {shown(end, 'length', self.units, 6)}, the end of the hole"
                raise CaseError(
                    at=f"measured[{i}].bit_depth",
                    got=shown(point.bit_depth, "length", self.units, 6),
                    want=want,
                )
        depths = sorted({point.bit_depth for point in points})
        at = f"measured[{next(i for i, p in enumerate(points) if p.bit_depth == depths[0])}].bit_depth"
        strings = [rows_at(case, depth, at) for depth in depths]
        for i, point in enumerate(points):
            unfit = strings[depths.index(point.bit_depth)].misfit
            if unfit:
                got, want = (
                    shown(point.bit_depth, "length", self.units, 6),
                    "a depth at which the string fits the hole",
                )
                raise CaseError(at=f"measured[{i}].bit_depth", got=got, want=want, hint=unfit)
        return strings, np.array([depths.index(point.bit_depth) for point in points])

    def _loads_of_points(self) -> tuple[FloatArray, list[tuple[float | None, str]]]:
        """(n, 4) weight on bit, its torque, axial velocity and rotation of each point; and its flow rate with the key that gives it."""
        case, points = self.case, self.points
        plan = plan_of(case)
        loads: list[tuple[float, ...]] = []
        flows: list[tuple[float | None, str]] = []
        for point in points:
            load = load_of(case, plan, point.operation)
            speed = abs(load.axial_velocity) if point.speed is None else point.speed
            if not speed:
                speed = abs(
                    load.axial_velocity
                )  # a reading of 0 while tripping: the direction is what counts
            on_bottom = point.operation in ("drilling", "sliding")
            loads.append(
                (
                    point.wob if on_bottom and point.wob is not None else load.wob,
                    load.torque if point.tob is None else point.tob,
                    np.sign(load.axial_velocity) * speed,
                    load.rotation if point.rpm is None else point.rpm,
                )
            )
            key = f"measured[{len(flows)}].flow_rate"
            own = point.flow_rate is not None
            flows.append(
                (
                    point.flow_rate if own else load.flow,
                    key if own else f"roadmap.{point.operation}.flow_rate",
                )
            )
        return np.array(loads, dtype=float).reshape(-1, 4), flows

    def _set_flow(self, flows: Sequence[tuple[float | None, str]]) -> None:
        """Forces of flowing mud on the string of each point.

        flows: rate [m3/s] of each point, and the key that gives it.
        """
        edges = [self._strings.holes[p].edges for p in self.placed]
        self.lift = [np.zeros(len(q) - 1) for q in edges]
        self.thrust = np.zeros(len(flows))
        pumped = [(i, flow, at) for i, (flow, at) in enumerate(flows) if flow]
        distinct = {(int(self.placed[i]), flow) for i, flow, _ in pumped}
        if len(distinct) > MOST_FLOWS:
            depth = np.array([self.points[i].bit_depth for i, _, _ in pumped])
            rate = np.array([flow for _, flow, _ in pumped])
            for low, high in _rates(rate):
                some = [k for k, q in enumerate(rate) if low <= q <= high]
                table = flow_table(self.case, depth[some], rate[some], FLOW_SPACING, pumped[some[0]][2])
                for k in some:
                    i = pumped[k][0]
                    self.lift[i], self.thrust[i] = table.forces(depth[k], rate[k], edges[i])
            return
        for i, flow, at in pumped:
            found = self._flow(i, flow, at)
            self.lift[i], self.thrust[i] = found.lift(edges[i]), found.thrust

    def _flow(self, i: int, flow: float, at: str) -> Circulation:
        key = int(self.placed[i]), flow
        if key not in self._flows:
            self._flows[key] = circulation(self.case, self.points[i].bit_depth, flow, at)
        return self._flows[key]


def _rates(rate: FloatArray) -> list[tuple[float, float]]:
    """Ranges of the rates [m3/s], each so narrow that forces between its ends can be interpolated."""
    out: list[tuple[float, float]] = []
    for q in np.unique(rate):
        if out and q <= FLOW_RANGE * out[-1][0]:
            out[-1] = out[-1][0], float(q)
        else:
            out.append((float(q), float(q)))
    return out
