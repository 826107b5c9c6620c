"""`string`: items of the string, from the surface down; and `material`."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag, model_validator

from drillpetsc.case.block import Block, derived_default, tagged_union
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import Quantity, Vector, WordOrNumber

Length = Annotated[float, Quantity("m", at_least=1e-3, at_most=50e3)]
RigidLength = Annotated[float, Quantity("m", at_least=0, at_most=200)]
Diameter = Annotated[float, Quantity("m", at_least=1e-4, at_most=2, kind="diameter")]
Bore = Annotated[float, Quantity("m", at_least=0, at_most=2, kind="diameter")]
Offset = Annotated[float, Quantity("m", at_least=0, at_most=1, kind="diameter")]
Angle = Annotated[float, Quantity("rad")]
Friction = Annotated[float, Quantity("", at_least=0, at_most=10)]


MIN_WALL_RATIO = 1e-4  # (od - id) over od [-]
MIN_BORE = 1e-4  # inner diameter [m]


_TOOL_FACE = (
    "0 is the high side, 90 deg to the right looking down the hole; measured from north where the inclination is below "
    "5 deg; at spin angle zero"
)


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
    """A kink at the upper end of an item (bent sub)."""

    angle: Annotated[float, Quantity("rad", at_least=0, at_most=math.pi / 2)] = Field(
        description="bend angle"
    )
    tool_face: Angle = Field(
        default=0.0, description="direction in which the string below the kink points: " + _TOOL_FACE
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

    unsupported_keys: ClassVar[tuple[str, ...]] = ("joints",)
    optional_attributes: ClassVar[Mapping[str, Any]] = {
        "bend": None,
        "initial": None,
        "material": None,
        "nozzle_area": None,
    }

    if TYPE_CHECKING:
        kind: str
        length: float
        od: float | None = None
        id: float = 0.0
        bend: Bend | None = None
        initial: ItemInitial | None = None
        material: Material | None = None
        nozzle_area: float | None = None

    name: str = Field(default="", description="name in reports; the kind when not given")
    friction: Friction | None = Field(
        default=None, description="friction coefficient of this item, instead of the hole section's"
    )

    @model_validator(mode="after")
    def _bore_inside(self) -> Item:
        outer, inner = self.od, self.id
        if outer is not None and inner >= outer:
            raise refuse("id", got=inner, want=f"an inner diameter below the outer, {outer:g} m")
        if outer is not None and inner > outer * (1 - MIN_WALL_RATIO):
            raise refuse(
                "id",
                got=inner,
                want=f"a wall of at least {MIN_WALL_RATIO / 2 * outer:g} m inside the outer diameter, {outer:g} m",
            )
        if 0 < inner < MIN_BORE:
            raise refuse("id", got=inner, want=f"0 (solid), or an inner diameter of at least {MIN_BORE:g} m")
        if outer is None and inner:
            raise refuse("id", got=inner, want="an inner diameter together with an outer one (od)")
        if not self.name:
            self.fill_defaults(name=self.kind)
        return self


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
                "eccentricity", got=self.eccentricity, want=f"at most the outer radius, {outer / 2:g} m"
            )
        return self


class Pipe(Flexible):
    """A round tube: drill pipe, collar, casing, coiled tubing."""

    kind: Literal["pipe"] = Field(description="round tube")
    od: Diameter = Field(description="outer diameter")
    id: Bore = Field(default=0.0, description="inner diameter")
    material: Material = derived_default("material of this item; keys left out are the case's")


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
    mass: Annotated[float, Quantity("kg/m", above=0)] = Field(description="mass per length")
    polar_inertia: Annotated[float, Quantity("kg m", above=0)] = Field(
        description="polar mass moment of inertia per length"
    )
    od: Diameter | None = Field(default=None, description="outer diameter; needed in a well and with a fluid")
    id: Bore = Field(default=0.0, description="inner diameter")
    damping: Damping = derived_default("damping; keys left out are the case's material.damping")


class Rigid(Item):
    """A rigid item: its lower end moves with its upper end."""

    length: RigidLength = Field(default=0.0, description="length")
    od: Diameter | None = Field(default=None, description="outer diameter")
    id: Bore = Field(default=0.0, description="inner diameter")
    mass: Annotated[float, Quantity("kg", at_least=0)] = derived_default(
        "mass; when not given, that of a tube with this od, id, length and density"
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

    @model_validator(mode="after")
    def _mass_known(self) -> Rigid:
        if self.mass is None and self.od is None:
            raise refuse("mass", want="a mass, or an outer diameter (od) and a length to compute it from")
        if self.center_of_gravity is None:
            self.fill_defaults(center_of_gravity=(0.5 * self.length, 0.0, 0.0))
        return self


class Stabilizer(Rigid):
    """A stabilizer: contact with the hole over its length."""

    kind: Literal["stabilizer"] = Field(description="stabilizer")
    length: RigidLength = Field(description="length")
    od: Diameter = Field(description="outer diameter over the blades")
    bend: Bend | None = Field(default=None, description="bent sub: kink at the item's upper end")


class Body(Rigid):
    """Any other rigid item; contact with the hole if it has an outer diameter."""

    kind: Literal["body"] = Field(description="rigid body")
    bend: Bend | None = Field(default=None, description="bent sub: kink at the item's upper end")


class Bit(Rigid):
    """The bit: the last item."""

    kind: Literal["bit"] = Field(description="bit")
    length: RigidLength = Field(description="length")
    od: Diameter = Field(description="diameter of the bit")
    nozzle_area: Annotated[float, Quantity("m^2", above=0, at_most=0.1)] | None = Field(
        default=None,
        description="total flow area of the nozzles (used by a fluid); the open bore when not given",
    )


_check, _tag = tagged_union(Pipe, Beam, Stabilizer, Body, Bit)

StringItem = Annotated[
    Annotated[Pipe, Tag("kind:Pipe")]
    | Annotated[Beam, Tag("kind:Beam")]
    | Annotated[Stabilizer, Tag("kind:Stabilizer")]
    | Annotated[Body, Tag("kind:Body")]
    | Annotated[Bit, Tag("kind:Bit")],
    Discriminator(_tag),
    BeforeValidator(_check),
]
