"""Static equilibrium of the ANCF string with friction against a given motion, coupled with the steady flow.

Manual: sec-statics-sequence, eq-statics-rest, eq-statics-imposed-friction.
"""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.statics.checks.folded_elements import refuse_fallen, refuse_folded
from drillpetsc.analysis.statics.flow_coupling import couple_flow_and_string, settle_contents, surge_rates
from drillpetsc.analysis.statics.friction_newton import LATERAL_FAILED, START_INCREMENT, reach
from drillpetsc.analysis.statics.path.path_answer import PathKind
from drillpetsc.analysis.statics.path.path_question import has_path, refuse_path
from drillpetsc.analysis.statics.path.paths_of_problem import answer_by_path, node_clearance, steps_in_hole
from drillpetsc.analysis.statics.placement import is_slanted, place_along_hole, prescribed_motion, top_depth
from drillpetsc.analysis.statics.relaxation import FIRST_DRAG, come_to_rest
from drillpetsc.analysis.statics.snapshot import Snapshot
from drillpetsc.analysis.statics.start.march import CRUSHING_STRAIN, March, Marcher
from drillpetsc.analysis.statics.start.soft_string_start import soft_string
from drillpetsc.analysis.statics.static_problem import StaticProblem, StaticState
from drillpetsc.analysis.statics.steady_flow import fluid_unknowns, freeze_flow, steady_flow
from drillpetsc.analysis.statics.top_on_wall import balance_across
from drillpetsc.case.quantities import largest, said
from drillpetsc.doubts import doubts_at
from drillpetsc.doubts.moments import Solved
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output.watches.free_end import FreeEnd, end_is_free
from drillpetsc.output.watches.outside_hole import HINT, may_leave_hole
from drillpetsc.parallel import total
from drillpetsc.physics.tools.mud_motor import MudMotor
from drillpetsc.solvers.static.search_limit import SearchEnded, SearchLimit
from drillpetsc.solvers.static.static_newton import CONVERGED_INCREMENT, Equilibrium, StaticNewton
from drillpetsc.unit_systems import display, display_unit, shown

FIRST_FLOW_INCREMENT = 1e-2  # of the flow from which flow and string are solved together
#: axial direction (down positive) and rotation of each motion of the `statics` command
MOTIONS = {"hoist": (-1.0, 0.0), "lower": (1.0, 0.0), "rotate": (0.0, 1.0)}
#: shares in which side loads are taken away: at once, else in steps, because under the flow of the loaded string the string without its
#: loads may be straight
SIDE_LOADS_LEFT = (0.0,), (0.3, 0.1, 0.03, 0.01, 3e-3, 1e-3, 0.0)


def director_equilibrium(
    model: DrillingModel,
    motion: tuple[float, float] | None = None,
    lateral_friction: bool = True,
    path: PathKind | None = None,
) -> StaticState:
    """Find the static equilibrium with friction against ``motion``; collective.

    Manual: sec-statics-sequence.

    motion: axial velocity [m/s, down positive] and rotation [rad/s]; by default what the top prescribes at
    time 0.
    lateral_friction: friction across the pipe pushes a turning pipe up the wall; without it only its torque
    acts, as in torque-and-drag models.
    path: the question that is answered by following the string's history; None: Newton's method answers, and a
    path of steady sliding where it finds no state of a string that coils and has no downhole motor.

    Raises SolveError if no equilibrium is found, CaseError if the weight on bit cannot be met.
    """
    lowering = prescribed_motion(model)[0] if motion is None else 0.0
    motion = prescribed_motion(model) if motion is None else motion
    place_along_hole(model, top_depth(model))
    if not model.beam.moves:
        flow = steady_flow(model.system)
        return StaticState(
            (0.0, 0.0), Equilibrium(iterations=flow.iterations, increment=flow.increment, converged=True)
        )
    problem = _posed(model, motion, lowering, lateral_friction, path)
    solver, found = problem.solver, problem.found
    state, report = problem.state, problem.state.equilibrium
    problem.set_friction_aside()
    if path is not None:
        answer_by_path(problem, path)
    else:
        try:
            _newton_with_flow(problem)
        except SolveError as error:
            fallen = HINT if is_slanted(model) and may_leave_hole(model) else ""
            error.hint = fallen or _free_end_hint(model, found) or error.hint
            raise
    placed, no_lateral_friction = True, False
    if state.path is None:
        lies = found is not None and found.top_on_wall and model.top.prescribes
        state.top_lies = lies and balance_across(model, solver, report)
        placed = state.top_lies or not lies
        problem.set_friction_aside()  # stability is counted without it
        count = solver.negative_pivots()
        no_lateral_friction = lateral_friction and problem.moves and not state.lateral_fraction
        report.negative_pivots, report.singular = max(0, count), count < 0
        problem.impose(state.lateral_fraction)
    refuse_folded(model)
    refuse_fallen(model)
    settle_contents(model, solver, report)
    solver.rows()  # the reactions of the final state
    model.system.assembly.freeze(None)
    state.warnings += doubts_at(
        Solved(
            model=model,
            top_unplaced=not placed,
            lateral_friction_failed=no_lateral_friction,
            below_hole=float(total(model.system.comm, FreeEnd(model).below_bottom())),
            negative_pivots=report.negative_pivots if state.path is None else 0,
            singular=report.singular,
        )
    )
    return state


def _posed(
    model: DrillingModel,
    motion: tuple[float, float],
    lowering: float,
    lateral_friction: bool,
    path: PathKind | None,
) -> StaticProblem:
    """Pose the problem of ``director_equilibrium``: the string at its march, or along the hole for a path; collective.

    lowering: speed at which the top lowers the string [m/s].  Raises SolveError if the string is locked up.
    """
    if path is not None:
        refuse_path(model, motion, path)
    surge = surge_rates(model, lowering)
    if surge is not None:
        model.system.assembly.y[:] = surge
    freeze_flow(model, tolerance=FIRST_FLOW_INCREMENT)
    soft = soft_string(model, motion)
    found = straight = band = None
    if model.contact is not None:
        marcher = Marcher(model, motion, surge)
        found, band = marcher.march(), marcher.band()
        if found.locked is not None and path != "slack_off":
            raise _lock_up(model, found.locked)
        straight = marcher.march(coils=False) if found.helical.any() else found
    solver = StaticNewton(
        model.system, node_clearance(model), advance=steps_in_hole(model), symmetric=model.conservative
    )
    solver.rates = surge
    if path is None:  # a user who asks for a path waits for it
        solver.limit = SearchLimit(model.mesh.nodes)
    if model.case.initial.wob is not None:
        set_weight_on_bit(model, solver, model.case.initial.wob)
    return StaticProblem(
        model,
        solver,
        StaticState(motion, Equilibrium(), soft, band=band),
        1.0 if lateral_friction else 0.0,
        lowering,
        found,
        straight,
        Snapshot(model),
    )


def _newton_with_flow(problem: StaticProblem) -> None:
    """Find the state of string and flow; errors as of ``_answer_by_newton``.

    A rough state of the string suffices to solve for both.  Where it does not, an exact one comes first.
    """
    model, solver, state = problem.model, problem.solver, problem.state
    restore, asm = problem.save(), model.system.assembly
    for increment in (
        (START_INCREMENT, CONVERGED_INCREMENT) if model.fluid is not None else (CONVERGED_INCREMENT,)
    ):
        solver.start_increment = increment
        _answer_by_newton(problem)
        if state.path is not None:  # it ends with the flow about its last state
            return
        problem.impose(state.lateral_fraction)
        try:
            couple_flow_and_string(model, solver, state.equilibrium, problem.lowering)
            _without_side_loads(problem)
            # a rough state may lie before the weight that makes the string buckle, which the flow's solve then adds
            if increment == CONVERGED_INCREMENT or problem.moves or solver.negative_pivots() <= 0:
                return
        except SolveError:
            if increment == CONVERGED_INCREMENT:
                raise
        restore()
        asm.freeze(fluid_unknowns(model.system))


def _without_side_loads(problem: StaticProblem) -> None:
    """Take away the side loads that found the state of string and flow, if it is stable without them; they stay otherwise."""
    model, solver, report = problem.model, problem.solver, problem.state.equilibrium
    asm, restore, fraction = model.system.assembly, problem.save(), problem.state.lateral_fraction
    load = asm.dead_load
    if load is None or not problem.leaves_loads:
        return
    for shares in SIDE_LOADS_LEFT:
        report.imperfection = 0.0
        try:
            for share in shares:
                asm.dead_load = share * load if share else None
                problem.impose(fraction)
                if model.fluid is None:
                    come_to_rest(model, solver, report, solver.start_increment, FIRST_DRAG, LATERAL_FAILED)
                else:
                    couple_flow_and_string(model, solver, report, problem.lowering)
            problem.set_friction_aside()
            stable = not solver.negative_pivots()
        except SolveError:
            stable = False
        if stable:
            break
        restore()
        solver.limit.begin_again()
    problem.impose(fraction)


def _answer_by_newton(problem: StaticProblem) -> None:
    """Find the state by Newton's method and the relaxation, else by a path.

    Raises SolveError if no equilibrium is found.
    """
    model, state, found = problem.model, problem.state, problem.found
    try:
        reach(problem)
    except SolveError as error:
        ended = isinstance(error, SearchEnded)
        if found is not None and found.helical.any():
            hint = _helix_hint(model, found, problem.moves)
            error.hint = f"{hint}; {error.hint}" if ended else hint
            if not ended:
                error.what = f"no static state was found of a string that coils in its hole ({error.what})"
        if ended or model.parts(MudMotor) or not any(state.motion) or not has_path(model, state.motion):
            raise
        problem.origin.restore()
        answer_by_path(problem, "sliding")


def _free_end_hint(model: DrillingModel, found: March | None) -> str:
    """What to do about a string without a static state whose free end reaches the end of the hole by the march; else empty."""
    if found is None or model.well is None or not end_is_free(model):
        return ""
    mesh, most = model.mesh, float(model.well.depth)
    if float(found.measured_depth[-1]) + mesh.total_length - float(mesh.node_depth[-1]) < most:
        return ""
    return (
        f"the free end of the string reaches the end of the hole, MD {shown(most, 'length', model.case.shown_units, 6)}, where nothing holds "
        "it and no mud flows past: a shorter string, or a deeper hole; bottom: {kind: bit} stands on it"
    )


def _helix_hint(model: DrillingModel, found: March, moves: bool) -> str:
    """What to do about a string without a static state that coils by the march."""
    depth = model.mesh.node_depth[found.helical] + top_depth(model)
    largest = -float(found.axial_force.min())
    pitch = 2 * np.pi * np.sqrt(2 * float(model.mesh.bending_stiffness[~model.mesh.is_joint].min()) / largest)
    scale, _, unit = display_unit("length", model.case.shown_units)
    push, force = display(largest, "force", model.case.shown_units)
    hint = (
        f"by the march the string coils from MD {depth[0] / scale:.0f} to {depth[-1] / scale:.0f} {unit} under a push of "
        f"{push:.3g} {force}, up to {found.coiling.max():.2g} times the push at which it coils; elements of {pitch / 4 / scale:.2g} {unit} or less show it"
    )
    if moves:
        hint += "; with friction a coiled string has many states: `run` finds the one of a given motion"
    return hint


def _lock_up(model: DrillingModel, node: int) -> SolveError | CaseError:
    """The error that no push reaches the bit: what friction takes grows faster than the push."""
    mesh, case = model.mesh, model.case
    most, wob = CRUSHING_STRAIN * float(mesh.axial_stiffness[~mesh.is_joint][-1]), case.initial.wob
    if wob is not None and wob > most:
        return CaseError(
            at="initial.wob",
            got=shown(wob, "force", model.case.shown_units, 6),
            want=f"less than {shown(most, 'force', model.case.shown_units, 3)}, which compresses the pipe above the bit by 1 %",
        )
    item = case.string[int(mesh.item[max(node - 1, 0)])]
    what = "no weight" if case.initial.wob else "no push"
    flows = case.fluid is not None and largest(case.fluid.flow_rate) > 0
    scale, _, unit = display_unit("length", model.case.shown_units)
    return SolveError(
        f"locked up: {what} passes MD {(mesh.node_depth[node] + top_depth(model)) / scale:.0f} {unit} ({item.name or item.kind}); "
        "below it the string coils in the hole, and friction takes any further push",
        hint="a stiffer or lighter string below that depth, less friction, rotation, or less weight"
        + ("; less flow or a wider annulus, whose pressure lifts the string (hydraulics)" if flows else ""),
    )


def set_weight_on_bit(model: DrillingModel, solver: StaticNewton, wob: float) -> None:
    """Make the top's axial position an unknown that meets the weight ``wob`` [N] (manual: eq-statics-wob)."""
    bit, top = model.bit, model.top
    if bit is None:
        raise CaseError(
            at="initial.wob",
            got=said(wob, "force", model.case.said_units),
            want="a bottom of kind bit, which carries the weight",
        )
    if not top.prescribes or model.case.top.force is not None:
        raise CaseError(
            at="initial.wob",
            got=said(wob, "force", model.case.said_units),
            want="a top with a prescribed axial position (top_drive, driven, clamped, pinned)",
        )
    target = bit.depth_for(wob)

    def depth(system):
        present, gradient = bit.depth_of_face(system.assembly)
        return present, gradient, target

    solver.depth, solver.move_top = depth, top.shift
