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
    model.system.assembly.dead_load = lateral_loads(model.system, size, spacing=None)


def imperfections(model: DrillingModel) -> FloatArray:
    """(n_nodes,) imperfection [-] that the case gives; 0 where it gives none."""
    initial = model.case.initial
    return _by_items(model, initial.imperfection if "imperfection" in initial.model_fields_set else 0.0)


def _by_items(model: DrillingModel, fraction: float) -> FloatArray:
    """(n_nodes,) imperfection [-] of the items that have their own, ``fraction`` elsewhere."""
    out = np.full(model.mesh.nodes, fraction)
    for e, number in enumerate(model.mesh.item):
        own = model.case.string[number].initial
        if own is not None:
            out[e : e + 2] = own.imperfection
    return out


def nodal_weight(model: DrillingModel) -> FloatArray:
    """Compute the weight (n_nodes,) of each node [N]: half of both neighbouring elements and the rigid items."""
    mesh, g = model.mesh, float(np.linalg.norm(model.case.gravity))
    weight = halves_at_nodes(model.effective_mass * mesh.length * g)
    for b in mesh.bodies:
        weight[b.node] += b.mass * g
    return weight


def side_load_size(model: DrillingModel) -> FloatArray:
    """Standard deviation (n_nodes,) of the side loads that lead a string off its saddle [N]; zeros if ``initial.imperfection`` is zero."""
    fraction = model.case.initial.imperfection
    return (nodal_weight(model) if fraction else 0.0) * _by_items(model, fraction)
