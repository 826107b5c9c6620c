"""How a scene starts: along the hole, straight, or in static equilibrium with friction against a given
motion."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from drillpetsc.analysis.coupled import couple_flow_and_string, freeze_flow, release_flow
from drillpetsc.analysis.energy_descent import (
    SUBSTITUTIONS,
    Snapshot,
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
from drillpetsc.analysis.soft_string_start import soft_string_start
from drillpetsc.analysis.steady_flow import place_fluid, steady_flow
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.physics.quaternion.beam import QuaternionBeam
from drillpetsc.solvers.static_newton import Equilibrium, StaticNewton

MOTIONS = {"hoist": (-1.0, 0.0), "lower": (1.0, 0.0), "rotate": (0.0, 1.0)}


@dataclass
class StaticState:
    """Result of ``find_equilibrium``; the state itself is in the scene's model.

    motion: axial velocity [m/s, down positive] and rotation [rad/s] that friction opposes; side: share of the
    side push of friction that the state could keep; stable: no negative pivot.
    """

    motion: tuple[float, float]
    equilibrium: Equilibrium
    soft_string: TorqueDrag | None = None
    warnings: list[str] = field(default_factory=list)
    side: float = 1.0

    @property
    def stable(self) -> bool:
        return self.equilibrium.negative_pivots == 0


def prescribed_motion(model: DrillingModel) -> tuple[float, float]:
    """Axial velocity (down positive) and rotation that the top prescribes at time 0."""
    top = model.case.top
    lowering = top.lowering if top.force is None else None
    rotation = top.rotation
    return (lowering.value(0.0) if lowering is not None else 0.0), (
        rotation.value(0.0) if rotation is not None else 0.0
    )


def place_along_hole(model: DrillingModel) -> None:
    """The unstrained string along the hole's axis (or straight, without a hole), at rest."""
    m = model.system
    if isinstance(model.beam, QuaternionBeam):
        place(model)
    elif model.beam is not None:
        m.set_field("string.position", model.position)
        m.set_field("string.tangent", model.tangent)
        m.set_field("string.spin", np.zeros((m.mesh.nodes, 1)))
    if "string.ratio" in m.layout.dofs:
        m.set_field("string.ratio", np.ones((m.mesh.nodes, 1)))
    for name in ("joint.load", "joint.correction"):
        if name in m.layout.dofs:
            m.set_field(name, np.zeros((m.mesh.nodes, 6)))
    m.assembly.y[:] = 0.0
    m.assembly.a[:] = 0.0
    if model.fluid is not None:
        place_fluid(m, model.fluid)


def move_rigidly(model: DrillingModel) -> None:
    """Give every node the spin and lowering that the top prescribes at time 0 (the state at rest before)."""
    if model.beam is None:
        release_flow(model)
        return
    m = model.system
    lowering, rotation = prescribed_motion(model)
    if isinstance(model.beam, QuaternionBeam):
        move(model, lowering, rotation)
    else:
        tangent = model.tangent if model.well is None else model.well.at(model.mesh.node_depth)[1]
        m.set_field("string.position", lowering * np.asarray(tangent), "y")
        m.set_field("string.tangent", np.zeros((m.mesh.nodes, 3)), "y")
        m.set_field("string.spin", np.full((m.mesh.nodes, 1), rotation), "y")
    if model.drilling is not None:
        model.drilling.first_cut(m.assembly)
    release_flow(model)


def find_equilibrium(
    model: DrillingModel, motion: tuple[float, float] | None = None, climb: bool = True
) -> StaticState:
    """Static equilibrium of the scene, friction opposing ``motion`` (by default what the top prescribes at
    time 0).

    First without friction, to a stable state; then friction is added at once.  climb: friction across the
    pipe pushes it up the wall of the hole, as it does with a turning pipe at rest there; without, only its
    torque acts, as torque-and-drag models have it. Raises SolveError when no equilibrium is found.
    """
    if isinstance(model.beam, QuaternionBeam):
        return equilibrium(model, motion, climb)
    lowering = prescribed_motion(model)[0] if motion is None else 0.0
    motion = prescribed_motion(model) if motion is None else motion
    place_along_hole(model)
    if model.beam is None:
        flow = steady_flow(model.system)
        return StaticState(
            (0.0, 0.0), Equilibrium(iterations=flow.iterations, increment=flow.increment, converged=True)
        )
    freeze_flow(model)
    soft = soft_string_start(model, motion)
    solver = _solver(model)
    wob = model.case.initial.wob
    if wob is not None:
        _ask_for_weight(model, solver, wob)
    slipping = [r for r in (model.contact, model.bit) if r is not None]
    for component in slipping:
        component.impose_sliding_direction(0.0, 0.0)
    report = Equilibrium()
    state, side = StaticState(motion, report, soft), 1.0 if climb else 0.0
    moves = bool(slipping) and motion != (0.0, 0.0)
    reached = _settle_at_once(model, solver, slipping, state, side) if moves and soft is not None else None
    if reached is None:
        stable_state(model, solver, soft, report)
        if moves:
            reached = _add_friction(model, solver, slipping, state, climb)
    side = state.side = side if reached is None else reached
    if climb and moves and not side:
        state.warnings.append(
            "friction across the pipe found no rest (a turning pipe may whirl here): "
            "its torque acts, its side push is left out"
        )
    for component in slipping:  # inertia is a question to the frictionless part
        component.impose_sliding_direction(0.0, 0.0)
    solver.energy = _conservative(model)
    report.negative_pivots = max(0, solver.negative_pivots()) if solver.energy else 0
    for component in slipping:
        component.impose_sliding_direction(*motion, side)
    couple_flow_and_string(model, solver, report, lowering)
    _reactions(model, solver)
    model.system.assembly.freeze(None)
    if report.negative_pivots:
        state.warnings.append(_why_unstable(model, report.negative_pivots))
    return state


def _settle_at_once(
    model: DrillingModel, solver: StaticNewton, components, state: StaticState, side: float
) -> float | None:
    """Newton with friction from the soft string, which has it already, first without side push; returns the
    share of side push that it could keep.  None, and all as before, without a stable state."""
    keep, reached = Snapshot(model), None
    for share in sorted({side if state.motion[1] else 1.0, 0.0 if state.motion[1] else 1.0}):
        here = Snapshot(model)
        for component in components:
            component.impose_sliding_direction(*state.motion, share)
        try:
            solver.newton_damped(state.equilibrium)
            reached = share
        except SolveError:
            here.restore()
            break
    for component in components:
        component.impose_sliding_direction(0.0, 0.0)
    if reached is not None and not (solver.energy and solver.negative_pivots()):
        return reached
    keep.restore()
    return None


def _add_friction(
    model: DrillingModel, solver: StaticNewton, components, state: StaticState, climb: bool
) -> float:
    """Equilibrium with friction against the motion from the frictionless one; returns the share of side push
    that it could keep."""
    keep, side = Snapshot(model), 1.0 if climb else 0.0
    for component in components:
        component.impose_sliding_direction(*state.motion, side)
    try:
        solver.newton_damped(state.equilibrium)
        return side
    except SolveError:
        keep.restore()
    _friction_by_substitution(model, solver, components, state)
    keep = Snapshot(model)
    if side and state.motion[1]:
        for component in components:
            component.impose_sliding_direction(*state.motion, side)
        try:
            solver.newton_damped(state.equilibrium)
            return side
        except SolveError:
            keep.restore()
    return 0.0 if state.motion[1] else side


def _friction_by_substitution(
    model: DrillingModel, solver: StaticNewton, components, state: StaticState
) -> None:
    """Friction along and about the pipe as dead load, renewed until it no longer changes: every solve has a
    potential to descend."""
    asm, system, motion, report, soft = (
        model.system.assembly,
        model.system,
        state.motion,
        state.equilibrium,
        state.soft_string,
    )
    imperfection = asm.dead_load
    fixed = 0.0 if imperfection is None else imperfection
    last, weight = np.zeros(system.layout.size), float(nodal_weight(model).sum())
    change, factors = np.inf, stiffness_steps(model, soft)
    try:
        for _ in range(SUBSTITUTIONS):
            asm.dead_load = None
            for component in components:
                component.impose_sliding_direction(*motion, 0.0)
            with_friction = solver.rows()
            for component in components:
                component.impose_sliding_direction(0.0, 0.0)
            friction = solver.rows() - with_friction
            change = solver.largest(float(np.max(np.abs(friction - last), initial=0.0)))
            if change < 1e-7 * weight:
                return
            asm.dead_load = fixed + friction
            newton_or_descent(model, solver, report, factors)
            last, factors = friction, (1.0,)
        raise SolveError(
            f"friction did not settle in {SUBSTITUTIONS} rounds (last change {change:.3g} N)",
            **system.locate_largest_residual(0.0),
        )
    finally:
        asm.dead_load = imperfection


def _solver(model: DrillingModel) -> StaticNewton:
    return StaticNewton(model.system, energy=_conservative(model), clearance=clearance(model))


def _conservative(model: DrillingModel) -> bool:
    """Whether all loads have a potential: moments in space and loads that turn with the section have none."""
    for component in model.components:
        for load in getattr(component, "loads", ()):
            if load.section or any(load.moment):
                return False
    return True


def _ask_for_weight(model: DrillingModel, solver: StaticNewton, wob: float) -> None:
    bit, top = model.bit, model.top
    if bit is None:
        raise CaseError(
            at="initial.wob", got=f"{wob:g} N", want="a bottom of kind bit, on which the weight can stand"
        )
    if top is None or not hasattr(top, "shift") or model.case.top.force is not None:
        raise CaseError(
            at="initial.wob",
            got=f"{wob:g} N",
            want="a top with a prescribed axial position (top_drive, driven, clamped, pinned)",
        )
    target = bit.depth_for(wob)

    def depth(system):
        here, gradient = bit.depth_of_face(system.assembly)
        return here, gradient, target

    solver.depth, solver.move_top = depth, top.shift


def _why_unstable(model: DrillingModel, count: int) -> str:
    if too_coarse(model):
        n = int(coarse_elements(model).sum())
        return (
            f"{count} negative pivots: the mesh is too coarse ({n} elements longer than (240 EI/w)^(1/3)), "
            "which is not buckling; "
            "shorten element_length"
        )
    return f"the static state is unstable ({count} negative pivots)"


def _reactions(model: DrillingModel, solver: StaticNewton) -> None:
    """One residual at the final state, so that reactions stand in the assembly."""
    solver.rows()


def release(model: DrillingModel) -> None:
    """From statics to motion: friction follows the motion from now on."""
    for component in (model.contact, model.bit):
        if component is not None:
            component.release_sliding_direction()
