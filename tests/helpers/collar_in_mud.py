"""A collar that hangs in mud and is turned up from rest: eccentric pipe, an unbalanced stabilizer between, a bit below, free of the wall."""

from __future__ import annotations

from tests.helpers.wells import simple_well

#: fixed steps of BDF, with Newton near rounding
EXACT = ["-ts_type", "bdf", "-ts_adapt_type", "none", "-ts_dt", "5e-3", "-q_snes_stol", "1e-12"]
PIPE = {"kind": "pipe", "od": 0.1715, "id": 0.0714, "element_length": 3.0, "eccentricity": 0.005}
CASE = {
    "string": [
        PIPE | {"length": 12.0},
        {"kind": "stabilizer", "length": 1.0, "od": 0.2, "body_od": 0.17, "id": 0.0714, "blade_length": 0.5, "unbalance": 0.5},
        PIPE | {"length": 9.0, "eccentricity_angle": 1.0},
        {"kind": "bit", "length": 0.3, "od": 0.205, "mass": 60.0, "nozzle_area": 4e-4},
    ],
    "well": simple_well(30, 0.2159),
    "top": {"kind": "top_drive", "rotation": {"ramp": 0.1, "value": 12.0}},
    "fluid": {"density": 1200, "rheology": {"model": "newtonian", "viscosity": 0.05}, "flow_rate": 0.02},
    "time": {"end": 0.2},
    "output": {"history_every": 0.02, "probes": [6.0, 12.5, 20.0]},
}  # fmt: skip
