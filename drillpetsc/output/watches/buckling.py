"""What a static state says of buckling: where the string is buckled, and whether the mesh can show it.

Manual: sec-statics-report.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.model.hole import top_of_string
from drillpetsc.output.files.tables import Column
from drillpetsc.output.static_table import at_nodes

#: helical over sinusoidal buckling load in a hole with side load (Chen, Lin and Cheatham, SPEDE 1990)
HELICAL_RATIO = np.sqrt(2.0)
#: first buckling of a vertical string with the weight w per length, F/(EI w^2)^(1/3) (Lubinski, 1950)
VERTICAL_LOAD = 1.94
ELEMENTS_PER_PITCH = 4.0  # with fewer, the shape of a helix is wrong
WINDING = 1.5 * np.pi  # rotation of the offset within a pitch from which a string counts as a helix [rad]


@dataclass(frozen=True)
class Buckling:
    """Buckling of a static state: ranges (from, to) of measured depth in the hole [m].

    sinusoidal: the compression exceeds the sinusoidal load but the string does not coil.
    helical: the string coils about the axis of the hole.
    coarse: upper, lower, length, enough [m] of buckled ranges with elements longer than the length that would be enough.
    """

    sinusoidal: tuple[tuple[float, float], ...] = ()
    helical: tuple[tuple[float, float], ...] = ()
    coarse: tuple[dict[str, float], ...] = ()

    def __bool__(self) -> bool:
        return bool(self.sinusoidal or self.helical)

    def as_dict(self) -> dict[str, list[list[float]]]:
        """Ranges for summary.json [m]."""
        return {"sinusoidal": [list(q) for q in self.sinusoidal], "helical": [list(q) for q in self.helical]}


def buckling(model: DrillingModel, columns: list[Column], values: FloatArray) -> Buckling:
    """Find where the string of a static table is buckled.

    columns, values: of ``static_table``, (n_nodes, columns) on rank 0.
    """
    table = dict(zip([c[0] for c in columns], values.T, strict=True))
    if model.contact is None or "buckling_load" not in table:
        return Buckling()
    mesh = model.mesh
    push = -table.get("effective_tension", table["axial_force"])
    stiffness = at_nodes(mesh.bending_stiffness, mesh.bending_stiffness)
    weight = at_nodes(model.effective_mass, model.effective_mass) * float(np.linalg.norm(model.case.gravity))
    vertical = VERTICAL_LOAD * np.cbrt(stiffness * weight**2)
    load = np.fmax(table["buckling_load"], vertical)
    buckled = push > load
    if not buckled.any():
        return Buckling()
    depth = mesh.node_depth + top_of_string(model.case, mesh.total_length)
    pitch = 2 * np.pi * np.sqrt(2 * stiffness / np.maximum(push, 1.0))
    helical = (
        buckled & _winds(model, table, pitch) & (push > HELICAL_RATIO * np.nan_to_num(table["buckling_load"]))
    )
    length = np.maximum(np.append(mesh.length, 0.0), np.append(0.0, mesh.length))
    coarse = buckled & (length > pitch / ELEMENTS_PER_PITCH * (1 + 1e-9))
    ranges = []
    for a, b in _ranges(depth, coarse):
        there = coarse & (depth >= a) & (depth <= b)
        enough = float(pitch[there].min() / ELEMENTS_PER_PITCH)
        ranges.append({"upper": a, "lower": b, "length": float(length[there].max()), "enough": enough})
    return Buckling(_ranges(depth, buckled & ~helical), _ranges(depth, helical), tuple(ranges))


def _winds(model: DrillingModel, table: dict[str, FloatArray], pitch: FloatArray) -> np.ndarray:
    """Mask of nodes (n,) whose offset from the axis rotates one way by ``WINDING`` within a pitch."""
    x, y, md = table["offset_x"], table["offset_y"], model.mesh.node_depth
    step = np.arctan2(x[:-1] * y[1:] - y[:-1] * x[1:], x[:-1] * x[1:] + y[:-1] * y[1:])
    angle = np.concatenate([[0.0], np.cumsum(step)])
    low, high = np.maximum(md - 0.5 * pitch, md[0]), np.minimum(md + 0.5 * pitch, md[-1])
    share = np.where(pitch > 0, (high - low) / pitch, 1.0)
    return np.asarray(np.abs(np.interp(high, md, angle) - np.interp(low, md, angle)) > WINDING * share)


def _ranges(md: FloatArray, mask: np.ndarray) -> tuple[tuple[float, float], ...]:
    """Ranges (from, to) [m] of neighbouring nodes in ``mask`` (n,), of more than one node."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(int), [0]])))
    return tuple(
        (float(md[a]), float(md[b - 1])) for a, b in zip(edges[::2], edges[1::2], strict=True) if b - a > 1
    )
