"""Figures that a notebook shows by themselves, without pyplot and its state."""

from __future__ import annotations

from io import BytesIO, StringIO
from typing import Any

from matplotlib.figure import Figure


class Picture(Figure):
    """A figure whose last line in a cell of a notebook is its picture.

    top: height below the heading, as a fraction of the figure.
    """

    top = 1.0

    def fitted(self, right: float = 1.0, bottom: float = 0.0, h_pad: float | None = None) -> Picture:
        """Lay the panels out below the heading, up to these fractions of the figure, and return it."""
        self.tight_layout(rect=(0, bottom, right, self.top), h_pad=h_pad)
        return self

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
