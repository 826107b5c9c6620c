"""`rig`: limits of the rig, and the weight of its block."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from drillpetsc.case.block import Block
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import Quantity, said
from drillpetsc.units import UnitError, to_si

STANDARD_GRAVITY = 9.80665  # [m/s2], ISO 80000-3


@dataclass(frozen=True)
class Weight(Quantity):
    """A weight [N]; a text with a unit of mass is times standard gravity, as `60 klb` is meant."""

    def read(self, value: object, *at: str | int) -> float:
        if isinstance(value, str):
            try:
                to_si(value, self.unit)
            except UnitError:
                try:
                    value = to_si(value, "kg") * STANDARD_GRAVITY
                except UnitError:
                    pass  # the message names a force
        return super().read(value, *at)


class HookloadSensor(Block):
    """Place of the hook-load sensor, and the sheaves between it and the hook."""

    at: Literal["hook", "dead_line"] = Field(
        default="hook", description="at the hook, or in the dead line, whose force times the lines is read"
    )
    lines: Annotated[int, Field(ge=2, le=20)] | None = Field(
        default=None, description="lines strung between crown and travelling block"
    )
    sheave_efficiency: Annotated[float, Quantity("", at_least=0.8, at_most=1)] | None = Field(
        default=None,
        description="force of the line behind a turning sheave over the force before it, 0.98 for roller bearings",
    )
    dead_sheave: Literal["still", "turning"] = Field(
        default="still", description="whether the sheave of the dead line turns"
    )

    @model_validator(mode="after")
    def _lines_of_a_dead_line(self) -> HookloadSensor:
        for key in ("lines", "sheave_efficiency"):
            if (getattr(self, key) is None) == (self.at == "dead_line"):
                want = (
                    "this key with at: dead_line" if self.at == "dead_line" else "no such key with at: hook"
                )
                raise refuse(key, got=getattr(self, key), want=want)
        return self


class WobZero(Block):
    """Where the indicator of the weight on bit was set to zero, off bottom."""

    bit_depth: Annotated[float, Quantity("m", above=0, at_most=50e3)] = Field(
        description="measured depth of the bit at zeroing"
    )
    flow_rate: Annotated[float, Quantity("m^3/s", at_least=0, at_most=1)] = Field(
        default=0.0, description="flow rate of the pump at zeroing"
    )


def _zero(value: Any) -> Any:
    """None for off_bottom: zeroed before each reading."""
    return None if value == "off_bottom" else value


class Rig(Block):
    """The rig: weight on the hook in addition to the string, and the limits of the rig."""

    datum: str = Field(
        default="", description="point that measured depths count from, such as RKB; shown in reports"
    )
    elevation: Annotated[float, Quantity("m", at_least=-1000, at_most=10e3)] | None = Field(
        default=None, description="height of the datum above elevation_ref, for depths of reports below it"
    )
    elevation_ref: str | None = Field(
        default=None, description="what elevation counts from; default MSL, mean sea level"
    )
    block_weight: Annotated[float, Weight("N", at_least=0, at_most=1e8)] | None = Field(
        default=None,
        description="weight of block and top drive, a force or a mass; hook_load_total is reported with it",
    )
    hookload_sensor: HookloadSensor | None = Field(
        default=None, description="where the hook load is read; at the hook when not given"
    )
    wob_zero: Annotated[
        WobZero | None, BeforeValidator(_zero, json_schema_input_type=Literal["off_bottom"] | WobZero)
    ] = Field(
        default=None,
        description="zero of the weights on bit of measured points: off_bottom (default), zeroed before each reading, or the depth and flow rate "
        "of one zeroing, {bit_depth: 1935 m, flow_rate: 3517 l/min}",
    )
    running_drag: bool = Field(
        default=False,
        strict=True,
        description="true: mud that a running or pulled string displaces drags it, in roadmaps and beside measured points",
    )
    max_hookload: Annotated[float, Weight("N", above=0, at_most=1e9)] | None = Field(
        default=None, description="largest total hook load, with the block"
    )
    max_surface_torque: Annotated[float, Quantity("N m", above=0, at_most=1e7)] | None = Field(
        default=None, description="largest torque of the drive"
    )
    max_spp: Annotated[float, Quantity("Pa", above=0, at_most=1e10, kind="pressure")] | None = Field(
        default=None, description="largest standpipe pressure"
    )

    @model_validator(mode="after")
    def _block_below_limit(self) -> Rig:
        if self.max_hookload is not None and (self.block_weight or 0.0) >= self.max_hookload:
            want = f"above the weight of the block, {said(self.block_weight or 0.0, 'force')}"
            raise refuse("max_hookload", got=self.max_hookload, want=want)
        if self.elevation_ref is not None and self.elevation is None:
            raise refuse("elevation", want=f"the height of the datum above {self.elevation_ref}")
        return self
