"""Rolling without slip: a round rigid body on a plane, or on the wall of a straight round hole
(kernels/joints/joints.hpp).

The only non-holonomic constraint of the package: the velocity of the body's point at the contact is zero
along the surface.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.component import Component, ElementBlock, Field
from drillpetsc.kernels.parameters import Parameters
from drillpetsc.physics.joints import SCALE
from drillpetsc.physics.rigid_bodies import VERTEX_SLOTS, local_vertices


class Rolling(Component):
    """A body of ``radius`` [m] on ``node``, whose centre is ``center`` [m] along the tangent from it, rolls.

    On a plane through ``point`` with ``normal`` (to the side of the body); or, with ``hole`` [m] the radius
    of a hole whose axis runs through ``point`` along ``normal``, on its wall: then it slides freely along the
    hole unless ``grips_along``. Its start must satisfy the constraints in place and velocity.  Rolling has no
    statics: it does not fix a place. Field ``rolling.force`` (3) in units of SCALE: normal force, and the two
    forces along the surface.
    """

    name = "rolling"

    def __init__(
        self,
        nodes: int,
        node: int,
        radius: float,
        point: FloatArray,
        normal: FloatArray,
        center: float = 0.0,
        hole: float | None = None,
        grips_along: bool = True,
    ):
        self.nodes, self.node = nodes, node
        n = np.asarray(normal, dtype=float) / np.linalg.norm(normal)
        side = np.eye(3)[int(np.argmin(np.abs(n)))]
        side = side - n * (side @ n)
        side /= np.linalg.norm(side)
        self._constants: dict[str, Any] = {
            "wall": hole is not None,
            "center": center,
            "radius": radius,
            "point": point,
            "normal": n,
            "side": side,
            "hole": hole or 0.0,
            "along": grips_along,
            "scale": SCALE,
        }
        self.multipliers = 3

    def regions(self) -> dict[str, np.ndarray]:
        return {"rolling": np.arange(self.nodes) == self.node}

    def fields(self) -> tuple[Field, ...]:
        return (
            Field(
                "rolling.force",
                3,
                physics="joint",
                region="rolling",
                second_order=False,
                differential=False,
                multiplier=True,
            ),
        )

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        _, vertices = local_vertices(part, np.array([self.node]))
        params = Parameters("rolling", len(vertices), **self._constants).array
        return (
            ElementBlock(
                "rolling", "rolling", "vertex", vertices, (*VERTEX_SLOTS, ("rolling.force", 0)), (0,), params
            ),
        )

    def force(self, system) -> FloatArray:
        """(3,) normal force on the body and the two forces along the surface [N], on the rank of the node;
        else zero."""
        local = np.flatnonzero((system.chain.vertices == self.node) & system.chain.owned)
        return SCALE * system.field("rolling.force")[local[0]] if len(local) else np.zeros(3)
