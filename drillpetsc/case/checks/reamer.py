"""Checks of a reamer against the bit, the hole and the formation."""

from __future__ import annotations

from drillpetsc.case.blocks.case_blocks import CaseBlocks
from drillpetsc.case.blocks.ends import BitBottom
from drillpetsc.case.blocks.reamer import Reamer
from drillpetsc.case.blocks.string import Bit
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import said

SAME = 1e-6  # [m] diameters closer than this are equal
TOUCHING = 1e-3  # [m] cutters deeper than the shoulder by more than this stand in rock
LEAST_PILOT = 1.0  # [m] between cutters and bit


def check_reamer(case: CaseBlocks) -> None:
    """Raise where a reamer has no pilot hole to widen, or does not stand at the end of its hole."""
    found = [i for i, item in enumerate(case.string) if isinstance(item, Reamer)]
    for number, below in zip(found, [*found[1:], len(case.string) - 1], strict=False):
        _check(case, number, below)


def _check(case: CaseBlocks, number: int, below: int) -> None:
    """Raise where the reamer of ``number`` does not fit.  below: number of the item that cuts its pilot hole."""
    item, cutter, units = case.string[number], case.string[below], case.output.units or case.units

    def length(value: float) -> str:
        return said(value, "length", units)

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
    if case.formation is None or case.well is None:
        return
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
            want = f"that of the pilot hole, {said(narrow, 'diameter', units)}, which the reamer widens below"
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
        want = f"at least {length(LEAST_PILOT)} between the cutters and those of {name}"
        raise refuse("string", number, "kind", got="reamer", want=want)


def _cutters(case: CaseBlocks, number: int) -> float:
    """Distance of a reamer's cutters below the top of the string [m]."""
    item = case.string[number]
    assert isinstance(item, Reamer)
    return case.item_depths[number][0] + sum(item.touching)
