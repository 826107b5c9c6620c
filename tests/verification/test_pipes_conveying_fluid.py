"""A pipe that conveys fluid, in a whole model: effect of flow, pressure and tension on stiffness and
stability (manual: sec-verif-fluid-structure, verif-pipe-divergence, verif-cantilever-flutter).

Steady states from find_equilibrium, K = dR/dx, C = dR/dy, M = dR/da of the assembled rows; inviscid,
incompressible fluid. u = U L sqrt(rho A_i/EI), beta = fluid mass over total mass, gamma = (total mass) g
L^3/EI; frequencies omega in sqrt(EI/(total mass))/L^2. Source, unless stated: Paidoussis, Fluid-Structure
Interactions, vol. 1 (1998), chapter 3.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import eigvals, null_space
from scipy.optimize import brentq

from drillpetsc.analysis.linear.modal import modes, prepare_state
from drillpetsc.analysis.statics.placement import move_rigidly, release
from drillpetsc.model.drilling_model import build_model
from tests.helpers.motion import fixed, integrate
from tests.helpers.moving import matrices
from tests.helpers.pipe_with_flow import (
    BENDING,
    BORE,
    DENSITY,
    FORCE,
    LENGTH,
    OUTER,
    SOLID,
    Tube,
    across,
    conveying,
    fastest_growing,
    flow_of,
    oscillating,
    roots_of,
    softest,
    spectral,
)

CLAMPED_FREE, CLAMPED_PINNED = 3.5160153, 15.4182057  # (beta_1)^2 of cos cosh = -1 and tan = tanh
SLIDING = {"kind": "top_drive", "force": 0.0}


def divergence(
    elements: int, near: float, beta: float = 0.5, stretch: float = 0.0, pressure: float = 0.0, **ends
) -> float:
    """u at which the lateral stiffness becomes indefinite."""
    tube = Tube.of(beta, elements)

    def stiffness(u: float) -> float:
        return softest(tube.at_rest({"flow_rate": flow_of(u), "outlet_pressure": pressure}, stretch, **ends))

    return brentq(stiffness, 0.9 * near, 1.1 * near, xtol=1e-7)


# ---------------------------------------------------------------------- divergence
HELD = {
    "pinned-pinned": ({"top": "pinned", "bottom": "pinned"}, np.pi),
    "clamped-clamped": ({"top": "clamped", "bottom": "clamped"}, 2 * np.pi),
    "clamped-pinned": ({"top": "clamped", "bottom": "pinned"}, 4.4934095),  # tan x = x
}


@pytest.mark.parametrize("ends", HELD)
def test_pipe_held_at_both_ends_diverges(ends):
    """The centrifugal load rho A U^2 is Euler's load, u = pi, 2 pi, 4.4934: 5e-5 with 16 elements, of fourth
    order, from above (manual: verif-pipe-divergence)."""
    where, exact = HELD[ends]
    error = [divergence(n, exact, **where) / exact - 1 for n in (4, 8, 16)]
    assert 0 < error[2] < 5e-5
    assert min(np.log2(error[0] / error[1]), np.log2(error[1] / error[2])) > 3.5


def test_divergence_does_not_depend_on_the_mass_of_the_fluid():
    """The critical speed is independent of beta (manual: verif-pipe-divergence)."""
    assert divergence(4, np.pi, beta=0.1) == pytest.approx(divergence(4, np.pi, beta=0.8), rel=1e-9)


@pytest.mark.parametrize("way", ["tension", "pressure"])
def test_divergence_under_tension_and_pressure(way):
    """Tension 5 EI/L2 is added to Euler's load, pressure p A = 4 EI/L2 between fixed ends is subtracted: u^2
    = pi^2 + 5, pi^2 - 4 (manual: verif-divergence-tension-pressure)."""
    tube = Tube.of(0.5)
    exact = np.sqrt(np.pi**2 + 5) if way == "tension" else np.sqrt(np.pi**2 - 4)
    load = (
        {"stretch": 5 * FORCE * LENGTH / tube.axial} if way == "tension" else {"pressure": 4 * FORCE / BORE}
    )
    error = [divergence(n, exact, **load) / exact - 1 for n in (4, 8, 16)]
    assert 0 < error[2] < 5e-5
    assert error[0] / error[1] > 12 and error[1] / error[2] > 12


# ---------------------------------------------------------------------- frequencies
def test_frequencies_of_a_pinned_pipe_with_flow():
    """u = 2, beta 0.5: omega of the spectral solution (7.45357, 37.6321, 87.1044), with the errors at 8
    elements of the manual (manual: verif-pinned-pipe-frequencies) and of fourth order. The flow is
    conservative here: no growth, no decay."""
    exact = oscillating(conveying(2.0, 0.5, ends="pinned"), 3)
    assert exact.imag == pytest.approx([7.45357, 37.6321, 87.1044], rel=2e-6)
    error = []
    for n in (4, 8, 16):
        tube = Tube.of(0.5, n)
        s = oscillating(roots_of(*across(tube.at_rest({"flow_rate": flow_of(2.0)}))), 3) * tube.time
        assert np.abs(s.real).max() < 1e-8
        error.append(s.imag / exact.imag - 1)
    assert error[1] == pytest.approx(
        [4.4e-5, 3.4e-4, 1.44e-3], rel=0.05
    )  # manual: verif-pinned-pipe-frequencies
    assert np.all(np.log2(np.divide(error[1], error[2])) > 3.6)


def test_all_unknowns_together_have_the_same_roots():
    """The linearised system with pressures and flow rates (first order) has each lateral eigenvalue twice
    (two planes), and none that grows."""
    tube = Tube.of(0.5, 6)
    model = tube.at_rest({"flow_rate": flow_of(2.0)})
    free, drop = np.eye(model.system.layout.size), []
    for f in model.system.assembly.row_replacements:
        base = null_space(f.D)
        free[np.ix_(f.rows, f.rows)] = 0.0
        free[np.ix_(f.rows, f.rows[: base.shape[1]])] = base
        drop += list(f.rows[base.shape[1] :])
    free = np.delete(free, drop, axis=1)
    K, C, M = (free.T @ A @ free for A in matrices(model.system))
    zero, one = np.zeros_like(K), np.eye(len(K))
    alpha, beta = eigvals(
        np.block([[zero, one], [-K, -C]]), np.block([[one, zero], [zero, M]]), homogeneous_eigvals=True
    )
    s = alpha[np.abs(beta) > 1e-10 * np.abs(alpha)] / beta[np.abs(beta) > 1e-10 * np.abs(alpha)]
    for root in oscillating(roots_of(*across(model)), 3):
        assert np.sum(np.abs(s - root) < 1e-6 * abs(root)) == 2
    slow = s[np.abs(s) * tube.time < 1e3]
    assert slow.real.max() < 1e-6 * np.abs(slow).max()


# ---------------------------------------------------------------------- pressure at rest
@pytest.mark.parametrize("load", [0.0, 5.0, 50.0])
def test_pressure_does_not_change_the_frequency_of_a_blind_pipe(load):
    """p A_i (in EI/L2) on a plugged end that slides freely: wall tension p A_i, effective tension 0, first
    frequency of the empty pipe's stiffness (manual: verif-blind-pipe-pressure): clamped-free, and
    clamped-pinned with a sliding upper end."""
    tube = Tube.of(0.5)
    fluid = {"pump_pressure": load * FORCE / BORE}
    for ends, exact in (
        ({"top": "clamped", "bottom": {"kind": "free", "plugged": True}}, CLAMPED_FREE),
        ({"top": SLIDING, "bottom": {"kind": "pinned", "plugged": True}}, CLAMPED_PINNED),
    ):
        model = tube.at_rest(fluid, **ends)
        cells = model.beam.element_results(model.system.assembly)
        assert cells[:, 3:6] == pytest.approx(load * FORCE, abs=1e-5 * FORCE)
        assert oscillating(roots_of(*across(model)), 1).imag * tube.time == pytest.approx([exact], rel=2e-5)


@pytest.mark.parametrize("load", [0.0, 5.0, 50.0, 200.0])
def test_outside_pressure_does_not_buckle_a_closed_pipe(load):
    """p_o A_o up to 200 EI/L2 on an empty closed pipe compresses the wall by up to 80 times a cantilever's
    Euler load, but does not change the frequency in still fluid (manual: verif-blind-pipe-pressure)."""
    tube = Tube(50.0, 16, hole=2 * OUTER)
    chi = (2**2 + 1) / (2**2 - 1)
    exact = CLAMPED_FREE * np.sqrt(BENDING / (tube.mass + chi * DENSITY * SOLID)) / LENGTH**2
    fluid = {"outlet_pressure": load * FORCE / SOLID, "lateral_damping": "none"}
    held = SLIDING | {
        "force": -load * FORCE
    }  # against being pushed out of the hole, where nothing presses on the section's upper side
    for ends, factor in (
        ({"top": "clamped", "bottom": {"kind": "free", "plugged": True}}, 1.0),
        ({"top": held, "bottom": {"kind": "pinned", "plugged": True}}, CLAMPED_PINNED / CLAMPED_FREE),
    ):
        model = tube.at_rest(fluid, **ends)
        cells = model.beam.element_results(model.system.assembly)
        assert cells[:, 3:6] == pytest.approx(-load * FORCE, abs=1e-5 * FORCE)
        assert oscillating(roots_of(*across(model)), 1).imag == pytest.approx([factor * exact], rel=2e-5)


@pytest.mark.parametrize("load", [5.0, 9.0])
def test_pressure_between_fixed_ends_softens_the_pipe(load):
    """Without wall tension the effective tension is -p A_i: omega^2 = pi^4 - pi^2 p A_i L2/EI (6.93261 and
    2.92962; manual: verif-fixed-ends-pressure)."""
    omega, error = np.sqrt(np.pi**4 - np.pi**2 * load), []
    for n in (4, 8, 16):
        tube = Tube.of(0.5, n)
        s = (
            oscillating(roots_of(*across(tube.at_rest({"outlet_pressure": load * FORCE / BORE}))), 1)
            * tube.time
        )
        error.append(float(s[0].imag / omega - 1))
    assert error[2] < 5e-5
    assert error[0] / error[1] > 12 and error[1] / error[2] > 12


def test_elastic_wall_between_fixed_ends_carries_part_of_the_pressure():
    """A steel tube that expands under pressure pulls at its fixed ends, T = 2 nu p A_i (thick tube, Lame), so
    the effective tension is -(1 - 2 nu) p A_i and omega^2 = pi^4 - pi^2 (1 - 2 nu) p A_i L2/EI (manual:
    verif-fixed-ends-pressure)."""
    young, nu = 206e9, 0.3
    bending = young * np.pi / 64 * (OUTER**4 - 0.1**4)
    pressure = 8.0 * bending / LENGTH**2 / BORE
    item = {
        "kind": "pipe",
        "length": LENGTH,
        "od": OUTER,
        "id": 0.1,
        "element_length": LENGTH / 16,
        "material": {"young": young, "poisson": nu},
    }
    tube = Tube.of(0.5)
    model = tube.at_rest({"outlet_pressure": pressure, "elastic_walls": True}, string=[item])
    mass = 7850 * (SOLID - BORE) + DENSITY * BORE
    omega = np.sqrt((np.pi**4 - np.pi**2 * (1 - 2 * nu) * 8.0) * bending / mass) / LENGTH**2
    assert oscillating(roots_of(*across(model)), 1).imag == pytest.approx([omega], rel=1e-4)


# ---------------------------------------------------------------------- flutter
def flutter(elements: int, beta: float, near: float, gamma: float = 0.0) -> tuple[float, float]:
    """(u, omega) at the onset of flutter of a cantilever near a given u."""
    tube = Tube.of(beta, elements)
    gravity = gamma * BENDING / ((tube.mass + DENSITY * BORE) * LENGTH**3)

    def root(u: float) -> complex:
        model = tube.at_rest({"flow_rate": flow_of(u)}, top="clamped", bottom="free", gravity=float(gravity))
        return fastest_growing(roots_of(*across(model))) * tube.time

    u = brentq(lambda u: root(u).real, 0.95 * near, 1.05 * near, xtol=1e-7)
    return u, root(u).imag


FLUTTER = {  # beta, gamma: u and omega as published (manual: verif-cantilever-flutter)
    (0.2, 0.0): (5.591, 13.72),
    (0.23e-3, 61.1): (6.15, 21.3),
    (2.03e-3, 42.4): (5.62, 19.5),
}


@pytest.mark.parametrize(("beta", "gamma"), FLUTTER)
def test_cantilever_flutters(beta, gamma):
    """Standing and hanging cantilevers: published u and omega within 0.2 % with 16 elements; the spectral
    solution within 3e-5, of fourth order (manual: verif-cantilever-flutter,
    verif-hanging-cantilever-flutter)."""
    u, omega = FLUTTER[beta, gamma]
    exact = brentq(lambda u: fastest_growing(conveying(u, beta, gamma)).real, 0.95 * u, 1.05 * u, xtol=1e-10)
    at = fastest_growing(conveying(exact, beta, gamma)).imag
    assert (exact, at) == pytest.approx((u, omega), rel=2e-3)
    found = np.array([flutter(n, beta, u, gamma) for n in (4, 8, 16)])
    assert found[2] == pytest.approx((u, omega), rel=2e-3)
    error = np.abs(found / (exact, at) - 1)
    assert error[2].max() < 5e-5
    assert np.all(error[:2] > 8 * error[1:])


@pytest.mark.parametrize(("u", "grows"), [(5.3, False), (5.9, True)])
def test_cantilever_in_motion_below_and_above_the_critical_speed(u, grows):
    """A run with 8 elements, small push, BDF2 with omega dt = 0.1: growth rate and frequency of the spectral
    solution within 0.02 and 1 % (manual: verif-flutter-in-a-run).

    BDF2 reduces the frequency by (omega dt)^2/3 = 0.33 %. The motion decays at u = 5.3 and grows at 5.9
    (critical 5.591).
    """
    tube = Tube.of(0.2, 8)
    model = tube.at_rest({"flow_rate": flow_of(u)}, top="clamped", bottom="free")
    release(model)
    move_rigidly(model)
    x = model.mesh.node_depth / LENGTH
    speed, turning = np.zeros((2, model.mesh.nodes, 3))
    speed[:, 0], turning[:, 0] = 1e-3 * x**2, 2e-3 * x / LENGTH
    model.system.set_field("string.position", speed, "y")
    model.system.set_field("string.tangent", turning, "y")
    tip: list[tuple[float, float]] = []
    integrate(
        model.system,
        4.5 * tube.time,
        fixed(0.1 / 13.7 * tube.time),
        call=lambda t, dt: tip.append((t / tube.time, model.system.field("string.position")[-1, 0])),
    )
    t, y = np.array(tip).T
    peaks = [k for k in range(1, len(y) - 1) if (y[k] - y[k - 1]) * (y[k + 1] - y[k]) <= 0 and t[k] > 1.5]
    tops = []
    for k in peaks:
        a, b, c = np.polyfit(t[k - 1 : k + 2] - t[k], y[k - 1 : k + 2], 2)
        tops.append((t[k] - b / (2 * a), abs(c - b * b / (4 * a))))
    when, size = np.array(tops).T
    root = fastest_growing(conveying(u, 0.2))
    growth = float(np.polyfit(when, np.log(size), 1)[0])
    assert (growth > 0) == grows
    assert growth == pytest.approx(root.real, abs=0.02)
    assert np.pi / np.diff(when).mean() == pytest.approx(root.imag, rel=1e-2)


def test_modes_distinguish_stable_from_unstable():
    """Results of the `modes` command 0.2 % below and above the critical speeds: no growing mode, then one in
    each plane; and the eigenvalues."""
    for ends, beta, critical, kind in (
        (("pinned", "pinned"), 0.5, np.pi, "diverging"),
        (("clamped", "free"), 0.2, 5.5914, "fluttering"),
    ):
        tube = Tube.of(beta)
        for u, count in ((0.998 * critical, 0), (1.002 * critical, 2)):
            model = build_model(tube.case({"flow_rate": flow_of(u)}, top=ends[0], bottom=ends[1]))
            prepare_state(model)
            found = modes(model, 6, kind="lateral")
            assert (found.unstable, getattr(found, kind)) == (count, count)
            rates = oscillating(found.eigenvalue, 4)
            assert rates[::2] == pytest.approx(oscillating(roots_of(*across(model)), 2), rel=1e-5)


def test_the_spectral_solution_gives_known_beams():
    """The reference solution: cantilever 3.5160, pinned pi^2, clamped-clamped 22.3733, and a pinned beam with
    tension."""
    for ends, exact in (("cantilever", 3.5160153), ("pinned", np.pi**2), ("clamped", 22.3732854)):
        assert oscillating(spectral(ends), 1).imag == pytest.approx([exact], rel=1e-7)
    assert oscillating(spectral("pinned", (7.0,)), 1).imag == pytest.approx(
        [np.sqrt(np.pi**4 + 7 * np.pi**2)], rel=1e-9
    )
