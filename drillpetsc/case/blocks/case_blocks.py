"""`CaseBlocks`: all blocks of a case file, each of them valid by itself.

Checks, defaults, writer and schema are typed on this class. `Case` adds them to it.
"""

from __future__ import annotations

import re
from typing import Annotated, Any, Literal

from pydantic import (
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
    field_validator,
)

from drillpetsc.case.block import Block
from drillpetsc.case.blocks.contact import Contact, contact_or_none
from drillpetsc.case.blocks.ends import AnyLoad, Bottom, HeldBottom, HeldTop, Top
from drillpetsc.case.blocks.fluid import Fluid
from drillpetsc.case.blocks.formation import Formation
from drillpetsc.case.blocks.items.joints import Joint
from drillpetsc.case.blocks.items.motor import PositiveDisplacementMotor
from drillpetsc.case.blocks.items.steering import RotarySteerable
from drillpetsc.case.blocks.items.string import Bit, Flexible, Material
from drillpetsc.case.blocks.items.tools import TelescopingTool
from drillpetsc.case.blocks.items.tubulars import StringItem
from drillpetsc.case.blocks.own_law import OwnComponent
from drillpetsc.case.blocks.rig import STANDARD_GRAVITY, Rig
from drillpetsc.case.blocks.roadmap import Roadmap
from drillpetsc.case.blocks.settings import BeamTheory, Initial, MeshSettings, Output, Time
from drillpetsc.case.blocks.uncertain import Spreads
from drillpetsc.case.blocks.well import WINDOW_FILE, Well, Window
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import Quantity, Vector
from drillpetsc.unit_systems import System

Option = bool | int | float | str


class CaseBlocks(Block):
    """The blocks of a case file. A block that is absent is absent physics."""

    # a held string needs no top, so the schema requires one of the two keys
    model_config = ConfigDict(
        json_schema_extra={
            "anyOf": [
                {"required": ["top"]},
                {"required": ["hold_string"], "properties": {"hold_string": {"const": True}}},
            ]
        }
    )

    title: str = Field(default="", description="title of the case")
    units: Literal["field", "metric", "SI"] = Field(
        default="SI",
        description="units of numbers without one: field (ft, in, klbf, ft-lbf, psi, ppg, gpm), metric (m, mm, kN, kN m, bar, sg, l/min) or SI; "
        "reports use them too",
    )
    force_unit: Literal["kN", "t"] | None = Field(
        default=None, description="unit of forces in the metric system: kN, or t for tonnes-force"
    )
    rig: Rig | None = Field(default=None, description="weight of the block, and limits of the rig")
    catalogue: str | None = Field(
        default=None,
        description="a folder with CSV files, or one CSV file, beside the case: rows of the catalogue before the built-in ones",
    )
    well: Well | None = Field(default=None, description="the hole; without it the string is in free space")
    string: tuple[StringItem, ...] = Field(
        min_length=1, description="from the top down; the last item ends at the bit"
    )
    bit_depth: Annotated[float, Quantity("m", above=0, at_most=50e3)] | None = Field(
        default=None,
        description="measured depth of the bit: the hole ends there, and the length of the topmost pipe follows. When not given, the length "
        "of the string, or the end of the survey with length: fill",
    )
    joints: tuple[Joint, ...] = Field(default=(), description="joints in the string, at measured depths")
    material: Material = Field(
        default=Material(), description="material of all items that name no other; steel when not given"
    )
    beam: BeamTheory = Field(default=BeamTheory(), description="unknowns of the string")
    mesh: MeshSettings = Field(default=MeshSettings(), description="elements of automatic length")
    hold_string: bool = Field(
        default=False,
        strict=True,
        description="the string does not move and has no unknowns (hydraulics only); top may be left out, "
        "and there is no contact",
    )
    top: Top = Field(
        default=None,  # the validator replaces None or refuses it
        validate_default=True,
        description="what holds or drives the upper end; needed unless hold_string is true",
    )
    bottom: Bottom = Field(default=HeldBottom(kind="free"), description="what the lower end meets")
    contact: Annotated[
        Contact | None, BeforeValidator(contact_or_none, json_schema_input_type=Literal["none"] | Contact)
    ] = Field(
        default=None,
        description="contact with the hole, or none; with a well and without this key, contact with all defaults",
    )
    fluid: Fluid | None = Field(
        default=None, description="the drilling fluid; without it the hole and the string are dry"
    )
    window: Annotated[
        Window | None, BeforeValidator(WINDOW_FILE.read_if_named, json_schema_input_type=str | Window)
    ] = Field(
        default=None,
        description="limits of the pressure in the open hole (used by hydraulics and surge), "
        "or the name of a CSV file with the columns tvd, pore, frac",
    )
    roadmap: Roadmap | None = Field(
        default=None, description="operations, depths and friction factors of a torque-and-drag roadmap"
    )
    uncertain: Spreads = Field(
        default=None,
        description="distributions of numbers of the case, by the path of each (used by uncertain)",
    )
    formation: Formation | None = Field(
        default=None, description="the rock that the bit cuts; without it the bit does not drill"
    )
    components: tuple[OwnComponent, ...] = Field(
        default=(),
        description="components of the user: functions that build them, file.py:function, module:function, or the name of an installed "
        "one (entry point drillpetsc.components)",
    )
    loads: tuple[AnyLoad, ...] = Field(default=(), description="point and distributed loads on the string")
    gravity: Annotated[tuple[float, float, float], Vector("m/s^2", along_z=True)] = Field(
        default=(0.0, 0.0, STANDARD_GRAVITY),
        description="acceleration of gravity, downward; or [north, east, down]",
    )
    initial: Initial = Field(default=Initial(), description="the state at time 0")
    time: Time | None = Field(default=None, description="simulated time; needed to run, not for statics")
    output: Output = Field(default=Output(), description="contents of the run folder")
    petsc: dict[str, Option] = Field(default={}, description="PETSc options, without the leading dash")

    @field_validator("top", mode="wrap")
    @classmethod
    def _top_unless_held(cls, value: Any, read: ValidatorFunctionWrapHandler, info: ValidationInfo) -> Any:
        if value is not None:
            return read(value)
        if info.data.get("hold_string"):
            return HeldTop(kind="clamped")
        hint = "a rig's drive is top: {kind: top_drive, rotation: 120 rpm}"
        raise refuse(want="this key; it has no default", hint=hint)

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
            if option is not None and not isinstance(option, (bool, int, float, str)) or option != option:
                raise refuse(key, got=option, want="a number, a word, true or false")
            options[str(key)] = "" if option is None else option
        return options

    @property
    def shown_units(self) -> System:
        """System of units of messages, tables and pictures."""
        return self.output.units or "metric"

    @property
    def said_units(self) -> System:
        """System of units of messages about keys of the case: as its reader gave them."""
        return self.output.units or self.units

    @property
    def given_well(self) -> Well:
        """``well`` of a case that has a hole."""
        assert self.well is not None
        return self.well

    @property
    def given_fluid(self) -> Fluid:
        """``fluid`` of a case with mud."""
        assert self.fluid is not None
        return self.fluid

    @property
    def given_time(self) -> Time:
        """``time`` of a case that is run."""
        assert self.time is not None
        return self.time

    @property
    def item_depths(self) -> tuple[tuple[float, float], ...]:
        """Measured depth of the upper and lower end of each string item [m]."""
        depths, above = [], 0.0
        for item in self.string:
            depths.append((above, above + item.length))
            above += item.length
        return tuple(depths)

    @property
    def tools(self) -> tuple[tuple[int, TelescopingTool, Joint], ...]:
        """Telescoping tools of a string that can move: number of the item, item, and its slider."""
        found = []
        for i, (item, (top, _)) in enumerate(zip(self.string, self.item_depths, strict=True)):
            # a piece of a tool, such as statics of a shorter string has, may end above its slider
            if isinstance(item, TelescopingTool) and not self.hold_string and item.joint_at < item.length:
                found.append((i, item, item.joint(top)))
        return tuple(found)

    @property
    def all_joints(self) -> tuple[Joint, ...]:
        """Joints of the case and of its tools."""
        return (
            *self.joints,
            *(joint for _, _, joint in self.tools),
            *(joint for _, joint in self.motor_joints),
        )

    @property
    def string_length(self) -> float:
        """Length of the string [m]."""
        return self.item_depths[-1][1]

    @property
    def steering_depths(self) -> dict[int, float]:
        """Measured depths of pads or tilts [m] by the numbers of their items."""
        return {
            number: below - item.place
            for number, (item, (_, below)) in enumerate(zip(self.string, self.item_depths, strict=True))
            if isinstance(item, RotarySteerable)
        }

    @property
    def motor_joints(self) -> tuple[tuple[int, Joint], ...]:
        """Numbers of downhole motors in the string, and their joints."""
        return tuple(
            (number, item.joint(top))
            for number, (item, (top, _)) in enumerate(zip(self.string, self.item_depths, strict=True))
            if isinstance(item, PositiveDisplacementMotor) and item.joint_at < item.length
        )

    @property
    def has_bore(self) -> bool:
        """Whether there is fluid in the string.

        There is none in a solid string, or in a plugged string that is not filled by a pump pressure or through
        nozzles above the bit.
        """
        sealed = self.bottom.plugged and not self.side_nozzles
        if self.fluid is None or (sealed and self.fluid.pump_pressure is None):
            return False
        return any(isinstance(item, Flexible) and item.id > 0 for item in self.string)

    @property
    def side_nozzles(self) -> tuple[tuple[int, float], ...]:
        """(number of the string item, flow area [m2]) of items with nozzles above the bit, from the top down."""
        found = ((i, item.nozzle_area) for i, item in enumerate(self.string) if not isinstance(item, Bit))
        return tuple((i, area) for i, area in found if area)

    @property
    def has_annulus(self) -> bool:
        """Whether there is fluid between string and hole."""
        return self.fluid is not None and self.fluid.annulus
