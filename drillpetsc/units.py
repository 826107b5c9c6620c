"""Text with a unit -> SI number. Units other than SI occur in this module only.

`to_si("9.625 in", "m")` is 0.244475. The second argument is the SI unit of the key; a value of
another dimension is a `UnitError`. A bare number is SI. Angles count as a dimension here (pint
itself treats them as pure numbers), so `5 Hz` is not a rotation speed and `80 rpm` is not a damping rate.

Besides the units of pint it reads fractions as in a tubing table (`9 5/8 in`), powers without a caret (`g/cm3`,
`mm2`), a number in a denominator (`3 deg/30 m`, `25 lbf/100 ft^2`), and `s^n` of a power-law consistency (`0.5
Pa s^n`).
"""

from __future__ import annotations

import difflib
import math
import re
from fractions import Fraction
from functools import lru_cache
from typing import Any

# SI unit of a key -> its name, and an example for messages
DIMENSIONS: dict[str, tuple[str, str]] = {
    "": ("a pure number", "0.3"),
    "m": ("a length", "9 m or 5 in"),
    "m^2": ("an area", "400 mm2"),
    "m^3": ("a volume", "7 l"),
    "s": ("a time", "20 s"),
    "1/s": ("a rate", "0.1 1/s"),
    "kg": ("a mass", "60 kg"),
    "kg/m": ("a mass per length", "29.2 kg/m"),
    "kg m": ("a mass times a length", "0.05 kg m"),
    "kg m^2": ("a moment of inertia", "200 kg m2"),
    "kg/m^3": ("a density", "7850 kg/m3"),
    "m/s": ("a speed", "10 m/h"),
    "m/s^2": ("an acceleration", "9.80665 m/s2"),
    "m^3/s": ("a flow rate", "30 l/s or 500 gal/min"),
    "rad": ("an angle", "30 deg"),
    "rad/s": ("a rotation speed", "80 rpm or 8.4 rad/s"),
    "1/m": ("a curvature", "1e-4 1/m or 3 deg/30 m"),
    "N": ("a force", "50 kN"),
    "N/m": ("a force per length (or stiffness)", "1e8 N/m"),
    "N m": ("a moment", "10 kN m"),
    "N m/m": ("a moment per length", "10 N m/m"),
    "N m^2": ("a bending or torsional stiffness", "9.8e6 N m^2"),
    "N m/rad": ("a rotational stiffness", "1000 N m/rad"),
    "N m s/rad": ("a rotational damping", "500 N m s/rad"),
    "Pa": ("a pressure, or stiffness per length", "206 GPa or 1e8 N/m^2"),
    "N/m^2.5": ("a Hertz stiffness per length", "3e9 N/m^2.5"),
    "N/m^1.5": ("a Hertz stiffness of a point", "1e10 N/m^1.5"),
    "Pa s": ("a viscosity", "20 cP"),
    "N s/m": ("a damping", "500 N s/m"),
    "N s/m^2": ("a damping per length", "20 N s/m^2"),
    "Pa s^n": ("a consistency", "0.5 Pa s^n"),
    "K": ("a temperature", "60 degF"),
    "m/(s N)": ("a drillability", "2.8e-8 m/(s N)"),
}

# fmt: off
# SI unit of a key -> spelling of a unit (as `_tidy` leaves it) -> factor to SI. The factors are those of pint. pint takes longer
# to import than everything else that reads a case, so it converts only units that are not listed here.
FACTORS: dict[str, dict[str, float]] = {
    "": {"%": 0.01},
    "m": {"m": 1.0, "mm": 0.001, "cm": 0.01, "km": 1000.0, "um": 1e-06, "in": 0.0254, "ft": 0.30479999999999996},
    "m^2": {"m^2": 1.0, "mm^2": 1e-06, "cm^2": 0.0001, "in^2": 0.00064516, "ft^2": 0.09290303999999999},
    "m^3": {"m^3": 1.0, "l": 0.0010000000000000002, "bbl": 0.15898729492799996, "gal": 0.0037854117839999993, "cm^3": 1.0000000000000002e-06},
    "s": {"s": 1.0, "ms": 0.001, "us": 1e-06, "min": 60.0, "h": 3600.0, "hour": 3600.0, "d": 86400.0, "day": 86400.0},
    "1/s": {"1/s": 1.0, "Hz": 1.0, "1/min": 0.016666666666666666},
    "kg": {"kg": 1.0, "g": 0.001, "t": 1000.0, "tonne": 1000.0, "lb": 0.4535923700000001, "klb": 453.5923700000001},
    "kg/m": {"kg/m": 1.0, "lb/ft": 1.488163943569554},
    "kg m": {"kg m": 1.0, "g m": 0.001, "kg mm": 0.001, "kg cm": 0.01},
    "kg m^2": {"kg m^2": 1.0},
    "kg/m^3": {"kg/m^3": 1.0, "g/cm^3": 999.9999999999999, "kg/l": 999.9999999999999, "lb/gal": 119.82642731689667, "ppg": 119.82642731689667, "lb/ft^3": 16.01846337396015, "t/m^3": 1000.0},
    "m/s": {"m/s": 1.0, "m/h": 0.0002777777777777778, "m/min": 0.016666666666666666, "mm/s": 0.001, "cm/s": 0.01, "km/h": 0.2777777777777778, "ft/s": 0.30479999999999996, "ft/min": 0.0050799999999999994, "ft/h": 8.466666666666666e-05},
    "m/s^2": {"m/s^2": 1.0, "ft/s^2": 0.30479999999999996},
    "m^3/s": {"m^3/s": 1.0, "l/s": 0.0010000000000000002, "l/min": 1.666666666666667e-05, "m^3/h": 0.0002777777777777778, "m^3/min": 0.016666666666666666, "gal/min": 6.309019639999999e-05, "gpm": 6.309019639999999e-05, "bbl/min": 0.0026497882487999994},
    "rad": {"rad": 1.0, "deg": 0.017453292519943295},
    "rad/s": {"rad/s": 1.0, "rpm": 0.10471975511965977, "deg/s": 0.017453292519943295, "rev/min": 0.10471975511965977, "rev/s": 6.283185307179586},
    "1/m": {"1/m": 1.0, "rad/m": 1.0, "deg/m": 0.017453292519943295, "1/km": 0.001, "1/ft": 3.2808398950131235},
    "N": {"N": 1.0, "kN": 1000.0, "MN": 1000000.0, "lbf": 4.4482216152605005, "klbf": 4448.221615260501},
    "N/m": {"N/m": 1.0, "kN/m": 1000.0, "MN/m": 1000000.0, "N/mm": 1000.0, "lbf/ft": 14.59390293720637, "lbf/in": 175.12683524647645},
    "N m": {"N m": 1.0, "kN m": 1000.0, "MN m": 1000000.0, "ft lbf": 1.3558179483314001, "N*m": 1.0, "kN*m": 1000.0},
    "N m/m": {"N m/m": 1.0},
    "N m^2": {"N m^2": 1.0, "kN m^2": 1000.0, "MN m^2": 1000000.0},
    "N m/rad": {"N m/rad": 1.0, "kN m/rad": 1000.0, "N m": 1.0},
    "N m s/rad": {"N m s/rad": 1.0, "kN m s/rad": 1000.0, "N m s": 1.0},
    "Pa": {"Pa": 1.0, "kPa": 1000.0, "MPa": 1000000.0, "GPa": 1000000000.0, "bar": 100000.0, "psi": 6894.7572931683635, "ksi": 6894757.293168363, "N/m^2": 1.0, "N/mm^2": 1000000.0},
    "Pa s": {"Pa s": 1.0, "mPa s": 0.001, "cP": 0.001},
    "N s/m": {"N s/m": 1.0},
    "N s/m^2": {"N s/m^2": 1.0, "Pa s": 1.0},
    "N/m^2.5": {"N/m^2.5": 1.0},
    "N/m^1.5": {"N/m^1.5": 1.0},
    "Pa s^n": {"Pa second_to_the_n": 1.0, "mPa second_to_the_n": 0.001},
    "K": {"K": 1.0},
    "m/(s N)": {"m/(s N)": 1.0, "m/h/kN": 2.7777777777777776e-07, "m/(h kN)": 2.7777777777777776e-07, "m/s/N": 1.0},
}
# fmt: on

# other spellings of the same quantity: radians may be left out of a stiffness and put into a curvature
_SAME: dict[str, tuple[str, ...]] = {"N m/rad": ("N m",), "N m s/rad": ("N m s",), "1/m": ("rad/m",)}

_NUMBER = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?")
_FRACTION = re.compile(r"([+-]?)(?:(\d+)[ -])?(\d+)/(\d+)(?=\s)")
_UNIT = re.compile(r"(?:1\s*/\s*)?[A-Za-z%°µμ(][A-Za-z0-9_%°µμ²³·.^*/() -]*")
_POWER_OF_NUMBER = re.compile(
    r"(?:(?<![A-Za-zµμ])\d[\d.]*|\))\s*(?:\^|\*\*)"
)  # 9^9^9 would be computed, for years
_WORDS = re.compile(r"[A-Za-z%µμ°][A-Za-z0-9_%µμ°]*")
LONGEST = 100  # letters of a number with its unit
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
    """What a key of this SI unit accepts, in words: `a length, such as 9 m or 5 in`."""
    name, example = DIMENSIONS.get(unit, (f"a value in {unit}", f"1 {unit}"))
    return f"{name}, such as {example}"


def spelled(unit: str) -> str:
    """SI unit as people write it: `kg/m^3` is kg/m3."""
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
    elif hasattr(value, "__float__") and not isinstance(value, bool) and getattr(value, "ndim", 0) == 0:
        number = float(value)  # numpy scalars
    else:
        raise UnitError(value, wanted(unit))
    if not math.isfinite(number):
        raise UnitError(value, f"{wanted(unit)}; finite")
    return number


@lru_cache(maxsize=8192)
def _text_to_si(text: str, unit: str) -> float:
    if len(text) > LONGEST:
        raise UnitError(text, wanted(unit), f"at most {LONGEST} letters")
    number, rest = _split(text, unit)
    if not rest:
        return number
    if not _UNIT.fullmatch(rest) or _POWER_OF_NUMBER.search(rest):
        raise UnitError(text, wanted(unit), "one number, then its unit")
    return _neat(_convert(number, rest, unit, text))


def _neat(number: float) -> float:
    """The number without the rounding error of a conversion: 1199.9999999999998 becomes 1200."""
    short = float(f"{number:.12g}")
    return short if abs(short - number) <= 2 * math.ulp(number) else number


def _split(text: str, unit: str) -> tuple[float, str]:
    """Leading number and the unit text behind it."""
    fraction = _FRACTION.match(text)
    if fraction:
        sign, whole, top, bottom = fraction.groups()
        if int(bottom) == 0:
            raise UnitError(text, wanted(unit))
        number = float(int(whole or 0) + Fraction(int(top), int(bottom)))
        return (-number if sign == "-" else number), text[fraction.end() :].strip()
    match = _NUMBER.match(text)
    if not match:
        raise UnitError(text, wanted(unit), "a number comes first")
    rest = text[match.end() :].strip()
    if rest.startswith(","):
        raise UnitError(text, wanted(unit), "the decimal separator is a point")
    return float(match.group()), rest


def _tidy(unit_text: str) -> str:
    """Spellings that pint does not read -> spellings it does."""
    text = unit_text.replace("·", "*").replace("²", "^2").replace("³", "^3").replace("°", "deg")
    text = re.sub(r"\bs\s*(?:\^|\*\*)\s*n\b", "second_to_the_n", text)
    text = re.sub(r"(?<=[A-Za-z])\.(?=[A-Za-z])", "*", text)  # Pa.s
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
    factor = FACTORS.get(unit, {}).get(_tidy(unit_text))
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
        return "say what turns: rpm or rad/s, not Hz or 1/s"
    for other, (name, _) in DIMENSIONS.items():
        if other and other != unit:
            target, target_angle = _parse(other)
            if target_angle == angle and quantity.is_compatible_with(target.units):
                return f"'{unit_text}' is {name}"
    return f"'{unit_text}' has another dimension"
