"""Telescoping tools of `string`: pipe with a slider inside. The slider's law follows from the tool's own keys."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field, model_validator

from drillpetsc.case.block import derived_default
from drillpetsc.case.blocks.joints import Joint
from drillpetsc.case.blocks.string import Tube
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import Quantity

Stroke = tuple[Annotated[float, Quantity("m")], Annotated[float, Quantity("m")]]
EDGE = 1e-3  # least distance of a tool's joint from the ends of its item [m]
_STROKE = "[least, largest] travel between the stops, negative as the tool closes"


class TelescopingTool(Tube):
    """A tube of two parts that telescope: the halves are ordinary pipe of the item."""

    mass: Annotated[float, Quantity("kg", above=0)] | None = Field(
        default=None, description="mass; when not given, that of a tube with this od, id, length and density"
    )
    joint_at: Annotated[float, Quantity("m", above=0, at_most=200)] = derived_default(
        "distance of the slider below the item's upper end; half the length when not given"
    )
    seal_area: Annotated[float, Quantity("m^2", at_least=0, at_most=0.5)] = Field(
        default=0.0,
        description="area inside the seals, on which the pressure in the string less that in the annulus pushes the "
        "parts apart (pump-open force)",
    )
    stop_stiffness: Annotated[float, Quantity("N/m", above=0)] = Field(
        default=1e9, description="stiffness of the stops at the ends of the stroke"
    )

    @model_validator(mode="after")
    def _slider_inside(self) -> TelescopingTool:
        if self.length <= 2 * EDGE:
            raise refuse("length", got=self.length, want=f"more than {2 * EDGE:g} m")
        if self.joint_at is None:
            self.fill_defaults(joint_at=0.5 * self.length)
        if not EDGE <= self.joint_at <= self.length - EDGE:
            want = f"inside the item, {EDGE:g} to {self.length - EDGE:g} m below its upper end"
            raise refuse("joint_at", got=self.joint_at, want=want)
        return self

    def density(self) -> float | None:
        """Density [kg/m3] that gives the tube the mass, None without one."""
        if self.mass is None:
            return None
        return self.mass / (self.length * math.pi / 4 * (self.od**2 - self.id**2))

    def joint(self, top: float) -> Joint:
        """The slider of the tool, whose upper end is at measured depth ``top`` [m]."""
        raise NotImplementedError


class ShockSub(TelescopingTool):
    """A shock sub: a spring and a damper between two parts that telescope."""

    kind: Literal["shock_sub"] = Field(description="shock sub (shock absorber)")
    stiffness: Annotated[float, Quantity("N/m", above=0)] = Field(description="stiffness of the spring")
    damping: Annotated[float, Quantity("N s/m", at_least=0)] = Field(
        default=0.0, description="force over the speed at which the parts telescope"
    )
    preload: Annotated[float, Quantity("N", kind="force")] = Field(
        default=0.0,
        description="force with which the spring pushes the parts apart at zero travel; negative: pulls them together",
    )
    stroke: Stroke | None = Field(default=None, description=_STROKE + "; no stops when not given")
    torsion_stiffness: Annotated[float, Quantity("N m/rad", above=0)] | None = Field(
        default=None, description="torsional stiffness between the parts; they do not turn when not given"
    )

    @model_validator(mode="after")
    def _stroke_is_ordered(self) -> ShockSub:
        _ordered(self.stroke)
        return self

    @property
    def held_by(self) -> float | None:
        """Load [N, tension positive] up to which the preload holds the parts on a stop, None where it does not."""
        if self.stroke is None:
            return None
        least, largest = (self.stiffness * end - self.preload for end in self.stroke)
        return least if least > 0 else largest if largest < 0 else None

    def joint(self, top: float) -> Joint:
        return Joint.model_construct(
            kind="slider",
            at=top + self.joint_at,
            spring=self.stiffness,
            damping=self.damping,
            stroke=self.stroke,
            stop_stiffness=self.stop_stiffness,
            seal_area=self.seal_area,
        )


class BumperSub(TelescopingTool):
    """A bumper sub: two parts that telescope freely between stops."""

    kind: Literal["bumper_sub"] = Field(description="bumper sub")
    stroke: Stroke = Field(description=_STROKE)

    @model_validator(mode="after")
    def _stroke_is_ordered(self) -> BumperSub:
        _ordered(self.stroke)
        return self

    def joint(self, top: float) -> Joint:
        return Joint.model_construct(
            kind="slider",
            at=top + self.joint_at,
            stroke=self.stroke,
            stop_stiffness=self.stop_stiffness,
            seal_area=self.seal_area,
        )


def _ordered(stroke: tuple[float, float] | None) -> None:
    if stroke is not None and not stroke[0] < stroke[1]:
        raise refuse("stroke", got=list(stroke), want="[least, largest] travel, the first below the second")
