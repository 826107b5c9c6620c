"""Types of the values in a case: numbers with a unit, vectors, values over time.

Used as `Annotated[float, Quantity("m", above=0, at_most=20e3)]`. Unit and bounds are written here only:
messages, schema, the manual and plots read them from here. Bounds are in SI. A bare number is in SI, or in the unit
that the case's `units` has for the kind of the quantity.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Any, Literal, get_args

from pydantic import BaseModel, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic.fields import FieldInfo
from pydantic_core import CoreSchema, core_schema

from drillpetsc.case.key_paths import refuse, suggestion
from drillpetsc.time_function import Constant, PiecewiseLinear, Ramp, TimeFunction
from drillpetsc.unit_systems import KINDS, System, display, kind_of, shown, unit_of_bare_number
from drillpetsc.unit_tables import DIMENSIONS
from drillpetsc.units import UnitError, bare_number, in_unit_of, spelled, to_si, wanted

BARE_NUMBERS: ContextVar[System] = ContextVar("BARE_NUMBERS", default="SI")
"""Unit system of numbers without a unit, while a case is read."""

MESSAGES: ContextVar[System] = ContextVar("MESSAGES", default="SI")
"""Unit system of figures in messages, while a case is read and checked."""

SMALLEST, LARGEST = (
    1e-60,
    1e30,
)  # magnitudes in SI: within them no formula of the model overflows or divides by zero
_EXAMPLE_UNITS = {"m": "mm", "Pa": "GPa", "rad": "deg", "rad/s": "rpm", "kg/m^3": "g/cm3", "s": "ms"}
#: unit of bare numbers -> a smaller one that is written for it
_SMALLER = {"klbf": "lbf", "kN": "N"}


def said(value: float, kind: str, system: System | None = None, digits: int = 6) -> str:
    """A figure [SI] as text for a message: in the units of the case, or as it is without any.

    kind: a key of `unit_systems.KINDS`; system: of the case, None: of the case that is being read; digits: significant ones.
    """
    system = system or MESSAGES.get()
    return (
        f"{value:.{digits}g} {spelled(KINDS[kind].si)}"
        if system == "SI"
        else shown(value, kind, system, digits)
    )


class InSI(float):
    """A number that a reader of files has converted: in SI, whatever the units of the case are."""


def with_unit(value: object, unit: str, kind: str, *at: str | int) -> object:
    """A bare number as text with the unit that it has in the case; any other value unchanged.

    unit: SI unit of the key
    kind: kind of the quantity, a key of `unit_systems.KINDS`
    at: key path below the validated value, for messages
    """
    system = BARE_NUMBERS.get()
    if system == "SI" or not unit or isinstance(value, InSI):
        return value
    number = bare_number(value)
    if number is None:
        return value
    own = unit_of_bare_number(unit, kind, system)
    if own is None:
        hint = f"'units: {system.partition('_')[0]}' has no unit for this key; '{value} {spelled(unit)}', or another unit"
        raise refuse(*at, got=value, want=f"a number with a unit: {wanted(unit)}", hint=hint)
    if isinstance(value, str) and "/" in value and not (kind == "diameter" and system == "field"):
        return value  # a fraction without a unit, which is refused
    return f"{number!r} {own}"


def with_text(value: Any) -> Any:
    """Keys of a case with quantities of pint as text with a unit, arrays of them as lists; all other values unchanged."""
    if type(value) is dict:
        return {key: with_text(part) for key, part in value.items()}
    if type(value) in (list, tuple):
        return type(value)(with_text(part) for part in value)
    if hasattr(value, "magnitude") and hasattr(value, "units"):
        numbers = value.magnitude.tolist() if hasattr(value.magnitude, "tolist") else value.magnitude
        unit = f"{value.units:~C}"
        return [f"{n!r} {unit}" for n in numbers] if isinstance(numbers, list) else f"{numbers!r} {unit}"
    return value


class Value:
    """Metadata of a key: how its value is read, and the value's JSON schema."""

    def read(self, value: object) -> Any:
        """The value in SI, or the error of the key."""
        raise NotImplementedError

    def json(self) -> dict[str, Any]:
        """JSON schema of the value."""
        raise NotImplementedError

    def serialization(self) -> core_schema.SerSchema | None:
        """How the value is written; None: as it is."""
        return None

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read, serialization=self.serialization())

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return self.json()


@dataclass(frozen=True)
class Quantity(Value):
    """A number in the SI unit `unit` within bounds (SI); text with any unit of the same dimension is
    converted."""

    unit: str
    above: float | None = None
    at_least: float | None = None
    below: float | None = None
    at_most: float | None = None
    why: str = ""
    """Meaning of the number, the hint of the message for a number out of range."""
    kind: str = ""
    """A key of `unit_systems.KINDS`, `none` for a quantity whose numbers always need a unit, or "": the usual kind of the unit."""

    @property
    def _bounds(self) -> list[tuple[str, float]]:
        """The bounds, each with its words."""
        bounds = {
            "above": self.above,
            "at least": self.at_least,
            "below": self.below,
            "at most": self.at_most,
        }
        return [(word, bound) for word, bound in bounds.items() if bound is not None]

    def allowed(self, system: System = "SI") -> str:
        """The range in words, in the units of a system if it has one for this quantity; empty if unbounded."""
        unit = unit_of_bare_number(self.unit, self.kind, system) if self.unit else None
        kind = kind_of(self.unit, self.kind)
        bounds = self._bounds
        if unit is None or system == "SI" or kind not in KINDS:
            text = ", ".join(f"{word} {bound:g}" for word, bound in bounds)
            return f"{text} {self.unit}".rstrip() if bounds else ""
        numbers = [(word, display(bound, kind, system)) for word, bound in bounds]
        text = ", ".join(f"{word} {number:.6g}" for word, (number, _) in numbers)
        return f"{text} {numbers[0][1][1]}" if numbers else ""

    def _allowed_for(self, value: object, system: System) -> str:
        """The range in words; for angles in the unit of the ``value`` (degrees), otherwise as in ``allowed``."""
        if self.unit != "rad" or not isinstance(value, str):
            return self.allowed(system)
        numbers = [(word, in_unit_of(value, bound, self.unit)) for word, bound in self._bounds]
        text = ", ".join(f"{word} {number}" for word, number in numbers)
        return text if all(number for _, number in numbers) else self.allowed(system)

    def inside(self, number: float) -> bool:
        return not (
            (self.above is not None and number <= self.above)
            or (self.at_least is not None and number < self.at_least)
            or (self.below is not None and number >= self.below)
            or (self.at_most is not None and number > self.at_most)
        )

    def read(self, value: object, *at: str | int) -> float:
        """The value in SI; refuses other dimensions and values out of range.

        at: key path below the validated value, for messages
        """
        try:
            number = to_si(with_unit(value, self.unit, self.kind, *at), self.unit)
        except UnitError as error:
            raise refuse(*at, got=value, want=error.want, hint=error.hint) from None
        if not self.inside(number):
            hint = self.why
            own = unit_of_bare_number(self.unit, self.kind, BARE_NUMBERS.get())
            if not isinstance(value, (str, InSI)) and (self.unit in _EXAMPLE_UNITS or own in _SMALLER):
                other = _EXAMPLE_UNITS[self.unit] if own == self.unit else spelled(self.unit)
                other = _SMALLER.get(own or "", other)
                if own != "deg":
                    fits = self.inside(to_si(f"{value} {other}", self.unit))
                    hint = f"a bare number is in {own}" + (f"; was '{value} {other}' meant?" if fits else "")
            system = BARE_NUMBERS.get()
            want = f"{DIMENSIONS.get(self.unit, ('a value', ''))[0]}, {self._allowed_for(value, system)}"
            got = value
            if isinstance(value, InSI) and kind_of(self.unit, self.kind) in KINDS:  # read from a file
                got, hint = (
                    said(value, kind_of(self.unit, self.kind), system),
                    "from a file: the unit of its column?",
                )
            raise refuse(*at, got=got, want=want, hint=hint)
        if number != 0 and not SMALLEST <= abs(number) <= LARGEST:
            want = f"{DIMENSIONS.get(self.unit, ('a value', ''))[0]} of {SMALLEST:g} to {LARGEST:g} {self.unit}".rstrip()
            raise refuse(
                *at,
                got=value,
                want=f"{want}, or 0",
                hint="beyond it, products and quotients overflow",
            )
        return number

    def json(self) -> dict[str, Any]:
        """JSON schema of the value: a number in SI, or text with a unit."""
        number: dict[str, Any] = {"type": "number"}
        bounds = {
            "exclusiveMinimum": self.above,
            "minimum": self.at_least,
            "exclusiveMaximum": self.below,
            "maximum": self.at_most,
        }
        # with `units: metric` a bare number is in another unit than the bounds, which are SI: only a bound of 0 holds in all
        number |= {
            key: bound for key, bound in bounds.items() if bound is not None and (not self.unit or bound == 0)
        }
        return {"anyOf": [number, {"type": "string"}]} if self.unit else number


@dataclass(frozen=True)
class Vector(Value):
    """Three numbers in the SI unit `unit`.

    along_z: one number is also accepted, as the component along the third axis
    along_x: the same along the first axis
    """

    unit: str
    along_z: bool = False
    along_x: bool = False
    kind: str = ""

    def read(self, value: object) -> tuple[float, float, float]:
        component = Quantity(self.unit, kind=self.kind)
        value = as_list(value)
        if isinstance(value, (list, tuple)):
            if len(value) != 3:
                raise refuse(got=value, want=f"three components, each {wanted(self.unit)}")
            x, y, z = (component.read(part, i) for i, part in enumerate(value))
            return x, y, z
        if isinstance(value, Mapping) or not (self.along_x or self.along_z):
            raise refuse(got=value, want=f"a list of three components, each {wanted(self.unit)}")
        number = component.read(value)
        return (number, 0.0, 0.0) if self.along_x else (0.0, 0.0, number)

    def json(self) -> dict[str, Any]:
        number = Quantity(self.unit).json()
        row = {"type": "array", "items": number, "minItems": 3, "maxItems": 3}
        return {"anyOf": [row, *number["anyOf"]]} if self.along_x or self.along_z else row


@dataclass(frozen=True)
class OverTime(Value):
    """A value over time in the SI unit `unit`: a constant, {time, value} or {ramp, value}."""

    unit: str
    kind: str = ""

    def read(self, value: object) -> TimeFunction:
        if isinstance(value, (Constant, PiecewiseLinear, Ramp)):
            return value
        if not isinstance(value, Mapping):
            return Constant(Quantity(self.unit, kind=self.kind).read(value))
        forms = "a constant, {time: [...], value: [...]} or {ramp: 2 s, value: ...}"
        for key in value:
            if key not in ("time", "ramp", "value"):
                raise refuse(key, got=value[key], want=forms, hint=suggestion(key, ("time", "ramp", "value")))
        if "value" not in value or ("time" in value) == ("ramp" in value):
            raise refuse(got=dict(value), want=forms)
        if "ramp" in value:
            duration = Quantity("s", above=0).read(value["ramp"], "ramp")
            return Ramp(duration, Quantity(self.unit, kind=self.kind).read(value["value"], "value"))
        return self._table(value["time"], value["value"])

    def _table(self, times: object, values: object) -> PiecewiseLinear:
        columns = []
        for key, column, unit, kind in (("time", times, "s", ""), ("value", values, self.unit, self.kind)):
            column = as_list(column)
            if not isinstance(column, (list, tuple)) or not column:
                raise refuse(key, got=column, want=f"a list, each {wanted(unit)}")
            columns.append(
                tuple(Quantity(unit, kind=kind).read(cell, key, i) for i, cell in enumerate(column))
            )
        if len(columns[0]) != len(columns[1]):
            count = f"{len(columns[0])} times and {len(columns[1])} values"
            raise refuse("value", got=count, want="as many values as times")
        try:
            return PiecewiseLinear(columns[0], columns[1])
        except ValueError as error:
            want = "times in ascending order; a time given twice is a jump"
            raise refuse("time", got=times, want=want, hint=str(error)) from None

    def serialization(self) -> core_schema.SerSchema:
        return core_schema.plain_serializer_function_ser_schema(dump_time_function)

    def json(self) -> dict[str, Any]:
        number, time = Quantity(self.unit).json(), Quantity("s").json()

        def mapping(**properties: Any) -> dict[str, Any]:
            return {
                "type": "object",
                "properties": properties,
                "required": list(properties),
                "additionalProperties": False,
            }

        table = mapping(time={"type": "array", "items": time}, value={"type": "array", "items": number})
        return {"anyOf": [*number.get("anyOf", [number]), table, mapping(ramp=time, value=number)]}


@dataclass(frozen=True)
class WordOrNumber(Value):
    """One of some words, or a number in the SI unit of `quantity`; `none` is 0 if it is allowed."""

    words: tuple[str, ...]
    quantity: Quantity
    none: bool = True

    @property
    def unit(self) -> str:
        return self.quantity.unit

    @property
    def json_schema_input_type(self) -> Any:
        """Type of the words, for the manual."""
        return Literal[self._all_words]

    def allowed(self) -> str:
        """The range of the number in words, empty when unbounded."""
        return self.quantity.allowed()

    @property
    def _all_words(self) -> tuple[str, ...]:
        return (*self.words, "none") if self.none else self.words

    def read(self, value: object) -> float | str:
        if value == "none" and self.none:
            return 0.0
        if isinstance(value, str) and value.strip()[:1].isalpha():
            if value in self.words:
                return value
            want = f"{', '.join(self._all_words)}, or a number, {self.quantity.allowed()}"
            raise refuse(got=value, want=want, hint=suggestion(value, self._all_words))
        return self.quantity.read(value)

    def json(self) -> dict[str, Any]:
        if self.unit:  # a text may be a number with a unit
            return {"anyOf": [{"type": "number"}, {"type": "string"}]}
        words = {"enum": list(self._all_words), "type": "string"}
        return {"anyOf": [words, {"type": "number"}]}


def as_list(value: Any) -> Any:
    """A numpy array as a list; other values unchanged."""
    return value.tolist() if hasattr(value, "tolist") else value


def one_as_list(value: Any) -> Any:
    """One value as a list of one."""
    value = as_list(value)
    return value if isinstance(value, (list, tuple)) else [value]


def slowest(function: TimeFunction | None) -> float | None:
    """Smallest magnitude above zero of the given values of an input over time, in its unit; None if all are zero."""
    values = function.values if isinstance(function, PiecewiseLinear) else (largest(function),)
    return min((abs(value) for value in values if value), default=None)


def largest(function: TimeFunction | None) -> float:
    """Largest magnitude of an input over time, in its unit; 0 without an input; for an input set during the run, its value at time 0."""
    if function is None:
        return 0.0
    if isinstance(function, Constant):
        return abs(function.constant)
    if isinstance(function, Ramp):
        return abs(function.final)
    if not hasattr(function, "values"):
        return abs(function.value(0.0))
    return max(abs(value) for value in function.values)


def unit_of_field(field: FieldInfo) -> str | None:
    """SI unit of the values of a key; "" for pure numbers, None if the key takes no quantity or several.

    Units of keys inside a block do not apply to the block.
    """
    units = {part.unit for part in _metadata(field.annotation, field.metadata) if hasattr(part, "unit")}
    return units.pop() if len(units) == 1 else None


def kinds_of_field(field: FieldInfo) -> set[tuple[str, str]]:
    """(SI unit, kind) of the values that a key takes."""
    parts = _metadata(field.annotation, field.metadata)
    parts = [part.quantity if isinstance(part, WordOrNumber) else part for part in parts]  # type: ignore[assignment]
    return {(part.unit, part.kind) for part in parts if isinstance(part, (Quantity, Vector, OverTime))}


def varies_over_time(field: FieldInfo) -> bool:
    """Whether the value of a key may be a function of time."""
    return any(isinstance(part, OverTime) for part in _metadata(field.annotation, field.metadata))


def _metadata(annotation: Any, own: Iterable[Any] = ()) -> Iterator[Any]:
    """Metadata of a key and of the types inside its annotation, except those inside blocks."""
    yield from own
    yield from getattr(annotation, "__metadata__", ())
    for part in get_args(annotation):
        if not (isinstance(part, type) and issubclass(part, BaseModel)):
            yield from _metadata(part)


def dump_time_function(function: TimeFunction) -> float | dict[str, Any]:
    """The inverse of OverTime.read, in SI."""
    if isinstance(function, Constant):
        return function.constant
    if isinstance(function, Ramp):
        return {"ramp": function.duration, "value": function.final}
    return {"time": list(function.times), "value": list(function.values)}
