"""Fatigue of a turning string: doglegs that drill pipe withstands, forces on its tool joints there, and damage by an S-N curve, in SI.

API RP 7G; Lubinski, Maximum permissible dog-legs in rotary boreholes, JPT 13(2), 1961. Curvatures are in 1/m: a
dogleg of 1 deg/100 ft is 5.726e-4 1/m. Arguments may be numbers or arrays.

Pipe that turns in a bend is bent once each way a turn, so the amplitude of the stress is the bending stress. Palmgren and Miner:
damage adds up as cycles over the cycles that the curve allows, and is 1 at failure. The mean stress counts only as far as the
curve has it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike
from pydantic_core import PydanticCustomError

from drillpetsc.analysis.loads.limits.strength import PSI
from drillpetsc.arrays import FloatArray
from drillpetsc.case.files.quantity_file import QuantityColumn, QuantityFile
from drillpetsc.errors import CaseError

CORROSIVE = 0.6  # share of the permissible dogleg in corrosive mud (API RP 7G)
#: rule of the bending stress by grade: E (E-75) or S (S-135); for X and G the standard has no rule of its own
RULES = {"E-75": "E", "E75": "E", "S-135": "S", "S135": "S"}
AS_S = {"X-95": "S", "X95": "S", "G-105": "S", "G105": "S"}
_RANGE = {"E": 67000.0, "S": 133400.0}  # largest axial stress of each rule [psi]


def rule_of(grade: str | None) -> str | None:
    """Rule for a grade: E, S, or None if there is none."""
    if grade is None:
        return None
    name = grade.upper().replace(" ", "")
    return RULES.get(name) or AS_S.get(name)


def fatigue_bending_stress(axial_stress: ArrayLike, rule: str) -> FloatArray:
    """Bending stress that drill pipe under tension withstands without fatigue [Pa] (API RP 7G).

    E: 19,500 - (10/67) s_t - (0.6/670^2) (s_t - 33,500)^2 psi up to s_t = 67,000 psi.
    S: 20,000 (1 - s_t/145,000) psi up to 133,400 psi.
    nan beyond, and in compression, of which the standard does not speak.

    axial_stress: tension over section [Pa]; rule: E or S.
    """
    tension = np.asarray(axial_stress, dtype=float) / PSI
    if rule == "E":
        stress = 19500 - 10 / 67 * tension - 0.6 / 670**2 * (tension - 33500) ** 2
    else:
        stress = 20000 * (1 - tension / 145000)
    return np.asarray(np.where((tension >= 0) & (tension <= _RANGE[rule]), stress * PSI, np.nan))


def tension_factor(pull: ArrayLike, stiffness: ArrayLike, half_joint: ArrayLike) -> FloatArray:
    """Curvature of the hole over the largest of the pipe in it, tanh(K l)/(K l) with K = sqrt(T/EI) (Lubinski 1961).

    Tension holds the pipe straight between tool joints and bends it beside them. 1 without tension.

    pull: T [N], not negative; stiffness: EI [N m2]; half_joint: l, half the length of a joint [m].
    """
    product = np.sqrt(np.maximum(pull, 0.0) / np.asarray(stiffness)) * np.asarray(half_joint)
    small = product < 1e-4
    return np.asarray(np.where(small, 1.0, np.tanh(product) / np.where(small, 1.0, product)))


def permissible_dogleg(
    pull: ArrayLike,
    outer: ArrayLike,
    section: ArrayLike,
    stiffness: ArrayLike,
    half_joint: ArrayLike,
    rule: str,
    young: ArrayLike,
) -> FloatArray:
    """Curvature of a hole in which drill pipe may rotate without fatigue [1/m] (API RP 7G).

    2 s_b/(E D) tanh(K l)/(K l); in field units (432,000/pi) s_b/(E D) tanh(K l)/(K l) deg/100 ft.

    pull: effective tension, the buoyed weight below [N]; nan in compression.
    outer: diameter of the tube [m]; section [m2]; stiffness: EI of the tube [N m2]; half_joint: l [m].
    rule: E or S; young: Young's modulus [Pa].
    """
    bending = fatigue_bending_stress(np.asarray(pull) / np.asarray(section), rule)
    return np.asarray(
        2 * bending / (np.asarray(young) * np.asarray(outer)) * tension_factor(pull, stiffness, half_joint)
    )


MPA = 1e6
ROUNDING = 1e-6  # share by which a stress may pass the largest of the curve
_AT = "--sn"
_WANT = "a,b of log10 N = a - b log10(S/MPa), such as 15.0,4.0; or a CSV file with the columns stress [MPa], cycles"
_FILE = QuantityFile(
    {
        "stress": QuantityColumn("Pa", ("stress",), {"stress": "MPa"}),
        "cycles": QuantityColumn("", ("cycles",), {}),
    },
    "stress [MPa], cycles",
    "a,b of log10 N = a - b log10(S/MPa)",
)


@dataclass(frozen=True)
class SnCurve:
    """Cycles to failure over the amplitude of the stress, straight in logarithms between points.

    stress: amplitudes [Pa], falling; cycles: to failure [-], rising; source: of the curve, for reports.
    line: the first and last piece go on beyond the points; else there is no number above the largest stress.
    """

    stress: tuple[float, ...]
    cycles: tuple[float, ...]
    source: str
    line: bool = False

    def cycles_at(self, amplitude: FloatArray) -> FloatArray:
        """Compute cycles to failure at amplitudes [Pa], of any shape; inf without stress, nan above the curve.

        Below the least stress of a table its last piece goes on: a limit of endurance is not assumed.
        """
        s, n = np.log(self.stress[::-1]), np.log(self.cycles[::-1])
        with np.errstate(divide="ignore"):
            x = np.log(np.asarray(amplitude, dtype=float))
        out = np.interp(x, s, n)
        low = (n[1] - n[0]) / (s[1] - s[0])
        out = np.where(x < s[0], n[0] + low * (x - s[0]), out)
        beyond = n[-1] + (n[-1] - n[-2]) / (s[-1] - s[-2]) * (x - s[-1]) if self.line else np.nan
        with np.errstate(over="ignore"):
            return np.exp(np.where(x > s[-1] + ROUNDING, beyond, out))

    def damage_per_hour(self, amplitude: FloatArray, rotation: float) -> FloatArray:
        """Compute Miner's damage per hour [1/h] at amplitudes [Pa] and a rotation [rad/s]."""
        return 3600 * abs(rotation) / (2 * math.pi) / self.cycles_at(amplitude)


def read_sn(text: str) -> SnCurve:
    """The curve of the option `--sn`: two numbers, or the name of a CSV file.

    Raises CaseError for other texts, and for curves that do not fall.
    """
    parts = text.split(",")
    try:
        numbers = [float(part) for part in parts]
    except ValueError:
        return _read_file(text)
    if len(numbers) != 2 or not (0 < numbers[0] <= 100 and 0 < numbers[1] <= 50):
        raise CaseError(at=_AT, got=text, want=_WANT)
    a, b = numbers
    stress = (1000.0, 1.0)
    cycles = tuple(10.0 ** (a - b * math.log10(s)) for s in stress)
    if not all(0 < n < math.inf for n in cycles):
        raise CaseError(at=_AT, got=text, want=_WANT)
    return SnCurve(tuple(s * MPA for s in stress), cycles, f"log10 N = {a:g} - {b:g} log10(S/MPa)", line=True)


def _read_file(name: str) -> SnCurve:
    try:
        found = _FILE.read(name)
    except PydanticCustomError:
        raise CaseError(at=_AT, got=name, want=_WANT, hint="no such CSV file can be read") from None
    except CaseError as error:
        error.at = _AT
        raise
    points = sorted(zip(found["stress"], found["cycles"], strict=True), key=lambda point: -point[0])
    rises = all(p[0] > q[0] and p[1] < q[1] for p, q in zip(points, points[1:], strict=False))
    if len(points) < 2 or not rises or not all(0 < q < math.inf for point in points for q in point):
        want = "two points or more above 0; cycles that rise as the stress falls"
        raise CaseError(at=_AT, file=Path(name), got=f"{len(points)} points", want=want)
    return SnCurve(tuple(p[0] for p in points), tuple(p[1] for p in points), Path(name).name)
