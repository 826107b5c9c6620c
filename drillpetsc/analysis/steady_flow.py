"""Steady flow of the drilling fluid in a string that stands (or moves) as it is: Newton's method on pressures
and flow rates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.errors import SolveError
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.model.fluid import FluidComponents
from drillpetsc.solvers.chain_lu import ZeroPivot
from drillpetsc.solvers.newton import chain_factor

CONVERGED = 1e-12  # increment relative to the fields' scales
NEARLY = 1e-7  # good enough when rounding stops the iteration
ITERATIONS = 100
#: weight of the storage terms [1/s]: a closed bore keeps the level of pressure it has, which the steady
#: equations leave open
LEVEL = 1e-8


@dataclass
class SteadyFlow:
    iterations: int = 0
    increment: float = 0.0


def fluid_unknowns(system: DiscreteSystem) -> np.ndarray:
    """(n,) mask of the local unknowns that belong to the fluid."""
    fluid = np.array([f.physics == "fluid" for f in system.layout.fields])
    return fluid[system.layout.field_of]


def place_fluid(system: DiscreteSystem, fluid: FluidComponents, t: float = 0.0) -> None:
    """Hydrostatic pressure under the outlet's (or nothing), flow rates those of the pump at ``t``."""
    asm, held = system.assembly, "string.position" not in system.layout.dofs
    flow = 0.0
    if fluid.bore is not None and fluid.bore.flow_rate is not None:
        flow = fluid.bore.flow_rate.value(t)
    if held:
        position = next(r.held_at for r in (fluid.bore, fluid.annulus) if r is not None)
        assert position is not None
        place, top = position[system.chain.vertices], position[0]
    else:
        place = system.field("string.position")
        top = (
            system.comm.tompi4py().bcast(place[0] if len(place) else None)
            if system.comm.size > 1
            else place[0]
        )
    gravity = fluid.constants.gravity
    head = fluid.constants.density * ((place - top) @ gravity)
    level = fluid.annulus.outlet.value(t) if fluid.annulus is not None else 0.0
    for component, sign in ((fluid.bore, 1.0), (fluid.annulus, -1.0)):
        if component is None:
            continue
        pump = getattr(component, "pump_pressure", None)
        base = level if pump is None else pump.value(t)
        closed = fluid.bit is None or not fluid.bit.has_link
        asm.x[system.layout.dofs[f"{component.name}.pressure"][:, 0]] = base + head
        if f"{component.name}.flow" in system.layout.dofs:
            rate = system.layout.dofs[f"{component.name}.flow"]
            asm.x[rate[rate >= 0]] = 0.0 if closed else sign * flow
    if "bit.flow" in system.layout.dofs:
        where = system.layout.dofs["bit.flow"][:, 0]
        asm.x[where[where >= 0]] = flow
    if fluid.volumes is not None:
        for name, values in fluid.volumes(level).items():
            system.set_field(name, values[:, None])


def steady_flow(system: DiscreteSystem, t: float = 0.0) -> SteadyFlow:
    """Solve for pressures and flow rates with the string's place and rates as they are in the assembly;
    collective.

    Raises SolveError where no steady flow is found.
    """
    asm, report = system.assembly, SteadyFlow()
    on_rank = fluid_unknowns(system)
    for component in system.components:  # size and direction of the hole where the string is now
        component.locate_hole(asm)
    asm.freeze(~on_rank)
    try:
        factor, f = chain_factor(system), system.new_condensed()
        weight, place = 1.0 / system.scale, np.flatnonzero(on_rank)
        best, quiet, share = np.inf, 0, 1.0
        asm.y[place] = asm.a[place] = 0.0
        _fill_chamber(system)
        for _ in range(ITERATIONS):
            asm.invalidate_prescribed_values()
            system.sum_residual(t, f)
            asm.jacobian(t, (1.0, LEVEL, 0.0), condensed=False)
            step = np.zeros(len(system.layout.local_of_owned))
            f.getArray()[~on_rank[system.layout.local_of_owned]] = (
                0.0  # the string stays: not even its ends' rounding errors are put right
            )
            try:
                factor.factor(asm.values)
            except ZeroPivot as error:
                raise SolveError(
                    "the steady flow is not determined", time=t, **system.locate_largest_residual(t)
                ) from error
            factor.solve_owned(-f.getArray(readonly=1), step)
            owned = system.layout.local_of_owned
            size = _largest(
                system,
                float(np.max(np.abs(step[on_rank[owned]]) * weight[owned][on_rank[owned]], initial=0.0)),
            )
            if not np.isfinite(size):
                raise SolveError("the steady flow ran away", time=t, **system.locate_largest_residual(t))
            share = (
                min(1.0, 2 * share) if size < best else max(0.1, 0.5 * share)
            )  # yield stress makes full steps overshoot
            _move(system, step * share)
            report.iterations += 1
            report.increment = size
            quiet += size < NEARLY and size > 0.5 * best
            if share == 1.0 and (size < CONVERGED or quiet >= 2):
                return report
            best = min(best, size)
    finally:
        asm.freeze(None)
    raise SolveError(
        f"the steady flow did not converge in {ITERATIONS} iterations (last increment {report.increment:.1e} of the scales)",
        time=t,
        hint="a larger fluid.rheology.shear_rate smooths a yield stress",
        **system.locate_largest_residual(t),
    )


def freeze_flow(model: DrillingModel, t: float = 0.0) -> None:
    """Solve for the steady flow in the string where it is now, and hold the fluid's unknowns (``release_flow``)."""
    if model.fluid is not None:
        steady_flow(model.system, t)
        model.system.assembly.freeze(fluid_unknowns(model.system))


def release_flow(model: DrillingModel) -> None:
    """Free all unknowns; the flow is steady in the string with the rates it has now, and reactions are renewed."""
    if model.fluid is not None:
        model.system.assembly.freeze(None)
        steady_flow(model.system, 0.0)
        model.system.sum_residual(0.0, model.system.new_condensed())


def _fill_chamber(system: DiscreteSystem) -> None:
    """With formulation hermite: volumes of the annulus and their rates, at every node alike, for the bit's
    chamber as it lies and moves."""
    missing = [component.missing_volume(system.assembly) for component in system.components]
    lack = next((np.array(volume) for volume in missing if volume is not None), None)
    if lack is None or "annulus.volume" not in system.layout.dofs:
        return
    lack = lack if system.comm.size == 1 else system.comm.tompi4py().allreduce(lack)
    asm, place = system.assembly, system.layout.dofs["annulus.volume"][:, 0]
    asm.x[place] += lack[0]
    asm.y[place] = lack[1]


def _move(system: DiscreteSystem, step: np.ndarray) -> None:
    q = system.new_condensed()
    system.store_unknowns(q)
    q.getArray()[:] += step
    system.load_unknowns(q)


def _largest(system: DiscreteSystem, value: float) -> float:
    from mpi4py import MPI

    return value if system.comm.size == 1 else float(system.comm.tompi4py().allreduce(value, op=MPI.MAX))
