"""`agitator`: a telescoping tool that pulses of the mud shake."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from drillpetsc.case.block import Block
from drillpetsc.case.blocks.items.joints import Joint
from drillpetsc.case.blocks.items.tools import SealedTool
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import OverTime, Quantity
from drillpetsc.time_function import Constant, TimeFunction


class AgitatorSection(Block):
    """Valve, piston and spring of an agitator."""

    rev_per_volume: Annotated[float, Quantity("rad/m^3", above=0, at_most=1e6, kind="none")] = Field(
        description="turns of the rotor, a pulse each, per volume of mud, `0.5 rev/l`"
    )
    pressure_amplitude: Annotated[float, Quantity("Pa", at_least=0, at_most=1e9, kind="pressure")] = Field(
        description="amplitude of the pressure of a pulse"
    )
    piston_area: Annotated[float, Quantity("m^2", above=0, at_most=1)] = Field(
        description="area on which the pulses push the halves apart"
    )
    spring: Annotated[float, Quantity("N/m", above=0)] = Field(
        description="stiffness of the spring between the halves"
    )
    damping: Annotated[float, Quantity("N s/m", at_least=0)] = Field(
        default=0.0, description="force over the speed at which the halves telescope"
    )
    pulse: Literal["sine", "square"] = Field(default="sine", description="form of the pulses")
    flow_rate: Annotated[TimeFunction, OverTime("m^3/s")] | None = Field(
        default=None,
        description="flow rate over time of a case without fluid; 0 when not given, which leaves a shock sub",
    )

    @model_validator(mode="after")
    def _flows_down(self) -> AgitatorSection:
        if isinstance(self.flow_rate, Constant) and self.flow_rate.constant < 0:
            raise refuse("flow_rate", got=self.flow_rate.constant, want="at least 0 m^3/s")
        return self


class AgitatorTool(SealedTool):
    """An agitator: a valve in the mud shakes the string along its axis."""

    kind: Literal["agitator"] = Field(description="agitator (axial oscillation tool)")
    agitator: AgitatorSection = Field(description="valve, piston and spring")

    def joint(self, top: float) -> Joint:
        return Joint.model_construct(
            kind="slider",
            at=top + self.joint_at,
            spring=self.agitator.spring,
            damping=self.agitator.damping,
            stop_stiffness=self.stop_stiffness,
            seal_area=self.seal_area,
        )
