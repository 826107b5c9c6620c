"""Static equilibrium of the string with quaternion elements: the ANCF equilibrium, then Newton's method."""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.equilibrium import StaticState, director_equilibrium
from drillpetsc.analysis.placement import place_along_hole, prescribed_motion
from drillpetsc.analysis.steady_flow import fluid_unknowns
from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.settings import BeamTheory
from drillpetsc.errors import SolveError
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.model.drilling_model import DrillingModel, build_model
from drillpetsc.physics.quaternion.beam import quaternions, turned
from drillpetsc.solvers.chain_lu import ZeroPivot
from drillpetsc.solvers.newton import chain_factor

CONVERGED = 2.0e-9  # increment relative to the fields' scales
ITERATIONS = 40


def quaternion_equilibrium(
    model: DrillingModel, motion: tuple[float, float] | None, climb: bool
) -> StaticState:
    """The ANCF equilibrium of the same case, then Newton's method on the quaternion's own rows
    from there."""
    twin = build_model(model.case.model_copy(update={"beam": BeamTheory()}), model.system.comm)
    state = director_equilibrium(twin, motion, climb)
    place_along_hole(model)
    take_over(twin.system, model.system)
    # statics may have moved the top aside, to where the string lies
    if model.top is not None and twin.top is not None:
        model.top.copy_position(twin.top)
    if model.contact is not None and twin.contact is not None:
        model.contact.copy_sliding_direction(twin.contact)
    if model.bit is not None and twin.bit is not None:
        model.bit.copy_sliding_direction(twin.bit)
    for component in model.system.components:  # size and direction of the hole where the string is now
        component.locate_hole(model.system.assembly)
    asm = model.system.assembly
    asm.freeze(
        fluid_unknowns(model.system)
    )  # the mud is as about the twin, and flows as about a string that moves as the top has it
    try:
        state.equilibrium.iterations += settle(
            model.system, velocity=_lowered(model) if motion is None else None
        )
    finally:
        asm.freeze(None)
    return state


def _lowered(model: DrillingModel) -> FloatArray | None:
    """(nv, 3) velocity [m/s] of the local nodes with which the top lowers the string at time 0, where there
    is mud to feel it."""
    lowering = prescribed_motion(model)[0]
    if model.fluid is None or not lowering:
        return None
    tangent = model.tangent if model.well is None else np.asarray(model.well.at(model.mesh.node_depth)[1])
    return lowering * tangent[model.system.chain.vertices]


def take_over(ancf: DiscreteSystem, system: DiscreteSystem) -> None:
    """The state of an ANCF string on the same nodes, slopes below a junction left aside; and its dead
    forces."""
    nodes, v, phi = ancf.chain.vertices, ancf.field("string.tangent"), ancf.field("string.spin")[:, 0]
    length = np.linalg.norm(v, axis=1)
    t, a = v / length[:, None], ancf.frames.reference[nodes]
    small = np.column_stack(
        [1.0 + np.sum(a * t, axis=1), np.cross(a, t)]
    )  # the smallest rotation from a to t
    small /= np.linalg.norm(small, axis=1, keepdims=True)
    w, u = small[:, :1], small[:, 1:]
    f = turned(quaternions(ancf.frames)[nodes], phi)
    q = np.column_stack(
        [
            w[:, 0] * f[:, 0] - np.sum(u * f[:, 1:], axis=1),
            w * f[:, 1:] + f[:, :1] * u + np.cross(u, f[:, 1:]),
        ]
    )
    for name, values in (
        ("position", ancf.field("string.position")),
        ("strain", length[:, None] - 1.0),
        ("quaternion", q),
    ):
        system.assembly.x[system.layout.dofs[f"string.{name}"]] = values
    for own in system.layout.fields:  # mud, hole, bit
        if not own.name.startswith("string."):
            here, there = system.layout.dofs[own.name], ancf.layout.dofs[own.name]
            system.assembly.x[here[here >= 0]] = ancf.assembly.x[there[there >= 0]]
    if ancf.assembly.dead_load is not None:
        dead, name = np.zeros(system.layout.size), "string.position"
        dead[system.layout.dofs[name]] = ancf.assembly.dead_load[ancf.layout.dofs[name]]
        system.assembly.dead_load = dead


def settle(system: DiscreteSystem, t: float = 0.0, velocity: FloatArray | None = None) -> int:
    """Newton's method on the rows at rest from the assembly's x, inputs as at ``t`` [s]; returns the
    iterations.  Raises SolveError.

    velocity: (nv, 3) of the local nodes [m/s], for the drag of mud; none by default.
    """
    for component in system.components:
        component.constrain_positions(True)
    try:
        return _newton(system, t, velocity)
    finally:
        for component in system.components:
            component.constrain_positions(False)


def _newton(system: DiscreteSystem, t: float, velocity: FloatArray | None) -> int:
    asm, factor, q = system.assembly, chain_factor(system), system.new_condensed()
    rows, owned = system.new_condensed(), system.layout.local_of_owned
    step, before, mpi = np.zeros(len(owned)), np.inf, system.comm.tompi4py()
    for iteration in range(1, ITERATIONS + 1):
        asm.y[:], asm.a[:] = 0.0, 0.0
        if velocity is not None:
            asm.y[system.layout.dofs["string.position"]] = velocity
        system.sum_residual(t, rows)
        asm.jacobian(t, (1.0, 0.0, 0.0), condensed=False)
        try:
            factor.factor(asm.values)
        except ZeroPivot:
            raise SolveError(
                "the static tangent is singular",
                hint="is the string held anywhere?",
                **system.locate_largest_residual(t),
            ) from None
        factor.solve_owned(rows.getArray(readonly=1), step)
        system.store_unknowns(q)
        q.getArray()[:] -= step
        system.load_unknowns(q)
        size = max(mpi.allgather(float(np.max(np.abs(step) / system.scale[owned], initial=0.0))))
        if size < CONVERGED or (size < 1e-5 and size > 0.5 * before):  # rounding stops it
            system.sum_residual(t, rows)
            return iteration
        before = size
    raise SolveError(
        f"statics did not converge in {ITERATIONS} iterations (last increment {before:.1e} of the fields' scales)",
        **system.locate_largest_residual(t),
    )
