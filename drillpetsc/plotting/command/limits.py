"""Pictures of the command `limits`, drawn from its table: tension, torque, stress and buckling along the depth."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.output.files.json_file import read_summary
from drillpetsc.output.files.run_folder import LIMITS_TABLE, RunFolder
from drillpetsc.output.files.tables import read_table
from drillpetsc.plotting import style
from drillpetsc.plotting.style import LINE_COLORS
from drillpetsc.unit_systems import System, display_unit

Table = dict[str, np.ndarray]
LIMIT = "#b03060"  # colour of limits
DASH = (0, (5, 2))


def limits_drawers(folder: Path, title: str, system: System) -> dict[str, Callable[[], Any]]:
    """Functions that draw the limits, by the name of the picture; none if the folder has no limits.csv.

    system: units of the axes.
    """
    if not (folder / LIMITS_TABLE).exists():
        return {}
    table = read_table(folder / LIMITS_TABLE)
    if not len(table["md [m]"]):
        return {}
    summary_file = RunFolder(folder).summary
    summary = read_summary(summary_file) if summary_file.exists() else {}
    doing = str(summary.get("operation", "")).replace("_", " ")
    heading = f"{title}: limits, {doing}".rstrip(", ")
    return {"limits": lambda: _limits(table, heading, summary, system)}


def _limits(table: Table, title: str, summary: dict[str, Any], system: System) -> Any:
    """Six panels over the depth: forces, torque, stresses, buckling, side force, dogleg."""
    drawing = style.figure(13.0, 9.0, dpi=110)
    top = style.heading(drawing, title)
    grid = drawing.subplots(2, 3, sharey=True)
    length, _, unit = display_unit("length", system, plot=True)
    depth = table["md [m]"] / length
    choices = summary.get("choices") or {}

    def panel(axes: Any, kind: str, text: str, *lines: tuple[np.ndarray, str, str, Any]) -> None:
        size, name = (1.0, "") if not kind else display_unit(kind, system, plot=True)[::2]
        for values, label, color, dash in lines:
            if np.isfinite(values).any():
                axes.plot(values / size, depth, color=color, linestyle=dash, linewidth=1.4, label=label)
        axes.set_xlabel(f"{text} [{name}]" if name else text)
        if axes.get_legend_handles_labels()[0]:
            place = {"loc": "lower center", "bbox_to_anchor": (0.5, 1.0), "borderaxespad": 0.2}
            axes.legend(
                frameon=False, fontsize=8, ncols=2, columnspacing=1.2, **place
            )  # above: lines fill the panel
        else:
            place = {"transform": axes.transAxes, "ha": "center", "color": "0.4"}
            axes.text(0.5, 0.5, "not known", **place)

    blue, orange, green = LINE_COLORS[:3]
    force, buckled = table["effective_tension [N]"], table["sinusoidal_limit [N]"]
    panel(
        grid[0, 0],
        "force",
        "Tension",
        (force, "effective", blue, "-"),
        (table["axial_force [N]"], "of the wall", orange, "-"),
        (table["tension_limit [N]"], "limit", LIMIT, DASH),
    )
    grid[0, 0].axvline(0.0, color="0.35", linewidth=0.8)
    panel(
        grid[0, 1],
        "torque",
        "Torque",
        (table["torque [N m]"], "torque", blue, "-"),
        (table["torque_limit [N m]"], "limit under this tension", LIMIT, DASH),
        *(
            [(table["make_up_torque [N m]"], "make-up torque", LIMIT, (0, (1, 1.5)))]
            if "make_up_torque [N m]" in table
            else []
        ),
    )
    strong = table["yield_strength [Pa]"]
    factor = float(choices.get("design_factor", 1.0))
    panel(
        grid[0, 2],
        "stress",
        "Stress",
        (table["von_mises [Pa]"], "von Mises", blue, "-"),
        (table["worst_bending_stress [Pa]"], "bending", green, "-"),
        (strong, "yield", LIMIT, DASH),
        (strong / factor, f"yield / {factor:g}", LIMIT, (0, (1, 1.5))),
    )
    compression = np.maximum(-force, 0.0)  # nan if unknown
    helical = table["helical_limit [N]"]
    pushed = compression > 0
    for values, dash in (
        (buckled, DASH),
        (helical, (0, (1, 1.5))),
    ):  # in tension a limit is passed by nothing
        faint = np.where(pushed, np.nan, values) / display_unit("force", system, plot=True)[0]
        grid[1, 0].plot(faint, depth, color=LIMIT, linestyle=dash, linewidth=0.8, alpha=0.35)
    panel(
        grid[1, 0],
        "force",
        "Compression",
        (compression, "effective", blue, "-"),
        (np.where(pushed, buckled, np.nan), "sinusoidal limit", LIMIT, DASH),
        (
            np.where(pushed, helical, np.nan),
            f"helical limit ({choices.get('helical', 'chen')})",
            LIMIT,
            (0, (1, 1.5)),
        ),
    )
    known = helical[np.isfinite(helical)]
    if len(known):  # limits in a tight curve are far away
        size = display_unit("force", system, plot=True)[0]
        most = max(1.2 * float(np.nanmax(compression, initial=0.0)), 2.0 * float(np.median(known)))
        grid[1, 0].set_xlim(0.0, most / size)
    panel(
        grid[1, 1],
        "force",
        "Side force per joint",
        (table["side_force_per_joint [N]"], "side force", blue, "-"),
        (_limit_of_joints(table, choices), "limit for tool joints", LIMIT, DASH),
    )
    panel(
        grid[1, 2],
        "dogleg",
        "Dogleg",
        (table["curvature [1/m]"], "string", blue, "-"),
        (table["fatigue_dls [1/m]"], "permissible (fatigue)", LIMIT, DASH),
    )
    for axes in grid[:, 0]:
        axes.set_ylabel(f"Measured depth [{unit}]")
    grid[0, 0].set_ylim(float(depth.max()), min(0.0, float(depth.min())))
    _cap(grid[0, 0], table["tension_limit [N]"], table["axial_force [N]"], depth, "force", system)
    _cap(grid[0, 1], table["torque_limit [N m]"], table["torque [N m]"], depth, "torque", system)
    torque = table["torque [N m]"]
    if np.nanmin(torque, initial=0.0) > -1e-3 * np.nanmax(np.abs(torque), initial=0.0):
        most = 1.1 * float(np.nanmax(torque, initial=0.0)) / display_unit("torque", system, plot=True)[0]
        if most > 0:  # a constant torque would lie on the edge
            grid[0, 1].set_xlim(0.0, max(most, grid[0, 1].get_xlim()[1]))
    drawing.tight_layout(rect=(0, 0, 1, top))
    return drawing


def _cap(
    axes: Any, limit: np.ndarray, load: np.ndarray, depth: np.ndarray, kind: str, system: System
) -> None:
    """End an axis at 1.5 times the limit of most of the string: the limit of a short collar is far beyond."""
    known = np.isfinite(limit)
    if not known.any():
        return
    order = np.argsort(limit[known])
    share = np.cumsum(np.gradient(depth)[known][order])
    usual = limit[known][order][np.searchsorted(share, 0.5 * share[-1])]
    most = max(1.5 * float(usual), 1.1 * float(np.nanmax(load)))
    if most < float(limit[known].max()):
        axes.set_xlim(right=most / display_unit(kind, system, plot=True)[0])


def _limit_of_joints(table: Table, choices: dict[str, Any]) -> np.ndarray:
    side = table["side_force_per_joint [N]"]
    most = float(choices.get("side_force_per_joint", np.nan))
    return np.where(np.isfinite(side), most, np.nan)
