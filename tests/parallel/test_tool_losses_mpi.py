"""A run with tools whose losses have curves and whose mud has its own sections, a flexible and a rigid one, on 1, 2 and 3 ranks."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.helpers.ranks import runs_on_ranks, same_histories

SCRIPT = Path(__file__).parent / "run_case.py"
EXACT = ["-ts_adapt_type", "none", "-ts_dt", "5e-3", "-q_snes_stol", "1e-12"]
PIPE = {"kind": "pipe", "od": 0.127, "id": 0.1086, "element_length": 20.0}
LOSS = {"curve": {"flow_rate": [0.01, 0.02, 0.04], "loss": [2e5, 9e5, 1.2e6]}, "density": 1000.0}
CASE = {
    "string": [
        PIPE | {"length": 60.0},
        PIPE
        | {"length": 81.0, "name": "tool", "pressure_loss": LOSS, "bore_volume": 0.5, "annulus_od": 0.14},
        {
            "kind": "body",
            "length": 1.0,
            "od": 0.17,
            "id": 0.07,
            "pressure_loss": LOSS,
            "bore_volume": 0.003,
            "annulus_od": 0.19,
        },
        PIPE | {"length": 60.0},
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
    path.write_text(json.dumps(CASE))
    history = same_histories(runs_on_ranks(path, tmp_path, EXACT), least=1e-9)
    pressure = history["pump_pressure [Pa]"]
    assert pressure[-1] < pressure[0] - 5e5
