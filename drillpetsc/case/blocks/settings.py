"""`beam`, `initial`, `time` and `output`: formulation, initial state, simulated time and output."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, field_validator, model_validator

from drillpetsc.case.block import Block, derived_default
from drillpetsc.case.blocks.items.string import Angle
from drillpetsc.case.blocks.sensors import Indices, Sensor, as_sensors, indices_or_true
from drillpetsc.case.files.named_file import find_file
from drillpetsc.case.key_paths import refuse, suggestion
from drillpetsc.case.quantities import Quantity, as_list, said
from drillpetsc.unit_systems import System

STARTS = ("statics", "rest", "straight")


class BeamTheory(Block):
    """Unknowns of the string."""

    formulation: Literal["ancf", "quaternion"] = Field(
        default="ancf",
        description="ancf: position, slope and spin angle at each node; quaternion: strain and Euler parameters, the element of "
        "the reference formulation (DOI 10.1177/1687814016656703)",
    )
    constraint: Literal["index3", "index2", "stabilized"] | None = Field(
        default=None,
        description="constraints of the quaternion element: index3 (when not given): on positions; index2: on velocities, positions "
        "drift; stabilized: on velocities, positions restored after each step",
    )

    @model_validator(mode="after")
    def _constraint_of_quaternion(self) -> BeamTheory:
        if self.formulation == "ancf" and self.constraint is not None:
            raise refuse(
                "constraint", got=self.constraint, want="no constraint unless formulation is quaternion"
            )
        if self.formulation == "quaternion" and self.constraint is None:
            self.fill_defaults(constraint="index3")
        return self


class MeshSettings(Block):
    """Elements of automatic length; items that name their `element_length` are not concerned."""

    refinement: Annotated[float, Quantity("", at_least=1e-3, at_most=1e3)] = Field(
        default=1.0, description="automatic elements are shorter by this factor; 2 halves them"
    )
    frequency: Annotated[float, Quantity("1/s", above=0, at_most=1e4)] | None = Field(
        default=None,
        description="highest frequency of interest: automatic elements resolve bending, torsional and axial waves up to it. When "
        "not given: bending waves at the rotation speed of a run with inertia",
    )


class Initial(Block):
    """The state at time 0."""

    from_: str = Field(
        default="statics",
        alias="from",
        description="statics: the static equilibrium; rest: along the hole's axis, without strain from loads; "
        "straight: straight and without strain; or a run folder, whose end is the start; time begins at 0",
    )
    wob: Annotated[float, Quantity("N", at_least=0)] | None = Field(
        default=None, description="weight on bit that the static start meets by the top's axial position"
    )
    inclination: Angle = Field(default=0.0, description="inclination of a string without a well")
    azimuth: Angle = Field(default=0.0, description="azimuth of a string without a well")
    imperfection: Annotated[float, Quantity("", at_least=0, at_most=1)] = Field(
        default=1e-3,
        description="lateral load as a fraction of the weight, so that the string leaves an unstable equilibrium; a start from "
        "rest or straight has none unless it is given",
    )

    @field_validator("from_", mode="before")
    @classmethod
    def _start(cls, value: Any) -> Any:
        if value in STARTS:
            return value
        want = f"{', '.join(STARTS)}, or a run folder that exists"
        if not isinstance(value, (str, Path)) or not str(value).strip():
            raise refuse(got=value, want=want)
        folder = find_file(value, os.path.isdir)
        if folder is None:
            raise refuse(got=value, want=want, hint=suggestion(value, STARTS))
        if not (folder / "checkpoint.h5").is_file():
            raise refuse(got=value, want="a run folder that holds a checkpoint.h5")
        return str(folder.resolve())

    @model_validator(mode="after")
    def _wob_needs_statics(self) -> Initial:
        if self.wob is not None and self.from_ != "statics":
            raise refuse("wob", got=self.wob, want="no wob unless initial.from is statics, which sets it")
        return self


class Time(Block):
    """Simulated time, with or without inertia."""

    end: Annotated[float, Quantity("s", above=0)] = Field(description="simulated time")
    mode: Literal["dynamic", "quasi_static"] = Field(
        default="dynamic",
        description="dynamic: with inertia; quasi_static: string and fluid in equilibrium at every moment, while the hole grows",
    )
    step: Annotated[float, Quantity("s", above=0)] | None = Field(
        default=None,
        description="first and largest step of a quasi-static run; the solver's choice when not given",
    )

    integrator: Literal["auto", "bdf", "generalized_alpha"] = Field(
        default="auto",
        description="bdf: backward differences; generalized_alpha: keeps the energy of vibrations that the steps resolve; auto: "
        "generalized_alpha if the string may turn in a hole, with steps short enough to resolve whirl, else bdf",
    )
    spectral_radius: Annotated[float, Quantity("", at_least=0, at_most=1)] | None = Field(
        default=None,
        description="of generalized_alpha: 1 keeps fast vibrations, 0 damps them within one step; when not given 0.8, and 0.5 with the bit law velocity_weakening",
    )

    @model_validator(mode="after")
    def _integrator(self) -> Time:
        alpha = self.integrator == "generalized_alpha"
        if alpha and self.mode == "quasi_static":
            hint = "a string without inertia has no accelerations to average"
            raise refuse(
                "integrator", got=self.integrator, want="bdf or auto with mode: quasi_static", hint=hint
            )
        if self.spectral_radius is not None and not alpha:
            want = "no spectral_radius without integrator: generalized_alpha"
            raise refuse("spectral_radius", got=self.spectral_radius, want=want)
        return self

    @model_validator(mode="after")
    def _step_of_a_quasi_static_run(self) -> Time:
        if self.step is not None and self.mode == "dynamic":
            hint = "with inertia the accuracy chooses the steps; see ts_dt, ts_rtol and ts_adapt_dt_max of the petsc block"
            raise refuse("step", got=self.step, want="no step unless mode is quasi_static", hint=hint)
        return self


Interval = Annotated[float, Quantity("s", above=0)]


class Output(Block):
    """Contents of the run folder. Intervals are simulated time."""

    history_every: Interval = derived_default(
        "interval of history.csv and probes.csv; end/1000, between 1 ms and 0.1 s (quasi_static: without limit), when not given"
    )
    field_every: Interval = derived_default(
        "interval of the snapshots of the string; end/100, not below history_every, when not given"
    )
    probes: Annotated[tuple[Annotated[float, Quantity("m", at_least=0)], ...], BeforeValidator(as_list)] = (
        Field(
            default=(),
            description="measured depths along the string, each with columns in probes.csv",
        )
    )
    item_forces: bool = Field(
        default=False,
        strict=True,
        description="true: side force, its components, couple and contact force sum of every rigid item are written to history.csv",
    )
    sensors: Annotated[
        tuple[Sensor, ...], BeforeValidator(as_sensors, json_schema_input_type=Sensor | tuple[Sensor, ...])
    ] = Field(default=(), description="downhole sensors, each with a file in the folder sensors")
    indices: Annotated[
        Indices | None, BeforeValidator(indices_or_true, json_schema_input_type=bool | Indices)
    ] = Field(
        default=None,
        description="indices of drilling dynamics in indices.csv and in the summary: stick-slip, vibration, energy, whirl; "
        "true for the defaults",
    )
    checkpoint_every: Interval = derived_default("interval of checkpoint.h5; end/10 when not given")
    units: System | None = Field(
        default=None,
        description="units of printed and plotted figures (files stay in SI); the case's units when not given",
    )

    @model_validator(mode="after")
    def _distinct_names(self) -> Output:
        names = [f"{probe:g}" for probe in self.probes]
        for i, name in enumerate(names):
            if name in names[:i]:
                raise refuse(
                    "probes",
                    i,
                    got=self.probes[i],
                    want=f"probes at different depths; {said(self.probes[i], 'length')} appears twice",
                )
        names = [sensor.name.lower() for sensor in self.sensors]
        for i, name in enumerate(names):
            if name in names[:i]:
                raise refuse(
                    "sensors", i, "name", got=self.sensors[i].name, want="another name for each sensor"
                )
        return self

    def with_intervals(self, end: float, dynamic: bool = True) -> Output:
        """This block with its intervals filled in.

        end: simulated time [s]
        dynamic: history_every is short enough to resolve vibrations
        """
        history = self.history_every or (min(max(end / 1000, 1e-3), 0.1, end) if dynamic else end / 1000)
        return self.model_copy(
            update={
                "history_every": history,
                "field_every": self.field_every or max(end / 100, history),
                "checkpoint_every": self.checkpoint_every or end / 10,
            }
        )
