"""The string with the paper's element: rooms of a case, its place at the start and its static equilibrium."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from drillpetsc.analysis.steady_flow import fluid_unknowns
from drillpetsc.case.blocks.ends import HeldBottom, HeldTop
from drillpetsc.case.blocks.ends import TopDrive as TopDriveCase
from drillpetsc.case.blocks.settings import BeamTheory
from drillpetsc.errors import SolveError
from drillpetsc.fem.component import FloatArray
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.frames import Frames
from drillpetsc.physics.contact import Contact
from drillpetsc.physics.end_conditions import NodeLoad
from drillpetsc.physics.quaternion.beam import QuaternionBeam, quaternions, spun, turned
from drillpetsc.physics.quaternion.contact import QuaternionContact
from drillpetsc.physics.quaternion.ends import ConstrainedEnd, QuaternionLoads
from drillpetsc.solvers.chain_lu import ZeroPivot
from drillpetsc.solvers.newton import chain_factor

if TYPE_CHECKING:
    from drillpetsc.analysis.equilibrium import StaticState
    from drillpetsc.case.case import Case
    from drillpetsc.model.drilling_model import DrillingModel

CONVERGED = 2.0e-9  # increment relative to the fields' scales
ITERATIONS = 40


# ---------------------------------------------------------------------- rooms
def quaternion_components(
    case: Case,
    mesh: StringMesh,
    frames: Frames,
    position: FloatArray,
    tangent: FloatArray,
    loads: Sequence[NodeLoad],
    breaks: tuple[float, ...],
    contact: Contact | None,
) -> tuple[QuaternionBeam, ConstrainedEnd | None, list]:
    """Beam, what holds the top (None: nothing), and all rooms of the string."""
    finest = contact.impact_depth if contact is not None else np.inf
    beam = QuaternionBeam(
        mesh, frames, np.array(case.gravity, dtype=float), case.beam.constraint or "index3", finest
    )
    top, bottom = _top(case, beam, position[0], tangent[0]), _bottom(case, beam, position[-1], tangent[-1])
    components = [beam, *(r for r in (top, bottom) if r is not None)]
    if loads:
        components.append(QuaternionLoads(tuple(loads), breaks))
    if contact is not None:
        components.append(contact)
    return beam, top, components


def _guided(
    beam: QuaternionBeam,
    vertex: int,
    places: int,
    turns: int,
    position: FloatArray,
    tangent: FloatArray,
    *inputs,
) -> ConstrainedEnd:
    return ConstrainedEnd(
        vertex,
        beam.mesh.nodes,
        places,
        turns,
        position,
        beam.start[vertex],
        tangent,
        beam.constraint,
        *inputs,
    )


def _top(
    case: Case, beam: QuaternionBeam, position: FloatArray, tangent: FloatArray
) -> ConstrainedEnd | None:
    top = case.top
    if isinstance(top, TopDriveCase):
        lowering = None if top.force is not None else top.lowering
        return _guided(beam, 0, 2 if lowering is None else 3, 3, position, tangent, lowering, top.rotation)
    assert isinstance(top, HeldTop)  # the case refuses the others
    return (
        None
        if top.kind == "free"
        else _guided(beam, 0, 3, 3 if top.kind == "clamped" else 1, position, tangent)
    )


def _bottom(
    case: Case, beam: QuaternionBeam, position: FloatArray, tangent: FloatArray
) -> ConstrainedEnd | None:
    bottom = case.bottom
    if not isinstance(bottom, HeldBottom) or bottom.kind == "free":
        return None
    return _guided(beam, beam.mesh.nodes - 1, 3, 3 if bottom.kind == "clamped" else 0, position, tangent)


# ---------------------------------------------------------------------- start
def place(model: DrillingModel) -> None:
    """The unstrained string along its axis, at rest."""
    m, beam = model.system, model.beam
    m.set_field("string.position", model.position)
    m.set_field("string.strain", np.zeros((m.mesh.nodes, 1)))
    m.set_field("string.quaternion", beam.start)  # type: ignore[union-attr]
    m.assembly.y[:] = 0.0
    m.assembly.a[:] = 0.0


def move(model: DrillingModel, lowering: float, rotation: float) -> None:
    """The rigid motion that the top prescribes at time 0: every node lowered [m/s] and turned about its
    tangent [rad/s]."""
    m = model.system
    q = np.zeros((m.mesh.nodes, 4))
    q[m.chain.vertices] = 0.5 * rotation * spun(m.field("string.quaternion"))
    m.set_field("string.position", lowering * np.asarray(model.tangent), "y")
    m.set_field("string.strain", np.zeros((m.mesh.nodes, 1)), "y")
    m.set_field("string.quaternion", q, "y")


def equilibrium(model: DrillingModel, motion: tuple[float, float] | None, climb: bool) -> StaticState:
    """The gauge element's equilibrium of the same case, then Newton's method on the quaternion's own rows
    from there."""
    from drillpetsc.analysis.equilibrium import find_equilibrium
    from drillpetsc.model.drilling_model import build_model

    twin = build_model(model.case.model_copy(update={"beam": BeamTheory()}), model.system.comm)
    state = find_equilibrium(twin, motion, climb)
    place(model)
    take_over(twin.system, model.system)
    if (
        isinstance(model.top, ConstrainedEnd) and twin.top is not None
    ):  # statics may have set the top aside, to where the string lies
        model.top.anchor[: model.top.places] = twin.top.anchor[: model.top.places]
    if isinstance(model.contact, QuaternionContact) and twin.contact is not None:
        model.contact.copy_sliding_direction(twin.contact)
    if model.bit is not None and twin.bit is not None:
        model.bit.copy_sliding_direction(twin.bit)  # type: ignore[arg-type]
    for component in model.system.components:  # size and direction of the hole where the string is now
        if hasattr(component, "find_hole"):
            component.find_hole(model.system.assembly)
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
    from drillpetsc.analysis.equilibrium import prescribed_motion

    lowering = prescribed_motion(model)[0]
    if model.fluid is None or not lowering:
        return None
    tangent = model.tangent if model.well is None else np.asarray(model.well.at(model.mesh.node_depth)[1])
    return lowering * tangent[model.system.chain.vertices]


def take_over(ancf: DiscreteSystem, system: DiscreteSystem) -> None:
    """The state of a ANCF string on the same nodes, slopes below a junction left aside; and its dead
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
    components = [component for component in system.components if hasattr(component, "hold_positions")]
    for component in components:
        component.hold_positions(True)
    try:
        return _newton(system, t, velocity)
    finally:
        for component in components:
            component.hold_positions(False)


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
