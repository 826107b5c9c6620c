"""Static equilibrium of a string with quaternion elements: the ANCF equilibrium, then Newton's method.

Manual: sec-quaternion-constraints.
"""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.statics.equilibrium import StaticState, director_equilibrium
from drillpetsc.analysis.statics.flow_coupling import surge_rates
from drillpetsc.analysis.statics.placement import (
    average_over_turn,
    place_along_hole,
    prescribed_motion,
)
from drillpetsc.analysis.statics.steady_flow import fluid_unknowns
from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.settings import BeamTheory
from drillpetsc.errors import SolveError
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.model.drilling_model import DrillingModel, build_model, is_quasi_static
from drillpetsc.physics.quaternion.beam import minimal_rotation, product, quaternions, turned
from drillpetsc.solvers.chain.chain_lu import ZeroPivot
from drillpetsc.solvers.chain.constraint_products import ConstraintProducts
from drillpetsc.solvers.time.newton import shared_factor

CONVERGED_INCREMENT = 2.0e-9  # largest increment of a converged state, in the fields' scales
MAX_ITERATIONS = 40


def quaternion_equilibrium(
    model: DrillingModel, motion: tuple[float, float] | None, lateral_friction: bool
) -> StaticState:
    """Find the ANCF equilibrium of the same case, then iterate by Newton's method on the rows of the quaternion string.

    motion, lateral_friction: see ``find_equilibrium``.  Collective.
    Raises SolveError if no equilibrium is found.
    """
    ancf = build_model(model.case.model_copy(update={"beam": BeamTheory()}), model.system.comm)
    if is_quasi_static(model.case):
        average_over_turn(ancf, prescribed_motion(model)[1])
    state = director_equilibrium(ancf, motion, lateral_friction)
    place_along_hole(model)
    copy_ancf_state(ancf.system, model.system)
    # statics may have moved the top across the hole, to the wall
    model.top.copy_position(ancf.top)
    model.copy_sliding_direction(ancf)
    for (
        component
    ) in model.system.components:  # size and direction of the hole at the string's present position
        component.locate_hole(model.system.assembly)
    asm = model.system.assembly
    # pressures and flow rates are those of the ANCF string; their drag uses its rates
    rates = surge_rates(model, prescribed_motion(model)[0]) if motion is None else None
    asm.freeze(fluid_unknowns(model.system))
    try:
        state.equilibrium.iterations += solve_at_rest(model.system, rates=rates)
    finally:
        asm.freeze(None)
    return state


def copy_ancf_state(ancf: DiscreteSystem, system: DiscreteSystem) -> None:
    """Copy the state and the dead load of an ANCF string to a quaternion string with the same nodes.

    The stretch ratios of changes of section have no counterpart and are left out; those below rigid items are copied.
    """
    nodes, v, phi = ancf.chain.vertices, ancf.field("string.tangent"), ancf.field("string.spin")[:, 0]
    length = np.linalg.norm(v, axis=1)
    t, a = v / length[:, None], ancf.frames.reference[nodes]
    q = product(minimal_rotation(a, t), turned(quaternions(ancf.frames)[nodes], phi))
    for name, values in (
        ("position", ancf.field("string.position")),
        ("strain", length[:, None] - 1.0),
        ("quaternion", q),
    ):
        system.assembly.x[system.layout.dofs[f"string.{name}"]] = values
    for other in system.layout.fields:  # mud, hole, bit
        if not other.name.startswith("string.") or other.name == "string.ratio":
            dofs, ancf_dofs = system.layout.dofs[other.name], ancf.layout.dofs[other.name]
            at = (dofs >= 0) & (ancf_dofs >= 0)
            system.assembly.x[dofs[at]] = ancf.assembly.x[ancf_dofs[at]]
    if ancf.assembly.dead_load is not None:
        dead_load, name = np.zeros(system.layout.size), "string.position"
        dead_load[system.layout.dofs[name]] = ancf.assembly.dead_load[ancf.layout.dofs[name]]
        system.assembly.dead_load = dead_load


def solve_at_rest(system: DiscreteSystem, t: float = 0.0, rates: FloatArray | None = None) -> int:
    """Solve for the equilibrium at rest by Newton's method from the assembly's x; returns the iterations.

    Collective.

    t: time of the inputs [s].
    rates: (n+1,) of a steady motion that the mud sees [SI of each field per second]; zero by default.
    Raises SolveError if the iteration does not converge.
    """
    for component in system.components:
        component.constrain_positions(True)
    try:
        return _newton(system, t, rates)
    finally:
        for component in system.components:
            component.constrain_positions(False)


def _newton(system: DiscreteSystem, t: float, rates: FloatArray | None) -> int:
    asm, factor, q = system.assembly, shared_factor(system), system.new_condensed()
    constraints = ConstraintProducts(system)
    rows, owned = system.new_condensed(), system.layout.local_of_owned
    step, before, mpi = np.zeros(len(owned)), np.inf, system.comm.tompi4py()
    for iteration in range(1, MAX_ITERATIONS + 1):
        asm.y[:], asm.a[:] = 0.0 if rates is None else rates, 0.0
        system.sum_residual(t, rows)
        asm.jacobian(t, (1.0, 0.0, 0.0), condensed=False)
        constraints.add(asm.values)
        try:
            factor.factor(asm.values)
        except ZeroPivot:
            raise SolveError(
                "singular stiffness matrix",
                hint="check the end conditions: a rigid-body mode may not be constrained",
                **system.locate_largest_residual(t),
            ) from None
        factor.solve_owned(rows.getArray(readonly=1), step)
        system.store_unknowns(q)
        q.getArray()[:] -= step
        system.load_unknowns(q)
        size = max(mpi.allgather(float(np.max(np.abs(step) / system.scale[owned], initial=0.0))))
        if size < CONVERGED_INCREMENT or (
            size < 1e-5 and size > 0.5 * before
        ):  # rounding stops the iteration
            system.sum_residual(t, rows)
            return iteration
        before = size
    raise SolveError(
        f"statics did not converge in {MAX_ITERATIONS} iterations (last increment {before:.1e} of the fields' scales)",
        **system.locate_largest_residual(t),
    )
