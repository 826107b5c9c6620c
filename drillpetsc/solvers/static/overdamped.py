"""Motion of the string with drag in place of inertia: the path of a string whose static state depends on history.

Manual: sec-statics-path.  Each step is implicit Euler with Newton's method inside, in the condensed unknowns.
Friction acts against the velocity of the step; the loads are those at time 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.solvers.chain.chain_lu import ZeroPivot
from drillpetsc.solvers.chain.constraint_products import ConstraintProducts
from drillpetsc.solvers.static.search_limit import SearchLimit
from drillpetsc.solvers.static.static_newton import Advance, diagonal_blocks, largest_of, nodal_length, sum_of
from drillpetsc.solvers.time.newton import shared_factor

MAX_ITERATIONS = 25
INCREMENT = 1e-6  # of a converged step, in the fields' scales
SIDE_SHARE = 0.5  # largest lateral motion of a node in one iteration, as a share of its clearance
MAX_SLOPE_CHANGE = 0.4  # of a node in one iteration
SHORTEST_SEARCH = 0.05  # smallest factor of an iteration's step
SPIN_ARM = 0.1  # usual lever of the drag on the spin [m]


@dataclass
class Drag:
    """Artificial drag per length of string.

    across: [N s/m2] on the velocity across the hole; along: its share along the hole [-].
    tangent: (n_nodes, 3) unit direction of the hole at each node.
    arm: lever of the drag on the spin [m].
    """

    across: float
    along: float
    tangent: FloatArray
    arm: float = SPIN_ARM


class OverdampedMotion:
    """Steps of one discrete system with drag and without inertia; the state is the assembly's x.

    system: the discrete system; drag: see there.
    clearance: (n_nodes,) radial clearance [m].
    advance: takes a step, equal to x + factor p to first order.

    The caller may set ``limit``, of the work of a search.
    """

    def __init__(self, system: DiscreteSystem, drag: Drag, clearance: FloatArray, advance: Advance):
        self.system, self.advance = system, advance
        self.iterations = 0
        self.limit: SearchLimit | None = None
        self._factor = shared_factor(system)
        self._f = system.new_condensed()
        self._owned = system.owned_index >= 0
        self._constraints = ConstraintProducts(system)
        here = system.chain.vertices
        self._clearance = clearance[here]
        h, t = nodal_length(system), drag.tangent[here]
        axial = t[:, :, None] * t[:, None, :]
        c, across = drag.across, np.eye(3) - axial
        matrices = {
            "string.position": c * h[:, None, None] * (across + drag.along * axial),
            "string.tangent": c * (h**3 / 100)[:, None, None] * across,
            "string.spin": (c * h * drag.arm**2)[:, None, None],
        }
        prescribed = {f.condition.vertex for f in system.assembly.row_replacements}
        free = np.array([v not in prescribed for v in here], dtype=bool)
        #: (dofs (k, d), drag (k, d, d) and its entries (k, d, d)) of the free nodes, by field
        self._drag = []
        for (name, M), (vertices, entries) in zip(
            matrices.items(), diagonal_blocks(system, tuple(matrices)), strict=True
        ):
            chosen = free[vertices]
            at = vertices[chosen]
            self._drag.append((system.layout.dofs[name][at], M[at], entries[chosen]))
        self._position, self._slope = (
            np.ascontiguousarray(system.layout.dofs[name]) for name in ("string.position", "string.tangent")
        )
        self._weight = 1.0 / system.scale

    # ------------------------------------------------------------------ pieces
    def rows(self, start: FloatArray, shift: float) -> FloatArray:
        """Residual (n,) of a step from ``start`` (n,) of length 1/``shift`` [1/s]; valid at owned unknowns."""
        system, asm = self.system, self.system.assembly
        asm.v0[:], asm.v1[:] = -shift * start, 0.0
        asm.condense(shift)
        asm.a[:] = 0.0
        asm.invalidate_prescribed_values()
        system.sum_residual(0.0, self._f)
        out = np.zeros(system.layout.size)
        out[system.layout.local_of_owned] = self._f.getArray(readonly=1)
        self._add_drag(out, asm.x[: system.layout.size] - start, shift)
        return out

    def _add_drag(self, rows: FloatArray, moved: FloatArray, shift: float) -> None:
        """Add the drag of the motion ``moved`` (n,) to the ``rows`` (n,) of free owned nodes."""
        for dofs, M, _ in self._drag:
            rows[dofs] += shift * (M @ moved[dofs][:, :, None])[:, :, 0]

    def _matrix(self, shift: float) -> FloatArray:
        """Entries of the Jacobian of ``rows``."""
        asm = self.system.assembly
        asm.jacobian(0.0, (1.0, shift, 0.0), condensed=True)
        for _, M, entries in self._drag:
            asm.values[entries] += shift * M
        self._constraints.add(asm.values)
        return asm.values

    def _side_share(self, p: FloatArray) -> float:
        """Largest motion of this rank's nodes across the string in the step ``p`` (n,), over its clearance."""
        t, r = self.system.assembly.x[self._slope], p[self._position]
        square = np.einsum("ij,ij->i", r, r) - np.einsum("ij,ij->i", r, t) ** 2 / np.einsum("ij,ij->i", t, t)
        return float(np.sqrt(np.max(np.maximum(square, 0.0) / self._clearance**2, initial=0.0)))

    def _share(self, p: FloatArray) -> float:
        """Largest factor of ``p`` (n,) with bounded lateral motion and change of slope of every node."""
        slope = p[self._slope]
        turn = float(np.sqrt(np.max(np.einsum("ij,ij->i", slope, slope), initial=0.0)))
        most = largest_of(self.system, max(self._side_share(p) / SIDE_SHARE, turn / MAX_SLOPE_CHANGE))
        return min(1.0, 1.0 / max(most, 1e-300)) if np.isfinite(most) else np.nan

    def _work(self, rows: FloatArray, p: FloatArray) -> float:
        """Work [J] of ``rows`` (n,) along ``p`` (n,), without that of prescribed components."""
        free = rows.copy()
        for f in self.system.assembly.row_replacements:
            free[f.rows] = f.row_complement @ free[f.rows]
        return sum_of(self.system, float(free[self._owned] @ p[self._owned]))

    # ------------------------------------------------------------------ step
    def step(self, dt: float, guess: FloatArray | None = None) -> int | None:
        """Take one step from the assembly's x; returns Newton iterations, None where it does not converge.

        dt: its length [s]; guess: (n,) first guess of the motion.  Collective.
        On failure x is anywhere.
        """
        system, asm, n, shift = self.system, self.system.assembly, self.system.layout.size, 1.0 / dt
        start, last, growing = asm.x[:n].copy(), np.inf, 0
        if guess is not None:
            asm.x[:n] = self.advance(start, guess, 1.0)
        g = self.rows(start, shift)
        for count in range(1, MAX_ITERATIONS + 1):
            if not np.isfinite(largest_of(system, float(np.abs(g).sum()))):
                return None
            if self.limit is not None:
                self.limit.count()
            try:
                self._factor.factor(self._matrix(shift))
            except ZeroPivot:
                return None
            self.iterations += 1
            p = np.zeros(n)
            self._factor.solve(-g, p)
            share = self._share(p)
            if not np.isfinite(share):
                return None
            here = asm.x[:n].copy()
            asm.x[:n] = self.advance(here, p, share)
            before, g = share * self._work(g, p), self.rows(start, shift)
            after = share * self._work(g, p)
            if before < 0 and after > -0.1 * before:
                share *= max(SHORTEST_SEARCH, before / (before - after))
                asm.x[:n] = self.advance(here, p, share)
                g = self.rows(start, shift)
            size = largest_of(system, float(np.max(np.abs(share * p) * self._weight, initial=0.0)))
            if not np.isfinite(size):
                return None
            contracts = share == 1.0 and count > 1 and size < last
            if size < INCREMENT or (contracts and size * size / (last - size) < 0.1 * INCREMENT):
                return count
            growing += count > 6 and size > 2 * last
            if growing >= 3:
                return None
            last = size
        return None
