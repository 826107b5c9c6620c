"""`hydraulics` and `surge` as a user types them: files, units on the screen, pictures, refusals."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from drillpetsc.plotting.run.plot import plot
from tests.helpers.command import drillpetsc, succeeds

CASE = """
title: small well
well:
  survey: {md: [0 m, 800 m, 1500 m], inclination: [0 deg, 0 deg, 40 deg], azimuth: [0 deg, 0 deg, 0 deg]}
  sections:
    - {to: 700 m, kind: casing, diameter: 224 mm}
    - {kind: open_hole, diameter: 215.9 mm}
string:
  - {kind: pipe, name: drill pipe, length: 1300 m, od: 127 mm, id: 108.6 mm, element_length: 50 m}
  - {kind: pipe, name: collar, length: 150 m, od: 171.5 mm, id: 71.4 mm, element_length: 50 m}
  - {kind: bit, length: 0.5 m, od: 215.9 mm, mass: 60 kg, nozzle_area: 300 mm2}
top: clamped
fluid: {density: 1200 kg/m3, rheology: {model: bingham, plastic_viscosity: 20 cP, yield_stress: 6 Pa}, flow_rate: 30 l/s}
window: {tvd: [600 m, 1500 m], pore: [1100 kg/m3, 1120 kg/m3], frac: [1450 kg/m3, 1500 kg/m3]}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """A folder with small.yaml and both commands done once."""
    path = tmp_path_factory.mktemp("hydraulics")
    (path / "small.yaml").write_text(CASE)
    done = succeeds("hydraulics small.yaml --flow '400,500 gpm' --units field --out h", cwd=path)
    assert "psi" in done.stdout and "ppg" in done.stdout and "HSI" not in done.stderr
    assert "MD 4758.86 ft" in done.stdout and "Open hole, limit passed: none; none" in done.stdout
    done = succeeds(
        "surge small.yaml --speeds '30,60 ft/min' --pipe closed,open,pumping --out s",
        cwd=path,
    )
    assert "largest trip speed" in done.stdout and "m/min" in done.stdout
    return path


@pytest.mark.parametrize("command", [("hydraulics",), ("surge", "--speeds", "60 ft/min")])
def test_a_mud_in_another_unit_is_doubted(command, tmp_path: Path):
    """12 is read as 12 kg/m3; the command says so, as `check` does."""
    (tmp_path / "small.yaml").write_text(
        CASE.replace("density: 1200 kg/m3", "density: 12").partition("window")[0]
    )
    done = drillpetsc(command[0], "small.yaml", *command[1:], "--out", "o", cwd=tmp_path)
    assert "WARNING: fluid.density is 12 kg/m3: lighter than any mud; 12 ppg?" in done.stderr


def test_a_limit_that_several_flow_rates_pass_is_said_once(tmp_path: Path):
    """At the first flow rate, with the others; the summary has it at each."""
    (tmp_path / "small.yaml").write_text(CASE + "rig: {max_spp: 10 bar}\n")
    done = drillpetsc("hydraulics small.yaml --flow", "20,30,40 l/s", "--out", "o", cwd=tmp_path)
    (line,) = (line for line in done.stdout.splitlines() if "rig.max_spp" in line)
    assert "at 1200 l/min:" in line and line.endswith("; also at 1800, 2400 l/min")
    flows = json.loads((tmp_path / "o" / "summary.json").read_text())["flows"]
    assert all(any("rig.max_spp" in w for w in flow["warnings"]) for flow in flows)


def test_pictures_and_a_second_plot(folder: Path):
    for run, names in (
        ("h", {"flow_curve", "losses", "pressure_profile"}),
        ("s", {"surge", "max_trip_speed"}),
    ):
        drawn = {file.stem for file in (folder / run / "plots").glob("*.png")}
        assert drawn == names
        again = plot(folder / run, folder / f"again-{run}")
        assert {file.stem for file in again} == names and all(file.stat().st_size > 10_000 for file in again)


def test_a_string_without_hole_and_nozzles(folder: Path):
    text = "string: [{kind: pipe, length: 100 m, od: 127 mm, id: 108.6 mm}]\ntop: clamped\n"
    text += "fluid: {density: 1000 kg/m3, rheology: {model: newtonian, viscosity: 1 cP}, flow_rate: 0.02}\n"
    (folder / "bare.yaml").write_text(text)
    done = succeeds("hydraulics bare.yaml --out bare", cwd=folder)
    assert "no annulus" in done.stdout and "no nozzles" in done.stdout and "ECD" not in done.stdout
    assert {f.stem for f in (folder / "bare" / "plots").glob("*.png")} == {
        "flow_curve",
        "losses",
        "pressure_profile",
    }


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["hydraulics", "small.yaml", "--flow", "0 gpm"], "above 0"),
        (["hydraulics", "small.yaml", "--flow=-400 gpm"], "above 0"),
        (["hydraulics", "small.yaml", "--flow", "400"], "a bare number is in"),
        (["hydraulics", "small.yaml", "--spp", "1 Pa"], "starts the flow"),
        (["surge", "small.yaml"], "--speeds"),
        (["surge", "small.yaml", "--speeds", "0 ft/min"], "above 0"),
        (["surge", "small.yaml", "--speeds", "30 ft/min", "--pipe", "shut"], "closed, open, pumping"),
        (["surge", "small.yaml", "--speeds", "30 ft/min", "--window", "14,9 ppg"], "frac above pore"),
        (["surge", "small.yaml", "--speeds", "30 ft/min", "--bit-depth", "2000 m"], "the end of the hole"),
        (["surge", "small.yaml", "--speeds", "30 ft/min", "--bit-depth", "0.2 m"], "rigid item"),
    ],
)
def test_bad_options_are_refused_before_anything_is_written(words, message, folder: Path):
    before = {p.name for p in folder.iterdir()}
    done = drillpetsc(*words, "--out", "never", cwd=folder)
    assert done.returncode == 2 and message in done.stderr, done.stderr
    assert "Traceback" not in done.stderr and {p.name for p in folder.iterdir()} == before
