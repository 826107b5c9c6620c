"""`output.sensors` and `output.indices`: downhole sensors, and indices of drilling dynamics."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, field_validator, model_validator

from drillpetsc.case.block import Block
from drillpetsc.case.blocks.items.string import Angle
from drillpetsc.case.blocks.rig import STANDARD_GRAVITY
from drillpetsc.case.key_paths import refuse, suggestion
from drillpetsc.case.quantities import InSI, Quantity, as_list
from drillpetsc.units import UnitError, to_si

CHANNELS = ("ax", "ay", "az", "rpm", "torque", "wob", "bending", "pressure")
ACCELERATIONS = ("ax", "ay", "az")
STEPS_PER_PERIOD = 4.0  # a step resolves frequencies up to one over so many steps


@dataclass(frozen=True)
class InGravities(Quantity):
    """An acceleration [m/s2]; `100 g` is a multiple of standard gravity."""

    def read(self, value: object, *at: str | int) -> float:
        found = re.fullmatch(r"\s*([-+.\deE]+)\s*(?:g|gn|g0)\s*", value) if isinstance(value, str) else None
        if found:
            try:
                value = InSI(float(found.group(1)) * STANDARD_GRAVITY)
            except ValueError:
                pass  # the message shows the text
        return super().read(value, *at)


@dataclass(frozen=True)
class DepthOrItem(Quantity):
    """A measured depth [m], or the name of an item of the string."""

    def read(self, value: object, *at: str | int) -> Any:
        if isinstance(value, str):
            try:
                to_si(value, self.unit)
            except UnitError:
                if value.strip():
                    return value
        return super().read(value, *at)


class SensorFilter(Block):
    """Low-pass filter before the samples are taken."""

    kind: Literal["butterworth"] = Field(default="butterworth", description="family of the filter")
    order: Annotated[int, Field(strict=True, ge=1, le=10)] = Field(default=2, description="number of poles")
    cutoff: Annotated[float, Quantity("1/s", above=0, at_most=1e6, kind="frequency")] = Field(
        description="frequency at which the gain is 1/sqrt(2), in Hz; below half the rate"
    )


def _channels(value: Any) -> Any:
    """Channels as a list; one word is a list of one."""
    value = [value] if isinstance(value, str) else as_list(value)
    for i, channel in enumerate(value if isinstance(value, (list, tuple)) else ()):
        if channel == "temperature":
            raise refuse(i, got=channel, want=", ".join(CHANNELS), hint="the model has no temperatures")
        if channel not in CHANNELS:
            raise refuse(i, got=channel, want=", ".join(CHANNELS), hint=suggestion(str(channel), CHANNELS))
        if channel in value[:i]:
            raise refuse(i, got=channel, want="each channel once")
    return value


Channel = Literal["ax", "ay", "az", "rpm", "torque", "wob", "bending", "pressure"]


class Sensor(Block):
    """A downhole sensor: channels at one place of the string, sampled at a given rate."""

    name: str = Field(description="name of its file, such as mwd; letters, digits, - and _")
    at: Annotated[float | str, DepthOrItem("m", at_least=0, at_most=50e3)] = Field(
        description="measured depth, or the name of a string item, in whose middle it is"
    )
    rate: Annotated[float, Quantity("1/s", above=0, at_most=1e6, kind="frequency")] = Field(
        description="samples in a second, in Hz"
    )
    channels: Annotated[tuple[Channel, ...], BeforeValidator(_channels)] = Field(
        default=("ax", "ay", "az", "rpm"),
        min_length=1,
        description="ax, ay, az: acceleration along the string, towards `angle` and to its right; rpm: rotation, true "
        "and by a magnetometer; torque, wob, bending: loads of the section; pressure: of the mud",
    )
    radius: Annotated[float, Quantity("m", at_least=0, at_most=1, kind="diameter")] = Field(
        default=0.0, description="distance of the accelerometers from the axis"
    )
    angle: Angle = Field(
        default=0.0, description="direction of the accelerometers in the section, clockwise looking down"
    )
    gravity: bool = Field(
        default=True,
        strict=True,
        description="true: accelerations less gravity, as a real accelerometer; false: of the motion alone",
    )
    filter: SensorFilter | None = Field(
        default=None, description="anti-alias filter; without it the motion is sampled unfiltered"
    )
    range: Annotated[float, InGravities("m/s^2", above=0)] | None = Field(
        default=None, description="largest acceleration that the accelerometers show, such as 100 g"
    )
    magnetic_dip: Annotated[float, Quantity("rad", at_least=-1.5708, at_most=1.5708)] = Field(
        default=1.0472,
        description="dip of the magnetic field of the magnetometer below the horizontal; its declination is 0",
    )

    @field_validator("name")
    @classmethod
    def _file_name(cls, value: str) -> str:
        if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_-]{0,63}", value):
            raise refuse(got=value, want="a name of letters, digits, - and _")
        if value.lower() in ("history", "probes"):
            raise refuse(got=value, want="another name: plots take this for the table of the run")
        return value

    @model_validator(mode="after")
    def _filter_below_nyquist(self) -> Sensor:
        if self.filter is not None and self.filter.cutoff >= 0.5 * self.rate:
            raise refuse(
                "filter",
                "cutoff",
                got=f"{self.filter.cutoff:g} Hz",
                want=f"below {0.5 * self.rate:g} Hz, half the rate",
                hint="frequencies above half the rate are folded to lower ones; raise the rate, or lower the cutoff",
            )
        return self

    @property
    def accelerations(self) -> tuple[str, ...]:
        """The channels of its accelerometers."""
        return tuple(c for c in self.channels if c in ACCELERATIONS)

    @property
    def finest(self) -> float:
        """Highest frequency that its samples show [Hz]: the cutoff of its filter, or half the rate."""
        return self.filter.cutoff if self.filter is not None else 0.5 * self.rate


class Indices(Block):
    """Indices of drilling dynamics in windows of time."""

    window: Annotated[float, Quantity("s", above=0)] = Field(default=20.0, description="length of a window")
    every: Annotated[float, Quantity("s", above=0)] = Field(
        default=1.0, description="time between the ends of two successive windows"
    )

    @property
    def span(self) -> tuple[float, float]:
        """Length of a window and time between two [s]."""
        return self.window, self.every


def sensor_depth(string: Any, item_depths: Any, sensor: Sensor) -> float | None:
    """Measured depth [m] of a sensor; None if no item, or several items, have its name."""
    if not isinstance(sensor.at, str):
        return float(sensor.at)
    found = [
        depths
        for item, depths in zip(string, item_depths, strict=True)
        if getattr(item, "name", "") == sensor.at
    ]
    return 0.5 * sum(found[0]) if len(found) == 1 else None


def indices_or_true(value: Any) -> Any:
    """True as a block of defaults, false as none."""
    return {} if value is True else None if value is False else value


def as_sensors(value: Any) -> Any:
    """A single sensor as a list."""
    return [value] if isinstance(value, Mapping) else as_list(value)
