"""Numbers of a case that are uncertain, checked against the case."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from drillpetsc.analysis.sensitivities.keys import Key, changed_case, key_of
from drillpetsc.analysis.uncertain.survey_path import SurveyPath, survey_path
from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.uncertain import RANGES, Spread
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError

#: by which the buoyed weight of the whole string is multiplied; not a key of the case, which gives weights item by item
WEIGHT_FACTOR = "string.weight_factor"
SAME = 1e-6  # relative difference of a mean from the case's value that is rounding


@dataclass(frozen=True)
class Uncertain:
    """A number with its distribution.

    keys: in the case, several for the friction of a group of sections, none for the weight factor and a number of the survey's path.
    """

    name: str
    keys: tuple[Key, ...]
    spread: Spread
    path: SurveyPath | None = None

    @property
    def value(self) -> float:
        """In the case [SI]; the weight factor, which is no key of it, has its mean."""
        if self.path is not None:
            return 0.0
        return self.keys[0].value if self.keys else _middle(self.spread)

    @property
    def unit(self) -> str:
        """SI unit, empty for a pure number."""
        return self.keys[0].unit if self.keys else ""


def uncertain_keys(case: Case) -> list[Uncertain]:
    """The uncertain numbers of a case in its order.

    Raises CaseError without any, for what is not a continuous number of the case, and for a distribution that contradicts the case's value.
    """
    if not case.uncertain:
        want = "distributions of numbers of the case, such as fluid.density: {normal: [1490 kg/m3, 10 kg/m3]}"
        raise CaseError(at="uncertain", want=want)
    found = [key for name, spread in case.uncertain.items() for key in _checked(case, name, spread)]
    named = dict[Key, str]()
    for q in found:
        for key in q.keys:
            if key in named:
                raise CaseError(at=f"uncertain.{q.name}", want=f"{key.name} once: {named[key]} has it, too")
            named[key] = q.name
    return found


def _checked(case: Case, name: str, spread: Spread) -> list[Uncertain]:
    at = f"uncertain.{name}"
    if spread.path is not None:
        if case.well is None:
            raise CaseError(at=at, want="a well with a survey")
        path = survey_path(case.given_well.survey, spread.path)
        return [Uncertain(name, (), Spread(normal=(0.0, 1.0)), path) for _ in path.modes]
    found = Uncertain(name, () if name == WEIGHT_FACTOR else keys_of(case, name, at), spread)
    value, mean = found.value, _middle(spread)
    got = f"{value:.6g} {found.unit}".rstrip()
    if spread.form in RANGES:
        low, high = spread.numbers[0], spread.numbers[-1]
        if not low <= value <= high:
            want = (
                f"a range with the case's value: the case has {got}, the distribution {low:.6g} to {high:.6g}"
            )
            raise CaseError(at=at, got=f"{low:.6g} to {high:.6g}", want=want, hint="change one of both")
    elif abs(mean - value) > SAME * max(abs(value), abs(mean)):
        want = f"the case's value as mean: the case has {got}, the distribution {mean:.6g}"
        raise CaseError(at=at, got=f"mean {mean:.6g}", want=want, hint="change one of both")
    return [found]


def names_of(case: Case, name: str) -> list[str]:
    """Paths of the keys that a name stands for: its own, or the friction of each section of a group."""
    sections = case.well.sections if case.well is not None else ()
    return [f"well.sections[{i}].friction" for i, q in enumerate(sections) if q.group == name] or [name]


def keys_of(case: Case, name: str, at: str) -> tuple[Key, ...]:
    """The keys that a name stands for; ``at`` is what a CaseError names: for no continuous number, or sections that differ."""
    try:
        keys = tuple(key_of(case, q) for q in names_of(case, name))
    except CaseError as error:
        groups = dict.fromkeys(section.group for section in case.well.sections) if case.well else ()
        names = f"groups of sections: {', '.join(groups)}" if groups and "." not in name else ""
        raise CaseError(at=at, got=error.got, want=error.want, hint=error.hint or names) from None
    values = dict.fromkeys(key.value for key in keys)
    if len(values) > 1:
        want = "sections with one friction coefficient, or a distribution of each (well.sections[0].friction, ...)"
        raise CaseError(at=at, got=" and ".join(f"{q:g}" for q in values), want=want)
    return keys


def _middle(spread: Spread) -> float:
    """Mean of a normal or lognormal number, middle of a uniform range, most likely value of a triangular one [SI]."""
    if spread.form == "uniform":
        return 0.5 * sum(spread.numbers)
    return spread.numbers[1 if spread.form == "triangular" else 0]


def case_at(case: Case, keys: Sequence[Uncertain], values: FloatArray) -> Case:
    """The case with other values (k,) [SI] of uncertain numbers that are keys of it, and with the error of its survey."""
    changes: Mapping[Key, float] = {
        key: float(v) for q, v in zip(keys, values, strict=True) for key in q.keys
    }
    numbers = [float(v) for q, v in zip(keys, values, strict=True) if q.path is not None]
    path = next((q.path for q in keys if q.path is not None), None)
    survey = None if path is None else path.at(numbers)
    return changed_case(case, changes, survey) if changes or survey is not None else case
