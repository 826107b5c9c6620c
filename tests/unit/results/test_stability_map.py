"""The stability map as a dataset over weight on bit and rotary speed, and its picture."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drillpetsc.api.runs import open_run
from drillpetsc.output import write_summary, write_table
from drillpetsc.output.files.run_folder import RunFolder
from drillpetsc.plotting import style
from drillpetsc.plotting.command.frequency import draw_stability
from drillpetsc.plotting.source import Source
from drillpetsc.results.datasets import Columns

SPEEDS, WEIGHTS = [60.0, 90.0, 120.0], [4e4, 8e4]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Growth weight/1e5 - speed/100, rows in the order of the weights, the last speed first; one point is missing."""
    points = [(s, w) for w in WEIGHTS for s in reversed(SPEEDS)][:-1]
    speed, weight = (np.array(v) for v in zip(*points, strict=True))
    columns = [
        ("rotary_speed", "rpm"),
        ("weight_on_bit", "N"),
        ("largest_growth", "1/s"),
        ("frequency", "Hz"),
        ("kind", "-"),
        ("imbalance", "N"),
    ]
    write_table(
        tmp_path / "stability_map.csv",
        columns,
        [speed, weight, weight / 1e5 - speed / 100, 0 * speed + 0.2, np.array(["torsional"] * 5), 0 * speed],
    )
    write_summary(tmp_path / "summary.json", {"title": "By hand", "case_speed": 75.0, "case_weight": 6e4})
    return tmp_path


def test_rows_are_placed_by_weight_and_speed(folder: Path) -> None:
    pytest.importorskip("xarray")
    found = open_run(folder).stability
    assert dict(found.sizes) == {"weight_on_bit": 2, "rotary_speed": 3}
    assert found.weight_on_bit.values.tolist() == WEIGHTS and found.rotary_speed.values.tolist() == SPEEDS
    growth = found.largest_growth
    assert float(growth.sel(weight_on_bit=4e4, rotary_speed=90)) == pytest.approx(0.4 - 0.9)
    assert np.isnan(growth.sel(weight_on_bit=8e4, rotary_speed=60)) and int(np.isnan(growth).sum()) == 1
    assert found.kind.sel(weight_on_bit=8e4).values.tolist() == ["", "torsional", "torsional"]
    assert growth.attrs["units"] == "1/s" and found.weight_on_bit.attrs["units"] == "N"


def test_runs_in_time_stand_on_the_same_grid(folder: Path) -> None:
    pytest.importorskip("xarray")
    columns = [("rotary_speed", "rpm"), ("weight_on_bit", "N"), ("run_behaviour", "-")]
    write_table(folder / "stability_runs.csv", columns, [[90.0], [8e4], np.array(["stick_slip"])])
    found = open_run(folder).stability.run_behaviour
    assert found.sel(weight_on_bit=8e4, rotary_speed=90).item() == "stick_slip" and (found != "").sum() == 1


def test_without_xarray_there_are_arrays_with_their_dimensions(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(__import__("sys").modules, "xarray", None)
    found = open_run(folder).stability
    assert isinstance(found, Columns) and found.dims["largest_growth"] == ("weight_on_bit", "rotary_speed")
    assert found["largest_growth"].shape == (2, 3)


def test_the_map_marks_the_case_and_has_contours(folder: Path) -> None:
    speed, weight = (v.ravel() for v in np.meshgrid(SPEEDS, WEIGHTS))
    columns = [("rotary_speed", "rpm"), ("weight_on_bit", "N"), ("largest_growth", "1/s")]
    write_table(folder / "stability_map.csv", columns, [speed, weight, weight / 1e5 - speed / 100])
    with style.look():
        axes = draw_stability(Source(RunFolder(folder))).axes[0]
    (star,) = (line for line in axes.lines if line.get_label() == "the case")
    assert star.get_xdata() == [75.0] and star.get_ydata() == [60.0]
    (lines,) = (c for c in axes.collections if hasattr(c, "levels"))
    assert 0.0 not in lines.levels and len(lines.levels) >= 3
    for level, path in zip(
        lines.levels, lines.get_paths(), strict=True
    ):  # growth is linear, so the lines are exact
        for x, y in path.vertices:
            assert y * 1e3 / 1e5 - x / 100 == pytest.approx(level, abs=1e-9)
