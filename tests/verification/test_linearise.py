"""Linear models x' = A x + B u, y = C x + D u against closed forms, modes and sessions (manual: verif-linear)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import drillpetsc
from drillpetsc import Case, load_case
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.model.drilling_model import build_model
from drillpetsc.physics.top.hoist import Hoist
from drillpetsc.solvers.linear.model_reduction import reduce
from drillpetsc.solvers.linear.state_space import StateSpace
from tests.helpers import top_drive_models as m
from tests.helpers.wells import simple_well

CASES = Path(__file__).parents[2] / "cases"
FREQUENCY = np.array([0.1, 0.5, 1.0, 2.0])
#: C30: |omega_top/torque| [rad/s per N m] and phase [deg] of a drive of 2900 kg m2 with 2000 m of pipe
C30 = [5.139077e-4, 1.187224e-4, 5.395235e-5, 2.975324e-5], [-90.0, -89.953, -89.979, -85.519]
PIPE = {"length": 2000.0, "od": 0.127, "id": 0.1086, "inertia": 2900.0, "damping": 1e-3}
COLLAR = {"length": 350.0, "od": 0.2, "id": 0.07, "inertia": 640.0, "damping": 4e-4}


def free_string(q: dict, elements: int = 200, **more) -> Case:
    """A uniform string, free below, without a hole; more: keys of the top."""
    pipe = {"kind": "pipe", "length": q["length"], "od": q["od"], "id": q["id"]}
    return Case(
        string=[{**pipe, "element_length": q["length"] / elements}],
        material={"young": m.YOUNG, "density": m.DENSITY, "damping": {"stiffness": q["damping"]}},
        top={"kind": "top_drive", **more},
        time={"end": 20.0},
    )


def driven(q: dict, elements: int = 200) -> Case:
    """The string under a motor whose torque is given."""
    return free_string(q, elements, torque=0.0, motor={"inertia": q["inertia"]})


def waves(q: dict, frequency: np.ndarray):
    """s, k L and the torque per twist GJ (1 + b s) k of torsional waves in the string."""
    s = 2j * np.pi * frequency
    polar = np.pi / 32 * (q["od"] ** 4 - q["id"] ** 4)
    k = s / (m.SPEED * np.sqrt(1 + q["damping"] * s))
    return s, k * q["length"], m.SHEAR * polar * (1 + q["damping"] * s) * k


@pytest.mark.parametrize("q", [PIPE, COLLAR], ids=["C30", "collar"])
def test_the_response_to_torque_is_that_of_the_wave_equation(q, tmp_path):
    """s/(I s^2 + GJ (1 + b s) k tanh kL) within 0.3 %, and over cosh kL at the lower end; the figures of C30."""
    outputs = ["top_speed", "bit_speed", "motor_torque"]
    system = drillpetsc.linearise(driven(q), ["top.torque"], outputs, tmp_path / "r").system
    s, kL, GJk = waves(q, FREQUENCY)
    exact = s / (q["inertia"] * s**2 + GJk * np.tanh(kL))
    found = system.response(FREQUENCY)[:, :, 0]
    assert np.abs(found[:, 0] / exact - 1).max() < 3e-3
    assert np.abs(found[:, 1] / (exact / np.cosh(kL)) - 1).max() < 3e-3
    assert found[:, 2] == pytest.approx(np.ones(4), rel=1e-6)
    if q is PIPE:
        assert np.abs(found[:, 0]) == pytest.approx(C30[0], rel=3e-3)
        assert np.degrees(np.angle(found[:, 0])) == pytest.approx(C30[1], abs=0.05)


def test_a_prescribed_rotation_acts_by_its_rate_too(tmp_path):
    """Bit speed 1/cosh kL and surface torque GJ (1 + b s) k tanh(kL)/s per rotation; inertia at the top is in F."""
    case = free_string(COLLAR, 50, rotation=5.0)
    result = drillpetsc.linearise(case, ["top.rotation"], ["bit_speed", "surface_torque"], tmp_path / "r")
    system = result.system
    s, kL, GJk = waves(COLLAR, FREQUENCY)
    found = system.response(FREQUENCY)[:, :, 0]
    assert np.abs(found[:, 0] * np.cosh(kL) - 1).max() < 3e-3
    assert np.abs(found[:, 1] / (GJk * np.tanh(kL) / s) - 1).max() < 3e-3
    polar = np.pi / 32 * (COLLAR["od"] ** 4 - COLLAR["id"] ** 4)
    element = m.DENSITY * polar * COLLAR["length"] / 50
    # 5/12 of the first element, whose matrix has 1/12 beside the diagonal, less what its neighbours carry
    last = (10 / 12 + np.sqrt((10 / 12) ** 2 - 4 / 144)) / 2
    assert system.F[1, 0] == pytest.approx(element * (5 / 12 - 1 / 144 / last), rel=1e-5)
    assert system.F[0, 0] == 0
    assert any("follows the rate of top.rotation" in line for line in result.lines)
    with pytest.raises((ImportError, ValueError), match="control"):
        result.to_control()


def test_the_delay_of_a_drive_is_a_delay(tmp_path):
    """Torque by set point of PI control with delay d: H C/(1 + H C/(J s)), C = p + i/s, H = exp(-d s) up to (w d)^5/720."""
    p, i, inertia, delay = 8e3, 4e3, 2900.0, 0.1
    control = {"kind": "pi", "p": p, "i": i, "delay": delay}
    case = free_string(
        COLLAR | {"length": 10.0}, 2, rotation=5.0, control=control, motor={"inertia": inertia}
    )
    frequency = np.array([0.3, 0.8, 1.5])
    system = drillpetsc.linearise(case, ["top.rotation"], ["motor_torque"], tmp_path / "r").system
    s = 2j * np.pi * frequency
    whole = inertia + m.DENSITY * np.pi / 32 * (COLLAR["od"] ** 4 - COLLAR["id"] ** 4) * 10.0
    loop = np.exp(-delay * s) * (p + i / s)
    exact = loop / (1 + loop / (whole * s))
    assert np.abs(system.response(frequency)[:, 0, 0] / exact - 1).max() < 3e-3


@pytest.mark.parametrize("q, order", [(PIPE, 20), (PIPE, 9), (COLLAR, 8)], ids=["C30", "odd", "collar"])
@pytest.mark.parametrize("method", ["balanced", "modal"])
def test_reduced_models(q, order, method, tmp_path):
    """The error at 500 frequencies is within twice the sum of the Hankel values left out; the rigid motion stays exact."""
    case = driven(q, 60)
    result = drillpetsc.linearise(
        case, ["top.torque"], ["top_speed", "bit_speed"], tmp_path / "r", reduce=method, order=order
    )
    full, reduced = result.system, result.reduced
    assert reduced.kept == 2 and order - 1 <= reduced.system.order <= order
    frequency = np.geomspace(0.02, 60, 500)
    error = reduced.error(full.response(frequency), reduced.system.response(frequency))
    if method == "balanced":
        assert 0 < error <= reduced.bound == pytest.approx(2 * reduced.hankel[order - 2 :].sum())
        assert np.all(np.diff(reduced.hankel) <= 0)
    else:
        assert error < 0.05  # of the largest resonance
        # the static response of the modes left out is kept
        near = full.response(np.array([1e-3])), reduced.system.response(np.array([1e-3]))
        assert np.abs(near[1] / near[0] - 1).max() < 1e-5
    slow = np.array([1e-4])
    polar = np.pi / 32 * (q["od"] ** 4 - q["id"] ** 4)
    whole = q["inertia"] + m.DENSITY * polar * q["length"]
    rigid = 1 / (2j * np.pi * slow[0] * whole)
    allowed = 1e-4 * abs(rigid) + np.nan_to_num(reduced.bound) * reduced.output_size / 1e4
    assert np.all(np.abs(reduced.system.response(slow)[0, :, 0] - rigid) < allowed)
    assert np.linalg.eigvals(reduced.system.A).real.max() == 0.0


def test_a_step_of_the_torque_is_that_of_a_session(tmp_path):
    """1 kN m for 2 s: speeds of the nonlinear model and of the linear one within 1 %."""
    import scipy.signal  # a slow import

    case = driven(COLLAR, 40).replace({"petsc.ts_rtol": 1e-6})
    outputs = ["top_speed", "bit_speed"]
    q = drillpetsc.linearise(case, ["top.torque"], outputs, tmp_path / "r", reduce="balanced", order=12)
    times, torque = np.linspace(0, 2, 101), 1e3
    rows = [[0.0, 0.0]]
    with drillpetsc.Session(case) as s:
        s.set("top.torque", torque)
        for _ in times[1:]:
            s.step(times[1])
            rows.append(s.get_many(outputs))
    for system in (q.system, q.reduced.system):
        matrices = system.A, system.B, system.C, system.D
        _, linear, _ = scipy.signal.lsim(matrices, np.full(len(times), torque), times)
        assert np.abs(linear - rows).max() < 0.01 * np.abs(rows).max()


def test_an_unstable_state_is_named_and_kept(tmp_path):
    """Stiff control at 90 rpm on a weakening bit: the growing pair of the modes is in the reduced model, too."""
    case = Case(**m.on_bottom(m.STIFF, 90 * m.RPM, 20))
    result = drillpetsc.linearise(
        case, ["top.rotation"], ["bit_speed"], tmp_path / "l", reduce="balanced", order=15
    )
    found = drillpetsc.modes(case, tmp_path / "m", count=3, kind="torsional").summary
    growth, frequency = max(zip(found["growth"], found["frequency"], strict=True))
    assert growth > 0
    s = np.linalg.eigvals(result.reduced.system.A)
    s = s[s.real.argmax()]
    assert s.real == pytest.approx(growth, rel=1e-4) and abs(s.imag) == pytest.approx(
        2 * np.pi * frequency, rel=1e-5
    )
    assert any("unstable" in line and "torsional" in line for line in result.lines)
    assert any("bit stays on the bottom" in line for line in result.lines)
    assert not result.summary["stable"]
    assert result.summary["largest_growth"] == pytest.approx(growth, rel=1e-4)


MUD = {
    "well": simple_well(420, 0.216, kind="casing", friction=0.2),
    "string": [{"kind": "pipe", "length": 400.0, "od": 0.127, "id": 0.1086, "element_length": 40.0}],
    "top": {"kind": "top_drive", "rotation": 5.0},
    "fluid": {"density": 1200, "rheology": {"model": "newtonian", "viscosity": 0.02}, "flow_rate": 0.01},
}
JOINTED = {
    "string": [{"kind": "pipe", "length": 30.0, "od": 0.127, "id": 0.1086, "element_length": 10.0}] * 2,
    "joints": [{"at": 30.0, "kind": "universal"}],
    "top": {"kind": "top_drive", "torque": 0.0, "motor": {"inertia": 500.0}},
    "material": {"damping": {"stiffness": 1e-4}},
}


@pytest.mark.parametrize(
    "case, inputs, outputs, kind",
    [
        (MUD, ["fluid.flow_rate"], ["pump_pressure"], "fluid"),
        (JOINTED, ["top.torque"], ["bit_speed"], "torsional"),
        (
            {**JOINTED, "joints": [{"at": 30.0, "kind": "universal", "constraint": "stabilised"}]},
            ["top.torque"],
            ["bit_speed"],
            "torsional",
        ),
    ],
    ids=["mud", "joint", "stabilised joint"],
)
def test_algebraic_unknowns_and_constraints_leave_the_modes(case, inputs, outputs, kind, tmp_path):
    """Eigenvalues of A include those of ``modes``: with a prescribed flow of mud, and with multipliers of a joint."""
    system = drillpetsc.linearise(Case(**case), inputs, outputs, tmp_path / "l").system
    found = drillpetsc.modes(Case(**case), tmp_path / "m", count=4, kind=kind).summary
    s = np.linalg.eigvals(system.A)
    checked = 0
    for growth, frequency in zip(found["growth"], found["frequency"], strict=True):
        root = growth + 2j * np.pi * frequency
        if frequency > 0:
            assert np.abs(s - root).min() < 1e-5 * abs(root)
            checked += 1
    assert checked >= 3


def test_flow_to_pump_pressure_at_slow_changes_is_the_curve_of_the_pump(tmp_path):
    """D - C A^-1 B is the slope of the pump pressure over the flow rate, of steady states (turbulent in the pipe)."""
    case = Case(**MUD)
    system = drillpetsc.linearise(case, ["fluid.flow_rate"], ["pump_pressure"], tmp_path / "l").system
    static = (system.D - system.C @ np.linalg.solve(system.A, system.B))[0, 0]
    pressures = []
    for rate in (0.0099, 0.0101):
        with drillpetsc.Session(case.replace({"fluid.flow_rate": rate})) as s:
            pressures.append(s.get("pump_pressure"))
    assert static == pytest.approx((pressures[1] - pressures[0]) / 2e-4, rel=1e-3)


def test_files_and_wrong_input(tmp_path):
    case = driven(COLLAR, 10)
    result = drillpetsc.linearise(
        case, ["top.torque"], ["top_speed", "hook_load"], tmp_path / "r", reduce="modal", order=99
    )
    assert any("hook_load does not depend on the inputs" in line for line in result.lines)
    assert any("all are kept" in line for line in result.lines)
    assert result.reduced.system.A.shape == result.system.A.shape == (22, 22)
    saved = np.load(tmp_path / "r" / "linear.npz")
    assert np.array_equal(saved["A"], result.system.A) and list(saved["outputs"]) == [
        "top_speed",
        "hook_load",
    ]
    from scipy.io import loadmat

    cells = loadmat(tmp_path / "r" / "linear.mat")
    assert np.array_equal(cells["C"], result.system.C) and cells["inputs"][0, 0][0] == "top.torque"
    alone = drillpetsc.linearise(
        case, ["top.torque"], ["hook_load"], tmp_path / "a", reduce="balanced"
    ).system
    assert alone.order == 0 and not alone.D.any()
    for inputs, outputs, words in [
        (["top.torqe"], ["bit_speed"], "nearest: top.torque"),
        ([], ["bit_speed"], "at least one of"),
        (["top.torque"], [], "at least one of"),
        (["top.torque"], ["bit_sped"], "nearest: bit_speed"),
        (["top.torque", "top.torque"], ["bit_speed"], "each name once"),
    ]:
        with pytest.raises(CaseError, match=words):
            drillpetsc.linearise(case, inputs, outputs, tmp_path / "w")
    with pytest.raises(CaseError, match="at least 1"):
        drillpetsc.linearise(case, ["top.torque"], ["bit_speed"], tmp_path / "w", reduce="modal", order=0)
    with pytest.raises(SolveError, match="order 1 is too small"):
        drillpetsc.linearise(case, ["top.torque"], ["bit_speed"], tmp_path / "w", reduce="modal", order=1)
    dry = {k: v for k, v in MUD.items() if k != "fluid"}
    quasi = Case(**dry, time={"end": 1.0, "mode": "quasi_static"})
    with pytest.raises(CaseError, match="inertia"):
        drillpetsc.linearise(quasi, ["top.rotation"], ["bit_speed"], tmp_path / "q")


def test_the_root_that_decays_least_in_an_inclined_hole_is_one_of_the_modes(tmp_path):
    """Sliding friction, tension and damping of very different sizes: no small entry of the matrices is lost."""
    case = Case(
        well=simple_well(450, 0.216, (0, 0.6), friction=0.3),
        string=[{"kind": "pipe", "length": 400.0, "od": 0.127, "id": 0.1086, "element_length": 20.0}],
        material={"damping": {"stiffness": 1e-3, "mass": 0.05}},
        top={"kind": "top_drive", "rotation": 6.0, "lowering": 0.01},
    )
    system = drillpetsc.linearise(case, ["top.rotation"], ["bit_speed"], tmp_path / "l").system
    s = np.linalg.eigvals(system.A)
    for low in (50.0, 300.0, 800.0):  # the least decaying root above some frequencies [rad/s]
        above = s[s.imag > low]
        root = above[above.real.argmax()]
        shift = root.imag / (2 * np.pi)
        found = drillpetsc.modes(case, tmp_path / f"m{low:g}", count=1, shift=shift).summary
        assert found["frequency"][0] == pytest.approx(shift, rel=1e-5)
        assert found["growth"][0] == pytest.approx(root.real, abs=1e-5 * abs(root))


@pytest.mark.parametrize("wob", [200.0, 2e3, 2e4])
def test_weight_by_the_speed_of_the_drum(wob, tmp_path):
    """k/|s + k D| of string, line and bit within 1 %, also under a bit that a few micrometres would lift off the bottom."""
    case = load_case(CASES / "autodriller.yaml")
    top = case.top.model_copy(update={"autodriller": None})
    case = case.model_copy(update={"top": top, "initial": case.initial.model_copy(update={"wob": wob})})
    system = drillpetsc.linearise(case, ["top.lowering"], ["wob"], tmp_path / "l").system
    assert top.hoist is not None and top.hoist.line is not None and case.bottom.stiffness is not None
    area, line = np.pi / 4 * (0.127**2 - 0.1086**2), build_model(case).part(Hoist).line.stiffness
    k = 1 / (1990 / (206e9 * area) + 1 / line + 1 / case.bottom.stiffness)
    s = 2j * np.pi * np.array([0.003, 0.01])
    found = system.response(s.imag / (2 * np.pi))[:, 0, 0]
    assert np.abs(found / (k / (s + k * 6e-8)) - 1).max() < 1e-2


def test_the_dominant_mode_is_kept_and_the_static_response_of_the_others():
    """Roots -1.0005 +- 0.0316 of x'' + 2.001 x' + x = u, residues +-1/0.0632 though their vectors are almost one, beside 5/(s + 1):
    order 1 keeps the slower of both.  The response at rest is that of the whole model, whatever the usual size of the input."""
    A = np.array([[0.0, 1.0, 0.0], [-1.0, -2.001, 0.0], [0.0, 0.0, -1.0]])
    B, C = np.array([[0.0], [1.0], [np.sqrt(5.0)]]), np.array([[1.0, 0.0, np.sqrt(5.0)]])
    model = StateSpace(A, B, C, np.zeros((1, 1)), np.zeros((1, 1)))
    small = reduce(model, "modal", 1, 0.0, np.array([0.2])).system
    assert small.A.ravel() == pytest.approx([np.sqrt(1.0005**2 - 1) - 1.0005])
    assert small.response(np.array([1e-9])) == pytest.approx(model.response(np.array([1e-9])), rel=1e-6)
