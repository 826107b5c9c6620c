"""Relaxation of a string to its static state: steps of implicit Euler with side drag, which become infinitely long.

Manual: sec-statics-relaxation.  Friction has the direction that the components impose.  Side loads are needed by
`buckled-collar.yaml` and by free columns beyond their buckling load; a soft wall by long strings that cross their hole.
"""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.statics.placement import top_depth
from drillpetsc.analysis.statics.snapshot import Snapshot
from drillpetsc.analysis.statics.start.march import March
from drillpetsc.errors import SolveError
from drillpetsc.geometry.well import Well
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.physics.contact import Contact
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


def relax(
    model: DrillingModel,
    solver: StaticNewton,
    report: Equilibrium,
    tolerance: float = CONVERGED_INCREMENT,
    load: float = 0.0,
    downhill: bool = False,
) -> None:
    """Relax the string from its present state while the wall becomes stiff; collective.

    On a stiff wall the region where a pipe crosses from one side of the hole to the other grows by a node in each step; on a
    soft wall all of it moves at once (manual: sec-statics-stiffening).

    report: gets iterations and increments.
    tolerance: largest increment of the last solve.
    load: contact force per length [N/m] that presses the string into the softest wall by ``SOFT_PENETRATION`` of its
    clearance; 0: the wall keeps its stiffness.
    downhill: as for ``come_to_rest``.
    Raises SolveError if no equilibrium is found.
    """
    contact = model.contact
    if contact is not None and contact.law.law == "linear":
        try:
            for factor in _softening(model, contact, load):
                contact.set_stiffness(factor)
                come_to_rest(model, solver, report, SOFT_INCREMENT, downhill=downhill)
        finally:
            contact.set_stiffness(1.0)
    come_to_rest(model, solver, report, tolerance, downhill=downhill)


def come_to_rest(
    model: DrillingModel,
    solver: StaticNewton,
    report: Equilibrium,
    tolerance: float,
    drag: float = 0.0,
    most_failed: int = MOST_FAILED,
    downhill: bool = False,
) -> None:
    """Let the string move to its state by steps with drag that grow until they are infinitely long; collective.

    report, tolerance: as for ``relax``; most_failed: steps that fail before the string is given up.
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


def _softening(model: DrillingModel, contact: Contact, load: float) -> tuple[float, ...]:
    """Factors of the contact stiffness before 1; none if the wall is soft."""
    softest = load / (SOFT_PENETRATION * _clearance(model, contact.well) * contact.law.stiffness)
    if not 0 < softest < 0.1:
        return ()
    return tuple(np.geomspace(softest, 1.0, int(np.ceil(-np.log10(softest) / 2)) + 1)[:-1])


def _clearance(model: DrillingModel, well: Well) -> float:
    """Smallest radial clearance [m], 1 mm at least."""
    middle = 0.5 * (model.mesh.upper + model.mesh.lower) + top_depth(model)
    gap = np.asarray(well.radius(middle)) - 0.5 * model.mesh.contact_diameter
    return float(max(1e-3, np.min(gap[model.mesh.contact_diameter > 0], initial=0.1)))


def helix_load(model: DrillingModel, found: March) -> float:
    """Largest contact force r F^2/4EI [N/m] of a helix with the clearance r under the largest push F on the string.

    found: march of the string, in which a push at the top may not pass.
    Source: Lubinski, Althouse and Logan, JPT 14(6), 1962.
    """
    force, pipe = model.case.top.force, ~model.mesh.is_joint
    push = max(-float(found.effective_tension.min()), 0.0 if force is None else -force.value(0.0), 0.0)
    gap = 0.0 if model.contact is None else _clearance(model, model.contact.well)
    return gap * push**2 / (4 * float(np.min(model.mesh.bending_stiffness[pipe])))
