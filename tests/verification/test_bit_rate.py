"""Rate of penetration in space: v = D (Omega/Omega_ref)^a (W_eff/W_ref)^(b-1) (W_eff/W) M_r M_b F (manual:
eq-bit-rate, verif-bit-drift).

``rate_under`` evaluates the compiled law. F is the force of the bit on the rock; axes north, east, down.
"""

from __future__ import annotations

import numpy as np
import pytest

from tests.helpers.bit_models import DRAG, RADIUS, TURNING, rock_bit
from tests.helpers.tables import each_row

DOWN = np.array([0.0, 0.0, 1.0])
D, WEIGHT = 2.8e-8, 1e5  # defaults of the case format: m/(s N), N


def normal_of(dip: float, azimuth: float) -> np.ndarray:
    """Upward normal of a bed that dips by ``dip`` towards ``azimuth``: cross product of two lines in the bed,
    along the dip and horizontal."""
    down_dip = [np.cos(dip) * np.cos(azimuth), np.cos(dip) * np.sin(azimuth), np.sin(dip)]
    level = [-np.sin(azimuth), np.cos(azimuth), 0.0]
    return np.cross(level, down_dip)


def drift(rate: np.ndarray, axis: np.ndarray = DOWN) -> float:
    """Angle between the rate and the axis [deg]."""
    return float(np.degrees(np.arctan2(np.linalg.norm(np.cross(axis, rate)), axis @ rate)))


def test_drift_of_an_anisotropic_bit():
    """I_b = 0.2 under 100 kN with a side force of 5 kN: atan(0.2 * 5/100) = 0.572939 deg, towards the side
    force (manual: verif-bit-drift)."""
    rate = rock_bit(bit_anisotropy=0.2).rate_under(np.array([3e3, 4e3, 1e5]), DOWN, TURNING)
    assert drift(rate) == pytest.approx(0.572939, abs=1e-6)
    assert rate[1] / rate[0] == pytest.approx(4 / 3, rel=1e-12)
    assert rate[2] == pytest.approx(D * 1e5, rel=1e-5)


def test_no_drift_under_an_axial_load():
    """Isotropic rock: an axial force drives the bit along its axis, for any axis."""
    rng = np.random.default_rng(1)
    bit = rock_bit(bit_anisotropy=0.3, walk=0.2)
    for _ in range(20):
        axis = rng.standard_normal(3)
        axis /= np.linalg.norm(axis)
        assert bit.rate_under(8e4 * axis, axis, TURNING) == pytest.approx(D * 8e4 * axis, rel=1e-5, abs=1e-12)


@each_row("seed", range(12))
def test_hos_relation(seed):
    """Ho's law (1987, US patent 4804051): r_N e_r = I_b I_r e_f + I_r (1 - I_b)(e_a.e_f) e_a + (1 - I_r) r_N
    (e_r.e_d) e_d.

    With e_f, e_a, e_d along force, bit axis and normal of the bedding.  Derived: M_b = I_b + (1 - I_b) e_a
    e_a^T and, with equal indices, M_r = I_r + (1 - I_r) e_d e_d^T, so v = I_r M_b F + (1 - I_r)(e_d.M_b F)
    e_d, and e_d.v = e_d.M_b F.
    """
    rng = np.random.default_rng(seed)
    sideways, index, dip, azimuth = (
        rng.uniform(0.05, 1), rng.uniform(0.8, 1.2), rng.uniform(0, np.pi / 2), rng.uniform(-np.pi, np.pi),
    )  # fmt: skip
    axis = rng.standard_normal(3)
    axis /= np.linalg.norm(axis)
    force = 1e5 * axis + 2e4 * rng.standard_normal(3)
    beds = {"dip": dip, "dip_azimuth": azimuth, "index_dip": index, "index_strike": index}
    bit = rock_bit(bit_anisotropy=sideways, rock_anisotropy=beds, rotary_exponent=0.0)
    v = bit.rate_under(force, axis, TURNING) / D
    normal = normal_of(dip, azimuth)
    expected = (
        sideways * index * force
        + index * (1 - sideways) * (axis @ force) * axis
        + (1 - index) * (v @ normal) * normal
    )
    assert v == pytest.approx(expected, rel=1e-11, abs=1e-6)


def test_three_indices_along_dip_and_strike():
    """Orthotropic beds: the rate along each of the three directions of the bedding is its index times the
    force component, for an isotropic bit."""
    beds = {"dip": 0.4, "dip_azimuth": 1.1, "index_dip": 0.9, "index_strike": 1.07}
    bit = rock_bit(bit_anisotropy=1.0, rock_anisotropy=beds, rotary_exponent=0.0)
    normal, strike = normal_of(0.4, 1.1), np.array([-np.sin(1.1), np.cos(1.1), 0.0])
    dip = np.cross(normal, strike)
    force = np.array([4e3, -7e3, 9e4])
    v = bit.rate_under(force, DOWN, 3.0) / D
    expected = [force @ normal, 0.9 * (force @ dip), 1.07 * (force @ strike)]
    assert [v @ q for q in (normal, dip, strike)] == pytest.approx(expected, rel=1e-11)
    assert dip @ [np.cos(1.1), np.sin(1.1), 0] != 0 and abs(dip[2]) == pytest.approx(np.sin(0.4))


@pytest.mark.parametrize(("index", "sign"), [(0.9, -1), (1.1, 1)])
def test_beds_that_drill_worse_along_themselves_turn_the_hole_up_dip(index, sign):
    """Beds that dip to the north by 20 deg, vertical load: the hole turns south (up-dip) by atan((1 - I) s
    c/(c^2 + I s^2)) for I_r < 1, and down-dip for I_r > 1 (Lubinski and Woods 1953: crooked holes go up-dip
    in gently dipping beds)."""
    s, c = np.sin(np.radians(20)), np.cos(np.radians(20))
    beds = {"dip": np.radians(20), "dip_azimuth": 0.0, "index_dip": index, "index_strike": index}
    v = rock_bit(rock_anisotropy=beds).rate_under(WEIGHT * DOWN, DOWN, TURNING)
    assert v[0] / v[2] == pytest.approx(-(1 - index) * s * c / (c**2 + index * s**2), rel=1e-11)
    assert np.sign(v[0]) == sign and v[1] == pytest.approx(0.0, abs=1e-15 * abs(v[2]) + 1e-18)


def test_a_mirrored_case_mirrors():
    """Forces, axis, dip and walk reflected in the plane east = 0: the rate is reflected, too."""
    mirror = np.array([1.0, -1.0, 1.0])
    axis, force = np.array([0.2, 0.3, 0.9]) / np.linalg.norm([0.2, 0.3, 0.9]), np.array([1e4, 4e4, 9e4])
    rates = []
    for side in (1, -1):
        beds = {"dip": 0.3, "dip_azimuth": side * 0.8, "index_dip": 0.9, "index_strike": 1.05}
        bit = rock_bit(rock_anisotropy=beds, walk=side * 0.25)
        rates.append(bit.rate_under(force * mirror ** (side < 0), axis * mirror ** (side < 0), TURNING))
    assert rates[1] == pytest.approx(rates[0] * mirror, rel=1e-12)


def test_walk_turns_the_side_motion_about_the_bits_axis():
    """Side force to the north on a bit that points down: the motion is rotated from north by the walk angle,
    clockwise along the axis (east)."""
    v = rock_bit(bit_anisotropy=0.4, walk=np.radians(15), rotary_exponent=0.0).rate_under(
        np.array([1e4, 0, 1e5]), DOWN, TURNING
    )
    assert v == pytest.approx(
        D * np.array([4e3 * np.cos(np.radians(15)), 4e3 * np.sin(np.radians(15)), 1e5]), rel=1e-12
    )


@pytest.mark.parametrize("exponent", [0.5, 0.8, 1.0, 2.0])
def test_exponent_of_the_rotation_speed(exponent):
    """(Omega/Omega_ref)^a for both directions of rotation, smoothed below a thousandth of the reference
    speed; 0 at standstill."""
    bit = rock_bit(rotary_exponent=exponent, reference_speed=5.0)
    for omega in (0.5, 2.5, 20.0, -20.0):
        assert bit.rate_under(WEIGHT * DOWN, DOWN, omega)[2] == pytest.approx(
            D * WEIGHT * (abs(omega) / 5) ** exponent, rel=1e-4
        )
    assert (bit.rate_under(WEIGHT * DOWN, DOWN, 0.0) == 0).all()


@pytest.mark.parametrize("exponent", [0.7, 1.0, 1.6])
def test_exponent_of_the_weight(exponent):
    """Axial load: v = D W (W/W_ref)^(b - 1); a side force does not change that factor."""
    bit = rock_bit(weight_exponent=exponent, reference_weight=6e4, rotary_exponent=0.0)
    for weight in (1e3, 6e4, 2e5):
        v = bit.rate_under(np.array([5e3, 0, weight]), DOWN, 0.0)
        factor = (weight / 6e4) ** (exponent - 1)
        assert v == pytest.approx([D * factor * 0.2 * 5e3, 0.0, D * factor * weight], rel=1e-11)


def test_threshold():
    """Only the weight above the threshold cuts; smoothed within 5 % of it, continuous with its slope; zero
    below it and in tension."""
    bit = rock_bit(threshold=2e4, rotary_exponent=0.0, weight_exponent=1.3)

    def rate(weight):
        return bit.rate_under(np.array([0.0, 0.0, weight]), DOWN, 0.0)[2]

    for weight in (2.2e4, 5e4, 1.2e5):
        assert rate(weight) == pytest.approx(D * (weight - 2e4) * ((weight - 2e4) / 1e5) ** 0.3, rel=1e-11)
    assert rate(1.89e4) == rate(0.0) == rate(-5e4) == 0.0
    weights = np.linspace(1.85e4, 2.2e4, 701)
    values = np.array([rate(w) for w in weights])
    steepest = D * (2.2e4 - 2e4) ** 0.3 * 1.3 / 1e5**0.3
    assert (np.diff(values) >= 0).all() and np.diff(values).max() < 1.01 * steepest * (
        weights[1] - weights[0]
    )


def test_layers_have_a_smooth_transition():
    """A layer boundary at 2 m: the rate changes from the upper to the lower value over 0.1 m by 3u^2 - 2u^3,
    each with its own anisotropies."""
    lower = {
        "from": 3.0,
        "drillability": 1e-8,
        "bit_anisotropy": 0.5,
        "rotary_exponent": 0.0,
        "threshold": 1e4,
    }
    bit = rock_bit(rotary_exponent=1.0, layers=[lower])  # the hole of rock_bit ends at 1 m
    force = np.array([5e3, 0.0, 1e5])
    above = D * 0.5 * np.array([0.2 * 5e3, 0, 1e5])
    below = 1e-8 * 0.9 * np.array([0.5 * 5e3, 0, 1e5])
    for drilled, share in (
        (0.0, 0.0),
        (1.999, 0.0),
        (2.025, 0.15625),
        (2.05, 0.5),
        (2.075, 0.84375),
        (2.1, 1.0),
        (9.0, 1.0),
    ):
        v = bit.rate_under(force, DOWN, 0.5 * TURNING, drilled)
        assert v == pytest.approx((1 - share) * above + share * below, rel=2e-6)


def test_the_hole_may_follow_the_bits_axis():
    """direction: bit_axis: the rate is the component along the bit's axis, in its direction."""
    axis = np.array([0.6, 0.0, 0.8])
    force = np.array([2e4, 1e4, 9e4])
    free = rock_bit().rate_under(force, axis, TURNING)
    assert rock_bit(direction="bit_axis").rate_under(force, axis, TURNING) == pytest.approx(
        (free @ axis) * axis, rel=1e-12
    )


def test_drag_bit_in_steady_cutting():
    """Without profile (quasi-static drilling) a drag bit removes d = (W - sigma a l)/(zeta eps a) per turn,
    and drifts as any bit."""
    rate = rock_bit(bit_law=DRAG).rate_under(np.array([0.0, 5e3, 23.328e3]), DOWN, TURNING)
    assert rate[2] == pytest.approx(28.8 / 3600, rel=1e-8)
    assert rate[1] / rate[2] == pytest.approx(0.2 * 5e3 / 23.328e3, rel=1e-12)
    assert (
        rock_bit(bit_law=DRAG).rate_under(np.array([0.0, 0.0, 0.9 * 60e6 * RADIUS * 1.2e-3]), DOWN, TURNING)
        == 0
    ).all()
