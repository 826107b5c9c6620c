"""A run with nozzles above the bit on 1, 2 and 3 ranks."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from tests.helpers.ranks import runs_on_ranks, same_histories

SCRIPT = Path(__file__).parent / "run_case.py"
EXACT = ["-ts_adapt_type", "none", "-ts_dt", "5e-3", "-q_snes_stol", "1e-12"]
PIPE = {"kind": "pipe", "od": 0.127, "id": 0.1086, "element_length": 20.0}
NOZZLES = {
    "kind": "stabilizer",
    "length": 1.0,
    "od": 0.2159,
    "body_od": 0.17,
    "id": 0.0714,
    "blade_length": 0.5,
}
CASE = {
    "string": [
        PIPE | {"length": 100.0},
        NOZZLES | {"nozzle_area": 2e-4},
        PIPE | {"length": 60.0},
        NOZZLES | {"nozzle_area": 1e-4},
        PIPE | {"length": 40.0},
        {"kind": "bit", "length": 0.3, "od": 0.2159, "mass": 50.0, "nozzle_area": 4e-4},
    ],
    "well": {
        "survey": {"md": [0, 210], "inclination": [0.0, 0.1], "azimuth": [0, 0]},
        "sections": [{"to": 210, "kind": "open_hole", "diameter": 0.22}],
    },
    "top": {"kind": "top_drive", "rotation": 1.0},
    "fluid": {
        "density": 1200,
        "rheology": {"model": "newtonian", "viscosity": 0.02},
        "flow_rate": {"time": [0.02, 0.06], "value": [0.03, 0.02]},
    },
    "time": {"end": 0.1},
    "output": {"history_every": 0.02},
}


@pytest.mark.parallel
def test_a_run_is_the_same_on_1_2_and_3_ranks(tmp_path):
    path = tmp_path / "case.yaml"
    path.write_text(yaml.safe_dump(CASE))
    history = same_histories(runs_on_ranks(path, tmp_path, EXACT), least=1e-9)
    flow = history["side_flow [m3/s]"]
    assert 0.005 < flow[-1] < flow[0] < 0.02
