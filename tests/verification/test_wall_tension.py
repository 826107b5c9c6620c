"""Tension of the wall of drill pipe with tool joints: that of the tube, not of its mean section with them.

By hand: an open string of one size hangs in still mud, T_e = m g (1 - rho/rho_s) (L - s) and p = rho g s, and the wall of the
tube of diameters D, d carries T_e + p (pi d^2/4 - pi D^2/4) (manual: eq-tubulars-wall-tension).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from drillpetsc import statics
from drillpetsc.analysis.loads.limits.limits import run_limits
from drillpetsc.analysis.loads.torque_drag.roadmap import run_roadmap
from drillpetsc.case import Case
from drillpetsc.output import read_table
from drillpetsc.output.job import Job
from tests.helpers.wells import newtonian

INCH, G, LENGTH, WEAK, DENSITY = 0.0254, 9.80665, 3000.0, 2000.0, 1800.0
OUTER, BORE = 5 * INCH, 4.276 * INCH
TUBE = math.pi / 4 * (BORE**2 - OUTER**2)  # p_i A_i - p_o A_o over a common pressure [m2]


def hanging(class_: str = "new", **keys: Any) -> Case:
    """2000 m of strong and 1000 m of weak 5 in 19.50 in a vertical hole full of mud of 1800 kg/m3, off bottom."""
    sections = [{"to": LENGTH + 100, "kind": "open_hole", "diameter": 0.3}]
    pipe = {"kind": "drill_pipe", "pipe": f"5in 19.50 S-135 NC50 {class_}"}
    return Case(
        string=[pipe | {"length": WEAK}, pipe | {"length": LENGTH - WEAK, "yield_strength": 500e6}],
        top={"kind": "top_drive"},
        well={"survey": {"md": [0, 3100], "inclination": [0, 0], "azimuth": [0, 0]}, "sections": sections},
        fluid=newtonian(DENSITY, 1e-3, flow_rate=0.0, bulk_modulus=1e14, elastic_walls=False),
        **keys,
    )


def by_hand(given: Case, md: np.ndarray) -> np.ndarray:
    """Tension of the tube's wall [N] at measured depths [m]."""
    pipe = given.string[0]
    buoyed = pipe.adjusted_weight * G * (1 - DENSITY / pipe.material.density)
    return buoyed * (LENGTH - md) + DENSITY * G * md * TUBE


def test_limits_and_statics(tmp_path):
    """Within 0.1 % of the string's load; the mean section gave 5 % of it less at half the depth."""
    given = hanging()
    expected_of = by_hand(given, np.zeros(1))[0]
    found = run_limits(Job(given, tmp_path / "limits"), "rotate_off_bottom")
    still = statics(given, tmp_path / "statics").folder
    for table in (read_table(found.folder / "limits.csv"), read_table(still / "statics.csv")):
        off = np.asarray(table["axial_force [N]"]) - by_hand(given, np.asarray(table["md [m]"]))
        assert np.abs(off).max() < 1e-3 * expected_of
        effective = np.asarray(table["axial_force [N]"]) - DENSITY * G * np.asarray(table["md [m]"]) * TUBE
        assert np.asarray(table["effective_tension [N]"]) == pytest.approx(effective, abs=1e-3 * expected_of)


@pytest.mark.parametrize("class_", ["new", "premium"])
def test_mud_alone_gives_the_free_end_no_stress_but_its_pressure(class_, tmp_path):
    """Pressure from all sides is no von Mises stress, whatever the wear: 0 at the lower end, 53 MPa deep."""
    found = run_limits(Job(hanging(class_), tmp_path / "limits"), "rotate_off_bottom")
    table = read_table(found.folder / "limits.csv")
    pressure = DENSITY * G * LENGTH
    assert table["axial_stress [Pa]"][-1] == pytest.approx(-pressure, rel=2e-3)
    assert table["von_mises [Pa]"][-1] < 2e-3 * pressure


@pytest.mark.parametrize("model", ["soft", "stiff"])
def test_overpull_of_a_roadmap(model, tmp_path):
    """0.9 Y A less the tension of the wall at the top of the weaker pipe, under 35 MPa; the mean section had 31 kN more."""
    plan = {"bit_depth": [LENGTH], "operations": ["rob"], "friction_factor": {"open_hole": [0.0]}}
    given = hanging(roadmap=plan)
    table = read_table(run_roadmap(Job(given, tmp_path / "run"), model=model).folder / "roadmap.csv")
    wall = by_hand(given, np.array([WEAK]))[0]
    assert table["overpull_margin [N]"][0] == pytest.approx(0.9 * 500e6 * -TUBE - wall, abs=1e-3 * 762e3)
