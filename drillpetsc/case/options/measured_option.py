"""`--measured FILE` and `--fit A,B`: options of the commands `roadmap` and `calibrate`."""

from __future__ import annotations

from pydantic import ValidationError
from pydantic_core import PydanticCustomError

from drillpetsc.case.blocks.roadmap import MeasuredPoint
from drillpetsc.case.case import Case
from drillpetsc.case.files.measured_file import read_measured
from drillpetsc.case.messages import case_error
from drillpetsc.case.options.ranges import read_words
from drillpetsc.case.quantities import BARE_NUMBERS
from drillpetsc.errors import CaseError


def measured_option(name: str, case: Case) -> tuple[MeasuredPoint, ...]:
    """The points of a file; columns without a unit are in the case's units.

    Raises CaseError, which names the option, or the file and its line.
    """
    token = BARE_NUMBERS.set(case.output.units or "SI")
    try:
        readings, _ = read_measured(name)
        points = []
        for reading in readings:
            values = reading.as_dict()
            try:
                points.append(MeasuredPoint(**values))
            except ValidationError as error:
                found = case_error(error, values)
                raise CaseError(at=found.at, got=found.got, want=found.want, file=name) from None
        return tuple(points)
    except PydanticCustomError as error:
        context = error.context or {}
        raise CaseError(
            at="--measured",
            got=context.get("got"),
            want=str(context.get("want", "")),
            hint=str(context.get("hint", "")),
        ) from None
    finally:
        BARE_NUMBERS.reset(token)


FITTED = ("cased", "open_hole", "block_weight", "weight_factor")


def fit_option(text: str, case: Case) -> tuple[str, ...]:
    """The parameters that `calibrate` fits; CaseError for a word that is not a parameter or a group of the case."""
    groups = () if case.well is None else tuple(section.group for section in case.well.sections)
    return read_words(text, tuple(dict.fromkeys([*FITTED, *groups])), "--fit")
