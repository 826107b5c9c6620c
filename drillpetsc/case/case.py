"""`Case`: a complete, valid description of the simulation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pydantic import PrivateAttr, ValidationError, field_validator, model_validator
from pydantic_core import PydanticCustomError

from drillpetsc.case.blocks.case_blocks import CaseBlocks
from drillpetsc.case.changes import changed, text_of
from drillpetsc.case.checks.case import check_case
from drillpetsc.case.checks.spreads import spreads_in_si
from drillpetsc.case.defaults import fill_case_defaults, fill_presence_defaults
from drillpetsc.case.files.named_file import FOLDER
from drillpetsc.case.key_paths import check_plain, refuse
from drillpetsc.case.messages import case_error
from drillpetsc.case.old_words import check_old_words
from drillpetsc.case.pipe.completed_string import completed_string
from drillpetsc.case.pipe.figures import Figures
from drillpetsc.case.pipe.fill import fill_to_bit_depth
from drillpetsc.case.quantities import BARE_NUMBERS, MESSAGES, with_text
from drillpetsc.case.writer import case_data, case_yaml, sourced_yaml
from drillpetsc.errors import CaseError
from drillpetsc.unit_systems import System


def system_of(keys: Mapping[str, Any]) -> System:
    """Unit system of bare numbers; SI for a word that is none, which is refused with the key."""
    units = keys.get("units")
    if units == "metric":
        return "metric_t" if keys.get("force_unit") == "t" else "metric"
    return "field" if units == "field" else "SI"


@dataclass(frozen=True)
class Given:
    """Keys of a case as they were given, and the base of relative file names in them. Two cases are equal whatever these are."""

    keys: Mapping[str, Any] | None = field(default=None, compare=False)
    folder: Path = field(default=Path(), compare=False)


class Case(CaseBlocks):
    """A case: the string, the hole, the drive, the fluid, the rock and the simulated time. A block that is
    absent is absent physics.

    Built from the keys of a case file: `Case(string=[{"kind": "pipe", "length": "9 m", "od": "5 in"}],
    top="clamped")`. Numbers are SI, text carries a unit, and `units="field"` gives bare numbers field units; after construction everything is SI and every
    default is filled in. Wrong input is a `CaseError`.
    """

    _figures: Figures = PrivateAttr(default=Figures())
    _given: Given = PrivateAttr(default=Given())

    def __init__(self, /, **keys: Any) -> None:
        keys = with_text(keys)
        check_plain(keys)
        check_old_words(keys)
        token, words = BARE_NUMBERS.set(system_of(keys)), MESSAGES.set(system_of(keys))
        try:
            super().__init__(**keys)
        except ValidationError as error:
            raise case_error(error, keys) from None
        finally:
            BARE_NUMBERS.reset(token)
            MESSAGES.reset(words)
        self._given = Given(_copied(keys), FOLDER.get())

    @field_validator("uncertain", mode="before")
    @classmethod
    def _spreads_in_si(cls, value: Any) -> Any:
        """Here, as the units of its keys are those of all blocks."""
        return spreads_in_si(value)

    @model_validator(mode="after")
    def _check_and_fill(self) -> Case:
        token = BARE_NUMBERS.set("SI")  # blocks that defaults build
        words = MESSAGES.set(self.said_units)
        try:
            fill_presence_defaults(self)
            string, self._figures, origins = completed_string(self, fill_to_bit_depth(self))
            self.fill_defaults(string=string, catalogue=None)
            try:
                check_case(self)
            except PydanticCustomError as error:
                raise _in_the_file(error, origins) from None
            fill_case_defaults(self)
            self._units_to_output()
        finally:
            BARE_NUMBERS.reset(token)
            MESSAGES.reset(words)
        return self

    def _units_to_output(self) -> None:
        """Keep the units of the case only for printed and plotted figures: all numbers are now in SI."""
        if self.force_unit is not None and self.units != "metric":
            raise refuse("force_unit", got=self.force_unit, want="no force_unit unless 'units: metric'")
        given: System = "metric_t" if self.force_unit == "t" else self.units
        if "units" in self.model_fields_set and self.output.units is None:
            self.fill_defaults(output=self.output.model_copy(update={"units": given}))
        self.fill_defaults(units="SI", force_unit=None)

    @property
    def figures(self) -> Figures:
        """Figures that the case did not give itself: from the catalogue, defaults and formulas, with sources."""
        return self._figures

    @property
    def given_keys(self) -> tuple[Mapping[str, Any], Path]:
        """The keys as they were given, and the folder that file names in them start from."""
        keys = self._given.keys
        return (case_data(self) if keys is None else keys), self._given.folder

    def replace(self, values: Mapping[str, Any]) -> Case:
        """A new case with other values; this one stays as it is.

        values: key path -> value, as in a sweep: `{"fluid.density": "11.2 ppg", "string[1].length": 90.0, "fluid": "off"}`. A text
        is read as in the case file, and a bare number has the unit that it has there. `on` and `off` keep or remove a block.
        Figures that follow from the values, such as the weight of a pipe from its diameter, are computed again.
        Raises CaseError for a path that the case cannot have, and for an invalid value.
        """
        if not isinstance(values, Mapping):
            raise CaseError(at="replace", got=values, want='a mapping such as {"fluid.density": "11.2 ppg"}')
        keys, folder = self.given_keys
        token = FOLDER.set(folder)
        try:
            return Case(**changed(keys, {key: text_of(value) for key, value in values.items()}))
        finally:
            FOLDER.reset(token)

    def __repr__(self) -> str:
        """What there is, in a line."""
        blocks = [
            name
            for name in ("well", "contact", "fluid", "formation", "loads", "joints")
            if getattr(self, name)
        ]
        end = [] if self.time is None else [f"{self.time.end:g} s"]
        items = f"{len(self.string)} item{'s' if len(self.string) > 1 else ''}"
        parts = [items, f"{self.string_length:g} m", *blocks, *end]
        return f"<Case {self.title!r}: {', '.join(parts)}>"

    def __str__(self) -> str:
        return repr(self)

    def _repr_html_(self) -> str:
        """The string as a table, for a notebook."""
        from drillpetsc.case.pipe.string_table import case_html

        return case_html(self)

    def to_yaml(self) -> str:
        """The case as YAML, in SI numbers and with every default written out; `load_case` reads it back
        unchanged."""
        return case_yaml(self)

    def to_sourced_yaml(self) -> str:
        """The case as `to_yaml`, with the source of each figure from catalogue, defaults and formulas as a comment."""
        return sourced_yaml(self, self._figures)

    def dump(self, path: str | Path) -> None:
        """Write `to_yaml()` to a file."""
        Path(path).write_text(self.to_yaml(), encoding="utf-8")


def _copied(value: Any) -> Any:
    """Copy mappings and lists, so that later changes to them do not affect the case."""
    if isinstance(value, Mapping):
        return {key: _copied(part) for key, part in value.items()}
    return [_copied(part) for part in value] if isinstance(value, (list, tuple)) else value


def _in_the_file(error: PydanticCustomError, origins: tuple[int, ...]) -> PydanticCustomError:
    """The error with the number that a string item has in the case file.

    origins: number in the case file of each item
    """
    context = dict(error.context or {})
    at = tuple(context.get("at", ()))
    if len(at) < 2 or at[0] != "string" or not isinstance(at[1], int) or origins[at[1]] == at[1]:
        return error
    return PydanticCustomError("case", "wrong value", context | {"at": ("string", origins[at[1]], *at[2:])})
