"""The path of a buckled string with friction, on 1, 2 and 3 ranks (manual: sec-statics-path)."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from drillpetsc.output import read_table
from tests.helpers.mpi import run_mpi

SCRIPT = Path(__file__).with_name("run_command.py")
CASE = """
title: pipe in a level hole
well:
  survey: {md: [0 m, 80 m], inclination: [90 deg, 90 deg], azimuth: [20 deg, 20 deg]}
  sections: [{to: 80 m, kind: open_hole, diameter: 215.9 mm, friction: 0.25}]
string: [{kind: pipe, length: 80 m, od: 127 mm, id: 108.6 mm, element_length: 4 m}]
top: {kind: top_drive, force: -350 kN}
bottom: {kind: bit, friction: 0}
"""


@pytest.mark.parallel
@pytest.mark.parametrize(
    ("path", "motion"), [("sliding", "lower"), ("slack_off", "lower"), ("sliding", "rotate")]
)
def test_a_path_is_the_same_on_1_2_and_3_ranks(path: str, motion: str, tmp_path: Path) -> None:
    """The same steps; forces to 1e-7 of the push, places to 1e-7 m: Newton's tolerance."""
    case = tmp_path / "case.yaml"
    case.write_text(CASE.replace("80 m", "40 m") if motion == "rotate" else CASE)
    runs = []
    for n in (1, 2, 3):
        out = tmp_path / f"ranks{n}"
        run_mpi(n, SCRIPT, ["statics", str(case), "--path", path, "--motion", motion, "--out", str(out)])
        runs.append((json.loads((out / "summary.json").read_text()), read_table(out / "statics.csv")))
    one, table = runs[0]
    assert one["buckling"]["helical"] or one["buckling"]["sinusoidal"]
    for summary, other in runs[1:]:
        for a, b in zip(one["path_states"], summary["path_states"], strict=True):
            assert (a["start"], a["steps"], a["negative_pivots"]) == (
                b["start"],
                b["steps"],
                b["negative_pivots"],
            )
            assert b["wob"] == pytest.approx(a["wob"], abs=1e-7 * 350e3)
            assert b["surface_torque"] == pytest.approx(a["surface_torque"], rel=1e-6)
        for name in ("offset_x [m]", "offset_y [m]"):
            assert np.abs(other[name] - table[name]).max() < 1e-7


HOISTED = """
title: coiled pipe with weight on its bit
well:
  survey: {md: [0 m, 400 m], inclination: [0 deg, 0 deg], azimuth: [20 deg, 20 deg]}
  sections: [{to: 400 m, kind: open_hole, diameter: 215.9 mm, friction: 0.3}]
string:
  - {kind: pipe, length: 399.7 m, od: 127 mm, id: 108.6 mm, element_length: 5 m}
  - {kind: bit, length: 0.3 m, od: 215.9 mm, mass: 60 kg}
top: {kind: top_drive}
bottom: {kind: bit}
formation: {drillability: 4.0e-8}
initial: {from: statics, wob: 150 kN}
"""


@pytest.mark.parallel
@pytest.mark.parametrize("motion", ["hoist", "lower"])
def test_a_string_that_creeps_is_the_same_on_1_2_and_3_ranks(motion: str, tmp_path: Path) -> None:
    """The same slide of the coiled string; hook load and torque to Newton's tolerance."""
    case = tmp_path / "case.yaml"
    case.write_text(HOISTED)
    runs = []
    for n in (1, 2, 3):
        out = tmp_path / f"ranks{n}"
        run_mpi(n, SCRIPT, ["statics", str(case), "--motion", motion, "--out", str(out)])
        runs.append(json.loads((out / "summary.json").read_text()))
    one = runs[0]
    assert one["path_states"][0]["start"] == "buckled"
    for other in runs[1:]:
        assert other["path_states"][0]["steps"] == one["path_states"][0]["steps"]
        assert other["hook_load"] == pytest.approx(one["hook_load"], abs=1e-6 * 150e3)


HELD = """
title: stuck string that is pulled
well:
  survey: {md: [0 m, 300 m], inclination: [0 deg, 30 deg], azimuth: [0 deg, 0 deg]}
  sections: [{to: 300 m, kind: open_hole, diameter: 215.9 mm, friction: 0.2}]
string:
  - {kind: pipe, length: 200 m, od: 127 mm, id: 108.6 mm, element_length: 10 m}
  - {kind: pipe, length: 100 m, od: 171.4 mm, id: 71.4 mm, element_length: 10 m}
top: {kind: top_drive, lowering: -0.3 m/s}
bottom: clamped
fluid: {density: 1200 kg/m3, flow_rate: 20 l/s, rheology: {model: bingham, plastic_viscosity: 20 mPa s, yield_stress: 4 Pa}}
initial: {from: statics}
time: {end: 0.05 s}
output: {history_every: 10 ms}
"""


@pytest.mark.parallel
def test_a_held_string_starts_alike_on_1_2_and_3_ranks(tmp_path: Path) -> None:
    """Rates of even stretch, divided among ranks: the same history (manual: eq-statics-share-of-top)."""
    case = tmp_path / "case.yaml"
    case.write_text(HELD)
    runs = []
    for n in (1, 2, 3):
        out = tmp_path / f"ranks{n}"
        run_mpi(n, SCRIPT, ["run", str(case), "--out", str(out)])
        runs.append(read_table(out / "history.csv"))
    name = next(n for n in runs[0] if n.startswith("hook_load"))
    for other in runs[1:]:
        assert np.abs(other[name] - runs[0][name]).max() < 1e-6 * np.abs(runs[0][name]).max()
