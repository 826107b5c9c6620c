"""Node frames of the string: reference directions and reference directors, and rotations in general
(numpy)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.arrays import FloatArray


@dataclass
class Frames:
    """Gauge direction and second reference director of every node, both (n, 3), unit; ``twist0``: (n-1,)
    offset of each element's twist [rad] (grows only when a gauge is renewed)."""

    reference: FloatArray
    second: FloatArray
    twist0: FloatArray


def smallest_rotation(a: FloatArray, b: FloatArray, e: FloatArray) -> FloatArray:
    """Vector ``e`` (3,) carried by the smallest rotation that takes the unit vector ``a`` to the unit vector
    ``b``."""
    axis = np.cross(a, b)
    return e * (a @ b) + np.cross(axis, e) + axis * (axis @ e) / (1.0 + a @ b)


def high_side(tangent: FloatArray) -> FloatArray:
    """Unit vector across ``tangent`` towards the high side of the hole; north where the hole is vertical (z
    points down)."""
    up = np.array([0.0, 0.0, -1.0])
    side = up - tangent * (up @ tangent)
    if np.linalg.norm(side) < 1e-6:
        north = np.array([1.0, 0.0, 0.0])
        side = north - tangent * (north @ tangent)
    return side / np.linalg.norm(side)


def transported_frames(tangents: FloatArray) -> Frames:
    """Frames along ``tangents`` (n, 3): the second director starts on the high side and is
    parallel-transported (no twist)."""
    second = np.empty_like(tangents)
    second[0] = high_side(tangents[0])
    for i in range(1, len(tangents)):
        second[i] = smallest_rotation(tangents[i - 1], tangents[i], second[i - 1])
    return Frames(tangents.copy(), second, np.zeros(len(tangents) - 1))


def directors(
    frames: Frames, nodes: np.ndarray, v: FloatArray, phi: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Directors 2 and 3 of ``nodes`` (k,) at slopes v (k, 3) and spin angles phi (k,): minrot(a -> t) D0
    Rot1(phi)."""
    t = v / np.linalg.norm(v, axis=1, keepdims=True)
    a, b2 = frames.reference[nodes], frames.second[nodes]
    b3 = np.cross(a, b2)
    c, s = np.cos(phi)[:, None], np.sin(phi)[:, None]
    factor = (a + t) / (1.0 + np.sum(a * t, axis=1, keepdims=True))
    e2, e3 = c * b2 + s * b3, c * b3 - s * b2
    return (
        e2 - factor * np.sum(t * e2, axis=1, keepdims=True),
        e3 - factor * np.sum(t * e3, axis=1, keepdims=True),
    )


def reference_change(a: FloatArray, d: FloatArray, v: FloatArray) -> float:
    """Change of the spin angle from gauge ``a`` (unit) to gauge d/|d| at the tangent ``v``: minus the
    triangle's solid angle."""
    n, m = np.linalg.norm(v), np.linalg.norm(d)
    return float(-2 * np.arctan2(v @ np.cross(a, d), n * (m + d @ a) + d @ v + m * (v @ a)))
