"""Rotary steerable tools: side forces of pads and tilted shafts, at rest and turning, and the hole that they drill
(manual: verif-steering)."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import trapezoid

from drillpetsc import Case, run
from drillpetsc.analysis.linear.linearised_model import mean_over_turn
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.analysis.statics.placement import move_rigidly, release
from drillpetsc.errors import CaseError
from drillpetsc.geometry.frames import high_side
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output import read_table
from drillpetsc.output.measured.bending import curvatures, end_forces
from drillpetsc.physics.tools.steering import OVERLAP, WINDOW, mean_share
from tests.helpers.motion import sampled
from tests.helpers.tables import each_row
from tests.helpers.wells import simple_well

LENGTH, OD, ID = 9.0, 0.1715, 0.0714
BENDING = 206e9 * np.pi / 64 * (OD**4 - ID**4)
RPM = np.pi / 30


def tool(rss: dict, rpm: float = 0.0, **more) -> dict:
    """A case of one collar that steers, without weight: both ends pinned unless said otherwise."""
    item = {"kind": "rss", "length": LENGTH, "od": OD, "id": ID, "element_length": 0.75, "rss": rss}
    return {
        "string": [item],
        "top": {"kind": "top_drive", "rotation": rpm * RPM, "hinged": True},
        "bottom": "pinned",
        "gravity": 0.0,
        "material": {"damping": {"mass": 4.0}},
        "initial": {"from": "statics", "inclination": 0.5, "azimuth": 0.3},
        **more,
    }


def at_rest(case: dict):
    model = build_model(Case(**case))
    find_equilibrium(model)
    return model


def sides(model) -> tuple[np.ndarray, np.ndarray]:
    """Directions of the high side and to its right, looking down."""
    up = high_side(model.tangent[0])
    return up, np.cross(model.tangent[0], up)


@pytest.mark.parametrize(
    ("force", "offset", "angle", "inclination"),
    [(20e3, 1.5, 0.0, 0.5), (20e3, 1.5, 90.0, 1.5), (7e3, 4.1, -135.0, 0.2), (31e3, 0.4, 37.0, 0.0)],
)
def test_side_force_of_pads_on_a_beam_with_pinned_ends(force, offset, angle, inclination):
    """F (L - b)/L at the lower end, F b/L at the upper one; the pipe goes towards the tool face (C16)."""
    rss = {"kind": "push", "force": force, "pad_offset": offset, "steer": {"tool_face": np.radians(angle)}}
    case = tool(rss, initial={"from": "statics", "inclination": inclination, "azimuth": 0.3})
    model = at_rest(case)
    for end, share in (("bottom", (LENGTH - offset) / LENGTH), ("top", offset / LENGTH)):
        parts = [model.system.reaction(f"{end}.side_reaction_{i}") for i in (1, 2)]
        assert np.hypot(*parts) == pytest.approx(force * share, rel=1e-4)
    moved = model.system.field("string.position") - model.position
    mid = moved[np.abs(moved).sum(axis=1).argmax()]
    up, right = sides(model)
    if inclination == 0.0:
        up, right = np.array([1.0, 0, 0]), np.array([0, 1.0, 0])  # north, east
    assert np.degrees(np.arctan2(mid @ right, mid @ up)) == pytest.approx(angle, abs=0.01)


@pytest.mark.parametrize("pads", ["sleeve", "rotating"])
def test_side_force_is_the_same_while_the_string_turns(pads):
    """At 120 rpm, after a ramp: 16.667 kN at the bit (C16), on average where the pads turn with the string."""
    steer = {"tool_face": "90 deg", "ratio": {"ramp": "1 s", "value": "60 %"}}
    rss = {"kind": "push", "force": "33333.333 N", "pad_offset": 1.5, "pads": pads, "steer": steer}
    model = at_rest(tool(rss, 120))
    release(model)
    move_rigidly(model)
    rows = sampled(
        model.system, 3.0, lambda s: [s.reaction(f"bottom.side_reaction_{i}") for i in (1, 2)], ts_rtol=1e-4
    )
    t, first, second = rows[rows[:, 0] >= 2.0].T
    mean = [trapezoid(q, t) / (t[-1] - t[0]) for q in (first, second)]
    assert np.hypot(*mean) == pytest.approx(16.6667e3, rel=1e-2)
    swing = np.ptp(second) / 16.667e3
    assert swing < 0.01 if pads == "sleeve" else swing > 0.2


def test_statics_take_the_mean_of_pads_that_turn():
    rss = {"kind": "push", "force": 20e3, "pad_offset": 1.5, "pads": "rotating", "steer": {"tool_face": 1.0}}
    model = at_rest(tool(rss, 120))
    found = [model.system.reaction(f"bottom.side_reaction_{i}") for i in (1, 2)]
    assert np.hypot(*found) == pytest.approx(16.6667e3, rel=1e-3)


def test_mean_of_pads_that_turn():
    """(3/pi) int s cos over the window: by the trapezoidal rule, and (3/pi) sin 60 deg for a sharp window."""
    a = np.linspace(-np.pi, np.pi, 200001)
    u = np.clip((WINDOW + OVERLAP - np.abs(a)) / (2 * OVERLAP), 0, 1)
    share = u * u * (3 - 2 * u)
    assert mean_share() == pytest.approx(3 / (2 * np.pi) * trapezoid(share * np.cos(a), a), rel=1e-8)
    assert mean_share() == pytest.approx(3 / np.pi * np.sin(np.pi / 3), rel=5e-3)


def test_the_command_follows_its_times():
    """Ratio and tool face over time: the static side force at each moment, at a slow change."""
    steer = {
        "ratio": {"time": [0, 1, 2], "value": [0, 1, 0.5]},
        "tool_face": {"time": [0, 3], "value": [0, 1.5]},
    }
    model = at_rest(tool({"kind": "push", "force": 9e3, "pad_offset": 3.0, "steer": steer}, 30))
    release(model)
    move_rigidly(model)
    rows = sampled(
        model.system, 3.0, lambda s: [s.reaction(f"bottom.side_reaction_{i}") for i in (1, 2)], ts_rtol=1e-4
    )
    up, right = sides(model)
    late = rows[rows[:, 0] > 2.3]
    assert len(late) > 3
    angle = np.arctan2(-late[:, 2], late[:, 1])
    turn = angle[-1] - angle[0]
    assert abs(turn) == pytest.approx(0.5 * (late[-1, 0] - late[0, 0]), rel=0.02)
    assert np.hypot(late[:, 1], late[:, 2]) == pytest.approx(0.5 * 9e3 * 2 / 3, rel=0.02)


@pytest.mark.parametrize(("tilt", "at", "angle"), [(0.6, 4.5, 30.0), (1.7, 2.0, -100.0)])
def test_a_tilted_shaft_points_in_space_while_it_turns(tilt, at, angle):
    """The free end is off by tilt times the length below, towards the tool face, and stays there while the string turns."""
    rss = {"kind": "point", "tilt": np.radians(tilt), "steer": {"tool_face": np.radians(angle)}}
    case = tool(rss, 120, top={"kind": "top_drive", "rotation": 120 * RPM}, bottom="free")
    case["string"][0]["joint_at"] = at
    model = at_rest(case)
    off = model.system.field("string.position")[-1] - model.position[-1]
    up, right = sides(model)
    size = at * np.radians(tilt)
    assert off @ up == pytest.approx(size * np.cos(np.radians(angle)), rel=3e-3, abs=1e-3 * size)
    assert off @ right == pytest.approx(size * np.sin(np.radians(angle)), rel=3e-3, abs=1e-3 * size)
    forces = end_forces(model)
    assert forces.moment_size.max() < 1e-4 * BENDING * np.radians(tilt) / 0.5  # free of stress
    bent = np.linalg.norm(curvatures(model, forces.moment), axis=2)
    assert bent.max() == pytest.approx(np.radians(tilt) / 0.5, rel=1e-3)
    release(model)
    move_rigidly(model)
    spin = model.system.field("string.spin")[-1, 0]
    rows = sampled(
        model.system, 0.5, lambda s: s.field("string.position")[-1] - model.position[-1], ts_rtol=1e-4
    )
    assert model.system.field("string.spin")[-1, 0] - spin == pytest.approx(0.5 * 120 * RPM, rel=1e-3)
    assert np.abs(rows[:, 1:] - off).max() < 0.005 * size


@pytest.mark.parametrize("at", [4.5, 2.0])
def test_side_force_of_a_tilted_shaft_between_supports(at):
    """Clamped above, pinned below: 3 EI theta a/L^3 at the bit."""
    tilt = np.radians(0.03)
    case = tool({"kind": "point", "tilt": tilt}, top="clamped")
    case["string"][0]["joint_at"] = at
    model = at_rest(case)
    found = [model.system.reaction(f"bottom.side_reaction_{i}") for i in (1, 2)]
    assert np.hypot(*found) == pytest.approx(3 * BENDING * tilt * at / LENGTH**3, rel=1e-3)


# ---------------------------------------------------------------------- drilling
def drilled(rss: dict, out, azimuth: float = 1.0, **more) -> tuple[float, float]:
    """Change of inclination and of azimuth [deg] over a few metres of new hole, without inertia."""
    start = 40.0
    string = [
        {"kind": "pipe", "length": 31, "od": 0.127, "id": 0.0762, "element_length": 1.0},
        {"kind": "stabilizer", "length": 0.5, "od": 0.2155, "id": 0.07, "mass": 120, "stiff": True},
        {"kind": "rss", "length": 4.2, "od": OD, "id": ID, "element_length": 0.6, "rss": rss},
        {"kind": "stabilizer", "length": 0.3, "od": 0.2155, "id": 0.07, "mass": 80},
        {"kind": "pipe", "length": 3.7, "od": OD, "id": ID, "element_length": 0.6},
        {"kind": "bit", "length": 0.3, "od": 0.2159, "mass": 60},
    ]
    if rss["kind"] == "push":  # pads right above the bit
        string = [string[0] | {"length": 34}, string[1], string[2] | {"length": 5.2}, string[5]]
    case = Case(
        string=string,
        well=simple_well(start, 0.2159, 0.7, azimuth=azimuth, friction=0.1),
        contact={"stiffness": 1e7},
        top={"kind": "top_drive", "rotation": 12.0, "lowering": 5e-3},
        bottom="bit",
        formation={"drillability": 5e-8, "bit_anisotropy": 0.3},
        initial={"from": "statics", "wob": 30e3},
        time={"end": 1000, "mode": "quasi_static"},
        output={"history_every": 100, "field_every": 1000},
        **more,
    )
    run(case, out, progress="silent")
    path = read_table(out / "trajectory.csv")
    column = {name.split(" [")[0]: values for name, values in path.items()}
    assert column["md"][-1] > start + 3
    unit = 1.0 if any("deg" in name for name in path if name.startswith("inclination")) else 180 / np.pi
    return (
        column["inclination"][-1] * unit - np.degrees(0.7),
        column["azimuth"][-1] * unit - np.degrees(azimuth),
    )


@pytest.mark.parametrize("kind", ["push", "point"])
def test_tool_face_0_builds_90_turns_right_and_180_drops(kind, tmp_path):
    """The new hole turns towards the tool face, against what the same string drills without steering."""
    base = (
        {"kind": "push", "force": 15e3, "pad_offset": 0.8}
        if kind == "push"
        else {"kind": "point", "tilt": 0.01}
    )
    none = drilled(base | {"steer": {"ratio": 0.0}}, tmp_path / "none")
    steered = {
        angle: np.subtract(
            drilled(base | {"steer": {"tool_face": np.radians(angle)}}, tmp_path / f"{angle}"), none
        )
        for angle in (0, 90, 180)
    }
    build, turn, drop = (steered[a] for a in (0, 90, 180))
    assert build[0] > 0.1
    assert drop[0] < -0.1
    assert turn[1] * np.sin(0.7) > 0.1
    assert abs(turn[0]) < 0.5 * build[0]
    assert abs(build[1]) * np.sin(0.7) < 0.5 * turn[1]


def test_energy_of_steering_closes(tmp_path):
    """What the actuators supply is in the balance, for pads that turn with the string and for a shaft that tilts over."""
    for kind in (
        {"kind": "push", "force": 5e3, "pad_offset": 2.0, "pads": "rotating"},
        {
            "kind": "point",
            "tilt": 0.02,
            "steer": {"ratio": {"ramp": 0.3, "value": 1.0}, "tool_face": {"time": [0, 1], "value": [0, 3]}},
        },
    ):
        case = tool(kind, 60, time={"end": 1.0}, output={"history_every": 0.01}, petsc={"ts_rtol": 1e-5})
        result = run(Case(**case), tmp_path / kind["kind"], progress="silent")
        history = read_table(result.folder / "history.csv")
        size = max(np.abs(history["kinetic_energy [J]"]).max(), np.ptp(history["strain_energy [J]"]))
        assert np.abs(history["energy_error [J]"]).max() < 0.01 * size
        assert "steering_tool_face [rad]" in history


@each_row(
    ("item", "words"),
    [
        ({"rss": {"kind": "push", "force": 1e3, "pad_offset": 9.5}}, ("pad_offset", "9")),
        (
            {"rss": {"kind": "push", "force": 1e3, "pad_offset": 1.0, "steer": {"ratio": 1.2}}},
            ("ratio", "at most 1"),
        ),
        (
            {"rss": {"kind": "push", "force": 1e3, "pad_offset": 1.0}, "joint_at": 2.0},
            ("joint_at", "pad_offset"),
        ),
        ({"rss": {"kind": "point", "tilt": 0.01}, "joint_at": 9.2}, ("joint_at", "9")),
        ({"rss": {"kind": "pull", "tilt": 0.01}}, ("push", "point")),
        ({"rss": {"kind": "point", "tilt": 1.0}}, ("tilt",)),
        ({"rss": {"kind": "point", "tilt": 0.01}, "bend": {"angle": 0.01}}, ("bend",)),
    ],
)
def test_bad_tools_are_refused(item, words):
    case = tool({"kind": "point", "tilt": 0.01})
    case["string"][0] |= item
    with pytest.raises(CaseError) as error:
        Case(**case)
    for word in words:
        assert word in str(error.value)


def test_two_tools_and_joints_inside_are_refused():
    case = tool({"kind": "point", "tilt": 0.01})
    with pytest.raises(CaseError, match="one steerable tool"):
        Case(**case | {"string": case["string"] * 2})
    with pytest.raises(CaseError, match="no joint inside"):
        Case(**case | {"joints": [{"kind": "universal", "at": 4.0}]})


def test_linear_models_take_the_mean_force():
    case = Case(**tool({"kind": "push", "force": 1e3, "pad_offset": 1.0, "pads": "rotating"}))
    assert mean_over_turn(case).string[0].rss.pads == "sleeve"
    steady = Case(**tool({"kind": "push", "force": 1e3, "pad_offset": 1.0}))
    assert mean_over_turn(steady) is steady


# ---------------------------------------------------------------------- below a downhole motor
FLOW, TURN = 0.03, 2 * np.pi * 0.29 / 3.785411784e-3  # [m3/s]; rotor of 0.29 rev/gal [rad/m3]


def below_motor(pads: str, **more) -> dict:
    """The collar of the checks with a motor in its upper third; the string above stands still."""
    pdm = {"rev_per_volume": TURN, "stall_torque": 14e3, "flow_rate": FLOW}
    rss = {"kind": "push", "force": 20e3, "pad_offset": 1.5, "pads": pads, "steer": {"tool_face": "90 deg"}}
    size = {"od": OD, "id": ID, "element_length": 0.75}
    case = tool({}, 0.0)
    case["string"] = [
        {"kind": "pdm", "length": 3.0, **size, "joint_at": 2.25, "pdm": pdm},
        {"kind": "rss", "length": 6.0, **size, "rss": rss},
    ]
    return case | more


@pytest.mark.parametrize("pads", ["sleeve", "rotating"])
def test_a_motor_turns_the_pads(pads):
    """The side force at the bit is F (L - b)/L of the span, on average; pads swing it three times a turn of the motor."""
    model = at_rest(below_motor(pads))
    release(model)
    move_rigidly(model)
    rows = sampled(
        model.system, 3.0, lambda s: [s.reaction(f"bottom.side_reaction_{i}") for i in (1, 2)], ts_rtol=1e-4
    )
    t, first, second = rows[rows[:, 0] >= 2.0].T
    even = np.linspace(t[0], t[-1], 4001)
    forces = np.array([np.interp(even, t, q) for q in (first, second)])
    assert np.hypot(*forces.mean(axis=1)) == pytest.approx(16.6667e3, rel=1e-2)
    swing = np.ptp(forces[1]) / 16.667e3
    if pads == "sleeve":
        assert swing < 0.01
        return
    assert swing > 0.2
    spectrum = np.abs(np.fft.rfft((forces[1] - forces[1].mean()) * np.hanning(even.size), 8 * even.size))
    found = np.fft.rfftfreq(8 * even.size, even[1] - even[0])[spectrum.argmax()]
    assert found == pytest.approx(3 * TURN * FLOW / (2 * np.pi), rel=0.01)


def test_a_steered_motor_in_mud_drills(tmp_path):
    """A tilted shaft below a motor in mud: the bit turns by top and motor, the tool face stands, mass and energy close."""
    size = {"od": OD, "id": ID}
    pdm = {"rev_per_volume": TURN, "stall_torque": 14e3, "no_load_pressure": 0.5e6}
    rss = {"kind": "point", "tilt": "0.4 deg", "steer": {"tool_face": "60 deg"}}
    survey = {"md": [0, 60, 160], "inclination": [0.4, 0.4, 0.6], "azimuth": [1.0, 1.0, 1.0]}
    case = {
        "well": {
            "survey": survey,
            "sections": [{"to": 160, "kind": "open_hole", "diameter": 0.2159, "friction": 0.2}],
        },
        "string": [
            {"kind": "pipe", "length": 141.7, "od": 0.127, "id": 0.1086},
            {"kind": "stabilizer", "length": 1.0, "od": 0.21, "body_od": OD, "mass": 180},
            {"kind": "pdm", "length": 7.0, **size, "joint_at": 6.2, "pdm": pdm},
            {"kind": "rss", "length": 10.0, **size, "joint_at": 3.0, "rss": rss},
            {"kind": "bit", "length": 0.3, "od": 0.2159, "mass": 60, "nozzle_area": 4e-4},
        ],
        "top": {"kind": "top_drive", "rotation": "40 rpm", "lowering": "10 m/h"},
        "bottom": "bit",
        "fluid": {
            "density": 1150,
            "rheology": {"model": "bingham", "plastic_viscosity": 0.02, "yield_stress": 4},
            "flow_rate": FLOW,
        },
        "formation": {"drillability": 3e-8},
        "initial": {"wob": 30e3},
        "time": {"end": 0.5},
        "output": {"history_every": 0.05},
    }
    done = run(Case(**case), tmp_path / "run", progress="silent")
    got = {
        name.split(" [")[0]: values for name, values in read_table(tmp_path / "run" / "history.csv").items()
    }
    assert got["steering_tool_face"] == pytest.approx(np.full(len(got["time"]), np.radians(60)), abs=1e-3)
    assert got["bit_speed"][-1] == pytest.approx(40 * RPM + got["motor_speed"][-1], rel=0.02)
    assert got["motor_speed"][-1] == pytest.approx(TURN * FLOW, rel=0.02)
    assert abs(done.summary["energy"]["error_share"]) < 1e-3
    rate = 3e-8 * got["wob"] * got["bit_speed"] / (120 * RPM)  # of the bit, which top and motor turn
    assert np.ptp(got["hole_depth"]) == pytest.approx(trapezoid(rate, got["time"]), rel=5e-3)
