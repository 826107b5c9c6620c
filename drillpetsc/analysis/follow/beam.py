"""The beam beside the soft string, once a stand: its hook load and torque with the same friction, and its tangent (manual: sec-follow-stiff)."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, Literal

import numpy as np
from petsc4py import PETSc

from drillpetsc.analysis.follow.state import STAND
from drillpetsc.analysis.follow.strings import SLIPS, Load, Strings, Tangent
from drillpetsc.analysis.loads.limits.along_string import Surroundings, static_state
from drillpetsc.analysis.loads.torque_drag.batch import Columns, Hole, soft_strings
from drillpetsc.analysis.loads.torque_drag.readings.forward_soft import SoftForward
from drillpetsc.analysis.loads.torque_drag.readings.forward_stiff import StiffForward
from drillpetsc.analysis.loads.torque_drag.stiff import need_beam
from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.roadmap import MeasuredPoint
from drillpetsc.case.quantities import InSI
from drillpetsc.errors import CaseError, SolveError

Model = Literal["soft", "stiff"]
WINDOW = 100.0  # length in which the models are compared along the string [m]
LEAST = 0.01  # friction at which a tangent is taken at least
REMARKS = 5  # depths without a beam that are named


@dataclass(frozen=True)
class Origin:
    """Where most of a difference arises: measured depths [m]; whether the soft string is coiled there."""

    upper: float
    lower: float
    coiled: bool


@dataclass(frozen=True)
class Compared:
    """Beam and soft string with the same friction and weights.

    soft, stiff: (2,) hook load as the sensor reads it [N], surface torque [N m].
    origins: of the difference of each; None at the end of a path, where the beam has one of several states.
    """

    soft: FloatArray
    stiff: FloatArray
    origins: tuple[Origin, Origin] | None


class Beam:
    """One static equilibrium of the beam a stand and operation; between them the strings read its tangent.

    model: soft, no beam is solved; remarks: where there was no state, each once; seconds: of each solution.
    Raises CaseError for a case that the beam does not cover.
    """

    def __init__(self, strings: Strings, model: Model) -> None:
        self.strings, self.model = strings, model
        if model == "stiff":
            need_beam(strings.case)
        self.remarks: list[str] = []
        self.seconds: list[float] = []
        self._looked: dict[str, float] = {}

    def look(self, load: Load, mean: FloatArray) -> Compared | None:
        """The beam at a row if the last one of its operation is a stand away; None otherwise, and where it has no state.

        mean: (n,) of the states.
        """
        word, depth = load.operation, load.bit_depth
        if self.model == "soft" or word == SLIPS:
            return None
        if abs(depth - self._looked.get(word, np.inf)) < STAND - 1e-6:
            return None
        self._looked[word] = depth
        tangents = self.strings.tangents
        tangents.pop(word, None)
        soft = self.strings.readings(mean[None], load)[0]
        begun = time.perf_counter()
        try:
            tangents[word], origins = self._solved(load, mean)
        except (CaseError, SolveError) as error:
            remark = f"no beam at {depth:.0f} m, {word.replace('_', ' ')}, where the soft string stands in: {' '.join(str(error).split())[:200]}"
            self.remarks += [remark] if len(self.remarks) < REMARKS else []
            return None
        finally:
            self.seconds.append(time.perf_counter() - begun)
        return Compared(soft, self.strings.readings(mean[None], load)[0], origins)

    def _solved(self, load: Load, mean: FloatArray) -> tuple[Tangent, tuple[Origin, Origin] | None]:
        names = [*self.strings.groups, "weight_factor"]
        of = dict(zip(self.strings.names, mean.tolist(), strict=True))
        at = {name: float(np.clip(of[name], LEAST, 1.0)) for name in names[:-1]} | {names[-1]: of[names[-1]]}
        soft = SoftForward(self.strings.case, [self._point(load, of)])
        stiff = StiffForward(soft, PETSc.COMM_SELF, at)
        beside = [at, *({**at, name: value + 1e-3} for name, value in at.items())]
        found = np.array([stiff.near(at, beside), soft.near(at, beside)])[..., 0]  # model, reading, set
        own, tangent = found[0] - found[1], {}
        for k, name in enumerate(names, 1):
            tangent[name] = ((own[:, k] - own[:, 0]) / 1e-3).tolist()
        if not np.isfinite(own).all():
            raise SolveError("the soft string cannot carry its weight on bit")
        return Tangent(at, own[:, 0].tolist(), tangent), _origins(stiff, at)

    def _point(self, load: Load, of: Mapping[str, float]) -> MeasuredPoint:
        tob = load.wob * of["bit_torque"] if np.isnan(load.torque_on_bit) else load.torque_on_bit
        keys = {
            "bit_depth": load.bit_depth, "hook_load": 0.0, "wob": load.wob, "tob": max(tob, 0.0) if load.rotation else 0.0,
            "rpm": load.rotation, "speed": abs(load.velocity),
            "flow_rate": 0.0 if load.operation.startswith("trip") else max(load.flow, 0.0),
        }  # fmt: skip
        return MeasuredPoint.model_validate(
            {"operation": load.operation, **{key: InSI(value) for key, value in keys.items()}}
        )

    # ------------------------------------------------------------------ restart
    def saved(self) -> dict[str, Any]:
        """Everything that a restart needs, in JSON types."""
        tangents = {word: asdict(q) for word, q in self.strings.tangents.items()}
        return {
            "looked": self._looked,
            "tangents": tangents,
            "remarks": self.remarks,
            "seconds": self.seconds,
        }

    def restore(self, saved: dict[str, Any]) -> None:
        """Continue from what was saved."""
        self._looked, self.remarks, self.seconds = saved["looked"], saved["remarks"], saved["seconds"]
        self.strings.tangents |= {word: Tangent(**q) for word, q in saved["tangents"].items()}


def _origins(stiff: StiffForward, at: Mapping[str, float]) -> tuple[Origin, Origin] | None:
    """Where the tension and the torque of beam and soft string part most, from the bit up."""
    model, soft = stiff.model_of(0), stiff.soft
    if model is None:
        return None
    state, md = static_state(model), Surroundings(model).md
    assert state is not None
    hole, flow = Hole(soft.well, [soft.rows[0]]), soft.flow_at(0)
    wob, torque, velocity, rotation = soft.loads.T
    columns = Columns(
        np.zeros(1, dtype=int), soft.groups.friction(at)[None], wob, torque, velocity, rotation, weight_factor=at["weight_factor"],
        lift=None if flow is None else [flow.lift(hole.edges)], thrust=0.0 if flow is None else flow.thrust,
    )  # fmt: skip
    batch = soft_strings(hole, columns)
    marks = np.arange(md[-1, 1], md[0, 0], -0.1 * WINDOW)
    out = []
    for own, other, more in (
        (state.effective, batch.tension, 0.0),
        (state.torque, batch.torque, torque[0]),
    ):
        off = np.interp(marks, md.ravel(), own.ravel() + more) - np.interp(marks, hole.edges, other[:, 0])
        gained = (off[10:] - off[:-10]) * np.sign(off[-1] - off[0])
        k = int(np.argmax(gained))
        lower, upper = float(marks[k]), float(marks[k + 10])
        inside = (hole.edges[:-1] >= upper) & (hole.edges[1:] <= lower)
        out.append(Origin(upper, lower, bool((batch.state[inside, 0] == 2).any())))
    return out[0], out[1]
