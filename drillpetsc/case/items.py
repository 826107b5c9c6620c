"""String items for Python: `DrillPipe("5in 19.50 S-135 NC50 premium", length="9200 ft")`.

An item is a mapping as in the list `string` of a case file, with the keys of its kind. Values are written as in the
case file: text carries a unit, and a bare number has the unit set by the case. They are read when the case is made,
because a unit of bare numbers belongs to a case. An unknown key is refused at once.
"""

from __future__ import annotations

import inspect
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, TypedDict, Unpack

from drillpetsc.case.trade_words import key_hint
from drillpetsc.errors import CaseError

Value = str | float
"""A text with a unit, or a number in the unit of the case."""
Keys = Mapping[str, Any]
"""A block inside an item, such as `{"connection": "NC50", "od": "6 5/8 in"}`."""


class _Any(TypedDict, total=False):
    name: str
    weight: Value
    friction: Value
    pressure_loss: Keys


class _MudSections(TypedDict, total=False):
    bore_volume: Value
    annulus_od: Value


class _Flexible(_Any, total=False):
    length: Value
    element_length: Value
    eccentricity: Value
    eccentricity_angle: Value
    curvature: Value
    curvature_angle: Value
    bend: Keys
    initial: Keys
    od: Value
    id: Value


class _Pipe(_Flexible, total=False):
    material: Keys


class _Beam(_Flexible, total=False):
    axial_stiffness: Value
    bending_stiffness: Value
    torsional_stiffness: Value
    mass: Value
    polar_inertia: Value
    damping: Keys


class _Tubular(_Pipe, total=False):
    wall: Value
    adjusted_weight: Value
    grade: str
    yield_strength: Value
    contact_on: str
    override: bool


class _Jointed(_Tubular, total=False):
    tool_joint: Keys
    joint_length: Value
    range: int
    stiffness: str
    clearance: str


class _DrillPipe(_Jointed, total=False):
    nominal_weight: Value
    class_: str
    remaining_wall: Value


class _HeavyPipe(_Jointed, total=False):
    center_upset: Keys


class _DrillCollar(_Tubular, total=False):
    joint_length: Value
    spiral: bool
    spiral_weight_factor: Value
    nonmagnetic: bool


class _Casing(_Tubular, total=False):
    nominal_weight: Value


class _Tube(_Pipe, _MudSections, total=False):
    pass


class _SheetTool(_Tube, total=False):
    axial_stiffness: Value
    bending_stiffness: Value
    torsional_stiffness: Value


class _RotarySteerable(_Tube, total=False):
    rss: Keys
    joint_at: Value
    mass: Value


class _Tool(_Tube, total=False):
    mass: Value
    joint_at: Value
    seal_area: Value
    stop_stiffness: Value
    stroke: Sequence[Value]


class _Jar(_Tube, total=False):
    mass: Value
    joint_at: Value
    jar: Keys


class _ShockSub(_Tool, total=False):
    stiffness: Value
    damping: Value
    preload: Value
    torsion_stiffness: Value


class _Rigid(_Any, _MudSections, total=False):
    length: Value
    od: Value
    id: Value
    mass: Value
    unbalance: Value
    unbalance_angle: Value
    inertia: Keys
    center_of_gravity: Value | Sequence[Value]
    material: Keys


class _Stabilizer(_Rigid, total=False):
    blade_od: Value
    gauge: str
    blade_length: Value
    blade_position: Value
    body_od: Value
    bypass_area: Value
    stiff: bool
    bend: Keys
    nozzle_area: Value
    nozzles: Value | Sequence[Value]


class _Reamer(_Stabilizer, total=False):
    pilot: Value
    blades: int
    specific_energy: Value
    inclination_ratio: Value


class _Body(_Rigid, total=False):
    bend: Keys


class _Bit(_Rigid, total=False):
    side: str
    gauge_length: Value
    gauge_width: Value
    bit_type: str
    nozzle_area: Value
    nozzles: Value | Sequence[Value]


class _Motor(_Tube, total=False):
    pdm: Keys
    mass: Value
    joint_at: Value


class StringItem(dict[str, Any]):
    """A string item: a mapping of the keys of a case file. Use the class of a kind, such as `DrillPipe`.

    Raises CaseError for a key that the kind does not have, and for a text reference or a length that is missing.
    """

    kind: ClassVar[str]
    """Value of the key `kind`."""
    key_types: ClassVar[Any]
    """The keys that may be given, with their types; `class` is written `class_`."""
    required: ClassVar[tuple[str, ...]] = ()
    first: ClassVar[dict[str, Any]] = {}
    """The key that may be given without its name, and its type."""

    def __init_subclass__(cls) -> None:
        """Give the class the signature of its keys, for the help of a notebook."""
        keys = cls.first | cls.key_types.__annotations__
        cls.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
            [
                inspect.Parameter(
                    name,
                    inspect.Parameter.POSITIONAL_OR_KEYWORD
                    if name in cls.first
                    else inspect.Parameter.KEYWORD_ONLY,
                    default=inspect.Parameter.empty if name in cls.required else None,
                    annotation=keys[name],
                )
                for name in sorted(keys, key=lambda name: (name not in cls.first, name not in cls.required))
            ]
        )

    def _fill(self, keys: Mapping[str, Any]) -> None:
        """Take over the keys that are not None; the others are left to their defaults."""
        allowed = self.first | self.key_types.__annotations__
        for key, value in keys.items():
            if key == "kind":
                raise CaseError(at="kind", got=value, want=f"no kind in {type(self).__name__}: {self.kind}")
            if key not in allowed:
                hint = key_hint(key, allowed)
                want = f"one of these keys ({type(self).__name__}): {', '.join(sorted(allowed))}"
                raise CaseError(at=key, got=value, want=want, hint=hint)
        for key in self.required:
            if keys.get(key) is None:
                raise CaseError(at=f"{type(self).__name__}: {key}", want="this key; it has no default")
        self["kind"] = self.kind
        self |= {key.removesuffix("_"): value for key, value in keys.items() if value is not None}

    def __repr__(self) -> str:
        given = ", ".join(
            f"{'class_' if key == 'class' else key}={value!r}" for key, value in self.items() if key != "kind"
        )
        return f"{type(self).__name__}({given})"


class Pipe(StringItem):
    """A plain round tube, without tool joints."""

    kind, key_types, required = "pipe", _Tube, ("length", "od")

    def __init__(self, **keys: Unpack[_Tube]) -> None:
        self._fill(keys)


class Tool(StringItem):
    """A tool of given diameters and weight, such as an MWD; its stiffnesses are a tube's unless given."""

    kind, key_types, required = "tool", _SheetTool, ("length", "od")

    def __init__(self, **keys: Unpack[_SheetTool]) -> None:
        self._fill(keys)


class Beam(StringItem):
    """An item given by its stiffnesses, for anything that is not a round tube."""

    kind, key_types = "beam", _Beam
    required = (
        "length",
        "axial_stiffness",
        "bending_stiffness",
        "torsional_stiffness",
        "polar_inertia",
    )

    def __init__(self, **keys: Unpack[_Beam]) -> None:
        self._fill(keys)


class DrillPipe(StringItem):
    """Drill pipe with tool joints, by a text reference to the catalogue or by its dimensions.

    pipe: text reference, such as `5in 19.50 S-135 NC50 premium`
    """

    kind, key_types, required = "drill_pipe", _DrillPipe, ("length",)
    first: ClassVar[dict[str, Any]] = {"pipe": str}

    def __init__(self, pipe: str | None = None, **keys: Unpack[_DrillPipe]) -> None:
        self._fill({"pipe": pipe, **keys})


class HWDP(StringItem):
    """Heavy-wall drill pipe, by a text reference to the catalogue or by its dimensions.

    pipe: text reference, such as `5in 49.3 NC50`
    """

    kind, key_types, required = "hwdp", _HeavyPipe, ("length",)
    first: ClassVar[dict[str, Any]] = {"pipe": str}

    def __init__(self, pipe: str | None = None, **keys: Unpack[_HeavyPipe]) -> None:
        self._fill({"pipe": pipe, **keys})


class DrillCollar(StringItem):
    """Drill collar, round or spiral."""

    kind, key_types, required = "drill_collar", _DrillCollar, ("length",)

    def __init__(self, **keys: Unpack[_DrillCollar]) -> None:
        self._fill(keys)


class Casing(StringItem):
    """Casing or liner that is run into the hole."""

    kind, key_types, required = "casing", _Casing, ("length",)

    def __init__(self, **keys: Unpack[_Casing]) -> None:
        self._fill(keys)


class CoiledTubing(StringItem):
    """Coiled tubing."""

    kind, key_types, required = "coiled_tubing", _Tubular, ("length",)

    def __init__(self, **keys: Unpack[_Tubular]) -> None:
        self._fill(keys)


class ShockSub(StringItem):
    """A shock sub: a spring and a damper between two parts that telescope."""

    kind, key_types, required = "shock_sub", _ShockSub, ("length", "od", "stiffness")

    def __init__(self, **keys: Unpack[_ShockSub]) -> None:
        self._fill(keys)


class BumperSub(StringItem):
    """A bumper sub: two parts that telescope freely between stops."""

    kind, key_types, required = "bumper_sub", _Tool, ("length", "od", "stroke")

    def __init__(self, **keys: Unpack[_Tool]) -> None:
        self._fill(keys)


class Jar(StringItem):
    """A jar: a latch that holds the load, then sets the parts free to hit a stop."""

    kind, key_types, required = "jar", _Jar, ("length", "od", "jar")

    def __init__(self, **keys: Unpack[_Jar]) -> None:
        self._fill(keys)


class Stabilizer(StringItem):
    """A stabilizer: contact with the hole over its blades, or over its length when blade_length is not given."""

    kind, key_types, required = "stabilizer", _Stabilizer, ("length",)

    def __init__(self, **keys: Unpack[_Stabilizer]) -> None:
        self._fill(keys)


class Body(StringItem):
    """Any other rigid item; contact with the hole if it has an outer diameter."""

    kind, key_types = "body", _Body

    def __init__(self, **keys: Unpack[_Body]) -> None:
        self._fill(keys)


class Bit(StringItem):
    """The bit: the last item."""

    kind, key_types, required = "bit", _Bit, ("length", "od")

    def __init__(self, **keys: Unpack[_Bit]) -> None:
        self._fill(keys)


class Reamer(StringItem):
    """A reamer: its blades cut the ring around the pilot hole of the bit."""

    kind, key_types, required = "reamer", _Reamer, ("length",)

    def __init__(self, **keys: Unpack[_Reamer]) -> None:
        self._fill(keys)


class RotarySteerable(StringItem):
    """A rotary steerable tool: `RotarySteerable(length="9 m", od="172 mm", rss={"kind": "point", "tilt": "0.6 deg"})`."""

    kind, key_types, required = "rss", _RotarySteerable, ("length", "od", "rss")

    def __init__(self, **keys: Unpack[_RotarySteerable]) -> None:
        self._fill(keys)


class _Agitator(_Tube, total=False):
    mass: Value
    joint_at: Value
    seal_area: Value
    stop_stiffness: Value
    agitator: Keys


class Agitator(StringItem):
    """An agitator: a valve in the mud shakes the string along its axis."""

    kind, key_types, required = "agitator", _Agitator, ("length", "od", "agitator")

    def __init__(self, **keys: Unpack[_Agitator]) -> None:
        self._fill(keys)


class MudMotor(StringItem):
    """Positive displacement motor: its housing is pipe, its rotor turns what hangs below its joint."""

    kind, key_types, required = "pdm", _Motor, ("length", "od", "pdm")

    def __init__(self, **keys: Unpack[_Motor]) -> None:
        self._fill(keys)


#: kind of a string item -> its class
ITEMS = {
    item.kind: item
    for item in (
        Pipe,
        Tool,
        Beam,
        DrillPipe,
        HWDP,
        DrillCollar,
        Casing,
        CoiledTubing,
        ShockSub,
        BumperSub,
        Jar,
        Stabilizer,
        Body,
        Bit,
        RotarySteerable,
        MudMotor,
        Agitator,
        Reamer,
    )
}
