"""Pictures of a well and its string from the data of a case: section and plan of the path, and the string to scale."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from drillpetsc.plotting import style
from drillpetsc.plotting.style import GROUND, LINE_COLORS, WALL
from drillpetsc.unit_systems import display_unit

STEEL = {"bit": "#222222", "stabilizer": LINE_COLORS[1], "drill_collar": "#5f6f84", "hwdp": "#8797ad"}
PIPE = "#b4c0cf"
CASING = "#3a3a3a"


@dataclass(frozen=True)
class Path:
    """Stations of a well: measured depth, north, east, true vertical depth, each (n,) [m]."""

    md: np.ndarray
    north: np.ndarray
    east: np.ndarray
    tvd: np.ndarray


@dataclass(frozen=True)
class Piece:
    """A cylinder along the hole: an item of the string, or a section of the hole.

    top, bottom: measured depths [m]; diameter, outer or of the hole [m]; bore [m]; name as pictures show it.
    """

    kind: str
    name: str
    top: float
    bottom: float
    diameter: float
    bore: float = 0.0


def section_and_plan(path: Path, shoes: Sequence[float], title: str) -> Any:
    """The vertical section in the plane through the well head and the farthest point of the well, and the plan; both true to scale.

    shoes: measured depths of casing shoes [m]
    """
    size, unit = style.depth_unit()
    north, east, down = (values / size for values in (path.north, path.east, path.tvd))
    farthest = int(np.hypot(north - north[0], east - east[0]).argmax())
    azimuth = float(np.arctan2(east[farthest] - east[0], north[farthest] - north[0]))
    along = (north - north[0]) * np.cos(azimuth) + (east - east[0]) * np.sin(azimuth)
    shown = round(float(np.degrees(azimuth))) % 360
    drawing = style.sheet(11.0, 5.6, title)
    reach = max(float(np.ptp(values)) for values in (north, east, down)) or 1.0
    views = (
        (
            f"vertical section along {shown} deg",
            along,
            down,
            "distance from the well head in this plane",
            "true vertical depth",
        ),
        ("plan", east, north, "east", "north"),
    )
    for axes, (name, x, y, across, upward) in zip(drawing.subplots(1, 2), views, strict=True):
        plan = y is north
        axes.plot(x, y, color=LINE_COLORS[0], linewidth=1.8)
        if plan:  # the plane of the section
            ends = np.array([0.0, along[farthest]])
            axes.plot(
                east[0] + ends * np.sin(azimuth),
                north[0] + ends * np.cos(azimuth),
                color="0.6",
                linewidth=0.8,
                linestyle="--",
            )
        axes.plot(x[0], y[0], "o", color="black", markersize=4)
        for shoe in shoes:
            at = [np.interp(shoe, path.md, values) for values in (x, y)]
            axes.plot(*at, marker="s" if plan else 7, color=CASING, markersize=6)
        half = 0.54 * (max(float(np.ptp(x)), float(np.ptp(y))) if plan else reach)
        half = max(half, 0.02 * reach)
        middle = 0.5 * (x.max() + x.min()), 0.5 * (y.max() + y.min())
        axes.set(xlim=(middle[0] - half, middle[0] + half), ylim=(middle[1] - half, middle[1] + half))
        if not plan:
            axes.invert_yaxis()
        axes.set(title=name, xlabel=f"{across} [{unit}]", ylabel=f"{upward} [{unit}]")
        axes.set_aspect("equal")
        axes.locator_params(nbins=5)
    return drawing.fitted(bottom=0.06)


def schematic(string: Sequence[Piece], hole: Sequence[Piece], title: str) -> Any:
    """The string in its hole: lengths to one scale, diameters to another; the whole string, and its lowest part.

    string: items from the top down; hole: sections from the top down, may be empty
    """
    system = style.system()
    size, unit = style.depth_unit()
    width, _, width_unit = display_unit("diameter", system)
    end = string[-1].bottom
    start = max(
        (piece.bottom for piece in string if piece.kind in ("drill_pipe", "pipe", "coiled_tubing", "casing")),
        default=0.0,
    )
    if start >= end:  # pipe down to the end: no assembly to enlarge
        start = string[0].top
    below = [piece for piece in string if piece.bottom > start + 1e-9]
    if len(below) > 2 and below[0].bottom - below[0].top > 0.6 * (end - start):
        start = below[0].bottom  # heavy-wall pipe would hide the assembly
    panels = [(string[0].top, end)] + ([(start, end)] if start > string[0].top + 1e-9 else [])
    drawing = style.sheet(4.2 * len(panels) + 1.0, 6.6, title)
    widest = max(piece.diameter for piece in (*string, *hole)) / width
    for axes, (upper, lower) in zip(drawing.subplots(1, len(panels), squeeze=False)[0], panels, strict=True):
        margin = 0.02 * (lower - upper)
        axes.set_xlim(-0.75 * widest, 1.9 * widest)
        axes.set_ylim((lower + margin) / size, (upper - margin) / size)
        for section in hole:
            _hole(axes, section, upper - margin, lower + margin, size, width, widest)
        labels = []
        for piece in string:
            if piece.bottom <= upper + 1e-9:
                continue
            _steel(axes, piece, max(piece.top, upper), size, width)
            labels.append((0.5 * (max(piece.top, upper) + piece.bottom) / size, piece.name))
        _labels(axes, labels, (upper - margin) / size, (lower + margin) / size, 0.78 * widest)
        axes.set(xlabel=f"radius [{width_unit}]", ylabel=f"measured depth [{unit}]")
        axes.set_xticks([-0.5 * widest, 0, 0.5 * widest])
        axes.set_xticklabels([f"{0.5 * widest:.3g}", "0", f"{0.5 * widest:.3g}"])
        axes.grid(False)
        ratio = _stretched(axes, size, width)
        axes.set_title(f"diameters drawn {ratio:,.0f} times larger than lengths", fontsize=8.5)
    return drawing.fitted()


def _stretched(axes: Any, size: float, width: float) -> float:
    """How much larger diameters are drawn than lengths."""
    box = axes.get_position()
    figure = axes.figure.get_size_inches()
    across = box.width * figure[0] / (np.ptp(axes.get_xlim()) * width)
    along = box.height * figure[1] / (np.ptp(axes.get_ylim()) * size)
    return float(across / along)


def _hole(
    axes: Any, section: Piece, upper: float, lower: float, size: float, width: float, widest: float
) -> None:
    top, bottom = max(section.top, upper), min(section.bottom, lower)
    if bottom <= top:
        return
    radius = 0.5 * section.diameter / width
    for sign in (-1, 1):
        axes.fill_betweenx(
            [top / size, bottom / size], sign * radius, sign * 0.75 * widest, color=GROUND, linewidth=0
        )
        cased = section.kind != "open_hole"
        axes.plot(
            [sign * radius] * 2,
            [top / size, bottom / size],
            color=CASING if cased else WALL,
            linewidth=2.4 if cased else 0.9,
        )


def _steel(axes: Any, piece: Piece, top: float, size: float, width: float) -> None:
    y, radius = [top / size, piece.bottom / size], 0.5 * piece.diameter / width
    color = STEEL.get(piece.kind, PIPE)
    axes.fill_betweenx(y, -radius, radius, facecolor=color, edgecolor="black", linewidth=0.5)
    bore = 0.5 * piece.bore / width
    if bore > 0:
        axes.fill_betweenx(y, -bore, bore, color="white", alpha=0.75, linewidth=0)


def _labels(axes: Any, labels: list[tuple[float, str]], upper: float, lower: float, x: float) -> None:
    """Names beside the string, moved apart if they would overlap."""
    step = 0.042 * (lower - upper)
    most = max(int((lower - upper) / step) - 1, 1)
    places = [place for place, _ in labels[-most:]]
    for i in range(1, len(places)):
        places[i] = max(places[i], places[i - 1] + step)
    limit = lower - 0.3 * step
    for i in reversed(range(len(places))):
        places[i] = min(places[i], limit)
        limit = places[i] - step
    for (place, name), text in zip(labels[-most:], places, strict=True):
        axes.annotate(
            name,
            (0.5 * x, place),
            (x, text),
            fontsize=8,
            va="center",
            parse_math=False,
            arrowprops={"arrowstyle": "-", "linewidth": 0.5, "color": "0.4"},
        )
