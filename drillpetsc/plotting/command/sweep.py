"""Pictures of a sweep whose members drilled new hole: paths, inclination and build rate.

Drawn from sweep.csv, summary.json and each trajectory.csv. The colour shows the first varied key, the marker
the second; a member without fluid is dashed black.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.geometry.frames import high_side
from drillpetsc.geometry.well import direction
from drillpetsc.output.files.run_folder import ABSENT, SWEEP_PICTURES, SWEEP_TABLE, RunFolder
from drillpetsc.output.files.tables import read_table
from drillpetsc.plotting import style
from drillpetsc.plotting.source import Source
from drillpetsc.plotting.style import LINE_COLORS
from drillpetsc.unit_systems import display_unit

MARKERS = "osD^vP*X"
BEHIND = 0.15  # length of old hole shown above the new hole, as a fraction of the new hole's length
EXAGGERATED = 0.35  # drawn length of the largest offset, as a fraction of the new hole's length
NEAR_VERTICAL = np.radians(3.0)  # below it the plan view is across the hole, not along it [rad]
STRAIGHT: dict[str, Any] = {"color": "0.55", "linewidth": 1.0, "linestyle": (0, (6, 3))}

DRY: dict[str, Any] = {"color": "black", "linewidth": 1.7, "linestyle": (0, (5, 2))}


@dataclass(frozen=True)
class Path3:
    """New hole of a member.

    values: varied key -> word.
    numbers: varied key -> value [SI], for the values that are numbers.
    units: varied key -> SI unit.
    md: (n,) measured depth [m].
    inclination: (n,) [deg].
    along: (n,) position in the direction of the old hole's end [m].
    up, right: (n,) offset from its straight continuation towards the high side, and to the right of that [m].
    tilt, azimuth: inclination [rad] and azimuth [deg] of the old hole's end.
    build: average build rate [deg/30 m].
    """

    values: dict[str, str]
    numbers: dict[str, float]
    units: dict[str, str]
    md: np.ndarray
    inclination: np.ndarray
    along: np.ndarray
    up: np.ndarray
    right: np.ndarray
    tilt: float
    azimuth: float
    build: float

    @property
    def dry(self) -> bool:
        return self.values.get("fluid") == "off"


def draw_sweep(sweep: str | os.PathLike, out: str | os.PathLike | None = None) -> list[Path]:
    """Draw the new hole of the members, into ``out`` or the sweep's folder; returns the files written.

    Without new hole: the results of the table, one panel each, over the members.
    """
    folder = Path(sweep)
    paths = drilled_paths(folder)
    into = folder if out is None else Path(out)
    title = Source(RunFolder(folder)).title
    first = next((f for f in sorted(folder.glob(f"*/{RunFolder(folder).case.name}"))), folder)
    with style.of_case(first, style.UNITS.get()):
        if paths:
            drawings = (draw(paths, title) for draw in (trajectories, inclinations, build_rates))
            drawn = dict(zip(SWEEP_PICTURES, drawings, strict=True))
        else:
            drawn = {"results": results(folder, title)}
        return style.save_figures({name: q for name, q in drawn.items() if q is not None}, into)


def results(folder: Path, title: str) -> Any:
    """Draw means and last values of the table over the number of the member; None without a member that is done."""
    table = read_table(folder / SWEEP_TABLE)
    done = np.flatnonzero(np.asarray(table["status"]) == "done")
    after = list(table)[list(table).index("status") + 1 :]
    skipped = ("ranks", "wall [s]", "time [s]", "real_time_factor [-]", "steps [-]", "message")
    shown = [
        name
        for name in after
        if name not in skipped
        and np.asarray(table[name]).dtype.kind == "f"
        and np.isfinite(table[name][done]).any()
    ]
    if not len(done) or not shown:
        return None
    columns = min(3, len(shown))
    rows = -(-len(shown) // columns)
    drawing = style.sheet(12.0, 0.9 + 1.9 * rows, f"{title}: results of the members")
    grid = drawing.subplots(rows, columns, squeeze=False, sharex=True).reshape(-1)
    member = np.asarray(table["member"], dtype=float)[done]
    for axes, name in zip(grid, shown, strict=False):
        size, unit = style.display_unit(name, table[name][done])
        axes.plot(member, table[name][done] / size, "o-", color=style.LINE_COLORS[0], markersize=4)
        axes.set_ylabel(style.label(name, unit), fontsize=8)
        style.level(axes, table[name][done] / size, style.is_noise(name, table[name][done]))
        axes.xaxis.get_major_locator().set_params(integer=True)
        axes.set_xlabel("member")
    for axes in grid[len(shown) :]:
        axes.remove()
    return drawing.fitted()


# ---------------------------------------------------------------------- data of the folder
def drilled_paths(folder: Path) -> list[Path3]:
    """New hole of every member that is done; the build rate of an unfinished run would not be comparable."""
    table = read_table(folder / SWEEP_TABLE)
    titles = list(table)
    keys = [title for title in titles[1 : titles.index("status")] if not title.endswith(" (SI)")]
    known = RunFolder(folder).read_summary().get("units", {})
    units = {key: known.get(key, "") for key in keys}
    found = []
    for i, length in enumerate(table.get("drilled [m]", ())):
        file = RunFolder(folder / str(table["folder"][i])).trajectory
        if table["status"][i] != "done" or not length > 0 or not file.is_file():
            continue
        words = {key: _word(table[key][i], units[key]) for key in keys}
        numbers = {
            key: x for key in keys if np.isfinite(x := _number(table.get(f"{key} (SI)", table[key])[i]))
        }
        found.append(
            _new_part(
                words,
                numbers,
                units,
                read_table(file),
                float(length),
                float(table["build_rate [deg/30m]"][i]),
            )
        )
    return found


def _word(value: Any, unit: str) -> str:
    """The word as given; a plain number gets its SI unit."""
    number = _number(value)
    return f"{number:.6g} {unit}".strip() if np.isfinite(number) else str(value)


def _number(word: Any) -> float:
    """The number in SI; nan for a word."""
    try:
        return float(word)
    except ValueError:
        return np.nan


def _new_part(
    values: dict[str, str],
    numbers: dict[str, float],
    units: dict[str, str],
    table: dict[str, np.ndarray],
    length: float,
    build: float,
) -> Path3:
    md, inclination, azimuth = table["md [m]"], table["inclination [deg]"], table["azimuth [deg]"]
    first = int(np.argmin(np.abs(md - (md[-1] - length))))
    place = np.column_stack([table[f"{name} [m]"] for name in ("north", "east", "tvd")])[first:]
    ahead = direction(np.radians(inclination[first]), np.radians(azimuth[first]))
    above = high_side(ahead)
    away = place - place[0]
    return Path3(
        values,
        numbers,
        units,
        md[first:],
        inclination[first:],
        away @ ahead,
        away @ above,
        away @ np.cross(ahead, above),
        float(np.radians(inclination[first])),
        float(azimuth[first]),
        build,
    )


# ---------------------------------------------------------------------- lines of the members
def varied(paths: list[Path3]) -> list[str]:
    """Keys that differ between the members with fluid."""
    wet = [p for p in paths if not p.dry] or paths
    return [key for key in wet[0].values if len({p.values[key] for p in wet}) > 1]


def _looks(paths: list[Path3]) -> list[dict[str, Any]]:
    """Colour, marker and name of each member's line."""
    import matplotlib as mpl

    keys = varied(paths)
    ranks = {key: list(dict.fromkeys(p.values[key] for p in paths if not p.dry)) for key in keys}
    colors: Any = LINE_COLORS
    if keys and len(ranks[keys[0]]) > len(LINE_COLORS):
        colors = [mpl.colormaps["viridis"](x) for x in np.linspace(0.0, 0.92, len(ranks[keys[0]]))]
    looks = []
    for p in paths:
        if p.dry:
            others = [p.values[key] for key in keys if p.values[key] != ABSENT]
            looks.append({**DRY, "zorder": 5, "label": ", ".join(["no fluid", *others])})
            continue
        color = colors[ranks[keys[0]].index(p.values[keys[0]])] if keys else LINE_COLORS[0]
        look = {
            "color": color,
            "linewidth": 1.3,
            "label": ", ".join(p.values[key] for key in keys) or "new hole",
        }
        if len(keys) > 1:
            marker = MARKERS[ranks[keys[1]].index(p.values[keys[1]]) % len(MARKERS)]
            look |= {"marker": marker, "markersize": 5, "markerfacecolor": "white"}
        looks.append(look)
    return looks


def _markers(look: dict[str, Any], count: int, number: int) -> dict[str, Any]:
    """Line style with markers at some of the ``count`` points only; the points differ between members, so that
    no marker hides another."""
    if "marker" not in look:
        return look
    step = max(count // 6, 1)
    return {**look, "markevery": (min(number % 9 * max(step // 9, 1), count - 1), step)}


def _legend(drawing: Any, axes: Any, paths: list[Path3]) -> None:
    """Draw the legend to the right of the panels, with the varied keys as its title."""
    keys = varied(paths)
    handles, labels = axes.get_legend_handles_labels()
    drawing.legend(
        handles,
        labels,
        title=",\n".join(keys) if keys else None,
        loc="outside right center",
        frameon=False,
        fontsize=9,
        ncols=1 + len(labels) // 30,
    )


def _figure(width: float, height: float, title: str) -> Any:
    """Figure with a title. width, height: [in]."""
    drawing = style.figure(width, height, dpi=110)
    drawing.set_layout_engine("constrained", h_pad=0.12, w_pad=0.12)
    drawing.suptitle(title, x=0.01, ha="left", fontweight="bold", fontsize=12)
    return drawing


# ---------------------------------------------------------------------- pictures
def trajectories(paths: list[Path3], title: str) -> Any:
    """Vertical section along the hole's azimuth, plan view, and ends of the holes; the titles state how many
    times offsets are exaggerated."""
    length = max(float(p.along[-1]) for p in paths)
    drawing = _figure(
        15.0, 6.2, f"{title}: new hole, {length / style.depth_unit()[0]:.4g} {style.depth_unit()[1]}"
    )
    section, plan, ends = drawing.subplots(1, 3, width_ratios=(1.5, 1, 1))
    _section(section, paths, length)
    _plan(plan, paths)
    _ends(ends, paths)
    _legend(drawing, section, paths)
    return drawing


def round_scale(wanted: float) -> float:
    """The largest of 1, 2, 5, 10, 20, ... that is not above ``wanted``; at least 1."""
    if not wanted > 1:
        return 1.0
    power = 10.0 ** np.floor(np.log10(wanted) + 1e-9)
    return float(power * max(m for m in (1, 2, 5) if m * power <= wanted * (1 + 1e-9)))


def _section(axes: Any, paths: list[Path3], length: float) -> None:
    largest = max(float(np.abs(p.up).max()) for p in paths)
    scale = round_scale(EXAGGERATED * length / max(largest, 1e-9))
    for number, (p, look) in enumerate(zip(paths, _looks(paths), strict=True)):
        away, down = _in_section(p, p.along, scale * p.up)
        axes.plot(away, down, **_markers(look, len(away), number))
    p = paths[0]
    away, down = _in_section(p, np.array([-BEHIND * length, 0.0]), np.zeros(2))
    axes.plot(away, down, color="0.45", linewidth=5, solid_capstyle="butt", zorder=1)
    size, unit = style.depth_unit()
    style.show_in(axes.xaxis, size)
    style.show_in(axes.yaxis, size)
    away, down = _in_section(p, np.array([0.0, length]), np.zeros(2))
    axes.plot(away, down, zorder=1, **STRAIGHT)
    sign = 1.0 if sum(float(q.up[-1]) for q in paths) >= 0 else -1.0
    _offset_scale(axes, p, length, largest, sign * scale)
    axes.set_aspect("equal", adjustable="datalim")
    axes.invert_yaxis()
    where = (
        f"azimuth {p.azimuth:.4g} deg"
        if np.ptp([q.azimuth for q in paths]) < 1e-3
        else "the old hole's azimuth"
    )
    axes.set(
        xlabel=f"departure along {where} [{unit}]",
        ylabel=f"depth below the start of new hole [{unit}]",
        title=f"Vertical section: offsets from the straight continuation {scale:g} times",
    )


def _in_section(p: Path3, along: np.ndarray, up: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Departure and depth (n,) [m] of points along the old hole's direction and up from it (both (n,)
    [m])."""
    s, c = np.sin(p.tilt), np.cos(p.tilt)
    return along * s + up * c, along * c - up * s


def _offset_scale(axes: Any, p: Path3, length: float, largest: float, scale: float) -> None:
    """Draw a scale of offsets across the end of the straight continuation."""
    small, text = style.lateral_unit(0.0)
    step = round_scale(largest / small / 2) * small if largest > 2 * small else max(largest, 1e-6)
    marks = step * np.arange(int(1.2 * largest / step) + 1)
    beyond = np.full(len(marks), 1.03 * length)
    away, down = _in_section(p, beyond, scale * marks)
    axes.plot(
        away, down, color="0.35", linewidth=0.9, marker="|" if p.tilt < np.pi / 4 else "_", markersize=7
    )
    aside = 11 * np.sin(p.tilt), -11 * np.cos(p.tilt)  # further down the hole
    for i in (0, -1):
        axes.annotate(
            f"{marks[i] / small:.4g} {text}",
            (away[i], down[i]),
            aside,
            textcoords="offset points",
            va="center",
            ha="center" if p.tilt < np.pi / 6 else "left",
            fontsize=8,
            color="0.25",
        )


def _plan(axes: Any, paths: list[Path3]) -> None:
    """Plan view: true along the hole's azimuth, exaggerated to the right of it; for a nearly vertical hole the
    view along the hole."""
    leaning = paths[0].tilt > NEAR_VERTICAL
    across = [p.along * np.sin(p.tilt) + p.up * np.cos(p.tilt) if leaning else p.up for p in paths]
    widest = max(float(np.abs(p.right).max()) for p in paths)
    reach = max(float(np.ptp(a)) for a in across)
    scale = round_scale(EXAGGERATED * reach / max(widest, 1e-9)) if leaning else 1.0
    for number, (p, a, look) in enumerate(zip(paths, across, _looks(paths), strict=True)):
        axes.plot(p.right, a, **_markers(look, len(a), number))
    axes.axvline(0.0, zorder=1, **STRAIGHT)
    axes.locator_params(axis="x", nbins=6)
    size, unit = style.depth_unit()
    across_size, across_unit = style.lateral_unit(0.0) if scale > 1 else (size, unit)
    style.show_in(axes.xaxis, across_size)
    style.show_in(axes.yaxis, size)
    axes.set_aspect(1.0 / scale, adjustable="datalim")
    aim = f"departure along the hole's azimuth [{unit}]" if leaning else f"north [{unit}]"
    axes.set(
        xlabel=f"to the right of the straight continuation [{across_unit}]" if leaning else f"east [{unit}]",
        ylabel=aim,
        title=f"Plan view: offsets to the right {scale:g} times" if leaning else "Plan view",
    )


def _ends(axes: Any, paths: list[Path3]) -> None:
    """Draw the ends of the new holes, seen along the old hole."""
    for p, look in zip(paths, _looks(paths), strict=True):
        spot = {"marker": "x", "markeredgewidth": 2} if p.dry else {"marker": look.get("marker", "o")}
        axes.plot(
            p.right[-1],
            p.up[-1],
            linestyle="",
            color=look["color"],
            markersize=8,
            markerfacecolor="white",
            **spot,
        )
    axes.margins(0.15)
    size, unit = style.lateral_unit(0.0)
    style.show_in(axes.xaxis, size)
    style.show_in(axes.yaxis, size)
    vertical = paths[0].tilt < 1e-6
    axes.set(
        xlabel=f"east [{unit}]" if vertical else f"to the right [{unit}]",
        ylabel=f"north [{unit}]" if vertical else f"to the high side [{unit}]",
        title="Ends, off the straight continuation",
    )


def inclinations(paths: list[Path3], title: str) -> Any:
    """Inclination over measured depth."""
    drawing = _figure(10.5, 6.4, f"{title}: inclination of the new hole")
    axes = drawing.subplots()
    size, unit = style.depth_unit()
    for number, (p, look) in enumerate(zip(paths, _looks(paths), strict=True)):
        axes.plot(p.md / size, p.inclination, **_markers(look, len(p.md), number))
    axes.set(xlabel=f"Measured depth [{unit}]", ylabel="Inclination [deg]")
    axes.ticklabel_format(useOffset=False)
    axes.margins(x=0.01)
    _legend(drawing, axes, paths)
    return drawing


def build_rates(paths: list[Path3], title: str) -> Any:
    """Average build rate over the first numeric key, one line per value of the other keys; a member without
    fluid is a dashed horizontal line."""
    keys = varied(paths)
    numeric = [key for key in keys if all(key in p.numbers for p in paths if p.values[key] != ABSENT)]
    if len(numeric) < 2:
        return None
    first = numeric[0]
    others = [key for key in keys if key != first]
    groups: dict[tuple[str, ...], list[Path3]] = {}
    for p in paths:
        if first in p.numbers:
            groups.setdefault(tuple(p.values[key] for key in others), []).append(p)
    drawing = _figure(9.0, 6.0, f"{title}: average build rate")
    axes = drawing.subplots()
    unit, size = shown_unit(first, paths)
    rate, _, per = display_unit("dogleg", style.system())
    rate *= np.degrees(30.0)  # to the unit, from deg/30 m
    for number, (words, members) in enumerate(groups.items()):
        members = sorted(members, key=lambda p: p.numbers[first])
        axes.plot(
            [p.numbers[first] / size for p in members],
            [p.build / rate for p in members],
            color=LINE_COLORS[number % len(LINE_COLORS)],
            marker=MARKERS[number % len(MARKERS)],
            markersize=6,
            linewidth=1.5,
            label=", ".join(words),
        )
    for p in paths:
        if first not in p.numbers:
            axes.axhline(p.build / rate, **DRY, label="no fluid" if p.dry else ", ".join(p.values.values()))
    axes.set(
        xlabel=f"{first} [{unit}]" if unit else first,
        ylabel=f"Average build rate [{per.replace('30m', '30 m')}]",
    )
    axes.ticklabel_format(useOffset=False)
    ticks = sorted({p.numbers[first] / size for p in paths if first in p.numbers})
    if len(ticks) <= 8:
        axes.set_xticks(ticks)
    axes.legend(title=", ".join(others), frameon=False, loc="best")
    return drawing


def shown_unit(key: str, paths: list[Path3]) -> tuple[str, float]:
    """Unit in which all values of a key were given, and its size in SI; the SI unit if they were given in
    several units."""
    units, size = set(), 1.0
    for p in paths:
        if key in p.numbers:
            number, _, unit = p.values[key].strip().partition(" ")
            units.add(unit.strip())
            try:
                size = p.numbers[key] / float(number) if float(number) else size
            except ValueError:
                return p.units[key], 1.0
    return (units.pop(), size) if len(units) == 1 else (paths[0].units[key], 1.0)
