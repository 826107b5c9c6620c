"""Position and motion of the string before the first solve."""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.statics.steady_flow import SteadyFlow, release_flow, set_fluid_at_rest
from drillpetsc.arrays import FloatArray, sums_from_below
from drillpetsc.fem.component import DRIVE, JOINT, Start
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.model.hole import top_of_string
from drillpetsc.parallel import total
from drillpetsc.physics.tools.mud_motor import MudMotor
from drillpetsc.physics.top.hoist import Hoist
from drillpetsc.unit_systems import System, shown

SLANTED = 1e-3  # horizontal part of the direction of a string that is not vertical


def prescribed_motion(model: DrillingModel) -> tuple[float, float]:
    """Return the axial velocity [m/s, down positive] and the rotation [rad/s] that the top prescribes at time 0."""
    top = model.case.top
    lowering = top.lowering if top.force is None else None
    rotation = top.rotation
    return (lowering.value(0.0) if lowering is not None else 0.0), (
        rotation.value(0.0) if rotation is not None else 0.0
    )


def motion_of_top(model: DrillingModel) -> tuple[float, float] | None:
    """Rotation [rad/s] and lowering [m/s] of the top in the present state, None of a held string; collective."""
    system, out = model.system, np.zeros(2)
    if not model.beam.moves:
        return None
    first = np.flatnonzero(system.chain.cells == 0)
    if len(first):
        place, rate, _ = model.beam.nodal_motion(system.assembly, system.chain.ends[first[0]][:1])[:, 0]
        out[:] = rate[6], rate[:3] @ place[3:6] / np.linalg.norm(place[3:6])
    rotation, lowering = total(system.comm, out)
    return float(rotation), float(lowering)


def motion_text(lowering: float, rotation: float, units: System) -> str:
    """`rotation at 60 rpm and lowering at 10 m/h`: the motion [m/s, rad/s] of the top for people, in a system of units."""
    moves = [f"rotation at {shown(rotation, 'rotation', units, 6)}"] if rotation else []
    moves += [f"lowering at {shown(lowering, 'rop', units, 6)}"] if lowering else []
    return " and ".join(moves) or "rest"


def average_over_turn(model: DrillingModel, rotation: float) -> None:
    """Include the bend of a bent item while the top does not turn; leave it out while the top turns (``rotation`` [rad/s])."""
    for component in model.components:
        component.average_over_turn(bool(rotation))


def top_depth(model: DrillingModel) -> float:
    """Measured depth [m] of the top of the unstrained string in statics."""
    return top_of_string(model.case, model.mesh.total_length)


def place_along_hole(model: DrillingModel, top: float = 0.0) -> None:
    """Put the unstrained string on the axis of the hole, on a straight line without a hole; at rest.

    top: measured depth of its upper end [m].
    """
    system = model.system
    for component in model.components:
        component.hold()
    position, tangent = model.position, model.tangent
    if top and model.well is not None:
        position, tangent, _ = (np.asarray(q) for q in model.well.at(model.mesh.node_depth + top))
    model.beam.place(system, position, tangent)
    for field in system.layout.fields:
        if field.physics in (JOINT, DRIVE) or field.name == "string.ratio":
            system.set_field(field.name, np.full((system.mesh.nodes, field.size), field.default))
    system.assembly.y[:] = 0.0
    system.assembly.a[:] = 0.0
    if model.fluid is not None:
        set_fluid_at_rest(system, model.fluid)


def take_unknowns(model: DrillingModel, other: DrillingModel) -> None:
    """Take the state of another model with the same unknowns: reference frames, unknowns and side loads."""
    system, frames, theirs = model.system, model.system.frames, other.system
    frames.reference[:], frames.second_director[:] = theirs.frames.reference, theirs.frames.second_director
    frames.twist0[:] = theirs.frames.twist0
    system.assembly.reference[:] = theirs.assembly.reference
    system.assembly.x[:] = theirs.assembly.x
    system.assembly.dead_load = theirs.assembly.dead_load
    for component in system.components:
        component.update_reference_frames()
        component.locate_hole(system.assembly)


def hole_at_string(model: DrillingModel) -> tuple[FloatArray, FloatArray]:
    """Return the hole's unit tangent and its derivative [1/m] at the present nodes, (n_nodes, 3) each.

    Rows of nodes of other ranks are zero.  Without a hole the tangent is that of the straight string.
    """
    system, well = model.system, model.well
    tangent, curvature = np.array(model.tangent), np.zeros_like(model.tangent)
    if well is not None:
        here = system.chain.vertices
        depth = well.project(system.field("string.position")).md
        tangent, curvature = np.zeros_like(tangent), np.zeros_like(tangent)
        _, tangent[here], curvature[here] = well.at(depth)
    return tangent, curvature


def is_slanted(model: DrillingModel) -> bool:
    """Whether the string leaves the vertical somewhere, so that its weight has a part across it."""
    return float(np.abs(model.tangent[:, :2]).max()) > SLANTED


def end_is_held(model: DrillingModel) -> bool:
    """Whether the place of the string's lower end is held."""
    return model.case.bottom.kind in ("clamped", "pinned")


def share_of_top(model: DrillingModel) -> tuple[FloatArray, FloatArray]:
    """Shares (n_nodes,) of the top's axial velocity and of its rotation that the nodes of a string have that moves steadily; manual:
    eq-statics-share-of-top.

    One where the lower end follows.  A lower end that is held does not: the string is stretched, and wound up, evenly.
    """
    mesh, shares = model.mesh, []
    for stiffness, held in (
        (mesh.axial_stiffness, end_is_held(model)),
        (mesh.torsional_stiffness, model.case.bottom.kind == "clamped"),
    ):
        share = np.ones(mesh.nodes)
        if held:
            element = np.divide(
                mesh.length, stiffness, out=np.zeros_like(mesh.length), where=~mesh.is_joint & (stiffness > 0)
            )
            below = sums_from_below(element)
            share = below / below[0]
        shares.append(share)
    return shares[0], shares[1]


def move_rigidly(model: DrillingModel) -> SteadyFlow:
    """Set the rates of every node to the rotation and the lowering that the top prescribes at time 0, and a motor's.

    Those of a string whose lower end is held fall to zero there.  Returns how the flow about it was found.
    """
    if model.beam.moves:
        tangent, curvature = hole_at_string(model)
        lowering, rotation = prescribed_motion(model)
        along, turn = share_of_top(model)
        spin = rotation * turn
        for motor in model.parts(MudMotor):
            spin[motor.cell + 1 :] += motor.start_speed
        model.beam.set_rigid_motion(model.system, tangent, curvature, lowering * along, spin)
        for component in model.components:
            component.first_cut(model.system.assembly)
    return release_flow(model)


def release(model: DrillingModel, at_rest: bool = False) -> None:
    """Change from statics to motion: friction follows the actual motion from now on.

    at_rest: a controlled drive keeps the string at rest, whatever its set point.
    """
    for component in model.components:
        component.release_sliding_direction()
    start = start_of(model, at_rest)
    for component in model.components:
        component.begin_motion(model.system.assembly, start)


def start_of(model: DrillingModel, at_rest: bool = False) -> Start:
    """What machines need to know of the static state to begin their motion; collective."""
    system = model.system
    hook_load = -system.reaction("top.axial_reaction") if model.parts(Hoist) else 0.0
    return Start(hook_load, lambda values: np.asarray(total(system.comm, values)), at_rest)


def find_reactions(model: DrillingModel) -> None:
    """Compute hook load, torque and the other reactions of the present state at time 0, without accelerations; collective."""
    system, asm = model.system, model.system.assembly
    rows, unknowns = system.new_condensed(), system.new_condensed()
    system.sum_residual(0.0, rows)
    if any(component.has_constraints for component in model.components):
        asm.residual(0.0)
        summed = system.sum_local(asm.r[: system.layout.size].copy())
        for component in model.components:
            component.balance_constraints(asm, summed)
        system.store_unknowns(unknowns)
        system.load_unknowns(unknowns)


def align_top(model: DrillingModel) -> None:
    """Prescribe at time 0 the present place, direction and angle of the top node; collective."""
    model.top.align(*(at_top(model, f"string.{name}") for name in ("position", "tangent", "spin")))
    model.system.assembly.invalidate_prescribed_values()


def at_top(model: DrillingModel, field: str) -> FloatArray:
    """Values (k,) of a nodal field at the top node, the same on all ranks; collective."""
    system = model.system
    here = system.chain.owned & (system.chain.vertices == 0)
    return np.asarray(total(system.comm, system.field(field)[here].sum(axis=0)))
