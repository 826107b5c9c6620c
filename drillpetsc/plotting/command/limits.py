"""Pictures of the command `limits`, drawn from its table: tension, torque, stress and buckling along the depth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from drillpetsc.output.files.run_folder import LIMITS_TABLE
from drillpetsc.plotting import style
from drillpetsc.plotting.source import Pictures, Source, Table
from drillpetsc.plotting.style import LINE_COLORS
from drillpetsc.unit_systems import System, display_unit

LIMIT = "#b03060"  # colour of limits
DASH, DOTS = (0, (5, 2)), (0, (1, 1.5))
BLUE, ORANGE, GREEN = LINE_COLORS[:3]


@dataclass(frozen=True)
class _Track:
    """One panel over the depth (n,), in units of the axes.

    kind: of the quantity, as in ``display_unit``; empty without a unit.
    """

    axes: Any
    kind: str
    depth: np.ndarray
    system: System

    @property
    def size(self) -> float:
        """Unit of the axis in SI."""
        return display_unit(self.kind, self.system, plot=True)[0] if self.kind else 1.0

    def draw(self, text: str, *lines: tuple[np.ndarray, str, str, Any]) -> None:
        """Draw lines (values (n,) in SI, label, colour, dashes) under one label of the axis."""
        axes, name = self.axes, display_unit(self.kind, self.system, plot=True)[2] if self.kind else ""
        for values, label, color, dash in lines:
            if np.isfinite(values).any():
                axes.plot(
                    values / self.size, self.depth, color=color, linestyle=dash, linewidth=1.4, label=label
                )
        axes.set_xlabel(f"{text} [{name}]" if name else text)
        if axes.get_legend_handles_labels()[0]:  # above the panel, since lines fill it
            place = {"loc": "lower center", "bbox_to_anchor": (0.5, 1.0), "borderaxespad": 0.2}
            axes.legend(frameon=False, fontsize=8, ncols=2, columnspacing=1.2, **place)
        else:
            axes.text(0.5, 0.5, "not known", transform=axes.transAxes, ha="center", color="0.4")


def _limits(at: Source) -> Any:
    """Six panels over the depth: forces, torque, stresses, buckling, side force, dogleg."""
    table, summary, system = at.table(LIMITS_TABLE), at.summary, at.system
    if not len(table["md [m]"]):
        return None
    doing = str(summary.get("operation", "")).replace("_", " ")
    drawing = style.sheet(13.0, 9.0, f"{at.title}: limits, {doing}".rstrip(", "))
    grid = drawing.subplots(2, 3, sharey=True)
    length, _, unit = display_unit("length", system, plot=True)
    depth = table["md [m]"] / length
    choices = summary.get("choices") or {}
    kinds = ("force", "torque", "stress", "force", "force", "dogleg")
    tension, torque, stress, push, side, dogleg = (
        _Track(axes, kind, depth, system) for axes, kind in zip(grid.flat, kinds, strict=True)
    )
    tension.draw(
        "Tension",
        (table["effective_tension [N]"], "effective", BLUE, "-"),
        (table["axial_force [N]"], "of the wall", ORANGE, "-"),
        (table["tension_limit [N]"], "limit", LIMIT, DASH),
    )
    tension.axes.axvline(0.0, color="0.35", linewidth=0.8)
    made_up = table.get("make_up_torque [N m]")
    torque.draw(
        "Torque",
        (table["torque [N m]"], "torque", BLUE, "-"),
        (table["torque_limit [N m]"], "limit under this tension", LIMIT, DASH),
        *([(made_up, "make-up torque", LIMIT, DOTS)] if made_up is not None else []),
    )
    strong = table["yield_strength [Pa]"]
    factor = float(choices.get("design_factor", 1.0))
    stress.draw(
        "Stress",
        (table["von_mises [Pa]"], "von Mises", BLUE, "-"),
        (table["worst_bending_stress [Pa]"], "bending", GREEN, "-"),
        (strong, "yield", LIMIT, DASH),
        (strong / factor, f"yield / {factor:g}", LIMIT, DOTS),
    )
    _draw_compression(push, table, str(choices.get("helical", "chen")))
    side.draw(
        "Side force per joint",
        (table["side_force_per_joint [N]"], "side force", BLUE, "-"),
        (_limit_of_joints(table, choices), "limit for tool joints", LIMIT, DASH),
    )
    dogleg.draw(
        "Dogleg",
        (table["curvature [1/m]"], "string", BLUE, "-"),
        (table["fatigue_dls [1/m]"], "permissible (fatigue)", LIMIT, DASH),
    )
    for axes in grid[:, 0]:
        axes.set_ylabel(f"Measured depth [{unit}]")
    tension.axes.set_ylim(float(depth.max()), min(0.0, float(depth.min())))
    _cap(tension, table["tension_limit [N]"], table["axial_force [N]"])
    _cap(torque, table["torque_limit [N m]"], table["torque [N m]"])
    turned = table["torque [N m]"]
    if np.nanmin(turned, initial=0.0) > -1e-3 * np.nanmax(np.abs(turned), initial=0.0):
        most = 1.1 * float(np.nanmax(turned, initial=0.0)) / torque.size
        if most > 0:  # a constant torque would lie on the edge
            torque.axes.set_xlim(0.0, max(most, torque.axes.get_xlim()[1]))
    return drawing.fitted()


def _draw_compression(track: _Track, table: Table, law: str) -> None:
    """Compression beside both buckling limits, which are faint where the string is in tension; law: of the helical limit."""
    sinusoidal, helical = table["sinusoidal_limit [N]"], table["helical_limit [N]"]
    compression = np.maximum(-table["effective_tension [N]"], 0.0)  # nan if unknown
    pushed = compression > 0
    for values, dash in ((sinusoidal, DASH), (helical, DOTS)):  # in tension a limit is passed by nothing
        faint = np.where(pushed, np.nan, values) / track.size
        track.axes.plot(faint, track.depth, color=LIMIT, linestyle=dash, linewidth=0.8, alpha=0.35)
    track.draw(
        "Compression",
        (compression, "effective", BLUE, "-"),
        (np.where(pushed, sinusoidal, np.nan), "sinusoidal limit", LIMIT, DASH),
        (np.where(pushed, helical, np.nan), f"helical limit ({law})", LIMIT, DOTS),
    )
    known = helical[np.isfinite(helical)]
    if len(known):  # limits in a tight curve are far away
        most = max(1.2 * float(np.nanmax(compression, initial=0.0)), 2.0 * float(np.median(known)))
        track.axes.set_xlim(0.0, most / track.size)


def _cap(track: _Track, limit: np.ndarray, load: np.ndarray) -> None:
    """End an axis at 1.5 times the limit of most of the string: the limit of a short collar is far beyond."""
    known = np.isfinite(limit)
    if not known.any():
        return
    order = np.argsort(limit[known])
    share = np.cumsum(np.gradient(track.depth)[known][order])
    usual = limit[known][order][np.searchsorted(share, 0.5 * share[-1])]
    most = max(1.5 * float(usual), 1.1 * float(np.nanmax(load)))
    if most < float(limit[known].max()):
        track.axes.set_xlim(right=most / track.size)


def _limit_of_joints(table: Table, choices: dict[str, Any]) -> np.ndarray:
    side = table["side_force_per_joint [N]"]
    most = float(choices.get("side_force_per_joint", np.nan))
    return np.where(np.isfinite(side), most, np.nan)


PICTURES: Pictures = {"limits": ((LIMITS_TABLE,), _limits)}
