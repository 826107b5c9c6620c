"""Accelerations, and rates of first-order unknowns, that fulfil the equations at a given state.

Manual: sec-time-alpha-start.  A start and a restart of generalised-alpha need them; without them its order is 1.
"""

from __future__ import annotations

import numpy as np
from petsc4py import PETSc

from drillpetsc.arrays import FloatArray
from drillpetsc.errors import SolveError
from drillpetsc.fem.assembly import spin_derivatives
from drillpetsc.solvers.time.newton import CondensedNewton, shared_factor

#: time [s] that weighs position and rate against acceleration in the matrix of the linear solve; it regularises
#: the matrix and does not enter the solution
REGULARISATION = 1.0e-6
ITERATIONS, ACCURACY = 30, 1.0e-10
STALLED = 0.9  # a step above this fraction of the last one is rounding, or of an unknown without a rate, which is not moved
#: steps [s] of the start with constraints, the first that Newton solves: short against the motion, long enough
#: for the rounding of positions of 1000 m
CONSTRAINED_STEPS = (1.0e-4, 1.0e-5, 1.0e-6)
IMPULSE_STEP = 1.0e-6  # of a jump of rates with constraints [s]
CONSTRAINED_TOLERANCE = 1.0e-12  # Newton's, in those steps
ALONG = 1.0e-6  # difference [s] for the acceleration of a prescribed motion


class ConsistentStart:
    """Consistent accelerations of a system at the assembly's x and y.

    newton: the condensed Newton method of the run.
    """

    def __init__(self, newton: CondensedNewton):
        self.newton, self.system = newton, newton.system
        layout = self.system.layout
        kind = np.array([0 if f.second_order else 1 if f.differential else 2 for f in layout.fields])
        kind = kind[layout.field_of]
        self.second, self.first = kind == 0, kind == 1
        self._rows = self.system.new_condensed()
        self._unknown = np.zeros(layout.size)
        self._local = PETSc.Vec().createWithArray(self._unknown, comm=PETSc.COMM_SELF)
        self._step = np.zeros(len(layout.local_of_owned))

    # ------------------------------------------------------------------ without multipliers: linear in both
    def accelerations(self, t: float, near: ConsistentStart | None = None) -> None:
        """Set ``a``, and ``y`` of first-order unknowns, so that the equations hold at ``t`` [s]; collective.

            near: of a system that differs little, at which it was called last, at the same time: its state and its factors serve here.
        Raises SolveError if the equations have no solution.
        """
        asm, n = self.system.assembly, self.system.layout.size
        if self.system.multipliers:
            self._by_small_steps(t)
            return
        found = None if near is None else near.system.assembly
        asm.a[:] = 0.0 if found is None else found.a
        self._prescribed_accelerations(t)
        with_imposed = asm.imposed
        asm.freeze(with_imposed)
        try:
            asm.y[:n][self.first] = 0.0 if found is None else found.y[:n][self.first]
            asm.apply_imposed_rates()
            if near is None:
                self._factor(t)
            solver, last = near or self, np.inf
            total = np.where(self.second, asm.a[:n], self.first * asm.y[:n] / REGULARISATION)
            for _ in range(ITERATIONS):
                step = solver._solve(self._residual(t))
                total -= step
                asm.a[:n][self.second] -= step[self.second]
                asm.y[:n][self.first] -= REGULARISATION * step[self.first]
                asm.apply_imposed_rates()
                size = self._largest(step)
                if size <= ACCURACY * max(1e-6, self._largest(total)) or size > STALLED * last:
                    break
                last = size
        finally:
            asm.freeze(None)
        if not np.isfinite(self._largest(total)):
            raise SolveError("the equations of motion have no solution for the accelerations", time=t)

    def rows(self, t: float) -> FloatArray:
        """Compute the rows (owned,) of the equations at the assembly's x, y, a and ``t`` [s], zero along prescribed motion; collective."""
        return self._residual(t)

    def response(self, t: float, change: FloatArray) -> FloatArray:
        """Compute the change (n,) of the accelerations and of the rates of first-order unknowns if the rows change by ``change``.

        For systems without multipliers; collective.  It has the error of the regularisation, 1e-5 of its size at most.
        """
        asm = self.system.assembly
        asm.freeze(asm.imposed)
        try:
            self._factor(t)
            step = self._solve(change)
        finally:
            asm.freeze(None)
        return np.where(self.second, -step, np.where(self.first, -REGULARISATION * step, 0.0))

    def jump(self, t: float) -> None:
        """Let rates jump to the prescribed ones at ``t`` [s], all others by the impulse; collective.

        The rows of inertia, integrated over the jump: the change of ``y`` of second-order unknowns, and of
        ``x`` of first-order ones, fulfils M change = 0 for unknowns that are not prescribed.
        """
        asm, n = self.system.assembly, self.system.layout.size
        if self.system.multipliers:
            self._impulse_by_a_step(t)
            return
        change = np.zeros(len(asm.y))
        for f in asm.row_replacements:
            f.evaluate(t, asm.x)
            change[f.rows] += f.D.T @ (f.rate - f.D @ (asm.y[f.rows] + change[f.rows]))
        asm.freeze(asm.imposed)
        try:
            asm.a[:] = 0.0
            rows = self._residual(t)
            asm.a[:] = change
            rows = self._residual(t) - rows
            self._factor(t)
            step = self._solve(rows)
        finally:
            asm.freeze(None)
        asm.a[:] = 0.0
        asm.y[:n][self.second] += (change[:n] - step)[self.second]
        asm.x[:n][self.first] -= REGULARISATION * step[self.first]

    def _prescribed_accelerations(self, t: float) -> None:
        """Set accelerations along prescribed directions, by a difference of their rates to a later time."""
        asm = self.system.assembly
        later = ALONG * max(1.0, abs(t) / 1000)
        moved = asm.x + later * asm.y
        for f in asm.row_replacements:
            f.evaluate(t, asm.x)
            asm.y[f.rows] += f.D.T @ (f.rate - f.D @ asm.y[f.rows])
            f.evaluate(t + later, moved)
            wanted = (f.rate - f.D @ asm.y[f.rows]) / later
            asm.a[f.rows] += f.D.T @ (wanted - f.D @ asm.a[f.rows])
            f.time = None

    def _residual(self, t: float) -> FloatArray:
        """Return the rows (owned,) at the assembly's x, y, a; zero along prescribed directions."""
        self.system.sum_residual(t, self._rows)
        rows = self._rows.getArray()
        for f in self.system.assembly.row_replacements:
            if f.owned:
                rows[f.owned_rows] = f.complement @ rows[f.owned_rows]
        return rows.copy()

    def _factor(self, t: float) -> None:
        tau = REGULARISATION
        asm = self.system.assembly
        asm.jacobian(t, (0.5 * tau * tau, tau, 1.0), condensed=False)
        shared_factor(self.system).factor(asm.values)

    def _solve(self, rows: FloatArray) -> FloatArray:
        """Return the solution (n,) of the last matrix at local unknowns, ghosts included."""
        shared_factor(self.system).solve_owned(rows, self._step)
        self._rows.getArray()[:] = self._step
        self.system.layout.condensed_dm.globalToLocal(self._rows, self._local)
        return self._unknown.copy()

    def _largest(self, values: FloatArray) -> float:
        """Return the largest size of local values (n,) relative to the unknowns' scales; collective."""
        size = float(np.max(np.abs(values) / self.system.scale, initial=0.0))
        if self.system.comm.size > 1:
            size = max(self.system.comm.tompi4py().allgather(size))
        return size

    # ------------------------------------------------------------------ with multipliers: short implicit steps
    def _short_step(
        self, t: float, rate: FloatArray, start: tuple[FloatArray, FloatArray], shifts: tuple[float, float]
    ) -> bool:
        """Solve at ``t`` [s] from x, y ``start`` with the given rate of x at the start and the two shifts.

        False if Newton's method does not converge.
        """
        newton, asm, n = self.newton, self.system.assembly, self.system.layout.size
        x, y = start
        asm.v0[:n] = np.where(self.second, rate, 0.0) - shifts[0] * x
        asm.v1[:n] = np.where(self.second, -shifts[1] * y, 0.0)
        tolerance, work = newton.tolerance, newton.work
        newton.tolerance, newton.work = CONSTRAINED_TOLERANCE, None
        newton.discard_factor()
        try:
            reason = newton.solve(t, *shifts)
        finally:
            newton.tolerance, newton.work = tolerance, work
            newton.discard_factor()
        return reason >= 0

    def _by_small_steps(self, t: float) -> None:
        """Accelerations, first-order rates and multipliers at two later times, extrapolated to ``t`` [s].

        With x = x0 + tau x' + tau^2/2 w and y = y0 + tau w the constraints give w as well.
        """
        asm, n = self.system.assembly, self.system.layout.size
        x0, y0 = asm.x[:n].copy(), asm.y[:n].copy()
        for f in asm.row_replacements:
            f.evaluate(t, asm.x)
            y0[f.rows] += f.D.T @ (f.rate - f.D @ y0[f.rows])
        asm.y[:n] = y0
        rate = self.rate_of_unknowns()
        for step in CONSTRAINED_STEPS:
            found = []
            for tau in (step, 2 * step):
                asm.x[:n] = np.where(self.second, x0 + tau * rate, x0)
                if not self._short_step(t + tau, -rate, (x0, y0), (2 / tau, 1 / tau)):
                    break
                found.append(np.where(self.second, asm.a[:n], np.where(self.first, asm.y[:n], asm.x[:n])))
            if len(found) == 2:
                break
        else:
            raise SolveError(
                "the equations of motion and the constraints have no solution for the accelerations", time=t
            )
        # extrapolates linearly from tau and 2 tau to 0 (manual: sec-time-alpha-start)
        value = 2 * found[0] - found[1]
        asm.x[:n] = np.where(self.second | self.first, x0, value)
        asm.y[:n] = np.where(self.first, value, y0)
        asm.a[:n] = np.where(self.second, value, 0.0)

    def _impulse_by_a_step(self, t: float) -> None:
        """One implicit Euler step much shorter than any motion."""
        asm, n = self.system.assembly, self.system.layout.size
        x0, y0 = asm.x[:n].copy(), asm.y[:n].copy()
        shift = 1 / IMPULSE_STEP
        if not self._short_step(t + IMPULSE_STEP, np.zeros(n), (x0, y0), (shift, shift)):
            raise SolveError("the constraints cannot be fulfilled when a prescribed velocity jumps", time=t)
        y = asm.y[:n].copy()
        # rates jump, but positions of second-order unknowns do not
        asm.x[:n] = np.where(self.first, asm.x[:n], x0)
        asm.y[:n] = np.where(self.second, y, y0)

    # ------------------------------------------------------------------ derivatives of x
    def rate_of_unknowns(self) -> FloatArray:
        """Return the first derivative (n,) of second-order unknowns x: y without the transport of spin rates."""
        asm, n = self.system.assembly, self.system.layout.size
        rate = np.where(self.second, asm.y[:n], 0.0)
        if len(asm.spin_at):
            rate[asm.spin_at[:, 0]] -= asm.transport()
        return rate

    def second_derivative(self) -> FloatArray:
        """Return the second derivative (n,) of second-order unknowns x: a without the change of that transport."""
        asm, n = self.system.assembly, self.system.layout.size
        second = np.where(self.second, asm.a[:n], 0.0)
        if len(asm.spin_at):
            by_v, by_w = spin_derivatives(asm)
            tangent = asm.spin_at[:, 1:2] + np.arange(3)
            second[asm.spin_at[:, 0]] -= np.sum(by_v * asm.y[tangent] + by_w * asm.a[tangent], axis=1)
        return second
