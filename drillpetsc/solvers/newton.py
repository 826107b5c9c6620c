"""Newton's method on the condensed unknowns: convergence by scaled increments, a factor that is kept while it
serves.

The velocities of a step follow from the unknowns (y = shift x + v0), so only the unknowns are solved for: an
inner PETSc SNES with prefix ``q_``, whose options all work.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from petsc4py import PETSc

from drillpetsc import petsc_compat
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.solvers.chain_lu import ChainFactor, ChainPC, ZeroPivot

ROUNDING = 64 * np.finfo(float).eps
STALLED = 1e-10  # an increment that no longer falls below this share of the scales is rounding


OVERSHOOT = 0.1  # a step is shortened when the rows afterwards point back along it by more than this share
SHORTEST = 0.05
Reason = PETSc.SNES.ConvergedReason


@dataclass
class Lag:
    """When a kept Jacobian still serves: same shift within ``shift_change``, contraction below
    ``contraction``, at most
    ``iterations`` taken with it, contact unchanged."""

    shift_change: float = 0.2
    contraction: float = 0.25
    iterations: int = 4
    shift: float = 0.0
    signature: int = 0
    good: bool = False


class CondensedNewton:
    """Inner SNES of one model; ``solve(t, shift)`` starts from and ends in the assembly's x."""

    def __init__(self, system: DiscreteSystem, prefix: str = "q_", tolerance: float = 1e-6, lag: bool = True):
        self.system, self.tolerance = system, tolerance
        self.t, self.shift = 0.0, 0.0
        self.lag = Lag() if lag else None
        self._turning = any(component.turns_with_string for component in system.components)
        self.jacobians = self.newton = self.linear = self.failures = 0
        self.eta, self._last, self._first, self._theta = 1.0, 0.0, 0.0, 0.0
        self.q, self._f = system.new_condensed(), system.new_condensed()
        owned = system.layout.local_of_owned
        self._scale = system.scale[owned]
        self.snes = self._make_snes(prefix)

    def _make_snes(self, prefix: str) -> PETSc.SNES:
        system = self.system
        snes = PETSc.SNES().create(comm=system.comm)
        snes.setOptionsPrefix(prefix)
        snes.setFunction(self._function, self._f)
        self.matrix = petsc_compat.square_matrix(self.q)
        asm, layout = system.assembly, system.layout
        lgm = layout.condensed_dm.getLGMap().getIndices()
        rows = np.where(asm.rows >= 0, lgm[np.maximum(asm.rows, 0)], -1)
        columns = np.where(asm.columns >= 0, lgm[np.maximum(asm.columns, 0)], -1)
        self._coo = (rows, columns)
        snes.setJacobian(self._jacobian, self.matrix)
        snes.setConvergenceTest(self._converged)
        snes.setType("newtonls")
        snes.setTolerances(rtol=0.0, atol=0.0, stol=0.0, max_it=25)
        snes.getKSP().setType("preonly")
        pc = snes.getKSP().getPC()
        pc.setType("python")
        options = PETSc.Options(prefix)
        chosen = options.hasName("snes_linesearch_type")
        if not chosen:
            # contact and friction make Newton overshoot; "cp" finds where the rows stop pointing along the
            # step, by residuals alone
            # (measured on the whirling 2000 m string: a third of the iterations, no failed step)
            # mixed with the balances of mud, rows along the step have no meaning: after a jump the search
            # stands still
            forces = all(f.does_work for f in system.layout.fields)
            options.setValue("snes_linesearch_type", "cp" if system.has_contact and forces else "basic")
        petsc_names = (
            "snes_type",
            "snes_linesearch_type",
            "ksp_type",
            "pc_type",
            "snes_monitor",
            "snes_converged_reason",
            "ksp_monitor",
        )
        self.direct = (
            not any(options.hasName(name) for name in petsc_names if name != "snes_linesearch_type")
            and not chosen
        )
        if self.direct:
            snes.setType("python")
            snes.setPythonContext(_DirectIteration(self))
        snes.setFromOptions()
        self.most = snes.getTolerances()[3]
        self.tolerance = options.getReal("snes_stol", self.tolerance)
        self.line_search = options.getString("snes_linesearch_type", "basic")
        if not chosen:  # the next scene chooses for itself
            options.delValue("snes_linesearch_type")
        self.assembled = (
            pc.getType() != "python" or snes.getKSP().getType() != "preonly" or self.line_search == "bt"
        )
        if self.assembled:
            petsc_compat.preallocate_coo(self.matrix, rows, columns)
        else:
            self.matrix.setUp()
            self.matrix.assemble()
        if pc.getType() == "python":
            self.factor = chain_factor(system)
            self.pc = ChainPC(self.factor, asm, stop=False)
            pc.setPythonContext(self.pc)
        snes.setUp()
        return snes

    # ------------------------------------------------------------------ callbacks
    def _evaluate(self) -> None:
        asm = self.system.assembly
        asm.condense(self.shift)
        if asm.row_replacements:
            asm.apply_prescribed_rates(self.t, self.shift)
        asm.apply_imposed_rates()

    def _function(self, snes, q, f) -> None:
        self.system.load_unknowns(q)
        self._evaluate()
        self.system.sum_residual(self.t, f)

    def rows(self, q: PETSc.Vec) -> np.ndarray:
        """Residual at ``q``, owned rows; the array is the solver's own and changes with the next call."""
        self._function(None, q, self._f)
        return self._f.getArray(readonly=1)

    def _jacobian(self, snes, q, J, P) -> None:
        if self.lag and self.lag.good and self.still_serves(snes.getIterationNumber()):
            return
        self.system.load_unknowns(q)
        self._evaluate()
        self.renew_jacobian()
        if self.assembled:
            petsc_compat.set_values_coo(self.matrix, self.system.assembly.values)
        else:
            J.assemble()

    def renew_jacobian(self) -> None:
        """New entries at the assembly's state."""
        self.system.assembly.jacobian(self.t, (1.0, self.shift, self.shift**2), condensed=True)
        self.jacobians += 1
        if self.lag:
            self.lag.shift, self.lag.good, self.lag.signature = (
                self.shift,
                True,
                self.system.contact_signature(),
            )
        self.eta = 1.0 if self.eta > 1.0 else max(self.eta, 1e-10) ** 0.8

    def all_ranks_agree(self, on_rank: bool) -> bool:
        """Whether all ranks say yes."""
        return bool(self.system.comm.tompi4py().allreduce(int(on_rank), op=_min()))

    def still_serves(self, its: int) -> bool:
        """Whether the kept factor may be used again; the same answer on every rank."""
        lag = self.lag
        assert lag is not None
        serves = (
            abs(self.shift / lag.shift - 1.0) <= lag.shift_change
            and self._theta <= lag.contraction
            and its < lag.iterations
            and self.system.contact_signature() == lag.signature
        )
        if self.system.comm.size > 1 and self.system.has_contact:  # each rank sees its own contacts only
            serves = self.all_ranks_agree(serves)
        return serves

    def _converged(self, snes, its, norms) -> int:
        step = snes.getSolutionUpdate().getArray(readonly=1) if its else np.zeros(0)
        return self.convergence_reason(its, step, bool(np.isfinite(norms[2])))

    def convergence_reason(self, its: int, step: np.ndarray, finite: bool) -> int:
        """Reason after ``its`` iterations, the last of which moved the owned unknowns by ``step``; 0: go
        on."""
        if not finite:
            return petsc_compat.not_a_number_reason()
        if its == 0:
            self._theta = 0.0
            return 0
        # below the spacing of numbers at the unknown's own size (a depth of 2000 m) nothing can be resolved
        floor = (ROUNDING / self.tolerance) * np.abs(self.q.getArray(readonly=1))
        size = float(np.max(np.abs(step) / np.maximum(self._scale, floor), initial=0.0))
        if self.system.comm.size > 1:
            size = float(self.system.comm.tompi4py().allreduce(size, op=_max()))
        if its > 1 and self._last > 0:
            self._theta = size / self._last
            if self._theta >= 2.0 and its > 4 and size > self._first:
                return PETSc.SNES.ConvergedReason.DIVERGED_DTOL
            if self._theta > 0.5 and size < STALLED:
                return PETSc.SNES.ConvergedReason.CONVERGED_SNORM_RELATIVE
            self.eta = self._theta / (1.0 - self._theta) if self._theta < 1.0 else 10.0
        self._first = size if its == 1 else self._first
        self._last = size
        if self.eta * size <= self.tolerance:
            return PETSc.SNES.ConvergedReason.CONVERGED_SNORM_RELATIVE
        if its >= self.most:
            return PETSc.SNES.ConvergedReason.DIVERGED_MAX_IT
        return 0

    # ------------------------------------------------------------------ use
    def forget(self) -> None:
        """Drop the kept factor and what was learned about convergence."""
        self.eta = 1.0
        if self.lag:
            self.lag.good = False

    def get_state(self) -> dict[str, np.ndarray]:
        """The kept factor, as the entries it was made of, and what was learned about convergence; whole on
        rank 0.  Collective."""
        lag, mpi = self.lag, self.system.comm.tompi4py()
        if lag is None or not lag.good:
            return {"newton": np.array([self.eta])}
        on_rank = self.system.assembly.values
        parts = [(on_rank, lag.signature)] if mpi.size == 1 else mpi.gather((on_rank, lag.signature))
        if parts is None:
            return {}
        return {
            "newton": np.array([self.eta, lag.shift]),
            "entries": np.concatenate([p[0] for p in parts]),
            "shares": np.array([len(p[0]) for p in parts]),
            "signatures": np.array([p[1] for p in parts]),
        }

    def set_state(self, memory: dict[str, np.ndarray]) -> None:
        """Take up a memory; of one left by another number of ranks only the convergence, as their entries are
        shared out differently."""
        asm, mpi = self.system.assembly, self.system.comm.tompi4py()
        self.forget()
        self.eta = float(memory["newton"][0])
        shares = memory.get("shares")
        fits = shares is not None and len(shares) == mpi.size and shares[mpi.rank] == len(asm.values)
        if self.lag is None or shares is None or not self.all_ranks_agree(bool(fits)):
            return
        start = int(shares[: mpi.rank].sum())
        asm.values[:] = memory["entries"][start : start + len(asm.values)]
        asm.version += 1
        self.lag.shift, self.lag.signature, self.lag.good = (
            float(memory["newton"][1]),
            int(memory["signatures"][mpi.rank]),
            True,
        )
        if self.direct:
            self.factor.factor(asm.values)
        elif self.assembled:
            petsc_compat.set_values_coo(self.matrix, asm.values)
        else:
            self.matrix.assemble()

    def solve(self, t: float, shift: float) -> int:
        """Solve at time ``t`` with rates y = shift x + v0; returns the SNES reason (negative: not
        converged)."""
        self.t, self.shift = t, shift
        if self.lag and self._turning:  # unknowns that turn with the string take the Jacobian along
            self.lag.good = False
        # what one step showed of the contraction is trusted less in the next (Hairer and Wanner, Solving ODEs
        # II, IV.8)
        self.eta = 1.0 if self.eta > 1.0 else max(self.eta, 1e-10) ** 0.8
        if (
            self.lag and self.lag.good
        ):  # a factor made for another step length leaves an error of this share in each iteration
            off = abs((shift / self.lag.shift) ** 2 - 1.0)
            self.eta = max(self.eta, off / max(1.0 - off, 0.1))
        self.system.store_unknowns(self.q)
        with petsc_compat.own_errors():
            self.snes.solve(None, self.q)
        self.newton += self.snes.getIterationNumber()
        if not self.direct:
            self.linear += self.snes.getLinearSolveIterations()
        reason = self.snes.getConvergedReason()
        if reason < 0:
            self.failures += 1
            if self.lag:
                self.lag.good = False
        self.system.load_unknowns(self.q)
        self._evaluate()
        return reason


class _DirectIteration:
    """Context of the python SNES of a ``CondensedNewton``: one residual an iteration, steps shortened only on overshoot.

    Any ``-q_snes_type`` takes its place.  Against ``newtonls`` with line search ``cp`` it saves the two residuals per
    iteration that the search spends even where the full step is fine.
    """

    def __init__(self, owner):
        self.owner = owner
        self.searches = owner.system.has_contact
        layout = owner.system.layout
        forces = np.array([f.does_work for f in layout.fields])[layout.field_of[layout.local_of_owned]]
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


def _max():
    from mpi4py import MPI

    return MPI.MAX


def _min():
    from mpi4py import MPI

    return MPI.MIN


def chain_factor(system: DiscreteSystem) -> ChainFactor:
    """The direct solver for this model's chain of nodes."""
    layout, asm = system.layout, system.assembly
    # a constraint's pivot is of the order of the step's square, without cancellation: small is no sign of a
    # singular matrix there
    smallest = 1e-25 if system.multipliers else 1e-15
    return ChainFactor(
        system.comm,
        layout.chain.vertices,
        layout.vertex_of,
        layout.local_of_owned,
        asm.rows,
        asm.columns,
        pivot_tolerance=smallest,
    )
