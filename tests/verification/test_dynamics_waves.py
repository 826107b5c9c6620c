"""Waves, steps and orders in time against closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from drillpetsc.fem.string_mesh import tube
from drillpetsc.physics.end_conditions import EndPlace, FixedEnd, Loads, NodeLoad, TopDrive
from drillpetsc.time_function import Constant, PiecewiseLinear, Ramp
from tests.helpers.motion import sampled
from tests.helpers.moving import straight_model
from tests.helpers.uniform_string import uniform_string

PIPE = tube(0.127, 0.1086, 206e9, 0.3, 7850.0)
LENGTH = 2000.0
TORSION = np.sqrt(206e9 / 2.6 / 7850.0)  # 3176.96 m/s


def clamp(frames, position, tangent):
    return FixedEnd(EndPlace(position[0], tangent[0]), "clamped")


def bit_speed(system):
    return system.field("string.spin", "y")[-1, 0]


def test_torque_step_plateau_and_top_torque():
    """2 kN m on the free end of 2000 m of pipe: bit speed T/Z = 6.74829 rad/s until 2L/c, then its negative;
    top torque 2T (manual: verif-torque-step).

    Characteristics of the torsional wave, Z = GJ/c = 296.371 N m s.
    """
    n = 200
    mesh = uniform_string(LENGTH, n, **PIPE)
    system = straight_model(mesh, [clamp, lambda f, p, t: Loads((NodeLoad(n, moment=(0, 0, 2000.0)),), f)])
    rows = sampled(
        system,
        2.4,
        lambda m: [bit_speed(m), m.reaction("top.torque_reaction")],
        ts_adapt_type="none",
        ts_dt=2e-3,
    )
    t, speed, torque = rows.T
    period = 2 * LENGTH / TORSION
    first = (t > 0.2 * period) & (t < 0.8 * period)
    second = (t > 1.2 * period) & (t < 1.8 * period)
    assert speed[first].mean() == pytest.approx(6.74829, rel=0.005)
    assert speed[second].mean() == pytest.approx(-6.74829, rel=0.01)
    at_top = (t > 0.7 * period) & (t < 1.3 * period)
    assert np.abs(torque[at_top].mean()) == pytest.approx(4000.0, rel=0.01)


def test_spin_up_against_the_exact_torsional_wave():
    """Top speed a half cosine to 80 rpm in 2 s: the bit speed is the sum of delayed inputs (method of
    characteristics, exact; manual: verif-spin-up)."""
    n, top = 225, 80 * 2 * np.pi / 60
    mesh = uniform_string(LENGTH, n, **PIPE)
    system = straight_model(
        mesh, [lambda f, p, t: TopDrive(EndPlace(p[0], t[0]), Ramp(2.0, top), Constant(0.0))]
    )
    delay = LENGTH / TORSION

    def exact(t):
        def f(s):
            return np.where(s <= 0, 0, np.where(s >= 2, 1, 0.5 * (1 - np.cos(np.pi * s / 2)))) * top

        return sum(2 * (-1) ** k * f(t - (2 * k + 1) * delay) for k in range(8))

    errors = []
    for dt in (0.02, 0.01, 0.005):
        system.set_field("string.spin", np.zeros((n + 1, 1)))
        system.assembly.y[:] = 0
        t, speed = sampled(system, 5.0, bit_speed, (2.0,), ts_adapt_type="none", ts_dt=dt).T
        errors.append(np.sqrt(np.mean((speed - exact(t)) ** 2)) / top)
    assert errors[-1] < 5e-4
    assert errors[0] > errors[1] > errors[2]
    # adaptive: the tolerance controls number of steps and error
    counts = []
    for tolerance in (1e-3, 1e-5):
        system.set_field("string.spin", np.zeros((n + 1, 1)))
        system.assembly.y[:] = 0
        t, speed = sampled(system, 5.0, bit_speed, (2.0,), ts_rtol=tolerance).T
        counts.append((len(t), np.sqrt(np.mean((speed - exact(t)) ** 2)) / top))
    assert counts[1][0] > 1.5 * counts[0][0] and counts[1][1] < 0.3 * counts[0][1]


def test_order_in_time_is_two():
    """Free torsional vibration in the first mode, phi = A cos(omega t) sin(pi s / 2L), clamped-free: BDF2
    converges with order 2 (manual: verif-order-in-time)."""
    n = 40
    mesh = uniform_string(LENGTH, n, **PIPE)
    omega = np.pi * TORSION / (2 * LENGTH)
    shape = np.sin(np.pi * mesh.node_depth / (2 * LENGTH))
    errors = []
    steps = (0.04, 0.02, 0.01, 0.005)
    for dt in steps:
        system = straight_model(mesh, [clamp])
        system.set_field("string.spin", shape[:, None])
        t, angle = sampled(
            system, 2.0, lambda m: m.field("string.spin")[-1, 0], ts_adapt_type="none", ts_dt=dt
        ).T
        errors.append(abs(angle[-1] - np.cos(omega * t[-1])))
    rate = np.polyfit(np.log(steps[1:]), np.log(errors[1:]), 1)[0]
    assert abs(rate - 2.0) < 0.15
    assert errors[-1] < 3e-4


def test_axial_wave_at_a_section_change():
    """Force step on the free end of a collar below a pipe: the reflected velocity is (Z2 - Z1)/(Z1 + Z2) of
    the incident one, Z = sqrt(EA mu) (plane waves in stepped bars), so the loaded end has v0 (1 + 2 r)
    (manual: verif-wave-section-change)."""
    n, force = 200, 1e4
    collar = tube(0.1778, 0.0714, 206e9, 0.3, 7850.0)
    mesh = uniform_string(LENGTH, n, **PIPE)
    upper = np.arange(n) < n // 2
    columns = {k: np.where(upper, PIPE[k], collar[k]) for k in PIPE}
    junction = np.zeros(n + 1, dtype=bool)
    junction[n // 2] = True
    mesh = replace(mesh, junction=junction, **columns)
    ramp = Ramp(0.05, 1.0)
    system = straight_model(
        mesh, [clamp, lambda f, p, t: Loads((NodeLoad(n, force=(0, 0, force), factor=ramp.value),), f)]
    )
    t, speed = sampled(
        system,
        0.72,
        lambda m: m.field("string.position", "y")[-1, 2],
        (0.05,),
        ts_adapt_type="none",
        ts_dt=5e-4,
    ).T
    z1, z2 = (np.sqrt(q["axial_stiffness"] * q["mass"]) for q in (PIPE, collar))
    c = np.sqrt(206e9 / 7850.0)
    back = 2 * (LENGTH / 2) / c  # 0.39 s
    v0, r = force / z2, (z2 - z1) / (z1 + z2)
    before = (t > 0.1) & (t < back - 0.02)
    after = (t > back + 0.1) & (t < 0.72)
    assert speed[before].mean() == pytest.approx(v0, rel=0.005)
    assert speed[after].mean() == pytest.approx(v0 * (1 + 2 * r), rel=0.01)


def test_a_spinning_hung_string_keeps_its_speed_for_1000_revolutions():
    """Without torque and damping the spin rate is constant (phi = Omega t is exact for BDF; manual:
    verif-steady-spin)."""
    n, speed = 10, 80 * 2 * np.pi / 60
    mesh = uniform_string(100.0, n, **PIPE)
    system = straight_model(
        mesh, [lambda f, p, t: TopDrive(EndPlace(p[0], t[0]), None, Constant(0.0))], gravity=(0, 0, 9.81)
    )
    s = mesh.node_depth
    strain = PIPE["mass"] * 9.81 * (100.0 - s) / PIPE["axial_stiffness"]
    stretch = PIPE["mass"] * 9.81 / PIPE["axial_stiffness"] * (100.0 * s - s**2 / 2)
    system.set_field("string.position", np.column_stack([0 * s, 0 * s, s + stretch]))
    system.set_field("string.tangent", np.column_stack([0 * s, 0 * s, 1 + strain]))
    system.set_field("string.spin", np.full((n + 1, 1), speed), "y")
    rows = sampled(
        system, 750.0, lambda m: m.field("string.spin", "y")[:, 0], ts_adapt_type="none", ts_dt=0.25
    )
    assert np.abs(rows[-1, 1:] / speed - 1).max() < 1e-9
    angle = system.field("string.spin")[:, 0]
    assert angle == pytest.approx(speed * 750.0, rel=1e-9)


def test_a_step_ends_at_a_jump_of_the_top_speed():
    """Rotation with a jump at 0.5 s: a step ends there, and the bit has twice the jump after L/c (manual:
    verif-speed-jump)."""
    jump = PiecewiseLinear((0.0, 0.5, 0.5, 5.0), (0.0, 0.0, 1.0, 1.0))
    mesh = uniform_string(LENGTH, 100, **PIPE)
    system = straight_model(mesh, [lambda f, p, t: TopDrive(EndPlace(p[0], t[0]), jump, Constant(0.0))])
    rows = sampled(system, 1.6, bit_speed, jump.breaks(), ts_rtol=1e-4)
    t, speed = rows.T
    assert np.min(np.abs(t - 0.5)) < 1e-12
    assert np.abs(speed[t < 0.9]).max() < 0.02
    assert speed[(t > 1.3) & (t < 1.6)].mean() == pytest.approx(2.0, rel=0.02)
