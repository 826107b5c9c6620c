"""Modes of linearised models against closed forms, and the eigenvalue solver against polynomials (manual:
sec-verif-modes)."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import scipy.sparse as sparse
from scipy.optimize import brentq
from scipy.special import jn_zeros

from drillpetsc import Case
from drillpetsc.analysis.linear.modal import modes, prepare_state, run_modes
from drillpetsc.geometry.well import Well
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output import read_frame, read_table
from drillpetsc.output.job import Job
from drillpetsc.physics.contact import Contact, ContactLaw
from drillpetsc.physics.end_conditions import EndPlace, FixedEnd, TopDrive
from drillpetsc.solvers.linear.linearization import linearise
from drillpetsc.solvers.linear.quadratic_eigenproblem import (
    QuadraticEigenproblem,
    eigenvalues_near,
    lowest_eigenvalues,
)
from drillpetsc.time_function import Constant
from tests.helpers.flow_models import build
from tests.helpers.motion import straight
from tests.helpers.moving import straight_model
from tests.helpers.uniform_string import uniform_string
from tests.helpers.wells import newtonian

L, EA, EI, GJ, MASS, POLAR = 10.0, 2e7, 1.2e5, 9.4e4, 27.0, 0.09
BETA_CANTILEVER = [
    brentq(lambda b: np.cos(b) * np.cosh(b) + 1, *bracket, xtol=1e-14) for bracket in ((1, 3), (4, 6), (7, 9))
]


def rod(elements: int = 16, length: float = L, **more) -> dict:
    values = {
        "axial_stiffness": EA,
        "bending_stiffness": EI,
        "torsional_stiffness": GJ,
        "mass": MASS,
        "polar_inertia": POLAR,
    }
    return {"kind": "beam", "length": length, "element_length": length / elements, **values, **more}


def found(count: int = 20, engine: str = "auto", kind: str | None = None, **case):
    case = {"gravity": 0.0, "initial": {"imperfection": 0.0}, **case}
    model = build_model(Case(**case))
    prepare_state(model)
    return modes(model, count, kind=kind, engine=engine)


def rates(m, kind: str) -> np.ndarray:
    """Angular frequencies [rad/s] of the oscillating modes of a kind, ascending."""
    return 2 * np.pi * m.frequency[[k == kind and f > 0 for k, f in zip(m.kind, m.frequency, strict=True)]]


FT, LBF, INCH = 0.3048, 4.4482216152605, 0.0254


def test_torsion_of_pipe_and_collars():
    """5,000 ft of pipe, I_p 9.4e-4 ft4, and 120 ft of collars, 1.593e-2 ft4, top fixed: 2.424 and 7.936 rad/s, where
    tan(w L1/c) tan(w L2/c) = I1/I2 (J. E. Akin, MECH 517, example 137, Rice University: 2.41 and 7.93; manual:
    verif-modes-pipe-and-collars)."""
    shear, density = 1.728e9 * LBF / FT**2, 15.22 * LBF / FT**4  # lb/ft2, lb s2/ft4
    speed, (pipe, collars), ratio = np.sqrt(shear / density), (5000 * FT, 120 * FT), 9.4e-4 / 1.593e-2
    exact = [
        brentq(lambda w: np.tan(w * pipe / speed) * np.tan(w * collars / speed) - ratio, *bracket)
        for bracket in ((0.5, 3.3), (6.8, 9.9))
    ]
    assert exact == pytest.approx([2.424, 7.936], rel=2e-4)
    string = [
        rod(
            elements, length, torsional_stiffness=shear * polar * FT**4, polar_inertia=density * polar * FT**4
        )
        for elements, length, polar in ((40, pipe, 9.4e-4), (4, collars, 1.593e-2))
    ]
    m = found(4, kind="torsional", string=string, top="clamped")
    assert rates(m, "torsional")[:2] == pytest.approx(exact, rel=5e-4)
    assert rates(m, "torsional")[:2] == pytest.approx([2.424, 7.936], rel=2e-3)


def test_an_unstable_state_is_told_if_no_mode_of_the_list_grows(tmp_path: Path):
    """Pinned column under 3.9 buckling loads: one lateral mode grows in each plane, with w1 sqrt(2.9). Among its torsional
    modes none grows, which does not make the state stable."""
    load = 3.9 * np.pi**2 * EI / L**2
    top = {"kind": "top_drive", "rotation": 0.0, "hinged": True, "force": -load}
    case = Case(string=[rod()], gravity=0.0, initial={"imperfection": 0.0}, top=top, bottom="pinned")
    for kind, growing in (("torsional", 0), ("lateral", 2)):
        result = run_modes(Job(case, tmp_path / kind), 3, kind=kind, about="rest")
        assert not result.summary["stable"] and result.summary["negative_pivots"] == 2
        assert result.summary["unstable"] == growing
        assert any("growing modes are not among these" in line for line in result.lines) != bool(growing)
    rate = (np.pi / L) ** 2 * np.sqrt(EI / MASS) * np.sqrt(2.9)
    assert result.summary["margin"] == pytest.approx(rate, rel=1e-3)


def test_critical_speed_of_a_joint():
    """4.0 x 3.5 in, 32 ft between tool joints: 4.76e6/l^2 sqrt(D^2 + d^2) = 171.57 rpm (API RP 7G), the first lateral mode
    of a pinned pipe with 30e6 psi and 489.5 lb/ft3 within 0.1 %."""
    outer, inner, length = 4.0 * INCH, 3.5 * INCH, 32 * FT
    rule = 171.57 * np.pi / 30
    pipe = {"kind": "pipe", "length": length, "od": outer, "id": inner, "element_length": length / 12}
    steel = {"young": "30e6 psi", "poisson": 0.3, "density": "489.5 lb/ft3"}
    m = found(2, string=[pipe], top="pinned", bottom="pinned", material=steel)
    assert rates(m, "lateral")[0] == pytest.approx(rule, rel=1e-3)


# ---------------------------------------------------------------------- rods
@pytest.mark.parametrize("engine", ["dense", "arpack"])
def test_clamped_free_rod(engine):
    """(beta/L)^2 sqrt(EI/m), cos beta cosh beta = -1; (2k - 1) pi/2L sqrt(EA/m) and sqrt(GJ/J) (Blevins,
    Formulas for Natural Frequency, tables 8-1, 8-16, 8-19); every lateral one twice, none damped (manual:
    verif-modes-cantilever)."""
    m = found(24, engine, string=[rod()], top="clamped")
    lateral, odd = rates(m, "lateral"), np.array([1, 3, 5]) * np.pi / 2 / L
    assert lateral[:6] == pytest.approx(
        np.repeat((np.array(BETA_CANTILEVER) / L) ** 2 * np.sqrt(EI / MASS), 2), rel=1e-4
    )
    assert rates(m, "axial")[:1] == pytest.approx(odd[:1] * np.sqrt(EA / MASS), rel=1e-6)
    assert rates(m, "torsional")[:2] == pytest.approx(odd[:2] * np.sqrt(GJ / POLAR), rel=1e-4)
    assert np.all(np.diff(m.frequency) >= 0) and m.count >= 24
    assert m.unstable == m.zeros == 0 and abs(m.margin) < 1e-9
    assert m.smallest == pytest.approx(lateral[0], rel=1e-12)


def test_pinned_pinned_rod():
    """(k pi/L)^2 sqrt(EI/m) in both planes; the ends are axially fixed, too: k pi/L sqrt(EA/m) (manual:
    verif-modes-pinned)."""
    m = found(10, string=[rod()], top="pinned", bottom="pinned")
    waves = np.arange(1, 4) * np.pi / L
    assert rates(m, "lateral")[:6] == pytest.approx(np.repeat(waves**2 * np.sqrt(EI / MASS), 2), rel=2e-4)
    axial = found(3, kind="axial", string=[rod()], top="pinned", bottom="pinned")
    assert set(axial.kind) == {"axial"}
    assert rates(axial, "axial") == pytest.approx(waves * np.sqrt(EA / MASS), rel=1e-5)


def test_shapes_of_the_cantilever():
    """Lowest shapes: cosh x - cos x - s (sinh x - sin x), x = beta z/L, and sin(pi z/2L) for stretch, largest
    value 1, and real."""
    m = found(20, string=[rod()], top="clamped")
    z, b = np.linspace(0, 1, 17), BETA_CANTILEVER[0]
    s = (np.cosh(b) + np.cos(b)) / (np.sinh(b) + np.sin(b))
    bent = np.cosh(b * z) - np.cos(b * z) - s * (np.sinh(b * z) - np.sin(b * z))
    position = m.shapes["string.position"]
    side = position[0][:, :2] @ (position[0][-1, :2].conj() / np.linalg.norm(position[0][-1, :2]))
    assert np.abs(side) / np.abs(side).max() == pytest.approx(bent / bent.max(), abs=1e-5)
    along = position[m.kind.index("axial")]
    assert along[:, 2].real == pytest.approx(np.sign(along[-1, 2].real) * np.sin(np.pi * z / 2), abs=1e-6)
    assert np.abs(position[0]).max() == pytest.approx(1.0) and np.abs(along[:, 2].imag).max() < 1e-6


def test_hung_string():
    """String almost without stiffness hung by one end, both planes: j0n/2 sqrt(g/L) (Bernoulli's chain;
    manual: verif-modes-hung).

    L 100 m, 40 kg/m, EI 100 N m2. The effect of EI, of the order of EI k^2/T with k = 2 omega/sqrt(g L) in
    the middle, is below 2e-4 for three modes.
    """
    string = rod(40, 100.0, bending_stiffness=100.0, mass=40.0, axial_stiffness=7e8)
    m = found(8, string=[string], top="pinned", gravity=9.81)
    expected = jn_zeros(0, 3) / 2 * np.sqrt(9.81 / 100)
    assert rates(m, "lateral")[:6] == pytest.approx(np.repeat(expected, 2), rel=2e-4)
    assert m.unstable == 0


@pytest.mark.parametrize(
    "kind, stiffness, inertia", [("axial", EA, MASS), ("torsional", GJ, POLAR), ("lateral", EI, MASS)]
)
def test_stiffness_damping(kind, stiffness, inertia):
    """sigma = E (eps + beta eps'): damping ratio beta omega/2 of every mode, omega its undamped rate |s|
    (manual: verif-modes-damping)."""
    beta = 2e-4
    m = found(2, kind=kind, string=[rod(damping={"stiffness": beta})], top="clamped")
    factors = (
        (np.array(BETA_CANTILEVER[:1]) / L) ** 2 if kind == "lateral" else np.array([1, 3]) * np.pi / 2 / L
    )
    omega = (np.repeat(factors, 2) if kind == "lateral" else factors) * np.sqrt(stiffness / inertia)
    swings = m.frequency > 0  # modes above 2/beta do not
    assert np.abs(m.eigenvalue[swings]) == pytest.approx(omega, rel=1e-4)
    assert m.damping_ratio[swings] == pytest.approx(beta * omega / 2, rel=1e-4)
    assert m.growth[swings] == pytest.approx(-beta * omega**2 / 2, rel=2e-4)


def test_overdamped_and_slow_roots():
    """Mass damping alpha: s^2 + alpha s + omega^2 = 0 for each mode. For alpha between 2 omega_1 and 2
    omega_2 the first mode has two real eigenvalues, the others oscillate (manual: verif-modes-damping)."""
    omega = (np.array(BETA_CANTILEVER) / L) ** 2 * np.sqrt(EI / MASS)
    alpha = omega[0] + omega[1]
    m = found(8, string=[rod(damping={"mass": float(alpha)})], top="clamped")
    slow = -alpha / 2 + np.sqrt(alpha**2 / 4 - omega[0] ** 2)
    assert m.eigenvalue[:2] == pytest.approx([slow, slow], rel=1e-4)
    assert m.damping_ratio[:2] == pytest.approx([1.0, 1.0])
    swinging = m.eigenvalue[m.frequency > 0][:2]
    assert swinging == pytest.approx(
        np.repeat(-alpha / 2 + 1j * np.sqrt(omega[1] ** 2 - alpha**2 / 4), 2), rel=3e-4
    )
    assert m.margin == pytest.approx(slow, rel=1e-4) and m.unstable == 0


def test_torsion_with_the_inertia_of_the_bit():
    """2000 m of drill pipe, top fixed, 300 kg m2 at the bit: x tan x = J_pipe/J_bit; f1 .180895, f2 .840968
    Hz (manual: verif-torsion-modes). There are about a hundred lateral modes in between."""
    string = [
        {"kind": "pipe", "length": 2000.0, "od": 0.127, "id": 0.1086, "element_length": 20.0},
        {"kind": "body", "mass": 100.0, "inertia": {"axial": 300.0, "transverse": 300.0}},
    ]
    m = found(2, kind="torsional", string=string, top="clamped", gravity=9.81)
    assert m.frequency[:2] == pytest.approx([0.180895, 0.840968], rel=1e-3)
    model = build_model(Case(string=string, top="clamped", gravity=9.81))
    prepare_state(model)
    near = modes(model, 3, shift=0.181)
    assert near.frequency[near.kind.index("torsional")] == pytest.approx(m.frequency[0], rel=1e-9)


# ---------------------------------------------------------------------- stability
def column(share: float):
    """A cantilever under an axial dead load, as a fraction of Euler's pi^2 EI/4 L^2, kept straight."""
    load = share * np.pi**2 * EI / (4 * L**2)
    return found(
        6, string=[rod(axial_stiffness=1e9)], top="clamped", bottom={"kind": "force", "force": [0, 0, -load]}
    )


def test_divergence_beyond_the_load_of_euler():
    """Stable at 0.99, two diverging modes (two planes) at 1.01; the square of the lowest eigenvalue is zero
    at Euler's load (manual: verif-modes-divergence)."""
    below, above = column(0.99), column(1.01)
    assert below.unstable == 0 and below.diverging == 0
    assert (above.unstable, above.diverging, above.fluttering) == (2, 2, 0)
    assert above.margin > 0 and above.growth[:2] == pytest.approx([above.margin] * 2, rel=1e-6)
    square = below.eigenvalue[0].imag ** 2, above.margin**2
    assert 0.99 + 0.02 * square[0] / (square[0] + square[1]) == pytest.approx(1.0, abs=2e-4)


def test_an_unconstrained_motion_has_a_zero_eigenvalue():
    """A string driven through a damper alone is in equilibrium at any angle: one eigenvalue is zero, none
    grows."""
    m = modes(straight(string=[rod()], top={"kind": "driven", "damping": 500.0}, gravity=0.0), 6)
    assert (m.zeros, m.unstable) == (1, 0)
    assert m.kind[int(np.abs(m.eigenvalue).argmin())] == "torsional"


# ---------------------------------------------------------------------- spinning, contact
class Hinge(TopDrive):
    """A top that rotates with free direction."""

    def __init__(self, position, tangent, speed):
        super().__init__(EndPlace(position, tangent), Constant(speed), Constant(0.0))
        c, keep = self._condition, [0, 1, 2, 5]
        self._condition = replace(
            c,
            directions=c.directions[keep],
            value=lambda t: c.value(t)[keep],
            rate=lambda t: c.rate(t)[keep],
            names=tuple(c.names[i] for i in keep),
        )


def whirl(n: int, speed: float, polar: float) -> np.ndarray:
    """Lowest six rates [rad/s] of a hinged shaft that spins."""
    mesh = uniform_string(
        L,
        n,
        axial_stiffness=EA,
        bending_stiffness=EI,
        torsional_stiffness=1e7,
        mass=MASS,
        polar_inertia=polar,
    )
    system = straight_model(
        mesh,
        [
            lambda f, p, t: Hinge(p[0], t[0], speed),
            lambda f, p, t: FixedEnd(EndPlace(p[-1], t[-1], n), "pinned", spin=False),
        ],
    )
    system.set_field("string.spin", np.full((n + 1, 1), speed), "y")
    s = lowest_eigenvalues(linearise(system).eigenproblem(10.0), 6).s
    assert np.abs(s.real).max() < 1e-9
    return s.imag[s.imag > 0][:6]


def test_gyroscopic_splitting_of_a_spinning_shaft():
    """Pinned shaft with polar inertia J at Omega, without inertia of tilting: forward whirl above, backward
    whirl below the rate at rest (rotor dynamics, e.g. Genta, Dynamics of Rotating Systems, ch. 4; manual:
    verif-modes-gyroscopic).

    With w = x + iy of wave number k, mu w'' - i J Omega k^2 w' + EI k^4 w = 0, so the rates solve mu q^2 -+ J
    Omega k^2 q - EI k^4 = 0. The spin momentum is lumped at the nodes: second order.
    """
    speed, polar, expected = 300.0, 2.0, []
    for k in np.arange(1, 4) * np.pi / L:
        half = polar * speed * k**2 / (2 * MASS)
        expected += [np.hypot(half, np.sqrt(EI / MASS) * k**2) + sign * half for sign in (-1, 1)]
    errors = [np.abs(whirl(n, speed, polar) / np.sort(expected) - 1).max() for n in (16, 32)]
    assert errors[1] < 5e-4
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)


def test_pipe_lying_in_a_hole():
    """A rigid piece at rest on the wall without friction: it bounces at sqrt(k/mu) on the contact stiffness
    per length and swings along the wall at sqrt(g/d), d the distance of its axis from the hole's (manual:
    verif-modes-contact). The opposite wall has no influence."""
    g, mass, stiffness, clearance = 9.81, 25.0, 1e6, 0.002
    mesh = uniform_string(
        1.0,
        1,
        axial_stiffness=1e9,
        bending_stiffness=1e8,
        torsional_stiffness=1e8,
        mass=mass,
        polar_inertia=0.1,
        outer_diameter=0.2,
    )
    hole = Well.from_survey(np.array([0.0, 50.0]), np.zeros(2), np.zeros(2), [50.0], [0.1 + clearance], [0.0])
    law = ContactLaw(stiffness=stiffness, restitution=1.0)
    system = straight_model(mesh, [lambda f, p, t: Contact(mesh, hole, law)], gravity=(g, 0.0, 0.0))
    depth = clearance + mass * g / stiffness
    system.set_field("string.position", np.array([[depth, 0.0, z] for z in (0.0, 1.0)]))
    rows = system.new_condensed()
    system.sum_residual(0.0, rows)
    assert np.abs(rows.getArray()).max() < 1e-6 * mass * g
    s = eigenvalues_near(linearise(system).eigenproblem(10.0), 20.0, 8, "dense").s.imag
    for expected in (np.sqrt(g / depth), np.sqrt(stiffness / mass)):
        assert np.abs(s - expected).min() < 1e-3 * expected


def test_linearised_rows_are_those_of_the_residual():
    """String, bore, annulus and bit in a random state that spins and slides: central differences of the
    residual along x + u e^(st), with consistent rates, against (K + s C + s^2 M) u, for three rates s and
    random u (manual: verif-modes-linearisation)."""
    system = build("pipe_annulus_bit_junction_topdrive")
    asm, layout = system.assembly, system.layout
    asm.y[layout.dofs["string.tangent"]] = 0.0
    asm.a[:] = 0.0
    system = linearise(system)
    x, y, n = asm.x.copy(), asm.y.copy(), layout.size
    numbers = layout.condensed_dm.getLGMap().getIndices()
    rng = np.random.default_rng(3)

    def spin_rate(position: np.ndarray, rate: np.ndarray) -> np.ndarray:
        asm.x[:-1], asm.y[:-1] = position, rate
        return asm.transport()

    def rows(size: float, u: np.ndarray, s: float) -> np.ndarray:
        """Residual on the path x(t) + size u e^(st), spin rates y + d(phi)/dt + c(v).v', at t = 0."""
        still = y[:-1].copy()
        spin = asm.spin_at[:, 0]

        def rate(t: float) -> np.ndarray:
            move = size * u * np.exp(s * t)
            out = still + s * move
            out[spin] += spin_rate(x[:-1] + move, s * move)
            return out

        h = 1e-4
        a = (rate(h) - rate(-h)) / (2 * h)
        asm.y[:-1], asm.a[:-1] = rate(0.0), np.where(layout.y_local >= 0, a, 0.0)
        asm.x[:-1] = x[:-1] + size * u
        return asm.residual(0.0)[:-1].copy()

    T = system.T.toarray()[numbers]
    for s in (0.0, 1.3, -2.1):
        q = rng.standard_normal(T.shape[1])
        u, e = T @ q, 1e-5
        measured = T.T @ ((rows(e, u, s) - rows(-e, u, s)) / (2 * e))
        K, C, M = (A for A in (system.K, system.C, system.M))
        expected = system.T.T @ ((K + s * C + s**2 * M) @ (system.T @ q))
        assert measured == pytest.approx(expected, rel=1e-5, abs=1e-6 * np.abs(expected).max())
    assert n == len(system.field)


# ---------------------------------------------------------------------- fluid
OD, ID, DENSITY = 0.127, 0.1086, 1200.0
BORE = np.pi / 4 * ID**2


def conveying(flow: float, length: float, elements: int, bulk_modulus: float, **case) -> dict:
    """A pipe with an inviscid fluid in rigid walls, without annulus; flow [m3/s]."""
    fluid = newtonian(DENSITY, 0.0, bulk_modulus=bulk_modulus, flow_rate=flow, elastic_walls=False)
    pipe = {"kind": "pipe", "length": length, "od": OD, "id": ID, "element_length": length / elements}
    return {"string": [pipe], "material": {"young": 206e9, "poisson": 0.0}, "fluid": fluid, **case}


def test_sound_in_a_held_bore():
    """First-order unknowns only, closed at the pump, open below: odd quarter waves (2k - 1) a/4L, a =
    sqrt(K/rho), L with the correction 0.61 of the bore radius for the open end (Levine and Schwinger 1948);
    40 elements, second order (manual: verif-modes-sound)."""
    m = found(3, **conveying(0.0, 200.0, 40, 2e9, hold_string=True))
    swinging = m.frequency[m.frequency > 0][:3]
    wave = np.sqrt(2e9 / DENSITY) / (4 * (200.0 + 0.61 * ID / 2))
    assert swinging[0] == pytest.approx(wave, rel=2e-4)
    assert swinging == pytest.approx(wave * np.array([1, 3, 5]), rel=4e-3)
    assert set(m.kind) == {"fluid"} and m.unstable == 0


def test_pipe_conveying_fluid_diverges_at_pi():
    """Pinned ends: stable below, diverging in both planes above u = U L sqrt(m_f/EI) = pi (Paidoussis,
    Fluid-Structure Interactions 1, ch. 3), where the square of the lowest eigenvalue is zero (manual:
    verif-pipe-divergence)."""
    length, stiffness = 20.0, 206e9 * np.pi / 64 * (OD**4 - ID**4)
    ends = {"top": "pinned", "bottom": "pinned"}
    one = np.sqrt(stiffness / (DENSITY * BORE)) / length * BORE  # flow rate at u = 1
    below, above = (found(4, **conveying(u * one, length, 12, 1e14, **ends)) for u in (3.12, 3.16))
    assert below.unstable == 0 and (above.diverging, above.fluttering) == (2, 0)
    square = np.abs(below.eigenvalue[0]) ** 2, above.margin**2
    assert 3.12 + 0.04 * square[0] / (square[0] + square[1]) == pytest.approx(np.pi, rel=1e-3)


# ---------------------------------------------------------------------- eigenvalue solver
def dae(copies: int, seed: int = 4) -> tuple[QuadraticEigenproblem, np.ndarray]:
    """``copies`` systems of an oscillator, driven by the lagged state of a first-order unknown, and an
    algebraic unknown, all mixed: m x'' + d x' + k x - b p = 0, tau p' + p + c x' = 0, q - x = 0: (m s^2 + d s
    + k)(tau s + 1) + b c s = 0."""
    rng, blocks, roots = np.random.default_rng(seed), [], []
    for m, d, k, tau, b, c in (
        (1.0, 0.1, 4.0, 0.5, 1.0, 0.3),
        (2.0, 0.0, 90.0, 0.1, 3.0, -0.2),
        (1.0, 0.3, -2.0, 2.0, 0.5, 1.0),
        (1.5, 0.0, 900.0, 0.05, 1.0, 1.0),
        (1.0, 9.0, 4.0, 1.0, 0.2, 0.2),
    ):
        for _ in range(copies):
            blocks.append(
                ([[k, -b, 0], [0, 1, 0], [-1, 0, 1]], [[d, 0, 0], [c, tau, 0], [0, 0, 0]], np.diag([m, 0, 0]))
            )
            roots.append(np.roots([m * tau, m + d * tau, k * tau + d + b * c, k]))
    K, C, M = (sparse.block_diag(part).toarray() for part in zip(*blocks, strict=True))
    n, second = len(K), np.tile([True, False, False], len(blocks))
    left, right = rng.standard_normal((n, n)), np.eye(n)
    for group in (second, ~second):  # unknowns of one order are mixed among themselves
        right[np.ix_(group, group)] = rng.standard_normal((group.sum(), group.sum()))
    A = [sparse.csr_matrix(left @ part @ right) for part in (K, C, M)]
    A[2] = A[2] @ sparse.diags(second.astype(float))
    return QuadraticEigenproblem(*A, second, np.ones(n), 1.0), np.concatenate(roots)


@pytest.mark.parametrize("engine", ["dense", "arpack"])
@pytest.mark.parametrize("copies", [1, 6])
def test_roots_of_an_algebraic_differential_system(engine, copies):
    """All finite eigenvalues with their multiplicities, no infinite one; growing ones are reported (manual:
    verif-eigenvalue-solver)."""
    problem, exact = dae(copies)
    exact = exact[exact.imag >= 0]
    exact = exact[np.argsort(np.abs(exact - 0.87))]
    some = len(exact) if engine == "dense" else 4 * copies
    got = eigenvalues_near(problem, 0.87, 2 * some if engine == "dense" else 6 * copies, engine)
    got = got.subset(np.argsort(np.abs(got.s - 0.87)))
    assert len(got.s) >= some if engine == "arpack" else len(got.s) == len(exact)
    for root in got.s:
        assert np.sum(np.abs(got.s - root) < 1e-5 * abs(root)) == np.sum(
            np.abs(exact - root) < 1e-5 * abs(root)
        )
    assert np.sort_complex(got.s) == pytest.approx(np.sort_complex(exact[: len(got.s)]), rel=1e-6)
    assert got.grows.sum() == np.sum(exact[: len(got.s)].real > 0) > 0
    residual = problem.K @ got.u + got.s * (problem.C @ got.u) + got.s**2 * (problem.M @ got.u)
    assert np.abs(residual).max() < 1e-8 * abs(problem.K).max() * np.abs(got.u).max()


def test_oscillators_beyond_many_slow_roots_are_found():
    """300 relaxations at -0.01 to -3 1/s lie between zero and the oscillators i k (k = 5, 5, 6, ... 44): the
    ten lowest oscillators are found in order, the double one twice."""
    slow = np.linspace(0.01, 3.0, 300)
    swing = np.concatenate([[5.0], np.arange(5.0, 45.0)])
    n = len(slow) + len(swing)
    second = np.arange(n) >= len(slow)
    K, C, M = (
        sparse.csr_matrix(sparse.diags(d.astype(float)))
        for d in (np.concatenate([slow, swing**2]), ~second, second)
    )
    problem = QuadraticEigenproblem(K, C, M, second, np.ones(n), 0.1)
    roots = lowest_eigenvalues(problem, 10, "arpack")
    assert roots.s[roots.s.imag > 0] == pytest.approx(1j * swing[:10], rel=1e-9)
    assert roots.s[roots.s.imag == 0].real == pytest.approx(-slow[:2], rel=1e-9)


# ---------------------------------------------------------------------- files
def test_files_of_a_run(tmp_path: Path):
    """modes.csv, summary.json and the shapes of a cantilever against closed forms."""
    run_modes(Job(Case(string=[rod()], top="clamped", gravity=0.0), tmp_path / "run"), count=4)
    table = read_table(tmp_path / "run" / "modes.csv")
    expected = np.repeat((np.array(BETA_CANTILEVER[:2]) / L) ** 2 * np.sqrt(EI / MASS) / (2 * np.pi), 2)
    assert table["frequency [Hz]"] == pytest.approx(expected, rel=1e-4)
    assert table["speed [rpm]"] == pytest.approx(60 * expected, rel=1e-4)
    assert list(table["kind [-]"]) == ["lateral"] * 4
    summary = json.loads((tmp_path / "run" / "summary.json").read_text())
    assert summary["stable"] and summary["unstable"] == 0
    assert summary["smallest_eigenvalue"] == pytest.approx(2 * np.pi * expected[0], rel=1e-4)
    frame = read_frame(tmp_path / "run" / "modes" / "mode_01.vtu")
    assert len(list((tmp_path / "run" / "modes").iterdir())) == 4
    assert frame.points[:, 2] == pytest.approx(np.linspace(0, L, 17), abs=1e-9)
    shape = np.hypot(frame.point_data["displacement [m]"], frame.point_data["displacement_imaginary [m]"])
    assert shape.max() == pytest.approx(1.0) and shape[0].max() < 1e-12


def test_no_mode_is_missed_between_the_discs_of_a_search():
    """Of 450 oscillators whose frequencies are the cube roots of 1, 2, 3 .. every tenth counts: the higher, the smaller are the discs of
    a search up to the first five."""
    n = 450
    problem = QuadraticEigenproblem(
        sparse.csr_matrix(sparse.diags(np.arange(1.0, n + 1) ** (2 / 3))),
        sparse.csr_matrix(1e-6 * sparse.eye(n)),
        sparse.csr_matrix(sparse.eye(n)),
        np.ones(n, dtype=bool),
        np.ones(n),
        1.0,
    )
    found = lowest_eigenvalues(problem, 5, "arpack", lambda q: np.round(q.s.imag**3) % 10 == 0)
    assert found.s.imag[found.s.imag > 1] ** 3 == pytest.approx([10, 20, 30, 40, 50], rel=1e-6)
