"""`Case`: the whole description of a scene."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field, ValidationError, field_validator, model_validator

from drillpetsc.case.base import Model
from drillpetsc.case.checks import check_scene
from drillpetsc.case.defaults import settle_scene
from drillpetsc.case.ends import AnyLoad, Bottom, HeldBottom, Top
from drillpetsc.case.hole import Contact, Well, contact_or_none
from drillpetsc.case.items import Material, StringItem
from drillpetsc.case.keys import refuse
from drillpetsc.case.messages import case_error
from drillpetsc.case.quantities import Vector
from drillpetsc.case.settings import BeamTheory, Initial, Output, Time

Option = bool | int | float | str

STANDARD_GRAVITY = 9.80665  # [m/s2], ISO 80000-3


class Case(Model):
    """A scene: what hangs in which hole, what drives it, and for how long. A block that is absent is absent physics.

    Built from the keys of a case file: `Case(string=[{"kind": "pipe", "length": "9 m", "od": "5 in"}], top="clamped")`.
    Numbers are SI, text carries a unit; after construction everything is SI and every default is filled in.
    Wrong input is a `CaseError`.
    """

    later_keys: ClassVar[tuple[str, ...]] = ("fluid", "formation", "joints", "hold_string")

    title: str = Field(default="", description="title of the scene")
    well: Well | None = Field(default=None, description="the hole; without it the string is in free space")
    string: tuple[StringItem, ...] = Field(min_length=1, description="from the top down; the last item ends at the bit")
    material: Material = Field(
        default=Material(), description="material of all items that name no other; steel when not given"
    )
    beam: BeamTheory = Field(default=BeamTheory(), description="unknowns of the string")
    top: Top = Field(description="what holds or drives the upper end")
    bottom: Bottom = Field(default=HeldBottom(kind="free"), description="what the lower end meets")
    contact: Annotated[
        Contact | None, BeforeValidator(contact_or_none, json_schema_input_type=Literal["none"] | Contact)
    ] = Field(
        default=None,
        description="contact with the hole, or none; with a well and without this key, contact with all defaults",
    )
    loads: tuple[AnyLoad, ...] = Field(default=(), description="point and distributed loads on the string")
    gravity: Annotated[tuple[float, float, float], Vector("m/s^2", along_z=True)] = Field(
        default=(0.0, 0.0, STANDARD_GRAVITY),
        description="acceleration of gravity [m/s2], downward; or [north, east, down]",
    )
    initial: Initial = Field(default=Initial(), description="the state at time 0")
    time: Time | None = Field(default=None, description="simulated time; needed to run, not for statics")
    output: Output = Field(default=Output(), description="what the run folder gets")
    petsc: dict[str, Option] = Field(default={}, description="PETSc options, without the leading dash")

    def __init__(self, /, **keys: Any) -> None:
        try:
            super().__init__(**keys)
        except ValidationError as error:
            raise case_error(error, keys) from None

    @field_validator("petsc", mode="before")
    @classmethod
    def _options(cls, value: Any) -> Any:
        if not isinstance(value, dict):
            raise refuse(got=value, want="a mapping of PETSc options, such as {ts_bdf_order: 2}")
        options = {}
        for key, option in value.items():
            if not re.fullmatch(r"[A-Za-z]\w*", str(key)):
                hint = f"write {str(key).lstrip('-')}" if str(key).startswith("-") else ""
                raise refuse(key, want="an option name without the leading dash", hint=hint)
            if option is not None and not isinstance(option, (bool, int, float, str)):
                raise refuse(key, got=option, want="a number, a word, true or false")
            options[str(key)] = "" if option is None else option
        return options

    @model_validator(mode="after")
    def _whole(self) -> Case:
        if self.well is not None and "contact" not in self.model_fields_set:
            self.settle(contact=Contact())
        check_scene(self)
        settle_scene(self)
        return self

    @property
    def item_depths(self) -> tuple[tuple[float, float], ...]:
        """Measured depth of the upper and lower end of each string item [m]."""
        depths, above = [], 0.0
        for item in self.string:
            depths.append((above, above + item.length))
            above += item.length
        return tuple(depths)

    @property
    def string_length(self) -> float:
        """Length of the string [m]."""
        return self.item_depths[-1][1]

    def to_yaml(self) -> str:
        """The case as YAML, in SI numbers and with every default written out; `load_case` reads it back unchanged."""
        from drillpetsc.case.writer import case_yaml

        return case_yaml(self)

    def dump(self, path: str | Path) -> None:
        """Write `to_yaml()` to a file."""
        Path(path).write_text(self.to_yaml(), encoding="utf-8")
