"""Spellings of units on rigs and in reports. Expected values follow from the definitions in NIST SP 811 (2008),
appendix B: inch 25.4 mm, pound 0.45359237 kg, standard gravity 9.80665 m/s2, US gallon 231 in3; oil barrel 42 gallons."""

import math
import subprocess
import sys

import pytest

from drillpetsc.units import UnitError, bare_number, to_si, weight_to_mass
from tests.helpers.tables import each_row

INCH, POUND, G0 = 0.0254, 0.45359237, 9.80665
FOOT, LBF, GALLON, PSI = 12 * INCH, POUND * G0, 231 * INCH**3, POUND * G0 / INCH**2
PER_100_FT2 = LBF / (100 * FOOT**2)
DEGREE = math.pi / 180

# SI unit -> spelling -> factor, each dimension a row of the table of spellings
SPELLINGS: dict[str, dict[str, float]] = {
    "N": {
        **dict.fromkeys(("lbf", "lb", "lbs", "LBF"), LBF),
        **dict.fromkeys(("klbf", "klb", "kip", "kips", "KLBF", "Klb"), 1e3 * LBF),
        **{"N": 1.0, "daN": 10.0, "kdaN": 1e4, "kN": 1e3, "KN": 1e3, "kgf": G0, "MN": 1e6},
        **dict.fromkeys(("tf", "t", "tonne"), 1e3 * G0),
        **{"tonf_us": 2000 * LBF, "tonf_uk": 2240 * LBF},
    },
    "kg": {"kg": 1.0, "t": 1e3, "lb": POUND, "lbm": POUND, "klb": 1e3 * POUND, "klbm": 1e3 * POUND},
    "N m": {
        **dict.fromkeys(("ft-lbf", "ft.lbf", "ft lbf", "lbf-ft", "lbf.ft", "ft-lb", "FT-LBF", "ft·lbf", "ft*lbf"), FOOT * LBF),
        **dict.fromkeys(("kft-lbf", "kft.lb", "kft-lb", "kft lbf"), 1e3 * FOOT * LBF),
        **dict.fromkeys(("N.m", "Nm", "N m", "N-m", "N*m"), 1.0),
        **dict.fromkeys(("kNm", "kN-m", "kN.m", "kN m", "KNM"), 1e3),
        "daN.m": 10.0,
    },
    "kg/m": {
        **dict.fromkeys(("lb/ft", "lbf/ft", "lbm/ft", "ppf", "#", "LB/FT", "#/ft"), POUND / FOOT),
        **{"kg/m": 1.0, "N/m": 1 / G0, "kN/m": 1e3 / G0, "daN/m": 10 / G0},
    },
    "rad/s": {
        **dict.fromkeys(("rpm", "RPM", "rev/min", "r/min", "Rpm"), math.pi / 30),
        **{"deg/s": DEGREE, "rad/s": 1.0},
    },
    "m/s": {
        **dict.fromkeys(("ft/h", "ft/hr", "fph"), FOOT / 3600),
        **dict.fromkeys(("m/h", "m/hr", "M/HR"), 1 / 3600),
        **{"ft/min": FOOT / 60, "m/min": 1 / 60, "ft/s": FOOT},
    },
    "m^3/s": {
        **dict.fromkeys(("gpm", "gal/min", "usgal/min", "galUS/min", "GPM", "USgal/min"), GALLON / 60),
        **dict.fromkeys(("bpm", "bbl/min"), 42 * GALLON / 60),
        **dict.fromkeys(("l/min", "lpm", "L/min", "LPM"), 1e-3 / 60),
        **{"m3/min": 1 / 60, "l/s": 1e-3, "L/s": 1e-3, "m3/h": 1 / 3600},
    },
    "kg/m^3": {
        **dict.fromkeys(("ppg", "lb/gal", "lbm/gal", "PPG"), POUND / GALLON),
        **dict.fromkeys(("sg", "SG", "s.g.", "S.G.", "g/cc", "g/cm3", "kg/l", "kg/L"), 1e3),
        **{"kg/m3": 1.0, "lb/ft3": POUND / FOOT**3, "pcf": POUND / FOOT**3},
        **{"psi/ft": PSI / FOOT / G0, "kPa/m": 1e3 / G0, "bar/m": 1e5 / G0},
    },
    "Pa": {
        **dict.fromkeys(("psi", "psig", "PSI"), PSI),
        **{"ksi": 1e3 * PSI, "kPa": 1e3, "MPa": 1e6, "bar": 1e5, "barg": 1e5, "Bar": 1e5, "Pa": 1.0},
        **{"kgf/cm2": G0 * 1e4, "lbf/ft2": LBF / FOOT**2},
        **dict.fromkeys(("lbf/100ft2", "lb/100ft2", "lbf/100 ft2", "lbf/100 ft^2", "lb / 100 ft²"), PER_100_FT2),
    },
    "Pa s^n": {
        "Pa s^n": 1.0,
        "Pa.s^n": 1.0,
        **dict.fromkeys(("lbf s^n/100ft2", "lb s^n/100ft2", "lbf s^n/100 ft2", "lbf.s^n/100ft2"), PER_100_FT2),
        **{"eq cP": 1e-3, "dyn s^n/100 cm2": 1e-3, "dyn s^n/100cm2": 1e-3, "dyn s^n/cm2": 0.1},
    },
    "Pa s": {**dict.fromkeys(("cP", "cp", "CP", "mPa.s", "mPa s", "mPa*s"), 1e-3), "Pa.s": 1.0},
    "m": {
        **dict.fromkeys(("ft", "'", "FT", "feet"), FOOT),
        **dict.fromkeys(("in", "inch", '"', "IN", "”", "″"), INCH),
        **{"m": 1.0, "mm": 1e-3, "cm": 1e-2, "M": 1.0},
    },
    "1/m": {
        **dict.fromkeys(("deg/100ft", "deg/100 ft", "°/100ft", "DEG/100FT"), DEGREE / (100 * FOOT)),
        **dict.fromkeys(("deg/30m", "deg/30 m", "dega/30m", "deg/(30 m)"), DEGREE / 30),
        **{"deg/10m": DEGREE / 10, "rad/m": 1.0, "1/m": 1.0, "deg/30ft": DEGREE / (30 * FOOT)},
    },
    "rad": {"deg": DEGREE, "dega": DEGREE, "rad": 1.0, "°": DEGREE},
    "m^2": {**dict.fromkeys(("in2", "sq in", "in^2"), INCH**2), "mm2": 1e-6},
    "W": {"hp": 550 * FOOT * LBF, "HHP": 550 * FOOT * LBF, "kW": 1e3, "W": 1.0},
}  # fmt: skip


@each_row(("unit", "spelling"), [(unit, text) for unit, texts in SPELLINGS.items() for text in texts])
def test_every_spelling(unit: str, spelling: str) -> None:
    factor = SPELLINGS[unit][spelling]
    for blank in (" ",) if spelling[0].isdigit() else ("", " "):
        assert to_si(f"12.5{blank}{spelling}", unit) == pytest.approx(12.5 * factor, rel=1e-12)


@each_row(
    ("text", "unit", "expected"),
    [
        ("12 1/4 in", "m", 12.25 * INCH), ('12 1/4"', "m", 12.25 * INCH), ("12-1/4 in", "m", 12.25 * INCH),
        ('12-1/4"', "m", 12.25 * INCH), ("9 5/8 in", "m", 9.625 * INCH), ("9 5/8in", "m", 9.625 * INCH),
        ("1/32 in", "m", INCH / 32), ("30'", "m", 30 * FOOT), ("2 min/m", "m/s", 1 / 120),
        ("2 min/ft", "m/s", FOOT / 120), ("150 degF", "K", (150 - 32) / 1.8 + 273.15),
        ("150 F", "K", (150 - 32) / 1.8 + 273.15), ("80 degC", "K", 353.15), ("80 C", "K", 353.15),
        ("0.03 deg/ft", "1/m", 0.03 * DEGREE / FOOT), ("5 ft-lbf/rad", "N m/rad", 5 * FOOT * LBF),
    ],
)  # fmt: skip
def test_numbers_of_the_field(text: str, unit: str, expected: float) -> None:
    assert to_si(text, unit) == pytest.approx(expected, rel=1e-12)


@each_row(
    ("text", "unit", "hint"),
    [
        ("30 ton", "N", "which ton"),
        ("30 Ton", "N", "which ton"),
        ("30 ton", "kg", "which ton"),
        ("30 kg", "N", "kgf, or a weight in N"),
        ("3000 psia", "Pa", "gauge"),
        ("20 bara", "Pa", "gauge"),
        ("12 1/4", "m", "12 1/4 in"),
        ("3 deg/ft", "1/m", "per 100 ft"),
        ("10°30'", "rad", "decimal degrees"),
        ("10 deg 30 min", "rad", "decimal degrees"),
        ("10 30 15", "rad", "decimal degrees"),
        ("N23E", "rad", "decimal degrees"),
        ("S 45.5 W", "rad", "decimal degrees"),
        ("0 min/m", "m/s", "infinitely"),
        ("5 mpa", "Pa", "not a known unit"),  # mPa or MPa
        ("5 gal", "m^3/s", "volume"),
    ],
)
def test_refused_with_a_hint(text: str, unit: str, hint: str) -> None:
    with pytest.raises(UnitError) as caught:
        to_si(text, unit)
    assert hint in caught.value.hint


def test_weight_keys_take_a_mass_or_a_weight() -> None:
    assert weight_to_mass("60 klb") == pytest.approx(60e3 * POUND, rel=1e-13)
    assert weight_to_mass("60 klbf") == pytest.approx(60e3 * POUND, rel=1e-13)
    assert weight_to_mass("100 kN") == pytest.approx(100e3 / G0, rel=1e-13)
    assert weight_to_mass("27 t") == pytest.approx(27e3, rel=1e-13)
    with pytest.raises(UnitError):
        weight_to_mass("27 m")
    with pytest.raises(UnitError) as caught:
        weight_to_mass("27 ton")
    assert "which ton" in caught.value.hint


def test_bare_numbers() -> None:
    values = {
        "8 1/2": 8.5,
        " 8.5 ": 8.5,
        "1/4": 0.25,
        "8.5 in": None,
        "x": None,
        "1/0": None,
        "9" * 200: None,
    }
    assert {text: bare_number(text) for text in values} == values
    assert bare_number(5) == 5.0 and bare_number(True) is None and bare_number([1]) is None


def test_no_spelling_of_the_table_needs_the_slow_import() -> None:
    spellings = {unit: list(texts) for unit, texts in SPELLINGS.items()}
    script = (
        "import sys\nfrom drillpetsc.units import to_si\n"
        f"spellings = {spellings!r}\n"
        "[to_si('1 ' + text, unit) for unit, texts in spellings.items() for text in texts]\n"
        "assert 'pint' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", script], check=True)
