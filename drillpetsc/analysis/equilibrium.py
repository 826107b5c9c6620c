"""Static equilibrium of the ANCF string with friction against a given motion, coupled with the steady flow."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

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
from drillpetsc.analysis.placement import place_along_hole, prescribed_motion
from drillpetsc.analysis.soft_string import TorqueDrag
from drillpetsc.analysis.soft_string_start import soft_string_start
from drillpetsc.analysis.steady_flow import fluid_unknowns, freeze_flow, steady_flow
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.solvers.static_newton import Equilibrium, StaticNewton

ROUNDS = 30  # of string and flow in turn
AGREED = 1e-10  # change of pressures and flows relative to their scales
NEARLY = 1e-6  # enough when rounding stops the rounds
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


def director_equilibrium(
    model: DrillingModel, motion: tuple[float, float] | None = None, climb: bool = True
) -> StaticState:
    """Static equilibrium of the scene, friction opposing ``motion`` (by default what the top prescribes at
    time 0).

    First without friction, to a stable state; then friction is added at once.  climb: friction across the
    pipe pushes it up the wall of the hole, as it does with a turning pipe at rest there; without, only its
    torque acts, as torque-and-drag models have it. Raises SolveError when no equilibrium is found.
    """
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
    return all(component.conservative for component in model.components)


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


def couple_flow_and_string(
    model: DrillingModel, solver: StaticNewton, report: Equilibrium, lowering: float = 0.0
) -> None:
    """Steady flow and string in turn, from a string in equilibrium under the frozen flow; raises SolveError
    where they do not settle.

    lowering: speed at which the top lets the string down [m/s]; the mud then flows as it does about the
    moving string (surge). The rounds converge by the ratio of what the fluid and what the steel gives way, a
    few percent.
    """
    if model.fluid is None:
        return
    system = model.system
    on_rank, best = fluid_unknowns(system), np.inf
    form = model.case.fluid.formulation  # type: ignore[union-attr]
    if lowering and form == "mixed":  # the flow of the other starts as the pump's
        place = system.layout.dofs["string.position"]
        tangent = model.tangent if model.well is None else np.asarray(model.well.at(model.mesh.node_depth)[1])
        solver.rates = np.zeros_like(system.assembly.y)
        solver.rates[place] = lowering * tangent[system.chain.vertices]
        system.assembly.y[:] = solver.rates
    for _ in range(ROUNDS):
        before = system.assembly.x[: system.layout.size][on_rank].copy()
        steady_flow(system, 0.0)
        change = np.abs(system.assembly.x[: system.layout.size][on_rank] - before) / system.scale[on_rank]
        size = solver.largest(float(change.max(initial=0.0)))
        system.assembly.freeze(on_rank)
        if size < AGREED or (size < NEARLY and size > 0.5 * best):
            return
        best = min(best, size)
        solver.newton_damped(report)
    raise SolveError(
        f"string and fluid did not agree on a steady state in {ROUNDS} rounds (last change {size:.1e} of the scales)"
    )
