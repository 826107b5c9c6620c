"""Down to a stable state: Newton where it works, else descent of the energy while the wall of the hole grows stiffer."""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.soft_string import TorqueDrag
from drillpetsc.errors import SolveError
from drillpetsc.fem.component import FloatArray
from drillpetsc.model.drilling_model import Scene
from drillpetsc.solvers.static_newton import ITERATIONS, Equilibrium, Statics

SUBSTITUTIONS = 30  # rounds of anything that is solved by substitution
TRIAL = 100  # descent iterations at each stiffness before a side load is added
SPRING = 10.0  # travel of the weak spring that carries the weight on bit while the string settles [m]
NEAR_DEPTH = 1e-6  # the bit is this near its depth when the true bit takes over [m]
STRONGER = 10.0  # side load that is taken where the asked one does not lead to a stable state, over the asked one
SINK = 0.1  # share of the radial room that the pipe may sink into the softest wall


def nodal_weight(scene: Scene) -> FloatArray:
    """(n_nodes,) weight that each node carries [N]."""
    mesh, g = scene.mesh, float(np.linalg.norm(scene.case.gravity))
    weight = np.zeros(mesh.nodes)
    half = 0.5 * scene.effective_mass * mesh.length * g
    np.add.at(weight, np.arange(mesh.nodes - 1), half)
    np.add.at(weight, np.arange(1, mesh.nodes), half)
    for b in mesh.bodies:
        weight[b.node] += b.mass * g
    return weight


class Place:
    """The state and the top's position, to come back to."""

    def __init__(self, scene: Scene):
        self.scene, self.x = scene, scene.model.assembly.x.copy()
        self.top = None if scene.top is None else scene.top.anchor.copy()

    def restore(self) -> None:
        self.scene.model.assembly.x[:] = self.x
        if self.scene.top is not None:
            self.scene.top.anchor[:] = self.top


def clearance(scene: Scene) -> float | None:
    if scene.well is None or scene.contact is None:
        return None
    middle = 0.5 * (scene.mesh.upper + scene.mesh.lower)
    room = np.asarray(scene.well.radius(middle)) - 0.5 * scene.mesh.outer_diameter
    return float(max(1e-3, np.min(room[scene.mesh.outer_diameter > 0], initial=0.1)))


def stable_state(scene: Scene, solver: Statics, soft: TorqueDrag | None, report: Equilibrium) -> None:
    """Newton where it finds a stable state, else down the energy; from a saddle a small persistent side load leads
    away."""
    fraction = scene.case.initial.imperfection
    factors = stiffness_steps(scene, soft)
    if not solver.energy:
        solver.settle(report)
        return
    try:
        newton_or_descent(scene, solver, report, factors, TRIAL if fraction else ITERATIONS)
        failure = SolveError("the static state is unstable") if solver.negative_pivots() else None
    except SolveError as error:
        failure = error
    if failure is None:
        return
    if not fraction or too_coarse(scene):
        if report.converged:
            return
        raise failure
    # on the saddle of a straight column nothing points sideways: a small persistent load does
    load, keep = nodal_weight(scene) * _own_imperfection(scene, fraction), Place(scene)
    for strength in (fraction, STRONGER * fraction):
        solver.push_aside(strength, load)
        report.imperfection = strength
        try:
            _descend(scene, solver, report, factors)
            return
        except SolveError:  # far above its critical load a long string has too flat a way down for so weak a load
            if strength > fraction:
                raise
            keep.restore()


def _own_imperfection(scene: Scene, fraction: float) -> FloatArray:
    """(n_nodes,) factor on ``fraction`` where a string item asks for an imperfection of its own."""
    mesh, factor = scene.mesh, np.ones(scene.mesh.nodes)
    for e, number in enumerate(mesh.item):
        own = getattr(scene.case.string[number], "initial", None)
        if own is not None:
            factor[e : e + 2] = own.imperfection / fraction
    return factor


def newton_or_descent(
    scene: Scene, solver: Statics, report: Equilibrium, factors: tuple[float, ...], most: int = ITERATIONS
) -> None:
    """Full Newton steps, or descent where they do not converge; may end in an unstable state."""
    keep = Place(scene)
    try:
        solver.settle_freely(report)
        return
    except SolveError:
        if report.converged:
            return
        keep.restore()
    _descend(scene, solver, report, factors, most)


def _descend(
    scene: Scene, solver: Statics, report: Equilibrium, factors: tuple[float, ...], most: int = ITERATIONS
) -> None:
    """Down the energy while the contact grows stiffer; the weight on bit acts as a weak spring, long preloaded,
    meanwhile."""
    if solver.depth is None:
        _harden(scene, solver, report, factors, most)
        return
    wob, constraint, bit = scene.case.initial.wob, solver.depth, scene.bit
    assert bit is not None and scene.top is not None and wob is not None
    solver.depth = None
    try:
        for _ in range(SUBSTITUTIONS):
            with bit.preloaded(wob, SPRING):
                _harden(scene, solver, report, factors, most)
            here, _, target = constraint(scene.model)
            error = target - solver.sum(here)
            if abs(error) < NEAR_DEPTH:
                break
            factors = (1.0,)
            scene.top.shift(error)
    finally:
        solver.depth = constraint
    solver.settle_freely(report)


def _harden(scene: Scene, solver: Statics, report: Equilibrium, factors: tuple[float, ...], most: int) -> None:
    for factor in factors:
        if scene.contact is not None:
            scene.contact.set_stiffness(factor)
        try:
            solver.settle_down(report, most)
        finally:
            if scene.contact is not None:
                scene.contact.set_stiffness(1.0)


def stiffness_steps(scene: Scene, soft: TorqueDrag | None) -> tuple[float, ...]:
    """Factors on the contact stiffness, rising to 1: at the first the most loaded part sinks in by a share of its
    radial room.

    Loads: weight, side load of the soft string, and r F^2/4EI of a helix under the largest compression F (Lubinski,
    Althouse and Logan, JPT 14(6), 1962).
    """
    room, contact, mesh = clearance(scene), scene.case.contact, scene.mesh
    if scene.contact is None:
        return (1.0,)
    if room is None or contact is None or contact.law != "linear":
        return 1e-2, 1e-1, 1.0
    load = float(np.max(mesh.mass)) * float(np.linalg.norm(scene.case.gravity))
    force = getattr(scene.case.top, "force", None)
    compression = 0.0 if force is None else max(0.0, -force.value(0.0))
    if soft is not None:
        load = max(load, float(np.max(soft.contact_force)))
        compression = max(compression, -float(np.min(soft.axial_force)))
    load = max(load, room * compression**2 / (4 * float(np.min(mesh.bending_stiffness))))
    softest = min(1.0, load / (SINK * room * contact.stiffness))
    count = int(np.ceil(np.log10(1.0 / softest))) if softest < 0.5 else 0
    return tuple(np.geomspace(max(softest, 1e-6), 1.0, count + 1)) if count else (1.0,)


def too_coarse(scene: Scene) -> bool:
    """Elements longer than their bending can hold against the axial load of their weight: L^3 > 240 EI/w (model,
    section 9.4)."""
    return bool(coarse_elements(scene).any())


def coarse_elements(scene: Scene) -> np.ndarray:
    """(n,) elements above the limit L^3 > 240 EI/w."""
    mesh = scene.mesh
    w = mesh.mass * np.linalg.norm(scene.case.gravity)
    return mesh.length**3 * w > 240 * mesh.bending_stiffness
