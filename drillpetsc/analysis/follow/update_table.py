"""The table of `follow`: a row for each update."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.analysis.follow.follower import Update
from drillpetsc.analysis.follow.state import State
from drillpetsc.output.files.tables import header

READINGS = (("hook_load", "N"), ("torque", "N m"), ("pump_pressure", "Pa"))
#: name, unit and place in an update of the first columns
_LOAD = (
    ("row", "-", "number"),
    ("time", "s", "reading.time"),
    ("bit_depth", "m", "reading.load.bit_depth"),
    ("operation", "-", "reading.load.operation"),
    ("wob", "N", "reading.load.wob"),
    ("torque_on_bit", "N m", "reading.load.torque_on_bit"),
    ("rotation", "rad/s", "reading.load.rotation"),
    ("velocity", "m/s", "reading.load.velocity"),
    ("flow_rate", "m3/s", "reading.load.flow"),
)


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
    return [
        *((name, unit) for name, unit, _ in _LOAD),
        *((name + end, unit) for name, unit in READINGS for end in ("", "_forecast", "_sd")),
        *((q.name + end, units.get(q.name, "-")) for q in states for end in ("", "_sd")),
        ("ahead_bit_depth", "m"),
        *((f"ahead_{name}{end}", unit) for name, unit in READINGS[:2] for end in ("", "_sd")),
        *((f"{model}_{name}", unit) for model in ("soft", "stiff") for name, unit in READINGS[:2]),
        *(("taught", "-"), ("alarm", "-")),
    ]


def _cells(update: Update) -> list[Any]:
    cells = [attrgetter(path)(update) for _, _, path in _LOAD]
    for name, _ in READINGS:
        error = update.forecast.get(name)
        forecast = [math.nan] * 2 if error is None else [error.forecast, error.sd]
        cells += [getattr(update.reading, name), *forecast]
    cells += np.column_stack([update.belief.mean, update.belief.sd]).ravel().tolist()
    ahead, both = update.ahead, update.compared
    found = [] if ahead is None else [ahead.bit_depth, *np.column_stack([ahead.mean, ahead.sd]).ravel()]
    cells += found or [math.nan] * 5
    cells += [math.nan] * 4 if both is None else [*both.soft.tolist(), *both.stiff.tolist()]
    cells = [f"{q:.9g}" if isinstance(q, float) else q for q in cells]
    return [*cells, int(update.taught), "; ".join(q.kind for q in update.alarms)]
