"""Quaternion element at rest: large bending, twist, weight, reactions; orders of convergence in the mesh and
their limits (manual: verif-quaternion-statics)."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from drillpetsc import Case
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.analysis.statics.quaternion_statics import solve_at_rest
from drillpetsc.model.drilling_model import build_model
from tests.helpers.motion import beam, straight
from tests.helpers.wells import simple_well

QUATERNION = {"formulation": "quaternion"}
RISING = {"time": [0, 1], "value": [0, 1]}


def cantilever(elements: int, axial: float, steps: int, **load):
    """Unit cantilever (L = EI = 1) hanging down, clamped above, loaded at its tip in ``steps`` steps."""
    model = straight(
        string=[beam(1.0, elements, axial, 1.0, 0.8, 1.0, 0.01)],
        top="clamped",
        gravity=0.0,
        beam=QUATERNION,
        loads=[{"at": 1.0, "value_over": RISING, **load}],
    )
    for t in np.linspace(0, 1, steps + 1)[1:]:
        solve_at_rest(model.system, t)
    return model.system


def test_a_moment_rolls_the_string_up_to_a_circle():
    """M = 2 pi EI/L closes the circle exactly: the distance of the tip from the root converges with order 4;
    the clamp carries -M."""
    gaps = []
    for n in (4, 8, 16):
        system = cantilever(n, 1e4, 40, moment=[0, 2 * np.pi, 0])
        r = system.field("string.position")
        gaps.append(np.linalg.norm(r[-1] - r[0]))
        assert system.reaction("top.side_moment_2") == pytest.approx(
            -2 * np.pi, rel=1e-9
        )  # the second axis points north, the third east
        assert (
            abs(system.reaction("top.torque_reaction")) < 1e-9
            and abs(system.reaction("top.axial_reaction")) < 1e-9
        )
    assert gaps[-1] < 2e-4
    assert np.log2(np.array(gaps[:-1]) / gaps[1:]) == pytest.approx(4.0, abs=0.5)


def bent(force: float, axial: float) -> np.ndarray:
    """Tip (x, z) of the extensible Kirchhoff rod, L = EI = 1, under a dead force across its initial axis, by
    shooting.

    x' = (1+e) sin th, z' = (1+e) cos th, th' = m, m' = -(1+e) P cos th, e = P sin th/EA, m(1) = 0.
    """

    def line(m0: float):
        def rate(s, q):
            stretch = 1 + force * np.sin(q[2]) / axial
            return [stretch * np.sin(q[2]), stretch * np.cos(q[2]), q[3], -stretch * force * np.cos(q[2])]

        return solve_ivp(rate, (0, 1), [0, 0, 0, m0], rtol=1e-11, atol=1e-13).y[:, -1]

    return line(brentq(lambda m: line(m)[3], 0.3 * force, force, xtol=1e-13))[:2]


def tip_errors(axial: float, elements: tuple[int, ...]) -> np.ndarray:
    exact = bent(10.0, axial)
    tips = [cantilever(n, axial, 20, force=[10, 0, 0]).field("string.position")[-1, [0, 2]] for n in elements]
    return np.linalg.norm(np.array(tips) - exact, axis=1)


def test_a_tip_force_bends_the_string_with_order_four():
    """P L2/EI = 10, EA L2/EI = 1e4 against shooting, order 4 or better; inextensible value 0.81061, 0.44500
    (Mattiasson, Int. J. Numer. Meth. Engng 17, 1981)."""
    assert bent(10.0, 1e9) == pytest.approx([0.81061, 1 - 0.55500], abs=1e-5)
    errors = tip_errors(1e4, (4, 8, 16))
    assert errors[-1] < 1e-5 and np.all(np.log2(errors[:-1] / errors[1:]) > 3.9)


def test_a_stiff_axis_locks_coarse_meshes():
    """Limit of order 4: with EA integrated at three points, an element has three axial constraints for its
    seven displacements, and at EA L2/EI = 1e6 the error decreases with order 2 until elements are short; the
    ANCF element has no such locking (manual: sec-quaternion-behaviour)."""
    errors = tip_errors(1e6, (4, 8, 16, 32))
    orders = np.log2(errors[:-1] / errors[1:])
    assert orders[0] == pytest.approx(2.0, abs=0.3) and orders[-1] > 3.9
    assert errors[1] > 5 * tip_errors(1e4, (8,))[0]


def test_reactions_of_a_bent_cantilever_are_those_of_its_free_body():
    """Dead force P at the tip: the clamp carries -P and the moment -P z_tip of the deformed lever, to
    rounding."""
    system = cantilever(3, 1e4, 10, force=[10, 0, 0])
    lever = system.field("string.position")[-1, 2]
    assert system.reaction("top.side_reaction_1") == pytest.approx(-10.0, rel=1e-10)
    assert system.reaction("top.side_moment_2") == pytest.approx(-10.0 * lever, rel=1e-10)
    assert abs(system.reaction("top.axial_reaction")) < 1e-9


def test_a_hung_string_carries_its_weight():
    """Stretch w L2/2EA and hook load w L, from the static start of a case (ANCF equilibrium, then Newton on
    the quaternion element)."""
    L, w, EA = 100.0, 40 * 9.81, 1e8
    case = Case(string=[beam(L, 5, EA, 1e6, 8e5, 40.0, 0.2)], top="clamped", gravity=9.81, beam=QUATERNION)
    model = build_model(case)
    state = find_equilibrium(model)
    assert model.system.field("string.position")[-1, 2] - L == pytest.approx(w * L**2 / (2 * EA), rel=1e-10)
    assert -model.system.reaction("top.axial_reaction") == pytest.approx(w * L, rel=1e-10)
    assert state.stable and EA * model.system.field("string.strain")[0, 0] == pytest.approx(w * L, rel=1e-9)


def test_an_end_torque_twists_a_straight_string():
    """Ten elements under T rotate by T L/GJ, minus a fraction h^4/60 with h half the angle of an element.

    Linear quaternions rotate unevenly: phi' = 2 sin h/(1 - 2 s (1-s)(1 - cos h)). The mean of its square is
    the square of its mean times 1 + h^4/180, so U = GJ phi^2/2L (1 + h^4/180) and T = dU/dphi = GJ phi/L (1 +
    h^4/60).
    """
    T, n, x = 1.0, 10, 0.5
    model = straight(
        string=[beam(1.0, n, 1e4, 1.0, T / (n * x), 1.0, 0.01)],
        top="clamped",
        gravity=0.0,
        beam=QUATERNION,
        loads=[{"at": 1.0, "moment": [0, 0, T], "value_over": RISING}],
    )
    for t in np.linspace(0, 1, 11)[1:]:
        solve_at_rest(model.system, t)
    # the angle increases from node to node, so it is summed over the elements
    angle = np.unwrap(model.beam._node_motion(model.system.assembly)[:, 7])
    assert 1 - angle[-1] / (n * x) == pytest.approx((0.5 * x) ** 4 / 60, rel=0.05)
    assert model.system.reaction("top.torque_reaction") == pytest.approx(-T, rel=1e-10)


@pytest.mark.parametrize("curvature, side", [(0.5, 0), (0.5, 1)])
def test_a_bent_pipe_rests_in_its_own_shape(curvature, side):
    """Stress-free curvature k towards north or east without load: an arc, tip at (1 - cos kL)/k, no strain
    energy.

    In a vertical string the tool face is magnetic: 0 is north, 90 degrees east. Order 4 in k L/n.
    """
    n, L = 8, 1.0
    item = beam(L, n, 1e4, 1.0, 0.8, 1.0, 0.01, curvature=curvature, curvature_angle=0.5 * np.pi * side)
    model = straight(string=[item], top="clamped", gravity=0.0, beam=QUATERNION)
    solve_at_rest(model.system)
    tip = model.system.field("string.position")[-1]
    away = (1 - np.cos(curvature * L)) / curvature
    expected = np.array([[away, 0.0], [0.0, away]][side])
    assert tip[:2] == pytest.approx(expected, abs=1e-5)
    assert tip[2] == pytest.approx(np.sin(curvature * L) / curvature, abs=1e-5)
    assert model.system.energies(0.0).strain < 1e-6


@pytest.mark.parametrize("inclination", [0.0, 0.5])
def test_a_piece_between_two_universal_joints_may_float(inclination):
    """Its block of the chain is singular without B^T B: 18 instead of 3 Newton steps from the ANCF state in a vertical hole."""
    found = []
    for formulation in ("ancf", "quaternion"):
        well = simple_well(60.0, 0.2159, inclination, friction=0.2)
        pipe = {"kind": "pipe", "length": 59.6, "od": 0.127, "id": 0.1086, "element_length": 2.0}
        model = build_model(
            Case(
                well=well,
                string=[pipe, {"kind": "bit", "length": 0.4, "od": 0.2159, "mass": 60.0}],
                joints=[{"at": 20.0, "kind": "universal"}, {"at": 40.0, "kind": "universal"}],
                top={"kind": "top_drive"},
                bottom={"kind": "bit"},
                gravity=9.81,
                beam={"formulation": formulation},
                initial={"from": "statics", "wob": 2e4},
            )
        )
        state = find_equilibrium(model)
        assert state.stable
        weight = model.bit.weight_and_torque(model.system.assembly)[0]
        found.append((state.equilibrium.iterations, weight, model.system.field("string.position").copy()))
    (ancf, weight, position), (both, other, place) = found
    assert both - ancf <= 5
    assert other == pytest.approx(weight, rel=1e-6) and place == pytest.approx(position, abs=1e-5)
