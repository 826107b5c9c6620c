"""Labels, displayed units and colours. No plotting package is imported at module level."""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.output import catalogue
from drillpetsc.output.files.tables import split_name
from drillpetsc.output.shown_units import unit_of
from drillpetsc.unit_systems import System, system_named
from drillpetsc.unit_systems import display_unit as unit_in

UNITS: ContextVar[System | None] = ContextVar("UNITS", default=None)
"""Unit system of a picture; None: metric units of a size that fits the values."""
_OUTPUT_UNITS = re.compile(r"^output:.*?^  units: (\w+)$", re.MULTILINE | re.DOTALL)

# unit -> displayed units in ascending order: (text, size in SI); the last one not above the values is used
STEPS: dict[str, list[tuple[str, float]]] = {
    "N": [("N", 1.0), ("kN", 1e3), ("MN", 1e6)],
    "N m": [("N m", 1.0), ("kN m", 1e3)],
    "N/m": [("N/m", 1.0), ("kN/m", 1e3)],
    "Pa": [("Pa", 1.0), ("kPa", 1e3), ("MPa", 1e6)],
    "J": [("J", 1.0), ("kJ", 1e3), ("MJ", 1e6)],
    "W": [("W", 1.0), ("kW", 1e3)],
    "m": [("mm", 1e-3), ("m", 1.0)],
    "s": [("ms", 1e-3), ("s", 1.0)],
    "rad/s": [("rpm", math.pi / 30)],
    "m3/s": [("l/min", 1e-3 / 60)],
    "m/s": [("mm/s", 1e-3), ("m/s", 1.0)],
    "-": [("", 1.0)],
}
FIXED = {"rop": ("m/h", 1 / 3600), "step": ("ms", 1e-3)}
DEPTHS = ("md", "tvd", "bit_depth", "hole_depth", "north", "east", "time")  # never in mm or ms

# unit -> size in SI below which all values of a quantity are rounding
NOISE = {
    "N": 1e-4,
    "N m": 1e-4,
    "N/m": 1e-6,
    "Pa": 1e-2,
    "J": 1e-6,
    "W": 1e-6,
    "m": 1e-9,
    "rad": 1e-9,
    "rad/s": 1e-9,
    "m/s": 1e-9,
    "m3/s": 1e-12,
    "1/m": 1e-12,
}

LINE_COLORS = ("#1f5fa8", "#c8501e", "#3a8a4d", "#7d4fa0", "#8a6d1f", "#b03060")
GROUND = "#e9e3d8"
WALL = "#6b5b45"


def display_unit(title: str, values: Any) -> tuple[float, str]:
    """How to show a column: (divide by, unit text). title: "wob [N]"; values: array [SI]."""
    name, unit = split_name(title)
    system = UNITS.get()
    if system is not None:
        size, zero, text = unit_of(title, system, plot=True)
        return (size, text) if zero == 0.0 else (1.0, unit)
    if name in FIXED:
        text, size = FIXED[name]
        return size, text
    if name in DEPTHS or unit not in STEPS:
        return 1.0, "" if unit == "-" else unit
    finite = np.abs(np.asarray(values, dtype=float))
    finite = finite[np.isfinite(finite)]
    largest = float(finite.max()) if finite.size else 0.0
    steps = STEPS[unit]
    if largest == 0.0:
        text, size = next((step for step in steps if step[1] == 1.0), steps[0])
        return size, text
    fitting = [step for step in steps if step[1] <= largest * 1.0000001] or steps[:1]
    return fitting[-1][1], fitting[-1][0]


def depth_unit() -> tuple[float, str]:
    """How to show depths and distances: (divide by, unit text)."""
    size, _, text = unit_in("length", system())
    return size, text


def lateral_unit(half: float) -> tuple[float, str]:
    """How to show lateral distances: (divide by, unit text). half: the largest [m]."""
    system = UNITS.get()
    if half >= 5:
        return depth_unit()
    if system is None:
        return 1e-3, "mm"
    size, _, text = unit_in("diameter", system)
    return size, text


def show_in(axis: Any, size: float) -> None:
    """Let an axis whose data are in m show them in a unit of another size [m]: round numbers of that unit."""
    if size == 1.0:
        return
    from matplotlib.ticker import FuncFormatter, MaxNLocator

    class Scaled(MaxNLocator):
        def tick_values(self, vmin: float, vmax: float) -> Any:
            return np.asarray(super().tick_values(vmin / size, vmax / size)) * size

    axis.set_major_locator(Scaled(7, steps=[1, 2, 2.5, 5, 10]))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{round(value / size, 6):g}"))


@contextmanager
def in_units(system: System | None) -> Iterator[None]:
    """Draw in a system of units, None: in metric units of a size that fits the values."""
    token = UNITS.set(system)
    try:
        yield
    finally:
        UNITS.reset(token)


@contextmanager
def of_case(case: Path, system: System | None = None) -> Iterator[None]:
    """Draw in this style, in a system of units; None: that of the run's case."""
    with in_units(system or units_of_run(case)), look():
        yield


def system() -> System:
    """Unit system of the picture; metric by default."""
    return UNITS.get() or "metric"


def units_of_run(case: Path) -> System | None:
    """Unit system of the case of a run for plots; None if it has none.

    case: the case.yaml of a run folder, which the program has written
    """
    found = _OUTPUT_UNITS.search(case.read_text(encoding="utf-8")) if case.is_file() else None
    return system_named(found.group(1)) if found else None


def words(title: str) -> str:
    """ "surface_torque [N m]" as a label: "Surface torque"."""
    name, _ = split_name(title)
    return catalogue.label(name, system()) or name.replace("_", " ").capitalize()


def label(title: str, unit: str) -> str:
    """Words and the displayed unit: "Hook load [kN]"."""
    return f"{words(title)} [{unit}]" if unit else words(title)


def color_scale(title: str, low: float, high: float) -> tuple[Any, Any]:
    """(norm, colormap) for values from low to high in displayed units.

    A quantity that changes sign gets blue above zero and red below, each side stretched to its extreme:
    50 kN of compression stays visible beside 800 kN of tension. One that does not change sign gets a
    sequential map.
    """
    import matplotlib as mpl
    from matplotlib.colors import Normalize, TwoSlopeNorm

    if not (math.isfinite(low) and math.isfinite(high)):
        low, high = 0.0, 1.0
    span = high - low
    if low < 0 < high and min(-low, high) > 1e-3 * span:
        return TwoSlopeNorm(0.0, low, high), mpl.colormaps["coolwarm_r"]
    if span <= 1e-12 * max(abs(low), abs(high), 1e-300):
        low, high = low - 0.5 * max(abs(low), 1.0), high + 0.5 * max(abs(high), 1.0)
    return Normalize(low, high), mpl.colormaps["viridis"]


LOOK = {
    "font.size": 9,
    "axes.titlesize": 10,
    "axes.grid": True,
    "grid.alpha": 0.3,
    "grid.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
}


def look() -> Any:
    """Context with the style of this package; the caller's settings are restored after it."""
    import matplotlib as mpl

    return mpl.rc_context(LOOK)


def figure(width: float, height: float, dpi: float) -> Any:
    """A figure on the Agg canvas (no display, no pyplot state). Inches, dots per inch."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    from drillpetsc.plotting.notebook import Picture

    drawing = Picture(figsize=(width, height), dpi=dpi)
    FigureCanvasAgg(drawing)
    return drawing


def is_noise(title: str, values: Any) -> bool:
    """Whether all values of a column are no more than rounding. title: "wob [N]"; values: array [SI]."""
    finite = np.abs(np.asarray(values, dtype=float))
    finite = finite[np.isfinite(finite)]
    return bool(finite.size) and 0 < float(finite.max()) < NOISE.get(split_name(title)[1], 0.0)


def sheet(width: float, height: float, heading: str) -> Any:
    """A figure [in] under a heading, which has as many lines as the width needs; ``fitted`` places the panels below it."""
    drawing = figure(width, height, dpi=110)
    lines = textwrap.wrap(heading, max(int((width - 0.4) / 0.105), 20))
    # its place in inches: a share of a tall drawing would lie within the first panels
    above = 1.0 - 0.1 / float(height)
    text_box = drawing.suptitle("\n".join(lines), x=0.02, y=above, ha="left", fontweight="bold", fontsize=12)
    text_box.set_parse_math(False)  # a title may have a $
    text_box.set_in_layout(False)  # ``fitted`` leaves its place free
    drawing.top = 1.0 - (0.25 + 0.2 * len(lines)) / float(height)
    return drawing


def limits_of_level(values: np.ndarray, noise: bool) -> tuple[float, float] | None:
    """Ends of an axis for values that are one constant, or rounding (``noise``); None for others.

    The ticks of a narrower axis would differ in their seventh digit.
    """
    finite = values[np.isfinite(values)]
    if noise or (finite.size and not finite.any()):
        return -1.0, 1.0
    if not finite.size or not np.ptp(finite) < 1e-6 * np.abs(finite).max():
        return None
    middle, half = 0.5 * (finite.max() + finite.min()), 1e-3 * np.abs(finite).max()
    return float(middle - half), float(middle + half)


def steady(axes: Any, values: np.ndarray, noise: bool, axis: str = "y") -> None:
    """Limit the magnification of a constant or of rounding (``noise``), and switch off offsets of an axis."""
    axes.ticklabel_format(axis=axis, useOffset=False)
    limits = limits_of_level(values, noise)
    if limits is not None:
        axes.set(**{f"{axis}lim": limits})


def level(axes: Any, values: np.ndarray, noise: bool) -> None:
    """As ``steady``; a power of ten above the axis is at its right end, away from the legend."""
    axes.yaxis.set_offset_position("right")
    axes.yaxis.get_offset_text().set_horizontalalignment("right")
    steady(axes, values, noise)


def save_figures(drawn: Mapping[str, Any], into: Path) -> list[Path]:
    """Save figures by name as PNG files in a folder; returns the files."""
    into.mkdir(parents=True, exist_ok=True)
    files = [into / f"{name}.png" for name in drawn]
    with look():
        for file, drawing in zip(files, drawn.values(), strict=True):
            drawing.savefig(file)
    return files


def contours(axes: Any, at: tuple[Any, Any], values: Any) -> None:
    """Draw labelled lines of equal values (m, n) over a grid.

    at: coordinates (n,) and (m,); values may be nan. There is no line of zero: a straight line between values of which one is
    far larger meets zero at another place than the boundary that was searched for.
    Without two by two values, or without a change, there is nothing to draw.
    """
    from matplotlib.ticker import MaxNLocator

    values = np.asarray(values, dtype=float)
    finite = values[np.isfinite(values)]
    if min(values.shape) < 2 or not finite.size or np.ptp(finite) <= 1e-9 * np.abs(finite).max():
        return
    levels = [
        v
        for v in MaxNLocator(6).tick_values(finite.min(), finite.max())
        if v and finite.min() < v < finite.max()
    ]
    if levels:
        drawn = axes.contour(
            *at,
            np.ma.masked_invalid(values),
            levels=levels,
            colors="0.25",
            linewidths=0.7,
            linestyles="solid",
        )
        axes.clabel(drawn, fontsize=7.5)
