"""The table of `follow`: a row for each update."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.analysis.follow.follower import Update
from drillpetsc.analysis.follow.state import State
from drillpetsc.output.files.tables import header

READINGS = (("hook_load", "N"), ("torque", "N m"), ("pump_pressure", "Pa"))


class UpdateTable:
    """A CSV that grows. states: of the filter, which give columns; kept: rows to keep of a table that is there, None for a new one."""

    def __init__(self, path: Path, states: Sequence[State], kept: int | None) -> None:
        if kept is None:
            path.write_text(",".join(header(columns_of(states))) + "\n", encoding="utf-8")
        else:
            lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
            path.write_text("".join(lines[: 1 + kept]), encoding="utf-8")
        self._file = open(path, "a", newline="", encoding="utf-8")  # noqa: SIM115
        self._writer = csv.writer(self._file, lineterminator="\n")

    def add(self, update: Update) -> None:
        """Write a row."""
        self._writer.writerow(_cells(update))

    def flush(self) -> None:
        """Hand the rows to the file system."""
        self._file.flush()

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def columns_of(states: Sequence[State]) -> list[tuple[str, str]]:
    """(name, unit) of the columns."""
    units = {"block_weight": "N", "running_drag": "N s/m", "bit_torque": "m", "hook_error": "N"}
    columns = [
        ("row", "-"),
        ("time", "s"),
        ("bit_depth", "m"),
        ("operation", "-"),
        ("wob", "N"),
        ("torque_on_bit", "N m"),
    ]
    columns += [("rotation", "rad/s"), ("velocity", "m/s"), ("flow_rate", "m3/s")]
    for name, unit in READINGS:
        columns += [(name, unit), (f"{name}_forecast", unit), (f"{name}_sd", unit)]
    for state in states:
        columns += [
            (state.name, units.get(state.name, "-")),
            (f"{state.name}_sd", units.get(state.name, "-")),
        ]
    columns += [("ahead_bit_depth", "m")]
    for name, unit in READINGS[:2]:
        columns += [(f"ahead_{name}", unit), (f"ahead_{name}_sd", unit)]
    for model in ("soft", "stiff"):
        columns += [(f"{model}_{name}", unit) for name, unit in READINGS[:2]]
    return [*columns, ("taught", "-"), ("alarm", "-")]


def _cells(update: Update) -> list[Any]:
    row, load = update.reading, update.reading.load
    cells: list[Any] = [
        update.number,
        row.time,
        load.bit_depth,
        load.operation,
        load.wob,
        load.torque_on_bit,
    ]
    cells += [load.rotation, load.velocity, load.flow]
    for name, _ in READINGS:
        error = update.forecast.get(name)
        cells += [getattr(row, name), *([math.nan] * 2 if error is None else [error.forecast, error.sd])]
    for mean, sd in zip(update.belief.mean, update.belief.sd, strict=True):
        cells += [mean, sd]
    ahead = update.ahead
    cells += (
        [math.nan] * 5
        if ahead is None
        else [ahead.bit_depth, *np.column_stack([ahead.mean, ahead.sd]).ravel()]
    )
    both = update.compared
    cells += [math.nan] * 4 if both is None else [*both.soft.tolist(), *both.stiff.tolist()]
    cells = [f"{q:.9g}" if isinstance(q, float) else q for q in cells]
    return [*cells, int(update.taught), "; ".join(q.kind for q in update.alarms)]
