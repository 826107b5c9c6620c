"""Paths of a static problem: the string's steps in its hole, and the state at the end of a path as the problem's result.

Manual: sec-statics-path.
"""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.statics.flow_coupling import surge_rates
from drillpetsc.analysis.statics.path.friction_path import SEED, FrictionPath, follow_paths
from drillpetsc.analysis.statics.path.path_answer import PathAnswer, PathKind
from drillpetsc.analysis.statics.placement import top_depth
from drillpetsc.analysis.statics.static_problem import StaticProblem
from drillpetsc.arrays import FloatArray
from drillpetsc.errors import SolveError
from drillpetsc.geometry.hole_steps import HoleSteps
from drillpetsc.geometry.well import Well
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.physics.tools.mud_motor import MudMotor
from drillpetsc.physics.tools.reamer import Reamer

LEAST_CLEARANCE = 1e-3  # [m]


def answer_by_path(problem: StaticProblem, kind: PathKind) -> None:
    """Find the state of a string with friction at the end of a path, and what other starts give.

    Raises SolveError if the path has no end.
    """
    path = _path(problem, kind)
    _take(problem, follow_paths(path, ("straight", "overload") if kind == "sliding" else ("straight",)), SEED)


def slides_on(problem: StaticProblem) -> bool:
    """Let a string that slides move on from the present state, which friction along the hole alone does not hold; collective.

    A buckle may roll along the wall for ever, slowly, while the string slides: with friction exactly along the hole it has
    no equilibrium, although force and shape stay.  Returns whether the string slides steadily; the state is the former one
    if it does not.
    """
    model, state = problem.model, problem.state
    assert problem.straight is not None
    largest_push = -float(problem.straight.axial_force.min())
    if (
        not any(state.motion)
        or bool(model.parts(MudMotor))
        or largest_push <= 0
        or model.parts(Reamer)  # the shares of bit and reamer are not those of a path
        or not _wall_rubs(model)
    ):
        return False
    if state.motion[1] and problem.fraction > 0:
        return False  # a turning string has no path with friction across the hole
    restore = problem.save()
    path = _path(problem, "sliding")
    try:
        end = path.follow_on(largest_push)
        if end.steady:
            _take(problem, path.answer((end,)), state.equilibrium.imperfection)
            return True
    except SolveError:
        pass
    restore()
    return False


def _wall_rubs(model: DrillingModel) -> bool:
    """Whether the wall has friction anywhere: without it motion changes nothing."""
    own = np.append(
        model.mesh.friction, [np.nan if b.friction is None else b.friction for b in model.mesh.bodies]
    )
    sections = () if model.case.well is None else model.case.well.sections
    law = model.contact.law.own if model.contact is not None else None
    return law is not None or any(s.friction for s in sections) or bool((own[np.isfinite(own)] > 0).any())


def _path(problem: StaticProblem, kind: PathKind) -> FrictionPath:
    model = problem.model
    surge = surge_rates(model, problem.lowering)
    problem.solver.rates, model.system.assembly.y[:] = None, 0.0  # the path has its own surge
    return FrictionPath(model, kind, problem.solver, problem.state.motion, surge)


def _take(problem: StaticProblem, answer: PathAnswer, imperfection: float) -> None:
    """Make the answer of a path the result of the problem."""
    state, end = problem.state, answer.ends[0]
    state.path, report = answer, state.equilibrium
    report.imperfection, report.converged = imperfection, True
    report.negative_pivots, report.singular = max(0, end.negative_pivots), end.negative_pivots < 0
    report.iterations += end.iterations
    state.lateral_fraction = 0.0 if answer.turns else 1.0
    state.warnings += answer.lines(problem.model.case.shown_units)


def _gap(model: DrillingModel, well: Well) -> FloatArray:
    """Radial clearance (n_nodes,) [m] of the thicker pipe at each node, not below zero."""
    mesh = model.mesh
    outer = np.zeros(mesh.nodes)
    np.maximum.at(outer, np.arange(mesh.nodes - 1), mesh.contact_diameter)
    np.maximum.at(outer, np.arange(1, mesh.nodes), mesh.contact_diameter)
    return np.maximum(np.asarray(well.radius(mesh.node_depth + top_depth(model))) - 0.5 * outer, 0.0)


def node_clearance(model: DrillingModel) -> FloatArray | None:
    """Clearance (n_nodes,) [m] that limits steps, ``LEAST_CLEARANCE`` at least; None without contact."""
    if model.contact is None:
        return None
    return np.maximum(_gap(model, model.contact.well), LEAST_CLEARANCE)


def steps_in_hole(model: DrillingModel) -> HoleSteps | None:
    """Create the steps in the hole's coordinates of this rank's nodes; None without contact.

    Ends with prescribed positions take plain steps; rigid items, joints and their neighbours do not move
    about the axis.
    """
    if model.contact is None:
        return None
    system, mesh, well = model.system, model.mesh, model.contact.well
    gap = _gap(model, well)
    gap[[b.node for b in mesh.bodies]] = 0.0
    vertices, dofs = system.chain.vertices, system.layout.dofs
    at = np.column_stack([dofs["string.position"][:, 0], dofs["string.tangent"][:, 0]])
    prescribed = {f.condition.vertex for f in system.assembly.row_replacements}
    free = np.array([v not in prescribed for v in vertices], dtype=bool)
    return HoleSteps(well, at[free], gap[vertices[free]])
