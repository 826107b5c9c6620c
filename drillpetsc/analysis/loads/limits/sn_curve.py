"""Fatigue life of a turning string: Miner's damage by an S-N curve that the user gives.

Pipe that turns in a bend is bent once each way a turn, so the amplitude of the stress is the bending stress. Palmgren and Miner:
damage adds up as cycles over the cycles that the curve allows, and is 1 at failure. The mean stress counts only as far as the
curve has it.
"""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.errors import CaseError
from drillpetsc.units import UnitError, to_si

MPA = 1e6
ROUNDING = 1e-6  # share by which a stress may pass the largest of the curve
_AT = "--sn"
_WANT = "a,b of log10 N = a - b log10(S/MPa), such as 15.0,4.0; or a CSV file with the columns stress [MPa], cycles"


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
    path = Path(name)
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError, ValueError):
        raise CaseError(at=_AT, got=name, want=_WANT, hint="no such CSV file can be read") from None
    lines = [
        (i, line) for i, line in enumerate(text.splitlines(), 1) if line.strip() and line.lstrip()[0] != "#"
    ]
    if not lines:
        raise CaseError(at=_AT, file=path, line=1, got="an empty file", want=_WANT)
    heads = [head.strip() for head in next(csv.reader([lines[0][1]]))]
    names = [head.partition("[")[0].strip().lower() for head in heads]
    if sorted(names) != ["cycles", "stress"]:
        raise CaseError(
            at=_AT, file=path, line=lines[0][0], got=lines[0][1], want="the columns stress [MPa], cycles"
        )
    at = names.index("stress")
    unit = heads[at].partition("[")[2].rstrip("] ") or "MPa"
    points: list[tuple[float, float]] = []
    for line, row in lines[1:]:
        cells = next(csv.reader([row]))
        try:
            stress, cycles = to_si(f"{float(cells[at])!r} {unit}", "Pa"), float(cells[1 - at])
            valid = len(cells) == 2 and 0 < stress < math.inf and 0 < cycles < math.inf
        except (UnitError, ValueError, IndexError):
            valid = False
        if not valid:
            raise CaseError(
                at=_AT,
                file=path,
                line=line,
                got=row,
                want=f"a stress in {unit} and a number of cycles, both above 0",
            )
        points.append((stress, cycles))
    points.sort(key=lambda point: -point[0])
    rises = all(p[0] > q[0] and p[1] < q[1] for p, q in zip(points, points[1:], strict=False))
    if len(points) < 2 or not rises:
        raise CaseError(
            at=_AT,
            file=path,
            got=f"{len(points)} points",
            want="two points or more; cycles that rise as the stress falls",
        )
    return SnCurve(tuple(p[0] for p in points), tuple(p[1] for p in points), path.name)
