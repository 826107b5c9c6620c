"""Static equilibrium with friction by Newton's method, from a start that contains friction or from a state without it.

Manual: sec-statics-sequence.
"""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.energy_descent import (
    MAX_SUBSTITUTIONS,
    START_INCREMENT,
    Snapshot,
    newton_or_descent,
    newton_with_stiffening,
    nodal_weight,
    stable_state,
    stiffness_steps,
)
from drillpetsc.analysis.lateral_start import SPACING, lateral_starts
from drillpetsc.analysis.march import March
from drillpetsc.analysis.paths_of_problem import answer_by_path, has_two_paths, slides_on
from drillpetsc.analysis.soft_string_start import place_marched
from drillpetsc.analysis.static_problem import StaticProblem
from drillpetsc.errors import SolveError
from drillpetsc.unit_systems import shown

LATERAL_STEPS = 15  # of Newton's method from a lateral equilibrium, which is close to the state
NEAR_STEPS, NEAR_INCREMENT = 6, 10.0  # of its first steps, and the increment that they reach from there
SETTLING_TURNS = 2  # minimisations with friction as a dead load where those do not converge
SETTLING_STEPS, SETTLED_INCREMENT = 120, 1e-3  # of one of them, and the increment that ends it
STALL_ROUNDS = 6  # rounds of friction without half the change before its substitution ends


def reach(problem: StaticProblem, found: March | None) -> float:
    """Find an equilibrium with friction from the present state; returns the lateral friction fraction reached.

    found: the start, None without contact.
    Raises SolveError where no equilibrium is found.
    """
    reached = from_lateral_start(problem)
    if reached is not None:
        return reached
    if problem.moves and problem.straight is not None and _follows_paths(problem):
        return problem.state.lateral_fraction
    if problem.moves and found is not None:
        reached = _newton_with_friction(problem, found)
    if reached is None:
        load, state = found.usual_contact_force if found is not None else 0.0, problem.state
        stable_state(problem.model, problem.solver, state.soft_string, state.equilibrium, load)
        reached = _add_friction(problem) if problem.moves else problem.fraction
    return reached


def _follows_paths(problem: StaticProblem) -> bool:
    """Follow the paths of a small string that slides and has several states, where its lateral equilibrium leads to none; collective.

    Returns whether the first one has an end; the state is the former one where it has none.
    """
    if problem.turns or not has_two_paths(problem):
        return False
    asm, before, rates = problem.model.system.assembly, Snapshot(problem.model), problem.solver.rates
    y = asm.y.copy()
    problem.origin.restore()
    try:
        answer_by_path(problem, "sliding")
    except SolveError:
        before.restore()
        asm.dead_load, asm.y[:], problem.solver.rates = None, y, rates
        problem.set_friction_aside()
        return False
    return True


def from_lateral_start(problem: StaticProblem) -> float | None:
    """Try Newton's method from the lateral equilibrium of a pushed string; manual: sec-statics-lateral-start.

    Returns the lateral friction fraction reached, or None with the state restored where nothing pushes the string, or no
    stable equilibrium is found.
    """
    model, solver, report, straight = (
        problem.model,
        problem.solver,
        problem.state.equilibrium,
        problem.straight,
    )
    if straight is None or not solver.energy:
        return None
    before = Snapshot(model)
    for start in lateral_starts(model, straight, problem.state.motion, problem.fraction > 0, problem.found):
        fraction = problem.fraction if start.with_friction else 0.0
        problem.origin.restore()
        place_marched(model, start.march)
        if start.side_loads is not None:
            solver.add_imperfection(start.side_loads, SPACING)
            report.imperfection = model.case.initial.imperfection
        for turn in range(1 if fraction and problem.state.motion[1] else SETTLING_TURNS + 1):
            if turn:
                try:
                    _settle_under_friction(problem, fraction)
                except SolveError:
                    break
            placed = Snapshot(model)
            problem.impose(fraction)
            try:
                solver.newton_damped(report, NEAR_INCREMENT, NEAR_STEPS)
                solver.newton_damped(report, solver.start_increment, LATERAL_STEPS, near=True)
                reached = True
            except SolveError:
                reached = False
            problem.set_friction_aside()
            if reached and not solver.negative_pivots():
                return fraction
            placed.restore()
            if start.with_friction and start.side_loads is not None and slides_on(problem):
                return fraction
    before.restore()
    model.system.assembly.dead_load, report.imperfection = None, 0.0
    return None


def _settle_under_friction(problem: StaticProblem, fraction: float) -> None:
    """Minimise the energy with the friction of the present state as a dead load.

    A buckle in a vertical hole rolls about the axis almost without work: far from the minimum Newton's method with
    friction, which has no energy, goes astray.  Raises SolveError where no minimum is found.
    """
    solver, asm = problem.solver, problem.model.system.assembly
    loads = asm.dead_load
    without = solver.rows()
    problem.impose(fraction)
    friction = without - solver.rows()
    problem.set_friction_aside()
    asm.dead_load = friction if loads is None else loads + friction
    try:
        solver.minimise_energy(problem.state.equilibrium, SETTLING_STEPS, SETTLED_INCREMENT, may_stall=True)
    finally:
        asm.dead_load = loads


def _newton_with_friction(problem: StaticProblem, found: March) -> float | None:
    """Try Newton's method with friction from the start ``found``, which already contains it.

    A turning string is first solved without lateral friction, then with its fraction.
    Returns the lateral friction fraction reached, or None with the state restored where no stable equilibrium
    is found.
    """
    model, solver, report = problem.model, problem.solver, problem.state.equilibrium
    turns, start, reached = bool(problem.state.motion[1]), Snapshot(model), None
    trials = sorted({problem.fraction if turns else 1.0, 0.0 if turns else 1.0})
    for trial in trials:
        last = Snapshot(model)
        problem.impose(trial)
        # what a further solve starts from, with more friction or with the flow, need not be exact
        tolerance = START_INCREMENT if trial != trials[-1] else solver.start_increment
        try:
            if reached is None:
                newton_with_stiffening(model, solver, report, found.usual_contact_force, tolerance)
            else:
                solver.newton_damped(report, tolerance)
            reached = trial
        except SolveError:
            last.restore()
            if reached is not None:
                problem.impose(reached)
                try:
                    solver.newton_damped(report)
                except SolveError:
                    reached = None
            break
    problem.set_friction_aside()
    if reached is not None and not (solver.energy and solver.negative_pivots()):
        return reached
    start.restore()
    return None


def _add_friction(problem: StaticProblem) -> float:
    """Find the equilibrium with friction from the frictionless one; returns the lateral friction fraction reached."""
    model, solver, report = problem.model, problem.solver, problem.state.equilibrium
    start, fraction, turns = Snapshot(model), 1.0 if problem.fraction > 0 else 0.0, problem.state.motion[1]
    problem.impose(fraction)
    try:
        solver.newton_damped(report)
        return fraction
    except SolveError:
        start.restore()
    _friction_by_substitution(problem)
    start = Snapshot(model)
    if fraction and turns:
        problem.impose(fraction)
        try:
            solver.newton_damped(report)
            return fraction
        except SolveError:
            start.restore()
    return 0.0 if turns else fraction


def _friction_by_substitution(problem: StaticProblem) -> None:
    """Apply axial friction and friction torque as a dead load, updated until it no longer changes.

    Every solve then has an energy to minimise.  Raises SolveError where the load does not converge.
    """
    model, solver, state = problem.model, problem.solver, problem.state
    system = model.system
    asm = system.assembly
    imperfection = asm.dead_load
    imperfection_load = 0.0 if imperfection is None else imperfection
    last, weight = np.zeros(system.layout.size), float(nodal_weight(model).sum())
    changes, factors = [np.inf], stiffness_steps(model, state.soft_string)
    try:
        for _ in range(MAX_SUBSTITUTIONS):
            asm.dead_load = None
            problem.impose(0.0)
            with_friction = solver.rows()
            problem.set_friction_aside()
            friction = solver.rows() - with_friction
            changes.append(solver.largest(float(np.max(np.abs(friction - last), initial=0.0))))
            if changes[-1] < 1e-7 * weight:
                return
            if len(changes) > 2 * STALL_ROUNDS and min(changes[-STALL_ROUNDS:]) > 0.5 * min(
                changes[:-STALL_ROUNDS]
            ):
                break  # a buckled string may go from state to state for ever
            asm.dead_load = imperfection_load + friction
            newton_or_descent(model, solver, state.equilibrium, factors)
            last, factors = friction, (1.0,)
        raise SolveError(
            f"friction did not converge in {len(changes) - 1} rounds (last change {shown(changes[-1], 'force', system.units, 3)})",
            **system.locate_largest_residual(0.0),
        )
    finally:
        asm.dead_load = imperfection
