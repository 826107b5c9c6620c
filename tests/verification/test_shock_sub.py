"""Shock sub and bumper sub: forces at the bit from the wave equation, static travel, stops, twist (manual: sec-verif-tools)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import drillpetsc
from drillpetsc import BumperSub, Case, ShockSub
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.case.plausible.plausibility import plausibility
from drillpetsc.errors import CaseError
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output import read_table
from drillpetsc.physics.joints import RESULT_NAMES, STOP_ROUNDING
from tests.helpers import frequency_models as m
from tests.helpers.joint_models import joint_component

COLLAR = {"od": 0.1778, "id": 0.0714}
EA_PIPE, EA_COLLAR, SPEED = 206e9 * 3.4047325e-3, 206e9 * 2.0824738e-2, np.sqrt(206e9 / 7850)


def sub(**keys: Any) -> dict:
    """A short shock sub of the collars' size; the pipe below its slider has next to no mass."""
    return ShockSub(**({"length": 0.04, "joint_at": 0.03, "stiffness": 5.25e6, **COLLAR} | keys))


def of_string(w: np.ndarray) -> np.ndarray:
    """Dynamic stiffness [N/m] at the lower end of 200 m of collars under 1800 m of pipe that is held: rods in series."""
    k = w / SPEED
    pipe = EA_PIPE * k / np.tan(1800 * k)
    c, s = np.cos(200 * k), np.sin(200 * k)
    return EA_COLLAR * k * (pipe * c - EA_COLLAR * k * s) / (EA_COLLAR * k * c + pipe * s)


def bit_force(rpm: np.ndarray, order: int, amplitude: float, stiffness: float, damping: float) -> np.ndarray:
    """Amplitude of the force at a bit that moves: string and sub in series."""
    w = order * rpm * np.pi / 30
    return np.abs(amplitude / (1 / of_string(w) + 1 / (stiffness + 1j * w * damping)))


RPM = np.array([60.0, 90.0, 120.0, 150.0])
#: forces [kN] without and with the sub of 5.25 MN/m and 20 kN s/m, as computed for this check before the code was written
WITHOUT = np.array([14.811, 76.071, 307.98, 931.28])
WITH = np.array([159.10, 19.969, 16.769, 15.736])


def test_the_closed_form_has_the_listed_values():
    assert np.abs(of_string(3 * RPM * np.pi / 30)) * 3e-6 == pytest.approx(WITHOUT, rel=1e-4)
    assert bit_force(RPM, 3, 3e-3, 5.25e6, 2e4) / 1e3 == pytest.approx(WITH, rel=1e-4)


@pytest.mark.parametrize(
    ("stiffness", "damping", "millimetres"), [(5.25e6, 2e4, 3.0), (9e6, 6e4, 2.0), (3e6, 0.0, 5.0)]
)
def test_force_at_the_bit_with_a_shock_sub(stiffness, damping, millimetres, tmp_path: Path):
    """60 rpm is worse with the sub, 90 to 150 rpm better; 0.5 %."""
    case = m.two_part_string()
    case["string"] = [*case["string"], sub(stiffness=stiffness, damping=damping)]
    drillpetsc.response(
        Case(**case),
        tmp_path,
        overwrite=True,
        excite="bit",
        amplitude=f"{millimetres} mm",
        speeds="60,90,120,150 rpm",
    )
    found = read_table(tmp_path / "response.csv")
    end = found["place [-]"] == "lower end"
    expected = bit_force(RPM, 3, millimetres * 1e-3, stiffness, damping)
    assert found["axial_force_amplitude [N]"][end] == pytest.approx(expected, rel=5e-3)


# ---------------------------------------------------------------------- statics
def state(item: dict, push: float = 0.0, torque: float = 0.0, name: str = "travel") -> float:
    """A figure of the slider in a string without gravity that is pushed up and turned at its lower end."""
    pipe = {"kind": "pipe", "length": 30, "element_length": 10, **COLLAR}
    bottom = {"kind": "force", "force": [0, 0, -push], "moment": [0, 0, torque]}
    model = build_model(
        Case(
            string=[pipe, item, pipe],
            top="clamped",
            bottom=bottom,
            gravity=0.0,
            initial={"imperfection": 0.0},
        )
    )
    find_equilibrium(model)
    system = model.system
    if name == "turn":
        spin = system.field("string.spin")[:, 0]
        return float(spin[model.mesh.joints[0].cell + 1] - spin[model.mesh.joints[0].cell])
    return float(joint_component(system).element_results(system.assembly)[0, RESULT_NAMES.index(name)])


@pytest.mark.parametrize(
    ("keys", "push", "expected"),
    [
        ({}, 1e5, -19.048e-3),
        ({"stiffness": 8e6}, 6e4, -7.5e-3),
        ({"preload": 3e4}, 1e5, -70e3 / 5.25e6),
        ({"preload": -2e4}, -5e4, 30e3 / 5.25e6),
    ],
)
def test_static_travel(keys, push, expected):
    """(preload - push)/k: 100 kN close 5.25 MN/m by 19.05 mm."""
    assert state(sub(length=2.0, joint_at=1.2, **keys), push) == pytest.approx(expected, rel=1e-4)


def test_stops_carry_what_the_spring_does_not():
    """Pushed by 300 kN with 20 mm of travel: on the stop, 195 kN beyond the spring."""
    found = state(sub(length=2.0, joint_at=1.0, stroke=[-0.02, 0.01], stop_stiffness=2e9), 3e5)
    closed, opened = (1e9 * (z + np.hypot(z, STOP_ROUNDING)) for z in (-0.02 - found, found - 0.01))
    assert 5.25e6 * -found + closed - opened == pytest.approx(3e5, rel=1e-6)
    assert found == pytest.approx((-3e5 - 2e9 * 0.02) / (2e9 + 5.25e6), abs=3e-5)


def test_a_bumper_sub_is_free_between_its_stops():
    item = BumperSub(length=3.0, joint_at=1.0, stroke=[-0.3, 0.1], stop_stiffness=5e8, **COLLAR)
    beyond = 5e4 / 5e8 - 5e8 * STOP_ROUNDING**2 / (4 * 5e4)  # of ks/2 (q + sqrt(q^2 + e^2)) = 50 kN
    assert state(item, 5e4) == pytest.approx(-0.3 - beyond, abs=1e-6)
    assert state(item, -5e4) == pytest.approx(0.1 + beyond, abs=1e-6)
    assert state(item, 5e4, name="tension") == pytest.approx(-5e4, rel=1e-6)


@pytest.mark.parametrize("torque", [4e3, -9e3])
def test_twist_of_a_sub_with_torsional_spring(torque):
    """The part below turns by torque/stiffness against the one above; without the key not at all."""
    item = sub(length=2.0, joint_at=1.0, torsion_stiffness=2.5e5)
    assert state(item, 1e4, torque, "turn") == pytest.approx(torque / 2.5e5, rel=1e-6)
    assert state(item, 1e4, torque, "torque") == pytest.approx(-torque, rel=1e-6)
    assert state(sub(length=2.0, joint_at=1.0), 1e4, torque, "turn") == pytest.approx(0.0, abs=1e-9)


def test_a_tool_has_the_mass_that_is_given():
    """A hanging sub of 900 kg on 2 m: hook load of the string, by the sum of the masses."""
    pipe = {"kind": "pipe", "length": 30, "element_length": 10, **COLLAR}
    case = Case(string=[pipe, sub(length=2.0, mass=900.0)], top="clamped")
    assert case.string[1].material.density == pytest.approx(900 / (2 * 2.0824738e-2), rel=1e-6)
    assert float(build_model(case).mesh.mass @ build_model(case).mesh.length) == pytest.approx(
        900 + 30 * 7850 * 2.0824738e-2, rel=1e-6
    )


# ---------------------------------------------------------------------- messages
def lines(**keys: Any) -> list[str]:
    pipe = {"kind": "pipe", "length": 30, **COLLAR}
    return plausibility(Case(string=[pipe, sub(length=2.0, **keys), pipe], top="clamped"))


def test_preload_that_closes_or_opens_the_stroke_is_named():
    assert lines(preload=-2e5, stroke=[-0.02, 0.02]) == [
        "string[1] shock_sub: preload closes the stroke: acts as rigid without a pull above 95 kN"
    ]
    assert lines(preload=3e5, stroke=[-0.02, 0.02]) == [
        "string[1] shock_sub: preload opens the stroke: acts as rigid without a push above 195 kN"
    ]
    assert lines(preload=5e4, stroke=[-0.02, 0.02]) == [] == lines(preload=5e5)


@pytest.mark.parametrize(
    ("item", "words"),
    [
        (sub(joint_at=0.05), "inside the item"),
        (sub(stroke=[0.1, -0.1]), "the first below the second"),
        (sub(stiffness=0.0), "above 0"),
        (BumperSub(length=1.0, stroke=[0.1, 0.1], **COLLAR), "the first below the second"),
    ],
)
def test_bad_values_are_refused(item, words):
    with pytest.raises(CaseError, match=words):
        Case(string=[{"kind": "pipe", "length": 30, **COLLAR}, item], top="clamped")


def test_a_joint_at_the_slider_of_a_tool_is_refused():
    with pytest.raises(CaseError, match="the slider of shock_sub is there"):
        Case(
            string=[{"kind": "pipe", "length": 30, **COLLAR}, sub(length=2.0, joint_at=1.0)],
            joints=[{"kind": "universal", "at": 31.0}],
            top="clamped",
        )
