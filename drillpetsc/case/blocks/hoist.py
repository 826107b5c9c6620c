"""`top.hoist` and `top.autodriller`: block, drilling line, heave, and the control of the drum."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, ClassVar, Literal

from pydantic import BeforeValidator, Field, Strict, model_validator

from drillpetsc.case.block import Block
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import OverTime, Quantity, one_as_list, said
from drillpetsc.time_function import TimeFunction

MODES = ("wob", "rop", "torque", "differential_pressure")
Switch = Annotated[bool, Strict()]


class DrillingLine(Block):
    """The rope between drum, sheaves and dead-line anchor."""

    axial_stiffness: Annotated[float, Quantity("N", above=0)] | None = Field(
        default=None, description="axial stiffness EA of the rope; or its diameter"
    )
    diameter: Annotated[float, Quantity("m", above=0, at_most=0.1)] | None = Field(
        default=None,
        description="diameter d of the rope, instead of axial_stiffness: modulus times fill times d^2",
    )
    modulus: Annotated[float, Quantity("Pa", above=0)] = Field(
        default=1.0e11,
        description="modulus of the rope's metal, as it lies in the strands (used with diameter)",
    )
    fill: Annotated[float, Quantity("", above=0, at_most=0.79)] = Field(
        default=0.4, description="area of metal over the squared diameter (used with diameter)"
    )

    @model_validator(mode="after")
    def _one_of_two(self) -> DrillingLine:
        if (self.axial_stiffness is None) == (self.diameter is None):
            want = "an axial_stiffness or a diameter" + (", not both" if self.diameter is not None else "")
            raise refuse("axial_stiffness", got=self.axial_stiffness, want=want)
        for key in ("modulus", "fill"):
            if key in self.model_fields_set and self.diameter is None:
                raise refuse(key, got=getattr(self, key), want=f"no {key} without a diameter")
        return self

    @property
    def stiffness(self) -> float:
        """Axial stiffness EA [N]."""
        if self.axial_stiffness is not None:
            return self.axial_stiffness
        assert self.diameter is not None
        return self.modulus * self.fill * self.diameter**2


class FloorHeave(Block):
    """Harmonic motion of a floating rig's floor."""

    amplitude: Annotated[TimeFunction, OverTime("m")] = Field(description="amplitude over time")
    period: Annotated[float, Quantity("s", above=0)] = Field(description="period")
    phase: Annotated[float, Quantity("rad")] = Field(default=0.0, description="phase at time 0")
    compensation: Annotated[float, Quantity("", at_least=0, at_most=1)] = Field(
        default=0.0, description="share of the motion that a compensator keeps from the block"
    )


class HoistBlock(Block):
    """Block, line and drum that hold the top drive. Without a line the block moves with the drum."""

    block_mass: Annotated[float, Quantity("kg", above=0, at_most=1e7)] = Field(
        description="mass of block, hook and top drive"
    )
    lines: Annotated[int, Strict(), Field(ge=1, le=40)] = Field(
        default=10, description="number of lines between crown and block"
    )
    line: DrillingLine | None = Field(
        default=None, description="the rope, which stretches; without it the block moves with the drum"
    )
    height: Annotated[float, Quantity("m", above=0)] = Field(
        default=30.0, description="height of the block over the floor at the start"
    )
    crown_height: Annotated[float, Quantity("m", above=0)] | None = Field(
        default=None,
        description="height of the crown over the floor, which sets the length of the lines; default twice height",
    )
    fast_line: Annotated[float, Quantity("m", at_least=0)] = Field(
        default=40.0, description="length of the fast line, from the crown to the drum"
    )
    dead_line: Annotated[float, Quantity("m", at_least=0)] = Field(
        default=35.0, description="length of the dead line, from the crown to its anchor"
    )
    damping: Annotated[float, Quantity("N s/m", at_least=0)] = Field(
        default=0.0, description="damping between drum and block"
    )
    sheave_efficiency: Annotated[float, Quantity("", above=0, at_most=1)] = Field(
        default=1.0, description="efficiency of one sheave; it acts on the dead-line tension only"
    )
    max_speed: Annotated[float, Quantity("m/s", above=0)] = Field(
        default=1.5, description="largest speed of the block"
    )
    tare: Switch = Field(
        default=False, description="true: hook_load_sensor leaves out the weight of the block"
    )
    heave: FloorHeave | None = Field(default=None, description="motion of the floor of a floating rig")

    @model_validator(mode="after")
    def _below_crown(self) -> HoistBlock:
        if self.crown_height is not None and self.crown_height <= self.height:
            want = f"above the height of the block, {said(self.height, 'length')}"
            raise refuse("crown_height", got=self.crown_height, want=want)
        if self.line is None and self.damping:
            raise refuse("damping", got=self.damping, want="no damping without a line")
        return self

    @property
    def crown(self) -> float:
        """Height of the crown over the floor [m]."""
        return 2 * self.height if self.crown_height is None else self.crown_height


Mode = Literal["wob", "rop", "torque", "differential_pressure"]
_GAINS = {"torque": "torque", "differential_pressure": "pressure"}  # words of the gains of a mode


def _least(value: TimeFunction) -> float:
    """Smallest value over time."""
    return min(value.value(t, before) for t in (0.0, *value.breaks()) for before in (False, True))


class AutodrillerBlock(Block):
    """Control of the drum's speed; of several modes the one with the least speed acts."""

    mode_of_key: ClassVar[Mapping[str, str]] = {
        "p": "wob", "i": "wob", "measure": "wob", "ramp": "wob", "torque_p": "torque", "torque_i": "torque",
        "pressure_p": "differential_pressure", "pressure_i": "differential_pressure",
    }  # fmt: skip
    """Keys that one of the modes uses."""
    mode: Annotated[
        tuple[Mode, ...], BeforeValidator(one_as_list, json_schema_input_type=Mode | tuple[Mode, ...])
    ] = Field(default=("wob",), description="what is held at its set point, or the first limit of several")
    wob: Annotated[TimeFunction, OverTime("N")] | None = Field(
        default=None, description="set point of the weight on bit over time"
    )
    rop: Annotated[TimeFunction, OverTime("m/s")] | None = Field(
        default=None, description="set point of the rate of penetration over time: the speed of the drum"
    )
    torque: Annotated[TimeFunction, OverTime("N m")] | None = Field(
        default=None, description="set point of the surface torque over time"
    )
    differential_pressure: Annotated[TimeFunction, OverTime("Pa")] | None = Field(
        default=None, description="set point of the pump pressure minus the pump pressure at the time from"
    )
    p: Annotated[float, Quantity("m/(s N)", above=0)] = Field(
        default=5.0e-8, description="proportional gain of mode wob"
    )
    i: Annotated[float, Quantity("m/(s^2 N)", at_least=0)] = Field(
        default=2.0e-9, description="integral gain of mode wob"
    )
    torque_p: Annotated[float, Quantity("m/(s N m)", above=0)] = Field(
        default=5.0e-7, description="proportional gain of mode torque"
    )
    torque_i: Annotated[float, Quantity("m/(s^2 N m)", at_least=0)] = Field(
        default=2.0e-8, description="integral gain of mode torque"
    )
    pressure_p: Annotated[float, Quantity("m/(s Pa)", above=0)] = Field(
        default=5.0e-9, description="proportional gain of mode differential_pressure"
    )
    pressure_i: Annotated[float, Quantity("m/(s^2 Pa)", at_least=0)] = Field(
        default=2.0e-10, description="integral gain of mode differential_pressure"
    )
    measure: Literal["surface", "bit"] = Field(
        default="surface",
        description="weight on bit: surface, from the hook load, tared at the start; bit, the true one",
    )
    from_: Annotated[float, Quantity("s", at_least=0)] = Field(
        default=0.0,
        alias="from",
        description="time from which it acts; before, the drum has the speed lowering",
    )
    max_speed: Annotated[float, Quantity("m/s", above=0)] | None = Field(
        default=None, description="largest speed of the drum; default: the largest speed of the hoist"
    )
    reverse: Switch = Field(default=False, description="true: the drum may also hoist, up to max_speed")
    ramp: Annotated[float, Quantity("N/s", above=0)] | None = Field(
        default=None, description="largest rate of the weight's set point, which begins at the weight at from"
    )
    filter: Annotated[float, Quantity("s", at_least=0)] = Field(
        default=0.0, description="time constant of the filter of the measurements"
    )
    sample: Annotated[float, Quantity("s", at_least=0)] = Field(
        default=0.0, description="interval of the measurements, held in between; 0: continuous"
    )

    @model_validator(mode="after")
    def _set_points(self) -> AutodrillerBlock:
        if not self.mode:
            raise refuse("mode", got="an empty list", want=f"one or several of {', '.join(MODES)}")
        if len(set(self.mode)) < len(self.mode):
            raise refuse("mode", got=", ".join(self.mode), want="each mode once")
        for key in MODES:
            given = getattr(self, key) is not None
            if given != (key in self.mode):
                want = (
                    f"a set point {key}, which mode {key} needs"
                    if not given
                    else f"no {key} without mode {key}"
                )
                raise refuse(key, want=want)
            set_point = getattr(self, key)
            if set_point is not None and (least := _least(set_point)) < 0:
                hint = "reverse: true lets the drum hoist if another mode requires it" if key == "rop" else ""
                raise refuse(key, got=f"{least:g}, in SI units", want="a set point of 0 or more", hint=hint)
        for key, mode in self.mode_of_key.items():
            if key in self.model_fields_set and mode not in self.mode:
                others = [m for m in self.mode if m in _GAINS and key in ("p", "i")]
                hint = ", ".join(f"mode {m} has {_GAINS[m]}_{key}" for m in others)
                raise refuse(key, got=getattr(self, key), want=f"no {key} without mode {mode}", hint=hint)
        return self
