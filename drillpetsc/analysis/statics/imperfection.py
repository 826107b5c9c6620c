"""Imperfection of a string: small random lateral loads at its nodes, as shares of its weight.

Statics adds such loads only where the string is unstable without them (manual: sec-statics-relaxation).
"""

from __future__ import annotations

import numpy as np

from drillpetsc.arrays import FloatArray, halves_at_nodes
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.solvers.static.lateral_loads import lateral_loads


def add_imperfection_of_rest(model: DrillingModel) -> None:
    """Add random lateral dead loads where the case gives ``initial.imperfection``, or an item its own; collective.

    The loads stay during the run and are part of its checkpoints. Their standard deviation is the imperfection times
    the weight of the node.
    """
    fractions = imperfections(model)
    if not model.beam.moves or not fractions.any():
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


def nodal_weight(model: DrillingModel) -> FloatArray:
    """Compute the weight (n_nodes,) of each node [N]: half of both neighbouring elements and the rigid items."""
    mesh, g = model.mesh, float(np.linalg.norm(model.case.gravity))
    weight = halves_at_nodes(model.effective_mass * mesh.length * g)
    for b in mesh.bodies:
        weight[b.node] += b.mass * g
    return weight


def item_imperfection(model: DrillingModel, fraction: float) -> FloatArray:
    """Compute the factor (n_nodes,) on ``fraction`` of string items with their own imperfection."""
    mesh, factor = model.mesh, np.ones(model.mesh.nodes)
    for e, number in enumerate(mesh.item):
        own = model.case.string[number].initial
        if own is not None:
            factor[e : e + 2] = own.imperfection / fraction
    return factor
