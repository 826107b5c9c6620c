"""Newton's iteration of a condensed step: one compiled loop, collective (kernels/newton/newton.cpp; manual: sec-time-newton).

The loop, its tests and its memory from one solve to the next are in a compiled record.  So are its parts, as long as
compiled calls suffice for a step. Otherwise, and for messages between ranks, the loop calls Python.
"""

from __future__ import annotations

import ctypes
import weakref
import zlib
from collections.abc import Callable
from typing import Any

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from drillpetsc import petsc_compat
from drillpetsc.arrays import FloatArray
from drillpetsc.errors import SolveError
from drillpetsc.fem.assembly import StepCalls
from drillpetsc.fem.contact_entries import ContactEntries
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.kernels import function, pointer
from drillpetsc.kernels.parameters import constant, structure
from drillpetsc.solvers.chain.chain_lu import ChainFactor, ZeroPivot
from drillpetsc.solvers.time.newton_work import ResidualWork

_solve = function("newton_solve", "p", ctypes.c_int)
_judge, _reusable = (
    function("newton_judge", "pi", ctypes.c_int),
    function("newton_reusable", "pi", ctypes.c_int),
)
_new_entries = function("newton_new_entries", "p")
_is_near = function("newton_is_near", "p", ctypes.c_int)
_renew = function("newton_renew", "p", ctypes.c_int)
_NewtonCall, _ReasonCall = structure("newton_call"), structure("reason_call")
_ContactCall, _FlagCall, _PartsCall, _SecantCall = (
    structure("contact_call"),
    structure("flag_call"),
    structure("parts_call"),
    structure("secant_call"),
)
_SECANT_VECTORS = int(constant("secant_vectors"))
_Part, _PartFrom = ctypes.CFUNCTYPE(ctypes.c_int), ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_int)
_Reduction = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.POINTER(ctypes.c_double), ctypes.c_int)

PHASES = ("Residual", "Jacobian", "ChainFactor", "ChainSolve")
Reason = PETSc.SNES.ConvergedReason
RAISED = -1000  # reason of a solve that an exception of a part has ended
#: relative spacing below which an unknown cannot be resolved (manual: eq-time-increment)
RESOLUTION = 64 * float(np.finfo(float).eps)
#: an increment that no longer shrinks and is below this fraction of the scales is rounding
ROUNDING_INCREMENT = 1e-10
#: the work of the residual requires increments down to this fraction of the tolerance, and not below the other
#: value: further iterations change only rounding (manual: sec-time-work)
WORK_REFINEMENT, WORK_FINEST_INCREMENT = 1e-3, 1e-9
#: a step is shortened if its work afterwards is opposite and above this fraction (manual:
#: eq-time-line-search)
OVERSHOOT_FRACTION = 0.1
SHORTEST_STEP_FRACTION = 0.05
#: iterations of a solve that renew a factorisation in its contacts alone, before all of it (manual:
#: sec-time-contact-entries)
CONTACT_ITERATIONS = 5
#: a factorisation is reused while the shift has changed by less than this, the contraction is better than this, and this
#: many iterations have not sufficed (manual: sec-time-newton)
SHIFT_CHANGE, CONTRACTION, LAG_ITERATIONS = 0.2, 0.5, 8
#: a matrix serves after a solve if the solve has gone on from its state by this fraction of its first increment at most (manual:
#: sec-sensitivities-steps)
NEAR = 1e-5


class NewtonIteration:
    """The iteration of one discrete system; every call is collective.

    system, factor: what is solved, and the direct solver of its chain; both are shared with other solves.
    q, rows: (owned,) arrays of the unknowns and of the residual.
    residual(): computes ``rows`` at ``q``, on several ranks and for steps that need more than compiled calls.
    apart: renew the entries of contacts apart from the others.
    work: limit of the work that the residual may leave, None: increments alone are tested.

    record: settings and state of the iteration, by the names of ``NewtonCall``.
    compiled: let compiled code have all parts that it can; False: Python has them, with the same results.
    """

    def __init__(
        self,
        system: DiscreteSystem,
        factor: ChainFactor | None,
        q: FloatArray,
        rows: FloatArray,
        residual: Callable[[], Any],
        apart: bool,
        work: ResidualWork | None,
    ):
        self.system, self.factor, self.q, self.rows = system, factor, q, rows
        self._residual: Any = weakref.WeakMethod(residual)  # of its owner, which solves
        self.work = work
        self.t, self.weights, self.compiled = 0.0, (1.0, 0.0, 0.0), True
        self._shifts, self._plain = (0.0, 0.0), False  # of the present solve
        self.scale, self.increment = system.scale[system.layout.local_of_owned], np.zeros(len(q))
        self.contacts = ContactEntries(system) if apart else None
        # of this iteration: number of the last factorisation, version of its entries
        self._factored, self._version = 0, -1
        self._sums = ("sum", "largest") if system.comm.size > 1 else ()
        self._signature: int | None = (
            None  # of the contacts at a restored factorisation, until the first rows are known
        )
        self._calls: StepCalls | None = None
        self._error: BaseException | None = None
        self._events = PETSc.Log.Event("ChainFactor"), PETSc.Log.Event("ChainSolve")
        self.record = self._make_record(residual)
        self._at = ctypes.addressof(self.record)

    # ------------------------------------------------------------------ the record
    def _make_record(self, residual: Callable[[], Any]) -> Any:
        system, layout = self.system, self.system.layout
        forces = np.array([f.does_work for f in layout.fields])[layout.field_of[layout.local_of_owned]]
        self._forces = np.flatnonzero(forces).astype(np.int32)
        self._flags = (_FlagCall * len(system.contact_flags))()
        for call, flags in zip(self._flags, system.contact_flags, strict=True):
            call.bytes, call.size, call.wall = pointer(flags.values), flags.values.nbytes, flags.wall
        #: contact flags of the factorisation, as ``DiscreteSystem.contact_signature`` takes them
        self._flags_before = np.zeros(sum(f.values.nbytes for f in system.contact_flags), dtype=np.int8)
        self._reasons = _ReasonCall(
            converged=Reason.CONVERGED_SNORM_RELATIVE,
            not_a_number=petsc_compat.not_a_number_reason(),
            no_pivot=Reason.DIVERGED_LINEAR_SOLVE,
            too_many=Reason.DIVERGED_MAX_IT,
            diverging=Reason.DIVERGED_DTOL,
            raised=RAISED,
        )
        self._python = {
            "rows": _Part(self._guarded(residual)),
            "entries": _Part(self._guarded(self.compute_entries)),
            "factor": _PartFrom(self._guarded(self._factor_from)),
            "solve": _Part(self._guarded(self._solve_rows)),
            "sum": _Reduction(self._guarded(self._sum)),
            "largest": _Reduction(self._guarded(self._largest)),
        }
        self._addresses = {
            name: ctypes.cast(call, ctypes.c_void_p).value for name, call in self._python.items()
        }
        self._parts = _PartsCall()
        self._compiled_parts = False, False, False  # rows, entries, factor and solution
        self._use_python(*self._sums, "rows", "entries", "factor", "solve")
        record = _NewtonCall(
            flags=ctypes.addressof(self._flags),
            reasons=ctypes.addressof(self._reasons),
            parts=ctypes.addressof(self._parts),
            q=pointer(self.q),
            rows=pointer(self.rows),
            increment=pointer(self.increment),
            scale=pointer(self.scale),
            flags_before=pointer(self._flags_before),
            shift_change=SHIFT_CHANGE,
            contraction=CONTRACTION,
            lag_iterations=LAG_ITERATIONS,
            rounding=ROUNDING_INCREMENT,
            overshoot=OVERSHOOT_FRACTION,
            shortest=SHORTEST_STEP_FRACTION,
            contact_iterations=CONTACT_ITERATIONS,
            eta=1.0,
            n=len(self.q),
            nodes=len(layout.chain.vertices),
            flag_count=len(self._flags),
            line_search=system.has_contact,
            switching=system.has_contact,
        )
        if not forces.all():
            record.forces, record.force_count = pointer(self._forces), len(self._forces)
        if self.work is not None:
            rows, rates = self.work.pairs
            record.power_rows, record.power_rates = pointer(rows), pointer(rates)
            record.power_count = len(rows)
        if self.factor is not None:
            n = len(self.q)
            self._secant_memory, self._squares = np.zeros((_SECANT_VECTORS, n)), self.scale**-2.0
            self._secants = _SecantCall(
                memory=pointer(self._secant_memory), weights=pointer(self._squares), n=n
            )
            record.secants = ctypes.addressof(self._secants)
            if system.comm.size == 1:
                self._chain = self.factor.record()
                record.chain = ctypes.addressof(self._chain)
        return record

    def _use_python(self, *names: str) -> None:
        """Assign these parts to Python, and all others to the compiled record."""
        for name, address in self._addresses.items():
            setattr(self._parts, name, address if name in names else None)

    def _guarded(self, part: Callable[..., Any]) -> Callable[..., int]:
        """The ``part`` for compiled code: 0, 1 without a pivot, -1 for any other exception, which is raised after the solve."""
        # the system ends with its last user, not with the process; both live as long as the solve
        own: Any = weakref.ref(self)
        method: Any = weakref.WeakMethod(part)

        def call(*arguments: Any) -> int:
            try:
                method()(*arguments)
            except ZeroPivot:
                return 1
            except BaseException as error:
                own()._error = error
                return -1
            return 0

        return call

    def _sum(self, values: Any, n: int) -> None:
        self._over_ranks(MPI.SUM, values, n)

    def _largest(self, values: Any, n: int) -> None:
        self._over_ranks(MPI.MAX, values, n)

    def _over_ranks(self, operation: MPI.Op, values: Any, n: int) -> None:
        array = np.ctypeslib.as_array(values, (n,))
        self.system.comm.tompi4py().Allreduce(MPI.IN_PLACE, [array, n, MPI.DOUBLE], operation)

    def _bind(self, calls: StepCalls) -> None:
        """Take the records of the assembly's compiled calls, which change with its blocks."""
        self._calls = calls
        self.record.step, self.record.jacobian = calls.step_at, calls.jacobian_at
        if self.contacts is not None:
            self._contacts = self.contacts.record(calls.blocks, self._flags_before)
            self._replaced = self.contacts.replaced_record()
            self.record.contacts, self.record.contact_count = (
                ctypes.addressof(self._contacts),
                len(self._contacts),
            )
            self.record.replaced = ctypes.addressof(self._replaced)

    # ------------------------------------------------------------------ the tests, for PETSc's own solvers
    def judge(self, iteration: int, q: FloatArray, rows: FloatArray, step: FloatArray) -> int:
        """Reason to end after an iteration, 0 to go on (manual: eq-time-increment, eq-time-convergence, eq-time-work).

        q, rows, step: (owned,) unknowns, residual and last increment.
        """
        r = self.record
        r.q, r.rows, r.increment = pointer(q), pointer(rows), pointer(step)
        reason: int = _judge(self._at, iteration)
        return reason

    def can_reuse(self, iteration: int) -> bool:
        """Whether the last factorisation may be used in an iteration."""
        if self._signature is not None:  # a restart: the first rows are known now
            self._take_flags(self.system.contact_signature() == self._signature)
        self.record.factored = 1
        return bool(_reusable(self._at, iteration))

    def take_entries(self) -> None:
        """The next factorisation uses the assembly's present entries."""
        _new_entries(self._at)

    # ------------------------------------------------------------------ parts in Python
    def compute_entries(self) -> None:
        """Compute the Jacobian's entries at the assembly's state (manual: eq-time-jacobian)."""
        self.system.assembly.jacobian(self.t, self.weights, condensed=True)

    def _factor_from(self, first: int) -> None:
        assert self.factor is not None
        self._events[0].begin()
        try:
            self.factor.factor(self.system.assembly.values, first)
        finally:
            self._events[0].end()
            PETSc.Log.logFlops(self.factor.factor_flops)

    def _solve_rows(self) -> None:
        assert self.factor is not None
        self._events[1].begin()
        self.factor.solve_owned(self.rows, self.increment)
        self._events[1].end()

    # ------------------------------------------------------------------ use
    def _can_be_compiled(self) -> bool:
        """Whether compiled calls compute rows and entries at the present time."""
        return self.compiled and self.system.assembly.prepare_step(self.t, *self._shifts) is not None

    @property
    def seconds(self) -> dict[str, float]:
        """Wall time so far of the compiled phases [s]."""
        return dict(zip(PHASES, self.record.seconds, strict=True))

    @property
    def has_factor(self) -> bool:
        """Whether the direct solver, which all solves of the system share, has the last factorisation of this one."""
        return self.factor is not None and self._factored == self.factor.factorisations

    @property
    def signature(self) -> int:
        """Contact signature at the factorisation."""
        return zlib.crc32(self._flags_before.tobytes()) if self._signature is None else self._signature

    def begin(self, t: float, shift: float, second: float, tolerance: float) -> None:
        """Set up a solve at ``t`` [s] with the shifts of its rates [1/s], as for ``CondensedNewton.solve``.

        tolerance: of the estimated error of the scaled unknowns [-].
        """
        r, asm = self.record, self.system.assembly
        self.t, self.weights = t, (1.0, shift, shift**2 if second == shift else shift * second)
        # the convergence factor of one step counts less in the next one (Hairer and Wanner, Solving ODEs II, IV.8)
        r.eta = 1.0 if r.eta > 1.0 else max(r.eta, 1e-10) ** 0.8
        if r.good:
            # a factorisation at another shift leaves an error of this fraction in each iteration
            mismatch = abs((shift / r.lag_shift) ** 2 - 1.0)
            r.eta = max(r.eta, mismatch / max(1.0 - mismatch, 0.1))
        if asm.calls is not self._calls:
            self._bind(asm.calls)
        step = asm.calls.step
        step.sigma, step.second = self._shifts = shift, second
        self._plain = asm.plain
        r.tolerance, r.spacing = tolerance, RESOLUTION / tolerance
        r.finest = max(WORK_REFINEMENT * tolerance, WORK_FINEST_INCREMENT)
        r.work_limit = 0.0 if self.work is None else self.work.limit
        r.factored, r.current = self.has_factor, self._version == asm.version
        r.contacts_apart = self.contacts is not None and self._plain

    def solve(self) -> int:
        """Iterate from the assembly's x, after ``begin``; returns PETSc's reason to end, negative without convergence."""
        r, asm = self.record, self.system.assembly
        assert self.factor is not None
        compiled, r.rows_known = self._can_be_compiled(), 0
        if (
            not compiled or self._signature is not None
        ):  # motion along a path needs the state once, a restart its contacts
            self.q[:] = asm.x[self.system.layout.local_of_owned]
            self._residual()()
            compiled, r.rows_known = self._can_be_compiled(), 1
        if self._signature is not None:
            self._take_flags(self.system.contact_signature() == self._signature)
        alone = self.compiled and not self._sums
        parts = compiled and alone, compiled and self._plain, alone
        if parts != self._compiled_parts:  # in few solves
            self._compiled_parts, (rows, entries, factor) = parts, parts
            names = {"rows": rows, "entries": entries, "factor": factor, "solve": factor}
            self._use_python(*self._sums, *(name for name, here in names.items() if not here))
        asm.weigh_next(self.weights)
        reason: int = _solve(self._at)
        asm.evaluations += r.evaluations
        if r.jacobians or r.contact_updates or r.factorisations:
            asm.version += 1
            self.factor.renewed(r.factorisations)
            self._factored, self._version = self.factor.factorisations, asm.version
        if self._error is not None:
            error, self._error = self._error, None
            raise error
        return reason

    def take_factor(self) -> None:
        """The direct solver now has the present entries of the assembly."""
        assert self.factor is not None
        self._factored, self._version = self.factor.factorisations, self.system.assembly.version

    # ------------------------------------------------------------------ the factors for other right sides
    def serve_others(self) -> None:
        """Keep the state of each matrix from now on, and compute one late in each solve, for ``state_of_factor``."""
        self._kept = np.zeros((3, len(self.system.assembly.x)))
        self.record.kept, self.record.near = pointer(self._kept), NEAR

    def state_of_factor(self) -> tuple[int, int, int]:
        """Addresses of the x, y, a at which the factored matrix is, after a solve whose state is the assembly's; collective.

        It is a state of the solve from which this has gone on by ``NEAR`` of its first increment at most.  Without such a matrix
        it is computed here, at the present state, and Newton's method goes on with it.
        """
        asm, length = self.system.assembly, 8 * len(self.system.assembly.x)
        assert self.factor is not None
        self.record.factored = self.has_factor and self._version == asm.version
        if _is_near(self._at):
            at = self.record.kept
            return at, at + length, at + 2 * length
        asm.weigh_next(self.weights)
        failed = _renew(self._at)
        asm.version += 1
        self.factor.renewed(self.record.factorisations)
        self.take_factor()
        if self._error is not None:
            error, self._error = self._error, None
            raise error
        if failed:
            raise SolveError("the matrix of the string is singular to working precision", time=self.t)
        x, y, a, _ = asm.state_at
        return x, y, a

    def columns(self, count: int) -> tuple[int, FloatArray]:
        """Address of the record, with which compiled code solves ``count`` right sides on one rank, and the work array that it needs."""
        return self._at, np.zeros((count, self._chain.length))

    def restore(self, shift: float, signature: int) -> None:
        """Treat the assembly's entries as the entries of a factorisation at ``shift`` [1/s] with the contacts of a ``signature``."""
        self.record.lag_shift, self.record.good, self._signature = shift, 1, signature

    def _take_flags(self, same: bool) -> None:
        """Treat the present contact flags as the flags of the factorisation, or others if they are not the ``same``."""
        present = [f.values.view(np.int8).ravel() for f in self.system.contact_flags]
        self._flags_before[:] = np.concatenate([*present, np.zeros(0, dtype=np.int8)])
        if not same:
            self._flags_before ^= 1
        self._signature = None
