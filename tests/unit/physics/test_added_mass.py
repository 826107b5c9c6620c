"""Added mass and damping in the annulus against closed forms and tables (manual: sec-mud-added-mass,
verif-added-mass, verif-stokes-damping)."""

import numpy as np
import pytest

from drillpetsc.physics.fluid.added_mass import (
    chi_confined,
    chi_eccentric,
    lateral_damping,
    steady_resistance,
    stokes_coefficients,
)
from tests.helpers.tables import each_row


def test_confined():
    """(D_w^2 + D_o^2)/(D_w^2 - D_o^2): 2.058 for D_w/D_o 1.7, 5/3 for 2, and 1 in an unbounded fluid (manual:
    verif-added-mass)."""
    assert chi_confined(0.127, [0.127 * 1.7, 0.254, 1e6]) == pytest.approx([2.058201, 5 / 3, 1.0], rel=1e-6)


@each_row(
    ("ratio", "chi"),
    [
        (1.7, [2.058, 2.099, 2.241, 2.595, 3.132]),
        (1.2, [5.546, 5.649, 6.005, 6.855, 8.082]),
        (2.5, [1.381, 1.403, 1.483, 1.701, 2.067]),
    ],
)
def test_eccentric_table(ratio, chi):
    """Eccentricity 0, .25, .5, .75, .9 (manual: verif-added-mass-eccentric)."""
    found = [chi_eccentric(0.1, 0.1 * ratio, e) for e in (0.0, 0.25, 0.5, 0.75, 0.9)]
    assert found == pytest.approx(chi, abs=6e-4)


@each_row("e", [0.0, 0.3, 0.6, 0.95])
def test_eccentric_thin_gap(e):
    """Gap c(1 - e cos t) much thinner than the radius a: the fluid's speed is U a sin(t)/gap, its kinetic
    energy rho U^2 a^3/(2 c) int sin^2/(1 - e cos) dt, so chi = (a/c) 2/(1 + sqrt(1 - e^2)), up to terms of
    c/a.
    """
    a, c = 0.5, 5e-5
    assert chi_eccentric(2 * a, 2 * (a + c), e) == pytest.approx(
        a / c * 2 / (1 + np.sqrt(1 - e**2)), rel=2e-4
    )


def test_eccentric_is_continuous_at_the_centre():
    """The closed form takes over where the bipolar coordinates end."""
    assert chi_eccentric(0.127, 0.2159, 1e-7) == pytest.approx(chi_confined(0.127, 0.2159), rel=1e-12)
    assert chi_eccentric(0.127, 0.2159, 0.0) == chi_confined(0.127, 0.2159)


@each_row(("outer", "hole", "e"), [(0.2, 0.1, 0.0), (0.1, 0.2, 1.0), (0.1, 0.2, -0.1)])
def test_eccentric_refuses(outer, hole, e):
    """A string that does not fit, or touches."""
    with pytest.raises(ValueError, match="chi_eccentric"):
        chi_eccentric(outer, hole, e)


@each_row(
    ("ratio", "S", "mass", "damping"),
    [
        (1.25, 100, 5.739, 11.07),
        (1.25, 1e4, 4.883, 0.3685),
        (2.0, 100, 2.209, 0.7218),
        (2.0, 1e4, 1.723, 0.0580),
    ],
)
def test_stokes(ratio, S, mass, damping):
    """Exact Stokes solution (Wambsganss, Chen; manual: verif-stokes-damping)."""
    found_mass, found_damping = stokes_coefficients(S, ratio)
    assert found_mass == pytest.approx(mass, rel=2e-4)
    assert found_damping == pytest.approx(damping, rel=4e-4)


@each_row("ratio", [1.2, 1.7, 2.5])
def test_stokes_thin_boundary_layers(ratio):
    """S -> infinity: C_m -> chi and C_d -> (2 sqrt(2)/sqrt(S)) (1 + k^3)/(1 - k^2)^2, k = 1/ratio; nothing
    overflows."""
    k, S = 1 / ratio, np.array([1e8, 1e10])
    mass, damping = stokes_coefficients(S, ratio)
    assert mass == pytest.approx(chi_confined(1.0, ratio), rel=2e-3)
    assert damping == pytest.approx(2 * np.sqrt(2 / S) * (1 + k**3) / (1 - k**2) ** 2, rel=2e-3)


def test_stokes_unbounded():
    """A cylinder alone (Stokes 1851): C_m = 1 + 4/sqrt(2 S), C_d = 4/sqrt(2 S) + 2/S up to S^-3/2, here at S
    = 1e4, walls 50 radii away."""
    mass, damping = stokes_coefficients(1e4, 50.0)
    assert mass == pytest.approx(1 + 4 / np.sqrt(2e4), rel=2e-3)
    assert damping == pytest.approx(4 / np.sqrt(2e4) + 2e-4, rel=2e-3)


@each_row("ratio", [1.02, 1.25, 2.0, 5.0])
def test_stokes_slow_motion(ratio):
    """S -> 0: force 4 pi mu V/(ln R - (R^2-1)/(R^2+1)) per length; the exact solution runs into it without a
    step."""
    limit = 4 / (np.log(ratio) - (ratio**2 - 1) / (ratio**2 + 1))
    switch = 1e-3 / (ratio - 1) ** 2
    S = np.array([1e-9, 0.999 * switch, 1.001 * switch, 10 * switch])
    mass, damping = stokes_coefficients(S, ratio)
    assert damping * S == pytest.approx(limit, rel=1e-6)
    assert mass == pytest.approx(mass[-1], rel=1e-4)
    assert steady_resistance(ratio) == pytest.approx(limit)


def test_stokes_thin_gap_squeeze_film():
    """A slow thin film has the parabolic profile, mean square speed 6/5 of the squared mean: 6/5 of the
    inviscid added mass."""
    mass, _ = stokes_coefficients(1.0, 1.002)
    assert mass / chi_confined(1.0, 1.002) == pytest.approx(1.2, rel=3e-3)


def test_lateral_damping():
    """C_d rho A_o Omega with C_d 11.07 at S = 100, ratio 1.25: D_o 0.2 m, rho 1000, mu 1 Pa s, Omega = S
    mu/(rho R_o^2) = 10 rad/s."""
    found = lateral_damping(0.2, 0.25, 1000.0, 1.0, [10.0, -10.0, 0.0])
    slow = 4 * np.pi / (np.log(1.25) - (1.25**2 - 1) / (1.25**2 + 1))
    assert found == pytest.approx(
        [11.07 * 1000 * np.pi * 0.01 * 10, 11.07 * 1000 * np.pi * 0.01 * 10, slow], rel=4e-4
    )
    assert lateral_damping(0.2, 0.25, 1000.0, 0.0, 10.0) == 0.0


@each_row(("S", "ratio"), [(0.0, 2.0), (1.0, 1.0), (-1.0, 2.0)])
def test_stokes_refuses(S, ratio):
    """No gap, or no motion."""
    with pytest.raises(ValueError, match="stokes_coefficients"):
        stokes_coefficients(S, ratio)
