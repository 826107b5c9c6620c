"""`drillpetsc sweep` of a case that drills: pictures at the end, and a member that cannot be computed leaves
the others complete."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drillpetsc.output import read_table
from tests.helpers.command import drillpetsc

CASE = """
title: short assembly
well:
  survey: {md: [0 m, 60 m, 120 m], inclination: [0 deg, 0 deg, 10 deg], azimuth: [20 deg, 20 deg, 20 deg]}
  sections: [{to: 60 m, kind: casing, diameter: 224.4 mm}, {kind: open_hole, diameter: 215.9 mm}]
string:
  - {kind: pipe, length: 60 m, od: 127 mm, id: 108.6 mm, element_length: 6 m}
  - {kind: pipe, length: 58 m, od: 171.5 mm, id: 71.4 mm, element_length: 4 m}
  - {kind: stabilizer, length: 1.5 m, od: 212 mm, id: 71.4 mm, mass: 200 kg}
  - {kind: bit, length: 0.5 m, od: 215.9 mm, mass: 60 kg}
top: {kind: top_drive, rotation: 120 rpm, lowering: 10 m/h}
bottom: {kind: bit}
formation: {drillability: 2.8e-8}
initial: {wob: 60 kN}
time: {mode: quasi_static, end: 180 s}
output: {history_every: 36 s}
"""
WORDS = ("initial.wob=30 kN,60 kN,1 GN", "formation.bit_anisotropy=0.1,0.3")  # no string carries 100 000 t


@pytest.fixture(scope="module")
def swept(tmp_path_factory) -> Path:
    """Six members in sweep/, of which the last two have no equilibrium to start from."""
    folder = tmp_path_factory.mktemp("drilling")
    (folder / "short.yaml").write_text(CASE)
    done = drillpetsc("sweep short.yaml", *WORDS, "--out", "sweep", cwd=folder, rendered=True)
    assert done.returncode == 1 and "Traceback" not in done.stderr, done.stderr
    assert "4 of 6 members done" in done.stdout and "member 5 failed: initial.wob" in done.stdout
    assert "pictures: trajectory.png, inclination.png, build_rate.png" in done.stdout
    return folder / "sweep"


def test_a_member_that_fails_leaves_the_others_complete(swept):
    """10 m/h for 180 s are 0.5 m, but for what the string shortens or lengthens as the weight on bit
    settles."""
    table = read_table(swept / "sweep.csv")
    assert table["status"].tolist() == ["done"] * 4 + ["failed"] * 2
    assert table["time [s]"][:4] == pytest.approx(180.0) and table["drilled [m]"][:4] == pytest.approx(
        0.5, abs=0.05
    )
    assert np.all(np.isnan(table["drilled [m]"][4:])) and all(
        "initial.wob" in message for message in table["message"][4:]
    )
    for name, length in zip(table["folder"][:4], table["drilled [m]"][:4], strict=True):
        assert read_table(swept / name / "trajectory.csv")["md [m]"][-1] == pytest.approx(
            120 + length, abs=1e-9
        )


def test_pictures_are_drawn_at_the_end(swept):
    for name in ("trajectory.png", "inclination.png", "build_rate.png"):
        assert (swept / name).stat().st_size > 10_000
