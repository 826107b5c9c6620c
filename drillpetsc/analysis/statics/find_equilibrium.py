"""The static equilibrium of a model: which search answers, by what the string has."""

from __future__ import annotations

from drillpetsc.analysis.statics.equilibrium import StaticState, director_equilibrium
from drillpetsc.analysis.statics.motor_statics import motor_equilibrium
from drillpetsc.analysis.statics.path.path_answer import PathKind
from drillpetsc.analysis.statics.path.path_question import nothing_holds
from drillpetsc.analysis.statics.placement import align_top, end_is_held, place_along_hole, take_unknowns
from drillpetsc.analysis.statics.quaternion_statics import quaternion_equilibrium
from drillpetsc.analysis.statics.start.soft_string_start import soft_string
from drillpetsc.doubts import doubts_at
from drillpetsc.doubts.moments import Freed
from drillpetsc.errors import SolveError
from drillpetsc.model.drilling_model import DrillingModel, build_model
from drillpetsc.model.string_forces import held_at_weight
from drillpetsc.physics.tools.mud_motor import MudMotor
from drillpetsc.unit_systems import shown


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
    if model.beam.needs_ancf_equilibrium:
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
        _name_pull(model, error)
        raise


def _name_pull(model: DrillingModel, error: SolveError) -> None:
    """Say in ``error`` that the force of the top is not the weight of a string that nothing else holds along its hole."""
    force, units = model.case.top.force, model.case.shown_units
    hanging = None if force is None or end_is_held(model) else soft_string(model, (0.0, 0.0))
    if force is None or hanging is None:
        return
    pull, weight = force.value(0.0), hanging.hook_load
    if model.bit is None:
        holds, cure = (
            "nothing holds it below",
            "a clamped top, or kind: top_drive without force, carries what it weighs",
        )
    elif pull > weight:
        holds, cure = (
            "the bit is lifted off the bottom",
            "a smaller top.force stands it on its bit; without top.force the top carries what it weighs",
        )
    else:
        return
    pulled, weighs = (shown(q, "force", units) for q in (pull, weight))
    error.what = (
        f"the top pulls with {pulled}, and the string weighs {weighs} along its hole: {holds} ({error.what})"
    )
    error.hint = f"{cure}; initial: {{from: rest}} with time: {{..}} lets it move"


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
    take_unknowns(model, held)
    model.copy_sliding_direction(held)
    align_top(model)
    force, hook_load = model.case.top.force, -held.system.reaction("top.axial_reaction")
    assert force is not None
    state.warnings += doubts_at(Freed(model=model, force=force.value(0.0), hook_load=hook_load))
    return state
