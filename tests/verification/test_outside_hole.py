"""A string that `contact: none` lets out of its hole has no mud around it: refused in statics, told of a run (manual: sec-mud-force-annulus)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import drillpetsc as dp
from drillpetsc.errors import SolveError

LENGTH = 30.0
MUD = {"pv": "20 cP", "yp": "10 lbf/100ft2"}


def case(inclination: float, **keys: Any) -> dp.Case:
    """A hanging pipe in a hole of 215.9 mm."""
    values = {
        "well": {
            "survey": {"md": [0, 60], "inclination": [f"{inclination} deg"] * 2, "azimuth": [0, 0]},
            "sections": [{"to": 60, "kind": "open_hole", "diameter": 0.2159}],
        },
        "string": [{"kind": "pipe", "length": LENGTH, "od": 0.127, "id": 0.1086, "element_length": 3.0}],
        "top": {"kind": "top_drive"},
        "bottom": "free",
        "contact": "none",
        "fluid": {"density": 1200.0, "rheology": MUD},
    }
    return dp.Case(**values | keys)


@pytest.mark.parametrize("command", ["statics", "run"])
def test_a_string_that_falls_out_of_an_inclined_hole_is_refused(command: str, tmp_path: Path) -> None:
    with pytest.raises(SolveError, match="contact: {}"):
        getattr(dp, command)(case(30.0, time={"end": 1.0}), tmp_path / "out")


def test_a_string_that_stays_inside_is_not(tmp_path: Path) -> None:
    """The end of a pipe that hangs vertically is 0.01 deg times 30 m = 5 mm from the axis."""
    found = dp.statics(case(0.01), tmp_path / "out")
    assert not any("leaves its hole" in text for text in found.summary["warnings"])


def test_mud_is_asked_about_and_contact_not(tmp_path: Path) -> None:
    """Without mud in the annulus the string may be wherever it hangs."""
    dp.statics(case(0.5, fluid={"density": 1200.0, "rheology": MUD, "annulus": False}), tmp_path / "out")


def test_a_run_says_where_the_string_left_its_hole(tmp_path: Path) -> None:
    """A force of 3 kN across the lower end, which bends the pipe, from 0.2 s on; told, with place and time."""
    loads = [{"at": LENGTH, "force": [3e3, 0, 0], "value_over": {"time": [0.2, 0.3], "value": [0.0, 1.0]}}]
    made = case(0.0, loads=loads, time={"end": 1.0}, output={"history_every": 0.1})
    texts = [
        text
        for text in dp.run(made, tmp_path / "run", progress="silent").summary["warnings"]
        if "leaves its hole" in text
    ]
    assert len(texts) == 1 and ("MD 30" in texts[0] or "MD 29" in texts[0]), texts
