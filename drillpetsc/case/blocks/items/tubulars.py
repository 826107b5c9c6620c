"""Pipe of the trade: drill pipe, heavy-wall pipe, collars, casing, coiled tubing; and the list of all string items.

Keys that are left out are filled in from the catalogue by `drillpetsc.case.pipe.tubulars`, each with its source.
"""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field, model_validator

from drillpetsc.case.block import Block, ByKind, derived_default
from drillpetsc.case.blocks.items.agitator import AgitatorTool
from drillpetsc.case.blocks.items.motor import PositiveDisplacementMotor
from drillpetsc.case.blocks.items.reamer import Reamer
from drillpetsc.case.blocks.items.steering import RotarySteerable
from drillpetsc.case.blocks.items.string import (
    PIPE_LENGTH,
    Beam,
    Bit,
    Body,
    Bore,
    Diameter,
    Pipe,
    PipeLength,
    Stabilizer,
    Tool,
    Tube,
)
from drillpetsc.case.blocks.items.tools import BumperSub, Jar, ShockSub
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import Quantity, said

Wall = Annotated[float, Quantity("m", above=0, at_most=1, kind="diameter")]
JointLength = Annotated[float, Quantity("m", above=0, at_most=100)]
UpsetLength = Annotated[float, Quantity("m", above=0, at_most=100, kind="none")]  # feet or inches?
Weight = Annotated[float, Quantity("kg/m", above=0, at_most=1e5)]
NominalWeight = Annotated[
    Weight | None,
    Field(
        description="name of the weight, with threads and couplings; finds the row of the catalogue, never a weight"
    ),
]
Stress = Annotated[float, Quantity("Pa", at_least=1e6, at_most=1e11, kind="stress")]
Torque = Annotated[float, Quantity("N m", above=0, at_most=1e7)]
Share = Annotated[float, Quantity("", above=0, at_most=1)]


class ToolJoint(Block):
    """Tool joint at each end of a joint of pipe. Missing keys are taken from the catalogue."""

    connection: str | None = Field(default=None, description="name of the connection, such as NC50")
    od: Diameter = derived_default("outer diameter")
    id: Bore = derived_default("inner diameter")
    length: UpsetLength = derived_default("pin tong and box tong of one joint, together")
    make_up_torque: Torque | None = Field(
        default=None,
        description="torque with which the connection is made up, for limits; default: the catalogue's, else 60 % of "
        "the torque at which the tool joint yields (API RP 7G)",
    )


class CenterUpset(Block):
    """Thick middle of heavy-wall drill pipe, which also touches the wall."""

    od: Diameter = Field(description="outer diameter")
    length: UpsetLength = Field(description="length")


class Tubular(Tube):
    """Base of all oilfield pipe."""

    has_own_od: ClassVar[bool] = False

    length: PipeLength = Field(description=PIPE_LENGTH)
    od: Diameter = derived_default("outer diameter of the tube")
    id: Bore = derived_default("inner diameter of the tube; or give the wall")
    wall: Wall | None = Field(default=None, description="wall of the tube, instead of id")
    adjusted_weight: Weight = derived_default(
        "average mass per length in air, with tool joints; from the catalogue, else by a formula"
    )
    grade: str | None = Field(default=None, description="steel grade, such as S-135; sets yield_strength")
    yield_strength: Stress = derived_default("yield strength, for limits")
    contact_on: Literal["tool_joint", "body"] = Field(
        default="tool_joint",
        description="diameter that touches the hole: tool joints, or body",
    )
    override: bool = Field(
        default=False, strict=True, description="od and id may differ from the catalogue by more than 1 %"
    )

    @model_validator(mode="after")
    def _one_wall(self) -> Tubular:
        if self.wall is not None and self.id is not None:
            raise refuse("wall", got=self.wall, want="id or wall, not both")
        if self.wall is not None and self.od is not None and 2 * self.wall >= self.od:
            raise refuse(
                "wall",
                got=self.wall,
                want=f"less than half the outer diameter, {said(self.od / 2, 'diameter')}",
            )
        return self


class Jointed(Tubular):
    """Pipe with tool joints."""

    pipe: str | None = Field(
        default=None, description="text reference to the catalogue: 5in 19.50 S-135 NC50 premium"
    )
    tool_joint: ToolJoint = derived_default("tool joint; keys left out are taken from the catalogue")
    joint_length: JointLength = derived_default(
        "length of a joint, shoulder to shoulder; 31.0 ft, with range: 3 44.0 ft"
    )
    range: Literal[2, 3] | None = Field(
        default=None, description="length range of the joints, instead of joint_length"
    )
    stiffness: Literal["series", "body"] = Field(
        default="series", description="tube and tool joints in series, or the tube alone"
    )
    clearance: Literal["tool_joint", "body"] = Field(
        default="tool_joint",
        description="diameter from which the clearance of buckling loads is measured: tool joints (API RP 7G), or body",
    )

    @property
    def widest_od(self) -> float | None:
        return self.od if self.tool_joint is None else self.tool_joint.od

    @property
    def contact_od(self) -> float | None:
        return self.od if self.contact_on == "body" or self.tool_joint is None else self.tool_joint.od

    @property
    def clearance_od(self) -> float | None:
        return self.od if self.clearance == "body" else self.contact_od


class DrillPipe(Jointed):
    """Drill pipe with tool joints, by a text reference to the catalogue or by its dimensions."""

    kind: Literal["drill_pipe"] = Field(description="drill pipe with tool joints")
    nominal_weight: NominalWeight = None
    class_: Literal["new", "premium", "class_2"] | None = Field(
        default=None,
        alias="class",
        description="wear: wall of 100, 80 or 70 %; premium when not given; for limits only",
    )
    remaining_wall: Share = derived_default(
        "fraction of the wall that is left, instead of class; for limits only"
    )


class HeavyPipe(Jointed):
    """Heavy-wall drill pipe."""

    kind: Literal["hwdp"] = Field(description="heavy-wall drill pipe")
    center_upset: CenterUpset | None = Field(
        default=None, description="thick middle of a joint; the catalogue's; for contact only"
    )


class DrillCollar(Tubular):
    """Drill collar, round or spiral."""

    kind: Literal["drill_collar"] = Field(description="drill collar")
    joint_length: JointLength = derived_default("length of a joint; 31.0 ft")
    spiral: bool = Field(
        default=False, strict=True, description="spiral grooves: less mass, the same stiffness"
    )
    spiral_weight_factor: Share = Field(
        default=0.96, description="mass of a spiral collar over the mass of a round one"
    )
    nonmagnetic: bool = Field(
        default=False,
        strict=True,
        description="density 7860 kg/m3 and Young's modulus 193 GPa unless the item's material gives them",
    )


class Casing(Tubular):
    """Casing or liner that is run into the hole."""

    kind: Literal["casing"] = Field(description="casing")
    nominal_weight: NominalWeight = None


class CoiledTubing(Tubular):
    """Coiled tubing."""

    kind: Literal["coiled_tubing"] = Field(description="coiled tubing")


StringItem = Annotated[
    Pipe
    | Tool
    | Beam
    | DrillPipe
    | HeavyPipe
    | DrillCollar
    | Casing
    | CoiledTubing
    | ShockSub
    | BumperSub
    | Jar
    | Stabilizer
    | Body
    | Bit
    | RotarySteerable
    | PositiveDisplacementMotor
    | AgitatorTool
    | Reamer,
    ByKind(),
]
