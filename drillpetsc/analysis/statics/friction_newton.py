"""Static equilibrium with friction: from the lateral equilibrium of a string in its hole, and by relaxation.

Manual: sec-statics-sequence, whose table is read from top to bottom.
"""

from __future__ import annotations

from drillpetsc.analysis.statics.imperfection import side_load_size
from drillpetsc.analysis.statics.path.paths_of_problem import slides_on
from drillpetsc.analysis.statics.relaxation import FIRST_DRAG, come_to_rest, fall
from drillpetsc.analysis.statics.snapshot import Snapshot
from drillpetsc.analysis.statics.start.lateral_start import lateral_start
from drillpetsc.analysis.statics.start.march import place_marched
from drillpetsc.analysis.statics.static_problem import StaticProblem
from drillpetsc.arrays import FloatArray
from drillpetsc.errors import SolveError
from drillpetsc.output.watches.coarse_mesh import too_coarse
from drillpetsc.solvers.static.lateral_loads import lateral_loads

START_INCREMENT = 0.1  # of a state from which a solve with the flow starts
STRONG_LOAD = 0.01  # side loads over the weight if the requested ones do not lead to a stable state
BUCKLED_STEPS = 15  # of Newton's method from a buckled lateral equilibrium, which is close to the state
NEAR_STEPS, NEAR_INCREMENT = 6, 10.0  # of its first steps, and the increment that they reach from there
LATERAL_FAILED = 10  # steps of a relaxation from there that may fail


def reach(problem: StaticProblem) -> None:
    """Find an equilibrium with friction, whose lateral fraction is then the state's.

    A state that is unstable is a saddle, on which no force is lateral: the string then relaxes again under small random side
    loads, which are taken away at the end.  On a coarse mesh the instability is that of the elements.  Raises SolveError if no
    equilibrium is found.
    """
    model, solver, report = problem.model, problem.solver, problem.state.equilibrium
    fraction, saddle, asm = model.case.initial.imperfection, None, model.system.assembly
    problem.origin.restore()
    if problem.found is not None and problem.straight is not None:
        start = lateral_start(problem.straight, problem.found, solver.limit)
        if start is not None and start.side_loads is not None:
            restore = problem.save()
            place_marched(model, start.march)
            if _from_buckled(problem, start.side_loads):
                return
            restore()
            start = None
        place_marched(model, problem.straight if start is None else start.march)
    placed, failure = Snapshot(model), SolveError("no static state was found")
    strengths = (0.0,) if not fraction or too_coarse(model) else (0.0, fraction, max(fraction, STRONG_LOAD))
    for strength in strengths:
        try:
            if strength:
                placed.restore()
                asm.dead_load = lateral_loads(model.system, strength / fraction * side_load_size(model))
                report.imperfection = strength
                # without friction the loads have an energy, down which a column leans further than any Newton step from straight
                fall(model, solver, report, solver.start_increment, problem.found)
            problem.impose(_fractions(problem)[0])
            try:
                come_to_rest(model, solver, report, solver.start_increment)
            finally:
                problem.set_friction_aside()
            _add_side_force(problem, climbs=True)
        except SolveError as error:
            failure = error
            continue
        if not solver.negative_pivots() or len(strengths) == 1:
            problem.leaves_loads = bool(strength)
            return
        # an unstable state is better than none: the first, without side loads, is symmetric and can be repeated
        saddle = saddle or problem.save()
    asm.dead_load, report.imperfection = None, 0.0
    if saddle is None:
        raise failure
    saddle()  # it says so
    solver.limit.begin_again()


def _from_buckled(problem: StaticProblem, side_loads: FloatArray) -> bool:
    """Try to reach a state from the lateral equilibrium of a string that buckles, under its side loads (n_nodes,) [N], which stay.

    Returns whether a stable one, or one that slides steadily, is found.
    """
    model, solver, report = problem.model, problem.solver, problem.state.equilibrium
    model.system.assembly.dead_load = lateral_loads(model.system, side_loads)
    report.imperfection = model.case.initial.imperfection
    placed = Snapshot(model)
    for near in (True, False):
        problem.impose(_fractions(problem)[0])
        try:
            if near:
                solver.newton(report, NEAR_INCREMENT, NEAR_STEPS)
                solver.newton(report, solver.start_increment, BUCKLED_STEPS, near=True)
            else:
                come_to_rest(model, solver, report, solver.start_increment, FIRST_DRAG, LATERAL_FAILED)
            problem.set_friction_aside()
            if not solver.negative_pivots():
                _add_side_force(problem, climbs=False)  # it may leave a buckled string without a state
                return True
        except SolveError:
            problem.set_friction_aside()
        placed.restore()  # what a failed solve leaves is no start for the next
        # a helix may creep along the wall for ever: it has no state, and a relaxation would not end
        if near and slides_on(problem):
            return True
    return False


def _fractions(problem: StaticProblem) -> tuple[float, float]:
    """Lateral friction fractions with which a search begins and ends: a string that turns climbs the wall at the end."""
    return (0.0, problem.fraction) if problem.turns else (1.0, 1.0)


def _add_side_force(problem: StaticProblem, climbs: bool) -> None:
    """Add the side force of friction, if there is a state with it; climbs: relax if Newton's method fails."""
    model, solver, report = problem.model, problem.solver, problem.state.equilibrium
    solver.limit.begin_again()  # there is a state: the limit of the search is none of its side force and flow
    first, full = _fractions(problem)
    if full == first:
        return
    restore = problem.save()
    problem.impose(full)
    try:
        if climbs:
            come_to_rest(model, solver, report, solver.start_increment, most_failed=LATERAL_FAILED)
        else:
            solver.newton(report, solver.start_increment)
    except SolveError:
        restore()
        solver.limit.begin_again()
    finally:
        problem.set_friction_aside()
