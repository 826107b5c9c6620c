"""How a scene starts: along the hole, straight, or in static equilibrium with friction against a given motion."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from drillpetsc.case.ends import DrivenTop
from drillpetsc.case.ends import TopDrive as TopDriveCase
from drillpetsc.coupled import agree, begin_flow, let_flow
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.field import FloatArray
from drillpetsc.guess import soft_string_guess
from drillpetsc.scene import Scene
from drillpetsc.soft_string import TorqueDrag
from drillpetsc.solve.hydraulics import place_fluid, steady_flow
from drillpetsc.solve.statics import ITERATIONS, Equilibrium, Statics

SUBSTITUTIONS = 30
TRIAL = 100  # descent iterations at each stiffness before a side load is added
SPRING = 10.0  # travel of the weak spring that carries the weight on bit while the string settles [m]
NEAR_DEPTH = 1e-6  # the bit is this near its depth when the true bit takes over [m]
SINK = 0.1  # share of the radial room that the pipe may sink into the softest wall
MOTIONS = {"hoist": (-1.0, 0.0), "lower": (1.0, 0.0), "rotate": (0.0, 1.0)}


@dataclass
class StaticState:
    """Result of ``find_equilibrium``; the state itself is in the scene's model.

    motion: axial velocity [m/s, down positive] and rotation [rad/s] that friction opposes; stable: no negative pivot.
    """

    motion: tuple[float, float]
    equilibrium: Equilibrium
    soft_string: TorqueDrag | None = None
    warnings: list[str] = field(default_factory=list)

    @property
    def stable(self) -> bool:
        return self.equilibrium.negative_pivots == 0


def prescribed_motion(scene: Scene) -> tuple[float, float]:
    """Axial velocity (down positive) and rotation that the top prescribes at time 0."""
    top = scene.case.top
    if isinstance(top, (TopDriveCase, DrivenTop)):
        lowering = 0.0 if getattr(top, "force", None) is not None else top.lowering.value(0.0)
        return lowering, top.rotation.value(0.0)
    return 0.0, 0.0


def place_along_hole(scene: Scene) -> None:
    """The unstrained string along the hole's axis (or straight, without a hole), at rest."""
    m = scene.model
    if scene.beam is not None:
        m.set_field("string.position", scene.position)
        m.set_field("string.tangent", scene.tangent)
        m.set_field("string.spin", np.zeros((m.mesh.nodes, 1)))
    if "string.ratio" in m.layout.place:
        m.set_field("string.ratio", np.ones((m.mesh.nodes, 1)))
    m.assembly.y[:] = 0.0
    m.assembly.a[:] = 0.0
    if scene.fluid is not None:
        place_fluid(m, scene.fluid)


def move_rigidly(scene: Scene) -> None:
    """Give every node the spin and lowering that the top prescribes at time 0 (the state at rest before)."""
    if scene.beam is None:
        let_flow(scene)
        return
    m = scene.model
    lowering, rotation = prescribed_motion(scene)
    tangent = scene.tangent if scene.well is None else scene.well.at(scene.mesh.node_depth)[1]
    m.set_field("string.position", lowering * np.asarray(tangent), "y")
    m.set_field("string.tangent", np.zeros((m.mesh.nodes, 3)), "y")
    m.set_field("string.spin", np.full((m.mesh.nodes, 1), rotation), "y")
    let_flow(scene)


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


def find_equilibrium(scene: Scene, motion: tuple[float, float] | None = None, climb: bool = True) -> StaticState:
    """Static equilibrium of the scene, friction opposing ``motion`` (by default what the top prescribes at time 0).

    First without friction, to a stable state; then friction is added at once.  climb: friction across the pipe pushes
    it up the wall of the hole, as it does with a turning pipe at rest there; without, only its torque acts, as
    torque-and-drag models have it. Raises SolveError when no equilibrium is found.
    """
    motion = prescribed_motion(scene) if motion is None else motion
    place_along_hole(scene)
    if scene.beam is None:
        flow = steady_flow(scene.model)
        return StaticState((0.0, 0.0), Equilibrium(iterations=flow.iterations, increment=flow.increment, converged=True))
    begin_flow(scene)
    soft = soft_string_guess(scene, motion)
    solver = _solver(scene)
    wob = scene.case.initial.wob
    if wob is not None:
        _ask_for_weight(scene, solver, wob)
    slipping = [r for r in (scene.contact, scene.bit) if r is not None]
    for room in slipping:
        room.impose_sliding(0.0, 0.0)
    report = Equilibrium()
    state, side = StaticState(motion, report, soft), 1.0 if climb else 0.0
    moves = bool(slipping) and motion != (0.0, 0.0)
    reached = _settle_at_once(scene, solver, slipping, state, side) if moves and soft is not None else None
    if reached is None:
        _stable_state(scene, solver, soft, report)
        if moves:
            reached = _add_friction(scene, solver, slipping, state, climb)
    side = side if reached is None else reached
    if climb and moves and not side:
        state.warnings.append(
            "friction across the pipe found no rest (a turning pipe may whirl here): "
            "its torque acts, its side push is left out"
        )
    for room in slipping:  # inertia is a question to the frictionless part
        room.impose_sliding(0.0, 0.0)
    solver.energy = _conservative(scene)
    report.negative_pivots = max(0, solver.negative_pivots()) if solver.energy else 0
    for room in slipping:
        room.impose_sliding(*motion, side)
    agree(scene, solver, report)
    _reactions(scene, solver)
    scene.model.assembly.freeze(None)
    if report.negative_pivots:
        state.warnings.append(_why_unstable(scene, report.negative_pivots))
    return state


def _settle_at_once(scene: Scene, solver: Statics, rooms, state: StaticState, side: float) -> float | None:
    """Newton with friction from the soft string, which has it already, first without side push; returns the share of
    side push that it could keep.  None, and all as before, without a stable state."""
    keep, reached = _Place(scene), None
    for share in sorted({side if state.motion[1] else 1.0, 0.0 if state.motion[1] else 1.0}):
        here = _Place(scene)
        for room in rooms:
            room.impose_sliding(*state.motion, share)
        try:
            solver.settle_near(state.equilibrium)
            reached = share
        except SolveError:
            here.restore()
            break
    for room in rooms:
        room.impose_sliding(0.0, 0.0)
    if reached is not None and not (solver.energy and solver.negative_pivots()):
        return reached
    keep.restore()
    return None


def _add_friction(scene: Scene, solver: Statics, rooms, state: StaticState, climb: bool) -> float:
    """Equilibrium with friction against the motion from the frictionless one; returns the share of side push that it
    could keep."""
    keep, side = _Place(scene), 1.0 if climb else 0.0
    for room in rooms:
        room.impose_sliding(*state.motion, side)
    try:
        solver.settle_near(state.equilibrium)
        return side
    except SolveError:
        keep.restore()
    _friction_by_substitution(scene, solver, rooms, state)
    keep = _Place(scene)
    if side and state.motion[1]:
        for room in rooms:
            room.impose_sliding(*state.motion, side)
        try:
            solver.settle_near(state.equilibrium)
            return side
        except SolveError:
            keep.restore()
    return 0.0 if state.motion[1] else side


def _friction_by_substitution(scene: Scene, solver: Statics, rooms, state: StaticState) -> None:
    """Friction along and about the pipe as dead load, renewed until it no longer changes: every solve has a potential
    to descend."""
    asm, model, motion, report, soft = (
        scene.model.assembly,
        scene.model,
        state.motion,
        state.equilibrium,
        state.soft_string,
    )
    imperfection = asm.dead
    fixed = 0.0 if imperfection is None else imperfection
    last, weight = np.zeros(model.layout.size), float(nodal_weight(scene).sum())
    change, factors = np.inf, _stiffness_steps(scene, soft)
    try:
        for _ in range(SUBSTITUTIONS):
            asm.dead = None
            for room in rooms:
                room.impose_sliding(*motion, 0.0)
            with_friction = solver.rows()
            for room in rooms:
                room.impose_sliding(0.0, 0.0)
            friction = solver.rows() - with_friction
            change = solver.largest(float(np.max(np.abs(friction - last), initial=0.0)))
            if change < 1e-7 * weight:
                return
            asm.dead = fixed + friction
            _newton_or_descent(scene, solver, report, factors)
            last, factors = friction, (1.0,)
        raise SolveError(
            f"friction did not settle in {SUBSTITUTIONS} rounds (last change {change:.3g} N)", **model.worst_place(0.0)
        )
    finally:
        asm.dead = imperfection


class _Place:
    """The state and the top's position, to come back to."""

    def __init__(self, scene: Scene):
        self.scene, self.x = scene, scene.model.assembly.x.copy()
        self.top = None if scene.top is None else scene.top.anchor.copy()

    def restore(self) -> None:
        self.scene.model.assembly.x[:] = self.x
        if self.scene.top is not None:
            self.scene.top.anchor[:] = self.top


def _solver(scene: Scene) -> Statics:
    return Statics(scene.model, energy=_conservative(scene), clearance=_clearance(scene))


def _conservative(scene: Scene) -> bool:
    """Whether all loads have a potential: moments in space and loads that turn with the section have none."""
    for room in scene.rooms:
        for load in getattr(room, "loads", ()):
            if load.section or any(load.moment):
                return False
    return True


def _clearance(scene: Scene) -> float | None:
    if scene.well is None or scene.contact is None:
        return None
    middle = 0.5 * (scene.mesh.upper + scene.mesh.lower)
    room = np.asarray(scene.well.radius(middle)) - 0.5 * scene.mesh.outer_diameter
    return float(max(1e-3, np.min(room[scene.mesh.outer_diameter > 0], initial=0.1)))


def _ask_for_weight(scene: Scene, solver: Statics, wob: float) -> None:
    bit, top = scene.bit, scene.top
    if bit is None:
        raise CaseError(at="initial.wob", got=f"{wob:g} N", want="a bottom of kind bit, on which the weight can stand")
    if top is None or not hasattr(top, "shift") or getattr(scene.case.top, "force", None) is not None:
        raise CaseError(
            at="initial.wob",
            got=f"{wob:g} N",
            want="a top with a prescribed axial position (top_drive, driven, clamped, pinned)",
        )
    target = bit.depth_for(wob)

    def depth(model):
        here, gradient = bit.depth_of_face(model.assembly)
        return here, gradient, target

    solver.depth, solver.move_top = depth, top.shift


def _stable_state(scene: Scene, solver: Statics, soft: TorqueDrag | None, report: Equilibrium) -> None:
    """Newton where it finds a stable state, else down the energy; from a saddle a small persistent side load leads
    away."""
    fraction = scene.case.initial.imperfection
    factors = _stiffness_steps(scene, soft)
    if not solver.energy:
        solver.settle(report)
        return
    try:
        _newton_or_descent(scene, solver, report, factors, TRIAL if fraction else ITERATIONS)
        failure = SolveError("the static state is unstable") if solver.negative_pivots() else None
    except SolveError as error:
        failure = error
    if failure is None:
        return
    if not fraction or _too_coarse(scene):
        if report.converged:
            return
        raise failure
    # on the saddle of a straight column nothing points sideways: a small persistent load does
    solver.push_aside(fraction, nodal_weight(scene) * _own_imperfection(scene, fraction))
    report.imperfection = fraction
    _descend(scene, solver, report, factors)


def _own_imperfection(scene: Scene, fraction: float) -> FloatArray:
    """(n_nodes,) factor on ``fraction`` where a string item asks for an imperfection of its own."""
    mesh, factor = scene.mesh, np.ones(scene.mesh.nodes)
    for e, number in enumerate(mesh.item):
        own = getattr(scene.case.string[number], "initial", None)
        if own is not None:
            factor[e : e + 2] = own.imperfection / fraction
    return factor


def _newton_or_descent(
    scene: Scene, solver: Statics, report: Equilibrium, factors: tuple[float, ...], most: int = ITERATIONS
) -> None:
    """Full Newton steps, or descent where they do not converge; may end in an unstable state."""
    keep = _Place(scene)
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


def _stiffness_steps(scene: Scene, soft: TorqueDrag | None) -> tuple[float, ...]:
    """Factors on the contact stiffness, rising to 1: at the first the most loaded part sinks in by a share of its
    radial room.

    Loads: weight, side load of the soft string, and r F^2/4EI of a helix under the largest compression F (Lubinski,
    Althouse and Logan, JPT 14(6), 1962).
    """
    room, contact, mesh = _clearance(scene), scene.case.contact, scene.mesh
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


def _too_coarse(scene: Scene) -> bool:
    """Elements longer than their bending can hold against the axial load of their weight: L^3 > 240 EI/w (model,
    section 9.4)."""
    return bool(coarse_elements(scene).any())


def coarse_elements(scene: Scene) -> np.ndarray:
    """(n,) elements above the limit L^3 > 240 EI/w."""
    mesh = scene.mesh
    w = mesh.mass * np.linalg.norm(scene.case.gravity)
    return mesh.length**3 * w > 240 * mesh.bending_stiffness


def _why_unstable(scene: Scene, count: int) -> str:
    if _too_coarse(scene):
        n = int(coarse_elements(scene).sum())
        return (
            f"{count} negative pivots: the mesh is too coarse ({n} elements longer than (240 EI/w)^(1/3)), "
            "which is not buckling; "
            "shorten element_length"
        )
    return f"the static state is unstable ({count} negative pivots)"


def _reactions(scene: Scene, solver: Statics) -> None:
    """One residual at the final state, so that reactions stand in the assembly."""
    solver.rows()


def release(scene: Scene) -> None:
    """From statics to motion: friction follows the motion from now on."""
    for room in (scene.contact, scene.bit):
        if room is not None:
            room.free_sliding()
