"""Figures of plotly from pictures: the same curves, bars and axes."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

import pytest

from drillpetsc.errors import CaseError
from drillpetsc.plotting.interactive import plotly_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def empty(**how: Any) -> Figure:
    from matplotlib.figure import Figure  # a slow import

    return Figure(**how)


def drawing() -> Figure:
    figure = empty(figsize=(8, 4))
    depth, losses = figure.subplots(1, 2)
    depth.plot([1.0, 2.0], [10.0, 30.0], "r--", label="hook load")
    depth.plot([2.0, 3.0], [20.0, 40.0], "r--", label="hook load")
    depth.axhline(25.0, label="_shoe")
    depth.axvline(1.5)
    depth.set(xlim=(1, 3), ylim=(50, 0), xlabel="Hook load [klbf]", ylabel="Bit depth (MD) [ft]")
    losses.bar([550.0], [100.0], width=20.0, bottom=[30.0], label="Bit")
    losses.set_yscale("log")
    losses.set_ylim(1, 1000)
    figure.suptitle("Eagle")
    return figure


def test_curves_bars_and_axes_are_those_of_the_picture() -> None:
    pytest.importorskip("plotly")
    shown = plotly_figure(drawing())
    first, second, shoe, upright, bar = shown.data
    assert shoe.line.dash == "solid" and "px" in first.line.dash
    assert (list(first.x), list(first.y), first.name, first.line.dash != "solid") == (
        [1, 2], [10, 30], "hook load", True,
    )  # fmt: skip
    assert first.showlegend and not second.showlegend and first.line.color == "#ff0000"
    assert list(shoe.x) == [1, 3] and list(shoe.y) == [25, 25] and list(upright.y) == [50, 0]
    assert (list(bar.x), list(bar.y), list(bar.base), list(bar.width)) == ([550], [100], [30], [20])
    layout = shown.layout
    assert layout.yaxis.range == (50, 0) and layout.yaxis2.type == "log" and layout.yaxis2.range == (0, 3)
    assert layout.title.text == "Eagle" and layout.xaxis.title.text == "Hook load [klbf]"
    assert layout.xaxis.domain[1] < layout.xaxis2.domain[0]


def test_surfaces_are_refused() -> None:
    pytest.importorskip("plotly")
    figure = empty()
    figure.subplots().fill_between([0, 1], [0, 1])
    with pytest.raises(CaseError, match="surfaces"):
        plotly_figure(figure)


def test_a_missing_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("plotly", "plotly.graph_objects"):
        monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(CaseError) as caught:
        plotly_figure(drawing())
    assert "notebook" in caught.value.hint
