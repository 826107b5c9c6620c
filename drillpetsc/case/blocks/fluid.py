"""`fluid`: the drilling fluid, its rheology, the pump and the outlet."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal, get_args

from pydantic import (
    BeforeValidator,
    Field,
    GetJsonSchemaHandler,
    Strict,
    model_validator,
)
from pydantic_core import CoreSchema

from drillpetsc.case.block import Block, ByKind, derived_default, kinds_of
from drillpetsc.case.blocks.own_law import OwnLaw
from drillpetsc.case.files.mud_report import standard
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import OverTime, Quantity, WordOrNumber
from drillpetsc.own_code import RheologyState
from drillpetsc.time_function import Constant, TimeFunction
from drillpetsc.unit_tables import FOOT, INCH

Consistency = Annotated[float, Quantity("Pa s^n", above=0, at_most=1e3)]
Viscosity = Annotated[float, Quantity("Pa s", at_least=0, at_most=1e3)]
PlasticViscosity = Annotated[float, Quantity("Pa s", above=0, at_most=1e3)]
YieldStress = Annotated[float, Quantity("Pa", at_least=0, at_most=1e4, kind="yield_point")]
FlowIndex = Annotated[float, Quantity("", above=0, at_most=2)]

_STRESS = "shear stress = "


class Rheology(Block):
    """Keys that all rheology models have in common."""

    discriminator: ClassVar[str] = "model"

    law: Literal["blend", "api", "exact"] = Field(
        default="blend",
        description="friction in pipe and annulus. blend: one smooth formula from laminar to turbulent flow. "
        "api: API form with Metzner-Reed Reynolds number and straight transition. exact: laminar profile integrated",
    )
    shear_rate: Annotated[float, Quantity("1/s", above=0, at_most=1e3, kind="shear_rate")] = Field(
        default=1.0, description="shear rate below which stresses go smoothly to zero"
    )
    dial: dict[str, float] | None = Field(
        default=None,
        description="readings of a viscometer in degrees by its speed in rpm, {600: 64, 300: 41}; the model's constants are fitted to them unless "
        "given",
    )
    fit: Literal["api", "least_squares"] | None = Field(
        default=None,
        description="fit to the readings: api: rules of API RP 13D (default with two readings and with law api); least_squares: in stress",
    )


class Newtonian(Rheology):
    """Water, oil, brine."""

    model: Literal["newtonian"] = Field(description=_STRESS + "viscosity * shear rate")
    viscosity: Viscosity = Field(description="viscosity; 0 is a fluid without friction")


class PowerLaw(Rheology):
    """Shear thinning (index below 1) or thickening, without a yield stress."""

    model: Literal["power_law"] = Field(description=_STRESS + "consistency * shear rate^index")
    consistency: Consistency = Field(description="consistency")
    index: FlowIndex = Field(description="flow index n, 1 for a Newtonian fluid")


class WithYieldStress(Rheology):
    """Keys that the models with a yield stress have in common."""

    unsupported_values: ClassVar[dict[str, tuple[str, ...]]] = {
        "law": ("api",)
    }  # the API formulas apply to a power law

    law: Literal["blend", "exact"] = Field(
        default="exact",
        description="friction in pipe and annulus: exact: laminar profile integrated; blend: a formula for it, too high in slow flow",
    )
    yield_stress: YieldStress = Field(description="yield stress")


class Bingham(WithYieldStress):
    """Plastic above a yield stress."""

    model: Literal["bingham"] = Field(description=_STRESS + "yield stress + plastic viscosity * shear rate")
    plastic_viscosity: PlasticViscosity = Field(description="plastic viscosity")


class Casson(WithYieldStress):
    """Plastic above a yield stress, in square roots."""

    model: Literal["casson"] = Field(
        description="sqrt(shear stress) = sqrt(yield stress) + sqrt(plastic viscosity * shear rate)"
    )
    plastic_viscosity: PlasticViscosity = Field(description="plastic viscosity")


class HerschelBulkley(WithYieldStress):
    """A power law above a yield stress."""

    model: Literal["herschel_bulkley"] = Field(
        description=_STRESS + "yield stress + consistency * shear rate^index"
    )
    consistency: Consistency = Field(description="consistency")
    index: FlowIndex = Field(description="flow index n, 1 for a Bingham fluid")


#: shear rates of 300 and 600 rpm of a viscometer [1/s], between which the stress of a function counts as a power law
POWER_LAW_RATES = 511.0, 1022.0


class OwnRheology(OwnLaw, Rheology):
    """A function that gives the shear stress. Turbulence is computed for the power law between 300 and 600 rpm of a viscometer."""

    unsupported_keys: ClassVar[tuple[str, ...]] = ("dial", "fit")

    model: Literal["python"] = Field(description=_STRESS + "a function of the shear rate in Python")
    law: Literal["exact"] = Field(
        default="exact", description="friction in pipe and annulus: laminar profile integrated"
    )

    def stress(self, shear_rate: Any) -> Any:
        """Shear stress [Pa] (n,) at shear rates (n,) [1/s]."""
        found = self.call(RheologyState(shear_rate), **self.parameters)
        return found["stress"] if isinstance(found, Mapping) else found

    @property
    def power_law(self) -> tuple[float, float]:
        """Consistency [Pa s^n] and index [-] between 300 and 600 rpm."""
        low, high = (float(self.stress(rate)) for rate in POWER_LAW_RATES)
        index = math.log(high / low) / math.log(2.0)
        return low / POWER_LAW_RATES[0] ** index, index


_Model = Newtonian | Bingham | PowerLaw | Casson | HerschelBulkley | OwnRheology


class _MudReportForms:
    """Alternatives to a model's keys, for the JSON schema: {dial}, {pv, yp}, {n, k}, {ty, n, k}."""

    KEYS: ClassVar[dict[str, str]] = {
        "pv": "plastic viscosity of bingham [Pa s]",
        "yp": "yield point of bingham [Pa]",
        "ty": "yield stress of herschel_bulkley [Pa]",
        "k": "consistency [Pa s^n]",
        "n": "flow index [-]",
    }
    FORMS: ClassVar[tuple[tuple[str, ...], ...]] = (("dial",), ("pv", "yp"), ("n", "k"), ("ty", "n", "k"))

    def __get_pydantic_json_schema__(
        self, core_schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        by_model = handler(core_schema)
        shared = Rheology.model_json_schema()["properties"]
        models = {"enum": [kinds_of(block, "model")[0] for block in get_args(_Model)]}
        forms = []
        for form in self.FORMS:
            own = {
                key: {"description": self.KEYS[key], "anyOf": [{"type": "number"}, {"type": "string"}]}
                for key in form
                if key in self.KEYS
            }
            forms.append(
                {
                    "type": "object",
                    "properties": {**shared, "model": models, **own},
                    "required": list(form),
                    "additionalProperties": False,
                }
            )
        return {"anyOf": [by_model, *forms]}


AnyRheology = Annotated[_Model, ByKind(key="model"), BeforeValidator(standard), _MudReportForms()]


def stress_at(rheology: Rheology, shear_rate: float) -> float:
    """Shear stress [Pa] at a shear rate [1/s]."""
    consistency, index, yield_stress = flow_constants(rheology)
    if isinstance(rheology, Casson):
        return (math.sqrt(yield_stress) + math.sqrt(consistency * shear_rate)) ** 2
    if isinstance(rheology, OwnRheology):
        return float(rheology.stress(shear_rate))
    return float(yield_stress + consistency * shear_rate**index)


def flow_constants(rheology: Rheology) -> tuple[float, float, float]:
    """(consistency [Pa s^n], index n [-], yield stress [Pa]) of any rheology model.

    All models except casson: stress = yield stress + consistency * shear rate^n.
    casson: sqrt(stress) = sqrt(yield stress) + sqrt(consistency * shear rate), with the plastic viscosity as
    the consistency and n = 1.
    python: the power law between 300 and 600 rpm of a viscometer.
    """
    if isinstance(rheology, OwnRheology):
        return (*rheology.power_law, 0.0)
    if isinstance(rheology, Newtonian):
        return rheology.viscosity, 1.0, 0.0
    if isinstance(rheology, PowerLaw):
        return rheology.consistency, rheology.index, 0.0
    if isinstance(rheology, HerschelBulkley):
        return rheology.consistency, rheology.index, rheology.yield_stress
    assert isinstance(rheology, (Bingham, Casson))
    return rheology.plastic_viscosity, 1.0, rheology.yield_stress


#: surface lines of API RP 13D: length [m] of 3.826 in bore, by case
SURFACE_LINES = {1: 2600 * FOOT, 2: 946 * FOOT, 3: 610 * FOOT, 4: 424 * FOOT}
SURFACE_BORE = 3.826 * INCH  # [m]


class SurfaceLine(Block):
    """Standpipe, hose, swivel and kelly. Their loss is added to the pump pressure and to nothing else."""

    case: Literal[1, 2, 3, 4] | None = Field(
        default=None,
        description="equipment of API RP 13D: 2600, 946, 610 or 424 ft of 3.826 in bore with the string's friction law",
    )
    length: Annotated[float, Quantity("m", above=0, at_most=10e3)] | None = Field(
        default=None, description="length of an equivalent pipe, with id, instead of a case"
    )
    id: Annotated[float, Quantity("m", at_least=1e-3, at_most=2, kind="diameter")] | None = Field(
        default=None, description="inner diameter of that pipe"
    )
    loss: Annotated[float, Quantity("Pa", at_least=0, at_most=1e9, kind="pressure")] | None = Field(
        default=None,
        description="measured loss, with the flow rate `at`, instead of a case; it goes with the flow rate squared",
    )
    at: Annotated[float, Quantity("m^3/s", above=0)] | None = Field(
        default=None, description="flow rate of the loss"
    )

    @model_validator(mode="before")
    @classmethod
    def _a_mapping(cls, value: Any) -> Any:
        if isinstance(value, (int, float, str)):
            hint = f"{{case: {value}}}?" if str(value).strip() in ("1", "2", "3", "4") else ""
            raise refuse(
                got=value, want="{case: 1}, {length: ..., id: ...} or {loss: ..., at: ...}", hint=hint
            )
        return value

    @model_validator(mode="after")
    def _one_form(self) -> SurfaceLine:
        given = {key for key in SurfaceLine.model_fields if getattr(self, key) is not None}
        if given not in ({"case"}, {"length", "id"}, {"loss", "at"}):
            want = "{case: 1}, {length: ..., id: ...} or {loss: ..., at: ...}"
            raise refuse(got=", ".join(sorted(given)) or "nothing", want=want)
        if self.case is not None:
            self.fill_defaults(length=SURFACE_LINES[self.case], id=SURFACE_BORE, case=None)
        return self


class Choke(Block):
    """A valve at the flow line. Its pressure drop is rho q |q| / (2 Cd^2 A^2)."""

    area: Annotated[float, Quantity("m^2", above=0, at_most=1)] = Field(description="open area A")
    discharge_coefficient: Annotated[float, Quantity("", above=0, at_most=2)] = Field(
        default=0.95, description="discharge coefficient Cd"
    )


class Fluid(Block):
    """The drilling fluid: down the string's bore, through the bit, up the annulus."""

    density: Annotated[float, Quantity("kg/m^3", above=0, at_most=30e3, kind="mud_weight")] = Field(
        description="density at zero (gauge) pressure"
    )
    rheology: AnyRheology = Field(
        description="shear stress as a function of the shear rate; also as in a mud report: {pv, yp}, {n, k}, {ty, n, k} or {dial: {600: 64, 300: 41}}"
    )
    annulus_rheology: AnyRheology | None = Field(
        default=None,
        description="rheology in the annulus, if it differs; with law api and dial readings at 100 and 3 rpm, the power law through these",
    )
    surface_line: SurfaceLine | None = Field(
        default=None, description="lines between pump and string, whose loss the pump pressure contains"
    )
    bulk_modulus: Annotated[float, Quantity("Pa", above=0)] = Field(
        default=2e9, description="bulk modulus of the fluid alone"
    )
    flow_rate: Annotated[TimeFunction, OverTime("m^3/s")] = derived_default(
        "volume pumped into the string over time, negative in reverse circulation; "
        "0 when this and pump_pressure are not given"
    )
    pump_pressure: Annotated[TimeFunction, OverTime("Pa", kind="pressure")] | None = Field(
        default=None,
        description="gauge pressure at the string's upper end over time, instead of a flow_rate",
    )
    outlet_pressure: Annotated[TimeFunction, OverTime("Pa", kind="pressure")] = Field(
        default=Constant(0.0),
        description="gauge pressure at the flow line, or without an annulus at the string's lower end, over time",
    )
    choke: Choke | None = Field(
        default=None, description="a valve between annulus and outlet; none when not given"
    )
    flow_line: Annotated[float, Quantity("m", at_most=50e3)] = Field(
        default=0.0, description="depth of the flow line below the rotary table, straight down"
    )
    level_in_string: Annotated[float, Quantity("m", at_least=0, at_most=50e3)] | None = Field(
        default=None,
        description="measured depth of the mud's surface in a plugged string, which is empty above: a string that is not filled "
        "(roadmap and calibrate with the soft string)",
    )
    floated_length: Annotated[float, Quantity("m", at_least=0, at_most=50e3)] | None = Field(
        default=None,
        description="length of the lower end of a plugged string that holds air below a flotation collar, with mud above it "
        "(roadmap and calibrate with the soft string)",
    )
    annulus: Annotated[bool, Strict()] = derived_default(
        "whether there is fluid between string and hole; when not given, true in a case with a well"
    )
    bit_volume: Annotated[float, Quantity("m^3", at_least=0, at_most=100)] = Field(
        default=7e-3, description="volume around the bit, between nozzles and annulus"
    )
    discharge_coefficient: Annotated[float, Quantity("", above=0, at_most=2)] = Field(
        default=0.95, description="discharge coefficient of the nozzles"
    )
    check_valve: bool = Field(
        default=False,
        strict=True,
        description="a valve against backflow into the string, above the bit or at an open end (float shoe)",
    )
    formulation: Literal["mixed", "hermite"] = Field(
        default="mixed",
        description="mixed: pressure at the nodes, flow rate in the elements; "
        "hermite: the volume passed, as a cubic between the nodes, as in the reference formulation "
        "(DOI 10.1177/1687814016656703); takes a flow_rate",
    )
    dynamics: Literal["full", "quasi_steady"] = Field(
        default="full",
        description="full: with inertia and compression of the fluid; quasi_steady: steady flow at every moment",
    )
    elastic_walls: bool = Field(
        default=True, strict=True, description="pipe and hole widen under pressure; false: rigid walls"
    )
    added_mass: Annotated[
        Literal["confined", "eccentric", "stokes", "paper_plug"] | float,
        WordOrNumber(
            ("confined", "eccentric", "stokes", "paper_plug"), Quantity("", at_least=0, at_most=1e3)
        ),
    ] = Field(
        default="confined",
        description="mass of annulus fluid that moves sideways with the string, over the displaced mass. "
        "confined: (Dw^2 + Do^2)/(Dw^2 - Do^2); eccentric: increases towards the wall, with the forces of its gradient; "
        "stokes: from the oscillating viscous flow, at lateral_damping_speed in runs and at each mode's own frequency in modes; "
        "paper_plug: Do^2/(Dw^2 - Do^2), as in the reference formulation (DOI 10.1177/1687814016656703); a number; none: 0",
    )
    lateral_damping: Annotated[
        Literal["stokes"] | float, WordOrNumber(("stokes",), Quantity("N s/m^2", at_least=0))
    ] = Field(
        default="stokes",
        description="force per length over sideways speed in still fluid; stokes: from the oscillating "
        "viscous flow at lateral_damping_speed; none: 0",
    )
    lateral_damping_speed: Annotated[float, Quantity("rad/s", above=0, kind="none")] = derived_default(
        "angular frequency for lateral_damping stokes; when not given, the fastest rotation of the top, "
        "or 1 rad/s if the top does not turn"
    )
    swirl: Annotated[
        Literal["auto"] | float, WordOrNumber(("auto",), Quantity("", at_least=0, at_most=0.5))
    ] = Field(
        default="auto",
        description="spin of the annulus mud about the hole over the string's spin, used by the sideways forces of the mud. "
        "auto: Do^2/(Do^2 + Dw^2), the mean of a flow between turning pipe and fixed wall; a number up to 0.5; none: 0",
    )
    swirl_lag: bool = Field(
        default=True,
        strict=True,
        description="the swirl follows a change of the string's spin within the time that friction takes; false: at once",
    )
    clinging: Annotated[float, Quantity("", at_least=0, at_most=1)] = Field(
        default=0.45,
        description="clinging factor: fraction of the string's axial speed that the fluid in the annulus takes on",
    )
    rotation_drag: bool = Field(
        default=False, strict=True, description="viscous torque of the annulus fluid on the turning string"
    )
    cuttings: Literal["removed", "returned"] = Field(
        default="removed",
        description="removed: fluid fills the volume of the rock that is cut; "
        "returned: the cuttings rise with the fluid, whose volume is constant (needs a formation)",
    )

    @model_validator(mode="after")
    def _pump_and_outlet(self) -> Fluid:
        if self.flow_rate is not None and self.pump_pressure is not None:
            raise refuse("pump_pressure", want="a flow_rate or a pump_pressure, not both")
        if self.surface_line is not None and self.pump_pressure is not None:
            hint = "a pump_pressure acts at the string's upper end, below the surface line"
            raise refuse("surface_line", want="a flow_rate with a surface_line", hint=hint)
        if self.flow_rate is None and self.pump_pressure is None:
            self.fill_defaults(flow_rate=Constant(0.0))
        if self.choke is not None and (self.formulation == "hermite" or self.annulus is False):
            raise refuse("choke", want="an annulus and formulation mixed for a choke")
        if self.formulation == "hermite" and self.pump_pressure is not None:
            hint = "hermite integrates the volume that the pump delivers; formulation: mixed takes a pump_pressure"
            raise refuse("pump_pressure", want="a flow_rate with formulation hermite", hint=hint)
        if self.flow_line < 0:
            want = "a depth below the rotary table, at least 0 m: the outlet cannot lie above the pump"
            raise refuse("flow_line", got=self.flow_line, want=want)
        return self
