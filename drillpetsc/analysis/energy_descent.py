"""Down to a stable state: Newton where it works, else descent of the energy while the wall of the hole grows
stiffer."""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.soft_string import TorqueDrag
from drillpetsc.arrays import FloatArray
from drillpetsc.errors import SolveError
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.solvers.static_newton import MAX_ITERATIONS, Equilibrium, StaticNewton

SUBSTITUTIONS = 30  # rounds of anything that is solved by substitution
TRIAL = 100  # descent iterations at each stiffness before a side load is added
SPRING = 10.0  # travel of the weak spring that carries the weight on bit while the string settles [m]
NEAR_DEPTH = 1e-6  # the bit is this near its depth when the true bit takes over [m]
STRONGER = (
    10.0  # side load that is taken where the asked one does not lead to a stable state, over the asked one
)
SINK = 0.1  # share of the radial clearance that the pipe may sink into the softest wall


def nodal_weight(model: DrillingModel) -> FloatArray:
    """(n_nodes,) weight that each node carries [N]."""
    mesh, g = model.mesh, float(np.linalg.norm(model.case.gravity))
    weight = np.zeros(mesh.nodes)
    half = 0.5 * model.effective_mass * mesh.length * g
    np.add.at(weight, np.arange(mesh.nodes - 1), half)
    np.add.at(weight, np.arange(1, mesh.nodes), half)
    for b in mesh.bodies:
        weight[b.node] += b.mass * g
    return weight


class Snapshot:
    """The state and the top's position, to come back to."""

    def __init__(self, model: DrillingModel):
        self.model, self.x = model, model.system.assembly.x.copy()
        self.top = None if model.top is None else model.top.anchor.copy()

    def restore(self) -> None:
        self.model.system.assembly.x[:] = self.x
        if self.model.top is not None:
            self.model.top.anchor[:] = self.top


def clearance(model: DrillingModel) -> float | None:
    if model.well is None or model.contact is None:
        return None
    middle = 0.5 * (model.mesh.upper + model.mesh.lower)
    gap = np.asarray(model.well.radius(middle)) - 0.5 * model.mesh.outer_diameter
    return float(max(1e-3, np.min(gap[model.mesh.outer_diameter > 0], initial=0.1)))


def stable_state(
    model: DrillingModel, solver: StaticNewton, soft: TorqueDrag | None, report: Equilibrium
) -> None:
    """Newton where it finds a stable state, else down the energy; from a saddle a small persistent side load
    leads away."""
    fraction = model.case.initial.imperfection
    factors = stiffness_steps(model, soft)
    if not solver.energy:
        solver.solve(report)
        return
    try:
        newton_or_descent(model, solver, report, factors, TRIAL if fraction else MAX_ITERATIONS)
        failure = SolveError("the static state is unstable") if solver.negative_pivots() else None
    except SolveError as error:
        failure = error
    if failure is None:
        return
    if not fraction or too_coarse(model):
        if report.converged:
            return
        raise failure
    # on the saddle of a straight column nothing points sideways: a small persistent load does
    load, keep = nodal_weight(model) * _own_imperfection(model, fraction), Snapshot(model)
    for strength in (fraction, STRONGER * fraction):
        solver.add_imperfection(strength, load)
        report.imperfection = strength
        try:
            _descend(model, solver, report, factors)
            return
        except (
            SolveError
        ):  # far above its critical load a long string has too flat a way down for so weak a load
            if strength > fraction:
                raise
            keep.restore()


def _own_imperfection(model: DrillingModel, fraction: float) -> FloatArray:
    """(n_nodes,) factor on ``fraction`` where a string item asks for an imperfection of its own."""
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
    most: int = MAX_ITERATIONS,
) -> None:
    """Full Newton steps, or descent where they do not converge; may end in an unstable state."""
    keep = Snapshot(model)
    try:
        solver.newton_free(report)
        return
    except SolveError:
        if report.converged:
            return
        keep.restore()
    _descend(model, solver, report, factors, most)


def _descend(
    model: DrillingModel,
    solver: StaticNewton,
    report: Equilibrium,
    factors: tuple[float, ...],
    most: int = MAX_ITERATIONS,
) -> None:
    """Down the energy while the contact grows stiffer; the weight on bit acts as a weak spring, long
    preloaded, meanwhile."""
    if solver.depth is None:
        _harden(model, solver, report, factors, most)
        return
    wob, constraint, bit = model.case.initial.wob, solver.depth, model.bit
    assert bit is not None and model.top is not None and wob is not None
    solver.depth = None
    try:
        for _ in range(SUBSTITUTIONS):
            with bit.preloaded(wob, SPRING):
                _harden(model, solver, report, factors, most)
            here, _, target = constraint(model.system)
            error = target - solver.sum(here)
            if abs(error) < NEAR_DEPTH:
                break
            factors = (1.0,)
            model.top.shift(error)
    finally:
        solver.depth = constraint
    solver.newton_free(report)


def _harden(
    model: DrillingModel, solver: StaticNewton, report: Equilibrium, factors: tuple[float, ...], most: int
) -> None:
    for factor in factors:
        if model.contact is not None:
            model.contact.set_stiffness(factor)
        try:
            solver.minimise_energy(report, most)
        finally:
            if model.contact is not None:
                model.contact.set_stiffness(1.0)


def stiffness_steps(model: DrillingModel, soft: TorqueDrag | None) -> tuple[float, ...]:
    """Factors on the contact stiffness, rising to 1: at the first the most loaded part sinks in by a share of
    its radial clearance.

    Loads: weight, side load of the soft string, and r F^2/4EI of a helix under the largest compression F
    (Lubinski, Althouse and Logan, JPT 14(6), 1962).
    """
    gap, contact, mesh = clearance(model), model.case.contact, model.mesh
    if model.contact is None:
        return (1.0,)
    if gap is None or contact is None or contact.law != "linear":
        return 1e-2, 1e-1, 1.0
    load = float(np.max(mesh.mass)) * float(np.linalg.norm(model.case.gravity))
    force = model.case.top.force
    compression = 0.0 if force is None else max(0.0, -force.value(0.0))
    if soft is not None:
        load = max(load, float(np.max(soft.contact_force)))
        compression = max(compression, -float(np.min(soft.axial_force)))
    load = max(load, gap * compression**2 / (4 * float(np.min(mesh.bending_stiffness))))
    softest = min(1.0, load / (SINK * gap * contact.stiffness))
    count = int(np.ceil(np.log10(1.0 / softest))) if softest < 0.5 else 0
    return tuple(np.geomspace(max(softest, 1e-6), 1.0, count + 1)) if count else (1.0,)


def too_coarse(model: DrillingModel) -> bool:
    """Elements longer than their bending can hold against the axial load of their weight: L^3 > 240 EI/w
    (model, section 9.4)."""
    return bool(coarse_elements(model).any())


def coarse_elements(model: DrillingModel) -> np.ndarray:
    """(n,) elements above the limit L^3 > 240 EI/w."""
    mesh = model.mesh
    w = mesh.mass * np.linalg.norm(model.case.gravity)
    return mesh.length**3 * w > 240 * mesh.bending_stiffness
