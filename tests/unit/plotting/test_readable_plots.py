"""Pictures that people can read: modes, rounding, long titles, colour bars, held strings, sweeps without hole."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drillpetsc import Case, run
from drillpetsc.analysis.linear.modal import run_modes
from drillpetsc.output.job import Job
from drillpetsc.plotting.run.hole_path import well_path
from drillpetsc.plotting.run.plot import _along_depth, _histories, _orbits, plot
from drillpetsc.plotting.run.view import view
from drillpetsc.plotting.style import is_noise, limits_of_level
from tests.helpers.wells import simple_well

PIPE = {"kind": "pipe", "length": 30.0, "od": 0.127, "id": 0.1086, "element_length": 5.0}
WELL = simple_well(40, 0.2159, kind="casing")
LONG = "A title that is much too long for a narrow picture of one orbit, as titles of cases often are"


def test_modes_are_drawn(tmp_path: Path) -> None:
    run_modes(Job(Case(string=[PIPE], top="clamped"), tmp_path / "modes"), count=3)
    assert "modes.png" in [file.name for file in plot(tmp_path / "modes")]


def test_a_held_string_is_viewed_by_its_pressure(tmp_path: Path) -> None:
    mud = {"density": 1200, "rheology": {"model": "newtonian", "viscosity": 0.02}, "flow_rate": 0.01}
    case = Case(string=[PIPE], top="clamped", well=WELL, fluid=mud, hold_string=True, time={"end": 0.01})
    run(case, tmp_path / "held", progress="silent")
    assert view(tmp_path / "held", renderer="matplotlib").is_file()


def test_a_sweep_without_new_hole_shows_its_results(tmp_path: Path) -> None:
    (tmp_path / "sweep.csv").write_text(
        "member,key,status,folder,ranks,hook_load [N],message\n1,0.1,done,m1,1,5000,\n2,0.2,done,m2,1,6000,\n"
    )
    assert [file.name for file in plot(tmp_path)] == ["results.png"]


def test_rounding_is_not_drawn_at_full_scale() -> None:
    """A torque of 1e-14 N m is a constant 0, on an axis of at least 1 N m; a real one of 1 mN m is shown as it is."""
    assert is_noise("surface_torque [N m]", np.array([1e-14, -2e-14]))
    assert not is_noise("surface_torque [N m]", np.array([1e-3, -1e-3]))
    assert not is_noise("surface_torque [N m]", np.zeros(3))
    table = {"time [s]": np.arange(3.0), "surface_torque [N m]": np.array([1e-14, 0.0, -1e-14])}
    drawing = _histories(table, [["surface_torque [N m]"]], "title")
    assert not drawing.axes and "Constant: Surface torque 0 N m" in [
        text.get_text() for text in drawing.texts
    ]
    assert limits_of_level(table["surface_torque [N m]"], True) == (-1.0, 1.0)


def test_long_titles_and_colour_bars_stay_inside() -> None:
    """Every text of the picture lies inside it; the high side is on the vertical axis."""
    table = {
        "time [s]": np.linspace(0, 1000, 5),
        "x_10 [m]": np.linspace(0, 0.01, 5),
        "y_10 [m]": np.zeros(5),
    }
    drawing = _orbits(table, None, LONG)
    drawing.canvas.draw()
    width = drawing.get_size_inches()[0] * drawing.dpi
    renderer = drawing.canvas.get_renderer()
    texts = [
        drawing._suptitle,
        *(t for axes in drawing.axes for t in axes.get_yticklabels()),
        drawing.axes[-1].title,
    ]
    for text in texts:
        box = text.get_window_extent(renderer)
        assert box.x0 >= 0 and box.x1 <= width, text.get_text()
    assert "high side" in drawing.axes[0].get_ylabel()
    path = drawing.axes[0].collections[-1].get_segments()
    assert path[-1][-1] == pytest.approx([0.0, 10.0])  # 10 mm towards the high side: up


def test_the_plan_of_a_vertical_hole_says_so() -> None:
    zeros = np.zeros(3)
    table = {"md [m]": np.arange(3.0), "north [m]": zeros, "east [m]": zeros, "tvd [m]": np.arange(3.0)}
    texts = [text.get_text() for axes in well_path(table, "title").axes for text in axes.texts]
    assert any("vertical hole" in text for text in texts)


def _along_depth_of(columns: dict[str, np.ndarray], rows: int = 50):
    """The picture along depth of columns of statics.csv (rows,)."""
    return _along_depth({"md [m]": np.linspace(0.0, 1000.0, rows), **columns}, "case")


def test_constants_along_depth_are_not_drawn_at_the_scale_of_their_rounding() -> None:
    """A torque of 4.6 kN m with a rounding of 1e-9 of it is a straight line; a column of zeros is in the middle."""
    wave = np.sin(np.arange(50.0))
    drawing = _along_depth_of({"torque [N m]": 4600 * (1 + 1e-9 * wave), "side_force [N]": 0 * wave})
    torque, zeros = drawing.axes
    low, high = torque.get_xlim()
    assert high - low > 1e-3 * high
    assert zeros.get_xlim() == (-1.0, 1.0)


def test_the_heading_of_a_tall_picture_is_above_its_panels() -> None:
    """Eighteen columns in three rows: the heading ends above the upper panels and within the picture."""
    wave = np.sin(np.arange(50.0))
    drawing = _along_depth_of({"axial_force [N]": wave, **{f"column_{k} [N]": wave for k in range(17)}})
    drawing.canvas.draw()
    renderer = drawing.canvas.get_renderer()
    heading = drawing._suptitle.get_window_extent(renderer)
    assert heading.y1 <= drawing.bbox.y1
    for axes in drawing.axes:
        assert axes.get_tightbbox(renderer).y1 <= heading.y0
        for other in drawing.axes:
            if other is not axes:
                assert not axes.xaxis.label.get_window_extent(renderer).overlaps(
                    other.xaxis.label.get_window_extent(renderer)
                )
