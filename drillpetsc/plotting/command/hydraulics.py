"""Pictures of the commands `hydraulics` and `surge`, drawn from their tables and summary."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import Any

import numpy as np

from drillpetsc.output.files.run_folder import (
    FITS_TABLE,
    FLOW_CURVE_TABLE,
    LOSS_TABLE,
    PROFILE_TABLE,
    READINGS_TABLE,
    SURGE_TABLE,
    TRIP_SPEED_TABLE,
)
from drillpetsc.output.files.tables import split_name
from drillpetsc.output.quantities.tables import COLUMNS
from drillpetsc.output.shown_units import shown_unit
from drillpetsc.plotting import style
from drillpetsc.plotting.source import Pictures, Source, Table
from drillpetsc.plotting.style import LINE_COLORS, words
from drillpetsc.unit_systems import System

MOST_PROFILES = 4  # flow rates in the picture of the profile
WINDOW: dict[str, dict[str, Any]] = {
    "pore": {"color": "#b03060", "linestyle": (0, (3, 1.5)), "label": "pore limit"},
    "frac": {"color": "#b03060", "linestyle": "-", "label": "fracture limit"},
}
OPERATIONS = {"trip_in": "running in", "trip_out": "pulling out"}
DASHES = {"closed": "-", "open": (0, (5, 2)), "pumping": (0, (1, 1.2))}


class _Axis:
    """A column in the unit of its axis."""

    def __init__(self, title: str, system: System) -> None:
        self.title = title
        name, unit = split_name(title)
        self.size, self.unit = shown_unit(name, unit, system)

    def values(self, table: Table) -> np.ndarray:
        return np.asarray(table[self.title]) / self.size

    def label(self, text: str = "") -> str:
        head = text or words(self.title)
        return f"{head} [{self.unit}]" if self.unit else head


def _flow_curve(at: Source) -> Any:
    """Pump pressure and equivalent densities over the flow rate, with the flow rates requested."""
    table, system = at.table(FLOW_CURVE_TABLE), at.system
    flow, pressure = _Axis("pump_flow [m3/s]", system), _Axis("pump_pressure [Pa]", system)
    densities = [
        (_Axis(f"{name} [kg/m3]", system), words)
        for name, words in (("ecd_bit", "bit"), ("ecd_shoe", "casing shoe"), ("ecd_td", "end of the hole"))
        if np.isfinite(table[f"{name} [kg/m3]"]).any()
    ]
    drawing = style.sheet(
        11.0 if densities else 6.5, 4.6, f"{at.title}: pressure and density against flow rate"
    )
    grid = drawing.subplots(1, 2 if densities else 1, squeeze=False)[0]
    x, asked = flow.values(table), [row["pump_flow"] / flow.size for row in at.summary.get("flows", ())]
    grid[0].plot(x, pressure.values(table), color=LINE_COLORS[0], linewidth=1.6)
    grid[0].plot(asked, np.interp(asked, x, pressure.values(table)), "o", color=LINE_COLORS[0], markersize=5)
    grid[0].set(xlabel=flow.label(), ylabel=pressure.label("Pump pressure"), ylim=(0, None), xlim=(0, None))
    drawn: list[np.ndarray] = []
    for (axis, name), color in zip(densities, LINE_COLORS, strict=False):
        y = axis.values(table)
        if any(np.allclose(y, other, rtol=1e-4) for other in drawn):
            continue  # the bit at the end of the hole
        drawn.append(y)
        grid[1].plot(x, y, color=color, linewidth=1.6, label=name)
        grid[1].plot(asked, np.interp(asked, x, y), "o", color=color, markersize=5)
    if densities:
        grid[1].set(
            xlabel=flow.label(),
            ylabel=densities[0][0].label("Equivalent circulating density"),
            xlim=(0, None),
        )
        grid[1].legend(frameon=False)
        grid[1].ticklabel_format(axis="y", useOffset=False)
    return drawing.fitted()


def _losses(at: Source) -> Any:
    """Stacked losses of each flow rate requested; a column that drives the flow is below zero."""
    flows, system = at.summary.get("flows", ()), at.system
    if not flows:
        return None
    rate, pressure = _Axis("pump_flow [m3/s]", system), _Axis("pump_pressure [Pa]", system)
    drawing = style.sheet(max(5.5, 3.6 + 0.9 * len(flows)), 5.0, f"{at.title}: pressure losses")
    axes = drawing.subplots()
    place = np.arange(len(flows))
    up, down = np.zeros(len(flows)), np.zeros(len(flows))
    largest = max(abs(row["pump_pressure"]) for row in flows) / pressure.size
    colors = (*LINE_COLORS[:2], "#2b8f8f", *LINE_COLORS[2:], "#7f7f7f")
    for q, color in zip((*COLUMNS["losses"], *COLUMNS["levels"]), colors, strict=True):
        values = np.array([row.get(q.name) or 0.0 for row in flows]) / pressure.size
        if not (np.abs(values) > 1e-3 * largest).any():
            continue
        bottom = np.where(values >= 0, up, down)
        axes.bar(place, values, 0.6, bottom=bottom, color=color, label=q.label)
        up, down = up + np.maximum(values, 0), down + np.minimum(values, 0)
    total = [row["pump_pressure"] / pressure.size for row in flows]
    axes.hlines(
        total, place - 0.36, place + 0.36, color="black", linewidth=1.6, label="Pump pressure", zorder=3
    )
    axes.axhline(0.0, color="0.35", linewidth=0.8)
    axes.set_xticks(place, [f"{row['pump_flow'] / rate.size:.4g}" for row in flows])
    axes.set(xlabel=rate.label(), ylabel=pressure.label("Pressure"), xlim=(-0.7, len(flows) - 0.3))
    axes.legend(frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return drawing.fitted()


def _profile(at: Source) -> Any:
    """Pressures over measured depth; densities over vertical depth, with the limits of the window.

    Of many flow rates the smallest, the largest and two between are drawn.
    """
    table, system = at.table(PROFILE_TABLE), at.system
    depth, rate = _Axis("md [m]", system), _Axis("pump_flow [m3/s]", system)
    wet = np.isfinite(table["ecd [kg/m3]"]).any()
    drawing = style.sheet(11.5 if wet else 6.0, 7.0, f"{at.title}: pressure along the depth")
    grid = drawing.subplots(1, 2 if wet else 1, squeeze=False)[0]
    flows = np.unique(rate.values(table))
    flows = flows[np.unique(np.linspace(0, len(flows) - 1, MOST_PROFILES).round().astype(int))]
    for flow, color in zip(flows, LINE_COLORS, strict=False):
        part = rate.values(table) == flow
        for name, dash in (("internal", "-"), ("annulus", (0, (5, 2)))):
            pressure = _Axis(f"{name}_pressure [Pa]", system)
            values = pressure.values(table)[part]
            text = f"{flow:.4g} {rate.unit}" if name == "internal" else None
            if np.isfinite(values).any():
                grid[0].plot(values, depth.values(table)[part], color=color, linestyle=dash, label=text)
        grid[0].set_xlabel(pressure.label("Pressure (solid: bore, dashed: annulus)" if wet else "Pressure"))
    grid[0].set(ylabel=depth.label(), ylim=(np.nanmax(depth.values(table)), 0.0))
    grid[0].legend(frameon=False, fontsize=8, loc="lower left")
    if wet:
        _densities(grid[1], table, flows * rate.size, at.summary, system)
    return drawing.fitted()


def _densities(axes: Any, table: Table, flows: np.ndarray, summary: dict[str, Any], system: System) -> None:
    """Draw equivalent densities over vertical depth. flows: flow rates to draw [m3/s]."""
    tvd, density, static = (
        _Axis("tvd [m]", system),
        _Axis("ecd [kg/m3]", system),
        _Axis("esd [kg/m3]", system),
    )
    rate = _Axis("pump_flow [m3/s]", system)
    deepest = float(np.nanmax(tvd.values(table)))
    shown: list[float] = _limits(summary, density.size)
    for flow, color in zip(flows, LINE_COLORS, strict=False):
        part = np.isclose(table["pump_flow [m3/s]"], flow, rtol=1e-9)
        x, y = density.values(table)[part], tvd.values(table)[part]
        axes.plot(x, y, color=color, label=f"{flow / rate.size:.4g} {rate.unit}")
        still = static.values(table)[part]
        shown += [*x[y > 0.05 * deepest], *still[y > 0.05 * deepest]]  # at the top a small height divides
    axes.plot(still, y, color="0.4", linewidth=1.0, label="still mud")
    shoe = summary.get("shoe_tvd")
    _window(axes, summary, density.size, tvd.size, deepest, (shoe or 0.0) / tvd.size)
    low, high = float(np.nanmin(shown)), float(np.nanmax(shown))
    pad = 0.05 * (high - low) + 1e-3 * high
    axes.set(xlabel=density.label("Equivalent density"), ylabel=tvd.label(), ylim=(deepest, 0.0))
    axes.set_xlim(low - pad, high + pad)
    if shoe is not None:
        axes.axhline(shoe / tvd.size, color="0.6", linewidth=0.9, linestyle=(0, (6, 3)))
        place = {"xycoords": ("axes fraction", "data"), "ha": "right", "va": "bottom", "fontsize": 8}
        axes.annotate("casing shoe", (1.0, shoe / tvd.size), **place)
    axes.legend(frameon=False, fontsize=8, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    axes.ticklabel_format(axis="x", useOffset=False)


def _limits(summary: dict[str, Any], size: float) -> list[float]:
    window = summary.get("window") or {}
    return [value / size for key in ("pore", "frac") for value in window.get(key, ())]


def _window(
    axes: Any, summary: dict[str, Any], density: float, depth: float, deepest: float, shoe: float
) -> None:
    """Draw pore and fracture limits, faint behind casing.

    density, depth: sizes of the units; deepest: end of the hole, shoe: of the casing, in the unit of the axis.
    """
    window = summary.get("window")
    if not window:
        return
    for key, look in WINDOW.items():
        tvd = np.array(window["tvd"] or [0.0, deepest * depth]) / depth
        values = np.array(window[key] if window["tvd"] else window[key] * 2) / density
        axes.plot(values, tvd, **(look | {"linewidth": 1.0, "alpha": 0.35, "label": None}))
        below = np.unique([shoe, *tvd[tvd > shoe]])
        axes.plot(np.interp(below, tvd, values), below, linewidth=1.6, **look)


def _rheology(at: Source) -> Any:
    """Dial readings as stress over shear rate, with the flow curves that fit them; the one in use is thick."""
    readings, fits, system = at.table(READINGS_TABLE), at.table(FITS_TABLE), at.system
    rate, stress = _Axis("shear_rate [1/s]", system), _Axis("shear_stress [Pa]", system)
    drawing = style.sheet(8.5, 5.2, f"{at.title}: flow curves of the mud")
    axes = drawing.subplots()
    x = np.linspace(0.0, 1.05 * float(readings["shear_rate [1/s]"].max()), 200)
    for i in range(len(fits["model [-]"])):
        y, k, n = (float(fits[q][i]) for q in ("yield_stress [Pa]", "consistency [Pa s^n]", "index [-]"))
        used = fits["used [-]"][i] == "yes"
        name = f"{fits['model [-]'][i]}, {fits['fit [-]'][i]}".replace("_", " ")
        name += f": misfit {float(fits['misfit [Pa]'][i]) / stress.size:.2g} {stress.unit}"
        color = LINE_COLORS[i % len(LINE_COLORS)]
        wide = {"linewidth": 2.4} if used else {"linewidth": 1.0, "linestyle": (0, (5, 2))}
        axes.plot(
            x / rate.size, (y + k * x**n) / stress.size, color=color, label=name + " (used)" * used, **wide
        )
    axes.plot(
        rate.values(readings), stress.values(readings), "ko", markersize=5, label="dial readings", zorder=4
    )
    axes.set(xlabel=rate.label(), ylabel=stress.label(), xlim=(0, None), ylim=(0, None))
    axes.legend(frameon=False, fontsize=8)
    return drawing.fitted()


def _surge(at: Source) -> Any:
    """Surge pressure and density at the bit over the speed, a line for each operation, pipe and bit depth."""
    table, system = at.table(SURGE_TABLE), at.system
    speed, pressure = _Axis("trip_speed [m/s]", system), _Axis("surge_pressure [Pa]", system)
    density, depth = _Axis("ecd_bit [kg/m3]", system), _Axis("bit_depth [m]", system)
    start = _Axis("dynamic_surge_pressure [Pa]", system)
    drawing = style.sheet(11.0, 5.0, f"{at.title}: surge and swab")
    grid = drawing.subplots(1, 2)
    depths = list(dict.fromkeys(table["bit_depth [m]"]))
    for k, md in enumerate(depths):
        at_depth = {title: values[table[depth.title] == md] for title, values in table.items()}
        for number, look, rows in _trips(at_depth, speed):
            look["label"] += f", bit at {md / depth.size:.5g} {depth.unit}" if len(depths) > 1 else ""
            look["color"] = LINE_COLORS[(2 * k + number) % len(LINE_COLORS)]
            for axes, column in ((grid[0], pressure), (grid[1], density)):
                axes.plot(speed.values(rows), column.values(rows), **look)
            if start.title in table:
                grid[0].plot(speed.values(rows), start.values(rows), "x", color=look["color"])
    for axes, column in ((grid[0], pressure), (grid[1], density)):
        axes.set(xlabel=speed.label(), ylabel=column.label(), xlim=(0, None))
        axes.ticklabel_format(axis="y", useOffset=False)
    if start.title in table:
        grid[1].plot([], [], "x", color="0.35", label="left: while the string starts")
    grid[0].axhline(0.0, color="0.35", linewidth=0.8)
    window = at.summary.get("window") or {}
    if window and not window.get("tvd"):
        for key, look in WINDOW.items():
            grid[1].axhline(window[key][0] / density.size, **look)
    grid[1].legend(frameon=False, fontsize=8, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return drawing.fitted()


def _trips(table: Table, along: _Axis) -> Iterator[tuple[int, dict[str, Any], Table]]:
    """The operations with each pipe, of which there are rows: number of the operation, look of the line, rows in the order of a column."""
    for (number, operation), (pipe, dash) in product(enumerate(OPERATIONS), DASHES.items()):
        part = np.flatnonzero((table["operation [-]"] == operation) & (table["pipe [-]"] == pipe))
        part = part[np.argsort(table[along.title][part])]
        if len(part):
            look = {"marker": ".", "linestyle": dash, "label": f"{OPERATIONS[operation]}, {pipe}"}
            yield number, look, {title: values[part] for title, values in table.items()}


def _trip_speeds(at: Source) -> Any:
    """Largest trip speed over the depth of the bit."""
    table, system = at.table(TRIP_SPEED_TABLE), at.system
    speed, depth = _Axis("max_trip_speed [m/s]", system), _Axis("bit_depth [m]", system)
    drawing = style.sheet(7.5, 6.5, f"{at.title}: largest trip speed within the window")
    axes = drawing.subplots()
    for number, look, rows in _trips(table, depth):
        axes.plot(speed.values(rows), depth.values(rows), color=LINE_COLORS[number], **look)
    free = np.isin(table["limited_by [-]"], ("none", "-"))
    if free.any():
        x, y = speed.values(table)[free], depth.values(table)[free]
        axes.plot(
            x,
            y,
            ">",
            color="0.25",
            markersize=9,
            fillstyle="none",
            zorder=1,
            label="no limit up to this speed",
        )
    slowest, fastest = (float(pick(speed.values(table))) for pick in (np.nanmin, np.nanmax))
    left = max(slowest - 0.25 * (fastest - slowest), 0.0) if slowest > 0.3 * fastest else 0.0
    right = fastest + 0.05 * max(fastest - left, 1e-9)
    axes.set(xlabel=speed.label(), ylabel=depth.label("Bit depth"), xlim=(left, right))
    axes.invert_yaxis()
    axes.legend(frameon=False, fontsize=8)
    return drawing.fitted()


PICTURES: Pictures = {
    "flow_curve": ((FLOW_CURVE_TABLE,), _flow_curve),
    "losses": ((LOSS_TABLE,), _losses),
    "pressure_profile": ((PROFILE_TABLE,), _profile),
    "rheology": ((FITS_TABLE, READINGS_TABLE), _rheology),
    "surge": ((SURGE_TABLE,), _surge),
    "max_trip_speed": ((TRIP_SPEED_TABLE,), _trip_speeds),
}
