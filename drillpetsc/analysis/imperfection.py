"""Imperfection of a string that starts from rest: small lateral loads at its nodes, as in statics.

Statics adds such loads only where the straight string is unstable (manual: sec-statics-descent).
"""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.energy_descent import nodal_weight
from drillpetsc.arrays import FloatArray
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.solvers.lateral_loads import lateral_loads


def add_imperfection_of_rest(model: DrillingModel) -> None:
    """Add random lateral dead loads where the case gives ``initial.imperfection``, or an item its own; collective.

    The loads stay during the run and are part of its checkpoints. Their standard deviation is the imperfection times
    the weight of the node.
    """
    fractions = imperfections(model)
    if model.beam is None or not fractions.any():
        return
    size = fractions * nodal_weight(model)
    model.system.assembly.dead_load = lateral_loads(model.system, size)


def imperfections(model: DrillingModel) -> FloatArray:
    """(n_nodes,) imperfection [-] that the case gives; 0 where it gives none."""
    mesh, initial = model.mesh, model.case.initial
    given = initial.imperfection if "imperfection" in initial.model_fields_set else 0.0
    fractions = np.full(mesh.nodes, given)
    for e, number in enumerate(mesh.item):
        own = model.case.string[number].initial
        if own is not None:
            fractions[e : e + 2] = own.imperfection
    return fractions
