"""Downhole sensors against rigid rotation, gravity, statics and a swinging mass (manual: sec-vibration-sensors)."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from drillpetsc import Case, Session, run
from drillpetsc.errors import CaseError
from drillpetsc.output import read_table
from drillpetsc.output.sensors.files import read_sensor
from tests.helpers.wells import newtonian

G = 9.80665
PIPE = {"kind": "pipe", "name": "dp", "od": 0.127, "id": 0.1086, "length": 20.0, "element_length": 5.0}
AREA = np.pi / 4 * (0.127**2 - 0.1086**2)


def hanging(sensor: dict, *, rpm: float = 150.0, end: float = 1.0, **more) -> Case:
    """A straight pipe that turns, without gravity."""
    keys = {
        "string": [PIPE],
        "top": {"kind": "top_drive", "rotation": f"{rpm} rpm"},
        "gravity": 0.0,
        "initial": {"from": "straight"},
        "time": {"end": end},
        "output": {"sensors": [{"name": "mwd", "at": "12 m", "rate": "100 Hz", **sensor}]},
    }
    return Case(**{**keys, **more})


def level(*sensors: dict, end: float = 2.0, **output) -> Case:
    """Two metres of level pipe at 120 rpm, held at one end; its sag tilts it by less than 0.0003."""
    return Case(
        string=[{**PIPE, "length": 2.0, "element_length": 0.5}],
        top={"kind": "top_drive", "rotation": "120 rpm"},
        initial={"from": "statics", "inclination": "90 deg"},
        time={"end": end},
        output={"sensors": list(sensors), **output},
    )


def columns(folder: Path, name: str = "mwd") -> dict[str, np.ndarray]:
    return {title.split(" [")[0]: values for title, values in read_sensor(folder, name).items()}


@pytest.mark.parametrize("cutoff", [None, 20.0])
def test_accelerometer_off_the_axis(tmp_path, cutoff):
    """C28: 60 mm off the axis at 150 rpm, without gravity: w^2 r = 1.50963 g towards the axis, whatever the filter."""
    case = hanging({"radius": "60 mm", "gravity": False, "filter": {"cutoff": cutoff} if cutoff else None})
    run(case, tmp_path / "r", progress="silent")
    got = columns(tmp_path / "r")
    assert got["time"] == pytest.approx(np.arange(101) / 100, abs=1e-15)
    assert got["ay"] == pytest.approx(np.full(101, -1.50963 * G), rel=1e-4)
    for name in ("ax", "az"):
        assert np.abs(got[name]).max() < 5e-3 * 1.5 * G
    for name in ("spin", "magnetic_rate"):
        assert got[name] == pytest.approx(np.full(101, 5 * np.pi), rel=1e-6)


def test_gravity_in_a_level_pipe(tmp_path):
    """C28: on the axis of a level pipe at 120 rpm: a sine of 1.0000 g (rms 0.70711 g) at 2 Hz; nothing along the pipe."""
    case = level({"name": "mwd", "at": "1.3 m", "rate": "100 Hz", "channels": ["ax", "ay", "az"]})
    run(case, tmp_path / "r", progress="silent")
    got = columns(tmp_path / "r")
    ay = got["ay"][:-1] / G
    assert np.sqrt(np.mean(ay**2)) == pytest.approx(0.70711, rel=5e-3)
    assert np.abs(ay).max() == pytest.approx(1.0, rel=5e-3)
    assert np.argmax(np.abs(np.fft.rfft(ay))) == 4  # cycles in 2 s
    assert np.abs(got["ax"]).max() < 5e-3 * G
    # ay begins on the high side, where gravity pulls away from it: the accelerometer shows + 1 g
    assert got["ay"][0] == pytest.approx(G, rel=1e-3)
    assert got["ay"][:-1] ** 2 + got["az"][:-1] ** 2 == pytest.approx(np.full(200, G**2), rel=2e-3)


def test_accelerometer_at_rest_shows_minus_gravity(tmp_path):
    """A vertical pipe that stands still: -1 g along the string, 0 across; without `gravity` 0."""
    sensors = [
        {"name": name, "at": "12 m", "rate": "50 Hz", "gravity": name == "real", "channels": ["ax", "ay"]}
        for name in ("real", "ideal")
    ]
    case = hanging({}, rpm=0.0, end=0.2, gravity=G, initial={"from": "statics"}, output={"sensors": sensors})
    run(case, tmp_path / "r", progress="silent")
    assert columns(tmp_path / "r", "real")["ax"] == pytest.approx(np.full(11, -G), rel=1e-6)
    for name, channel in (("real", "ay"), ("ideal", "ax"), ("ideal", "ay")):
        assert np.abs(columns(tmp_path / "r", name)[channel]).max() < 1e-4


def test_loads_of_the_section(tmp_path):
    """Weight below a place, and the moment q (L - s)^2/2 of a level cantilever of weight q per length.

    The element's curvature is straight, so its moment is off by q h^2/12 (1 - 6 u + 6 u^2) at the part u of an element of length h.
    """
    sensor = {"name": "mwd", "at": "1.25 m", "rate": "50 Hz", "channels": ["wob", "torque", "bending"]}
    run(level(sensor, end=0.5), tmp_path / "level", progress="silent")
    got = columns(tmp_path / "level")
    weight = 7850 * AREA * G
    exact, error = weight * 0.75**2 / 2, weight * 0.5**2 / 12 * 0.5
    assert np.hypot(got["bending_y"], got["bending_z"]) == pytest.approx(np.full(26, exact + error), rel=2e-3)
    # ay begins on the high side; a cantilever bends down
    assert got["bending_y"][0] == pytest.approx(-(exact + error), rel=2e-3)
    case = hanging({"channels": ["wob", "torque"]}, end=0.2, gravity=G, initial={"from": "statics"})
    run(case, tmp_path / "hang", progress="silent")
    assert columns(tmp_path / "hang")["downhole_wob"] == pytest.approx(np.full(21, -weight * 8.0), rel=1e-4)
    # a moment that turns the lower end anticlockwise: the part above turns the part below clockwise
    case = hanging({"channels": ["torque"]}, rpm=0.0, end=0.1, initial={"from": "statics"})
    case = case.replace({"loads": [{"at": 20.0, "moment": [0, 0, -1000.0]}]})
    run(case, tmp_path / "twist", progress="silent")
    assert columns(tmp_path / "twist")["downhole_torque"] == pytest.approx(np.full(11, 1000.0), rel=1e-6)
    surface = read_table(tmp_path / "twist" / "history.csv")["surface_torque [N m]"]
    assert surface == pytest.approx(np.full(len(surface), 1000.0), rel=1e-6)


def test_pressure_of_the_mud(tmp_path):
    """Standing mud of 1200 kg/m3 in a pipe at 12 m: rho g h."""
    case = hanging(
        {"channels": "pressure"},
        rpm=0.0,
        end=0.1,
        gravity=G,
        initial={"from": "statics"},
        fluid=newtonian(
            1200.0, 1e-3, flow_rate=0.0, annulus=False, outlet_pressure=1200 * G * 20, bulk_modulus=2e15
        ),
        bottom="free",
    )
    run(case, tmp_path / "r", progress="silent")
    got = columns(tmp_path / "r")
    assert list(got) == ["time", "internal_pressure"]
    assert got["internal_pressure"] == pytest.approx(np.full(11, 1200 * G * 12), rel=1e-3)


def test_a_range_cuts_off_and_says_so(tmp_path):
    """1.5 g in a range of 1 g: -1 g, and a warning."""
    result = run(
        hanging({"radius": "60 mm", "gravity": False, "range": "1 g"}), tmp_path / "r", progress="silent"
    )
    assert columns(tmp_path / "r")["ay"] == pytest.approx(np.full(101, -G))
    assert result.summary["sensors"][0]["clipped"] >= 101
    assert any("range" in text for text in result.summary["warnings"])


def test_steps_that_do_not_resolve_the_rate_are_told(tmp_path):
    """Long steps: the frequency up to which the numbers hold stands in the summary and in a warning; short steps: the cutoff."""
    coarse = run(hanging({"rate": "1 kHz"}), tmp_path / "coarse", progress="silent").summary
    longest = float(np.max(read_table(tmp_path / "coarse" / "history.csv")["step [s]"]))
    (row,) = coarse["sensors"]
    assert row["resolved_to"] == pytest.approx(1 / (4 * longest), rel=1e-6)
    assert row["coarse_share"] > 0.9
    (warning,) = [w for w in coarse["warnings"] if "not resolved" in w]
    assert f"{row['resolved_to']:.3g} Hz" in warning and "filter.cutoff" in warning
    case = hanging({"rate": "1 kHz", "filter": {"cutoff": 25}}, end=0.1, petsc={"ts_adapt_dt_max": 0.01})
    fine = run(case, tmp_path / "fine", progress="silent").summary
    assert fine["sensors"][0]["resolved_to"] == 25.0
    assert fine["sensors"][0]["coarse_share"] == 0.0
    assert not any("not resolved" in w for w in fine["warnings"])


def test_a_run_without_sensors_has_none(tmp_path):
    """No files, no keys, no columns."""
    case = hanging({}, end=0.1, output={})
    result = run(case, tmp_path / "r", progress="silent")
    assert not (tmp_path / "r" / "sensors").exists()
    assert "sensors" not in result.summary and "vibration" not in result.summary
    with_one = run(hanging({}, end=0.1), tmp_path / "s", progress="silent")
    assert (tmp_path / "r" / "history.csv").read_bytes() == (tmp_path / "s" / "history.csv").read_bytes()
    assert with_one.summary["steps"] == result.summary["steps"]


@pytest.mark.parametrize("rows", ["csv", "h5"])
def test_a_continued_run_has_the_same_samples(tmp_path, monkeypatch, rows):
    """To the last bit: filter, last step and number of the next sample stand in the checkpoint."""
    if rows == "h5":
        monkeypatch.setattr("drillpetsc.output.sensors.files.MOST_ROWS", 100)
    sensor = {
        "name": "mwd",
        "at": "1.3 m",
        "rate": "400 Hz",
        "filter": {"cutoff": 50, "order": 4},
        "radius": 0.05,
        "channels": ["ax", "ay", "az", "rpm", "torque", "wob", "bending"],
    }
    case = level(sensor, end=1.0, checkpoint_every=0.1)

    def killed(share: float, text: str) -> None:
        """The folder as a run leaves it that is killed between two checkpoints."""
        if share > 0.45 and not (tmp_path / "parts").exists():
            temporary = shutil.ignore_patterns(".*")  # of the thread that writes frames: they come and go
            shutil.copytree(tmp_path / "whole", tmp_path / "parts", ignore=temporary)

    run(case, tmp_path / "whole", progress=killed)
    run(case, tmp_path / "parts", restart=True, progress="silent")
    whole, parts = columns(tmp_path / "whole"), columns(tmp_path / "parts")
    assert len(whole["time"]) == 401
    assert (tmp_path / "whole" / "sensors" / f"mwd.{rows}").is_file()
    for name in whole:
        assert np.array_equal(parts[name], whole[name]), name


def test_a_restart_without_the_samples_before_it_is_refused(tmp_path):
    """A file of a sensor that is gone, or that lacks samples, is named."""
    sensor = {"name": "mwd", "at": "1 m", "rate": "100 Hz"}
    case = level(sensor, end=0.2, checkpoint_every=0.1)
    run(case, tmp_path / "r", progress="silent")
    longer, file = case.replace({"time.end": 0.4}), tmp_path / "r" / "sensors" / "mwd.csv"
    lines = file.read_text().splitlines(keepends=True)
    file.write_text("".join(lines[:5]))
    with pytest.raises(CaseError, match="samples up to 0.03 s"):
        run(longer, tmp_path / "r", restart=True, progress="silent")
    file.unlink()
    with pytest.raises(CaseError, match="no such file"):
        run(longer, tmp_path / "r", restart=True, progress="silent")
    file.write_text("".join(lines))
    run(longer, tmp_path / "r", restart=True, progress="silent")
    assert columns(tmp_path / "r")["time"] == pytest.approx(np.arange(41) / 100)
    run(longer.replace({"output.sensors": []}), tmp_path / "r", overwrite=True, progress="silent")
    assert not file.parent.exists()


def test_sensors_of_a_session(tmp_path):
    """Outputs mwd.ax and others are the latest samples; a state replays them."""
    sensor = {"name": "mwd", "at": "1.3 m", "rate": "200 Hz", "filter": {"cutoff": 40}, "radius": 0.05}
    fixed = {"ts_adapt_type": "none", "ts_dt": 2.5e-3}
    case = Case(**{**level(sensor, end=0.3).model_dump(by_alias=True, exclude_none=True), "petsc": fixed})
    run(case, tmp_path / "r", progress="silent")
    table = columns(tmp_path / "r")
    with Session(case) as s:
        assert "mwd.ay" in {q.name for q in s.outputs}
        assert np.isnan(s.get("mwd.ay"))  # no step, no sample
        got = []
        for _ in range(20):
            s.step(0.01)
            got.append(s.get_many(["mwd.ay", "bit_speed", "mwd.spin"]))
        state = s.state()
        s.step(0.01)
        first = s.get("mwd.ay")
        s.set_state(state)
        assert s.get("mwd.ay") == got[-1][0]
        s.step(0.01)
        assert s.get("mwd.ay") == first
        with pytest.raises(LookupError, match="nearest: mwd.ax"):
            s.get("mwd.axx")
    assert np.array(got)[:, 0] == pytest.approx(table["ay"][2:42:2], abs=1e-6)
    assert np.array(got)[:, 2] == pytest.approx(table["spin"][2:42:2], abs=1e-6)


def test_filtered_acceleration_of_a_heavy_mass(tmp_path):
    """C29 in a run: 200 t let go at the end of 100 m of pipe swing with g cos(w t), x tan x = m/M.

    Behind a filter of order 2 with its cutoff at that frequency: 1/sqrt(2) of it, a quarter of a period late.
    """
    mass, length, young, density = 200e3, 100.0, 206e9, 7850.0
    x = np.sqrt(density * AREA * length / mass)
    for _ in range(20):
        x = np.sqrt(density * AREA * length / mass * x / np.tan(x))
    w = x * np.sqrt(young / density) / length
    case = Case(
        string=[
            {**PIPE, "length": length, "element_length": 20.0},
            {"kind": "body", "name": "mass", "length": 1.0, "mass": mass},
        ],
        material={"young": young, "density": density},
        top="clamped",
        initial={"from": "straight"},
        time={"end": 2.6},
        output={
            "sensors": [
                {"name": name, "at": "mass", "rate": "200 Hz", "gravity": False, "channels": "ax", **more}
                for name, more in (("raw", {}), ("filtered", {"filter": {"cutoff": w / (2 * np.pi)}}))
            ]
        },
        petsc={"ts_adapt_type": "none", "ts_dt": 4e-3},
    )
    run(case, tmp_path / "r", progress="silent")
    time = columns(tmp_path / "r", "raw")["time"]
    late = time > time[-1] - 2 * np.pi / w
    waves = np.column_stack([np.cos(w * time), np.sin(w * time)])[late]
    found = {}
    for name in ("raw", "filtered"):
        (c, s), *_ = np.linalg.lstsq(waves, columns(tmp_path / "r", name)["ax"][late], rcond=None)
        found[name] = c - 1j * s
    assert found["raw"] / G == pytest.approx(1.0, abs=1e-2)
    assert found["filtered"] / found["raw"] == pytest.approx(-1j / np.sqrt(2), abs=5e-3)


def test_long_steps_are_sampled_in_parts(tmp_path, monkeypatch):
    """A step that holds thousands of samples: the parts in which they are computed change no bit."""
    sensor = {"name": "mwd", "at": "1 m", "rate": "2 kHz", "radius": 0.05, "filter": {"cutoff": 100}}
    run(level(sensor, end=1.0), tmp_path / "whole", progress="silent")
    monkeypatch.setattr("drillpetsc.output.sensors.samples.AT_ONCE", 37)
    run(level(sensor, end=1.0), tmp_path / "parts", progress="silent")
    files = [tmp_path / name / "sensors" / "mwd.csv" for name in ("whole", "parts")]
    assert files[0].read_bytes() == files[1].read_bytes()
    assert len(columns(tmp_path / "whole")["time"]) == 2001


def test_motion_is_continuous_through_a_rigid_item(tmp_path):
    """A body between two pipes, shaken: at its ends the sensors see what those in the pipes see, in its middle the mean of both."""
    depths = {"above": 1.9999, "upper": 2.0001, "middle": 2.15, "lower": 2.2999, "below": 2.3001}
    pipe = {**PIPE, "element_length": 0.5}
    case = Case(
        string=[
            {**pipe, "length": 2.0},
            {"kind": "body", "length": 0.3, "mass": 40.0},
            {**pipe, "length": 1.0},
        ],
        top={"kind": "top_drive", "rotation": "120 rpm"},
        initial={"from": "statics", "inclination": "90 deg"},
        loads=[
            {
                "at": 3.2,
                "force": [0, 0, 300.0],
                "value_over": {"time": [0, 0.05, 0.05, 1], "value": [0, 0, 1, 1]},
            }
        ],
        time={"end": 0.15},
        output={
            "sensors": [
                {"name": n, "at": at, "rate": "500 Hz", "radius": 0.05, "gravity": False}
                for n, at in depths.items()
            ]
        },
        petsc={"ts_adapt_type": "none", "ts_dt": 2e-3},
    )
    run(case, tmp_path / "r", progress="silent")
    found = {n: columns(tmp_path / "r", n) for n in depths}
    for name in ("ax", "ay", "az"):
        size = np.abs(found["middle"]["ay"]).max()
        assert size > 5.0
        assert found["above"][name] == pytest.approx(found["upper"][name], abs=1e-3 * size)
        assert found["below"][name] == pytest.approx(found["lower"][name], abs=1e-3 * size)
        mean = 0.5 * (found["upper"][name] + found["lower"][name])
        assert found["middle"][name] == pytest.approx(mean, abs=1e-10 * size)


def test_both_elements_feel_the_same(tmp_path):
    """A level pipe at 120 rpm that is struck: the quaternion element, whose spin angle does not count turns, against the default one.

    The first four steps after the start and after the jump of the load are left out: there the accelerations of constraints on positions have an
    error of first order.
    """
    found = {}
    for formulation in ("ancf", "quaternion"):
        channels = ["ax", "ay", "az", "rpm", "torque", "bending"]
        sensor = {"name": "mwd", "at": "1.3 m", "rate": "200 Hz", "radius": 0.05, "channels": channels}
        strike = {
            "at": 1.8,
            "force": [0, 0, 100.0],
            "value_over": {"time": [0, 0.9, 0.9, 2], "value": [0, 0, 1, 1]},
        }
        case = level(sensor, end=1.1).replace(
            {
                "beam.formulation": formulation,
                "loads": [strike, {"at": 2.0, "moment": [100.0, 0, 0]}],
                "petsc": {"ts_adapt_type": "none", "ts_dt": 2e-3},
            }
        )
        run(case, tmp_path / formulation, progress="silent")
        found[formulation] = columns(tmp_path / formulation)
    assert found["ancf"].keys() == found["quaternion"].keys()
    size = {"az": 10.0, "ay": 10.0, "ax": 10.0} | {
        n: np.abs(v).max() for n, v in found["ancf"].items() if n[0] != "a"
    }
    time = found["ancf"]["time"]
    kept = (time > 0.01) & ((time < 0.9) | (time > 0.91))
    for name, values in found["ancf"].items():
        assert found["quaternion"][name][kept] == pytest.approx(values[kept], abs=5e-3 * size[name]), name
