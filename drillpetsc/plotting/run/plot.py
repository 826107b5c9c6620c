"""`drillpetsc plot RUN`: histories, probes, orbits, forces along depth and the well path as PNG files.

The columns of the tables select the pictures: a run without fluid, probes or well has no such pictures.
"""

from __future__ import annotations

import os
import re
import textwrap
from collections.abc import Callable, Sequence
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.output.catalogue import find
from drillpetsc.output.files.fields import last_sizes
from drillpetsc.output.files.run_folder import (
    SWEEP_TABLE,
    RunFolder,
)
from drillpetsc.output.files.tables import read_numbers, read_titles, split_name
from drillpetsc.output.sensors.files import sensor_names
from drillpetsc.plotting import style
from drillpetsc.plotting.command import frequency, hydraulics, limits, sensitivities, torque_drag, vibration
from drillpetsc.plotting.command.modes import draw_modes
from drillpetsc.plotting.command.sweep import draw_sweep
from drillpetsc.plotting.command.vibration import draw_power, draw_sensor, draw_waterfall
from drillpetsc.plotting.run.hole_path import new_hole, well_path
from drillpetsc.plotting.run.signals import signal
from drillpetsc.plotting.source import Pictures, Source
from drillpetsc.plotting.style import GROUND, LINE_COLORS, WALL, display_unit, label, words
from drillpetsc.plotting.thinning import envelope, last_passages
from drillpetsc.unit_systems import System
from drillpetsc.unit_systems import display_unit as display_unit_of

Table = dict[str, np.ndarray]
LABEL_WIDTH = 26  # characters in one line below a panel of the pictures along depth
NOTE_WIDTH = 190  # characters in one line below the panels
FLAT = 0.03  # largest change of a column over the span of its panel below which all look constant
WIDEST_LEGEND = 66  # characters in one line above a panel


def plot(
    run: str | os.PathLike, out: str | os.PathLike | None = None, units: System | None = None
) -> list[Path]:
    """Draw the pictures of a run folder; returns the files written, in `out` or the run's plots folder.

    For the folder of a sweep: the new hole of its members.

    units: field, metric, metric_t or SI; by default the case's.  Raises FileNotFoundError if nothing can be drawn.
    """
    pictures = drawn(run, out, units)
    if not pictures:
        raise FileNotFoundError(
            f"{run} holds no table with rows that make a curve (an `uncertain` of one bit depth has none), and no members of a sweep "
            "that drilled new hole: nothing to plot"
        )
    return pictures


def drawn(
    run: str | os.PathLike, out: str | os.PathLike | None = None, units: System | None = None
) -> list[Path]:
    """As ``plot``, for a folder that may have nothing to draw: the hydraulics of one depth, say."""
    folder = RunFolder.open(run)
    with style.of_case(folder.case, units):
        if (folder.path / SWEEP_TABLE).is_file():
            return draw_sweep(folder.path, out)
        return style.save_figures(drawings(folder, units), folder.plots if out is None else Path(out))


def spectra(
    run: str | os.PathLike,
    waterfalls: Sequence[str] = (),
    powers: Sequence[str] = (),
    *,
    order: bool = False,
    segment: float | None = None,
    units: System | None = None,
) -> dict[str, Any]:
    """Waterfalls and power densities of signals of a run folder, as figures of matplotlib by name.

    waterfalls, powers: signals SOURCE:COLUMN, such as mwd:ax or history:bit_speed.
    order: waterfalls over the order of rotation; segment: length of a segment [s], with ``order`` its revolutions.
    units: as for `plot`.
    Raises CaseError for a signal that the folder does not have.
    """
    folder = RunFolder.open(run)
    title = Source(folder).title
    drawn: dict[str, Any] = {}
    with style.of_case(folder.case, units):
        for name in waterfalls:
            found = signal(folder.path, name)
            kind = "orders" if order else "waterfall"
            drawn[f"{kind}_{found.file}"] = draw_waterfall(found, title, segment, order)
        for name in powers:
            found = signal(folder.path, name, "--psd")
            drawn[f"psd_{found.file}"] = draw_power(found, title, segment)
    return drawn


def figures(
    run: str | os.PathLike,
    units: System | None = None,
    names: Sequence[str] | None = None,
    first: bool = False,
) -> dict[str, Any]:
    """The pictures of a run folder by name, as figures of matplotlib; no file is written.

    units: as for `plot`.
    names: of the pictures; by default all. Names without a picture in the folder are left out.
    first: the first picture only.
    """
    folder = RunFolder.open(run)
    with style.of_case(folder.case, units):
        return drawings(folder, units, names, first)


def picture_names(run: str | os.PathLike) -> list[str]:
    """Names of the pictures that the tables of a run folder may give; a table without rows gives none."""
    return list(_drawers(Source(RunFolder.open(run))))


def _drawers(at: Source) -> dict[str, Callable[[], Any]]:
    """Functions that draw the pictures of a folder, by name; they return None if there is nothing to draw."""
    drawers: dict[str, Callable[[], Any]] = {}
    folder, title = at.folder, at.title
    read = lru_cache(maxsize=1)(read_numbers)  # tables of long runs would not fit side by side
    if folder.history.exists():
        operation, numerics = grouped(read_titles(folder.history))
        drawers["history"] = lambda: _histories(read(folder.history), operation, f"{title}: histories")
        drawers["numerics"] = lambda: _histories(
            read(folder.history), numerics, f"{title}: energy and time steps"
        )
    if folder.probes.exists():
        sizes = last_sizes(folder.path)
        clearances = sizes and sizes[::2]
        drawers["orbits"] = lambda: _orbits(read(folder.probes), clearances, title)
        drawers["probes"] = lambda: _probes(read(folder.probes), clearances, title)
    drawers |= {f"sensor_{name}": partial(draw_sensor, at, name) for name in sensor_names(folder.path)}
    return drawers | {name: partial(draw, at) for name, (files, draw) in PICTURES.items() if at.has(*files)}


def drawings(
    folder: RunFolder, units: System | None = None, names: Sequence[str] | None = None, first: bool = False
) -> dict[str, Any]:
    """Figures of a run folder by name, in the units of `style.UNITS`; call it and save them within `style.look()`.

    units: of the pictures of hydraulics, surge, limits, torque and drag; by default their summary's.
    names, first: as for `figures`.
    """
    drawn: dict[str, Any] = {}
    for name, draw in _drawers(Source(folder, units)).items():
        drawing = draw() if names is None or name in names else None
        if drawing is not None:
            drawn[name] = drawing
            if first:
                break
    return drawn


def grouped(titles: list[str]) -> tuple[list[list[str]], list[list[str]]]:
    """Group columns into panels: (panels of the operation, panels of the numerics). The first column is the
    time.

    Quantities of one panel share it; every other column joins the columns of its unit after them.
    """
    panels: dict[int, list[str]] = {}
    by_unit: dict[str, list[str]] = {}
    numerics = set()
    for title in titles[1:]:
        name, unit = split_name(title)
        quantity = find(name)
        if quantity is None or not quantity.panel:
            by_unit.setdefault(unit, []).append(title)
            continue
        panels.setdefault(quantity.panel, []).append(title)
        if quantity.numerics:
            numerics.add(quantity.panel)
    operation = [panels[k] for k in sorted(panels) if k not in numerics]
    return operation + list(by_unit.values()), [panels[k] for k in sorted(numerics)]


def _histories(table: Table, panels: list[list[str]], title: str) -> Any:
    """Draw one panel per group of columns that change, in two columns, over a common time axis; name the others."""
    time_title, *_ = table
    time = table[time_title]
    panels = [kept for panel in panels if (kept := [c for c in panel if np.isfinite(table[c]).any()])]
    if not panels or len(time) < 2:
        return None
    panels, constant = _changing(table, panels)
    columns = 1 if len(panels) == 1 else 2
    rows = -(-len(panels) // columns)
    lines = textwrap.wrap("Constant: " + ", ".join(constant), NOTE_WIDTH) if constant else []
    below = 0.1 + 0.17 * len(lines)  # inches
    height = 0.9 + below + 2.15 * rows
    drawing = style.sheet(13.0, height, title)
    drawing.text(
        0.012, 0.08 / height, "\n".join(lines), fontsize=8.5, color="0.35", va="bottom", parse_math=False
    )
    if not panels:
        return drawing
    grid = drawing.subplots(rows, columns, squeeze=False, sharex=True)
    places = list(grid.T.reshape(-1))
    for axes, panel in zip(places, panels, strict=False):
        together = np.concatenate([table[name] for name in panel])
        size, unit = display_unit(panel[0], together)
        for name, color in zip(panel, LINE_COLORS * 3, strict=False):
            count = split_name(name)[0] == "newton"  # whole numbers that jump: dots, not a filled band
            style_of = {"linestyle": "", "marker": ".", "markersize": 2.5} if count else {"linewidth": 1.1}
            axes.plot(*envelope(time, table[name] / size), color=color, label=words(name), **style_of)
            if count:
                axes.set_ylim(0, 1.08 * max(float(np.nanmax(table[name])), 1.0))
                axes.yaxis.get_major_locator().set_params(integer=True)
        style.level(axes, together / size, style.is_noise(panel[0], together))
        axes.set_ylabel(f"[{unit}]" if unit else "")
        if (
            len(panel) == 1
        ):  # above, as the names of several: beside the axis a long one reaches the next panel
            axes.set_title(words(panel[0]), loc="left", fontsize=8.5, fontweight="normal")
        else:
            length = sum(len(words(name)) + 6 for name in panel)  # characters beside the lines
            stacked = -(-length // WIDEST_LEGEND)
            axes.legend(
                loc="lower left",
                bbox_to_anchor=(0.0, 1.02),
                ncols=-(-len(panel) // stacked),
                frameon=False,
                fontsize=8.5,
                borderaxespad=0.0,
            )
        axes.margins(x=0.0)
    for axes in places[len(panels) :]:
        axes.remove()
    for column in range(columns):
        last = [axes for axes in grid[:, column] if axes.figure is not None][-1]
        last.set_xlabel("time [s]")
        last.tick_params(labelbottom=True)
    return drawing.fitted(bottom=below / height, h_pad=1.1)


def _changing(table: Table, panels: list[list[str]]) -> tuple[list[list[str]], list[str]]:
    """Panels of columns that change, and words for those that do not.

    A constant stays beside columns that come near it: a set point. Columns that are flat beside their distance get panels of
    their own.
    """
    kept: list[list[str]] = []
    constant: list[str] = []
    for panel in panels:
        ends = {name: (float(np.nanmin(table[name])), float(np.nanmax(table[name]))) for name in panel}
        moving = [
            name
            for name in panel
            if style.limits_of_level(table[name], style.is_noise(name, table[name])) is None
        ]
        low, high = _span([ends[name] for name in moving])
        near = 0.5 * (high - low)
        shown = [n for n in panel if n in moving or low - near <= ends[n][0] <= high + near]
        for name in (n for n in panel if n not in shown):
            size, unit = display_unit(name, table[name])
            value = 0.0 if style.is_noise(name, table[name]) else ends[name][1] / size
            constant.append(f"{words(name)} {value:.4g} {unit}".rstrip())
        low, high = _span([ends[name] for name in shown])
        if any(ends[name][1] - ends[name][0] >= FLAT * (high - low) for name in shown):
            kept.append(shown)
        else:
            kept += [[name] for name in shown]
    return kept, constant


def _span(ends: list[tuple[float, float]]) -> tuple[float, float]:
    """Smallest and largest value of columns between their ends; nan without a column."""
    return min((low for low, _ in ends), default=np.nan), max((high for _, high in ends), default=np.nan)


def probe_names(table: Table) -> list[str]:
    """Measured depths of the probes, as written in the headers, in order."""
    found = [
        match.group(1)
        for title in table
        if (match := re.fullmatch(r"(?:x|spin)_([\d.]+)", split_name(title)[0]))
    ]
    return list(dict.fromkeys(found))


def _orbits(table: Table, clearances: tuple[np.ndarray, np.ndarray] | None, title: str) -> Any:
    """Draw the path of the string's centre at each probe, late times dark, with the circle of contact."""
    from matplotlib.collections import LineCollection

    names = [name for name in probe_names(table) if f"x_{name} [m]" in table and f"y_{name} [m]" in table]
    time = next(iter(table.values()))
    if not names or len(time) < 2:
        return None
    columns = min(len(names), 4)
    rows = -(-len(names) // columns)
    drawing = style.sheet(
        max(3.9 * columns, 6.5), 0.7 + 4.1 * rows, f"{title}: orbits of the string's centre"
    )
    lines = None
    size, _, unit = display_unit_of("diameter", style.system())
    length, depth_text = style.depth_unit()
    digits = 1 if unit == "mm" else 3
    grid = drawing.subplots(rows, columns, squeeze=False)
    for axes, name in zip(grid.reshape(-1), names, strict=False):
        x, y = table[f"x_{name} [m]"] / size, table[f"y_{name} [m]"] / size
        circle = None if clearances is None else float(np.interp(float(name), *clearances)) / size
        _clearance_circle(axes, circle, float(np.nanmax(np.hypot(x, y))))
        points = np.column_stack((y, x))  # looking down the hole with the high side on top
        seen = last_passages(points, float(axes.get_xlim()[1]))
        lines = LineCollection(
            np.stack((points[seen], points[seen + 1]), axis=1), cmap="viridis_r", linewidths=0.8, zorder=3
        )
        lines.set_array(time[seen + 1])
        axes.add_collection(lines, autolim=False)
        axes.plot(y[-1], x[-1], "o", color="#b03060", markersize=4.5, zorder=4)
        axes.set_aspect("equal")
        axes.set(
            xlabel=f"to the right (east in a vertical hole), y [{unit}]",
            ylabel=f"to the high side (north in a vertical hole), x [{unit}]",
            title=f"{round(float(name) / length, 2):g} {depth_text}"
            + (f", clearance {circle:.{digits}f} {unit}" if circle is not None else ""),
        )
    for axes in grid.reshape(-1)[len(names) :]:
        axes.remove()
    width = float(drawing.get_size_inches()[0])
    drawing.fitted(right=1 - 1.0 / width)
    bar = drawing.add_axes((1 - 0.85 / width, 0.18, 0.13 / width, 0.62))  # 0.7 inches for its numbers
    drawing.colorbar(lines, cax=bar)
    bar.set_title("time [s]", fontsize=9)
    return drawing


def _clearance_circle(axes: Any, clearance: float | None, reach: float) -> None:
    """Draw the rock outside the circle of contact. clearance, reach (largest offset of the orbit): in one unit."""
    half = 1.15 * max(reach, clearance or 0.0, 1e-6)
    if clearance is not None and clearance > 0:
        angle = np.linspace(0, 2 * np.pi, 181)
        axes.set_facecolor(GROUND)
        axes.fill(
            clearance * np.cos(angle),
            clearance * np.sin(angle),
            facecolor="white",
            edgecolor=WALL,
            linewidth=1.3,
            zorder=1,
        )
    axes.plot(0, 0, "+", color=WALL, markersize=9, zorder=2)
    axes.set(xlim=(-half, half), ylim=(-half, half))


def _probes(table: Table, clearances: tuple[np.ndarray, np.ndarray] | None, title: str) -> Any:
    """Draw spin, distance from the hole's centre and contact force over time, one line per probe."""
    names = probe_names(table)
    shown: dict[str, Table] = {"spin [rad/s]": {}, "distance_from_centre [m]": {}, "contact [N]": {}}
    for name in names:
        for kind, unit in (("spin", "rad/s"), ("contact", "N")):
            if f"{kind}_{name} [{unit}]" in table:
                shown[f"{kind} [{unit}]"][name] = table[f"{kind}_{name} [{unit}]"]
        if f"x_{name} [m]" in table and f"y_{name} [m]" in table:
            shown["distance_from_centre [m]"][name] = np.hypot(table[f"x_{name} [m]"], table[f"y_{name} [m]"])
    kept = {name: group for name, group in shown.items() if group}
    time = next(iter(table.values()))
    if not kept or len(time) < 2:
        return None
    drawing = style.sheet(13.0, 0.9 + 2.4 * len(kept), f"{title}: probes")
    for axes, (column, group) in zip(
        drawing.subplots(len(kept), 1, squeeze=False, sharex=True)[:, 0], kept.items(), strict=True
    ):
        together = np.concatenate(list(group.values()))
        size, unit = display_unit(column, together)
        for (name, values), color in zip(group.items(), LINE_COLORS * 3, strict=False):
            length, depth_text = style.depth_unit()
            at = f"{round(float(name) / length, 2):g} {depth_text}"
            axes.plot(*envelope(time, values / size), color=color, linewidth=1.0, label=at)
            if column.startswith("distance") and clearances is not None:
                axes.axhline(
                    np.interp(float(name), *clearances) / size,
                    color=color,
                    linewidth=0.9,
                    linestyle=(0, (6, 3)),
                )
        axes.set_ylabel(
            label(column, unit)
            + (("\n(dashed: on the wall)") if column.startswith("distance") and clearances else "")
        )
        axes.margins(x=0.0)
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False, fontsize=8.5)
        style.steady(axes, together / size, style.is_noise(column, together))
    axes.set_xlabel("time [s]")
    return drawing.fitted()


def _along_depth(table: Table, title: str) -> Any:
    """Draw every column of statics.csv over depth."""
    depth_title, *rest = table
    length, depth_text = style.depth_unit()
    depth = table[depth_title] / length
    numbers = [name for name in rest if table[name].dtype.kind == "f" and np.isfinite(table[name]).any()]
    if not numbers or len(depth) < 2:
        return None
    per_row = min(len(numbers), 6)
    rows = -(-len(numbers) // per_row)
    drawing = style.sheet(
        max(1.2 + 2.3 * per_row, 6.0), 0.9 + 7.2 * rows, f"{title}: static equilibrium along the string"
    )
    grid = drawing.subplots(rows, per_row, squeeze=False, sharey=True)
    for axes, name in zip(grid.reshape(-1), numbers, strict=False):
        size, unit = display_unit(name, table[name])
        values = table[name] / size
        axes.plot(values, depth, color=LINE_COLORS[0], linewidth=1.4)
        if values.min() < 0 < values.max() or values.min() == 0 or values.max() == 0:
            axes.axvline(0.0, color="0.35", linewidth=0.8)
        if split_name(name)[0] == "axial_force":
            axes.fill_betweenx(
                depth, np.minimum(values, 0.0), 0.0, color=LINE_COLORS[1], alpha=0.35, linewidth=0
            )
            # in the panel: the heading is above it
            axes.text(
                0.97, 0.01, "compression shaded", fontsize=8.5, color=LINE_COLORS[1], ha="right", transform=axes.transAxes,
            )  # fmt: skip
        axes.set_xlabel(textwrap.fill(label(name, unit), LABEL_WIDTH))
        axes.locator_params(axis="x", nbins=4)
        style.steady(axes, values, style.is_noise(name, table[name]), "x")
    for axes in grid.reshape(-1)[len(numbers) :]:
        axes.remove()
    for axes in grid[:, 0]:
        axes.set_ylabel(f"{words(depth_title)} [{depth_text}]")
    grid[0, 0].set_ylim(depth.max(), depth.min())
    return drawing.fitted()


PICTURES: Pictures = {
    **vibration.PICTURES,
    "along_depth": (("statics.csv",), lambda at: _along_depth(at.table("statics.csv"), at.title)),
    "modes": (("modes.csv",), draw_modes),
    **frequency.PICTURES,
    **hydraulics.PICTURES,
    **torque_drag.PICTURES,
    **limits.PICTURES,
    **sensitivities.PICTURES,
    "trajectory": (("trajectory.csv",), lambda at: well_path(*_drilled(at))),
    "new_hole": (("trajectory.csv",), lambda at: new_hole(*_drilled(at))),
}


def _drilled(at: Source) -> tuple[Table, str, float]:
    """Path of the hole, title, and length of the new hole [m]."""
    return at.table("trajectory.csv"), at.title, at.summary.get("new_hole", {}).get("drilled [m]", 0.0)
