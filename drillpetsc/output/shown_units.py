"""Units in which the columns of tables are printed and plotted; files stay in SI."""

from __future__ import annotations

import re

from drillpetsc.case.schema import bare_unit_of
from drillpetsc.output import catalogue
from drillpetsc.output.files.tables import split_name
from drillpetsc.unit_systems import System, display_unit, kind_of
from drillpetsc.unit_tables import GRAVITY
from drillpetsc.units import UnitError, to_si

#: kinds of columns that no quantity describes
_KINDS = {
    "offset": "diameter",
    "offset_x": "diameter",
    "offset_y": "diameter",
    "distance_from_centre": "diameter",
    "hole_radius": "diameter",
    "outer_radius": "diameter",
    "contact_diameter": "diameter",
    "yield_strength": "stress",
}
_DIAMETERS = ("od", "id")
_STRESSES = ("yield_stress", "shear_stress", "misfit", "yield_point")
_KIND_OF_UNIT = {
    "Pa": "pressure",
    "m3/s": "flow",
    "kg/m3": "mud_weight",
    "m": "length",
    "m/s": "trip_speed",
    "W": "power",
    "m3": "volume",
    "m2": "flow_area",
    "Pa s^n": "consistency",
    "Pa s": "viscosity",
    "N": "force",
    "N m": "torque",
}
#: a depth or length in metres inside a sentence: `TVD 1233 m`, `casing to 1371.6 m`, `ends at MD 274.32 m, 2164 m above`
_LENGTH = re.compile(r"(TVD |MD |, | to )(\d+(?:\.\d+)?) m(?=[ ,;:)]|$)")
_MINUTE = ("min", 60.0)
_JET = (("ft/s", to_si("1 ft/s", "m/s")), ("m/s", 1.0))
_IMPACT = (("lbf", to_si("1 lbf", "N")), ("kN", 1e3))
_ACCELERATION = (("g", GRAVITY), ("m/s2", 1.0))  # as sensors of vibration are read on a rig
_PER_AREA = (("hp/in2", to_si("1 hp", "W") / to_si("1 in2", "m^2")), ("W/mm2", 1e6))
#: name -> unit and its size in SI, in field and in metric units, for quantities with a special unit in the field
_OWN: dict[str, tuple[tuple[str, float], tuple[str, float]]] = {
    "jet_velocity": _JET,
    "impact_force": _IMPACT,
    "bit_power_per_area": _PER_AREA,
    "nozzle_jet_velocity": _JET,
    "nozzle_impact_force": _IMPACT,
    "nozzle_power_per_area": _PER_AREA,
    "bottoms_up_time": (_MINUTE, _MINUTE),
    "circulation_time": (_MINUTE, _MINUTE),
}


def shown_unit(name: str, unit: str, system: System, plot: bool = False) -> tuple[float, str]:
    """Size of the unit [SI] in which a quantity is shown, and its text.

    name: of the quantity; unit: SI, as in the heading of its column; plot: the unit of axes, if the system has one.
    """
    if system == "SI" or unit == "-":
        return 1.0, "" if unit == "-" else unit
    if unit == "m/s2":
        text, size = _ACCELERATION[system != "field"]
        return size, text
    if name in _OWN:
        text, size = _OWN[name][system != "field"]
        return size, text
    if name in _STRESSES:
        kind: str | None = "yield_point"
    else:
        kind = "diameter" if name in _DIAMETERS else _KIND_OF_UNIT.get(unit)
    if kind is None:
        return 1.0, unit
    size, _, text = display_unit(kind, system, plot)
    return size, text


def key_unit(name: str, unit: str, system: System) -> tuple[float, str]:
    """Size of the unit [SI] in which a key of a case is shown, and its text: the unit of a bare number of the key.

    name: path of the key; unit: SI, empty or `-` for a pure number.
    """
    own = bare_unit_of(name, system) if system != "SI" else ""
    try:
        return (to_si(f"1 {own}", unit), own) if own and unit not in ("", "-") else (1.0, unit.strip("-"))
    except UnitError:  # a key that only the file has
        return 1.0, unit


def unit_of(title: str, system: System, plot: bool = False) -> tuple[float, float, str]:
    """(size of the unit [SI], its zero [SI], unit text) of a column `name [unit]` in a system.

    plot: the unit of axes, if the system has one.  The text is empty for a pure number.
    """
    name, unit = split_name(title)
    if unit in ("-", ""):
        return 1.0, 0.0, ""
    if unit == "deg/30m" and system == "field":
        return 30.0 / 30.48, 0.0, "deg/100ft"
    quantity = catalogue.find(name)
    kind = quantity.kind if quantity is not None else ""
    kind = kind or _KINDS.get(name, "diameter" if unit == "m" and name[:2] in ("x_", "y_") else "")
    if not kind:
        size, text = shown_unit(name, unit, system, plot)
        if text != unit:
            return size, 0.0, text
    kind = kind_of(unit, kind)
    return display_unit(kind, system, plot) if kind else (1.0, 0.0, unit)


def lengths_shown(text: str, system: System) -> str:
    """A text of a table or a note with its depths in the units of a system."""
    size, unit = display_unit("length", system)[0], display_unit("length", system)[2]

    def shown(found: re.Match[str]) -> str:
        value = float(found[2]) / size
        return f"{found[1]}{value:.0f} {unit}" if found[1] == "TVD " else f"{found[1]}{value:.6g} {unit}"

    return _LENGTH.sub(shown, text)
