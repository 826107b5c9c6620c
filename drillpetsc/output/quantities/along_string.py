"""Motion, forces and surroundings of the string at its nodes and elements."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.fem.quantity import FloatArray, Quantity, Sample, quantities_of

quantity = quantities_of(Path(__file__).with_name("measured.csv"))


def _position(string: Any, sample: Sample) -> FloatArray:
    return np.asarray(string.position(sample))


def _offset(string: Any, position: FloatArray, depth: FloatArray) -> FloatArray:
    return np.asarray(string.offset(position, depth))


def _bending_components(string: Any, sample: Sample) -> FloatArray:
    return np.asarray(string.bending_components(sample))


def _shear_components(string: Any, sample: Sample) -> FloatArray:
    return np.asarray(string.shear_components(sample))


OFFSET_X = quantity("offset_x", value=_position, size=3, finish=_offset, index=0)
#: bending moment and shear force of a string
BENDING: tuple[Quantity, ...] = (
    quantity("bending_moment", value=lambda string, sample: string.bending_moment(sample)),
    quantity("bending_moment_x", value=_bending_components, size=2, index=0),
    quantity("bending_moment_y", value=_bending_components, size=2, index=1),
    quantity("shear_force", value=lambda string, sample: string.shear_force(sample)),
    quantity("shear_force_x", value=_shear_components, size=2, index=0),
    quantity("shear_force_y", value=_shear_components, size=2, index=1),
)
HOLE_RADIUS = quantity(
    "hole_radius",
    value=_position,
    size=3,
    finish=lambda string, position, depth: string.hole_radius(position),
)
STRING_FIELDS: tuple[Quantity, ...] = (
    quantity("md", value=lambda string, sample: string.node_depth),
    quantity("outer_radius", value=lambda string, sample: string.outer_radius),
    quantity(
        "displacement",
        value=_position,
        size=3,
        finish=lambda string, position, depth: position - string.start,
        index=None,
    ),
    quantity("slope", value=lambda string, sample: string.slope(sample), size=3, index=None),
    quantity("velocity", value=lambda string, sample: string.motion(sample)[:, 3:6], size=3, index=None),
    quantity("spin", value=lambda string, sample: string.motion(sample)[:, 6]),
    quantity("spin_angle", value=lambda string, sample: string.motion(sample)[:, 7]),
    OFFSET_X,
    quantity("offset_y", value=_position, size=3, finish=_offset, index=1),
    quantity("axial_force", value=lambda string, sample: string.axial_force(sample)),
    quantity(
        "torque",
        value=lambda string, sample: string.results(sample, "torque"),
        finish=lambda string, values, depth: -values,
    ),
    *BENDING,
    quantity("stress", value=lambda string, sample: string.stress(sample)),
    quantity(
        "effective_tension",
        value=lambda string, sample: string.tension_and_pressure(sample),
        size=2,
        finish=lambda string, parts, depth: parts[:, :1] + parts[:, 1:],
    ),
)
