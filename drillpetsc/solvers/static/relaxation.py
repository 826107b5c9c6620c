"""Relaxation of a string to its static state: steps of implicit Euler with side drag, which become infinitely long.

Manual: sec-statics-relaxation.  Friction has the direction that the components impose.
"""

from __future__ import annotations

import numpy as np

from drillpetsc.errors import SolveError
from drillpetsc.solvers.static.search_limit import SearchEnded
from drillpetsc.solvers.static.static_newton import CONVERGED_INCREMENT, Drag, Equilibrium, StaticNewton

FIRST_DRAG, LAST_DRAG = 1e3, 1e-2  # over the length of the step [N/m2]
MOST_DRAG = 1e12  # beyond it no step is short enough
MOST_STEPS, MOST_FAILED = 300, 20
SOFT_INCREMENT = 1.0  # largest last increment on a wall that is still soft
STEP_INCREMENT = 1e-2  # largest last increment of a step with drag
STEP_ITERATIONS = 25  # of a step with drag
#: (most iterations of a step, factor by which the next one is longer)
GROWTH = ((2, 100.0), (4, 10.0), (7, 4.0), (12, 1.5), (np.inf, 0.7))
CONVEX = 2.0  # factor of the drag until a step begins convex
SHORTER = 4.0  # factor of a step's drag if it fails
#: largest growth after a failed step, and the factor on it with each further one
AFTER_FAILURE, LIFT = 2.0, 1.5
BACK = 100.0  # factor of the drag if Newton's method fails after the last step


def come_to_rest(
    solver: StaticNewton,
    report: Equilibrium,
    tolerance: float = CONVERGED_INCREMENT,
    drag: float = 0.0,
    most_failed: int = MOST_FAILED,
    downhill: bool = False,
) -> None:
    """Let the string move to its state by steps with drag that grow until they are infinitely long; collective.

    report: gets iterations and increments.  tolerance: largest increment of the last solve.  most_failed: steps that fail before the
    string is given up.
    drag: of the first step [N/m2]; 0: the first one is infinitely long, that is Newton's method, and ``FIRST_DRAG`` follows if it fails.
    downhill: the loads have an energy.  A step begins with so much drag that its energy is convex there, so that it passes over no
    hill; the last one ends in a stable state.
    Raises SolveError if no equilibrium is found.
    """
    most, failed, failure = np.inf, 0, SolveError("the string did not come to rest")
    over_a_hill = SolveError("the step passes over a hill of the energy")
    shorter = 0.0 if drag else FIRST_DRAG  # drag after an infinite step that fails before any other
    for _ in range(MOST_STEPS):
        start, before = solver.save(), report.iterations
        try:
            if not drag:
                solver.newton(report, tolerance)
                if not (downhill and shorter) or not solver.negative_pivots():
                    return
                raise over_a_hill
            drag, shorter = (_convex(solver, drag) if downhill else drag), 0.0
            with solver.drag(Drag(drag)):
                solver.newton(report, STEP_INCREMENT, STEP_ITERATIONS)
                if downhill and drag <= LAST_DRAG and solver.negative_pivots():
                    raise over_a_hill
            count = report.iterations - before
            growth = next(factor for limit, factor in GROWTH if count <= limit)
            drag, most = max(drag / min(growth, most), LAST_DRAG) if drag > LAST_DRAG else 0.0, LIFT * most
        except SolveError as error:
            failure = error
            start()
            if isinstance(error, SearchEnded):  # so would any other step
                break
            if shorter:
                drag, shorter = shorter, 0.0
                continue
            # a failed step costs several good ones, so that the next ones grow slowly
            drag, most, failed = SHORTER * drag if drag else BACK * LAST_DRAG, AFTER_FAILURE, failed + 1
            if failed > most_failed or drag > MOST_DRAG:
                break
    raise failure


def _convex(solver: StaticNewton, drag: float) -> float:
    """The drag, or as much more that the energy of a step is convex where it begins; collective."""
    while drag < MOST_DRAG:
        with solver.drag(Drag(drag)):
            if solver.negative_pivots() <= 0:
                break
        drag *= CONVEX
    return drag
