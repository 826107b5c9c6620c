"""Rolling without slip: a round rigid body on a plane, or on the wall of a straight round hole
(kernels/joints/joints.hpp).

It is the only non-holonomic constraint of the package: the velocity of the body's contact point is zero along
the surface (manual: sec-joints-rolling).
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
    """Rolling of a round body on a plane, or on the wall of a hole.

    The start must satisfy the constraints in position and velocity.  There is no statics of rolling, since it
    does not fix a position.  The field ``rolling.force`` (3) is the normal force and the two forces along the
    surface, in units of SCALE.

    nodes: of the string; node: of the body; radius: of the body [m].
    center: distance from the node along the tangent to the body's centre [m].
    point: (3,) on the plane [m]; normal: (3,) of the plane, towards the body.
    hole: radius of a hole [m] whose axis goes through ``point`` along ``normal``; None: a plane.
    grips_along: no slip along the hole either.
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
        """Return (3,) normal force on the body and the two forces along the surface [N].

        Zero on ranks without the node.
        """
        local = np.flatnonzero((system.chain.vertices == self.node) & system.chain.owned)
        return SCALE * system.field("rolling.force")[local[0]] if len(local) else np.zeros(3)
