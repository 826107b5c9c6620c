"""Downhole motor in a string: reaction, speed under load, rotor, tool face, statics and messages (manual: verif-motor)."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drillpetsc import Case, load_case, modes, mud_motor, run, statics
from drillpetsc.analysis.linear.modal import modes as find_modes
from drillpetsc.analysis.linear.modal import prepare_state
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.errors import CaseError
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output import read_table
from drillpetsc.physics.tools.mud_motor import MudMotor
from tests.helpers.tables import each_row
from tests.helpers.wells import newtonian, simple_well

GJ = 9.4156072e5  # of 127 x 108.6 mm, E 206 GPa, nu 0.3 [N m2]
PIPE = {"od": 0.127, "id": 0.1086}
LAW = {"rev_per_volume": "0.29 rev/gal", "no_load_pressure": "0.6 MPa", "stall_torque": "14 kN m"}
SECTION = {**LAW, "flow_rate": "30 l/s"}
CASES = Path(__file__).parents[2] / "cases"
WELL = simple_well(60, 0.2159, 0.7, friction=0.2)
BIT = {"kind": "bit", "length": 0.3, "od": 0.2159, "mass": 60}


def motor(length: float = 9.0, **more: Any) -> dict:
    """A motor of pipe; keys of the power section in capitals are left to ``pdm``."""
    item = {"kind": "pdm", "length": length, **PIPE, "element_length": length / 3, "pdm": SECTION}
    return item | more


def hung(length: float, torque: float, **more: Any) -> dict:
    """A motor at the end of pipe, nothing but ``torque`` [N m] braking what is below it."""
    return {
        "string": [
            {"kind": "pipe", "length": length - 9, **PIPE, "element_length": length / 20},
            motor(**more),
        ],
        "top": "clamped",
        "bottom": {"kind": "force", "moment": [0, 0, -torque]},
        "gravity": 0,
        "time": {"end": 0.05},
    }


def on_bottom(rotation: float = 0.0, friction: float = 0.5, wob: float = 30e3, **more: Any) -> dict:
    """A short inclined string with a motor, its bit on bottom."""
    return {
        "well": WELL,
        "string": [{"kind": "pipe", "length": 50.7, **PIPE, "element_length": 5.07}, motor(**more), BIT],
        "top": {"kind": "top_drive", "rotation": rotation},
        "bottom": {"kind": "bit", "friction": friction},
        "initial": {"from": "statics", "wob": wob},
        "time": {"end": 0.05},
        "output": {"history_every": 0.01},
    }


def history(case: dict, out: Path) -> tuple[dict[str, np.ndarray], dict]:
    result = run(Case(**case), out, progress="silent")
    return {
        name.split(" [")[0]: values for name, values in read_table(out / "history.csv").items()
    }, result.summary


def twist(case: dict, out: Path) -> float:
    """Twist of a string by statics [rad]."""
    return float(read_table(statics(Case(**case), out).folder / "statics.csv")["twist_angle [rad]"][-1])


# ---------------------------------------------------------------------- reaction
@pytest.mark.parametrize(("length", "torque"), [(2500.0, 5e3), (900.0, 8.2e3), (1700.0, 1.3e3)])
def test_reactive_wind_up(length, torque, tmp_path):
    """C14: 5 kN m at the lower end of 2500 m of drill pipe held at the top winds it up by 760.65 deg, T L/GJ; 0.1 %."""
    exact = torque * length / GJ
    if length == 2500.0:
        assert math.degrees(exact) == pytest.approx(760.65, rel=1e-4)
    assert twist(hung(length, torque), tmp_path / "run") == pytest.approx(exact, rel=1e-3)


@pytest.mark.parametrize("torque", [0.0, 8e3, 12e3, -2e3])
def test_the_rotor_turns_as_the_law_says_and_the_string_stands(torque, tmp_path):
    """C12 in motion: speed, differential pressure, torque at the top, from the first step on, energy closed."""
    law = mud_motor(Case(**hung(200.0, torque)))
    got, summary = history(hung(200.0, torque), tmp_path / "run")
    point = law.point(torque, 0.03)
    assert got["motor_speed"] == pytest.approx(point.speed, rel=1e-6)
    assert got["bit_speed"] == pytest.approx(point.speed, rel=1e-6)
    assert got["motor_output_torque"] == pytest.approx(torque, abs=1e-3)
    assert got["motor_differential_pressure"] == pytest.approx(point.differential_pressure, rel=1e-6)
    assert got["surface_torque"] == pytest.approx(torque, abs=1e-2)
    assert not got["motor_stalled"].any()
    assert np.abs(got["energy_error"]).max() < 1e-6 * max(abs(torque * point.speed * 0.05), 1.0)


def test_a_load_swings_the_rotor_against_the_string(tmp_path):
    """Rotor I on the law, stator on the spring GJ/L of the string: I dw/dt = T - M, dT/dt = GJ/L (w_law(T) - w).

    The load M grows from 0 to 9 kN m; the two equations are solved here by Runge-Kutta of order 4.  Inertia of the pipe
    is below 1 % of that of the rotor.
    """
    inertia, load, stiffness = 100.0, 9e3, GJ / 19.8
    case = hung(20.0, 0.0, pdm={**SECTION, "rotor_inertia": inertia}, joint_at=8.8)
    ramp = {"time": [0, 0.05, 0.1, 1.0], "value": [0, 0, 1, 1]}
    case["loads"] = [{"at": 20.0, "moment": [0, 0, -load], "value_over": ramp}]
    case["time"], case["output"] = {"end": 0.6}, {"history_every": 0.01}
    got, _ = history(case, tmp_path / "run")
    law, step = mud_motor(Case(**case)), 2e-5

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        acting = load * min(max((t - 0.05) / 0.05, 0.0), 1.0)
        return np.array([(y[1] - acting) / inertia, stiffness * (law.speed(y[1], 0.03) - y[0])])

    y, rows = np.array([law.free_speed(0.03), 0.0]), []
    for k in range(30001):
        t = k * step
        if k % 500 == 0:
            rows.append(y)
        a = rate(t, y)
        b = rate(t + step / 2, y + step / 2 * a)
        c = rate(t + step / 2, y + step / 2 * b)
        y = y + step / 6 * (a + 2 * b + 2 * c + rate(t + step, y + step * c))
    speed, torque = np.array(rows).T
    assert torque.max() > 9.5e3 and speed.min() < 0.9 * law.free_speed(0.03)
    assert np.abs(got["bit_speed"] - speed).max() < 0.02 * np.ptp(speed)
    assert np.abs(got["motor_output_torque"] - torque).max() < 0.02 * torque.max()


# ---------------------------------------------------------------------- drilling
def test_slide_and_rotary_drilling(tmp_path):
    """Rotation 0: the bit turns by the motor, the string winds against it; with rotation both speeds add up.

    Torque of a bit with friction mu under W: 2/3 mu W R.
    """
    torque = 2 / 3 * 0.5 * 30e3 * 0.2159 / 2
    for rotation in (0.0, 4.0):
        got, _ = history(on_bottom(rotation), tmp_path / f"{rotation:g}")
        assert got["bit_torque"][0] == pytest.approx(torque, rel=5e-3)
        # the motor also turns the pipe below its joint, and the bit, against the wall
        assert torque < got["motor_output_torque"][0] < 1.3 * torque
        law = mud_motor(Case(**on_bottom(rotation)))
        assert got["motor_speed"][0] == pytest.approx(
            law.speed(got["motor_output_torque"][0], 0.03), rel=1e-6
        )
        assert got["bit_speed"][0] == pytest.approx(rotation + got["motor_speed"][0], rel=1e-9)
        assert (
            np.abs(got["bit_speed"] - rotation - got["motor_speed"][0]).max() < 0.02 * got["motor_speed"][0]
        )


@pytest.mark.parametrize("rotation", [0.0, 3.0])
def test_the_wall_brakes_what_the_motor_turns(rotation, tmp_path):
    """Off bottom in an inclined hole: the torque of the motor is the friction torque mu W sin(I) r of the pipe below it.

    The pipe lies on the lower side; a bit would hold it off the wall, so there is none.
    """
    case = on_bottom(rotation, joint_at=3.0)
    case["string"] = case["string"][:2]
    case["bottom"], case["initial"] = "free", {"from": "statics"}
    case["string"][1]["element_length"] = 0.5
    got, _ = history(case, tmp_path / "run")
    weight = 6.0 * 7850 * math.pi / 4 * (0.127**2 - 0.1086**2) * 9.80665 * math.sin(0.7)
    assert got["motor_output_torque"][0] == pytest.approx(0.2 * weight * 0.0635, rel=0.15)


def test_the_bearing_carries_mud_and_weight(tmp_path):
    """Off bottom: dp pi/4 d^2 and the weight below the joint; on bottom the weight on the bit is taken off."""
    seal = 0.06
    pdm = {**SECTION, "seal_diameter": seal}
    case = hung(20.0, 2e3, pdm=pdm) | {"gravity": 9.81}
    got, _ = history(case, tmp_path / "off")
    below = 4.5 * 7850 * math.pi / 4 * (0.127**2 - 0.1086**2) * 9.81
    thrust = math.pi / 4 * seal**2 * got["motor_differential_pressure"][0]
    assert got["bearing_load"][0] == pytest.approx(thrust + below, rel=1e-5)
    case["bottom"] = {"kind": "force", "force": [0, 0, -5e3], "moment": [0, 0, -2e3]}
    got, _ = history(case, tmp_path / "on")
    assert got["bearing_load"][0] == pytest.approx(thrust + below - 5e3, rel=1e-5)


def test_the_rotor_orbits_backwards_and_shakes_the_string(tmp_path):
    """C13 in a string: the force M e (N w)^2 turns with N w; with both ends of a short stiff pipe held, supports share it.

    The side force of the joint shows it: its frequency is N w/2 pi, 9.00 Hz.
    """
    flow = 11.31 / (2 * math.pi * 0.29 / 3.785411784e-3)
    pdm = {
        **LAW,
        "flow_rate": flow,
        "lobes": [5, 6],
        "rotor_mass": 350,
        "eccentricity": 0.01,
        "rotor_inertia": 3,
    }
    case = hung(18.0, 0.0, pdm=pdm, mass=800)  # [kg], of the motor
    case["material"] = {"damping": {"mass": 20.0}}
    case["time"], case["output"] = {"end": 2.0}, {"history_every": 4e-3, "probes": [9.0]}
    got, _ = history(case, tmp_path / "run")
    assert got["rotor_orbit_speed"][-1] == pytest.approx(-5 * 11.31, rel=2e-3)
    side = read_table(tmp_path / "run" / "probes.csv")
    x = next(values for name, values in side.items() if name.startswith("x_9"))[250:]
    spectrum = np.abs(np.fft.rfft((x - x.mean()) * np.hanning(len(x)), 16 * len(x)))
    found = np.fft.rfftfreq(16 * len(x), 4e-3)[spectrum.argmax()]
    assert found == pytest.approx(9.0, rel=0.01)


def test_tool_face_follows_the_reactive_torque(tmp_path):
    """The bend stands where it was made up, turned back by the wind-up T L/GJ of the string above it."""
    face, torque = 0.6, 3e3
    case = hung(400.0, torque, bend={"angle": 1e-4, "tool_face": face, "position": 4.0}, joint_at=8.0)
    case["initial"] = {"inclination": 0.5}
    tilt = (math.sin(0.5), 0.0, math.cos(0.5))
    case["bottom"]["moment"] = [-torque * c for c in tilt]
    case["bottom"]["force"] = [20e3 * c for c in tilt]  # keeps the string straight
    got, _ = history(case, tmp_path / "run")
    assert got["tool_face"][0] == pytest.approx(face - torque * 395.75 / GJ, abs=1e-3)


# ---------------------------------------------------------------------- linear models
def test_modes_of_a_string_with_a_motor(tmp_path):
    """Torsion: a running motor under no load holds its speed, so the rotor goes with the string; near stall it lets it go.

    Held at the top, lengths a above and b below the joint: with the rotor locked a rod of a + b, f = c/4(a + b); with a rotor
    that gives way (droop 1 at half the stall torque, dT/dw = T_s/w0) below 1 % of the impedance, a rod of a alone, f = c/4a (wave
    equation).
    """
    c = math.sqrt(79230769230.76923 / 7850)

    def lowest(pdm: dict, torque: float) -> float:
        case = hung(1000.0, torque, pdm=pdm, joint_at=20.0, element_length=20.0)
        case["string"][0]["length"], case["string"][1]["length"] = 800.0, 200.0
        found = modes(Case(**case), tmp_path / str(len(list(tmp_path.iterdir()))), count=2, kind="torsional")
        table = read_table(found.folder / "modes.csv")
        return float(table["frequency [Hz]"].min())

    assert lowest(SECTION, 0.0) == pytest.approx(c / 4000, rel=2e-3)
    soft = {**SECTION, "droop": 1, "stall_torque": 30.0}
    assert lowest(soft, 15.0) == pytest.approx(c / (4 * 820), rel=2e-2)


def test_a_motor_with_a_bit_that_cuts_has_one_root_zero():
    """The metres drilled, on which nothing depends; the free angle of the rotor is left out, though both vectors mix."""
    model = build_model(load_case(CASES / "motor-slide.yaml"))
    prepare_state(model)
    found = find_modes(model, count=20)
    (zero,) = np.flatnonzero(np.abs(found.eigenvalue) < 1e-9)
    assert np.abs(found.shapes["hole.drilled"][zero]).max() > 0


# ---------------------------------------------------------------------- messages
def test_start_above_the_stall_torque_is_answered_in_words(tmp_path):
    case = on_bottom(wob=80e3, pdm={**SECTION, "stall_torque": 2e3})
    found = statics(Case(**case), tmp_path / "s")
    text = next(w for w in found.summary["warnings"] if "pdm" in w)
    assert (
        "1800 l/min gives 137.9 rpm" in text
        and "is above stall_torque 2 kN m: the motor does not turn" in text
    )
    got, _ = history(case, tmp_path / "run")
    assert got["motor_stalled"][0] == 1
    assert abs(got["motor_speed"][0]) < 1e-2


def test_no_flow_leaves_the_motor_standing(tmp_path):
    got, summary = history(hung(50.0, 1e3, pdm={**SECTION, "flow_rate": 0}), tmp_path / "run")
    assert np.abs(got["motor_speed"]).max() < 1e-2
    assert any("does not turn" in w for w in summary["statics"]["warnings"])


@each_row(
    ("change", "text"),
    [
        ({"pdm": {**LAW}}, "a flow_rate of the motor, or a fluid"),
        ({"pdm": {**SECTION, "stall_torque": 0}}, "above 0"),
        ({"pdm": {**SECTION, "droop": 0.5}}, "at least 1"),
        (
            {"pdm": {k: v for k, v in SECTION.items() if k != "rev_per_volume"}},
            "a rev_per_volume, or a curve",
        ),
        ({"pdm": {**SECTION, "eccentricity": 0.01}}, "lobes of rotor and stator"),
        ({"pdm": {**SECTION, "lobes": [7, 9]}}, "one more in the stator"),
        ({"pdm": {**SECTION, "flow_rate": "-1 l/s"}}, "turns in one direction"),
        ({"joint_at": 9.0}, "pipe of the item above and below it"),
        ({"joint_at": 3.0, "bend": {"angle": 0.02, "position": 2.0}}, "turns with the bit"),
        ({"pdm": {**SECTION, "droops": 3}}, "droop"),
    ],
)
def test_bad_input_is_refused(change, text):
    with pytest.raises(CaseError) as error:
        Case(**hung(50.0, 0.0, **change))
    assert text in f"{error.value.want} {error.value.hint}"


@pytest.mark.parametrize(
    ("more", "text"),
    [
        ({"time": {"end": 1, "mode": "quasi_static"}}, "no motor in a quasi-static run"),
        ({"beam": {"formulation": "quaternion"}}, "a downhole motor"),
        ({"joints": [{"kind": "universal", "at": 45.5}]}, "one joint at a place"),
        ({"string": [motor(), motor()]}, "one motor"),
    ],
)
def test_what_a_motor_does_not_go_with(more, text):
    with pytest.raises(CaseError) as error:
        Case(**(hung(50.0, 0.0) | more))
    assert text in f"{error.value.want}"


# ---------------------------------------------------------------------- measured curve
CURVE = """# motor 6 3/4 in
flow [gpm], differential pressure [psi], torque [ft lbf], rpm
300, 100, 0, 90
300, 400, 3000, 82
300, 700, 6000, 60
500, 150, 0, 150
500, 450, 3000, 146
500, 750, 6000, 130
"""


def test_a_measured_curve_from_a_file(tmp_path):
    """The points of the file, and their mean half-way between two flow rates of a motor whose speed is linear in it."""
    (tmp_path / "motor.csv").write_text(CURVE)
    (tmp_path / "case.yaml").write_text(
        f"""
string:
  - {{kind: pipe, length: 20 m, od: 127 mm, id: 108.6 mm}}
  - {{kind: pdm, length: 9 m, od: 127 mm, id: 108.6 mm, pdm: {{curve: motor.csv, stall_torque: 9000 ft lbf, flow_rate: 500 gpm}}}}
top: clamped
bottom: {{kind: force, moment: [0, 0, -{6000 * 1.3558179483314004}]}}
gravity: 0
time: {{end: 0.02}}
"""
    )
    law, gpm, rpm, psi, foot = (
        mud_motor(load_case(tmp_path / "case.yaml")), 6.30901964e-5, math.pi / 30, 6894.757293168361, 1.3558179483314004,
    )  # fmt: skip
    for flow, torque, pressure, speed in ((300, 3000, 400, 82), (500, 6000, 750, 130), (500, 0, 150, 150)):
        point = law.point(torque * foot, flow * gpm)
        assert point.speed == pytest.approx(speed * rpm, rel=2e-3)
        assert point.differential_pressure == pytest.approx(pressure * psi, rel=2e-3)
    assert law.point(3000 * foot, 400 * gpm).speed == pytest.approx(114 * rpm, rel=0.02)
    assert law.speed(9500 * foot, 500 * gpm) == pytest.approx(0.0, abs=1e-3)
    result = run(load_case(tmp_path / "case.yaml"), tmp_path / "run", progress="silent")
    speed = read_table(tmp_path / "run" / "history.csv")["motor_speed [rad/s]"]
    assert speed == pytest.approx(130 * rpm, rel=2e-3)
    again = load_case(result.folder / "case.yaml")  # the points are in the case that a run writes
    assert mud_motor(again).speed(1e3, 0.03) == pytest.approx(law.speed(1e3, 0.03), rel=1e-12)


@each_row(
    ("text", "want"),
    [
        ("flow [gpm], torque [N m], rpm\n300, 0, 90\n", "a header such as"),
        ("flow, dp [psi], torque [N m], rpm\n300, 1, 0, 90\n", "a unit in brackets"),
        ("flow [gpm], dp [psi], torque [N m], rpm\n300, 1, 0, x\n", "a number in rpm"),
        ("flow [gpm], dp [psi], torque [N m], rpm\n300, 1, 0, 90\n300, 2, 5, 95\n", "does not rise"),
        ("flow [gpm], dp [psi], torque [N m], rpm\n300, 1, 5, 90\n300, 2, 9, 0\n", "a point at torque 0"),
        ("flow [gpm], dp [psi], torque [N m], rpm\n300, 1, 0, 90\n300, 2, 9, 60\n", "a stall_torque"),
    ],
)
def test_bad_curves_are_refused(text, want, tmp_path):
    (tmp_path / "motor.csv").write_text(text)
    (tmp_path / "case.yaml").write_text(
        "string:\n  - {kind: pdm, length: 9, od: 0.127, id: 0.1, pdm: {curve: motor.csv, flow_rate: 30 l/s}}\ntop: clamped\n"
    )
    with pytest.raises(CaseError) as error:
        load_case(tmp_path / "case.yaml")
    assert want in error.value.want


# ---------------------------------------------------------------------- mud
def wet(torque: float, kind: str = "pdm", flow: Any = 0.028, **more: Any) -> dict:
    """A motor (or plain pipe) at the end of a vertical string with mud in and around it, ``torque`` [N m] at its end."""
    item = (
        motor(pdm=LAW)
        if kind == "pdm"
        else {k: v for k, v in motor().items() if k != "pdm"} | {"kind": "pipe"}
    )
    case = hung(200.0, torque) | {
        "well": simple_well(210, 0.2159, kind="casing", friction=0.0),
        "fluid": newtonian(1200, 0.02, flow_rate=flow, bulk_modulus=2.2e9),
        "gravity": 9.81,
        "contact": "none",
    }
    case["string"][1] = item
    case["bottom"]["force"] = [0, 0, 50e3]
    return case | more


@pytest.mark.parametrize("torque", [0.0, 9e3])
def test_mud_turns_the_motor_and_pays_for_it(torque, tmp_path):
    """Speed by the volume that passes, q rho0/rho; the standpipe pressure is that of plain pipe and the law's pressure."""
    got, summary = history(wet(torque), tmp_path / "motor")
    pipe, _ = history(wet(torque, "pipe"), tmp_path / "pipe")
    law = mud_motor(Case(**wet(torque)))
    middle = 200 * 1200 * 9.81  # about the pressure at the motor, a thousandth of the bulk modulus
    point = law.point(torque, 0.028 * math.exp(-middle / 2.2e9))
    assert got["motor_speed"] == pytest.approx(point.speed, rel=2e-3)
    assert got["motor_differential_pressure"] == pytest.approx(point.differential_pressure, rel=1e-3)
    rise = got["pump_pressure"][0] - pipe["pump_pressure"][0]
    assert rise == pytest.approx(point.differential_pressure, rel=5e-3)
    passed = 0.028 * point.differential_pressure * 0.05  # work of the mud on the motor
    assert np.abs(got["energy_error"]).max() < 1e-4 * passed


def test_energy_closes_while_flow_and_load_change(tmp_path):
    """The pump stops within 0.2 s under load: mud, rotor and string exchange energy, and the balance closes to 0.1 %."""
    ramp = {"time": [0, 0.05, 0.25, 1], "value": [0.03, 0.03, 0.005, 0.005]}
    case = wet(4e3, flow=ramp)
    case["string"][1]["pdm"] = {
        **LAW,
        "rotor_inertia": 20.0,
        "lobes": [5, 6],
        "rotor_mass": 200,
        "eccentricity": 0.005,
    }
    case["time"] = {"end": 0.4}
    case["petsc"] = {"ts_rtol": 1e-5}
    got, _ = history(case, tmp_path / "run")
    assert got["motor_speed"][0] > 13 and got["motor_speed"][-1] < 0.7 * got["motor_speed"][0]
    assert got["pump_pressure"][0] - got["pump_pressure"].min() > 1e5
    exchanged = 0.03 * got["motor_differential_pressure"].mean() * 0.4
    assert np.abs(got["energy_error"]).max() < 1e-3 * exchanged


def test_a_stalled_motor_lets_all_mud_pass(tmp_path):
    """Beyond the stall torque the flow goes on and the pressure stays at that of the stall."""
    got, summary = history(wet(16e3), tmp_path / "run")
    law = mud_motor(Case(**wet(0.0)))
    stalled = law.point(1.01 * law.stall_torque(0.028), 0.028)
    assert got["motor_stalled"].all() and np.abs(got["motor_speed"]).max() < 1e-2
    assert got["motor_differential_pressure"] == pytest.approx(stalled.differential_pressure, rel=1e-4)
    assert got["outlet_flow"] == pytest.approx(0.028, rel=1e-2)
    assert any("above stall_torque" in w for w in summary["statics"]["warnings"])


def test_fluid_and_flow_rate_exclude_each_other():
    case = wet(0.0)
    case["string"][1] = motor()
    with pytest.raises(CaseError) as error:
        Case(**case)
    assert "no flow_rate with a fluid" in error.value.want


def test_still_mud_does_not_load_the_bearing():
    """Its pressure is the same inside and outside: the buoyed weight below the joint is left, metal without ends."""
    case = on_bottom() | {
        "well": simple_well(80, 0.2159, 0.0, friction=0.0),
        "bottom": "free",
        "initial": {"from": "statics"},
        "fluid": newtonian(1200, 0.02, flow_rate=0.0),
    }
    case["string"] = [
        case["string"][0],
        motor(pdm={k: v for k, v in SECTION.items() if k != "flow_rate"} | {"seal_diameter": 0.06}),
    ]
    model = build_model(Case(**case))
    find_equilibrium(model)
    part = model.part(MudMotor)
    assert part is not None
    metal = math.pi / 4 * (0.127**2 - 0.1086**2) * (59.7 - float(model.mesh.node_depth[part.cell]))
    pressure = 1200 * 9.80665 * float(model.mesh.node_depth[part.cell])
    thrust = part.thrust(0.0, model.system.assembly)
    assert thrust == pytest.approx((7850 - 1200) * 9.80665 * metal, rel=5e-3)
    assert math.pi / 4 * 0.06**2 * pressure > 0.5 * thrust  # what the pressure inside alone would add
