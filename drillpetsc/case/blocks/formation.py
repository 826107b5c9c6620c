"""`formation`: the rock, in layers, and how the bit cuts it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from pydantic import Field, model_validator

from drillpetsc.case.block import Block, ByKind, derived_default, overlaid
from drillpetsc.case.blocks.items.string import Friction
from drillpetsc.case.blocks.own_law import LawOfKind
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import Quantity, said

Drillability = Annotated[float, Quantity("m/(s N)", at_least=0, at_most=1e-3)]
BitAnisotropy = Annotated[
    float,
    Quantity(
        "",
        above=0,
        at_most=1,
        why="drillability sideways over drillability ahead of the bit; 1 for a bit that cuts equally in all directions",
    ),
]
RotaryExponent = Annotated[float, Quantity("", at_least=0, at_most=3)]
WeightExponent = Annotated[float, Quantity("", at_least=0.1, at_most=4)]
Threshold = Annotated[float, Quantity("N", at_least=0)]
Index = Annotated[
    float,
    Quantity(
        "",
        above=0,
        at_most=2,
        why="drillability along the bedding over drillability across it; mostly 0.9 to 1.1",
    ),
]
Depth = Annotated[float, Quantity("m", at_least=0, at_most=50e3)]
Stiffness = Annotated[float, Quantity("N/m", above=0)] | None

SAME_DEPTH = 1e-6  # [m] between the end of a layer and the beginning of the next
LAYER_KEYS = (
    "drillability",
    "bit_anisotropy",
    "rock_anisotropy",
    "rotary_exponent",
    "weight_exponent",
    "threshold",
)

_DRILLABILITY = "rate of penetration over force, at reference_speed and reference_weight; 0 cannot be drilled"
_BIT = "drillability sideways over drillability ahead of the bit"
_ROCK = "bedding of the rock"
_ROTARY = "exponent of the rotation speed over reference_speed"
_WEIGHT = "exponent of the weight on bit over reference_weight in the rate of penetration"
_THRESHOLD = "weight on bit below which the bit does not cut"
_STIFFNESS = "contact stiffness of bit on rock; bottom.stiffness is set to this value"


class RockAnisotropy(Block):
    """Bedded rock: M_r = n n^T + index_dip d d^T + index_strike s s^T, n across the bedding, d down dip, s
    along strike."""

    dip: Annotated[float, Quantity("rad", at_least=0, at_most=math.pi / 2)] = Field(
        default=0.0, description="angle of the bedding from the horizontal"
    )
    dip_azimuth: Annotated[float, Quantity("rad", at_least=-2 * math.pi, at_most=2 * math.pi)] = Field(
        default=0.0, description="azimuth of the down-dip direction, from north over east"
    )
    index_dip: Index = Field(
        default=1.0, description="drillability down dip over drillability across the bedding"
    )
    index_strike: Index = Field(
        default=1.0, description="drillability along strike over drillability across the bedding"
    )


class Layer(Block):
    """An interval of other rock. Keys left out have the values of the formation."""

    from_: Depth = Field(alias="from", description="measured depth of the upper end")
    to: Depth = derived_default(
        "measured depth of the lower end, equal to the next layer's from. When not given: the next layer's from, and "
        "no end for the last layer. Below the last layer the formation's values hold again."
    )
    drillability: Drillability = derived_default(_DRILLABILITY)
    bit_anisotropy: BitAnisotropy = derived_default(_BIT)
    rock_anisotropy: RockAnisotropy = derived_default(_ROCK + "; keys left out are the formation's")
    rotary_exponent: RotaryExponent = derived_default(_ROTARY)
    weight_exponent: WeightExponent = derived_default(_WEIGHT)
    threshold: Threshold = derived_default(_THRESHOLD)


class PatternOrder(Block):
    """A wave of the bottom's surface under a roller cone."""

    order: Annotated[float, Quantity("", above=0, at_most=100)] = Field(
        description="waves per turn of the bit"
    )
    amplitude: Annotated[float, Quantity("m", at_least=0, at_most=0.1, kind="diameter")] = Field(
        description="half the height from valley to crest"
    )
    phase: Annotated[float, Quantity("rad", at_least=-2 * math.pi, at_most=2 * math.pi)] = Field(
        default=0.0, description="phase at the start: at 0 the bit is half-way up, at 90 deg on a crest"
    )


class AnyLaw(Block):
    """Base of all bit laws."""

    if TYPE_CHECKING:
        kind: str

    @property
    def orders(self) -> tuple[PatternOrder, ...]:
        """Waves of the bottom's surface; empty for a plane bottom."""
        return ()

    @property
    def torque_law(self) -> AnyLaw:
        """The law on a plane bottom."""
        return self


class RopLaw(AnyLaw):
    """Rate of penetration from force and rotation speed. The torque comes from friction (bottom.friction)."""

    kind: Literal["rop"] = Field(description="rate of penetration from force and rotation speed")
    stiffness: Stiffness = Field(default=None, description=_STIFFNESS)


class DragBit(AnyLaw):
    """Blades that cut and rub (Detournay and Defourny). Each blade cuts in the groove left by the one before."""

    kind: Literal["drag_bit"] = Field(description="blades that cut and rub")
    blades: int = Field(default=4, ge=1, le=20, strict=True, description="number of blades")
    specific_energy: Annotated[float, Quantity("Pa", above=0)] = Field(
        default=60e6,
        description="intrinsic specific energy: work of cutting per volume of rock, 1 J/m3 = 1 Pa",
    )
    inclination_ratio: Annotated[float, Quantity("", above=0, at_most=10)] = Field(
        default=0.6, description="vertical over horizontal force of a cutter"
    )
    contact_stress: Annotated[float, Quantity("Pa", at_least=0)] = Field(
        default=60e6, description="largest stress between wear flats and rock"
    )
    wear_flat: Annotated[float, Quantity("m", at_least=0, at_most=1, kind="diameter")] = Field(
        default=1.2e-3, description="width of all wear flats together; 0 for a sharp bit"
    )
    friction: Friction = Field(
        default=0.6,
        description="friction coefficient of the wear flats times the shape factor of the bit, mu gamma",
    )
    exposure: Annotated[float, Quantity("m", above=0, at_most=0.1, kind="diameter")] = Field(
        default=6.5e-3,
        description="cutter exposure above the blades. It limits the cut of a blade per passage; the rest of the weight presses "
        "the body on the rock. Default: half the diameter of a 13 mm cutter",
    )
    stiffness: Stiffness = Field(default=None, description=_STIFFNESS)


class VelocityWeakening(AnyLaw):
    """A torque that falls from a static to a dynamic value with the rotation speed, a cause of stick-slip."""

    kind: Literal["velocity_weakening"] = Field(description="torque that falls with the rotation speed")
    static: Annotated[float, Quantity("N m", at_least=0)] | None = Field(
        default=None, description="torque at which the bit breaks loose"
    )
    dynamic: Annotated[float, Quantity("N m", at_least=0)] | None = Field(
        default=None, description="torque at high speed"
    )
    static_friction: Friction | None = Field(
        default=None,
        description="static torque over weight on bit times 2/3 of the bit's radius, instead of static",
    )
    dynamic_friction: Friction | None = Field(
        default=None,
        description="dynamic torque over weight on bit times 2/3 of the bit's radius, instead of dynamic",
    )
    speed: Annotated[float, Quantity("rad/s", above=0)] = Field(
        description="rotation speed over which the torque falls"
    )
    stiffness: Stiffness = Field(default=None, description=_STIFFNESS)

    @model_validator(mode="after")
    def _one_pair(self) -> VelocityWeakening:
        torques, frictions = ("static", "dynamic"), ("static_friction", "dynamic_friction")
        of_torques, of_frictions = (
            [key for key in keys if getattr(self, key) is not None] for keys in (torques, frictions)
        )
        want = "static and dynamic (torques), or static_friction and dynamic_friction (over the weight on bit): one of the two pairs"
        if of_torques and of_frictions:
            raise refuse(of_frictions[0], got=getattr(self, of_frictions[0]), want=want)
        high_key, low_key = pair = frictions if of_frictions else torques
        for key in pair:
            if getattr(self, key) is None:
                raise refuse(key, want=want)
        high, low = getattr(self, high_key), getattr(self, low_key)
        if low > high:
            want = f"at most {high_key}, {high:g}{' N m' if pair is torques else ''}: the torque falls as the bit turns faster"
            raise refuse(low_key, got=low, want=want)
        return self


class OwnBitLaw(AnyLaw, LawOfKind):  # type: ignore[misc]  # kind: one of its words
    """A law of the user that gives the torque on bit, and if it likes the rate of penetration, from the state of the bit."""

    of: ClassVar[str] = "BIT"

    stiffness: Stiffness = Field(default=None, description=_STIFFNESS)


class OwnRockLaw(LawOfKind):
    """A law of the user that gives the strength of the rock from the depth."""

    of: ClassVar[str] = "ROCK"


BaseLaw = Annotated[RopLaw | VelocityWeakening | OwnBitLaw, ByKind("rop")]


class RollerCone(AnyLaw):
    """Cones that roll on lobes of the bottom: its surface moves the turning bit up and down. The bit can lift off."""

    kind: Literal["roller_cone"] = Field(description="cones that roll on lobes of the bottom")
    lobes: Annotated[int, Field(ge=1, le=100, strict=True)] | None = Field(
        default=None, description="lobes of the bottom, waves per turn; 3 when not given"
    )
    amplitude: Annotated[float, Quantity("m", at_least=0, at_most=0.1, kind="diameter")] | None = Field(
        default=None, description="half the height of the lobes, from valley to crest"
    )
    phase: Annotated[float, Quantity("rad", at_least=-2 * math.pi, at_most=2 * math.pi)] | None = Field(
        default=None,
        description="phase of the lobes at the start: at 0 the bit is half-way up, at 90 deg on a crest; 0 when not given",
    )
    pattern: Annotated[tuple[PatternOrder, ...], Field(max_length=50)] = Field(
        default=(),
        description="several waves, [{order: 3, amplitude: 3 mm}, ...], instead of lobes and amplitude",
    )
    base: BaseLaw = Field(
        default=RopLaw(kind="rop"),
        description="law of torque and rate of penetration: rop, velocity_weakening, or python",
    )
    stiffness: Stiffness = Field(default=None, description=_STIFFNESS)

    @model_validator(mode="after")
    def _one_pattern(self) -> RollerCone:
        given = [key for key in ("lobes", "amplitude", "phase") if getattr(self, key) is not None]
        if self.pattern and given:
            raise refuse(given[0], got=getattr(self, given[0]), want=f"pattern, or {given[0]}, not both")
        if not self.pattern and self.amplitude is None:
            raise refuse("amplitude", want="the amplitude of the lobes, or a pattern of several waves")
        if self.base.stiffness is not None:
            raise refuse(
                "base",
                "stiffness",
                got=self.base.stiffness,
                want="the stiffness in the roller_cone law, not in its base",
            )
        return self

    @property
    def orders(self) -> tuple[PatternOrder, ...]:
        if self.pattern:
            return self.pattern
        return (
            PatternOrder(order=self.lobes or 3, amplitude=self.amplitude or 0.0, phase=self.phase or 0.0),
        )

    @property
    def torque_law(self) -> AnyLaw:
        return self.base


BitLaw = Annotated[RopLaw | DragBit | VelocityWeakening | RollerCone | OwnBitLaw, ByKind("rop", "drag_bit")]


class Formation(Block):
    """The rock below the bit. velocity = D (speed/reference)^a (weight/reference)^(b-1) M_r M_b force."""

    drillability: Drillability = Field(default=2.8e-8, description=_DRILLABILITY)
    bit_anisotropy: BitAnisotropy = Field(default=0.2, description=_BIT)
    rock_anisotropy: RockAnisotropy = Field(default=RockAnisotropy(), description=_ROCK)
    rotary_exponent: RotaryExponent = Field(default=1.0, description=_ROTARY)
    weight_exponent: WeightExponent = Field(default=1.0, description=_WEIGHT)
    threshold: Threshold = Field(default=0.0, description=_THRESHOLD)
    reference_speed: Annotated[float, Quantity("rad/s", above=0)] = Field(
        default=4 * math.pi, description="rotation speed at which the drillability is given"
    )
    reference_weight: Annotated[float, Quantity("N", above=0)] = Field(
        default=1e5, description="weight on bit at which the drillability is given"
    )
    walk: Annotated[float, Quantity("rad", at_least=-math.pi / 4, at_most=math.pi / 4)] = Field(
        default=0.0,
        description="walk angle about the bit's axis, from the side force to the sideways motion of the bit",
    )
    overgauge: Annotated[float, Quantity("m", kind="diameter")] = Field(
        default=0.0,
        description="radius of the new hole minus radius of the bit; negative for an under-gauge hole",
    )
    strength: Annotated[float, Quantity("Pa", at_least=5e6, at_most=250e6)] | None = Field(
        default=None,
        description="compressive strength of the rock, at which the wall yields to a bit with side: cutting; 60 MPa for such a bit "
        "when not given",
    )
    young: Annotated[float, Quantity("Pa", at_least=1e8, at_most=200e9)] | None = Field(
        default=None,
        description="Young's modulus of the rock; sets the wall stiffness for contact.stiffness: physical and a bit with side: "
        "cutting; 20 GPa when not given",
    )
    growth: Literal["state", "post_step"] = Field(
        default="state",
        description="state: the hole's end is integrated with the string; post_step: moved after each step (for comparison)",
    )
    direction: Literal["rop_vector", "bit_axis"] = Field(
        default="rop_vector",
        description="rop_vector: the hole grows along the velocity of penetration; bit_axis: along the bit's axis, with the component "
        "of the velocity in that direction",
    )
    node_spacing: Annotated[float, Quantity("m", above=0, at_most=10)] = Field(
        default=0.5, description="distance between the nodes of the drilled hole"
    )
    layers: tuple[Layer, ...] = Field(
        default=(),
        description="other rock, from the first layer down; above the first layer the values of this block hold",
    )
    rock_law: OwnRockLaw | None = Field(
        default=None,
        description="the strength of the rock as a function of depth, relative to the rock that the other keys describe: so many times "
        "the force is needed for the same rate, or of a drag bit for the same cut; none when not given",
    )
    bit_law: BitLaw = Field(default=RopLaw(kind="rop"), description="torque and weight of the bit as it cuts")

    @model_validator(mode="after")
    def _rock(self) -> Formation:
        check_turning(self.bit_anisotropy, self.rock_anisotropy, self.walk, ("rock_anisotropy",))
        _check_depths(self.layers)
        self.fill_defaults(layers=self._complete_layers())
        return self

    def _complete_layers(self) -> tuple[Layer, ...]:
        """The layers with all values filled in.

        Below a last layer that has an end, one more layer with the values of the formation is added.
        """
        whole: list[Layer] = []
        for i, layer in enumerate(self.layers):
            end = self.layers[i + 1].from_ if i + 1 < len(self.layers) else layer.to
            values = {key: getattr(self if getattr(layer, key) is None else layer, key) for key in LAYER_KEYS}
            values["rock_anisotropy"] = overlaid(self.rock_anisotropy, layer.rock_anisotropy)
            key = "bit_anisotropy" if layer.rock_anisotropy is None else "rock_anisotropy"
            check_turning(values["bit_anisotropy"], values["rock_anisotropy"], self.walk, ("layers", i, key))
            whole.append(layer.model_copy(update={"to": end, **values}))
        if whole and whole[-1].to is not None:
            own = {key: getattr(self, key) for key in LAYER_KEYS}
            whole.append(whole[-1].model_copy(update={"from_": whole[-1].to, "to": None, **own}))
        return tuple(whole)


def level_bottom(formation: Formation | None) -> Formation | None:
    """The formation with a plane bottom, the mean of the lobes under a roller cone."""
    if formation is None or not formation.bit_law.orders:
        return formation
    return formation.model_copy(update={"bit_law": formation.bit_law.torque_law})


def _check_depths(layers: tuple[Layer, ...]) -> None:
    """Refuse layers that do not follow one another downward without a gap or an overlap."""
    for i, layer in enumerate(layers):
        if i and layer.from_ <= layers[i - 1].from_:
            want = (
                f"rising depths: below the layer above, which begins at {said(layers[i - 1].from_, 'length')}"
            )
            raise refuse("layers", i, "from", got=layer.from_, want=want)
        if layer.to is not None and layer.to <= layer.from_:
            raise refuse("layers", i, "to", got=layer.to, want=f"below from, {said(layer.from_, 'length')}")
    for i, (layer, below) in enumerate(zip(layers, layers[1:], strict=False), 1):
        if layer.to is None or abs(below.from_ - layer.to) <= SAME_DEPTH:
            continue
        ends = f"{said(min(layer.to, below.from_), 'length')} to {said(max(layer.to, below.from_), 'length')}"
        gap = (
            f"formation gap: no rock from {ends}"
            if below.from_ > layer.to
            else f"formation overlap: two layers from {ends}"
        )
        raise refuse(
            "layers",
            i,
            "from",
            got=below.from_,
            want=f"{said(layer.to, 'length')}, the end of the layer above",
            hint=gap,
        )


def largest_turn_of_rock(rock: RockAnisotropy) -> float:
    """Largest angle [rad] between a vector x and M_r x.

    For a symmetric positive definite matrix of condition number k it is arcsin((k - 1)/(k + 1)), in the plane
    of the extreme eigenvectors (Gustafson and Rao, Numerical Range, 1997: the antieigenvalue).
    """
    indices = (1.0, rock.index_dip, rock.index_strike)
    ratio = max(indices) / min(indices)
    return math.asin((ratio - 1) / (ratio + 1))


def largest_turn_of_bit(sideways: float, walk: float) -> float:
    """Largest angle [rad] between x and M_b x, M_b = e e^T + I W (1 - e e^T), W turning by the walk about e;
    I in (0, 1].

    With u = (part of x across e)^2 / (part along e)^2 and c = cos(walk) the cosine of the angle is
    (1 + I c u) / sqrt((1 + u)(1 + I^2 u)). Its one stationary point is the minimum
    u = (1 + I^2 - 2 I c) / (I (c (1 + I^2) - 2 I)); if that is not positive, the cosine falls to c at u =
    infinity.
    """
    c, square = math.cos(walk), sideways**2
    slope = c * (1 + square) - 2 * sideways
    if slope <= 0:
        return abs(walk)
    u = (1 + square - 2 * sideways * c) / (sideways * slope)
    return math.acos(min(1.0, (1 + sideways * c * u) / math.sqrt((1 + u) * (1 + square * u))))


def check_turning(sideways: float, rock: RockAnisotropy, walk: float, at: tuple[str | int, ...]) -> None:
    """Refuse rock and bit for which the symmetric part of M_r M_b is not positive definite.

    x . M_r M_b x = (M_r x) . (M_b x) is positive for all x as long as the angle between M_r x and M_b x is
    less than a right angle. The bit's axis may have any direction. So both largest angles can occur for one x
    in one plane, on opposite sides of x. Their sum must be below a right angle.

    sideways: bit anisotropy [-]
    rock: indices of the rock
    walk: walk angle [rad]
    at: key path for the message
    """
    bit = largest_turn_of_bit(sideways, walk)
    if largest_turn_of_rock(rock) + bit < math.pi / 2:
        return
    most = (1 + math.cos(bit)) / (1 - math.cos(bit))
    beside = f" and walk {math.degrees(walk):g} deg" if walk else ""
    want = (f"indices of the rock, 1 (across the bedding), {rock.index_dip:g} (dip) and {rock.index_strike:g} (strike), whose "
            f"largest is below {most:.4g} times the smallest, with bit_anisotropy {sideways:g}{beside}")  # fmt: skip
    hint = "with these the bit could move against the force on it: take a larger bit_anisotropy, or indices nearer 1"
    raise refuse(*at, want=want, hint=hint)
