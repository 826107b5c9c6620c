"""`joints`: places where the string can bend freely, turn freely or telescope."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field, model_validator

from drillpetsc.case.block import Block
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import Quantity, Vector

_SLIDER = ("slider",)
_KINDS_OF = {
    "axis": ("revolute", "universal"),
    "spring": _SLIDER,
    "damping": _SLIDER,
    "stroke": _SLIDER,
    "stop_stiffness": _SLIDER,
    "seal_area": _SLIDER,
}


class Joint(Block):
    """A joint at one measured depth, without length and mass; add both by rigid items (`{kind: body}`)."""

    kind: Literal["fixed", "revolute", "universal", "slider"] = Field(
        description="fixed: rigid connection; revolute: a hinge about one axis; universal: bends in two planes and transmits torque "
        "(Hooke joint); slider: telescopes along the string only (bumper sub, slip joint)"
    )
    at: Annotated[float, Quantity("m", at_least=0)] = Field(
        description="measured depth on the string; 0: between the top and the string"
    )
    axis: Annotated[tuple[float, float, float], Vector("")] = Field(
        default=(0.0, 1.0, 0.0),
        description="axis of a revolute joint, or of a universal joint's pin in the part above: components along the string and in two "
        "directions across it (the first towards the high side, or north, at the start)",
    )
    constraint: Literal["position", "stabilised"] = Field(
        default="position",
        description="position: constraint on positions (index 3); stabilised: also on velocities (Gear, Gupta and Leimkuhler; index 2)",
    )
    spring: Annotated[float, Quantity("N/m", at_least=0)] = Field(
        default=0.0, description="stiffness along a slider (shock sub)"
    )
    damping: Annotated[float, Quantity("N s/m", at_least=0)] = Field(
        default=0.0, description="damping along a slider"
    )
    stroke: tuple[Annotated[float, Quantity("m")], Annotated[float, Quantity("m")]] | None = Field(
        default=None,
        description="[least, largest] travel of a slider between its stops, 0 in the undeformed string; "
        "no stops when not given",
    )
    stop_stiffness: Annotated[float, Quantity("N/m", above=0)] = Field(
        default=1e8, description="stiffness of a slider's stops"
    )

    seal_area: Annotated[float, Quantity("m^2", at_least=0, at_most=0.5)] = Field(
        default=0.0,
        description="area inside the seals of a slider. The pressure difference between string and annulus pushes its parts "
        "apart on this area (pump-open force); mud fills the swept volume",
    )

    @model_validator(mode="after")
    def _fits_its_kind(self) -> Joint:
        for key, kinds in _KINDS_OF.items():  # compares values: case.yaml of a run names every key
            if self.kind not in kinds and getattr(self, key) != type(self).model_fields[key].default:
                want = f"no {key} for a joint of kind {self.kind}, only for {' | '.join(kinds)}"
                raise refuse(key, got=getattr(self, key), want=want)
        if not math.hypot(*self.axis) > 0:
            raise refuse("axis", got=list(self.axis), want="three components, not all zero")
        if self.kind == "universal" and self.axis[0] != 0:
            raise refuse("axis", got=list(self.axis), want="an axis across the string: its first component 0")
        if self.stroke is not None and not self.stroke[0] <= self.stroke[1]:
            raise refuse("stroke", got=list(self.stroke), want="[least, largest] travel")
        return self

    @property
    def axes(self) -> tuple[tuple[float, float, float], ...]:
        """(3, 3) orthonormal rows in the basis (tangent, director 2, director 3) [-].

        The first row is the axis. The second row of a universal joint is the pin of the part below.
        """
        x, y, z = (q / math.hypot(*self.axis) for q in self.axis)
        if self.kind in ("fixed", "slider"):
            return (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
        if self.kind == "universal" or abs(x) < 0.9:  # second across tangent and axis
            a = math.hypot(y, z)
            second = (0.0, -z / a, y / a)
        else:
            a = math.hypot(x, z)
            second = (z / a, 0.0, -x / a)
        third = (y * second[2] - z * second[1], z * second[0] - x * second[2], x * second[1] - y * second[0])
        return (x, y, z), second, third
