"""The walk-through "add a doubt" of the manual: its code is executed, and statics reports the doubt (manual: sec-add-doubt)."""

from __future__ import annotations

import importlib
import re
import sys
from pathlib import Path
from typing import Any

import pytest

from drillpetsc import Case, statics
from drillpetsc.doubts import DOUBTS, state

DOCS = Path(__file__).parents[3] / "docs"
PAGE = DOCS / "development" / "add-doubt.md"
sys.path.insert(0, str(DOCS))
generate = importlib.import_module("generate")


@pytest.fixture
def tally(monkeypatch: pytest.MonkeyPatch) -> Any:
    """The doubt of the page, as if it stood in doubts/state.py."""
    found = re.search(r"```{code-block} python\n:name: add-doubt\n\n(.*?)^```", PAGE.read_text(), re.S | re.M)
    assert found is not None
    monkeypatch.setattr(state, "stretched_tally", None, raising=False)  # gone afterwards
    exec(compile(found[1], str(PAGE), "exec"), vars(state))
    added = DOUBTS[-1]
    yield added
    DOUBTS.remove(added)  # others may have been registered meanwhile


def hanging(length: float, units: str = "metric") -> Case:
    return Case(
        string=[{"kind": "pipe", "length": length, "od": 0.127, "id": 0.1086, "element_length": 20.0}],
        material={"density": 7850.0, "young": 2.06e11},
        top="clamped",
        gravity=9.81,
        output={"units": units},
    )


def test_statics_reports_the_doubt(tally: Any, tmp_path: Path) -> None:
    """rho g L^2/2E: 0.187 m (0.613 ft) of 1000 m, and 0.047 m of 500 m, which is not reported."""

    def said(name: str, case: Case) -> list[str]:
        warnings = statics(case, tmp_path / name).summary["warnings"]
        return [text for text in warnings if "tally" in text]

    assert said("m", hanging(1000.0)) == [
        "the string stretches by 0.187 m: the bit is deeper than the pipe tally says"
    ]
    assert "stretches by 0.613 ft" in said("ft", hanging(1000.0, "field"))[0]
    assert said("short", hanging(500.0)) == []


def test_the_manual_has_the_doubt(tally: Any) -> None:
    page = generate.warnings_page()
    assert "> the string stretches by *stretch*: the bit is deeper" in page
    assert "*What to do:* Add the stretch to the tally" in page


def test_without_the_page_there_is_no_such_doubt() -> None:
    assert "stretched_tally" not in [q.function.__name__ for q in DOUBTS]
