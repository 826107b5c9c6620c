"""Newton's iteration of a condensed step on one rank as one compiled call (kernels/newton/newton.cpp; manual: sec-time-newton)."""

from __future__ import annotations

import ctypes
import zlib
from typing import TYPE_CHECKING

import numpy as np
from petsc4py import PETSc

from drillpetsc import petsc_compat
from drillpetsc.fem.assembly import StepCalls
from drillpetsc.kernels import function, pointer
from drillpetsc.kernels.parameters import structure

if TYPE_CHECKING:
    from drillpetsc.solvers.newton import CondensedNewton

_solve = function("newton_solve", "p", ctypes.c_int)
_NewtonCall, _ReasonCall = structure("newton_call"), structure("reason_call")
_ContactCall, _FlagCall = structure("contact_call"), structure("flag_call")

PHASES = ("Residual", "Jacobian", "ChainFactor", "ChainSolve")
Reason = PETSc.SNES.ConvergedReason


class CompiledNewton:
    """The iteration of a ``CondensedNewton`` that needs none of PETSc's solvers, with the results of its parts to the last bit.

    newton: its settings are taken once; forces: (k,) owned rows that do work along a step, None for all.
    seconds: (4,) wall time so far of the ``PHASES`` [s].
    """

    def __init__(
        self, newton: CondensedNewton, forces: np.ndarray | None, line_search: bool, limits: dict[str, float]
    ):
        self._newton, system = newton, newton.system
        assert newton.lag is not None and newton.arrays is not None
        lag = newton.lag
        self._q, self._rows = newton.arrays
        self._increment = np.zeros(len(self._q))
        self._forces = None if forces is None else np.ascontiguousarray(forces, dtype=np.int32)
        self._flags = (_FlagCall * len(system.contact_flags))()
        for call, flags in zip(self._flags, system.contact_flags, strict=True):
            call.bytes, call.size, call.wall = pointer(flags.values), flags.values.nbytes, flags.wall
        #: contact flags of the factorisation, as ``DiscreteSystem.contact_signature`` takes them
        self._flags_before = np.zeros(sum(f.values.nbytes for f in system.contact_flags), dtype=np.int8)
        self._signature: int | None = None  # of ``_flags_before``
        self._reasons = _ReasonCall(
            converged=Reason.CONVERGED_SNORM_RELATIVE,
            not_a_number=petsc_compat.not_a_number_reason(),
            no_pivot=Reason.DIVERGED_LINEAR_SOLVE,
            too_many=Reason.DIVERGED_MAX_IT,
            diverging=Reason.DIVERGED_DTOL,
        )
        self._chain = newton.factor.record()
        self._call = _NewtonCall(
            chain=ctypes.addressof(self._chain),
            flags=ctypes.addressof(self._flags),
            reasons=ctypes.addressof(self._reasons),
            q=pointer(self._q),
            rows=pointer(self._rows),
            increment=pointer(self._increment),
            scale=pointer(newton.scale),
            flags_before=pointer(self._flags_before),
            shift_change=lag.shift_change,
            contraction=lag.contraction,
            lag_iterations=lag.iterations,
            max_iterations=newton.max_iterations,
            n=len(self._q),
            nodes=len(system.layout.chain.vertices),
            flag_count=len(self._flags),
            line_search=line_search,
            **limits,
        )
        if self._forces is not None:
            self._call.forces, self._call.force_count = pointer(self._forces), len(self._forces)
        if newton.work is not None:
            rows, rates = newton.work.pairs
            self._call.power_rows, self._call.power_rates = pointer(rows), pointer(rates)
            self._call.power_count = len(rows)
        self._at = ctypes.addressof(self._call)
        self._calls: StepCalls | None = None

    @property
    def seconds(self) -> dict[str, float]:
        """Wall time so far by phase [s]; that of a factorisation includes its Jacobian."""
        return dict(zip(PHASES, self._call.seconds, strict=True))

    def _bind(self, calls: StepCalls) -> None:
        """Take new records of the assembly."""
        self._calls = calls
        self._call.step, self._call.jacobian = calls.step_at, calls.jacobian_at
        contacts = self._newton.contacts
        if contacts is not None:
            self._contacts = contacts.record(calls.blocks, self._flags_before)
            self._replaced = contacts.replaced_record()
            self._call.contacts, self._call.contact_count = (
                ctypes.addressof(self._contacts),
                len(self._contacts),
            )
            self._call.replaced = ctypes.addressof(self._replaced)

    def solve(self) -> int | None:
        """Solve from the assembly's x; returns the reason to end, None where a solve needs more than the compiled call does.

        The state of the Newton method, its counters and the assembly are afterwards those of the separate operations.
        """
        newton = self._newton
        system, lag, work = newton.system, newton.lag, newton.work
        asm = system.assembly
        assert lag is not None
        if asm.imposed_or_held:
            return None
        c = self._call
        calls = asm.prepare_step(newton.t, newton.shift, newton.second_shift)
        if calls is None:  # prescribed motion along a path needs the state, once
            if asm.stabilized or asm.block_by_block:
                return None
            system.store_unknowns(newton.q)
            newton.rows(newton.q)
            calls = asm.prepare_step(newton.t, newton.shift, newton.second_shift)
            if calls is None:
                return None
            c.rows_known = 1
        else:
            c.rows_known = 0
        if calls is not self._calls:
            self._bind(calls)
        asm.weigh_next(newton.weights)
        if lag.good and self._signature != lag.signature:  # a restart, or a Jacobian of other operations
            if not c.rows_known:
                system.store_unknowns(newton.q)
                newton.rows(newton.q)
                c.rows_known = 1
            self._take_flags(system.contact_signature() == lag.signature)
        c.good, c.factored = lag.good, newton.has_factor
        c.lag_shift, c.tolerance = lag.shift, newton.tolerance
        c.spacing, c.finest = newton.spacing, newton.finest
        c.work_limit = 0.0 if work is None else work.limit
        c.contacts_apart, c.current = newton.contacts is not None, newton.has_entries
        c.eta, c.last, c.first, c.theta = newton.estimates
        reason: int = _solve(self._at)
        newton.estimates = c.eta, c.last, c.first, c.theta
        asm.evaluations += c.evaluations
        newton.count(c.iterations, c.jacobians, c.contact_updates)
        if c.jacobians or c.contact_updates or c.factorisations:
            asm.version += 1
            newton.factor.renewed(c.factorisations)
            newton.take_factor()
            lag.shift, lag.good = c.lag_shift, bool(c.good)
            self._signature = lag.signature = zlib.crc32(self._flags_before.tobytes())
        return reason

    def _take_flags(self, same: bool) -> None:
        """Take the present contact flags as those of the factorisation, or others where they are not the ``same``."""
        newton = self._newton
        assert newton.lag is not None
        present = [f.values.view(np.int8).ravel() for f in newton.system.contact_flags]
        self._flags_before[:] = np.concatenate([*present, np.zeros(0, dtype=np.int8)])
        if not same:
            self._flags_before ^= 1
        self._signature = newton.lag.signature
