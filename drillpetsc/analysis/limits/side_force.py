"""Side force on a joint of pipe, from the wall's force on pieces of the string."""

from __future__ import annotations

import numpy as np

from drillpetsc.arrays import FloatArray


def force_on_joint(md: FloatArray, own: FloatArray, joint: FloatArray) -> FloatArray:
    """(n, 2) side force [N] on a joint of pipe whose middle is there: that of the wall over the length of a joint.

    At the ends of the string the joint is the last one. So a force at one point counts once, whatever the pieces are.

    md: (n, 2) measured depths [m] of the ends of the pieces; own: (n,) force of the wall on each [N].
    joint: (n,) length [m], nan where there are no joints.
    """
    depths = np.concatenate([md[:1, 0], md.ravel()])
    sums = np.concatenate([[0.0], np.column_stack([np.cumsum(own) - own, np.cumsum(own)]).ravel()])
    length = np.minimum(joint, md[-1, 1] - md[0, 0])[:, None]
    first = np.clip(md - 0.5 * length, md[0, 0], md[-1, 1] - length)
    return np.asarray(np.interp(first + length, depths, sums) - np.interp(first, depths, sums))
