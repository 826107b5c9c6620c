"""Units in which figures of hydraulics are printed and plotted; files stay in SI."""

from __future__ import annotations

import re

from drillpetsc.unit_systems import System, display_unit
from drillpetsc.units import to_si

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
_PER_AREA = (("hp/in2", to_si("1 hp", "W") / to_si("1 in2", "m^2")), ("W/mm2", 1e6))
#: name -> unit and its size in SI, in field and in metric units, where the trade has a unit of its own
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


def shown_unit(name: str, unit: str, system: System) -> tuple[float, str]:
    """Size of the unit [SI] in which a quantity is shown, and its text.

    name: of the quantity; unit: SI, as in the heading of its column.
    """
    if system == "SI" or unit == "-":
        return 1.0, "" if unit == "-" else unit
    if name in _OWN:
        text, size = _OWN[name][system != "field"]
        return size, text
    if name in _STRESSES:
        kind: str | None = "yield_point"
    else:
        kind = "diameter" if name in _DIAMETERS else _KIND_OF_UNIT.get(unit)
    if kind is None:
        return 1.0, unit
    size, _, text = display_unit(kind, system)
    return size, text


def lengths_shown(text: str, system: System) -> str:
    """A text of a table or a note with its depths in the units of a system."""
    size, unit = display_unit("length", system)[0], display_unit("length", system)[2]

    def shown(found: re.Match[str]) -> str:
        value = float(found[2]) / size
        return f"{found[1]}{value:.0f} {unit}" if found[1] == "TVD " else f"{found[1]}{value:.6g} {unit}"

    return _LENGTH.sub(shown, text)
