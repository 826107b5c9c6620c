"""B^T B of the constraint rows B of joints: static matrices without singular blocks (manual: eq-chain-constraints)."""

from __future__ import annotations

import numpy as np

from drillpetsc.fem.bound_parts import ROW_SCALE
from drillpetsc.fem.discrete_system import DiscreteSystem


class ConstraintProducts:
    """Adds the products to the matrix entries of one system's joints.

    The piece of a string between two joints may float, which leaves a block of the chain singular, although the matrix
    is not.  The solution stays the same but for the multipliers, by the error of the constraints, and so does the number
    of negative eigenvalues.
    """

    def __init__(self, system: DiscreteSystem):
        fields = [f.name for f in system.layout.fields if f.multiplier and f.physics == "joint"]
        dofs = [system.layout.dofs[name].ravel() for name in fields]
        multipliers = np.concatenate([*dofs, np.zeros(0, dtype=int)])
        multipliers = multipliers[multipliers >= 0]
        #: blocks with (element, slot) of each of their multipliers
        self._found = [
            (item, np.argwhere(np.isin(item.index, multipliers)))
            for item in (system.assembly.bound_blocks if len(multipliers) else ())
        ]

    def add(self, values: np.ndarray) -> None:
        """Add B^T B over ``ROW_SCALE`` to the entries ``values`` (m,) of an assembled matrix."""
        for item, places in self._found:
            K = values[item.span].reshape(item.count, item.width, item.width)
            for e, k in places:
                if K[e, k, k] == 0.0:
                    K[e] += np.outer(K[e, :, k], K[e, k]) / ROW_SCALE
