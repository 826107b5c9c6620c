"""`joints`: places where the string can bend freely, turn freely or telescope."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field, model_validator

from drillpetsc.case.block import Block
from drillpetsc.case.blocks.string import Flexible
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import Quantity, Vector

if TYPE_CHECKING:
    from drillpetsc.case.case import Case

TOLERANCE = 1e-6  # [m] depths closer than this are one
_SLIDER = ("slider",)
_KINDS_OF = {
    "axis": ("revolute", "universal"),
    "spring": _SLIDER,
    "damping": _SLIDER,
    "stroke": _SLIDER,
    "stop_stiffness": _SLIDER,
}


class Joint(Block):
    """A joint at one measured depth; it has no length and no mass. Rigid items (`{kind: body}`) beside it
    give it both."""

    kind: Literal["fixed", "revolute", "universal", "slider"] = Field(
        description="fixed: nothing moves; revolute: a hinge about one axis; universal: bends both ways and carries torque, as a Hooke "
        "joint; slider: telescopes along the string and carries all else (bumper sub, slip joint)"
    )
    at: Annotated[float, Quantity("m", above=0)] = Field(description="measured depth on the string [m]")
    axis: Annotated[tuple[float, float, float], Vector("")] = Field(
        default=(0.0, 1.0, 0.0),
        description="axis of a revolute joint, or of a universal joint's pin in the part above, as components along the string and its "
        "section's two directions (the first towards the high side, or north, at the start)",
    )
    constraint: Literal["position", "stabilised"] = Field(
        default="position",
        description="position: the parts fit in place (index 3); stabilised: their velocities fit as well (Gear, Gupta and "
        "Leimkuhler; index 2)",
    )
    spring: Annotated[float, Quantity("N/m", at_least=0)] = Field(
        default=0.0, description="stiffness along a slider [N/m] (shock sub)"
    )
    damping: Annotated[float, Quantity("N s/m", at_least=0)] = Field(
        default=0.0, description="damping along a slider [N s/m]"
    )
    stroke: tuple[Annotated[float, Quantity("m")], Annotated[float, Quantity("m")]] | None = Field(
        default=None,
        description="least and largest travel of a slider between its stops [m], 0 as the string is given; "
        "no stops when not given",
    )
    stop_stiffness: Annotated[float, Quantity("N/m", above=0)] = Field(
        default=1e8, description="stiffness of a slider's stops [N/m]"
    )

    @model_validator(mode="after")
    def _fits_its_kind(self) -> Joint:
        for key, kinds in _KINDS_OF.items():  # by value: a case as run names every key
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
        """(3, 3) orthonormal rows in (tangent, director 2, director 3): the axis first; for a universal
        joint, second the pin below."""
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


def check_joints(case: Case) -> None:
    """Raises where joints do not fit the string or the rest of the scene."""
    end = case.string_length
    seen: dict[float, int] = {}
    for i, joint in enumerate(case.joints):
        if case.hold_string:
            raise refuse(
                "joints", i, got=joint.kind, want="no joints in a string that hold_string keeps still"
            )
        if case.fluid is not None:
            raise refuse(
                "joints",
                i,
                got=joint.kind,
                want="no joints in a scene with a fluid (not available in this version)",
            )
        if not TOLERANCE < joint.at < end - TOLERANCE:
            raise refuse(
                "joints",
                i,
                "at",
                got=joint.at,
                want=f"a measured depth inside the string, between 0 and {end:g} m",
            )
        for other, k in seen.items():
            if abs(other - joint.at) <= TOLERANCE:
                raise refuse(
                    "joints",
                    i,
                    "at",
                    got=joint.at,
                    want=f"another depth than that of joints[{k}]: one joint at a place",
                )
        seen[joint.at] = i
        for k, (item, (above, below)) in enumerate(zip(case.string, case.item_depths, strict=True)):
            if not isinstance(item, Flexible) and above + TOLERANCE < joint.at < below - TOLERANCE:
                want = f"an end of the rigid item string[{k}], {above:g} or {below:g} m, or a depth in a pipe or beam"
                raise refuse("joints", i, "at", got=joint.at, want=want)
    _no_loose_item(case)


def _no_loose_item(case: Case) -> None:
    """Rigid items alone between joints, or between one and an end, need a mass and inertia of their own."""
    marks = [0.0, *sorted(joint.at for joint in case.joints), case.string_length]
    for above, below in zip(marks, marks[1:], strict=False):
        inside = [
            i for i, (a, b) in enumerate(case.item_depths) if b > above + TOLERANCE and a < below - TOLERANCE
        ]
        if len(marks) == 2 or any(isinstance(case.string[i], Flexible) for i in inside):
            continue
        for i, joint in enumerate(case.joints):
            if joint.at == below and joint.constraint == "stabilised":
                want = "constraint: position, or a pipe or beam above the joint"
                raise refuse(
                    "joints",
                    i,
                    "constraint",
                    got=joint.constraint,
                    want=want,
                    hint="only rigid items hang above it",
                )
        if all(case.string[i].mass == 0 for i in inside):  # type: ignore[union-attr]
            raise refuse(
                "string",
                inside[0],
                "mass",
                got=0.0,
                want="a mass: only rigid items hang between the joints here",
            )
