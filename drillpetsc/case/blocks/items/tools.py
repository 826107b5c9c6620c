"""Telescoping tools of `string`: pipe with a slider inside. The slider's law follows from the tool's own keys."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from drillpetsc.case.block import Block, derived_default
from drillpetsc.case.blocks.items.joints import Joint
from drillpetsc.case.blocks.items.string import ToolTube
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import Quantity, said

Stroke = tuple[Annotated[float, Quantity("m")], Annotated[float, Quantity("m")]]
BEHIND_LATCH = 0.01  # distance of the stop behind the latch of a jar that fires to one side [m]
EDGE = 1e-3  # least distance of a tool's joint from the ends of its item [m]
_STROKE = "[least, largest] travel between the stops, negative as the tool closes"


SealArea = Annotated[
    float,
    Quantity("m^2", at_least=0, at_most=0.5),
    Field(
        description="area inside the seals, on which the pressure difference between string and annulus pushes the "
        "parts apart (pump-open force)"
    ),
]
StopStiffness = Annotated[
    float,
    Quantity("N/m", above=0),
    Field(description="stiffness of the stops at the ends of the stroke"),
]


class TelescopingTool(ToolTube):
    """A tube of two parts that telescope: the halves are ordinary pipe of the item."""

    mass: Annotated[float, Quantity("kg", above=0)] | None = Field(
        default=None,
        description="mass; when not given, the mass of a tube with this od, id, length and density",
    )
    joint_at: Annotated[float, Quantity("m", above=0, at_most=200)] = derived_default(
        "distance of the slider below the item's upper end; half the length when not given"
    )

    @model_validator(mode="after")
    def _slider_inside(self) -> TelescopingTool:
        if self.length <= 2 * EDGE:
            raise refuse("length", got=self.length, want=f"more than {said(2 * EDGE, 'length')}")
        if self.joint_at is None:
            self.fill_defaults(joint_at=0.5 * self.length)
        if not EDGE <= self.joint_at <= self.length - EDGE:
            want = f"inside the item, {said(EDGE, 'length')} to {said(self.length - EDGE, 'length')} below its upper end"
            raise refuse("joint_at", got=self.joint_at, want=want)
        return self

    def joint(self, top: float) -> Joint:
        """The slider of the tool, whose upper end is at measured depth ``top`` [m]."""
        raise NotImplementedError


class SealedTool(TelescopingTool):
    """A telescoping tool whose seals and stops are keys of the item."""

    seal_area: SealArea = 0.0
    stop_stiffness: StopStiffness = 1e9


class ShockSub(SealedTool):
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
        """Load [N, tension positive] up to which the preload holds the parts on a stop, None if it does not."""
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


class BumperSub(SealedTool):
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


class JarSection(Block):
    """Law of a jar."""

    action: Literal["hydraulic", "mechanical"] = Field(
        default="hydraulic",
        description="hydraulic: above threshold the jar meters over metering_stroke, then it is free; mechanical: it is free above trigger",
    )
    direction: Literal["up", "down", "both"] = Field(
        default="up", description="load that fires it: tension, compression, or either"
    )
    stroke: Annotated[float, Quantity("m", above=0, at_most=5)] = Field(
        description="travel from the cocked position to the stop"
    )
    threshold: Annotated[float, Quantity("N", above=0, kind="force")] | None = Field(
        default=None, description="load that the latch of a hydraulic jar holds"
    )
    metering_stroke: Annotated[float, Quantity("m", at_least=0, at_most=5)] = Field(
        default=0.0, description="travel over which a hydraulic jar meters; 0: it is free at the threshold"
    )
    metering_resistance: Annotated[float, Quantity("N s/m", above=0)] | None = Field(
        default=None, description="load above the threshold over the speed of metering"
    )
    trigger: Annotated[float, Quantity("N", above=0, kind="force")] | None = Field(
        default=None, description="load at which a mechanical jar fires"
    )

    seal_area: SealArea = 0.0
    stop_stiffness: StopStiffness = 1e9

    @model_validator(mode="after")
    def _latch(self) -> JarSection:
        hydraulic = self.action == "hydraulic"
        needed, other = ("threshold", ("trigger",)) if hydraulic else (
            "trigger",
            ("threshold", "metering_resistance"),
        )  # fmt: skip
        if getattr(self, needed) is None:
            raise refuse(needed, want=f"a load: a {self.action} jar needs it")
        for key in other:
            if getattr(self, key) is not None:
                raise refuse(key, got=getattr(self, key), want=f"no {key} for a {self.action} jar")
        if not hydraulic and self.metering_stroke > 0:
            raise refuse("metering_stroke", got=self.metering_stroke, want="no metering of a mechanical jar")
        if self.metering_stroke > 0 and self.metering_resistance is None:
            raise refuse("metering_resistance", want="a resistance together with a metering_stroke")
        if not self.metering_stroke < self.stroke:
            want = f"below the stroke, {said(self.stroke, 'length')}"
            raise refuse("metering_stroke", got=self.metering_stroke, want=want)
        return self

    @property
    def latch_load(self) -> float:
        """Load that the latch holds [N]."""
        load = self.threshold if self.action == "hydraulic" else self.trigger
        assert load is not None
        return load


class Jar(TelescopingTool):
    """A jar: a latch that holds the load, then sets the parts free to hit a stop."""

    kind: Literal["jar"] = Field(description="drilling or fishing jar")
    jar: JarSection = Field(description="latch, stroke and seals")

    def joint(self, top: float) -> Joint:
        least = -self.jar.stroke if self.jar.direction != "up" else -BEHIND_LATCH
        largest = self.jar.stroke if self.jar.direction != "down" else BEHIND_LATCH
        return Joint.model_construct(
            kind="slider",
            at=top + self.joint_at,
            stroke=(least, largest),
            stop_stiffness=self.jar.stop_stiffness,
            seal_area=self.jar.seal_area,
        )


def _ordered(stroke: tuple[float, float] | None) -> None:
    if stroke is not None and not stroke[0] < stroke[1]:
        raise refuse("stroke", got=list(stroke), want="[least, largest] travel, the first below the second")
