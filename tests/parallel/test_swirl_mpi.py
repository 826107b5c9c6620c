"""Mud that swirls about a turning string, its rigid items and its bit, on 1, 2 and 3 ranks."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import yaml

from tests.helpers.collar_in_mud import CASE, EXACT
from tests.helpers.ranks import runs_on_ranks, same_histories


@pytest.mark.parallel
@pytest.mark.parametrize("more", [{}, {"swirl": 0.4, "swirl_lag": False}], ids=["lag", "at once"])
def test_a_whirl_in_mud_is_the_same_on_1_2_and_3_ranks(more, tmp_path: Path) -> None:
    path = tmp_path / "case.yaml"
    path.write_text(yaml.safe_dump(CASE | {"fluid": CASE["fluid"] | more}))
    folders = runs_on_ranks(path, tmp_path, EXACT)
    same_histories(folders, least=1e-9)
    probes = same_histories(folders, least=1e-9, table="probes.csv")
    for depth in ("6", "12.5", "20"):
        assert np.hypot(probes[f"x_{depth} [m]"], probes[f"y_{depth} [m]"]).max() > 1e-5
    error = [json.loads((f / "summary.json").read_text())["energy"]["error_share"] for f in folders]
    assert error == pytest.approx([error[0]] * 3, rel=1e-3)
