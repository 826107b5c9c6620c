"""`fluid`: the drilling fluid, its rheology, the pump and the outlet."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Discriminator, Field, Strict, Tag, field_validator, model_validator

from drillpetsc.case.block import Block, derived_default, tagged_union
from drillpetsc.case.key_paths import refuse, suggestion
from drillpetsc.case.quantities import OverTime, Quantity
from drillpetsc.time_function import Constant, TimeFunction

Consistency = Annotated[float, Quantity("Pa s^n", above=0, at_most=1e3)]
Viscosity = Annotated[float, Quantity("Pa s", at_least=0, at_most=1e3)]
PlasticViscosity = Annotated[float, Quantity("Pa s", above=0, at_most=1e3)]
YieldStress = Annotated[float, Quantity("Pa", at_least=0, at_most=1e4)]
FlowIndex = Annotated[float, Quantity("", above=0, at_most=2)]

_STRESS = "shear stress = "


class Rheology(Block):
    """What all rheology models have in common."""

    told_by: ClassVar[str] = "model"

    law: Literal["blend", "api", "exact"] = Field(
        default="blend",
        description="friction in pipe and annulus: blend: one smooth formula from laminar to turbulent flow; "
        "api: API form with Metzner-Reed Reynolds number and straight transition; exact: laminar profile integrated",
    )
    shear_rate: Annotated[float, Quantity("1/s", above=0, at_most=1e3)] = Field(
        default=1.0, description="shear rate [1/s] below which stresses go smoothly to zero with the flow"
    )


class Newtonian(Rheology):
    """Water, oil, brine."""

    model: Literal["newtonian"] = Field(description=_STRESS + "viscosity * shear rate")
    viscosity: Viscosity = Field(description="viscosity [Pa s]; 0 is a fluid without friction")


class PowerLaw(Rheology):
    """Shear thinning (index below 1) or thickening, without a yield stress."""

    model: Literal["power_law"] = Field(description=_STRESS + "consistency * shear rate^index")
    consistency: Consistency = Field(description="consistency [Pa s^n]")
    index: FlowIndex = Field(description="flow index n [-], 1 for a Newtonian fluid")


class WithYieldStress(Rheology):
    """What the models with a yield stress have in common."""

    later_values: ClassVar[dict[str, tuple[str, ...]]] = {
        "law": ("api",)
    }  # its formulas are those of a power law

    law: Literal["blend", "exact"] = Field(
        default="blend",
        description="friction in pipe and annulus: blend: one smooth formula from laminar to turbulent flow; "
        "exact: laminar profile integrated",
    )
    yield_stress: YieldStress = Field(description="yield stress [Pa]")


class Bingham(WithYieldStress):
    """Plastic above a yield stress."""

    model: Literal["bingham"] = Field(description=_STRESS + "yield stress + plastic viscosity * shear rate")
    plastic_viscosity: PlasticViscosity = Field(description="plastic viscosity [Pa s]")


class Casson(WithYieldStress):
    """Plastic above a yield stress, in square roots."""

    model: Literal["casson"] = Field(
        description="sqrt(shear stress) = sqrt(yield stress) + sqrt(plastic viscosity * shear rate)"
    )
    plastic_viscosity: PlasticViscosity = Field(description="plastic viscosity [Pa s]")


class HerschelBulkley(WithYieldStress):
    """A power law above a yield stress."""

    model: Literal["herschel_bulkley"] = Field(
        description=_STRESS + "yield stress + consistency * shear rate^index"
    )
    consistency: Consistency = Field(description="consistency [Pa s^n]")
    index: FlowIndex = Field(description="flow index n [-], 1 for a Bingham fluid")


_rheology, _rheology_tag = tagged_union(Newtonian, Bingham, PowerLaw, Casson, HerschelBulkley, key="model")

AnyRheology = Annotated[
    Annotated[Newtonian, Tag("kind:Newtonian")]
    | Annotated[Bingham, Tag("kind:Bingham")]
    | Annotated[PowerLaw, Tag("kind:PowerLaw")]
    | Annotated[Casson, Tag("kind:Casson")]
    | Annotated[HerschelBulkley, Tag("kind:HerschelBulkley")],
    Discriminator(_rheology_tag),
    BeforeValidator(_rheology),
]


def flow_constants(rheology: Rheology) -> tuple[float, float, float]:
    """(consistency [Pa s^n], index n [-], yield stress [Pa]) of any model, as if it were Herschel-Bulkley's.

    stress = yield stress + consistency * shear rate^n holds for all but casson, whose sqrt(stress) is
    sqrt(yield stress) + sqrt(consistency * shear rate): its plastic viscosity stands as the consistency, with
    n = 1.
    """
    if isinstance(rheology, Newtonian):
        return rheology.viscosity, 1.0, 0.0
    if isinstance(rheology, PowerLaw):
        return rheology.consistency, rheology.index, 0.0
    if isinstance(rheology, HerschelBulkley):
        return rheology.consistency, rheology.index, rheology.yield_stress
    assert isinstance(rheology, (Bingham, Casson))
    return rheology.plastic_viscosity, 1.0, rheology.yield_stress


def _word_or_number(value: Any, words: tuple[str, ...], quantity: Quantity) -> Any:
    """One of the words, or a number in SI; `none` is 0."""
    if value == "none":
        return 0.0
    if isinstance(value, str) and value.strip()[:1].isalpha():
        if value in words:
            return value
        want = f"{', '.join(words)}, none, or a number, {quantity.allowed()}"
        raise refuse(got=value, want=want, hint=suggestion(value, (*words, "none")))
    return quantity.read(value)


ADDED_MASS = Quantity("", at_least=0, at_most=1e3)
LATERAL_DAMPING = Quantity("N s/m^2", at_least=0)


class Choke(Block):
    """A valve at the flow line: it holds rho q |q| / (2 Cd^2 A^2) against the outflow."""

    area: Annotated[float, Quantity("m^2", above=0, at_most=1)] = Field(description="open area A [m2]")
    discharge_coefficient: Annotated[float, Quantity("", above=0, at_most=2)] = Field(
        default=0.95, description="discharge coefficient Cd [-]"
    )


class Fluid(Block):
    """The drilling fluid: down the string's bore, through the bit, up the annulus."""

    density: Annotated[float, Quantity("kg/m^3", above=0, at_most=30e3)] = Field(
        description="density at zero (gauge) pressure [kg/m3]"
    )
    rheology: AnyRheology = Field(description="how shear stress follows from shear rate")
    bulk_modulus: Annotated[float, Quantity("Pa", above=0)] = Field(
        default=2e9, description="bulk modulus of the fluid alone [Pa]"
    )
    flow_rate: Annotated[TimeFunction, OverTime("m^3/s")] = derived_default(
        "volume pumped into the string over time [m3/s], negative in reverse circulation; "
        "0 when neither this nor a pump_pressure is given"
    )
    pump_pressure: Annotated[TimeFunction, OverTime("Pa")] | None = Field(
        default=None,
        description="gauge pressure at the string's upper end over time [Pa], instead of a flow_rate",
    )
    outlet_pressure: Annotated[TimeFunction, OverTime("Pa")] = Field(
        default=Constant(0.0),
        description="gauge pressure at the flow line, or without an annulus at the string's lower end, over time [Pa]",
    )
    choke: Choke | None = Field(
        default=None, description="a valve between annulus and outlet; none when not given"
    )
    flow_line: Annotated[float, Quantity("m", at_most=50e3)] = Field(
        default=0.0, description="depth of the flow line below the rotary table, straight down [m]"
    )
    annulus: Annotated[bool, Strict()] = derived_default(
        "whether there is fluid between string and hole; when not given, true in a scene with a well"
    )
    bit_volume: Annotated[float, Quantity("m^3", at_least=0, at_most=100)] = Field(
        default=7e-3, description="volume about the bit that joins nozzles and annulus [m3]"
    )
    discharge_coefficient: Annotated[float, Quantity("", above=0, at_most=2)] = Field(
        default=0.95, description="discharge coefficient of the nozzles [-]"
    )
    check_valve: bool = Field(
        default=False, strict=True, description="a valve above the bit that lets nothing back into the string"
    )
    formulation: Literal["mixed", "hermite"] = Field(
        default="mixed",
        description="mixed: pressure at the nodes, flow rate in the elements; "
        "hermite: the paper's, the volume that has passed as a cubic between the nodes (takes a flow_rate)",
    )
    dynamics: Literal["full", "quasi_steady"] = Field(
        default="full",
        description="full: with inertia and compression of the fluid; quasi_steady: the steady flow at every moment",
    )
    elastic_walls: bool = Field(
        default=True, strict=True, description="pipe and hole widen under pressure; false: rigid walls"
    )
    added_mass: Literal["confined", "eccentric", "paper_plug"] | float = Field(
        default="confined",
        description="mass of annulus fluid that moves sideways with the string, over the mass it displaces: "
        "confined: (Dw^2 + Do^2)/(Dw^2 - Do^2); eccentric: larger the nearer the wall, by the place at the last step; "
        "paper_plug: Do^2/(Dw^2 - Do^2); a number; none: 0",
    )
    lateral_damping: Literal["stokes"] | float = Field(
        default="stokes",
        description="force per length over sideways speed in still fluid [N s/m2]; stokes: from the oscillating "
        "viscous flow at lateral_damping_speed; none: 0",
    )
    lateral_damping_speed: Annotated[float, Quantity("rad/s", above=0)] = derived_default(
        "angular frequency [rad/s] for lateral_damping stokes; the fastest rotation of the top when not given, "
        "1 rad/s when that does not turn"
    )
    clinging: Annotated[float, Quantity("", at_least=0, at_most=1)] = Field(
        default=0.45,
        description="part of the string's axial speed that the fluid in the annulus takes on [-]",
    )
    rotation_drag: bool = Field(
        default=False, strict=True, description="viscous torque of the annulus fluid on the turning string"
    )
    cuttings: Literal["removed", "returned"] = Field(
        default="removed",
        description="removed: fluid takes the place of the rock that is cut; "
        "returned: the rock goes up with the fluid, which keeps its volume (needs a formation)",
    )

    @field_validator(
        "added_mass",
        mode="plain",
        json_schema_input_type=Literal["confined", "eccentric", "paper_plug", "none"] | float,
    )
    @classmethod
    def _added_mass(cls, value: Any) -> Any:
        return _word_or_number(value, ("confined", "eccentric", "paper_plug"), ADDED_MASS)

    @field_validator("lateral_damping", mode="plain", json_schema_input_type=float | str)
    @classmethod
    def _lateral_damping(cls, value: Any) -> Any:
        return _word_or_number(value, ("stokes",), LATERAL_DAMPING)

    @model_validator(mode="after")
    def _pump_and_outlet(self) -> Fluid:
        if self.flow_rate is not None and self.pump_pressure is not None:
            raise refuse("pump_pressure", want="a flow_rate or a pump_pressure, not both")
        if self.flow_rate is None and self.pump_pressure is None:
            self.fill_defaults(flow_rate=Constant(0.0))
        if self.choke is not None and (self.formulation == "hermite" or self.annulus is False):
            raise refuse("choke", want="an annulus and formulation mixed for a choke")
        if self.formulation == "hermite" and self.pump_pressure is not None:
            hint = "it counts volumes from those that the pump delivers; formulation: mixed takes a pump_pressure"
            raise refuse("pump_pressure", want="a flow_rate with formulation hermite", hint=hint)
        if self.flow_line < 0:
            want = "a depth below the rotary table, at least 0 m: the outlet cannot lie above the pump"
            raise refuse("flow_line", got=self.flow_line, want=want)
        return self
