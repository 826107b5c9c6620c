"""Checks of a reamer against the bit, the hole and the formation."""

from __future__ import annotations

from drillpetsc.case.blocks.case_blocks import CaseBlocks
from drillpetsc.case.blocks.ends import BitBottom
from drillpetsc.case.blocks.reamer import Reamer
from drillpetsc.case.blocks.string import Bit
from drillpetsc.case.key_paths import refuse

SAME = 1e-6  # [m] diameters closer than this are equal
TOUCHING = 1e-3  # [m] cutters deeper than the shoulder by more than this stand in rock
LEAST_PILOT = 1.0  # [m] between cutters and bit


def check_reamer(case: CaseBlocks) -> None:
    """Raise where a reamer has no pilot hole to widen, or does not stand at the end of its hole."""
    found = [i for i, item in enumerate(case.string) if isinstance(item, Reamer)]
    if len(found) > 1:
        raise refuse("string", found[1], "kind", got="reamer", want="one reamer in a string")
    for number in found:
        _check(case, number)


def _check(case: CaseBlocks, number: int) -> None:
    item, bit = case.string[number], case.string[-1]
    assert isinstance(item, Reamer) and item.od is not None
    if not isinstance(bit, Bit):
        raise refuse("string", number, "kind", got="reamer", want="a bit below the reamer, as the last item")
    if item.pilot is not None and abs(item.pilot - bit.od) > SAME:
        raise refuse("string", number, "pilot", got=item.pilot, want=f"the diameter of the bit, {bit.od:g} m")
    if item.od <= bit.od + SAME:
        want = f"more than the diameter of the bit, {bit.od:g} m"
        raise refuse("string", number, "od", got=item.od, want=want, hint="kind: stabilizer does not cut")
    if case.formation is None or case.well is None:
        return
    wide = [k for k, q in enumerate(case.well.sections) if q.diameter >= item.od - SAME]
    pilot = len(case.well.sections) - 1
    if not wide or wide[-1] == pilot:
        want = "a last section of the pilot hole, below the one that is reamed"
        hint = f"sections: one of {item.od:g} m down to the reamer, one of {bit.od:g} m down to the bit"
        raise refuse(
            "well",
            "sections",
            pilot,
            "diameter",
            got=case.well.sections[pilot].diameter,
            want=want,
            hint=hint,
        )
    shoulder = case.well.sections[wide[-1]].to
    above, below = case.item_depths[number]
    cutters = above + sum(item.touching)
    if isinstance(case.bottom, BitBottom) and case.initial.wob is not None:
        cutters += case.well.survey.md[-1] - case.string_length
    if cutters > shoulder + TOUCHING:
        want = f"cutters at or above the end of the reamed hole, {shoulder:g} m"
        raise refuse(
            "string", number, "length", got=f"cutters at {cutters:g} m", want=want,
            hint=f"well.sections: the reamed hole down to {cutters:g} m",
        )  # fmt: skip
    if case.string_length - above - sum(item.touching) < LEAST_PILOT:
        want = f"at least {LEAST_PILOT:g} m between the cutters and the bit's face"
        raise refuse("string", number, "kind", got="reamer", want=want)
