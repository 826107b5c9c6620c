"""Tables of `units.py`: dimensions, spellings of units with their factor to SI, and messages for ambiguous ones."""

from __future__ import annotations

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
    "W": ("a power", "500 hp or 370 kW"),
    "W/m": ("a power per length", "10 W/m"),
    "N m/s": ("a rate of a torque", "50 kN m/s"),
    "1/s^2": ("a squared rate", "5 1/s2"),
    "N/s": ("a rate of a force", "5 kN/s"),
    "m/(s^2 N)": ("an integral gain of a force", "2e-9 m/(s2 N)"),
    "m/(s N m)": ("a gain of a torque", "5e-7 m/(s N m)"),
    "m/(s^2 N m)": ("an integral gain of a torque", "2e-8 m/(s2 N m)"),
    "m/(s Pa)": ("a gain of a pressure", "5e-9 m/(s Pa)"),
    "m/(s^2 Pa)": ("an integral gain of a pressure", "2e-10 m/(s2 Pa)"),
}

# fmt: off
# SI unit of a key -> spelling of a unit (as `_tidy` of `units.py` leaves it) -> factor to SI. The factors are pint's. pint takes longer
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
    "kg m^2": {"kg m^2": 1.0, "lb ft^2": 0.0421401100938048},
    "kg/m^3": {"kg/m^3": 1.0, "g/cm^3": 999.9999999999999, "kg/l": 999.9999999999999, "lb/gal": 119.82642731689667, "ppg": 119.82642731689667, "lb/ft^3": 16.01846337396015, "t/m^3": 1000.0},
    "m/s": {"m/s": 1.0, "m/h": 0.0002777777777777778, "m/min": 0.016666666666666666, "mm/s": 0.001, "cm/s": 0.01, "km/h": 0.2777777777777778, "ft/s": 0.30479999999999996, "ft/min": 0.0050799999999999994, "ft/h": 8.466666666666666e-05, "in/min": 0.0004233333333333333},
    "m/s^2": {"m/s^2": 1.0, "ft/s^2": 0.30479999999999996},
    "m^3/s": {"m^3/s": 1.0, "l/s": 0.0010000000000000002, "l/min": 1.666666666666667e-05, "m^3/h": 0.0002777777777777778, "m^3/min": 0.016666666666666666, "gal/min": 6.309019639999999e-05, "gpm": 6.309019639999999e-05, "bbl/min": 0.0026497882487999994},
    "rad": {"rad": 1.0, "deg": 0.017453292519943295},
    "rad/s": {"rad/s": 1.0, "rpm": 0.10471975511965977, "deg/s": 0.017453292519943295, "rev/min": 0.10471975511965977, "rev/s": 6.283185307179586},
    "1/m": {"1/m": 1.0, "rad/m": 1.0, "deg/m": 0.017453292519943295, "1/km": 0.001, "1/ft": 3.2808398950131235},
    "N": {"N": 1.0, "kN": 1000.0, "MN": 1000000.0, "lbf": 4.4482216152605005, "klbf": 4448.221615260501},
    "N/m": {"N/m": 1.0, "kN/m": 1000.0, "MN/m": 1000000.0, "N/mm": 1000.0, "lbf/ft": 14.59390293720637, "lbf/in": 175.12683524647645},
    "N m": {"N m": 1.0, "kN m": 1000.0, "MN m": 1000000.0, "ft lbf": 1.3558179483314001, "N*m": 1.0, "kN*m": 1000.0},
    "N m/m": {"N m/m": 1.0},
    "N m^2": {"N m^2": 1.0, "kN m^2": 1000.0, "MN m^2": 1000000.0, "lbf ft^2": 0.41325331065141085},
    "N m/rad": {"N m/rad": 1.0, "kN m/rad": 1000.0, "N m": 1.0, "ft lbf/rad": 1.3558179483314001},
    "N m s/rad": {"N m s/rad": 1.0, "kN m s/rad": 1000.0, "N m s": 1.0, "ft lbf s/rad": 1.3558179483314001},
    "Pa": {"Pa": 1.0, "kPa": 1000.0, "MPa": 1000000.0, "GPa": 1000000000.0, "bar": 100000.0, "psi": 6894.7572931683635, "ksi": 6894757.293168363, "N/m^2": 1.0, "N/mm^2": 1000000.0},
    "Pa s": {"Pa s": 1.0, "mPa s": 0.001, "cP": 0.001},
    "N s/m": {"N s/m": 1.0, "kN s/m": 1000.0, "MN s/m": 1000000.0},
    "N s/m^2": {"N s/m^2": 1.0, "Pa s": 1.0},
    "N/m^2.5": {"N/m^2.5": 1.0},
    "N/m^1.5": {"N/m^1.5": 1.0},
    "Pa s^n": {"Pa second_to_the_n": 1.0, "mPa second_to_the_n": 0.001},
    "K": {"K": 1.0},
    "W": {"W": 1.0, "kW": 1000.0, "MW": 1000000.0},
    "W/m": {"W/m": 1.0, "kW/m": 1000.0, "ft lbf/ft/h": 0.001235617115350139},
    "N m/s": {"N m/s": 1.0, "kN m/s": 1000.0},
    "1/s^2": {"1/s^2": 1.0},
    "N/s": {"N/s": 1.0, "kN/s": 1000.0},
    "m/(s^2 N)": {"m/(s^2 N)": 1.0, "m/s^2/N": 1.0},
    "m/(s N m)": {"m/(s N m)": 1.0},
    "m/(s^2 N m)": {"m/(s^2 N m)": 1.0},
    "m/(s Pa)": {"m/(s Pa)": 1.0, "m/s/Pa": 1.0},
    "m/(s^2 Pa)": {"m/(s^2 Pa)": 1.0, "m/s^2/Pa": 1.0},
    "m/(s N)": {"m/(s N)": 1.0, "m/h/kN": 2.7777777777777776e-07, "m/(h kN)": 2.7777777777777776e-07, "m/s/N": 1.0, "ft/h/lbf": 1.903382384910882e-05},
}
# fmt: on

INCH, POUND, GRAVITY = (
    0.0254,
    0.45359237,
    9.80665,
)  # [m], [kg], [m/s2]: exact by definition (NIST SP 811, appendix B)
FOOT, _POUND_FORCE, _GALLON = 12 * INCH, POUND * GRAVITY, 231 * INCH**3  # [m], [N], [m3] (US gallon)
_BARREL, _PSI, _DEGREE = 42 * _GALLON, _POUND_FORCE / INCH**2, 0.017453292519943295
_TON = 1000 * GRAVITY  # [N] weight of a tonne
_PER_100_FT2 = _POUND_FORCE / (100 * FOOT**2)  # [Pa] lbf/100 ft2

# fmt: off
# Spellings of the oil field, some of which pint reads as something else (cp is a cup, bpm a heart rate). The keys are written
# as `canonical` leaves a unit. They are looked up before pint is called.
FIELD: dict[str, dict[str, float]] = {
    "m": {'"': INCH, "inch": INCH, "inches": INCH, "'": FOOT, "feet": FOOT, "foot": FOOT, "ftUS": 1200 / 3937, "meter": 1.0, "meters": 1.0,
          "metre": 1.0, "metres": 1.0},
    "m^2": {"sq in": INCH**2, "sqin": INCH**2, "sq ft": FOOT**2, "sqft": FOOT**2, "sq mm": 1e-6},
    "m^3": {"bbls": _BARREL, "L": 1e-3, "usgal": _GALLON},
    "1/s": {"1/sec": 1.0, "s^-1": 1.0},
    "s": {"sec": 1.0, "hr": 3600.0},
    "kg": {"lbm": POUND, "lbs": POUND, "klbm": 1e3 * POUND, "short_ton": 2000 * POUND, "long_ton": 2240 * POUND},
    "kg/m": {"lbf/ft": POUND / FOOT, "lbm/ft": POUND / FOOT, "ppf": POUND / FOOT, "#": POUND / FOOT, "#/ft": POUND / FOOT,
             "N/m": 1 / GRAVITY, "kN/m": 1e3 / GRAVITY, "daN/m": 10 / GRAVITY},
    "kg/m^3": {"sg": 1e3, "SG": 1e3, "s.g.": 1e3, "g/cc": 1e3, "kg/dm^3": 1e3, "lbm/gal": POUND / _GALLON, "lb/usgal": POUND / _GALLON,
               "lbm/ft^3": POUND / FOOT**3, "pcf": POUND / FOOT**3,
               "psi/ft": _PSI / FOOT / GRAVITY, "kPa/m": 1e3 / GRAVITY, "bar/m": 1e5 / GRAVITY},
    "m/s": {"m/hr": 1 / 3600, "ft/hr": FOOT / 3600, "fph": FOOT / 3600, "fpm": FOOT / 60, "m/sec": 1.0, "ft/sec": FOOT},
    "m^3/s": {"usgal/min": _GALLON / 60, "galUS/min": _GALLON / 60, "gal(US)/min": _GALLON / 60, "usgpm": _GALLON / 60, "bpm": _BARREL / 60,
              "lpm": 1e-3 / 60, "L/min": 1e-3 / 60, "L/s": 1e-3, "m^3/hr": 1 / 3600, "m^3/sec": 1.0, "l/sec": 1e-3},
    "rad": {"dega": _DEGREE, "degree": _DEGREE, "degrees": _DEGREE},
    "rad/s": {"r/min": 0.10471975511965977, "rev/sec": 6.283185307179586, "rad/sec": 1.0, "rps": 6.283185307179586, "dega/s": _DEGREE},
    "1/m": {f"{angle}/{length}": _DEGREE / meters for angle in ("deg", "dega")
            for length, meters in (("100ft", 100 * FOOT), ("30ft", 30 * FOOT), ("30m", 30.0), ("10m", 10.0), ("ft", FOOT))},
    "N": {"lb": _POUND_FORCE, "lbs": _POUND_FORCE, "klb": 1e3 * _POUND_FORCE, "klbs": 1e3 * _POUND_FORCE, "kip": 1e3 * _POUND_FORCE,
          "kips": 1e3 * _POUND_FORCE, "daN": 10.0, "kdaN": 1e4, "kgf": GRAVITY, "tf": _TON, "t": _TON, "tonne": _TON, "tonnes": _TON,
          "tonf_us": 2000 * _POUND_FORCE, "tonf_uk": 2240 * _POUND_FORCE},
    "N/m": {"lb/ft": _POUND_FORCE / FOOT, "daN/m": 10.0, "lb/in": _POUND_FORCE / INCH},
    "N m": {**{f"{force} {length}": size * arm for force, size in (("lbf", _POUND_FORCE), ("lb", _POUND_FORCE))
               for length, arm in (("ft", FOOT), ("in", INCH))},
            **{f"{length} {force}": size * arm for force, size in (("lbf", _POUND_FORCE), ("lb", _POUND_FORCE))
               for length, arm in (("ft", FOOT), ("kft", 1e3 * FOOT), ("in", INCH))},
            "klbf ft": 1e3 * _POUND_FORCE * FOOT, "klb ft": 1e3 * _POUND_FORCE * FOOT, "ft klbf": 1e3 * _POUND_FORCE * FOOT,
            "ft klb": 1e3 * _POUND_FORCE * FOOT, "ft lbs": _POUND_FORCE * FOOT, "Nm": 1.0, "kNm": 1e3, "daN m": 10.0, "daNm": 10.0,
            "kdaN m": 1e4, "kgf m": GRAVITY},
    "Pa": {"psig": _PSI, "barg": 1e5, "kgf/cm^2": GRAVITY * 1e4, "lbf/ft^2": _POUND_FORCE / FOOT**2, "lb/ft^2": _POUND_FORCE / FOOT**2,
           "lbf/100ft^2": _PER_100_FT2, "lb/100ft^2": _PER_100_FT2, "dyn/cm^2": 0.1},
    "Pa s": {"cp": 1e-3, "centipoise": 1e-3, "mPas": 1e-3},
    "Pa s^n": {"Pa s^n": 1.0, "mPa s^n": 1e-3, "lbf s^n/100ft^2": _PER_100_FT2, "lb s^n/100ft^2": _PER_100_FT2, "eq cP": 1e-3, "eqcP": 1e-3,
               "dyn s^n/100cm^2": 1e-3, "dyn s^n/cm^2": 0.1},
    "W": {"hp": 550 * _POUND_FORCE * FOOT, "HHP": 550 * _POUND_FORCE * FOOT},
    "J": {"J": 1.0, "ft lbf": FOOT * _POUND_FORCE},
    "rad/m^3": {"rad/m^3": 1.0, "rev/l": 6283.185307179586, "rev/gal": 1659.8419579441947},
}

# SI unit of a key -> spelling -> (size of a degree, value of its zero), both in the SI unit
WITH_ZERO: dict[str, dict[str, tuple[float, float]]] = {
    "K": {"degc": (1.0, 273.15), "c": (1.0, 273.15), "degf": (5 / 9, 273.15 - 160 / 9), "f": (5 / 9, 273.15 - 160 / 9)},
}

# SI unit of a key -> spelling of its inverse -> factor: 2 min/m is 120 s/m, which is 1/120 m/s
INVERSE: dict[str, dict[str, float]] = {"m/s": {"min/m": 60.0, "min/ft": 60 / FOOT, "s/m": 1.0, "h/m": 3600.0}}

_WHICH_TON = "which ton? t (tonne), tonf_us (2000 lbf) or tonf_uk (2240 lbf)"
_GAUGE = "gauge pressures here: psi or bar above atmospheric"
_DECIMAL = "decimal degrees, such as 23.5 deg"
# SI unit of a key -> spelling -> why it is refused
REFUSED: dict[str, dict[str, str]] = {
    "N": {"ton": _WHICH_TON, "tons": _WHICH_TON, "kg": "'kg' is a mass; kgf, or a weight in N"},
    "kg": {"ton": "which ton? t (tonne), short_ton or long_ton", "tons": "which ton? t (tonne), short_ton or long_ton"},
    "Pa": {"psia": _GAUGE, "bara": _GAUGE},
    "rad": {"'": _DECIMAL, '"': _DECIMAL},
}
# fmt: on

# Units that differ by the case of their letters alone; all others may be written in any case.
KEEP_CASE = frozenset({"mm", "mm^2", "sq mm", "mm/s", "um", "ms", "us", "s", "g", "g m", "h", "d"})
KEEP_CASE |= {
    "MPa",
    "mPa s",
    "mPas",
    "mPa s^n",
    "N/mm^2",
    "N/mm",
    "MN",
    "MN/m",
    "MN m",
    "MN m^2",
    "kg mm",
    "MW",
    "t/m^3",
    "K",
}
