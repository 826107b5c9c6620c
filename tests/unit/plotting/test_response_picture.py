"""The picture of a forced response shows the numbers of its table in the unit of its axis."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.output import write_table
from drillpetsc.output.files.run_folder import RESPONSE_TABLE, RunFolder
from drillpetsc.plotting.command.frequency import draw_response
from drillpetsc.plotting.source import Source

COLUMNS = [
    ("rotary_speed", "rpm"), ("place", "-"), ("lateral_amplitude", "m"), ("axial_amplitude", "m"),
    ("twist_amplitude", "rad"), ("axial_force_amplitude", "N"), ("torque_amplitude", "N m"),
    ("bending_moment_amplitude", "N m"), ("validity", "-"),
]  # fmt: skip


@pytest.fixture
def panels(tmp_path):
    """Axes of the picture of a top that is held and a bit that moves by 1 to 3 mm, with 10 to 30 kN, by their labels."""
    speed = np.array([60.0, 90.0, 120.0] * 2)
    size = np.array([1.0, 2.0, 3.0] * 2)
    moves = np.repeat([0.0, 1.0], 3)
    values = [
        speed, ["top"] * 3 + ["bit"] * 3, 0 * size, 1e-3 * size * moves, 0 * size, 1e4 * size, 0 * size,
        0 * size, ["linear", "lifts", "linear"] * 2,
    ]  # fmt: skip
    write_table(tmp_path / RESPONSE_TABLE, COLUMNS, values)
    drawing = draw_response(Source(RunFolder(tmp_path)))
    return {axes.get_ylabel(): axes for axes in drawing.axes}


@pytest.mark.parametrize(
    "label, line, cross", [("Axial [mm]", [1, 2, 3], [2]), ("Axial force [kN]", [10, 20, 30], [20])]
)
def test_lines_and_crosses_are_in_the_unit_of_the_axis(panels, label, line, cross):
    lines = {"x" if q.get_marker() == "x" else q.get_label(): q for q in panels[label].lines}
    assert np.asarray(lines["bit"].get_ydata()) == pytest.approx(line)
    assert np.asarray(lines["x"].get_ydata()) == pytest.approx(cross)


def test_places_that_do_not_move_in_the_first_panel_are_named(panels):
    legends = [axes.get_legend() for axes in panels.values() if axes.get_legend() is not None]
    assert [text.get_text() for text in legends[0].get_texts()] == ["top", "bit"]
