"""Picture of the command `top-drive`: reflection of torsional waves over the frequency."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from drillpetsc.output.files.json_file import read_summary
from drillpetsc.output.files.run_folder import REFLECTION_TABLE, RunFolder
from drillpetsc.output.files.tables import read_table
from drillpetsc.plotting import style
from drillpetsc.plotting.style import LINE_COLORS


def draw_reflection(folder: Path, title: str) -> Any:
    """|r| of every controller over the frequency, with the string's lowest torsional frequency; None without a table."""
    if not (folder / REFLECTION_TABLE).exists():
        return None
    table = read_table(folder / REFLECTION_TABLE)
    file = RunFolder(folder).summary
    found = (read_summary(file) if file.exists() else {}).get("top_drive", {})
    kinds = [law["kind"] for law in found.get("control", ())]
    drawing = style.sheet(8.0, 4.5, f"{title}: reflection at the top")
    axes = drawing.subplots()
    number, frequency, size = (
        table[f"{name}"] for name in ("controller [-]", "wave_frequency [Hz]", "reflection [-]")
    )
    for k in range(int(number.max(initial=0.0))):
        rows = number == k + 1
        label = kinds[k] if k < len(kinds) else f"controller {k + 1}"
        axes.plot(frequency[rows], size[rows], color=LINE_COLORS[k % len(LINE_COLORS)], label=label)
    lowest = found.get("torsional_frequency")
    if lowest:
        axes.axvline(lowest, color="0.4", linewidth=0.8, linestyle=(0, (5, 2)), label="lowest torsional mode")
    axes.set(
        xscale="log",
        xlim=(frequency[0], frequency[-1]),
        ylim=(0.0, max(1.02, float(size.max()))),
    )
    axes.set(xlabel="Frequency [Hz]", ylabel="Reflected part of a torsional wave |r| [-]")
    axes.legend(frameon=False)
    return drawing.fitted()
