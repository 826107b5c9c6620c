"""`pdm`: a positive displacement motor as an item of the string."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, model_validator

from drillpetsc.case.block import Block, derived_default
from drillpetsc.case.blocks.items.joints import Joint
from drillpetsc.case.blocks.items.string import ToolTube
from drillpetsc.case.files.quantity_file import QuantityColumn, QuantityFile
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import OverTime, Quantity, said
from drillpetsc.time_function import Constant, TimeFunction

_Flow = Annotated[float, Quantity("m^3/s", above=0, at_most=10)]
_Pressure = Annotated[float, Quantity("Pa", at_least=0, at_most=1e9, kind="pressure")]
_Torque = Annotated[float, Quantity("N m", at_least=0, at_most=1e7)]
_Speed = Annotated[float, Quantity("rad/s", at_least=0, at_most=1e3)]
STANDING = 0.02  # share of the free speed below which the last measured point counts as stalled
END_CLEARANCE = 1e-3  # least distance of the motor's joint from the ends of the item [m]


class MotorCurve(Block):
    """Measured points of a motor: one value of each list a point."""

    flow_rate: tuple[_Flow, ...] = Field(
        description="flow rate; points with the same one are a curve of rising torque"
    )
    differential_pressure: tuple[_Pressure, ...] = Field(description="pressure that the mud loses")
    torque: tuple[_Torque, ...] = Field(description="torque of the motor; the first of a curve is 0")
    speed: tuple[_Speed, ...] = Field(
        description="speed of the rotor in the stator, not rising along a curve"
    )

    @model_validator(mode="after")
    def _rows(self) -> MotorCurve:
        count = len(self.flow_rate)
        for key in ("differential_pressure", "torque", "speed"):
            if len(getattr(self, key)) != count:
                raise refuse(
                    key, got=f"{len(getattr(self, key))} values", want=f"{count}, one for each flow_rate"
                )
        for flow in self.flows:
            rows = self.rows_at(flow)
            name = f"the curve at {flow * 6e4:g} l/min"
            if len(rows) < 2:
                raise refuse("flow_rate", got=flow, want=f"two points or more in {name}")
            if self.torque[rows[0]] != 0:
                raise refuse(
                    "torque", rows[0], got=self.torque[rows[0]], want=f"a point at torque 0 in {name}"
                )
            if not self.speed[rows[0]] > 0:
                raise refuse("speed", rows[0], got=self.speed[rows[0]], want="a speed above 0 without torque")
            for a, b in zip(rows, rows[1:], strict=False):
                if not self.torque[b] > self.torque[a]:
                    raise refuse("torque", b, got=self.torque[b], want=f"each torque once in {name}")
                if self.speed[b] > self.speed[a]:
                    want = (
                        f"at most {self.speed[a]:g} rad/s: the speed does not rise with the torque in {name}"
                    )
                    raise refuse("speed", b, got=self.speed[b], want=want)
                if self.differential_pressure[b] < self.differential_pressure[a]:
                    want = f"at least {said(self.differential_pressure[a], 'pressure')}: the pressure does not fall with the torque in {name}"
                    raise refuse("differential_pressure", b, got=self.differential_pressure[b], want=want)
        return self

    @property
    def flows(self) -> tuple[float, ...]:
        """The flow rates, rising [m3/s]."""
        return tuple(sorted(set(self.flow_rate)))

    def rows_at(self, flow: float) -> list[int]:
        """Numbers of the points at a flow rate, by rising torque."""
        return sorted(
            (i for i, q in enumerate(self.flow_rate) if q == flow), key=lambda i: (self.torque[i], i)
        )


#: measured performance of a motor; a column `rpm` needs no unit
MOTOR_FILE = QuantityFile(
    {
        "flow_rate": QuantityColumn("m^3/s", ("flow", "flowrate", "q"), {}),
        "differential_pressure": QuantityColumn(
            "Pa", ("differentialpressure", "pressure", "dp", "diffpressure"), {}
        ),
        "torque": QuantityColumn("N m", ("torque",), {}),
        "speed": QuantityColumn("rad/s", ("speed", "rpm"), {"rpm": "rpm"}),
    },
    "flow [gpm], differential_pressure [psi], torque [ft lbf], speed [rpm]",
    "{flow_rate: [...], differential_pressure: [...], torque: [...], speed: [...]}",
)


#: keys of the law that a measured curve replaces
_OF_LAW = ("rev_per_volume", "efficiency", "no_load_pressure", "droop")


class MotorSection(Block):
    """Power section of a positive displacement motor: law, rotor and flow."""

    rev_per_volume: Annotated[float, Quantity("rad/m^3", above=0, at_most=1e6, kind="none")] | None = Field(
        default=None, description="turns of the rotor per volume of mud, `0.29 rev/gal`"
    )
    efficiency: Annotated[float, Quantity("", above=0, at_most=1)] = Field(
        default=0.85, description="torque over the torque of a motor that turns all its pressure into torque"
    )
    no_load_pressure: _Pressure = Field(
        default=0.0, description="differential pressure of the motor without torque"
    )
    stall_torque: Annotated[float, Quantity("N m", above=0, at_most=1e7)] | None = Field(
        default=None, description="torque at which the rotor stops and all mud leaks past it"
    )
    droop: Annotated[float, Quantity("", at_least=1, at_most=20)] = Field(
        default=4.0,
        description="exponent of the loss of speed: speed over free speed is 1 - (torque/stall_torque)^droop",
    )
    curve: Annotated[
        MotorCurve | None, BeforeValidator(MOTOR_FILE.read_if_named, json_schema_input_type=str | MotorCurve)
    ] = Field(
        default=None,
        description="measured performance instead of a law: the name of a CSV file with the columns flow, differential_pressure, "
        "torque and speed, each with its unit in brackets; curves that end before the rotor stops are extended to stall_torque",
    )
    lobes: tuple[int, ...] | None = Field(
        default=None, description="lobes of rotor and stator, `[7, 8]`; needed with an eccentricity"
    )
    rotor_mass: Annotated[float, Quantity("kg", at_least=0, at_most=1e5)] = Field(
        default=0.0, description="mass of the rotor, a part of the item's mass"
    )
    eccentricity: Annotated[float, Quantity("m", at_least=0, at_most=0.2, kind="diameter")] = Field(
        default=0.0, description="radius of the rotor's orbit in the stator"
    )
    rotor_inertia: Annotated[float, Quantity("kg m^2", at_least=0, at_most=1e4)] = Field(
        default=0.0, description="moment of inertia of rotor and drive shaft about their axis"
    )
    bypass: Annotated[float, Quantity("m^3/s", at_least=0, at_most=10)] = Field(
        default=0.0, description="flow rate through the nozzle of the rotor, which gives no torque"
    )
    flow_rate: Annotated[TimeFunction, OverTime("m^3/s")] | None = Field(
        default=None,
        description="flow rate over time if the case has no fluid; otherwise the flow in the bore turns the motor",
    )
    seal_diameter: Annotated[float, Quantity("m", at_least=0, at_most=2, kind="diameter")] | None = Field(
        default=None,
        description="diameter on which the differential pressure pushes the rotor down; the item's bore when not given",
    )

    @model_validator(mode="after")
    def _law_or_curve(self) -> MotorSection:
        if self.curve is None:
            for key in ("rev_per_volume", "stall_torque"):
                if getattr(self, key) is None:
                    raise refuse(key, want=f"a {key}, or a curve of the motor")
        else:
            for key in _OF_LAW:
                if getattr(self, key) != type(self).model_fields[key].default:
                    raise refuse(key, got=getattr(self, key), want=f"{key} or a curve, not both")
            for flow in self.curve.flows:
                rows = self.curve.rows_at(flow)
                last = rows[-1]
                stands = self.curve.speed[last] <= STANDING * self.curve.speed[rows[0]]
                if stands:
                    continue
                if self.stall_torque is None:
                    want = f"a stall_torque: the curve at {flow * 6e4:g} l/min ends at {self.curve.speed[last]:.3g} rad/s"
                    raise refuse("stall_torque", want=want)
                if not self.stall_torque > self.curve.torque[last]:
                    want = f"more than the last torque of the curve at {said(flow, 'flow')}, {said(self.curve.torque[last], 'torque')}"
                    raise refuse("stall_torque", got=self.stall_torque, want=want)
        if self.lobes is not None and not (
            len(self.lobes) == 2 and self.lobes[0] >= 1 and self.lobes[1] == self.lobes[0] + 1
        ):
            raise refuse(
                "lobes",
                got=list(self.lobes),
                want="[lobes of the rotor, lobes of the stator], one more in the stator",
            )
        if self.eccentricity > 0 and self.lobes is None:
            raise refuse("lobes", want="the lobes of rotor and stator, [7, 8], together with an eccentricity")
        constant = self.flow_rate.constant if isinstance(self.flow_rate, Constant) else None
        if constant is not None and constant < 0:
            raise refuse("flow_rate", got=constant, want="at least 0 m^3/s: a motor turns in one direction")
        return self


class PositiveDisplacementMotor(ToolTube):
    """A downhole motor: its housing is pipe of the string, its rotor turns what hangs below its joint."""

    kind: Literal["pdm"] = Field(description="positive displacement motor (mud motor)")
    pdm: MotorSection = Field(description="power section: law of the motor, its rotor, its flow")
    mass: Annotated[float, Quantity("kg", above=0)] | None = Field(
        default=None,
        description="mass of the whole item; when not given, the mass of a tube with this od, id and density",
    )
    joint_at: Annotated[float, Quantity("m", above=0, at_most=50e3)] = derived_default(
        "start of the rotating part below the item's upper end; half the length, or half-way "
        "between a bend and the lower end, when not given"
    )

    @model_validator(mode="after")
    def _joint_inside(self) -> PositiveDisplacementMotor:
        bend = None
        if self.bend is not None and self.bend.angle:  # distance below the upper end
            bend = 0.0 if self.bend.position is None else self.length - self.bend.position
        if self.joint_at is None:
            self.fill_defaults(joint_at=0.5 * (self.length + (bend or 0.0)))
        if not END_CLEARANCE <= self.joint_at <= self.length - END_CLEARANCE:
            want = f"between {said(END_CLEARANCE, 'length')} and {said(self.length - END_CLEARANCE, 'length')}: pipe of the item above and below it"
            raise refuse("joint_at", got=self.joint_at, want=want)
        if bend is not None and self.joint_at - bend < END_CLEARANCE:
            raise refuse(
                "joint_at",
                got=self.joint_at,
                want=f"more than {said(bend, 'length')}, below the bend: the housing bends, and what is below the joint turns with the bit",
            )
        return self

    def joint(self, top: float) -> Joint:
        """The joint of the motor, whose upper end is at measured depth ``top`` [m]."""
        return Joint.model_construct(kind="revolute", at=top + self.joint_at, axis=(1.0, 0.0, 0.0))

    @property
    def seal_area(self) -> float:
        """Area on which the differential pressure pushes the rotor down [m2]."""
        diameter = self.id if self.pdm.seal_diameter is None else self.pdm.seal_diameter
        return math.pi / 4 * diameter**2
