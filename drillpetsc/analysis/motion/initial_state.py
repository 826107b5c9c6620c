"""The state that a run starts from: a checkpoint, another run, the static equilibrium, or the string at rest."""

from __future__ import annotations

from pathlib import Path

from drillpetsc.analysis.motion import checkpoint
from drillpetsc.analysis.motion.quasi_static import QuasiStatic
from drillpetsc.analysis.statics.equilibrium import StaticState
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.analysis.statics.imperfection import add_imperfection_of_rest
from drillpetsc.analysis.statics.placement import find_reactions, move_rigidly, place_along_hole, release
from drillpetsc.case.case import Case
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.parallel import total


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
        if state.path is not None:  # friction follows the motion from now on
            model.system.assembly.dead_load = state.path.persistent_load
    elif case.initial.from_ in ("rest", "straight"):
        place_along_hole(model)
        add_imperfection_of_rest(model)
    else:
        other = checkpoint.read(Path(case.initial.from_) / "checkpoint.h5")
        checkpoint.restore(model, other, at="initial.from")
        # time begins at 0 with the state of the other run: the top goes on from its position and angle there
        model.top.align(*model.beam.first_node(other.fields))
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
