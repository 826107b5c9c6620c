"""An imperfection that the case gives acts in a run that starts from rest."""

from __future__ import annotations

import numpy as np

from drillpetsc import Case, run
from drillpetsc.analysis.statics.imperfection import imperfections
from drillpetsc.case import load_case
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output import read_table

PIPE = {"kind": "pipe", "length": 30, "od": 0.127, "id": 0.1086, "element_length": 5}
COLLAR = {"kind": "pipe", "length": 20, "od": 0.1715, "id": 0.0714, "element_length": 5}


def from_rest(folder, **initial):
    case = Case(
        string=[PIPE],
        top={"kind": "top_drive"},
        initial={"from": "rest", **initial},
        time={"end": 0.02},
        output={"probes": [15.0], "history_every": 0.002},
    )
    run(case, folder, progress="silent")
    return read_table(folder / "probes.csv"), case


def test_an_imperfection_acts_in_a_run_from_rest(tmp_path):
    """Loads F on nodes of the mass m move them by F t^2/2m at first: with F = 0.1 m g u, u normal, by 0.05 g u t^2.

    Without the key nothing moves across the vertical string, and a case that is written and read stays so.
    """
    still, case = from_rest(tmp_path / "still")
    moved, _ = from_rest(tmp_path / "moved", imperfection=0.1)
    across = ["x_15 [m]", "y_15 [m]"]
    assert all(np.ptp(still[name]) < 1e-9 for name in across)
    late = max(np.ptp(moved[name]) for name in across)
    assert 1e-6 < late < 0.05 * 9.81 * 4 * 0.02**2  # u below 4; bending shares a load among nodes
    file = tmp_path / "again.yaml"
    case.dump(file)
    assert not imperfections(build_model(load_case(file))).any()


def test_an_item_has_its_own_imperfection():
    case = Case(
        string=[PIPE, COLLAR | {"initial": {"imperfection": 0.01}}],
        top={"kind": "top_drive"},
        initial={"from": "straight"},
    )
    found = imperfections(build_model(case))
    assert np.array_equal(found, np.where(np.arange(11) * 5 >= 30, 0.01, 0.0))
