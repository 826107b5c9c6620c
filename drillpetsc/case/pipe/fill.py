"""Depth of the bit: the pipe that fills the string down to it (`length: fill`), and the hole above it (`bit_depth`)."""

from __future__ import annotations

from typing import Any

from drillpetsc.case.blocks.case_blocks import CaseBlocks
from drillpetsc.case.blocks.items.string import FILL, Pipe
from drillpetsc.case.blocks.items.tubulars import Tubular
from drillpetsc.case.blocks.well import Well
from drillpetsc.case.importers.stations import cut_stations
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import said

SHORTEST = 1e-3  # length of the pipe that fills the string [m]


def fill_to_bit_depth(case: CaseBlocks) -> str:
    """Set the length of the pipe that fills the string, and cut the hole at `bit_depth`, while the case is validated.

    Without `length: fill`, `bit_depth` sets the length of the topmost item. Returns the source of the length; "" if it is
    as given. Raises if the string cannot end there.
    """
    filling = [i for i, item in enumerate(case.string) if item.length == FILL]
    depth, given = case.bit_depth, case.bit_depth is not None
    if not filling and not given:
        return ""
    if case.well is None:
        at = ("string", filling[0], "length") if filling else ("bit_depth",)
        raise refuse(*at, want="a well, whose depth the string fills")
    if filling and filling != [0]:
        want = "fill as the length of the topmost item only, to which pipe is added as the hole gets deeper"
        raise refuse("string", filling[-1], "length", got="fill", want=want)
    end = case.well.survey.md[-1]
    if depth is None:
        depth = end
    elif depth > end + 1e-6:
        raise refuse(
            "bit_depth",
            got=said(depth, "length"),
            want=f"at most the end of the survey, {said(end, 'length')}",
        )
    first = case.string[0]
    if not isinstance(first, (Pipe, Tubular)):
        raise refuse(
            "bit_depth", got=said(depth, "length"), want="a pipe as the topmost item, whose length follows"
        )
    others = sum(item.length for item in case.string[1:])
    if depth - others < SHORTEST:
        key = "bit_depth" if given else "well.survey"
        raise refuse(
            key,
            got=said(depth, "length"),
            want=f"below the other items, which are {said(others, 'length')} long",
        )
    values: dict[str, Any] = {
        "string": (first.model_copy(update={"length": depth - others}), *case.string[1:])
    }
    if given:
        values |= {"well": _cut(case.well, depth), "bit_depth": None}
    case.fill_defaults(**values)
    if not filling and abs(first.length - (depth - others)) < SHORTEST:
        return ""
    bottom = "bit_depth" if given else "the end of the survey"
    return f"{bottom}, {said(depth, 'length')}, less the other items, {said(others, 'length')}"


def _cut(well: Well, depth: float) -> Well:
    """The hole down to a measured depth [m]."""
    survey = well.survey
    md, inclination, azimuth = cut_stations(survey.md, survey.inclination, survey.azimuth, depth)
    cut = survey.model_copy(update={"md": md, "inclination": inclination, "azimuth": azimuth})
    last = next(i for i, section in enumerate(well.sections) if section.to >= depth - SHORTEST)
    bottom = well.sections[last].model_copy(update={"to": depth})
    return well.model_copy(update={"survey": cut, "sections": (*well.sections[:last], bottom)})
