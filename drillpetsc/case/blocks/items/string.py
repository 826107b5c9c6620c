"""`string`: items of the string, from the surface down; and `material`. Pipe of the trade: `blocks/tubulars.py`."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

from drillpetsc.case.block import Block, derived_default
from drillpetsc.case.blocks.items.pressure_loss import PressureLoss
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.nozzles import Nozzles
from drillpetsc.case.quantities import Quantity, Vector, WordOrNumber, said
from drillpetsc.units import UnitError, bare_number, weight_to_mass

FILL = math.inf
"""Length of an item that fills the string, until the case is complete."""


@dataclass(frozen=True)
class LengthOrFill(Quantity):
    """A length, or `fill`."""

    def read(self, value: object, *at: str | int) -> float:
        return FILL if value == "fill" else super().read(value, *at)


Length = Annotated[float, Quantity("m", at_least=1e-3, at_most=50e3)]
PipeLength = Annotated[float, LengthOrFill("m", at_least=1e-3, at_most=50e3)]
PIPE_LENGTH = "length; fill for the topmost pipe: bit_depth, or the end of the survey, less all other items"
RigidLength = Annotated[float, Quantity("m", at_least=0, at_most=200)]
Diameter = Annotated[float, Quantity("m", at_least=1e-4, at_most=2, kind="diameter")]
Bore = Annotated[float, Quantity("m", at_least=0, at_most=2, kind="diameter")]
Offset = Annotated[float, Quantity("m", at_least=0, at_most=1, kind="diameter")]
Angle = Annotated[float, Quantity("rad")]
Friction = Annotated[float, Quantity("", at_least=0, at_most=10)]


BoreVolume = Annotated[float, Quantity("m^3", above=0, at_most=100)] | None
NozzleArea = Annotated[float, Quantity("m^2", above=0, at_most=0.1)] | None
NozzleSizes = Annotated[tuple[float, ...], Nozzles()] | None


MIN_WALL_RATIO = 1e-4  # (od - id) over od [-]
MIN_BORE = 1e-4  # inner diameter [m]


_BORE_VOLUME = "volume of the mud inside the item; the volume of a bore of its id when not given"
_ANNULUS_OD = "outer diameter that the mud outside flows past and that displaces it; od when not given"
_TOOL_FACE = (
    "0 is the high side, 90 deg to the right looking down the hole; measured from north if the inclination is below 5 "
    "deg; at spin angle zero"
)


@dataclass(frozen=True)
class WeightPerLength(Quantity):
    """A weight per length, or its mass [kg/m]; the weight of a whole item is refused with its place."""

    def read(self, value: object, *at: str | int) -> float:
        if isinstance(value, str) and bare_number(value) is None:
            try:
                weight_to_mass(value)
            except UnitError:
                pass
            else:
                want = "a weight per length, such as 1824 N/m or 125 lb/ft"
                raise refuse(*at, got=value, want=want, hint="a rigid item has the key 'mass' for all of it")
        return super().read(value, *at)


class Damping(Block):
    """Damping of the pipe: Kelvin-Voigt in the rotating section, and external, proportional to the mass."""

    stiffness: Annotated[float, Quantity("s", at_least=0, kind="none")] = Field(
        default=0.0, description="Kelvin-Voigt time constant: stress E (strain + stiffness * strain rate)"
    )
    mass: Annotated[float, Quantity("1/s", at_least=0)] = Field(
        default=0.0, description="external damping rate: force per mass over velocity"
    )


class Material(Block):
    """Elastic constants and density; steel when not given. In a string item, keys left out are the case's."""

    young: Annotated[float, Quantity("Pa", at_least=1e3, at_most=1e14)] = Field(
        default=206e9, description="Young's modulus"
    )
    poisson: Annotated[float, Quantity("", above=-1, at_most=0.5)] = Field(
        default=0.3, description="Poisson's ratio"
    )
    density: Annotated[float, Quantity("kg/m^3", above=0, at_most=30e3)] = Field(
        default=7850.0, description="density"
    )
    damping: Damping = Field(default=Damping(), description="damping of the string")


class Bend(Block):
    """A kink in an item, at its upper end when no position is given (bent sub)."""

    angle: Annotated[float, Quantity("rad", at_least=0, at_most=math.pi / 2)] = Field(
        description="bend angle"
    )
    tool_face: Angle = Field(
        default=0.0, description="direction in which the string below the kink points: " + _TOOL_FACE
    )
    position: Annotated[float, Quantity("m", at_least=0, at_most=50e3)] | None = Field(
        default=None,
        description="height of the kink above the item's lower end; the item's upper end when not given. "
        "A rigid item bends at its upper end only",
    )


class ItemInitial(Block):
    """Imperfection of one item."""

    imperfection: Annotated[float, Quantity("", at_least=0, at_most=1)] = Field(
        description="lateral load as a fraction of the item's weight, instead of the case's initial.imperfection"
    )


class Inertia(Block):
    """Moments of inertia of a rigid item about its centre of gravity; a hollow cylinder's when not given."""

    axial: Annotated[float, Quantity("kg m^2", at_least=0)] = derived_default("about the string's axis")
    transverse: Annotated[float, Quantity("kg m^2", at_least=0)] = derived_default(
        "about an axis across the string through the centre of gravity"
    )


class Item(Block):
    """Base of every string item. A kind without one of the optional keys has the value None for it."""

    keys_elsewhere: ClassVar[Mapping[str, str]] = {
        "joints": "joints at the top level of the case, at measured depths in the string: joints: [{kind: universal, at: 120 m}]"
    }
    optional_attributes: ClassVar[Mapping[str, Any]] = {
        "bend": None,
        "initial": None,
        "material": None,
        "nozzle_area": None,
        "bore_volume": None,
        "annulus_od": None,
    }

    has_own_od: ClassVar[bool] = True
    """Diameters that are not given do not come from elsewhere, such as the catalogue."""

    if TYPE_CHECKING:
        kind: str
        length: float
        od: float | None = None
        id: float = 0.0
        bend: Bend | None = None
        initial: ItemInitial | None = None
        material: Material | None = None
        nozzle_area: float | None = None
        bore_volume: float | None = None
        annulus_od: float | None = None

    name: str = Field(default="", description="name in reports; the kind when not given")
    friction: Friction | None = Field(
        default=None, description="friction coefficient of this item, instead of the hole section's"
    )
    weight: Annotated[float, WeightPerLength("kg/m", above=0, at_most=1e5)] | None = Field(
        default=None,
        description="weight per length in air as weighed, 1824 N/m or 125 lb/ft, instead of density times area; mud displaces the "
        "ring between od and id",
    )
    pressure_loss: PressureLoss | None = Field(
        default=None,
        description="pressure loss in this item besides friction, {value: 350 psi, at: 600 gpm, density: 10 ppg}, {coefficient: 2.5} or "
        "{curve: loss.csv, density: 10 ppg}",
    )

    @model_validator(mode="after")
    def _bore_inside(self) -> Item:
        outer, inner = self.od, self.id
        if not self.name:
            self.fill_defaults(name=self.kind.replace("_", " "))
        if outer is None and inner is None:
            return self
        if outer is not None and inner is not None and inner >= outer:
            raise refuse(
                "id", got=inner, want=f"an inner diameter below the outer, {said(outer, 'diameter')}"
            )
        if outer is not None and inner is not None and inner > outer * (1 - MIN_WALL_RATIO):
            raise refuse(
                "id",
                got=inner,
                want=f"a wall of at least {said(MIN_WALL_RATIO / 2 * outer, 'diameter')} inside the outer diameter, {said(outer, 'diameter')}",
            )
        if inner is not None and 0 < inner < MIN_BORE:
            raise refuse(
                "id",
                got=inner,
                want=f"0 (solid), or an inner diameter of at least {said(MIN_BORE, 'diameter')}",
            )
        if outer is None and inner and self.has_own_od:
            raise refuse("id", got=inner, want="an inner diameter together with an outer one (od)")
        return self

    @model_validator(mode="after")
    def _mud_inside(self) -> Item:
        if self.bore_volume is not None and not self.length > 0:
            raise refuse(
                "bore_volume", got=self.bore_volume, want="a length of the item above 0 with a bore_volume"
            )
        if self.bore_volume is None and self.annulus_od is None:
            return self
        inside, outside = self.bore_section, self.outer_section
        if outside and not inside < (1 - MIN_WALL_RATIO) * outside:
            if self.bore_volume is not None:
                most = said(outside * self.length, "volume")
                raise refuse(
                    "bore_volume",
                    got=said(self.bore_volume, "volume"),
                    want=f"less than the item displaces, {most}",
                )
            want = f"more than the inner diameter, {said(self.id, 'diameter')}"
            raise refuse("annulus_od", got=said(self.annulus_od or 0.0, "diameter"), want=want)
        return self

    @property
    def bore_section(self) -> float:
        """Mean area of the mud inside [m2]."""
        return math.pi / 4 * self.id**2 if self.bore_volume is None else self.bore_volume / self.length

    @property
    def outer_section(self) -> float:
        """Mean area that displaces the mud outside [m2]; 0 of an item without a diameter."""
        return math.pi / 4 * ((self.od if self.annulus_od is None else self.annulus_od) or 0.0) ** 2

    @property
    def flow_resistance(self) -> float:
        """Pressure loss of the tool over density and flow rate squared [1/m4]; 0 without one, and with a measured curve."""
        return 0.0 if self.pressure_loss is None else self.pressure_loss.resistance(self.id)

    def tool_loss(self, flow: float, density: float) -> float:
        """Pressure loss [Pa] of the tool at a flow rate [m3/s] of a fluid [kg/m3] there; 0 without one."""
        if self.pressure_loss is None:
            return 0.0
        return self.flow_resistance * density * flow * abs(flow) + self.pressure_loss.of_curve(flow, density)

    @property
    def contact_od(self) -> float | None:
        """Diameter that touches the hole [m]: of the tool joints, of the blades, or the outer diameter."""
        return self.od

    @property
    def widest_od(self) -> float | None:
        """Diameter that has to pass the hole [m]: of the tool joints, or the diameter that touches it."""
        return self.contact_od

    @property
    def clearance_od(self) -> float | None:
        """Diameter for the clearance of buckling loads [m]: the one that touches the hole, unless the item gives another."""
        return self.contact_od


class Flexible(Item):
    """An item that is meshed with beam elements."""

    length: Length = Field(description="length")
    element_length: Annotated[
        Literal["auto"] | float, WordOrNumber(("auto",), Quantity("m", above=0), none=False)
    ] = Field(
        default="auto",
        description="target length of an element, rounded so that elements fit the item; auto: chosen from the physics along the "
        "string and graded",
    )
    eccentricity: Offset = Field(default=0.0, description="offset of the mass centre from the axis")
    eccentricity_angle: Angle = Field(default=0.0, description="direction of the eccentricity in the section")
    curvature: Annotated[float, Quantity("1/m", at_least=0, at_most=100)] = Field(
        default=0.0, description="stress-free curvature"
    )
    curvature_angle: Angle = Field(
        default=0.0, description="direction in which the item bends downward: " + _TOOL_FACE
    )
    bend: Bend | None = Field(default=None, description="bent sub: kink at the item's upper end")
    initial: ItemInitial | None = Field(default=None, description="imperfection of this item")

    @model_validator(mode="after")
    def _mass_centre_inside(self) -> Flexible:
        outer = self.od
        if outer is not None and self.eccentricity > outer / 2:
            raise refuse(
                "eccentricity",
                got=self.eccentricity,
                want=f"at most the outer radius, {said(outer / 2, 'diameter')}",
            )
        at = None if self.bend is None else self.bend.position
        if at is not None and at > self.length:
            raise refuse(
                "bend",
                "position",
                got=at,
                want=f"at most the length of the item, {said(self.length, 'length')}",
            )
        return self


class Tube(Flexible):
    """A round tube of one material."""

    od: Diameter = Field(description="outer diameter")
    id: Bore = Field(default=0.0, description="inner diameter")
    material: Material = derived_default("material of this item; keys left out are the case's")


class ToolTube(Tube):
    """A tube in which the mud may flow through sections other than its od and id: pipe, or a tool."""

    bore_volume: BoreVolume = Field(default=None, description=_BORE_VOLUME)
    annulus_od: Diameter | None = Field(default=None, description=_ANNULUS_OD)


class Pipe(ToolTube):
    """A plain round tube, without tool joints."""

    kind: Literal["pipe"] = Field(description="plain round tube")
    length: PipeLength = Field(description=PIPE_LENGTH)


class Tool(ToolTube):
    """A tool of which a string sheet has diameters and weight, such as an MWD: a tube whose stiffnesses may be given."""

    kind: Literal["tool"] = Field(description="tool of given diameters and weight")
    axial_stiffness: Annotated[float, Quantity("N", above=0, kind="none")] | None = Field(
        default=None, description="axial stiffness EA; of the tube when not given"
    )
    bending_stiffness: Annotated[float, Quantity("N m^2", above=0)] | None = Field(
        default=None, description="bending stiffness EI; of the tube when not given"
    )
    torsional_stiffness: Annotated[float, Quantity("N m^2", above=0)] | None = Field(
        default=None, description="torsional stiffness GJ; of the tube when not given"
    )

    @property
    def given_stiffness(self) -> dict[str, float]:
        """The stiffnesses that are given, by their keys: EA [N], EI, GJ [N m2]."""
        keys = ("axial_stiffness", "bending_stiffness", "torsional_stiffness")
        return {key: value for key in keys if (value := getattr(self, key)) is not None}


class Beam(Flexible):
    """An item given by its stiffnesses, for anything that is not a round tube."""

    kind: Literal["beam"] = Field(description="item given by its stiffnesses")
    axial_stiffness: Annotated[float, Quantity("N", above=0, kind="none")] = Field(
        description="axial stiffness EA"
    )
    bending_stiffness: Annotated[float, Quantity("N m^2", above=0)] = Field(
        description="bending stiffness EI"
    )
    torsional_stiffness: Annotated[float, Quantity("N m^2", above=0)] = Field(
        description="torsional stiffness GJ"
    )
    mass: Annotated[float, Quantity("kg/m", above=0)] = derived_default("mass per length; or give the weight")
    polar_inertia: Annotated[float, Quantity("kg m", above=0)] = Field(
        description="polar mass moment of inertia per length"
    )
    od: Diameter | None = Field(default=None, description="outer diameter; needed in a well and with a fluid")
    id: Bore = Field(default=0.0, description="inner diameter")
    damping: Damping = derived_default("damping; keys left out are the case's material.damping")

    @model_validator(mode="after")
    def _mass_or_weight(self) -> Beam:
        if self.mass is None and self.weight is None:
            raise refuse("mass", want="this key, or weight; it has no default")
        return self


class Rigid(Item):
    """A rigid item: its lower end moves with its upper end."""

    length: RigidLength = Field(default=0.0, description="length")
    od: Diameter | None = Field(default=None, description="outer diameter")
    id: Bore = Field(default=0.0, description="inner diameter")
    mass: Annotated[float, Quantity("kg", at_least=0)] = derived_default(
        "mass; when not given, the mass of a tube with this od, id, length and density"
    )
    unbalance: Annotated[float, Quantity("kg m", at_least=0)] = Field(
        default=0.0, description="mass times offset of the mass centre from the axis"
    )
    unbalance_angle: Angle = Field(default=0.0, description="direction of the unbalance in the section")
    inertia: Inertia = Field(default=Inertia(), description="moments of inertia about the centre of gravity")
    center_of_gravity: Annotated[tuple[float, float, float], Vector("m", along_x=True)] = derived_default(
        "distance below the item's upper end along the axis, or [distance, two offsets across the axis]; "
        "half the length when not given"
    )
    material: Material = derived_default(
        "material of this item (for its density); keys left out are the case's"
    )
    bore_volume: BoreVolume = Field(default=None, description=_BORE_VOLUME)
    annulus_od: Diameter | None = Field(
        default=None,
        description="diameter of a cylinder of the item's length that displaces as much mud; by its metal, mass over density, when not given",
    )

    @model_validator(mode="after")
    def _mass_known(self) -> Rigid:
        if self.mass is None and self.weight is None and self.od is None and self.has_own_od:
            raise refuse("mass", want="a mass, or an outer diameter (od) and a length to compute it from")
        if self.center_of_gravity is None:
            self.fill_defaults(center_of_gravity=(0.5 * self.length, 0.0, 0.0))
        at = None if self.bend is None else self.bend.position
        if at is not None and abs(at - self.length) > 1e-6:
            raise refuse(
                "bend",
                "position",
                got=at,
                want=f"{said(self.length, 'length')}, the upper end: a rigid item bends there only",
                hint="kind: pipe bends at any position",
            )
        return self

    @property
    def touching(self) -> tuple[float, float]:
        """(distance below the item's upper end, length) of the part that touches the hole [m]."""
        return 0.0, self.length


def _area_of_nozzles(item: Bit | Stabilizer, od: float | None, what: str) -> float | None:
    """Flow area [m2] of the nozzles of an item, by their sizes or as given; None without any.

    od: of the item [m], None: not known yet; what: the item, for the message of an area above its face.
    """
    area = item.nozzle_area
    if item.nozzles is not None:
        sum_ = math.fsum(math.pi / 4 * d**2 for d in item.nozzles)
        if area is not None and abs(area - sum_) > 1e-9 * sum_:
            want = f"nozzles or nozzle_area, not both: the nozzles have {said(sum_, 'flow_area')}"
            raise refuse("nozzle_area", got=area, want=want)
        area = sum_
    if area is not None and od is not None and area > math.pi / 4 * od**2:
        key = "nozzle_area" if item.nozzles is None else "nozzles"
        want = f"at most the area of {what}, {said(math.pi / 4 * od**2, 'flow_area')}"
        raise refuse(key, got=said(area, "flow_area"), want=want)
    return area


class Stabilizer(Rigid):
    """A stabilizer: contact with the hole over its blades, or over its length when blade_length is not given."""

    has_own_od: ClassVar[bool] = False

    kind: Literal["stabilizer"] = Field(description="stabilizer")
    length: RigidLength = Field(description="length")
    od: Diameter = derived_default("outer diameter over the blades; or give blade_od, or gauge")
    blade_od: Diameter | None = Field(default=None, description="outer diameter over the blades, sets od")
    gauge: str | None = Field(
        default=None,
        description="outer diameter over the blades relative to the bit: full, or 1/8 in under; sets od",
    )
    blade_length: Annotated[float, Quantity("m", above=0, at_most=200, kind="diameter")] | None = Field(
        default=None, description="length of the blades, which touch the hole; the whole item when not given"
    )
    blade_position: Annotated[float, Quantity("m", at_least=0, at_most=200, kind="none")] = derived_default(
        "height of the middle of the blades above the item's lower end; the middle of the item when not given"
    )
    body_od: Diameter | None = Field(
        default=None, description="outer diameter between the blades; for mass and the flow past the item"
    )
    bypass_area: Annotated[float, Quantity("m^2", above=0, at_most=10)] | None = Field(
        default=None,
        description="flow area past the blades; when not given, the hole minus body and blades, which "
        "fill 45 % of the ring between body_od and od",
    )
    stiff: bool = Field(
        default=True, strict=True, description="true: a rigid item; false: its body bends, its blades do not"
    )
    bend: Bend | None = Field(default=None, description="bent sub: kink at the item's upper end")
    nozzle_area: NozzleArea = Field(
        default=None,
        description="total flow area of nozzles in the side of the item, from the bore to the annulus; none when not given",
    )
    nozzles: NozzleSizes = Field(
        default=None,
        description="diameters of nozzles in the side of the item, `2 x 14/32 in` or [14, 14] in 32nds of an inch; sets nozzle_area",
    )

    @model_validator(mode="after")
    def _side_nozzles(self) -> Stabilizer:
        od = self.blade_od if self.od is None else self.od
        self.fill_defaults(nozzle_area=_area_of_nozzles(self, od, "the item"))
        return self

    @model_validator(mode="after")
    def _blades(self) -> Stabilizer:
        given = [key for key in ("od", "blade_od", "gauge") if getattr(self, key) is not None]
        if not given:
            raise refuse("od", want="an outer diameter over the blades: od, blade_od or gauge")
        if len(given) > 1:
            raise refuse(
                given[1],
                got=getattr(self, given[1]),
                want=f"one of od, blade_od and gauge, not {given[0]}, too",
            )
        if self.blade_od is not None:
            self.fill_defaults(od=self.blade_od, blade_od=None)
        span, at = self.blade_length, self.blade_position
        if span is None:
            for key in ("blade_position", "bypass_area"):
                if getattr(self, key) is not None:
                    raise refuse("blade_length", want=f"a length of the blades together with {key}")
        else:
            if span > self.length + 1e-9:
                raise refuse(
                    "blade_length",
                    got=span,
                    want=f"at most the length of the item, {said(self.length, 'length')}",
                )
            at = 0.5 * self.length if at is None else at
            if not span / 2 - 1e-9 <= at <= self.length - span / 2 + 1e-9:
                want = f"blades inside the item: {said(span / 2, 'length')} to {said(self.length - span / 2, 'length')} above its lower end"
                raise refuse("blade_position", got=at, want=want)
            self.fill_defaults(blade_position=at)
        if self.body_od is not None:
            for key, below, above in (("od", self.body_od, self.od), ("body_od", self.id, self.body_od)):
                if below is not None and above is not None and below > above:
                    want = f"at least {'body_od' if key == 'od' else 'id'}, {said(below, 'diameter')}"
                    raise refuse(key, got=above, want=want)
        if not self.stiff and (self.body_od is None or span is None):
            raise refuse("stiff", got=False, want="a body_od and a blade_length together with stiff: false")
        return self

    @property
    def touching(self) -> tuple[float, float]:
        if self.blade_length is None:
            return 0.0, self.length
        return max(0.0, self.length - self.blade_position - 0.5 * self.blade_length), self.blade_length


class Body(Rigid):
    """Any other rigid item; contact with the hole if it has an outer diameter."""

    kind: Literal["body"] = Field(description="rigid body")
    bend: Bend | None = Field(default=None, description="bent sub: kink at the item's upper end")


class Bit(Rigid):
    """The bit: the last item."""

    kind: Literal["bit"] = Field(description="bit")
    length: RigidLength = Field(description="length")
    od: Diameter = Field(description="diameter of the bit")
    side: Literal["guided", "cutting", "rolling"] | None = derived_default(
        "side of the bit in its hole. guided: friction brakes its rotation and does not push it round the hole; cutting: it rolls "
        "and slides on rock that yields at formation.strength; rolling: the same on a wall that does not yield. When not given, "
        "cutting with a formation whose strength is given, otherwise guided"
    )
    gauge_length: Annotated[float, Quantity("m", above=0, at_most=2, kind="diameter")] = Field(
        default=0.05, description="length of the gauge in contact with the rock (side: cutting)"
    )
    gauge_width: Annotated[float, Quantity("m", above=0, at_most=1, kind="diameter")] = derived_default(
        "width of the gauge in contact with the rock, one blade (side: cutting); a tenth of od when not given"
    )
    bit_type: Literal["PDC", "roller_cone", "diamond", "core"] | None = Field(
        default=None, description="type of the bit; only shown in reports"
    )
    nozzle_area: NozzleArea = Field(
        default=None,
        description="total flow area of the nozzles (used by a fluid); the open bore when not given",
    )
    nozzles: NozzleSizes = Field(
        default=None,
        description="diameters of the nozzles, `3 x 12/32 in` or [12, 12, 12] in 32nds of an inch; sets nozzle_area",
    )

    @model_validator(mode="after")
    def _flow_area(self) -> Bit:
        self.fill_defaults(nozzle_area=_area_of_nozzles(self, self.od, "the bit"))
        if self.gauge_width is None:
            self.fill_defaults(gauge_width=0.1 * self.od)
        return self
