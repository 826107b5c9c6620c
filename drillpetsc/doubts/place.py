"""Doubts about the place of the string: outside its hole, in its wall."""

from __future__ import annotations

from drillpetsc.case.plausible.plausible_string import ONE_JOINT
from drillpetsc.doubts.doubt import Values, doubt
from drillpetsc.doubts.moments import Answer, Built, End, Solved
from drillpetsc.output.watches.free_end import BEYOND
from drillpetsc.output.watches.outside_hole import HINT, furthest_outside
from drillpetsc.output.watches.wall_depth import LARGEST, deepest_in_wall


@doubt(
    "the string leaves its hole: it lies {distance:length 3} from the axis at MD {depth:length 3}{when}, so the forces and energies "
    f"of the mud are meaningless; {HINT.replace('{', '{{').replace('}', '}}')}",
    "Give the case `contact: {}`, or leave the annulus out of the fluid.",
)
def outside_hole(at: Solved | End) -> Values:
    """A string without contact leaves its hole, so the forces and energies of the mud around it mean nothing (manual: sec-outputs-watch)."""
    found = at.monitors.outside.worst if isinstance(at, End) else furthest_outside(at.model)
    if found is not None:
        when = f" at {found.time:.4g} s" if isinstance(at, End) else ""
        yield {"distance": found.distance, "depth": found.depth, "when": when}


@doubt(
    "the lower end is at MD {depth:length 6}, the length of the string; the hole goes on to {end:length 6} (bit_depth)",
    "Give `bit_depth`, and `length: fill` for the topmost pipe, to compute another depth.",
    weight="remark",
)
def shorter_than_hole(at: Built | Answer) -> Values:
    """The case has no `bit_depth`, and the string ends above the end of the hole: its own length says where the bit is."""
    case = at.case
    if (
        case.well is None
        or case.bit_depth is not None
        or case.bottom.kind == "bit"
        or case.top.force is not None
    ):
        return None
    end = float(case.well.survey.md[-1])
    return end - case.string_length > ONE_JOINT and {"depth": case.string_length, "end": end}


@doubt(
    "{name} at MD {md:length 5} depends on the wall stiffness: it presses into the wall by {depth:diameter 2} of its radial clearance "
    "of {clearance:diameter 2} (contact.stiffness; physical takes it from the moduli of casing and rock)",
    "Use `contact: {stiffness: physical}`, or a larger stiffness.",
)
def deep_in_wall(at: Answer | End) -> Values:
    """A part presses into the wall by a notable share of its clearance, so results depend on the wall's stiffness (manual: sec-contact-physical)."""
    if isinstance(at, End) and not at.finished:
        return None
    found = deepest_in_wall(at.model)
    return found is not None and found["depth"] >= LARGEST * found["clearance"] and found


@doubt(
    "the place of the top across the hole was not found: it is held on the wall, and long elements below it may carry its side "
    "force as contact (side force, torque and moment near the top)",
    "Use shorter elements below the top, and do not read side forces there.",
)
def top_on_wall(at: Solved) -> Values:
    """Statics has not found the place of the top across the hole, and holds it on the wall."""
    return at.top_unplaced


@doubt(
    "no equilibrium with lateral friction (a turning pipe may whirl here): the torque of friction acts, its lateral force is left "
    "out",
    "Torque and drag are as usual in the trade. Simulate the motion with `run` to see whether the string whirls.",
)
def no_lateral_friction(at: Solved) -> Values:
    """A turning string has no equilibrium with the lateral force of friction, which may be the beginning of whirl."""
    return at.lateral_friction_failed


@doubt(
    "the string's end lies {below_hole:length 3} below the end of the hole, which its stretch makes it reach; bottom: {{kind: bit}} "
    "stands on it, and a shorter string hangs above it",
    "Use `bottom: {kind: bit}`, or a shorter string.",
)
def end_below_hole(at: Solved) -> Values:
    """The stretch of a string makes its free end reach below the end of the hole, where nothing stops it."""
    return at.below_hole > BEYOND and {"below_hole": at.below_hole}


@doubt(
    "the stiffness is singular: part of the string may move freely, or it is about to buckle",
    "Check that the ends hold the string along its axis and in rotation.",
)
def singular(at: Solved) -> Values:
    """The stiffness of the equilibrium is singular: part of the string moves without resistance, or it is about to buckle."""
    return at.singular and not at.negative_pivots
