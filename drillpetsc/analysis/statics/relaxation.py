"""Relaxation of a string to its static state: steps of implicit Euler with side drag, which become infinitely long.

Manual: sec-statics-relaxation.  Friction has the direction that the components impose.  Side loads and a soft wall are needed by
`buckled-collar.yaml`, side loads by free columns beyond their buckling load.
"""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.statics.snapshot import Snapshot
from drillpetsc.analysis.statics.start.march import March
from drillpetsc.errors import SolveError
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.solvers.static.search_limit import SearchEnded
from drillpetsc.solvers.static.static_newton import CONVERGED_INCREMENT, Drag, Equilibrium, StaticNewton

FIRST_DRAG, LAST_DRAG = 1e3, 1e-2  # over the length of the step [N/m2]
MOST_DRAG = 1e12  # beyond it no step is short enough
MOST_STEPS, MOST_FAILED = 300, 20
STEP_INCREMENT = 1e-2  # largest last increment of a step with drag
STEP_ITERATIONS = 25  # of a step with drag
#: (most iterations of a step, factor by which the next one is longer)
GROWTH = ((2, 100.0), (4, 10.0), (7, 4.0), (12, 1.5), (np.inf, 0.7))
CONVEX = 2.0  # factor of the drag until a step begins convex
SHORTER = 4.0  # factor of a step's drag if it fails
#: largest growth after a failed step, and the factor on it with each further one
AFTER_FAILURE, LIFT = 2.0, 1.5
BACK = 100.0  # factor of the drag if Newton's method fails after the last step
SOFT_PENETRATION = 0.05  # penetration of the softest wall, as a share of the clearance
SOFT_INCREMENT = 1.0  # largest last increment on a wall that is still soft


def fall(
    model: DrillingModel, solver: StaticNewton, report: Equilibrium, tolerance: float, found: March | None
) -> None:
    """Let a string whose loads have an energy come to rest downhill, while the wall becomes stiff; collective.

    The softest wall yields by ``SOFT_PENETRATION`` of the clearance under the force r F^2/4EI of a helix under the largest push F
    (Lubinski, Althouse and Logan, JPT 14(6), 1962); manual: sec-statics-stiffening.

    found: march of the string, in which a push at the top may not pass; None: no wall.  Others: as for ``come_to_rest``.
    """
    contact, force, softest = model.contact, model.case.top.force, 1.0
    if contact is not None and found is not None and contact.law.law == "linear":
        push = max(-float(found.effective_tension.min()), 0.0 if force is None else -force.value(0.0))
        stiffness = float(np.min(model.mesh.bending_stiffness[~model.mesh.is_joint]))
        softest = max(push, 0.0) ** 2 / (4 * stiffness * SOFT_PENETRATION * contact.law.stiffness)
    if contact is not None and 0 < softest < 0.1:
        try:
            for factor in np.geomspace(softest, 1.0, int(np.ceil(-np.log10(softest) / 2)) + 1)[:-1]:
                contact.set_stiffness(factor)
                come_to_rest(model, solver, report, SOFT_INCREMENT, downhill=True)
        finally:
            contact.set_stiffness(1.0)
    come_to_rest(model, solver, report, tolerance, downhill=True)


def come_to_rest(
    model: DrillingModel,
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
        start, before = Snapshot(model), report.iterations
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
            start.restore()
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
