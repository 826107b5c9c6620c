"""Derivatives of a run by parameters, computed in each accepted step from its own equations (manual: sec-sensitivities-steps).

Systems beside the run have a parameter changed a little. Their rows at the run's state give the right side, for which the Jacobian at
the accepted state is factored once a step.  No system beside the run is solved.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.errors import SolveError
from drillpetsc.fem.assembly import spin_derivatives
from drillpetsc.solvers.time.beside_rows import Beside, BesideRows
from drillpetsc.solvers.time.consistent_start import ConsistentStart
from drillpetsc.solvers.time.formula_derivatives import AlphaDerivatives, BdfDerivatives
from drillpetsc.solvers.time.generalized_alpha import GeneralizedAlpha
from drillpetsc.solvers.time.newton import CondensedNewton
from drillpetsc.solvers.time.time_integrator import TimeIntegrator

SAME_SHIFT = 1e-9  # relative: the formula here is the integrator's


class StepTangent:
    """Derivatives of x, y, a by k parameters; it follows an integrator from its start on.

    groups: of each parameter, the systems beside the run, in their states at the start.

    x, y, a: (k, n) derivatives at the accepted state.
    """

    def __init__(self, integrator: TimeIntegrator, groups: Sequence[Sequence[Beside]]) -> None:
        self.integrator, self.system, self.groups = integrator, integrator.system, groups
        layout, system = self.system.layout, self.system
        n, k = layout.size, len(groups)
        self.x, self.y, self.a = (np.zeros((k, n)) for _ in range(3))
        self._two = np.array([f.second_order for f in layout.fields])[layout.field_of]
        self.formula: AlphaDerivatives | BdfDerivatives
        self._starts: list[list[ConsistentStart]] = []
        if isinstance(integrator, GeneralizedAlpha):
            self.formula = AlphaDerivatives(integrator.formula, self._two, k)
            self._starts = [[ConsistentStart(CondensedNewton(b.system)) for b in group] for group in groups]
        else:
            self.formula = BdfDerivatives(integrator.order, self._two)
        self._remember = any(b.system._remembering for group in groups for b in group)
        self._beside, self._step = BesideRows(system, groups), np.zeros(len(layout.local_of_owned))
        self._reference = system.assembly.reference.copy()
        self._take_states(rates=True)
        integrator.follower = self
        integrator.after_step.append(self._follow)

    # ------------------------------------------------------------------ states of the systems beside the run
    def _difference(self, k: int, values: Sequence[FloatArray]) -> FloatArray:
        """The derivative by the parameter ``k`` of values at the systems beside the run."""
        return np.asarray(sum(b.weight * v for b, v in zip(self.groups[k], values, strict=True)))

    def _take_states(self, rates: bool) -> None:
        """Take the derivatives from the states of the systems."""
        n = self.system.layout.size
        for k, group in enumerate(self.groups):
            self.x[k] = self._difference(k, [b.system.assembly.x[:n] for b in group])
            if rates:
                self.y[k] = self._difference(k, [b.system.assembly.y[:n] for b in group])

    # ------------------------------------------------------------------ called by the integrator
    def change_states(self, t: float, changed: bool) -> None:
        """An input jumps or bends at ``t`` [s]: components may change states; changed: the run's have."""
        self._beside.place_all(self.x, self.y, self.a)
        for group in self.groups:
            for beside in group:
                for component in beside.system.components:
                    component.at_break(t, beside.system.assembly)
        if changed:
            self._take_states(rates=True)

    def start(self, t: float, jumped: bool) -> None:
        """The formula starts at ``t`` [s]; jumped: a prescribed velocity jumps."""
        if isinstance(self.formula, BdfDerivatives):
            self.formula.start(t, self.x, self.y)
            return
        n = self.system.layout.size
        more = [np.zeros_like(self.x), np.zeros_like(self.x)]
        self._beside.place_all(self.x, self.y, self.a)
        for k, (group, starts) in enumerate(zip(self.groups, self._starts, strict=True)):
            found = []
            for beside, begin in zip(group, starts, strict=True):
                asm = beside.system.assembly
                asm.invalidate_prescribed_values()
                if jumped:
                    begin.jump(t)
                begin.accelerations(t)
                found.append((begin.rate_of_unknowns(), begin.second_derivative()))
            for i, out in enumerate(more):
                out[k] = self._difference(k, [q[i] for q in found])
            self.y[k] = self._difference(k, [b.system.assembly.y[:n] for b in group])
            self.a[k] = self._difference(k, [b.system.assembly.a[:n] for b in group])
        self._take_states(rates=True)
        self.formula.start(t, self.x, self.y, self.a, *more)

    def stage(self, t: float, step: float) -> None:
        """A stage of the first step of length ``step`` [s] is solved, at ``t`` [s]."""
        if isinstance(self.formula, BdfDerivatives):
            if not self.formula.begins_with_half(t, step):
                return
        self.formula.try_stage(t, *self._solve(t))

    def _follow(self, t: float, dt: float) -> None:
        """A step to ``t`` [s] is accepted."""
        if not np.array_equal(self._reference, self.system.assembly.reference):
            raise SolveError(
                "sensitivities of a string that tumbles, whose reference frames are renewed, are not computed",
                time=t,
            )
        self.x, self.y, self.a = self._solve(t)
        self.formula.advance(t, self.x, self.y, self.a)
        if self._remember:
            self._beside.place_all(self.x, self.y, self.a)
            for group in self.groups:
                for beside in group:
                    beside.system.accept(t)

    # ------------------------------------------------------------------ a step
    def _solve(self, t: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Derivatives (k, n) of x, y, a at the present state, which solves a step to ``t`` [s] (manual: eq-sensitivities-step)."""
        system, asm, newton = self.system, self.system.assembly, self.integrator.newton
        shift, v0, v1 = self.formula.constants(t)
        if abs(shift - newton.shift) > SAME_SHIFT * newton.shift:
            raise SolveError(
                f"the shift of the formula is {newton.shift!r}, that of its derivatives {shift!r}", time=t
            )
        second = newton.second_shift
        self._refresh()
        by_v, by_w = spin_derivatives(asm)
        spin, tangent = asm.spin_at[:, 0], asm.spin_at[:, 1:2] + np.arange(3)
        # a guess with the last rates, so that the systems beside the run differ little from it; prescribed unknowns are known before
        # the solve, in whose matrix they have rates
        given = self._beside.prescribed(newton.t)
        guess = np.where(self._two, (self.y - v0) / shift, self.x)
        for f in asm.row_replacements:
            guess[:, f.rows] = guess[:, f.rows] @ f.complement + given[:, f.rows]

        def rates(x: FloatArray) -> FloatArray:
            y = shift * x + v0
            if len(spin):
                y[:, spin] += np.einsum("ij,kij->ki", by_v, x[:, tangent]) + np.einsum(
                    "ij,kij->ki", by_w, y[:, tangent]
                )
            return y

        x, dy = guess.copy(), rates(guess)
        da = second * dy + v1
        self._beside.prepare(newton.t, shift, second)
        rows = -self._beside.derivative((guess, dy, da, np.asarray(v1)), newton.t, second)
        assert newton.factor is not None
        for k, q in enumerate(rows):
            newton.factor.solve_owned(q, self._step)
            x[k, system.layout.local_of_owned] += self._step
            if system.ends is not None:
                system.ends.spread(x[k])
        held = [
            [
                self._difference(k, [b.system.assembly.y[f.rows] for b in group])
                for k, group in enumerate(self.groups)
            ]
            for f in asm.row_replacements
        ]
        y = rates(x)
        for i, f in enumerate(asm.row_replacements):
            # along prescribed directions the rate is given, and not that of the formula
            moved = (y - dy)[:, f.rows] @ f.complement
            y[:, f.rows] = moved + np.array(held[i])
            if f.leans:
                node = int(np.flatnonzero(spin == f.rows[6])[0])
                y[:, f.rows[6]] += (x - guess)[:, tangent[node]] @ by_v[node] + moved[:, 3:6] @ by_w[node]
        return x, y, second * y + v1

    def _refresh(self) -> None:
        """Factor the Jacobian at the present state; Newton's method goes on with it."""
        newton = self.integrator.newton
        iteration = newton.iteration
        iteration.compute_entries()
        iteration.take_entries()
        assert newton.factor is not None
        newton.factor.factor(self.system.assembly.values)
        iteration.take_factor()

    def balance(self, t: float) -> None:
        """Move the systems along the derivatives, and find their reactions; ``t``: of the inputs [s]."""
        self._beside.balance(self.x, self.y, self.a, t)
