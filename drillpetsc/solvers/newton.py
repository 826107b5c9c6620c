"""Modified Newton method on the condensed unknowns (manual: sec-time-newton).

Convergence is tested on scaled increments; the factorisation is reused while it converges fast enough.  The
rates of a step follow from the unknowns, y = shift x + v0 (manual: eq-time-condensed), so only the unknowns
are solved for (manual: eq-time-condensed-residual).  The solver is an inner PETSc SNES with the options
prefix ``q_``.
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
from petsc4py import PETSc

from drillpetsc import petsc_compat
from drillpetsc.fem.contact_entries import ContactEntries
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.kernels import function, pointer
from drillpetsc.parallel import all_true, joined, largest, total
from drillpetsc.solvers.chain_lu import ChainFactor, ChainPC, ZeroPivot
from drillpetsc.solvers.compiled_newton import CompiledNewton
from drillpetsc.solvers.newton_work import ResidualWork

_scaled_size = function("scaled_size", "ippdp", ctypes.c_double)
_work = function("work_along_step", "ippp", ctypes.c_double)
_finite_sum = function("finite_sum", "ip", ctypes.c_int)
_take_step, _shorten_step = function("take_step", "ipp"), function("shorten_step", "idpp")
#: relative spacing below which an unknown cannot be resolved (manual: eq-time-increment)
RESOLUTION = 64 * float(np.finfo(float).eps)
#: an increment that no longer shrinks and is below this fraction of the scales is rounding
ROUNDING_INCREMENT = 1e-10
#: the work of the residual asks for increments down to this fraction of the tolerance, and not below the other
#: value: further iterations change only rounding (manual: sec-time-work)
WORK_REFINEMENT, WORK_FINEST_INCREMENT = 1e-3, 1e-9
#: a step is shortened where its work afterwards is opposite and above this fraction (manual:
#: eq-time-line-search)
OVERSHOOT_FRACTION = 0.1
SHORTEST_STEP_FRACTION = 0.05
#: iterations of a solve that renew a factorisation in its contacts alone, before all of it (manual:
#: sec-time-contact-entries)
CONTACT_ITERATIONS = 5
Reason = PETSc.SNES.ConvergedReason


@dataclass
class Lag:
    """Conditions for the reuse of a factorisation, and its data (manual: sec-time-newton).

    shift_change: largest relative change of the shift [-].
    contraction: largest contraction of the last iteration [-].
    iterations: most iterations of a solve with the same factorisation.
    shift: shift of the factorisation [1/s].
    signature: contact signature at the factorisation; an opened or closed contact changes it.
    good: a factorisation exists.
    """

    shift_change: float = 0.2
    contraction: float = 0.25
    iterations: int = 4
    shift: float = 0.0
    signature: int = 0
    good: bool = False


class CondensedNewton:
    """Inner SNES of one discrete system; ``solve(t, shift)`` starts from and ends in the assembly's x.

    system: the discrete system.
    prefix: of the PETSc options.
    tolerance: of the estimated error of the scaled unknowns [-]; ``-q_snes_stol`` overrides it.
    lag: reuse factorisations.
    work: limit of the work that the residual may leave; None: increments alone are tested.

    jacobians, iterations, linear_iterations, failures, contact_updates: counters over all solves.
    """

    def __init__(
        self,
        system: DiscreteSystem,
        prefix: str = "q_",
        tolerance: float = 1e-6,
        lag: bool = True,
        work: ResidualWork | None = None,
    ):
        self.system, self.tolerance, self.work = system, tolerance, work
        self.t, self.shift, self.second_shift = 0.0, 0.0, 0.0
        self.lag = Lag() if lag else None
        self._turns_with_string = any(component.turns_with_string for component in system.components)
        self.jacobians = self.iterations = self.linear_iterations = self.failures = self.contact_updates = 0
        self.eta, self._last, self._first, self._theta = 1.0, 0.0, 0.0, 0.0
        self._renewed = 0  # iteration of this solve that renewed the contacts last
        self._factored, self._version = (
            0,
            -1,
        )  # of this solve: number of the last factorisation, version of its entries
        self.q, self._f = system.new_condensed(), system.new_condensed()
        owned = system.layout.local_of_owned
        self.scale = system.scale[owned]
        self._scale_at = pointer(self.scale)
        #: unknowns and residual (owned,) of the direct iteration
        self.arrays: tuple[np.ndarray, np.ndarray] | None = None
        self.last_iterations = 0
        self.snes = self._make_snes(prefix)
        compiled = self.direct and lag and system.comm.size == 1
        apart = self.direct and lag and system.has_contact
        self.contacts = ContactEntries(system) if apart else None
        self.compiled = self._compiled() if compiled else None

    def _make_snes(self, prefix: str) -> PETSc.SNES:
        system = self.system
        snes = PETSc.SNES().create(comm=system.comm)
        snes.setOptionsPrefix(prefix)
        snes.setFunction(self._function, self._f)
        self.matrix = petsc_compat.square_matrix(self.q)
        asm, layout = system.assembly, system.layout
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
            # Contact and friction make Newton overshoot.  "cp" finds the zero of the work of the rows along
            # the step from residuals alone; measured on the whirling 2000 m string it takes a third of the
            # iterations and no step fails.  With the balances of mud this work has no sign to search by, and
            # after a jump the search does not progress.
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
            self._iteration = _DirectIteration(self)
            snes.setPythonContext(self._iteration)
        snes.setFromOptions()
        self.max_iterations = snes.getTolerances()[3]
        self.tolerance = options.getReal("snes_stol", self.tolerance)
        self.line_search = options.getString("snes_linesearch_type", "basic")
        if not chosen:  # the next system in this process makes its own choice
            options.delValue("snes_linesearch_type")
        self.assembled = (
            pc.getType() != "python" or snes.getKSP().getType() != "preonly" or self.line_search == "bt"
        )
        if self.assembled:
            lgm = layout.condensed_dm.getLGMap().getIndices()
            rows, columns = (np.where(p >= 0, lgm[np.maximum(p, 0)], -1) for p in asm.places())
            petsc_compat.preallocate_coo(self.matrix, rows, columns)
        else:
            self.matrix.setUp()
            self.matrix.assemble()
        if pc.getType() == "python":
            self.factor = shared_factor(system)
            self.pc = ChainPC(self.factor, asm, stop=False)
            pc.setPythonContext(self.pc)
        snes.setUp()
        if self.direct:
            #: arrays of unknowns and residual, their addresses: the rows of a step are one compiled call
            self.arrays = self.q.getArray(), self._f.getArray()
            self._arrays_at = pointer(self.arrays[0]), pointer(self.arrays[1])
        return snes

    def _compiled(self) -> CompiledNewton:
        """The iteration in one compiled call; ``_DirectIteration`` has its parts."""
        limits = {
            "rounding": ROUNDING_INCREMENT,
            "overshoot": OVERSHOOT_FRACTION,
            "shortest": SHORTEST_STEP_FRACTION,
            "contact_iterations": CONTACT_ITERATIONS,
        }
        parts = self._iteration
        return CompiledNewton(self, parts.forces, parts.line_search, limits)

    # ------------------------------------------------------------------ callbacks
    def _evaluate(self) -> None:
        """Compute rates and accelerations from the assembly's x (manual: eq-time-condensed)."""
        asm = self.system.assembly
        asm.condense(self.shift, self.second_shift)
        if asm.row_replacements:
            asm.apply_prescribed_rates(self.t, self.second_shift)
        asm.apply_imposed_rates()

    def _function(self, snes, q, f) -> None:
        self.system.load_unknowns(q)
        self._evaluate()
        self.system.sum_residual(self.t, f)

    def rows(self, q: PETSc.Vec) -> np.ndarray:
        """Compute the residual at ``q``, owned rows; the next call overwrites the array."""
        if self.arrays is not None and q.handle == self.q.handle:
            at, ends, rows = self._arrays_at, self.system.ends, self.arrays[1]
            if self.system.assembly.step_rows(self.t, self.shift, self.second_shift, at, ends, rows):
                return rows
        self._function(None, q, self._f)
        return self._f.getArray(readonly=1)

    def last_rows(self) -> np.ndarray:
        """Return the residual (owned,) that was computed last: that of the last solve at its end."""
        return self._f.getArray(readonly=1) if self.arrays is None else self.arrays[1]

    def _jacobian(self, snes, q, J, P) -> None:
        if self.lag and self.lag.good and self.can_reuse_factor(snes.getIterationNumber()):
            return
        self.system.load_unknowns(q)
        self._evaluate()
        self.update_jacobian()
        if self.assembled:
            petsc_compat.set_values_coo(self.matrix, self.system.assembly.values)
        else:
            J.assemble()

    @property
    def weights(self) -> tuple[float, float, float]:
        """Weights of the Jacobian's parts [-, 1/s, 1/s2] (manual: eq-time-jacobian)."""
        shift, second = self.shift, self.second_shift
        return 1.0, shift, shift**2 if second == shift else shift * second

    def update_jacobian(self) -> None:
        """Compute the Jacobian's entries at the assembly's state (manual: eq-time-jacobian)."""
        self.system.assembly.jacobian(self.t, self.weights, condensed=True)
        self.jacobians += 1
        if self.lag:
            self.lag.shift, self.lag.good, self.lag.signature = (
                self.shift,
                True,
                self.system.contact_signature(),
            )
        self.eta = 1.0 if self.eta > 1.0 else max(self.eta, 1e-10) ** 0.8

    def factor_matrix(self) -> None:
        """Factor the matrix of the assembly's entries.  Raises ZeroPivot."""
        self.factor.factor(self.system.assembly.values)
        self.take_factor()

    def take_factor(self) -> None:
        """The direct solver now has the present entries of the assembly."""
        self._factored, self._version = self.factor.factorisations, self.system.assembly.version

    def contacts_suffice(self, contacts: ContactEntries, lag: Lag) -> bool:
        """Whether contacts can be renewed apart and are the likely cause of slow convergence: they have switched, or the contraction
        is poor; collective.

        A good contraction that takes many iterations is that of the other entries, which are old.
        """
        switched = self.system.contact_signature() != lag.signature
        anywhere = total(
            self.system.comm, np.array([switched, contacts.at_wall, contacts.hindered], dtype=float)
        )
        switched, at_wall, hindered = (anywhere > 0.0).tolist()
        return at_wall and not hindered and (self._theta > lag.contraction or switched)

    def update_contacts(self, its: int) -> bool:
        """Renew the entries of the contacts in the last factorisation, all others stay (manual: sec-time-contact-entries).

        Collective.  its: number of the iteration.  Returns False where that is not possible.  Raises ZeroPivot.
        """
        asm, lag = self.system.assembly, self.lag
        if (
            self.contacts is None
            or lag is None
            or not (lag.good and self.has_factor and self.has_entries)
            or abs(self.shift / lag.shift - 1.0) > lag.shift_change
            or not self.contacts_suffice(self.contacts, lag)
        ):
            return False
        first = self.contacts.update(self.t, self.weights)
        if first < self.contacts.nodes or self.system.comm.size > 1:
            self.factor.factor(asm.values, first)
        self.take_factor()
        lag.signature = self.system.contact_signature()
        self.contact_updates += 1
        self._renewed = its
        return True

    @property
    def has_factor(self) -> bool:
        """Whether the direct solver, which all solves of the system share, has the last factorisation of this one."""
        return self._factored == self.factor.factorisations

    @property
    def has_entries(self) -> bool:
        """Whether the assembly has the entries of the last factorisation."""
        return self._version == self.system.assembly.version

    @property
    def estimates(self) -> tuple[float, float, float, float]:
        """Convergence factor, scaled size of the last increment and of the first one, last contraction [-]."""
        return self.eta, self._last, self._first, self._theta

    @estimates.setter
    def estimates(self, values: tuple[float, float, float, float]) -> None:
        self.eta, self._last, self._first, self._theta = values

    def count(self, iterations: int, jacobians: int, contact_updates: int) -> None:
        """Count what a compiled solve has done."""
        self.last_iterations = iterations
        self.linear_iterations += iterations
        self.jacobians += jacobians
        self.contact_updates += contact_updates

    @property
    def spacing(self) -> float:
        """Relative spacing of numbers over the tolerance [-]: increments below it at the unknown's size (a depth of 2000 m) cannot be
        resolved."""
        return RESOLUTION / self.tolerance

    @property
    def finest(self) -> float:
        """Error [-] below which the work of the residual is not tested."""
        return max(WORK_REFINEMENT * self.tolerance, WORK_FINEST_INCREMENT)

    def true_on_all_ranks(self, local: bool) -> bool:
        """Whether ``local`` is true on all ranks; collective."""
        return all_true(self.system.comm, local)

    def can_reuse_factor(self, its: int) -> bool:
        """Whether the last factorisation may be used in iteration ``its``.

        The same on every rank, collective.
        """
        lag = self.lag
        assert lag is not None
        reusable = (
            abs(self.shift / lag.shift - 1.0) <= lag.shift_change
            and self._theta <= lag.contraction
            and its - self._renewed < lag.iterations
            and self.system.contact_signature() == lag.signature
        )
        if self.system.comm.size > 1 and self.system.has_contact:  # the signature is that of local contacts
            reusable = self.true_on_all_ranks(reusable)
        return reusable

    def _converged(self, snes, its, norms) -> int:
        step = snes.getSolutionUpdate().getArray(readonly=1) if its else np.zeros(0)
        rows = snes.getFunction()[0].getArray(readonly=1)
        return self.convergence_reason(its, step, rows, bool(np.isfinite(norms[2])))

    def convergence_reason(self, its: int, step: np.ndarray, rows: np.ndarray, finite: bool) -> int:
        """Test convergence after ``its`` iterations; collective.

        Manual: eq-time-increment, eq-time-convergence, eq-time-work.

        step: (owned,) last increment of the owned unknowns.
        rows: (owned,) residual after it; finite: it is finite.
        Returns a SNES reason, 0 to continue.
        """
        if not finite:
            return petsc_compat.not_a_number_reason()
        if its == 0:
            self._theta, self._renewed = 0.0, 0
            return 0
        unknowns = self.q.getArray(readonly=1)
        size: float = _scaled_size(len(step), pointer(step), self._scale_at, self.spacing, pointer(unknowns))
        if self.system.comm.size > 1:
            size = largest(self.system.comm, size)
        if its > 1 and self._last > 0:
            self._theta = size / self._last
            if self._theta >= 2.0 and its > 4 and size > self._first:
                return PETSc.SNES.ConvergedReason.DIVERGED_DTOL
            if self._theta > 0.5 and size < ROUNDING_INCREMENT:
                return PETSc.SNES.ConvergedReason.CONVERGED_SNORM_RELATIVE
            self.eta = self._theta / (1.0 - self._theta) if self._theta < 1.0 else 10.0
        self._first = size if its == 1 else self._first
        self._last = size
        if self.eta * size <= self.tolerance and (
            its >= self.max_iterations or not self._leaves_work(self.eta * size, rows)
        ):
            return PETSc.SNES.ConvergedReason.CONVERGED_SNORM_RELATIVE
        if its >= self.max_iterations:
            return PETSc.SNES.ConvergedReason.DIVERGED_MAX_IT
        return 0

    def _leaves_work(self, size: float, rows: np.ndarray) -> bool:
        """Whether another iteration is due because the residual does too much work; collective.

        Manual: eq-time-work.  size: estimated error of the scaled unknowns [-]; rows: (owned,) residual.
        """
        if self.work is None or self.work.limit <= 0.0:
            return False
        if size <= self.finest:
            return False
        return abs(self.work.power(rows)) > self.work.limit

    # ------------------------------------------------------------------ use
    def discard_factor(self) -> None:
        """Discard the factorisation and the estimate of the contraction."""
        self.eta = 1.0
        if self.lag:
            self.lag.good = False

    def get_state(self) -> dict[str, np.ndarray]:
        """Return the matrix entries of the factorisation and the convergence factor for a checkpoint.

        Collective.

        The result is complete on rank 0 and may be empty elsewhere.  On one rank the entries are those of the assembly itself, which
        the next Jacobian overwrites: with a copy a checkpoint would need a third more memory.
        newton: convergence factor [-] and shift [1/s].
        entries: entries of all ranks; shares: their number on each rank; signatures: contact signature of
        each rank.
        directions: (k, 7, 7) what these entries leave of the rows of each prescribed motion; places: their number on each rank.
        """
        lag, mpi = self.lag, self.system.comm.tompi4py()
        if lag is None or not lag.good or (self.direct and not self.has_factor):
            return {"newton": np.array([self.eta])}
        values = self.system.assembly.values
        applied = np.array([f.applied for f in self.system.assembly.row_replacements]).reshape(-1, 7, 7)
        counts = mpi.gather((len(values), lag.signature, len(applied)))
        entries, directions = joined(mpi, values), joined(mpi, applied)
        if entries is None:
            return {}
        shares, signatures, places = zip(*counts, strict=True)
        return {
            "newton": np.array([self.eta, lag.shift]),
            "entries": entries,
            "shares": np.array(shares),
            "signatures": np.array(signatures),
            "directions": directions,
            "places": np.array(places),
        }

    def set_state(self, state: dict[str, np.ndarray]) -> None:
        """Restore the factorisation from a checkpoint: ``state`` as returned by ``get_state``; collective.

        On another number of ranks the entries are distributed differently, and only the convergence factor is
        used.
        """
        asm, mpi = self.system.assembly, self.system.comm.tompi4py()
        self.discard_factor()
        self.eta = float(state["newton"][0])
        shares = state.get("shares")
        fits = shares is not None and len(shares) == mpi.size and shares[mpi.rank] == len(asm.values)
        if self.lag is None or shares is None or not self.true_on_all_ranks(bool(fits)):
            return
        start = int(shares[: mpi.rank].sum())
        asm.values[:] = state["entries"][start : start + len(asm.values)]
        places = state.get("places", [len(asm.row_replacements)] if mpi.size == 1 else [])
        first = int(np.sum(places[: mpi.rank]))
        stored = state["directions"][first:] if len(places) == mpi.size and "directions" in state else ()
        for f, directions in zip(asm.row_replacements, stored, strict=False):
            f.applied[:] = directions
        asm.version += 1
        self.lag.shift, self.lag.signature, self.lag.good = (
            float(state["newton"][1]),
            int(state["signatures"][mpi.rank]),
            True,
        )
        if self.direct:
            self.factor_matrix()
        elif self.assembled:
            petsc_compat.set_values_coo(self.matrix, asm.values)
        else:
            self.matrix.assemble()

    def solve(self, t: float, shift: float, second_shift: float | None = None) -> int:
        """Solve at time ``t`` [s] with rates y = ``shift`` x + v0, shift in 1/s; collective.

        second_shift: da/dy [1/s] of the accelerations a = second_shift y + v1, ``shift`` unless given.
        Returns the SNES reason; it is negative where the iteration did not converge.
        """
        self.t, self.shift = t, shift
        self.second_shift = shift if second_shift is None else second_shift
        if self.lag and self._turns_with_string:  # the Jacobian turns with the string
            self.lag.good = False
        # the convergence factor of one step counts less in the next one (Hairer and Wanner, Solving ODEs II,
        # IV.8)
        self.eta = 1.0 if self.eta > 1.0 else max(self.eta, 1e-10) ** 0.8
        if self.lag and self.lag.good:
            # a factorisation at another shift leaves an error of this fraction in each iteration
            mismatch = abs((shift / self.lag.shift) ** 2 - 1.0)
            self.eta = max(self.eta, mismatch / max(1.0 - mismatch, 0.1))
        reason = None if self.compiled is None else self.compiled.solve()
        if reason is None:
            reason = self._solve_in_parts()
        self.iterations += self.last_iterations
        if reason < 0:
            self.failures += 1
            if self.lag:
                self.lag.good = False
        return reason

    def _solve_in_parts(self) -> int:
        """Solve with PETSc's SNES from the assembly's x; returns its reason."""
        self.system.store_unknowns(self.q)
        with petsc_compat.own_errors():
            self.snes.solve(None, self.q)
        self.last_iterations = self.snes.getIterationNumber()
        if (
            not self.direct
        ):  # else the assembly has the state of the last rows, which are those of the solution
            self.linear_iterations += self.snes.getLinearSolveIterations()
            self.system.load_unknowns(self.q)
            self._evaluate()
        return self.snes.getConvergedReason()


class _DirectIteration:
    """Context of the python SNES of a ``CondensedNewton``: one residual an iteration, steps shortened only on
    overshoot.

    Any ``-q_snes_type`` replaces it.  ``newtonls`` with line search ``cp`` needs two more residuals an
    iteration, even where the full step is good.
    """

    def __init__(self, newton: CondensedNewton):
        self.newton = newton
        self.line_search = newton.system.has_contact
        layout = newton.system.layout
        forces = np.array([f.does_work for f in layout.fields])[layout.field_of[layout.local_of_owned]]
        self.forces = None if forces.all() else np.flatnonzero(forces)
        self.step = np.zeros(len(newton.system.layout.local_of_owned))
        self._step_at = pointer(self.step)
        self._chosen = np.flatnonzero(forces).astype(np.int32)
        self.log = PETSc.Log.Event("ChainFactor"), PETSc.Log.Event("ChainSolve")

    def solve(self, snes, b, x) -> None:
        """Iterate from ``x``; set reason and number of iterations of ``snes``."""
        its, reason = self._iterate(x)
        snes.setIterationNumber(its)
        snes.setConvergedReason(reason)

    def _iterate(self, x) -> tuple[int, int]:
        newton, step = self.newton, self.step
        unknowns = x.getArray()  # shares memory with the vector
        rows = newton.rows(x)
        reason = newton.convergence_reason(0, step, rows, self._finite(rows))
        its = 0
        while not reason:
            if not self._prepare(its):
                return its, Reason.DIVERGED_LINEAR_SOLVE
            self.log[1].begin()
            newton.factor.solve_owned(rows, step)
            self.log[1].end()
            _take_step(len(step), self._step_at, pointer(unknowns))
            before = self._work_along_step(rows) if self.line_search else 0.0
            rows = newton.rows(x)
            if self.line_search:
                rows = self._shorten(x, unknowns, rows, before)
            its += 1
            newton.linear_iterations += 1
            reason = newton.convergence_reason(its, step, rows, self._finite(rows))
        return its, reason

    def _finite(self, rows: np.ndarray) -> bool:
        finite = bool(_finite_sum(len(rows), pointer(rows)))
        if self.newton.system.comm.size > 1:
            finite = self.newton.true_on_all_ranks(finite)
        return finite

    def _prepare(self, its: int) -> bool:
        """Factorise, unless the last factorisation can be reused; False where the matrix has no pivot."""
        newton = self.newton
        if newton.lag and newton.lag.good and newton.has_factor and newton.can_reuse_factor(its):
            return True
        self.log[0].begin()
        try:
            if its < CONTACT_ITERATIONS and newton.update_contacts(its):
                return True
            newton.update_jacobian()
            newton.factor_matrix()
        except ZeroPivot:
            if newton.lag:
                newton.lag.good = False
            return False
        finally:
            self.log[0].end()
            PETSc.Log.logFlops(newton.factor.factor_flops)
        return True

    def _work_along_step(self, rows: np.ndarray) -> float:
        """Compute the work [J] of this rank's rows along the step, over the rows that are forces."""
        chosen = None if self.forces is None else pointer(self._chosen)
        count = len(rows) if chosen is None else len(self._chosen)
        work: float = _work(count, chosen, pointer(rows), self._step_at)
        return work

    def _shorten(self, x, unknowns: np.ndarray, rows: np.ndarray, before: float) -> np.ndarray:
        """Shorten a step that overshoots by one secant step (manual: eq-time-line-search); collective.

        before: this rank's work along the step before it [J].  Returns the residual at the shortened step.
        """
        newton, step = self.newton, self.step
        after = self._work_along_step(rows)
        if newton.system.comm.size > 1:
            before, after = total(newton.system.comm, [before, after]).tolist()
        if not (before < 0.0 and after > -OVERSHOOT_FRACTION * before):
            return rows
        fraction = max(SHORTEST_STEP_FRACTION, before / (before - after))
        _shorten_step(len(step), fraction, self._step_at, pointer(unknowns))
        return newton.rows(x)


def chain_factor(system: DiscreteSystem) -> ChainFactor:
    """Create the direct solver for the system's chain of nodes (manual: sec-chain)."""
    layout, asm = system.layout, system.assembly
    # the pivot of a constraint is of the order of the squared step, without cancellation, so a small one does
    # not mean a singular matrix
    smallest = 1e-25 if system.multipliers else 1e-15
    return ChainFactor(
        system.comm,
        layout.chain.vertices,
        layout.vertex_of,
        layout.local_of_owned,
        *asm.places(),
        pivot_tolerance=smallest,
    )


_shared_factors: WeakKeyDictionary[DiscreteSystem, ChainFactor] = WeakKeyDictionary()


def shared_factor(system: DiscreteSystem) -> ChainFactor:
    """Return the direct solver that all solves of a system share, created at the first call.

    Its tables take longer than a factorisation, and factors are the second largest part of a model in memory.  A caller factors
    before it solves; one that uses its factors again first compares ``factorisations``.
    """
    if system not in _shared_factors:
        _shared_factors[system] = chain_factor(system)
    return _shared_factors[system]
