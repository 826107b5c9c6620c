"""A small drilling case on 1, 2 and 3 ranks."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import yaml

from drillpetsc.output import read_table
from tests.helpers.ranks import runs_on_ranks, same_histories

SCRIPT = Path(__file__).parent / "run_case.py"
EXACT = ["-ts_adapt_type", "none", "-ts_dt", "2e-3", "-q_snes_stol", "1e-12"]
FORMATIONS = {
    "rop": {"drillability": 2e-6, "node_spacing": 0.005},
    "drag_bit": {
        "bit_law": {"kind": "drag_bit", "specific_energy": 3e6, "contact_stress": 3e6},
        "node_spacing": 0.005,
    },
    "roller_cone": {
        "drillability": 2e-6,
        "bit_law": {"kind": "roller_cone", "lobes": 2, "amplitude": 1e-4, "phase": 0.7},
        "node_spacing": 0.005,
    },
    "post_step": {"drillability": 2e-6, "growth": "post_step", "node_spacing": 0.005},
    "cutting side": {"drillability": 2e-6, "strength": 5e6, "node_spacing": 0.005},
}


@pytest.mark.parallel
@pytest.mark.parametrize("law", list(FORMATIONS))
def test_new_hole_is_the_same_on_1_2_and_3_ranks(law, tmp_path):
    """0.12 s of rotation and cutting in an inclined hole with walls: histories and the path of the hole are
    equal to rounding, and all ranks fix the same nodes of the hole."""
    well = {
        "survey": {"md": [0, 40.2], "inclination": [0.5, 0.5], "azimuth": [1, 1]},
        "sections": [{"to": 40.2, "kind": "open_hole", "diameter": 0.216, "friction": 0.25}],
    }
    pipe = {"kind": "pipe", "length": 40.0, "od": 0.127, "id": 0.1086, "element_length": 10}
    beds = {"dip": 0.4, "dip_azimuth": 2.5, "index_dip": 0.9, "index_strike": 0.95}
    case = {
        "string": [pipe, {"kind": "bit", "length": 0.2, "od": 0.216, "mass": 60}],
        "well": well,
        "bottom": "bit",
        "contact": {"stiffness": 1e7},
        "formation": {**FORMATIONS[law], "rock_anisotropy": beds},
        "top": {"kind": "top_drive", "rotation": 12.0, "lowering": 0.3},
        "initial": {"from": "straight"},
        "time": {"end": 0.12},
        "output": {"history_every": 0.02, "field_every": 0.12, "item_forces": True},
    }
    path = tmp_path / "case.yaml"
    path.write_text(yaml.safe_dump(case))
    folders, runs = runs_on_ranks(path, tmp_path, EXACT), []
    same_histories(folders, share=5e-8)
    for out in folders:
        runs.append((read_table(out / "trajectory.csv"), json.loads((out / "summary.json").read_text())))
    path_of_hole, summary = runs[0]
    assert path_of_hole["md [m]"][-1] > 40.202
    for its_path, its_summary in runs[1:]:
        for column, values in path_of_hole.items():
            assert its_path[column] == pytest.approx(values, rel=1e-9, abs=1e-9), column
        assert its_summary["steps"] == summary["steps"]
