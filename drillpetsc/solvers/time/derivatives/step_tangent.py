"""Derivatives of a run by parameters, computed in each accepted step from its own equations (manual: sec-sensitivities-steps).

The Jacobian of Newton's method serves for all parameters.  What the parameters themselves change in the rows is a difference of systems
beside the run, of which only the elements that a parameter changes are evaluated.  No system beside the run is solved.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence

import numpy as np

from drillpetsc.arrays import FloatArray, IntArray
from drillpetsc.errors import SolveError
from drillpetsc.fem.component import Component
from drillpetsc.kernels import address, function, pointer
from drillpetsc.kernels.parameters import structure
from drillpetsc.solvers.time.consistent_start import ConsistentStart
from drillpetsc.solvers.time.derivatives.beside_systems import Beside, BesideSystems
from drillpetsc.solvers.time.derivatives.event_derivatives import EventDerivatives
from drillpetsc.solvers.time.derivatives.formula_derivatives import AlphaDerivatives, BdfDerivatives
from drillpetsc.solvers.time.derivatives.given_motion import GivenCall, GivenMotion
from drillpetsc.solvers.time.generalized_alpha import GeneralizedAlpha
from drillpetsc.solvers.time.newton import CondensedNewton
from drillpetsc.solvers.time.time_integrator import TimeIntegrator

SAME_SHIFT = 1e-9  # relative: the formula here is the integrator's

_TangentCall = structure("tangent_call")
_rows, _gather, _prescribed, _positions, _rates = (
    function(f"tangent_{name}", "p") for name in ("rows", "gather", "prescribed", "positions", "rates")
)
_step, _ends = function("tangent_step", "ppp"), function("tangent_ends", "pippppp")


class StepTangent:
    """Derivatives of x, y, a by k parameters; it follows an integrator from its start on.

    groups: of each parameter, the systems beside the run, in their states at the start.

    x, y, a: (k, length) derivatives at the accepted state, as long as the unknowns of the assembly.
    """

    def __init__(self, integrator: TimeIntegrator, groups: Sequence[Sequence[Beside]]) -> None:
        self.integrator, self.system, self.groups = integrator, integrator.system, groups
        layout, asm = self.system.layout, self.system.assembly
        n, self._length, k = layout.size, layout.array_length, len(groups)
        self.x, self.y, self.a = (np.zeros((k, self._length)) for _ in range(3))
        two = np.zeros(self._length, dtype=bool)
        two[:n] = np.array([f.second_order for f in layout.fields])[layout.field_of]
        self._with_rate = two.astype(np.int8)
        self.formula: AlphaDerivatives | BdfDerivatives
        self._starts: list[list[ConsistentStart]] = []
        if isinstance(integrator, GeneralizedAlpha):
            self.formula = AlphaDerivatives(integrator.formula, two, k)
            self._starts = [[ConsistentStart(CondensedNewton(b.system)) for b in group] for group in groups]
        else:
            self.formula = BdfDerivatives(integrator.order)
        self._remember = any(b.system.remembers for group in groups for b in group)
        self._beside = BesideSystems(self.system, groups)
        self._given = [
            GivenMotion(f, others, self._beside.follows)
            for i, f in enumerate(asm.row_replacements)
            for others in [[[(b.system.assembly.row_replacements[i], b) for b in group] for group in groups]]
        ]
        self._frames = self.system.frames_renewed
        #: by number of the parameter: time [s] from which a history beside the run has left it, so that there is no derivative
        self.lost: dict[int, float] = {}
        self._make_call()
        self.read_only(None)
        self._take_states()
        integrator.follower = self
        integrator.newton.iteration.serve_others()
        self._began = False
        #: times of events [s] and their derivatives (k,)
        self.events: list[tuple[float, FloatArray]] = []
        self.system.lead([b.system for group in groups for b in group])
        if self._remember:
            integrator.after_step.append(self._accept)

    def _make_call(self) -> None:
        """Create the record for compiled code."""
        asm, (k, length) = self.system.assembly, self.x.shape
        calls, owned = asm.calls, len(self.system.layout.local_of_owned)
        widest = max(
            (b.count * b.width**2 + 4 * b.width for b in calls.blocks if not _product_of(b.block.kernel)),
            default=0,
        )
        self._ends, needed = self._beside.end_calls()
        self._ends_at, widest = ctypes.addressof(self._ends), max(widest, needed)
        self._along, self._by_rate, self._by_second, self._rows = (np.zeros((k, length)) for _ in range(4))
        self._end_rows = np.zeros((k, length))
        self._end_rows_at = pointer(self._end_rows)
        self._constants_at = pointer(self._by_rate), pointer(self._by_second)
        self._lean, self._element = np.zeros((2, max(1, len(asm.spin_at)), 3)), np.zeros(max(1, widest))
        self._owned, self._found = np.zeros((k, owned)), np.zeros((k, owned))
        products = [_product_of(b.block.kernel) for b in calls.blocks]
        self._products = (ctypes.c_void_p * max(1, len(products)))(*products)
        self._given_calls = (GivenCall * max(1, len(self._given)))()
        for given, one in zip(self._given, self._given_calls, strict=False):
            given.fill(one)
        self._call = _TangentCall(
            step=calls.step_at, jacobian=calls.jacobian_at, products=ctypes.addressof(self._products),
            beside=ctypes.addressof(self._beside.calls), given=ctypes.addressof(self._given_calls), along=pointer(self._along),
            by_rate=pointer(self._by_rate), by_second=pointer(self._by_second), lean=pointer(self._lean), element=pointer(self._element),
            rows=pointer(self._rows), owned=pointer(self._owned), found=pointer(self._found), keys=k, length=length,
            sums=self.formula.sums_at, besides=self._beside.count, with_rate=pointer(self._with_rate), moved=pointer(self._beside.moved),
        )  # fmt: skip
        arrays = [tuple(np.zeros((k, length)) for _ in range(3)) for _ in range(self.integrator.order + 3)]
        self._states = [((x, y, a), (pointer(x), pointer(y), pointer(a))) for x, y, a in arrays]
        self._next = 0
        self._at, self._alone = ctypes.addressof(self._call), self.system.comm.size == 1
        if self._alone:
            newton_at, self._work = self.integrator.newton.iteration.columns(k)
            self._step_at = self._at, newton_at, pointer(self._work)

    # ------------------------------------------------------------------ states of the systems beside the run
    def _difference(self, k: int, values: Sequence[FloatArray]) -> FloatArray:
        """The derivative by the parameter ``k`` of values at the systems beside the run."""
        return np.asarray(sum(b.weight * v for b, v in zip(self.groups[k], values, strict=True)))

    def _take_states(self) -> None:
        """Take the derivatives from the states of the systems."""
        n = self.system.layout.size
        for k, group in enumerate(self.groups):
            self.x[k, :n] = self._difference(k, [b.system.assembly.x[:n] for b in group])
            self.y[k, :n] = self._difference(k, [b.system.assembly.y[:n] for b in group])

    # ------------------------------------------------------------------ called by the integrator
    def change_states(self, t: float, changed: bool) -> None:
        """An input jumps or bends at ``t`` [s]: components may change states; changed: the run's have."""
        self._beside.move(self.x, self.y, self.a)
        for group in self.groups:
            for beside in group:
                for component in beside.system.components:
                    component.at_break(t, beside.system.assembly)
        self._beside.take_parts()
        if changed:
            self._take_states()

    def change_law(self, t: float, component: Component, numbers: FloatArray) -> None:
        """As of ``Follower``."""
        n, events = (
            self.system.layout.size,
            EventDerivatives(ConsistentStart(self.integrator.newton), self.groups),
        )
        self._beside.move(self.x, self.y, self.a)
        shifts, *jumps = events.jump(t, component, numbers, lambda: component.change_law(numbers))
        for mine, jump in zip((self.x, self.y), jumps, strict=True):
            mine[:, :n] += jump
        self.events.append((t, shifts))
        self._beside.take_parts()
        self.start(t, False)

    def start(self, t: float, jumped: bool) -> None:
        """The formula starts at ``t`` [s]; jumped: a prescribed velocity jumps."""
        for given in self._given:
            given.forget()
        if not self._began:  # as the run has done
            self._began = True
            self._accept_here(t)
        if isinstance(self.formula, BdfDerivatives):
            self.formula.start(t, self.x, self.y)
            return
        assert isinstance(self.integrator, GeneralizedAlpha)
        n = self.system.layout.size
        more = [np.zeros_like(self.x), np.zeros_like(self.x)]
        self._beside.move(self.x, self.y, self.a)
        for k, (group, starts) in enumerate(zip(self.groups, self._starts, strict=True)):
            found = []
            for beside, begin in zip(group, starts, strict=True):
                asm = beside.system.assembly
                asm.invalidate_prescribed_values()
                if jumped:
                    begin.jump(t)
                begin.accelerations(t, self.integrator.begin)
                found.append((begin.rate_of_unknowns(), begin.second_derivative()))
            for i, out in enumerate(more):
                out[k, :n] = self._difference(k, [q[i] for q in found])
            self.a[k, :n] = self._difference(k, [b.system.assembly.a[:n] for b in group])
        self._take_states()
        self.formula.start(t, self.x, self.y, self.a, *more)

    def stage(self, t: float, step: float) -> None:
        """A stage of the first step of length ``step`` [s] is solved, at ``t`` [s]."""
        if isinstance(self.formula, BdfDerivatives):
            if not self.formula.begins_with_half(t, step):
                return
        self.formula.try_stage(t, *self._solve(t))

    def step(self, t: float) -> None:
        """As of ``Follower``."""
        if self.system.frames_renewed != self._frames:
            raise SolveError(
                "sensitivities of a string that tumbles, whose reference frames are renewed, are not computed",
                time=t,
            )
        self.x, self.y, self.a = self._solve(t)
        for k in self.lost:
            self.x[k] = self.y[k] = self.a[k] = 0.0
        self.formula.advance(t, self.x, self.y, self.a)

    def _accept(self, t: float, dt: float) -> None:
        if all(beside.system.idle for group in self.groups for beside in group):
            return
        self._beside.move(self.x, self.y, self.a)
        self._accept_here(t)
        self._beside.renew()

    def _accept_here(self, t: float) -> None:
        """Let the components of the systems beside the run go on from the end ``t`` [s] of a step, as those of the run have."""
        self.system.accept_beside(t)
        for k, group in enumerate(self.groups):
            if k not in self.lost and any(beside.system.strayed for beside in group):
                self.lost[k] = t

    # ------------------------------------------------------------------ a step
    def _solve(self, t: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Derivatives (k, length) of x, y, a at the present state, which solves a step to ``t`` [s] (manual: eq-sensitivities-step)."""
        system, asm, newton, call = self.system, self.system.assembly, self.integrator.newton, self._call
        shift = self.formula.constants(t, *self._constants_at)
        if abs(shift - newton.shift) > SAME_SHIFT * newton.shift:
            raise SolveError(
                f"the shift of the formula is {newton.shift!r}, that of its derivatives {shift!r}", time=t
            )
        call.x, call.y, call.a = newton.iteration.state_of_factor()
        for given in self._given:
            given.evaluate(newton.t, asm.x, asm.y)
        self._beside.update(newton.t)
        # the formula keeps the arrays of its nodes
        (x, y, a), at = self._states[self._next]
        self._next = (self._next + 1) % len(self._states)
        call.second, call.last_x, call.last_y = newton.second_shift, pointer(self.x), pointer(self.y)
        call.moved_x, call.moved_y, call.moved_a = at
        if self._alone:
            _step(*self._step_at)
            return x, y, a
        _rows(self._at)
        _gather(self._at)
        self._sum_over_ranks()
        _prescribed(self._at)
        assert newton.factor is not None
        for b, found in zip(self._owned, self._found, strict=True):
            newton.factor.solve_owned(b, found)
        _positions(self._at)
        if system.ends is not None:
            for row in x:
                system.ends.spread(row)
        _rates(self._at)
        return x, y, a

    def _sum_over_ranks(self) -> None:
        """Add what other ranks have of the owned rows; collective."""
        if self.system.ends is not None:
            for local, owned in zip(self._rows, self._owned, strict=True):
                self.system.ends.add(local, owned)

    def read_only(self, places: IntArray | None) -> None:
        """Let ``balance`` move only the unknowns that outputs read, at ``places``, and those that reactions need; None: all."""
        n, ends = self.system.layout.size, self._beside.end_places
        every = np.arange(n) if places is None else np.union1d(places, ends)
        self._places = np.ascontiguousarray(every[every < n], dtype=np.int32)

    def balance(self) -> None:
        """Move the systems along the derivatives after a step, and find their reactions."""
        x, y, a = self.x, self.y, self.a
        _ends(self._at, len(self._ends), self._ends_at, pointer(x), pointer(y), pointer(a), self._end_rows_at)
        self._beside.move(x, y, a, (self._places, self._end_rows))


def _product_of(kernel: str) -> int | None:
    """Entry point that multiplies the kernel's derivatives by rates and accelerations with directions; None without one."""
    return address(f"{kernel}_by_rates")
