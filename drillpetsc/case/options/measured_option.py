"""`--measured FILE`, `--fit A,B` and `--prior A=B+-C`: options of the commands `roadmap` and `calibrate`."""

from __future__ import annotations

from collections.abc import Sequence

from pydantic import ValidationError
from pydantic_core import PydanticCustomError

from drillpetsc.case.blocks.roadmap import MeasuredPoint
from drillpetsc.case.blocks.well import OTHER_FITS
from drillpetsc.case.case import Case
from drillpetsc.case.files.measured_file import read_measured
from drillpetsc.case.messages import case_error
from drillpetsc.case.options.ranges import read_words
from drillpetsc.case.quantities import BARE_NUMBERS
from drillpetsc.case.schema import bare_unit_of
from drillpetsc.errors import CaseError
from drillpetsc.units import UnitError, to_si


def measured_option(name: str, case: Case) -> tuple[MeasuredPoint, ...]:
    """The points of a file; columns without a unit are in the case's units.

    Raises CaseError, which names the option, or the file and its line.
    """
    token = BARE_NUMBERS.set(case.said_units)
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


FITTED = ("cased", "open_hole", *OTHER_FITS)


def fit_option(text: str, case: Case) -> tuple[str, ...]:
    """The parameters that `calibrate` fits; CaseError for a word that is not a parameter, a group of the case, or like a path."""
    groups = () if case.well is None else tuple(section.group for section in case.well.sections)
    words = [word.strip() for word in text.split(",")]
    paths = [word for word in words if _is_path(word)]
    read_words(
        [word for word in words if word not in paths], tuple(dict.fromkeys([*FITTED, *groups])), "--fit"
    )
    return tuple(dict.fromkeys(words))


def _is_path(word: str) -> bool:
    """Whether a name is meant as the path of a number of the case, which is checked where it is changed."""
    return "." in word or "[" in word


def prior_option(texts: Sequence[str]) -> dict[str, tuple[float, float]]:
    """name -> (mean, standard deviation) SI of options such as `cased=0.2+-0.05`; raises CaseError."""
    out = {}
    for text in texts:
        name, _, rest = text.partition("=")
        name = name.strip()
        unit = {"block_weight": "N", "running_drag": "N s/m"}.get(name, "")
        unit = bare_unit_of(name, "SI") if _is_path(name) else unit
        mean, mark, sigma = rest.replace("±", "+-").partition("+-")
        try:
            found = to_si(mean.strip(), unit), to_si(sigma.strip(), unit)
        except UnitError:
            found = (0.0, 0.0)
        if not mark or not name or not found[1] > 0:
            want = "NAME=MEAN+-SIGMA with a standard deviation above 0, such as cased=0.2+-0.05 or 'block_weight=623 kN+-10 kN'"
            raise CaseError(at="--prior", got=text, want=want)
        out[name] = found
    return out
