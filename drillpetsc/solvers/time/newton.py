"""Modified Newton method on the condensed unknowns (manual: sec-time-newton).

Convergence is tested on scaled increments; the factorisation is reused while it converges fast enough.  The
rates of a step follow from the unknowns, y = shift x + v0 (manual: eq-time-condensed), so only the unknowns
are solved for (manual: eq-time-condensed-residual).  ``NewtonIteration`` iterates; any of PETSc's options that chooses
another solver, with the prefix ``q_``, puts an SNES in its place, with the same tests.
"""

from __future__ import annotations

from weakref import WeakKeyDictionary

import numpy as np
from petsc4py import PETSc

from drillpetsc import petsc_compat
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.kernels import pointer
from drillpetsc.parallel import all_true, joined
from drillpetsc.solvers.chain.chain_lu import ChainFactor, ChainNumbering, ChainPC
from drillpetsc.solvers.time.newton_iteration import NewtonIteration
from drillpetsc.solvers.time.newton_work import ResidualWork

MOST_ITERATIONS = 25  # of a solve, unless -q_snes_max_it says otherwise
#: options that put one of PETSc's solvers in the place of the iteration
PETSC_SOLVERS = (
    "snes_type",
    "snes_linesearch_type",
    "ksp_type",
    "pc_type",
    "snes_monitor",
    "snes_converged_reason",
    "ksp_monitor",
)


class CondensedNewton:
    """Newton's method of one discrete system; ``solve(t, shift)`` starts from and ends in the assembly's x.

    system: the discrete system.
    prefix: of the PETSc options.
    tolerance: of the estimated error of the scaled unknowns [-]; ``-q_snes_stol`` overrides it.
    work: limit of the work that the residual may leave; None: increments alone are tested.

    iteration: the iteration and its record; direct: it is used, not one of PETSc's solvers.
    jacobians, iterations, linear_iterations, failures, contact_updates: counters over all solves.
    """

    def __init__(
        self,
        system: DiscreteSystem,
        prefix: str = "q_",
        tolerance: float = 1e-6,
        work: ResidualWork | None = None,
    ):
        self.system = system
        self.t, self.shift, self.second_shift = 0.0, 0.0, 0.0
        self._turns_with_string = any(component.turns_with_string for component in system.components)
        self.jacobians = self.iterations = self.linear_iterations = self.failures = self.contact_updates = 0
        self.q, self._f = system.new_condensed(), system.new_condensed()
        self.factor: ChainFactor | None = None
        options = PETSc.Options(prefix)
        self.direct = not any(options.hasName(name) for name in PETSC_SOLVERS)
        # Contact and friction make Newton overshoot.  "cp" finds the zero of the work of the rows along the step from
        # residuals alone; measured on the whirling 2000 m string it takes a third of the iterations and no step fails.
        # With the balances of mud this work has no sign to search by, and after a jump the search does not progress.
        forces = all(f.does_work for f in system.layout.fields)
        self.line_search = options.getString(
            "snes_linesearch_type", "cp" if system.has_contact and forces else "basic"
        )
        self.tolerance = options.getReal("snes_stol", tolerance)
        if self.direct:
            self.factor, self.max_iterations = (
                shared_factor(system),
                options.getInt("snes_max_it", MOST_ITERATIONS),
            )
        else:
            self.snes = self._make_snes(prefix, options)
            self.max_iterations = self.snes.getTolerances()[3]
        #: unknowns and residual (owned,) of the last evaluation, and their addresses: the rows of a step are one compiled call
        self.arrays = self.q.getArray(), self._f.getArray()
        self._arrays_at = pointer(self.arrays[0]), pointer(self.arrays[1])
        apart = self.direct and system.has_contact
        self.iteration = NewtonIteration(system, self.factor, *self.arrays, self._rows_at_q, apart, work)
        self.iteration.record.max_iterations = self.max_iterations

    def _make_snes(self, prefix: str, options: PETSc.Options) -> PETSc.SNES:
        """Create the SNES that the options choose."""
        system = self.system
        snes = PETSc.SNES().create(comm=system.comm)
        snes.setOptionsPrefix(prefix)
        self.matrix = petsc_compat.square_matrix(self.q)
        snes.setFunction(self._function, self._f)
        snes.setJacobian(self._jacobian, self.matrix)
        snes.setConvergenceTest(self._converged)
        snes.setType("newtonls")
        snes.setTolerances(rtol=0.0, atol=0.0, stol=0.0, max_it=MOST_ITERATIONS)
        snes.getKSP().setType("preonly")
        pc = snes.getKSP().getPC()
        pc.setType("python")
        given = options.hasName("snes_linesearch_type")
        if not given:
            options.setValue("snes_linesearch_type", self.line_search)
        snes.setFromOptions()
        if not given:  # the next system in this process makes its own choice
            options.delValue("snes_linesearch_type")
        self.assembled = (
            pc.getType() != "python" or snes.getKSP().getType() != "preonly" or self.line_search == "bt"
        )
        if self.assembled:
            lgm = system.layout.condensed_dm.getLGMap().getIndices()
            places = system.assembly.places()
            rows, columns = (np.where(p >= 0, lgm[np.maximum(p, 0)], -1) for p in places)
            petsc_compat.preallocate_coo(self.matrix, rows, columns)
        else:
            self.matrix.setUp()
            self.matrix.assemble()
        if pc.getType() == "python":
            self.factor = shared_factor(system)
            pc.setPythonContext(ChainPC(self.factor, system.assembly))
        snes.setUp()
        return snes

    # ------------------------------------------------------------------ residual and matrix
    def _evaluate(self) -> None:
        """Compute rates and accelerations from the assembly's x (manual: eq-time-condensed)."""
        asm = self.system.assembly
        asm.condense(self.shift, self.second_shift)
        if asm.row_replacements:
            asm.apply_prescribed_rates(self.t, self.second_shift)
        asm.apply_imposed_rates()

    @petsc_compat.callback
    def _function(self, snes, q, f) -> None:
        self.system.load_unknowns(q)
        self._evaluate()
        self.system.sum_residual(self.t, f)

    def _rows_at_q(self) -> None:
        """Compute the residual at ``q`` into ``arrays``."""
        at, asm, ends = self._arrays_at, self.system.assembly, self.system.ends
        if not asm.step_rows(self.t, self.shift, self.second_shift, at, ends, self.arrays[1]):
            self._function(None, self.q, self._f)

    @petsc_compat.callback
    def _jacobian(self, snes, q, J, P) -> None:
        iteration = self.iteration
        if iteration.record.good and iteration.can_reuse(snes.getIterationNumber()):
            return
        self.system.load_unknowns(q)
        self._evaluate()
        iteration.compute_entries()
        iteration.take_entries()
        self._set_matrix()

    def _set_matrix(self) -> None:
        if self.assembled:
            petsc_compat.set_values_coo(self.matrix, self.system.assembly.values)
        else:
            self.matrix.assemble()

    @petsc_compat.callback
    def _converged(self, snes, its, norms) -> int:
        step = snes.getSolutionUpdate().getArray(readonly=1) if its else self.iteration.increment
        rows = snes.getFunction()[0].getArray(readonly=1)
        return self.iteration.judge(its, snes.getSolution().getArray(readonly=1), rows, step)

    # ------------------------------------------------------------------ use
    @property
    def work(self) -> ResidualWork | None:
        """Limit of the work that the residual may leave; None: increments alone are tested."""
        return self.iteration.work

    @work.setter
    def work(self, work: ResidualWork | None) -> None:
        self.iteration.work = work

    def discard_factor(self) -> None:
        """Discard the factorisation and the estimate of the contraction."""
        self.iteration.record.eta, self.iteration.record.good = 1.0, 0

    def get_state(self) -> dict[str, np.ndarray]:
        """Return the matrix entries of the factorisation and the convergence factor for a checkpoint.

        Collective.

        The result is complete on rank 0 and may be empty elsewhere.  On one rank the entries are the assembly's array, which the next
        Jacobian overwrites: a copy would need a third more memory for a checkpoint.
        newton: convergence factor [-] and shift [1/s].
        entries: entries of all ranks; shares: their number on each rank; signatures: contact signature of
        each rank.
        directions: (k, 7, 7) what these entries leave of the rows of each prescribed motion; places: their number on each rank.
        """
        iteration, mpi = self.iteration, self.system.comm.tompi4py()
        record = iteration.record
        if not record.good or (self.direct and not iteration.has_factor):
            return {"newton": np.array([record.eta])}
        values = self.system.assembly.values
        applied = np.array([f.applied for f in self.system.assembly.row_replacements]).reshape(-1, 7, 7)
        counts = mpi.gather((len(values), iteration.signature, len(applied)))
        entries, directions = joined(mpi, values), joined(mpi, applied)
        if entries is None:
            return {}
        shares, signatures, places = zip(*counts, strict=True)
        return {
            "newton": np.array([record.eta, record.lag_shift]),
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
        self.iteration.record.eta = float(state["newton"][0])
        shares = state.get("shares")
        fits = shares is not None and len(shares) == mpi.size and shares[mpi.rank] == len(asm.values)
        if shares is None or not all_true(self.system.comm, bool(fits)):
            return
        start = int(shares[: mpi.rank].sum())
        asm.values[:] = state["entries"][start : start + len(asm.values)]
        places = state.get("places", [len(asm.row_replacements)] if mpi.size == 1 else [])
        first = int(np.sum(places[: mpi.rank]))
        stored = state["directions"][first:] if len(places) == mpi.size and "directions" in state else ()
        for f, directions in zip(asm.row_replacements, stored, strict=False):
            f.applied[:] = directions
        asm.version += 1
        self.iteration.restore(float(state["newton"][1]), int(state["signatures"][mpi.rank]))
        if self.direct:
            assert self.factor is not None
            self.factor.factor(asm.values)
            self.iteration.take_factor()
        else:
            self._set_matrix()

    def solve(self, t: float, shift: float, second_shift: float | None = None) -> int:
        """Solve at time ``t`` [s] with rates y = ``shift`` x + v0, shift in 1/s; collective.

        second_shift: da/dy [1/s] of the accelerations a = second_shift y + v1, ``shift`` unless given.
        Returns the SNES reason; it is negative if the iteration did not converge.
        """
        self.t, self.shift = t, shift
        self.second_shift = shift if second_shift is None else second_shift
        iteration = self.iteration
        if self._turns_with_string:  # so does the Jacobian
            iteration.record.good = 0
        iteration.begin(t, shift, self.second_shift, self.tolerance)
        reason = iteration.solve() if self.direct else self._solve_by_petsc()
        record = iteration.record
        self.last_iterations = record.iterations
        self.iterations += record.iterations
        self.linear_iterations += record.iterations if self.direct else self.snes.getLinearSolveIterations()
        self.jacobians += record.jacobians
        self.contact_updates += record.contact_updates
        if reason < 0:
            self.failures += 1
            record.good = 0
        return reason

    def _solve_by_petsc(self) -> int:
        """Solve with PETSc's SNES from the assembly's x; returns its reason."""
        self.iteration.record.jacobians = self.iteration.record.contact_updates = 0
        self.system.store_unknowns(self.q)
        with petsc_compat.own_errors():
            self.snes.solve(None, self.q)
        self.iteration.record.iterations = self.snes.getIterationNumber()
        self.system.load_unknowns(self.q)
        self._evaluate()
        return self.snes.getConvergedReason()


def chain_factor(system: DiscreteSystem) -> ChainFactor:
    """Create the direct solver for the system's chain of nodes (manual: sec-chain)."""
    layout, asm = system.layout, system.assembly
    # the pivot of a constraint is of the order of the squared step, without cancellation, so a small one does
    # not mean a singular matrix
    smallest = 1e-25 if system.multipliers else 1e-15
    return ChainFactor(
        system.comm,
        ChainNumbering(layout.chain.vertices, layout.vertex_of, layout.local_of_owned),
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
