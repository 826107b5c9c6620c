"""A bent motor that slides, drilling tens of metres: the curve of three points, and the waves of its hole (manual: verif-bent-motor).

The tool is hinged above a stabiliser S, has a full-gauge pad P next to its bend, and the bit B: lengths L2 from S to P, L1 from P to B, the kink b
below P. Without weight, friction and clearance the hole grows along (1 - I) times the slope of the bit plus I times force over weight.
"""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest

from drillpetsc import Case, run
from drillpetsc.output import read_table

E, BORE, HOLE = 206e9, 0.08, 0.2159
START, BIT = 60.0, 0.2  # depth of the hole at the start, and length of the bit [m]
WEIGHT, RATE = 10e3, 10 / 3600  # [N], [m/s]


def stiffness(od: float) -> float:
    return E * math.pi / 64 * (od**4 - BORE**4)


def share(side: float, lower: float, od: float) -> float:
    """`bit_anisotropy` that gives the ratio ``side`` = 3 EI I/(W L1^2) of sideways cutting to the tool's bending."""
    return side * WEIGHT * lower**2 / (3 * stiffness(od))


def bent_motor(
    angle: float, lower: float, upper: float, side: float, od: float, start: float, metres: float
) -> tuple[dict[str, Any], float]:
    """The case, and the distance of the kink below the pad [m].

    angle: [rad]; lower, upper: L1 and L2 [m]; start: curvature of the hole at the start over that of three points.
    """
    md = np.linspace(0, START, 13)
    inclination = math.radians(30) + 2 * angle / (lower + upper) * start * md
    shaft = lower - 0.5 * BIT  # to the centre of the bit, where the rock pushes
    elements = round(shaft / 0.1)
    tube = {"kind": "pipe", "od": od, "id": BORE}
    string: list[dict[str, Any]] = [
        tube | {"length": START - upper - shaft - BIT, "element_length": 2.0},
        {"kind": "stabilizer", "length": 0.0, "od": HOLE, "mass": 90},
        tube | {"length": upper, "element_length": 0.5},
        {"kind": "stabilizer", "length": 0.0, "od": HOLE, "mass": 60},
        tube | {"length": shaft, "element_length": 0.1, "bend": {"angle": angle}},
        {"kind": "bit", "length": BIT, "od": HOLE, "mass": 40},
    ]
    return {
        "gravity": 0.0,
        "material": {"young": E, "poisson": 0.3, "density": 7850},
        "well": {
            "survey": {"md": list(md), "inclination": list(inclination), "azimuth": [0.7] * len(md)},
            "sections": [{"to": START, "kind": "open_hole", "diameter": HOLE, "friction": 0.0}],
        },
        "string": string,
        "joints": [{"at": string[0]["length"], "kind": "universal"}],
        "contact": {"stiffness": 1e9},
        "top": {"kind": "top_drive", "rotation": 0.0, "lowering": RATE},
        "bottom": {"kind": "bit", "friction": 0.0},
        "formation": {
            "drillability": RATE / WEIGHT,
            "rotary_exponent": 0,
            "bit_anisotropy": share(side, lower, od),
        },
        "initial": {"wob": WEIGHT},
        "time": {"mode": "quasi_static", "end": metres / RATE},
    }, 0.5 * shaft / elements


def steady_curvature(angle: float, lower: float, upper: float, side: float, od: float, kink: float) -> float:
    """Curvature of the steady hole [1/m]: a beam-column over S, P and B on a circle, under the weight W.

    Unknown are four constants of A + B x + C cos qx + D sin qx for each of the spans S-P, P-kink and kink-B, the force on the bit
    and the curvature.
    """
    EI = stiffness(od)
    q = math.sqrt(WEIGHT / EI)
    rows, right = [], []
    force, curve = np.eye(14)[12], np.eye(14)[13]

    def w(span: int, x: float, order: int) -> np.ndarray:
        c, s = math.cos(q * x), math.sin(q * x)
        out = np.zeros(14)
        out[4 * span : 4 * span + 4] = (
            (1, x, c, s),
            (0, 1, -q * s, q * c),
            (0, 0, -q * q * c, -q * q * s),
            (0, 0, q**3 * s, -(q**3) * c),
        )[order]
        return out

    def shear(span: int, x: float) -> np.ndarray:
        return EI * w(span, x, 3) + WEIGHT * w(span, x, 1)

    def add(row: np.ndarray, value: float = 0.0) -> None:
        rows.append(row)
        right.append(value)

    k, bit = upper + kink, upper + lower
    for row in (w(0, 0, 0), w(0, 0, 2), w(0, upper, 0), w(1, upper, 0)):
        add(row)
    for order in (1, 2):
        add(w(0, upper, order) - w(1, upper, order))
    add(w(1, k, 0) - w(2, k, 0))
    add(w(2, k, 1) - w(1, k, 1), angle)
    add(w(1, k, 2) - w(2, k, 2))
    add(shear(1, k) - shear(2, k))
    add(w(2, bit, 2))
    add(shear(2, bit) + force)
    add(w(2, bit, 0) - 0.5 * lower * bit * curve)
    cut = share(side, lower, od)
    add((1 - cut) * w(2, bit, 1) - cut / WEIGHT * force - (0.5 * upper + lower) * curve)
    return float(np.linalg.solve(np.array(rows), np.array(right))[13])


def rightmost_root(lower: float, upper: float, side: float) -> complex:
    """Fastest growing wave exp(p s) of the hole [1/m], by Chebyshev collocation of the delay equation (manual: eq-bit-waves)."""
    n, length = 120, lower + upper
    k = np.arange(n + 1)
    x = np.cos(np.pi * k / n)
    c = np.where((k == 0) | (k == n), 2.0, 1.0) * (-1.0) ** k
    gap = x[:, None] - x[None]
    D = np.outer(c, 1 / c) / (gap + np.eye(n + 1))
    D -= np.diag(D.sum(axis=1))
    D *= 2 / length
    s = 0.5 * (x - 1) * length

    def at(place: float) -> np.ndarray:
        weight = (-1.0) ** k
        weight[[0, -1]] *= 0.5
        near = np.abs(place - s) < 1e-12
        if near.any():
            return near.astype(float)
        q = weight / (place - s)
        return q / q.sum()

    pad, slope = at(-lower), (at(-lower) - at(-length)) / upper
    D[0] = slope + ((upper / lower + 1.5) - side) / length * (at(0.0) - pad - lower * slope)
    roots = np.linalg.eigvals(D)
    return max(roots[roots.imag > 0.1], key=lambda p: p.real)


def drill(tmp_path, *keys) -> tuple[np.ndarray, np.ndarray, float]:
    """Depths [m] and inclinations [rad] of the hole, and the distance of the kink below the pad [m]."""
    case, kink = bent_motor(*keys)
    run(Case(**case), tmp_path / "run")
    hole = read_table(tmp_path / "run" / "trajectory.csv")
    md, inclination = (hole[next(n for n in hole if n.startswith(q))] for q in ("md", "inclination"))
    assert np.ptp(hole[next(n for n in hole if n.startswith("azimuth"))]) < 1e-6  # [deg]
    return md, np.radians(inclination), kink


FOOT = 0.3048


@pytest.mark.parametrize(
    ("angle", "lower", "upper", "side", "od", "start"),
    [
        (math.radians(1.25), 6 * FOOT, 30 * FOOT, 30.0, 0.130, 1.0),
        (math.radians(1.8), 2.1, 3.9, 4.0, 0.150, 1.3),
    ],
)
def test_the_curve_of_three_points(angle, lower, upper, side, od, start, tmp_path):
    """C15 as a run: from an arc the hole comes to the curvature of the beam-column within 0.3 %. For 1.25 deg, 6 ft and 30 ft,
    6.944 deg/100 ft by the rule 2 th/(L1 + L2); the tool's bending takes 6 % of it where the bit cuts sideways well."""
    md, inclination, kink = drill(tmp_path, angle, lower, upper, side, od, start, 40.0)
    new = md > START + 15
    found = np.polyfit(md[new], inclination[new], 1)[0]
    expected = steady_curvature(angle, lower, upper, side, od, kink)
    assert found == pytest.approx(expected, rel=3e-3)
    rule = 2 * angle / (lower + upper)
    assert found < rule and not wavy(tmp_path)
    if side == 30.0:
        assert math.degrees(rule) * 100 * FOOT == pytest.approx(6.944, rel=1e-4)
        assert found == pytest.approx(rule, rel=0.06)


def test_a_stiff_tool_on_a_bit_that_cuts_sideways_drills_waves(tmp_path):
    """Above a ratio of about 40 the delay equation grows: the hole winds with the length of its root, within 1 %, about as fast."""
    lower, upper = 6 * FOOT, 30 * FOOT
    assert rightmost_root(lower, upper, 30.0).real < -0.04
    root = rightmost_root(lower, upper, 100.0)
    assert root.real > 0.05
    md, inclination, _ = drill(tmp_path, math.radians(0.5), lower, upper, 100.0, 0.1715, 1.0, 30.0)
    s = np.arange(START + 4, START + 29, 0.01)
    wave = np.interp(s, md, inclination)
    wave -= np.polyval(np.polyfit(s, wave, 1), s)
    zeros = s[:-1][wave[:-1] * wave[1:] < 0]
    assert np.pi / np.mean(np.diff(zeros)) == pytest.approx(root.imag, rel=0.01)
    first, last = (np.abs(wave[(s >= a) & (s < a + 4)]).max() for a in (START + 8, START + 24))
    growth = math.log(last / first) / 16
    assert 0.7 * root.real < growth < 1.05 * root.real
    assert wavy(tmp_path) == (severest(md, inclination, 3.0) > math.radians(30) / 30)


def test_a_hole_that_winds_beyond_any_survey_is_doubted(tmp_path):
    """The same tool with three times the kink: within 10 m bends over 3 m exceed 30 deg/30 m, and the rates of the hole are doubted."""
    md, inclination, _ = drill(tmp_path, math.radians(1.5), 6 * FOOT, 30 * FOOT, 100.0, 0.1715, 1.0, 10.0)
    assert severest(md, inclination, 3.0) > math.radians(30) / 30
    assert wavy(tmp_path)


def severest(md: np.ndarray, inclination: np.ndarray, course: float) -> float:
    """Largest dogleg [rad/m] over a course [m] of a hole in a plane, from one course below its start."""
    s = np.arange(START + course, md[-1], 0.05)
    return (
        float(np.abs(np.interp(s, md, inclination) - np.interp(s - course, md, inclination)).max()) / course
    )


def wavy(tmp_path) -> bool:
    warnings = json.loads((tmp_path / "run" / "summary.json").read_text())["warnings"]
    return any("the new hole has waves" in text for text in warnings)
