"""Where points of the string are: their depth and offset in the hole, and their depth below the flow line."""

from __future__ import annotations

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.kernels import function, pointer
from drillpetsc.model.drilling_model import DrillingModel

_high_side_offsets = function("high_side_offsets", "ippp")


def offsets(model: DrillingModel, points: FloatArray) -> FloatArray:
    """(k, 2) offset [m] of ``points`` (k, 3) from the hole's axis: towards the high side (north in a vertical
    hole), and to the right of it looking down (east).  Manual: eq-conv-high-side."""
    foot = model.axis.project(points)
    # bound, so that they stay alive
    tangent, offset = np.ascontiguousarray(foot.tangent), np.ascontiguousarray(foot.offset)
    out = np.empty((len(points), 2))
    _high_side_offsets(len(out), pointer(tangent), pointer(offset), pointer(out))
    return out


def measured_depth(model: DrillingModel, point: FloatArray) -> float:
    """Measured depth [m] of the point of the hole's axis that is nearest to ``point`` (3,)."""
    return float(model.axis.project(point[None, :]).md[0])


def measured_depths(model: DrillingModel, points: FloatArray) -> FloatArray:
    """(k,) measured depths [m] of ``points`` (k, 3), as ``measured_depth``."""
    return np.asarray(model.axis.project(points).md)


def along_hole(model: DrillingModel, point: FloatArray) -> float:
    """Measured depth [m] as ``measured_depth``, continued straight above the start of the hole."""
    foot = model.axis.project(point[None, :])
    return float(foot.md[0] + foot.tangent[0] @ foot.offset[0])


LOWEST_COLUMN = 1.0  # height of mud above a point below which it has no equivalent density [m]


def equivalent_density(
    pressure: FloatArray | float, height: FloatArray | float, gravity: float
) -> FloatArray:
    """Compute p/(g h) [kg/m3]; nan if the column is lower than LOWEST_COLUMN, or the point lies above the flow line.

    pressure: (k,) gauge [Pa]; height: (k,) vertical, below the flow line [m]; gravity: [m/s2].
    """
    out = np.full(np.broadcast(height, pressure).shape, np.nan)
    height = np.asarray(height, dtype=float)
    np.divide(pressure, gravity * height, out=out, where=height >= LOWEST_COLUMN)
    return out


def below_flow_line(model: DrillingModel, position: FloatArray) -> FloatArray:
    """Vertical depth below the flow line (k,) [m] of points (k, 3) [m] of the string at its present position."""
    assert model.fluid is not None and model.case.fluid is not None
    gravity = np.asarray(model.fluid.constants.gravity)
    size = float(np.linalg.norm(gravity))
    if size == 0.0:
        return np.full(len(position), np.nan)
    return np.asarray(position @ gravity) / size - model.case.fluid.flow_line
