"""The push at which a level pipe snakes: where its tangent stiffness loses its first positive pivot."""

from __future__ import annotations

import numpy as np

from drillpetsc.errors import SolveError
from drillpetsc.fem.component import PrescribedMotion
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.physics.end_conditions import EndPlace, FixedEnd, Loads, NodeLoad
from drillpetsc.solvers.static.static_newton import Equilibrium, StaticNewton


class SideHold(FixedEnd):
    """Holds a node sideways, free along the string."""

    def __init__(self, vertex, position, tangent):
        super().__init__(EndPlace(position, tangent, vertex), "pinned", spin=False)
        whole, target = self._condition, self.anchor[1:]
        self._condition = PrescribedMotion(
            vertex, whole.directions[1:], lambda t: target, lambda t: np.zeros(2), whole.names[1:]
        )


def buckling_load(model: DrillingModel, clearance: float, expected: float) -> float:
    """Load [N] of a pipe without friction on the low side of a level hole along north, hinged at both ends, to 2e-4.

    clearance: radial [m]; expected: load within 10 % of it.
    """
    lying, last = model.position + [0, 0, clearance], model.mesh.nodes - 1
    components = [
        model.beam,
        FixedEnd(EndPlace(lying[0], model.tangent[0]), "pinned"),
        SideHold(last, lying[-1], model.tangent[-1]),
        Loads((NodeLoad(last, (-1.0, 0.0, 0.0), factor=lambda t: t),), model.frames),
        model.contact,
    ]
    system = DiscreteSystem(model.mesh, model.frames, components)
    system.set_field("string.position", lying)
    system.set_field("string.tangent", model.tangent)
    model.contact.impose_sliding_direction(0.0, 0.0)
    solver = StaticNewton(system, clearance=clearance)

    def negative(force: float) -> int:
        solver.t = force
        try:
            solver.newton(Equilibrium())
        except SolveError:
            pass  # unstable, but straight without a disturbance
        return solver.negative_pivots()

    low, high = 0.9 * expected, 1.1 * expected
    assert negative(low) == 0 and negative(high) > 0
    while high - low > 2e-4 * high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if negative(middle) == 0 else (low, middle)
    return low
