"""Checks of a reamer against the bit, the hole and the formation."""

from __future__ import annotations

from drillpetsc.case.blocks.case_blocks import CaseBlocks
from drillpetsc.case.blocks.ends import BitBottom
from drillpetsc.case.blocks.items.reamer import Reamer
from drillpetsc.case.blocks.items.string import Bit
from drillpetsc.case.catalogue.sizes import INCH
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import said

BLADE_OVER_HOLE = INCH / 16  # [m] by which blades may be larger than the hole of a case
SAME = 1e-6  # [m] diameters closer than this are equal
TOUCHING = 1e-3  # [m] cutters deeper than the shoulder by more than this are in rock
LEAST_PILOT = 1.0  # [m] between cutters and bit


def check_reamer(case: CaseBlocks) -> None:
    """Raise if a reamer has no pilot hole to widen, or is not at the end of its hole."""
    found = [i for i, item in enumerate(case.string) if isinstance(item, Reamer)]
    for number, below in zip(found, [*found[1:], len(case.string) - 1], strict=False):
        _check(case, number, below)


def _check(case: CaseBlocks, number: int, below: int) -> None:
    """Raise if the reamer of ``number`` does not fit.  below: number of the item that cuts its pilot hole."""
    item, cutter, units = case.string[number], case.string[below], case.said_units
    assert isinstance(item, Reamer) and item.od is not None
    if not isinstance(case.string[-1], Bit):
        raise refuse("string", number, "kind", got="reamer", want="a bit below the reamer, as the last item")
    name = "the bit" if isinstance(cutter, Bit) else f"the reamer below, string[{below}]"
    size = cutter.od
    assert size is not None
    width = said(size, "diameter", units)
    if item.pilot is not None and abs(item.pilot - size) > SAME:
        raise refuse("string", number, "pilot", got=item.pilot, want=f"the diameter of {name}, {width}")
    if item.od <= size + SAME:
        want = f"more than the diameter of {name}, {width}"
        raise refuse("string", number, "od", got=item.od, want=want, hint="kind: stabilizer does not cut")
    if case.formation is not None and case.well is not None:
        _check_pilot_hole(case, number, below, name)
    if case.contact is not None or case.has_annulus:
        _body_passes(case, number)


def _check_pilot_hole(case: CaseBlocks, number: int, below: int, name: str) -> None:
    """Raise if a reamer that drills has no pilot hole.  name: of the item ``below`` that cuts it."""
    item, cutter, units = case.string[number], case.string[below], case.said_units

    def length(value: float) -> str:
        return said(value, "length", units)

    assert (
        isinstance(item, Reamer) and item.od is not None and cutter.od is not None and case.well is not None
    )
    size, width = cutter.od, said(cutter.od, "diameter", units)
    wide = [k for k, q in enumerate(case.well.sections) if q.diameter >= item.od - SAME]
    pilot = len(case.well.sections) - 1
    reached = {k for k, q in enumerate(case.well.sections) if q.diameter >= size - SAME}
    if not wide or wide[-1] == pilot or max(reached) <= wide[-1]:
        want = "a last section of the pilot hole, below the one that is reamed"
        reamed = said(item.od, "diameter", units)
        hint = f"sections: one of {reamed} down to the reamer, one of {width} down to {name}"
        raise refuse(
            "well",
            "sections",
            pilot,
            "diameter",
            got=case.well.sections[pilot].diameter,
            want=want,
            hint=hint,
        )
    narrow = case.well.sections[max(reached)].diameter
    for k in range(wide[-1] + 1, max(reached)):
        if abs(case.well.sections[k].diameter - narrow) > SAME:
            want = f"the diameter of the pilot hole, {said(narrow, 'diameter', units)}, which the reamer widens below"
            got = said(case.well.sections[k].diameter, "diameter", units)
            raise refuse("well", "sections", k, "diameter", got=got, want=want)
    shoulder = case.well.sections[wide[-1]].to
    above = case.item_depths[number][0]
    cutters = _cutters(case, number)
    if isinstance(case.bottom, BitBottom) and case.initial.wob is not None and case.top.force is None:
        cutters += case.well.survey.md[-1] - case.string_length
    if cutters > shoulder + TOUCHING:
        want = f"cutters at or above the end of the reamed hole, {length(shoulder)}"
        raise refuse(
            "string", number, "length", got=f"cutters at {length(cutters)}", want=want,
            hint=f"well.sections: the reamed hole down to {length(cutters)}",
        )  # fmt: skip
    face = case.string_length if below == len(case.string) - 1 else _cutters(case, below)
    if face - above - sum(item.touching) < LEAST_PILOT:
        want = f"at least {length(LEAST_PILOT)} between these cutters and the cutters of {name}"
        raise refuse("string", number, "kind", got="reamer", want=want)


def _cutters(case: CaseBlocks, number: int) -> float:
    """Distance of a reamer's cutters below the top of the string [m]."""
    item = case.string[number]
    assert isinstance(item, Reamer)
    return case.item_depths[number][0] + sum(item.touching)


def _body_passes(case: CaseBlocks, number: int) -> None:
    """Raise if the hole down to the reamer of ``number`` is narrower than its body, or narrower than its blades around them.

    Cutters open below a narrower casing: the hole above may be narrower than the cutters.
    """
    item, units = case.string[number], case.said_units
    if case.well is None:
        return
    assert isinstance(item, Reamer) and item.od is not None
    start, end = case.item_depths[number]
    down = 0.0
    if isinstance(case.bottom, BitBottom) and case.initial.wob is not None and case.top.force is None:
        down = case.well.survey.md[-1] - case.string_length
    lower = _cutters(case, number) + down
    upper = lower - item.touching[1]
    body, key = (item.id, "id") if item.body_od is None else (item.body_od, "body_od")
    top = 0.0
    for n, section in enumerate(case.well.sections):
        kind, width = section.kind.replace("_", " "), said(section.diameter, "diameter", units)
        at = f"the {kind} at {said(top, 'length', units)}, {width}"
        hint = f"or another well.sections[{n}].diameter"
        if body > section.diameter + SAME and top < end + down - TOUCHING:
            want = f"at most the diameter of {at}, through which the body passes"
            raise refuse("string", number, key, got=said(body, "diameter", units), want=want, hint=hint)
        inside = top < lower - TOUCHING and section.to > max(upper, start) + TOUCHING
        if inside and item.od > section.diameter + BLADE_OVER_HOLE:
            want = f"at most 1/16 in above the diameter of {at}, which surrounds its blades"
            raise refuse("string", number, "od", got=said(item.od, "diameter", units), want=want, hint=hint)
        top = section.to
