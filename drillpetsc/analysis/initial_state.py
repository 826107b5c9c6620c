"""The state that a run starts from: a checkpoint, another run, the static equilibrium, or the string at rest."""

from __future__ import annotations

from pathlib import Path

from drillpetsc.analysis import checkpoint
from drillpetsc.analysis.equilibrium import StaticState, director_equilibrium
from drillpetsc.analysis.imperfection import add_imperfection_of_rest
from drillpetsc.analysis.motor_statics import motor_equilibrium
from drillpetsc.analysis.path_answer import PathKind
from drillpetsc.analysis.placement import find_reactions, move_rigidly, place_along_hole, release
from drillpetsc.analysis.quasi_static import QuasiStatic
from drillpetsc.analysis.quaternion_statics import quaternion_equilibrium
from drillpetsc.case.case import Case
from drillpetsc.model.drilling_model import DrillingModel


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
    path: the question that is answered by following the string's history, see ``director_equilibrium``.
    Raises SolveError where no equilibrium is found.
    """
    if model.beam is not None and model.beam.needs_ancf_equilibrium:
        return quaternion_equilibrium(model, motion, lateral_friction)
    if model.motor is not None:
        return motor_equilibrium(model, model.motor, motion, lateral_friction, path)
    return director_equilibrium(model, motion, lateral_friction, path)


def initial_state(
    model: DrillingModel, case: Case, saved: checkpoint.Checkpoint | None, quasi: QuasiStatic | None
) -> StaticState | None:
    """Set the model to its state at the start; returns the static state where one was computed; collective.

    saved: checkpoint of a run to continue, None for a new run.
    quasi: quasi-static motion of the model, None with inertia.
    Raises CaseError where a checkpoint does not fit, SolveError where no equilibrium is found.
    """
    if saved is not None:
        checkpoint.restore(model, saved)
        if quasi is not None:
            quasi.start(saved.time, saved.notes.get("share", 1.0))
        return None
    state = None
    if case.initial.from_ == "statics":
        state = find_equilibrium(model)
        if state.path is not None:  # friction follows the motion from now on
            model.system.assembly.dead_load = state.path.persistent_load
    elif case.initial.from_ in ("rest", "straight"):
        place_along_hole(model)
        add_imperfection_of_rest(model)
    else:
        other = checkpoint.read(Path(case.initial.from_) / "checkpoint.h5")
        checkpoint.restore(model, other, at="initial.from")
        checkpoint.restart_clock(model, other)
        if quasi is None:
            release(model)
            find_reactions(model)
        else:
            quasi.start()
        return None
    if quasi is not None:
        quasi.start(lateral_fraction=state.lateral_fraction if state is not None else 1.0)
        return state
    release(model)
    move_rigidly(model)
    if state is None:
        find_reactions(model)
    return state
