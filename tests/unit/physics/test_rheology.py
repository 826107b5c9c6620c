"""Wall friction against closed forms, published worked examples and integrated profiles (manual:
sec-mud-friction)."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from drillpetsc.case.files.mud_report import api_annulus, by_rules
from drillpetsc.kernels import function, pointer
from drillpetsc.physics.fluid.rheology import (
    Rheology,
    pressure_gradient,
    wall_shear,
    wall_shear_and_slope,
)
from tests.helpers.tables import each_row

DIAL = {"600": 65.0, "300": 39.0, "100": 20.0, "3": 3.0}  # readings [deg] by speed [rpm]
INCH, FOOT, GPM, PPG, PSI = 0.0254, 0.3048, 6.30902e-5, 119.8264, 6894.757  # m, m, m3/s, kg/m3, Pa
CENTIPOISE, LB_PER_100_SQ_FT = 1e-3, 0.4788026  # Pa s, Pa
PIPE, ANNULUS = (
    0.03 / (np.pi / 4 * 0.1086**2),
    0.03 / (np.pi / 4 * (0.2159**2 - 0.127**2)),
)  # speeds of 30 l/s [m/s]
STILL = 1e-12  # kg/m3: a fluid so light that it is laminar at any speed

FLUIDS = {
    "newtonian": Rheology.newtonian(0.02),
    "bingham": Rheology.bingham(0.02, 7.2),
    "power_law": Rheology.power_law(0.4, 0.7),
    "thickening": Rheology.power_law(0.002, 1.3),
    "herschel_bulkley": Rheology.herschel_bulkley(0.3, 0.75, 3.0),
    "casson": Rheology.casson(0.02, 4.0),
    "no viscosity": Rheology.herschel_bulkley(0.0, 0.8, 3.0),
    "exact newtonian": Rheology.newtonian(0.02, "exact"),
    "exact bingham": Rheology.bingham(0.02, 7.2, "exact"),
    "exact power_law": Rheology.power_law(0.4, 0.7, "exact"),
    "exact herschel_bulkley": Rheology.herschel_bulkley(0.3, 0.75, 3.0, "exact"),
    "exact casson": Rheology.casson(0.02, 4.0, "exact"),
    "exact no viscosity": Rheology.herschel_bulkley(0.0, 0.8, 3.0, "exact"),
    "api newtonian": Rheology.newtonian(0.02, "api"),
    "api power_law": Rheology.power_law(0.4, 0.7, "api"),
}
every_fluid = pytest.mark.parametrize("fluid", FLUIDS.values(), ids=FLUIDS.keys())
pipe_and_annulus = each_row("annulus", [False, True], ids=["pipe", "annulus"])


def speed(gpm, outer, inner=0.0):
    """Mean speed [m/s] of a flow [gal/min] between diameters [in]."""
    return gpm * GPM / (np.pi / 4 * (outer**2 - inner**2) * INCH**2)


# ---------------------------------------------------------------- values of the manual


def test_api_dial_readings():
    """Constants of R600/300/100/3 = 65/39/20/3, third edition of API RP 13D; in dyn s^n/cm2 they are 2.017
    and 6.336 (manual: verif-api-power-law)."""
    assert by_rules("power_law", DIAL) == pytest.approx((0.2017, 0.7365), rel=2e-4)
    assert api_annulus(DIAL) == pytest.approx((0.6336, 0.5413), rel=2e-4)


@each_row(
    ("outer", "inner", "length", "loss"),
    [
        (0.096012, 0.0, 3474.72, 4.5979e6),
        (0.0635, 0.0, 182.88, 1.5671e6),
        (0.2159, 0.1651, 182.88, 0.21811e6),
        (0.2159, 0.1143, 3474.72, 1.05715e6),
    ],
)
def test_api_pressure_losses(outer, inner, length, loss):
    """17.66529 l/s of 1497.83 kg/m3 by the API law through drill pipe, collars and around both (manual:
    verif-api-power-law)."""
    constants = api_annulus(DIAL) if inner else by_rules("power_law", DIAL)
    w = 17.66529e-3 / (np.pi / 4 * (outer**2 - inner**2))
    found = (
        pressure_gradient(Rheology.power_law(*constants, "api"), w, outer - inner, inner > 0, 1497.83)
        * length
    )
    assert found == pytest.approx(loss, rel=1e-4)


@each_row(
    ("fluid", "stress"),
    [
        (Rheology.newtonian(0.02, shear_rate_eps=0.1), [41.0420, 9.0452]),
        (Rheology.bingham(0.02, 7.2, shear_rate_eps=0.1), [54.0668, 14.1828]),
        (Rheology.power_law(0.4, 0.7, shear_rate_eps=0.1), [46.5364, 15.9376]),
        (Rheology.herschel_bulkley(0.3, 0.75, 3.0, shear_rate_eps=0.1), [50.4213, 19.2934]),
    ],
)
def test_blend(fluid, stress):
    """Wall shear of 30 l/s of 1200 kg/m3 in 108.6 mm and in 215.9 around 127 mm (manual:
    verif-friction-blend)."""
    assert wall_shear(fluid, [PIPE, ANNULUS], [0.1086, 0.0889], [False, True], 1200.0) == pytest.approx(
        stress, abs=5.1e-5
    )


def test_exact_laminar():
    """The same flow of Herschel-Bulkley 3/.75/.3, laminar (manual: verif-laminar-exact)."""
    fluid = Rheology.herschel_bulkley(0.3, 0.75, 3.0, "exact", shear_rate_eps=1e-3)
    found = wall_shear(fluid, [PIPE, ANNULUS], [0.1086, 0.0889], [False, True], STILL)
    assert found == pytest.approx([23.223682, 19.455998], rel=5e-8)


# ---------------------------------------------------------------- published worked examples


def test_published_turbulent_power_law_in_pipe():
    """API RP 13D (3rd ed., 1995) as worked in Texas A&M's PETE 411, lesson 13: 280 gal/min, 12.5 lb/gal,
    dials 65/39/20/3, drill pipe
    3.78 in x 11400 ft: Re 6616, f 0.007126, 0.05837 psi/ft, 665 psi.  Their density and flow constants are
    rounded (0.3 %).
    """
    fluid = Rheology.power_law(*by_rules("power_law", DIAL), "api")
    w = speed(280, 3.78)
    loss = pressure_gradient(fluid, w, 3.78 * INCH, False, 12.5 * PPG)
    assert loss * FOOT / PSI == pytest.approx(0.05837, rel=3e-3)
    assert loss * 11400 * FOOT / PSI == pytest.approx(665, rel=3e-3)
    friction = wall_shear(fluid, w, 3.78 * INCH, False, 12.5 * PPG) / (0.5 * 12.5 * PPG * w**2)
    assert friction == pytest.approx(0.007126, rel=2e-3)


def test_published_laminar_bingham_in_pipe():
    """Drilling Engineering course text (Heriot-Watt, recalled as its origin), hydraulics exercise 2: 150
    gal/min,
    4.276 in, PV 20 cP, YP 15 lb/100 sq ft, 10 lb/gal:
    0.018 psi/ft.  Their 20 x 3.35/(1500 x 4.276^2) + 15/(225 x 4.276) is 0.018034.
    """
    fluid = Rheology.bingham(20 * CENTIPOISE, 15 * LB_PER_100_SQ_FT)
    loss = pressure_gradient(fluid, speed(150, 4.276), 4.276 * INCH, False, 10 * PPG) * FOOT / PSI
    assert loss == pytest.approx(0.018034, rel=1e-3)


@each_row(
    ("hole", "pipe", "length", "psi"), [(8.755, 4.5, 6500, 73), (8.5, 4.5, 3000, 38), (8.5, 6.75, 450, 31)]
)
def test_published_laminar_bingham_in_annulus(hole, pipe, length, psi):
    """Guo and Liu, Applied Drilling Circulation Systems, example 2.5: 300 gal/min, 10.5 lb/gal, PV 35 cP, YP
    6 lb/100 sq ft in three annuli [in], [ft].  Losses are printed without decimals; the collars' one is early
    in our transition (below 1 %).
    """
    fluid = Rheology.bingham(35 * CENTIPOISE, 6 * LB_PER_100_SQ_FT)
    loss = (
        pressure_gradient(fluid, speed(300, hole, pipe), (hole - pipe) * INCH, True, 10.5 * PPG)
        * length
        * FOOT
        / PSI
    )
    assert loss == pytest.approx(psi, abs=0.5)


@each_row("law", ["blend", "api"])
@each_row("reynolds", [1e4, 3e4, 1e5])
def test_turbulent_newtonian_against_prandtl_karman(reynolds, law):
    """Smooth pipe, 1/sqrt(f) = 4 log10(Re sqrt(f)) - 0.4 (Prandtl, von Karman): a/Re^b is a Blasius line, 4 %
    from it up to Re 1e5."""
    f = brentq(lambda f: 1 / np.sqrt(f) - 4 * np.log10(reynolds * np.sqrt(f)) + 0.4, 1e-3, 0.1)
    w = reynolds * 1e-3 / (1000 * 0.1)
    assert wall_shear(Rheology.newtonian(1e-3, law), w, 0.1, False, 1000.0) == pytest.approx(
        500 * f * w**2, rel=0.04
    )


# ---------------------------------------------------------------- closed forms


def test_hagen_poiseuille_and_slot():
    """Laminar Newtonian: tau = 8 mu w/D in a pipe, 12 mu w/d_h in a slot, at any speed and with any law."""
    w = np.array([1e-9, 1e-3, 0.7, -12.0])
    for law in ("blend", "api", "exact"):
        fluid = Rheology.newtonian(0.05, law)
        assert wall_shear(fluid, w, 0.1, False, STILL) == pytest.approx(8 * 0.05 * w / 0.1, rel=1e-14)
        assert wall_shear(fluid, w, 0.1, True, STILL) == pytest.approx(12 * 0.05 * w / 0.1, rel=1e-14)


@each_row("plug", [0.05, 0.5, 0.9])
def test_buckingham_reiner(plug):
    """Bingham in a pipe: 8 mu w/D = tau (1 - 4 p/3 + p^4/3), in a slot 12 mu w/d_h = tau (1 - 3 p/2 + p^3/2),
    p = tau_y/tau."""
    tau = 7.2 / plug
    fluid = Rheology.bingham(0.02, 7.2, "exact", shear_rate_eps=1e-6)
    pipe = tau * (1 - 4 * plug / 3 + plug**4 / 3) * 0.1 / (8 * 0.02)
    slot = tau * (1 - 1.5 * plug + plug**3 / 2) * 0.1 / (12 * 0.02)
    assert wall_shear(fluid, [pipe, slot], 0.1, [False, True], STILL) == pytest.approx([tau, tau], rel=1e-10)


PROFILES = {
    "newtonian": (Rheology.newtonian(0.02, "exact", 1e-6), lambda t: t / 0.02),
    "power_law": (Rheology.power_law(0.4, 0.7, "exact", 1e-6), lambda t: (t / 0.4) ** (1 / 0.7)),
    "bingham": (Rheology.bingham(0.02, 5.0, "exact", 1e-6), lambda t: (t - 5) / 0.02),
    "herschel_bulkley": (
        Rheology.herschel_bulkley(0.3, 0.6, 5.0, "exact", 1e-6),
        lambda t: ((t - 5) / 0.3) ** (1 / 0.6),
    ),
    "casson": (Rheology.casson(0.02, 5.0, "exact", 1e-6), lambda t: (np.sqrt(t) - np.sqrt(5)) ** 2 / 0.02),
    "casson blend": (
        Rheology.casson(0.02, 5.0, "blend", 1e-6),
        lambda t: (np.sqrt(t) - np.sqrt(5)) ** 2 / 0.02,
    ),
}


@each_row(("fluid", "rate"), PROFILES.values(), ids=PROFILES.keys())
@each_row("plug", [0.02, 0.5, 0.95])
@pipe_and_annulus
def test_exact_against_the_integrated_profile(fluid, rate, plug, annulus):
    """Shear stress tau y/y_w at y from the axis (or mid-plane); u(y) = integral of the shear rate; mean of u
    over the section."""
    tau, d = 5.0 / plug, 0.1
    wall = d / 4 if annulus else d / 2
    edge = wall * plug if fluid.yield_stress else 0.0  # of the plug

    def u(y):
        return quad(lambda z: rate(tau * z / wall), max(y, edge), wall, epsabs=0, epsrel=1e-11)[0]

    def share(y):
        return u(y) / wall if annulus else u(y) * 2 * y / wall**2

    w = quad(share, edge, wall, epsabs=0, epsrel=1e-10)[0]
    w += u(edge) * (edge / wall if annulus else (edge / wall) ** 2)
    assert wall_shear(fluid, w, d, annulus, STILL) == pytest.approx(tau, rel=1e-8)


@pipe_and_annulus
def test_explicit_yield_stress_law_is_near_the_exact_one(annulus):
    """Error at most 2.2 % in a pipe at tau_y/tau_w <= 0.5, 6 % for Bingham in a slot at 0.5; too large near
    gelling (manual: sec-mud-blend)."""
    w = np.geomspace(1e-3, 10, 200)
    near = wall_shear(Rheology.bingham(0.02, 5.0, shear_rate_eps=1e-3), w, 0.1, annulus, STILL)
    exact = wall_shear(Rheology.bingham(0.02, 5.0, "exact", 1e-3), w, 0.1, annulus, STILL)
    flowing = exact >= 10.0
    assert flowing.sum() > 20
    assert np.abs(near / exact - 1)[flowing].max() < (0.065 if annulus else 0.022)
    assert np.all(near[~flowing] > exact[~flowing])


# ---------------------------------------------------------------- regimes of the API law


def api_speed(reynolds, n, K, d, annulus, density):
    """Speed of a Metzner-Reed Reynolds number: rho w^(2-n) d^n = Re 8^(n-1) K ((3n+1)/4n)^n, annulus 12 and
    (2n+1)/3n."""
    k = (
        12 ** (n - 1) * ((2 * n + 1) / (3 * n)) ** n
        if annulus
        else 8 ** (n - 1) * ((3 * n + 1) / (4 * n)) ** n
    )
    return (reynolds * k * K / (density * d**n)) ** (1 / (2 - n))


@each_row("n", [0.4, 0.7, 1.0])
@pipe_and_annulus
def test_regimes(n, annulus):
    """16/Re or 24/Re below 3470-1370n, a/Re^b above 4270-1370n, linear between them; the kinks are rounded
    within 40 in Re (manual: verif-friction-regimes)."""
    K, d, density, lam = 0.2, 0.1, 1200.0, 24 if annulus else 16
    low, high = 3470 - 1370 * n, 4270 - 1370 * n
    a, b = (np.log10(n) + 3.93) / 50, (1.75 - np.log10(n)) / 7
    reynolds = np.array([1, 500, low - 41, low + 41, low + 400, high - 41, high + 41, 2e4, 1e6])
    straight = lam / low + (a / high**b - lam / low) * (reynolds - low) / 800
    want = np.where(reynolds < low, lam / reynolds, np.where(reynolds < high, straight, a / reynolds**b))
    w = api_speed(reynolds, n, K, d, annulus, density)
    stress = wall_shear(Rheology.power_law(K, n, "api", shear_rate_eps=1e-9), w, d, annulus, density)
    assert stress / (0.5 * density * w**2) == pytest.approx(want, rel=1e-12)


@each_row("kink", [3470 - 1370 * 0.7, 4270 - 1370 * 0.7])
@pipe_and_annulus
def test_api_rounding_is_smooth(kink, annulus):
    """Across both ends of a rounding the slope does not jump, and the rounded friction factor stays within 1
    % of the kinked one."""
    fluid = Rheology.power_law(0.2, 0.7, "api", shear_rate_eps=1e-9)

    def at(reynolds):
        return wall_shear_and_slope(
            fluid, api_speed(np.array(reynolds), 0.7, 0.2, 0.1, annulus, 1200.0), 0.1, annulus, 1200.0
        )

    for end in (kink - 40, kink + 40):
        stress, slope = at([end * (1 - 1e-10), end * (1 + 1e-10)])
        assert slope[0] == pytest.approx(slope[1], rel=1e-6)
        assert stress[0] == pytest.approx(stress[1], rel=1e-8)
    stress, _ = at([kink])
    friction = stress / (600 * api_speed(kink, 0.7, 0.2, 0.1, annulus, 1200.0) ** 2)
    a, b, lam = (np.log10(0.7) + 3.93) / 50, (1.75 - np.log10(0.7)) / 7, 24 if annulus else 16
    assert friction == pytest.approx(lam / kink if kink < 3000 else a / kink**b, rel=0.01)


# ---------------------------------------------------------------- derivative, symmetry, limits

SPEEDS = np.concatenate([np.geomspace(1e-8, 20, 300), -np.geomspace(1e-8, 20, 299), [0.0]])


@every_fluid
@pipe_and_annulus
def test_derivative(fluid, annulus):
    """Fourth-order central differences of the stress, |w| 1e-8 to 20 m/s: through zero, transition and
    turbulence.

    The steps are small beside the regularised speed (about 0.01 m/s) and the transition; where one of them
    straddles an end of the API law's roundings, at which the second derivative jumps, the difference is only
    of first order.
    """
    h = 3e-4 * np.hypot(SPEEDS, 0.01)
    moved = [wall_shear(fluid, SPEEDS + k * h, 0.1, annulus, 1200.0) for k in (-2, -1, 1, 2)]
    difference = (8 * (moved[2] - moved[1]) - (moved[3] - moved[0])) / (12 * h)
    slope = wall_shear_and_slope(fluid, SPEEDS, 0.1, annulus, 1200.0)[1]
    error = np.abs(difference / slope - 1)
    if fluid.law == "api":
        assert np.sum(error > 1e-7) <= 12 and error.max() < 0.05
    else:
        assert error.max() < 1e-7


@every_fluid
@pipe_and_annulus
def test_odd_and_rising(fluid, annulus):
    """tau(-w) = -tau(w) to the last bit, zero at rest; the slope is positive, so a given pressure has one
    speed."""
    stress, slope = wall_shear_and_slope(fluid, SPEEDS, 0.1, annulus, 1200.0)
    mirrored, mirrored_slope = wall_shear_and_slope(fluid, -SPEEDS, 0.1, annulus, 1200.0)
    assert np.array_equal(stress, -mirrored) and np.array_equal(slope, mirrored_slope)
    assert stress[-1] == 0.0
    assert np.all(slope > 0) and np.all(stress[:300] > 0)


def test_slope_at_rest():
    """8 G/d_h (c_y/eps + K eps^(n-1)): Herschel-Bulkley in a pipe, G = (3n+1)/4n, c_y = (4/3)^n tau_y; slot G
    = (2n+1)/2n, (3/2)^n."""
    fluid, n = Rheology.herschel_bulkley(0.3, 0.75, 3.0, shear_rate_eps=0.5), 0.75
    _, slope = wall_shear_and_slope(fluid, 0.0, 0.1, [False, True], 1200.0)
    for found, G, c in zip(
        slope, [(3 * n + 1) / (4 * n), (2 * n + 1) / (2 * n)], [4 / 3, 3 / 2], strict=True
    ):
        assert found == pytest.approx(80 * G * (c**n * 3.0 / 0.5 + 0.3 * 0.5 ** (n - 1)), rel=1e-13)


@each_row(
    ("model", "law"),
    [
        (m, law)
        for m in ("newtonian", "power_law", "bingham", "casson", "herschel_bulkley")
        for law in ("blend", "exact")
    ]
    + [("newtonian", "api"), ("power_law", "api")],
)
def test_inviscid_fluid_has_no_friction(model, law):
    """Neither viscosity nor yield stress: exactly zero at any speed, no NaN."""
    stress, slope = wall_shear_and_slope(
        Rheology(model, law), [[0.0, 1e-8, 3.0, -20.0]], 0.1, [[False], [True]], 1200.0
    )
    assert np.array_equal(stress, np.zeros((2, 4))) and np.array_equal(slope, np.zeros((2, 4)))


@every_fluid
def test_extremes_are_finite(fluid):
    """Any state a Newton step may try."""
    stress, slope = wall_shear_and_slope(
        fluid, [0, 1e-300, 1e-20, 1e6, -1e12], 0.01, [[False], [True]], 2000.0
    )
    assert np.all(np.isfinite(stress)) and np.all(np.isfinite(slope))


@every_fluid
def test_dual_numbers(fluid):
    """The template with four directional derivatives gives value and slope times the seeds."""
    w, seed = SPEEDS[::20].copy(), np.tile([1.0, -2.0, 0.0, 0.5], (len(SPEEDS[::20]), 1))
    out, packed = np.empty((len(w), 5)), fluid.parameters()
    function("rheology_wall_shear_dual", "pippdddp")(
        pointer(packed), len(w), pointer(w), pointer(seed), 0.1, 1.0, 1200.0, pointer(out)
    )
    stress, slope = wall_shear_and_slope(fluid, w, 0.1, True, 1200.0)
    assert np.array_equal(out[:, 0], stress)
    assert out[:, 1:] == pytest.approx(slope[:, None] * seed, rel=1e-15)


def test_special_cases_agree():
    """Bingham is Herschel-Bulkley with n = 1, a power law one without yield stress, Newton both; Casson
    without yield stress is Newton."""
    w, args = SPEEDS[::7], (0.1, True, 1200.0)
    for law in ("blend", "exact"):
        for special, general in [
            (Rheology.bingham(0.02, 7.0, law), Rheology.herschel_bulkley(0.02, 1.0, 7.0, law)),
            (Rheology.power_law(0.4, 0.7, law), Rheology.herschel_bulkley(0.4, 0.7, 0.0, law)),
            (Rheology.newtonian(0.02, law), Rheology.casson(0.02, 0.0, law)),
            (Rheology.newtonian(0.02, law), Rheology.bingham(0.02, 0.0, law)),
        ]:
            assert wall_shear(special, w, *args) == pytest.approx(wall_shear(general, w, *args), rel=1e-13)
    thin = Rheology.herschel_bulkley(
        0.4, 0.7, 1e-9, "exact"
    )  # through the inversion: must meet the closed form
    assert wall_shear(thin, w, *args) == pytest.approx(
        wall_shear(Rheology.power_law(0.4, 0.7), w, *args), rel=1e-7
    )


def test_apparent_viscosity():
    """Stress over shear rate at 100 1/s: 3/100 + 0.3 x 100^-0.25; Casson (sqrt(4) + sqrt(0.02 x
    100))^2/100."""
    fluid = Rheology.herschel_bulkley(0.3, 0.75, 3.0, shear_rate_eps=1e-6)
    assert fluid.apparent_viscosity(100.0) == pytest.approx(0.03 + 0.3 * 100**-0.25)
    assert Rheology.casson(0.02, 4.0, shear_rate_eps=1e-6).apparent_viscosity(100.0) == pytest.approx(
        (2 + np.sqrt(2)) ** 2 / 100
    )


@each_row(
    "wrong",
    [
        {"model": "maxwell"},
        {"model": "newtonian", "law": "moody"},
        {"model": "newtonian", "consistency": -1.0},
        {"model": "power_law", "consistency": 0.1, "index": 0.0},
        {"model": "power_law", "consistency": 0.1, "index": 2.5},
        {"model": "bingham", "consistency": 0.1, "index": 0.5},
        {"model": "bingham", "consistency": 0.1, "yield_stress": 1.0, "law": "api"},
        {"model": "newtonian", "consistency": 0.1, "yield_stress": 1.0},
        {"model": "newtonian", "consistency": 0.1, "shear_rate_eps": 0.0},
        {"model": "newtonian", "consistency": float("nan")},
    ],
)
def test_bad_input_is_refused(wrong):
    """What the kernel cannot evaluate never reaches it."""
    with pytest.raises(ValueError, match="rheology"):
        Rheology(**wrong)
