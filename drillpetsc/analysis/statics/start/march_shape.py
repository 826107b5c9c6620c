"""Place of a marched string in its hole: offsets from the axis, what they shorten, and the positions of the nodes.

Manual: eq-statics-resting-shape, eq-statics-start-position.
"""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.statics.start.resting_shape import Beam, resting_shape
from drillpetsc.arrays import FloatArray
from drillpetsc.geometry.frames import directors
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.physics.contact import penetration


def lateral_shape(
    model: DrillingModel,
    s: FloatArray,
    load: FloatArray,
    contact: FloatArray,
    clearance: FloatArray,
    beam: Beam,
    top_on_wall: bool,
) -> tuple[FloatArray, FloatArray]:
    """Offsets [m] and slopes [-] of the nodes from the axis of the hole, (n, 2) each, along the directors at zero spin.

    A string that coils is straight here: the search finds its shape.
    s: (n,) measured depths [m]; load: (n, 3) on the wall [N]; contact: (n,) per length [N/m]; clearance: (n,) [m].
    """
    well, law = model.well, None if model.contact is None else model.contact.law
    assert well is not None
    t, second, third = _directors(model, s)
    size = np.linalg.norm(load, axis=1)
    touches = size > 1e-6 * size.max(initial=0.0)
    side = np.divide(load, size[:, None], out=np.zeros_like(load), where=touches[:, None])
    deep = clearance
    if law is not None and law.law == "linear":
        deep = clearance + penetration(contact / law.stiffness)
    wall = np.column_stack([np.sum(side * second, axis=1), np.sum(side * third, axis=1)]) * deep[:, None]
    if not top_on_wall:
        wall[0] = 0.0
    curvature = _mean_curvature(model, s)
    return resting_shape(beam, wall, curvature)


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
    assert model.well is not None
    t = np.asarray(model.well.at(s)[1])
    return t, *frame_across(model, t)


def frame_across(model: DrillingModel, t: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Both directors (n, 3) at zero spin of nodes with the tangents ``t`` (n, 3)."""
    return directors(model.frames, np.arange(len(t)), t, np.zeros(len(t)))


def place(
    model: DrillingModel, s: FloatArray, across: FloatArray, slope: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Positions, unit tangents, offsets from the axis and tangents of the hole, (n, 3) each, of nodes at depths ``s`` (n,) [m].

    across, slope: as of ``lateral_shape``.
    """
    assert model.well is not None
    t, second, third = _directors(model, s)
    offset = across[:, :1] * second + across[:, 1:] * third
    tangent = t + slope[:, :1] * second + slope[:, 1:] * third
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    return np.asarray(model.well.at(s)[0]) + offset, tangent, offset, t
