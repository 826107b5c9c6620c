"""Pictures of the path of a hole: section and plan, and the new hole enlarged; drawn from trajectory.csv."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.geometry.trajectory import COURSE, dogleg
from drillpetsc.geometry.well import direction
from drillpetsc.plotting import style
from drillpetsc.plotting.source import Table
from drillpetsc.plotting.style import LINE_COLORS
from drillpetsc.unit_systems import display_unit

ABOVE = 10.0  # length of old hole shown above the new hole [m]
#: by unit of depth: lengths over which the dogleg severity is computed, the local one first [m]
COURSES = {"ft": (10 * 0.3048, 100 * 0.3048), "m": (3.0, COURSE)}
LEAST_WIDTH = 0.5  # smallest width of a track of angles [deg]
OLD, NEW = "0.45", LINE_COLORS[1]


def well_path(table: Table, title: str, drilled: float = 0.0) -> Any:
    """Section (depth over horizontal distance from the well head) and plan of a hole, both true to scale.

    The last ``drilled`` metres are marked as new.
    """
    if len(table["md [m]"]) < 2:
        return None
    length, unit = style.depth_unit()
    north, east, depth = (table[f"{name} [m]"] / length for name in ("north", "east", "tvd"))
    away = np.hypot(north - north[0], east - east[0])
    drawing = style.sheet(11.0, 6.2, f"{title}: well path")
    section, plan = drawing.subplots(1, 2)
    start = table["md [m]"][-1] - drilled
    old, new = table["md [m]"] <= start + 1e-6, table["md [m]"] >= start - 1e-6
    for axes, across, along in ((section, away, depth), (plan, east, north)):
        axes.plot(across[old], along[old], color=LINE_COLORS[0], linewidth=2)
        if drilled > 0:
            axes.plot(
                across[new],
                along[new],
                color=NEW,
                linewidth=3.5,
                solid_capstyle="butt",
                label=f"new hole, {drilled / length:.4g} {unit}",
            )
    section.set(
        xlabel=f"horizontal distance from the well head [{unit}]",
        ylabel=f"True vertical depth [{unit}]",
        title="Section",
    )
    span = max(float(np.ptp(depth)), float(np.ptp(away)), 1e-9)
    section.set(
        ylim=(depth.max() + 0.04 * span, depth.min() - 0.04 * span),
        xlim=(-0.06 * span, max(away.max(), 0.3 * span) * 1.06),
    )
    section.set_aspect("equal")
    plan.plot(east[0], north[0], "o", color="black", markersize=5, label="well head")
    half = 0.55 * max(float(np.ptp(east)), float(np.ptp(north)), 0.02 * span)
    middle = 0.5 * (east.max() + east.min()), 0.5 * (north.max() + north.min())
    plan.set(
        xlim=(middle[0] - half, middle[0] + half),
        ylim=(middle[1] - half, middle[1] + half),
        xlabel=f"east [{unit}]",
        ylabel=f"north [{unit}]",
        title="Plan",
    )
    plan.set_aspect("equal")
    if max(float(np.ptp(east)), float(np.ptp(north))) < 1e-3 * span:
        plan.text(
            0.5,
            0.42,
            "vertical hole:\nthe plan is one point",
            transform=plan.transAxes,
            ha="center",
            color="0.35",
        )
    plan.legend(frameon=False)
    return drawing.fitted()


def new_hole(table: Table, title: str, drilled: float) -> Any:
    """Tracks of inclination, azimuth and dogleg severity beside the depth axis, over the last ``drilled``
    metres and ten above them."""
    md = table["md [m]"]
    start = md[-1] - drilled
    if drilled <= 0 or len(md) < 3:
        return None
    top = max(start - ABOVE, float(md[0]))
    shown = np.union1d(md[md > top], top)
    length, unit = style.depth_unit()
    depth, kink = shown / length, start / length
    size, _, per = display_unit("dogleg", style.system())
    turned = np.degrees(np.unwrap(np.radians(table["azimuth [deg]"])))
    drawing = style.sheet(9.5, 7.5, f"{title}: new hole, {drilled / length:.4g} {unit}")
    tracks = drawing.subplots(1, 3, sharey=True)
    _track(tracks[0], depth, np.interp(shown, md, table["inclination [deg]"]), kink, "Inclination [deg]")
    _track(tracks[1], depth, np.interp(shown, md, turned), kink, "Azimuth [deg]")
    courses = COURSES[unit]
    local, severity = (_severity(table, shown, course) / size for course in courses)
    names = [f"over the {course / length:g} {unit} above" for course in courses]
    _track(tracks[2], depth, local, kink, f"Dogleg severity [{per}]", names[0])
    tracks[2].plot(
        severity,
        depth,
        color="black",
        linewidth=1.2,
        linestyle=(0, (5, 2)),
        label=names[1],
    )
    tracks[2].set_xlim(0.0, 1.15 * max(severity.max(), local.max(), 1e-3))
    tracks[2].legend(frameon=True, framealpha=0.9, edgecolor="none", fontsize=8.5, loc="best")
    tracks[0].set(ylim=((md[-1] + 0.02 * drilled) / length, top / length), ylabel=f"Measured depth [{unit}]")
    for text, place, color in (("old hole", "bottom", OLD), ("new hole", "top", NEW)):
        tracks[1].annotate(
            text,
            (0.98, kink),
            (0, 3 if place == "bottom" else -3),
            xycoords=tracks[1].get_yaxis_transform(),
            textcoords="offset points",
            va=place,
            ha="right",
            fontsize=8.5,
            color=color,
        )
    return drawing.fitted()


def _severity(table: Table, md: np.ndarray, course: float) -> np.ndarray:
    """Dogleg severity (n,) [rad/m] over the ``course`` [m] above md (n,) [m].

    Directions between stations are interpolated.
    """
    stations = direction(np.radians(table["inclination [deg]"]), np.radians(table["azimuth [deg]"]))

    def at(s: np.ndarray) -> np.ndarray:
        t = np.column_stack([np.interp(s, table["md [m]"], one) for one in stations.T])
        return t / np.linalg.norm(t, axis=1, keepdims=True)

    above = np.maximum(md - course, table["md [m]"][0])
    return np.asarray(dogleg(at(above), at(md)) / np.maximum(md - above, 1e-9))


def _track(axes: Any, md: np.ndarray, values: np.ndarray, start: float, label: str, name: str = "") -> None:
    """One quantity over depth, grey in the old hole.

    The axis is at least LEAST_WIDTH wide, so that rounding is not mistaken for a change of direction.
    """
    axes.plot(values, md, color=NEW, linewidth=1.8, label=name)
    old = md <= start + 1e-6
    axes.plot(values[old], md[old], color=OLD, linewidth=2.2)
    axes.axhline(start, color="0.35", linewidth=0.9, linestyle=(0, (6, 3)))
    low, high = float(values.min()), float(values.max())
    spare = max(0.06 * (high - low), 0.5 * (LEAST_WIDTH - (high - low)))
    axes.set(xlabel=label, xlim=(low - spare, high + spare))
    axes.ticklabel_format(axis="x", useOffset=False)
    axes.locator_params(axis="x", nbins=5)
