"""A roadmap as a dataset over operation, friction and bit depth."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np
import pytest

from drillpetsc.errors import CaseError
from drillpetsc.output import write_summary, write_table
from drillpetsc.results import open_run

COLUMNS = [
    ("bit_depth", "m"), ("operation", "-"), ("ff_cased", "-"), ("ff_open_hole", "-"), ("hook_load", "N"),
]  # fmt: skip
COLUMNS += [("status", "-")]
#: depth, operation, factors (no open hole), hook load, status; one row is missing, the depths are not in order
ROWS = [
    (2000.0, "trip_out", 0.2, math.nan, 21.0, "ok"),
    (1000.0, "trip_out", 0.2, math.nan, 11.0, "ok"),
    (1000.0, "trip_in", 0.2, math.nan, 1.0, "ok"),
    (2000.0, "trip_in", 0.2, math.nan, 2.0, "the string yields"),
    (1000.0, "trip_out", 0.1, math.nan, 10.0, "ok"),
    (2000.0, "trip_out", 0.1, math.nan, 20.0, "ok"),
    (1000.0, "trip_in", 0.1, math.nan, 5.0, "ok"),
]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_table(tmp_path / "roadmap.csv", COLUMNS, [list(column) for column in zip(*ROWS, strict=True)])
    write_summary(tmp_path / "summary.json", {"title": "By hand", "status": "done"})
    return tmp_path


def test_every_row_stands_at_its_place(folder: Path) -> None:
    pytest.importorskip("xarray")
    cube = open_run(folder).roadmap
    assert dict(cube.sizes) == {"operation": 2, "friction": 2, "bit_depth": 2}
    assert cube.hook_load.dims == ("operation", "friction", "bit_depth")
    assert cube.bit_depth.values.tolist() == [1000.0, 2000.0] and cube.ff_cased.values.tolist() == [0.2, 0.1]
    assert np.isnan(cube.ff_open_hole.values).all()
    for depth, operation, cased, _, load, status in ROWS:
        at = cube.sel(operation=operation, bit_depth=depth).isel(friction=[0.2, 0.1].index(cased))
        assert float(at.hook_load) == load and at.status.item() == status
    missing = cube.sel(operation="trip_in", bit_depth=2000.0).isel(friction=1)
    assert np.isnan(float(missing.hook_load)) and missing.status.item() == ""
    assert cube.hook_load.attrs["units"] == "N" and cube.bit_depth.attrs["units"] == "m"
    assert cube.hook_load.attrs["mnemonic"]


def test_arrays_by_name_without_xarray(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "xarray", None)
    cube = open_run(folder).roadmap
    assert cube.dims["hook_load"] == ("operation", "friction", "bit_depth")
    assert cube["hook_load"][cube["operation"].tolist().index("trip_out"), 1].tolist() == [10.0, 20.0]


def test_a_folder_without_a_roadmap_says_what_it_has(tmp_path: Path) -> None:
    write_summary(tmp_path / "summary.json", {"status": "done"})
    with pytest.raises(CaseError, match="roadmap.csv"):
        _ = open_run(tmp_path).roadmap
