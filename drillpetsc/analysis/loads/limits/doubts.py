"""Doubts about the limits of a string: limits that are passed, and what the table leaves out."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from drillpetsc.analysis.loads.limits.buckling_loads import law_words
from drillpetsc.analysis.loads.limits.fatigue import AS_S, rule_of
from drillpetsc.analysis.loads.limits.table import Choices
from drillpetsc.case.blocks.items.tubulars import DrillPipe, Jointed, Tubular
from drillpetsc.case.case import Case
from drillpetsc.doubts.doubt import Values, doubt, remark
from drillpetsc.doubts.moments import Moment


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

    def passed(self, column: str, limit: float) -> dict[str, Any]:
        """The worst place of a column if its value is above a limit, else nothing."""
        worst = self.weakest.get(column)
        return worst if worst is not None and worst["value"] > limit else {}


# ---------------------------------------------------------------------- limits that are passed
@doubt(
    "safety factor {value:.3g}, below the design factor {design:g}, at MD {md:length 5} ({item})",
    "Use pipe of a higher grade or a thicker wall there, or reduce pull and torque.",
)
def weak_pipe(at: Judged) -> Values:
    """The stress in the wall of the pipe leaves less than the design factor to its yield strength."""
    worst, design = at.weakest.get("safety_factor"), at.choices.design_factor
    return worst and worst["value"] < design and {**worst, "design": design}


@doubt(
    "pull at yield over tension {factor:.3g}, below {least:g}, at MD {md:length 5} ({item})",
    "Use stronger pipe at the top, or a lighter string below it.",
)
def high_pull(at: Judged) -> Values:
    """The tension is too close to the pull at which the pipe yields."""
    worst, least = at.passed("tension_ratio", 0.0), at.choices.tension_design_factor
    factor = at.choices.tension_fraction / worst["value"] if worst else np.inf
    return factor < least and {**worst, "factor": factor, "least": least}


@doubt(
    "torque {value:.3g} times its limit at MD {md:length 5} ({item})",
    "Use stronger pipe, or reduce friction or torque on bit.",
)
def high_torque(at: Judged) -> Values:
    """The torque exceeds the limit of the tube."""
    return at.passed("torque_ratio", 1.0)


@doubt(
    "torque {value:.3g} times the make-up torque, connections make up further in the hole, at MD {md:length 5} ({item})",
    "Make connections up with more torque, or reduce the torque.",
)
def makes_up(at: Judged) -> Values:
    """The torque exceeds the make-up torque, so connections make up further in the hole."""
    return at.passed("make_up_ratio", 1.0)


@doubt(
    "dogleg {value:.3g} times the permissible one of API RP 7G at MD {md:length 5} ({item})",
    "Rotate less with that pipe in the dogleg, ream the dogleg, or reduce the tension there.",
)
def sharp_dogleg(at: Judged) -> Values:
    """The hole bends more than drill pipe withstands without fatigue while it turns under tension (API RP 7G)."""
    return at.passed("fatigue_ratio", 1.0)


@doubt(
    "inside pressure {value:.3g} times the burst pressure at MD {md:length 5} ({item})",
    "Use pipe of a higher grade or a thicker wall, or pump less.",
)
def bursts(at: Judged) -> Values:
    """The pressure inside exceeds the burst pressure of the pipe."""
    return at.passed("burst_ratio", 1.0)


@doubt(
    "outside pressure {value:.3g} times the collapse pressure at MD {md:length 5} ({item})",
    "Fill the pipe, or use a thicker wall.",
)
def collapses(at: Judged) -> Values:
    """The pressure outside exceeds the collapse pressure of the pipe."""
    return at.passed("collapse_ratio", 1.0)


@doubt(
    "fatigue life of {life:.3g} h by {source} at MD {md:length 5} ({item})",
    "Turn more slowly, reduce the bending there, or replace the pipe in time.",
)
def short_life(at: Judged) -> Values:
    """Bending while the string turns uses up its fatigue life within hours."""
    curve, worst = at.choices.sn, at.passed("damage_per_hour", 0.01)
    return curve and worst and {**worst, "life": 1 / worst["value"], "source": curve.source}


@doubt(
    "bending stress beyond the largest stress of {source}: the curve gives no life there",
    "Reduce the bending, or give an S-N curve that goes higher.",
)
def beyond_fatigue_curve(at: Judged) -> Values:
    """The bending stress exceeds the largest of the fatigue curve, which gives no life there."""
    if at.choices.sn is None:
        return None
    stress, damaged = at.table["worst_bending_stress"], at.table["damage_per_hour"]
    return (np.isfinite(stress) & np.isnan(damaged)).any() and {"source": at.choices.sn.source}


@doubt(
    "side force of {value:force} a joint, above {most:force}, at MD {md:length 5} ({item})",
    "Reduce the tension or the dogleg there, or protect the joints.",
)
def high_side_force(at: Judged) -> Values:
    """The side force on a tool joint exceeds the usual limit, beyond which joints and casing wear."""
    most = at.choices.side_force_per_joint
    worst = at.passed("side_force_per_joint", most)
    return worst and {**worst, "most": most}


@doubt(
    "compression beyond the {state} limit{law} between MD {upper:length 5} and {lower:length 5}",
    "Give less weight on bit, use stiffer pipe there, or rotate the string.",
)
def beyond_buckling(at: Judged) -> Values:
    """The compression exceeds a buckling limit of the pipe in its hole."""
    for state in ("sinusoidal", "helical"):
        md = at.table["md"][at.table["buckling_state"] == state]
        if len(md):
            law = f" ({law_words(at.choices.helical)})" if state == "helical" else ""
            yield {"state": state, "law": law, "upper": float(md.min()), "lower": float(md.max())}


@doubt(
    "the string is in compression outside the hole, where no buckling limit applies",
    "Keep the string above the rotary table in tension, or describe its guide as a section of the well.",
)
def free_compression(at: Judged) -> Values:
    """The string is in compression where no wall holds it, so that there is no buckling limit to compare with."""
    flexible = np.isfinite(at.table["curvature"])  # rows of rigid items have none
    return ((at.table["buckling_state"] == "-") & flexible).any()


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


def _pumped(at: Judged) -> float | None:
    """Flow rate at time 0 [m3/s], None without mud in the bore or without a given flow rate."""
    mud, fluid = at.case.fluid, at.model.fluid
    wet = mud is not None and fluid is not None and fluid.bore is not None
    return float(mud.flow_rate.value(0.0)) if wet and mud is not None and mud.flow_rate is not None else None


def _loose(at: Judged) -> list[str]:
    return [item.name for item in at.jointed if item.tool_joint.make_up_torque is None]


@doubt(
    "no yield strength, so no strength limits: {names} (give a kind of pipe with a grade, or yield_strength)"
)
def unknown(at: Judged) -> Values:
    return _names(at.case.string[i].name for i in at.model.mesh.item if np.isnan(yield_of(at.case, i)))


remark(
    Judged,
    "no permissible dogleg for grade {names}: API RP 7G has E and S",
    lambda at: _names(q.grade for q in at.drill_pipe if q.grade and rule_of(q.grade) is None),
)


@doubt("permissible dogleg of {names} by the rule of grade S")
def as_s(at: Judged) -> Values:
    return _names(q.grade for q in at.drill_pipe if q.grade and q.grade.upper().replace(" ", "") in AS_S)


remark(Judged, "no drill pipe: no permissible doglegs", lambda at: not at.drill_pipe)
remark(Judged, "no mud: no pressures and no buoyancy", lambda at: at.model.fluid is None)
remark(Judged, "pressures are computed for still mud", lambda at: _pumped(at) == 0.0)
remark(
    Judged,
    "pressures are computed for {flow:flow}, also in the margin of overpull; the margin in still mud is given beside it",
    lambda at: _pumped(at) and {"flow": _pumped(at)},
)


@doubt("clearance of the buckling limits: from {which}")
def clearance(at: Judged) -> Values:
    if at.model.contact is None or not at.jointed:
        return None
    words = {"tool_joint": "the tool joints", "body": "the body of the pipe"}
    return {"which": " or ".join(words[word] for word in sorted({item.clearance for item in at.jointed}))}


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
