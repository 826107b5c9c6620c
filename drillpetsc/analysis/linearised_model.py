"""Linearised model: the discrete system's matrices, with a bottom of the hole that gives no work.

Manual: sec-eigen-bottom.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse as sparse

from drillpetsc.arrays import FloatArray
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.solvers.linearization import Linearised, linearise


def linearise_model(model: DrillingModel) -> Linearised | None:
    """Linearise the model at its present state; the result is on rank 0, None elsewhere; collective.

    A bit that stands on the bottom displaces no mud there, but the mud's pressure acts on its whole face: the rock
    would give the difference as work, and make modes grow that lose none.  A small motion presses on the rock what it
    presses on the bit, so that only the face over which mud is displaced remains.
    """
    linearised = linearise(model.system)
    closed = _closed_face(model)
    if linearised is None or not closed.any():
        return linearised
    names, last = [f.name for f in model.system.layout.fields], model.mesh.nodes - 1
    position, pressure = (
        np.flatnonzero((linearised.field == names.index(name)) & (linearised.node == last))
        for name in ("string.position", "annulus.pressure")
    )
    force = closed[linearised.component[position]]
    columns = np.full(len(position), pressure[0])
    change = sparse.csr_matrix((force, (position, columns)), shape=linearised.K.shape)
    return replace(linearised, K=sparse.csr_matrix(linearised.K - change))


def _closed_face(model: DrillingModel) -> FloatArray:
    """Area of the bit's face under which no mud is displaced, times the hole's direction (3,) [m2], on all ranks."""
    bit = None if model.fluid is None else model.fluid.bit
    if bit is None:
        return np.zeros(3)
    own, system = bit.closed_face(model.system.assembly), model.system
    return own if system.comm.size == 1 else np.asarray(system.comm.tompi4py().allreduce(own))
