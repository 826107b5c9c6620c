"""Steady flow of the drilling fluid with fixed position and motion of the string: Newton's method on
pressures and flows.

Manual: sec-mud-steady.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.errors import SolveError
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.model.fluid import FluidComponents
from drillpetsc.parallel import largest, total
from drillpetsc.solvers.chain.chain_lu import ZeroPivot
from drillpetsc.solvers.time.newton import shared_factor

CONVERGED_INCREMENT = 1e-12  # largest increment of a converged flow, in the fields' scales
ROUNDING_INCREMENT = (
    1e-7  # increment below which a flow counts as converged where rounding stops the iteration
)
MAX_ITERATIONS = 100
#: weight of the storage terms [1/s]; the steady equations do not determine the pressure level of a closed
#: bore, which these terms leave at its value
STORAGE_WEIGHT = 1e-8


@dataclass
class SteadyFlow:
    """Iterations of a steady flow, and its last increment in the fields' scales."""

    iterations: int = 0
    increment: float = 0.0


def fluid_unknowns(system: DiscreteSystem) -> np.ndarray:
    """Return the mask (n,) of the local unknowns that belong to the fluid."""
    fluid = np.array([f.physics == "fluid" for f in system.layout.fields])
    return fluid[system.layout.field_of]


def set_fluid_at_rest(system: DiscreteSystem, fluid: FluidComponents, t: float = 0.0) -> None:
    """Set hydrostatic pressures below the outlet's pressure, and the pump's flow rate in all channels; nozzles above the bit
    take their share by areas.

    Without an outlet the pressure at the top is zero.  ``t``: time of outlet and pump [s].
    """
    asm, is_held = system.assembly, "string.position" not in system.layout.dofs
    flow = 0.0
    if fluid.bore is not None and fluid.bore.flow_rate is not None:
        flow = fluid.bore.flow_rate.value(t)
    if is_held:
        held_position = next(r.held_at for r in (fluid.bore, fluid.annulus) if r is not None)
        assert held_position is not None
        position, top = held_position[system.chain.vertices], held_position[0]
    else:
        position = system.field("string.position")
        top = (
            system.comm.tompi4py().bcast(position[0] if len(position) else None)
            if system.comm.size > 1
            else position[0]
        )
    gravity = fluid.constants.gravity
    head = fluid.constants.density * ((position - top) @ gravity)
    level = fluid.annulus.flow_line.pressure.value(t) if fluid.annulus is not None else 0.0
    closed = fluid.bit is None or not fluid.bit.has_link
    vertices, through_bit = system.chain.vertices, 1.0
    going_on = np.ones(len(vertices))  # share of the pump's flow in the cell above each local vertex
    if fluid.side is not None:
        dofs = system.layout.dofs["side.flow"][:, 0]
        for link, share in zip(fluid.side.links, fluid.side.shares_of_pump(), strict=True):
            through_bit -= share
            going_on[vertices > link.node] -= share
            here = dofs[vertices == link.node]
            asm.x[here[here >= 0]] = flow * share
    for component, sign in ((fluid.bore, 1.0), (fluid.annulus, -1.0)):
        if component is None:
            continue
        pump = getattr(component, "pump_pressure", None)
        base = level if pump is None else pump.value(t)
        asm.x[system.layout.dofs[f"{component.name}.pressure"][:, 0]] = base + head
        if f"{component.name}.flow" in system.layout.dofs:
            dofs = system.layout.dofs[f"{component.name}.flow"][:, 0]
            start = np.zeros(len(dofs)) if closed and fluid.side is None else sign * flow * going_on
            asm.x[dofs[dofs >= 0]] = start[dofs >= 0]
    if "bit.flow" in system.layout.dofs:
        dofs = system.layout.dofs["bit.flow"][:, 0]
        asm.x[dofs[dofs >= 0]] = flow * through_bit
    if fluid.volumes is not None:
        for name, values in fluid.volumes(level).items():
            system.set_field(name, values[:, None])


def steady_flow(system: DiscreteSystem, t: float = 0.0, tolerance: float = CONVERGED_INCREMENT) -> SteadyFlow:
    """Solve for pressures and flow rates with the string's position and rates fixed; collective.

    system: its assembly contains position and rates of the string and the start of the iteration.
    t: time of the inputs [s]; tolerance: last increment of a converged flow, in the fields' scales.
    Raises SolveError where no steady flow is found.
    """
    asm, report = system.assembly, SteadyFlow()
    is_fluid = fluid_unknowns(system)
    for component in system.components:  # size and direction of the hole at the string's present position
        component.locate_hole(asm)
    asm.freeze(~is_fluid)
    try:
        factor = shared_factor(system)
        weight, dofs = 1.0 / system.scale, np.flatnonzero(is_fluid)
        smallest, stalled, damping = np.inf, 0, 1.0
        asm.y[dofs] = asm.a[dofs] = 0.0
        _fill_chamber(system)
        for _ in range(MAX_ITERATIONS):
            step = np.zeros(len(system.layout.local_of_owned))
            try:
                rows = _flow_rows(system, t, is_fluid, factored=True)
            except ZeroPivot as error:
                raise SolveError(
                    "the steady flow is not determined", time=t, **system.locate_largest_residual(t)
                ) from error
            factor.solve_owned(-rows, step)
            owned = system.layout.local_of_owned
            size = largest(
                system.comm,
                float(np.max(np.abs(step[is_fluid[owned]]) * weight[owned][is_fluid[owned]], initial=0.0)),
            )
            if not np.isfinite(size):
                raise SolveError("the steady flow is not finite", time=t, **system.locate_largest_residual(t))
            # a yield stress makes full steps overshoot
            damping = min(1.0, 2 * damping) if size < smallest else max(0.1, 0.5 * damping)
            _move(system, step * damping)
            report.iterations += 1
            report.increment = size
            stalled += size < ROUNDING_INCREMENT and size > 0.5 * smallest
            if damping == 1.0 and (size < tolerance or stalled >= 2):
                return report
            smallest = min(smallest, size)
    finally:
        asm.freeze(None)
    raise SolveError(
        f"the steady flow did not converge in {MAX_ITERATIONS} iterations (last increment {report.increment:.1e} of the scales)",
        time=t,
        hint="a larger fluid.rheology.shear_rate smooths a yield stress",
        **system.locate_largest_residual(t),
    )


def flow_rows(system: DiscreteSystem, t: float, factor: bool = False) -> np.ndarray:
    """Residual (owned,) of a steady flow at the assembly's unknowns, zero in the string's rows; collective.

    t: time of the inputs [s]; factor: factor the matrix there, too, with ``shared_factor``.
    """
    asm, is_fluid = system.assembly, fluid_unknowns(system)
    for component in system.components:
        component.locate_hole(asm)
    asm.freeze(~is_fluid)
    try:
        asm.y[:-1][is_fluid] = asm.a[:-1][is_fluid] = 0.0
        return _flow_rows(system, t, is_fluid, factored=factor)
    finally:
        asm.freeze(None)


def _flow_rows(system: DiscreteSystem, t: float, is_fluid: np.ndarray, factored: bool) -> np.ndarray:
    asm, rows = system.assembly, system.new_condensed()
    asm.invalidate_prescribed_values()
    system.sum_residual(t, rows)
    if factored:
        asm.jacobian(t, (1.0, STORAGE_WEIGHT, 0.0), condensed=False)
        shared_factor(system).factor(asm.values)
    # the string does not move, not even by the rounding errors of its ends
    return np.where(is_fluid[system.layout.local_of_owned], rows.getArray(readonly=1), 0.0)


def freeze_flow(model: DrillingModel, t: float = 0.0, tolerance: float = CONVERGED_INCREMENT) -> None:
    """Solve for the steady flow with the present string at ``t`` [s], and freeze the fluid's unknowns.

    Collective.
    """
    if model.fluid is not None:
        steady_flow(model.system, t, tolerance)
        model.system.assembly.freeze(fluid_unknowns(model.system))


def release_flow(model: DrillingModel) -> SteadyFlow:
    """Release all unknowns, solve for the steady flow at the string's present rates, update the reactions.

    Collective.
    """
    if model.fluid is None:
        return SteadyFlow()
    model.system.assembly.freeze(None)
    found = steady_flow(model.system, 0.0)
    model.system.sum_residual(0.0, model.system.new_condensed())
    return found


def _fill_chamber(system: DiscreteSystem) -> None:
    """With the Hermite formulation, set the volume and volume rate of the annulus that the bit's chamber needs.

    Collective.

    All nodes get the same addition.
    """
    volumes = [component.missing_volume(system.assembly) for component in system.components]
    missing = next((np.array(volume) for volume in volumes if volume is not None), None)
    if missing is None or "annulus.volume" not in system.layout.dofs:
        return
    missing = total(system.comm, missing)
    asm, dofs = system.assembly, system.layout.dofs["annulus.volume"][:, 0]
    asm.x[dofs] += missing[0]
    asm.y[dofs] = missing[1]


def _move(system: DiscreteSystem, step: np.ndarray) -> None:
    """Add the step (owned,) to the assembly's unknowns, ghosts included; collective."""
    q = system.new_condensed()
    system.store_unknowns(q)
    q.getArray()[:] += step
    system.load_unknowns(q)
