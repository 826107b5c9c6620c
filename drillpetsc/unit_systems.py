"""Systems of units: which unit a bare number of a case has, and in which unit a figure is printed or plotted.

One table holds both, a row a kind of quantity. A kind is finer than a dimension: the depth of a hole is given in feet,
its diameter in inches. Files stay in SI.

`display(0.2159, "diameter", "field")` is (8.5, "in").
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Literal, TypeVar, get_args

from drillpetsc.unit_tables import WITH_ZERO
from drillpetsc.units import canonical, to_si

System = Literal["field", "metric", "metric_t", "SI"]
"""`metric_t` is `metric` with forces in tonnes-force."""
SYSTEMS: tuple[System, ...] = ("field", "metric", "metric_t", "SI")

Values = TypeVar("Values")
"""A number or a numpy array."""


@dataclass(frozen=True)
class Kind:
    """Units of a kind of quantity, as texts that `to_si` reads.

    si: SI unit, a key of DIMENSIONS
    field, metric: unit of bare numbers and of printed figures in that system
    field_plot: unit of plots and of large printed figures in field units, if it differs
    metric_t: unit in the system metric_t, if it differs from metric
    """

    si: str
    field: str
    metric: str
    field_plot: str = ""
    metric_t: str = ""

    def unit(self, system: System, plot: bool = False) -> str:
        """The unit of this kind in a system, such as `in`."""
        if system == "SI":
            return self.si
        if system == "field":
            return self.field_plot if plot and self.field_plot else self.field
        return self.metric_t if system == "metric_t" and self.metric_t else self.metric


KINDS: dict[str, Kind] = {
    "length": Kind("m", "ft", "m"),
    "diameter": Kind("m", "in", "mm"),
    "force": Kind("N", "klbf", "kN", metric_t="t"),
    "torque": Kind("N m", "ft-lbf", "kN m", field_plot="kft-lbf"),
    "side_force": Kind("N/m", "lbf/ft", "kN/m"),
    "weight_per_length": Kind("kg/m", "lb/ft", "kg/m"),
    "pressure": Kind("Pa", "psi", "bar"),
    "pressure_gradient": Kind("Pa/m", "psi/ft", "bar/m"),
    "stress": Kind("Pa", "psi", "MPa", field_plot="ksi"),
    "mud_weight": Kind("kg/m^3", "ppg", "sg"),
    "flow": Kind("m^3/s", "gpm", "l/min"),
    "rop": Kind("m/s", "ft/h", "m/h"),
    "trip_speed": Kind("m/s", "ft/min", "m/min"),
    "rotation": Kind("rad/s", "rpm", "rpm"),
    "dogleg": Kind("1/m", "deg/100ft", "deg/30m"),
    "viscosity": Kind("Pa s", "cP", "mPa s"),
    "yield_point": Kind("Pa", "lbf/100ft2", "Pa"),
    "consistency": Kind("Pa s^n", "lbf s^n/100ft2", "Pa s^n"),
    "flow_area": Kind("m^2", "in2", "mm2"),
    "volume": Kind("m^3", "bbl", "m3"),
    "angle": Kind("rad", "deg", "deg"),
    "temperature": Kind("K", "degF", "degC"),
    "power": Kind("W", "hp", "kW"),
    "wear_rate": Kind("W/m", "ft-lbf/ft/h", "W/m"),
    "mass": Kind("kg", "lb", "kg"),
    "density": Kind("kg/m^3", "lb/ft3", "kg/m3"),
    "energy": Kind("J", "ft-lbf", "J"),
    "creep": Kind("m/s", "in/min", "mm/s"),
    "inertia": Kind("kg m^2", "lb ft2", "kg m2"),
    "stiffness": Kind("N/m", "lbf/in", "kN/m"),
    "section_stiffness": Kind("N m^2", "lbf ft2", "kN m2"),
    "turning_stiffness": Kind("N m/rad", "ft-lbf/rad", "kN m/rad"),
    "turning_damping": Kind("N m s/rad", "ft-lbf s/rad", "kN m s/rad"),
    "drillability": Kind("m/(s N)", "ft/h/lbf", "m/h/kN"),
    "time": Kind("s", "s", "s"),
    "shear_rate": Kind("1/s", "1/s", "1/s"),
    "frequency": Kind("1/s", "Hz", "Hz"),
}
#: kinds that are only shown: keys do not take bare numbers of them
_NOT_FOR_BARE_NUMBERS = frozenset(
    {"volume", "pressure_gradient", "mass", "density", "energy", "creep", "inertia", "stiffness"}
    | {"section_stiffness", "turning_stiffness", "turning_damping", "drillability"}
)

# SI unit -> kind of a quantity that names none. Units with several meanings have no entry: a pressure, a modulus and a
# stress are all Pa, a side force and a stiffness N/m.
KIND_OF_UNIT: dict[str, str] = {
    "m": "length",
    "N": "force",
    "N m": "torque",
    "kg/m": "weight_per_length",
    "m^3/s": "flow",
    "rad/s": "rotation",
    "1/m": "dogleg",
    "Pa s": "viscosity",
    "Pa s^n": "consistency",
    "m^2": "flow_area",
    "rad": "angle",
    "K": "temperature",
    "W": "power",
    "W/m": "wear_rate",
    "s": "time",
}


def kind_of(unit: str, kind: str = "") -> str:
    """The kind of a quantity of this SI unit: the one it names, else the usual one; "" if there is none.

    unit: as in a case (`m^3/s`) or in the heading of a column (`m3/s`)
    kind: a key of KINDS; `none` for a quantity that has no row in the table
    """
    return "" if kind == "none" else kind or KIND_OF_UNIT.get(canonical(unit), "")


def unit_of_bare_number(unit: str, kind: str, system: System) -> str | None:
    """The unit that a number without one has in a case; None if a unit must be written.

    unit: SI unit of the key
    kind: kind that the key names, "" for the usual one of its unit
    """
    if system == "SI" or not unit:
        return unit
    row = KINDS.get(kind_of(unit, kind))
    return None if row is None or kind in _NOT_FOR_BARE_NUMBERS else row.unit(system)


@lru_cache(maxsize=256)
def _scale(text: str, si: str) -> tuple[float, float]:
    """(size of the unit, its zero), both in SI."""
    zeros = WITH_ZERO.get(si, {})
    if text.casefold() in zeros:
        return zeros[text.casefold()]
    if si == "Pa/m":
        length = text.rpartition("/")[2]
        return to_si(f"1 {text.rpartition('/')[0]}", "Pa") / to_si(f"1 {length}", "m"), 0.0
    return to_si(f"1 {text}", si), 0.0


def system_named(word: object) -> System | None:
    """The system of a word that names one, else None."""
    return next((system for system in get_args(System) if system == word), None)


def display(value: Values, kind: str, system: System, plot: bool = False) -> tuple[Values, str]:
    """A figure in the unit in which a system shows it: (number, unit text).

    value: in SI, a number or an array
    kind: a key of KINDS
    system: field, metric, metric_t or SI
    plot: the unit of axes and of large figures, if the system has one: kft-lbf for ft-lbf
    """
    size, zero, text = display_unit(kind, system, plot)
    return (value - zero) / size, text  # type: ignore[operator, return-value]


def display_unit(kind: str, system: System, plot: bool = False) -> tuple[float, float, str]:
    """(size of the unit [SI], its zero [SI], unit text), for a kind in a system.

    A figure is shown as (value - zero)/size.
    """
    row = KINDS[kind]
    size, zero = _scale(row.unit(system, plot), row.si) if system != "SI" else (1.0, 0.0)
    return size, zero, row.unit(system, plot).replace("m^3", "m3").replace("m^2", "m2")


def shown(value: float, kind: str, system: System, digits: int = 4, plot: bool = False) -> str:
    """A figure with its unit as a text: `8.5 in`.

    digits: significant digits; whole numbers keep all of theirs
    """
    number, text = display(value, kind, system, plot)
    return f"{plain(number, digits)} {text}".rstrip()


def plain(number: float, digits: int) -> str:
    """A number with so many significant digits, and from 1 on without an exponent: 12.3 with one digit is 12."""
    text = f"{number:.{digits}g}"
    return f"{number:.0f}" if "e" in text and abs(number) >= 1 else text


def duration(seconds: float) -> str:
    """A time [s] with a unit of its size: 0.0017 -> "1.7 ms"."""
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds:.3g} s"
