"""Headlines of `limits` are those of the string, not of its mesh."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from drillpetsc import load_case
from drillpetsc.analysis.loads.limits.fatigue import read_sn
from drillpetsc.analysis.loads.limits.limits import run_limits
from drillpetsc.analysis.loads.limits.side_force import largest_on_joint
from drillpetsc.analysis.loads.limits.table import Choices
from drillpetsc.case import Case
from drillpetsc.output.job import Job
from tests.verification.test_limits_command import hole

CASE = Path(__file__).parents[2] / "docs" / "tutorials" / "cases" / "limits.yaml"
SMALL = 1e-3  # ratios below this are none


def headlines(refinement: float, folder: Path) -> dict[str, float]:
    """Figures of the screen of a field case whose build ends within elements, at a refinement of its automatic mesh."""
    given = load_case(CASE, [f"mesh.refinement={refinement}"])
    found = run_limits(
        Job(given, folder / str(refinement)), "drilling", Choices(sn=read_sn("15.0,4.0"))
    ).summary
    out = {name: worst["value"] for name, worst in found["weakest"].items() if worst is not None}
    out |= {key: found[key] for key in ("hook_load", "surface_torque", "max_slackoff")}
    out |= {"margin": found["margin_of_overpull"]["margin"], "pull": found["max_overpull_at_bit"]["pull"]}
    return out | {f"wob {k}": v["wob"] for k, v in found["available_wob"].items()}


def test_headlines_at_refinement_2(tmp_path):
    """Every headline within 2 %; damage goes with the fourth power of a stress, so its fourth root."""
    one, two = (headlines(r, tmp_path) for r in (1, 2))
    assert (
        one.keys() == two.keys()
        and {"casing_wear_rate", "damage_per_hour", "side_force_per_joint"} <= one.keys()
    )
    for name, value in two.items():
        power = 0.25 if name == "damage_per_hour" else 1.0
        assert one[name] ** power == pytest.approx(value**power, rel=0.02, abs=SMALL), name


def test_wear_under_a_point_force(tmp_path):
    """10 kN press the string on casing at one place: the wear rate is that of a joint of 31 ft, whatever the elements.

    F v/L_j = 10 kN x 0.733 m/s over 9.449 m; it was that of an element, and doubled with each halving.
    """
    well = hole(200, 0.0, 0.222, friction=0.0)
    well["sections"][0]["kind"] = "casing"
    for length in (4.0, 2.0, 1.0):
        pipe = {"kind": "pipe", "length": 200.0, "od": 0.14, "id": 0.116, "element_length": length}
        top = {"kind": "top_drive", "rotation": "100 rpm"}
        given = Case(string=[pipe], well=well, top=top, loads=[{"at": 100.0, "force": [10e3, 0, 0]}])
        found = run_limits(Job(given, tmp_path / str(length))).summary
        expected = 10e3 * 100 * math.pi / 30 * 0.07 / (31 * 0.3048)
        assert found["weakest"]["casing_wear_rate"]["value"] == pytest.approx(expected, rel=0.03), length


def test_a_joint_lies_anywhere():
    """A force on one piece of 5 m counts whole for joints whose ends leave it, and at every end from which one reaches it."""
    edges = np.arange(0.0, 105.0, 5.0)
    md, own = np.column_stack([edges[:-1], edges[1:]]), np.zeros(20)
    own[10] = 1e3
    found = largest_on_joint(md, own, np.full(20, 9.0))
    assert found[10] == pytest.approx([1e3, 1e3]) and found[9, 0] == pytest.approx(0.4e3)
    assert found[7].max() == found[13].max() == 0.0
