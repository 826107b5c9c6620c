"""`follow --model stiff`: the beam beside the soft string once a stand, and the filter along its tangent."""

from __future__ import annotations

import numpy as np
import pytest

import drillpetsc
from drillpetsc.analysis.follow.advice import models_told
from drillpetsc.analysis.follow.alarms import Error
from drillpetsc.analysis.follow.follower import Follower, Reading
from drillpetsc.analysis.follow.strings import Load
from drillpetsc.analysis.loads.torque_drag.operations import Load as Pulled
from drillpetsc.analysis.loads.torque_drag.operations import Pair
from drillpetsc.analysis.loads.torque_drag.stiff import Job, stiff_row
from drillpetsc.analysis.loads.torque_drag.string_rows import need_well, rows_at
from drillpetsc.case import load_case
from drillpetsc.errors import CaseError
from drillpetsc.output.files.tables import read_table
from tests.verification.test_follow import CASE, planted_log

WELL = """
title: a slant well
rig: {{block_weight: 200 kN}}
well:
  survey: {{md: {md}, inclination: {inclination}, azimuth: {azimuth}}}
  sections: [{{kind: open_hole, to: end, diameter: 216 mm, friction: 0.25}}]
bit_depth: 600 m
string:
  - {{kind: pipe, name: pipe, length: 540 m, od: 127 mm, id: 108.6 mm}}
  - {{kind: drill_collar, length: 60 m, od: {od} mm, id: 71 mm}}
top: {{kind: top_drive, rotation: 100 rpm}}
bottom: bit

"""


def well(folder, md, inclination, azimuth, od=165):
    lists = {"md": md, "inclination": inclination, "azimuth": azimuth}
    units = {"md": "m", "inclination": "deg", "azimuth": "deg"}
    text = {
        name: "[" + ", ".join(f"{q} {units[name]}" for q in values) + "]" for name, values in lists.items()
    }
    (folder / "case.yaml").write_text(WELL.format(od=od, **text))
    return load_case(folder / "case.yaml")


def test_a_straight_hole_is_the_closed_form(tmp_path):
    """Both models in a hole of 50 degrees: W (cos I + mu sin I) of a string pulled, W cos I of one that turns, mu W r sin I."""
    case = well(tmp_path, [0, 600], [50, 50], [0, 0])
    follower = Follower(case, 200e3, model="stiff")
    rows = rows_at(case, 600.0, "bit depth")
    angle, weight = np.radians(50), float(rows.weight @ np.diff(rows.edges))
    radius = float(rows.weight * rows.contact_radius @ np.diff(rows.edges))
    mean = follower.belief.mean.copy()
    mean[[q.name for q in follower.states].index("running_drag")] = 0.0
    pulled = follower.beam.look(Load("trip_out", 600.0, velocity=0.3), mean)
    turned = follower.beam.look(Load("rotate_off_bottom", 600.0, rotation=10.0), mean)
    for model in ("soft", "stiff"):
        hook = getattr(pulled, model)[0] - 200e3
        assert hook == pytest.approx(weight * (np.cos(angle) + 0.25 * np.sin(angle)), rel=2e-3)
        hook, torque = getattr(turned, model) - [200e3, 0.0]
        assert hook == pytest.approx(weight * np.cos(angle), rel=2e-3)
        assert torque == pytest.approx(0.25 * radius * np.sin(angle), rel=1e-2)


def test_the_tangent_is_that_of_the_beam_of_a_roadmap():
    """Readings along the tangent at another friction and weight, beside full solutions of `roadmap --model stiff`."""
    case = load_case(CASE)
    follower = Follower(case, 623e3, model="stiff")
    names, well_ = [q.name for q in follower.states], need_well(case, "x")
    mean = follower.belief.mean.copy()
    mean[names.index("running_drag")] = 0.0
    for load, rotation in (
        (Load("trip_out", 2100.0, velocity=0.3), 0.0),
        (Load("rotate_off_bottom", 2100.0, rotation=15.7), 15.7),
    ):
        assert follower.beam.look(load, mean) is not None
        for change in (0.0, 0.02):
            at = mean.copy()
            at[names.index("cased")] += change
            at[names.index("open_hole")] -= change
            found = follower.strings.readings(at[None], load)[0]
            pair = Pair(np.nan, np.nan, np.array([0.18 + change, 0.22 - change]))
            own = stiff_row(
                case, well_, Job(rows_at(case, 2100.0, "x"), pair, Pulled(0.0, 0.0, load.velocity, rotation))
            )
            assert own["status"] == "ok"
            assert found[0] - 623e3 == pytest.approx(own["hook_load"], rel=1e-6 if not change else 2e-4)
            if rotation:
                assert found[1] == pytest.approx(own["surface_torque"], rel=1e-6 if not change else 1e-3)


def test_where_the_models_differ_is_told(tmp_path):
    """A collar of 200 mm in 216 mm of hole with doglegs of 5 degrees in 10 m: the beam drags more, and the words say where."""
    md = [0, 300, *range(310, 610, 10)]
    inclination = [0, 30, *(30 + 5 * (i % 2) for i in range(30))]
    case = well(tmp_path, md, inclination, [0.0] * len(md), od=200)
    follower = Follower(case, 200e3, model="stiff")
    load = Load("trip_out", 600.0, velocity=0.3)
    update = follower.see(Reading(load, np.nan, 400e3, np.nan))
    both = update.compared
    assert both is not None and both.stiff[0] > both.soft[0]
    band = {"hook_load": Error(400e3, 400e3, 0.1 * (both.stiff[0] - both.soft[0]))}
    update.forecast.update(band)
    told = models_told(case, update)["hook_load"]
    assert "trust the stiff string" in told and "presses on bends" in told and "MD 5" in told
    update.forecast["hook_load"] = Error(400e3, 400e3, both.stiff[0] - both.soft[0])
    assert not models_told(case, update)


def test_restart_gives_the_same_file_and_a_state_each_stand(tmp_path):
    case = load_case(CASE)
    lines = planted_log(case, tmp_path / "rig.csv")
    whole = drillpetsc.follow(CASE, tmp_path / "whole", log=str(tmp_path / "rig.csv"), model="stiff")
    part = tmp_path / "part.csv"
    for k, end in enumerate((150, len(lines))):
        part.write_text("\n".join(lines[:end]) + "\n")
        drillpetsc.follow(CASE, tmp_path / "parts", log=str(part), restart=k > 0, model="stiff")
    texts = [(tmp_path / name / "follow.csv").read_bytes() for name in ("whole", "parts")]
    assert texts[0] == texts[1]
    assert len(whole.summary["beam_seconds"]) == 3  # at 2000, 2030 and 2060 m of 90 m


def test_a_case_without_such_a_beam_is_refused(tmp_path):
    case = well(tmp_path, [0, 600], [50, 50], [0, 0]).replace({"beam.formulation": "quaternion"})
    with pytest.raises(CaseError, match="formulation"):
        Follower(case, 200e3, model="stiff")


def test_a_difference_is_told_once_while_it_lasts(tmp_path, capsys):
    """A trip of eight stands through doglegs: one line on the screen, one entry in the summary, and the page has it."""
    md = [0, 300, *range(310, 610, 10)]
    well(tmp_path, md, [0, 30, *(30 + 5 * (i % 2) for i in range(30))], [0.0] * len(md), od=200)
    lines, depth = (
        ["time [s],bit depth [m],hole depth [m],hook load [kN],torque [kN m],rpm,flow in [l/min]"],
        590.0,
    )
    for i in range(8 * 28):
        depth -= 2.0 if i % 28 < 14 else 0.0
        lines.append(f"{5 * i},{depth},600,{700 - depth / 50 + 3 * (i % 3) if i % 28 < 14 else 200},0,0,0")
    (tmp_path / "rig.csv").write_text("\n".join(lines) + "\n")
    result = drillpetsc.follow(
        tmp_path / "case.yaml", tmp_path / "out", log=str(tmp_path / "rig.csv"), model="stiff"
    )
    told = result.summary["model_differences"]
    assert len(told) == 1 and capsys.readouterr().out.count("MODELS ") == 1
    assert "trust the stiff string" in told[0]["text"]
    assert "trust the stiff string" in (tmp_path / "out" / "live.html").read_text()
    table = read_table(tmp_path / "out" / "follow.csv")
    seen = np.isfinite(table["stiff_hook_load [N]"])
    assert (
        5 <= seen.sum() <= 8
        and (np.abs(table["stiff_hook_load [N]"] - table["soft_hook_load [N]"])[seen] > 20e3).sum() > 2
    )
