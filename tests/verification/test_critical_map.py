"""Critical speeds over the stiffness of the wall (manual: verif-critical-map)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

import drillpetsc
from drillpetsc import Case
from drillpetsc.errors import CaseError
from drillpetsc.output import read_table
from tests.helpers import frequency_models as m
from tests.helpers.command import main_succeeds
from tests.helpers.wells import simple_well

HOLE, SPAN, MASS = 0.2159, 9.0, 700.0
LIGHT = {"young": m.YOUNG, "poisson": 0.3, "density": 1.0, "damping": {"stiffness": 2e-3}}


def shaft() -> dict:
    """A massless shaft between two full-gauge points of the wall, a heavy body in the middle; weightless, with damping and friction."""
    half = {
        "kind": "pipe",
        "length": SPAN / 2,
        "od": m.OD,
        "id": m.ID,
        "element_length": SPAN / 8,
        "material": LIGHT,
    }
    end = half | {"length": 0.02, "element_length": 0.02}
    point = {"kind": "stabilizer", "length": 0.0, "od": HOLE, "mass": 1e-3}
    body = {"kind": "body", "mass": MASS, "inertia": {"axial": 1.0, "transverse": 1e-3}, "unbalance": 0.1}
    return {
        "string": [end, point, half, body, half, point, end],
        "well": simple_well(20, HOLE, friction=0.3),
        "top": {"kind": "top_drive", "force": 0.0, "guided": False, "hinged": True},
        "bottom": "free",
        "gravity": 0.0,
        "initial": {"from": "straight"},
    }


def critical(stiffness: np.ndarray) -> np.ndarray:
    """Critical speed [rpm] of the body on shaft and wall: 1/K = L^3/48 EI + 1/2 k, k the stiffness times the diameter."""
    compliance = SPAN**3 / (48 * m.EI) + 0.5 / (stiffness * HOLE)
    return np.sqrt(1 / (compliance * MASS)) / m.RPM


def test_body_between_two_points_of_the_wall(tmp_path):
    """Soft walls carry the shaft as a rigid body, stiff ones as hinges: 0.5 %.  Through a case file and the command line."""

    file = tmp_path / "shaft.yaml"
    file.write_text(yaml.safe_dump(shaft()))
    words = [
        "campbell", str(file), "--speeds", "10:150:20 rpm", "--count", "4", "--kind", "lateral", "--lines",
        "1",
    ]  # fmt: skip
    walls = np.array([3e5, 1e6, 4e6, 1e9])
    options = ["--stiffness", "3e5,1e6,4e6,1e9 Pa", "--out", str(tmp_path / "run")]
    main_succeeds(*words, *options)
    found = read_table(tmp_path / "run" / "critical_map.csv")
    for wall, expected in zip(walls, critical(walls), strict=True):
        speeds = found["critical_rotary_speed [rpm]"][found["wall_stiffness [Pa]"] == wall]
        assert np.min(np.abs(speeds / expected - 1)) < 5e-3, (wall, expected, speeds)
        assert len(speeds) <= 2  # forward and backward circle of one mode
    assert critical(walls)[0] < 0.8 * critical(walls)[-1]


def test_a_string_without_a_wall_is_refused(tmp_path: Path):
    with pytest.raises(CaseError) as caught:
        drillpetsc.campbell(Case(**m.rotor()), tmp_path / "no", speeds="10,20 rpm", stiffness="1e6 Pa")
    assert caught.value.at == "--stiffness"
