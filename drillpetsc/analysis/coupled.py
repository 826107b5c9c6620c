"""Fluid and string at rest together: the steady flow in the string as it hangs, the string under the flow's
forces, until both agree."""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.steady_flow import fluid_unknowns, steady_flow
from drillpetsc.errors import SolveError
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.solvers.static_newton import Equilibrium, StaticNewton

ROUNDS = 30
AGREED = 1e-10  # change of pressures and flows relative to their scales
NEARLY = 1e-6  # enough when rounding stops the rounds


def freeze_flow(model: DrillingModel, t: float = 0.0) -> None:
    """Steady flow in the string where it is now; the fluid then stays as it is (frozen) until ``agree`` or
    ``release_flow``."""
    if model.fluid is not None:
        steady_flow(model.system, t)
        model.system.assembly.freeze(fluid_unknowns(model.system))


def couple_flow_and_string(
    model: DrillingModel, solver: StaticNewton, report: Equilibrium, lowering: float = 0.0
) -> None:
    """Steady flow and string in turn, from a string in equilibrium under the frozen flow; raises SolveError
    where they do not settle.

    lowering: speed at which the top lets the string down [m/s]; the mud then flows as it does about the
    moving string (surge). The rounds converge by the ratio of what the fluid and what the steel gives way, a
    few percent.
    """
    if model.fluid is None:
        return
    system = model.system
    on_rank, best = fluid_unknowns(system), np.inf
    form = model.case.fluid.formulation  # type: ignore[union-attr]
    if lowering and form == "mixed":  # the flow of the other starts as the pump's
        place = system.layout.dofs["string.position"]
        tangent = model.tangent if model.well is None else np.asarray(model.well.at(model.mesh.node_depth)[1])
        solver.rates = np.zeros_like(system.assembly.y)
        solver.rates[place] = lowering * tangent[system.chain.vertices]
        system.assembly.y[:] = solver.rates
    for _ in range(ROUNDS):
        before = system.assembly.x[: system.layout.size][on_rank].copy()
        steady_flow(system, 0.0)
        change = np.abs(system.assembly.x[: system.layout.size][on_rank] - before) / system.scale[on_rank]
        size = solver.largest(float(change.max(initial=0.0)))
        system.assembly.freeze(on_rank)
        if size < AGREED or (size < NEARLY and size > 0.5 * best):
            return
        best = min(best, size)
        solver.newton_damped(report)
    raise SolveError(
        f"string and fluid did not agree on a steady state in {ROUNDS} rounds (last change {size:.1e} of the scales)"
    )


def release_flow(model: DrillingModel) -> None:
    """All unknowns free again; the flow steady in the string with the rates it has now, the reactions those
    of this state."""
    if model.fluid is not None:
        model.system.assembly.freeze(None)
        steady_flow(model.system, 0.0)
        model.system.sum_residual(0.0, model.system.new_condensed())
