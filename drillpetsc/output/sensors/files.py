"""Files of sensors: CSV, or HDF5 for many samples (manual: sec-guide-sensors)."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.output.files.tables import Column, Table, header, read_table

MOST_ROWS = 10**6  # of a CSV file; a sensor with more samples has an HDF5 file
FOLDER = "sensors"
SENSOR_TABLE = "sensors/*.csv"  # represents the file of any sensor in the catalogue


def sensor_file(folder: Path, name: str, rows: float, continued: bool = False) -> Path:
    """File of the sensor ``name`` in a run folder that gets about so many rows; a continued run keeps the file that it has."""
    table, many = (folder / FOLDER / f"{name}.{suffix}" for suffix in ("csv", "h5"))
    if continued and (table.is_file() or many.is_file()):
        return table if table.is_file() else many
    return many if rows > MOST_ROWS else table


class Hdf5Samples:
    """Samples as one dataset a column, named without its unit, which is the attribute `unit`."""

    def __init__(self, path: Path, columns: Sequence[Column], restart_time: float | None = None) -> None:
        header(columns)  # refuses two equal names
        self.path, self._names = path, [name for name, _ in columns]
        path.parent.mkdir(parents=True, exist_ok=True)
        import h5py

        continued = restart_time is not None and path.is_file()
        with h5py.File(path, "a" if continued else "w") as file:
            for name, unit in columns:
                if name not in file:
                    made = file.create_dataset(name, (0,), maxshape=(None,), chunks=(16384,), dtype=float)
                    made.attrs["unit"] = unit
            if continued:
                assert restart_time is not None
                time = file[self._names[0]][:]
                kept = int(np.searchsorted(time, restart_time * (1 + 1e-12), side="right"))
                for name in self._names:
                    file[name].resize((kept,))

    def add_rows(self, rows: FloatArray) -> None:
        """rows: (k, columns), SI.  The file is closed afterwards, so that a killed run leaves it whole."""
        if not len(rows):
            return
        import h5py

        with h5py.File(self.path, "r+") as file:
            for name, values in zip(self._names, rows.T, strict=True):
                dataset = file[name]
                dataset.resize((len(dataset) + len(values),))
                dataset[-len(values) :] = values

    def flush(self) -> None:
        """Flush every row to disk."""
        handle = os.open(self.path, os.O_RDONLY)
        os.fsync(handle)
        os.close(handle)

    def close(self) -> None:
        """Nothing is open between two calls."""


def open_samples(path: Path, columns: Sequence[Column], restart_time: float | None) -> Table | Hdf5Samples:
    """The file of a sensor, new, or continued at a time [s]; samples later than it are dropped."""
    kind: Any = Hdf5Samples if path.suffix == ".h5" else Table
    return kind(path, columns, restart_time=restart_time)


def sensor_names(folder: Path) -> list[str]:
    """Names of the sensors with a file in a run folder."""
    files = [f for f in (folder / FOLDER).glob("*") if f.suffix in (".csv", ".h5")]
    return sorted(f.stem for f in files)


def read_sensor(folder: Path, name: str) -> dict[str, np.ndarray]:
    """Columns of a sensor by heading, such as `ax [m/s2]`.  Raises FileNotFoundError for a sensor that the folder does not have."""
    table = folder / FOLDER / f"{name}.csv"
    if table.is_file():
        return read_table(table)
    path = table.with_suffix(".h5")
    if not path.is_file():
        has = ", ".join(sensor_names(folder)) or "no sensors"
        raise FileNotFoundError(f"{folder} has no sensor {name!r}; it has {has}")
    import h5py

    with h5py.File(path, "r") as file:
        units = {name: file[name].attrs["unit"] for name in file}
        columns = {f"{name} [{unit}]": np.array(file[name]) for name, unit in units.items()}
    return {"time [s]": columns.pop("time [s]"), **columns}


def covered(path: Path, columns: Sequence[Column]) -> float | None:
    """Time of the last sample in the file of a sensor [s], minus infinity without any; None if its columns differ."""
    if path.suffix == ".h5":
        import h5py

        with h5py.File(path, "r") as file:
            if set(file) != {name for name, _ in columns}:
                return None
            return float(file["time"][-1]) if len(file["time"]) else -np.inf
    with open(path, "rb") as table:
        if table.readline().decode().strip() != ",".join(header(columns)):
            return None
        table.seek(max(table.tell(), path.stat().st_size - 4096))
        lines = table.read().decode().splitlines(keepends=True)
    whole = [line for line in lines if line.endswith("\n") and line.count(",") == len(columns) - 1]
    return float(whole[-1].partition(",")[0]) if whole else -np.inf
