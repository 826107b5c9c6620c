"""Roadmap, limits and statics have one torque on bit and one rotation for an operation, and say where these come from."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.analysis.limits.limits import run_limits
from drillpetsc.analysis.statics import run_statics
from drillpetsc.analysis.torque_drag.roadmap import run_roadmap
from drillpetsc.case.case import Case
from drillpetsc.output import read_table
from drillpetsc.units import to_si

WOB, OD = 50e3, 0.2159


def case(roadmap=None, friction=None, rotation="120 rpm", units="field"):
    """A smooth vertical well, in which the surface torque is that on the bit."""
    return Case(
        well={
            "survey": {"md": ["0 m", "400 m"], "inclination": [0, 0], "azimuth": [0, 0]},
            "sections": [{"kind": "open_hole", "diameter": "8.5 in", "friction": 0.0}],
        },
        string=[
            {
                "kind": "drill_collar",
                "length": "399.7 m",
                "od": "6.75 in",
                "id": "2.8125 in",
                "element_length": "50 m",
            },
            {"kind": "bit", "length": "0.3 m", "od": "8.5 in"},
        ],
        top={"kind": "top_drive", "rotation": rotation},
        bottom={"kind": "bit", **({} if friction is None else {"friction": friction})},
        initial={"wob": f"{WOB} N"},
        units=units,
        **({} if roadmap is None else {"roadmap": roadmap}),
    )


@pytest.mark.parametrize(
    ("roadmap", "friction", "torque", "said"),
    [
        (None, None, to_si("5 kft-lbf", "N m"), "drilling.tob 5 kft-lbf, drilling.rop 60 ft/h assumed"),
        (None, 0.5, 2 / 3 * 0.5 * WOB * OD / 2, "from bottom.friction"),
        ({"drilling": {"tob": "3 kN m"}}, 0.5, 3000.0, None),
    ],
)
def test_one_torque_on_bit(tmp_path, roadmap, friction, torque, said):
    """The roadmap's, else that of a given bottom.friction (2/3 mu W R), else 5 kft-lbf, in all three commands."""
    c = case(roadmap, friction)
    drawn = run_roadmap(c, tmp_path / "r")
    table = read_table(tmp_path / "r" / "roadmap.csv")
    drilling = table["surface_torque [N m]"][table["operation [-]"] == "drilling"]
    assert drilling == pytest.approx(np.full(len(drilling), torque), rel=1e-9)
    limits = run_limits(c, "drilling", out=tmp_path / "l")
    assert limits.summary["surface_torque"] == pytest.approx(torque, rel=1e-3)
    assert run_statics(c, tmp_path / "s", operation="drilling").summary["bit_torque"] == pytest.approx(
        torque, rel=1e-3
    )
    for result in (drawn, limits):
        assert (
            any(said in note for note in result.summary["notes"])
            if said
            else not any("drilling.tob" in note for note in result.summary["notes"])
        )


def test_rotation_and_words(tmp_path):
    """roadmap.rpm, else top.rotation, else 100 rpm; the heading of limits has the speeds in the units of the case."""
    heads = [
        (case(), "drilling, 60 ft/h and 120 rpm"),
        (case(units="metric"), "drilling, 18.29 m/h and 120 rpm"),
        (case({"rpm": "90 rpm", "drilling": {"rop": "30 ft/h"}}), "drilling, 30 ft/h and 90 rpm"),
        (case(rotation="0 rpm"), "drilling, 60 ft/h and 100 rpm"),
    ]
    for i, (c, words) in enumerate(heads):
        lines = run_limits(c, "drilling", out=tmp_path / str(i)).lines
        assert lines[0].endswith(words)
        assert any("note: " in line and "rpm" in line for line in lines) == ("90" not in words)


def test_default_friction_of_the_bit_is_said(tmp_path):
    """As the case, limits has the torque of bottom.friction, whose default is named beside that of the roadmap."""
    result = run_limits(case(), out=tmp_path / "a")
    assert result.summary["bit_torque"] == pytest.approx(2 / 3 * 0.3 * WOB * OD / 2, rel=1e-3)
    (note,) = [n for n in result.summary["notes"] if "bottom.friction 0.3, the default" in n]
    assert "5000 ft-lbf" in note
    assert any(line.strip().startswith("Torque on bit") for line in result.lines)
