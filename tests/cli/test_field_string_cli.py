"""Commands with a string of the trade: `catalogue`, `check` with sources, `case.resolved.yaml`."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import drillpetsc
from drillpetsc import cli, statics
from drillpetsc.analysis.commands.check import describe
from drillpetsc.case import load_case

CASE = """
title: tally
rig: {datum: RKB, block_weight: 60 klb}
string:
  - {kind: drill_pipe, length: 900 ft, pipe: 5in 19.50 S-135 NC50}
  - {kind: drill_collar, length: 180 ft, od: 6.75 in, id: 2.8125 in, spiral: true}
  - {kind: bit, length: 1 ft, od: 8.5 in, nozzles: 3 x 12/32 in}
well:
  survey: {md: [0, 1200 ft], inclination: [0, 20 deg], azimuth: [0, 0]}
  sections: [{to: end, kind: open_hole, diameter: 8.5 in}]
top: {kind: top_drive, rotation: 0}
fluid: {density: 10 ppg, rheology: {model: bingham, yield_stress: 5, plastic_viscosity: 20 cP}}
"""


def test_catalogue_prints_rows(capsys: pytest.CaptureFixture) -> None:
    assert cli.main(["catalogue", "5in", "19.50", "NC50"]) == 0
    text = capsys.readouterr().out
    assert "6 5/8 in" in text and "168.3 mm" in text
    assert "22.60 lb/ft" in text and "33.63 kg/m" in text
    assert "unverified" in text
    assert cli.main(["catalogue", "5.2in"]) == 2
    assert "sizes of drill pipe: 2 3/8" in capsys.readouterr().err
    assert cli.main(["catalogue", "--files", "nowhere"]) == 2


def test_check_lists_figures_with_sources(tmp_path: Path) -> None:
    (tmp_path / "case.yaml").write_text(CASE)
    case = load_case(tmp_path / "case.yaml")
    text = describe(case)
    for words in (
        'string[0] drill pipe "5in 19.50 S-135 NC50":',
        "od 0.127 m (5 in): catalogue drill_pipe.csv line 19",
        "adjusted_weight 33.6325 kg/m (22.6 lb/ft): catalogue tool_joint.csv line 23 (unverified)",
        "class premium: default: no class given",
        "tool_joint.make_up_torque 51580.1 N m (38044 ft-lbf): catalogue connection.csv line 12, 60% of the torque",
        "joint_length 9.4488 m (31 ft): default, 31.0 ft",
        "EA +3.9 %, EI and GJ +4.0 % over the tube",
        "areas: bore 9016.46 mm2, outside 13300.9 mm2",
        "touches the hole with 168.27 mm (6 5/8 in): diameter of the tool joint",
        "(560,764 lbf) or 78.792 kN m (58,114 ft-lbf)",
        "friction of the mud: tube and tool joints in series (bore: +33 % over the tube in turbulent flow)",
        "times 0.96 for the spiral",
        "nozzle_area 0.000213767 m^2 (0.33134 in2): sum of pi d^2/4 of 3 nozzles",
        "rig: depths from RKB; block 266893 N",
    ):
        assert words in text
    listed = sum(len(figures) for figures in case.figures.of_item.values())
    assert len(re.findall(r"^      \S.*: (catalogue|default|section|sum|pipe)", text, re.MULTILINE)) == listed


def test_a_run_folder_has_the_sources(tmp_path: Path) -> None:
    (tmp_path / "case.yaml").write_text(CASE)
    case = load_case(tmp_path / "case.yaml")
    folder = statics(case, tmp_path / "run").folder
    text = (folder / "case.resolved.yaml").read_text()
    assert "adjusted_weight: 33.632505124671916 # from: catalogue tool_joint.csv line 23 (unverified)" in text
    assert load_case(folder / "case.resolved.yaml") == case == load_case(folder / "case.yaml")


def test_plain_pipe_lists_nothing() -> None:
    case = load_case(Path(__file__).parents[2] / "cases" / "vertical-2000m-dry.yaml")
    assert "figures of the string" not in describe(case)


def test_check_says_its_verdict_first_and_briefly(capsys) -> None:
    """The string sheet of Volve F-5 in at most 25 lines (contract A1); --verbose gives sources and element lengths."""
    case = str(Path(__file__).parents[2] / "cases" / "measured" / "volve-f5" / "case.yaml")
    assert cli.main(["check", case]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].endswith(": valid") and len(lines) <= 25
    assert any("length 2265.49 m" in line for line in lines)  # of the pipe that fills the string
    assert cli.main(["check", case, "--verbose"]) == 0
    text = capsys.readouterr().out
    assert "automatic element lengths" in text and "bit_depth, 2400 m, less the other items, 134.51 m" in text


def test_check_counts_its_warnings_in_the_verdict(capsys, tmp_path: Path) -> None:
    sheet = tmp_path / "swapped.yaml"
    item = "{kind: pipe, length: 90 m, od: 127 mm, id: 108.6 mm, weight: 73 kg/m}"
    sheet.write_text(f"units: metric\nstring:\n  - {item}\ntop: clamped\n")
    assert cli.main(["check", str(sheet)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "case: valid, 1 warning" and lines[1].startswith(
        "  WARNING: string[0] pipe weighs 2.7 times"
    )


@pytest.mark.parametrize("command", ["hydraulics", "surge", "roadmap", "calibrate", "limits"])
def test_every_command_writes_the_sources(command: str, tmp_path: Path) -> None:
    """As the manual promises of case.resolved.yaml (*Files of a run folder*)."""
    (tmp_path / "case.yaml").write_text(CASE)
    fluid = {"density": "10 ppg", "flow_rate": "300 gpm", "rheology": {"pv": "15 cP", "yp": "12 lbf/100ft2"}}
    points = [
        {"bit_depth": "1000 ft", "operation": word, "hook_load": load}
        for word, load in (("trip_out", "110 klbf"), ("trip_in", "100 klbf"))
    ]
    case = load_case(tmp_path / "case.yaml").replace(
        {"fluid": fluid, "roadmap": {"bit_depth": ["1000 ft"], "measured": points}}
    )
    options = {"surge": {"speeds": "30 ft/min"}}.get(command, {})
    folder = getattr(drillpetsc, command)(case, tmp_path / "run", **options).folder
    assert "# from: catalogue tool_joint.csv line 23" in (folder / "case.resolved.yaml").read_text()
    assert load_case(folder / "case.resolved.yaml") == load_case(folder / "case.yaml")
