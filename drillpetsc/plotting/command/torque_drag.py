"""Pictures of the commands `roadmap` and `calibrate`, drawn from their tables."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from drillpetsc.output.files.json_file import read_summary
from drillpetsc.output.files.run_folder import (
    CALIBRATION_SERIES,
    CALIBRATION_TABLE,
    ROADMAP_FILE,
    ROADMAP_TABLE,
)
from drillpetsc.plotting import style
from drillpetsc.plotting.source import Pictures, Source, Table
from drillpetsc.plotting.style import LINE_COLORS
from drillpetsc.unit_systems import System, display_unit

#: operation -> words, colour; in the order of a broomstick from its left
FREE_COLOR = "#e0a800"  # seen on the curve of rotating off bottom, which it follows
FREE = (0, (4, 4))  # dashes of the free rotating weight
OPERATIONS = {
    "trip_in": ("trip in", LINE_COLORS[0]),
    "sliding": ("sliding", LINE_COLORS[3]),
    "drilling": ("drilling", LINE_COLORS[2]),
    "rotate_off_bottom": ("rotate off bottom", "0.25"),
    "backreaming": ("backreaming", LINE_COLORS[4]),
    "trip_out": ("trip out", LINE_COLORS[1]),
}
DASHES: tuple[Any, ...] = ("-", (0, (5, 2)), (0, (1, 1.2)), (0, (5, 1.5, 1, 1.5)), (0, (8, 2, 2, 2)))
LIMIT = "#b03060"
_MODELS = {"soft": "the soft string", "stiff": "the beam"}
MANY_POINTS = 100  # of a calibration, which then have small marks
FAR_LIMIT = 1.5  # a limit of the rig beyond this times the axis is not drawn
OTHER_PIPE = (
    0.1  # a limit that changes by more than this share from one depth to the next belongs to another pipe
)
#: state -> mark, words
BUCKLED = {
    "sinusoidal": ("o", "buckled, sinusoidal"),
    "helical": ("s", "buckled, helical"),
    "lock_up": ("X", "locked up"),
}


def _series(at: Source) -> Any:
    """The columns of a log over time, beside the run with the fitted numbers."""
    table = at.table(CALIBRATION_SERIES)
    names = [column.split(" read [")[0] for column in table if " read [" in column]
    drawing = style.sheet(10.0, 1.5 + 2.2 * len(names), f"{at.title}: log and run with the fitted numbers")
    panels = drawing.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
    for axes, name in zip(panels, names, strict=True):
        title_read = next(column for column in table if column.startswith(f"{name} read ["))
        read, computed = table[title_read], table[title_read.replace(" read [", " computed [")]
        size, shown = style.display_unit(title_read.replace(" read", ""), read)
        read, computed = read / size, computed / size
        axes.plot(table["time [s]"], read, ".", color="0.45", markersize=3, label="read")
        axes.plot(table["time [s]"], computed, color=LINE_COLORS[0], linewidth=1.2, label="computed")
        axes.set_ylabel(f"{name.replace('_', ' ')} [{shown}]")
    panels[0].legend(frameon=False, fontsize=8.5, ncols=2, loc="lower right", bbox_to_anchor=(1, 1))
    panels[-1].set_xlabel("time [s]")
    return drawing.fitted()


def _calibration(at: Source) -> Any:
    """Residuals over the bit depth in standard errors, and the open-hole factor of each point alone."""
    table, summary = at.table(CALIBRATION_TABLE), at.summary
    depth, _, unit = display_unit("length", at.system)
    md, operation = table["bit_depth [m]"] / depth, table["operation [-]"]
    marks = {"hook_load": ("o", "hook load"), "surface_torque": ("^", "surface torque")}
    drawing = style.sheet(
        11.0, 6.5, f"{at.title}: measured points and {_MODELS[summary.get('model', 'soft')]}"
    )
    left, right = drawing.subplots(1, 2, sharey=True)
    size = 6 if len(md) < MANY_POINTS else 3
    residual = table["residual [N or N m]"] / table["sigma [N or N m]"]
    left.axvspan(-2, 2, color="0.93", zorder=0)
    left.axvline(0.0, color="0.35", linewidth=0.8)
    for word, (text, color) in OPERATIONS.items():
        for reading, (mark, kind) in marks.items():
            part = (operation == word) & (table["compared [-]"] == reading)
            held = part & (np.asarray(table["part [-]"]) == "held_out")
            if held.any():
                left.plot(
                    residual[held],
                    md[held],
                    mark,
                    mfc="none",
                    color=color,
                    label=f"{text}, {kind}, predicted",
                    markersize=size,
                )
            part &= ~held
            if part.any():
                left.plot(
                    residual[part], md[part], mark, color=color, label=f"{text}, {kind}", markersize=size
                )
                right.plot(
                    table["ff_open_hole_alone [-]"][part], md[part], mark, color=color, markersize=size
                )
    found = summary["fit"].get("open_hole", {})
    if found.get("value") is not None:
        if found["interval"] is not None:
            low, high = np.clip(found["interval"], 0.0, 1.0)
            right.axvspan(low, high, color="0.9", zorder=0, label="95 % interval")
        right.axvline(found["value"], color="0.25", linewidth=1.2, label=f"all points: {found['value']:.3f}")
        right.legend(frameon=False, fontsize=8.5, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
    left.set(xlabel="computed less measured [standard errors]", ylabel=f"Bit depth (MD) [{unit}]")
    right.set(xlabel="open-hole friction factor of each point alone", xlim=(0, 1))
    margin = 0.15 * float(md.max())
    left.set_ylim(float(md.max()) + 0.4 * margin, max(float(md.min()) - margin, 0.0))
    handles, labels = left.get_legend_handles_labels()
    drawing.legend(handles, labels, frameon=False, fontsize=8.5, loc="center right")
    return drawing.fitted(right=0.8)


def _pairs(table: Table) -> list[tuple[float, float, str]]:
    """Friction pairs in the order of the table, with the text of further groups."""
    return list(dict.fromkeys(_pair_of_rows(table)))


def _pair_of_rows(table: Table) -> list[tuple[float, float, str]]:
    cased, opened = (np.nan_to_num(table[f"ff_{name} [-]"], nan=-1.0) for name in ("cased", "open_hole"))
    groups = table.get("ff_groups [-]", [""] * len(cased))
    return [(float(a), float(b), str(text)) for a, b, text in zip(cased, opened, groups, strict=True)]


def _pair_words(pair: tuple[float, float, str]) -> str:
    cased, opened, groups = pair
    words = [" / ".join(f"{value:.4g}" for value in (cased, opened) if value >= 0), groups]
    return ", ".join(filter(None, words))


def _hook_load(at: Source) -> Any:
    """Hook load over the bit depth: the broomstick."""
    table, inputs = at.table(ROADMAP_TABLE), read_summary(at.folder.path / ROADMAP_FILE)
    total = "hook_load_total [N]" in table
    column = "hook_load_total [N]" if total else "hook_load [N]"
    block = inputs["block_weight [N]"] or 0.0
    words = "Hook load with block" if total else "Hook load of the string"
    drawing, axes, size, depth = _frame(f"{at.title}: hook load", words, "force", at.system)
    _curves(axes, table, column, size, depth)
    lines = inputs["lines [m, N]"]
    md = np.array(lines["bit_depth"]) / depth
    free, air = ((np.array(lines[q]) + block) / size for q in ("free_rotating_weight", "weight_in_air"))
    dot = "." if len(md) == 1 else None
    axes.plot(
        free, md, color=FREE_COLOR, linewidth=0.9, linestyle=FREE, marker=dot, zorder=4
    )  # on top of rotating off bottom
    axes.plot(air, md, color="0.45", linewidth=0.8, linestyle=":", marker=dot)
    extra = [(FREE_COLOR, FREE, "free rotating weight"), ("0.45", ":", "weight in air")]
    if inputs["max_hookload [N]"] is not None:
        extra.append(_rig_limit(axes, inputs["max_hookload [N]"] / size, "largest hook load"))
    shift = block if inputs["hookload_excludes_block"] and total else 0.0
    shift -= block if not total and not inputs["hookload_excludes_block"] else 0.0
    _measured(axes, inputs, "hook_load", size, depth, shift)
    if np.any(table[column] < 0):
        axes.axvline(0.0, color="0.35", linewidth=0.8)
    return _finish(drawing, axes, table, inputs, extra, depth)


def _torque(at: Source) -> Any:
    """Surface torque over the bit depth, of the operations that have one."""
    table, inputs = at.table(ROADMAP_TABLE), read_summary(at.folder.path / ROADMAP_FILE)
    column = "surface_torque [N m]"
    if not np.any(np.abs(table[column]) > 0):
        return None
    drawing, axes, size, depth = _frame(f"{at.title}: surface torque", "Surface torque", "torque", at.system)
    turning = [
        o
        for o in OPERATIONS
        if np.nanmax(np.abs(table[column][table["operation [-]"] == o]), initial=0.0) > 0
    ]
    kept = np.isin(table["operation [-]"], turning)
    some = {name: values[kept] for name, values in table.items()}
    _curves(axes, some, column, size, depth)
    extra = []
    if inputs["max_surface_torque [N m]"] is not None:
        extra.append(_rig_limit(axes, inputs["max_surface_torque [N m]"] / size, "largest torque"))
    extra += _strength(axes, inputs["torque_lines"], size, depth)
    _measured(axes, inputs, "torque", size, depth, 0.0)
    axes.set_xlim(left=0)
    return _finish(drawing, axes, some, inputs, extra, depth)


def _rig_limit(axes: Any, limit: float, words: str) -> tuple[str, str, str]:
    """Draw a limit of the rig; returns its entry of the legend.

    A limit far beyond the curves is only named, so that it does not squeeze them.
    """
    if limit <= FAR_LIMIT * axes.get_xlim()[1]:
        axes.axvline(limit, color=LIMIT, linewidth=1.4)
        return LIMIT, "-", f"rig: {words}"
    return "none", "-", f"rig: {words}\n{limit:.4g}, off the picture"


def _strength(axes: Any, lines: dict[str, Any], size: float, depth: float) -> list[tuple[str, Any, str]]:
    """Draw the limits of the pipe at the rig over the bit depth; returns the entries of the legend."""
    out: list[tuple[str, Any, str]] = []
    md = np.array(lines["bit_depth [m]"], dtype=float) / depth
    largest = FAR_LIMIT * axes.get_xlim()[1]
    for key, dash, words in (
        ("make_up_torque [N m]", (0, (6, 2)), "pipe at the rig: make-up"),
        ("torque_at_yield [N m]", (0, (6, 2, 1, 2)), "pipe at the rig: yields"),
    ):
        limit = np.array(lines[key], dtype=float) / size
        if not np.isfinite(limit).any():
            continue
        if np.nanmin(limit) > largest:
            deepest = limit[np.isfinite(limit)][-1]
            out.append(("none", "-", f"{words}\n{deepest:.4g}, off the picture"))
            continue
        x, y = np.where(limit <= largest, limit, np.nan), md
        if len(md) == 1:
            x, y = np.repeat(x, 2), np.array([0.0, 1.02 * md[0]])
        else:  # no line across the depth at which another pipe comes to the rig
            other = np.flatnonzero(np.abs(np.diff(x)) > OTHER_PIPE * x[1:]) + 1
            x, y = np.insert(x, other, np.nan), np.insert(y, other, np.nan)
        axes.plot(x, y, color=LIMIT, linestyle=dash, linewidth=1.2)
        out.append((LIMIT, dash, words))
    return out


def _frame(heading: str, words: str, kind: str, system: System) -> tuple[Any, Any, float, float]:
    """(drawing, axes, size of the load's unit [SI], size of the depth's unit [m])."""
    drawing = style.sheet(9.5, 8.0, heading)
    axes = drawing.subplots()
    size, _, unit = display_unit(kind, system, plot=True)
    if system == "SI":
        size, unit = 1e3, f"k{unit}"
    depth, _, depth_unit = display_unit("length", system)
    axes.set(xlabel=f"{words} [{unit}]", ylabel=f"Bit depth (MD) [{depth_unit}]")
    drawing.subplots_adjust(left=0.095, right=0.74, bottom=0.07, top=drawing.top - 0.02)
    return drawing, axes, size, depth


def _curves(axes: Any, table: Table, column: str, size: float, depth: float) -> None:
    """A line for each operation and friction pair, marked at depths at which the string is buckled."""
    of_rows = _pair_of_rows(table)
    for pair, dash in zip(_pairs(table), DASHES * 20, strict=False):
        here = np.array([row == pair for row in of_rows])
        for operation, (_, color) in OPERATIONS.items():
            part = here & (table["operation [-]"] == operation)
            if not part.any():
                continue
            order = np.argsort(table["bit_depth [m]"][part])
            x, y = table[column][part][order] / size, table["bit_depth [m]"][part][order] / depth
            state = table["buckling_state [-]"][part][order]
            x = _without_locked(x, state == "lock_up")
            free = state != "lock_up"  # a string that is locked up has no hook load that means anything
            axes.plot(
                x[free],
                y[free],
                color=color,
                linestyle=dash,
                linewidth=1.4,
                marker="." if free.sum() == 1 else None,
            )
            for word, (marker, _) in BUCKLED.items():
                at = state == word
                if at.any():
                    axes.plot(
                        x[at], y[at], marker, color=color, markersize=4.5, fillstyle="none", linestyle=""
                    )


def _without_locked(x: np.ndarray, locked: np.ndarray) -> np.ndarray:
    """Loads (n,); for a locked-up string, the load of the nearest depth above without lock-up."""
    out = x.copy()
    for i in np.flatnonzero(locked):
        above = np.flatnonzero(~locked[:i])
        out[i] = x[above[-1]] if len(above) else np.nan
    return out


def _measured(axes: Any, inputs: dict[str, Any], key: str, size: float, depth: float, shift: float) -> None:
    """Measured points in the colour of their operation."""
    for point in inputs["measured"]:
        if point.get(key) is not None:
            color = OPERATIONS[point["operation"]][1]
            axes.plot(
                (point[key] + shift) / size,
                point["bit_depth"] / depth,
                "D",
                color=color,
                markeredgecolor="black",
                markeredgewidth=0.7,
                markersize=6,
                zorder=5,
            )


def _finish(
    drawing: Any,
    axes: Any,
    table: Table,
    inputs: dict[str, Any],
    extra: list[tuple[str, Any, str]],
    depth: float,
) -> Any:
    """Casing shoes, depth downwards, and a legend of colours, dashes and marks."""
    from matplotlib.lines import Line2D

    deepest = float(np.max(table["bit_depth [m]"])) / depth
    for shoe in inputs["casing_shoes [m]"]:
        if shoe / depth <= 1.02 * deepest:
            axes.axhline(shoe / depth, color=style.WALL, linewidth=0.9, linestyle=(0, (2, 2)))
            axes.annotate(
                "shoe",
                (1.0, shoe / depth),
                xycoords=("axes fraction", "data"),
                fontsize=7.5,
                color=style.WALL,
                ha="right",
                va="bottom",
            )
    points = [point["bit_depth"] / depth for point in inputs["measured"]]
    deepest = max(
        [deepest, *(min(md, 1.3 * deepest) for md in points)]
    )  # points below the hole are also shown
    axes.set_ylim(1.02 * deepest, 0)
    entry = partial(Line2D, [], [])
    handles = [
        entry(color=color, linewidth=1.8, label=words)
        for operation, (words, color) in OPERATIONS.items()
        if (table["operation [-]"] == operation).any()
    ]
    pairs = _pairs(table)
    handles.append(entry(linestyle="", label="\nfriction, cased / open hole"))
    handles += [
        entry(color="0.3", linestyle=dash, label=_pair_words(pair))
        for pair, dash in zip(pairs, DASHES * 20, strict=False)
    ][:12]
    handles.append(entry(linestyle="", label=""))
    handles += [entry(color=c, linestyle=dash, linewidth=1.0, label=words) for c, dash, words in extra]
    if any(shoe / depth <= 1.02 * deepest for shoe in inputs["casing_shoes [m]"]):
        handles.append(entry(color=style.WALL, linestyle=(0, (2, 2)), linewidth=0.9, label="casing shoe"))
    mark = partial(entry, linestyle="")
    handles += [
        mark(color="0.3", marker=marker, fillstyle="none", markersize=5, label=text)
        for word, (marker, text) in BUCKLED.items()
        if (table["buckling_state [-]"] == word).any()
    ]
    if inputs["measured"]:
        handles.append(mark(color="white", markeredgecolor="black", marker="D", label="measured"))
    axes.legend(handles=handles, frameon=False, fontsize=8.5, loc="upper left", bbox_to_anchor=(1.01, 1.0))
    return drawing


PICTURES: Pictures = {
    "roadmap_hook_load": ((ROADMAP_TABLE, ROADMAP_FILE), _hook_load),
    "roadmap_torque": ((ROADMAP_TABLE, ROADMAP_FILE), _torque),
    "calibration": ((CALIBRATION_TABLE,), _calibration),
    "calibration_series": ((CALIBRATION_SERIES,), _series),
}
