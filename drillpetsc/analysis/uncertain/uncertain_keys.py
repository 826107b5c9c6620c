"""Numbers of a case that are uncertain, checked against the case."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from drillpetsc.analysis.sensitivities.keys import Key, changed_case, key_of
from drillpetsc.analysis.uncertain.survey_path import SurveyPath, survey_path
from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.uncertain import Spread
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError

#: by which the buoyed weight of the whole string is multiplied; not a key of the case, which gives weights item by item
WEIGHT_FACTOR = "string.weight_factor"
SAME = 1e-6  # relative difference of a mean from the case's value that is rounding


@dataclass(frozen=True)
class Uncertain:
    """A number with its distribution.

    key: in the case, None: the weight factor, or a number of the survey's path.
    """

    name: str
    key: Key | None
    spread: Spread
    path: SurveyPath | None = None

    @property
    def value(self) -> float:
        """In the case [SI]."""
        if self.key is None:
            return 1.0 if self.path is None else 0.0
        return self.key.value

    @property
    def unit(self) -> str:
        """SI unit, empty for a pure number."""
        return "" if self.key is None else self.key.unit


def uncertain_keys(case: Case) -> list[Uncertain]:
    """The uncertain numbers of a case in its order.

    Raises CaseError without any, for what is not a continuous number of the case, and for a distribution that contradicts the case's value.
    """
    if not case.uncertain:
        want = "distributions of numbers of the case, such as fluid.density: {normal: [1490 kg/m3, 10 kg/m3]}"
        raise CaseError(at="uncertain", want=want)
    return [key for name, spread in case.uncertain.items() for key in _checked(case, name, spread)]


def _checked(case: Case, name: str, spread: Spread) -> list[Uncertain]:
    at = f"uncertain.{name}"
    if spread.path is not None:
        if case.well is None:
            raise CaseError(at=at, want="a well with a survey")
        path = survey_path(case.given_well.survey, spread.path)
        return [Uncertain(name, None, Spread(normal=(0.0, 1.0)), path) for _ in path.modes]
    if name == WEIGHT_FACTOR:
        found = Uncertain(name, None, spread)
    else:
        try:
            found = Uncertain(name, key_of(case, name), spread)
        except CaseError as error:
            raise CaseError(at=at, got=error.got, want=error.want, hint=error.hint) from None
    value, size = found.value, max(abs(found.value), abs(spread.mean))
    got = f"{value:.6g} {found.unit}".rstrip()
    if spread.normal is not None and abs(spread.mean - value) > SAME * size:
        want = f"the case's value as mean: the case has {got}, the distribution {spread.mean:.6g}"
        raise CaseError(at=at, got=f"mean {spread.mean:.6g}", want=want, hint="change one of both")
    if spread.uniform is not None and not spread.uniform[0] <= value <= spread.uniform[1]:
        low, high = spread.uniform
        want = f"a range with the case's value: the case has {got}, the distribution {low:.6g} to {high:.6g}"
        raise CaseError(at=at, got=f"{low:.6g} to {high:.6g}", want=want, hint="change one of both")
    return [found]


def case_at(case: Case, keys: Sequence[Uncertain], values: FloatArray) -> Case:
    """The case with other values (k,) [SI] of uncertain numbers that are keys of it, and with the error of its survey."""
    changes: Mapping[Key, float] = {
        q.key: float(v) for q, v in zip(keys, values, strict=True) if q.key is not None
    }
    numbers = [float(v) for q, v in zip(keys, values, strict=True) if q.path is not None]
    path = next((q.path for q in keys if q.path is not None), None)
    survey = None if path is None else path.at(numbers)
    return changed_case(case, changes, survey) if changes or survey is not None else case
