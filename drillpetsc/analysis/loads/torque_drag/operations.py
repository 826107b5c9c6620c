"""Operations, friction pairs and bit depths of a roadmap: what the case asks for, and what was assumed."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from drillpetsc.analysis.loads.torque_drag.string_rows import StringRows, rows_at
from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.ends import BitBottom
from drillpetsc.case.blocks.roadmap import DepthRange, Roadmap
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.physics.bit.bit_on_bottom import bit_torque
from drillpetsc.unit_systems import System, shown
from drillpetsc.units import to_si

DEPTHS = 30  # bit depths where the case gives none
FIRST_SHARE = 0.1  # of the hole: the first of them
FACTORS = (0.75, 1.0, 1.25)  # times the sections' own friction, where the case gives no friction factors
KINDS = ("cased", "open_hole")  # groups of sections without a ff_group
LENGTHENED = 0.01  # a string longer than that of the case by less than this is the same one [m]
MOST_ROWS = 100_000  # of a roadmap
ASSUMED_WOB = {"drilling": "25 klbf", "sliding": "15 klbf"}  # without wob and initial.wob


@dataclass(frozen=True)
class Pair:
    """Friction of the hole.

    cased, open_hole: coefficients to be reported, nan where there is no such section [-].
    friction: (m,) coefficient of each section; item_factor: by which those of items are multiplied.
    groups: coefficients of further groups of sections, as text; empty without any.
    """

    cased: float
    open_hole: float
    friction: FloatArray
    item_factor: float = 1.0
    groups: str = ""


@dataclass(frozen=True)
class Load:
    """What an operation does: wob [N], torque on bit [N m], axial velocity [m/s, up], rotation [rad/s], flow [m3/s]."""

    wob: float
    torque: float
    axial_velocity: float
    rotation: float
    flow: float = 0.0


def plan_of(case: Case) -> Roadmap:
    """The case's roadmap, or one with all defaults."""
    return case.roadmap or Roadmap()


def assumptions(case: Case, plan: Roadmap) -> list[str]:
    """What the case does not give and was assumed, as sentences."""
    units = case.shown_units
    notes, given = [], plan.model_fields_set
    used = plan.operations
    if any(word.startswith("trip") for word in used) and "trip_speed" not in given:
        speed = shown(plan.trip_speed, "trip_speed", units)
        drags = case.rig is not None and case.rig.running_drag
        notes.append(
            f"trip_speed {speed} assumed" + ("" if drags else " (without rotation it changes nothing)")
        )
    if {"rotate_off_bottom", "drilling"} & set(used):
        notes.append(rotation_note(case, plan))
    for word in ("drilling", "sliding"):
        if word not in used:
            continue
        block = getattr(plan, word)
        if block.wob is None:
            weight = shown(to_si(ASSUMED_WOB[word], "N"), "force", units)
            notes.append(
                f"{word}.wob " + (f"{weight} assumed" if case.initial.wob is None else "from initial.wob")
            )
        notes.append(assumed(case, plan, word))
    if "backreaming" in used:
        notes.append(assumed(case, plan, "backreaming"))
    notes = [note for note in notes if note]
    if case.fluid is not None:
        loads = {word: load_of(case, plan, word) for word in used}
        still = [
            word
            for word, load in loads.items()
            if not load.flow and not running_speed(case, word, load.axial_velocity)
        ]
        if still:
            notes.append(
                f"the mud stands still in {', '.join(still)}: forces of the flow on the string are left out"
            )
    if plan.hole_grows:
        notes.append("the open hole ends at the bit (hole_grows): the same rows as with the hole of the case")
    notes += grades_assumed(case)
    if any(item.friction is not None for item in case.string):
        notes.append("items with a friction of their own keep it for given friction factors")
    return notes


def grades_assumed(case: Case) -> list[str]:
    """Say which drill pipe has the default grade: it decides strength, and with it the tool joint and the weight."""
    names = [
        case.string[i].name
        for i, figures in case.figures.of_item.items()
        for f in figures
        if f.key == "grade" and f.source.startswith("default")
    ]
    return [f"no grade given for {', '.join(dict.fromkeys(names))}: E-75 assumed"] if names else []


_KINDS = {"tob": "torque", "rop": "rop", "speed": "trip_speed", "rpm": "rotation"}


def assumed(case: Case, plan: Roadmap, word: str) -> str:
    """What of drilling, sliding or backreaming was assumed, in the units of the case; empty if all is given."""
    block, units = getattr(plan, word), case.shown_units
    missing = [key for key in _KINDS if key in type(block).model_fields and key not in block.model_fields_set]
    parts = []
    if word == "drilling" and "tob" in missing and torque_of_bit(case, plan) != block.tob:
        missing.remove("tob")
        parts.append(
            f"{word}.tob {shown(torque_of_bit(case, plan), 'torque', units, plot=True)} from bottom.friction"
        )
    if missing:
        values = (
            f"{word}.{key} {shown(getattr(block, key), kind, units, plot=kind == 'torque')}"
            for key, kind in _KINDS.items()
            if key in missing
        )
        parts.append(", ".join(values) + " assumed")
    return "; ".join(parts)


def torque_of_bit(case: Case, plan: Roadmap) -> float:
    """Torque on the bit while drilling [N m]: roadmap.drilling.tob, else that of a bottom.friction that the case gives, else
    the default of the roadmap."""
    given = "tob" in plan.drilling.model_fields_set
    bottom, bit = case.bottom, case.string[-1]
    if (
        given
        or not isinstance(bottom, BitBottom)
        or "friction" not in bottom.model_fields_set
        or bit.od is None
    ):
        return plan.drilling.tob
    return bit_torque(_wob(case, plan, "drilling"), bottom.friction, 0.5 * bit.od)


def _wob(case: Case, plan: Roadmap, operation: str) -> float:
    """Weight on bit of drilling or sliding [N]."""
    given = getattr(plan, operation).wob
    if given is None:
        given = case.initial.wob
    return to_si(ASSUMED_WOB[operation], "N") if given is None else float(given)


def _rotation_of_top(case: Case) -> float | None:
    """Rotation that the top prescribes at time 0 [rad/s]; None where it does not turn the string."""
    own = 0.0 if case.top.rotation is None else float(case.top.rotation.value(0.0))
    return own if own > 0 else None


def rotation_of(case: Case, plan: Roadmap) -> float:
    """Rotation off bottom and while drilling [rad/s]: roadmap.rpm, else that of the top, else the default of the roadmap."""
    own = _rotation_of_top(case)
    return plan.rpm if "rpm" in plan.model_fields_set or own is None else own


def rotation_note(case: Case, plan: Roadmap) -> str:
    """Where the rotation off bottom and while drilling comes from; empty where the roadmap gives it."""
    if "rpm" in plan.model_fields_set:
        return ""
    where = "assumed" if _rotation_of_top(case) is None else "from top.rotation"
    rpm = shown(rotation_of(case, plan), "rotation", "metric")
    return f"{rpm} {where} for rotate_off_bottom and drilling"


def flow_of(case: Case, given: float | None = None) -> float:
    """Flow rate [m3/s] of an operation that pumps: as given, else that of the case at time 0; 0 where the case gives a pump pressure."""
    own = None if case.fluid is None or not case.has_bore else case.fluid.flow_rate
    return (0.0 if own is None else max(float(own.value(0.0)), 0.0)) if given is None else given


def told(case: Case, plan: Roadmap, operation: str, units: System) -> str:
    """What an operation does, in words and in ``units``: the assumptions that roadmap, limits and statics share."""
    load = load_of(case, plan, operation)
    along = {"drilling": "rop", "sliding": ""}.get(operation, "trip_speed")
    parts = [f"{shown(load.wob, 'force', units)} on bit"] if load.wob else []
    parts += [f"{shown(load.torque, 'torque', units, plot=True)} of torque on bit"] if load.torque else []
    if along and load.axial_velocity:
        parts.append(shown(abs(load.axial_velocity), along, units))
    parts += [shown(load.rotation, "rotation", units)] if load.rotation else ["no rotation"]
    if case.fluid is not None and case.fluid.flow_rate is not None:
        parts.append(f"pump at {shown(load.flow, 'flow', units)}" if load.flow else "pumps off")
    return f"{operation}: {', '.join(parts)}"


def load_of(case: Case, plan: Roadmap, operation: str) -> Load:
    """Weight, torque, speeds and flow rate of an operation; the pumps are off in trips."""
    if operation == "trip_in":
        return Load(0.0, 0.0, -plan.trip_speed, 0.0)
    if operation == "trip_out":
        return Load(0.0, 0.0, plan.trip_speed, 0.0)
    if operation == "rotate_off_bottom":
        return Load(0.0, 0.0, 0.0, rotation_of(case, plan), flow_of(case))
    if operation == "backreaming":
        back = plan.backreaming
        return Load(0.0, back.tob, back.speed, back.rpm, flow_of(case, back.flow_rate))
    wob = _wob(case, plan, operation)
    if operation == "drilling":
        block = plan.drilling
        flow = flow_of(case, block.flow_rate)
        return Load(wob, torque_of_bit(case, plan), -block.rop, rotation_of(case, plan), flow)
    slide = plan.sliding
    return Load(
        wob, slide.tob, -1.0, 0.0, flow_of(case, slide.flow_rate)
    )  # all friction is axial, whatever the speed


def running_speed(case: Case, operation: str, axial_velocity: float) -> float:
    """Speed of the string in its mud [m/s], positive down; 0 unless it is run or pulled and the case has rig.running_drag.

    axial_velocity: positive up [m/s].
    """
    moved = (
        operation in ("trip_in", "trip_out", "backreaming") and case.fluid is not None and case.has_annulus
    )
    return -axial_velocity if moved and case.rig is not None and case.rig.running_drag else 0.0


@dataclass(frozen=True)
class FrictionGroups:
    """Friction of the sections of a hole.

    of: (m,) name of the group of each: cased, open_hole, or its ff_group; own: (m,) friction of each in the case.
    """

    of: tuple[str, ...]
    own: FloatArray

    @property
    def last(self) -> dict[str, float]:
        """Friction of each group, of several sections that of the deepest; cased and open hole first."""
        last = dict(zip(self.of, self.own.tolist(), strict=True))
        return {name: last[name] for name in dict.fromkeys([*(k for k in KINDS if k in last), *last])}

    def friction(self, factors: Mapping[str, ArrayLike]) -> FloatArray:
        """(m,), or (s, m) for (s,) factors each: friction of the sections, their own in groups without a factor."""
        pairs = zip(self.of, self.own, strict=True)
        return np.stack(np.broadcast_arrays(*(factors.get(name, mu) for name, mu in pairs)), axis=-1)


def groups_of(case: Case) -> FrictionGroups:
    """The friction of the sections of a case's hole."""
    sections = case.given_well.sections
    return FrictionGroups(tuple(q.group for q in sections), np.array([q.friction for q in sections], float))


def pairs_of(case: Case, plan: Roadmap, notes: list[str]) -> list[Pair]:
    """Friction pairs in the order of the case.  Raises CaseError for a group that the well does not have."""
    groups, factors = groups_of(case), plan.friction_factor
    given = {} if factors is None else factors.by_group
    further = [name for name in groups.last if name not in KINDS]
    for name in given:
        if name not in KINDS and name not in further:
            want = f"one of {', '.join(further)}" if further else "no groups: no section has a ff_group"
            raise CaseError(at=f"roadmap.friction_factor.groups.{name}", got=name, want=want)

    def pair(friction: FloatArray, item_factor: float = 1.0) -> Pair:
        last = replace(groups, own=friction).last
        text = ", ".join(f"{name} {last[name]:.4g}" for name in further)
        cased, opened = (last.get(name, np.nan) for name in KINDS)
        return Pair(cased, opened, friction, item_factor, text)

    for name in dict.fromkeys(groups.of):
        own = {mu for group, mu in zip(groups.of, groups.own.tolist(), strict=True) if group == name}
        if len(own) > 1 and name not in given:
            words = {"open_hole": "open-hole"}.get(name, name)
            notes.append(
                f"several {words} sections with different friction factors: the deepest section's is shown"
            )
    if factors is None:
        return [pair(groups.own * f, f) for f in FACTORS]
    if factors.combine == "all":
        chosen = list(itertools.product(*given.values()))
    else:
        count = max(len(values) for values in given.values())
        chosen = list(zip(*(v * count if len(v) == 1 else v for v in given.values()), strict=False))
    out = [pair(groups.friction(dict(zip(given, values, strict=True)))) for values in chosen]
    for name in KINDS:
        if name in given and name not in groups.of:
            notes.append(f"friction_factor.{name} has no effect: the well has no such section")
    return out


def _length(case: Case, depth: float) -> str:
    """A depth [m] as text in the units of the case."""
    return shown(depth, "length", case.shown_units, 6)


def shoes_of(case: Case) -> list[float]:
    """Measured depths of the casing shoes [m], rising."""
    sections = case.given_well.sections
    ends = [
        s.to
        for s, below in zip(sections, (*sections[1:], None), strict=True)
        if s.kind == "casing" and (below is None or below.kind != "casing")
    ]
    return [float(to) for to in ends]


def strings_of(case: Case, plan: Roadmap, notes: list[str]) -> list[StringRows]:
    """The string at each bit depth, depths rising.  Depths in a list must be possible; of others some may be left out."""
    end, shoes = float(case.given_well.survey.md[-1]), shoes_of(case)
    given = plan.bit_depth
    if isinstance(given, tuple):
        for i, depth in enumerate(given):
            if depth > end + 1e-6:
                raise CaseError(
                    at=f"roadmap.bit_depth[{i}]",
                    got=_length(case, depth),
                    want=f"at most {_length(case, end)}, the end of the hole",
                )
        listed = [rows_at(case, depth) for depth in sorted(set(given))]
        return _told_lengthened(case, listed, notes)
    if isinstance(given, DepthRange):
        if given.from_ == "shoe" and not shoes:
            raise CaseError(at="roadmap.bit_depth.from", got="shoe", want="a depth: the well has no casing")
        first = shoes[-1] if given.from_ == "shoe" else float(given.from_)
        last = end if given.to == "td" else float(given.to)
        if not first < last <= end + 1e-6:
            want = f"depths rising from 'from' to 'to', at most {_length(case, end)}, the end of the hole"
            got = f"{_length(case, first)} to {_length(case, last)}"
            raise CaseError(at="roadmap.bit_depth", got=got, want=want)
        if (last - first) / given.step > 2000:
            raise CaseError(
                at="roadmap.bit_depth.step",
                got=_length(case, given.step),
                want="a step that gives at most 2000 depths",
            )
        depths = [*np.arange(first, last - 1e-6, given.step), last]
    else:
        depths = sorted({*np.linspace(FIRST_SHARE * end, end, DEPTHS), *shoes})
    out, left = [], []
    problem: CaseError | None = None
    for depth in depths:
        try:
            out.append(rows_at(case, float(f"{depth:.10g}")))
        except CaseError as error:
            problem = error
            left.append(depth)
    if problem is not None and not out:
        raise problem
    if left:
        which = ", ".join(_length(case, d) for d in left[:5]) + (", ..." if len(left) > 5 else "")
        notes.append(f"bit depths left out: {which} ({problem.want if problem else ''})")
    return _told_lengthened(case, out, notes)


def _told_lengthened(case: Case, strings: list[StringRows], notes: list[str]) -> list[StringRows]:
    """The strings, with a note where some are longer than that of the case, so that their weight is not that of its items."""
    longer = [rows.depth for rows in strings if rows.depth > case.string_length + LENGTHENED]
    if longer:
        which = " to ".join(dict.fromkeys(_length(case, depth) for depth in (longer[0], longer[-1])))
        notes.append(
            f"bit at {which}: the string of the case is {_length(case, case.string_length)} long; its topmost item ({case.string[0].name}) "
            "is lengthened there, with its weight"
        )
    return strings
