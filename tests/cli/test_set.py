"""`--set KEY=VALUE` changes a key of the case for one call of a command."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from drillpetsc import cli, load_case
from drillpetsc.operations import OPERATIONS

CASE = """
title: hanging
string:
  - {kind: pipe, length: 100 m, od: 0.2 m, id: 0.1 m}
material: {density: 7850 kg/m3}
top: {kind: top_drive}
bottom: free
gravity: 10 m/s2
fluid: {density: 1000 kg/m3, rheology: {model: newtonian, viscosity: 1 mPa s}, bulk_modulus: 2 GPa}
"""
STEEL = 7850 * 3.141592653589793 / 4 * (0.2**2 - 0.1**2) * 100 * 10  # [N] weight of 100 m in air


@pytest.fixture
def case(tmp_path: Path) -> str:
    (tmp_path / "case.yaml").write_text(CASE)
    return str(tmp_path / "case.yaml")


def test_keys_and_blocks_are_changed(case, tmp_path, capsys):
    """The weight of half the string, in air, and the case that was computed stands in the run folder."""
    out = tmp_path / "out"
    changes = ["--set", "string[0].length=50 m", "--set", "fluid=off"]
    assert cli.main(["statics", case, "--out", str(out), *changes]) == 0
    assert json.loads((out / "summary.json").read_text())["hook_load"] == pytest.approx(STEEL / 2, rel=1e-6)
    written = load_case(out / "case.yaml")
    assert written.fluid is None
    assert written.string[0].length == 50.0
    assert load_case(case, ["fluid=off"]).fluid is None


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ("string[0].od=-1", "drillpetsc: string[0].od\n  given:   -1"),
        ("fluid", "KEY=VALUE, such as top.rotation=90 rpm"),
        ("string[3].od=1", "an entry of string, a list of 1, such as string[0]"),
        ("string.od=1", "an entry of string, a list of 1, such as string[0].od"),
        ("title[0]=1", "title is 'hanging' and no block"),
        (
            "bottom.plugged=1",
            "bottom is 'free' and no block; give it as a whole, bottom={kind: free, plugged: ..}",
        ),
        ("material[0]=1", "material is a block and no list"),
        ("material=off", "on and off only for a block of physics"),
        ("time=", "time=off leaves the key out"),
    ],
)
def test_bad_changes(change, said, case, capsys):
    """Refused like the file's keys, without a line of the file that does not have the value."""
    assert cli.main(["check", case, "--set", change]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert "line" not in error


def test_several_wells_keep_their_keys(case, capsys):
    assert cli.main(["run", case, case, "--set", "time.end=1"]) == 2
    assert "--set" in capsys.readouterr().err


def test_every_command_that_takes_a_case_takes_changes():
    """All but sweep, whose values do the same."""
    for operation in OPERATIONS:
        names = {option.name for option in operation.options()}
        takes_case = bool(names & {"case", "cases"})
        assert ("set" in names) == (takes_case and operation.command() != "sweep"), operation


def test_a_change_without_set_is_answered_with_it(case, capsys):
    assert cli.main(["statics", case, "top.rotation=90 rpm"]) == 2
    assert "--set 'top.rotation=90 rpm'" in capsys.readouterr().err
