"""Restarts of drilling runs, and quasi-static drilling on several ranks."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import yaml

from drillpetsc import load_case
from drillpetsc.analysis.transient import run
from drillpetsc.output import read_table
from tests.helpers.mpi import run_mpi
from tests.parallel.test_restart import files, run_with_copies

SCRIPT = Path(__file__).parent / "run_case.py"
MUD = {
    "density": 1200,
    "rheology": {"model": "newtonian", "viscosity": 0.02},
    "bulk_modulus": 2e9,
    "flow_rate": 0.02,
    "cuttings": "returned",
}
BEDS = {"dip": 0.4, "dip_azimuth": 2.5, "index_dip": 0.95}
QUASI = {
    "time": {"end": 40, "mode": "quasi_static"},
    "output": {"history_every": 2, "field_every": 20, "checkpoint_every": 6},
    "fluid": MUD,
    "top": {"kind": "top_drive", "rotation": 12.0, "lowering": 3e-3},
}
MOTION = {
    "time": {"end": 0.12},
    "output": {"history_every": 0.01, "field_every": 0.04, "checkpoint_every": 0.015},
    "top": {"kind": "top_drive", "rotation": 12.0, "lowering": 0.1},
}
RUNS = {
    "quasi-static, mud": (
        QUASI,
        {"drillability": 5e-8, "node_spacing": 0.02, "layers": [{"from": 80.03, "drillability": 3e-8}]},
    ),
    "plain rate": (MOTION, {"drillability": 2e-6, "node_spacing": 0.002}),
    "cutting side": (MOTION, {"drillability": 2e-6, "strength": 5e6, "node_spacing": 0.002}),
    "chips": (
        MOTION,
        {
            "bit_law": {"kind": "drag_bit", "specific_energy": 3e6, "contact_stress": 3e6},
            "node_spacing": 0.002,
        },
    ),
    "weakening": (
        MOTION,
        {
            "drillability": 2e-6,
            "bit_law": {"kind": "velocity_weakening", "static": 900, "dynamic": 500, "speed": 1},
        },
    ),
    "lobes": (
        MOTION,
        {
            "drillability": 2e-6,
            "bit_law": {"kind": "roller_cone", "amplitude": 2e-4, "phase": 0.7},
            "node_spacing": 0.002,
        },
    ),
    "moved after steps": (MOTION, {"drillability": 2e-6, "growth": "post_step", "node_spacing": 0.002}),
}


def write(folder: Path, more: dict, formation: dict) -> Path:
    """A case of 80 m in a hole that builds, with 20 kN on bit."""
    well = {
        "survey": {"md": [0, 80], "inclination": [0.4, 0.55], "azimuth": [1, 1]},
        "sections": [{"to": 80, "kind": "open_hole", "diameter": 0.216, "friction": 0.25}],
    }
    string = [
        {"kind": "pipe", "length": 50, "od": 0.127, "id": 0.1086, "element_length": 10},
        {"kind": "pipe", "length": 29.7, "od": 0.1715, "id": 0.0714, "element_length": 5},
        {"kind": "bit", "length": 0.3, "od": 0.216, "mass": 60, "nozzle_area": 4e-4},
    ]
    case = {
        "well": well,
        "string": string,
        "bottom": "bit",
        "formation": {**formation, "rock_anisotropy": BEDS},
        "initial": {"from": "statics", "wob": 20e3},
        **more,
    }
    path = folder / "case.yaml"
    path.write_text(yaml.safe_dump(case))
    return path


@pytest.mark.parametrize("kind", RUNS)
def test_drilling_restarted_from_any_checkpoint_is_bit_identical(kind, tmp_path, monkeypatch):
    """State, fixed nodes of the new hole, moving end, rock profile: every file of the restarted run is that
    of the uninterrupted one."""
    path = write(tmp_path, *RUNS[kind])
    copies = run_with_copies(path, tmp_path / "run", monkeypatch)
    whole = files(tmp_path / "run")
    assert len(copies) >= 6
    assert read_table(tmp_path / "run" / "trajectory.csv")["md [m]"][-1] > 80.002
    for copy in copies[1:-1:2]:
        run(load_case(path), copy, restart=True, progress="silent")
        for name, content in files(copy).items():
            assert content == whole[name], (copy, name)


@pytest.mark.parallel
def test_quasi_static_drilling_is_the_same_on_1_2_and_3_ranks(tmp_path):
    """Twelve seconds with mud, Newton to rounding: histories equal to rounding (1e-8), steps identical."""
    more, formation = RUNS["quasi-static, mud"]
    path = write(
        tmp_path,
        {**more, "time": {"end": 12, "mode": "quasi_static"}, "petsc": {"q_snes_stol": 1e-10}},
        formation,
    )
    run(load_case(path), tmp_path / "ranks1", progress="silent")
    for n in (2, 3):
        run_mpi(n, SCRIPT, [str(path), str(tmp_path / f"ranks{n}")], timeout=200)
    runs = [
        (read_table(out / "history.csv"), json.loads((out / "summary.json").read_text()))
        for out in (tmp_path / f"ranks{n}" for n in (1, 2, 3))
    ]
    history, summary = runs[0]
    assert history["hole_depth [m]"][-1] > 80.012
    for other, its_summary in runs[1:]:
        assert its_summary["steps"] == summary["steps"]
        for column, values in history.items():
            if not column.startswith(("newton", "step")):
                assert np.abs(other[column] - values).max() <= 1e-8 * np.abs(values).max(), column
