"""A string that `contact: none` lets out of its hole has no mud around it: told of statics and of a run (manual: sec-mud-force-annulus)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import drillpetsc as dp
from tests.helpers.wells import simple_well

LENGTH = 30.0
MUD = {"pv": "20 cP", "yp": "10 lbf/100ft2"}


def case(inclination: float, **keys: Any) -> dp.Case:
    """A hanging pipe in a hole of 215.9 mm."""
    values = {
        "well": simple_well(300, 0.2159, f"{inclination} deg"),
        "string": [{"kind": "pipe", "length": LENGTH, "od": 0.127, "id": 0.1086, "element_length": 3.0}],
        "top": {"kind": "top_drive"},
        "bottom": "free",
        "contact": "none",
        "fluid": {"density": 1200.0, "rheology": MUD},
    }
    return dp.Case(**values | keys)


@pytest.mark.parametrize("command", ["statics", "run"])
def test_a_string_that_falls_out_of_an_inclined_hole(command: str, tmp_path: Path) -> None:
    """Statics find the string where it hangs, 30 m sin(1 deg) from the axis at most; a run starts there."""
    found = getattr(dp, command)(case(1.0, time={"end": 0.1}), tmp_path / "out")
    texts = [text for text in found.summary["warnings"] if "leaves its hole" in text]
    assert len(texts) == 1 and "contact: {}" in texts[0]
    distance = float(texts[0].split("it lies ")[1].split(" m")[0])
    assert 0.15 < distance < LENGTH * np.sin(np.radians(1.0)) + 0.01


def test_a_state_far_outside_the_hole_is_told(tmp_path: Path) -> None:
    """A thick tool in a long string, which the mud pushes tens of metres away: the state says so, and what to do."""
    pipe = {"kind": "pipe", "od": 0.127, "id": 0.0889, "element_length": 10.0}
    tool = {"kind": "pipe", "od": 0.2, "id": 0.0889, "length": 9.0, "element_length": 3.0}
    mud = {"density": 1200.0, "rheology": MUD, "flow_rate": 0.03}
    made = case(30.0, fluid=mud, string=[pipe | {"length": 120.0}, tool, pipe | {"length": 30.0}])
    (told,) = (
        text for text in dp.statics(made, tmp_path / "out").summary["warnings"] if "leaves its hole" in text
    )
    assert "contact: {}" in told and "meaningless" in told


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
