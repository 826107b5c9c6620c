"""Fluid and string at rest together: the steady flow in the string as it hangs, the string under the flow's forces, until both agree."""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.steady_flow import fluid_unknowns, steady_flow
from drillpetsc.errors import SolveError
from drillpetsc.model.drilling_model import Scene
from drillpetsc.solvers.static_newton import Equilibrium, Statics

ROUNDS = 30
AGREED = 1e-10  # change of pressures and flows relative to their scales
NEARLY = 1e-6  # enough when rounding stops the rounds


def begin_flow(scene: Scene, t: float = 0.0) -> None:
    """Steady flow in the string where it is now; the fluid then stays as it is (frozen) until ``agree`` or ``let_flow``."""
    if scene.fluid is not None:
        steady_flow(scene.model, t)
        scene.model.assembly.freeze(fluid_unknowns(scene.model))


def agree(scene: Scene, solver: Statics, report: Equilibrium, lowering: float = 0.0) -> None:
    """Steady flow and string in turn, from a string in equilibrium under the frozen flow; raises SolveError where they do not settle.

    lowering: speed at which the top lets the string down [m/s]; the mud then flows as it does about the moving string (surge).
    The rounds converge by the ratio of what the fluid and what the steel gives way, a few percent.
    """
    if scene.fluid is None:
        return
    model = scene.model
    mine, best = fluid_unknowns(model), np.inf
    form = scene.case.fluid.formulation  # type: ignore[union-attr]
    if lowering and form == "mixed":  # the flow of the other starts as the pump's
        place = model.layout.place["string.position"]
        tangent = scene.tangent if scene.well is None else np.asarray(scene.well.at(scene.mesh.node_depth)[1])
        solver.rates = np.zeros_like(model.assembly.y)
        solver.rates[place] = lowering * tangent[model.line.vertices]
        model.assembly.y[:] = solver.rates
    for _ in range(ROUNDS):
        before = model.assembly.x[: model.layout.size][mine].copy()
        steady_flow(model, 0.0)
        change = np.abs(model.assembly.x[: model.layout.size][mine] - before) / model.scale[mine]
        size = solver.largest(float(change.max(initial=0.0)))
        model.assembly.freeze(mine)
        if size < AGREED or (size < NEARLY and size > 0.5 * best):
            return
        best = min(best, size)
        solver.settle_near(report)
    raise SolveError(f"string and fluid did not agree on a steady state in {ROUNDS} rounds (last change {size:.1e} of the scales)")


def let_flow(scene: Scene) -> None:
    """All unknowns free again; the flow steady in the string with the rates it has now, the reactions those of this state."""
    if scene.fluid is not None:
        scene.model.assembly.freeze(None)
        steady_flow(scene.model, 0.0)
        scene.model.sum_residual(0.0, scene.model.new_condensed())
