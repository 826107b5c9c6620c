"""Newton's method for a static equilibrium, or for one step of a string that moves with drag in place of inertia.

Manual: sec-statics-newton.  Friction acts in the directions that the components impose, or against the velocity of the
step.  A step with drag is one of implicit Euler.  Without drag the step is infinitely long.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

import numpy as np

from drillpetsc.arrays import FloatArray, halves_at_nodes
from drillpetsc.errors import SolveError
from drillpetsc.fem.bound_parts import ROW_SCALE, RowReplacement
from drillpetsc.fem.component import DRIVE, ROCK
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.geometry.frames import cross
from drillpetsc.kernels import function, pointer
from drillpetsc.parallel import largest, total
from drillpetsc.solvers.chain.chain_lu import ZeroPivot
from drillpetsc.solvers.chain.constraint_products import ConstraintProducts
from drillpetsc.solvers.static.newton_progress import CONVERGED_INCREMENT, ROUNDING_INCREMENT, NewtonProgress
from drillpetsc.solvers.static.search_limit import SearchLimit
from drillpetsc.solvers.time.newton import shared_factor

_quasi_rows = function("quasi_rows", "iipppp")

MAX_STEPS = 40
SLOPE_STEP = 1.0e-4  # share of a step over which its direction is differenced
#: largest lateral motion of a node in one step, as a share of its clearance: without drag, with drag
STEP_SHARE, DRAG_STEP_SHARE = 2.0, 0.5
AXIAL_SHARE = 1e-6  # of the drag along the string; it holds a string that nothing else holds
MAX_SLOPE_CHANGE = 0.4  # largest change of a node's slope in one step
#: lateral stiffness [N/m2] below which a motion in a hole is neutral: a helix without weight rolls without work
NEUTRAL = 0.01


NODAL = ("string.position", "string.tangent", "string.spin")  # fields that the drag holds

#: (unknowns, step, factor) -> unknowns after the step
Advance = Callable[[FloatArray, FloatArray, float], FloatArray]


@dataclass(frozen=True)
class Drag:
    """Artificial drag in one step of implicit Euler.

    across: drag per length of string on the motion across it, over the length of the step [N/m2] (manual: eq-statics-shift).
    along: its share along the string [-]; arm: its lever on the spin [m].
    shift: one over the length of the step [1/s], if friction acts against the velocity of the step; 0: it acts as imposed.
    """

    across: float
    along: float = AXIAL_SHARE
    arm: float = 0.0
    shift: float = 0.0


@dataclass
class Equilibrium:
    """Results of a static solve.

    iterations: Newton steps; history: (iterations,) increments in the fields' scales, the last one in
    ``increment``.
    negative_pivots: negative eigenvalues of the stiffness beyond those of multipliers (manual:
    eq-statics-stable).
    residual: largest residual [N, N m].
    singular: the stiffness has a zero pivot, so that stability is not known.
    imperfection: relative size of the lateral loads that were added [-].
    """

    iterations: int = 0
    negative_pivots: int = 0
    residual: float = 0.0
    increment: float = 0.0
    imperfection: float = 0.0
    singular: bool = False
    converged: bool = False
    history: list[float] = field(default_factory=list)


class StaticNewton:
    """Static solver of one discrete system; the state is the assembly's x, rates are zero.

    system: the discrete system.
    symmetric: the loads have a potential.  Without one the inertia is that of the symmetric part: no negative
    pivot still means stable (manual: eq-statics-stable).
    clearance: (n_nodes,) radial clearance [m], or the same for all; None without a well.
    t: time at which inputs are evaluated [s].
    advance: takes a step, equal to x + factor p to first order; None: exactly that.

    The caller may set, with n local dofs:
    depth(system): depth of the bit below the hole's end [m], its gradient (n,) by the local unknowns, and the
    depth [m] of the requested weight on bit.  The top's axial position is then an unknown (manual:
    eq-statics-wob).
    move_top(step): moves the prescribed position of the top by ``step`` [m].
    rates: (n+1,) rates of a steady motion [SI of each field per second], None at rest.
    start_increment: largest increment of a state from which a further solve starts, in the fields' scales.
    rate_weight: of the derivatives by the rates in the matrix [1/s]; a flow in a closed channel needs some.
    limit: of the work of a search.
    """

    def __init__(
        self,
        system: DiscreteSystem,
        clearance: FloatArray | float | None = None,
        t: float = 0.0,
        advance: Advance | None = None,
        symmetric: bool = True,
    ):
        self.system, self.t, self.symmetric = system, t, symmetric
        self._advanced: Advance = advance or (lambda x, p, factor: x + factor * p)
        free = 0.2 * float(system.mesh.node_depth[-1])
        # contacts that open and close overshoot; a rod without a wall may turn far in a full step
        self._searches = clearance is not None
        step = free if clearance is None else np.asarray(clearance, dtype=float)
        self._step_shares = (1.0, 1.0) if clearance is None else (STEP_SHARE, DRAG_STEP_SHARE)
        self.max_lateral_step = np.broadcast_to(step, (system.mesh.nodes,))[system.chain.vertices]
        self.factor = shared_factor(system)
        self.f = system.new_condensed()
        self.depth: Callable[[DiscreteSystem], tuple[float, FloatArray, float]] | None = None
        self.move_top: Callable[[float], None] | None = None
        self.rates: FloatArray | None = None
        self.rate_weight = 0.0
        self.start_increment = CONVERGED_INCREMENT
        self.limit = SearchLimit()
        self._owned = system.owned_index >= 0
        ends = [f.condition.vertex for f in system.assembly.row_replacements]
        #: of each nodal field: local nodes (k,) that move with drag, and the places (k, d, d) of their entries
        self._free = [
            (nodes[moves], entries[moves])  # a prescribed end moves without drag
            for nodes, entries in diagonal_blocks(system, NODAL)
            for moves in [~np.isin(system.chain.vertices[nodes], ends)]
        ]
        spin = system.assembly.spin_at
        self._phi, self._slope = (
            spin[:, 0],
            spin[:, 1:2] + np.arange(3),
        )  # unknowns of the nodes with a spin angle
        self._spin_number = np.full(system.layout.size + 1, -1, dtype=np.int32)
        self._spin_number[self._phi] = np.arange(len(spin))
        #: of the present step: drag, unknowns (n,) before it, and the springs of each nodal field
        self._drag: tuple[Drag, FloatArray, list[tuple[np.ndarray, FloatArray, np.ndarray]]] | None = None
        self._constraints = ConstraintProducts(system)
        self._held_entries = self._couplings_of_held_unknowns()
        self._top_rows = next(
            (f for f in system.assembly.row_replacements if f.owned and f.condition.vertex == 0), None
        )

    # ------------------------------------------------------------------ pieces
    def sum(self, value: float) -> float:
        """Sum ``value`` over all ranks; collective."""
        return float(total(self.system.comm, value))

    def largest(self, value: float) -> float:
        """Largest ``value`` of all ranks; collective."""
        return largest(self.system.comm, value)

    def rows(self) -> FloatArray:
        """Compute the residual (n,) at rest, in the steady motion ``rates``, or of the present step, summed over ranks; collective.

        The array has local numbering with ghosts and is valid at owned unknowns.  Manual: eq-statics-rest.
        """
        system, asm = self.system, self.system.assembly
        if self._shift and self._drag is not None:
            asm.v0[:], asm.v1[:] = -self._shift * self._drag[1], 0.0
            asm.condense(self._shift)  # velocities of the step, those of the spin included
        else:
            asm.y[:] = 0.0 if self.rates is None else self.rates
        asm.a[:] = 0.0
        asm.invalidate_prescribed_values()
        system.sum_residual(self.t, self.f)
        local = np.zeros(system.layout.size)
        local[system.layout.local_of_owned] = self.f.getArray(readonly=1)
        return local

    @contextmanager
    def drag(self, drag: Drag) -> Iterator[None]:
        """Meanwhile solve for the end of a step that begins at the present state: springs hold the free nodes there."""
        n = self.system.layout.size
        self._drag = drag, self.system.assembly.x[:n].copy(), self._springs(drag)
        try:
            yield
        finally:
            self._drag = None

    def move(self, p: FloatArray) -> None:
        """Move the string by ``p`` (n,)."""
        x = self.system.assembly.x[: self.system.layout.size]
        x[:] = self._advanced(x.copy(), p, 1.0)

    @property
    def _shift(self) -> float:
        return 0.0 if self._drag is None else self._drag[0].shift

    def _springs(self, drag: Drag) -> list[tuple[np.ndarray, FloatArray, np.ndarray]]:
        """Springs of a drag by nodal field: unknowns (k, d), matrices (k, d, d), their places (k, d, d) in the values."""
        system, v = self.system, self.system.field("string.tangent")
        h = halves_at_nodes(system.mesh.length)[system.chain.vertices]
        along = v[:, :, None] * v[:, None, :] / np.sum(v * v, axis=1)[:, None, None]
        across = np.eye(3) - along
        matrices = (
            h[:, None, None] * (across + drag.along * along),
            (h**3 / 100)[:, None, None] * across,
            (h * drag.arm**2)[:, None, None],
        )
        fields = zip(self._free, NODAL, matrices, strict=True)
        return [
            (system.layout.dofs[name][at], drag.across * M[at], entries) for (at, entries), name, M in fields
        ]

    def _pull(self) -> FloatArray:
        """Gradient (n,) at x, with the drag of the present step; collective."""
        return self._gradient(self.rows()) + self.drag_force()

    def drag_force(self) -> FloatArray:
        """Force (n,) on the springs of the present step, zero without one."""
        out = np.zeros(self.system.layout.size)
        if self._drag is not None:
            _, start, springs = self._drag
            moved = self.system.assembly.x[: len(out)] - start
            for dofs, M, _ in springs:
                out[dofs] = (M @ moved[dofs][:, :, None])[:, :, 0]
        return out

    def _gradient(self, rows: FloatArray) -> FloatArray:
        """Compute the derivative (n,) of the energy by (r, v, phi) from the residual ``rows`` (n,).

        The rows of v include the part of the spin coordinate (manual: eq-beam-quasi-rows); prescribed rows
        are zero.
        """
        asm, g = self.system.assembly, rows.copy()
        for f in asm.row_replacements:
            if f.leans:
                f.lean_at(asm.x)
            g[f.rows] = f.row_complement @ g[f.rows]
        g[self._slope] += self._spin_potential() * g[self._phi][:, None]
        return g

    def _spin_potential(self) -> FloatArray:
        """Compute c(v) (k, 3) at the k local nodes with a spin angle (manual: eq-beam-spin-potential)."""
        asm = self.system.assembly
        v = asm.x[self._slope]
        n = np.linalg.norm(v, axis=1, keepdims=True)
        with np.errstate(
            divide="ignore", invalid="ignore"
        ):  # a slope against its reference: a step that is not taken
            return cross(v, asm.reference) / (n * (n + np.sum(v * asm.reference, axis=1, keepdims=True)))

    def _stiffness(self) -> None:
        """Compute the stiffness at x into the assembly's values.

        It is symmetric if all loads are conservative.
        """
        asm = self.system.assembly
        asm.jacobian(self.t, (1.0, self._shift or self.rate_weight, 0.0), condensed=self._shift > 0)
        # (n+1,) derivative of the free rows by the downward motion of the top
        self._by_top = np.zeros(self.system.layout.size + 1)
        for f in asm.row_replacements:  # prescribed components do not move, so their columns are removed
            for item, e, slots in f.elements:
                K = asm.values[item.span].reshape(item.count, item.width, item.width)[e]
                if f is self._top_rows:
                    np.add.at(self._by_top, item.index[e], K[:, slots] @ self._advance(f))
                K[:, slots] = K[:, slots] @ f.complement
        c = np.ascontiguousarray(self._spin_potential())
        for item in asm.bound_blocks:
            if item.count and item.width >= 7:
                at = pointer(asm.values) + 8 * item.span.start
                _quasi_rows(
                    item.count, item.width, pointer(item.index), pointer(self._spin_number), pointer(c), at
                )
        self._constraints.add(asm.values)
        for _, M, entries in self._drag[2] if self._drag is not None else ():
            asm.values[entries] += M

    def _advance(self, f: RowReplacement) -> FloatArray:
        """Change (7,) of the unknowns of a prescribed end by the length that it is moved down its path."""
        advance = f.condition.advance
        return f.D[0] if advance is None else advance(self.system.assembly.x[f.rows])

    def _couplings_of_held_unknowns(self) -> np.ndarray:
        """Places in the matrix where the unknowns of rock and drives couple to others (manual: sec-statics-stability).

        Statics holds them by rows of their own.  The string's rows depend on them, those rows not on the string: the
        eigenvalues are those of the string alone, while the symmetric part of the couplings has negative ones.
        """
        layout, asm = self.system.layout, self.system.assembly
        held = np.array([f.physics in (ROCK, DRIVE) for f in layout.fields])[layout.field_of]
        if not held.any():
            return np.zeros(0, dtype=int)
        rows, columns = asm.places()
        by_row, by_column = (np.append(held, False)[i] for i in (rows, columns))
        return np.flatnonzero((by_row | by_column) & (rows != columns))

    def _factor(self) -> None:
        """Factor the stiffness; raises SolveError if it is singular."""
        self.limit.count()
        try:
            self.factor.factor(self.system.assembly.values)
        except ZeroPivot:
            raise SolveError(
                "singular stiffness matrix",
                hint="check the end conditions: a rigid-body mode may not be constrained",
                **self.system.locate_largest_residual(self.t),
            ) from None

    def negative_pivots(self) -> int:
        """Count the negative pivots of the stiffness at x beyond those of multipliers; -1 if a pivot is missing.

        Manual: eq-statics-stable.

        The count has a meaning without friction only.  Neutral motions in a hole do not count.
        """
        self._stiffness()
        values = self.system.assembly.values
        values[self._held_entries] = 0.0
        count = self._inertia(values)
        if count > 0 and self._searches:
            for _, M, entries in self._springs(Drag(NEUTRAL)):
                values[entries] += M
            count = self._inertia(values)
        return count

    def _inertia(self, values: FloatArray) -> int:
        """Negative pivots of a matrix, or of its symmetric part, beyond those of multipliers; -1 if one is missing."""
        self.limit.count()
        try:
            # each multiplier is a negative eigenvalue in every state (saddle point)
            count = self.factor.negative_pivots(values if self.symmetric else self._symmetric_part(values))
            return count - self.system.multipliers
        except ZeroPivot:
            return -1

    def _symmetric_part(self, values: FloatArray) -> FloatArray:
        """Symmetric part of the matrix with entries ``values``; loads without a potential add to the rest."""
        out = values.copy()
        for item in self.system.assembly.bound_blocks:
            K = out[item.span].reshape(item.count, item.width, item.width)
            K[:] = 0.5 * (K + K.transpose(0, 2, 1))
        return out

    # ------------------------------------------------------------------ iteration
    def _step_limit(self, p: FloatArray) -> float:
        """Compute the largest factor of the step ``p`` (n,) with bounded lateral motion and slope change of every node."""
        system = self.system
        r, v = p[system.layout.dofs["string.position"]], p[system.layout.dofs["string.tangent"]]
        t = system.field("string.tangent")
        t = t / np.linalg.norm(t, axis=1, keepdims=True)
        lateral = np.linalg.norm(r - t * np.sum(r * t, axis=1, keepdims=True), axis=1)
        share = (lateral / self.max_lateral_step).max(initial=0.0)
        slope = np.linalg.norm(v, axis=1).max(initial=0.0)
        return min(
            self._step_shares[self._drag is not None] / max(self.largest(share), 1e-300),
            MAX_SLOPE_CHANGE / max(self.largest(slope), 1e-300),
        )

    def _search(
        self, x0: FloatArray, p: FloatArray, with_top: FloatArray, slope0: float, alpha: float
    ) -> float:
        """Shorten a step beyond which the energy rises again, by the slope along it; returns the factor of ``p``.

        x0: (n,) start; p: (n,) step; with_top: (n,) its part that follows the top's own motion, along which the loads at
        the top do work; slope0: slope at the start without that part [J]; alpha: first factor.
        """
        for _ in range(12):
            slope = self._slope_at(x0, p, with_top, alpha)
            if np.isfinite(slope) and slope <= 0.8 * abs(slope0):
                break
            alpha *= (
                min(0.7, max(0.1, slope0 / (slope0 - slope))) if np.isfinite(slope) and slope > 0 else 0.3
            )
        return alpha

    def _slope_at(self, x0: FloatArray, p: FloatArray, with_top: FloatArray, alpha: float) -> float:
        """Compute the slope [J] of the energy along ``p`` (n,) less ``with_top`` (n,) at x0 + alpha p; collective."""
        self.system.assembly.x[: self.system.layout.size] = self._advanced(x0, p, alpha)
        way = (self._advanced(x0, p, alpha + SLOPE_STEP) - self._advanced(x0, p, alpha - SLOPE_STEP)) / (
            2 * SLOPE_STEP
        )
        way -= with_top
        return self.sum(float(self._pull()[self._owned] @ way[self._owned]))

    def missing_depth(self) -> float:
        """Distance [m] from the depth of the bit to that of the requested weight on bit; 0 without a request; collective."""
        if self.depth is None:
            return 0.0
        depth, _, target = self.depth(self.system)
        return target - self.sum(depth)

    def gradient(self) -> FloatArray:
        """Gradient (n,) of the energy at x with the errors of the prescribed components, zero at an equilibrium; collective."""
        return self._with_constraints(self._gradient(self.rows()))

    def factor_here(self) -> None:
        """Factor the stiffness at x; collective.  Raises SolveError if it is singular."""
        self._stiffness()
        self._factor()

    def step_for(self, source: FloatArray, missing: float) -> tuple[FloatArray, float]:
        """Solve for the step (n,) that changes ``gradient`` by ``source`` (n,), and the depth by ``missing`` [m]; collective.

        Returns the step, and the motion of the top in it [m].
        """
        p = np.zeros(self.system.layout.size)
        self.factor.solve(source, p)
        if self.depth is None:
            return p, 0.0
        move, with_top = self._bring_to_depth(p, missing)
        return p + with_top, move

    def _bring_to_depth(self, p: FloatArray, missing: float | None = None) -> tuple[float, FloatArray]:
        """Compute the motion of the top that brings the bit to its depth beside the step ``p`` (n,) (manual: eq-statics-wob).

        missing: way to that depth [m], by default from the present one.

        Returns the motion of the top [m], and the step (n,) that belongs to it.  Raises SolveError if the top does not
        move the bit.
        """
        system, n = self.system, self.system.layout.size
        s = np.zeros(n)
        self.factor.solve(-self._gradient(system.sum_local(self._by_top)), s)
        if self._top_rows is not None:
            s[self._top_rows.rows] += self._advance(self._top_rows)
        _, gradient, _ = self.depth(system)  # type: ignore[misc]
        missing = self.missing_depth() if missing is None else missing
        by_step = self.sum(float(gradient[self._owned] @ p[self._owned]))
        by_top = self.sum(float(gradient[self._owned] @ s[self._owned]))
        if abs(by_top) < 1e-12:
            raise SolveError(
                "the top's position does not reach the bit",
                hint="wob needs a top with a prescribed axial position",
            )
        move = (missing - by_step) / by_top
        return move, move * s

    def newton(
        self,
        report: Equilibrium,
        tolerance: float = CONVERGED_INCREMENT,
        most: int = MAX_STEPS,
        near: bool = False,
    ) -> None:
        """Iterate from the assembly's x to an equilibrium, or to the end of a step with drag; collective.

        Manual: eq-statics-step.

        report: gets iterations, increments, ``converged`` and the largest residual.
        tolerance: largest increment of a converged state, in the fields' scales.  Of one that a further solve starts from, it
        may be of a step that the search has shortened since.
        most: number of steps.
        near: the start is near its state: give up if two consecutive steps exceed the radial clearance.
        Raises SolveError if the iteration does not converge; x is then anywhere.
        """
        self._begin(report)
        progress, start = NewtonProgress(tolerance, most, near), len(report.history)
        n, x = self.system.layout.size, self.system.assembly.x
        while progress.goes_on():
            g = self._pull()
            self._stiffness()
            self._factor()
            p = np.zeros(n)
            self.factor.solve(-self._with_constraints(g), p)
            slope0 = self.sum(float(g[self._owned] @ p[self._owned]))
            move, with_top = self._bring_to_depth(p) if self.depth else (0.0, np.zeros(n))
            p += with_top
            longest = self._step_limit(p)
            if progress.leaves(longest):
                break
            progress.take(self._size(p))
            x0, alpha = x[:n].copy(), min(1.0, longest)
            # near rounding the slope has no sign; beside a saddle it does not say how far to go
            if self._searches and slope0 < 0 and progress.full > ROUNDING_INCREMENT:
                alpha = self._search(x0, p, with_top, slope0, alpha)
            x[:n] = self._advanced(x0, p, alpha)
            if self.depth and self.move_top:
                self.move_top(alpha * move)
            report.increment = self._size(alpha * p)
            report.iterations += 1
            report.history.append(report.increment)
            if not np.isfinite(report.increment):
                raise SolveError(
                    "the static solution is not finite", **self.system.locate_largest_residual(self.t)
                )
            if progress.converged(report.increment, alpha):
                self._end(report)
                return
            if progress.stalls(alpha, self._drag is not None):
                break
        raise SolveError(
            f"statics did not converge in {len(report.history) - start} iterations "
            f"(last increment {report.increment:.1e} of the fields' scales)",
            hint="a finer mesh (mesh: {refinement: 2}), a softer contact.stiffness or a stronger initial.imperfection may help",
            **self.system.locate_largest_residual(self.t),
        )

    def _size(self, p: FloatArray) -> float:
        """Largest component of ``p`` (n,) in the fields' scales, of all ranks; collective."""
        return self.largest(float(np.max(np.abs(p) / self.system.scale, initial=0.0)))

    def _with_constraints(self, g: FloatArray) -> FloatArray:
        """Return the gradient ``g`` (n,) with the error of the prescribed positions in their rows."""
        out = g.copy()
        asm = self.system.assembly
        for f in asm.row_replacements:
            if f.owned:
                f.evaluate(self.t, asm.x)
                error = f.D @ asm.x[f.rows] - f.value
                out[f.rows] += f.D.T @ (ROW_SCALE * error)
        return out

    def _begin(self, report: Equilibrium) -> None:
        """Put prescribed components at their values."""
        report.converged = False
        x = self.system.assembly.x
        self.system.assembly.invalidate_prescribed_values()
        for f in self.system.assembly.row_replacements:
            f.evaluate(self.t, x)
            x[f.rows] += f.D.T @ (f.value - f.D @ x[f.rows])

    def _end(self, report: Equilibrium) -> None:
        """Report a converged state; collective."""
        report.converged = True
        report.residual = self.largest(
            float(np.max(np.abs(self._gradient(self.rows())[self._owned]), initial=0.0))
        )


def diagonal_blocks(system: DiscreteSystem, fields: tuple[str, ...]) -> list[tuple[np.ndarray, np.ndarray]]:
    """Find the matrix entries of the diagonal blocks of nodal ``fields``.

    Returns for each field: owned vertices (k,), each once, and the places (k, d, d) in ``Assembly.values`` of one
    element's entries, for fields of d components.
    """
    asm = system.assembly
    chain, out = system.chain, []
    for name in fields:
        dofs = system.layout.dofs[name]
        vertex, first = np.full(system.layout.size + 1, -1), dofs[:, 0]
        chosen = (first >= 0) & chain.owned
        vertex[first[chosen]] = np.flatnonzero(chosen)
        # vertex, first entry of its diagonal block, and width of the element's matrix
        found = [np.zeros((0, 3), dtype=int)]
        for item in asm.bound_blocks:
            element, slot = np.nonzero(vertex[item.index] >= 0)
            corner = item.span.start + element * item.width**2 + slot * (item.width + 1)
            at = vertex[item.index[element, slot]]
            found.append(np.column_stack([at, corner, np.full(len(at), item.width)]))
        rows = np.concatenate(found)
        vertices, once = np.unique(rows[:, 0], return_index=True)
        _, corner, width = rows[once].T
        k = np.arange(dofs.shape[1])
        out.append((vertices, corner[:, None, None] + k[:, None] * width[:, None, None] + k))
    return out
