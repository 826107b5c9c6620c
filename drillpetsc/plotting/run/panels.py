"""Panels of a view. Each function draws the static parts, and returns a function that draws one time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from drillpetsc.plotting.run.shape import Shape
from drillpetsc.plotting.style import GROUND, WALL, depth_unit, label, lateral_unit, show_in

Update = Callable[[Shape], None]


@dataclass(frozen=True)
class Paint:
    """Colours of a field.

    field: full name. unit, size: displayed unit and its size in SI. low, high: range of the field. norm, cmap:
    of matplotlib. Range and norm are in the displayed unit.
    """

    field: str
    unit: str
    size: float
    low: float
    high: float
    norm: Any
    cmap: Any

    def colors(self, values: np.ndarray) -> np.ndarray:
        """values (n,) [SI] -> (n, 3) red, green, blue in 0..1."""
        return self.cmap(self.norm(values / self.size))[:, :3]

    def label(self) -> str:
        return label(self.field, self.unit)


def middle(values: np.ndarray) -> np.ndarray:
    return 0.5 * (values[:-1] + values[1:])


def segments(x: np.ndarray, y: np.ndarray) -> Any:
    """(n - 1, 2, 2) line pieces between successive points, for a LineCollection."""
    points = np.column_stack((x, y))
    return np.stack((points[:-1], points[1:]), axis=1)


def hole_walls(axes: Any, shape: Shape, size: float) -> None:
    """Draw rock on both sides of the hole. size: [m] of one unit of the lateral axis."""
    if shape.hole_radius is None:
        axes.axvline(0.0, color=WALL, linewidth=0.6, linestyle=(0, (8, 4)))
        return
    far = 1e3 * shape.hole_radius.max() / size
    for side in (-1, 1):
        wall = side * shape.hole_radius / size
        axes.fill_betweenx(shape.md, wall, side * far, color=GROUND, linewidth=0, zorder=0)
        axes.plot(wall, shape.md, color=WALL, linewidth=0.9, zorder=1)


def offset_track(axes: Any, shape: Shape, paint: Paint, component: int, half: float) -> Update:
    """Offset of the string against measured depth: the pipe as a ribbon of its diameter between the walls of
    the hole.

    half: lateral distance shown on each side [m].
    """
    from matplotlib.collections import LineCollection, PolyCollection

    size, unit = lateral_unit(half)
    hole_walls(axes, shape, size)
    axes.set_xlim(-half / size, half / size)
    axes.set_xlabel(f"offset {'xy'[component]} [{unit}]\n({('+ high side', '+ right')[component]})")
    axes.locator_params(axis="x", nbins=4)
    body: Any
    if shape.outer_radius is None:
        body = LineCollection([], cmap=paint.cmap, norm=paint.norm, linewidths=2.0, zorder=3)
    else:
        body = PolyCollection(
            [], cmap=paint.cmap, norm=paint.norm, linewidths=0, antialiaseds=False, zorder=2
        )
    axes.add_collection(body, autolim=False)
    (center,) = axes.plot([], [], color="black", linewidth=0.6, alpha=0.65, zorder=4)

    def update(now: Shape) -> None:
        place = now.offset[:, component] / size
        if now.outer_radius is None:
            body.set_segments(segments(place, now.md))
        else:
            radius = now.outer_radius / size
            left, right = np.column_stack((place - radius, now.md)), np.column_stack((place + radius, now.md))
            body.set_verts(np.stack((left[:-1], right[:-1], right[1:], left[1:]), axis=1))
        body.set_array(middle(now.values) / paint.size)
        center.set_data(place, now.md)

    return update


def field_track(axes: Any, paint: Paint) -> Update:
    """The chosen field against measured depth."""
    from matplotlib.collections import LineCollection

    low, high = paint.low, paint.high
    margin = 0.06 * (high - low) or 1.0
    axes.set_xlim(low - margin, high + margin)
    axes.set_xlabel(paint.label())
    axes.locator_params(axis="x", nbins=4)
    if low < 0 < high:
        axes.axvline(0.0, color="0.35", linewidth=0.7)
    (thin,) = axes.plot([], [], color="0.3", linewidth=0.5)
    line = LineCollection([], cmap=paint.cmap, norm=paint.norm, linewidths=2.6)
    axes.add_collection(line, autolim=False)

    def update(now: Shape) -> None:
        shown = now.values / paint.size
        line.set_segments(segments(shown, now.md))
        line.set_array(middle(shown))
        thin.set_data(shown, now.md)

    return update


def path_panel(axes: Any, whole: Shape, paint: Paint, interval: tuple[float, float] | None) -> Update:
    """True path of the string at true scale: depth over distance from the well head towards its end."""
    from matplotlib.collections import LineCollection

    north, east = whole.points[-1, 0] - whole.points[0, 0], whole.points[-1, 1] - whole.points[0, 1]
    away, length = float(np.hypot(north, east)), float(whole.md[-1] - whole.md[0])
    direction = np.array([north, east]) / away if away > 1e-3 * length else np.array([1.0, 0.0])
    line = LineCollection([], cmap=paint.cmap, norm=paint.norm, linewidths=3.0, capstyle="round", zorder=3)
    axes.add_collection(line, autolim=False)
    top, bottom = float(whole.points[:, 2].min()), float(whole.points[:, 2].max())
    reach = (whole.points[:, :2] - whole.points[0, :2]) @ direction
    span = max(bottom - top, float(np.ptp(reach)), 1e-9)
    axes.set_ylim(bottom + 0.06 * span, top - 0.06 * span)
    wide = max(0.0, 0.5 * (0.36 * span - float(np.ptp(reach))))  # a vertical well still gets some width
    axes.set_xlim(reach.min() - 0.06 * span - wide, reach.max() + 0.06 * span + wide)
    axes.set_aspect("equal", adjustable="box")
    size, unit = depth_unit()
    axes.set_xlabel(
        f"distance [{unit}]"
        if away <= 1e-3 * length
        else f"distance towards {np.rad2deg(np.arctan2(east, north)) % 360:.0f}° [{unit}]"
    )
    axes.set_ylabel(f"vertical depth [{unit}]")
    axes.set_title("True path, true scale")
    show_in(axes.xaxis, size)
    show_in(axes.yaxis, size)
    axes.locator_params(axis="x", nbins=4)
    if interval is not None:
        inside = (whole.md >= interval[0]) & (whole.md <= interval[1])
        axes.plot(
            reach[inside],
            whole.points[inside, 2],
            color="black",
            linewidth=7,
            alpha=0.25,
            solid_capstyle="butt",
        )

    def update(now: Shape) -> None:
        along = (now.points[:, :2] - now.points[0, :2]) @ direction
        line.set_segments(segments(along, now.points[:, 2]))
        line.set_array(middle(now.values) / paint.size)

    return update


def clearance_panel(axes: Any, shape: Shape, paint: Paint) -> Update:
    """View along the hole: the string's centre as a fraction of the local clearance; on the circle it touches
    the wall."""
    from matplotlib.collections import LineCollection

    assert shape.hole_radius is not None and shape.outer_radius is not None
    clearance = shape.hole_radius - shape.outer_radius
    free = (
        clearance > 0.02 * shape.hole_radius
    )  # a fraction of a vanishing clearance, as at a bit, is meaningless
    angle = np.linspace(0, 2 * np.pi, 181)
    axes.fill(1.25 * np.array([-1, 1, 1, -1]), 1.25 * np.array([-1, -1, 1, 1]), color=GROUND, zorder=0)
    axes.fill(np.cos(angle), np.sin(angle), facecolor="white", edgecolor=WALL, linewidth=1.2, zorder=1)
    axes.plot(0, 0, "+", color=WALL, markersize=8, zorder=2)
    axes.set_aspect("equal")
    axes.set(
        xlim=(-1.25, 1.25),
        ylim=(-1.25, 1.25),
        xlabel="to the right, y / clearance",
        ylabel="to the high side, x / clearance",
        title="Down the hole (circle: pipe on the wall)",
    )
    axes.grid(False)
    line = LineCollection([], cmap=paint.cmap, norm=paint.norm, linewidths=1.2, zorder=3)
    axes.add_collection(line, autolim=False)

    def update(now: Shape) -> None:
        share = np.where(free[:, None], now.offset / np.where(free, clearance, 1.0)[:, None], np.nan)
        line.set_segments(segments(share[:, 1], share[:, 0]))  # the high side is on top
        line.set_array(middle(now.values) / paint.size)

    return update


def true_shape_panel(axes: Any, shapes: list[Shape], paint: Paint, across: int) -> Update:
    """True shape of a string without hole, seen from the side. across: 0 north, 1 east."""
    from matplotlib.collections import LineCollection

    points = np.concatenate([shape.points for shape in shapes])
    center, half = 0.5 * (points.max(axis=0) + points.min(axis=0)), 0.55 * float(np.ptp(points, axis=0).max())
    axes.set_xlim(center[across] - half, center[across] + half)
    axes.set_ylim(center[2] + half, center[2] - half)
    axes.set_aspect("equal")
    size, unit = depth_unit()
    show_in(axes.xaxis, size)
    show_in(axes.yaxis, size)
    axes.set(
        xlabel=f"{('north', 'east')[across]} [{unit}]",
        ylabel=f"depth [{unit}]",
        title=f"True shape, seen from the {('east', 'south')[across]}",
    )
    line = LineCollection([], cmap=paint.cmap, norm=paint.norm, linewidths=4, capstyle="round")
    axes.add_collection(line, autolim=False)
    (ends,) = axes.plot([], [], "o", color="black", markersize=4)

    def update(now: Shape) -> None:
        line.set_segments(segments(now.points[:, across], now.points[:, 2]))
        line.set_array(middle(now.values) / paint.size)
        ends.set_data(now.points[[0], across], now.points[[0], 2])

    return update
