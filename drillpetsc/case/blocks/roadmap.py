"""`roadmap`: operations, bit depths and friction factors of a torque-and-drag roadmap; measured points."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from drillpetsc.case.block import Block
from drillpetsc.case.files.measured_file import OPERATIONS, operation_word, read_measured
from drillpetsc.case.key_paths import refuse, suggestion
from drillpetsc.case.quantities import Quantity, as_list, one_as_list
from drillpetsc.units import to_si

Operation = Literal["trip_in", "trip_out", "rotate_off_bottom", "drilling", "sliding", "backreaming"]
ROTATION = Quantity("rad/s", at_least=0, at_most=50)  # 50 rad/s are 477 rpm: a bare 100 in SI is a mistake
Depth = Annotated[float, Quantity("m", above=0, at_most=50e3)]
Weight = Annotated[float, Quantity("N", at_least=0, at_most=1e7)]
Torque = Annotated[float, Quantity("N m", at_least=0, at_most=1e6)]
Speed = Annotated[float, Quantity("m/s", at_least=0, at_most=10, kind="trip_speed")]
Rop = Annotated[float, Quantity("m/s", at_least=0, at_most=1, kind="rop")]
Flow = Annotated[float, Quantity("m^3/s", at_least=0, at_most=1)]
Rotation = Annotated[float, ROTATION]
PumpFlow = Annotated[
    Flow | None,
    Field(
        description="flow rate of the pump, which drags and lifts the string; 0: the mud is at rest; fluid.flow_rate at time 0 when not given"
    ),
]


def _operation(value: Any) -> Any:
    word = operation_word(value) if isinstance(value, str) else None
    if word is None:
        hint = suggestion(value, OPERATIONS)
        raise refuse(got=value, want=f"one of {', '.join(OPERATIONS)}", hint=hint)
    return word


Factor = Annotated[float, Quantity("", at_least=0, at_most=2)]
Factors = Annotated[
    tuple[Factor, ...], BeforeValidator(one_as_list, json_schema_input_type=Factor | tuple[Factor, ...])
]
AnyOperation = Annotated[Operation, BeforeValidator(_operation, json_schema_input_type=str)]


class FrictionFactors(Block):
    """Friction factors of cased and open hole, in pairs."""

    cased: Factors | None = Field(
        default=None, description="friction factors of cased hole; the sections' own when not given"
    )
    open_hole: Factors | None = Field(
        default=None, description="friction factors of open hole; the sections' own when not given"
    )
    groups: dict[str, Factors] = Field(
        default={},
        description="friction factors of sections with a ff_group, by its name; the sections' own when not given",
    )
    combine: Literal["pairs", "all"] = Field(
        default="pairs", description="pairs: first with first, second with second; all: every pair"
    )

    @property
    def by_group(self) -> dict[str, tuple[float, ...]]:
        """Factors that are given, by the name of the group."""
        own = {"cased": self.cased, "open_hole": self.open_hole}
        return {name: values for name, values in {**own, **self.groups}.items() if values is not None}

    @model_validator(mode="after")
    def _same_count(self) -> FrictionFactors:
        given = self.by_group
        if not given:
            raise refuse("cased", want="cased, open_hole, groups, or several of them")
        for key, values in given.items():
            if key in self.groups and key in ("cased", "open_hole"):
                raise refuse("groups", key, want=f"the name of a ff_group; {key} is given with groups")
            if values == ():
                path = ("groups", key) if key in self.groups else (key,)
                raise refuse(*path, got="an empty list", want="one friction factor or more")
        counts = {key: len(values) for key, values in given.items() if len(values) > 1}
        if self.combine == "pairs" and len(set(counts.values())) > 1:
            first, second = list(counts)[0], next(k for k in counts if counts[k] != counts[list(counts)[0]])
            path = ("groups", second) if second in self.groups else (second,)
            raise refuse(
                *path,
                got=f"{counts[second]} values",
                want=f"{counts[first]} values, as many as {first}, or one",
                hint="or combine: all",
            )
        return self


class DepthRange(Block):
    """Bit depths from `from` to `to` in equal steps."""

    from_: Annotated[
        Literal["shoe"] | float,
        BeforeValidator(lambda v: _mark(v, "shoe"), json_schema_input_type=str | float),
    ] = Field(alias="from", description="first depth [m], or shoe: the last casing shoe")
    to: Annotated[
        Literal["td"] | float, BeforeValidator(lambda v: _mark(v, "td"), json_schema_input_type=str | float)
    ] = Field(default="td", description="last depth [m], or td: the end of the hole")
    step: Depth = Field(description="distance between depths; the last one may be shorter")


def _mark(value: Any, word: str) -> Any:
    if value == word:
        return value
    return Quantity("m", above=0, at_most=50e3).read(value)


def _depths(value: Any) -> Any:
    value = as_list(value)
    if isinstance(value, (Mapping, DepthRange, list, tuple)):
        return value
    return [value]


def _measured(value: Any) -> Any:
    """Points from the name of a file; other values unchanged."""
    return [p.as_dict() for p in read_measured(value)[0]] if isinstance(value, str) else value


class Drilling(Block):
    """Drilling with rotation."""

    wob: Weight | None = Field(
        default=None, description="weight on bit; initial.wob when not given, else 25 klbf"
    )
    tob: Torque = Field(default=to_si("5 kft-lbf", "N m"), description="torque of the rock on the bit")
    rop: Rop = Field(default=to_si("60 ft/h", "m/s"), description="rate of penetration")
    flow_rate: PumpFlow = None


class Sliding(Block):
    """Drilling without rotation of the string."""

    wob: Weight | None = Field(
        default=None, description="weight on bit; initial.wob when not given, else 15 klbf"
    )
    tob: Torque = Field(default=to_si("2 kft-lbf", "N m"), description="torque of the rock on the bit")
    flow_rate: PumpFlow = None


class Backreaming(Block):
    """Pulling out with rotation."""

    speed: Speed = Field(default=to_si("20 ft/min", "m/s"), description="upward speed")
    rpm: Rotation = Field(default=to_si("80 rpm", "rad/s"), description="rotation")
    tob: Torque = Field(default=to_si("1 kft-lbf", "N m"), description="torque of the rock on the bit")
    flow_rate: PumpFlow = None


class MeasuredPoint(Block):
    """One reading of the rig."""

    bit_depth: Depth = Field(description="measured depth of the bit")
    operation: AnyOperation = Field(description="what the string did")
    hook_load: Annotated[float, Quantity("N", at_least=-1e8, at_most=1e8)] | None = Field(
        default=None, description="hook load as read"
    )
    torque: Annotated[float, Quantity("N m", at_least=0, at_most=1e7)] | None = Field(
        default=None, description="surface torque as read"
    )
    wob: Weight | None = Field(default=None, description="weight on bit, instead of the operation's")
    tob: Torque | None = Field(default=None, description="torque on bit, instead of the operation's")
    rpm: Rotation | None = Field(default=None, description="rotation, instead of the operation's")
    speed: Speed | None = Field(default=None, description="speed of the block, instead of the operation's")
    flow_rate: Flow | None = Field(
        default=None, description="flow rate of the pump, instead of the operation's (used by calibrate)"
    )
    sigma: Annotated[float, Quantity("N", above=0, at_most=1e8)] | None = Field(
        default=None, description="standard error of the hook load; 2 % and at least 10 kN when not given"
    )

    @model_validator(mode="after")
    def _something_read(self) -> MeasuredPoint:
        if self.hook_load is None and self.torque is None:
            raise refuse("hook_load", want="a hook_load or a torque")
        return self


class Roadmap(Block):
    """A torque-and-drag roadmap: what `drillpetsc roadmap` computes."""

    operations: tuple[AnyOperation, ...] = Field(
        default=("trip_in", "trip_out", "rotate_off_bottom", "drilling", "sliding", "backreaming"),
        min_length=1,
        description="operations, each once; slackoff, pickup and rob are also accepted",
    )
    bit_depth: Annotated[
        tuple[Depth, ...] | DepthRange | None,
        BeforeValidator(_depths, json_schema_input_type=Depth | tuple[Depth, ...] | DepthRange),
    ] = Field(
        default=None,
        description="measured depths of the bit, or {from, to, step}; by default 30 depths from 10 % of the hole to its end, and "
        "the casing shoes",
    )
    friction_factor: FrictionFactors | None = Field(
        default=None, description="friction factors; 0.75, 1 and 1.25 times the sections' own when not given"
    )
    trip_speed: Speed = Field(default=to_si("60 ft/min", "m/s"), description="speed of tripping in and out")
    rpm: Rotation = Field(
        default=to_si("100 rpm", "rad/s"), description="rotation off bottom and while drilling"
    )
    drilling: Drilling = Field(default=Drilling(), description="drilling with rotation")
    sliding: Sliding = Field(default=Sliding(), description="drilling without rotation")
    backreaming: Backreaming = Field(default=Backreaming(), description="pulling out with rotation")
    measured: Annotated[
        tuple[MeasuredPoint, ...] | None,
        BeforeValidator(_measured, json_schema_input_type=str | tuple[MeasuredPoint, ...]),
    ] = Field(default=None, description="measured points, or the name of a file with them: CSV, xlsx or LAS")
    hookload_excludes_block: bool = Field(
        default=False,
        strict=True,
        description="true: measured hook loads do not include the block",
    )

    hole_grows: bool = Field(
        default=False,
        strict=True,
        description="true: the open hole ends at the bit; false: the hole of the case is there below it. Both give the same "
        "rows, since nothing below the bit touches the string or moves its mud",
    )

    @model_validator(mode="after")
    def _each_once(self) -> Roadmap:
        self.fill_defaults(operations=tuple(dict.fromkeys(self.operations)))
        return self
