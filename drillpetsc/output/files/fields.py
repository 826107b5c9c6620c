"""The string over time (string.pvd, string/NNNNNN.vtu) and the hole's wall (well.vtu), for ParaView and
pyvista as they are.
"""

from __future__ import annotations

import hashlib
import os
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np

from drillpetsc.errors import CaseError
from drillpetsc.output.files.atomic import replace_file, replace_text, to_disk
from drillpetsc.output.files.tables import DIGEST
from drillpetsc.output.files.vtk import read_frame, write_vtu


def _checked(data: Mapping[str, np.ndarray] | None, count: int, where: str) -> dict[str, np.ndarray]:
    arrays = {}
    for name, values in (data or {}).items():
        array = np.ascontiguousarray(values)
        array = array.astype(np.int32) if array.dtype == bool else array
        if array.ndim not in (1, 2) or len(array) != count:
            raise ValueError(
                f"{where} data {name!r} has shape {array.shape}, wanted ({count},) or ({count}, k)"
            )
        arrays[name] = array
    return arrays


class FieldWriter:
    """Writes the deformed string, one .vtu a call, and updates string.pvd after each of them.

    With `restart_time` a series is continued: frames later than that time are removed, and numbering continues.
    """

    def __init__(
        self, folder: str | os.PathLike, *, restart_time: float | None = None, compress: bool = False
    ) -> None:
        """folder: the run folder; string.pvd and string/ are made in it."""
        self.series = Path(folder) / "string.pvd"
        self.frames = Path(folder) / "string"
        self.frames.mkdir(parents=True, exist_ok=True)
        self.compress = compress
        self._entries: list[tuple[float, str]] = []
        self._listed: list[str] = []  # their lines in string.pvd
        self._new: list[Path] = []  # frames that the disk may not have yet
        if restart_time is not None and self.series.exists():
            self._entries = [
                (time, f"string/{file.name}") for time, file in _until(read_series(folder), restart_time)
            ]
        kept = {name for _, name in self._entries}
        for file in self.frames.glob("[0-9]*.vtu"):
            if f"string/{file.name}" not in kept:
                file.unlink()
        self._next = 1 + max((int(Path(name).stem) for name in kept), default=-1)
        self._digest = _digest((time, self.series.parent / name) for time, name in self._entries)
        self._write_series()

    def write(
        self,
        time: float,
        points: np.ndarray,
        point_data: Mapping[str, np.ndarray],
        cell_data: Mapping[str, np.ndarray] | None = None,
    ) -> Path:
        """Write one frame.

        time: [s]. points: (n, 3) deformed positions [m], in order along the string; n - 1 straight lines join
        them.
        point_data: {"axial_force [N]": (n,), "displacement [m]": (n, 3), ...}; cell_data likewise with n - 1
        values.
        """
        points = np.ascontiguousarray(points, dtype=float)
        if points.ndim != 2 or points.shape[1] != 3 or len(points) < 2:
            raise ValueError(f"points of shape {points.shape}, wanted (n, 3) with n >= 2")
        count = len(points)
        lines = np.column_stack((np.arange(count - 1), np.arange(1, count)))
        at_points = _checked(point_data, count, "point")
        on_cells = _checked(cell_data, count - 1, "cell")
        name = f"{self._next:06d}.vtu"
        path = replace_file(
            self.frames / name,
            lambda file: write_vtu(file, points, "line", lines, at_points, on_cells, self.compress),
        )
        self._next += 1
        self._new.append(path)
        self._entries.append((float(time), f"string/{name}"))
        _add_frame(self._digest, float(time), path)
        self._write_series()
        return path

    @property
    def written(self) -> tuple[int, str]:
        """Number of the frames, and a digest of them with their times, as ``Table.written``."""
        return len(self._entries), self._digest.hexdigest()

    def flush(self) -> None:
        """Wait until the disk has every frame and their list (for a checkpoint; a kill of the process needs
        no flush)."""
        for file in (*self._new, *([self.frames] if self._new else []), self.series, self.series.parent):
            to_disk(file)
        self._new = []

    def _write_series(self) -> None:
        self._listed += map(_listed, self._entries[len(self._listed) :])
        _write_list(self.series, self._listed)


def _listed(entry: tuple[float, str]) -> str:
    """Line of a series for a time [s] and its file."""
    return f'    <DataSet timestep="{entry[0]!r}" group="" part="0" file="{entry[1]}"/>\n'


def _write_list(path: Path, lines: list[str]) -> None:
    replace_text(
        path,
        '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">\n'
        f"  <Collection>\n{''.join(lines)}  </Collection>\n</VTKFile>\n",
    )


def write_series(path: Path, entries: Sequence[tuple[float, str]]) -> None:
    """Write a .pvd of times [s] and the files that it lists, relative to it."""
    _write_list(path, [_listed(entry) for entry in entries])


def read_series(folder: str | os.PathLike) -> list[tuple[float, Path]]:
    """The frames of a run folder in order of time: [(time [s], path)]; empty when the run wrote none.

    Raises CaseError if their list is damaged.
    """
    series = Path(folder) / "string.pvd"
    if not series.exists():
        return []
    try:
        sets = ElementTree.parse(series).getroot().iter("DataSet")
        return sorted((float(q.attrib["timestep"]), series.parent / q.attrib["file"]) for q in sets)
    except (ElementTree.ParseError, KeyError, ValueError) as error:
        raise CaseError(
            file=series,
            got=f"a damaged file ({error})",
            want="the list of the frames of a run",
            hint="take the file from a copy of the run folder",
        ) from None


def last_sizes(folder: str | os.PathLike) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """Measured depth, outer radius and clearance of the nodes [m], from the last frame; None without a frame in a hole."""
    series = read_series(folder)
    data = read_frame(series[-1][1]).point_data if series else {}
    if not {"md [m]", "hole_radius [m]", "outer_radius [m]"} <= set(data):
        return None
    radius = data["outer_radius [m]"]
    return data["md [m]"], radius, data["hole_radius [m]"] - radius


def frames_written(folder: str | os.PathLike, until: float) -> tuple[int, str]:
    """``FieldWriter.written`` of the frames of a folder up to ``until`` [s]."""
    frames = _until(read_series(folder), until)
    return len(frames), _digest(frames).hexdigest()


def _until(frames: list[tuple[float, Path]], until: float) -> list[tuple[float, Path]]:
    return [(time, file) for time, file in frames if time <= until + 1e-12 * abs(until)]


def _digest(frames: Iterable[tuple[float, Path]]) -> hashlib.blake2b:
    digest = hashlib.blake2b(digest_size=DIGEST)
    for time, file in frames:
        _add_frame(digest, time, file)
    return digest


def _add_frame(digest: hashlib.blake2b, time: float, file: Path) -> None:
    digest.update(f"{time!r} {file.name}\n".encode())
    digest.update(file.read_bytes())


def write_well(
    path: str | os.PathLike,
    md: np.ndarray,
    center: np.ndarray,
    radius: np.ndarray,
    friction: np.ndarray | None = None,
    sides: int = 24,
) -> Path:
    """Write the hole's wall as a tube of quadrilaterals around its axis.

    md: (n,) measured depth [m], not falling. center: (n, 3) axis of the hole [m]. radius: (n,) [m]. friction:
    (n,) [-]. A step of the radius is a station given twice, above and below it.
    """
    md, center = np.asarray(md, dtype=float), np.asarray(center, dtype=float)
    count = len(md)
    if count < 2 or center.shape != (count, 3):
        raise ValueError(
            f"the well needs two stations or more and a center (n, 3), got {md.shape} and {center.shape}"
        )
    stations = {"md [m]": md, "radius [m]": np.asarray(radius, dtype=float)}
    if friction is not None:
        stations["friction [-]"] = np.asarray(friction, dtype=float)
    stations = _checked(stations, count, "station")
    first, second = cross_section_axes(center)
    angle = 2 * np.pi * np.arange(sides) / sides
    around = np.cos(angle)[:, None] * first[:, None, :] + np.sin(angle)[:, None] * second[:, None, :]
    points = (center[:, None, :] + stations["radius [m]"][:, None, None] * around).reshape(-1, 3)
    ring, corner = np.meshgrid(np.arange(count - 1) * sides, np.arange(sides), indexing="ij")
    beside = (corner + 1) % sides
    quads = np.stack(
        (ring + corner, ring + beside, ring + sides + beside, ring + sides + corner), axis=-1
    ).reshape(-1, 4)
    data = {name: np.repeat(values, sides, axis=0) for name, values in stations.items()}
    return replace_file(path, lambda file: write_vtu(file, points, "quad", quads, data, {}, True))


def cross_section_axes(center: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two unit vectors (n, 3) each, square to the polyline center (n, 3) [m] and to each other, turning as
    little as possible along it.

    Double reflection: Wang, Juettler, Zheng, Liu 2008, Computation of rotation minimizing frames, ACM
    Transactions on Graphics 27(1). Stations that coincide share one tangent.
    """
    steps = np.diff(center, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    moving = lengths > 0
    if not moving.any():
        raise ValueError("the well has no length")
    owner = np.where(moving, np.arange(len(steps)), -1)
    owner = np.maximum.accumulate(owner)
    owner[owner < 0] = np.flatnonzero(moving)[0]
    chord = steps[owner] / lengths[owner][:, None]
    tangent = np.vstack((chord[:1], chord[:-1] + chord[1:], chord[-1:]))
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    first = np.empty_like(center)
    start = np.eye(3)[
        np.argmin(np.abs(tangent[0]))
    ]  # the axis furthest from the tangent: north for a vertical hole
    first[0] = start - (start @ tangent[0]) * tangent[0]
    first[0] /= np.linalg.norm(first[0])
    for k in range(len(center) - 1):
        across, direction = first[k], tangent[k]
        if lengths[k] > 0:
            across = across - 2 * (across @ chord[k]) * chord[k]
            direction = direction - 2 * (direction @ chord[k]) * chord[k]
        mirror = tangent[k + 1] - direction
        size = mirror @ mirror
        if size > 1e-30:
            across = across - 2 * (across @ mirror) / size * mirror
        first[k + 1] = across
    return first, np.cross(tangent, first)
