"""Stable static equilibrium: Newton's method, or energy minimisation with continuation in the contact stiffness.

Manual: sec-statics-descent.
"""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.placement import top_depth
from drillpetsc.analysis.soft_string import TorqueDrag
from drillpetsc.arrays import FloatArray
from drillpetsc.errors import SolveError
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.solvers.static_newton import CONVERGED_INCREMENT, MAX_ITERATIONS, Equilibrium, StaticNewton

MAX_SUBSTITUTIONS = 30  # rounds of an iteration by substitution
TRIAL_ITERATIONS = 100  # iterations of the minimisation at each stiffness before a lateral load is added
SPRING_TRAVEL = 10.0  # travel of the weak spring that carries the weight on bit during the minimisation [m]
MOST_GAIN = 1e4  # motion of the top over the error of the bit's depth
DEPTH_TOLERANCE = 1e-6  # largest error of the bit's depth when the bit replaces the spring [m]
STRONGER_LOAD = 10.0  # factor of the lateral load where the requested one does not lead to a stable state
#: largest penetration in the first continuation step, as a fraction of the radial clearance
FIRST_PENETRATION = 0.1
SOFT_PENETRATION = 0.05  # penetration of the softest wall in Newton's method, as a fraction of the clearance
COARSE_INCREMENT = 1e-3  # largest increment of a converged minimum on a wall that is still soft
SOFT_INCREMENT = 1.0  # largest last increment of Newton's method on a wall that is still soft
START_INCREMENT = 0.1  # of a state from which a further solve with more friction, or with the flow, starts


def newton_with_stiffening(
    model: DrillingModel,
    solver: StaticNewton,
    report: Equilibrium,
    load: float,
    tolerance: float = CONVERGED_INCREMENT,
) -> None:
    """Take full Newton steps while the wall becomes stiff (manual: sec-statics-stiffening).

    On a stiff wall the region where a pipe crosses from one side of the hole to the other grows by a node in
    each step; on a soft wall all of it moves at once.

    load: contact force per length [N/m] that presses the string into the softest wall by
    ``SOFT_PENETRATION`` of its clearance; 0: the wall keeps its stiffness.
    tolerance: largest increment of the last solve.
    Raises SolveError where a solve does not converge.
    """
    if model.contact is not None:
        try:
            for factor in _softening(model, load):
                model.contact.set_stiffness(factor)
                solver.newton_damped(report, SOFT_INCREMENT)
        finally:
            model.contact.set_stiffness(1.0)
    solver.newton_damped(report, tolerance)


def _softening(model: DrillingModel, load: float) -> tuple[float, ...]:
    """Compute the factors of the contact stiffness before 1; none where the wall is soft."""
    gap = clearance(model)
    if model.contact is None or model.contact.law.law != "linear" or gap is None:
        return ()
    softest = load / (SOFT_PENETRATION * gap * model.contact.law.stiffness)
    if not 0 < softest < 0.1:
        return ()
    return tuple(np.geomspace(softest, 1.0, int(np.ceil(-np.log10(softest) / 2)) + 1)[:-1])


def nodal_weight(model: DrillingModel) -> FloatArray:
    """Compute the weight (n_nodes,) of each node [N]: half of both neighbouring elements and the rigid items."""
    mesh, g = model.mesh, float(np.linalg.norm(model.case.gravity))
    weight = np.zeros(mesh.nodes)
    half = 0.5 * model.effective_mass * mesh.length * g
    np.add.at(weight, np.arange(mesh.nodes - 1), half)
    np.add.at(weight, np.arange(1, mesh.nodes), half)
    for b in mesh.bodies:
        weight[b.node] += b.mass * g
    return weight


class Snapshot:
    """Copy of the unknowns and of the top's position, which ``restore`` puts back."""

    def __init__(self, model: DrillingModel):
        self.model, self.x = model, model.system.assembly.x.copy()
        self.top = None if model.top is None else model.top.anchor.copy()

    def restore(self) -> None:
        """Put the copied state back."""
        self.model.system.assembly.x[:] = self.x
        if self.model.top is not None:
            self.model.top.anchor[:] = self.top


def clearance(model: DrillingModel) -> float | None:
    """Compute the smallest radial clearance [m], 1 mm at least; None without contact."""
    if model.well is None or model.contact is None:
        return None
    middle = 0.5 * (model.mesh.upper + model.mesh.lower) + top_depth(model)
    gap = np.asarray(model.well.radius(middle)) - 0.5 * model.mesh.contact_diameter
    return float(max(1e-3, np.min(gap[model.mesh.contact_diameter > 0], initial=0.1)))


def stable_state(
    model: DrillingModel,
    solver: StaticNewton,
    soft: TorqueDrag | None,
    report: Equilibrium,
    load: float,
) -> None:
    """Find a stable state: Newton's method, else minimisation of the energy; collective.

    From a saddle of the energy a small persistent lateral load leads to a minimum (manual:
    sec-statics-descent).

    soft: results of the soft string, None without one.
    report: gets iterations, increments and imperfection.
    load: as for ``newton_with_stiffening``.
    Raises SolveError where no state is found.
    """
    fraction = model.case.initial.imperfection
    factors = stiffness_steps(model, soft)
    if not solver.energy:
        solver.solve(report)
        return
    try:
        newton_or_descent(
            model, solver, report, factors, TRIAL_ITERATIONS if fraction else MAX_ITERATIONS, load
        )
        failure = SolveError("the static state is unstable") if solver.negative_pivots() else None
    except SolveError as error:
        failure = error
    if failure is None:
        return
    if not fraction or too_coarse(model):
        if report.converged:
            return
        raise failure
    # a straight column is a saddle of the energy, on which no force is lateral; a small persistent load is
    lateral, start = nodal_weight(model) * item_imperfection(model, fraction), Snapshot(model)
    for strength in (fraction, STRONGER_LOAD * fraction):
        solver.add_imperfection(strength * lateral)
        report.imperfection = strength
        try:
            _minimise(model, solver, report, factors)
            return
        except SolveError:
            # far above the critical load of a long string the energy falls too slowly for a weak load
            if strength > fraction:
                raise
            start.restore()


def item_imperfection(model: DrillingModel, fraction: float) -> FloatArray:
    """Compute the factor (n_nodes,) on ``fraction`` of string items with their own imperfection."""
    mesh, factor = model.mesh, np.ones(model.mesh.nodes)
    for e, number in enumerate(mesh.item):
        own = model.case.string[number].initial
        if own is not None:
            factor[e : e + 2] = own.imperfection / fraction
    return factor


def newton_or_descent(
    model: DrillingModel,
    solver: StaticNewton,
    report: Equilibrium,
    factors: tuple[float, ...],
    max_iterations: int = MAX_ITERATIONS,
    load: float = 0.0,
) -> None:
    """Take full Newton steps, or minimise the energy where they do not converge; collective.

    The result may be unstable.

    report: gets iterations and increments.
    factors: of the contact stiffness, rising to 1.
    max_iterations: of the minimisation at each stiffness.
    load: as for ``newton_with_stiffening``; 0: the wall keeps its stiffness.
    Raises SolveError where neither converges.
    """
    start, searches = Snapshot(model), solver.searches
    solver.searches = False  # where full steps do not converge, the descent is faster than short ones
    try:
        newton_with_stiffening(model, solver, report, load)
        solver.check_stable()
        return
    except SolveError:
        if report.converged:
            return
        start.restore()
    finally:
        solver.searches = searches
    _minimise(model, solver, report, factors, max_iterations)


def _minimise(
    model: DrillingModel,
    solver: StaticNewton,
    report: Equilibrium,
    factors: tuple[float, ...],
    max_iterations: int = MAX_ITERATIONS,
) -> None:
    """Minimise the energy while the contact becomes stiffer.

    A given weight on bit acts through a weak preloaded spring meanwhile (manual: sec-statics-wob).
    """
    if solver.depth is None:
        _minimise_with_stiffening(model, solver, report, factors, max_iterations)
        return
    wob, constraint, bit = model.case.initial.wob, solver.depth, model.bit
    assert bit is not None and model.top is not None and wob is not None
    solver.depth, last, moved = None, None, 0.0
    try:
        for _ in range(MAX_SUBSTITUTIONS):
            with bit.preloaded(wob, SPRING_TRAVEL):
                _minimise_with_stiffening(model, solver, report, factors, max_iterations)
            depth, _, target = constraint(model.system)
            error = target - solver.sum(depth)
            if abs(error) < DEPTH_TOLERANCE:
                break
            factors = (1.0,)
            # a reamer on its shoulder carries what the top adds: the bit follows by a hundredth of it
            gain = moved / (last - error) if last is not None and last != error else 1.0
            moved, last = min(max(gain, 1.0), MOST_GAIN) * error, error
            model.top.shift(moved)
    finally:
        solver.depth = constraint
    solver.newton_free(report)


def _minimise_with_stiffening(
    model: DrillingModel,
    solver: StaticNewton,
    report: Equilibrium,
    factors: tuple[float, ...],
    max_iterations: int,
) -> None:
    """Minimise the energy at each contact stiffness, in the order of ``factors``.

    The last state has factor 1.
    """
    for factor in factors:
        if model.contact is not None:
            model.contact.set_stiffness(factor)
        try:
            last = factor == factors[-1]
            solver.minimise_energy(report, max_iterations, CONVERGED_INCREMENT if last else COARSE_INCREMENT)
        finally:
            if model.contact is not None:
                model.contact.set_stiffness(1.0)


def stiffness_steps(model: DrillingModel, soft: TorqueDrag | None) -> tuple[float, ...]:
    """Compute the factors of the contact stiffness, rising to 1 (manual: eq-statics-softest).

    At the first one the most loaded part penetrates the wall by ``FIRST_PENETRATION`` of its radial
    clearance.
    Loads per length: weight, lateral load of the soft string, and r F^2/4EI of a helix under the largest
    compression F with the clearance r (Lubinski, Althouse and Logan, JPT 14(6), 1962).
    """
    gap, mesh = clearance(model), model.mesh
    if model.contact is None:
        return (1.0,)
    law = model.contact.law
    if gap is None or law.law != "linear":
        return 1e-2, 1e-1, 1.0
    load = float(np.max(mesh.mass)) * float(np.linalg.norm(model.case.gravity))
    force = model.case.top.force
    compression = 0.0 if force is None else max(0.0, -force.value(0.0))
    if soft is not None:
        load = max(load, float(np.max(soft.contact_force)))
        compression = max(compression, -float(np.min(soft.axial_force)))
    load = max(load, gap * compression**2 / (4 * float(np.min(mesh.bending_stiffness))))
    if not load > 0:  # weightless and without a push: nothing presses on the wall
        return (1.0,)
    softest = min(1.0, load / (FIRST_PENETRATION * gap * law.stiffness))
    count = int(np.ceil(np.log10(1.0 / softest))) if softest < 0.5 else 0
    return tuple(np.geomspace(max(softest, 1e-6), 1.0, count + 1)) if count else (1.0,)


def too_coarse(model: DrillingModel) -> bool:
    """Whether an element is above the limit of ``coarse_elements``."""
    return bool(coarse_elements(model).any())


def coarse_elements(model: DrillingModel) -> np.ndarray:
    """Find the elements (n,) with L^3 > 240 EI/w (manual: eq-beam-length-limit).

    The bending stiffness of such an element does not balance the axial load of its own weight w per length.
    """
    mesh = model.mesh
    w = mesh.mass * np.linalg.norm(model.case.gravity)
    return mesh.length**3 * w > 240 * mesh.bending_stiffness
