"""Equivalent density: the density of a still column of mud from the flow line that has the pressure of a point."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from drillpetsc.arrays import FloatArray

if TYPE_CHECKING:
    from drillpetsc.model.drilling_model import DrillingModel

LOWEST_COLUMN = 1.0  # height of mud above a point below which it has no equivalent density [m]


def equivalent_density(
    pressure: FloatArray | float, height: FloatArray | float, gravity: float
) -> FloatArray:
    """Compute p/(g h) [kg/m3]; nan if the column is lower than LOWEST_COLUMN, or the point lies above the flow line.

    pressure: (k,) gauge [Pa]; height: (k,) vertical, below the flow line [m]; gravity: [m/s2].
    """
    out = np.full(np.broadcast(height, pressure).shape, np.nan)
    height = np.asarray(height, dtype=float)
    np.divide(pressure, gravity * height, out=out, where=height >= LOWEST_COLUMN)
    return out


def below_flow_line(model: DrillingModel, position: FloatArray) -> FloatArray:
    """Vertical depth below the flow line (k,) [m] of points (k, 3) [m] of the string at its present position."""
    assert model.fluid is not None and model.case.fluid is not None
    gravity = np.asarray(model.fluid.constants.gravity)
    size = float(np.linalg.norm(gravity))
    if size == 0.0:
        return np.full(len(position), np.nan)
    return np.asarray(position @ gravity) / size - model.case.fluid.flow_line
