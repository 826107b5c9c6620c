"""Figures that a notebook shows by themselves, without pyplot and its state."""

from __future__ import annotations

from io import BytesIO, StringIO
from typing import Any

from matplotlib.figure import Figure


class Picture(Figure):
    """A figure whose last line in a cell of a notebook is its picture."""

    def _repr_png_(self) -> bytes:
        file = BytesIO()
        self.savefig(file, format="png", metadata={"Software": None})
        return file.getvalue()


def svg(drawing: Any) -> str:
    """A figure as the element `<svg>` of an HTML page, with text as text, no wider than the page."""
    import matplotlib as mpl

    file = StringIO()
    with mpl.rc_context({"svg.fonttype": "none"}):
        drawing.savefig(file, format="svg", metadata={"Date": None, "Creator": None})
    text = file.getvalue()
    return text[text.index("<svg") :].replace("<svg", '<svg style="max-width: 100%; height: auto"', 1)
