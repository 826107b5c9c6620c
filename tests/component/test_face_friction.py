"""Friction of the face of a bit that turns and moves sideways (manual: verif-bit-face)."""

from __future__ import annotations

import ctypes

import numpy as np
import pytest
from scipy.special import ellipe, ellipk

from drillpetsc.kernels import function, pointer
from drillpetsc.kernels.parameters import Parameters, constant
from drillpetsc.physics.bit.bit_on_bottom import RESULTS
from tests.helpers.tables import each_row

RADIUS, FRICTION, WEIGHT, SPIN = 0.108, 0.3, 5e4, 8.0
#: q, f and h by quadrature over the disc, to four places (mean slip of a uniformly pressed disc and its derivative)
TABLE = [
    (0.1, 0.0999, 0.9925), (0.3, 0.2966, 0.9337), (0.5, 0.4838, 0.8216), (0.7, 0.6540, 0.6690),
    (1.0, 8 / (3 * np.pi), 4 / (3 * np.pi)), (1.5, 0.9408, 0.2607), (2.0, 0.9677, 0.1917),
    (4.0, 0.9921, 0.0942),
]  # fmt: skip


def face(sideways: float, spin: float = SPIN, slip: float = 1e-9) -> tuple[np.ndarray, np.ndarray]:
    """Rows (7,) [N, -, N m] of a bit whose face is at its node, and its results; it moves north with ``sideways`` [m/s]."""
    stiffness = 1e8
    p = Parameters(
        "bit_contact",
        1,
        face=0.0,
        radius=RADIUS,
        stiffness=stiffness,
        friction=FRICTION,
        end=0.0,
        axis=[0.0, 0.0, 1.0],
        slip=slip,
        imposed=constant("not_imposed"),
    )
    x = np.array([0.0, 0.0, WEIGHT / stiffness, 0.0, 0.0, 1.0, 0.0])
    y = np.array([sideways, 0.0, 0.0, 0.0, 0.0, 0.0, spin])
    index, rows, results = np.arange(7, dtype=np.int32), np.zeros(7), np.zeros(RESULTS.width)
    head = pointer(index), pointer(p.array), ctypes.c_void_p()
    function("bit_contact_residual", "ipppppp" + "p")(
        1, *head, pointer(x), pointer(y), pointer(y), pointer(rows)
    )
    function("bit_contact_results", "iippppp" + "p")(1, 7, *head, pointer(x), pointer(y), pointer(results))
    return rows, results


@each_row(("q", "f", "h"), TABLE)
def test_force_and_torque_of_a_disc(q, f, h):
    """Lateral force mu W f(q) and torque 2/3 mu W a h(q) at q = v/(Omega a), to the places of the table."""
    rows, results = face(q * SPIN * RADIUS)
    assert rows[0] / (FRICTION * WEIGHT) == pytest.approx(f, abs=1e-4)
    assert rows[6] / (2 / 3 * FRICTION * WEIGHT * RADIUS) == pytest.approx(h, abs=1e-4)
    assert rows[1] == 0 and rows[2] == pytest.approx(WEIGHT)
    power = rows[0] * q * SPIN * RADIUS + rows[6] * SPIN
    assert results[RESULTS["power"]] == pytest.approx(power, rel=1e-12)


def test_potential_of_a_disc():
    """Both follow from g, the mean distance of a point from the points of a disc: f = g', h = 3/2 (g - q g').

    g = 4/(9 pi) [(q^2 + 7) E(q^2) - 4 (1 - q^2) K(q^2)] for q < 1, and what continues it beyond (complete elliptic integrals).
    The power F v + T Omega is mu W a Omega g(q), and the small-speed dashpot is mu W/(Omega a).
    """

    def mean_distance(q: float) -> float:
        if q < 1:
            return 4 / (9 * np.pi) * ((q * q + 7) * ellipe(q * q) - 4 * (1 - q * q) * ellipk(q * q))
        m = 1 / q**2
        outer = (q * q + 7) * ellipe(m) * q - (q * q - 1) * (q * q + 3) / q * ellipk(m)
        return 4 / (9 * np.pi) * outer

    for q in np.concatenate([np.linspace(0.003, 0.98, 60), np.geomspace(1.02, 300.0, 60)]):
        rows, results = face(q * SPIN * RADIUS)
        scale = FRICTION * WEIGHT * RADIUS * SPIN
        assert results[RESULTS["power"]] == pytest.approx(scale * mean_distance(q), rel=1e-6)
    rows, _ = face(1e-6)
    assert rows[0] == pytest.approx(FRICTION * WEIGHT / (SPIN * RADIUS) * 1e-6, rel=1e-6)


def test_a_centred_face_has_the_torque_of_the_ring():
    """Without sideways motion the torque is that of a ring at 2/3 of the radius, its rounding included; a face that slides without
    turning has the friction mu W."""
    for spin in (-3.0, -0.01, 0.0, 0.02, 7.0):
        v = 2 / 3 * RADIUS * spin
        expected = 2 / 3 * FRICTION * RADIUS * WEIGHT * v / np.hypot(v, 0.01)
        assert face(0.0, spin, 0.01)[0][6] == pytest.approx(expected, rel=1e-9, abs=1e-9)
    rows, _ = face(5.0, 0.0, 0.01)
    assert rows[0] == pytest.approx(FRICTION * WEIGHT, rel=1e-4) and rows[6] == 0
