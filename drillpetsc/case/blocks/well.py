"""`well` (survey and sections) and `contact` of the string with it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field, ValidationInfo, WrapValidator, field_validator, model_validator

from drillpetsc.case.block import Block, derived_default
from drillpetsc.case.blocks.string import Friction
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import Quantity
from drillpetsc.case.survey_file import read_survey

DEFAULT_FRICTION = {"casing": 0.2, "open_hole": 0.3}


class Survey(Block):
    """Stations of the hole, from the rotary table down: lists of the same length."""

    md: tuple[Annotated[float, Quantity("m", at_least=0, at_most=50e3)], ...] = Field(
        min_length=2, description="measured depths [m], rising from 0"
    )
    inclination: tuple[Annotated[float, Quantity("rad", at_least=0, at_most=math.pi)], ...] = Field(
        description="inclinations from the vertical [rad]"
    )
    azimuth: tuple[Annotated[float, Quantity("rad", at_least=-2 * math.pi, at_most=2 * math.pi)], ...] = (
        Field(description="azimuths from north over east [rad]")
    )

    @model_validator(mode="after")
    def _stations(self) -> Survey:
        if abs(self.md[0]) > 1e-9:
            raise refuse("md", 0, got=self.md[0], want="a first station at 0 m (the rotary table)")
        for i in range(1, len(self.md)):
            if self.md[i] <= self.md[i - 1]:
                want = f"rising depths: above {self.md[i - 1]:g} m, the station before"
                raise refuse("md", i, got=self.md[i], want=want)
        for key in ("inclination", "azimuth"):
            count = len(getattr(self, key))
            if count != len(self.md):
                raise refuse(key, got=f"{count} values", want=f"{len(self.md)} values, one for each md")
        return self


def _survey(value: Any) -> Any:
    return read_survey(value) if isinstance(value, str) else value


class Compliance(Block):
    """Elastic constants of what stands around a section: it widens under the fluid's pressure."""

    young: Annotated[float, Quantity("Pa", at_least=1e3, at_most=1e14)] = Field(
        description="Young's modulus of the rock, or of casing and rock together [Pa]"
    )
    poisson: Annotated[float, Quantity("", above=-1, at_most=0.5)] = Field(
        default=0.25, description="Poisson's ratio [-]"
    )


def _depth_or_end(value: Any, depth: Callable[[Any], float]) -> float | None:
    """None for the end of the survey, which the section does not know."""
    return None if value is None or (isinstance(value, str) and value == "end") else depth(value)


class Section(Block):
    """A stretch of hole of one diameter."""

    later_keys: ClassVar[tuple[str, ...]] = ("roughness",)

    to: Annotated[float, Quantity("m", above=0, at_most=50e3), WrapValidator(_depth_or_end)] = (
        derived_default(
            "measured depth of its lower end [m]; for the last section `end`, or nothing: the last station of the survey"
        )
    )
    kind: Literal["casing", "open_hole"] = Field(description="cased or open hole")
    diameter: Annotated[float, Quantity("m", above=0, at_most=10)] = Field(description="inner diameter [m]")
    friction: Friction = derived_default(
        "friction coefficient [-]; 0.2 in casing, 0.3 in open hole when not given"
    )
    compliance: Compliance | None = Field(
        default=None,
        description="elasticity of the wall (used by a fluid in the annulus); rigid when not given",
    )

    @model_validator(mode="after")
    def _settle_friction(self) -> Section:
        if self.friction is None:
            self.fill_defaults(friction=DEFAULT_FRICTION[self.kind])
        return self


class Well(Block):
    """The hole."""

    survey: Annotated[Survey, BeforeValidator(_survey, json_schema_input_type=str | Survey)] = Field(
        description="stations md, inclination, azimuth; or the name of a CSV file with these columns, or of a run folder: its hole, "
        "as drilled"
    )
    sections: tuple[Section, ...] = Field(
        min_length=1, description="casing and open hole, from the surface down"
    )

    @model_validator(mode="after")
    def _covered(self) -> Well:
        above, last = 0.0, len(self.sections) - 1
        if self.sections[last].to is None:
            self.fill_defaults(
                sections=(
                    *self.sections[:last],
                    self.sections[last].model_copy(update={"to": self.survey.md[-1]}),
                )
            )
        for i, section in enumerate(self.sections):
            if section.to is None:
                hint = "only the last section may leave it to the survey"
                raise refuse(
                    "sections", i, "to", want="the measured depth of the section's lower end", hint=hint
                )
            if section.to <= above:
                want = f"rising depths: below the section above, {above:g} m"
                raise refuse("sections", i, "to", got=section.to, want=want)
            above = section.to
        end = self.survey.md[-1]
        if abs(above - end) > 1e-3:
            hint = "the survey ends there; add a station, or write `to: end`"
            want = f"sections down to the last station, {end:g} m"
            raise refuse("sections", last, "to", got=above, want=want, hint=hint)
        return self

    def section_at(self, md: float) -> Section:
        """The section that holds the measured depth md [m]."""
        return next((section for section in self.sections if md <= section.to), self.sections[-1])


class Stribeck(Block):
    """Friction that falls from a static to the kinetic coefficient: mu_k + (mu_s - mu_k)
    exp(-(v/speed)^2)."""

    static: Friction = Field(description="static friction coefficient [-]")
    speed: Annotated[float, Quantity("m/s", above=0)] = Field(
        description="slip speed over which it falls [m/s]"
    )


STIFFNESS_UNIT = {"linear": "Pa", "hertz": "N/m^2.5", "hertz_point": "N/m^1.5"}


class Contact(Block):
    """Contact between string and hole."""

    law: Literal["linear", "hertz", "hertz_point"] = Field(
        default="linear",
        description="force per length: stiffness * penetration (linear) or * penetration^1.5 (hertz); "
        "hertz_point: force at each point of an element, stiffness * penetration^1.5",
    )
    stiffness: float = Field(
        default=1e8,
        description="contact stiffness: per length [Pa = N/m2] (linear) or [N/m^2.5] (hertz), "
        "of a point [N/m^1.5] (hertz_point); a default only for linear",
    )
    restitution: Annotated[float, Quantity("", at_least=1e-3, at_most=1)] = Field(
        default=0.5, description="speed after over speed before an impact [-]"
    )
    restitution_speed: Annotated[float, Quantity("m/s", above=0)] = Field(
        default=1.0, description="impact speed at which the restitution holds [m/s]"
    )
    slip_velocity: Annotated[float, Quantity("m/s", above=0)] = Field(
        default=0.01, description="slip speed over which friction builds up [m/s]"
    )
    stribeck: Stribeck | None = Field(default=None, description="static friction; none when not given")
    points_per_element: int = Field(
        default=2, ge=1, le=16, strict=True, description="contact points per element [-]"
    )
    energy_strict: bool = Field(
        default=False,
        strict=True,
        description="true: no step longer than half the shortest impact, so that impacts keep their books of energy",
    )

    @field_validator("stiffness", mode="plain", json_schema_input_type=float | str)
    @classmethod
    def _by_law(cls, value: Any, info: ValidationInfo) -> float:
        return Quantity(STIFFNESS_UNIT[info.data.get("law", "linear")], above=0).read(value)

    @model_validator(mode="after")
    def _stiffness_given(self) -> Contact:
        if self.law != "linear" and "stiffness" not in self.model_fields_set:
            unit = STIFFNESS_UNIT[self.law]
            raise refuse("stiffness", want=f"a stiffness in {unit} (law {self.law} has no default)")
        return self


def contact_or_none(value: Any) -> Any:
    """`none` -> None."""
    if isinstance(value, str):
        if value != "none":
            raise refuse(got=value, want="none, or a mapping of contact keys")
        return None
    return value
