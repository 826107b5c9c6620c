"""How a scene starts: along the hole, straight, or in static equilibrium with friction against a given motion."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from drillpetsc.analysis.coupled import agree, begin_flow, let_flow
from drillpetsc.analysis.energy_descent import (
    SUBSTITUTIONS,
    Place,
    clearance,
    coarse_elements,
    newton_or_descent,
    nodal_weight,
    stable_state,
    stiffness_steps,
    too_coarse,
)
from drillpetsc.analysis.quaternion_statics import equilibrium, move, place
from drillpetsc.analysis.soft_string import TorqueDrag
from drillpetsc.analysis.soft_string_start import soft_string_guess
from drillpetsc.analysis.steady_flow import place_fluid, steady_flow
from drillpetsc.case.blocks.ends import DrivenTop
from drillpetsc.case.blocks.ends import TopDrive as TopDriveCase
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.model.drilling_model import Scene
from drillpetsc.physics.quaternion.beam import QuaternionBeam
from drillpetsc.solvers.static_newton import Equilibrium, Statics

MOTIONS = {"hoist": (-1.0, 0.0), "lower": (1.0, 0.0), "rotate": (0.0, 1.0)}


@dataclass
class StaticState:
    """Result of ``find_equilibrium``; the state itself is in the scene's model.

    motion: axial velocity [m/s, down positive] and rotation [rad/s] that friction opposes; side: share of the side push of friction that
    the state could keep; stable: no negative pivot.
    """

    motion: tuple[float, float]
    equilibrium: Equilibrium
    soft_string: TorqueDrag | None = None
    warnings: list[str] = field(default_factory=list)
    side: float = 1.0

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
    if isinstance(scene.beam, QuaternionBeam):
        place(scene)
    elif scene.beam is not None:
        m.set_field("string.position", scene.position)
        m.set_field("string.tangent", scene.tangent)
        m.set_field("string.spin", np.zeros((m.mesh.nodes, 1)))
    if "string.ratio" in m.layout.place:
        m.set_field("string.ratio", np.ones((m.mesh.nodes, 1)))
    for name in ("joint.load", "joint.correction"):
        if name in m.layout.place:
            m.set_field(name, np.zeros((m.mesh.nodes, 6)))
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
    if isinstance(scene.beam, QuaternionBeam):
        move(scene, lowering, rotation)
    else:
        tangent = scene.tangent if scene.well is None else scene.well.at(scene.mesh.node_depth)[1]
        m.set_field("string.position", lowering * np.asarray(tangent), "y")
        m.set_field("string.tangent", np.zeros((m.mesh.nodes, 3)), "y")
        m.set_field("string.spin", np.full((m.mesh.nodes, 1), rotation), "y")
    if scene.drilling is not None:
        scene.drilling.first_cut(m.assembly)
    let_flow(scene)


def find_equilibrium(scene: Scene, motion: tuple[float, float] | None = None, climb: bool = True) -> StaticState:
    """Static equilibrium of the scene, friction opposing ``motion`` (by default what the top prescribes at time 0).

    First without friction, to a stable state; then friction is added at once.  climb: friction across the pipe pushes
    it up the wall of the hole, as it does with a turning pipe at rest there; without, only its torque acts, as
    torque-and-drag models have it. Raises SolveError when no equilibrium is found.
    """
    if isinstance(scene.beam, QuaternionBeam):
        return equilibrium(scene, motion, climb)
    lowering = prescribed_motion(scene)[0] if motion is None else 0.0
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
        stable_state(scene, solver, soft, report)
        if moves:
            reached = _add_friction(scene, solver, slipping, state, climb)
    side = state.side = side if reached is None else reached
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
    agree(scene, solver, report, lowering)
    _reactions(scene, solver)
    scene.model.assembly.freeze(None)
    if report.negative_pivots:
        state.warnings.append(_why_unstable(scene, report.negative_pivots))
    return state


def _settle_at_once(scene: Scene, solver: Statics, rooms, state: StaticState, side: float) -> float | None:
    """Newton with friction from the soft string, which has it already, first without side push; returns the share of
    side push that it could keep.  None, and all as before, without a stable state."""
    keep, reached = Place(scene), None
    for share in sorted({side if state.motion[1] else 1.0, 0.0 if state.motion[1] else 1.0}):
        here = Place(scene)
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
    keep, side = Place(scene), 1.0 if climb else 0.0
    for room in rooms:
        room.impose_sliding(*state.motion, side)
    try:
        solver.settle_near(state.equilibrium)
        return side
    except SolveError:
        keep.restore()
    _friction_by_substitution(scene, solver, rooms, state)
    keep = Place(scene)
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
    change, factors = np.inf, stiffness_steps(scene, soft)
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
            newton_or_descent(scene, solver, report, factors)
            last, factors = friction, (1.0,)
        raise SolveError(
            f"friction did not settle in {SUBSTITUTIONS} rounds (last change {change:.3g} N)", **model.worst_place(0.0)
        )
    finally:
        asm.dead = imperfection


def _solver(scene: Scene) -> Statics:
    return Statics(scene.model, energy=_conservative(scene), clearance=clearance(scene))


def _conservative(scene: Scene) -> bool:
    """Whether all loads have a potential: moments in space and loads that turn with the section have none."""
    for room in scene.rooms:
        for load in getattr(room, "loads", ()):
            if load.section or any(load.moment):
                return False
    return True


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


def _why_unstable(scene: Scene, count: int) -> str:
    if too_coarse(scene):
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
