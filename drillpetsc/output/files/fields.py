"""The string over time (string.pvd, string/NNNNNN.vtu) and the hole's wall (well.vtu), for ParaView and
pyvista as they are.

`_write_vtu` writes every .vtu; `read_frame` reads it with meshio, which a run does not import.
"""

from __future__ import annotations

import hashlib
import os
import sys
import xml.etree.ElementTree as ElementTree
import zlib
from base64 import b64encode
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from drillpetsc.errors import CaseError
from drillpetsc.output.files.atomic import replace_file, replace_text, to_disk
from drillpetsc.output.files.tables import DIGEST


@dataclass(frozen=True)
class Frame:
    """One .vtu as read back.

    points: (n, 3) [m]. point_data: {"name [unit]": (n,) or (n, 3)}; cell_data: the same with m.
    cells: {type: (m, k) point numbers}.
    """

    points: np.ndarray
    point_data: dict[str, np.ndarray]
    cell_data: dict[str, np.ndarray]
    cells: dict[str, np.ndarray]


VTK_CELLS = {"line": 3, "quad": 9}  # numbers of the kinds of cells in VTK files
ZLIB_BLOCK = 32768  # bytes that zlib compresses at once


def _write_vtu(
    path: Path,
    points: np.ndarray,
    kind: str,
    cells: np.ndarray,
    point_data: Mapping[str, np.ndarray],
    cell_data: Mapping[str, np.ndarray],
    compress: bool,
) -> None:
    """Write an unstructured grid: XML with base64 data (VTK file formats, "XML formats"; a header of UInt32).

    points: (n, 3); cells: (m, k) numbers of points, all of one ``kind``.
    compress: with zlib: a smaller file, in about four times the time.
    """
    order = "LittleEndian" if sys.byteorder == "little" else "BigEndian"
    compressor = ' compressor="vtkZLibDataCompressor"' if compress else ""
    count, width = cells.shape
    topology = {
        "connectivity": cells.ravel().astype(np.int64, copy=False),
        "offsets": np.arange(width, width * count + 1, width, dtype=np.int64),
        "types": np.full(count, VTK_CELLS[kind], dtype=np.int64),
    }
    groups = [
        ("Points", {"Points": points}),
        ("Cells", topology),
        ("PointData", point_data),
        ("CellData", cell_data),
    ]
    parts = [
        f'<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="0.1" byte_order="{order}"{compressor}>\n'
        f'<UnstructuredGrid>\n<Piece NumberOfPoints="{len(points)}" NumberOfCells="{count}">\n'.encode()
    ]
    for group, arrays in groups:
        if arrays:
            parts.append(f"<{group}>\n".encode())
            parts += [_data_array(name, values, compress) for name, values in arrays.items()]
            parts.append(f"</{group}>\n".encode())
    parts.append(b"</Piece>\n</UnstructuredGrid>\n</VTKFile>\n")
    path.write_bytes(b"".join(parts))


def _escaped(text: str) -> str:
    """The text as XML.  ``xml.sax.saxutils`` has the same function, but imports a client for the web with it."""
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def _data_array(name: str, values: np.ndarray, compress: bool) -> bytes:
    """One array of a .vtu: (n,) or (n, k)."""
    kind = {"f": "Float", "i": "Int", "u": "UInt"}[values.dtype.kind] + str(8 * values.dtype.itemsize)
    size = f' NumberOfComponents="{values.shape[1]}"' if values.ndim == 2 else ""
    raw = values.tobytes()
    if compress:
        blocks = [zlib.compress(raw[i : i + ZLIB_BLOCK]) for i in range(0, len(raw), ZLIB_BLOCK)]
        last = len(raw) - ZLIB_BLOCK * (len(blocks) - 1)
        header = np.array([len(blocks), ZLIB_BLOCK, last, *map(len, blocks)], dtype=np.uint32)
        text = b64encode(header.tobytes()) + b64encode(b"".join(blocks))
    else:
        text = b64encode(np.uint32(len(raw)).tobytes() + raw)
    return b"".join(
        (
            f'<DataArray type="{kind}" Name="{_escaped(name)}"{size} format="binary">\n'.encode(),
            text,
            b"\n</DataArray>\n",
        )
    )


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
            lambda file: _write_vtu(file, points, "line", lines, at_points, on_cells, self.compress),
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
        self._listed += [
            f'    <DataSet timestep="{time!r}" group="" part="0" file="{name}"/>\n'
            for time, name in self._entries[len(self._listed) :]
        ]
        sets = "".join(self._listed)
        replace_text(
            self.series,
            '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">\n'
            f"  <Collection>\n{sets}  </Collection>\n</VTKFile>\n",
        )


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


def read_frame(path: str | os.PathLike) -> Frame:
    """Read a .vtu of this package.  Raises FileNotFoundError, and ValueError if the file is damaged."""
    from meshio import vtu  # not `meshio.read`: it ends the process if a file is damaged

    try:
        mesh = vtu.read(os.fspath(path))
    except OSError:
        raise
    except Exception as error:  # of XML, base64, zlib or numpy, as the damage has it
        raise ValueError(
            f"{path} is damaged: {' '.join(str(error).split()) or type(error).__name__}"
        ) from None
    cells = {block.type: block.data for block in mesh.cells}
    return Frame(
        points=mesh.points,
        point_data=dict(mesh.point_data),
        cell_data={name: np.concatenate(parts) for name, parts in mesh.cell_data.items()},
        cells=cells,
    )


def write_well(
    path: str | os.PathLike,
    md: np.ndarray,
    center: np.ndarray,
    radius: np.ndarray,
    friction: np.ndarray | None = None,
    extra: Mapping[str, np.ndarray] | None = None,
    sides: int = 24,
) -> Path:
    """Write the hole's wall as a tube of quadrilaterals around its axis.

    md: (n,) measured depth [m], not falling. center: (n, 3) axis of the hole [m]. radius: (n,) [m]. friction:
    (n,) [-]. A step of the radius is a station given twice, above and below it. extra: more {"name [unit]":
    (n,)}.
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
    stations = _checked({**stations, **(extra or {})}, count, "station")
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
    return replace_file(path, lambda file: _write_vtu(file, points, "quad", quads, data, {}, True))


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
