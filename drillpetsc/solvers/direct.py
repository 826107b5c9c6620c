"""The default Newton iteration of a step: chain factor, one residual an iteration, steps shortened only where
they overshoot.

It is an SNES of type python, so any ``-q_snes_type`` takes its place.  What it saves against ``newtonls``
with line search ``cp`` are the two residuals per iteration that the search spends even where the full step is
fine.
"""

from __future__ import annotations

import math

import numpy as np
from petsc4py import PETSc

from drillpetsc.fem.component import Field
from drillpetsc.solvers.chain_lu import ZeroPivot

OVERSHOOT = 0.1  # a step is shortened when the rows afterwards point back along it by more than this share
SHORTEST = 0.05
Reason = PETSc.SNES.ConvergedReason


def does_work(field: Field) -> bool:
    """Whether the rows of a field are forces along its unknowns: those of the string, not constraints, and
    not the balances of mud, whose product with a step has no sign to search by."""
    return (
        not field.multiplier
        and field.name.split(".")[0] not in ("bore", "annulus")
        and field.name != "bit.flow"
    )


class DirectNewton:
    """Context of the python SNES; ``owner`` is the CondensedNewton whose callbacks and books it uses."""

    def __init__(self, owner):
        self.owner = owner
        self.searches = owner.system.has_contact
        layout = owner.system.layout
        forces = np.array([does_work(f) for f in layout.fields])[layout.field_of[layout.local_of_owned]]
        self.forces = None if forces.all() else np.flatnonzero(forces)
        self.step = np.zeros(len(owner.system.layout.local_of_owned))
        self.log = PETSc.Log.Event("ChainFactor"), PETSc.Log.Event("ChainSolve")

    def solve(self, snes, b, x) -> None:
        """Iterate from ``x``; leaves the reason and the number of iterations in ``snes``."""
        its, reason = self._iterate(x)
        snes.setIterationNumber(its)
        snes.setConvergedReason(reason)

    def _iterate(self, x) -> tuple[int, int]:
        owner, step = self.owner, self.step
        unknowns = x.getArray()  # of the vector itself
        rows = owner.rows(x)
        reason = owner.convergence_reason(0, step, self._finite(rows))
        its = 0
        while not reason:
            if not self._prepare(its):
                return its, Reason.DIVERGED_LINEAR_SOLVE
            self.log[1].begin()
            owner.factor.solve_owned(rows, step)
            self.log[1].end()
            np.negative(step, out=step)
            before = self._along(rows) if self.searches else 0.0
            unknowns += step
            rows = owner.rows(x)
            if self.searches:
                rows = self._shorten(x, unknowns, rows, before)
            its += 1
            owner.linear += 1
            reason = owner.convergence_reason(its, step, self._finite(rows))
        return its, reason

    def _finite(self, rows: np.ndarray) -> bool:
        good = math.isfinite(np.add.reduce(rows))  # without the wrapping of rows.sum()
        if self.owner.system.comm.size > 1:
            good = self.owner.all_ranks_agree(good)
        return good

    def _prepare(self, its: int) -> bool:
        """A factor that serves; False when the matrix has no pivot."""
        owner = self.owner
        if owner.lag and owner.lag.good and owner.still_serves(its):
            return True
        owner.renew_jacobian()
        self.log[0].begin()
        try:
            owner.factor.factor(owner.system.assembly.values)
        except ZeroPivot:
            owner.lag.good = False
            return False
        finally:
            self.log[0].end()
            PETSc.Log.logFlops(owner.factor.factor_flops)
        return True

    def _along(self, rows: np.ndarray) -> float:
        """Work of the rows along the step, of those that are forces."""
        if self.forces is None:
            return float(rows @ self.step)
        return float(rows[self.forces] @ self.step[self.forces])

    def _shorten(self, x, unknowns: np.ndarray, rows: np.ndarray, before: float) -> np.ndarray:
        """Go back along the step to where the rows no longer point along it (one secant), if it went too
        far."""
        owner, step = self.owner, self.step
        after = self._along(rows)
        if owner.system.comm.size > 1:
            before, after = owner.system.comm.tompi4py().allreduce(np.array([before, after]))
        if not (before < 0.0 and after > -OVERSHOOT * before):
            return rows
        share = max(SHORTEST, before / (before - after))
        unknowns += (share - 1.0) * step
        step *= share
        return owner.rows(x)
