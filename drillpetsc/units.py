"""Text with a unit -> SI number. Units other than SI occur in this module and its tables only.

`to_si("9.625 in", "m")` is 0.244475. The second argument is the SI unit of the key; a value of
another dimension is a `UnitError`. A bare number is SI. Angles count as a dimension here (pint
itself treats them as pure numbers), so `5 Hz` is not a rotation speed and `80 rpm` is not a damping rate.

A unit is looked up in the tables of its dimension first (`unit_tables.py`): `lb` is a force for a key that takes a
force, and a mass for one that takes a mass. Letters may be of either case unless two units differ by it. Units outside
the tables are read by pint, with powers without a caret (`g/cm3`, `mm2`) and a number in a denominator
(`25 lbf/100 ft^2`). Numbers may be fractions as in a tubing table: `9 5/8 in`, `12-1/4"`.
"""

from __future__ import annotations

import difflib
import math
import re
from fractions import Fraction
from functools import lru_cache
from typing import Any, SupportsFloat, cast

from drillpetsc.unit_tables import DIMENSIONS, FACTORS, FIELD, GRAVITY, INVERSE, KEEP_CASE, REFUSED, WITH_ZERO

# other spellings of the same quantity: radians may be left out of a stiffness and put into a curvature
_SAME: dict[str, tuple[str, ...]] = {"N m/rad": ("N m",), "N m s/rad": ("N m s",), "1/m": ("rad/m",)}

_NUMBER = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?")
_FRACTION = re.compile(r"([+-]?)(?:(\d+)(?:\s+|\s*-\s*))?(\d+)\s*/\s*(\d+)(?=\s|[\"']|in|ft|mm|$)")
_UNIT = re.compile(r"(?:1\s*/\s*)?[A-Za-z%°µμ(][A-Za-z0-9_%°µμ²³·.^*/() -]*|[\"']|#(?:\s*/\s*ft)?")
_QUOTES = str.maketrans(dict.fromkeys("″”“", '"') | dict.fromkeys("′’‘", "'"))
_BEARING = re.compile(r"[NSns]\s*\d+(?:\.\d*)?\s*[EWew]$|.*\d\s*(?:°|deg|d|:|\s)\s*\d")
_DECIMAL_DEGREES = "decimal degrees, such as 23.5 deg"
_POWER_OF_NUMBER = re.compile(
    r"(?:\d[\d.]*|\)|[²³])\s*(?:\^|\*\*|[²³])"
)  # 9^9^9, m3^9^9 and 5²^99 would be computed, for years
# a number that is a factor (m 2, m*2), a divisor alone (m/2), and // and %, which pint would compute with
_FACTOR = re.compile(r"(?<![/*^(\s-])\s*(?:\s|\*(?!\*))\s*\d|/\s*\d+(?:\.\d*)?\s*(?![\sA-Za-z\d.])|//")
_SHARE = re.compile(r"%|percent", re.IGNORECASE)
_WORDS = re.compile(r"[A-Za-z%µμ°][A-Za-z0-9_%µμ°]*")
LONGEST = 100  # letters of a number with its unit
_FORCE = re.compile(r"lbf|(?<![A-Za-z])[kMG]?N(?![A-Za-z])")
_ANGLE = re.compile(r"(radian|degree|turn|gradian|arcminute|arcsecond)$|^revolutions?_per")
_COMMON = "m mm cm km in ft s ms min hour kg g lb tonne N kN MN lbf klbf Pa kPa MPa GPa bar psi ksi rad deg rpm l".split()
_COMMON += "gal bbl ppg gpm cP degC degF K J W".split()


class UnitError(ValueError):
    """A value that cannot be converted to the unit of a key.

    got: the value
    want: what is allowed
    hint: the reason
    """

    def __init__(self, got: object, want: str, hint: str = "") -> None:
        super().__init__()
        self.got = got
        self.want = want
        self.hint = hint

    def __str__(self) -> str:
        return f"{self.got!r}: {self.want}" + (f" ({self.hint})" if self.hint else "")


def wanted(unit: str) -> str:
    """Values that a key of this SI unit accepts, in words: `a length, such as 9 m or 5 in`."""
    name, example = DIMENSIONS.get(unit, (f"a value in {unit}", f"1 {unit}"))
    return f"{name}, such as {example}"


def spelled(unit: str) -> str:
    """SI unit in usual notation: `kg/m^3` is kg/m3."""
    return re.sub(r"\^(\d)(?![\d.])", r"\1", unit)


def to_si(value: object, unit: str) -> float:
    """A value as a number in an SI unit.

    value: number, or text with a unit
    unit: a key of DIMENSIONS, or any SI unit
    """
    if isinstance(value, str):
        number = _text_to_si(value.strip(), unit)
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        try:
            number = float(value)
        except OverflowError:  # a whole number of more than 308 digits
            number = math.inf
    elif _is_number_like(value):
        number = float(cast(SupportsFloat, value))
    else:
        raise UnitError(value, wanted(unit))
    if not math.isfinite(number):
        raise UnitError(value, f"{wanted(unit)}; finite")
    return number


def in_unit_of(text: str, number: float, unit: str) -> str:
    """The ``number`` in the SI unit ``unit`` as a text in the unit of ``text``; empty if that has no unit, or another kind."""
    try:
        own = _split(text.strip(), unit)[1]
        size, zero = _linear(own, unit) if own else (0.0, 0.0)
    except UnitError:
        return ""
    return f"{(number - zero) / size:.6g} {own}" if size else ""


def weight_to_mass(value: object) -> float:
    """Mass [kg] of a value that is a mass, or a weight under standard gravity: `60 klb`, `27 t`, `267 kN`."""
    try:
        return to_si(value, "kg")
    except UnitError as error:
        try:
            return _neat(to_si(value, "N") / GRAVITY)
        except UnitError:
            raise UnitError(value, "a mass or a weight, such as 27 t or 60 klbf", error.hint) from None


@lru_cache(maxsize=8192)
def _text_to_si(text: str, unit: str) -> float:
    if len(text) > LONGEST:
        raise UnitError(text, wanted(unit), f"at most {LONGEST} letters")
    if unit == "rad" and _BEARING.match(text):
        raise UnitError(text, wanted(unit), _DECIMAL_DEGREES)
    number, rest = _split(text.translate(_QUOTES), unit)
    if not rest:
        return number
    if (
        not _UNIT.fullmatch(rest)
        or _POWER_OF_NUMBER.search(rest)
        or _FACTOR.search(rest)
        or (unit and _SHARE.search(rest))
    ):
        raise UnitError(text, wanted(unit), "one number, then its unit")
    return _neat(_convert(number, rest, unit, text))


def to(value: Any, unit: str, given: str = "") -> Any:
    """A value in another unit: `to(4.448e6, "klbf")` is 1000.

    value: a number or an array in SI, or a variable with `attrs["units"]` such as one of a result (xarray), which comes back as
    such a variable with the attribute of its new unit
    unit: any unit that a case file may have
    given: unit of the value, if it differs from `attrs["units"]` and from SI
    Raises UnitError for a unit that cannot be read, is of another kind than the value, or belongs to two kinds of quantity
    (`lb`: say lbf or lbm).
    """
    if not unit.strip():
        raise UnitError(unit, "a unit, such as klbf or m3/h")
    attributes = getattr(value, "attrs", None)
    source = given or (str(attributes.get("units", "")) if attributes is not None else "")
    (size, zero), (from_size, from_zero) = _common_scales(unit, source)
    changed = value * (from_size / size) + (from_zero - zero) / size if source else (value - zero) / size
    if attributes is not None and hasattr(changed, "attrs"):
        changed.attrs = {**attributes, "units": unit}
    return changed


@lru_cache(maxsize=512)
def _common_scales(unit: str, source: str) -> tuple[tuple[float, float], tuple[float, float]]:
    """(size, zero) in SI of two units of one kind of quantity. An empty `source` is the SI unit."""
    found: dict[str, tuple[tuple[float, float], tuple[float, float]]] = {}
    reasons = []
    for si in filter(None, DIMENSIONS):
        if si.startswith("kg") and _FORCE.search(unit):  # a weight, for keys that take a mass
            continue
        try:
            found[si] = _linear(unit, si), _linear(source, si) if source else (1.0, 0.0)
        except UnitError as error:
            reasons.append(error.hint)
    ways = {f"{of[0] / to[0]:.9g} {(of[1] - to[1]) / to[0]:.9g}" for to, of in found.values()}
    if len(ways) == 1:
        return next(iter(found.values()))
    if found:
        kinds = " and ".join(DIMENSIONS[si][0] for si in found)
        raise UnitError(unit, "a unit of one kind of quantity", f"{unit} is {kinds}")
    if source:
        raise UnitError(unit, f"a unit of the kind of {source}")
    raise UnitError(unit, "a unit, such as klbf or m3/h", next(iter(reasons), ""))


def _linear(unit: str, si: str) -> tuple[float, float]:
    """(size, zero) of a unit in SI; UnitError if it is of another kind or is an inverse (min/ft)."""
    zero, one = to_si(f"0 {unit}", si), to_si(f"1 {unit}", si)
    return one - zero, zero


def bare_number(value: object) -> float | None:
    """The number of a value without a unit: 5, "5", "8 1/2"; None for all others."""
    if isinstance(value, str):
        text = value.strip()
        if len(text) > LONGEST:
            return None
        fraction = _FRACTION.fullmatch(text)
        if fraction:
            return _of_fraction(fraction)
        return float(text) if _NUMBER.fullmatch(text) else None
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    return float(cast(SupportsFloat, value)) if is_number or _is_number_like(value) else None


def is_number(word: str) -> bool:
    """Whether a text is a bare number."""
    try:
        float(word)
    except ValueError:
        return False
    return True


def _is_number_like(value: object) -> bool:
    """Whether a value is a number of another package, such as a whole number of numpy, or an array of one number."""
    if isinstance(value, (str, bool)) or getattr(value, "ndim", None) not in (None, 0):
        return False
    return hasattr(value, "__float__") and getattr(getattr(value, "dtype", None), "kind", "f") != "b"


def _neat(number: float) -> float:
    """The number without the rounding error of a conversion: 1199.9999999999998 becomes 1200."""
    short = float(f"{number:.12g}")
    return short if abs(short - number) <= 2 * math.ulp(number) else number


def _split(text: str, unit: str) -> tuple[float, str]:
    """Leading number and the unit text behind it."""
    fraction = _FRACTION.match(text)
    if fraction:
        value, rest = _of_fraction(fraction), text[fraction.end() :].strip()
        if value is None:
            raise UnitError(text, wanted(unit))
        if not rest and unit:
            raise UnitError(text, wanted(unit), f"a fraction needs a unit: {text} in")
        return value, rest
    match = _NUMBER.match(text)
    if not match:
        raise UnitError(text, wanted(unit), "a number comes first")
    rest = text[match.end() :].strip()
    if rest.startswith(","):
        raise UnitError(text, wanted(unit), "the decimal separator is a point")
    return float(match.group()), rest


def _of_fraction(match: re.Match[str]) -> float | None:
    """Number of a match of _FRACTION; None if its denominator is 0."""
    sign, whole, top, bottom = match.groups()
    if int(bottom) == 0:
        return None
    number = float(int(whole or 0) + Fraction(int(top), int(bottom)))
    return -number if sign == "-" else number


def canonical(unit_text: str) -> str:
    """One spelling for many: `ft-lbf`, `ft.lbf` and `ft·lbf` are `ft lbf`; `lb / 100 ft2` is `lb/100ft^2`."""
    text = " ".join(unit_text.split())
    if text.casefold() in ("s.g.", "s.g"):
        return "s.g."
    text = text.replace("²", "^2").replace("³", "^3").replace("°", "deg").replace("**", "^")
    text = re.sub(r"\s*([/^])\s*", r"\1", text)
    text = re.sub(r"(?<=[A-Za-z\d])\s*[.*·-]\s*(?=[A-Za-z])", " ", text)
    text = re.sub(r"(?<=[A-Za-z])(-?\d)(?![\d.])", r"^\1", text)
    return re.sub(r"/\(?(\d+)\s*([A-Za-z]+(?:\^\d)?)\)?$", r"/\1\2", text)


@lru_cache(maxsize=64)
def _spellings(unit: str) -> tuple[dict[str, float], dict[str, float]]:
    """Factors of an SI unit by canonical spelling, and by spelling in small letters."""
    listed = FACTORS.get(unit, {}) | FIELD.get(unit, {})
    exact = {canonical(text): factor for text, factor in listed.items()}
    ambiguous = {canonical(text).casefold() for text in KEEP_CASE}
    folded: dict[str, float] = {}
    for text, factor in exact.items():
        if folded.setdefault(text.casefold(), factor) != factor:
            ambiguous.add(text.casefold())
    return exact, {text: factor for text, factor in folded.items() if text not in ambiguous}


def _tidy(unit_text: str) -> str:
    """Spellings that pint does not read -> spellings it does."""
    text = unit_text.replace("·", "*").replace("²", "^2").replace("³", "^3").replace("°", "deg")
    text = re.sub(r"\bs\s*(?:\^|\*\*)\s*n\b", "second_to_the_n", text)
    text = re.sub(r"(?<=[A-Za-z])[.-](?=[A-Za-z])", "*", text)  # Pa.s, ft-lbf
    text = re.sub(r"(?<=[A-Za-z])(\d)\b(?!\.)", r"^\1", text)  # cm3
    text = re.sub(r"(?<=[A-Za-z])(-\d)\b", r"^\1", text)  # m-1
    return re.sub(r"/\s*(\d+(?:\.\d+)?)\s*([A-Za-z]+(?:\^\d+)?)", r"/(\1 \2)", text)  # deg/30 m


@lru_cache(maxsize=1)
def _registry() -> Any:
    """The pint registry with the units of the oil field; half a second to build."""
    import pint

    registry: Any = pint.UnitRegistry(on_redefinition="ignore")
    registry.define("second_to_the_n = [flow_index]")
    registry.define("bbl = 42 * gallon")  # oil barrel; pint's own bbl is a dry barrel
    registry.define("ppg = pound / gallon")
    registry.define("gpm = gallon / minute")
    registry.define("rev = 2 * pi * radian")
    return registry


@lru_cache(maxsize=4096)
def _parse(unit_text: str) -> tuple[Any, int]:
    """pint quantity of one such unit, and the power of angle in it."""
    registry = _registry()
    text = _tidy(unit_text)
    try:
        quantity = registry.Quantity(1.0, registry.parse_units(text))
    except ValueError:  # a number inside: deg/(30 m)
        quantity = registry.parse_expression(text)
    powers = quantity.units._units.items()
    angle = sum(power for name, power in powers if _ANGLE.search(name) or name == "rev")
    return quantity, round(angle)


def _convert(number: float, unit_text: str, unit: str, text: str) -> float:
    """number [unit_text] in the SI unit `unit`.

    text: the whole value, for messages
    """
    spelling = canonical(unit_text)
    small = spelling.casefold()
    reason = REFUSED.get(unit, {}).get(small)
    if unit == "1/m" and small in ("deg/ft", "dega/ft") and abs(number) > 1:
        reason = f"do you mean per 100 ft? {number:g} deg/100ft"
    if reason:
        raise UnitError(text, wanted(unit), reason)
    if small in INVERSE.get(unit, {}):
        if number == 0:
            raise UnitError(text, wanted(unit), "infinitely fast")
        return 1 / (number * INVERSE[unit][small])
    if small in WITH_ZERO.get(unit, {}):
        size, zero = WITH_ZERO[unit][small]
        return number * size + zero
    exact, folded = _spellings(unit)
    factor = exact.get(spelling, folded.get(small))
    return _convert_by_pint(number, unit_text, unit, text) if factor is None else number * factor


def _convert_by_pint(number: float, unit_text: str, unit: str, text: str) -> float:
    """As `_convert`, for any unit that pint reads; UnitError for all others."""
    import pint

    try:
        quantity, angle = _parse(unit_text)
    except Exception as error:  # pint raises a dozen kinds for unreadable text
        raise UnitError(text, wanted(unit), _unit_hint(unit_text)) from error
    for spelling in (unit, *_SAME.get(unit, ())):
        target, target_angle = _parse(spelling) if spelling else (_registry().Quantity(1.0, ""), 0)
        if target_angle != angle:
            continue
        try:
            given = _registry().Quantity(number * quantity.magnitude, quantity.units)
            return float(given.to(target.units).magnitude / target.magnitude)
        except (pint.errors.PintError, ArithmeticError):
            continue
    raise UnitError(text, wanted(unit), _dimension_hint(quantity, angle, unit, unit_text))


def _is_unit(word: str) -> bool:
    try:
        _registry().parse_units(word)
    except Exception:  # as in _convert
        return False
    return True


def _unit_hint(unit_text: str) -> str:
    """Name the first word that is not a unit, with the nearest unit."""
    for word in _WORDS.findall(_tidy(unit_text)):
        if _is_unit(word):
            continue
        near = difflib.get_close_matches(word, _COMMON, 1, 0.5)
        return f"'{word}' is not a known unit" + (f"; did you mean '{near[0]}'?" if near else "")
    return f"'{unit_text}' cannot be read as a unit"


def _dimension_hint(quantity: Any, angle: int, unit: str, unit_text: str) -> str:
    if unit == "rad/s" and angle == 0 and quantity.check("1/[time]"):
        return "for a rotation use rpm or rad/s, not Hz or 1/s"
    for other, (name, _) in DIMENSIONS.items():
        if other and other != unit:
            target, target_angle = _parse(other)
            if target_angle == angle and quantity.is_compatible_with(target.units):
                return f"'{unit_text}' is {name}"
    return f"'{unit_text}' has another dimension"
