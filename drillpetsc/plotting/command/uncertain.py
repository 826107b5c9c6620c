"""Picture of the command `uncertain`: bands of a roadmap over the bit depth, with measured points."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.output.files.json_file import read_summary
from drillpetsc.output.files.run_folder import UNCERTAIN_TABLE
from drillpetsc.output.files.tables import read_table
from drillpetsc.output.shown_units import shown_unit
from drillpetsc.plotting import style
from drillpetsc.plotting.command.torque_drag import OPERATIONS
from drillpetsc.unit_systems import System, display_unit

LEAST_DEPTHS = 2  # of a band


def uncertain_drawers(folder: Path, title: str, system: System) -> dict[str, Callable[[], Any]]:
    """A function that draws the bands; none without uncertain.csv, or with rows at one depth only."""
    if not (folder / UNCERTAIN_TABLE).exists():
        return {}
    table = {name.partition(" [")[0]: values for name, values in read_table(folder / UNCERTAIN_TABLE).items()}
    depth = np.asarray(table["bit_depth"], dtype=float)
    if len(np.unique(depth[np.isfinite(depth)])) < LEAST_DEPTHS:
        return {}
    summary = read_summary(folder / "summary.json")
    return {"uncertain": lambda: _bands(table, summary, title, system)}


def _bands(table: dict[str, np.ndarray], summary: dict[str, Any], title: str, system: System) -> Any:
    """A panel for each quantity, with a band for each operation from the lowest to the highest quantile."""
    outputs = table["output"].astype(str)
    names = list(dict.fromkeys(q.rpartition(".")[2] for q in outputs))
    levels = summary["levels"]
    low, high = (f"P{100 * levels[i]:.4g}" for i in (0, -1))
    drawing = style.sheet(6.5 * len(names), 7.5, f"{title}: {low} to {high}, {summary['samples']} samples")
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
    table: dict[str, np.ndarray],
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
