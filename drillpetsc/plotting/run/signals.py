"""Signals of a run folder for spectra: columns of sensors, of the history and of the probes."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from drillpetsc.errors import CaseError
from drillpetsc.output.files.run_folder import RunFolder
from drillpetsc.output.files.tables import read_table, split_name
from drillpetsc.output.sensors.files import read_sensor, sensor_names


@dataclass(frozen=True)
class Signal:
    """A column of a run.

    source: history, probes, or the name of a sensor; title: heading of the column; time: (n,) [s]; values: (n,) in SI.
    speed: (n,) rotation there [rad/s], of the lower end if the source has none; None without any.
    limit: frequency up to which the numbers hold [Hz]; told: the reason, for people; empty if it is half the rate.
    """

    source: str
    title: str
    time: np.ndarray
    values: np.ndarray
    speed: np.ndarray | None
    limit: float
    told: str

    @property
    def name(self) -> str:
        """Source and column, such as mwd:ax."""
        return f"{self.source}:{split_name(self.title)[0]}"

    @property
    def file(self) -> str:
        """Part of the name of a picture."""
        return self.name.replace(":", "_")


def signal(folder: Path, name: str, at: str = "--waterfall") -> Signal:
    """The signal SOURCE:COLUMN of a run folder, such as mwd:ax, history:bit_speed or probes:x_600.

    at: option, for messages.  Raises CaseError if the folder does not have it.
    """
    source, _, column = name.partition(":")
    tables = {"history": RunFolder(folder).history, "probes": RunFolder(folder).probes}
    sources = [*(key for key, file in tables.items() if file.is_file()), *sensor_names(folder)]
    if source not in sources:
        want = f"SOURCE:COLUMN, with a source of {', '.join(sources) or 'this folder, which has none'}"
        raise CaseError(at=at, got=name, want=want)
    table = read_table(tables[source]) if source in tables else read_sensor(folder, source)
    names = {split_name(title)[0]: title for title in table}
    choices = [key for key in names if key != "time"]
    if column not in choices:
        raise CaseError(at=at, got=name, want=f"{source}: with one of {', '.join(choices)}")
    time, values = table[names["time"]], table[names[column]]
    if len(time) < 4 or values.dtype.kind != "f":
        raise CaseError(at=at, got=name, want=f"a column of numbers with at least 4 rows, not {len(time)}")
    limit, told = 0.5 * (len(time) - 1) / float(time[-1] - time[0]), ""
    for row in RunFolder(folder).read_summary().get("sensors", ()):
        if row.get("name") == source and row.get("coarse_share"):
            limit = float(row["resolved_to"])
            told = (
                f"content above {limit:.3g} Hz is not resolved by the time steps "
                f"in {100 * row['coarse_share']:.3g} % of the time"
            )
    return Signal(
        source, names[column], time, values, _speed(folder, source, column, table, time), limit, told
    )


def _speed(
    folder: Path, source: str, column: str, table: dict[str, np.ndarray], time: np.ndarray
) -> np.ndarray | None:
    """Rotation at the times of a signal [rad/s]."""
    own = f"spin_{column.partition('_')[2]} [rad/s]" if source == "probes" else "spin [rad/s]"
    if own in table:
        return table[own]
    history = RunFolder(folder).history
    found = read_table(history) if history.is_file() else {}
    if "bit_speed [rad/s]" not in found:
        return None
    return np.interp(time, found["time [s]"], found["bit_speed [rad/s]"])
