"""Loss of the lines between pump and string: standpipe, hose, swivel, kelly."""

from __future__ import annotations

import math
from dataclasses import dataclass

from drillpetsc.physics.fluid.rheology import Rheology, pressure_gradient


@dataclass(frozen=True)
class SurfaceLine:
    """A pipe with the string's friction law, or a measured loss scaled with the flow rate squared.

    rheology, density: of the fluid [kg/m3].
    length, diameter: of the pipe [m]; 0 with a measured loss.
    measured, at: loss [Pa] at a flow rate [m3/s]; 0 with a pipe.
    """

    rheology: Rheology
    density: float
    length: float = 0.0
    diameter: float = 0.0
    measured: float = 0.0
    at: float = 0.0

    def loss(self, flow_rate: float) -> float:
        """Compute the pressure loss [Pa], with the sign of the flow rate [m3/s]."""
        if self.at > 0:
            return self.measured * flow_rate * abs(flow_rate) / self.at**2
        speed = flow_rate / (math.pi / 4 * self.diameter**2)
        gradient = pressure_gradient(self.rheology, [speed], [self.diameter], [False], [self.density])
        return float(gradient[0]) * self.length
