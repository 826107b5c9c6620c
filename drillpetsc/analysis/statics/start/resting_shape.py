"""Shape in which a string rests in its hole: a beam under tension on an elastic bed about the places on the wall.

Manual: eq-statics-resting-shape.  The place on the wall to which the loads press the string jumps where they change
side, where the clearance steps, and at stabilizers.  A beam follows such a jump over a length that depends on its
bending stiffness, its tension and the load.  Without that, a start on a fine mesh is far from any equilibrium.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.arrays import FloatArray, halves_at_nodes
from drillpetsc.solvers.chain.block_tridiagonal import Piece
from drillpetsc.solvers.static.lateral_beam import element_matrices

TIE = 1e3  # stiffness of a tie over the largest of the beam's entries [-]
_PIVOT = 1e-14  # a pivot over the largest entry of its column


@dataclass(frozen=True)
class Beam:
    """Straightened string of n nodes and n-1 elements, and the bed that holds it.

    length: (n-1,) of the elements [m], 0 for joints; bending: (n-1,) EI [N m2]; tension: (n-1,) [N], pushes count as none.
    joint: (n-1,) whether the element is a joint, which ties its two nodes.
    bed: (n,) stiffness of the bed [N/m per metre].
    """

    length: FloatArray
    bending: FloatArray
    tension: FloatArray
    joint: np.ndarray
    bed: FloatArray


def resting_shape(beam: Beam, wall: FloatArray, curvature: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Compute the offsets (n, 2) [m] and slopes (n, 2) [-] of a string from the axis of its hole.

    wall: (n, 2) offsets of the places on the wall that the bed pulls to [m]; those of the first node are kept, with the
    slope of the hole.
    curvature: (n-1, 2) of the hole in each element [1/m], in the same two directions.
    """
    n = len(beam.bed)
    flexible = ~beam.joint
    h = np.where(flexible, beam.length, 1.0)
    bending = np.where(flexible, beam.bending, 0.0)
    tension = np.where(flexible, np.maximum(beam.tension, 0.0), 0.0)
    entries = element_matrices(h, bending, tension, np.zeros_like(h))
    tie = TIE * float(np.max(entries[:, 0, 0], initial=0.0))
    entries[beam.joint] = tie * (np.eye(4) - np.eye(4, k=2) - np.eye(4, k=-2))
    bed = beam.bed * halves_at_nodes(beam.length)
    bed[0] += tie
    held = np.zeros((n, 2))
    held[:, 0] = bed
    held[0, 1] = tie
    load = np.zeros((n, 2, 2))
    load[:, 0] = bed[:, None] * wall
    moment = bending[:, None] * curvature
    load[:-1, 1] += moment
    load[1:, 1] -= moment
    first = 2 * np.arange(n - 1)[:, None] + np.arange(4)
    rows = np.concatenate([np.repeat(first, 4, axis=1).ravel(), np.arange(2 * n)])
    columns = np.concatenate([np.tile(first, (1, 4)).ravel(), np.arange(2 * n)])
    values = np.concatenate([entries.ravel(), held.ravel()])
    unknown = np.arange(2 * n)
    chain = Piece(np.full(n, 2), 0)
    chain.set_matrix_entries(rows, columns, unknown // 2, unknown % 2)
    chain.factor(values, _PIVOT)
    found, at = np.zeros((2, 2 * n)), chain.positions()
    for direction in range(2):
        padded = np.zeros(chain.length)
        padded[at] = load[:, :, direction].ravel()
        chain.forward(padded)
        chain.backward(padded)
        found[direction] = padded[at]
    return found[:, 0::2].T, found[:, 1::2].T
