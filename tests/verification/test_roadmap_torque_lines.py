"""Make-up torque and torque at yield of the pipe at the rig in a roadmap (manual: sec-guide-roadmap)."""

from __future__ import annotations

import json
import math

import pytest

from drillpetsc.analysis.loads.torque_drag.roadmap import run_roadmap
from drillpetsc.case.catalogue.sizes import LBF
from drillpetsc.output import read_table
from drillpetsc.output.job import Job
from drillpetsc.plotting.run.plot import figures
from tests.verification.test_roadmap_command import PIPE, case

FT_LBF = 0.3048 * LBF
PLAN = {"bit_depth": [1000, 2000], "friction_factor": {"open_hole": [0.3]}, "operations": ["rob", "drilling"]}
DRILL_PIPE = {"kind": "drill_pipe", "pipe": "5in 19.50 E-75 NC50 new"}


def run(folder, item=DRILL_PIPE, above=(), **plan):
    made = case([0, 2000], [60, 60], item=item, above=above, length=2000, roadmap=PLAN | plan)
    result = run_roadmap(Job(made, folder / "run"))
    return result, json.loads((result.folder / "roadmap.json").read_text())["torque_lines"]


def test_torque_at_yield_is_that_of_api(tmp_path):
    """0.096167 J/D sqrt(Y^2 - (P/A)^2) in psi, in and ft-lbf (API RP 7G), P the larger hook load of each bit depth."""
    result, lines = run(tmp_path)
    table = read_table(result.folder / "roadmap.csv")
    polar, area = math.pi / 32 * (5**4 - 4.276**4), math.pi / 4 * (5**2 - 4.276**2)
    assert lines["bit_depth [m]"] == [1000, 2000]
    for depth, found in zip(lines["bit_depth [m]"], lines["torque_at_yield [N m]"], strict=True):
        pull = table["hook_load [N]"][table["bit_depth [m]"] == depth].max() / LBF
        expected = 0.096167 * polar / 5 * math.sqrt(75e3**2 - (pull / area) ** 2)
        assert found / FT_LBF == pytest.approx(expected, rel=1e-3)
    assert not any("at the rig" in w for w in result.summary["warnings"])


def test_torque_beyond_the_make_up_torque_is_told(tmp_path):
    """At 2000 m the string needs more torque than the connection is made up with, at 1000 m it does not."""
    free, _ = run(tmp_path / "free", operations=["rob"])
    table = read_table(free.folder / "roadmap.csv")
    torque, at = table["surface_torque [N m]"], table["bit_depth [m]"]
    between = 0.5 * (torque[at == 1000].max() + torque[at == 2000].min())
    assert torque[at == 1000].max() < between < torque[at == 2000].min()
    result, lines = run(
        tmp_path / "low", DRILL_PIPE | {"tool_joint": {"make_up_torque": between}}, operations=["rob"]
    )
    assert lines["make_up_torque [N m]"] == pytest.approx([between] * 2)
    said = [w for w in result.summary["warnings"] if "make-up torque of the pipe at the rig" in w]
    assert len(said) == 1 and "in 1 rows, first at MD 2000 m" in said[0]


def test_the_pipe_at_the_rig_changes_with_the_depth(tmp_path):
    """1500 m of weak pipe below stronger pipe: at 1000 m the weak one is at the rig, at 2000 m the other."""
    upper = {**DRILL_PIPE, "tool_joint": {"make_up_torque": 50e3}, "length": 500}
    made = case(
        [0, 2000],
        [60, 60],
        item=DRILL_PIPE | {"tool_joint": {"make_up_torque": 30e3}},
        above=[upper],
        length=1500,
        roadmap=PLAN,
    )
    result = run_roadmap(Job(made, tmp_path / "run"))
    lines = json.loads((result.folder / "roadmap.json").read_text())["torque_lines"]
    assert lines["make_up_torque [N m]"] == [30e3, 50e3]


@pytest.mark.parametrize(
    "plan", [{}, {"bit_depth": [2000]}, {"bit_depth": [2000], "operations": ["trip_in"]}]
)
def test_what_is_not_known_has_no_line(plan, tmp_path):
    """A plain tube has neither figure; pictures are drawn for one depth and without torque."""
    result, lines = run(tmp_path, PIPE, **plan)
    assert set(lines["make_up_torque [N m]"] + lines["torque_at_yield [N m]"]) == {None}
    for item, name in ((PIPE, "pipe"), (DRILL_PIPE | {"tool_joint": {"make_up_torque": 20e3}}, "drill pipe")):
        result, _ = run(tmp_path / name, item, **plan)
        drawing = figures(result.folder, "metric").get("roadmap_torque")
        if "operations" in plan:
            assert drawing is None
            continue
        words = " ".join(t.get_text() for t in drawing.axes[0].get_legend().get_texts())
        assert ("pipe at the rig" in words) == (item is not PIPE)
