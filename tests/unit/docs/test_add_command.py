"""The walk-through "add a command" of the manual: its code is executed, and the command answers (manual: sec-add-command)."""

from __future__ import annotations

import importlib
import inspect
import re
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest

from drillpetsc import cli, load_case, operations
from drillpetsc.api.functions import function_of
from drillpetsc.operations import fields, loads

DOCS = Path(__file__).parents[3] / "docs"
PAGE = DOCS / "development" / "add-command.md"
sys.path.insert(0, str(DOCS))
generate = importlib.import_module("generate")
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


@pytest.fixture
def weight(monkeypatch: pytest.MonkeyPatch) -> Any:
    """The class of the page, as if it stood in operations/loads.py and in the list of commands."""
    for name, value in (("number", fields.number), ("Iterable", Iterable), ("Weight", None)):
        monkeypatch.setattr(loads, name, value, raising=False)  # gone afterwards
    exec(compile(code("add-command"), str(PAGE), "exec"), vars(loads))
    made = vars(loads)["Weight"]
    monkeypatch.setattr(operations, "OPERATIONS", [*operations.OPERATIONS, made])
    return made


def test_the_command_of_the_page_answers(
    weight: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """90 m of pipe and a body: 10 (7850 pi/4 (0.04 - 0.01) 90 + 100) N = 167.465 kN in air; the same without mud."""
    file = tmp_path / "case.yaml"
    file.write_text(CASE)
    assert cli.main(["weight", str(file)]) == 0
    assert "167.465 kN in air, 167.465 kN in mud" in capsys.readouterr().out
    assert cli.main(["weight", str(file), "--overpull", "50 kN", "--set", "string[0].length=45 m"]) == 0
    assert "134.233 kN in air" in capsys.readouterr().out  # (167.465 - 1)/2 + 1 + 50


def test_what_follows_from_the_class(weight: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Help, refusals, the row of the manual, and the Python function."""
    (tmp_path / "case.yaml").write_text(CASE)
    text = cli.parser().format_help()
    assert "weight of the string in air and in mud" in " ".join(text.split())
    for words, message in (
        ([str(tmp_path / "missing.yaml")], "a case file that exists"),
        ([str(tmp_path / "case.yaml"), "--overpull", "-3 kN"], "--overpull"),
        ([str(tmp_path / "case.yaml"), "--overpul", "3 kN"], "a known --option"),
    ):
        assert cli.main(["weight", *words]) == 2
        assert message in capsys.readouterr().err
    row = "| `--overpull` F | pull beyond the weight, which is added (default: 0 N) |"
    assert row in generate.commands_page()
    function = function_of(weight)
    assert str(inspect.signature(function)).startswith("(case: Any, *, overpull:")
    assert "overpull: pull beyond the weight" in (function.__doc__ or "")
    assert function(load_case(tmp_path / "case.yaml"), overpull=50e3)[0] == pytest.approx(217465, abs=1)
    with pytest.raises(TypeError, match="overpul"):
        function(CASE, overpul=1)


def test_without_the_page_there_is_no_such_command() -> None:
    assert "weight" not in [operation.command() for operation in operations.OPERATIONS]
