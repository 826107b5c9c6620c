"""Doubts about the place of the string: outside its hole, in its wall."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from drillpetsc.case.plausible.plausible_string import ONE_JOINT
from drillpetsc.doubts.doubt import Doubt
from drillpetsc.doubts.moments import Answer, Built, End, Moment, Solved
from drillpetsc.output.watches.free_end import BEYOND
from drillpetsc.output.watches.outside_hole import HINT, furthest_outside
from drillpetsc.output.watches.wall_depth import LARGEST, deepest_in_wall

Values = Iterable[dict[str, Any]]


class OutsideHole(Doubt):
    """A string without contact leaves its hole, so the forces and energies of the mud around it mean nothing (manual: sec-outputs-watch)."""

    about = (Solved, End)
    sentence = (
        "the string leaves its hole: it lies {distance:length 3} from the axis at MD {depth:length 3}{when}, so the forces and energies "
        f"of the mud are meaningless; {HINT.replace('{', '{{').replace('}', '}}')}"
    )
    remedy = "Give the case `contact: {}`, or leave the annulus out of the fluid."

    def look(self, at: Any) -> Iterable[dict[str, Any]]:
        at_end = isinstance(at, End)
        found = at.monitors.outside.worst if at_end else furthest_outside(at.model)
        if found is not None:
            when = f" at {found.time:.4g} s" if at_end else ""
            yield {"distance": found.distance, "depth": found.depth, "when": when}


class ShorterThanHole(Doubt):
    """The case has no `bit_depth`, and the string ends above the end of the hole: its own length says where the bit is."""

    about = (Built, Answer)
    sentence = "the lower end is at MD {depth:length 6}, the length of the string; the hole goes on to {end:length 6} (bit_depth)"
    remedy = "Give `bit_depth`, and `length: fill` for the topmost pipe, to compute another depth."
    weight = "remark"

    def look(self, at: Moment) -> Iterable[dict[str, Any]]:
        case = at.case
        if (
            case.well is None
            or case.bit_depth is not None
            or case.bottom.kind == "bit"
            or case.top.force is not None
        ):
            return
        end = float(case.well.survey.md[-1])
        if end - case.string_length > ONE_JOINT:
            yield {"depth": case.string_length, "end": end}


class DeepInWall(Doubt):
    """A part presses into the wall by a notable share of its clearance, so results depend on the wall's stiffness (manual: sec-contact-physical)."""

    about = (Answer, End)
    sentence = (
        "{name} at MD {md:length 5} depends on the wall stiffness: it presses into the wall by {depth:diameter 2} of its radial clearance "
        "of {clearance:diameter 2} (contact.stiffness; physical takes it from the moduli of casing and rock)"
    )
    remedy = "Use `contact: {stiffness: physical}`, or a larger stiffness."

    def look(self, at: Any) -> Iterable[dict[str, Any]]:
        if isinstance(at, End) and not at.finished:
            return
        found = deepest_in_wall(at.model)
        if found is not None and found["depth"] >= LARGEST * found["clearance"]:
            yield found


class TopOnWall(Doubt):
    """Statics has not found the place of the top across the hole, and holds it on the wall."""

    about = (Solved,)
    sentence = (
        "the place of the top across the hole was not found: it is held on the wall, and long elements below it may carry its side "
        "force as contact (side force, torque and moment near the top)"
    )
    remedy = "Use shorter elements below the top, and do not read side forces there."

    def look(self, at: Solved) -> Values:
        if at.top_unplaced:
            yield {}


class NoLateralFriction(Doubt):
    """A turning string has no equilibrium with the lateral force of friction, which may be the beginning of whirl."""

    about = (Solved,)
    sentence = (
        "no equilibrium with lateral friction (a turning pipe may whirl here): the torque of friction acts, its lateral force is left "
        "out"
    )
    remedy = "Torque and drag are as usual in the trade. Simulate the motion with `run` to see whether the string whirls."

    def look(self, at: Solved) -> Values:
        if at.lateral_friction_failed:
            yield {}


class EndBelowHole(Doubt):
    """The stretch of a string makes its free end reach below the end of the hole, where nothing stops it."""

    about = (Solved,)
    sentence = (
        "the string's end lies {below_hole:length 3} below the end of the hole, which its stretch makes it reach; bottom: {{kind: bit}} "
        "stands on it, and a shorter string hangs above it"
    )
    remedy = "Use `bottom: {kind: bit}`, or a shorter string."

    def look(self, at: Solved) -> Values:
        if at.below_hole > BEYOND:
            yield {"below_hole": at.below_hole}


class Singular(Doubt):
    """The stiffness of the equilibrium is singular: part of the string moves without resistance, or it is about to buckle."""

    about = (Solved,)
    sentence = "the stiffness is singular: part of the string may move freely, or it is about to buckle"
    remedy = "Check that the ends hold the string along its axis and in rotation."

    def look(self, at: Solved) -> Values:
        if at.singular and not at.negative_pivots:
            yield {}
