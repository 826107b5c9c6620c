"""Random lateral loads that lead a straight string off its saddle, the same on any number of ranks."""

from __future__ import annotations

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.discrete_system import DiscreteSystem

SPACING = 3.0  # of independent side loads of a search, the same on all meshes [m]


def lateral_shares(depth: FloatArray, spacing: float | None = SPACING) -> FloatArray:
    """Random numbers (n, 2) of standard deviation 1 along directors 2 and 3, of nodes at ``depth`` (n,) [m].

    spacing: see ``lateral_loads``.
    """
    random = np.random.default_rng(1)
    if spacing is None:
        return random.standard_normal((len(depth), 2))
    knots = np.arange(np.ceil(depth[-1] / spacing) + 1) * spacing
    values = random.standard_normal((len(knots), 2))
    return np.column_stack([np.interp(depth, knots, v) for v in values.T])


def lateral_loads(system: DiscreteSystem, size: FloatArray, spacing: float | None = SPACING) -> FloatArray:
    """Compute random lateral loads at the nodes, (n,) by the local unknowns [N]; the same for any number of ranks.

    size: (n_nodes,) standard deviation at each node [N].
    spacing: distance [m] between independent random numbers along the string, with linear interpolation, so that all
    meshes have the same load per length; None: the nodes are independent.
    """
    loads = size[:, None] * lateral_shares(system.mesh.node_depth, spacing)
    t, second = system.frames.reference, system.frames.second_director
    force = loads[:, :1] * second + loads[:, 1:] * np.cross(t, second)
    out = np.zeros(system.layout.size)
    dofs, owned = system.layout.dofs["string.position"], system.chain.owned
    out[dofs[owned]] = force[system.chain.vertices[owned]]
    return out
