"""The walk-through "add a command" of the manual: its code is executed, and the command answers (manual: sec-add-command)."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from drillpetsc import cli
from drillpetsc.cli import analyses, commands

PAGE = Path(__file__).parents[3] / "docs" / "development" / "add-command.md"
CASE = """
title: two pipes
string:
  - {kind: pipe, length: 90 m, od: 0.2 m, id: 0.1 m}
  - {kind: body, length: 1 m, mass: 100 kg}
material: {density: 7850 kg/m3}
top: clamped
gravity: 10 m/s2
"""


def code(name: str) -> str:
    """The code block of the page with this name."""
    found = re.search(rf"```{{code-block}} python\n:name: {name}\n\n(.*?)^```", PAGE.read_text(), re.S | re.M)
    assert found is not None, name
    return found[1]


def test_the_command_of_the_page_answers(
    tmp_path: Path, capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    """90 m of pipe and a body: 10 (7850 pi/4 (0.04 - 0.01) 90 + 100) N = 167.465 kN in air; the same without mud."""
    (tmp_path / "case.yaml").write_text(CASE)
    monkeypatch.setattr(analyses, "COMMANDS", analyses.COMMANDS)  # so that the command is gone afterwards
    exec(compile(code("add-command"), str(PAGE), "exec"), vars(analyses))
    monkeypatch.setattr(commands, "COMMANDS", analyses.COMMANDS)
    assert cli.main(["weight", str(tmp_path / "case.yaml")]) == 0
    assert "two pipes: 167.465 kN in air, 167.465 kN in mud" in capsys.readouterr().out
    assert "weight" in cli.parser().format_help()
    assert cli.main(["weight", str(tmp_path / "missing.yaml")]) == 2
