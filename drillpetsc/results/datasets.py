"""Tables as datasets of xarray, or as arrays by name if xarray is not installed; tables as frames of pandas."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.errors import CaseError
from drillpetsc.output.files.fields import read_series
from drillpetsc.output.files.tables import split_name
from drillpetsc.output.files.vtk import read_frame
from drillpetsc.results.described import attributes, in_system
from drillpetsc.unit_systems import System

EXTRA = "pip install 'drillpetsc[notebook]'"
#: table -> column that is the coordinate of its rows; the rows of other tables are numbered
COORDINATES = {
    "history.csv": "time",
    "probes.csv": "time",
    "indices.csv": "time",
    "sensors/*.csv": "time",
    "statics.csv": "md",
    "trajectory.csv": "md",
    "limits.csv": "md",
    "flow_curve.csv": "pump_flow",
    "modes.csv": "mode",
}
ROWS = "row"
DIRECTIONS = ("north", "east", "down")
STRING = "string/*.vtu"

Table = Mapping[str, np.ndarray]
"""Columns by heading, such as `wob [N]`, in the unit of the heading."""


class Columns(dict[str, np.ndarray]):
    """Arrays by name, in place of a dataset of xarray, which is not installed.

    attributes: name -> units, long_name, label, mnemonic, sign, description
    dims: name -> names of the dimensions of its array
    """

    def __init__(
        self,
        arrays: Mapping[str, np.ndarray] = {},  # noqa: B006 (not changed)
        attributes: Mapping[str, dict[str, str]] | None = None,
        dims: Mapping[str, tuple[str, ...]] | None = None,
    ) -> None:
        super().__init__(arrays)
        self.attributes = dict(attributes or {})
        self.dims = dict(dims or {})

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        raise AttributeError(
            f"{name!r}: these are arrays by name, because xarray is not installed; datasets need: {EXTRA}"
        )

    def __repr__(self) -> str:
        lines = [
            f"  {name} ({', '.join(self.dims.get(name, ()))}) {self.attributes.get(name, {}).get('units', '')}".rstrip()
            for name in self
        ]
        return "\n".join(["arrays:", *lines, f"xarray is not installed; datasets need: {EXTRA}"])


def dataset(table: Table, file: str, title: str = "") -> Any:
    """A table as a dataset of xarray, or as `Columns` if xarray is not installed. The arrays are copies.

    file: name of the table, which determines its coordinate and what its columns are; title: of the run
    """
    coordinate = COORDINATES.get(file, "")
    names = {split_name(heading)[0]: heading for heading in table}
    dimension = coordinate if coordinate in names else ROWS
    arrays = {name: np.array(table[heading]) for name, heading in names.items()}
    described = {
        name: attributes(heading, file, words=arrays[name].dtype.kind not in "fiu")
        for name, heading in names.items()
    }
    dims = dict.fromkeys(names, (dimension,))
    return assembled(arrays, described, dims, {dimension} & set(names), title)


def assembled(
    arrays: Mapping[str, np.ndarray],
    described: Mapping[str, dict[str, str]],
    dims: Mapping[str, tuple[str, ...]],
    coordinates: set[str],
    title: str,
) -> Any:
    """A dataset of xarray, or `Columns` if xarray is not installed, from arrays by name."""
    try:
        import xarray
    except ImportError:
        return Columns(arrays, described, dims)
    variables = {name: (dims[name], values, described.get(name, {})) for name, values in arrays.items()}
    return xarray.Dataset(
        {name: variable for name, variable in variables.items() if name not in coordinates},
        coords={name: variable for name, variable in variables.items() if name in coordinates},
        attrs={"title": title} if title else {},
    )


# ---------------------------------------------------------------------- the string
StringFrames = tuple[np.ndarray, Table]
"""Times (k,) [s], and fields by heading: (k, n) or (k, n, 3) at the n nodes."""


def read_string(folder: Path) -> StringFrames:
    """All frames of the string in a run folder; CaseError if there are none, or they have different nodes."""
    series = read_series(folder)
    if not series:
        raise CaseError(file=folder, want="a run folder with frames of the string (string.pvd)")
    frames = [read_frame(path) for _, path in series]
    if len({len(frame.points) for frame in frames}) > 1:
        raise CaseError(
            file=folder, got="frames with different numbers of nodes", want="frames of one mesh of the string"
        )
    fields = {
        name: np.stack([frame.point_data[name] for frame in frames])
        for name in frames[0].point_data
        if all(name in frame.point_data for frame in frames)
    }
    return np.array([time for time, _ in series]), {
        "position [m]": np.stack([frame.points for frame in frames]),
        **fields,
    }


def string_dataset(frames: StringFrames, title: str = "") -> Any:
    """The string over time as a dataset of xarray, or as `Columns` if xarray is not installed. The arrays are copies.

    Dimensions are time, md (measured depth of the nodes on the string) and, for vectors, direction: north, east, down.
    """
    times, fields = frames
    arrays: dict[str, np.ndarray] = {"time": np.array(times)}
    dims: dict[str, tuple[str, ...]] = {"time": ("time",), "md": ("md",)}
    described = {"time": attributes("time [s]", "history.csv")}
    for heading, values in fields.items():
        name, _ = split_name(heading)
        described[name] = attributes(heading, STRING)
        if name == "md":  # of the nodes on the unstrained string: the same in all frames
            arrays[name] = np.array(values[0])
            continue
        arrays[name] = np.array(values)
        dims[name] = ("time", "md", "direction")[: values.ndim]
        if values.ndim == 3 and "direction" not in arrays:
            arrays["direction"], dims["direction"] = np.array(DIRECTIONS), ("direction",)
    return assembled(arrays, described, dims, {"time", "md", "direction"}, title)


# ---------------------------------------------------------------------- pandas
def frame(table: Table, file: str, system: System) -> Any:
    """A table as a frame of pandas in a system of units; headings are `hook_load [klbf]`.

    The coordinate of the table is the index. Raises CaseError if pandas is not installed.
    """
    try:
        import pandas
    except ImportError as error:
        raise CaseError(at="to_frame", want=f"the package pandas: {EXTRA}", hint=str(error)) from None
    columns = dict(in_system(heading, values, system) for heading, values in table.items())
    made = pandas.DataFrame({heading: np.array(values) for heading, values in columns.items()})
    coordinate = COORDINATES.get(file)
    index = next((heading for heading in columns if split_name(heading)[0] == coordinate), None)
    return made if index is None else made.set_index(index)
