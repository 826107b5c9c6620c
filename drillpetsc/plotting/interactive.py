"""Pictures as figures of plotly: the lines and bars of a figure of matplotlib, with its axes, to zoom in a notebook."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.container import BarContainer
from matplotlib.lines import Line2D

from drillpetsc.errors import CaseError

INSTALL = "pip install 'drillpetsc[notebook]'"
PIXELS = 96  # of an inch
_MARKERS = {
    "s": "square",
    "D": "diamond",
    "^": "triangle-up",
    "v": "triangle-down",
    ">": "triangle-right",
    "x": "x",
}
_NOTHING = ("None", "none", "", " ", None)


def plotly_figure(drawing: Any) -> Any:
    """The figure of plotly with the curves, bars and axes of a figure of matplotlib.

    Raises CaseError if plotly is missing, and for a picture that has surfaces or images.
    """
    try:
        import plotly.graph_objects as go
    except ImportError:
        want = "matplotlib, unless the package plotly is installed"
        raise CaseError(at="backend", got="plotly", want=want, hint=INSTALL) from None
    size = drawing.get_size_inches()
    figure = go.Figure(layout={"width": size[0] * PIXELS, "height": size[1] * PIXELS})
    title = getattr(drawing, "_suptitle", None)
    if title is not None:
        figure.update_layout(title={"text": title.get_text()})
    named: set[str] = set()
    shown = [axes for axes in drawing.axes if axes.get_visible() and axes.axison]
    for number, axes in enumerate(shown, start=1):
        _refuse_others(axes)
        end = "" if number == 1 else str(number)
        _place(figure, axes, end)
        at = {"xaxis": f"x{end}", "yaxis": f"y{end}"}
        lines = (_line(line, axes, named) for line in axes.lines)
        figure.add_traces([go.Scatter(**trace, **at) for trace in lines if trace is not None])
        bars = (_bars(q, named) for q in axes.containers if isinstance(q, BarContainer))
        figure.add_traces([go.Bar(**trace, **at) for trace in bars])
    right = max((axes.get_position().x1 for axes in shown), default=1.0)
    figure.update_layout(
        barmode="overlay",
        margin={"l": 0, "r": 0, "t": 50, "b": 0},  # the axes of the picture leave space for their texts
        legend={"x": right + 0.02, "xanchor": "left"},
    )
    for text, handle in _entries([*drawing.legends, *(axes.get_legend() for axes in shown)]):
        if text not in named:  # of a style, not of a curve
            named.add(text)
            figure.add_trace(go.Scatter(x=[None], y=[None], name=text, **_style(handle)))
    return figure


def _place(figure: Any, axes: Axes, end: str) -> None:
    """Give axes of number ``end`` their place, title, scale and range."""
    box = axes.get_position()
    for letter, other, axis, ends, domain in (
        ("x", "y", axes.xaxis, axes.get_xlim(), (box.x0, box.x1)),
        ("y", "x", axes.yaxis, axes.get_ylim(), (box.y0, box.y1)),
    ):
        log = axis.get_scale() == "log"
        figure.layout[f"{letter}axis{end}"] = {
            "showline": True,
            "ticks": "outside",
            "domain": [max(domain[0], 0.0), min(domain[1], 1.0)],
            "anchor": f"{other}{end}",
            "title": {"text": axis.get_label_text()},
            "type": "log" if log else "linear",
            "range": [float(np.log10(v) if log else v) for v in ends],
        }
    if axes.get_title():
        where = {
            "x": 0.5 * (box.x0 + box.x1),
            "y": min(box.y1, 1.0),
            "xanchor": "center",
            "yanchor": "bottom",
        }
        figure.add_annotation(text=axes.get_title(), xref="paper", yref="paper", showarrow=False, **where)


def _entries(legends: Sequence[Any]) -> Iterator[tuple[str, Line2D]]:
    """Texts and lines of the legends, which may be None."""
    for legend in filter(None, legends):
        for handle, text in zip(legend.legend_handles, legend.get_texts(), strict=True):
            if isinstance(handle, Line2D):
                yield text.get_text(), handle


def plotly_script() -> str:
    """The script of plotly that a page without a network needs; raises CaseError if the package is missing."""
    try:
        from plotly.offline import get_plotlyjs
    except ImportError:
        want = "a report without it, unless the package plotly is installed"
        raise CaseError(at="--interactive", got="interactive", want=want, hint=INSTALL) from None
    return str(get_plotlyjs())


def _refuse_others(axes: Axes) -> None:
    """Raise CaseError for parts of a picture other than lines and bars."""
    bars = {id(p) for bar in axes.containers if isinstance(bar, BarContainer) for p in bar.patches}
    others: list[Any] = [part for part in (*axes.collections, *axes.images) if part.get_visible()]
    others += [part for part in axes.patches if part.get_visible() and id(part) not in bars]
    if others:
        want = "matplotlib, the only one that draws the surfaces of this picture"
        raise CaseError(at="backend", got="plotly", want=want)


def _legend(label: Any, named: set[str]) -> dict[str, Any]:
    """Name and group of a trace in the legend, which has each name once."""
    text = str(label)
    if text.startswith("_"):
        return {"showlegend": False}
    first = text not in named
    named.add(text)
    return {"name": text, "legendgroup": text, "showlegend": first}


def _line(line: Line2D, axes: Axes, named: set[str]) -> dict[str, Any] | None:
    """Data and style of a curve; lines across the axes get their ends; None for a line without data."""
    x, y = (np.asarray(values, dtype=float) for values in line.get_data(orig=False))
    if not len(x) or not line.get_visible():
        return None
    if line.get_transform() == axes.get_xaxis_transform(which="grid"):  # axvline: y is a share of the axis
        y = _across(y, axes.get_ylim())
    elif line.get_transform() == axes.get_yaxis_transform(which="grid"):  # axhline
        x = _across(x, axes.get_xlim())
    style = _style(line)
    return None if style["mode"] == "none" else {"x": x, "y": y, **style, **_legend(line.get_label(), named)}


def _style(line: Line2D) -> dict[str, Any]:
    """Colour, dashes and markers of a curve."""
    dash, marker, width = line.get_linestyle(), line.get_marker(), line.get_linewidth()
    modes = [word for word, value in (("lines", dash), ("markers", marker)) if value not in _NOTHING]
    gaps = getattr(line, "_unscaled_dash_pattern", (0, None))[1]
    pattern = ",".join(f"{max(v * width, 1.0):.3g}px" for v in gaps) if gaps else "solid"
    return {
        "mode": "+".join(modes) or "none",
        "line": {"color": to_hex(line.get_color()), "dash": pattern, "width": width},
        "marker": {"symbol": _MARKERS.get(str(marker), "circle"), "size": line.get_markersize()},
    }


def _across(share: np.ndarray, limits: tuple[float, float]) -> np.ndarray:
    return limits[0] + share * (limits[1] - limits[0])


def _bars(bars: BarContainer, named: set[str]) -> dict[str, Any]:
    """Data and style of the bars of one label."""
    patches: Any = bars.patches
    return {
        "x": [p.get_x() + 0.5 * p.get_width() for p in patches],
        "width": [p.get_width() for p in patches],
        "base": [p.get_y() for p in patches],
        "y": [p.get_height() for p in patches],
        "marker": {"color": [to_hex(p.get_facecolor()) for p in patches]},
        **_legend(bars.get_label(), named),
    }
