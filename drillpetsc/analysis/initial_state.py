"""The state that a run starts from: a checkpoint, another run, the static equilibrium, or the string at rest."""

from __future__ import annotations

from pathlib import Path

from drillpetsc.analysis import checkpoint
from drillpetsc.analysis.equilibrium import StaticState, director_equilibrium
from drillpetsc.analysis.freed_weight import weight_warnings
from drillpetsc.analysis.imperfection import add_imperfection_of_rest
from drillpetsc.analysis.motor_statics import motor_equilibrium
from drillpetsc.analysis.path_answer import PathKind
from drillpetsc.analysis.path_question import nothing_holds
from drillpetsc.analysis.placement import align_top, find_reactions, move_rigidly, place_along_hole, release
from drillpetsc.analysis.quasi_static import QuasiStatic
from drillpetsc.analysis.quaternion_statics import quaternion_equilibrium
from drillpetsc.case.case import Case
from drillpetsc.errors import SolveError
from drillpetsc.model.drilling_model import DrillingModel, build_model
from drillpetsc.model.string_forces import held_at_weight
from drillpetsc.parallel import total
from drillpetsc.physics.tools.mud_motor import MudMotor
from drillpetsc.unit_systems import shown

TOLERATED_JUMP = 0.01  # of the hook load, at the start of a run with a top force and a given weight on bit


def find_equilibrium(
    model: DrillingModel,
    motion: tuple[float, float] | None = None,
    lateral_friction: bool = True,
    path: PathKind | None = None,
) -> StaticState:
    """Find the static equilibrium with friction against ``motion``; the state is left in the model's system.

    motion: axial velocity [m/s, down positive] and rotation [rad/s]; by default what the top prescribes at
    time 0.
    lateral_friction: the lateral friction force pushes a turning pipe up the wall; without it only its torque
    acts, as in torque-and-drag models.
    path: the motion whose history the string follows, see ``director_equilibrium``.
    Raises SolveError if no equilibrium is found.
    """
    if model.beam is not None and model.beam.needs_ancf_equilibrium:
        return quaternion_equilibrium(model, motion, lateral_friction)
    # the weight on bit sets the static state, although the force of the top acts from time 0 on
    if model.case.top.force is not None and model.case.initial.wob is not None:
        return _equilibrium_at_weight(model, motion, lateral_friction, path)
    motor = model.part(MudMotor)
    if motor is not None:
        return motor_equilibrium(model, motor, motion, lateral_friction, path)
    try:
        return director_equilibrium(model, motion, lateral_friction, path)
    except SolveError as error:
        if nothing_holds(model):
            error.what = (
                f"the string is not held along the hole: it falls, or only friction holds it ({error.what})"
            )
            error.hint = "initial: {from: rest} with time: {..} lets it fall; another kind of top, or a bottom, holds it"
        raise


def _equilibrium_at_weight(
    model: DrillingModel,
    motion: tuple[float, float] | None,
    lateral_friction: bool,
    path: PathKind | None,
) -> StaticState:
    """Hold the top of a model with a top force at the depth where the bit carries ``initial.wob``; the force acts from time 0 on.

    Parameters and errors are the same as in ``find_equilibrium``.  Collective.
    """
    held = build_model(held_at_weight(model.case), model.system.comm)
    state = director_equilibrium(held, motion, lateral_friction, path)
    place_along_hole(model)
    system, other = model.system, held.system
    system.frames.reference[:], system.frames.second_director[:] = (
        other.frames.reference,
        other.frames.second_director,
    )
    system.frames.twist0[:] = other.frames.twist0
    system.assembly.reference[:] = other.assembly.reference
    system.assembly.x[:] = other.assembly.x
    system.assembly.dead_load = other.assembly.dead_load
    for component in system.components:
        component.update_reference_frames()
        component.locate_hole(system.assembly)
    model.copy_sliding_direction(held)
    align_top(model)
    force, hook_load = model.case.top.force, -other.reaction("top.axial_reaction")
    assert force is not None
    if abs(force.value(0.0) - hook_load) > TOLERATED_JUMP * abs(hook_load):
        units = model.case.shown_units
        state.warnings.append(
            f"the top pulls with {shown(force.value(0.0), 'force', units)} from time 0 on, and with initial.wob the string "
            f"hangs on {shown(hook_load, 'force', units)}: it starts to move"
        )
    return state


def initial_state(
    model: DrillingModel, case: Case, saved: checkpoint.Checkpoint | None, quasi: QuasiStatic | None
) -> StaticState | None:
    """Set the model to its state at the start; returns the static state if one was computed; collective.

    saved: checkpoint of a run to continue, None for a new run.
    quasi: quasi-static motion of the model, None with inertia.
    Raises CaseError if a checkpoint does not fit, SolveError if no equilibrium is found.
    """
    if saved is not None:
        checkpoint.restore(model, saved)
        if quasi is not None:
            quasi.start(saved.time, saved.notes.get("share", 1.0))
        return None
    state = None
    if case.initial.from_ == "statics":
        state = find_equilibrium(model)
        state.warnings += weight_warnings(model)
        if state.path is not None:  # friction follows the motion from now on
            model.system.assembly.dead_load = state.path.persistent_load
    elif case.initial.from_ in ("rest", "straight"):
        place_along_hole(model)
        add_imperfection_of_rest(model)
    else:
        other = checkpoint.read(Path(case.initial.from_) / "checkpoint.h5")
        checkpoint.restore(model, other, at="initial.from")
        checkpoint.restart_clock(model, other)
        # the case may have parts with a state that the other run does not have
        begin_new_states(model, 0.0)
        if quasi is None:
            release(model)
            find_reactions(model)  # at time 0, from which histories count
            for component in model.components:
                component.settle(0.0, model.system.assembly)
        else:
            quasi.start()
        return None
    if quasi is not None:
        quasi.start(lateral_fraction=state.lateral_fraction if state is not None else 1.0)
        return state
    # friction now follows the motion, no longer the sliding imposed by statics
    release(model)
    move_rigidly(model)
    for component in model.components:
        component.settle(0.0, model.system.assembly)
    if state is None or case.top.force is not None:
        find_reactions(model)
    return state


def begin_new_states(model: DrillingModel, t: float) -> bool:
    """Begin the states that a restored state at ``t`` [s] lacks; returns whether there were any; collective."""
    system = model.system
    changed = [component.begin_new_states(t, system.assembly) for component in system.components]
    return bool(total(system.comm.tompi4py(), float(any(changed))))
