"""`uncertain`: how far numbers of the case may be off."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from drillpetsc.case.block import Block
from drillpetsc.case.key_paths import refuse

FORMS = ("normal", "uniform")
_Number = Annotated[float, BeforeValidator(lambda value: value, json_schema_input_type=float | str)]


class Spread(Block):
    """Distribution of a number of the case, in its units."""

    normal: tuple[_Number, _Number] | None = Field(
        default=None, description="mean and standard deviation of a normal distribution"
    )
    uniform: tuple[_Number, _Number] | None = Field(
        default=None, description="lowest and highest value, between which all are equally likely"
    )
    correlated: dict[str, float] = Field(
        default={}, description="correlation coefficients with other keys of `uncertain`, by key"
    )

    @model_validator(mode="after")
    def _possible(self) -> Spread:
        if (self.normal is None) == (self.uniform is None):
            raise refuse(want="normal: [mean, standard deviation], or uniform: [lowest, highest]")
        if self.normal is not None and not self.normal[1] > 0:
            raise refuse("normal", got=self.normal[1], want="a standard deviation above 0")
        if self.uniform is not None and not self.uniform[0] < self.uniform[1]:
            raise refuse("uniform", got=list(self.uniform), want="the lowest value before the highest")
        for name, value in self.correlated.items():
            if not -1 < value < 1:
                raise refuse("correlated", name, got=value, want="a number between -1 and 1")
        return self

    @property
    def mean(self) -> float:
        """Mean [SI]."""
        return self.normal[0] if self.normal else 0.5 * sum(self.uniform or ())


def _known(spreads: dict[str, Spread] | None) -> dict[str, Spread] | None:
    for name, spread in (spreads or {}).items():
        for other in spread.correlated:
            if other == name or other not in (spreads or {}):
                raise refuse(name, "correlated", got=other, want="another key of `uncertain`")
    return spreads


#: by path of the key, as of `sensitivities`
Spreads = Annotated[dict[str, Spread] | None, AfterValidator(_known)]
