"""Pictures over rotary speeds and frequencies: Campbell diagram, stability map, forced response, reflection at the top."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.output.files.run_folder import (
    BOUNDARY_TABLE,
    CAMPBELL_TABLE,
    CRITICAL_MAP_TABLE,
    CRITICAL_TABLE,
    REFLECTION_TABLE,
    RESPONSE_TABLE,
    STABILITY_RUNS_TABLE,
    STABILITY_TABLE,
)
from drillpetsc.plotting import style
from drillpetsc.plotting.source import Pictures, Source
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


#: color of each kind of mode, and dashes by the sense of the whirl
KIND_COLORS = {
    "lateral": LINE_COLORS[0],
    "axial": LINE_COLORS[1],
    "torsional": LINE_COLORS[2],
    "fluid": LINE_COLORS[3],
}
DASHES = {"backward": (0, (3, 1.6))}
DAMPED = 0.3  # damping ratio from which a branch is pale
SHARP = 0.1  # damping ratio below which a critical speed is marked


def draw_campbell(at: Source) -> Any:
    """Frequencies over the rotary speed with excitation lines and critical speeds."""
    table = at.table(CAMPBELL_TABLE)
    if not len(table["branch [-]"]):
        return None
    summary = at.summary
    branch, speed, frequency = (table[k] for k in ("branch [-]", "rotary_speed [rpm]", "frequency [Hz]"))
    ratio, kind, sense = (table[k] for k in ("damping_ratio [-]", "kind [-]", "whirl_sense [-]"))
    drawing = style.sheet(9.5, 6.5, f"{at.title}: Campbell diagram")
    axes = drawing.subplots()
    low, high = float(speed.min()), float(speed.max())
    drawn, faint = set(), False
    for number in np.unique(branch):
        rows = branch == number
        word, whirl = str(kind[rows][0]), _prevailing(sense[rows])
        pale = float(np.median(np.abs(ratio[rows]))) > DAMPED
        faint = faint or pale
        label = f"{word} {whirl}" if whirl in ("forward", "backward") else word
        axes.plot(
            speed[rows],
            frequency[rows],
            color=KIND_COLORS[word],
            linestyle=DASHES.get(whirl, "-"),
            linewidth=1.0 if pale else 1.5,
            alpha=0.35 if pale else 1.0,
        )
        if label not in drawn:
            axes.plot(
                [], [], color=KIND_COLORS[word], linestyle=DASHES.get(whirl, "-"), linewidth=1.5, label=label
            )
        drawn.add(label)
        grows = rows & (table["growth [1/s]"] > 1e-6 * np.maximum(2 * np.pi * frequency, 1e-12))
        axes.plot(speed[grows], frequency[grows], "o", color="#c0392b", markersize=3.5, zorder=4,
                  label=None if "grows" in drawn or not grows.any() else "grows")  # fmt: skip
        drawn |= {"grows"} if grows.any() else set()
    if faint:
        axes.plot([], [], color="0.75", linewidth=1.0, label=f"pale: damping above {DAMPED:g}")
    ceiling = 1.05 * float(frequency.max())
    for k, line in enumerate(summary.get("lines", ())):
        end = min(high, ceiling * 60 / line)
        axes.plot(
            [low, end], [low * line / 60, end * line / 60], color="0.35", linewidth=0.9, linestyle=(0, (6, 3))
        )
        axes.annotate(f"{line:g}x", (end, end * line / 60), xytext=(3, 2 + 9 * (k % 2)), textcoords="offset points", fontsize=8, color="0.35",
                      annotation_clip=False)  # fmt: skip
    if "motor_line" in summary:
        speeds = np.sort(np.array([*summary["speeds"], *summary["added_speeds"]]))
        axes.plot(
            speeds, summary["motor_line"], color="0.35", linewidth=0.9, linestyle=(0, (1, 2)), label="motor"
        )
    if at.has(CRITICAL_TABLE):
        found = at.table(CRITICAL_TABLE)
        sharp = found["damping_ratio [-]"] < SHARP
        if sharp.any():
            axes.plot(
                found["critical_rotary_speed [rpm]"][sharp], found["frequency [Hz]"][sharp], "D", markersize=5.5,
                markerfacecolor="white", markeredgecolor="black", zorder=5, label=f"critical, damping < {SHARP:g}",
            )  # fmt: skip
    case_speed = float(summary.get("case_speed", 0.0))
    if low < case_speed < high:
        axes.axvline(case_speed, color="0.6", linewidth=1.0, zorder=0)
        axes.annotate(
            "case",
            (case_speed, ceiling),
            xytext=(3, -10),
            textcoords="offset points",
            fontsize=8,
            color="0.45",
        )
    axes.set(xlim=(low, high), ylim=(0.0, ceiling), xlabel="Rotary speed [rpm]", ylabel="Frequency [Hz]")
    axes.legend(frameon=False, fontsize=8.5, loc="center left", bbox_to_anchor=(1.03, 0.5))
    return drawing.fitted()


def _prevailing(words: np.ndarray) -> str:
    """The word that occurs most often."""
    found, count = np.unique(words.astype(str), return_counts=True)
    return str(found[count.argmax()])


def draw_critical_map(at: Source) -> Any:
    """Critical speeds without damping over the stiffness of the wall, by excitation line and kind of the mode."""
    table = at.table(CRITICAL_MAP_TABLE)
    wall = table["wall_stiffness [Pa]"].astype(float)
    if not len(wall):
        return None
    drawing = style.sheet(8.0, 5.0, f"{at.title}: critical speeds without damping")
    axes = drawing.subplots()
    size, unit = style.display_unit("wall_stiffness [Pa]", wall)
    line, kind = table["excitation_line [-]"].astype(float), table["kind [-]"].astype(str)
    groups = sorted(set(zip(kind.tolist(), np.round(line, 3).tolist(), strict=True)))
    for (word, order), marker in zip(groups, "osDv^<>Pd*Xhp" * (1 + len(groups) // 13), strict=False):
        here = (kind == word) & (np.round(line, 3) == order)
        speed = table["critical_rotary_speed [rpm]"][here].astype(float)
        axes.semilogx(wall[here] / size, speed, marker, markersize=5, label=f"{word}, {order:g} per turn")
    axes.set(xlabel=f"Stiffness of the wall [{unit}]", ylabel="Critical speed [rpm]", ylim=(0, None))
    axes.legend(frameon=False, fontsize=8.5, loc="center left", bbox_to_anchor=(1.02, 0.5))
    return drawing.fitted()


def draw_stability(at: Source) -> Any:
    """Largest growth over rotary speed and weight on bit, growth in red, with contours, the boundary and the case."""
    table = at.table(STABILITY_TABLE)
    if not len(table["weight_on_bit [N]"]):
        return None
    speeds, weights = (np.unique(table[k]) for k in ("rotary_speed [rpm]", "weight_on_bit [N]"))
    growth = table["largest_growth [1/s]"].reshape(len(weights), len(speeds)).astype(float)
    unit, text = style.display_unit("weight_on_bit [N]", weights)
    drawing = style.sheet(9.0, 5.0, f"{at.title}: stability of steady drilling")
    axes = drawing.subplots()
    from matplotlib.colors import TwoSlopeNorm

    finite = growth[np.isfinite(growth)]
    low, high = float(finite.min(initial=0.0)), float(finite.max(initial=0.0))
    low, high = min(low, -1e-6), max(high, 1e-6)
    norm = TwoSlopeNorm(0.0, vmin=low, vmax=high)  # each side to its extreme
    drawn = axes.pcolormesh(
        _edges(speeds), _edges(weights / unit), growth, cmap="RdBu_r", norm=norm, shading="flat"
    )
    bar = drawing.colorbar(drawn, ax=axes, label="Largest growth rate [1/s]  (red: unstable)")
    ticks = [low, 0.5 * low, 0.0, 0.5 * high, high]  # matplotlib's ticks leave out a narrow side
    bar.set_ticks(ticks, labels=[f"{tick:.2g}" for tick in ticks])
    style.contours(axes, (speeds, weights / unit), growth)
    if at.has(BOUNDARY_TABLE):
        found = at.table(BOUNDARY_TABLE)
        if len(found["weight_on_bit [N]"]):
            axes.plot(
                found["boundary_speed [rpm]"].astype(float), found["weight_on_bit [N]"].astype(float) / unit, "o",
                color="black", markersize=5, label="boundary",
            )  # fmt: skip
    if at.has(STABILITY_RUNS_TABLE):
        _mark_runs(axes, at.table(STABILITY_RUNS_TABLE), unit)
    summary = at.summary
    if summary.get("case_speed") and "case_weight" in summary:
        case = {
            "color": "#ffd400",
            "markeredgecolor": "black",
            "markersize": 14,
            "label": "the case",
            "zorder": 6,
        }
        axes.plot(
            summary["case_speed"], summary["case_weight"] / unit, "*", **case
        )  # the axes grow if it lies outside
    if axes.get_legend_handles_labels()[0]:
        axes.legend(frameon=True, loc="upper right", fontsize=8.5)
    axes.set(xlabel="Rotary speed [rpm]", ylabel=f"Weight on bit [{text}]", yticks=weights / unit)
    return drawing.fitted()


#: marker of the behaviour of a run
RUN_MARKERS = {
    "steady": ("o", "white"),
    "decays": ("v", "white"),
    "grows": ("^", "black"),
    "stick_slip": ("s", "black"),
    "failed": ("x", "black"),
}


def _mark_runs(axes: Any, table: dict[str, np.ndarray], unit: float) -> None:
    """Mark the outcome of the runs in time: white if the string is or becomes steady, black if vibration grows or the string sticks."""
    for behaviour, (marker, colour) in RUN_MARKERS.items():
        here = table["run_behaviour [-]"] == behaviour
        if here.any():
            axes.scatter(
                table["rotary_speed [rpm]"][here].astype(float), table["weight_on_bit [N]"][here].astype(float) / unit,
                marker=marker, c=colour, edgecolors="black" if marker != "x" else None, s=42, linewidths=0.8,
                label=f"run: {behaviour.replace('_', ' ')}", zorder=3,
            )  # fmt: skip


def _edges(values: np.ndarray) -> np.ndarray:
    """Ends of the cells about ``values``."""
    if len(values) == 1:
        return values[0] * np.array([0.9, 1.1])
    middle = 0.5 * (values[1:] + values[:-1])
    return np.concatenate([[2 * values[0] - middle[0]], middle, [2 * values[-1] - middle[-1]]])


def draw_response(at: Source) -> Any:
    """Amplitudes over the rotary speed at every place; a vertical line marks an infinite amplitude, a cross a string that
    touches or leaves the wall."""
    table = at.table(RESPONSE_TABLE)
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
    drawing = style.sheet(9.0, 1.2 + 2.2 * len(shown), f"{at.title}: response over the rotary speed")
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
                np.where(values > 0, values, np.nan) / unit,
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
    lines = {line.get_label(): line for axes in tracks for line in axes.get_legend_handles_labels()[0]}
    listed = [name for name in names if name in lines]  # of all panels: a place may not move in the first
    tracks[0].legend(
        [lines[name] for name in listed],
        listed,
        frameon=False,
        fontsize=8,
        loc="center left",
        bbox_to_anchor=(1.0, 0.5),
    )
    tracks[-1].set_xlabel("Rotary speed [rpm]   (x: beyond the linear result; dashed: infinite)")
    return drawing.fitted()


def _largest(values: np.ndarray) -> float:
    """Largest finite value."""
    return float(np.max(values[np.isfinite(values)], initial=0.0))


def draw_reflection(at: Source) -> Any:
    """|r| of every controller over the frequency, with the string's lowest torsional frequency."""
    table = at.table(REFLECTION_TABLE)
    found = at.summary.get("top_drive", {})
    kinds = [law["kind"] for law in found.get("control", ())]
    drawing = style.sheet(8.0, 4.5, f"{at.title}: reflection at the top")
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


PICTURES: Pictures = {
    "campbell": ((CAMPBELL_TABLE,), draw_campbell),
    "critical_map": ((CRITICAL_MAP_TABLE,), draw_critical_map),
    "stability_map": ((STABILITY_TABLE,), draw_stability),
    "response": ((RESPONSE_TABLE,), draw_response),
    "reflection": ((REFLECTION_TABLE,), draw_reflection),
}
