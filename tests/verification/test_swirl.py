"""Whirl that the swirl of the mud feeds, against closed forms (manual: verif-swirl)."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import root

from drillpetsc import Case, run, statics
from drillpetsc.analysis.linear.doubts import fed_by_swirl
from drillpetsc.analysis.linear.modal import modes, moment_of, prepare_state
from drillpetsc.model.drilling_model import build_model
from drillpetsc.model.fluid import build_rheology, lateral_viscosity
from drillpetsc.output import read_table
from drillpetsc.physics.fluid.added_mass import stokes_force
from drillpetsc.physics.fluid.mud_items import MudItems
from drillpetsc.physics.fluid.rheology import pressure_gradient
from tests.helpers.collar_in_mud import CASE, EXACT
from tests.helpers.wells import simple_well

# a collar between two pins, without axial force: mass with the mud in its bore and added mass [kg/m], damping [N s/m2], stiffness
# E I (pi/L)^4 [N/m2] (Fritz, J. Basic Eng. 92 (1970) 923: a rotor in a fluid that turns with a share of its speed)
OD, ID, HOLE, LENGTH, MUD = 0.1715, 0.0714, 0.2159, 20.0, 1300.0
MASS = np.pi / 4 * (7850 * (OD**2 - ID**2) + MUD * ID**2)
ADDED, DAMPING = 152.908, 166.466
STIFFNESS = 206e9 * np.pi / 64 * (OD**4 - ID**4) * (np.pi / LENGTH) ** 4
SHARE = OD**2 / (OD**2 + HOLE**2)


def collar(rpm: float, **fluid) -> Case:
    displaced = MUD * np.pi / 4 * OD**2
    return Case(
        well=simple_well(LENGTH, HOLE, friction=0.25),
        string=[{"kind": "pipe", "length": LENGTH, "od": OD, "id": ID, "element_length": 1.0}],
        material={"young": 206e9, "density": 7850.0},
        top={"kind": "top_drive", "rotation": f"{rpm} rpm", "hinged": True},
        bottom="pinned",
        gravity=0.0,
        fluid={
            "density": MUD,
            "rheology": {"model": "newtonian", "viscosity": 0.03},
            "added_mass": ADDED / displaced,
            "lateral_damping": DAMPING,
            **fluid,
        },
    )


def first_whirls(case: Case) -> np.ndarray:
    """(2,) eigenvalues [1/s] of the first span, the slower one first."""
    model = build_model(case)
    prepare_state(model)
    m = modes(model, 4, kind="lateral")
    found = m.eigenvalue
    grows = bool((found.real[found.imag > 0] > 1e-6).any())
    assert bool(fed_by_swirl.sentences(moment_of(model, m))) == grows  # the note on whirls that the mud feeds
    return found[(found.imag > 0) & (found.imag < 10)][:2]


def closed_form(share: float, rpm: float) -> np.ndarray:
    """Roots of m s^2 + M (s - i w)^2 + k_v (s - i w) + k = 0, forward (w the swirl) and, by the conjugate, backward."""
    w = share * rpm * np.pi / 30
    s = np.roots([MASS + ADDED, DAMPING - 2j * ADDED * w, STIFFNESS - ADDED * w**2 - 1j * DAMPING * w])
    return np.sort_complex(np.where(s.imag < 0, s.conj(), s))[
        np.argsort(np.abs(np.sort_complex(np.where(s.imag < 0, s.conj(), s)).imag))
    ]


@pytest.mark.parametrize(
    "rpm, swirl", [(0, "auto"), (60, "auto"), (120, "auto"), (60, 0.5), (120, 0.5), (240, "auto"), (60, 0.0)]
)
def test_whirls_of_a_collar_in_swirling_mud(rpm, swirl):
    """Forward and backward whirl of a collar: equal without swirl, split by it, and the forward one growing from the speed on at
    which its span turns slower than the mud."""
    found = first_whirls(collar(rpm, swirl=swirl))
    expected = closed_form(SHARE if swirl == "auto" else swirl, rpm)
    assert found.imag == pytest.approx(expected.imag, rel=2e-4)
    assert found.real == pytest.approx(expected.real, rel=2e-3, abs=2e-4)


@pytest.mark.parametrize("swirl, threshold", [("auto", 142.44), (0.5, 110.22)])
def test_speed_from_which_mud_feeds_forward_whirl(swirl, threshold):
    """sqrt(k/m) = swirl, with the mass m of pipe and mud in its bore, but without the added mass, whatever the damping is."""
    share = SHARE if swirl == "auto" else swirl
    assert np.sqrt(STIFFNESS / MASS) / share * 30 / np.pi == pytest.approx(threshold, rel=1e-4)
    for damping in (DAMPING, 20.0):
        growth = [
            first_whirls(collar(f * threshold, swirl=swirl, lateral_damping=damping)).real.max()
            for f in (0.99, 1.01)
        ]
        assert growth[0] < 0 < growth[1]


def test_viscous_mud_at_the_rates_of_both_whirls():
    """With the oscillating viscous flow the force of each whirl is that at its rate relative to the mud (manual: eq-eigen-swirl)."""
    found = first_whirls(
        collar(60, added_mass="stokes", lateral_damping="stokes", lateral_damping_speed=2 * np.pi)
    )
    swirl, radius, nu = SHARE * 2 * np.pi, OD / 2, 0.03 / MUD

    def rest(v: np.ndarray, way: float) -> list[float]:
        s = complex(*v)
        relative = s - 1j * way * swirl
        upper = relative if relative.imag > 0 else relative.conjugate()
        force = complex(stokes_force(upper, radius, nu, HOLE / OD))
        force = force if relative.imag > 0 else force.conjugate()
        left = MASS * s**2 + MUD * np.pi * radius**2 * force * relative**2 + STIFFNESS
        return [left.real, left.imag]

    for one, way in zip(found, (-1.0, 1.0), strict=True):
        exact = complex(*root(rest, [one.real, one.imag], args=(way,)).x)
        assert abs(one - exact) < 1e-3 * abs(exact)


def probes(folder, top=None, fluid=None, angle: float = 1.0) -> dict[str, np.ndarray]:
    """probes.csv of the collar turned up in mud, with other keys of `top` and `fluid` and angle of an eccentricity [rad]."""
    string = [*CASE["string"][:2], CASE["string"][2] | {"eccentricity_angle": angle}, *CASE["string"][3:]]
    petsc = dict(zip((name[1:] for name in EXACT[::2]), EXACT[1::2], strict=True))
    case = CASE | {
        "string": string,
        "top": CASE["top"] | (top or {}),
        "fluid": CASE["fluid"] | (fluid or {}),
        "petsc": petsc,
    }
    run(Case(**case), folder, progress="silent")
    return read_table(folder / "probes.csv")


@pytest.mark.parametrize(
    "fluid", [{}, {"swirl": "none"}, {"flow_rate": -0.02}], ids=["swirl", "no swirl", "downward"]
)
def test_a_whirl_in_mud_that_flows_keeps_its_energy(fluid, tmp_path):
    """The mud that enters at the lower end and passes along the whirling string exchanges energy with it, which the balance counts
    (manual: eq-mud-energy-across).  It gained up to 15 J in a second, 3.6e-4 of the energy exchanged, whatever the tolerance."""
    string = [*CASE["string"][:1], CASE["string"][1] | {"unbalance": 0.3}, *CASE["string"][2:]]
    case = CASE | {
        "string": string,
        "contact": "none",
        "time": {"end": 0.5},
        "petsc": {"ts_type": "bdf", "ts_rtol": 1e-6},
    }
    turned = {
        "top": {"kind": "top_drive", "rotation": {"ramp": 0.3, "value": 25.0}},
        "fluid": CASE["fluid"] | fluid,
    }
    energy = run(Case(**case | turned), tmp_path / "run", progress="silent").summary["energy"]
    assert abs(energy["error_share"]) < 3e-5 and energy["gained_share"] < 3e-5


def test_a_string_that_turns_the_other_way_round_moves_in_the_mirror(tmp_path):
    """Counter-clockwise rotation with mirrored eccentricities: the same motion, mirrored; the swirl moves it by some 5 % of its size."""
    one = probes(tmp_path / "one")
    other = probes(tmp_path / "other", {"rotation": {"ramp": 0.1, "value": -12.0}}, angle=-1.0)
    without = probes(tmp_path / "without", fluid={"swirl": "none"})
    for depth in ("6", "12.5", "20"):
        x, y, spin = f"x_{depth} [m]", f"y_{depth} [m]", f"spin_{depth} [rad/s]"
        size = np.hypot(one[x], one[y]).max()
        for name, sign in ((x, 1.0), (y, -1.0), (spin, -1.0)):
            assert other[name] == pytest.approx(
                sign * one[name], abs=1e-9 * max(size, np.abs(one[name]).max())
            )
        assert np.hypot(without[x] - one[x], without[y] - one[y]).max() > 0.02 * size


def test_mud_about_a_string_that_does_not_turn_has_no_swirl(tmp_path):
    still = probes(tmp_path / "still", {"rotation": 0.0})
    without = probes(tmp_path / "without", {"rotation": 0.0}, {"swirl": "none"})
    for name, values in still.items():
        assert np.array_equal(values, without[name]), name


def test_statics_names_the_viscous_torque_that_it_leaves_out(tmp_path):
    """Couette's flow brakes a string on the axis of its hole with 4 pi mu Omega L Ro^2 Rw^2/(Rw^2 - Ro^2)."""
    case = collar(60.0, rotation_drag=True)
    outer, wall = (OD / 2) ** 2, (HOLE / 2) ** 2
    torque = 4 * np.pi * 0.03 * 2 * np.pi * LENGTH * outer * wall / (wall - outer)
    (said,) = [w for w in statics(case, out=tmp_path / "drag").summary["warnings"] if "viscous torque" in w]
    assert f"{torque / 1000:.3g} kN m at 60 rpm, is left out" in said
    summary = statics(case.replace({"fluid.rotation_drag": False}), out=tmp_path / "none").summary
    assert not any("viscous torque" in w for w in summary["warnings"])


def test_viscosity_and_following_of_the_mud_about_a_turning_pipe():
    """Couette: the shear rate at the pipe is 2 w/(1 - (Do/Dw)^2), so K of a power law gives K rate^(n-1).  Axial flow makes the swirl
    follow as fast as its wall friction would stop the flow itself: dp/ds/(rho v) (manual: eq-mud-swirl-lag)."""
    law = {"model": "power_law", "consistency": 0.8, "index": 0.5}
    case = Case(
        well=simple_well(60, 0.2159),
        string=[
            {"kind": "pipe", "length": 50, "od": 0.127, "id": 0.1086, "element_length": 10},
            {"kind": "bit", "length": 0.4, "od": 0.2, "mass": 60},
        ],
        top={"kind": "top_drive", "rotation": 10.0},
        fluid={
            "density": 1200,
            "rheology": law,
            "flow_rate": 0.02,
            "lateral_damping_speed": 7.0,
            "swirl_lag": True,
        },
    )
    inner, outer = np.array([0.127]), np.array([0.2159])
    rate = 2 * 7.0 / (1 - (0.127 / 0.2159) ** 2)
    assert lateral_viscosity(case, inner, outer) == pytest.approx(0.8 / np.sqrt(rate), rel=1e-12)
    model = build_model(case)
    follow, speed = model.annulus.lateral.following, np.array([1.3])
    viscous = np.pi**2 * 0.8 / np.sqrt(rate) / 1200 / (0.5 * (outer - inner)) ** 2
    gradient = pressure_gradient(build_rheology(case), speed, outer - inner, [True], [1200.0])
    assert follow(speed, inner, outer) - viscous == pytest.approx(gradient / (1200 * speed), rel=1e-9)
    (item,) = model.part(MudItems).items
    assert model.mesh.node_depth[item.node] + item.arm == pytest.approx(50.2)
