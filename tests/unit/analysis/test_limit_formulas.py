"""Formulas of limits against published examples and closed forms.

ME: Mitchell Engineering, BHA sheet, 1990; RP: API RP 7G. Young's modulus 30e6 psi.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from drillpetsc.analysis.loads.limits import buckling_loads, fatigue, strength
from drillpetsc.case.catalogue.sizes import FT_LBF, INCH, KSI, LBF
from tests.helpers.tables import each_row

FT, KLB, PSI = 0.3048, 1e3 * LBF, KSI / 1e3
YOUNG = 30e6 * PSI
DEG_PER_100FT = math.radians(1) / 30.48
FIVE = (5 * INCH, 4.276 * INCH)  # 5 in 19.50 lb/ft, new


# ---------------------------------------------------------------------- strength
def test_second_moment_of_collars():
    """6 x 4.276 in pipe and 8 x 3 in collar: section moduli 15.74 and 49.27 in3, I of the second 197.1 in4 (ME)."""
    moment = strength.second_moment([6.0, 8.0], [4.276, 3.0])
    assert moment / [3.0, 4.0] == pytest.approx([15.74, 49.27], rel=1e-3)
    assert moment[1] == pytest.approx(197.1, rel=1e-3)


def test_torque_limit_under_tension():
    """5 in 19.50 E-75 new at 200 klb: 35,518 ft-lbf; S-135 premium at 300 klb: 49,098 (RP 7G)."""
    new = strength.torque_at_yield(*FIVE, 75e3 * PSI, 200 * KLB)
    assert new / FT_LBF == pytest.approx(35518, rel=1e-3)
    worn = strength.torque_at_yield(4.8552 * INCH, FIVE[1], 135e3 * PSI, 300 * KLB)
    assert worn / FT_LBF == pytest.approx(49098, rel=1e-3)
    assert strength.torque_at_yield(*FIVE, 75e3 * PSI, 400 * KLB) == 0.0  # the pull alone is beyond


def test_stresses_of_drill_pipe():
    """5 in 19.50 new, 200 klb, 20 kft-lbf, 5 deg/100 ft, 3,000 psi inside: each stress, and von Mises at both fibres.

    Closed form (Lame), with a bending stress E D/2 kappa.
    """
    moment = YOUNG * strength.second_moment(*FIVE) * 5 * DEG_PER_100FT
    found = strength.stresses(*FIVE, 200 * KLB, moment, 20e3 * FT_LBF, 3000 * PSI, 0.0)
    assert found.axial / PSI == pytest.approx(37918, rel=1e-3)
    assert found.bending / PSI == pytest.approx(5454, rel=1e-3)
    assert found.shear / PSI == pytest.approx(21024, rel=1e-3)
    assert found.outer / PSI == pytest.approx(52588, rel=1e-3)
    assert found.inner / PSI == pytest.approx(50283, rel=1e-3)
    assert found.von_mises == found.outer


def test_equal_pressures_leave_no_shape_change():
    """The same pressure inside and outside and as axial stress: hydrostatic, von Mises 0."""
    push = -50e6 * strength.area(*FIVE)
    found = strength.stresses(*FIVE, push, 0.0, 0.0, 50e6, 50e6)
    assert found.von_mises == pytest.approx(0.0, abs=1e-6 * 50e6)


def test_thin_tube_under_pressure():
    """Closed ends, thin wall: hoop p r/t, axial half of it, von Mises sqrt(3)/2 of the hoop stress."""
    outer, inner, pressure = 1.002, 1.0, 1e6
    pull = pressure * math.pi / 4 * inner**2
    found = strength.stresses(outer, inner, pull, 0.0, 0.0, pressure, 0.0)
    assert found.hoop == pytest.approx(500e6, rel=3e-3)
    assert found.von_mises == pytest.approx(math.sqrt(3) / 2 * 500e6, rel=5e-3)


def test_torque_limit_is_where_von_mises_yields():
    """0.577 of RP 7G for 1/sqrt(3): von Mises stress at the limit equals the yield to 0.1 %, with and without pull."""
    for pull in (0.0, 100 * KLB, 300 * KLB):
        torque = strength.torque_at_yield(*FIVE, 135e3 * PSI, pull)
        assert strength.stresses(*FIVE, pull, 0.0, torque).outer / PSI == pytest.approx(135e3, rel=1e-3)


# ---------------------------------------------------------------------- buckling


def test_helical_laws_by_name():
    """Chen sqrt(2) and Wu 2 sqrt(2) - 1 times the sinusoidal load."""
    sinusoidal = buckling_loads.dawson_paslay(2e6, 300.0, 0.04)
    assert buckling_loads.helical(2e6, 300.0, 0.04, "chen") == pytest.approx(1.414214 * sinusoidal, rel=1e-6)
    assert buckling_loads.helical(2e6, 300.0, 0.04, "wu") == pytest.approx(1.828427 * sinusoidal, rel=1e-6)


# ---------------------------------------------------------------------- fatigue
@each_row(
    "outer, inner, rule, klb, dogleg",
    [(4.5, 3.826, "E", 100, 4.837), (5.0, 4.276, "S", 200, 3.477), (5.0, 4.276, "S", 100, 5.746)],
)
def test_permissible_dogleg(outer, inner, rule, klb, dogleg):
    """4 1/2 16.60 E at 100 klb; 5 in 19.50 S at 200 and 100 klb; half a joint 180 in (RP 7G)."""
    tube = (outer * INCH, inner * INCH)
    stiffness = YOUNG * strength.second_moment(*tube)
    section = strength.area(*tube)
    found = fatigue.permissible_dogleg(klb * KLB, tube[0], section, stiffness, 180 * INCH, rule, YOUNG)
    assert found / DEG_PER_100FT == pytest.approx(dogleg, rel=2e-3)


def test_fatigue_rules_end_where_the_standard_ends():
    """nan beyond 67 ksi (E) and 133.4 ksi (S) and in compression; the printed values at the ends of the E curve."""
    stress = fatigue.fatigue_bending_stress(np.array([0, 67e3, 67.1e3, -1.0]) * PSI, "E") / PSI
    assert stress[0] == pytest.approx(19500 - 1500, rel=1e-6)  # 0.6/670^2 x 33,500^2 = 1,500
    assert stress[1] == pytest.approx(19500 - 10000 - 1500, rel=1e-6)
    assert np.isnan(stress[2:]).all()
    stress = fatigue.fatigue_bending_stress(np.array([0, 72.5e3, 133.5e3]) * PSI, "S") / PSI
    assert stress[:2] == pytest.approx([20000, 10000], rel=1e-6) and np.isnan(stress[2])


def test_grades_and_their_rules():
    assert [fatigue.rule_of(g) for g in ("E-75", "s135", "X-95", "G-105", "V-150", "L-80", None)] == [
        *("E", "S", "S", "S"),
        *(None, None, None),
    ]


def test_tension_concentrates_bending_beside_tool_joints():
    """tanh(x)/x: 1 without tension, 0.76159 at x = 1, and 1/x for long joints."""
    assert fatigue.tension_factor(0.0, 1e6, 5.0) == 1.0
    assert fatigue.tension_factor(-1e5, 1e6, 5.0) == 1.0
    assert fatigue.tension_factor(1e6, 1e6, 1.0) == pytest.approx(math.tanh(1.0), rel=1e-12)
    assert fatigue.tension_factor(1e8, 1e6, 10.0) == pytest.approx(0.01, rel=1e-6)
