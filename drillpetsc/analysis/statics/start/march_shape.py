"""Place of a marched string in its hole: offsets from the axis, what they shorten, and the positions of the nodes.

Manual: eq-statics-resting-shape, eq-statics-start-position.  A string that stands needs the shortening of its helix, and a string
without weight, which no side load leads off its axis, its shape.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.analysis.statics.start.resting_shape import Beam, resting_shape
from drillpetsc.arrays import FloatArray
from drillpetsc.geometry.frames import directors
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.physics.contact import penetration

CROSSING = 12.0  # half length over which a helix begins and ends [m]


@dataclass(frozen=True)
class OnWall:
    """How a marched string lies on the wall, at its nodes.

    load: (n, 3) on the wall [N]; contact: (n,) per length [N/m]; clearance: (n,) [m].
    top: whether the upper end lies there.
    """

    load: FloatArray
    contact: FloatArray
    clearance: FloatArray
    top: bool


def lateral_shape(
    model: DrillingModel, s: FloatArray, lying: OnWall, beam: Beam, helical: np.ndarray, phase: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Offsets and slopes of the nodes from the axis of the hole, (n, 4), and those without coils, (n, 2) each, and the share of
    the coils in the elements (n-1,).

    The four columns are offsets [m] and slopes [-] along the second and the third director at zero spin.
    s: (n,) measured depths [m]; helical: (n,); phase: (n,) of the helix [rad].
    """
    law = None if model.contact is None else model.contact.law
    t, second, third = _directors(model, s)
    load, clearance = lying.load, lying.clearance
    size = np.linalg.norm(load, axis=1)
    touches = size > 1e-6 * size.max(initial=0.0)
    side = np.divide(load, size[:, None], out=np.zeros_like(load), where=touches[:, None])
    deep = clearance
    if law is not None and law.law == "linear":
        deep = clearance + penetration(lying.contact / law.stiffness)
    wall = np.column_stack([np.sum(side * second, axis=1), np.sum(side * third, axis=1)]) * deep[:, None]
    if not lying.top:
        wall[0] = 0.0
    curvature = _mean_curvature(model, s)
    across, slope = resting_shape(beam, wall, curvature)
    still, lean, coils = across.copy(), slope.copy(), np.zeros(len(s) - 1)
    if helical.any():
        share = _eased(helical[:, None].astype(float), s)
        share[clearance < 1e-4] = 0.0
        first = int(np.argmax(helical))
        angle = phase - phase[first] + np.arctan2(wall[first, 1], wall[first, 0])
        coil = deep[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
        across = (1 - share) * across + share * coil
        slope *= 1 - share
        if not model.mesh.is_joint.any():
            slope += share * np.gradient(across, s, axis=0)
        coils = _at_middle(share)[:, 0]
    return np.column_stack([across, slope]), still, lean, coils


def _mean_curvature(model: DrillingModel, s: FloatArray) -> FloatArray:
    """Mean curvature (n-1, 2) [1/m] of the hole between the depths ``s`` (n,) [m] of the nodes, along both directors."""
    t, second, third = _directors(model, s)
    bend = np.diff(t, axis=0) / np.maximum(np.diff(s), 1e-9)[:, None]
    return np.column_stack([np.sum(bend * _at_middle(d), axis=1) for d in (second, third)])


def shortening(model: DrillingModel, s: FloatArray, across: FloatArray, slope: FloatArray) -> FloatArray:
    """By how much offsets and slopes (n, 2) of nodes at the depths ``s`` (n,) [m] shorten the elements, (n-1,) [-]."""
    inside = np.sum(_mean_curvature(model, s) * _at_middle(across), axis=1)
    return 0.5 * np.sum(_at_middle(slope) ** 2, axis=1) - inside


def _at_middle(values: FloatArray) -> FloatArray:
    """Means (n-1, k) of neighbouring rows of ``values`` (n, k)."""
    return 0.5 * (values[1:] + values[:-1])


def _directors(model: DrillingModel, s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Tangent of the hole and both directors at zero spin, (n, 3) each, at the depths ``s`` (n,) [m] of the nodes.

    The hole where the string lies may have any direction beside the frames of the start.
    """
    t = np.asarray(model.given_well.at(s)[1])
    return t, *frame_across(model, t)


def frame_across(model: DrillingModel, t: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Both directors (n, 3) at zero spin of nodes with the tangents ``t`` (n, 3)."""
    return directors(model.frames, np.arange(len(t)), t, np.zeros(len(t)))


def place(
    model: DrillingModel, s: FloatArray, shape: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Positions, unit tangents, offsets from the axis and tangents of the hole, (n, 3) each, of nodes at depths ``s`` (n,) [m].

    shape: as of ``_shape``.
    """
    t, second, third = _directors(model, s)
    offset = shape[:, :1] * second + shape[:, 1:2] * third
    tangent = t + shape[:, 2:3] * second + shape[:, 3:] * third
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    return np.asarray(model.given_well.at(s)[0]) + offset, tangent, offset, t


def _eased(values: FloatArray, s: FloatArray) -> FloatArray:
    """Average ``values`` (n, k) over +-CROSSING [m] along ``s`` (n,), exact for constants."""
    pieces = 0.5 * (values[1:] + values[:-1]) * np.diff(s)[:, None]
    total = np.concatenate([np.zeros((1, values.shape[1])), np.cumsum(pieces, axis=0)])
    width = np.minimum(np.minimum(s - s[0], s[-1] - s), CROSSING)
    out = np.column_stack([np.interp(s + width, s, c) - np.interp(s - width, s, c) for c in total.T])
    wide = width > 1e-9
    return np.where(wide[:, None], out / np.where(wide, 2 * width, 1.0)[:, None], values)
