"""The string element in statics against closed forms and independent solutions, without hole (manual:
sec-verif-string).

Orders and limits of the error as in the manual; roll-up and elastica are of fourth order in the
element length (manual: verif-roll-up, verif-elastica), frequencies as tabulated (manual:
verif-static-frequencies).
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import eigh
from scipy.optimize import brentq, fsolve

from drillpetsc import Case
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.analysis.statics.placement import place_along_hole
from drillpetsc.analysis.statics.relaxation import come_to_rest
from drillpetsc.model.drilling_model import build_model
from drillpetsc.solvers.static.static_newton import Equilibrium, StaticNewton

HORIZONTAL = {"inclination": np.pi / 2}
RISE = {"time": [0.0, 1.0], "value": [0.0, 1.0]}


def rod(length, elements, axial, bending, torsional, **more):
    """A beam item of unit mass."""
    return {
        "kind": "beam",
        "length": length,
        "axial_stiffness": axial,
        "bending_stiffness": bending,
        "torsional_stiffness": torsional,
        "mass": 1.0,
        "polar_inertia": 1.0,
        "element_length": length / elements,
        **more,
    }


def cantilever(item, loads, **more):
    case = Case(
        string=[item], top="clamped", bottom="free", gravity=0.0, initial=HORIZONTAL, loads=loads, **more
    )
    model = build_model(case)
    place_along_hole(model)
    return model


def load_in_steps(model, steps: int) -> Equilibrium:
    """Apply loads in ``steps`` equal steps (their factor over time is t), with updates of the reference
    frames in between."""
    solver, report = StaticNewton(model.system), Equilibrium()
    for k in range(1, steps + 1):
        solver.t = k / steps
        come_to_rest(model, solver, report)
        model.system.renew_reference_frames()
    return report


# ---------------------------------------------------------------------- bending
def rolled_up(elements: int, axial: float) -> tuple[float, int]:
    """Gap of a cantilever of length 1, EI 1, bent by an end moment 2 pi EI/L; Newton iterations of ten load
    steps."""
    model = cantilever(
        rod(1.0, elements, axial, 1.0, 1.0), [{"at": 1.0, "moment": [0, 0, 2 * np.pi], "value_over": RISE}]
    )
    report = load_in_steps(model, 10)
    return float(np.linalg.norm(model.system.field("string.position")[-1])), report.iterations


def test_end_moment_rolls_the_rod_into_a_circle():
    """Exact: a closed circle (kappa = M/EI = 2 pi/L). Error 2.9e-2, 1.6e-3, 9.7e-5 for 4, 8, 16 elements at
    EA L2/EI 1e4 (order 4; manual: verif-roll-up)."""
    gaps, work = zip(*(rolled_up(n, 1e4) for n in (4, 8, 16)), strict=True)
    assert gaps == pytest.approx((2.9e-2, 1.6e-3, 9.7e-5), rel=0.1)
    assert np.log2(gaps[1] / gaps[2]) > 3.9
    assert max(work) <= 80


@pytest.mark.parametrize("axial", [1e6, 1e8])
def test_roll_up_does_not_lock(axial):
    """At EA L2/EI 1e6 the error is 1.7e-3 with 8 elements and 1.0e-4 with 16; a hundred times larger EA has
    no effect (manual: verif-no-locking)."""
    assert rolled_up(8, axial)[0] == pytest.approx(1.7e-3, rel=0.1)
    assert rolled_up(16, axial)[0] == pytest.approx(1.0e-4, rel=0.1)


def test_reference_update_changes_nothing_physical():
    """Energies, residual and reactions of a bent, twisted, undamped string with a stress-free curvature,
    before and after an update of the reference frames (manual: verif-reference-update)."""
    loads = [
        {
            "at": 1.0,
            "moment": [1.0, 0.3, 0.2],
            "force": [0.1, 0.2, 0.2],
            "frame": "section",
            "value_over": RISE,
        }
    ]
    model = cantilever(rod(1.0, 8, 1e4, 1.0, 0.8, curvature=2.6, curvature_angle=0.4), loads)
    solver = StaticNewton(model.system)
    for k in range(1, 9):
        solver.t = k / 8
        come_to_rest(model, solver, Equilibrium())
    system = model.system
    rng = np.random.default_rng(2)
    system.assembly.x[:-1] += 1e-3 * rng.standard_normal(system.layout.size)

    def figures():
        return solver.rows(), np.array(system.energies(1.0)), system.reaction("top.torque_reaction")

    before = figures()
    old = model.frames.reference.copy()
    assert system.renew_reference_frames()
    assert not system.renew_reference_frames()
    assert np.abs(model.frames.reference - old).max() > 1.0
    assert np.abs(model.frames.twist0).max() > 1e-3
    after = figures()
    for a, b in zip(before, after, strict=True):
        assert np.abs(a - b).max() < 1e-11 * np.abs(a).max()


def elastica_tip(load: float, axial: float) -> np.ndarray:
    """(x, y) of the tip of a horizontal cantilever, L = EI = 1, dead tip force ``load`` in +y, by shooting.

    Plane extensible rod: theta' = m (moment over EI), m' = -(x' Fy - y' Fx), stretch 1 + N/EA with N = F.t;
    unknown m(0), m(1) = 0.
    """

    def rates(s, q):
        x, y, theta, m = q
        stretch = 1 + load * np.sin(theta) / axial
        return [stretch * np.cos(theta), stretch * np.sin(theta), m, -stretch * np.cos(theta) * load]

    def end(m0):
        return solve_ivp(rates, (0, 1), [0, 0, 0, m0], method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]

    m0 = brentq(lambda m: end(m)[3], 0.1, load, xtol=1e-13)
    return end(m0)[:2]


@pytest.mark.parametrize("axial", [1e4, 1e6])
def test_elastica_is_fourth_order_for_any_axial_stiffness(axial):
    """P L2/EI = 10: tip errors 8.2e-4, 5.2e-5, 3.2e-6 with 4, 8, 16 elements, against a shooting solution
    (manual: verif-elastica)."""
    exact, errors = elastica_tip(10.0, axial), []
    for n in (4, 8, 16):
        model = cantilever(
            rod(1.0, n, axial, 1.0, 1.0), [{"at": 1.0, "force": [0, 10.0, 0], "value_over": RISE}]
        )
        load_in_steps(model, 4)
        errors.append(np.linalg.norm(model.system.field("string.position")[-1, :2] - exact))
    assert errors == pytest.approx([8.2e-4, 5.2e-5, 3.2e-6], rel=0.15)


def leaning_column(load: float, moment: float) -> np.ndarray:
    """(x, y) of the tip of a clamped column, L = EI = 1, under a dead ``load`` towards its foot and an end ``moment``, by shooting.

    theta'' = -P sin(theta), theta(0) = 0, theta'(1) = M; the solution of largest curvature at the foot is that of a
    column that has buckled.
    """

    def end(m0):
        def rates(s, q):
            return [np.cos(q[2]), np.sin(q[2]), q[3], -load * np.sin(q[2])]

        return solve_ivp(rates, (0, 1), [0, 0, 0, m0], method="DOP853", rtol=1e-11, atol=1e-12).y[:, -1]

    m0 = np.linspace(0.3, 2 * np.sqrt(load) - 0.01, 200)
    miss = np.array([end(m)[3] - moment for m in m0])
    last = int(np.flatnonzero(miss[:-1] * miss[1:] < 0)[-1])
    return end(brentq(lambda m: end(m)[3] - moment, m0[last], m0[last + 1]))[:2]


@pytest.mark.parametrize("share", [1.1, 1.5, 2.0])
def test_a_free_column_beyond_its_buckling_load_leans(share):
    """Clamped at one end, an end moment on the free one: the stable elastica by shooting.  It was returned straight and unstable."""
    load, moment = share * np.pi**2 / 4, 0.01
    loads = [{"at": 1.0, "force": [0, 0, -load]}, {"at": 1.0, "moment": [moment, 0, 0]}]
    case = Case(string=[rod(1.0, 16, 1e6, 1.0, 1.0)], top="clamped", bottom="free", gravity=0.0, loads=loads)
    model = build_model(case)
    state = find_equilibrium(model)
    assert state.stable and state.equilibrium.negative_pivots == 0
    tip = model.system.field("string.position")[-1]
    assert [tip[2], -tip[1]] == pytest.approx(leaning_column(load, moment), abs=1e-3)


# ---------------------------------------------------------------------- bend of 45 degrees
RADIUS, BEND_LENGTH, BEND_EA, BEND_EI = 100.0, 100 * np.pi / 4, 1e7, 1e7 / 12
BEND_GJ = 1e7 / 2 / 6  # nu 0, square section 1x1 with J = 1/6 as in the publications


def bend_reference(load: float) -> np.ndarray:
    """Tip of the 45 degree bend by shooting the rod equations: r' = (1 + N/EA) t, d_i' = kappa x d_i, M' =
    -r' x F, kappa = M.t/GJ t + (M - M.t t)/EI + d2/R; clamped along x, stress-free curvature about d2
    (pointing to -z)."""
    force = np.array([0.0, 0.0, load])

    def rates(s, q):
        t, d2, d3, moment = q[3:6], q[6:9], q[9:12], q[12:]
        kappa = (
            (moment @ t) / BEND_GJ * t
            + (moment @ d2) / BEND_EI * d2
            + (moment @ d3) / BEND_EI * d3
            + d2 / RADIUS
        )
        tangent = (1 + force @ t / BEND_EA) * t
        return np.concatenate(
            [tangent, np.cross(kappa, t), np.cross(kappa, d2), np.cross(kappa, d3), -np.cross(tangent, force)]
        )

    def end(m0):
        start = np.concatenate([[0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 1, 0], m0])
        return solve_ivp(rates, (0, BEND_LENGTH), start, method="DOP853", rtol=1e-11, atol=1e-9).y[:, -1]

    m0 = np.zeros(3)
    for step in np.linspace(0.2, 1, 5):
        force = np.array([0.0, 0.0, step * load])
        m0 = fsolve(lambda m: end(m)[12:] / load, m0, xtol=1e-12)
    return end(m0)[:3]


PUBLISHED = {300.0: (22.33, 58.84, 40.08), 450.0: (18.62, 52.32, 48.39), 600.0: (15.79, 47.23, 53.37)}


@pytest.mark.parametrize("load", PUBLISHED)
def test_bend_of_45_degrees(load):
    """Bathe and Bolourchi 1979; values of Simo and Vu-Quoc 1986 with 8 elements, here within 0.15 of the
    length 78.5; the shooting solution within 4e-4 of the length, because interpolated directors are of second
    order (manual: verif-bend-45)."""
    model = cantilever(
        rod(BEND_LENGTH, 8, BEND_EA, BEND_EI, BEND_GJ, curvature=1 / RADIUS, curvature_angle=-np.pi / 2),
        [{"at": BEND_LENGTH, "force": [0, 0, load], "value_over": RISE}],
    )
    come_to_rest(model, StaticNewton(model.system), Equilibrium())  # no load: the rod takes its curved shape
    arc = RADIUS * np.array([np.sin(np.pi / 4), np.cos(np.pi / 4) - 1, 0])
    assert np.abs(model.system.field("string.position")[-1] - arc).max() < 0.03
    load_in_steps(model, 2)
    tip = model.system.field("string.position")[-1]
    published = np.array(PUBLISHED[load])
    assert np.abs([-tip[1], tip[0], tip[2]] - published).max() < 0.15
    assert np.linalg.norm(tip - bend_reference(load)) < 4e-4 * BEND_LENGTH


# ---------------------------------------------------------------------- torsion
@pytest.mark.parametrize(("elements", "limit"), [(4, 3.1e-2), (8, 2.3e-3), (16, 1.5e-4)])
def test_clamped_rod_buckles_under_twist(elements, limit):
    """Exact M L/EI = 8.98682 (tan(x/2) = x/2, the clamped rod of Greenhill's problem); errors 3.0 %, 0.22 %,
    1.4e-4 (manual: verif-greenhill)."""
    length, bending, torsional = 2.0, 3.0, 2.5
    case = Case(
        string=[rod(length, elements, 1e5, bending, torsional)],
        top={"kind": "top_drive", "rotation": 1.0},
        bottom="clamped",
        gravity=0.0,
    )
    model = build_model(case)
    place_along_hole(model)
    solver, depth = StaticNewton(model.system), model.mesh.node_depth

    def count(moment):
        angle = moment * length / torsional
        model.system.set_field(
            "string.spin", angle * (1 - depth / length)[:, None]
        )  # straight and evenly twisted: an exact equilibrium
        solver.t = angle
        return solver.negative_pivots()

    low, high = 0.5 * 8.98682 * bending / length, 1.5 * 8.98682 * bending / length
    assert count(low) == 0 and count(high) > 0
    while high - low > 1e-7 * high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if count(middle) == 0 else (low, middle)
    error = low * length / bending / 8.98682 - 1
    assert abs(error) < limit
    assert abs(error) > limit / 10  # the order is what it is


def test_ten_turns_of_torsion_in_one_step():
    """Twist M L/GJ = 20 pi over 20 elements: pi per element without branch; linear, so one Newton step (and
    one to detect convergence; manual: verif-ten-turns).

    The moment of 0.5 MN m is below that of Greenhill, pi EI/L at the least, so that the straight rod is stable."""
    case = Case(
        string=[rod(100.0, 20, 1e8, 1e8, 8e5)],
        top="clamped",
        gravity=0.0,
        loads=[{"at": 100.0, "moment": [0, 0, 8e5 * 20 * np.pi / 100]}],
    )
    model = build_model(case)
    state = find_equilibrium(model)
    assert model.system.field("string.spin")[-1, 0] == pytest.approx(20 * np.pi, rel=1e-12)
    assert state.equilibrium.iterations <= 2 and state.stable


def test_a_straight_rod_above_the_torsional_buckling_moment_is_not_called_stable():
    """Greenhill's moment of a rod with a clamped and a free end that the moment does not follow is pi EI/L at most."""
    case = Case(
        string=[rod(100.0, 20, 1e8, 1e6, 8e5)],
        top="clamped",
        gravity=0.0,
        loads=[{"at": 100.0, "moment": [0, 0, 8e5 * 20 * np.pi / 100]}],
    )
    model = build_model(case)
    state = find_equilibrium(model)
    assert not state.stable and any("not shown to be stable" in w for w in state.warnings)


# ---------------------------------------------------------------------- stretch
@pytest.mark.parametrize("elements", [10, 40])
def test_section_change_with_a_point_load(elements):
    """1800 m of pipe over 200 m of collar (EA ratio 4) hung in air, 50 kN downward at the junction: tip
    displacement (w1 L1^2/2 + (w2 L2 + F) L1)/EA1 + w2 L2^2/2 EA2, and the forces beside the junction, to
    rounding (manual: verif-section-change)."""
    g, l1, l2, ea1, ea2, m1, m2, force = 9.81, 1800.0, 200.0, 7e8, 2.8e9, 27.0, 150.0, 5e4

    def part(length, axial, bending, mass, count):
        return {
            "kind": "beam",
            "length": length,
            "axial_stiffness": axial,
            "bending_stiffness": bending,
            "torsional_stiffness": 1e6,
            "mass": mass,
            "polar_inertia": 0.1,
            "element_length": length / count,
        }

    case = Case(
        string=[part(l1, ea1, 1.2e8, m1, 9 * elements), part(l2, ea2, 8e8, m2, elements)],
        top="clamped",
        gravity=g,
        loads=[{"at": l1, "force": [0, 0, force]}],
    )
    model = build_model(case)
    state = find_equilibrium(model)
    tip = (m1 * g * l1**2 / 2 + (m2 * g * l2 + force) * l1) / ea1 + m2 * g * l2**2 / 2 / ea2
    moved = model.system.field("string.position")[-1, 2] - l1 - l2
    assert moved == pytest.approx(tip, rel=2e-11)
    cells = model.beam.element_results(model.system.assembly)
    here = 9 * elements
    assert cells[here - 1, 5] == pytest.approx(m2 * g * l2 + force, rel=1e-8)
    assert cells[here, 3] == pytest.approx(m2 * g * l2, rel=1e-8)
    assert model.system.reaction("top.axial_reaction") == pytest.approx(
        -(m1 * l1 + m2 * l2) * g - force, rel=1e-10
    )
    assert state.equilibrium.iterations <= 6


DRILL_PIPE = {"kind": "pipe", "od": 0.127, "id": 0.1086}
DP_EA, DP_GJ, DP_AREA = 7.0137489e8, 9.4156072e5, 3.4047325e-3


def test_hanging_drill_pipe_stretches():
    """2000 m of drill pipe in air, w L^2/2 EA = .747655 m (manual: verif-hanging-string)."""
    case = Case(string=[{**DRILL_PIPE, "length": 2000.0}], top="clamped", gravity=9.81)
    model = build_model(case)
    find_equilibrium(model)
    stretch = model.system.field("string.position")[-1, 2] - 2000
    assert stretch == pytest.approx(7850 * DP_AREA * 9.81 * 2000**2 / 2 / DP_EA, rel=1e-7)
    assert stretch == pytest.approx(0.747655, rel=1e-5)


def test_drill_pipe_twists():
    """10 kN m on 2000 m of drill pipe, 21.24133 rad; the tension of its weight keeps it straight (manual:
    verif-hanging-string)."""
    case = Case(
        string=[{**DRILL_PIPE, "length": 2000.0}],
        top="clamped",
        gravity=9.81,
        loads=[{"at": 2000.0, "moment": [0, 0, 1e4]}],
    )
    model = build_model(case)
    find_equilibrium(model)
    assert model.system.field("string.spin")[-1, 0] == pytest.approx(21.24133, rel=1e-6)


# ---------------------------------------------------------------------- frequencies
FREQUENCIES = {  # elements: relative errors of modes 1 to 3 (manual: verif-static-frequencies)
    4: ((4.4e-8, 2.5e-5, 3.6e-4), (-5.0e-5, -4.2e-3, -3.5e-2), (3.3e-5, 1.2e-3, 7.7e-3)),
    8: ((8.2e-10, 5.5e-7, 1.0e-5), (-3.1e-6, -2.5e-4, -2.0e-3), (2.1e-6, 8.0e-5, 6.1e-4)),
    16: ((1.4e-11, 9.8e-9, 2.0e-7), (-1.9e-7, -1.6e-5, -1.2e-4), (1.3e-7, 5.1e-6, 4.0e-5)),
}


@pytest.mark.parametrize("elements", FREQUENCIES)
def test_frequencies_of_a_clamped_free_string(elements):
    """Modes against c (2n-1) pi/2L (axial, torsion) and (beta_n/L)^2 sqrt(EI/mu) with beta_n of cos cosh = -1
    (bending) (manual: verif-static-frequencies)."""
    length, ea, ei, gj, mass, polar = 100.0, 7e8, 1.2e6, 9.4e5, 27.0, 0.09
    item = {
        "kind": "beam",
        "length": length,
        "axial_stiffness": ea,
        "bending_stiffness": ei,
        "torsional_stiffness": gj,
        "mass": mass,
        "polar_inertia": polar,
        "element_length": length / elements,
    }
    model = build_model(Case(string=[item], top="clamped", gravity=0.0))
    place_along_hole(model)
    system = model.system
    asm, layout = system.assembly, system.layout

    def matrix(weights):
        asm.jacobian(0.0, weights, condensed=False)
        out = np.zeros((layout.size, layout.size))
        np.add.at(out, asm.places(), asm.values)
        return out

    stiffness, inertia = matrix((1.0, 0.0, 0.0)), matrix((0.0, 0.0, 1.0))
    held = np.zeros(layout.size, dtype=bool)
    for f in asm.row_replacements:
        held[f.rows] = np.any(f.D != 0, axis=0)
    position, slope, spin = (layout.dofs[f"string.{k}"] for k in ("position", "tangent", "spin"))
    modes = (2 * np.arange(1, 4) - 1) * np.pi / 2 / length
    beta = [
        brentq(lambda b: np.cos(b) * np.cosh(b) + 1, *bracket, xtol=1e-14)
        for bracket in ((1, 3), (4, 6), (7, 9))
    ]
    exact = (
        modes * np.sqrt(ea / mass),
        modes * np.sqrt(gj / polar),
        (np.array(beta) / length) ** 2 * np.sqrt(ei / mass),
    )
    unknowns = (
        np.concatenate([position[:, 2], slope[:, 2]]),
        spin[:, 0],
        np.concatenate([position[:, 0], slope[:, 0]]),
    )
    for chosen, truth, expected in zip(unknowns, exact, FREQUENCIES[elements], strict=True):
        free = chosen[~held[chosen]]
        square = eigh(stiffness[np.ix_(free, free)], inertia[np.ix_(free, free)], eigvals_only=True)[:3]
        error = np.sqrt(square) / truth - 1
        assert error == pytest.approx(expected, rel=0.1, abs=5e-10)
