"""A bit and a reamer that drill, on 1, 2 and 3 ranks and restarted."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from drillpetsc import load_case
from drillpetsc.analysis.transient import run
from tests.helpers.ranks import runs_on_ranks, same_histories
from tests.parallel.test_restart import files, run_with_copies
from tests.verification.test_reamer import reaming
from tests.verification.test_reamer_in_mud import in_mud

SCRIPT = Path(__file__).parent / "run_case.py"
MUD = ["dry", "removed", "returned"]
EXACT = ["-ts_adapt_type", "none", "-ts_dt", "2e-3", "-q_snes_stol", "1e-12"]


def write(folder: Path, mud: str = "dry") -> Path:
    """A tenth of a second of drilling with contact, checkpoints every 20 ms; ``mud``: what becomes of the cuttings, or dry."""
    case = reaming(0.2159, 0.2667, 30e6, 0.6, 120.0, 0.05, 40e3, "dynamic", contact={"stiffness": 1e7})
    case |= {"time": {"end": 0.1}, "output": {"history_every": 0.01, "checkpoint_every": 0.02}}
    if mud != "dry":  # 10 mm of new hole, after which the mud reads it anew, within 50 ms
        case = in_mud(case, 0.02, cuttings=mud)
        case["top"]["lowering"] = 0.2
    path = folder / "case.yaml"
    path.write_text(yaml.safe_dump(case))
    return path


@pytest.mark.parallel
@pytest.mark.parametrize("mud", MUD)
def test_reaming_is_the_same_on_1_2_and_3_ranks(mud, tmp_path):
    one = same_histories(runs_on_ranks(write(tmp_path, mud), tmp_path, EXACT), least=1e-9)
    assert one["hole_depth_reamer [m]"][-1] > 53.7 + 1e-3


@pytest.mark.parametrize("mud", MUD)
def test_a_reaming_run_restarted_is_bit_identical(mud, tmp_path, monkeypatch):
    path = write(tmp_path, mud)
    copies = run_with_copies(path, tmp_path / "run", monkeypatch)
    whole = files(tmp_path / "run")
    assert len(copies) >= 3
    for copy in copies[:-1:2]:
        run(load_case(path), copy, restart=True, progress="silent")
        for name, content in files(copy).items():
            assert content == whole[name], (copy, name)
