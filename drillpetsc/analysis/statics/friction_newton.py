"""Static equilibrium with friction: from the lateral equilibrium of a pushed string, else by relaxation from the march.

Manual: sec-statics-sequence, whose table is read from top to bottom.
"""

from __future__ import annotations

from drillpetsc.analysis.statics.imperfection import item_imperfection, nodal_weight
from drillpetsc.analysis.statics.path.paths_of_problem import slides_on
from drillpetsc.analysis.statics.relaxation import FIRST_DRAG, come_to_rest, helix_load, relax
from drillpetsc.analysis.statics.snapshot import Snapshot
from drillpetsc.analysis.statics.start.lateral_start import SPACING, lateral_start
from drillpetsc.analysis.statics.start.soft_string_start import place_marched
from drillpetsc.analysis.statics.static_problem import StaticProblem
from drillpetsc.errors import SolveError
from drillpetsc.output.watches.coarse_mesh import too_coarse

START_INCREMENT = 0.1  # of a state from which a solve with the flow starts
STRONG_LOAD = 0.01  # side loads over the weight if the requested ones do not lead to a stable state
LATERAL_STEPS = 15  # of Newton's method from a lateral equilibrium, which is close to the state
NEAR_STEPS, NEAR_INCREMENT = 6, 10.0  # of its first steps, and the increment that they reach from there
LATERAL_FAILED = 10  # steps of a relaxation from there that may fail


def reach(problem: StaticProblem) -> float:
    """Find an equilibrium with friction; returns the lateral friction fraction reached.

    Raises SolveError if no equilibrium is found.
    """
    reached = _from_lateral_start(problem)
    return _by_relaxation(problem) if reached is None else reached


def _from_lateral_start(problem: StaticProblem) -> float | None:
    """Try to reach a state from the lateral equilibrium of a pushed string; manual: sec-statics-lateral-start.

    Returns the lateral friction fraction reached, or None with the state restored if nothing pushes the string, or no
    stable equilibrium is found.
    """
    model, solver, report, state = problem.model, problem.solver, problem.state.equilibrium, problem.state
    start = lateral_start(model, problem.straight, state.motion, problem.found, solver.limit)
    if start is None:
        return None
    restore = problem.save()
    problem.origin.restore()
    place_marched(model, start.march)
    buckled = start.side_loads is not None
    if start.side_loads is not None:
        solver.add_imperfection(start.side_loads, SPACING)
        report.imperfection = model.case.initial.imperfection
    placed = Snapshot(model)
    first, full = _fractions(problem, problem.turns)
    for near in (True, False):
        problem.impose(first)
        try:
            if near:
                solver.newton(report, NEAR_INCREMENT, NEAR_STEPS)
                solver.newton(report, solver.start_increment, LATERAL_STEPS, near=buckled)
            else:
                come_to_rest(model, solver, report, solver.start_increment, FIRST_DRAG, LATERAL_FAILED)
            problem.set_friction_aside()
            if not solver.negative_pivots():
                # the side force may leave a buckled string without a state; one that lies on the wall climbs it
                return _with_side_force(problem, first, full, climbs=not buckled)
        except SolveError:
            problem.set_friction_aside()
        placed.restore()  # what a failed solve leaves is no start for the next
        # a helix may creep along the wall for ever: it has no state, and a relaxation would not end
        if near and buckled and slides_on(problem):
            return first
    restore()
    return None


def _by_relaxation(problem: StaticProblem) -> float:
    """Relax the string from the march; returns the lateral friction fraction reached.

    A state that is unstable is a saddle, on which no force is lateral: the string then relaxes again under small random side
    loads, which are taken away at the end.  On a coarse mesh the instability is that of the elements.  Raises SolveError if no
    equilibrium is found.
    """
    model, solver, report = problem.model, problem.solver, problem.state.equilibrium
    fraction, found, saddle = model.case.initial.imperfection, problem.found, None
    load = helix = 0.0
    if found is not None:
        problem.origin.restore()
        place_marched(model, found)
        load, helix = found.usual_contact_force, helix_load(model, found)
    start, failure = Snapshot(model), SolveError("no static state was found")
    first, full = _fractions(problem, bool(problem.state.motion[1]))
    strengths = (0.0,) if not fraction or too_coarse(model) else (0.0, fraction, max(fraction, STRONG_LOAD))
    for strength in strengths:
        try:
            if strength:
                start.restore()
                size = strength * nodal_weight(model) * item_imperfection(model, fraction)
                solver.add_imperfection(size, SPACING)
                report.imperfection = strength
                # without friction the loads have an energy, down which a column leans further than any Newton step from straight
                relax(model, solver, report, solver.start_increment, helix, downhill=True)
                load = 0.0  # it has found its wall
            problem.impose(first)
            try:
                relax(model, solver, report, solver.start_increment, load)
            finally:
                problem.set_friction_aside()
            reached = _with_side_force(problem, first, full)
        except SolveError as error:
            failure = error
            continue
        if not solver.negative_pivots() or len(strengths) == 1:
            problem.leaves_loads = bool(strength)
            return reached
        # an unstable state is better than none: the first, without side loads, is symmetric and can be repeated
        saddle = saddle or (problem.save(), reached)
    model.system.assembly.dead_load, report.imperfection = None, 0.0
    if saddle is None:
        raise failure
    saddle[0]()  # it says so
    solver.limit.begin_again()
    return saddle[1]


def _fractions(problem: StaticProblem, turns: bool) -> tuple[float, float]:
    """Lateral friction fractions with which a search begins and ends: a string that turns climbs the wall at the end."""
    return (0.0, problem.fraction) if turns else (1.0, 1.0)


def _with_side_force(problem: StaticProblem, first: float, full: float, climbs: bool = False) -> float:
    """Add the side force of friction between the fractions ``first``, of the present state, and ``full``; returns the one reached.

    climbs: relax if Newton's method fails.
    """
    model, solver, report = problem.model, problem.solver, problem.state.equilibrium
    solver.limit.begin_again()  # there is a state: the limit of the search is none of its side force and flow
    if full == first:
        return full if problem.moves else problem.fraction
    restore = problem.save()
    problem.impose(full)
    try:
        if climbs:
            come_to_rest(model, solver, report, solver.start_increment, most_failed=LATERAL_FAILED)
        else:
            solver.newton(report, solver.start_increment)
        return full
    except SolveError:
        restore()
        solver.limit.begin_again()
        return first
    finally:
        problem.set_friction_aside()
