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
    return _force(md, own, md, joint[:, None])


def largest_on_joint(md: FloatArray, own: FloatArray, joint: FloatArray) -> FloatArray:
    """(n, 2) as `force_on_joint`, the largest for a middle in the halves of the pieces that meet at that end: joints lie anywhere.

    The force over a joint is linear in its place between the places where one of its ends is at an end of a piece.
    """
    out = force_on_joint(md, own, joint)
    edges = np.unique(md)
    for length in np.unique(joint[np.isfinite(joint)]):
        middle = np.unique(np.concatenate([edges - 0.5 * length, edges + 0.5 * length, md.mean(axis=1)]))
        force = _force(md, own, middle, np.array(length))
        for i in np.flatnonzero(joint == length):
            upper, half, lower = np.searchsorted(middle, [md[i, 0], md[i].mean(), md[i, 1]])
            out[i, 0] = max(out[i, 0], force[upper : half + 1].max(initial=0.0))
            out[i, 1] = max(out[i, 1], force[half:lower].max(initial=0.0))
    same = np.flatnonzero(joint[1:] == joint[:-1])
    out[same, 1] = out[same + 1, 0] = np.maximum(out[same, 1], out[same + 1, 0])
    return out


def _force(md: FloatArray, own: FloatArray, middle: FloatArray, joint: FloatArray) -> FloatArray:
    """Force of the wall on a joint of pipe about each ``middle`` [m], arrays that go together; see `force_on_joint`."""
    depths = np.concatenate([md[:1, 0], md.ravel()])
    sums = np.concatenate([[0.0], np.column_stack([np.cumsum(own) - own, np.cumsum(own)]).ravel()])
    length = np.minimum(joint, md[-1, 1] - md[0, 0])
    first = np.clip(middle - 0.5 * length, md[0, 0], md[-1, 1] - length)
    return np.asarray(np.interp(first + length, depths, sums) - np.interp(first, depths, sums))
