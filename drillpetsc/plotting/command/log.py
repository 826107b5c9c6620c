"""The page of `import log`: tracks of the log coloured by rig state, and what the checks found."""

from __future__ import annotations

import base64
import io
import json
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.output.files.atomic import replace_text
from drillpetsc.output.files.run_folder import LOG_PAGE, LOG_QUALITY, LOG_TABLE
from drillpetsc.output.files.tables import read_table, split_name
from drillpetsc.plotting import style

TRACKS = ("bit_depth", "hook_load", "torque", "rpm", "flow_rate", "pump_pressure", "wob")
MOST_POINTS = 20_000  # of a track that the picture shows
COLORS = {
    "drilling": "#3a8a4d",
    "slide": "#7d4fa0",
    "trip_in": "#1f5fa8",
    "ream_down": "#7fa8d8",
    "trip_out": "#c8501e",
    "backream": "#8a6d1f",
    "rotate_off": "#000000",
    "circulate": "#20a0a0",
    "hanging": "#e0a800",
    "in_slips": "#b8b8b8",
    "connection": "#808080",
    "edge": "#e8b0c0",
    "unknown": "#d02070",
}


def log_page(folder: Path) -> Path:
    """Write `log.html` of a folder of `import log`: one file, without scripts and without the web."""
    summary = json.loads((folder / LOG_QUALITY).read_text(encoding="utf-8"))
    picture = base64.b64encode(_tracks(read_table(folder / LOG_TABLE), summary["index"] == "time")).decode(
        "ascii"
    )
    shares = [
        f"<tr><td>{escape(q['check'])}</td><td>{escape(q['channel'])}</td><td>{q['count']}</td><td>{q['share']:.1%}</td>"
        f"<td><meter max=1 value={q['share']:.4f}></meter></td><td>{escape(q['detail'])}</td><td>{escape(q['action'])}</td></tr>"
        for q in summary["checks"]
    ]
    states = [
        f"<tr><td>{escape(word)}</td><td>{count}</td></tr>" for word, count in summary["states"].items()
    ]
    said = [f"<li>{escape(text)}</li>" for text in (*summary["warnings"], *summary["notes"])]
    used = ", ".join(f"{name} = {title}" for name, title in summary["columns"].items())
    head = "<tr><th>check</th><th>channel</th><th>rows</th><th>share</th><th></th><th>what</th><th>action</th></tr>"
    text = f"""<!doctype html><html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>Log {escape(folder.name)}</title>
<style>body{{font:15px/1.4 sans-serif;margin:1em auto;max-width:70em;padding:0 1em}}img{{max-width:100%}}
table{{border-collapse:collapse}}td,th{{padding:.15em .6em;text-align:left;border-bottom:1px solid #ccc}}</style>
<h1>Log {escape(folder.name)}</h1>
<p>{summary["rows"]} rows by {summary["index"]}. Columns: {escape(used)}.
Not used: {escape(", ".join(summary["unused"]) or "none")}.</p>
<img alt="Tracks of the log coloured by rig state" src="data:image/png;base64,{picture}">
<h2>Quality</h2><table>{head}{"".join(shares)}</table>
<h2>States</h2><table><tr><th>state</th><th>rows</th></tr>{"".join(states)}</table>
<p>{summary["points"]} points for calibrate.</p>
<ul>{"".join(said)}</ul></html>
"""
    return replace_text(folder / LOG_PAGE, text)


def _tracks(table: dict[str, np.ndarray], by_time: bool) -> bytes:
    """The picture (PNG)."""
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    title_of = {split_name(title)[0]: title for title in table}
    words = np.asarray(table[title_of["state"]]).astype(str)
    index = np.asarray(table[title_of["time" if by_time else "bit_depth"]], float)
    names = [q for q in TRACKS if q in title_of and not (q == "bit_depth" and not by_time)]
    step = max(len(words) // MOST_POINTS, 1)
    figure = Figure(
        figsize=(11, 1.7 * len(names) + 0.8) if by_time else (1.9 * len(names) + 1.2, 9), layout="constrained"
    )
    axes: Any = figure.subplots(
        len(names) if by_time else 1,
        1 if by_time else len(names),
        sharex=by_time,
        sharey=not by_time,
        squeeze=False,
    )
    shown = [state for state in COLORS if (words == state).any()]
    for axis, name in zip(axes.ravel(), names, strict=True):
        values = np.asarray(table[title_of[name]], float)
        size, unit = style.display_unit(title_of[name].replace("m^3", "m3"), values)
        for state in shown:
            rows = np.flatnonzero(words == state)[::step]
            pair = (
                (index[rows] / 3600, values[rows] / size) if by_time else (values[rows] / size, index[rows])
            )
            axis.plot(*pair, ".", ms=2, color=COLORS[state])
        label = f"{name.replace('_', ' ')} [{unit}]"
        axis.set_ylabel(label) if by_time else axis.set_xlabel(label)
        axis.grid(color="0.9")
        if name == "bit_depth":
            axis.invert_yaxis()
    if by_time:
        axes[-1, 0].set_xlabel("time [h]")
    else:
        axes[0, 0].set_ylabel("bit depth [m]")
        axes[0, 0].invert_yaxis()
    marks = [
        Line2D([], [], ls="", marker="o", color=COLORS[state], label=state.replace("_", " "))
        for state in shown
    ]
    figure.legend(handles=marks, loc="outside upper center", ncols=7, frameon=False)
    image = io.BytesIO()
    figure.savefig(image, format="png", dpi=110)
    return image.getvalue()
