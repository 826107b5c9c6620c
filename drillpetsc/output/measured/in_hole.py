"""Position of points of the string relative to the hole; without a hole, relative to the straight string."""

from __future__ import annotations

import numpy as np

from drillpetsc.fem.component import FloatArray
from drillpetsc.kernels import function, pointer
from drillpetsc.model.drilling_model import DrillingModel

_high_side_offsets = function("high_side_offsets", "ippp")


def offsets(model: DrillingModel, points: FloatArray) -> FloatArray:
    """(k, 2) offset [m] of ``points`` (k, 3) from the hole's axis: towards the high side (north in a vertical
    hole), and to the right of it looking down (east).  Manual: eq-conv-high-side."""
    if model.well is not None:
        foot = model.well.project(points)
        tangent, offset = foot.tangent, foot.offset
    else:
        tangent = np.tile(model.tangent[0], (len(points), 1))
        d = points - model.position[0]
        offset = d - tangent * np.sum(d * tangent, axis=1, keepdims=True)
    out = np.empty((len(points), 2))
    tangent, offset = (
        np.ascontiguousarray(tangent),
        np.ascontiguousarray(offset),
    )  # bound, so that they stay alive
    _high_side_offsets(len(out), pointer(tangent), pointer(offset), pointer(out))
    return out


def measured_depth(model: DrillingModel, point: FloatArray) -> float:
    """Measured depth [m] of the point of the hole's axis that is nearest to ``point`` (3,)."""
    if model.well is not None:
        return float(model.well.project(point[None, :]).md[0])
    return float((point - model.position[0]) @ model.tangent[0])


def measured_depths(model: DrillingModel, points: FloatArray) -> FloatArray:
    """(k,) measured depths [m] of ``points`` (k, 3), as ``measured_depth``."""
    if model.well is not None:
        return np.asarray(model.well.project(points).md)
    return np.array([measured_depth(model, point) for point in points])


def along_hole(model: DrillingModel, point: FloatArray) -> float:
    """Measured depth [m] as ``measured_depth``, continued straight above the start of the hole."""
    if model.well is None:
        return measured_depth(model, point)
    foot = model.well.project(point[None, :])
    return float(foot.md[0] + foot.tangent[0] @ foot.offset[0])
