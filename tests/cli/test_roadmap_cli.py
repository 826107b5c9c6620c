"""`roadmap` and `calibrate` as a user types them: files, units on the screen, pictures, refusals."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from drillpetsc.output import read_table
from tests.helpers.command import drillpetsc, succeeds

CASE = """
title: build and hold
units: field
rig: {block_weight: 60 klb, max_hookload: 300 klb}
well:
  survey: {md: [0, 3000, 5000, 9000], inclination: [0, 0, 50 deg, 50 deg], azimuth: [0, 0, 0, 0]}
  sections:
    - {to: 5500, kind: casing, diameter: 8.835}
    - {to: end, kind: open_hole, diameter: 8.5}
string:
  - {kind: drill_pipe, length: 8500, pipe: 5in 19.50 S-135 NC50 premium}
  - {kind: drill_collar, length: 499, od: 6 3/4 in, id: 2 13/16 in}
  - {kind: bit, length: 1, od: 8.5, mass: 200 lb}
top: clamped
fluid: {density: 10.5, rheology: {pv: 20 cP, yp: 15 lbf/100ft2}}
roadmap:
  bit_depth: {from: shoe, to: td, step: 1000}
  friction_factor: {cased: [0.2, 0.25], open_hole: 0.3}
"""
LOG = """Bit Depth [ft], Operation, HKLD [klbf], TQ [kft-lbf]
6000, POOH, 215, -999.25
6000, RIH, 165,
9000, PU, 265,
9000, SO, 175,
9000, ROB, 215, 11
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """A folder with case and log, and both commands done once."""
    path = tmp_path_factory.mktemp("roadmap")
    (path / "well.yaml").write_text(CASE)
    (path / "log.csv").write_text(LOG)
    done = succeeds("roadmap well.yaml --measured log.csv --out r", cwd=path, rendered=True)
    assert "klbf" in done.stdout and "bit at MD 9000 ft" in done.stdout and "0.25 / 0.3" in done.stdout
    done = succeeds("calibrate well.yaml --measured log.csv --out c", cwd=path, rendered=True)
    assert "95 % interval" in done.stdout and "correlation" in done.stdout
    return path


def test_pictures(folder: Path):
    for run, name in (("r", "roadmap_hook_load"), ("r", "roadmap_torque"), ("c", "calibration")):
        assert (folder / run / "plots" / f"{name}.png").stat().st_size > 20_000
    inputs = json.loads((folder / "r" / "roadmap.json").read_text())
    assert len(inputs["measured"]) == 5 and inputs["max_hookload [N]"] == pytest.approx(300e3 * 4.4482216)


def test_field_numbers_are_those_of_si(folder: Path, tmp_path: Path):
    """The case that the run left, all in SI, gives the same table to 1e-9."""
    succeeds("roadmap", str(folder / "r" / "case.yaml"), "--out", str(tmp_path / "si"), cwd=tmp_path)
    a, b = read_table(folder / "r" / "roadmap.csv"), read_table(tmp_path / "si" / "roadmap.csv")
    for title in a:
        if a[title].dtype.kind == "f":
            assert b[title] == pytest.approx(a[title], rel=1e-9, nan_ok=True), title


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (("roadmap", "well.yaml", "--measured", "no.csv"), "measured points that exists"),
        (("roadmap", "well.yaml", "--measured", "well.yaml"), "a header with bit depth"),
        (("calibrate", "well.yaml"), "a file of measured points"),
        (("calibrate", "well.yaml", "--measured", "log.csv", "--fit", "cased,mud"), "one or more of cased"),
    ],
)
def test_refused(folder: Path, words: tuple[str, ...], text: str):
    done = drillpetsc(*words, "--out", "none", cwd=folder)
    assert done.returncode == 2 and text in done.stderr and "Traceback" not in done.stderr
    assert not (folder / "none").exists()
