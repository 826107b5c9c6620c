"""`well`: survey and sections of the hole; `window`: pressures between which the open hole holds."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import (
    BeforeValidator,
    Field,
    PrivateAttr,
    ValidatorFunctionWrapHandler,
    WrapValidator,
    model_validator,
)
from pydantic_core import PydanticCustomError

from drillpetsc.case.block import Block, derived_default
from drillpetsc.case.blocks.items.string import Friction
from drillpetsc.case.files.quantity_file import QuantityColumn, QuantityFile
from drillpetsc.case.files.survey_file import read_survey
from drillpetsc.case.importers.stations import Rules
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import BARE_NUMBERS, InSI, Quantity, one_as_list, said

DEFAULT_FRICTION = {"casing": 0.2, "riser": 0.2, "open_hole": 0.3}


North = Annotated[
    Literal["grid", "true", "magnetic"] | None,
    Field(description="what azimuths are measured from; for reports, without azimuth_from"),
]
_Angle = Annotated[float, Quantity("rad", at_least=-math.pi, at_most=math.pi)]
Convergence = Annotated[
    _Angle | None,
    Field(
        description="grid convergence: grid north east of true north is positive; for reports, without azimuth_from"
    ),
]
Declination = Annotated[
    _Angle | None,
    Field(
        description="magnetic declination: magnetic north east of true north is positive; for reports, without azimuth_from"
    ),
]
AzimuthFrom = Annotated[
    bool,
    Field(
        strict=True,
        description="true: azimuths are turned from their north by declination and convergence, to grid north, or to true north "
        "without convergence",
    ),
]


class TieIn(Block):
    """The station that a survey continues."""

    md: Annotated[float, Quantity("m", at_least=0, at_most=50e3)] = Field(
        default=0.0, description="measured depth"
    )
    inclination: Annotated[float, Quantity("rad", at_least=0, at_most=math.pi)] = Field(
        default=0.0, description="inclination from the vertical"
    )
    azimuth: Annotated[float, Quantity("rad", at_least=-2 * math.pi, at_most=2 * math.pi)] = Field(
        default=0.0, description="azimuth from north over east"
    )


class SurveyFile(Block):
    """A survey in a file of another program."""

    file: str = Field(
        description="CSV and other text tables, xlsx (`well.xlsx#Sheet2`), LAS, WITSML trajectory; or a run folder"
    )
    columns: dict[Literal["md", "inclination", "azimuth", "tvd", "ns", "ew", "dls"], str] | None = Field(
        default=None,
        description="titles of columns that the reader does not know: {md: MD_ft, inclination: Neigung, azimuth: Azimut}",
    )
    tie_in: TieIn | None = Field(default=None, description="station above the first one of the file")
    allow_dogleg: bool = Field(default=False, strict=True, description="true: accept bends above 30 deg/30 m")
    north: North = None
    convergence: Convergence = None
    declination: Declination = None
    azimuth_from: AzimuthFrom = False


class Survey(Block):
    """Stations of the hole, from the rotary table down: lists of the same length."""

    _remarks: tuple[str, ...] = PrivateAttr(default=())

    md: tuple[Annotated[float, Quantity("m", at_least=0, at_most=50e3)], ...] = Field(
        min_length=2, description="measured depths, rising from 0"
    )
    inclination: tuple[Annotated[float, Quantity("rad", at_least=0, at_most=math.pi)], ...] = Field(
        description="inclinations from the vertical"
    )
    azimuth: tuple[Annotated[float, Quantity("rad", at_least=-2 * math.pi, at_most=2 * math.pi)], ...] = (
        Field(description="azimuths from north over east")
    )

    north: North = None
    convergence: Convergence = None
    declination: Declination = None
    azimuth_from: AzimuthFrom = False

    @model_validator(mode="after")
    def _azimuth_from(self) -> Survey:
        """Turn the azimuths to grid north, or to true north; the angles applied become a remark, and are removed so that they are not applied again."""
        if not self.azimuth_from:
            return self
        if self.north not in ("true", "magnetic"):
            want = "true or magnetic with azimuth_from: true; azimuths from grid north need no correction"
            raise refuse("north", got=self.north, want=want)
        needed = "declination" if self.north == "magnetic" else "convergence"
        if getattr(self, needed) is None:
            raise refuse(
                needed, want=f"the {needed} as an angle, with azimuth_from: true and north: {self.north}"
            )
        declination = (self.declination or 0.0) if self.north == "magnetic" else 0.0
        turn, to = declination - (self.convergence or 0.0), "true" if self.convergence is None else "grid"
        words = [
            f"{key} {math.degrees(value):.6g} deg"
            for key, value in (("declination", declination), ("convergence", self.convergence))
            if value
        ]
        self._remarks = (
            f"azimuths from {self.north} north turned by {math.degrees(turn):.6g} deg to {to} north ({', '.join(words) or 'no angles'})",
        )
        self.fill_defaults(
            azimuth=tuple((azimuth + turn) % (2 * math.pi) for azimuth in self.azimuth),
            north=to,
            convergence=None,
            declination=None if self.north == "magnetic" else self.declination,
            azimuth_from=False,
        )
        return self

    @property
    def remarks(self) -> tuple[str, ...]:
        """Assumptions, omissions and findings of the reader of the survey's file."""
        return self._remarks

    def __eq__(self, other: object) -> bool:
        """Whether the stations are the same; how they were read does not count."""
        if not isinstance(other, Survey):
            return NotImplemented
        return all(getattr(self, key) == getattr(other, key) for key in Survey.model_fields)

    __hash__ = None  # type: ignore[assignment]

    @model_validator(mode="after")
    def _stations(self) -> Survey:
        if abs(self.md[0]) > 1e-9:
            raise refuse("md", 0, got=self.md[0], want="a first station at 0 m (the rotary table)")
        for i in range(1, len(self.md)):
            if self.md[i] <= self.md[i - 1]:
                want = f"rising depths: above {said(self.md[i - 1], 'length')}, the station before"
                raise refuse("md", i, got=self.md[i], want=want)
        for key in ("inclination", "azimuth"):
            count = len(getattr(self, key))
            if count != len(self.md):
                raise refuse(key, got=f"{count} values", want=f"{len(self.md)} values, one for each md")
        return self


def _survey(value: Any, read: ValidatorFunctionWrapHandler) -> Survey:
    """A survey from its lists, or from a file."""
    if isinstance(value, Mapping) and "file" in value:
        given = SurveyFile.model_validate(value)
    elif isinstance(value, str):
        given = SurveyFile(file=value)
    elif isinstance(value, SurveyFile):
        given = value
    else:
        return read(value)
    tie = given.tie_in
    rules = Rules(
        units=BARE_NUMBERS.get(),
        tie_in=None if tie is None else (tie.md, tie.inclination, tie.azimuth),
        allow_dogleg=given.allow_dogleg,
        columns=given.columns or {},  # type: ignore[arg-type]  # words of a Literal
    )
    try:
        found = read_survey(given.file, rules)
    except PydanticCustomError as error:
        if isinstance(value, Mapping):
            context = error.context or {}
            raise refuse("file", got=given.file, want=context["want"], hint=context["hint"]) from None
        raise
    keys: dict[str, Any] = {
        key: tuple(map(InSI, getattr(found, key))) for key in ("md", "inclination", "azimuth")
    }
    for key in ("north", "convergence", "declination", "azimuth_from"):
        number = getattr(given, key)
        if number is not None:
            keys[key] = InSI(number) if isinstance(number, float) else number
    survey: Survey = read(keys)
    survey._remarks = (*found.remarks, *survey._remarks)
    return survey


class Compliance(Block):
    """Elastic constants of rock and casing around a section, which widens under the fluid's pressure."""

    young: Annotated[float, Quantity("Pa", at_least=1e3, at_most=1e14)] = Field(
        description="Young's modulus of the rock, or of casing and rock together"
    )
    poisson: Annotated[float, Quantity("", above=-1, at_most=0.5)] = Field(
        default=0.25, description="Poisson's ratio"
    )


def _depth_or_end(value: Any, depth: Callable[[Any], float]) -> float | None:
    """Depth, or None for the end of the survey."""
    return None if value is None or (isinstance(value, str) and value == "end") else depth(value)


#: what `calibrate` fits beside friction factors: no names of groups
OTHER_FITS = ("block_weight", "weight_factor", "running_drag", "sheave_efficiency")


class Section(Block):
    """An interval of the hole with one diameter."""

    unsupported_keys: ClassVar[tuple[str, ...]] = ("roughness",)

    to: Annotated[float, Quantity("m", above=0, at_most=50e3), WrapValidator(_depth_or_end)] = (
        derived_default(
            "measured depth of the lower end; for the last section `end`, or nothing: the last station of the survey"
        )
    )
    kind: Literal["casing", "riser", "open_hole"] = Field(
        description="cased hole, riser between rig and seabed, or open hole"
    )
    diameter: Annotated[float, Quantity("m", above=0, at_most=10, kind="diameter")] = Field(
        description="inner diameter"
    )
    friction: Friction = derived_default(
        "friction coefficient; 0.2 in casing and riser, 0.3 in open hole when not given"
    )
    ff_group: str | None = Field(
        default=None,
        pattern=r"^[A-Za-z][A-Za-z0-9_]*$",
        max_length=30,
        description="group whose friction factor `roadmap` and `calibrate` change together; cased or open hole by its kind when "
        "not given",
    )
    compliance: Compliance | None = Field(
        default=None,
        description="elasticity of the wall (used by a fluid in the annulus); rigid when not given",
    )

    @model_validator(mode="after")
    def _default_friction(self) -> Section:
        if self.friction is None:
            self.fill_defaults(friction=DEFAULT_FRICTION[self.kind])
        if self.ff_group in OTHER_FITS:
            raise refuse("ff_group", got=self.ff_group, want=f"another name than {', '.join(OTHER_FITS)}")
        return self

    @property
    def group(self) -> str:
        """Name of the group of sections with one friction factor: cased, open_hole, or a name given in the case."""
        return self.ff_group or ("open_hole" if self.kind == "open_hole" else "cased")


class Well(Block):
    """The hole."""

    survey: Annotated[Survey, WrapValidator(_survey, json_schema_input_type=str | SurveyFile | Survey)] = (
        Field(
            description="stations md, inclination, azimuth; or the name of a file with these columns; or {file, columns, tie_in, allow_dogleg, north, convergence, "
            "declination, azimuth_from} for such a file; or the folder of a run that drilled this hole"
        )
    )
    sections: tuple[Section, ...] = Field(
        min_length=1, description="riser, casing and open hole, from the surface down"
    )

    @model_validator(mode="after")
    def _covered(self) -> Well:
        above, last = 0.0, len(self.sections) - 1
        end = self.survey.md[-1]
        for i, section in enumerate(self.sections[:last]):
            if section.to is not None and section.to > end + 1e-3:
                want = f"at most the depth of the last survey station, {said(end, 'length')}"
                raise refuse("sections", i, "to", got=said(section.to, "length"), want=want)
        if self.sections[last].to is None:
            self.fill_defaults(
                sections=(
                    *self.sections[:last],
                    self.sections[last].model_copy(update={"to": self.survey.md[-1]}),
                )
            )
        for i, section in enumerate(self.sections):
            if section.to is None:
                hint = "only the last section may leave it to the survey"
                raise refuse(
                    "sections", i, "to", want="the measured depth of the section's lower end", hint=hint
                )
            if section.to <= above:
                want = f"rising depths: below the section above, {said(above, 'length')}"
                raise refuse("sections", i, "to", got=section.to, want=want)
            above = section.to
        if abs(above - end) > 1e-3:
            hint = "the survey ends there; add a station, or write `to: end`"
            want = f"sections down to the last station, {said(end, 'length')}"
            raise refuse("sections", last, "to", got=said(above, "length"), want=want, hint=hint)
        return self

    def diameter_at(self, depth: float) -> float:
        """Diameter of the hole [m] at a measured depth [m]; below the last section, the diameter of that section."""
        return next((q.diameter for q in self.sections if depth <= q.to), self.sections[-1].diameter)


_Density = Annotated[float, Quantity("kg/m^3", above=0, at_most=5e3, kind="mud_weight")]
Densities = Annotated[
    tuple[_Density, ...], BeforeValidator(one_as_list, json_schema_input_type=_Density | tuple[_Density, ...])
]


class Window(Block):
    """Pressures between which the open hole holds, as equivalent densities: one pair, or a table over the depth."""

    tvd: tuple[Annotated[float, Quantity("m", at_least=0, at_most=50e3)], ...] | None = Field(
        default=None,
        description="vertical depths below the rotary table, rising; linear between them; "
        "when not given, pore and frac are one value each for all depths",
    )
    pore: Densities = Field(
        description="lower limit (pore pressure or stability) as the density of a column from the flow line"
    )
    frac: Densities = Field(
        description="upper limit (fracture or loss) as the density of a column from the flow line"
    )

    @model_validator(mode="after")
    def _rows(self) -> Window:
        count = 1 if self.tvd is None else len(self.tvd)
        if self.tvd is not None and count < 2:
            raise refuse(
                "tvd", got=f"{count} values", want="two depths or more", hint="leave tvd out for one pair"
            )
        for i in range(1, count):
            assert self.tvd is not None
            if self.tvd[i] <= self.tvd[i - 1]:
                want = f"rising depths: above {said(self.tvd[i - 1], 'length')}, the row before"
                raise refuse("tvd", i, got=self.tvd[i], want=want)
        for key in ("pore", "frac"):
            values = getattr(self, key)
            if len(values) != count:
                want = "one value without tvd" if self.tvd is None else f"{count} values, one for each tvd"
                raise refuse(key, got=f"{len(values)} values", want=want)
        for i, (low, high) in enumerate(zip(self.pore, self.frac, strict=True)):
            if high <= low:
                raise refuse("frac", i, got=high, want=f"above pore, {said(low, 'mud_weight')}")
        return self


#: a pressure window; a column without a unit has that of the bare numbers of the case
WINDOW_FILE = QuantityFile(
    {
        "tvd": QuantityColumn("m", ("tvd",), {}),
        "pore": QuantityColumn("kg/m^3", ("pore",), {}),
        "frac": QuantityColumn("kg/m^3", ("frac",), {}),
    },
    "tvd [ft], pore [ppg], frac [ppg]",
    "{pore: ..., frac: ...}, or {tvd: [...], pore: [...], frac: [...]}",
    bare=True,
)
