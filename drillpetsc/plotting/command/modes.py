"""Picture of the modes of a `modes` run, drawn from modes.csv and modes/mode_NN.vtu."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.output.files.fields import cross_section_axes
from drillpetsc.output.files.vtk import read_frame
from drillpetsc.plotting import style
from drillpetsc.plotting.source import Source
from drillpetsc.plotting.style import LINE_COLORS

SHOWN = 8  # modes in the picture
UNDAMPED = 1e-9  # damping ratio below which it is rounding
PARTS = {  # quantity drawn, by kind of mode
    "lateral": ("displacement [m]", ("first direction across", "second direction across")),
    "axial": ("displacement [m]", ("along the string",)),
    "torsional": ("spin_angle [rad]", ("spin angle",)),
}


def draw_modes(at: Source) -> Any:
    """Shapes of the first modes along measured depth, each scaled to 1: solid the real, dashed the imaginary part.

    Returns None if the folder holds no shapes.
    """
    files = sorted((at.folder.path / "modes").glob("mode_*.vtu"))[:SHOWN]
    if not files:
        return None
    table = at.table("modes.csv")
    drawing = style.sheet(max(1.6 * len(files) + 1.0, 6.0), 8.0, f"{at.title}: modes")
    tracks = drawing.subplots(1, len(files), sharey=True, squeeze=False)[0]
    for k, (axes, file) in enumerate(zip(tracks, files, strict=True)):
        kind = str(table["kind [-]"][k])
        depth, lines = _lines(file, kind)
        size = max((float(np.abs(values).max()) for _, values in lines), default=0.0) or 1.0
        for (name, values), color in zip(lines, LINE_COLORS, strict=False):
            axes.plot(values.real / size, depth, color=color, linewidth=1.4, label=name)
            if np.abs(values.imag).max() > 1e-3 * size:
                axes.plot(values.imag / size, depth, color=color, linewidth=0.9, linestyle=(0, (4, 2)))
        axes.axvline(0.0, color="0.35", linewidth=0.7)
        axes.set(xlim=(-1.1, 1.1), xticks=(-1, 0, 1))
        damping = float(table["damping_ratio [-]"][k])
        words = "undamped" if abs(damping) < UNDAMPED else f"damping {damping:.2g}"
        axes.set_title(f"{k + 1}: {kind}\n{float(table['frequency [Hz]'][k]):.4g} Hz\n{words}", fontsize=8.5)
        if lines:
            axes.legend(
                loc="upper center", bbox_to_anchor=(0.5, -0.045), frameon=False, fontsize=7, handlelength=1.2
            )
    tracks[0].set_ylabel(f"Measured depth [{style.depth_unit()[1]}]")
    tracks[0].set_ylim(depth.max(), depth.min())
    return drawing.fitted()


def _lines(file: Path, kind: str) -> tuple[np.ndarray, list[tuple[str, np.ndarray]]]:
    """Measured depth (n,) [m] of a shape, and name and complex values (n,) of the lines that show it."""
    frame = read_frame(file)
    data = frame.point_data

    def shape(name: str) -> np.ndarray:
        stem, unit = name.split(" ", 1)
        return np.asarray(data[name]) + 1j * np.asarray(data[f"{stem}_imaginary {unit}"])

    depth = np.asarray(data["md [m]"], dtype=float) / style.depth_unit()[0]
    if kind in PARTS and PARTS[kind][0] in data:
        column, names = PARTS[kind]
        values = shape(column)
        if kind == "torsional":
            return depth, [(names[0], values)]
        points = np.asarray(frame.points, dtype=float)
        first, second = cross_section_axes(points)
        directions = (np.cross(first, second),) if kind == "axial" else (first, second)
        return depth, [
            (name, np.sum(values * along, axis=1)) for name, along in zip(names, directions, strict=True)
        ]
    pressures = [name for name in ("bore_pressure [Pa]", "annulus_pressure [Pa]") if name in data]
    return depth, [(name.split("_")[0] + " pressure", shape(name)) for name in pressures]
