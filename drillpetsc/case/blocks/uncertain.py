"""`uncertain`: how far numbers of the case may be off."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from drillpetsc.case.block import Block
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import Quantity

SURVEY = "well.survey"  # key of the survey's error
#: distributions of one number -> how many numbers give it
FORMS = {"normal": 2, "lognormal": 2, "uniform": 2, "triangular": 3}
RANGES = ("uniform", "triangular")  # those between a lowest and a highest value
_Number = Annotated[float, BeforeValidator(lambda value: value, json_schema_input_type=float | str)]


class SurveyError(Block):
    """Error of a survey that changes smoothly along the hole."""

    inclination: Annotated[float, Quantity("rad", at_least=0, at_most=0.2)] = Field(
        description="standard deviation of the inclination"
    )
    lateral: Annotated[float, Quantity("rad", at_least=0, at_most=0.2)] = Field(
        description="standard deviation of the direction across it: the sine of the inclination times the standard deviation of the azimuth"
    )
    length: Annotated[float, Quantity("m", above=0, at_most=50e3)] = Field(
        default=300.0, description="length over which errors are alike, usually 100 to 300 m"
    )

    @model_validator(mode="after")
    def _not_zero(self) -> SurveyError:
        if not self.inclination and not self.lateral:
            raise refuse(
                "inclination", got=0, want="an error of the inclination or of the direction across it"
            )
        return self


class Spread(Block):
    """Distribution of a number of the case, in its units."""

    normal: tuple[_Number, _Number] | None = Field(
        default=None, description="mean and standard deviation of a normal distribution"
    )
    lognormal: tuple[_Number, _Number] | None = Field(
        default=None,
        description="mean and standard deviation of a number whose logarithm is normal: it is never negative",
    )
    uniform: tuple[_Number, _Number] | None = Field(
        default=None, description="lowest and highest value, between which all are equally likely"
    )
    triangular: tuple[_Number, _Number, _Number] | None = Field(
        default=None, description="lowest, most likely and highest value"
    )
    path: SurveyError | None = Field(
        default=None, description="for the key `well.survey` only: error of the survey"
    )
    correlated: dict[str, float] = Field(
        default={}, description="correlation coefficients with other keys of `uncertain`, by key"
    )

    @model_validator(mode="after")
    def _possible(self) -> Spread:
        if [*(getattr(self, form) for form in FORMS), self.path].count(None) != len(FORMS):
            raise refuse(
                want="one of normal: [mean, standard deviation], lognormal: [mean, standard deviation], uniform: [lowest, highest], "
                "triangular: [lowest, most likely, highest], and path of well.survey"
            )
        if self.path is not None and self.correlated:
            raise refuse("correlated", want="no correlation of a path with other keys")
        form, numbers = self.form, self.numbers
        if form.endswith("normal") and not numbers[1] > 0:
            raise refuse(form, got=numbers[1], want="a standard deviation above 0")
        if form == "lognormal" and not numbers[0] > 0:
            raise refuse(form, got=numbers[0], want="a mean above 0")
        if form in RANGES and not (list(numbers) == sorted(numbers) and numbers[0] < numbers[-1]):
            raise refuse(form, got=list(numbers), want="the lowest value before the highest")
        for name, value in self.correlated.items():
            if not -1 < value < 1:
                raise refuse("correlated", name, got=value, want="a number between -1 and 1")
        return self

    @property
    def form(self) -> str:
        """Name of the distribution, one of ``FORMS``; path: the error of a survey."""
        return next((form for form in FORMS if getattr(self, form) is not None), "path")

    @property
    def numbers(self) -> tuple[float, ...]:
        """Numbers that give the distribution [SI]; none of a path."""
        return () if self.form == "path" else tuple(getattr(self, self.form))


def _known(spreads: dict[str, Spread] | None) -> dict[str, Spread] | None:
    for name, spread in (spreads or {}).items():
        if (name == SURVEY) != (spread.path is not None):
            raise refuse(name, want=f"path: for {SURVEY}, one of {', '.join(FORMS)} for any other key")
        for other in spread.correlated:
            if other in (name, SURVEY) or other not in (spreads or {}):
                raise refuse(name, "correlated", got=other, want="another key of `uncertain`")
    return spreads


#: by path of the key, as of `sensitivities`
Spreads = Annotated[dict[str, Spread] | None, AfterValidator(_known)]
