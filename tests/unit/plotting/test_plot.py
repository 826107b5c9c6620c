"""Plots: which files for which tables, columns in panels, the clearance circle."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from drillpetsc.output import RunFolder, Table, read_table, write_table
from drillpetsc.output.files.fields import last_sizes
from drillpetsc.plotting.run.plot import _histories, _orbits, grouped, plot, probe_names
from tests.helpers.output_samples import HOLE, PIPE, make_run


def test_a_full_run_gives_every_picture(tmp_path: Path) -> None:
    run = make_run(tmp_path / "run")
    files = plot(run.path)
    assert [file.name for file in files] == [
        "history.png", "numerics.png", "orbits.png", "probes.png", "along_depth.png", "trajectory.png",
    ]  # fmt: skip
    for file in files:
        assert file.parent == run.plots
        assert len(np.unique(np.asarray(Image.open(file).convert("L")))) > 20
    assert plot(run.path, tmp_path / "elsewhere")[0] == tmp_path / "elsewhere" / "history.png"


def test_absent_tables_give_no_picture(tmp_path: Path) -> None:
    run = RunFolder.create("a", out=tmp_path / "run")
    with pytest.raises(FileNotFoundError, match="nothing to plot"):
        plot(run.path)
    write_table(run.statics, [("md", "m"), ("axial_force", "N")], [[0.0, 10.0], [5.0, 0.0]])
    assert [file.name for file in plot(run.path)] == ["along_depth.png"]


def test_a_run_killed_at_once_or_in_a_row_can_be_plotted(tmp_path: Path) -> None:
    run = RunFolder.create("a", out=tmp_path / "run")
    run.history.write_text("time [s],hook_load [N]\n0,1\n1,2\n2,1")
    Table(run.probes, [("time", "s"), ("x_600", "m"), ("y_600", "m")]).close()
    assert [file.name for file in plot(run.path)] == ["history.png"]


def test_compared_columns_share_panels() -> None:
    titles = [
        "time [s]", "hook_load [N]", "surface_torque [N m]", "wob [N]", "bit_torque [N m]", "new_force [N]",
        "other_force [N]", "step [s]", "newton [-]", "energy_error [J]",
    ]  # fmt: skip
    operation, numerics = grouped(titles)
    assert operation == [
        ["hook_load [N]"],
        ["wob [N]"],
        ["surface_torque [N m]", "bit_torque [N m]"],
        ["new_force [N]", "other_force [N]"],
    ]
    assert numerics == [["energy_error [J]"], ["step [s]"], ["newton [-]"]]
    assert sorted(sum(operation + numerics, [])) == sorted(titles[1:])


def test_histories_show_the_columns_in_displayed_units(tmp_path: Path) -> None:
    table = read_table(make_run(tmp_path / "run").history)
    drawing = _histories(table, [["hook_load [N]"], ["bit_speed [rad/s]"]], "t")
    load, speed = drawing.axes
    assert [axes.get_title(loc="left") for axes in (load, speed)] == ["Hook load", "Bit speed"]
    assert load.get_ylabel() == "[kN]" and speed.get_ylabel() == "[rpm]"
    assert np.allclose(load.lines[0].get_ydata(), table["hook_load [N]"] / 1000)
    assert np.allclose(speed.lines[0].get_ydata(), table["bit_speed [rad/s]"] * 60 / (2 * np.pi))
    assert speed.get_xlabel() == "time [s]"


def test_a_column_without_values_gets_no_panel(tmp_path: Path) -> None:
    table = {"time [s]": np.arange(3.0), "rop [m/s]": np.full(3, np.nan), "wob [N]": np.arange(3.0)}
    (axes,) = _histories(table, [["rop [m/s]"], ["wob [N]"]], "t").axes
    assert axes.get_title(loc="left") == "Weight on bit"


def test_orbits_have_the_clearance_of_their_depth(tmp_path: Path) -> None:
    """Clearance of the sample: hole radius less pipe radius, in mm."""
    run = make_run(tmp_path / "run")
    sizes = last_sizes(run.path)
    assert sizes is not None and np.allclose(sizes[2], HOLE - PIPE)
    axes = _orbits(read_table(run.probes), sizes[::2], "t").axes[0]
    assert axes.get_title() == "600 m, clearance 40.0 mm"
    assert np.allclose(np.hypot(*axes.patches[0].get_xy().T), 1e3 * (HOLE - PIPE))
    assert axes.get_aspect() == 1.0


def test_orbits_without_a_well_have_no_circle(tmp_path: Path) -> None:
    run = make_run(tmp_path / "run", well=False)
    assert last_sizes(run.path) is None
    assert len(_orbits(read_table(run.probes), None, "t").axes[0].patches) == 0


def test_probe_names_come_from_the_headers() -> None:
    titles = [
        "time [s]", "x_600 [m]", "y_600 [m]", "spin_600 [rad/s]", "spin_1199.5 [rad/s]", "contact_600 [N]",
    ]  # fmt: skip
    assert probe_names({title: np.zeros(1) for title in titles}) == ["600", "1199.5"]
