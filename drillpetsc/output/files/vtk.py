"""Grids as XML files of VTK, for ParaView and pyvista (VTK file formats, "XML formats"; base64 data, headers of UInt32).

An array ``axial_force [N]`` of this package is ``axial_force`` in a file, with its unit in the array's information key
``UNITS_LABEL``: a name with brackets cannot stand in a formula of ParaView's calculator.
"""

from __future__ import annotations

import os
import sys
import xml.etree.ElementTree as ElementTree
import zlib
from base64 import b64decode, b64encode
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from drillpetsc.output.files.tables import split_name

KINDS = {"line": 3, "quad": 9}  # numbers of the kinds of cells in VTK files
ZLIB_BLOCK = 32768  # bytes that zlib compresses at once

Arrays = Mapping[str, np.ndarray]


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


def write_vtu(
    path: Path,
    points: np.ndarray,
    kind: str,
    cells: np.ndarray,
    point_data: Arrays,
    cell_data: Arrays,
    compress: bool,
) -> None:
    """Write an unstructured grid.

    points: (n, 3); cells: (m, k) numbers of points, all of one ``kind``.
    compress: with zlib: a smaller file, in about four times the time.
    """
    count, width = cells.shape
    topology = {
        "connectivity": cells.ravel().astype(np.int64, copy=False),
        "offsets": np.arange(width, width * count + 1, width, dtype=np.int64),
        "types": np.full(count, KINDS[kind], dtype=np.int64),
    }
    groups = {"Points": {"Points": points}, "Cells": topology, "PointData": point_data, "CellData": cell_data}
    _write(path, "UnstructuredGrid", f'NumberOfCells="{count}"', points, groups, compress)


def write_vtp(path: Path, points: np.ndarray, ends: np.ndarray, point_data: Arrays) -> None:
    """Write curves through points in their order, compressed; a curve of one point is a vertex.

    points: (n, 3); ends: (k,) number of points up to the end of each curve, so the last is n.
    """
    lines = len(ends) < len(points)
    topology = {"connectivity": np.arange(len(points), dtype=np.int64), "offsets": ends.astype(np.int64)}
    size = f'NumberOfVerts="{0 if lines else len(ends)}" NumberOfLines="{len(ends) if lines else 0}"'
    groups = {"Points": {"Points": points}, "Lines" if lines else "Verts": topology, "PointData": point_data}
    _write(path, "PolyData", size + ' NumberOfStrips="0" NumberOfPolys="0"', points, groups, True)


def _write(
    path: Path, kind: str, size: str, points: np.ndarray, groups: Mapping[str, Arrays], compress: bool
) -> None:
    """Write a file with one piece.  size: numbers of its cells, as attributes."""
    order = "LittleEndian" if sys.byteorder == "little" else "BigEndian"
    compressor = ' compressor="vtkZLibDataCompressor"' if compress else ""
    parts = [
        f'<?xml version="1.0"?>\n<VTKFile type="{kind}" version="0.1" byte_order="{order}"{compressor}>\n'
        f'<{kind}>\n<Piece NumberOfPoints="{len(points)}" {size}>\n'.encode()
    ]
    for group, arrays in groups.items():
        if arrays:
            parts.append(f"<{group}>\n".encode())
            parts += [_data_array(name, values, compress) for name, values in arrays.items()]
            parts.append(f"</{group}>\n".encode())
    parts.append(f"</Piece>\n</{kind}>\n</VTKFile>\n".encode())
    path.write_bytes(b"".join(parts))


def _escaped(text: str) -> str:
    """The text as XML.  ``xml.sax.saxutils`` has the same function, but imports a client for the web with it."""
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;").replace('"', "&quot;")


def _data_array(title: str, values: np.ndarray, compress: bool) -> bytes:
    """One array of a file: (n,) or (n, k).  title: with or without unit."""
    kind = {"f": "Float", "i": "Int", "u": "UInt"}[values.dtype.kind] + str(8 * values.dtype.itemsize)
    size = f' NumberOfComponents="{values.shape[1]}"' if values.ndim == 2 else ""
    raw = values.tobytes()
    if compress:
        blocks = [zlib.compress(raw[i : i + ZLIB_BLOCK]) for i in range(0, len(raw), ZLIB_BLOCK)]
        last = len(raw) - ZLIB_BLOCK * (len(blocks) - 1) if blocks else 0
        header = np.array([len(blocks), ZLIB_BLOCK, last, *map(len, blocks)], dtype=np.uint32)
        text = b64encode(header.tobytes()) + b64encode(b"".join(blocks))
    else:
        text = b64encode(np.uint32(len(raw)).tobytes() + raw)
    name, unit = split_name(title)
    key = f'<InformationKey name="UNITS_LABEL" location="vtkDataArray">{_escaped(unit)}</InformationKey>\n'
    return b"".join(
        (
            f'<DataArray type="{kind}" Name="{_escaped(name)}"{size} format="binary">\n'.encode(),
            text,
            f"\n{key if unit else ''}</DataArray>\n".encode(),
        )
    )


def read_frame(path: str | os.PathLike) -> Frame:
    """Read a .vtu of this package.  Raises FileNotFoundError, and ValueError if the file is damaged."""
    text = Path(path).read_bytes()
    try:
        return _frame(ElementTree.fromstring(text))
    except Exception as error:  # of XML, base64, zlib or numpy, as the damage has it
        raise ValueError(
            f"{path} is damaged: {' '.join(str(error).split()) or type(error).__name__}"
        ) from None


def _frame(root: ElementTree.Element) -> Frame:
    """The grid of a file.  Any exception means that it is damaged."""
    piece = root.find("UnstructuredGrid/Piece")
    if piece is None:
        raise ValueError("there is no piece of an unstructured grid")
    count, cells = int(piece.attrib["NumberOfPoints"]), int(piece.attrib["NumberOfCells"])
    order = "<" if root.attrib["byte_order"] == "LittleEndian" else ">"
    compressed = "compressor" in root.attrib

    def arrays(group: str, rows: int) -> dict[str, np.ndarray]:
        return dict(
            _read_array(each, rows, order, compressed) for each in piece.iterfind(f"{group}/DataArray")
        )

    topology = {each.attrib["Name"]: each for each in piece.iterfind("Cells/DataArray")}
    kinds = {number: kind for kind, number in KINDS.items()}
    types = _read_array(topology["types"], cells, order, compressed)[1]
    width = _read_array(topology["offsets"], cells, order, compressed)[1][:1]
    connectivity = _read_array(topology["connectivity"], int(cells * width[0]), order, compressed)[1]
    return Frame(
        points=arrays("Points", count)["Points"],
        point_data=arrays("PointData", count),
        cell_data=arrays("CellData", cells),
        cells={kinds[int(types[0])]: connectivity.reshape(cells, -1)},
    )


def _read_array(
    array: ElementTree.Element, rows: int, order: str, compressed: bool
) -> tuple[str, np.ndarray]:
    """Title and values (rows,) or (rows, k) of an array of a file."""
    name, kind = array.attrib["Name"], array.attrib["type"]
    text = (array.text or "").strip()
    head = np.dtype(f"{order}u4")
    if compressed:
        blocks = int(np.frombuffer(b64decode(text[:8], validate=True), head, 1)[0])
        length = 4 * -(-4 * (3 + blocks) // 3)  # of the header as base64
        sizes = np.frombuffer(b64decode(text[:length], validate=True), head, 3 + blocks)[3:]
        data, ends = b64decode(text[length:], validate=True), np.cumsum(sizes)
        raw = b"".join(zlib.decompress(data[end - size : end]) for size, end in zip(sizes, ends, strict=True))
    else:
        raw = b64decode(text, validate=True)[4:]
    number = {"Float": "f", "Int": "i", "UInt": "u"}[kind.rstrip("0123456789")]
    values = np.frombuffer(raw, f"{order}{number}{int(kind.lstrip('FloatUIn')) // 8}")
    width = int(array.get("NumberOfComponents", "1"))
    values = values.astype(values.dtype.newbyteorder("="), copy=True)
    if values.size != rows * width:
        raise ValueError(f"{name} has {values.size} numbers, wanted {rows * width}")
    unit = array.findtext("InformationKey[@name='UNITS_LABEL']", "").strip()
    shaped = values.reshape(rows, width) if "NumberOfComponents" in array.attrib else values
    return f"{name} [{unit}]" if unit else name, shaped
