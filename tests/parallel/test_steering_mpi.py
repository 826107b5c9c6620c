"""A steerable tool that drills, on 1, 2 and 3 ranks and restarted."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import yaml

from drillpetsc import load_case
from drillpetsc.analysis.transient import run
from tests.helpers.ranks import runs_on_ranks, same_histories
from tests.parallel.test_restart import files, run_with_copies

SCRIPT = Path(__file__).parent / "run_case.py"
EXACT = ["-ts_adapt_type", "none", "-ts_dt", "2e-3", "-q_snes_stol", "1e-12"]
TOOLS = {
    "push": {
        "kind": "push",
        "force": 3e3,
        "pad_offset": 1.0,
        "pads": "rotating",
        "steer": {"tool_face": 1.0},
    },
    "point": {
        "kind": "point",
        "tilt": 0.003,
        "steer": {"ratio": {"ramp": 0.05, "value": 1.0}, "tool_face": -1.0},
    },
}


def write(folder: Path, rss: dict) -> Path:
    """A case of 40 m in an inclined hole, whose tool begins 0.2 m above the bottom."""
    case = {
        "string": [
            {"kind": "pipe", "length": 36.0, "od": 0.127, "id": 0.1086, "element_length": 9},
            {
                "kind": "rss",
                "length": 4.0,
                "od": 0.1715,
                "id": 0.0714,
                "element_length": 1,
                "rss": rss,
                "mass": 560,
            },
            {"kind": "bit", "length": 0.2, "od": 0.216, "mass": 60},
        ],
        "well": {
            "survey": {"md": [0, 40.2], "inclination": [0.5, 0.55], "azimuth": [1, 1]},
            "sections": [{"to": 40.2, "kind": "open_hole", "diameter": 0.216, "friction": 0.25}],
        },
        "bottom": "bit",
        "contact": {"stiffness": 1e7},
        "formation": {"drillability": 2e-6, "node_spacing": 0.005},
        "top": {"kind": "top_drive", "rotation": 12.0, "lowering": 0.3},
        "initial": {"from": "statics", "wob": 10e3},
        "time": {"end": 0.1},
        "output": {"history_every": 0.01, "field_every": 0.05, "checkpoint_every": 0.02},
    }
    path = folder / "case.yaml"
    path.write_text(yaml.safe_dump(case))
    return path


@pytest.mark.parallel
@pytest.mark.parametrize("kind", TOOLS)
def test_a_steered_run_is_the_same_on_1_2_and_3_ranks(kind, tmp_path):
    """Histories and the path of the new hole are equal to rounding."""
    folders = runs_on_ranks(write(tmp_path, TOOLS[kind]), tmp_path, EXACT)
    history = same_histories(folders)
    column = "steering_force [N]" if kind == "push" else "steering_tilt [rad]"
    assert history[column][-1] == pytest.approx(3e3 if kind == "push" else 0.003)
    assert history["hole_depth [m]"][-1] > 40.201
    assert len({json.loads((out / "summary.json").read_text())["steps"] for out in folders}) == 1


@pytest.mark.parametrize("kind", TOOLS)
def test_a_steered_run_restarted_is_bit_identical(kind, tmp_path, monkeypatch):
    """The direction of the tool face is part of a checkpoint: every file is that of the uninterrupted run."""
    path = write(tmp_path, TOOLS[kind])
    copies = run_with_copies(path, tmp_path / "run", monkeypatch)
    whole = files(tmp_path / "run")
    assert len(copies) >= 3
    for copy in copies[:-1:2]:
        run(load_case(path), copy, restart=True, progress="silent")
        for name, content in files(copy).items():
            assert content == whole[name], (copy, name)
