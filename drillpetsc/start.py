"""How a scene starts: along the hole, straight, or in static equilibrium with friction against a given motion."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from drillpetsc.case.ends import DrivenTop
from drillpetsc.case.ends import TopDrive as TopDriveCase
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.field import FloatArray
from drillpetsc.scene import Scene
from drillpetsc.soft_string import TorqueDrag, torque_drag
from drillpetsc.solve.statics import Equilibrium, Statics

SUBSTITUTIONS = 30
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
    m.set_field("string.position", scene.position)
    m.set_field("string.tangent", scene.tangent)
    m.set_field("string.spin", np.zeros((m.mesh.nodes, 1)))
    if "string.ratio" in m.layout.place:
        m.set_field("string.ratio", np.ones((m.mesh.nodes, 1)))
    m.assembly.y[:] = 0.0
    m.assembly.a[:] = 0.0


def move_rigidly(scene: Scene) -> None:
    """Give every node the spin and lowering that the top prescribes at time 0 (the state at rest before)."""
    m = scene.model
    lowering, rotation = prescribed_motion(scene)
    tangent = scene.tangent if scene.well is None else scene.well.at(scene.mesh.node_depth)[1]
    m.set_field("string.position", lowering * np.asarray(tangent), "y")
    m.set_field("string.tangent", np.zeros((m.mesh.nodes, 3)), "y")
    m.set_field("string.spin", np.full((m.mesh.nodes, 1), rotation), "y")


def nodal_weight(scene: Scene) -> FloatArray:
    """(n_nodes,) weight that each node carries [N]."""
    mesh, g = scene.mesh, float(np.linalg.norm(scene.case.gravity))
    weight = np.zeros(mesh.nodes)
    half = 0.5 * mesh.mass * mesh.length * g
    np.add.at(weight, np.arange(mesh.nodes - 1), half)
    np.add.at(weight, np.arange(1, mesh.nodes), half)
    for b in mesh.bodies:
        weight[b.node] += b.mass * g
    return weight


def find_equilibrium(scene: Scene, motion: tuple[float, float] | None = None) -> StaticState:
    """Static equilibrium of the scene, friction opposing ``motion`` (by default what the top prescribes at time 0).

    First without friction, to a stable state; then friction is added at once.  Raises SolveError when no equilibrium is found.
    """
    motion = prescribed_motion(scene) if motion is None else motion
    place_along_hole(scene)
    soft = _guess(scene, motion) if scene.contact is not None else None
    solver = _solver(scene)
    wob = scene.case.initial.wob
    if wob is not None:
        _ask_for_weight(scene, solver, wob)
    slipping = [r for r in (scene.contact, scene.bit) if r is not None]
    for room in slipping:
        room.impose_sliding(0.0, 0.0)
    report = _stable_state(scene, solver)
    state, side = StaticState(motion, report, soft), 1.0
    if slipping and motion != (0.0, 0.0):
        side = _add_friction(scene, solver, slipping, motion, report)
        if not side:
            state.warnings.append("friction across the pipe finds no rest (it would drive a whirl): its torque acts, its side push is left out")
    for room in slipping:  # inertia is a question to the frictionless part
        room.impose_sliding(0.0, 0.0)
    solver.energy = _conservative(scene)
    report.negative_pivots = max(0, solver.negative_pivots()) if solver.energy else 0
    for room in slipping:
        room.impose_sliding(*motion, side)
    _reactions(scene, solver)
    if report.negative_pivots:
        state.warnings.append(_why_unstable(scene, report.negative_pivots))
    return state


def _add_friction(scene: Scene, solver: Statics, rooms, motion: tuple[float, float], report: Equilibrium) -> float:
    """Equilibrium with friction against ``motion`` from the frictionless one; returns the share of side push that it could keep."""
    start = scene.model.assembly.x.copy()
    for side in (1.0, 0.0):
        for room in rooms:
            room.impose_sliding(*motion, side)
        try:
            solver.settle_near(report)
            return side
        except SolveError:
            scene.model.assembly.x[:] = start
    _friction_by_substitution(scene, solver, rooms, motion, report)
    return 0.0


def _friction_by_substitution(scene: Scene, solver: Statics, rooms, motion: tuple[float, float], report: Equilibrium) -> None:
    """Friction as dead load, renewed until it no longer changes: slower than Newton, but every solve has a potential to descend."""
    asm, model = scene.model.assembly, scene.model
    imperfection = asm.dead
    fixed = 0.0 if imperfection is None else imperfection
    last, weight = np.zeros(model.layout.size), float(nodal_weight(scene).sum())
    try:
        for _ in range(SUBSTITUTIONS):
            asm.dead = None
            for room in rooms:
                room.impose_sliding(*motion, 0.0)
            with_friction = solver.rows()
            for room in rooms:
                room.impose_sliding(0.0, 0.0)
            friction = solver.rows() - with_friction
            asm.dead = fixed + friction
            solver.settle(report)
            change = solver.largest(float(np.max(np.abs(friction - last), initial=0.0)))
            last = friction
            if change < 1e-7 * weight:
                return
        raise SolveError(f"friction did not settle in {SUBSTITUTIONS} rounds (last change {change:.3g} N)", **model.worst_place(0.0))
    finally:
        asm.dead = imperfection


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
        raise CaseError(at="initial.wob", got=f"{wob:g} N", want="a top with a prescribed axial position (top_drive, driven, clamped, pinned)")
    target = bit.depth_for(wob)

    def depth(model):
        here, gradient = bit.depth_of_face(model.assembly)
        return here, gradient, target

    solver.depth, solver.move_top = depth, top.shift


def _stable_state(scene: Scene, solver: Statics) -> Equilibrium:
    fraction = scene.case.initial.imperfection
    report = Equilibrium()
    try:
        solver.settle(report)
        unstable = solver.energy and solver.negative_pivots() > 0
    except SolveError:
        unstable = True
        if not fraction or not solver.energy:
            raise
    if unstable and fraction and solver.energy and not _too_coarse(scene):
        # on the saddle of a straight column nothing points sideways: a small persistent load does
        solver.push_aside(fraction, nodal_weight(scene))
        report.imperfection = fraction
        solver.settle(report)
    return report


def _too_coarse(scene: Scene) -> bool:
    """Elements longer than their bending can hold against the axial load of their weight: L^3 > 240 EI/w (model, section 9.4)."""
    return bool(coarse_elements(scene).any())


def coarse_elements(scene: Scene) -> np.ndarray:
    """(n,) elements above the limit L^3 > 240 EI/w."""
    mesh = scene.mesh
    w = mesh.mass * np.linalg.norm(scene.case.gravity)
    return mesh.length**3 * w > 240 * mesh.bending_stiffness


def _why_unstable(scene: Scene, count: int) -> str:
    if _too_coarse(scene):
        n = int(coarse_elements(scene).sum())
        return (f"{count} negative pivots: the mesh is too coarse ({n} elements longer than (240 EI/w)^(1/3)), which is not buckling; "
                "shorten element_length")
    return f"the static state is unstable ({count} negative pivots)"


def _guess(scene: Scene, motion: tuple[float, float]) -> TorqueDrag | None:
    """Soft string: stretch, twist and the side of the hole the string lies on."""
    mesh, well, case = scene.mesh, scene.well, scene.case
    gravity = np.array(case.gravity)
    g = float(np.linalg.norm(gravity))
    if gravity[0] or gravity[1] or g == 0:
        return None
    depth = mesh.node_depth
    wob = case.initial.wob or 0.0
    hung = sum(b.mass for b in mesh.bodies if b.node == mesh.nodes - 1) * g
    force = getattr(case.top, "force", None)
    soft = torque_drag(well, depth, mesh.mass * g, 0.5 * mesh.outer_diameter, mesh.axial_stiffness, mesh.torsional_stiffness,
                       bottom_force=hung - wob, axial_velocity=-motion[0], rotation=motion[1])
    clearance = np.asarray(well.radius(depth)) - 0.5 * np.append(mesh.outer_diameter, mesh.outer_diameter[-1])
    deep = np.maximum(clearance, 0.0) + soft.contact_force / case.contact.stiffness if case.contact.law == "linear" else np.maximum(clearance, 0.0)
    top_moves = 0.0
    if case.initial.wob is not None and scene.bit is not None:
        top_moves = _hole_end(scene) - (mesh.total_length + soft.stretch)
        scene.top.shift(top_moves)
    if force is not None:
        top_moves = 0.0
    centre, tangent, _ = well.at(depth + soft.elongation + top_moves)
    strain = np.concatenate([[soft.axial_force[0] / mesh.axial_stiffness[0]],
                             soft.axial_force[1:] / mesh.axial_stiffness])
    m = scene.model
    m.set_field("string.position", centre + deep[:, None] * soft.side)
    m.set_field("string.tangent", (1 + strain)[:, None] * tangent)
    return soft


def _hole_end(scene: Scene) -> float:
    from drillpetsc.scene import hole_depth

    return hole_depth(scene.case)


def _reactions(scene: Scene, solver: Statics) -> None:
    """One residual at the final state, so that reactions stand in the assembly."""
    solver.rows()


def release(scene: Scene) -> None:
    """From statics to motion: friction follows the motion from now on."""
    for room in (scene.contact, scene.bit):
        if room is not None:
            room.free_sliding()
