"""Roadmap, limits and statics have one torque on bit and one rotation for an operation, and say where these come from."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.analysis.commands.statics import run_statics
from drillpetsc.analysis.loads.limits.limits import run_limits
from drillpetsc.analysis.loads.torque_drag.roadmap import run_roadmap
from drillpetsc.case.case import Case
from drillpetsc.output import read_table
from drillpetsc.output.job import Job
from drillpetsc.units import to_si

WOB, OD = 30e3, 0.2159  # below the weight at which the collars buckle


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
    drawn = run_roadmap(Job(c, tmp_path / "r"))
    table = read_table(tmp_path / "r" / "roadmap.csv")
    drilling = table["surface_torque [N m]"][table["operation [-]"] == "drilling"]
    assert drilling == pytest.approx(np.full(len(drilling), torque), rel=1e-9)
    limits = run_limits(Job(c, tmp_path / "l"), "drilling")
    assert limits.summary["surface_torque"] == pytest.approx(torque, rel=1e-3)
    assert run_statics(Job(c, tmp_path / "s"), operation="drilling").summary["bit_torque"] == pytest.approx(
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
        lines = run_limits(Job(c, tmp_path / str(i)), "drilling").lines
        assert lines[0].endswith(words)
        assert any("note: " in line and "rpm" in line for line in lines) == ("90" not in words)


def test_default_friction_of_the_bit_is_said(tmp_path):
    """As the case, limits has the torque of bottom.friction, whose default is named beside that of the roadmap."""
    result = run_limits(Job(case(), tmp_path / "a"))
    assert result.summary["bit_torque"] == pytest.approx(2 / 3 * 0.3 * WOB * OD / 2, rel=1e-3)
    (note,) = [n for n in result.summary["notes"] if "bottom.friction 0.3, the default" in n]
    assert "5000 ft-lbf" in note
    assert any(line.strip().startswith("Torque on bit") for line in result.lines)


FLOW = to_si("500 gpm", "m3/s")
MUD = {
    "density": "10 ppg",
    "rheology": {"model": "bingham", "plastic_viscosity": "20 cP", "yield_stress": "5 Pa"},
    "flow_rate": "500 gpm",
}


@pytest.mark.parametrize("word", ["drilling", "rotate_off_bottom", "trip_out"])
def test_one_flow_rate(tmp_path, word):
    """The pumps of the case run while drilling and rotating, and are off in trips: the same hook load from all three commands.

    A roadmap without a flow_rate had still mud: its hook load while drilling was that without jets and drag.
    """
    c = case({"bit_depth": ["400 m"]}).replace({"fluid": MUD, "string": with_nozzles()})
    drawn = run_roadmap(Job(c, tmp_path / "r"))
    table = read_table(drawn.folder / "roadmap.csv")
    hook = float(table["hook_load [N]"][table["operation [-]"] == word][0])
    limits, statics = (
        run_limits(Job(c, tmp_path / "l"), word),
        run_statics(Job(c, tmp_path / "s"), operation=word),
    )
    for result in (limits, statics):
        assert result.summary["hook_load"] == pytest.approx(hook, rel=3e-3)
    pumped = "pumps off" if word == "trip_out" else "pump at 500 gpm"
    for result in (drawn, limits, statics):
        assert any(line.startswith(f"  {word}: ") and line.endswith(pumped) for line in result.lines[:8])


def test_a_flow_rate_of_the_roadmap_is_that_of_all(tmp_path):
    """roadmap.drilling.flow_rate 0 stops the pumps of `limits`, too: its pressures are those of still mud."""
    c = case({"drilling": {"flow_rate": 0}}).replace({"fluid": MUD, "string": with_nozzles()})
    result = run_limits(Job(c, tmp_path / "l"), "drilling")
    assert any("pumps off" in line for line in result.lines[:3])
    table = read_table(result.folder / "limits.csv")
    assert table["internal_pressure [Pa]"][0] == pytest.approx(0.0, abs=1e3)
    assert "margin_of_overpull_still" not in result.summary


def test_margin_of_overpull_with_pumps_on_and_off(tmp_path):
    """Pressure p in the bore at the rig takes p pi d^2/4 from the margin, where no mud stands outside (eq-tubulars-wall-tension)."""
    c = case().replace({"fluid": MUD, "string": with_nozzles()})
    result = run_limits(Job(c, tmp_path / "l"), "drilling")
    pressure = read_table(result.folder / "limits.csv")["internal_pressure [Pa]"][0]
    less = (
        result.summary["margin_of_overpull_still"]["margin"] - result.summary["margin_of_overpull"]["margin"]
    )
    assert pressure > 1e6 and less == pytest.approx(
        pressure * np.pi / 4 * to_si("2.8125 in", "m") ** 2, rel=1e-2
    )


def with_nozzles():
    """Collars with a bit whose nozzles are open."""
    collar = {
        "kind": "drill_collar",
        "length": "399.7 m",
        "od": "6.75 in",
        "id": "2.8125 in",
        "element_length": "20 m",
    }
    return [collar, {"kind": "bit", "length": "0.3 m", "od": "8.5 in", "nozzle_area": "400 mm2"}]
