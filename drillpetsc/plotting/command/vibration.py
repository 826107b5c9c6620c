"""Pictures of drilling dynamics: waterfalls, order maps, power densities, indices, whirl over time and depth, sensors."""

from __future__ import annotations

import textwrap
from typing import Any

import numpy as np

from drillpetsc import vibration
from drillpetsc.errors import CaseError
from drillpetsc.output.files.run_folder import INDICES_TABLE
from drillpetsc.output.files.tables import split_name
from drillpetsc.output.sensors.files import read_sensor
from drillpetsc.plotting import style
from drillpetsc.plotting.run.signals import Signal
from drillpetsc.plotting.source import Pictures, Source, Table
from drillpetsc.plotting.style import LINE_COLORS, display_unit, label, words
from drillpetsc.plotting.thinning import envelope
from drillpetsc.unit_tables import GRAVITY

RANGE = 1e-3  # smallest amplitude that a map shows, over the largest
ORDERS = (1, 2, 3)  # lines over the rotation that a waterfall shows
WHIRL_COLORS = {
    "none": "#d9d9d9",
    "forward synchronous": "#8fbf8f",
    "forward": "#3a8a4d",
    "backward rolling": "#c8501e",
    "backward slipping": "#e9a36b",
    "chaotic": "#7d4fa0",
    "unresolved": "#ffffff",
}


def _shown(title: str, values: np.ndarray) -> tuple[float, str]:
    """How to show a column: (divide by, unit text); accelerations in multiples of gravity."""
    if split_name(title)[1] == "m/s2":
        return GRAVITY, "g"
    return display_unit(title, values)


def _colours(axes: Any, found: vibration.Spectrogram, size: float, drawing: Any, text: str) -> None:
    """A map of amplitudes on a logarithmic scale, with its bar."""
    from matplotlib.colors import LogNorm

    amplitude = np.maximum(found.amplitude / size, 1e-300)
    largest = float(amplitude[:, 1:].max(initial=1e-300))
    step = np.diff(found.time, prepend=found.time[0] - 1.0)[-1] if len(found.time) > 1 else 1.0
    edges = np.concatenate([found.time - 0.5 * step, found.time[-1:] + 0.5 * step])
    lines = np.concatenate([found.frequency, 2 * found.frequency[-1:] - found.frequency[-2:-1]])
    lines = lines - 0.5 * (found.frequency[1] - found.frequency[0])
    mesh = axes.pcolormesh(
        edges, lines, amplitude.T, norm=LogNorm(RANGE * largest, largest), cmap="magma", rasterized=True
    )
    axes.grid(False)
    drawing.colorbar(mesh, ax=axes, pad=0.015).set_label(text)


def _top(found: vibration.Spectrogram, limit: float) -> float:
    """Frequency or order up to which a map is shown: above it there is less than a hundredth of its power."""
    power = np.cumsum(np.sum(found.amplitude[:, 1:] ** 2, axis=0))
    if not power[-1] > 0:
        return float(found.frequency[-1])
    last = 1 + int(np.searchsorted(power, 0.995 * power[-1]))
    return float(
        min(found.frequency[-1], max(2.0 * found.frequency[min(last, len(found.frequency) - 1)], limit))
    )


def draw_waterfall(signal: Signal, title: str, segment: float | None = None, order: bool = False) -> Any:
    """Amplitudes of a signal over time and frequency with lines at multiples of the rotation, or over time and order.

    segment: length of a segment [s], or with ``order`` its revolutions.  Raises CaseError for an order map without rotation.
    """
    size, unit = _shown(signal.title, signal.values)
    try:
        if order:
            if signal.speed is None:
                raise ValueError("an order map needs the rotation: a channel rpm")
            turns = abs(float(vibration.turned_angle(signal.time, signal.speed)[-1])) / (2 * np.pi)
            revolutions = segment if segment is not None else float(np.clip(turns / 12, 4, 64))
            found = vibration.order_map(signal.time, signal.values, signal.speed, revolutions)
        else:
            found = vibration.spectrogram(signal.time, signal.values, segment)
    except ValueError as error:
        raise CaseError(at="--order" if order else "--waterfall", got=signal.name, want=str(error)) from None
    drawing = style.sheet(
        11.0, 5.2, f"{title}: {signal.name}, {'orders of rotation' if order else 'waterfall'}"
    )
    axes = drawing.subplots()
    text = f"amplitude of {words(signal.title).lower()}" + (f" [{unit}]" if unit else "")
    _colours(axes, found, size, drawing, text)
    spacing = float(found.frequency[1] - found.frequency[0])
    if order:
        axes.set_ylim(0, min(float(found.frequency[-1]), max(6.0, _top(found, 0.0))))
        for k in ORDERS:
            axes.axhline(k, color="white", linewidth=0.7, linestyle=(0, (6, 4)))
        axes.set_ylabel("order of rotation [-]")
    else:
        rotation = 0.0 if signal.speed is None else float(np.abs(signal.speed).max()) / (2 * np.pi)
        axes.set_ylim(0, _top(found, 1.3 * max(ORDERS) * rotation))
        if signal.speed is not None:
            t, speed = envelope(signal.time, np.abs(signal.speed) / (2 * np.pi))
            for k in ORDERS:
                axes.plot(t, k * speed, color="white", linewidth=0.8, linestyle=(0, (6, 4)))
                at = int(np.argmax(speed))
                axes.annotate(
                    f"{k}x",
                    (t[at], k * speed[at]),
                    xytext=(0, 2),
                    textcoords="offset points",
                    color="white",
                    fontsize=8,
                    ha="center",
                    annotation_clip=True,
                )
        axes.set_ylabel("frequency [Hz]")
    note = f"lines {spacing:.3g} {'orders' if order else 'Hz'} apart" + (
        f"; {signal.told}" if signal.told else ""
    )
    axes.set_xlabel(f"time [s]      ({note})")
    axes.set_xlim(
        found.time[0] if len(found.time) > 1 else None, found.time[-1] if len(found.time) > 1 else None
    )
    return drawing.fitted()


def draw_power(signal: Signal, title: str, segment: float | None = None) -> Any:
    """Power density of a signal over the frequency."""
    size, unit = _shown(signal.title, signal.values)
    frequency, density = vibration.power_density(signal.time, signal.values / size, segment)
    drawing = style.sheet(8.5, 4.8, f"{title}: {signal.name}, power density")
    axes = drawing.subplots()
    axes.loglog(frequency[1:], np.maximum(density[1:], 1e-300), color=LINE_COLORS[0], linewidth=1.1)
    largest = float(density[1:].max(initial=1e-300))
    axes.set_ylim(1e-9 * largest, 3 * largest)
    if signal.told:
        axes.axvspan(signal.limit, frequency[-1], color="0.85", zorder=0)
    axes.set_xlabel("frequency [Hz]" + (f"      ({signal.told}: shaded)" if signal.told else ""))
    axes.set_ylabel(f"power density of {words(signal.title).lower()} [{f'{unit}^2/Hz' if unit else '1/Hz'}]")
    return drawing.fitted()


# ---------------------------------------------------------------------- pictures of every folder that has the tables
def _panels(table: Table, titles: list[list[str]], heading: str) -> Any:
    """Groups of columns below each other over the time; None without a group."""
    kept = [part for group in titles if (part := [t for t in group if np.isfinite(table[t]).any()])]
    time = next(iter(table.values()))
    if not kept or not len(time):
        return None
    drawing = style.sheet(11.0, 0.9 + 1.6 * len(kept), heading)
    for axes, group in zip(
        drawing.subplots(len(kept), 1, squeeze=False, sharex=True)[:, 0], kept, strict=True
    ):
        together = np.concatenate([table[t] for t in group])
        size, unit = _shown(group[0], together)
        for column, color in zip(group, LINE_COLORS * 3, strict=False):
            t, v = envelope(time, table[column] / size)
            mark = "." if len(time) < 40 else ""
            axes.plot(t, v, color=color, linewidth=1.0, marker=mark, label=words(column))
        if len(group) == 1:
            axes.set_ylabel("\n".join(textwrap.wrap(label(group[0], unit), 22)))
        else:
            axes.set_ylabel(f"[{unit}]" if unit else "[-]")
            axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False, fontsize=8)
        style.level(axes, together / size, False)
        axes.margins(x=0.0)
    axes.set_xlabel("time [s]")
    return drawing.fitted()


def draw_indices(at: Source) -> Any:
    """Indices over the ends of their windows."""
    table = at.table(INDICES_TABLE)
    numbers = [t for t in list(table)[2:] if table[t].dtype.kind == "f"]
    names = {t: split_name(t)[0] for t in numbers}

    def group(*starts: str) -> list[str]:
        return [t for t in numbers if names[t].startswith(starts)]

    groups = [
        group("stick_slip"),
        group("stuck_share"),
        group("rotation"),
        group("mse"),
        group("efficiency"),
        group("depth_of_cut"),
        group("whirl_ratio"),
        group("rms_"),
        group("peak_"),
        group("impacts"),
    ]
    window = float(next(iter(table[t] for t in table if t.startswith("window ")))[0])
    return _panels(table, groups, f"{at.title}: indices of drilling dynamics, windows of {window:g} s")


def draw_whirl(at: Source) -> Any:
    """Class of whirl over time and measured depth; None without probes in a hole."""
    from matplotlib.colors import BoundaryNorm, ListedColormap
    from matplotlib.patches import Patch

    table = at.table(INDICES_TABLE)
    names = {
        float(name.removeprefix("whirl_")): t
        for t in table
        if (name := split_name(t)[0]).startswith("whirl_") and not name.startswith("whirl_ratio_")
    }
    time = next(iter(table.values()))
    if not names or not len(time):
        return None
    depths = sorted(names)
    classes = list(WHIRL_COLORS)
    rows = np.array([[classes.index(str(c)) for c in table[names[d]]] for d in depths])
    drawing = style.sheet(11.0, 1.7 + 0.5 * max(len(depths), 2), f"{at.title}: whirl over time and depth")
    axes = drawing.subplots()
    step = time[-1] - time[-2] if len(time) > 1 else 1.0
    edges = np.concatenate([time - step, time[-1:]])
    axes.pcolormesh(
        edges,
        np.arange(len(depths) + 1),
        rows,
        cmap=ListedColormap(list(WHIRL_COLORS.values())),
        norm=BoundaryNorm(np.arange(len(classes) + 1) - 0.5, len(classes)),
        edgecolors="face",
    )
    length, unit = style.depth_unit()
    axes.set_yticks(np.arange(len(depths)) + 0.5, [f"{round(d / length, 2):g} {unit}" for d in depths])
    axes.invert_yaxis()
    axes.grid(False)
    axes.set_xlabel("end of the window [s]")
    axes.set_ylabel("measured depth")
    handles = [Patch(facecolor=color, edgecolor="0.6", label=name) for name, color in WHIRL_COLORS.items()]
    axes.legend(handles=handles, loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False, fontsize=8.5)
    return drawing.fitted()


def draw_sensor(at: Source, name: str) -> Any:
    """Channels of a sensor over time: accelerations, rotation, loads, pressures."""
    table = read_sensor(at.folder.path, name)
    groups: dict[str, list[str]] = {}
    for heading in list(table)[1:]:
        column, unit = split_name(heading)
        key = "motion" if column.endswith("_motion") else unit
        groups.setdefault(key, []).append(heading)
    groups.pop("motion", None)
    return _panels(table, list(groups.values()), f"{at.title}: sensor {name}")


PICTURES: Pictures = {"indices": ((INDICES_TABLE,), draw_indices), "whirl": ((INDICES_TABLE,), draw_whirl)}
