"""Pictures of `sensitivities`, a tornado of bars, and of `uncertain`, bands over the bit depth with measured points."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.output.files.run_folder import SENSITIVITIES_TABLE, UNCERTAIN_TABLE
from drillpetsc.output.files.tables import split_name
from drillpetsc.output.shown_units import key_unit, shown_unit
from drillpetsc.plotting import style
from drillpetsc.plotting.command.torque_drag import OPERATIONS
from drillpetsc.plotting.source import Pictures, Source, Table
from drillpetsc.plotting.style import LINE_COLORS
from drillpetsc.unit_systems import System, display_unit

MOST_BARS, MOST_PANELS = 12, 6
UP, DOWN = LINE_COLORS[0], LINE_COLORS[1]


def _short(table: Table) -> Table:
    """A table with columns by their names without units."""
    return {split_name(title)[0]: values for title, values in table.items()}


def _tornado(at: Source) -> Any:
    """A panel for each output at the deepest bit depth, in units of the axes; None if no key has an effect."""
    table, system = _short(at.table(SENSITIVITIES_TABLE)), at.system
    effect = np.asarray(table["effect"], dtype=float)
    if not np.any(np.nan_to_num(effect)):
        return None
    depth = np.asarray(table["bit_depth"], dtype=float)
    deepest = np.ones(len(depth), dtype=bool)
    if np.isfinite(depth).any():
        deepest = depth == np.nanmax(depth)
    names = [
        n
        for n in dict.fromkeys(table["output"][deepest].astype(str))
        if _bars(table, effect, deepest, n).size
    ]
    names = names[:MOST_PANELS]
    rows = -(-len(names) // 2) if len(names) > 1 else 1
    bars = max(_bars(table, effect, deepest, name).size for name in names)
    heading = f"{at.title}: effect of a change of each key"
    drawing = style.sheet(13.0 if len(names) > 1 else 8.5, 1.2 + rows * (1.1 + 0.34 * bars), heading)
    grid = drawing.subplots(rows, min(len(names), 2), squeeze=False)
    for axes, name in zip(grid.flat, names, strict=False):
        _panel(axes, table, effect, _bars(table, effect, deepest, name), system)
    for axes in list(grid.flat)[len(names) :]:
        axes.set_visible(False)
    return drawing.fitted()


def _bars(table: Table, effect: np.ndarray, chosen: np.ndarray, name: str) -> np.ndarray:
    """Rows of the bars of an output, the largest effect first."""
    mine = np.flatnonzero(
        chosen & (table["output"].astype(str) == name) & (effect != 0) & np.isfinite(effect)
    )
    return mine[np.argsort(-np.abs(effect[mine]))][:MOST_BARS]


def _panel(axes: Any, table: Table, effect: np.ndarray, rows: np.ndarray, system: System) -> None:
    output = str(table["output"][rows[0]])
    size, unit = shown_unit(output.rpartition(".")[2], str(table["output_unit"][rows[0]]), system, plot=True)
    values = effect[rows] / size
    labels = []
    for i in rows:
        step, word = key_unit(str(table["key"][i]), str(table["key_unit"][i]), system)
        flag = " *" if str(table["flag"][i]) not in ("", "-") else ""
        labels.append(f"{table['key'][i]}  + {float(table['per'][i]) / step:.3g} {word}".rstrip() + flag)
    place = np.arange(len(rows))
    axes.barh(place, values, color=[UP if v > 0 else DOWN for v in values], height=0.7)
    axes.axvline(0.0, color="0.35", linewidth=0.8)
    axes.set_yticks(place, labels, fontsize=8.5)
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.margins(x=0.18)
    for y, value in zip(place, values, strict=True):
        side = "left" if value > 0 else "right"
        axes.annotate(
            f"{value:+.3g}", (value, y), (3 if value > 0 else -3, 0), textcoords="offset points",
            va="center", ha=side, fontsize=8,
        )  # fmt: skip
    present = float(table["value"][rows[0]]) / size
    words = output.replace("_", " ").replace(".", ", ")
    axes.set_xlabel(f"{words}: change from {present:.5g} {unit} [{unit or '-'}]", fontsize=9)
    if any(label.endswith("*") for label in labels):
        axes.text(1.0, 0.02, "* flagged", transform=axes.transAxes, ha="right", fontsize=7.5, color="0.4")


LEAST_DEPTHS = 2  # of a band


def _bands(at: Source) -> Any:
    """A panel for each quantity, with a band for each operation from the lowest to the highest quantile; None at one depth only."""
    table, summary, system = _short(at.table(UNCERTAIN_TABLE)), at.summary, at.system
    depth = np.asarray(table["bit_depth"], dtype=float)
    if len(np.unique(depth[np.isfinite(depth)])) < LEAST_DEPTHS:
        return None
    outputs = table["output"].astype(str)
    names = list(dict.fromkeys(q.rpartition(".")[2] for q in outputs))
    levels = summary["levels"]
    low, high = (f"P{100 * levels[i]:.4g}" for i in (0, -1))
    drawing = style.sheet(6.5 * len(names), 7.5, f"{at.title}: {low} to {high}, {summary['samples']} samples")
    panels = drawing.subplots(1, len(names), sharey=True, squeeze=False)[0]
    length, _, unit = display_unit("length", system)
    for axes, name in zip(panels, names, strict=True):
        rows = np.array([q.rpartition(".")[2] == name for q in outputs])
        size, word = shown_unit(name, str(table["output_unit"][rows][0]), system, plot=True)
        for operation, (text, color) in OPERATIONS.items():
            mine = rows & (outputs == f"{operation}.{name}") & (table["method"] == table["method"][0])
            if np.any(np.asarray(table["quantile"], dtype=float)[mine] != 0.0):  # a trip has no torque
                _band(axes, table, mine, levels, (size, length), text, color)
            for point in summary["measured"]:
                if (point["operation"], point["output"]) == (operation, name):
                    axes.plot(
                        point["measured"] / size,
                        point["bit_depth"] / length,
                        "o",
                        color=color,
                        mfc=color if point["inside"] else "white",
                        markersize=4,
                    )
        inside = [point["inside"] for point in summary["measured"] if point["output"] == name]
        if inside:
            said = f"{sum(inside)} of {len(inside)} points inside"
            axes.text(0.02, 0.02, said, transform=axes.transAxes, fontsize=8.5)
        axes.set_xlabel(f"{name.replace('_', ' ')} [{word or '-'}]")
        axes.legend(fontsize=8.5)
    panels[0].set_ylabel(f"bit depth [{unit}]")
    panels[0].invert_yaxis()
    return drawing.fitted()


def _band(
    axes: Any,
    table: Table,
    rows: np.ndarray,
    levels: list[float],
    sizes: tuple[float, float],
    text: str,
    color: str,
) -> None:
    """Band of an output, and the quantile in its middle.  sizes: of the units of the output and of depth [SI]."""
    depth = np.asarray(table["bit_depth"], dtype=float)[rows] / sizes[1]
    value = np.asarray(table["quantile"], dtype=float)[rows].reshape(-1, len(levels)) / sizes[0]
    depth = depth.reshape(-1, len(levels))[:, 0]
    axes.fill_betweenx(depth, value[:, 0], value[:, -1], color=color, alpha=0.25, linewidth=0)
    axes.plot(value[:, len(levels) // 2], depth, color=color, label=text)


PICTURES: Pictures = {
    "tornado": ((SENSITIVITIES_TABLE,), _tornado),
    "uncertain": ((UNCERTAIN_TABLE,), _bands),
}
