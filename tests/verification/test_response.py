"""Forced harmonic response against closed forms (manual: verif-response)."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import yaml

import drillpetsc
from drillpetsc import Case
from drillpetsc.analysis.linear.frequency.harmonic import rock_load
from drillpetsc.analysis.linear.modal import modes, prepare_state
from drillpetsc.errors import CaseError
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output import read_table
from drillpetsc.physics.contact import damping_factor
from tests.helpers import frequency_models as m
from tests.helpers.command import main_succeeds
from tests.helpers.tables import each_row
from tests.helpers.wells import simple_well


def table(case: dict, folder: Path, place: str, **options) -> dict[str, np.ndarray]:
    """Columns of response.csv at a place."""
    drillpetsc.response(Case(**case), folder, overwrite=True, **options)
    return at(folder, place)


def at(folder: Path, place: str) -> dict[str, np.ndarray]:
    """Columns at a place of a table that has been written."""
    found = read_table(folder / "response.csv")
    rows = found["place [-]"] == place
    return {name.split(" [")[0]: values[rows] for name, values in found.items()}


# ---------------------------------------------------------------------- unbalance
SPEEDS = np.array([15, 30, 40, 60, 90, 120.0])
#: amplitudes [mm], as computed for this check (C20) before the code was written
SPAN = np.array([0.19109, 1.30490, 8.83669, 2.79329, 1.72606, 1.48203])


def rotor_amplitude(rpm: np.ndarray) -> np.ndarray:
    """Signed amplitude [m] in the middle: 4 EI k^3/(tan(kL/2) - tanh(kL/2)) - M w^2, k^4 = m w^2/EI."""
    w = rpm * m.RPM
    k = (m.MASS * w**2 / m.EI) ** 0.25
    stiffness = 4 * m.EI * k**3 / (np.tan(10 * k) - np.tanh(10 * k)) - 100.0 * w**2
    return 0.5 * w**2 / stiffness


@pytest.mark.parametrize("damping", [0.0, 1e-3])
def test_unbalanced_rotor(damping, tmp_path):
    """Amplitude, forward circles and the turn of the phase at the critical speed.  Damping in the material turns with the
    pipe and does not limit it (C20)."""
    assert np.abs(rotor_amplitude(SPEEDS)) * 1e3 == pytest.approx(SPAN, rel=1e-4)
    rpm = "15,30,40,60,90,120 rpm"
    found = table(m.rotor(damping=damping), tmp_path, "body", excite="unbalance", speeds=rpm)
    assert found["rotary_speed"] == pytest.approx(SPEEDS)
    assert found["lateral_amplitude"] * 1e3 == pytest.approx(SPAN, rel=5e-3)
    assert found["whirl"] == pytest.approx(np.ones(6), abs=1e-6)
    assert np.abs(found["lateral_phase"]) == pytest.approx([0, 0, 0, 180, 180, 180], abs=1e-6)
    assert set(found["validity"]) == {"linear"}


def test_order_of_the_rotor(tmp_path):
    """Error at 40 rpm falls at least with the square of the element (2, 4, 8 elements a half)."""
    exact = rotor_amplitude(np.array([40.0]))[0]
    errors = [
        abs(
            table(m.rotor(n), tmp_path, "body", excite="unbalance", speeds="40 rpm")["lateral_amplitude"][0]
            / exact
            - 1
        )
        for n in (2, 4, 8)
    ]
    assert np.log2(errors[0] / errors[1]) > 1.8 and errors[2] < 1e-3


def test_critical_speed_of_the_rotor(tmp_path):
    """42.9907 rpm: the phase turns within 0.5 % of it, and the amplitude is more than 100 times that at 30 rpm."""
    found = table(m.rotor(), tmp_path, "body", excite="unbalance", speeds="42.776, 43.206 rpm")
    assert np.abs(found["lateral_phase"]) == pytest.approx([0, 180], abs=1e-3)
    assert found["lateral_amplitude"].min() > 0.1


def test_a_hinged_top_drive_is_a_pinned_top(tmp_path):
    case = m.rotor()
    pinned = table(case, tmp_path, "body", excite="unbalance", speeds="30,60 rpm")
    case["top"] = {"kind": "top_drive", "rotation": "10 rpm", "hinged": True}
    hinged = table(case, tmp_path, "body", excite="unbalance", speeds="30,60 rpm")
    assert hinged["lateral_amplitude"] == pytest.approx(pinned["lateral_amplitude"], rel=1e-12)


def test_eccentric_and_bent_pipe(tmp_path):
    """Pinned pipe of 20 m whose centre of mass is off by e, or with a stress-free curvature: with q = kL/2, k^4 = m w^2/EI,

    -e + e/2 (1/cos q + 1/cosh q), and (1/cosh q - 1/cos q)/(2 k^2) times the curvature, in the middle; bending moment of
    the eccentric pipe there: EI e k^2/2 (1/cos q - 1/cosh q) (from EI w'''' - m w^2 (w + e) = 0)."""
    rpm = np.array([20.0, 35.0, 90.0])
    k = (m.MASS * (rpm * m.RPM) ** 2 / m.EI) ** 0.25
    q = 10.0 * k
    half = {"eccentricity": 0.003}, {"curvature": 2e-4}
    expected = (
        np.abs(-0.003 + 0.0015 * (1 / np.cos(q) + 1 / np.cosh(q))),
        np.abs((1 / np.cosh(q) - 1 / np.cos(q)) / (2 * k**2)) * 2e-4,
    )
    for more, amplitude in zip(half, expected, strict=True):
        case = m.rotor() | {"string": [m.drill_pipe(20.0, 20, **more)], "output": {"probes": [10.0]}}
        found = table(case, tmp_path, "probe 10 m", excite="unbalance", speeds="20,35,90 rpm")
        assert found["lateral_amplitude"] == pytest.approx(amplitude, rel=2e-3)
        if "eccentricity" in more:
            moment = m.EI * 0.0015 * k**2 * np.abs(1 / np.cos(q) - 1 / np.cosh(q))
            assert found["bending_moment_amplitude"] == pytest.approx(moment, rel=5e-3)


@pytest.mark.parametrize(("rpm", "lobes", "flow"), [("10,30 rpm", 3, 0.04), ("5,60 rpm", 6, 0.021)])
def test_orbit_of_a_motor(rpm, lobes, flow, tmp_path):
    """M e (N w - Omega)^2 in the middle of a span hinged at both ends, backwards, at its own frequency; 0.5 %.

    The dynamic stiffness is that of C20, with the rotor's mass; a motor without load turns by 2 pi n Q.
    """
    mass, eccentricity, turn = 120.0, 0.006, 20.0
    half = m.drill_pipe(9.5, 10, 0.0)
    size = {"od": half["od"], "id": half["id"]}
    section = {
        "rev_per_volume": turn, "stall_torque": 1e4, "flow_rate": flow, "rotor_mass": mass, "eccentricity": eccentricity,
        "lobes": [lobes, lobes + 1],
    }  # fmt: skip
    motor = {
        "kind": "pdm",
        "name": "motor",
        "length": 1.0,
        **size,
        "element_length": 0.5,
        "mass": m.MASS + mass,
    }
    case = m.rotor() | {"string": [half, motor | {"pdm": section}, half]}
    found = table(
        case | {"output": {"probes": [10.0]}}, tmp_path, "probe 10 m", excite="motor", speeds=rpm, stress=True
    )
    assert len(found["rotary_speed"]) == 2
    w = lobes * turn * flow - found["rotary_speed"] * np.pi / 30
    assert found["excitation_frequency"] == pytest.approx(
        np.abs(w) / (2 * np.pi), rel=3e-5
    )  # the slip without load
    k = (m.MASS * w**2 / m.EI) ** 0.25
    stiffness = 4 * m.EI * k**3 / (np.tan(10 * k) - np.tanh(10 * k)) - mass * w**2
    assert found["lateral_amplitude"] == pytest.approx(
        np.abs(mass * eccentricity * w**2 / stiffness), rel=5e-3
    )
    assert found["whirl"] == pytest.approx(-np.sign(w), abs=1e-3)
    # a circle at another speed than that of the pipe: its moment alternates in full
    bending = found["bending_moment_amplitude"] * 0.5 * m.OD * m.YOUNG / m.EI
    assert found["stress_amplitude"] == pytest.approx(bending, rel=1e-3)


def test_a_motor_without_an_orbit_excites_nothing(tmp_path):
    with pytest.raises(CaseError, match="rotor_mass, eccentricity and lobes"):
        table(m.rotor(), tmp_path, "body", excite="motor", speeds="20 rpm")


# ---------------------------------------------------------------------- the bit
def test_bit_that_moves_three_times_a_turn(tmp_path):
    """Axial force at a lower end that moves by 3 mm, from the wave equation of drill pipe and collars: 14.811, 76.071, 307.98,
    931.28 kN at 60, 90, 120, 150 rpm (C23); tolerance 0.5 %.  Through a case file and the command line."""

    file = tmp_path / "string.yaml"
    file.write_text(yaml.safe_dump(m.two_part_string()))
    words = ["response", str(file), "--excite", "bit", "--amplitude", "3 mm", "--speeds", "60,90,120,150 rpm"]
    main_succeeds(*words, "--out", tmp_path / "run")
    found = read_table(tmp_path / "run" / "response.csv")
    end = found["place [-]"] == "lower end"
    expected = np.array([14.811e3, 76.071e3, 307.98e3, 931.28e3])
    assert found["axial_force_amplitude [N]"][end] == pytest.approx(expected, rel=1e-4)
    assert found["axial_amplitude [m]"][end] == pytest.approx(np.full(4, 3e-3))
    assert (tmp_path / "run" / "plots" / "response.png").exists()
    peaks = json.loads((tmp_path / "run" / "summary.json").read_text())["peaks"]
    assert peaks[-1]["axial_force_amplitude"] == pytest.approx([931.28e3, 150.0], rel=1e-4)


def test_resonance_of_the_collars(tmp_path):
    """The force has a pole at c/(4 x 200 m) x 20 rpm = 128.067: large on both sides, of opposite sign (C23)."""
    speeds = "128.003, 128.131 rpm"  # 0.05 % below and above
    found = table(m.two_part_string(2), tmp_path, "top", excite="bit", amplitude="3 mm", speeds=speeds)
    assert found["axial_force_amplitude"].min() > 5e6
    wave = 3 * 128.067 / 60 * 2 * np.pi / m.AXIAL_SPEED
    assert wave * 200 == pytest.approx(np.pi / 2, rel=1e-5)


def test_damped_force_and_torque(tmp_path):
    """A pipe of 1000 m held at the top, with Kelvin-Voigt damping b, under a force or torque at its free end:
    motion F/(E' A k) tan(k L), force at the top F/cos(k L), k = w/c', c'^2 = c^2 (1 + i w b), E' = E (1 + i w b)."""
    b, L = 2e-3, 1000.0
    case = m.two_part_string() | {"string": [m.drill_pipe(L, 200, damping=b)]}
    rpm = np.array([40.0, 75.0, 160.0])
    for what, stiffness, speed, motion, force in (
        ("5 kN", m.YOUNG * m.AREA, m.AXIAL_SPEED, "axial", "axial_force"),
        ("1 kN m", m.GJ, m.TORSIONAL_SPEED, "twist", "torque"),
    ):
        load = 5e3 if what == "5 kN" else 1e3
        options = {"excite": "bit", "amplitude": what, "order": 2.0, "speeds": "40,75,160 rpm"}
        w = 2 * rpm * m.RPM
        complex_part = 1 + 1j * w * b
        k = w / (speed * np.sqrt(complex_part))
        end = table(case, tmp_path, "lower end", **options)
        exact = load / (stiffness * complex_part * k) * np.tan(k * L)
        assert end[f"{motion}_amplitude"] == pytest.approx(np.abs(exact), rel=2e-3)
        assert end[f"{motion}_phase"] == pytest.approx(np.degrees(np.angle(exact)), abs=0.3)
        top = at(tmp_path, "top")
        assert top[f"{force}_amplitude"] == pytest.approx(np.abs(load / np.cos(k * L)), rel=2e-3)


# ---------------------------------------------------------------------- a place along the string
LENGTH, PLACE, DAMPED = 1000.0, 400.0, 2e-3
# elements of 1 m: beside a load the strain jumps, which the elements smooth over one of them
THREE = [
    m.drill_pipe(300.0, 300, damping=DAMPED),
    m.drill_pipe(200.0, 200, damping=DAMPED, name="tool"),
    m.drill_pipe(500.0, 500, damping=DAMPED),
]


@pytest.mark.parametrize(
    ("excite", "what", "stiffness", "wave_speed", "motion", "force"),
    [
        ("tool", "5 kN", m.YOUNG * m.AREA, m.AXIAL_SPEED, "axial", "axial_force"),
        ("400 m", "1 kN m", m.GJ, m.TORSIONAL_SPEED, "twist", "torque"),
        ("400 m", "3 mm", m.YOUNG * m.AREA, m.AXIAL_SPEED, "axial", "axial_force"),
    ],
)
def test_an_excitation_along_the_string(excite, what, stiffness, wave_speed, motion, force, tmp_path):
    """A load F, or a motion U, at the depth a of a pipe held at the top and free below, by an item's name and by its depth.

    Motion of the free end F/(E' A k) sin(k a)/cos(k L), force at the top F cos(k (L - a))/cos(k L); U/cos(k (L - a)), E' A k U/sin(k a); k and
    E' as above.
    """
    case = m.two_part_string() | {"string": THREE}
    rpm = np.array([40.0, 75.0, 160.0])
    w, complex_part = 2 * rpm * m.RPM, 1 + 2j * rpm * m.RPM * DAMPED
    k = w / (wave_speed * np.sqrt(complex_part))
    size = {"5 kN": 5e3, "1 kN m": 1e3, "3 mm": 3e-3}[what]
    if what == "3 mm":
        end, top = (
            size / np.cos(k * (LENGTH - PLACE)),
            stiffness * complex_part * k * size / np.sin(k * PLACE),
        )
    else:
        end = size / (stiffness * complex_part * k) * np.sin(k * PLACE) / np.cos(k * LENGTH)
        top = size * np.cos(k * (LENGTH - PLACE)) / np.cos(k * LENGTH)
    options = {"excite": excite, "amplitude": what, "order": 2.0, "speeds": "40,75,160 rpm"}
    found = table(case, tmp_path, "lower end", **options)
    assert found[f"{motion}_amplitude"] == pytest.approx(np.abs(end), rel=2e-3)
    assert found[f"{motion}_phase"] == pytest.approx(np.degrees(np.angle(end)), abs=0.3)
    assert at(tmp_path, "top")[f"{force}_amplitude"] == pytest.approx(np.abs(top), rel=2e-3)
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert any("node at MD 400 m" in w for w in summary["warnings"])
    name = "tool" if excite == "tool" else "MD 400 m"
    assert f"at {name}, 2 per turn" in summary["excitation"]


@each_row(
    ("excite", "amplitude", "at", "said"),
    [
        ("unbalanc", "1 kN", "--excite", "unbalance"), ("toll", "1 kN", "--excite", "tool"),
        ("1200 m", "1 kN", "--excite", "0 to 1000 m"), ("-3 m", "1 kN", "--excite", "0 to 1000 m"),
        ("tool", None, "--amplitude", "5 kN"), ("tool", "1 kg", "--amplitude", "5 kN"),
    ],
)  # fmt: skip
def test_wrong_places_are_refused(excite, amplitude, at, said, tmp_path):
    case = Case(**m.two_part_string() | {"string": THREE})
    with pytest.raises(CaseError) as caught:
        drillpetsc.response(case, tmp_path / "no", excite=excite, amplitude=amplitude, speeds="40 rpm")
    assert caught.value.at == at and said in str(caught.value)


# ---------------------------------------------------------------------- unlucky inputs
def test_an_undamped_resonance_is_infinite(tmp_path):
    """At a frequency of the undamped model the amplitude is infinite, said so, and not a number; damped it is finite."""
    case = m.two_part_string() | {"string": [m.drill_pipe(1000.0, 50)]}
    model = build_model(Case(**case))
    prepare_state(model)
    speed = 2 * np.pi * modes(model, 1, kind="axial").frequency[0] / 3
    options = {"excite": "bit", "amplitude": "1 kN", "speeds": [0.9 * speed, speed]}
    found = table(case, tmp_path, "lower end", **options)
    assert list(found["validity"]) == ["linear", "infinite"]
    assert np.isfinite(found["axial_amplitude"][0]) and np.isinf(found["axial_amplitude"][1])
    assert found["lateral_amplitude"][1] == 0 and np.isinf(found["axial_force_amplitude"][1])
    warnings = json.loads((tmp_path / "summary.json").read_text())["warnings"]
    assert any("infinite" in w for w in warnings) and any("dissipates" in w for w in warnings)
    case["string"] = [m.drill_pipe(1000.0, 50, damping=1e-4)]
    assert list(table(case, tmp_path, "lower end", **options)["validity"]) == ["linear", "linear"]


HOLE = simple_well(20, 0.131, kind="casing", friction=0.0)


def test_an_amplitude_beyond_the_clearance_is_marked(tmp_path):
    """Radial clearance 2 mm: linear at 30 rpm (1.305 mm), beyond it at 40 rpm (8.837 mm)."""
    case = m.rotor() | {"well": HOLE, "output": {"probes": [10.0]}}
    found = table(case, tmp_path, "probe 10 m", excite="unbalance", speeds="30,40 rpm")
    assert list(found["validity"]) == ["linear", "touches"]
    assert found["clearance_use"] == pytest.approx(np.array([1.30490, 8.83669]) / 2.0, rel=5e-3)


def test_a_bit_that_lifts_off_is_marked(tmp_path):
    """A bit on bottom with 1 kN: a moving bottom of the hole with more force than that is beyond the linear result."""
    string = [m.drill_pipe(99.5, 20, damping=1e-3), {"kind": "bit", "length": 0.5, "od": 0.131, "mass": 20}]
    well = simple_well(100, 0.131, friction=0.2)
    case = {
        "string": string,
        "well": well,
        "top": {"kind": "top_drive", "rotation": "60 rpm"},
        "bottom": "bit",
    }
    case["initial"] = {"wob": 1e3}
    for amplitude, word in (("0.01 mm", "linear"), ("1 mm", "lifts")):
        found = table(case, tmp_path, "bit", excite="bit", amplitude=amplitude, speeds="60 rpm")
        assert list(found["validity"]) == [word]


def test_a_body_on_the_wall_that_lifts_off_is_marked(tmp_path):
    """A level span on a body of 0.1 m, whose middle is at 10.05 m: it lifts where the unbalance's force exceeds the weight it carries.

    With 0.2 m/s2 it carries less than the string's 130 N, and more than some newtons; 90 rpm give 0.01 and 2 kg m forces of 0.9 and 178 N."""
    case = m.rotor() | {"well": simple_well(20.1, 0.135, np.pi / 2, friction=0.0), "gravity": 0.2}
    case["string"][1] |= {"length": 0.1, "od": 0.1348}
    case["initial"] = {"from": "statics"}
    for unbalance, word in ((0.01, "linear"), (2.0, "lifts")):
        case["string"][1]["unbalance"] = unbalance
        found = table(case, tmp_path, "body", excite="unbalance", speeds="90 rpm")
        assert list(found["validity"]) == [word]
        assert found["md"] == pytest.approx([10.05])


@each_row(
    ("changes", "options", "words"),
    [
        ({"top": "free"}, {}, ("top", "turn")),
        ({"bottom": "clamped"}, {}, ("bottom", "turn")),
        (
            {"beam": {"formulation": "quaternion"}, "string": [m.drill_pipe(20.0, 4, eccentricity=1e-3)]},
            {},
            ("beam.formulation", "response"),
        ),
        ({"string": [m.drill_pipe(20.0, 4)]}, {}, ("--excite", "unbalance")),
        ({}, {"speeds": "0:60:10 rpm"}, ("--speeds", "above 0")),
        ({}, {"speeds": "-30 rpm"}, ("--speeds", "at least 0")),
        ({}, {"speeds": "60:60:10 rpm"}, ("--speeds", "smaller")),
        ({}, {"speeds": "60:30:10 rpm"}, ("--speeds", "smaller")),
        ({}, {"speeds": "30:60:0 rpm"}, ("--speeds", "step")),
        ({}, {"speeds": "30:60:-5 rpm"}, ("--speeds", "step")),
        ({}, {"speeds": "30:60:5"}, ("--speeds", "unit")),
        ({}, {"speeds": "30:60:5 m"}, ("--speeds", "rad/s")),
        ({}, {"speeds": "60,30 rpm"}, ("--speeds", "ascending")),
        ({}, {"excite": "motor"}, ("--excite", "a pdm with rotor_mass")),
        ({}, {"excite": "wind"}, ("--excite", "unbalance, bit")),
        ({}, {"excite": "unbalance", "amplitude": "3 mm"}, ("--amplitude", "unbalance")),
        ({}, {"excite": "bit"}, ("--amplitude", "3 mm")),
        ({}, {"excite": "bit", "amplitude": "3"}, ("--amplitude", "unit")),
        ({}, {"excite": "bit", "amplitude": "3 s"}, ("--amplitude", "unit")),
        ({}, {"excite": "bit", "amplitude": "0 mm"}, ("--amplitude", "above 0")),
        ({}, {"excite": "bit", "amplitude": "3 mm", "order": 0.0}, ("--order", "above 0")),
    ],
)  # fmt: skip
def test_bad_input_is_refused(changes, options, words, tmp_path):
    case = Case(**(m.rotor() | changes))
    with pytest.raises(CaseError) as error:
        drillpetsc.response(case, tmp_path / "run", **({"excite": "unbalance", "speeds": "30 rpm"} | options))
    assert all(word in str(error.value) for word in words), str(error.value)


# ---------------------------------------------------------------------- stresses of the turning pipe
RADIUS, INERTIA = 0.5 * m.OD, m.EI / m.YOUNG


def test_stress_of_an_axial_force_and_a_torque(tmp_path):
    """|N|/A under drill pipe and under collars, r |T|/2I; the mean stress of a tension of 50 kN (C23's string)."""
    case = m.two_part_string() | {"bottom": {"kind": "force", "force": [0, 0, 50e3]}}
    options = {"excite": "bit", "amplitude": "8 kN", "order": 3.0, "speeds": "35,50,90 rpm", "stress": True}
    w = 3 * np.array([35, 50, 90]) * m.RPM / m.AXIAL_SPEED
    # wave equation: force 8 kN at the free end of the collars, their motion and force meet those of the pipe
    ratio = m.AREA / m.COLLAR_AREA
    joint = 8e3 / (np.cos(200 * w) - np.sin(200 * w) * np.tan(1800 * w) / ratio)
    top = table(case, tmp_path, "top", **options)
    assert top["axial_force_amplitude"] == pytest.approx(np.abs(joint / np.cos(1800 * w)), rel=2e-3)
    assert top["stress_amplitude"] == pytest.approx(top["axial_force_amplitude"] / m.AREA, rel=1e-9)
    assert top["mean_stress"] == pytest.approx(np.full(3, 50e3 / m.AREA), rel=1e-6)
    end = table(case, tmp_path, "lower end", **options)
    assert end["stress_amplitude"] == pytest.approx(np.full(3, 8e3 / m.COLLAR_AREA), rel=2e-2)
    turned = table(case, tmp_path, "top", **(options | {"amplitude": "1 kN m"}))
    assert turned["shear_stress_amplitude"] == pytest.approx(
        turned["torque_amplitude"] * 0.5 * RADIUS / INERTIA, rel=1e-9
    )


def test_the_moment_of_an_unbalance_turns_with_the_pipe(tmp_path):
    """A forward circle bends the pipe without an alternating stress; in a field of forces the static moment alternates.

    Hinged span with a body in the middle: M = q L^2/8 + m g L/4 of its weight, upright none."""
    options = {"excite": "unbalance", "speeds": "30,60,90 rpm", "stress": True}
    upright = table(m.rotor(), tmp_path, "body", **options)
    bending = upright["bending_moment_amplitude"] * RADIUS / INERTIA
    assert bending.min() > 1e5
    assert np.all(upright["stress_amplitude"] < 1e-4 * bending)
    small = m.rotor() | {
        "gravity": [0.05, 0, 0]
    }  # so small that the hinges, which stand still, pull at nothing
    small["string"][1]["unbalance"] = 0.05
    lying = table(small, tmp_path, "body", **options)
    moment = (m.MASS * 20**2 / 8 + 100 * 20 / 4) * 0.05
    assert lying["stress_amplitude"] == pytest.approx(np.full(3, moment * RADIUS / INERTIA), rel=1e-2)
    assert lying["bending_moment_amplitude"] == pytest.approx(
        0.1 * upright["bending_moment_amplitude"], rel=5e-3
    )


def test_the_load_of_a_rock_that_moves_has_the_damping_of_its_contact():
    """A bit on bottom with W pushes k d (1 + c v): rock that moves by a exp(i w t) loads it by k a + i w c W a."""
    weight, stiffness, damping, omega = 1e4, 1e8, damping_factor(0.5, 1.0), 30.0
    case = Case(
        string=[m.drill_pipe(99.5, 5), {"kind": "bit", "length": 0.5, "od": 0.131, "mass": 20}],
        well=simple_well(100, 0.131, friction=0.2),
        top={"kind": "top_drive", "rotation": "60 rpm", "lowering": weight * 5e-7},
        bottom={"kind": "bit", "stiffness": stiffness, "friction": 0.0},
        contact={"restitution": 0.5, "restitution_speed": 1.0},
        formation={"drillability": 5e-7, "reference_speed": "60 rpm"},
        initial={"wob": weight},
    )
    model = build_model(case)
    prepare_state(model)
    load = rock_load(model, 1e-3, omega)
    push = load[np.argmax(np.abs(load))]
    assert abs(push.real) == pytest.approx(1e-3 * stiffness, rel=1e-3)
    assert push.imag / push.real == pytest.approx(omega * damping * weight / stiffness, rel=1e-2)
