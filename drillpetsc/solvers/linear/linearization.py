"""Linearisation of the discrete system about the current state: R(x, y, a) = 0 becomes (K + s C + s^2 M) u = 0.

Manual: eq-eigen-rates, eq-eigen-problem.  With K_R = dR/dx, C_R = dR/dy, M_R = dR/da, the rates of most
unknowns are y = x', a = x''.  The rate of a spin angle is the spin omega = phi' + c(v).v'.  A small motion
changes it by (phi' + c.v') s + (d(c.v')/dv).v.  So y = (s P + G) u and a = s y: P is the unit matrix plus the
rows c(v), G has the rows d(c.v')/dv.  Then K = K_R + C_R G, C = C_R P + M_R G, M = M_R P.

Prescribed components do not move: u = T q with orthonormal columns over the free motions, and rows are
projected by the transpose of T.  Constraints with multipliers leave further motions out of the eigenvalue problem
(manual: sec-eigen-constraints).

The matrices are collected on rank 0, and the eigenvalues are computed there (a string has a few thousand
unknowns: seconds).  Every rank receives them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.linalg
import scipy.sparse as sparse

from drillpetsc.arrays import FloatArray, IntArray
from drillpetsc.fem.assembly import spin_derivatives
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.solvers.linear.quadratic_eigenproblem import Eigenvalues, QuadraticEigenproblem

_PARTS = (slice(0, 3), slice(3, 6), slice(6, 7))  # position, slope, spin angle of a prescribed vertex
#: of the largest singular value of a constraint's rows: smaller ones belong to directions that are held already
_DEPENDENT = 1e-10


def unknowns_of(motions: sparse.spmatrix) -> np.ndarray:
    """(m,) the unknown that represents each free motion: the largest of its column of ``motions`` (n, m)."""
    return np.asarray(abs(motions).argmax(axis=0)).ravel()


@dataclass(frozen=True)
class Linearised:
    """Matrices of the linearised system, with all n unknowns, prescribed ones included.

    K, C, M: (n, n) sparse [rows of R by unknown, its rate, its acceleration].
    T: (n, q) basis of the motions that the ends leave free.
    field, node, component: (n,) of each unknown: number of its field, of its node from the top, of its
    component.
    scale: (n,) usual size of each unknown [SI].
    second_order: (n,) whether the rate of the unknown is a further unknown.
    P, G: (n, n) sparse: the rates are y = P u' + G u, and a = y'.
    multiplier: (n,) whether the unknown is a multiplier of a constraint.
    """

    K: sparse.csr_matrix
    C: sparse.csr_matrix
    M: sparse.csr_matrix
    T: sparse.csr_matrix
    field: IntArray
    node: IntArray
    component: IntArray
    scale: FloatArray
    second_order: np.ndarray
    P: sparse.csr_matrix
    G: sparse.csr_matrix
    multiplier: np.ndarray

    @cached_property
    def _multipliers(self) -> tuple[IntArray, IntArray]:
        """Multipliers whose constraint is one of places and which act on the string; those that act on nothing."""
        unknowns = np.flatnonzero(self.multiplier)
        others = sparse.diags((~self.multiplier).astype(float))
        acts = abs(others @ self.K[:, unknowns]).sum(axis=0).A1 > 0
        rates = (abs(self.C[unknowns]) + abs(self.M[unknowns])).sum(axis=1).A1 > 0
        return unknowns[acts & ~rates], unknowns[~acts]

    @cached_property
    def motions(self) -> sparse.csr_matrix:
        """(n, m) basis of the motions that the constraints leave free, without the multipliers.

        A constraint of places makes its multiplier an eigenvalue at infinity in a Jordan block of three.  Rounding
        spreads it over circles of the cube root of the rounding error: finite numbers of any sign, as 8e9 1/s.
        The block goes with the motions across the constraint and with the multiplier (manual: sec-eigen-constraints).
        """
        constraints, idle = self._multipliers
        T = sparse.csc_matrix(self.T)
        left_out = np.zeros(len(self.scale))
        left_out[np.concatenate([constraints, idle])] = 1.0
        T = T[:, (abs(T).T @ left_out) == 0]
        joints = self.field[constraints].astype(np.int64) * (self.node.max() + 1) + self.node[constraints]
        for joint in np.unique(joints):
            rows = sparse.csc_matrix(self.K[constraints[joints == joint]] @ T)
            columns = np.flatnonzero(np.diff(rows.indptr))
            dense = rows[:, columns].toarray()
            dense /= np.maximum(np.linalg.norm(dense, axis=1, keepdims=True), 1e-300)
            free = scipy.linalg.null_space(dense, rcond=_DEPENDENT)
            others = np.setdiff1d(np.arange(T.shape[1]), columns)
            T = sparse.csc_matrix(sparse.hstack([T[:, others], T[:, columns] @ free]))
        return sparse.csr_matrix(T)

    def vectors(self, found: Eigenvalues) -> np.ndarray:
        """Return the vectors (n, m) of all unknowns of eigenvalues of ``eigenproblem``, with the multipliers.

        The forces of a constraint are the forces missing in the motion.
        """
        u = np.asarray(self.motions @ found.u, dtype=complex)
        constraints, _ = self._multipliers
        if len(constraints):
            T = self.T[:, (abs(self.T).T @ self.multiplier.astype(float)) == 0]
            B = sparse.csr_matrix(T.T @ self.K[:, constraints])
            rows = np.flatnonzero(np.diff(B.indptr))
            lacking = T.T @ (self.K @ u + (self.C @ u) * found.s + (self.M @ u) * found.s**2)
            u[constraints] = -np.linalg.lstsq(B[rows].toarray(), lacking[rows], rcond=_DEPENDENT)[0]
        return u

    def eigenproblem(self, reference: float) -> QuadraticEigenproblem:
        """Form the eigenvalue problem in the free motions; ``reference``: a slow rate of the system [1/s].

        A column of the basis lies within the fields of the string, or within one field: it has the order and scale of
        its largest entry.
        """
        T = self.motions
        parent = unknowns_of(T)
        K, C, M = (sparse.csr_matrix(T.T @ A @ T) for A in (self.K, self.C, self.M))
        return QuadraticEigenproblem(K, C, M, self.second_order[parent], self.scale[parent], reference)

    def field_values(self, number: int, u: np.ndarray, nodes: int, size: int) -> np.ndarray:
        """Return the (m, nodes, size) values of a field in the vectors u (n, m); zero if it is absent.

        number: of the field; nodes: of the string; size: components of the field.
        """
        unknowns = np.flatnonzero(self.field == number)
        out = np.zeros((u.shape[1], nodes, size), dtype=u.dtype)
        out[:, self.node[unknowns], self.component[unknowns]] = u[unknowns].T
        return out


def linearise(system: DiscreteSystem, t: float = 0.0) -> Linearised | None:
    """Linearise at the assembly's x, y, a and time ``t`` [s]; the result is on rank 0, None elsewhere.

    Collective.
    """
    layout, asm = system.layout, system.assembly
    # evaluating the rows, not the matrix, shows which motions the ends leave free
    asm.invalidate_prescribed_values()
    system.sum_residual(t, system.new_condensed())
    numbers = layout.condensed_dm.getLGMap().getIndices()
    rows, columns = asm.places()
    used = (rows >= 0) & (columns >= 0)
    entries = [numbers[rows[used]], numbers[columns[used]]]
    for weights in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)):
        asm.jacobian(t, weights, condensed=False)
        entries.append(asm.values[used])
    component = np.zeros(layout.size, dtype=np.int32)
    for field_dofs in layout.dofs.values():
        for k, dofs in enumerate(field_dofs.T):
            component[dofs[dofs >= 0]] = k
    owned = layout.local_of_owned
    unknowns = [
        layout.field_of[owned],
        layout.chain.vertices[layout.vertex_of[owned]],
        component[owned],
        system.scale[owned],
        layout.y_local[owned] >= 0,
    ]
    piece = (entries, _spin_rates(system, numbers), _prescribed(system, numbers), unknowns)
    pieces = [piece] if system.comm.size == 1 else system.comm.tompi4py().gather(piece)
    multipliers = np.array([f.multiplier for f in layout.fields])
    return None if pieces is None else _join(pieces, multipliers)


def _spin_rates(system: DiscreteSystem, numbers: IntArray) -> list[np.ndarray]:
    """Compute rows, columns, c(v) and d(c.w)/dv at the owned vertices (manual: eq-eigen-rates).

    numbers: (n,) global numbers of the local unknowns.
    """
    asm = system.assembly
    by_v, by_w = spin_derivatives(asm)
    owned = system.owned_index[asm.spin_at[:, 0]] >= 0 if len(asm.spin_at) else np.zeros(0, dtype=bool)
    spin, tangent = asm.spin_at[owned, 0], asm.spin_at[owned, 1:2] + np.arange(3)
    return [
        np.repeat(numbers[spin], 3),
        numbers[tangent.ravel()],
        by_w[owned].ravel(),
        by_v[owned].ravel(),
    ]


def _prescribed(system: DiscreteSystem, numbers: IntArray) -> list[tuple[IntArray, list[np.ndarray]]]:
    """Return global unknowns (7,) of each prescribed vertex that this rank owns, and a basis of its free motions.

    The basis has one matrix (3 or 1, k) for position, slope and spin angle each.
    """
    out = []
    for f in system.assembly.row_replacements:
        if f.owned:
            free = [scipy.linalg.null_space(f.D[:, part]) for part in _PARTS]
            if sum(q.shape[1] for q in free) != 7 - int(f.D.any(axis=1).sum()):
                raise ValueError("a prescribed component mixes position, slope and spin")
            out.append((numbers[f.rows], free))
    return out


def _join(pieces, multipliers: np.ndarray) -> Linearised:
    """Assemble the whole system from the pieces of all ranks; unknowns are numbered through the ranks.

    multipliers: (fields,) whether a field's values are multipliers.
    """
    field, node, component, scale, second_order = (
        np.concatenate(q) for q in zip(*(p[3] for p in pieces), strict=True)
    )
    n = len(field)
    rows, columns, *values = (np.concatenate(q) for q in zip(*(p[0] for p in pieces), strict=True))
    K, C, M = (sparse.csr_matrix((v, (rows, columns)), shape=(n, n)) for v in values)
    spin, tangent, by_w, by_v = (np.concatenate(q) for q in zip(*(p[1] for p in pieces), strict=True))
    P = sparse.identity(n, format="csr") + sparse.csr_matrix((by_w, (spin, tangent)), shape=(n, n))
    G = sparse.csr_matrix((by_v, (spin, tangent)), shape=(n, n))
    T = _free_motions(n, [h for p in pieces for h in p[2]])
    # manual: eq-eigen-problem
    return Linearised(
        K + C @ G,
        C @ P + M @ G,
        M @ P,
        T,
        field,
        node,
        component,
        scale,
        second_order,
        P,
        G,
        multipliers[field],
    )


def _free_motions(n: int, prescribed: list[tuple[IntArray, list[np.ndarray]]]) -> sparse.csr_matrix:
    """Form T (n, q): unit columns of the free unknowns, the given bases at the prescribed vertices."""
    fixed = np.concatenate([rows for rows, _ in prescribed] + [np.zeros(0, dtype=int)])
    free = np.setdiff1d(np.arange(n), fixed)
    rows, columns, values, q = [free], [np.arange(len(free))], [np.ones(len(free))], len(free)
    for node_dofs, bases in prescribed:
        for part, basis in zip(_PARTS, bases, strict=True):
            k = basis.shape[1]
            rows.append(np.repeat(node_dofs[part], k))
            columns.append(np.tile(q + np.arange(k), len(basis)))
            values.append(basis.ravel())
            q += k
    return sparse.csr_matrix(
        (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=(n, q)
    )
