"""Loops of an autodriller in linear models: roots of string, line and loop, and steps beside a session (manual:
verif-linear-autodriller)."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg

from drillpetsc import Case, Session, campbell, linearise, modes, stability
from drillpetsc.errors import CaseError
from drillpetsc.output import read_table
from tests.helpers.hoist_models import DRILLABILITY, EA, HOIST, LINE_STIFFNESS, MATERIAL, drilling, pipe
from tests.helpers.wells import simple_well

BIT_STIFFNESS = 1e8  # [N/m]
FRICTION = 0.3  # of the bit


def series(length: float) -> float:
    """Stiffness of string, line and bit [N/m]."""
    return 1 / (length / EA + 1 / LINE_STIFFNESS + 1 / BIT_STIFFNESS)


def drill(autodriller: dict, length: float, damping: float = 0.0) -> dict:
    """A string that lies in a level hole on a bit with 20 kN, under an autodriller; damping: of its stiffness [s]."""
    top = {"hoist": HOIST, "autodriller": autodriller, "rotation": 10.0}
    case = drilling(top, length, wob=20e3, lying=True, time={"end": 1.0})
    case["string"] = [pipe(length, 30)]
    case["material"] = MATERIAL | {"damping": {"stiffness": damping}}
    case["bottom"] = {"kind": "bit", "stiffness": BIT_STIFFNESS, "friction": FRICTION}
    return case


def torque_over_weight(case: dict) -> float:
    """Torque of the bit over its weight [m], from the start of a run."""
    with Session(Case(**(case | {"initial": {"wob": 20e3}}))) as s:
        s.step(1e-3)
        return s.get("bit_torque") / s.get("wob")


def slow_roots(case: dict, folder, count: int = 2) -> np.ndarray:
    """Roots of the axial modes below 0.1 Hz, imaginary parts not negative [1/s]."""
    table = read_table(modes(Case(**case), folder, kind="axial", count=count).folder / "modes.csv")
    root = table["growth [1/s]"] + 2j * np.pi * table["frequency [Hz]"]
    return root[(root.imag < 0.7) & (np.abs(root) > 1e-6)]


def loop_roots(length: float, gain: float, reset: float, lag: float = 0.0) -> np.ndarray:
    """Roots of s W = k (v - D W), v = -(p + i/s) W/(1 + lag s)."""
    k = series(length)
    own = np.polymul([lag, 1.0], [1.0, k * DRILLABILITY, 0.0])
    return np.roots(np.polyadd(own, [k * gain, k * reset]))


@pytest.mark.parametrize(
    ("length", "keys", "lag"),
    [
        (800.0, {"wob": 50e3, "measure": "bit", "p": 4e-8, "i": 6e-9, "filter": 3.0}, 3.0),
        (1200.0, {"wob": 70e3, "measure": "bit", "p": 6e-8, "i": 5e-9, "sample": 2.0}, 1.0),
        (1200.0, {"wob": 70e3, "p": 6e-8, "i": 5e-9, "sample": 2.0, "filter": 1.5}, 2.5),
    ],
    ids=["filter", "sample", "surface"],
)
def test_roots_of_a_weight_loop(length, keys, lag, tmp_path):
    """The weight is measured at the bit, filtered or sampled: 1 % of the root; the same in ``linearise``."""
    case = drill(keys, length)
    expected = loop_roots(length, keys.get("p", 5e-8), keys.get("i", 2e-9), lag)
    expected = expected[(expected.imag >= 0) & (np.abs(expected) < 0.7)]
    found = slow_roots(case, tmp_path / "m")
    assert np.abs(found - expected[expected.imag > 0][0]).min() < 1e-3 * np.abs(expected).max()
    A = linearise(Case(**case), ["top.autodriller.wob"], ["wob"], tmp_path / "l").system.A
    for root in expected:
        assert np.abs(np.linalg.eigvals(A) - root).min() < 1e-2 * abs(root)


@pytest.mark.parametrize(("length", "p", "i"), [(2000.0, 1e-6, 6e-8), (700.0, 5e-7, 9e-8)])
def test_roots_of_a_torque_loop(length, p, i, tmp_path):
    """The torque at the top is that of the bit, in proportion to its weight."""
    case = drill({"mode": "torque", "torque": 3e3, "torque_p": p, "torque_i": i}, length)
    ratio = torque_over_weight(case)
    expected = loop_roots(length, p * ratio, i * ratio)
    expected = expected[expected.imag >= 0]
    found = slow_roots(case, tmp_path / "m")
    for root in expected:
        assert np.abs(found - root).min() < 1e-2 * abs(root)


def step(system, time: np.ndarray, size: float) -> np.ndarray:
    """Answer (k, outputs) to a step of the only input."""
    n, h = system.order, time[1] - time[0]
    whole = np.zeros((n + 1, n + 1))
    whole[:n, :n], whole[:n, n] = system.A * h, system.B[:, 0] * h
    over = scipy.linalg.expm(whole)
    x, out = np.append(np.zeros(n), size), []
    for _ in time:
        out.append(system.C @ x[:n] + system.D[:, 0] * size)
        x = over @ x
    return np.array(out)


@pytest.mark.parametrize(
    "keys",
    [
        {"wob": 20e3, "measure": "bit", "filter": 0.5},
        {"wob": 20e3, "p": 8e-8, "i": 6e-9},
        {"mode": "torque", "torque": 0.0, "torque_p": 1e-6, "torque_i": 8e-8},
    ],
    ids=["bit", "surface", "torque"],
)
def test_a_step_of_the_set_point_is_that_of_a_session(keys, tmp_path):
    """Hook load after a small step of the set point, from steady drilling, within 1 % of the largest change."""
    name = "torque" if "torque" in keys else "wob"
    case = drill(keys | {"reverse": True, "from": 0.1}, 600.0, damping=5e-3)
    case["top"]["lowering"] = DRILLABILITY * 20e3
    if name == "torque":
        case["top"]["autodriller"]["torque"] = 20e3 * torque_over_weight(case)
    goal = case["top"]["autodriller"][name]
    result = linearise(Case(**case), [f"top.autodriller.{name}"], ["hook_load"], tmp_path / "l")
    time = np.arange(0.0, 40.0, 0.5)
    size = 0.2 * goal
    linear = step(result.system, time, size)[:, 0]
    with Session(Case(**case)) as s:
        s.step(5.0)
        start = s.get("hook_load")
        s.set(f"top.autodriller.{name}", goal + size)
        found = []
        for _ in time:
            found.append(s.get("hook_load") - start)
            s.step(0.5)
    assert np.abs(np.array(found) - linear).max() < 1e-2 * np.abs(linear).max()


def test_a_step_of_differential_pressure_is_that_of_a_session(tmp_path):
    """Pump pressure of mud that drives a motor: torque of the bit, pressure of the motor, drum; 1 % of the largest change."""
    section = {
        "rev_per_volume": "0.29 rev/gal",
        "no_load_pressure": 6e5,
        "stall_torque": 14e3,
        "lobes": [7, 8],
    }
    size = {"od": 0.1715, "id": 0.1}
    goal = {"differential_pressure": 0.0, "pressure_p": 5e-9, "pressure_i": 1.2e-9}
    case = Case(
        well=simple_well(200, 0.2159, 0.02, azimuth=0.5, friction=0.0),
        string=[
            {"kind": "pipe", "length": 150, "element_length": 15, "od": 0.127, "id": 0.1086},
            {"kind": "pipe", "length": 41.4, "element_length": 6.9, "od": 0.1715, "id": 0.0714},
            {"kind": "pdm", "length": 8.3, **size, "mass": 1050, "joint_at": 7.7, "pdm": section},
            {"kind": "bit", "length": 0.3, "od": 0.2159, "mass": 60, "nozzle_area": 400e-6},
        ],
        material={"damping": {"stiffness": 2e-3}},
        fluid={
            "density": 1200,
            "rheology": {"model": "power_law", "consistency": "0.5 Pa s^n", "index": 0.7},
            "flow_rate": 0.03,
            "swirl": "none",  # in a linear model it stays that of the steady state: 1.3 % here
        },
        top={
            "kind": "top_drive",
            "rotation": 6.0,
            "hoist": HOIST,
            "lowering": 4.2e-8 * 20e3,
            "autodriller": goal | {"mode": "differential_pressure", "from": 0.1, "reverse": True},
        },
        bottom={"kind": "bit", "friction": 0.5},
        formation={"drillability": 4.2e-8, "rotary_exponent": 0, "bit_anisotropy": 1.0},
        initial={"wob": 20e3},
        time={"end": 1.0},
    )
    name = "top.autodriller.differential_pressure"
    system = linearise(case, [name], ["hook_load"], tmp_path / "l").system
    time = np.arange(0.0, 8.0, 0.25)
    linear = step(system, time, 5e4)[:, 0]
    with Session(case) as s:
        s.step(8.0)
        start, found = s.get("hook_load"), []
        s.set(name, 5e4)
        for _ in time:
            found.append(s.get("hook_load") - start)
            s.step(0.25)
    assert np.abs(linear).max() > 2e3
    assert np.abs(np.array(found) - linear).max() < 1e-2 * np.abs(linear).max()


def test_the_loop_in_charge(tmp_path):
    """Of several loops the one with the least speed is closed; with ``rop`` none, and the weight decays as with the drum held."""
    keys = {"mode": ["wob", "rop"], "wob": 60e3, "rop": 1e-4}
    held = modes(Case(**drill(keys, 900.0)), tmp_path / "rop", kind="axial", count=2)
    assert any("(rop): no loop of it is closed" in w for w in held.summary["warnings"])
    s = np.linalg.eigvals(
        linearise(Case(**drill(keys, 900.0)), ["top.autodriller.rop"], ["wob"], tmp_path / "r").system.A
    )
    decay = series(900.0) * DRILLABILITY
    assert np.abs(s + decay).min() < 1e-2 * decay
    keys |= {"rop": 0.05}
    closed = modes(Case(**drill(keys, 900.0)), tmp_path / "wob", kind="axial", count=2)
    assert any("loop wob is in charge of its loops" in w for w in closed.summary["warnings"])
    with pytest.raises(CaseError, match="top.lowering"):
        linearise(Case(**drill(keys, 900.0)), ["top.lowering"], ["wob"], tmp_path / "l")


def test_campbell_and_stability_hold_the_loop(tmp_path):
    """The root of the weight loop at all speeds, and the growth of the slowest mode in the map."""
    case = drill({"wob": 20e3, "measure": "bit", "p": 4e-7, "i": 1.5e-7}, 600.0)
    expected = loop_roots(600.0, 4e-7, 1.5e-7)
    root = expected[expected.imag > 0][0]
    campbell(Case(**case), tmp_path / "c", speeds="40,80,120 rpm", count=2, kind="axial")
    rows = read_table(tmp_path / "c" / "campbell.csv")
    slow = rows["frequency [Hz]"] < 0.1
    assert slow.sum() == 3
    assert rows["growth [1/s]"][slow] == pytest.approx(root.real, rel=1e-2)
    assert 2 * np.pi * rows["frequency [Hz]"][slow] == pytest.approx(root.imag, rel=1e-2)
    # an integrator that is too fast for its filter
    keys = {"wob": 20e3, "measure": "bit", "p": 4e-7, "i": 1.5e-7, "filter": 20.0}
    grows = loop_roots(600.0, 4e-7, 1.5e-7, 20.0).real.max()
    assert grows > 0.01
    stability(
        Case(**drill(keys, 600.0)), tmp_path / "s", speeds="60,90 rpm", wob="15 kN", count=2, kind="axial"
    )
    points = read_table(tmp_path / "s" / "stability_map.csv")
    assert points["largest_growth [1/s]"] == pytest.approx(grows, rel=1e-2)
