"""`limits` and `freepoint` as a user types them: files, units on the screen, pictures, refusals."""

from __future__ import annotations

from pathlib import Path

import pytest

from drillpetsc.plotting.run.plot import plot
from tests.helpers.command import drillpetsc, succeeds

CASE = """
title: small well
well:
  survey: {md: [0 m, 300 m, 600 m, 1000 m], inclination: [0 deg, 0 deg, 40 deg, 40 deg], azimuth: [0 deg, 0 deg, 0 deg, 0 deg]}
  sections: [{kind: open_hole, diameter: 215.9 mm, friction: 0.25}]
string:
  - {kind: drill_pipe, pipe: 5in 19.50 S-135 NC50 premium, length: 900 m}
  - {kind: pipe, name: plain collar, length: 90 m, od: 171.5 mm, id: 71.4 mm}
  - {kind: bit, length: 0.5 m, od: 215.9 mm, mass: 60 kg, nozzle_area: 300 mm2}
top: {kind: top_drive, rotation: 100 rpm}
bottom: bit
initial: {wob: 30 kN}
rig: {block_weight: 200 kN, max_hookload: 250 kN}
fluid: {density: 1200 kg/m3, rheology: {model: bingham, plastic_viscosity: 20 cP, yield_stress: 6 Pa}, flow_rate: 30 l/s}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """A folder with small.yaml and the command done once."""
    path = tmp_path_factory.mktemp("limits")
    (path / "small.yaml").write_text(CASE)
    words = ("limits", "small.yaml", "--operation", "Drilling", "--units", "field", "--out", "r")
    done = succeeds(*words, cwd=path)
    (path / "screen.txt").write_text(done.stdout)
    return path


def test_the_screen_names_places_units_and_what_is_missing(folder: Path):
    screen = (folder / "screen.txt").read_text()
    assert "Hook load with the block" in screen and "klbf" in screen and "MD" in screen
    assert "no yield strength, so no strength limits: plain collar" in screen
    assert "exceeds rig.max_hookload" in screen
    assert "Law of the helical limit" in screen and "chen, 1.41 times the sinusoidal load" in screen
    assert "Weight on bit, sliding, helical" in screen and "r/plots/limits.png" in screen


def test_pictures_are_drawn_again_in_other_units(folder: Path):
    assert [file.name for file in plot(folder / "r", folder / "again", "metric")] == ["limits.png"]
    assert (folder / "again" / "limits.png").stat().st_size > 20_000


@pytest.mark.parametrize(
    "words, text",
    [
        (("--operation", "trip_inn"), "did you mean 'trip_in'?"),
        (("--operation", ""), "trip_in, trip_out"),
        (("--design-factor", "0"), "a number from 1 to 10"),
        (("--tension-fraction", "nan"), "above 0, up to 1"),
        (("--tension-fraction", "2"), "above 0, up to 1"),
    ],
)
def test_bad_options_are_answered_in_words(folder: Path, words, text):
    done = drillpetsc("limits small.yaml", *words, "--out", "bad", cwd=folder)
    assert done.returncode == 2 and text in done.stderr and "Traceback" not in done.stderr
    assert not (folder / "bad").exists()


def test_free_point(folder: Path):
    done = succeeds("freepoint small.yaml --stretch '1,2.2 in' --pull '30,60 kN'", cwd=folder)
    assert done.stdout.count("below the top (drill pipe)") == 3 and "line through them" in done.stdout
    done = drillpetsc("freepoint small.yaml --stretch 4 --pull '60 kN'", cwd=folder)
    assert done.returncode == 2 and "a number with a unit" in done.stderr
    done = drillpetsc("freepoint small.yaml --stretch '8 m' --pull '60 kN'", cwd=folder)
    assert done.returncode == 0 and "a figure is wrong" in done.stdout
