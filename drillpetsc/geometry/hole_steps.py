"""Steps of the string's nodes in the hole's own coordinates: along it and about its axis.

Manual: eq-statics-retraction.
"""

from __future__ import annotations

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.geometry.well import Well
from drillpetsc.kernels import function, pointer

_advance = function("hole_advance", "pipppp" + "dpp")


class HoleSteps:
    """Retraction of steps of the nodes onto the hole.

    A step p moves a node to x + p to first order.  A node on the wall that moves about the axis stays on the
    wall to second order, and a node that moves along a curved hole follows it.

    well: the hole; at: (n, 2) positions of place and slope of each node in the unknowns.
    clearance: (n,) radial clearance [m]; beyond a fraction of it a node moves about the axis; 0: never.
    """

    def __init__(self, well: Well, at: np.ndarray, clearance: FloatArray):
        self._packed = well.packed()
        self._at = np.ascontiguousarray(at, dtype=np.int32)
        self._clearance = np.ascontiguousarray(clearance, dtype=float)
        self._segment = np.full(len(at), -1, dtype=np.int32)

    def __call__(self, x: FloatArray, p: FloatArray, factor: float) -> FloatArray:
        """Return the unknowns after ``factor`` times the step ``p`` from ``x``, all (m,)."""
        out = x + factor * p
        arrays = [pointer(a) for a in (self._at, self._clearance, x, p)]
        _advance(pointer(self._packed), len(self._at), *arrays, factor, pointer(self._segment), pointer(out))
        return out
