"""Pictures of the commands over rotary speeds: forced response."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.output.files.run_folder import RESPONSE_TABLE
from drillpetsc.output.files.tables import read_table
from drillpetsc.plotting import style
from drillpetsc.plotting.style import LINE_COLORS

SHOWN = 1e-4  # share of the largest amplitude of a motion below which a panel or a line is rounding
#: column, its label, a column with which its size is compared
PANELS = (
    ("lateral_amplitude [m]", "Lateral", "lateral_amplitude [m]"),
    ("bending_moment_amplitude [N m]", "Bending", "lateral_amplitude [m]"),
    ("axial_amplitude [m]", "Axial", "axial_amplitude [m]"),
    ("axial_force_amplitude [N]", "Axial force", "axial_amplitude [m]"),
    ("twist_amplitude [rad]", "Twist", "twist_amplitude [rad]"),
    ("torque_amplitude [N m]", "Torque", "twist_amplitude [rad]"),
)
LEAST = {"lateral_amplitude [m]": 1e-9, "axial_amplitude [m]": 1e-9, "twist_amplitude [rad]": 1e-9}


def draw_response(folder: Path, title: str) -> Any:
    """Amplitudes over the rotary speed at every place; a vertical line where the amplitude is infinite, a cross where the
    string touches or leaves the wall."""
    table = read_table(folder / RESPONSE_TABLE)
    speed, place, word = (table[k] for k in ("rotary_speed [rpm]", "place [-]", "validity [-]"))
    if not len(speed):
        return None
    names = list(dict.fromkeys(str(p) for p in place))
    sizes = {k: _largest(table[k]) for k in LEAST}
    most = max(sizes.values())
    shown = [
        p for p in PANELS
        if p[0] in table and sizes[p[2]] > max(LEAST[p[2]], SHOWN * most) and _largest(table[p[0]]) > 0
    ]  # fmt: skip
    if not shown:
        return None
    drawing = style.figure(9.0, 1.2 + 2.2 * len(shown), dpi=110)
    top = style.heading(drawing, f"{title}: response over the rotary speed")
    tracks = drawing.subplots(len(shown), 1, sharex=True, squeeze=False)[:, 0]
    for axes, (column, label, _) in zip(tracks, shown, strict=True):
        largest = _largest(table[column])
        unit, text = style.display_unit(column, table[column])
        for k, name in enumerate(names):
            rows = place == name
            values = np.where(np.isfinite(table[column][rows]), table[column][rows], np.nan).astype(float)
            if not np.nanmax(values, initial=0.0) > SHOWN * largest:
                continue
            color = LINE_COLORS[k % len(LINE_COLORS)]
            marker = "." if rows.sum() < 60 else None
            axes.plot(
                speed[rows],
                np.where(values > 0, values, np.nan),
                color=color,
                marker=marker,
                linewidth=1.3,
                label=name,
            )
            beyond = rows & ((word == "touches") | (word == "lifts"))
            axes.plot(speed[beyond], table[column][beyond] / unit, "x", color=color, markersize=5)
        for rpm in np.unique(speed[word == "infinite"]):
            axes.axvline(rpm, color="0.3", linewidth=0.9, linestyle=(0, (4, 2)))
        axes.set(yscale="log", ylabel=f"{label} [{text}]")
        axes.grid(True, which="major", color="0.9", linewidth=0.6)
    tracks[0].legend(frameon=False, fontsize=8, loc="center left", bbox_to_anchor=(1.0, 0.5))
    tracks[-1].set_xlabel("Rotary speed [rpm]   (x: beyond the linear result; dashed: infinite)")
    drawing.tight_layout(rect=(0, 0, 1, top))
    return drawing


def _largest(values: np.ndarray) -> float:
    """Largest finite value."""
    return float(np.max(values[np.isfinite(values)], initial=0.0))
