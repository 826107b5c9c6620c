"""Reference frames of the nodes, and rotations along the string (numpy; manual: sec-beam-frame)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.arrays import FloatArray

#: inclination below which a tool face is measured from north [rad]
MAGNETIC_BELOW = np.radians(5.0)


@dataclass
class Frames:
    """Reference frames of n nodes.

    reference: (n, 3) unit reference directions a.
    second_director: (n, 3) unit second reference directors b.
    twist0: (n-1,) offset of each element's twist [rad]; it changes only with a reference direction (manual:
    eq-beam-update).
    """

    reference: FloatArray
    second_director: FloatArray
    twist0: FloatArray


def cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Vector products (k, 3) of ``a`` and ``b`` (k, 3); ``np.cross`` takes several times as long for some hundreds."""
    out = np.empty_like(a)
    np.subtract(a[:, 1] * b[:, 2], a[:, 2] * b[:, 1], out=out[:, 0])
    np.subtract(a[:, 2] * b[:, 0], a[:, 0] * b[:, 2], out=out[:, 1])
    np.subtract(a[:, 0] * b[:, 1], a[:, 1] * b[:, 0], out=out[:, 2])
    return out


def smallest_rotation(a: FloatArray, b: FloatArray, e: FloatArray) -> FloatArray:
    """Rotate the vector ``e`` (3,) by the smallest rotation from the unit vector ``a`` to the unit vector
    ``b``, (3,) each.

    Manual: eq-beam-minimal-rotation.
    """
    axis, cosine = _cross(a, b), a @ b
    return e * cosine + _cross(axis, e) + axis * (axis @ e) / (1.0 + cosine)


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Vector product of two vectors (3,); ``np.cross`` takes ten times as long."""
    x, y, z = a.tolist()
    u, v, w = b.tolist()
    return np.array([y * w - z * v, z * u - x * w, x * v - y * u])


def two_across(tangents: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Two unit vectors across each of the unit ``tangents`` (n, 3), right-handed with it; the first is as near to
    north as it can be, or to east beside a tangent within 26 deg of north."""
    near = np.where(np.abs(tangents[:, :1]) < 0.9, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    first = near - tangents * np.sum(near * tangents, axis=1, keepdims=True)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return first, np.cross(tangents, first)


def high_side(tangent: FloatArray) -> FloatArray:
    """Return the unit vector (3,) across ``tangent`` (3,) towards the high side of the hole.

    Manual: eq-conv-high-side.

    It points north if the hole is vertical; z points down.
    """
    up = np.array([0.0, 0.0, -1.0])
    across = up - tangent * (up @ tangent)
    if np.linalg.norm(across) < 1e-6:
        north = np.array([1.0, 0.0, 0.0])
        across = north - tangent * (north @ tangent)
    return across / np.linalg.norm(across)


def high_sides(tangents: FloatArray) -> FloatArray:
    """Return the unit vectors (n, 3) of ``high_side`` for ``tangents`` (n, 3)."""
    out = tangents * tangents[:, 2:]
    out[:, 2] -= 1.0
    level = np.linalg.norm(out, axis=1) < 1e-6
    if level.any():
        out[level] = -tangents[level] * tangents[level, :1]
        out[level, 0] += 1.0
    return np.asarray(out / np.linalg.norm(out, axis=1, keepdims=True))


def tool_face_zero(tangent: FloatArray) -> FloatArray:
    """Return the unit vector (3,) across ``tangent`` (3,) from which a tool face is measured.

    Manual: eq-conv-tool-face.

    It is the high side (gravity tool face).  If the hole is inclined by less than ``MAGNETIC_BELOW`` to the
    vertical, it points north (magnetic tool face).
    """
    if np.hypot(tangent[0], tangent[1]) >= np.sin(MAGNETIC_BELOW):
        return high_side(tangent)
    north = np.array([1.0, 0.0, 0.0])
    across = north - tangent * (north @ tangent)
    return across / np.linalg.norm(across)


def axial_curvature(tangent: FloatArray, second: FloatArray, size: float, tool_face: float) -> FloatArray:
    """Compute the axial vector (2,) [1/m] along directors 2 and 3 of a curvature towards a tool face.

    Manual: eq-conv-bend-direction.

    tangent: (3,) unit vector; second: (3,) director 2; size: of the curvature [1/m]; tool_face [rad].
    """
    zero = tool_face_zero(tangent)
    towards = np.cos(tool_face) * zero + np.sin(tool_face) * np.cross(tangent, zero)
    axial = size * np.cross(tangent, towards)
    return np.array([axial @ second, axial @ np.cross(tangent, second)])


def transported_frames(tangents: FloatArray) -> Frames:
    """Create reference frames along ``tangents`` (n, 3).

    The second director starts on the high side and is parallel-transported, without twist.
    """
    n = len(tangents)
    second = np.empty_like(tangents)
    second[0] = high_side(tangents[0])
    turns = (1 + np.flatnonzero((tangents[1:] != tangents[:-1]).any(axis=1))).tolist()
    for start, end in zip([0, *turns], [*turns, n], strict=True):
        for i in range(max(start, 1), end):
            second[i] = smallest_rotation(tangents[i - 1], tangents[i], second[i - 1])
            if i > start and (second[i] == second[i - 1]).all():
                second[i + 1 : end] = second[
                    i
                ]  # a straight stretch: from here on each node is as the one above
                break
    return Frames(tangents.copy(), second, np.zeros(len(tangents) - 1))


def directors(
    frames: Frames, nodes: np.ndarray, v: FloatArray, phi: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Compute directors 2 and 3, (k, 3) each, of k nodes (manual: eq-beam-directors).

    The directors are the columns of minrot(a -> t) D0 Rot1(phi).

    nodes: (k,) numbers; v: (k, 3) slopes [-]; phi: (k,) spin angles [rad].
    """
    t = v / np.linalg.norm(v, axis=1, keepdims=True)
    return turned_directors(frames.reference[nodes], frames.second_director[nodes], t, phi[:, None])


def turned_directors(
    a: FloatArray, b2: FloatArray, t: FloatArray, phi: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """The same of unit reference directions ``a``, second reference directors ``b2`` and tangents ``t`` (k, 3); phi: (k, 1)."""
    b3 = cross(a, b2)
    c, s = np.cos(phi), np.sin(phi)
    factor = (a + t) / (1.0 + np.sum(a * t, axis=1, keepdims=True))
    e2, e3 = c * b2 + s * b3, c * b3 - s * b2
    return (
        e2 - factor * np.sum(t * e2, axis=1, keepdims=True),
        e3 - factor * np.sum(t * e3, axis=1, keepdims=True),
    )


def reference_change(a: FloatArray, d: FloatArray, v: FloatArray) -> float:
    """Compute the change of the spin angle [rad] with a change of the reference direction.

    Manual: eq-beam-update.

    It is minus the solid angle of the triangle of both directions and the tangent (manual:
    eq-beam-solid-angle).

    a: (3,) old reference direction, unit; d: (3,) along the new one; v: (3,) along the tangent.
    """
    n, m = np.linalg.norm(v), np.linalg.norm(d)
    return float(-2 * np.arctan2(v @ np.cross(a, d), n * (m + d @ a) + d @ v + m * (v @ a)))
