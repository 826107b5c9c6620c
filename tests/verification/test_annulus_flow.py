"""Fluid between string and hole in a whole model: added mass, lateral damping, flow along the string, bore
and annulus together.

Models as in test_pipes_conveying_fluid.py. chi = (Dw^2 + Do^2)/(Dw^2 - Do^2) is the ratio of added to
displaced mass of a cylinder in a concentric hole (potential flow; Paidoussis, Fluid-Structure Interactions,
vol. 2; manual: eq-mud-chi).
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from drillpetsc.analysis.statics.placement import move_rigidly, release
from drillpetsc.physics.fluid.rheology import Rheology, wall_shear
from tests.helpers.motion import fixed, integrate
from tests.helpers.pipe_with_flow import (
    BENDING,
    BORE,
    DENSITY,
    FORCE,
    INNER,
    LENGTH,
    OUTER,
    SOLID,
    Tube,
    across,
    fastest_growing,
    flow_of,
    oscillating,
    roots_of,
    softest,
    spectral,
)

PLUGGED = {"kind": "pinned", "plugged": True}
RATIOS = (3.0, 1.7, 1.2)  # hole over string diameter
GRAVITY = 9.81


def chi_of(ratio: float) -> float:
    return (ratio**2 + 1) / (ratio**2 - 1)


def slowest_root(tube: Tube, **fluid) -> complex:
    """First root [1/s] of a pinned, plugged, empty pipe in still fluid."""
    model = tube.at_rest({"lateral_damping": "none", **fluid}, bottom=PLUGGED)
    return complex(oscillating(roots_of(*across(model)), 1)[0])


# ---------------------------------------------------------------------- still fluid
@pytest.mark.parametrize("ratio", RATIOS)
def test_confined_added_mass_from_the_frequency(ratio):
    """The frequency of a pipe with added mass gives chi within 1e-4 (manual: verif-added-mass).

    The pipe has 0.6 and the displaced fluid 0.4 of the total mass: undamped frequency 1/sqrt(.6 + .4 chi)
    (.95346, .83822, .59568) of that without added mass. The same for a given ratio, and for the plug flow of
    the reference paper, Do^2/(Dw^2 - Do^2).
    """
    displaced = DENSITY * SOLID
    tube, beam = Tube(1.5 * displaced, 16, hole=ratio * OUTER), np.pi**4 * BENDING / LENGTH**4
    for option, chi in (
        ("confined", chi_of(ratio)),
        ("paper_plug", 1 / (ratio**2 - 1)),
        (7.5, 7.5),
        ("none", 0.0),
    ):
        s = slowest_root(tube, added_mass=option)
        assert abs(s.real) < 1e-9 * s.imag
        assert (beam / s.imag**2 - tube.mass) / displaced == pytest.approx(chi, abs=1e-4 * (chi + 1.5))
    s = slowest_root(tube)
    assert s.imag / np.sqrt(beam / (2.5 * displaced)) == pytest.approx(
        1 / np.sqrt(0.6 + 0.4 * chi_of(ratio)), rel=2e-5
    )


def test_lateral_damping_is_the_number_given():
    """Given damping k_v [N s/m2]: s^2 (m + chi rho A_o) + s k_v + EI (pi/L)^4 = 0."""
    tube, damping = Tube(30.0, 16, hole=1.7 * OUTER), 12.0
    s = slowest_root(tube, lateral_damping=damping)
    mass = tube.mass + chi_of(1.7) * DENSITY * SOLID
    assert -2 * s.real * mass == pytest.approx(damping, rel=1e-6)
    assert abs(s) ** 2 * mass == pytest.approx(np.pi**4 * BENDING / LENGTH**4, rel=2e-5)


STOKES = {(1.25, 100.0): 11.07, (1.25, 1e4): 0.3685, (2.0, 100.0): 0.7218, (2.0, 1e4): 0.0580}


@pytest.mark.parametrize(("ratio", "number"), STOKES)
def test_lateral_damping_from_viscous_flow(ratio, number):
    """Decay of the first mode of a pipe in a viscous fluid, within 0.1 % of the exact solution of the Stokes
    equations (manual: verif-stokes-damping).

    C_d at S = Omega Ro^2/nu: Chen, Wambsganss and Jendrzejczyk 1976.
    """
    tube, speed = Tube(30.0, 16, hole=ratio * OUTER), 0.5
    viscosity = DENSITY * speed * OUTER**2 / 4 / number
    law = {"model": "newtonian", "viscosity": float(viscosity)}
    s = slowest_root(tube, rheology=law, lateral_damping="stokes", lateral_damping_speed=speed)
    mass = tube.mass + chi_of(ratio) * DENSITY * SOLID
    assert -2 * s.real * mass / (DENSITY * SOLID * speed) == pytest.approx(STOKES[ratio, number], rel=2e-3)


def test_vibration_in_a_filled_hole():
    """A pinned pipe released from rest in its first mode (manual: verif-added-mass).

    8 elements, BDF2 with omega dt = 0.03: period within 0.1 % and decay within 0.5 % of s^2 (m + chi rho A_o)
    + s k_v + EI (pi/L)^4 = 0. BDF2 lengthens the period by (omega dt)^2/3 = 0.03 %. The amplitude is small
    compared with sqrt(EI/EA) = 1 mm, because a bent pipe between fixed ends stretches.
    """
    tube, damping = Tube(30.0, 8, hole=1.7 * OUTER), 12.0
    mass = tube.mass + chi_of(1.7) * DENSITY * SOLID
    decay = 0.5 * damping / mass
    omega = np.sqrt(np.pi**4 * BENDING / LENGTH**4 / mass - decay**2)
    model = tube.at_rest({"lateral_damping": damping}, bottom=PLUGGED)
    release(model)
    move_rigidly(model)
    x, r, v = (
        model.mesh.node_depth / LENGTH,
        *(model.system.field(f"string.{k}").copy() for k in ("position", "tangent")),
    )
    r[:, 0], v[:, 0] = 2e-6 * np.sin(np.pi * x), 2e-6 * np.pi / LENGTH * np.cos(np.pi * x)
    model.system.set_field("string.position", r)
    model.system.set_field("string.tangent", v)
    path: list[tuple[float, float]] = []
    integrate(
        model.system,
        4.2 * 2 * np.pi / omega,
        fixed(0.03 / omega),
        call=lambda t, dt: path.append((t, model.system.field("string.position")[4, 0])),
    )
    t, y = np.array(path).T
    k = np.flatnonzero((y[:-1] > 0) & (y[1:] <= 0))
    falls = t[k] - y[k] * (t[k + 1] - t[k]) / (y[k + 1] - y[k])
    assert 2 * np.pi / np.diff(falls).mean() == pytest.approx(omega, rel=1e-3)
    tops = [y[a : b + 1].max() for a, b in zip(k, k[1:], strict=False)]
    rate = np.log(tops[0] / tops[-1]) / ((len(tops) - 1) * 2 * np.pi / omega)
    assert rate == pytest.approx(decay, rel=5e-3)


# ---------------------------------------------------------------------- flow
@pytest.mark.parametrize("ratio", RATIOS)
def test_flow_in_and_around_a_pinned_pipe_buckles_it(ratio):
    """Flow down the bore and up the annulus, inviscid, at zero pressure: divergence at rho A_i U_i^2 + chi
    rho A_o U_o^2 = pi^2 EI/L2 (manual: verif-annulus-divergence).

    Annulus alone: u_o = pi/sqrt(chi). Within 5e-5 with 16 elements, of fourth order.
    """
    annulus = (ratio**2 - 1) * SOLID
    exact = np.pi / LENGTH * np.sqrt(BENDING / DENSITY / (1 / BORE + chi_of(ratio) * SOLID / annulus**2))
    error = []
    for n in (4, 8, 16):
        tube = Tube(10.0, n, hole=ratio * OUTER)
        q = brentq(
            lambda q, tube=tube: softest(tube.at_rest({"flow_rate": float(q)})),
            0.9 * exact,
            1.1 * exact,
            xtol=1e-8 * exact,
        )
        error.append(q / exact - 1)
    assert 0 < error[2] < 5e-5
    assert error[0] / error[1] > 12 and error[1] / error[2] > 12


def test_flow_around_a_pinned_pipe_buckles_it_either_way():
    """With a large added mass (chi = 1000) the bore contributes 0.5 %: u_o = U_o L sqrt(rho A_o/EI) =
    pi/sqrt(chi) minus that part, in normal and in reverse circulation."""
    tube, chi = Tube(10.0, 16, hole=1.7 * OUTER), 1000.0
    annulus = (1.7**2 - 1) * SOLID
    share = 1 / BORE / (1 / BORE + chi * SOLID / annulus**2)
    assert share < 6e-3
    near = np.pi / np.sqrt(chi) / LENGTH * np.sqrt(BENDING / (DENSITY * SOLID)) * annulus
    for way in (1.0, -1.0):

        def stiffness(q: float, way: float = way) -> float:
            return softest(tube.at_rest({"flow_rate": float(way * q), "added_mass": chi}))

        q = brentq(stiffness, 0.8 * near, 1.1 * near, xtol=1e-9)
        assert q / near == pytest.approx(np.sqrt(1 - share), rel=5e-5)


# ---------------------------------------------------------------------- bore and annulus of a hanging
# cantilever
def hanging(
    u: float, ratio: float, viscosity: float, damping: float, elements: int, mass: float = 10.0
) -> np.ndarray:
    """Eigenvalues [1/s] of the assembled system, bore down and annulus up (u < 0: reversed), u = U_i L
    sqrt(rho A_i/EI)."""
    tube = Tube(mass, elements, hole=ratio * OUTER)
    fluid = {
        "flow_rate": flow_of(u),
        "lateral_damping": damping,
        "rheology": {"model": "newtonian", "viscosity": viscosity},
    }
    model = tube.at_rest(fluid, top="clamped", bottom="free", gravity=GRAVITY)
    return roots_of(*across(model))


def hanging_by_spectrum(
    u: float, ratio: float, viscosity: float, damping: float, mass: float = 10.0
) -> np.ndarray:
    """The same from the linear equation (manual: eq-mud-work-annulus; slender-body added momentum, Lighthill
    1960; drag along the relative velocity)

      EI y'''' - (T y')' + rho A_i (d_t + U_i d_s)^2 y + chi rho A_o (d_t + U_o d_s)^2 y + m y_tt + k_v y_t
      + F/|U_o| (y_t + U_o y') = 0,

    with the full mass of the fluid in the bore and the wall shear F = tau pi D_o. T decreases to 0 at the
    free end by (m + rho A_i - rho A_o) g minus the lift F Dw/(Dw - Do) of upward flow (pressure and shear).
    """
    tension_unit, s2 = BENDING / LENGTH**2, LENGTH**4 / BENDING
    added, annulus = chi_of(ratio) * DENSITY * SOLID, (ratio**2 - 1) * SOLID
    q = flow_of(u)
    U_i, U_o = q / BORE, -q / annulus
    shear = (
        float(wall_shear(Rheology.newtonian(viscosity), abs(U_o), (ratio - 1) * OUTER, 1, DENSITY))
        if viscosity
        else 0.0
    )
    force = shear * np.pi * OUTER
    weight = (mass + DENSITY * (BORE - SOLID)) * GRAVITY - np.sign(q) * force * ratio / (ratio - 1)
    drag = force / abs(U_o)
    return spectral(
        "cantilever",
        (weight * LENGTH / tension_unit, -weight * LENGTH / tension_unit),
        centrifugal=(DENSITY * BORE * U_i**2 + added * U_o**2) / tension_unit,
        coriolis=2 * (DENSITY * BORE * U_i + added * U_o) * s2 / LENGTH,
        damping=(damping + drag) * s2,
        drag=drag * U_o * s2 / LENGTH,
        mass=(mass + DENSITY * BORE + added) * s2,
    )


HANGING = [  # u, hole over string, viscosity [Pa s], k_v [N s/m2]
    (4.0, 3.0, 0.0, 0.0),
    (4.0, 3.0, 0.05, 0.0),
    (1.2, 1.5, 0.05, 5.0),
    (1.2, 1.5, 0.0, 5.0),
    (-1.2, 1.5, 0.05, 0.0),
]


@pytest.mark.parametrize(("u", "ratio", "viscosity", "damping"), HANGING)
def test_roots_of_a_hanging_pipe_with_flow_in_and_around_it(u, ratio, viscosity, damping):
    """First three complex eigenvalues (frequency and growth) within 1e-4 of the spectral solution with 16
    elements, of fourth order (manual: verif-annulus-hanging-pipe)."""
    exact = oscillating(hanging_by_spectrum(u, ratio, viscosity, damping), 3)
    error = [np.abs(oscillating(hanging(u, ratio, viscosity, damping, n), 3) / exact - 1) for n in (4, 8, 16)]
    assert error[2].max() < 1e-4
    assert np.all(error[0] > 8 * error[1]) and np.all(error[1] > 8 * error[2])


@pytest.mark.parametrize(("ratio", "damping", "near"), [(3.0, 0.0, 4.7), (1.5, 5.0, 0.6), (1.5, 10.0, 1.2)])
def test_hanging_pipe_flutters(ratio, damping, near):
    """Critical bore speed (manual: verif-annulus-hanging-pipe): a wide annulus has no influence; in a narrow
    one flutter starts at a low flow, in proportion to the damping in still fluid (pattern of Paidoussis, Luu
    and Prabhakar, J. Fluids Struct. 24, 2008)."""

    def critical(roots) -> float:
        return brentq(lambda u: fastest_growing(roots(u)).real, 0.4 * near, 1.6 * near, xtol=1e-8)

    exact = critical(lambda u: hanging_by_spectrum(u, ratio, 0.0, damping))
    found = [critical(lambda u, n=n: hanging(u, ratio, 0.0, damping, n)) for n in (4, 8, 16)]
    assert found[2] == pytest.approx(exact, rel=1e-4)
    assert abs(found[0] - exact) > 8 * abs(found[1] - exact)


def test_outlet_pressure_between_fixed_ends_stiffens_the_pipe():
    """Fixed ends, empty and plugged: T = p_o A_o, omega^2 (m + chi rho A_o) = EI (pi/L)^4 + p_o A_o
    (pi/L)^2."""
    tube = Tube(30.0, 16, hole=1.7 * OUTER)
    s = slowest_root(tube, outlet_pressure=7 * FORCE / SOLID)
    mass = tube.mass + chi_of(1.7) * DENSITY * SOLID
    assert s.imag == pytest.approx(np.sqrt((np.pi**4 + 7 * np.pi**2) * BENDING / LENGTH**4 / mass), rel=2e-5)


def test_areas_of_the_model_are_those_of_the_helper():
    """Areas of bore and annulus in the model."""
    assert np.pi / 4 * INNER**2 == BORE and np.pi / 4 * OUTER**2 == SOLID
    model = Tube(30.0, 4, hole=1.7 * OUTER).at_rest({})
    assert model.fluid.bore.bore.area == pytest.approx(BORE, rel=1e-14)
    assert model.fluid.annulus.annulus.hole == pytest.approx(1.7**2 * SOLID, rel=1e-14)
