"""Readings of a rig's log beside the columns of a run's history, at the times of the run."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.logs.log import read_log

#: channel of a log -> column of history.csv
COLUMNS = {
    "hook_load": "hook_load",
    "torque": "surface_torque",
    "rpm": "top_speed",
    "wob_downhole": "wob",
    "torque_downhole": "bit_torque",
    "bit_rpm": "bit_speed",
}
FEWEST_ROWS = 10
#: least standard error that is assumed, over a column's range, and over its largest value
SMALLEST_SHARE, OF_LARGEST = 0.01, 1e-3
TO_SIGMA = 1.4826 / np.sqrt(6.0)  # of the median size of second differences of independent errors


@dataclass(frozen=True)
class LogSeries:
    """Readings (n,) of a log in SI, column after column.

    columns: of history.csv; column: number of each reading's; time: of the run [s].
    scatter: (columns,) standard error that the change from row to row shows; notes: what was left out.
    """

    file: Path
    columns: tuple[str, ...]
    column: np.ndarray
    time: FloatArray
    value: FloatArray
    scatter: FloatArray
    notes: tuple[str, ...]

    @property
    def end(self) -> float:
        """Time of the last reading [s]."""
        return float(self.time.max())


def log_series(file: str, case: Case, history: Collection[str]) -> LogSeries:
    """The readings of a log that a run computes.  history: columns of the run's history.

    A log with clock times begins with the run.  Raises CaseError for a log without such columns, with too few rows, or with rows outside
    of the run.
    """
    log, path = read_log([file]), Path(file)
    if not log.by_time:
        raise CaseError(file=path, got="a log by depth", want="a log by time, with a column such as time [s]")
    time, end = log.values["time"] + log.begins, case.given_time.end
    outside = np.flatnonzero((time < 0) | (time > end * (1 + 1e-9)))
    if len(outside):
        want = f"times from 0 to {end:g} s, the end of the run (time.end)"
        raise CaseError(file=path, at=log.titles["time"], got=f"{time[outside[0]]:g} s", want=want)
    common = {c: name for c, name in COLUMNS.items() if c in log.values and name in history}
    notes = [
        f"{log.titles[c]} is not compared: the run has no {COLUMNS[c]}"
        for c in COLUMNS
        if c in log.values and c not in common
    ]
    parts: list[tuple[np.ndarray, FloatArray, FloatArray]] = []
    columns: list[str] = []
    scatter: list[float] = []
    for channel, name in common.items():
        values = log.values[channel]
        known = np.isfinite(values)
        if known.sum() < FEWEST_ROWS:
            notes.append(
                f"{log.titles[channel]} is not compared: {known.sum()} numbers, fewer than {FEWEST_ROWS}"
            )
            continue
        if not known.all():
            notes.append(f"{log.titles[channel]}: {(~known).sum()} rows without a number are left out")
        values = values[known] - _above_string(case, channel)
        parts.append((np.full(known.sum(), len(columns)), time[known], values))
        columns.append(name)
        scatter.append(scatter_of_rows(values))
    if not columns:
        have = ", ".join(title for channel, title in log.titles.items() if channel != "time") or "none"
        want = f"at least {FEWEST_ROWS} numbers in a column that the run has: {', '.join(_words(history))}"
        raise CaseError(file=path, got=f"{len(log)} rows of {have}", want=want)
    column, at, value = (np.concatenate(q) for q in zip(*parts, strict=True))
    return LogSeries(
        path, tuple(columns), column, at, value, np.array(scatter), (*notes, *log.remarks, *log.warnings)
    )


def _words(history: Collection[str]) -> list[str]:
    return [channel.replace("_", " ") for channel, name in COLUMNS.items() if name in history]


def _above_string(case: Case, channel: str) -> float:
    """What a hook load contains beside the string's [N]: the block, unless the case says that it is left out."""
    if channel != "hook_load" or case.rig is None:
        return 0.0
    sensor = case.rig.hookload_sensor
    if sensor is not None and sensor.at == "dead_line":
        want = "hook for a calibration of runs: what a dead line reads depends on the direction of the block"
        raise CaseError(at="rig.hookload_sensor.at", got="dead_line", want=want)
    excluded = case.roadmap is not None and case.roadmap.hookload_excludes_block
    return 0.0 if excluded else case.rig.block_weight or 0.0


def scatter_of_rows(values: FloatArray) -> float:
    """Standard error of readings (n,) in order, from their second differences."""
    second = np.abs(values[:-2] - 2 * values[1:-1] + values[2:])
    least = max(SMALLEST_SHARE * float(np.ptp(values)), OF_LARGEST * float(np.abs(values).max()))
    return max(TO_SIGMA * float(np.median(second)), least) or 1.0
