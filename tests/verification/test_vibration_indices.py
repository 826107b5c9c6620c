"""Indices of runs against closed forms; the command, the pictures and the Python face (manual: sec-vibration-indices)."""

from __future__ import annotations

import shutil

import numpy as np
import pytest

import drillpetsc as dp
from drillpetsc import Case, vibration
from drillpetsc.cli import main
from drillpetsc.errors import CaseError
from drillpetsc.output import read_table
from drillpetsc.output.indices import _drilling
from tests.helpers.command import main_succeeds
from tests.helpers.wells import simple_well

AREA = np.pi / 4 * 0.2159**2
PIPE = {"kind": "pipe", "name": "dp", "od": 0.127, "id": 0.1086, "length": 20.0, "element_length": 5.0}


def turning(rotation, end: float, *sensors: dict, **output) -> Case:
    """Two metres of level pipe, so stiff that both ends turn alike; its sag tilts it by less than 0.0003."""
    return Case(
        string=[{**PIPE, "length": 2.0, "element_length": 0.5}],
        top={"kind": "top_drive", "rotation": rotation},
        initial={"from": "statics", "inclination": "90 deg"},
        time={"end": end},
        output={"history_every": 0.01, "sensors": list(sensors), **output},
    )


def columns(result) -> dict[str, np.ndarray]:
    table = read_table(result.folder / "indices.csv")
    return {title.split(" [")[0]: values for title, values in table.items()}


def test_stick_slip_index_of_a_run(tmp_path):
    """C27: 1 + 0.8 of a triangle wave of 2 s about w0 = 10 rad/s: 0.80 in windows of whole periods; never stuck."""
    corners = {"time": [0, 1, 2, 3, 4], "value": [2.0, 18.0, 2.0, 18.0, 2.0]}
    result = dp.run(
        turning(corners, 4.0, indices={"window": 2.0, "every": 0.5}), tmp_path / "r", progress="silent"
    )
    got = columns(result)
    assert got["time"] == pytest.approx([2.0, 2.5, 3.0, 3.5, 4.0])
    assert got["stick_slip"] == pytest.approx(np.full(5, 0.80), abs=1e-3)
    assert got["rotation"] == pytest.approx(np.full(5, 10.0), rel=1e-3)
    assert np.all(got["stuck_share"] == 0)
    assert result.summary["vibration"]["largest"]["stick_slip [-]"] == pytest.approx(0.80, abs=1e-3)
    assert result.summary["vibration"]["windows"] == 5


def test_a_bit_that_sticks_half_of_the_time(tmp_path):
    """0 for 2 s, up to w and down again in 2 s, whose mean is w/4: (w - 0)/(2 w/4) = 2, and stuck for half of the time."""
    corners = {"time": [0, 2, 3, 4], "value": [0.0, 0.0, 20.0, 0.0]}
    result = dp.run(turning(corners, 4.0, indices={"window": 4.0}), tmp_path / "r", progress="silent")
    got = columns(result)
    assert got["stick_slip"] == pytest.approx([2.0], rel=5e-3)
    assert got["stuck_share"] == pytest.approx([0.5 + 0.5 * vibration.indices.STUCK / 20.0], abs=5e-3)


def drilling(**law) -> Case:
    """A bit that drills 4 mm/s at 2 turns a second without inertia."""
    return Case(
        string=[
            {"kind": "pipe", "length": 29.5, "od": 0.1715, "id": 0.0714, "element_length": 5.0},
            {"kind": "bit", "length": 0.5, "od": 0.2159, "mass": 60.0},
        ],
        well=simple_well(30, 0.2159, friction=0.0),
        contact="none",
        bottom="bit",
        formation={"drillability": 2.8e-8, "bit_law": {"kind": "drag_bit", **law}},
        top={"kind": "top_drive", "rotation": 4 * np.pi, "lowering": 0.004},
        initial={"from": "statics", "wob": 30e3},
        time={"end": 4.0, "mode": "quasi_static"},
        output={"history_every": 0.05, "indices": {"window": 1.0, "every": 1.0}},
    )


def test_specific_energy_of_a_sharp_drag_bit(tmp_path):
    """C26: the energy of a sharp bit is its intrinsic specific energy and W/A (Detournay and Defourny 1992).

    Its depth of cut is 4 mm/s over 2 turns a second; W is the inclination ratio times the energy times cut times radius.
    """
    result = dp.run(drilling(wear_flat=0.0, specific_energy=60e6), tmp_path / "r", progress="silent")
    got, cut = columns(result), 0.004 / 2
    weight = 0.6 * 60e6 * 0.10795 * cut
    assert got["depth_of_cut"][1:] == pytest.approx(np.full(3, cut), rel=1e-4)
    assert got["mse"][1:] == pytest.approx(np.full(3, 60e6 + weight / AREA), rel=1e-4)
    assert got["efficiency"][1:] == pytest.approx(60e6 / (60e6 + weight / AREA), rel=1e-4)
    history = {t.split(" [")[0]: v for t, v in read_table(result.folder / "history.csv").items()}
    last = {name: history[name][-1] for name in ("wob", "bit_torque", "bit_speed", "rop")}
    hand = vibration.mechanical_specific_energy(*last.values(), 0.2159)
    assert got["mse"][-1] == pytest.approx(hand, rel=1e-6)


def test_no_progress_is_said(tmp_path):
    """A bit off the bottom: the energy is not a number, and a warning says why; so is a string that does not turn.  Rock that cannot
    be drilled has no columns of drilling."""
    case = drilling().replace(
        {
            "top.lowering": 0.0,
            "well.survey.md": [0, 31],
            "well.sections[0].to": 31,
            "initial": {"from": "statics"},
            "time": {"end": 0.5},
        }
    )
    result = dp.run(case, tmp_path / "r", progress="silent")
    assert np.isnan(columns(result)["mse"]).all()
    assert result.summary["vibration"]["largest"]["mse [Pa]"] is None
    assert any("no progress" in text for text in result.summary["warnings"])
    hard = case.replace({"formation.drillability": 0.0})
    assert "mse" not in columns(dp.run(hard, tmp_path / "h", progress="silent"))
    still = dp.run(turning(0.0, 1.0, indices={"window": 0.5}), tmp_path / "s", progress="silent")
    assert np.isnan(columns(still)["stick_slip"]).all()
    assert any("less than 1 rpm" in text for text in still.summary["warnings"])


def test_a_run_shorter_than_a_window(tmp_path):
    """One row over the run, its length beside it, and a warning."""
    result = dp.run(turning(10.0, 1.0, indices=True), tmp_path / "r", progress="silent")
    got = columns(result)
    assert got["time"] == pytest.approx([1.0]) and got["window"] == pytest.approx([1.0])
    assert any("shorter than a window of 20 s" in text for text in result.summary["warnings"])


def test_acceleration_indices_take_gravity_off(tmp_path):
    """A level pipe at 120 rpm: sensors on the axis and 60 mm off it, both with gravity: 0 and w^2 r; torsional 0."""
    sensors = [
        {"name": name, "at": "1 m", "rate": "100 Hz", "radius": radius, "channels": ["ax", "ay", "az", "rpm"]}
        for name, radius in (("axis", 0.0), ("off", 0.06))
    ]
    case = turning("120 rpm", 2.0, *sensors, indices={"window": 1.0})
    result = dp.run(case, tmp_path / "r", progress="silent")
    got = columns(result)
    assert got["rms_lateral_axis"] == pytest.approx(np.zeros(2), abs=1e-3)
    assert got["rms_lateral_off"] == pytest.approx(np.full(2, (4 * np.pi) ** 2 * 0.06), rel=1e-4)
    assert got["peak_lateral_off"] == pytest.approx(got["rms_lateral_off"], rel=1e-4)
    assert got["rms_torsional_off"] == pytest.approx(np.zeros(2), abs=1e-3)
    assert list(got["impacts_off"]) == [0, 0] and "rms_torsional_axis" not in got
    assert set(result.sensors) == {"axis", "off"}
    measured = np.hypot(*(np.asarray(result.sensors["axis"][c]) for c in ("ay", "az")))
    assert measured == pytest.approx(np.full(201, 9.80665), rel=1e-3)


def test_torsional_acceleration_of_a_ramp(tmp_path):
    """Rotation that grows by 5 rad/s a second: 60 mm times 5 rad/s2."""
    sensor = {"name": "mwd", "at": "1 m", "rate": "200 Hz", "radius": 0.06, "gravity": False}
    ramp = {"time": [0, 2], "value": [10.0, 20.0]}
    case = turning(ramp, 2.0, sensor, indices={"window": 1.0})
    result = dp.run(case, tmp_path / "r", progress="silent")
    assert columns(result)["rms_torsional_mwd"][-1] == pytest.approx(0.3, rel=1e-2)
    # and the accelerometer sideways shows it: 0.3 m/s2
    assert np.asarray(result.sensors["mwd"]["az"])[200:] == pytest.approx(np.full(201, 0.3), rel=2e-2)


def test_synchronous_whirl_of_an_unbalanced_collar(tmp_path):
    """Forced whirl of an eccentric collar between two bearings: once a turn, off the wall; the probe at the end does not whirl."""
    case = Case(
        string=[
            {**PIPE, "od": 0.1778, "id": 0.0714, "length": 20.0, "element_length": 2.5, "eccentricity": 0.01}
        ],
        material={"damping": {"mass": 5.0}},
        well=simple_well(21, 0.2159),
        top={"kind": "top_drive", "rotation": 6.0},
        bottom="pinned",
        gravity=0.0,
        initial={"from": "straight"},
        time={"end": 8.0},
        output={"history_every": 0.01, "probes": [10.0, 19.99], "indices": {"window": 2.0, "every": 0.5}},
    )
    result = dp.run(case, tmp_path / "r", progress="silent")
    got = columns(result)
    late = got["time"] >= 6.0
    assert set(got["whirl_10"][late]) == {"forward synchronous"}
    assert got["whirl_ratio_10"][late] == pytest.approx(np.ones(late.sum()), abs=0.05)
    assert set(got["whirl_19.99"][late]) == {"none"}
    assert result.summary["vibration"]["whirl"]["10"]["forward synchronous"] > 0.3


@pytest.fixture(scope="module")
def ramp(tmp_path_factory):
    """A level pipe from 60 to 180 rpm in 30 s, seen by a filtered accelerometer."""
    sensor = {"name": "mwd", "at": "1 m", "rate": "100 Hz", "filter": {"cutoff": 30, "order": 4}}
    rotation = {"time": [0, 30], "value": ["60 rpm", "180 rpm"]}
    case = turning(rotation, 30.0, sensor, indices={"window": 10.0})
    return dp.run(case, tmp_path_factory.mktemp("ramp") / "r", progress="silent")


def test_order_of_gravity_in_a_ramp(ramp):
    """C29 in a run: gravity in a turning level pipe is a tone of order 1 and 1 g, throughout the ramp."""
    table = ramp.sensors["mwd"]
    time, ay, spin = (np.asarray(table[name]) for name in ("time", "ay", "spin"))
    found = vibration.order_map(time, ay, spin, 8.0)
    assert vibration.ridge(found, 0.3, 6.0) == pytest.approx(1.0, abs=0.02)
    line = np.argmin(np.abs(found.frequency - 1.0))
    assert found.amplitude[:, line] / 9.80665 == pytest.approx(1.0, rel=1e-2)
    # over the frequency it is at 1 Hz at first and at 3 Hz at last
    over_time = vibration.spectrogram(time, ay, 2.0)
    peaks = vibration.ridge(over_time, 0.3, 10.0)
    assert peaks == pytest.approx(1.0 + over_time.time / 15.0, abs=0.05)


def test_pictures_and_command(ramp, tmp_path, capsys):
    """`plot` draws what there is, `--waterfall` and `--psd` one signal; `vibration` writes indices.csv in other windows."""
    folder = tmp_path / "r"
    shutil.copytree(ramp.folder, folder)
    arguments = ["--waterfall", "mwd:ay", "--psd", "history:bit_speed", "--out", str(tmp_path / "p")]
    main_succeeds("plot", folder, *arguments)
    main_succeeds("plot", folder, "--waterfall", "mwd:ay", "--order", "--out", tmp_path / "p")
    names = {file.name for file in (tmp_path / "p").iterdir()}
    assert names == {"waterfall_mwd_ay.png", "psd_history_bit_speed.png", "orders_mwd_ay.png"}
    assert {"indices", "sensor_mwd"} <= set(_names(folder))
    main_succeeds("vibration", folder, "--window", "5 s", "--every", "2.5")
    printed = capsys.readouterr().out
    assert "11 windows of 5 s" in printed and "Stick-slip index" in printed
    assert len(read_table(folder / "indices.csv")["time [s]"]) == 11
    again = dp.open_run(folder)
    assert again.indices.sizes["time"] == 11
    drawn = again.waterfall("mwd:ay", order=True)
    assert "order" in drawn.axes[0].get_ylabel()


def _names(folder) -> list[str]:
    from drillpetsc.plotting.run.plot import picture_names

    return picture_names(folder)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["plot", "--waterfall", "mwd:ayy"], "mwd: with one of"),
        (["plot", "--waterfall", "nobody:ay"], "history, mwd"),
        (["plot", "--order"], "--waterfall SIGNAL beside it"),
        (["plot", "--psd", "mwd:ay", "--segment", "0 s"], "a time above 0"),
        (["vibration", "--window", "0"], "a time above 0"),
    ],
)
def test_refused(ramp, arguments, message, capsys):
    """Exit status 2 and one message."""
    assert main([arguments[0], str(ramp.folder), *arguments[1:]]) == 2
    assert message in capsys.readouterr().err


def test_a_folder_without_a_run(tmp_path):
    """Statics have no indices."""
    result = dp.statics(Case(string=[PIPE], top="clamped"), tmp_path / "s")
    with pytest.raises(CaseError, match="no history"):
        result.find_indices()


def test_too_few_rows_and_too_many_windows(tmp_path, capsys):
    """A run with one row of history is done without indices, and says so; windows without end are refused before it."""
    result = dp.run(turning(10.0, 0.5, indices=True, history_every=1.0), tmp_path / "r", progress="silent")
    assert result.status == "done" and "vibration" not in result.summary
    assert any("indices: none" in text and "at least 2" in text for text in result.summary["warnings"])
    with pytest.raises(CaseError, match="windows in the run"):
        turning(10.0, 5.0, indices={"window": 1.0, "every": 1e-6})
    dp.run(turning(10.0, 2.0), tmp_path / "s", progress="silent")
    assert main(["vibration", str(tmp_path / "s"), "--window", "1 s", "--every", "1e-6 s"]) == 2
    assert "windows in the run" in capsys.readouterr().err


def test_the_work_of_a_torque_that_swings_with_the_speed_counts():
    """T = T_0 + T_1 sin, w = w_0 + w_1 sin over whole periods: the mean power is T_0 w_0 + T_1 w_1/2."""
    t, case = np.linspace(0.0, 2.0, 401), drilling()
    swing = np.sin(2 * np.pi * t)
    history = {
        "time": t,
        "bit_speed": 10 + 6 * swing,
        "rop": 0 * t + 0.004,
        "wob": 0 * t + 5e4,
        "bit_torque": 3e3 + 1e3 * swing,
    }
    energy = _drilling(history, [slice(0, 401)], case)["mse", "Pa"]
    assert energy == pytest.approx([5e4 / AREA + (3e4 + 3e3) / (AREA * 0.004)], rel=1e-4)
