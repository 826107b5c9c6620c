"""Doubts about the limits of a string: limits that are passed, and what the table leaves out."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from drillpetsc.analysis.loads.limits.buckling_loads import law_words
from drillpetsc.analysis.loads.limits.fatigue import AS_S, rule_of
from drillpetsc.analysis.loads.limits.table import Choices
from drillpetsc.case.blocks.items.tubulars import DrillPipe, Jointed, Tubular
from drillpetsc.case.case import Case
from drillpetsc.doubts.doubt import Doubt, remark
from drillpetsc.doubts.moments import Moment

Values = Iterable[dict[str, Any]]


@dataclass(frozen=True, kw_only=True)
class Judged(Moment):
    """The limits of a static state have been computed (limits).

    table: columns of limits.csv; weakest: worst value, md [m] and item by column, None for an empty one.
    word: the operation, None for the case as it is; turning: rotation in it [rad/s]; wob: weight on bit of the state [N].
    soft: the soft string gives margins; strength: a yield strength is known.
    """

    table: Mapping[str, Any]
    weakest: dict[str, Any]
    choices: Choices
    word: str | None
    turning: float
    wob: float
    soft: bool
    strength: bool

    @property
    def drill_pipe(self) -> list[DrillPipe]:
        """The drill pipe of the string."""
        return [item for item in self.case.string if isinstance(item, DrillPipe)]

    @property
    def jointed(self) -> list[Jointed]:
        """The pipe with tool joints."""
        return [item for item in self.case.string if isinstance(item, Jointed)]


# ---------------------------------------------------------------------- limits that are passed
class _Passed(Doubt):
    """A limit is passed somewhere: at the worst place of a column."""

    about = (Judged,)
    column: ClassVar[str]

    def passed(self, value: float, choices: Choices) -> bool:
        """Whether the worst value passes the limit."""
        return value > 1

    def limit(self, value: float, choices: Choices) -> dict[str, Any]:
        """Values of the sentence beside value, md and item."""
        return {}

    def look(self, at: Judged) -> Values:
        worst = at.weakest.get(self.column)
        if worst is not None and self.passed(worst["value"], at.choices):
            yield {**worst, **self.limit(worst["value"], at.choices)}


class WeakPipe(_Passed):
    """The stress in the wall of the pipe leaves less than the design factor to its yield strength."""

    column = "safety_factor"
    sentence = "safety factor {value:.3g}, below the design factor {design:g}, at MD {md:length 5} ({item})"
    remedy = "Use pipe of a higher grade or a thicker wall there, or reduce pull and torque."

    def passed(self, value: float, choices: Choices) -> bool:
        return value < choices.design_factor

    def limit(self, value: float, choices: Choices) -> dict[str, Any]:
        return {"design": choices.design_factor}


class HighPull(_Passed):
    """The tension is too close to the pull at which the pipe yields."""

    column = "tension_ratio"
    sentence = "pull at yield over tension {factor:.3g}, below {least:g}, at MD {md:length 5} ({item})"
    remedy = "Use stronger pipe at the top, or a lighter string below it."

    def passed(self, value: float, choices: Choices) -> bool:
        return self.limit(value, choices)["factor"] < choices.tension_design_factor

    def limit(self, value: float, choices: Choices) -> dict[str, Any]:
        factor = choices.tension_fraction / value if value > 0 else np.inf
        return {"factor": factor, "least": choices.tension_design_factor}


class HighTorque(_Passed):
    """The torque exceeds the limit of the tube."""

    column = "torque_ratio"
    sentence = "torque {value:.3g} times its limit at MD {md:length 5} ({item})"
    remedy = "Use stronger pipe, or reduce friction or torque on bit."


class MakesUp(_Passed):
    """The torque exceeds the make-up torque, so connections make up further in the hole."""

    column = "make_up_ratio"
    sentence = "torque {value:.3g} times the make-up torque, connections make up further in the hole, at MD {md:length 5} ({item})"
    remedy = "Make connections up with more torque, or reduce the torque."


class SharpDogleg(_Passed):
    """The hole bends more than drill pipe withstands without fatigue while it turns under tension (API RP 7G)."""

    column = "fatigue_ratio"
    sentence = "dogleg {value:.3g} times the permissible one of API RP 7G at MD {md:length 5} ({item})"
    remedy = "Rotate less with that pipe in the dogleg, ream the dogleg, or reduce the tension there."


class Bursts(_Passed):
    """The pressure inside exceeds the burst pressure of the pipe."""

    column = "burst_ratio"
    sentence = "inside pressure {value:.3g} times the burst pressure at MD {md:length 5} ({item})"
    remedy = "Use pipe of a higher grade or a thicker wall, or pump less."


class Collapses(_Passed):
    """The pressure outside exceeds the collapse pressure of the pipe."""

    column = "collapse_ratio"
    sentence = "outside pressure {value:.3g} times the collapse pressure at MD {md:length 5} ({item})"
    remedy = "Fill the pipe, or use a thicker wall."


class ShortLife(_Passed):
    """Bending while the string turns uses up its fatigue life within hours."""

    column = "damage_per_hour"
    sentence = "fatigue life of {life:.3g} h by {source} at MD {md:length 5} ({item})"
    remedy = "Turn more slowly, reduce the bending there, or replace the pipe in time."

    def passed(self, value: float, choices: Choices) -> bool:
        return choices.sn is not None and value > 0.01

    def limit(self, value: float, choices: Choices) -> dict[str, Any]:
        assert choices.sn is not None
        return {"life": 1 / value, "source": choices.sn.source}


class BeyondFatigueCurve(Doubt):
    """The bending stress exceeds the largest of the fatigue curve, which gives no life there."""

    about = (Judged,)
    sentence = "bending stress beyond the largest stress of {source}: the curve gives no life there"
    remedy = "Reduce the bending, or give an S-N curve that goes higher."

    def look(self, at: Judged) -> Values:
        if at.choices.sn is None:
            return
        stress, damaged = at.table["worst_bending_stress"], at.table["damage_per_hour"]
        if (np.isfinite(stress) & np.isnan(damaged)).any():
            yield {"source": at.choices.sn.source}


class HighSideForce(_Passed):
    """The side force on a tool joint exceeds the usual limit, beyond which joints and casing wear."""

    column = "side_force_per_joint"
    sentence = "side force of {value:force} a joint, above {most:force}, at MD {md:length 5} ({item})"
    remedy = "Reduce the tension or the dogleg there, or protect the joints."

    def passed(self, value: float, choices: Choices) -> bool:
        return value > choices.side_force_per_joint

    def limit(self, value: float, choices: Choices) -> dict[str, Any]:
        return {"most": choices.side_force_per_joint}


class BeyondBuckling(Doubt):
    """The compression exceeds a buckling limit of the pipe in its hole."""

    about = (Judged,)
    sentence = "compression beyond the {state} limit{law} between MD {upper:length 5} and {lower:length 5}"
    remedy = "Give less weight on bit, use stiffer pipe there, or rotate the string."

    def look(self, at: Judged) -> Values:
        for state in ("sinusoidal", "helical"):
            md = at.table["md"][at.table["buckling_state"] == state]
            if len(md):
                law = f" ({law_words(at.choices.helical)})" if state == "helical" else ""
                yield {"state": state, "law": law, "upper": float(md.min()), "lower": float(md.max())}


class FreeCompression(Doubt):
    """The string is in compression where no wall holds it, so that there is no buckling limit to compare with."""

    about = (Judged,)
    sentence = "the string is in compression outside the hole, where no buckling limit applies"
    remedy = (
        "Keep the string above the rotary table in tension, or describe its guide as a section of the well."
    )

    def look(self, at: Judged) -> Values:
        flexible = np.isfinite(at.table["curvature"])  # rows of rigid items have none
        if ((at.table["buckling_state"] == "-") & flexible).any():
            yield {}


# ---------------------------------------------------------------------- remarks
def yield_of(case: Case, item: int) -> float:
    """Yield strength of an item [Pa], nan if it is unknown."""
    strong = (
        getattr(case.string[item], "yield_strength", None) if isinstance(case.string[item], Tubular) else None
    )
    return np.nan if strong is None else float(strong)


def _names(items: Iterable[str]) -> dict[str, str] | None:
    listed = ", ".join(sorted(set(items)))
    return {"names": listed} if listed else None


def _unknown(at: Judged) -> dict[str, str] | None:
    return _names(at.case.string[i].name for i in at.model.mesh.item if np.isnan(yield_of(at.case, i)))


def _as_s(at: Judged) -> dict[str, str] | None:
    return _names(q.grade for q in at.drill_pipe if q.grade and q.grade.upper().replace(" ", "") in AS_S)


def _pumped(at: Judged) -> float | None:
    """Flow rate at time 0 [m3/s], None without mud in the bore or without a given flow rate."""
    mud, fluid = at.case.fluid, at.model.fluid
    wet = mud is not None and fluid is not None and fluid.bore is not None
    return float(mud.flow_rate.value(0.0)) if wet and mud is not None and mud.flow_rate is not None else None


def _clearance(at: Judged) -> dict[str, str] | None:
    if at.model.contact is None or not at.jointed:
        return None
    words = {"tool_joint": "the tool joints", "body": "the body of the pipe"}
    return {"which": " or ".join(words[word] for word in sorted({item.clearance for item in at.jointed}))}


def _loose(at: Judged) -> list[str]:
    return [item.name for item in at.jointed if item.tool_joint.make_up_torque is None]


remark(
    Judged,
    "no yield strength, so no strength limits: {names} (give a kind of pipe with a grade, or yield_strength)",
    _unknown,
)
remark(
    Judged,
    "no permissible dogleg for grade {names}: API RP 7G has E and S",
    lambda at: _names(q.grade for q in at.drill_pipe if q.grade and rule_of(q.grade) is None),
)
remark(Judged, "permissible dogleg of {names} by the rule of grade S", _as_s)
remark(Judged, "no drill pipe: no permissible doglegs", lambda at: not at.drill_pipe)
remark(Judged, "no mud: no pressures and no buoyancy", lambda at: at.model.fluid is None)
remark(Judged, "pressures are computed for still mud", lambda at: _pumped(at) == 0.0)
remark(
    Judged,
    "pressures are computed for {flow:flow}, also in the margin of overpull; the margin in still mud is given beside it",
    lambda at: _pumped(at) and {"flow": _pumped(at)},
)
remark(Judged, "clearance of the buckling limits: from {which}", _clearance)
remark(Judged, "no wall: no side forces and no buckling limits", lambda at: at.model.contact is None)
remark(
    Judged,
    "no make-up torque of {names}: give tool_joint.make_up_torque",
    lambda at: _names(_loose(at)),
)
remark(
    Judged,
    "torque limits hold for the tube; of the connections only the make-up torque of tool joints is compared",
    lambda at: len(_loose(at)) < len(at.jointed),
)
remark(
    Judged,
    "connections are not checked: torque limits hold for the tube",
    lambda at: len(_loose(at)) == len(at.jointed),
)
remark(
    Judged,
    "no rotation at time 0 in this operation: no cycles and no damage (key top.rotation)",
    lambda at: at.choices.sn is not None and not at.turning,
)
remark(
    Judged,
    "initial.wob is not given: the weight on bit is what a top at the rig leaves on the bottom",
    lambda at: at.word is None and at.case.initial.wob is None and at.wob > 0,
)
remark(
    Judged,
    "no margin of overpull and no largest weight on bit: they need a hole with contact, and gravity that points down",
    lambda at: not at.soft,
)
remark(
    Judged,
    "no margin of overpull: no yield strength is known",
    lambda at: at.soft and not at.strength,
)
remark(
    Judged,
    "margin of overpull, max_wob, max_slackoff and available_wob are computed with the soft string",
    lambda at: at.soft,
)
