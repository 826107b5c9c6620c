"""`contact`: contact between string and hole."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, ValidationInfo, field_validator, model_validator

from drillpetsc.case.block import Block, derived_default
from drillpetsc.case.blocks.items.string import Friction
from drillpetsc.case.blocks.own_law import LawOfKind
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import Quantity


class Stribeck(Block):
    """Friction coefficient that falls with the slip speed v: mu_k + (mu_s - mu_k) exp(-(v/speed)^2)."""

    static: Friction = Field(description="static friction coefficient")
    speed: Annotated[float, Quantity("m/s", above=0)] = Field(
        description="slip speed over which the friction coefficient falls"
    )


class OwnFriction(LawOfKind):
    """A law of the user that gives the friction coefficient from the state at a contact point."""

    of: ClassVar[str] = "FRICTION"


STIFFNESS_UNIT = {"linear": "Pa", "hertz": "N/m^2.5", "hertz_point": "N/m^1.5"}  # by contact law


class Contact(Block):
    """Contact between string and hole."""

    law: Literal["linear", "hertz", "hertz_point"] = Field(
        default="linear",
        description="force per length: stiffness * penetration (linear) or * penetration^1.5 (hertz); "
        "hertz_point: force at each point of an element, stiffness * penetration^1.5",
    )
    stiffness: float | Literal["physical"] = Field(
        default=1e8,
        description="contact stiffness per length (linear, hertz) or of a point (hertz_point): "
        + ", ".join(f"{law} [{unit}]" for law, unit in STIFFNESS_UNIT.items())
        + "; a default only for linear. physical (linear only): from the moduli of casing and rock (formation.young) at each part of "
        "the string",
    )
    restitution: Annotated[float, Quantity("", at_least=1e-3, at_most=1)] = Field(
        default=0.5, description="coefficient of restitution: speed after over speed before an impact"
    )
    restitution_speed: Annotated[float, Quantity("m/s", above=0)] = Field(
        default=1.0, description="impact speed at which the restitution holds"
    )
    slip_velocity: Annotated[float, Quantity("m/s", above=0)] = derived_default(
        "slip speed over which friction builds up; when not given 0.01 m/s, or a twentieth of the slowest top.lowering of a string "
        "that does not turn (5 m/h where an autodriller finds it), if that is less"
    )
    stribeck: Stribeck | None = Field(default=None, description="static friction; none when not given")
    friction_law: OwnFriction | None = Field(
        default=None,
        description="the friction coefficient as a function of the state at each contact point; Coulomb's law, with stribeck, when not "
        "given. The soft string of torque-and-drag uses the coefficients of the wall",
    )
    points_per_element: int = Field(
        default=2, ge=1, le=16, strict=True, description="contact points per element"
    )
    energy_strict: bool = Field(
        default=False,
        strict=True,
        description="true: no step longer than half the shortest impact, so that the energy balance holds across impacts",
    )

    @field_validator("stiffness", mode="plain", json_schema_input_type=float | str)
    @classmethod
    def _by_law(cls, value: Any, info: ValidationInfo) -> float | str:
        if value == "physical":
            if info.data.get("law") == "linear":
                return "physical"
            raise refuse(got=value, want="a number: physical is a stiffness of the linear law")
        return Quantity(STIFFNESS_UNIT[info.data.get("law", "linear")], above=0).read(value)

    @model_validator(mode="after")
    def _one_friction(self) -> Contact:
        if self.friction_law is not None and self.stribeck is not None:
            raise refuse("friction_law", want="stribeck or a friction_law, not both")
        return self

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
