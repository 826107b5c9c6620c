"""Energy balance of mud without inertia: what its steady flow stores is fed by no power (manual: eq-mud-follows)."""

import json

import numpy as np
import pytest

import drillpetsc
from drillpetsc.case.case import Case
from tests.helpers.wells import simple_well

LENGTH, OD, ID, HOLE, DENSITY = 240.0, 0.127, 0.1, 0.2159, 1350.0


def string(dynamics, flow, lowering=0.0, end=6.0, nozzles=4e-4, **fluid):
    """A string that hangs with mud, above the bottom."""
    depth = LENGTH + 20.3
    return {
        "well": simple_well(depth, HOLE, friction=0.2),
        "string": [
            {"kind": "pipe", "length": LENGTH, "od": OD, "id": ID, "element_length": 30.0},
            {"kind": "bit", "length": 0.3, "od": 0.2, "mass": 30.0, "nozzle_area": nozzles},
        ],
        "material": {"young": 206e9, "poisson": 0.3, "density": 7850.0},
        "top": {"kind": "top_drive", "rotation": 0.0, "lowering": lowering},
        "bottom": {"kind": "free"},
        "fluid": {
            "density": DENSITY,
            "rheology": {"model": "newtonian", "viscosity": 0.015},
            "flow_rate": flow,
            "dynamics": dynamics,
            **fluid,
        },
        "initial": {"from": "statics"},
        "time": {"end": end},
        "output": {"history_every": 0.1},
    }


def energy(case, folder):
    drillpetsc.run(Case(**case), out=folder)
    summary = json.loads((folder / "summary.json").read_text())
    return summary["energy"], summary["warnings"]


@pytest.mark.parametrize("flows", [(0.02, 0.03), (0.028, 0.0)])
def test_flow_that_changes(flows, tmp_path):
    """rho L/2 (1/A_bore + 1/A_annulus) (Q1^2 - Q0^2) [derived], 1 %, with stiff mud and little pressure on walls that give; closed to 1e-5."""
    flow = {"time": [0.0, 1.0, 3.0, 6.0], "value": [flows[0], flows[0], flows[1], flows[1]]}
    got, warnings = energy(string("quasi_steady", flow, nozzles=4e-3, bulk_modulus=2e13), tmp_path / "run")
    areas = np.pi / 4 * np.array([ID**2, HOLE**2 - OD**2])
    expected = 0.5 * DENSITY * LENGTH * np.sum(1 / areas) * (flows[1] ** 2 - flows[0] ** 2)
    assert got["followed"] == pytest.approx(expected, rel=1e-2)
    assert abs(got["error_share"]) < 1e-5 and got["gained_share"] < 1e-5
    assert not any("gained" in text for text in warnings)


def test_string_that_is_lowered(tmp_path):
    """The flow of a lowered string changes with its speed, and so does the cross term of the two; the balance is closed to 1e-3."""
    lowering = {"time": [0.0, 1.0, 4.0, 5.0], "value": [0.0, 0.4, 0.4, 0.0]}
    got, _ = energy(string("quasi_steady", 0.02, lowering), tmp_path / "run")
    assert abs(got["error_share"]) < 1e-3 and got["gained_share"] < 1e-4


def test_mud_with_inertia_has_none(tmp_path):
    """With inertia and compression all energy is fed by powers."""
    got, _ = energy(string("full", 0.02, end=0.2), tmp_path / "run")
    assert "followed" not in got
