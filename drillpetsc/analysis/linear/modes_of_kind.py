"""Modes of one kind, the damped ones included (manual: sec-eigen-search).

The search by discs finds what lies near the imaginary axis. If lateral modes lie close together, its discs are small,
and none contains a
mode that a drive damps strongly. Such modes follow from the system that has only the motions of their kind, in which they are alone.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sparse

from drillpetsc.arrays import FloatArray
from drillpetsc.errors import SolveError
from drillpetsc.fem.component import DRIVE
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.solvers.linear.linearization import Linearised
from drillpetsc.solvers.linear.nonlinear_eigenvalue import refine
from drillpetsc.solvers.linear.quadratic_eigenproblem import (
    Eigenvalues,
    QuadraticEigenproblem,
    Selection,
    backward_errors,
    lowest_eigenvalues,
    lowest_of,
)

SAME = 1e-6  # relative difference of an eigenvalue that was found twice
HELD = 1e-6  # part of a motion that the ends leave free, below which it is held


def lowest_of_kind(
    model: DrillingModel,
    linearised: Linearised,
    problem: QuadraticEigenproblem,
    count: int,
    kind: str,
    selected: Selection,
    engine: str = "auto",
) -> Eigenvalues:
    """The ``count`` lowest modes of a kind, as `lowest_eigenvalues`, and the damped ones among them.

    Raises SolveError if nothing converges.
    """
    own = _from_own_motions(model, linearised, problem, count, kind, selected)
    try:
        found = lowest_eigenvalues(problem, count, engine, selected)
    except SolveError:
        if own is None or int((own.s.imag > 0).sum()) < count:
            raise
        return lowest_of([own], count)
    if own is None:
        return found
    new = np.array([np.all(np.abs(s - found.s) > SAME * abs(s)) for s in own.s], dtype=bool)
    return lowest_of([found, own.subset(new)], count)


def _from_own_motions(
    model: DrillingModel,
    linearised: Linearised,
    problem: QuadraticEigenproblem,
    count: int,
    kind: str,
    selected: Selection,
) -> Eigenvalues | None:
    """Oscillating modes of the whole system, continued from the modes of the motions of a kind; None for other kinds and without any."""
    basis = _motions(model, linearised, kind)
    if basis is None:
        return None
    P, second, scale = basis
    K, C, M = (sparse.csr_matrix(P.T @ A @ P) for A in (problem.K, problem.C, problem.M))
    try:
        start = lowest_eigenvalues(QuadraticEigenproblem(K, C, M, second, scale, problem.reference), count)
    except (SolveError, ValueError):  # motions of the kind alone make no system
        return None
    oscillating = np.flatnonzero(start.s.imag > 0)[:count]
    refined = [
        refine(lambda s: problem.K + s * problem.C + s**2 * problem.M, start.s[i], P @ start.u[:, i])
        for i in oscillating
    ]
    kept = [r for r in refined if r.converged and r.s.imag > 0]
    if not kept:
        return None
    s, u = np.array([r.s for r in kept]), np.column_stack([r.u for r in kept])
    first = [i for i in range(len(s)) if np.all(np.abs(s[:i] - s[i]) > SAME * abs(s[i]))]
    found = Eigenvalues(s[first], u[:, first], backward_errors(problem, s[first], u[:, first]))
    return found.subset(selected(found))


def _motions(
    model: DrillingModel, linearised: Linearised, kind: str
) -> tuple[sparse.csr_matrix, np.ndarray, FloatArray] | None:
    """Motions of a kind in the free motions of the system (q, k), which of them are of second order, and their scales.

    Torsional: the spin angle. Axial: position and slope along the string. Both with the states of the drive.
    """
    fields = model.system.layout.fields
    names = [f.name for f in fields]
    drive = np.isin(linearised.field, [i for i, f in enumerate(fields) if f.physics == DRIVE])
    own = {"torsional": ("string.spin",), "axial": ()}.get(kind)
    if own is None or "string.position" not in names:
        return None
    alone = np.flatnonzero(
        drive | np.isin(linearised.field, [names.index(name) for name in own if name in names])
    )
    n = len(linearised.field)
    parts = [sparse.csr_matrix((np.ones(len(alone)), (alone, np.arange(len(alone)))), (n, len(alone)))]
    second, scale = [linearised.second_order[alone]], [linearised.scale[alone]]
    t = model.tangent / np.linalg.norm(model.tangent, axis=1, keepdims=True)
    for name in ("string.position", "string.tangent") if kind == "axial" else ():
        rows = np.flatnonzero(linearised.field == names.index(name))
        node = linearised.node[rows]
        values = t[node, linearised.component[rows]]
        parts.append(sparse.csr_matrix((values, (rows, node)), (n, model.mesh.nodes)))
        second.append(np.ones(model.mesh.nodes, dtype=bool))
        scale.append(np.full(model.mesh.nodes, linearised.scale[rows].max()))
    P = sparse.csc_matrix(linearised.motions.T @ sparse.hstack(parts))
    free = np.sqrt(np.asarray(P.multiply(P).sum(axis=0)).ravel()) > HELD
    return sparse.csr_matrix(P[:, free]), np.concatenate(second)[free], np.concatenate(scale)[free]
