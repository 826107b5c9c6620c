"""`check` says what roadmap and hydraulics will refuse, and roadmap what it thinks of measured points."""

from __future__ import annotations

import json

import pytest

from drillpetsc.analysis.commands.check import describe
from drillpetsc.analysis.loads.torque_drag.roadmap import run_roadmap
from drillpetsc.case.case import Case
from drillpetsc.output.job import Job

FT = 0.3048


def case(window=None, **roadmap):
    """A hole of 6000 ft built to 60 deg, in field units."""
    keys = {} if window is None else {"window": window}
    return Case(
        units="field",
        well={
            "survey": {"md": [0, 2000, 4000, 6000], "inclination": [0, 0, 60, 60], "azimuth": [0] * 4},
            "sections": [
                {"to": 3000, "kind": "casing", "diameter": 8.681, "friction": 0.2},
                {"to": "end", "kind": "open_hole", "diameter": 8.5, "friction": 0.3},
            ],
        },
        string=[{"kind": "drill_pipe", "length": 6000, "pipe": "5in 19.5 S-135 NC50"}],
        top="clamped",
        rig={"block_weight": 60},
        fluid={"density": 10, "rheology": {"pv": 20, "yp": 15}},
        roadmap={
            "operations": ["trip_in", "trip_out", "rotate_off_bottom"],
            "bit_depth": [5000, 6000],
            **roadmap,
        },
        **keys,
    )


def points(*rows):
    return [dict(zip(("bit_depth", "operation", "hook_load"), row, strict=True)) for row in rows]


@pytest.mark.parametrize(
    ("c", "words"),
    [
        (
            case({"tvd": [2000, 3500], "pore": [9, 9], "frac": [13, 14]}),
            ["surge refuse the window", "2000 ft to 3500 ft"],
        ),
        (
            case({"tvd": [2000, 6000], "pore": [9, 9], "frac": [13, 14]}),
            ["are these measured depths?", "6000 ft"],
        ),
        (case(bit_depth=[5000, 7000]), ["roadmap refuses", "bit_depth[1] is 7000 ft", "at most 6000 ft"]),
        (case(measured=points((7000, "PU", 200))), ["1 of 1 measured points", "6000 ft"]),
    ],
)
def test_check_warns_of_what_commands_refuse(c, words):
    lines = [line for line in describe(c).splitlines() if "WARNING" in line]
    assert len(lines) == 1 and all(word in lines[0] for word in words)


def test_check_repeats_window_and_roadmap():
    c = case({"tvd": [2000, 5000], "pore": [9, 9.5], "frac": [13, 14]}, measured=points((5000, "PU", 200)))
    text = describe(c)
    assert "WARNING" not in text
    assert "window: pore 9 ppg to 9.5 ppg, frac 13 ppg to 14 ppg, TVD 2000 ft to 5000 ft" in text
    assert (
        "2 bit depths, 5000 ft to 6000 ft" in text and "1 measured points, hook loads with the block" in text
    )


def run(c, folder):
    result = run_roadmap(Job(c, folder, overwrite=True))
    return result.lines, json.loads((folder / "summary.json").read_text())["warnings"]


def test_measured_points_beside_the_curves(tmp_path):
    """Points made from the curves are on them; moved by the block, or far below, or below the hole, they are not."""
    _, nothing = run(case(), tmp_path / "a")
    assert nothing == []
    header = (tmp_path / "a" / "roadmap.csv").read_text().splitlines()[0].split(",")
    hook = header.index("hook_load [N]")
    block = 60e3 * 4.4482216152605
    loads = {}
    for line in (tmp_path / "a" / "roadmap.csv").read_text().splitlines()[1:]:
        cells = line.split(",")
        loads.setdefault((round(float(cells[0]) / FT), cells[1]), []).append(float(cells[hook]) + block)

    def measured(shift=0.0, depth=5000):
        return [
            {"bit_depth": depth, "operation": o, "hook_load": f"{loads[5000, o][1] + shift} N"}
            for o in ("trip_in", "trip_out", "rotate_off_bottom")
        ]

    lines, warnings = run(case(measured=measured()), tmp_path / "b")
    assert warnings == []
    told = [line for line in lines if line.startswith("  measured")]
    assert len(told) == 3 and "at MD 5000 ft: hook load" in told[0] and "computed" in told[0]
    _, warnings = run(case(measured=measured(-block)), tmp_path / "b")
    assert len(warnings) == 2
    assert "3 of 3 readings lie far off the curves" in warnings[0]
    assert "hookload_excludes_block: true" in warnings[1] and "60 klbf" in warnings[1]
    _, warnings = run(case(measured=measured(-block), hookload_excludes_block=True), tmp_path / "b")
    assert warnings == []
    _, warnings = run(case(measured=measured(-100e3)), tmp_path / "b")
    assert len(warnings) == 1 and "far off" in warnings[0]
    _, warnings = run(case(measured=measured(depth=6500)), tmp_path / "b")
    assert len(warnings) == 1 and "below the end of the hole" in warnings[0]
    _, warnings = run(case(measured=measured(depth=1000)), tmp_path / "b")
    assert len(warnings) == 1 and "have no curve" in warnings[0]
