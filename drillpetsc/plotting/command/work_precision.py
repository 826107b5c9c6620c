"""Pictures of a study: error over CPU time, error over step; from the content of study.json."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from drillpetsc.plotting import style

MARKERS = "osD^vP*Xh<>"
COLORS = (*style.LINE_COLORS, "#4a4a4a", "#2aa198", "#e0a030", "#6c3b1f")
NORM = "rms"


def draw_study(
    content: Mapping[str, Any], into: Path, norm: str = NORM, name: str = "", dpi: float = 100
) -> list[Path]:
    """Draw work_precision.png and orders.png (speed_up.png if ranks vary), with ``name`` in front.

    If no point has an error, nothing is drawn. Returns the files.
    """
    if content["vary"] == "ranks":
        drawn = {"speed_up": _speed_up(content, dpi)} if content["speed_up"] else {}
    elif content["outputs"]:
        of_cpu = _panels(content, "cpu", "CPU time [s]", norm, dpi)
        of_step = _panels(content, "abscissa", content["abscissa"], norm, dpi)
        drawn = {"work_precision": of_cpu, "orders": of_step}
    else:
        drawn = {}
    return style.save_figures({f"{name}{kind}": drawing for kind, drawing in drawn.items()}, into)


def _panels(content: Mapping[str, Any], abscissa: str, label: str, norm: str, dpi: float) -> Any:
    """A panel per output, a line per curve."""
    outputs = list(content["outputs"])
    columns = min(len(outputs), 3)
    rows = -(-len(outputs) // columns)
    curves = list(dict.fromkeys(p["curve"] for p in content["points"]))
    with style.look():
        drawing = style.figure(4.6 * columns + 2.6, 3.9 * rows + 0.9, dpi=dpi)
        grid = drawing.subplots(rows, columns, squeeze=False)
        what = "error over CPU time" if abscissa == "cpu" else f"error over {label.split(' [')[0]}"
        drawing.suptitle(f"{content['title']}: {what}", x=0.02, ha="left", fontweight="bold", fontsize=12)
        drawing.text(
            0.02, 0.008, _note(content), fontsize=7.5, color="0.3", ha="left", va="bottom", wrap=True
        )
        for axes, name in zip(grid.reshape(-1), outputs, strict=False):
            _panel(axes, content, name, curves, abscissa, norm)
            axes.set(xlabel=label, ylabel=f"{norm} error / range", title=_title(name))
        for axes in grid.reshape(-1)[len(outputs) :]:
            axes.remove()
        handles, labels = grid[0, 0].get_legend_handles_labels()
        side = 2.5 / (4.6 * columns + 2.6)
        drawing.legend(handles, labels, loc="center right", frameon=False, fontsize=8.5)
        drawing.tight_layout(rect=(0, 0.045 / rows + 0.015, 1 - side, 0.985))
    return drawing


def _title(name: str) -> str:
    """ "x_10" is the offset x of the probe at 10 m."""
    probe = re.fullmatch(r"(x|y|spin|contact)_([\d.]+)", name)
    if probe is None:
        return style.words(name)
    kind = {"x": "Offset x", "y": "Offset y"}.get(probe[1], probe[1].capitalize())
    depth = float(probe[2]) / style.depth_unit()[0]
    return f"{kind} at {depth:.6g} {style.depth_unit()[1]}"


def _note(content: Mapping[str, Any]) -> str:
    reference = content["reference"]
    return f"Reference: {reference['what']}. Dashed: error of the reference, if known. Crosses: points that failed."


def _panel(
    axes: Any, content: Mapping[str, Any], name: str, curves: Sequence[str], abscissa: str, norm: str
) -> None:
    drawn: list[tuple[float, float]] = []
    failed: list[tuple[int, Mapping[str, Any]]] = []
    for k, curve in enumerate(curves):
        on_curve = [p for p in content["points"] if p["curve"] == curve]
        good = [(p[abscissa], p[f"error_{name}_{norm}"]) for p in on_curve if p["status"] == "done"]
        shown = [(x, y) for x, y in good if _positive(x) and _positive(y)]
        drawn += shown
        failed += [(k, p) for p in on_curve if p["status"] != "done"]
        color, marker = COLORS[k % len(COLORS)], MARKERS[k % len(MARKERS)]
        suffix = f" ({len(on_curve) - len(good)} failed)" if len(good) < len(on_curve) else ""
        axes.plot(
            *(zip(*shown, strict=True) if shown else ((), ())),
            color=color,
            marker=marker,
            markersize=4.5,
            linewidth=1.3,
            label=curve + suffix,
        )
    if drawn:
        axes.set(xscale="log", yscale="log")
        axes.grid(True, which="both", alpha=0.18, linewidth=0.5)
        _few_labels(axes.xaxis, [x for x, _ in drawn])
        if abscissa == "abscissa":
            _guides(axes, drawn)
        own = (content["reference"]["own_error"] or {}).get(name)
        if _positive(own):
            axes.axhline(own, color="0.45", linewidth=0.9, linestyle=(0, (5, 3)))
    else:
        axes.text(
            0.5,
            0.5,
            "the errors of all points are unknown",
            transform=axes.transAxes,
            ha="center",
            color="0.4",
        )
    _crosses(axes, failed, abscissa if drawn else "")


def _crosses(axes: Any, failed: Sequence[tuple[int, Mapping[str, Any]]], abscissa: str) -> None:
    """Mark failed points at the upper margin: at their step if it is known, otherwise in the corner."""
    for k, p in failed:
        known = abscissa == "abscissa" and p["petsc"].get("ts_dt")
        x = p["value"] if known else 0.985 - 0.03 * (k % 8)
        axes.plot(
            x,
            0.975,
            "x",
            color=COLORS[k % len(COLORS)],
            markersize=6,
            clip_on=False,
            transform=axes.get_xaxis_transform() if known else axes.transAxes,
        )


def _few_labels(axis: Any, values: Sequence[float]) -> None:
    """Label 1, 2 and 5 of a decade if there are few decades; nine labels would overlap."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    wide = max(values) > 100 * min(values)
    axis.set_major_locator(LogLocator(subs=(1.0,) if wide else (1.0, 2.0, 5.0)))
    axis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:.3g}"))
    axis.set_minor_formatter(NullFormatter())


def _guides(axes: Any, drawn: Sequence[tuple[float, float]]) -> None:
    """Draw slopes 1 to 4 from the upper right corner of the points."""
    right, high = max(x for x, _ in drawn), max(y for _, y in drawn)
    left, low = min(x for x, _ in drawn), min(y for _, y in drawn)
    if not left < right or not low < high:
        return
    axes.set_xlim(left / 1.5, right * 1.5)
    axes.set_ylim(low / 2, high * 3)
    for slope in (1, 2, 3, 4):
        end = max(left, right * (low / high) ** (1 / slope))
        axes.plot(
            [end, right],
            [high * (end / right) ** slope, high],
            color="0.75",
            linewidth=0.8,
            linestyle=":",
            zorder=1,
        )
        axes.annotate(str(slope), (end, high * (end / right) ** slope), fontsize=7.5, color="0.5")


def _speed_up(content: Mapping[str, Any], dpi: float) -> Any:
    with style.look():
        drawing = style.figure(5.6, 4.2, dpi=dpi)
        axes = drawing.subplots()
        ranks = sorted(int(n) for n in content["speed_up"])
        axes.plot(
            ranks, [content["speed_up"][str(n)] for n in ranks], "o-", color=COLORS[0], label="measured"
        )
        axes.plot(ranks, ranks, ":", color="0.6", label="ideal")
        axes.set(
            xlabel="ranks",
            ylabel="wall time on 1 rank / wall time",
            title=f"{content['title']}: speed-up",
            xticks=ranks,
        )
        axes.legend(frameon=False)
        drawing.tight_layout()
    return drawing


def _positive(value: Any) -> bool:
    return value is not None and math.isfinite(value) and value > 0
