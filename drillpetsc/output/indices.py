"""Indices of drilling dynamics of a run, from its tables and the files of its sensors (manual: sec-vibration-indices)."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc import vibration
from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.formation import DragBit
from drillpetsc.case.blocks.rig import STANDARD_GRAVITY
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.output import catalogue
from drillpetsc.output.files.fields import last_sizes
from drillpetsc.output.files.run_folder import INDICES_TABLE, RunFolder
from drillpetsc.output.files.tables import read_table, split_name, write_table
from drillpetsc.output.sensors.files import read_sensor, sensor_names
from drillpetsc.output.shown_units import unit_of
from drillpetsc.unit_systems import System, shown

IMPACT = 10 * STANDARD_GRAVITY  # lateral acceleration of an impact [m/s2]
FEWEST = 20  # rows in a window below which its largest and smallest values mean little
MANY = 0.1  # share of windows without a result from which on it is reported
MOST_WINDOWS = 100_000  # of a run
DEFAULT_WINDOW, DEFAULT_EVERY = 20.0, 1.0  # [s]


@dataclass
class IndexTable:
    """Indices at the ends of windows.

    columns: name, unit -> (k,) numbers or words; summary: for summary.json; warnings: for the user.
    """

    columns: dict[tuple[str, str], Any]
    summary: dict[str, Any]
    warnings: list[str] = field(default_factory=list)

    def write(self, folder: Path) -> Path:
        """Write indices.csv into a run folder."""
        return write_table(folder / INDICES_TABLE, list(self.columns), list(self.columns.values()))

    def lines(self, units: System) -> list[str]:
        """Lines on the indices: mean and largest over the windows, in a system of units; accelerations in g."""
        s = self.summary
        out = [f"{s['windows']} windows of {s['window']:g} s", f"  {'':48} {'mean':>10} {'largest':>10}"]
        for title, largest in s["largest"].items():
            name, unit = split_name(title)
            size, _, text = (STANDARD_GRAVITY, 0.0, "g") if unit == "m/s2" else unit_of(title, units)
            mean, most = (
                "-" if value is None else f"{value / size:.4g}" for value in (s["mean"][title], largest)
            )
            out.append(f"  {catalogue.label(name, units) or name:48} {mean:>10} {most:>10} {text}".rstrip())
        for depth, classes in s["whirl"].items():
            shares = ", ".join(f"{name} {100 * share:.3g} %" for name, share in classes.items())
            out.append(f"  Whirl at {shown(float(depth), 'length', units, 6)}: {shares}")
        return out


def indices(
    folder: Path, case: Case, window: float = DEFAULT_WINDOW, every: float = DEFAULT_EVERY
) -> IndexTable:
    """Indices of the run in a folder, in windows of a length [s] whose ends are ``every`` [s] apart.

    A run shorter than a window has one row, over the whole run.  Raises CaseError if the folder has no history of a string.
    """
    run = RunFolder(folder)
    history = _columns(read_table(run.history)) if run.history.is_file() else {}
    if "bit_speed" not in history:
        raise CaseError(
            file=folder, got="no history of a string", want="the folder of a run, not with hold_string"
        )
    time = history["time"]
    if len(time) < 2:
        raise CaseError(file=run.history, got=f"{len(time)} rows", want="at least 2")
    warnings = []
    if time[-1] - time[0] < window * (1 - 1e-9):
        warnings.append(
            f"indices: the run of {time[-1] - time[0]:g} s is shorter than a window of {window:g} s; the one row covers the run"
        )
        window, ends = float(time[-1] - time[0]), time[-1:]
    else:
        most = (time[-1] - time[0] - window) / MOST_WINDOWS
        if every < most:
            raise CaseError(
                at="every",
                got=f"{every:g} s",
                want=f"at least {most:.3g} s: {MOST_WINDOWS:g} windows in the run",
            )
        count = int((time[-1] - time[0] - window) / every * (1 + 1e-12) + 1e-9)
        ends = time[0] + window + every * np.arange(count + 1)
    spans = [_rows(time, end, window) for end in ends]
    rows = min(s.stop - s.start for s in spans)
    if rows < FEWEST:
        warnings.append(
            f"indices: a window of {window:g} s has {rows} rows of history.csv, fewer than {FEWEST}: the stick-slip index is too "
            "small; a smaller output.history_every helps"
        )
    columns: dict[tuple[str, str], Any] = {("time", "s"): ends, ("window", "s"): np.full(len(ends), window)}
    columns |= _rotation(history, spans) | _drilling(history, spans, case)
    whirl, told = _whirl(run, case, ends)
    columns |= whirl
    warnings += told
    warnings += _undefined(columns)
    for name in sensor_names(folder):
        columns |= _sensor(name, _columns(read_sensor(folder, name)), case, ends, window)
    return IndexTable(columns, _summary(columns, window), warnings)


def _undefined(columns: dict[tuple[str, str], Any]) -> list[str]:
    """Why an index has no number in any window."""
    reasons = {
        (
            "stick_slip",
            "-",
        ): "stick-slip index is not defined: the lower end turns at less than 1 rpm on average",
        ("mse", "Pa"): "mechanical specific energy is not defined: the bit makes no progress",
        ("depth_of_cut", "m"): "depth of cut is not defined: the bit turns at less than 1 rpm on average",
    }
    return [
        f"indices: the {text}"
        for key, text in reasons.items()
        if key in columns and np.isnan(columns[key]).all()
    ]


def _columns(table: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    return {split_name(title)[0]: values for title, values in table.items()}


def _rows(time: FloatArray, end: float, window: float) -> slice:
    """Rows of the window that ends at a time [s]."""
    near = 1e-9 * max(1.0, abs(end))
    return slice(
        int(np.searchsorted(time, end - window - near)), int(np.searchsorted(time, end + near, side="right"))
    )


def _rotation(history: dict[str, np.ndarray], spans: list[slice]) -> dict[tuple[str, str], Any]:
    time, speed = history["time"], history["bit_speed"]
    return {
        ("rotation", "rad/s"): np.array([vibration.time_mean(time[s], speed[s]) for s in spans]),
        ("stick_slip", "-"): np.array([vibration.stick_slip_index(speed[s], time[s]) for s in spans]),
        ("stuck_share", "-"): np.array([vibration.stuck_share(time[s], speed[s]) for s in spans]),
    }


def _drilling(history: dict[str, np.ndarray], spans: list[slice], case: Case) -> dict[tuple[str, str], Any]:
    """Energy and depth of cut of a bit that drills, from means over the window: of weight, of power and of progress."""
    diameter = getattr(case.string[-1], "od", None)
    if "rop" not in history or diameter is None or case.formation is None:
        return {}
    if not (case.formation.drillability or any(layer.drillability for layer in case.formation.layers)):
        return {}  # rock that cannot be drilled
    law = case.formation.bit_law
    strength = law.specific_energy if isinstance(law, DragBit) else None
    energy, cut = [], []
    for s in spans:
        time, speed, rop = (
            history["time"][s],
            history["bit_speed"][s],
            vibration.time_mean(history["time"][s], history["rop"][s]),
        )
        weight, power = (
            vibration.time_mean(time, history["wob"][s]),
            vibration.time_mean(time, history["bit_torque"][s] * speed),
        )
        energy.append(vibration.mechanical_specific_energy(weight, power, 1.0, rop, diameter))
        cut.append(vibration.depth_of_cut(rop, vibration.time_mean(time, speed)))
    out: dict[tuple[str, str], Any] = {("mse", "Pa"): np.array(energy)}
    if strength is not None:
        out["efficiency", "-"] = np.array([vibration.drilling_efficiency(strength, e) for e in energy])
    return out | {("depth_of_cut", "m"): np.array(cut)}


def _whirl(run: RunFolder, case: Case, ends: FloatArray) -> tuple[dict[tuple[str, str], Any], list[str]]:
    """Whirl at the probes in the hole, and sentences about it."""
    if not run.probes.is_file() or case.well is None:
        return {}, []
    probes, found = _columns(read_table(run.probes)), {}
    sizes, unresolved, still = last_sizes(run.path), list[str](), list[str]()
    units = case.shown_units
    for name in [key.removeprefix("x_") for key in probes if key.startswith("x_")]:
        radius, clearance = (np.nan, np.nan)
        if sizes is not None:
            radius, clearance = (float(np.interp(float(name), sizes[0], values)) for values in sizes[1:])
        got = vibration.whirl(
            probes["time"],
            probes[f"x_{name}"],
            probes[f"y_{name}"],
            probes[f"spin_{name}"],
            radius,
            clearance,
            ends,
        )
        found["whirl_ratio_" + name, "-"] = got.ratio
        words = np.array([vibration.CLASSES[k] for k in got.number])
        found["whirl_" + name, "-"] = words
        late = np.isfinite(got.radius)  # three revolutions are over
        if not late.any():
            still.append(shown(float(name), "length", units, 6))
        elif np.mean(words[late] == "unresolved") > MANY:
            unresolved.append(shown(float(name), "length", units, 6))
    told = []
    if still:
        told.append(
            f"indices: whirl at {', '.join(still)} is not known: the string makes fewer than three turns"
        )
    if unresolved:
        every = float(np.median(np.diff(probes["time"])))
        told.append(
            f"indices: whirl at {', '.join(unresolved)} is not resolved in more than {100 * MANY:g} % of the windows: output.history_every "
            f"of {every:g} s has too few rows for a string that rolls on the wall, or the string turns back and forth"
        )
    return found, told


def _sensor(
    name: str, table: dict[str, np.ndarray], case: Case, ends: FloatArray, window: float
) -> dict[tuple[str, str], Any]:
    """Stick-slip, accelerations without gravity and impacts of a sensor."""
    sensor = next((s for s in case.output.sensors if s.name == name), None)
    if sensor is None or not len(table["time"]):
        return {}
    spans = [_rows(table["time"], end, window) for end in ends]
    out: dict[tuple[str, str], Any] = {}
    if "spin" in table:
        out[f"stick_slip_{name}", "-"] = np.array(
            [vibration.stick_slip_index(table["spin"][s], table["time"][s]) for s in spans]
        )
    moved = {
        axis: table[column]
        for axis in ("ax", "ay", "az")
        if (column := f"{axis}_motion" if sensor.gravity else axis) in table
    }
    ways: dict[str, FloatArray] = {}
    if "ax" in moved:
        ways["axial"] = np.abs(moved["ax"])
    if "ay" in moved and "az" in moved:
        ways["lateral"] = np.hypot(moved["ay"], moved["az"])
    if "spin_acceleration" in table and sensor.radius:
        ways["torsional"] = np.abs(sensor.radius * table["spin_acceleration"])
    for way, size in ways.items():
        out[f"rms_{way}_{name}", "m/s2"] = np.array([vibration.root_mean_square(size[s]) for s in spans])
    for way, size in ways.items():
        out[f"peak_{way}_{name}", "m/s2"] = np.array([float(size[s].max(initial=0.0)) for s in spans])
    if "lateral" in ways:
        out[f"impacts_{name}", "-"] = np.array(
            [vibration.exceedances(ways["lateral"][s], IMPACT) for s in spans]
        )
    return out


def _summary(columns: dict[tuple[str, str], Any], window: float) -> dict[str, Any]:
    """Largest values over the windows, the shares of the classes of whirl, and the last row."""
    count = len(next(iter(columns.values())))
    out: dict[str, Any] = {"windows": count, "window": window, "largest": {}, "mean": {}, "whirl": {}}
    for (name, unit), values in list(columns.items())[2:]:
        if values.dtype.kind in "fi":
            finite = values[np.isfinite(values)]
            title = f"{name} [{unit}]"
            out["largest"][title] = float(finite.max()) if len(finite) else None
            out["mean"][title] = float(finite.mean()) if len(finite) else None
        else:
            classes, times = np.unique(values, return_counts=True)
            out["whirl"][name.removeprefix("whirl_")] = {
                str(c): float(k / count) for c, k in zip(classes, times, strict=True)
            }
    return out
