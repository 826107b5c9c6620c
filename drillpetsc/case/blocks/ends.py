"""`top`, `bottom` and `loads`: end conditions and loads of the string."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Discriminator, Field, Strict, Tag, model_validator

from drillpetsc.case.block import Block, ByKind
from drillpetsc.case.blocks.hoist import AutodrillerBlock, HoistBlock
from drillpetsc.case.blocks.items.string import Friction
from drillpetsc.case.blocks.top_drive import Controllers, TopMotor
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import OverTime, Quantity, Vector, said
from drillpetsc.time_function import Constant, TimeFunction

Force = Annotated[tuple[float, float, float], Vector("N")]
Moment = Annotated[tuple[float, float, float], Vector("N m")]
RotationSpeed = Annotated[TimeFunction, OverTime("rad/s")]
Speed = Annotated[TimeFunction, OverTime("m/s")]

Plugged = Annotated[bool, Strict()]

_ZERO = Constant(0.0)
_ROTATION = "rotation speed over time, positive clockwise seen from above"
_LOWERING = "speed of the top over time, positive downward"
_PLUGGED = (
    "true: the lower end is closed, and the string is empty unless a pump_pressure holds fluid in it; "
    "false: the end is open (used by a fluid)"
)


class TopEnd(Block):
    """Base of every kind of top. A kind without one of these keys has the value None for it."""

    optional_attributes: ClassVar[Mapping[str, Any]] = {
        "rotation": None,
        "lowering": None,
        "force": None,
        "torque": None,
        "motor": None,
        "control": (),
        "hoist": None,
        "autodriller": None,
    }

    if TYPE_CHECKING:
        kind: str
        rotation: TimeFunction | None = None
        lowering: TimeFunction | None = None
        force: TimeFunction | None = None
        torque: TimeFunction | None = None
        motor: TopMotor | None = None
        control: Controllers = ()
        hoist: HoistBlock | None = None
        autodriller: AutodrillerBlock | None = None


class HeldTop(TopEnd):
    """A top end without a drive."""

    kind: Literal["clamped", "pinned", "free"] = Field(
        description="clamped: position, direction and spin held; pinned: position and spin held, it bends freely; "
        "free: nothing held"
    )


class DrivenTop(TopEnd):
    """A rotary drive with inertia, held at `rotation` by a spring and a damper (PI control).

    Position and direction of the upper end are clamped.

    torque on the drive = stiffness * (prescribed angle - angle) + damping * (prescribed speed - speed).
    """

    kind: Literal["driven"] = Field(description="drive with inertia behind a spring and a damper")
    rotation: RotationSpeed = Field(default=_ZERO, description=_ROTATION)
    lowering: Speed = Field(default=_ZERO, description=_LOWERING)
    stiffness: Annotated[float, Quantity("N m/rad", at_least=0)] = Field(
        default=0.0, description="rotational stiffness"
    )
    damping: Annotated[float, Quantity("N m s/rad", at_least=0)] = Field(
        default=0.0, description="rotational damping"
    )
    inertia: Annotated[float, Quantity("kg m^2", at_least=0)] = Field(
        default=0.0, description="inertia of the drive"
    )

    @model_validator(mode="after")
    def _drives(self) -> DrivenTop:
        if self.stiffness == 0 and self.damping == 0:
            raise refuse("stiffness", want="a stiffness or a damping above 0, or nothing turns the string")
        return self


class TopDrive(TopEnd):
    """A top drive: rotation that is prescribed, or that a motor and its control follow; lowering, or an axial force."""

    kind: Literal["top_drive"] = Field(description="prescribed rotation, and lowering or axial force")
    rotation: RotationSpeed = Field(default=_ZERO, description=_ROTATION)
    lowering: Speed = Field(default=_ZERO, description=_LOWERING)
    force: Annotated[TimeFunction, OverTime("N")] | None = Field(
        default=None,
        description="axial force at the top over time, positive in pull, instead of a lowering",
    )
    hinged: bool = Field(
        default=False,
        strict=True,
        description="true: the direction of the string at the top is free; false: it is held",
    )
    guided: bool = Field(
        default=True,
        strict=True,
        description="false: with a force, the top also moves freely across the hole; true: its position across is held",
    )
    motor: TopMotor | None = Field(
        default=None, description="motor with inertia and limits; without it the rotation is prescribed"
    )
    control: Controllers = Field(
        default=(),
        description="speed controller of the motor, whose set point is the rotation; or a list of controllers, "
        "each from a time on",
    )
    torque: Annotated[TimeFunction, OverTime("N m")] | None = Field(
        default=None, description="torque of the motor over time, instead of a control"
    )
    hoist: HoistBlock | None = Field(
        default=None, description="block and drilling line; without it the lowering moves the top itself"
    )
    autodriller: AutodrillerBlock | None = Field(
        default=None, description="control of the drum of a hoist with a line"
    )

    @model_validator(mode="after")
    def _one_of_two(self) -> TopDrive:
        if self.force is not None and "lowering" in self.model_fields_set:
            raise refuse("force", want="a lowering or a force, not both")
        if not self.guided and self.force is None:
            raise refuse(
                "guided", got=False, want="a force: a top whose axial position is prescribed is guided"
            )
        if self.motor is None:
            if self.control:
                raise refuse(
                    "control", got=self.control[0].kind, want="an own controller needs motor.inertia",
                    hint="without a motor the rotation is prescribed",
                )  # fmt: skip
            if self.torque is not None:
                raise refuse("torque", want="a motor, whose torque it is: motor: {inertia: ...}")
        elif bool(self.control) == (self.torque is not None):
            want = "a control, or a torque over time" + (", not both" if self.control else "")
            raise refuse("torque" if self.control else "control", want=want)
        self._hoisting()
        if self.torque is not None and "rotation" in self.model_fields_set:
            raise refuse("rotation", want="no rotation with a torque: the speed follows from it")
        self._times()
        return self

    def _hoisting(self) -> None:
        """Raise if hoist, autodriller, force and lowering are inconsistent."""
        drill = self.autodriller
        if self.hoist is None:
            if drill is not None:
                raise refuse("autodriller", want="a hoist with a line: hoist: {block_mass: ..., line: {...}}")
            return
        if self.force is not None:
            raise refuse("force", want="a hoist or a force, not both: the block hangs on the line")
        if self.hinged:
            raise refuse("hinged", got=True, want="no hinge with a hoist: the block guides the string")
        most = self.hoist.max_speed
        for t in (0.0, *self.lowering.breaks()):
            for value in (self.lowering.value(t, True), self.lowering.value(t)):
                if abs(value) > most:
                    raise refuse("lowering", got=value, want=f"at most hoist.max_speed, {said(most, 'rop')}")
        if drill is None:
            return
        if self.hoist.line is None:
            raise refuse("autodriller", want="a line of the hoist, such as hoist: {line: {diameter: 35 mm}}")
        if drill.from_ == 0 and "lowering" in self.model_fields_set:
            raise refuse(
                "lowering", want="no lowering with an autodriller from time 0",
                hint="lowering acts before autodriller.from",
            )  # fmt: skip
        if drill.max_speed is not None and drill.max_speed > most:
            raise refuse(
                "autodriller",
                "max_speed",
                got=drill.max_speed,
                want=f"at most hoist.max_speed, {said(most, 'rop')}",
            )

    def _times(self) -> None:
        """Raise if controllers do not follow each other from time 0 on."""
        for i, q in enumerate(self.control):
            if q.kind == "python" and len(self.control) > 1:
                want = "a single controller: a function in Python changes its law by itself"
                raise refuse("control", i, "kind", got=q.kind, want=want)
            if q.sample != self.control[0].sample:
                want = f"the same for all controllers, {self.control[0].sample:g} s as in the first one"
                raise refuse("control", i, "sample", got=q.sample, want=want)
            if i == 0 and q.from_ != 0:
                raise refuse("control", 0, "from", got=q.from_, want="0 for the first controller")
            if i and q.from_ <= self.control[i - 1].from_:
                want = f"later than the controller before, {self.control[i - 1].from_:g} s"
                raise refuse("control", i, "from", got=q.from_, want=want)


class HeldBottom(Block):
    """A bottom end that is free or held."""

    kind: Literal["free", "pinned", "clamped"] = Field(
        description="free: nothing held; pinned: position held; clamped: position, direction and spin held"
    )
    plugged: Plugged = Field(default=False, description=_PLUGGED)


class ForcedBottom(Block):
    """A dead force and moment at the lower end."""

    kind: Literal["force"] = Field(description="a given force and moment")
    force: Force = Field(default=(0.0, 0.0, 0.0), description="force on the string, north, east, down")
    moment: Moment = Field(default=(0.0, 0.0, 0.0), description="moment on the string, north, east, down")
    plugged: Plugged = Field(default=False, description=_PLUGGED)


class BitBottom(Block):
    """A bit that rests on the end of the hole."""

    kind: Literal["bit"] = Field(description="a bit on the end of the hole")
    stiffness: Annotated[float, Quantity("N/m", above=0)] = Field(
        default=1e8, description="contact stiffness of the bit on the rock"
    )
    friction: Friction = Field(default=0.3, description="friction coefficient of the bit face on the rock")
    pump_off_area: Annotated[float, Quantity("m^2", at_least=0, at_most=1)] = Field(
        default=0.0,
        description="area on which the pressure drop of the bit lowers a weight on bit that is read: weight read = weight - pressure drop "
        "of the bit times area; for measured points",
    )
    plugged: Plugged = Field(default=False, description=_PLUGGED)


Top = Annotated[HeldTop | DrivenTop | TopDrive, ByKind("clamped", "pinned", "free")]
Bottom = Annotated[HeldBottom | ForcedBottom | BitBottom, ByKind("free", "pinned", "clamped", "bit")]


class Load(Block):
    """Keys that point and distributed loads have in common."""

    frame: Literal["global", "section"] = Field(
        default="global",
        description="global: north, east, down; section: along the string, then two directions across it, which turn with the string",
    )
    value_over: Annotated[TimeFunction, OverTime("")] = Field(
        default=Constant(1.0), description="factor over time on force and moment"
    )

    @model_validator(mode="after")
    def _force_or_moment(self) -> Load:
        if not {"force", "moment"} & self.model_fields_set:
            raise refuse("force", want="a force, a moment or both")
        return self


class PointLoad(Load):
    """A force and a moment at one measured depth."""

    at: Annotated[float, Quantity("m", at_least=0)] = Field(description="measured depth")
    force: Force = Field(default=(0.0, 0.0, 0.0), description="force")
    moment: Moment = Field(default=(0.0, 0.0, 0.0), description="moment")


class LineLoad(Load):
    """A force and a moment per length between two measured depths."""

    from_: Annotated[float, Quantity("m", at_least=0)] = Field(
        alias="from", description="measured depth of the upper end"
    )
    to: Annotated[float, Quantity("m", at_least=0)] = Field(description="measured depth of the lower end")
    force: Annotated[tuple[float, float, float], Vector("N/m", kind="side_force")] = Field(
        default=(0.0, 0.0, 0.0), description="force per length"
    )
    moment: Annotated[tuple[float, float, float], Vector("N m/m")] = Field(
        default=(0.0, 0.0, 0.0), description="moment per length"
    )

    @model_validator(mode="after")
    def _downward(self) -> LineLoad:
        if self.to <= self.from_:
            raise refuse("to", got=self.to, want=f"below from, {said(self.from_, 'length')}")
        return self


def _load(value: Any) -> Any:
    if isinstance(value, Load):
        return value
    if not isinstance(value, dict):
        raise refuse(
            got=value, want="a mapping {at: ..., force: [...]} or {from: ..., to: ..., force: [...]}"
        )
    if "at" in value and ("from" in value or "to" in value):
        raise refuse("at", got=value["at"], want="either at (a point) or from and to (distributed)")
    if not {"at", "from", "from_", "to"} & set(value):
        raise refuse("at", want="a place: at (a point) or from and to (distributed)")
    return value


def _load_tag(value: Any) -> str:
    point = "at" in value if isinstance(value, dict) else isinstance(value, PointLoad)
    return "kind:PointLoad" if point else "kind:LineLoad"


AnyLoad = Annotated[
    Annotated[PointLoad, Tag("kind:PointLoad")] | Annotated[LineLoad, Tag("kind:LineLoad")],
    Discriminator(_load_tag),
    BeforeValidator(_load),
]
