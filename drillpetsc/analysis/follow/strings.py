"""Readings of hook load and torque as the soft string gives them, for many guesses of the states in one batch."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from drillpetsc.analysis.follow.state import HOOK, TORQUE, State
from drillpetsc.analysis.loads.torque_drag.batch import Columns, Hole, SoftStrings
from drillpetsc.analysis.loads.torque_drag.circulation import Circulation, circulation
from drillpetsc.analysis.loads.torque_drag.operations import groups_of
from drillpetsc.analysis.loads.torque_drag.readings.flow_table import FlowTable
from drillpetsc.analysis.loads.torque_drag.readings.sensor import DIRECTION, sensor_of
from drillpetsc.analysis.loads.torque_drag.string_rows import gravity_of, need_well, rows_at
from drillpetsc.arrays import FloatArray
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError, SolveError

LONGEST_STEP = 25.0  # of the integration where the hole is straight: there it is exact without a helix [m]
FLOW_SPACING, FLOW_RATIO = (
    200.0,
    1.25,
)  # bit depths [m], and ratio of rates, between which flows are interpolated
SLIPS = "in_slips"


@dataclass(frozen=True)
class Load:
    """What the rig does in a row, SI; ``operation`` of `roadmap`, or in_slips.

    velocity: of the string, up; torque_on_bit: nan where it is not measured.
    """

    operation: str
    bit_depth: float
    wob: float = 0.0
    torque_on_bit: float = np.nan
    velocity: float = 0.0
    rotation: float = 0.0
    flow: float = 0.0

    @property
    def on_bottom(self) -> bool:
        """Whether the bit carries weight."""
        return self.operation in ("drilling", "sliding")


@dataclass(frozen=True)
class Tangent:
    """What a beam has at its top beyond the soft string, near a state.

    at: friction factors and weight factor of the state; ends: (2,) tension [N] and torque [N m] there; slopes: (2,) of each by name.
    """

    at: dict[str, float]
    ends: list[float]
    slopes: dict[str, list[float]]

    def of(self, states: Mapping[str, FloatArray]) -> FloatArray:
        """(2, s) tension and torque for states (s,) each; friction is that in the string."""
        away = [
            np.array(slope)[:, None] * (states[name] - self.at[name]) for name, slope in self.slopes.items()
        ]
        return np.array(self.ends)[:, None] + np.sum(away, axis=0)


class Strings:
    """Soft strings of a case at any bit depth, one at a time.

    tangents: operation -> what a beam adds to them; remarks: what could not be computed, each once.
    """

    def __init__(self, case: Case, states: Sequence[State]) -> None:
        self.case, self.well = case, need_well(case, "follow")
        gravity_of(case, "follow")
        self.names = [q.name for q in states]
        self._friction = groups_of(case)
        self.groups = list(self._friction.last)
        self.sensor, self.remarks = sensor_of(case), list[str]()
        self.tangents: dict[str, Tangent] = {}
        self._depth = np.nan
        self._string: SoftStrings | None = None
        self._flows: dict[tuple[int, int], Circulation | None] = {}

    def readings(self, points: FloatArray, load: Load) -> FloatArray:
        """(s, 2) hook load as the sensor reads it, block included [N], and surface torque [N m].

        points: (s, n) of the states.  Raises CaseError for a depth at which the case has no string.
        """
        of = dict(zip(self.names, points.T, strict=True))
        if load.operation == SLIPS:
            return np.column_stack([of["block_weight"] + of[HOOK], np.zeros(len(points))])
        tension, torque = self._ends(of, load)
        running = load.velocity if load.operation.startswith("trip") else 0.0
        hook = tension + of["block_weight"] + of["running_drag"] * running
        hook = hook / self.sensor.factor(DIRECTION[load.operation]) + of[HOOK]
        return np.column_stack([hook, torque * (1 + of[TORQUE])])

    def exists(self, depth: float) -> bool:
        """Whether the case has a string with its bit at a depth [m]."""
        try:
            return bool(self._at(depth))
        except CaseError:
            return False

    @property
    def hoisting_factor(self) -> float:
        """Weight on the hook over the reading while the block rises."""
        return self.sensor.factor(DIRECTION["trip_out"])

    def _ends(self, of: dict[str, FloatArray], load: Load) -> tuple[FloatArray, FloatArray]:
        """(tension [N], torque [N m]) at the top, (s,) each; equal strings are integrated once.

        of: state -> (s,) values.  Half of the sigma points differ only in what is added to the string afterwards.
        """
        groups = self.groups
        bit = np.full(len(of["weight_factor"]), load.torque_on_bit if load.rotation else 0.0)
        if load.rotation and np.isnan(load.torque_on_bit):
            bit = load.wob * np.maximum(of["bit_torque"], 0.0)
        own = np.column_stack([*(of[name] for name in groups), of["weight_factor"], bit])
        own[:, : len(groups)] = np.clip(own[:, : len(groups)], 0.0, 1.0)
        own, which = np.unique(own, axis=0, return_inverse=True)
        friction = self._friction.friction(dict(zip(groups, own.T, strict=False)))
        string = self._at(load.bit_depth)
        lift, thrust = self._mud(load, string.holes[0].edges)
        columns = Columns(
            np.zeros(len(own), dtype=int), friction, load.wob, own[:, -1], load.velocity, load.rotation,
            weight_factor=own[:, -2], lift=None if lift is None else [lift] * len(own), thrust=thrust,
        )  # fmt: skip
        tension, torque, *_ = string.ends(columns)
        if load.operation in self.tangents:
            more = self.tangents[load.operation].of(
                dict(zip([*groups, "weight_factor"], own.T, strict=False))
            )
            tension, torque = tension + more[0], torque + more[1]
        return tension[which.ravel()], torque[which.ravel()]

    def _at(self, depth: float) -> SoftStrings:
        if depth != self._depth or self._string is None:
            self._depth = depth
            self._string = SoftStrings(
                [Hole(self.well, [rows_at(self.case, depth, "bit depth")], LONGEST_STEP)]
            )
        return self._string

    # ------------------------------------------------------------------ mud
    def _mud(self, load: Load, edges: FloatArray) -> tuple[FloatArray | None, float]:
        """(lift per length (k,) [N/m] in the steps between ``edges``, None without any; thrust of the jets [N])."""
        if (
            not load.flow > 0  # a sensor may read a little below zero
            or self.case.fluid is None
            or not self.case.has_bore
            or load.operation.startswith("trip")
        ):
            return None, 0.0
        i = int(np.floor(load.bit_depth / FLOW_SPACING))
        j = int(np.floor(np.log(load.flow) / np.log(FLOW_RATIO)))
        found = tuple(tuple(self._flow(a, b) for b in (j, j + 1)) for a in (i, i + 1))
        known = [q for row in found for q in row if q is not None]
        if not known:
            return None, 0.0
        rates = np.array([FLOW_RATIO**j, FLOW_RATIO ** (j + 1)])
        depths = np.array([self._flow_depth(i), self._flow_depth(i + 1)])
        whole = tuple(tuple(known[-1] if q is None else q for q in row) for row in found)
        return FlowTable(depths, rates, whole).forces(load.bit_depth, load.flow, edges)

    def _flow_depth(self, i: int) -> float:
        return min(i * FLOW_SPACING, float(self.case.given_well.survey.md[-1]))

    def _flow(self, i: int, j: int) -> Circulation | None:
        """Forces of the mud at a depth and rate of the grid, computed once; None if there is no steady flow."""
        if (i, j) not in self._flows:
            try:
                self._flows[i, j] = circulation(self.case, self._flow_depth(i), FLOW_RATIO**j, "flow rate")
            except (CaseError, SolveError) as error:
                self._flows[i, j] = None
                remark = f"forces of the mud left out near {self._flow_depth(i):.0f} m: {' '.join(str(error).split())[:160]}"
                self.remarks += [] if remark in self.remarks else [remark]
        return self._flows[i, j]
