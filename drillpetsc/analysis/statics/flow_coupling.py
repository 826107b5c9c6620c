"""Static state of string and steady flow together, from a string in equilibrium under frozen flow.

Manual: sec-statics-flow.
"""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.statics.placement import hole_at_string, share_of_top
from drillpetsc.analysis.statics.snapshot import Snapshot
from drillpetsc.analysis.statics.steady_flow import STORAGE_WEIGHT, fluid_unknowns, steady_flow
from drillpetsc.arrays import FloatArray
from drillpetsc.errors import SolveError
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.parallel import total
from drillpetsc.solvers.static.static_newton import Equilibrium, StaticNewton

MAX_COUPLING_ROUNDS = 30  # solves of flow and string in turn
COUPLING_TOLERANCE = 1e-10  # largest change of pressures and flows relative to their scales
COUPLING_SHARE = 1e-3  # increment of the string's solve over the flow's last change
ROUNDING_TOLERANCE = 1e-6  # largest change if rounding stops the coupling iteration
LEAST_SHARE = 0.05  # of a change, taken if the rounds do not contract


def surge_rates(model: DrillingModel, lowering: float) -> FloatArray | None:
    """Compute the rates (n+1,) of a string that its top lowers with ``lowering`` [m/s]; None where the flow does
    not see them.
    """
    if model.case.fluid is None or not lowering or model.case.fluid.formulation != "mixed":
        return None  # with the Hermite formulation the flow starts from the pump's rate
    system = model.system
    dofs, rates = system.layout.dofs["string.position"], np.zeros_like(system.assembly.y)
    tangent, _ = hole_at_string(model)
    here = system.chain.vertices
    rates[dofs] = lowering * share_of_top(model)[0][here, None] * tangent[here]
    return rates


def _flow_and_string_together(model: DrillingModel, solver: StaticNewton, report: Equilibrium) -> bool:
    """Solve for steady flow and string by Newton's method on all unknowns; collective.

    Returns False, with the state restored, if it does not converge.
    """
    system, start = model.system, Snapshot(model)
    fluid = fluid_unknowns(system)
    for component in system.components:  # the flow's hole is that at the string's present place
        component.locate_hole(system.assembly)
    system.assembly.freeze(None)
    solver.rate_weight = STORAGE_WEIGHT
    try:
        solver.newton(report)
    except SolveError:
        start.restore()
        return False
    finally:
        solver.rate_weight = 0.0
        system.assembly.freeze(fluid)
    return True


def settle_contents(model: DrillingModel, solver: StaticNewton, report: Equilibrium) -> None:
    """Let the contents of a Hermite flow answer the string, whose state was found under pressures straight between nodes.

    Collective.  The change is small; where Newton's method does not converge the state stays.
    """
    if model.case.fluid is not None and model.case.fluid.formulation == "hermite":
        _flow_and_string_together(model, solver, report)
        model.system.assembly.freeze(None)


def couple_flow_and_string(
    model: DrillingModel, solver: StaticNewton, report: Equilibrium, lowering: float = 0.0
) -> None:
    """Solve for steady flow and string, from a string in equilibrium under frozen flow; collective.

    Manual: sec-statics-flow.  Newton's method solves for both together.  Where it does not converge, and for flows of
    the Hermite formulation, they are solved in turn; the change then contracts in each round by the ratio of the fluid's
    compliance to the steel's, a few percent.  A column beside its buckling load is much softer: where a change is not
    half of the one before, a share of it is taken (Irons and Tuck, Int. J. Numer. Methods Eng. 1:275, 1969).

    report: gets the iterations of the string.
    lowering: speed at which the top lowers the string [m/s]; the flow is then that about the moving string
    (surge).
    Raises SolveError if the iteration does not converge.
    """
    if model.fluid is None:
        return
    system = model.system
    fluid, smallest = fluid_unknowns(system), np.inf
    rates = surge_rates(model, lowering)
    if rates is not None:
        solver.rates = rates
        system.assembly.y[:] = rates
    # the chamber of the Hermite formulation is filled from outside
    mixed = model.case.given_fluid.formulation == "mixed"
    if mixed and _flow_and_string_together(model, solver, report):
        return
    x, last, share, size = system.assembly.x[: system.layout.size], np.zeros(0), 1.0, np.inf
    for _ in range(MAX_COUPLING_ROUNDS):
        before, former = x[fluid].copy(), size
        steady_flow(system, 0.0)
        change = (x[fluid] - before) / system.scale[fluid]
        size = solver.largest(float(np.abs(change).max(initial=0.0)))
        system.assembly.freeze(fluid)
        if size < COUPLING_TOLERANCE or (size < ROUNDING_TOLERANCE and size > 0.5 * smallest):
            solver.newton(report)
            return
        smallest = min(smallest, size)
        if share < 1 or size > 0.5 * former:
            share = _share_of_change(system, last, change, share) if len(last) else share
            x[fluid] = before + share * change * system.scale[fluid]
        last = change
        solver.newton(report, COUPLING_SHARE * size)
    raise SolveError(
        f"string and fluid did not converge to a steady state in {MAX_COUPLING_ROUNDS} rounds "
        f"(last change {size:.1e} of the scales)"
    )


def _share_of_change(system: DiscreteSystem, last: FloatArray, change: FloatArray, share: float) -> float:
    """Share [-] of the ``change`` (k,) of the fluid's unknowns after one, ``last``, of which ``share`` was taken; collective."""
    owned = (system.owned_index >= 0)[fluid_unknowns(system)]
    turn = (change - last)[owned]
    along, square = (total(system.comm, float(turn @ v[owned])) for v in (last, change - last))
    return float(np.clip(-share * along / square, LEAST_SHARE, 1.0)) if square > 0 else share
