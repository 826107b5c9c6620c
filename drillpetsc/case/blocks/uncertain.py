"""`uncertain`: how far numbers of the case may be off."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from drillpetsc.case.block import Block
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import BARE_NUMBERS
from drillpetsc.units import UnitError, bare_number, to_si

FORMS = ("normal", "uniform")
_WITH_UNIT = re.compile(r"\s*([-+]?[\d.]+(?:[eE][-+]?\d+)?)\s+(\S.*)")
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


def _read(value: Any) -> Any:
    """Distributions with their numbers in SI; what is not of their form is left to the block's own checks."""
    if not isinstance(value, Mapping):
        return value
    return {name: _in_si(name, spread) for name, spread in value.items()}


def _in_si(name: Any, spread: Any) -> Any:
    from drillpetsc.case.schema import bare_unit_of

    if not isinstance(spread, Mapping):
        return spread
    path = re.sub(r"\[[^\]]*\]", "[0]", str(name))  # an item of the string may be named
    unit, own = bare_unit_of(path, "SI"), bare_unit_of(path, BARE_NUMBERS.get())
    out = dict(spread)
    for form in FORMS:
        values = spread.get(form)
        if not isinstance(values, list | tuple) or len(values) != 2:
            continue
        out[form] = [
            _number(v, unit, own, (name, form, i), width=form == "normal" and i == 1)
            for i, v in enumerate(values)
        ]
    return out


def _number(value: Any, unit: str, own: str, at: tuple[str | int, ...], width: bool) -> float:
    """A number in SI.  own: unit of one without a unit; width: a difference, which no zero of the unit shifts."""
    bare = bare_number(value)
    match = _WITH_UNIT.fullmatch(value) if isinstance(value, str) and bare is None else None
    if bare is None and match is None:
        raise refuse(*at, got=value, want="a number")
    number, word = (float(bare), own) if match is None else (float(match[1]), match[2])  # type: ignore[arg-type]
    if not word:
        return number
    try:
        zero = float(to_si(f"0 {word}", unit)) if width else 0.0
        return float(to_si(f"{number!r} {word}", unit)) - zero
    except (UnitError, ValueError):
        raise refuse(
            *at, got=value, want=f"a number in {unit}, or another unit of it" if unit else "a pure number"
        ) from None


def _known(spreads: dict[str, Spread] | None) -> dict[str, Spread] | None:
    for name, spread in (spreads or {}).items():
        for other in spread.correlated:
            if other == name or other not in (spreads or {}):
                raise refuse(name, "correlated", got=other, want="another key of `uncertain`")
    return spreads


#: by path of the key, as of `sensitivities`
Spreads = Annotated[
    dict[str, Spread] | None,
    BeforeValidator(_read, json_schema_input_type=dict[str, Spread] | None),
    AfterValidator(_known),
]
