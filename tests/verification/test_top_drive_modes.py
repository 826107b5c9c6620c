"""Torsional modes and critical speeds of a string under a controlled top drive (manual: verif-top-drive).

The expected roots are those of the wave equation of the pipe with the impedance Z(s) of the drive at its top and a body (and
a bit law's slope) at its bottom, solved here by Newton's method.
"""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case
from drillpetsc.analysis.linear.modal import modes, prepare_state
from drillpetsc.model.drilling_model import build_model
from drillpetsc.physics.top.top_drive import MotorDrive
from tests.helpers import top_drive_models as m


def impedance(name: str):
    """Z(s) of a drive, written out once more (manual: eq-top-drive-impedance)."""
    I, z = m.INERTIA, m.ZETA
    if name.startswith("soft"):
        kappa = 0.75 if name.endswith("0.75") else 0.0
        return lambda s: I * (1 - kappa) * s + 4 * z + (2 * np.pi * 0.2) ** 2 * (1 - kappa) * I / s
    if name == "stiff":
        return lambda s: I * s + 50 * z + 5 * I / s
    factor, T = float(name.split()[1]), 20 / (2 * np.pi)

    def matched(s):
        C = 50 * z + 5 * I / s
        return (I * s + C) / (1 + factor / z * T * s / (1 + T * s) * C)

    return matched


def characteristic(s: complex, Z, slope: float = 0.0) -> complex:
    """Zero at a root: (J s^2 + slope s)(cosh kL + b sinh kL) + GJ k (sinh kL + b cosh kL), k = s/c, b = Z s/(GJ k)."""
    k = s / m.SPEED
    b, kL = Z(s) * s / (m.GJ * k), k * m.LENGTH
    body = m.BODY * s**2 + slope * s
    return body * (np.cosh(kL) + b * np.sinh(kL)) + m.GJ * k * (np.sinh(kL) + b * np.cosh(kL))


def root(start: complex, Z, slope: float = 0.0) -> complex:
    """The root near ``start``, by the secant method."""
    a, b = start, start * (1 + 1e-4)
    fa, fb = characteristic(a, Z, slope), characteristic(b, Z, slope)
    for _ in range(100):
        a, b, fa = b, b - fb * (b - a) / (fb - fa), fb
        fb = characteristic(b, Z, slope)
        if abs(b - a) < 1e-13 * abs(b):
            break
    return b


CONTROLS = {
    "stiff": m.STIFF,
    "soft 0": m.SOFT,
    "soft 0.75": m.COMPENSATED,
    "z 0.25": m.Z_TORQUE,
    "z 1": m.Z_TORQUE_1,
}
#: growth [1/s] and frequency [Hz], as computed for this check before the code was written
EXPECTED = {
    "stiff": [(-0.01326, 0.17950)],
    "soft 0": [(-0.05832, 0.15929), (-0.14190, 0.22337)],
    "soft 0.75": [(-0.24836, 0.14847), (-0.50821, 0.21205)],
    "z 0.25": [(-0.29808, 0.16520)],
}


def torsional(case: dict, count: int = 4):
    model = build_model(Case(**case))
    prepare_state(model)
    return modes(model, count, kind="torsional")


@pytest.mark.parametrize("name", EXPECTED)
def test_roots_of_the_wave_equation(name):
    """The roots above solve the wave equation to the digits that are printed."""
    for growth, frequency in EXPECTED[name]:
        s = root(complex(growth, 2 * np.pi * frequency), impedance(name))
        assert s.real == pytest.approx(growth, abs=6e-6)
        assert s.imag / (2 * np.pi) == pytest.approx(frequency, abs=6e-6)


@pytest.mark.parametrize("name", EXPECTED)
def test_modes_of_the_controlled_string(name):
    """Growth within 1 %, frequency within 0.2 % (C2); no root zero of the free angle is shown."""
    found = torsional(m.twisting(CONTROLS[name]))
    for growth, frequency in EXPECTED[name]:
        s = complex(growth, 2 * np.pi * frequency)
        near = found.eigenvalue[np.abs(found.eigenvalue - s).argmin()]
        assert near.real == pytest.approx(growth, rel=1e-2)
        assert near.imag == pytest.approx(s.imag, rel=2e-3)
    assert found.zeros == 0
    assert found.unstable == 0


def test_error_falls_with_the_square_of_the_element():
    """The root with stiff control on 10, 20 and 40 elements: fourfold smaller errors."""
    s = root(complex(-0.01326, 2 * np.pi * 0.1795), impedance("stiff"))
    errors = []
    for elements in (10, 20, 40):
        found = torsional(m.twisting(m.STIFF, elements=elements), 1)
        errors.append(np.abs(found.eigenvalue - s).min())
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.1)
    assert errors[1] / errors[2] == pytest.approx(4, rel=0.1)


def test_modes_with_the_top_held():
    """Without a motor: w J/GJ c = cot(wL/c), 0.180895 and 0.840967 Hz; `frequency: auto` tunes to the first."""
    found = torsional(m.twisting(None), 2)
    assert found.frequency[:2] == pytest.approx([0.180895, 0.840967], rel=2e-3)
    model = build_model(Case(**m.twisting({"kind": "soft_torque"})))
    assert model.part(MotorDrive).laws[0].frequency == pytest.approx(0.180895, rel=1e-4)


@pytest.mark.parametrize(
    ("name", "critical"),
    [("stiff", 128.72), ("soft 0", 122.63), ("soft 0.75", 77.63), ("z 0.25", 71.25), ("z 1", 65.33)],
)
def test_critical_speed(name, critical):
    """A bit torque that falls from 6 to 4 kN m over 6 rad/s: a mode grows 0.5 rpm below the critical speed and none 0.5 rpm
    above it (C3), of the modes below 1.2 Hz.

    With soft 0 and no other damping, higher modes grow up to 124.8 rpm (at 5e-5 1/s and less): the bit's slope s feeds mode n
    by s/J^2 and the drive damps it by p/I^2, both over w_n^2, so the limit is s = 4 zeta (J/I)^2.
    """
    Z = impedance(name)

    def growth(rpm: float) -> float:
        w = rpm * m.RPM
        slope = -2e3 * 2 * w / 36 * np.exp(-((w / 6) ** 2))
        starts = [complex(0.01, 2 * np.pi * f) for f in np.arange(0.06, 1.2, 0.04)]
        roots = [q for q in (root(s, Z, slope) for s in starts) if np.isfinite(q) and 0.3 < q.imag < 12]
        return max(q.real for q in roots if abs(characteristic(q, Z, slope)) < 1e-6 * m.GJ)

    assert growth(critical - 0.02) > 0 > growth(critical + 0.02)
    for rpm, grows in ((critical - 0.5, True), (critical + 0.5, False)):
        found = torsional(m.on_bottom(CONTROLS[name], rpm * m.RPM), 3)
        low = (found.frequency > 0) & (found.frequency < 1.2)
        assert (found.growth[low].max() > 0) == grows
    if name == "soft 0":
        for rpm, grows in ((124.6, True), (124.9, False)):
            w = rpm * m.RPM
            slope = -2e3 * 2 * w / 36 * np.exp(-((w / 6) ** 2))
            assert (-slope > 4 * m.ZETA * (m.BODY / m.INERTIA) ** 2) == grows
            high = root(complex(1e-6, 2 * np.pi * 9.5355), Z, slope)
            assert (high.real > 0) == grows
