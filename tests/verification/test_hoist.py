"""Block on its line, brake and heave: stiffness, modes, drill-off, forces of a heaving floor (manual: verif-hoist)."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from drillpetsc import Case, Session, modes
from drillpetsc.errors import SolveError
from drillpetsc.output import read_table
from drillpetsc.physics.top.hoisting import Heave, HeavingSpeed, Line, dead_line_share, fast_line_efficiency
from drillpetsc.time_function import Constant, Ramp
from tests.helpers.hoist_models import (
    AREA,
    DENSITY,
    DRILLABILITY,
    EA,
    HOIST,
    LINE_STIFFNESS,
    MATERIAL,
    SPEED,
    drilling,
    history,
    pipe,
)

G = 9.80665


def hanging(hoist: dict, pull: float, end: float = 1.0, length: float = 500.0, **more) -> dict:
    """Pipe that hangs on the block; ``pull`` [N] at its lower end."""
    return {
        "string": [pipe(length, 10)],
        "material": MATERIAL,
        "bottom": {"kind": "force", "force": [0, 0, pull]},
        "top": {"kind": "top_drive", "hoist": hoist},
        "time": {"end": end},
        "output": {"history_every": 0.05},
        **more,
    }


# ---------------------------------------------------------------------- line
def test_stiffness_of_the_line(tmp_path):
    """C7: ten lines of 20 m with EA 50 MN, fast line 40 m, dead line 35 m: 18.1818 MN/m, and 1.2 MN on the lines stretch them by
    66.0 mm; the dead line carries 120 kN; 1e-4."""
    pull = 1.2e6 - 25e3 * G - DENSITY * AREA * 500 * G
    got, summary = history(hanging(HOIST, pull), tmp_path / "run")
    assert summary["hoist"]["line_stiffness"] == pytest.approx(18.1818e6, rel=1e-4)
    assert summary["hoist"]["stretch"] == pytest.approx(66.0e-3, rel=1e-4)
    assert got["dead_line_tension"] == pytest.approx(120e3, rel=1e-4)
    assert got["hook_load_sensor"] == pytest.approx(1.2e6, rel=1e-4)
    assert got["hook_load"] == pytest.approx(1.2e6 - 25e3 * G, rel=1e-4)
    # at rest: the statics of the string is that of the block
    assert np.abs(got["block_position"] - 20).max() < 1e-8
    got, _ = history(hanging(HOIST | {"tare": True}, pull, 0.1), tmp_path / "tared")
    assert got["hook_load_sensor"] == pytest.approx(1.2e6 - 25e3 * G, rel=1e-4)


@pytest.mark.parametrize(("lines", "rope"), [(10, {}), (8, {"crown_height": 45.0, "height": 12.0})])
def test_a_load_lowers_the_block_by_its_share_of_the_stiffness(lines, rope, tmp_path):
    """A rope of 38 mm, 60 GPa and 0.45 d^2 of metal, loaded by 300 kN over 8 s: the block sinks by the load over
    n^2 EA/(n l + fast + dead)."""
    line = {"diameter": 0.038, "modulus": 60e9, "fill": 0.45}
    hoist = {"block_mass": 30e3, "lines": lines, "line": line, "height": 20.0, "damping": 2e5, **rope}
    length = hoist.get("crown_height", 40.0) - hoist["height"]
    k = lines**2 * 60e9 * 0.45 * 0.038**2 / (lines * length + 75)
    case = hanging(hoist, 0.0, 12.0, petsc={"ts_rtol": 1e-5})
    case["loads"] = [{"at": 500.0, "force": [0, 0, 3e5], "value_over": {"ramp": 8.0, "value": 1.0}}]
    got, summary = history(case, tmp_path / "run")
    assert summary["hoist"]["line_stiffness"] == pytest.approx(k, rel=1e-12)
    sunk = got["block_position"][0] - got["block_position"][-1]
    assert sunk == pytest.approx(3e5 / k, rel=1e-3)
    assert abs(summary["energy"]["error_share"]) < 1e-3


def test_lowering_a_stand_follows_the_drum(tmp_path):
    """15 m down in 12 s: the block has the drum's speed, the lines grow softer with the rope that is paid out, and the energy
    balance holds although rope leaves the drum with its strain energy."""
    pull = 1.0e6
    speed = {"time": [0, 1, 11, 12], "value": [0, 1.5, 1.5, 0]}
    hoist = HOIST | {"damping": 3e5, "sheave_efficiency": 0.98}
    case = hanging(hoist, pull, 16.0)
    case["top"]["lowering"] = speed
    got, summary = history(case, tmp_path / "run")
    load = got["line_tension"][0]
    assert got["block_position"][-1] == pytest.approx(20 - 16.5, abs=2e-3)
    steady = (got["time"] > 6) & (got["time"] < 10)
    assert got["block_speed"][steady].mean() == pytest.approx(1.5, rel=2e-4)
    assert got["block_speed"][steady] == pytest.approx(1.5, rel=5e-3)  # the string swings
    assert got["drum_speed"][steady] == pytest.approx(1.5, rel=1e-12)
    down = dead_line_share(0.98, 10, True)
    assert got["dead_line_tension"][steady] == pytest.approx(load * down, rel=5e-3)
    assert abs(summary["energy"]["error_share"]) < 1e-3


def test_friction_of_the_sheaves():
    """Efficiency of the fast line for K = 1.04: 0.8416, 0.8111, 0.7821 with 8, 10, 12 lines (API RP 9B).

    The tensions of the lines are a geometric series: those of the n lines add up to the load.
    """
    for lines, expected in ((8, 0.8416), (10, 0.8111), (12, 0.7821)):
        assert fast_line_efficiency(1 / 1.04, lines) == pytest.approx(expected, abs=5e-5)
        up, down = (dead_line_share(1 / 1.04, lines, way) for way in (False, True))
        assert up * (1.04 ** np.arange(lines)).sum() == pytest.approx(1)
        assert down * (1.04 ** -np.arange(lines)).sum() == pytest.approx(1)
        fast = 1 / (lines * fast_line_efficiency(1 / 1.04, lines))
        assert fast == pytest.approx(up * 1.04**lines)
    assert fast_line_efficiency(1.0, 10) == 1 and dead_line_share(1.0, 10, True) == 0.1
    assert fast_line_efficiency(1 - 1e-9, 10) == pytest.approx(1, abs=1e-7)


def test_the_sensor_shows_the_friction_of_the_sheaves(tmp_path):
    """Hoisted and lowered at the same load, the dead line carries less and more than at rest."""
    hoist = {**HOIST, "line": None, "sheave_efficiency": 0.98, "tare": True}
    del hoist["line"]
    case = hanging(hoist, 5e5, 0.2)
    seen = {}
    for speed in (0.5, 0.0, -0.5):
        case["top"]["lowering"] = speed
        got, _ = history(case, tmp_path / f"run{speed}")
        seen[speed] = got["hook_load_sensor"][-1] + 25e3 * G
        load = got["hook_load"][-1] + 25e3 * G
        way = {0.5: dead_line_share(0.98, 10, True), -0.5: dead_line_share(0.98, 10, False), 0.0: 0.1}[speed]
        assert seen[speed] == pytest.approx(10 * way * load, rel=1e-6)
    assert seen[0.5] > 1.05 * seen[0.0] > 1.05**2 * seen[-0.5]


def test_the_block_does_not_pass_floor_or_crown(tmp_path):
    """The run ends with status 1 at the time at which the block meets the floor, and keeps its results."""
    for speed, word, hoist in (
        (1.0, "floor", {"height": 1.5, "crown_height": 20.0}),
        (-1.0, "crown", {"crown_height": 21.0}),
    ):
        case = hanging(
            {**HOIST, **hoist},
            1e5,
            5.0,
            top={"kind": "top_drive", "lowering": speed, "hoist": {**HOIST, **hoist}},
        )
        with pytest.raises(SolveError, match=f"the block would pass the {word}") as error:
            history(case, tmp_path / word)
        assert error.value.time == pytest.approx(1.5 if word == "floor" else 1.0, abs=0.05)
        assert len(read_table(tmp_path / word / "history.csv")["time [s]"]) > 10


def test_the_drum_without_a_line_stops_at_the_floor(tmp_path):
    hoist = {"block_mass": 25e3, "height": 0.5}
    case = hanging(hoist, 1e5, 5.0, top={"kind": "top_drive", "lowering": 1.0, "hoist": hoist})
    with pytest.raises(SolveError, match="the block would pass the floor"):
        history(case, tmp_path / "run")


def test_a_quasi_static_run_leaves_the_hoist_out(tmp_path):
    case = hanging(HOIST, 1e5, 1.0)
    case["time"]["mode"] = "quasi_static"
    case["top"]["lowering"] = 0.1
    got, summary = history(case, tmp_path / "run")
    assert any(text.startswith("top.hoist: left out") for text in summary["warnings"])
    assert "block_position" not in got and "hoist" not in summary


@pytest.mark.parametrize("options", [{"ts_type": "beuler"}, {"ts_type": "cn"}, {"ts_type": "arkimex"}])
def test_other_time_formulas(options, tmp_path):
    """A load on the lines with other integrators of PETSc, whose system has the rates as unknowns."""
    hoist = HOIST | {"damping": 3e5}
    case = hanging(hoist, 2e5, 4.0, petsc={**options, "ts_rtol": 1e-4})
    case["top"]["lowering"] = {"ramp": 2.0, "value": 0.2}
    got, _ = history(case, tmp_path / "run")
    expected, _ = history(case | {"petsc": {"ts_rtol": 1e-5}}, tmp_path / "bdf")
    assert got["block_position"] == pytest.approx(expected["block_position"], abs=2e-3)
    assert got["block_position"][-1] == pytest.approx(20 - 0.2 * 3, abs=2e-3)


def test_a_run_goes_on_from_another(tmp_path):
    """`initial.from` a run: block, lines and autodriller go on where the other ended, at the time 0."""
    top = {"hoist": HOIST, "autodriller": {"wob": 50e3, "measure": "bit", "filter": 0.5, "ramp": 5e3}}
    first, _ = history(drilling(top, 500.0, time={"end": 12}, output={"history_every": 0.5}), tmp_path / "a")
    case = drilling(top, 500.0, time={"end": 8}, output={"history_every": 0.5})
    case["initial"] = {"from": str(tmp_path / "a")}
    second, _ = history(case, tmp_path / "b")
    whole, _ = history(drilling(top, 500.0, time={"end": 20}, output={"history_every": 0.5}), tmp_path / "c")
    assert second["block_position"][0] == pytest.approx(first["block_position"][-1], abs=1e-9)
    after = whole["time"] >= 12
    assert second["wob"] == pytest.approx(whole["wob"][after], abs=500)
    assert second["block_position"] == pytest.approx(whole["block_position"][after], abs=1e-3)


def test_a_heaving_run_goes_on_from_another(tmp_path):
    """The rig floor of the second run begins its own heave at its mean; lines and block go on where they were, without a jump."""
    case = heaving(0.3, 7.0, 500.0)
    case["top"]["hoist"] |= {key: HOIST[key] for key in ("line", "lines", "height")}
    case["time"]["end"] = 15.0
    first, _ = history(case, tmp_path / "a")
    case |= {"initial": {"from": str(tmp_path / "a")}, "time": {"end": 1.0}}
    case["top"]["hoist"]["heave"] = {"amplitude": {"ramp": 21.0, "value": 0.3}, "period": 7.0}
    second, _ = history(case, tmp_path / "b")
    assert abs(first["line_tension"][-1]) > 5e4
    assert second["line_tension"][0] == pytest.approx(first["line_tension"][-1], rel=1e-6)
    assert second["block_position"][0] == pytest.approx(first["block_position"][-1], abs=1e-9)
    change = np.abs(second["line_tension"] - second["line_tension"][0]).max()
    assert change < 0.5 * abs(second["line_tension"][0])


def test_slack_lines_are_reported(tmp_path):
    """A push from below that lifts block and string."""
    case = hanging(HOIST, 0.0, 1.0, initial={"from": "statics"})
    weight = 25e3 * G + DENSITY * AREA * 500 * G
    case["loads"] = [{"at": 0.0, "force": [0, 0, -1.2 * weight], "value_over": {"ramp": 0.8, "value": 1.0}}]
    _, summary = history(case, tmp_path / "run")
    assert 0.3 < summary["hoist"]["slack"] < 0.8
    assert any("the lines would be slack" in text for text in summary["warnings"])


# ---------------------------------------------------------------------- modes
def axial_roots(mass: float, k: float, length: float, count: int) -> list[float]:
    """Frequencies [Hz] of a block on a spring with a bar hanging free: k - m w^2 = EA (w/c) tan(w L/c)."""

    def f(w: float) -> float:
        x = w * length / SPEED
        return (k - mass * w**2) * np.cos(x) - EA * w / SPEED * np.sin(x)

    w = np.linspace(1e-3, 60 * SPEED / length, 60000)
    values = np.array([f(q) for q in w])
    at = np.flatnonzero(values[:-1] * values[1:] < 0)[:count]
    return [brentq(f, w[i], w[i + 1]) / (2 * np.pi) for i in at]


def axial_modes(
    hoist: dict | None, length: float, elements: int, folder, count: int = 3, **options
) -> np.ndarray:
    """Axial frequencies [Hz] of pipe that hangs free, without gravity."""
    top = {"kind": "top_drive"} | ({} if hoist is None else {"hoist": hoist})
    case = Case(string=[pipe(length, elements)], material=MATERIAL, top=top, gravity=0.0)
    result = modes(case, out=folder, kind="axial", count=count, **options)
    return read_table(result.folder / "modes.csv")["frequency [Hz]"]


def test_axial_modes_of_block_and_string(tmp_path):
    """C8: 25 t on the line of C7 with 1000 m of drill pipe: 1.22910, 3.47776, 4.61575 Hz, 0.2 %; held top 1.28067 Hz.

    Errors fall with the elements; the pay-out of the free drum is no mode.
    """
    expected = axial_roots(25e3, LINE_STIFFNESS, 1000.0, 3)
    assert expected == pytest.approx([1.22910, 3.47776, 4.61575], abs=1e-5)
    error = []
    for elements in (5, 10, 20):
        got = axial_modes(HOIST, 1000.0, elements, tmp_path / f"m{elements}")[:3]
        error.append(np.abs(got / expected - 1).max())
    assert error[2] < 2e-3 and error[0] > 10 * error[1] > 20 * error[2]
    held = axial_modes(HOIST, 1000.0, 20, tmp_path / "held", without_control=True)[0]
    assert held == pytest.approx(1.28067, rel=2e-3)


def test_axial_modes_of_another_rig(tmp_path):
    """45 t on 12 lines of a 35 mm rope at 35 m, 600 m of pipe, with gravity: the same frequencies as without."""
    hoist = {"block_mass": 45e3, "lines": 12, "line": {"diameter": 0.035}, "height": 35.0}
    k = Line(12, 1e11 * 0.4 * 0.035**2, 35.0, 40.0, 35.0).stiffness
    got = axial_modes(hoist, 600.0, 20, tmp_path / "m")[:3]
    assert got == pytest.approx(axial_roots(45e3, k, 600.0, 3), rel=1e-3)


# ---------------------------------------------------------------------- brake
@pytest.mark.parametrize(
    ("top", "stiffness"),
    [({}, np.inf), ({"hoist": {"block_mass": 25e3}}, np.inf), ({"hoist": HOIST}, LINE_STIFFNESS)],
)
def test_drill_off(top, stiffness, tmp_path):
    """C9: brake set on 2000 m under 100 kN: W = W0 exp(-k D t), 55.480 kN and 126.95 mm of hole after 60 s without line
    stiffness, 1 %; with the line of C7 its stiffness is in series."""
    case = drilling(top, wob=100e3, lying=True, time={"end": 60}, output={"history_every": 1.0})
    got, summary = history(case, tmp_path / "run")
    k = 1 / (2000 / EA + 1 / stiffness)
    expected = 100e3 * np.exp(-k * DRILLABILITY * got["time"])
    if np.isinf(stiffness):
        assert expected[-1] == pytest.approx(55.480e3, rel=1e-5)
        assert (1e5 - expected[-1]) / k == pytest.approx(126.95e-3, rel=1e-4)
    assert got["wob"] == pytest.approx(expected, rel=1e-2)
    assert got["hole_depth"][-1] - 2000 == pytest.approx((1e5 - expected[-1]) / k, rel=1e-2)
    assert abs(summary["energy"]["error_share"]) < 2e-3


# ---------------------------------------------------------------------- heave
def heaving(amplitude: float, period: float, length: float, **heave) -> dict:
    """Pipe between a heaving rig and a pinned lower end, without gravity; the heave grows over three periods."""
    return {
        "string": [pipe(length, 20)],
        "material": MATERIAL | {"damping": {"stiffness": 2e-3}},
        "bottom": {"kind": "pinned"},
        "gravity": 0.0,
        "top": {
            "kind": "top_drive",
            "hoist": {
                "block_mass": 25e3,
                "heave": {"amplitude": {"ramp": 3 * period, "value": amplitude}, "period": period, **heave},
            },
        },
        "time": {"end": 6 * period},
        "output": {"history_every": 0.02},
        "petsc": {"ts_rtol": 1e-5},
    }


@pytest.mark.parametrize(
    ("amplitude", "period", "length", "heave"),
    [(0.07, 11.0, 2000.0, {}), (0.5, 8.0, 3000.0, {"compensation": 0.9, "phase": 1.0})],
)
def test_heave_on_a_held_bit(amplitude, period, length, heave, tmp_path):
    """C11: 0.07 m in 11 s on 2000 m: 24.140 kN at the top and 24.753 kN at the bit, EA w/c a/tan and a/sin(w L/c), 0.5 %.

    The force at the pinned end is its reaction, read in a session.
    """
    case = heaving(amplitude, period, length, **heave)
    got, summary = history(case, tmp_path / "run")
    a = amplitude * (1 - heave.get("compensation", 0.0))
    w = 2 * np.pi / period
    x = w * length / SPEED
    top, bit = EA * w / SPEED * a / np.tan(x), EA * w / SPEED * a / np.sin(x)
    if not heave:
        assert [top, bit] == pytest.approx([24.140e3, 24.753e3], abs=1)
    late = got["time"] > 3 * period
    assert 0.5 * np.ptp(got["hook_load"][late]) == pytest.approx(top, rel=5e-3)
    travelled = got["top_travel"][late]
    assert 0.5 * np.ptp(travelled) == pytest.approx(a, rel=1e-3)
    assert 0.5 * np.ptp(got["block_position"][late]) == pytest.approx(amplitude - a, abs=1e-3 * amplitude)
    assert abs(summary["energy"]["error_share"]) < 1e-2
    force = []
    with Session(Case(**case)) as s:
        s.step(3 * period)
        for _ in range(150):
            s.step(period / 75)
            force.append(s._model.system.reaction("bottom.axial_reaction"))
    assert 0.5 * np.ptp(force) == pytest.approx(bit, rel=5e-3)


def test_heave_reaches_the_line(tmp_path):
    """With a line the heave moves its crown: the force is EA w/c a/tan over 1 + (EA w/c/tan - m w^2)/k."""
    case = heaving(0.07, 11.0, 2000.0)
    case["top"]["hoist"] |= {key: HOIST[key] for key in ("line", "lines", "height")}
    got, summary = history(case, tmp_path / "run")
    w = 2 * np.pi / 11
    stiff = EA * w / SPEED / np.tan(w * 2000 / SPEED)
    late = got["time"] > 33
    moved = 0.07 / (1 + (stiff - 25e3 * w**2) / LINE_STIFFNESS)
    assert 0.5 * np.ptp(got["hook_load"][late]) == pytest.approx(stiff * moved, rel=5e-3)
    assert 0.5 * np.ptp(got["top_travel"][late]) == pytest.approx(moved, rel=5e-3)
    assert abs(summary["energy"]["error_share"]) < 1e-2


def test_heaving_speed_is_the_derivative_of_the_way():
    heave = Heave(Ramp(7.0, 0.4), 5.0, 0.3, 0.25)
    speed = HeavingSpeed(Constant(0.2), heave)
    for t in (0.2, 1.3, 6.9, 20.0):
        h = 1e-5
        assert (speed.integral(t + h) - speed.integral(t - h)) / (2 * h) == pytest.approx(
            speed.value(t), abs=1e-7
        )
        assert (speed.value(t + h) - speed.value(t - h)) / (2 * h) == pytest.approx(speed.rate(t), abs=1e-6)
    assert speed.integral(0.0) == 0
