"""Rotary steerable tools as items of the string: `kind: rss`."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field, model_validator

from drillpetsc.case.block import Block, ByKind, derived_default
from drillpetsc.case.blocks.items.string import ToolTube
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import OverTime, Quantity, said
from drillpetsc.time_function import Constant, TimeFunction


class Steer(Block):
    """Command of a rotary steerable tool over time."""

    ratio: Annotated[TimeFunction, OverTime("")] = Field(
        default=Constant(1.0), description="share of the force or the tilt, 0 to 1, over time"
    )
    tool_face: Annotated[TimeFunction, OverTime("rad")] = Field(
        default=Constant(0.0),
        description="direction in which the tool steers, fixed in space, over time: 0 is the high side, 90 deg to the right "
        "looking down the hole; measured from north if the inclination is below 5 deg",
    )

    @model_validator(mode="after")
    def _a_share(self) -> Steer:
        for t in (0.0, *self.ratio.breaks()):
            for value in (self.ratio.value(t, True), self.ratio.value(t)):
                if not 0 <= value <= 1:
                    raise refuse(
                        "ratio", got=value, want="a share of the full command, at least 0, at most 1"
                    )
        return self


class PushSteering(Block):
    """Pads push on the wall, and the wall pushes the string towards the tool face."""

    kind: Literal["push"] = Field(description="pads that push on the wall")
    force: Annotated[float, Quantity("N", at_least=0, at_most=1e6)] = Field(
        description="force on the string at ratio 1, its mean over a turn"
    )
    pad_offset: Annotated[float, Quantity("m", at_least=0, at_most=50e3)] = Field(
        description="height of the pads above the item's lower end"
    )
    pads: Literal["sleeve", "rotating"] = Field(
        default="sleeve",
        description="sleeve: on a sleeve that does not turn, a steady force; rotating: three pads turn with the string, each acts over 120 deg",
    )
    steer: Steer = Field(default=Steer(), description="command over time")


class PointSteering(Block):
    """The shaft below is tilted towards the tool face while it turns."""

    kind: Literal["point"] = Field(description="tilted shaft")
    tilt: Annotated[float, Quantity("rad", at_least=0, at_most=math.radians(10))] = Field(
        description="angle of the tilt at ratio 1"
    )
    steer: Steer = Field(default=Steer(), description="command over time")


AnySteering = Annotated[PushSteering | PointSteering, ByKind()]


class RotarySteerable(ToolTube):
    """A rotary steerable tool in a plain round tube, which bends."""

    kind: Literal["rss"] = Field(description="rotary steerable tool")
    rss: AnySteering = Field(description="how it steers")
    joint_at: Annotated[float, Quantity("m", at_least=0, at_most=50e3)] = derived_default(
        "height of the tilt above the item's lower end, with rss.kind point; the middle when not given"
    )
    mass: Annotated[float, Quantity("kg", above=0)] | None = Field(
        default=None, description="mass, instead of the mass of a tube with the density of the material"
    )

    @model_validator(mode="after")
    def _inside(self) -> RotarySteerable:
        at = self.joint_at
        if isinstance(self.rss, PushSteering):
            if at is not None:
                raise refuse("joint_at", got=at, want="no joint_at with pads: rss.pad_offset is their place")
            at, key = self.rss.pad_offset, ("rss", "pad_offset")
        else:
            key = ("joint_at",)
            if at is None:
                at = 0.5 * self.length
                self.fill_defaults(joint_at=at)
        if at > self.length + 1e-9:
            raise refuse(*key, got=at, want=f"at most the length of the item, {said(self.length, 'length')}")
        if self.bend is not None:
            raise refuse("bend", want="no bend in a steerable tool", hint="give the bend to an adjacent item")
        return self

    @property
    def place(self) -> float:
        """Height of the pads or of the tilt above the item's lower end [m]."""
        return self.rss.pad_offset if isinstance(self.rss, PushSteering) else self.joint_at
