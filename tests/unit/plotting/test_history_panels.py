"""Which columns of a history share a panel, and which are named as constant."""

from __future__ import annotations

import numpy as np

from drillpetsc.plotting import style
from drillpetsc.plotting.run.plot import _changing, _histories

TIME = np.linspace(0.0, 10.0, 50)
WAVE = np.sin(TIME)


def test_constants_are_named_and_have_no_panel() -> None:
    table = {
        "hook_load [N]": 8e5 + 1e4 * WAVE,
        "flow_in [m3/s]": np.full(50, 0.03),
        "stalled [-]": np.zeros(50),
    }
    with style.in_units("metric"):
        panels, constant = _changing(table, [["hook_load [N]"], ["flow_in [m3/s]"], ["stalled [-]"]])
    assert panels == [["hook_load [N]"]]
    assert len(constant) == 2 and "1800 l/min" in constant[0] and constant[1].endswith(" 0")


def test_a_set_point_stays_beside_what_follows_it() -> None:
    table = {"a [N]": 100 + WAVE, "near [N]": np.full(50, 101.5), "far [N]": np.full(50, 104.0)}
    panels, constant = _changing(table, [list(table)])
    assert panels == [["a [N]", "near [N]"]] and len(constant) == 1 and constant[0].lower().startswith("far")


def test_curves_that_look_constant_together_get_panels_of_their_own() -> None:
    table = {"low [N]": 100 + WAVE, "high [N]": 200 + WAVE}
    assert _changing(table, [list(table)])[0] == [["low [N]"], ["high [N]"]]
    table = {"low [N]": 100 + WAVE, "high [N]": 110 + WAVE}
    assert _changing(table, [list(table)])[0] == [["low [N]", "high [N]"]]


def test_rounding_is_constant_and_nan_is_left_out() -> None:
    values = np.where(TIME < 5, np.nan, 7.0 + 1e-12 * WAVE)
    panels, constant = _changing({"load [N]": values}, [["load [N]"]])
    assert panels == [] and len(constant) == 1 and "7 N" in constant[0]


def test_no_text_of_a_panel_reaches_another_one() -> None:
    """16 panels with long names: titles, axis labels and legends of different panels lie apart."""
    names = [f"bending_moment_of_the_joint_far_below_at_{k} [N m]" for k in range(16)]
    table = {"time [s]": TIME, **{name: (k + 1) * WAVE for k, name in enumerate(names)}}
    drawing = _histories(table, [[name] for name in names], "Sixteen panels")
    drawing.canvas.draw()
    boxes = [axes.get_tightbbox().shrunk(0.999, 0.999) for axes in drawing.axes]
    assert len(boxes) == 16
    assert not [(i, j) for i in range(16) for j in range(i) if boxes[i].overlaps(boxes[j])]


def test_a_history_without_any_change_names_all() -> None:
    drawing = _histories({"time [s]": TIME, "load [N]": np.full(50, 7.0)}, [["load [N]"]], "Still")
    assert drawing is not None and not drawing.axes
    assert any("Constant:" in text.get_text() for text in drawing.texts)
