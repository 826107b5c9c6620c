"""Checks of the formation against hole, bit and ends."""

from __future__ import annotations

from drillpetsc.case.blocks.case_blocks import CaseBlocks
from drillpetsc.case.blocks.ends import BitBottom
from drillpetsc.case.blocks.items.reamer import Reamer
from drillpetsc.case.blocks.items.string import Bit, Flexible
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import said

LENGTH_TOLERANCE = 1e-6  # [m] diameters and depths closer than this are equal
ON_BOTTOM = 1.0  # a bit that is closer than this to the end of the hole is on bottom [m]
SMALLEST_BIT = 0.9  # relative to its hole


def check_drilling(case: CaseBlocks) -> None:
    """Raise if the bit has nothing to cut, or does not fit into the hole."""
    _bit_passes(case)
    if case.fluid is not None and case.fluid.cuttings == "returned" and case.formation is None:
        hint = "without a formation the bit does not cut"
        raise refuse("fluid", "cuttings", got="returned", want="removed, or a formation", hint=hint)
    _side_of_bit(case)
    if case.formation is None:
        return
    if case.well is None:
        raise refuse(
            "formation",
            want="no formation without a well",
            hint="the bit drills on from the end of the hole; give a well",
        )
    if not isinstance(case.bottom, BitBottom):
        want = f"no formation with bottom {case.bottom.kind}"
        raise refuse("formation", want=want, hint="a bit cuts the rock: bottom: {kind: bit}")
    _one_stiffness(case, case.bottom)
    _new_hole(case)


def _side_of_bit(case: CaseBlocks) -> None:
    """Raise if the side of the bit is to cut and there is no rock, or no wall."""
    bit = case.string[-1]
    if not isinstance(bit, Bit) or bit.side != "cutting":
        return
    if case.formation is None or case.contact is None:
        missing = "formation" if case.formation is None else "contact"
        want = "guided or rolling, or a formation with a strength and contact with the hole"
        hint = f"the rock beside the bit yields at formation.strength; the case has no {missing}"
        raise refuse("string", len(case.string) - 1, "side", got="cutting", want=want, hint=hint)
    if bit.length > 0 and bit.gauge_length > bit.length + LENGTH_TOLERANCE:
        want = f"at most the length of the bit, {said(bit.length, 'length', case.said_units)}"
        raise refuse("string", len(case.string) - 1, "gauge_length", got=bit.gauge_length, want=want)


def _bit_passes(case: CaseBlocks) -> None:
    """Raise if a section above the bit is narrower than the bit, which has passed it."""
    bit = case.string[-1]
    if case.well is None or not isinstance(bit, Bit):
        return
    top, units = 0.0, case.said_units
    for section in case.well.sections:
        if bit.od > section.diameter + LENGTH_TOLERANCE and top < case.string_length - LENGTH_TOLERANCE:
            ends = f"{said(top, 'length', units)} to {said(section.to, 'length', units)}"
            place = f"the {section.kind.replace('_', ' ')} from {ends}"
            want = f"at most the diameter of {place}, {said(section.diameter, 'diameter', units)}"
            raise refuse(
                "string",
                len(case.string) - 1,
                "od",
                got=bit.od,
                want=want,
                hint="the bit is larger than the hole above it",
            )
        top = section.to
    last = case.well.sections[-1]
    on_bottom = case.bottom.kind == "bit" and case.string_length >= case.well.survey.md[-1] - ON_BOTTOM
    if on_bottom and bit.od < SMALLEST_BIT * last.diameter:
        raise refuse(
            "string",
            len(case.string) - 1,
            "od",
            got=bit.od,
            want=f"at least {SMALLEST_BIT:.0%} of the hole around it, {said(last.diameter, 'diameter', units)}",
            hint=f"is well.sections[{len(case.well.sections) - 1}].diameter right?",
        )


def _one_stiffness(case: CaseBlocks, bottom: BitBottom) -> None:
    """Raise if `bottom.stiffness` and the stiffness of the bit law differ: they are the same quantity."""
    assert case.formation is not None
    given = case.formation.bit_law.stiffness
    if given is not None and "stiffness" in bottom.model_fields_set and given != bottom.stiffness:
        want = f"the same as bottom.stiffness, {said(bottom.stiffness, 'stiffness')}"
        hint = "both are the contact stiffness of the bit on the rock; give one of them"
        raise refuse("formation", "bit_law", "stiffness", got=given, want=want, hint=hint)


def _new_hole(case: CaseBlocks) -> None:
    """Raise unless the new hole is about as wide as the bit, and wide enough for the string."""
    assert case.formation is not None
    bit, wider = case.string[-1], case.formation.overgauge
    diameter = bit.od
    assert diameter is not None  # the check of the bottom has refused it
    if abs(wider) >= diameter / 10:
        want = f"between {said(-diameter / 10, 'diameter')} and {said(diameter / 10, 'diameter')}, a tenth of the bit's diameter"
        raise refuse(
            "formation", "overgauge", got=wider, want=want, hint="it is added to the radius of the new hole"
        )
    if not isinstance(bit, Bit) or (case.contact is None and not case.has_annulus):
        return
    reamer = max((i for i, item in enumerate(case.string) if isinstance(item, Reamer)), default=-1)
    for i, item in enumerate(case.string[reamer + 1 : -1], reamer + 1):  # above a reamer the hole is wider
        outer = item.widest_od if isinstance(item, Flexible) else None
        if outer is not None and outer >= diameter + 2 * wider:
            want = f"less than the diameter of the hole that the bit makes, {said(diameter + 2 * wider, 'diameter')}"
            key = ("od",) if outer == item.od else ("tool_joint", "od")
            raise refuse(
                "string", i, *key, got=outer, want=want, hint="the item follows the bit into the new hole"
            )
