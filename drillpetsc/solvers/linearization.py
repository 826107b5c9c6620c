"""The scene linearised about the state its model has: R(x, y, a) = 0 becomes (K + s C + s^2 M) u = 0.

K = dR/dx, C = dR/dy, M = dR/da.  The rates of most unknowns are y = x', a = x''; that of a spin angle is the
spin omega = phi' + c(v).v', and its small change (phi' + c.v')s + (d(c.v')/dv).v is put in:  y = (s P + G) u,
a = s y with the row c(v) in P beside the unit matrix and d(c.v')/dv in G.  So  K + C G,  C P + M G,  M P
stand for K, C, M.  PrescribedMotion components of the ends do not move: u = T q with orthonormal columns over
what is left, rows are those along T.

The matrices are collected on rank 0, and the roots are found there (a string has a few thousand unknowns:
seconds); every rank gets them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg
import scipy.sparse as sparse

from drillpetsc.arrays import FloatArray, IntArray
from drillpetsc.fem.assembly import spin_derivatives
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.solvers.quadratic_eigenproblem import QuadraticEigenproblem

_PARTS = (slice(0, 3), slice(3, 6), slice(6, 7))  # position, slope, spin angle of a held vertex


@dataclass(frozen=True)
class Linearised:
    """K, C, M (n, n) of all unknowns of the scene, prescribed ones included, and T (n, q) the motions that
    the ends leave free.

    field (n,) number of each unknown's field, node (n,) from the top, component (n,); scale (n,) usual size,
    second (n,) order.
    """

    K: sparse.csr_matrix
    C: sparse.csr_matrix
    M: sparse.csr_matrix
    T: sparse.csr_matrix
    field: IntArray
    node: IntArray
    component: IntArray
    scale: FloatArray
    second: np.ndarray

    def pencil(self, reference: float) -> QuadraticEigenproblem:
        """The problem in the free motions; a column of T lies within one field of one node, so it has that
        field's order and scale."""
        parent = np.asarray(abs(self.T).argmax(axis=0)).ravel()
        K, C, M = (sparse.csr_matrix(self.T.T @ A @ self.T) for A in (self.K, self.C, self.M))
        return QuadraticEigenproblem(K, C, M, self.second[parent], self.scale[parent], reference)

    def of_field(self, number: int, u: np.ndarray, nodes: int, size: int) -> np.ndarray:
        """(m, nodes, size) values of a field in the vectors u (n, m); zero where it is absent."""
        on_rank = np.flatnonzero(self.field == number)
        out = np.zeros((u.shape[1], nodes, size), dtype=u.dtype)
        out[:, self.node[on_rank], self.component[on_rank]] = u[on_rank].T
        return out


def linearise(system: DiscreteSystem, t: float = 0.0) -> Linearised | None:
    """Linearise at the assembly's x, y, a; the whole on rank 0, None elsewhere.  Collective."""
    layout, asm = system.layout, system.assembly
    numbers = layout.condensed_dm.getLGMap().getIndices()
    keep = (asm.rows >= 0) & (asm.columns >= 0)
    entries = [numbers[asm.rows[keep]], numbers[asm.columns[keep]]]
    for weights in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)):
        asm.jacobian(t, weights, condensed=False)
        entries.append(asm.values[keep])
    component = np.zeros(layout.size, dtype=np.int32)
    for places in layout.dofs.values():
        for k, place in enumerate(places.T):
            component[place[place >= 0]] = k
    on_rank = layout.local_of_owned
    unknowns = [
        layout.field_of[on_rank],
        layout.chain.vertices[layout.vertex_of[on_rank]],
        component[on_rank],
        system.scale[on_rank],
        layout.y_local[on_rank] >= 0,
    ]
    piece = (entries, _spins(system, numbers), _held(system, numbers), unknowns)
    pieces = [piece] if system.comm.size == 1 else system.comm.tompi4py().gather(piece)
    return None if pieces is None else _put_together(pieces)


def _spins(system: DiscreteSystem, numbers: IntArray) -> list[np.ndarray]:
    """Rows, columns, c(v), d(c.w)/dv at the owned vertices."""
    asm = system.assembly
    by_v, by_w = spin_derivatives(asm)
    on_rank = system.owned_index[asm.spin_at[:, 0]] >= 0 if len(asm.spin_at) else np.zeros(0, dtype=bool)
    spin, tangent = asm.spin_at[on_rank, 0], asm.spin_at[on_rank, 1:2] + np.arange(3)
    return [
        np.repeat(numbers[spin], 3),
        numbers[tangent.ravel()],
        by_w[on_rank].ravel(),
        by_v[on_rank].ravel(),
    ]


def _held(system: DiscreteSystem, numbers: IntArray) -> list[tuple[IntArray, list[np.ndarray]]]:
    """Unknowns (7,) of each prescribed vertex that this rank owns, and a basis (7, k) of what each of its
    parts may do."""
    out = []
    for f in system.assembly.row_replacements:
        if f.owned:
            free = [scipy.linalg.null_space(f.D[:, part]) for part in _PARTS]
            if sum(q.shape[1] for q in free) != 7 - len(f.D):
                raise ValueError("a prescribed component mixes position, slope and spin")
            out.append((numbers[f.rows], free))
    return out


def _put_together(pieces) -> Linearised:
    """The whole system from what the ranks sent; numbers of unknowns run through the ranks."""
    field, node, component, scale, second = (
        np.concatenate(q) for q in zip(*(p[3] for p in pieces), strict=True)
    )
    n = len(field)
    rows, columns, *values = (np.concatenate(q) for q in zip(*(p[0] for p in pieces), strict=True))
    K, C, M = (sparse.csr_matrix((v, (rows, columns)), shape=(n, n)) for v in values)
    turning, tangent, by_w, by_v = (np.concatenate(q) for q in zip(*(p[1] for p in pieces), strict=True))
    P = sparse.identity(n, format="csr") + sparse.csr_matrix((by_w, (turning, tangent)), shape=(n, n))
    G = sparse.csr_matrix((by_v, (turning, tangent)), shape=(n, n))
    T = _free_motions(n, [h for p in pieces for h in p[2]])
    return Linearised(K + C @ G, C @ P + M @ G, M @ P, T, field, node, component, scale, second)


def _free_motions(n: int, held: list[tuple[IntArray, list[np.ndarray]]]) -> sparse.csr_matrix:
    """(n, q): unit columns of the free unknowns, the given bases at the held vertices."""
    free = np.setdiff1d(np.arange(n), np.concatenate([rows for rows, _ in held] + [np.zeros(0, dtype=int)]))
    rows, columns, values, q = [free], [np.arange(len(free))], [np.ones(len(free))], len(free)
    for seven, bases in held:
        for part, basis in zip(_PARTS, bases, strict=True):
            k = basis.shape[1]
            rows.append(np.repeat(seven[part], k))
            columns.append(np.tile(q + np.arange(k), len(basis)))
            values.append(basis.ravel())
            q += k
    return sparse.csr_matrix(
        (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=(n, q)
    )
