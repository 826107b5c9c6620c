"""Swirl of the mud about a turning string, a history variable of the annulus (manual: sec-mud-swirl).

The mud between a string that turns at the rate Omega and a stationary hole turns at Omega_s about the hole's axis.
In steady state, Omega_s = share Omega; after a change of the spin, friction makes it follow with a time lag:

    d(Omega_s)/dt = k (share Omega - Omega_s)                                                  (manual: eq-mud-swirl-lag)

The swirl is constant while Newton's method solves a step: it is computed from the spins after the last steps, which are
extrapolated linearly.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.component import ElementBlock
from drillpetsc.kernels import function, pointer
from drillpetsc.kernels.parameters import columns, structure

_at, _write_all = function("swirl_at", "idp"), function("swirls_write", "ipid")
_Block, _Call = structure("swirl_block"), structure("swirl_call")
_accept, _mean_spins = function("swirl_accept", "idippip"), function("mean_spins", "ippp")
_accept_all = function("swirls_accept", "ipdi")
_following_is_old = function("following_is_old", "ippppd", ctypes.c_int)
_ROWS = columns("swirl_rows")  # of the state of all elements
_NAMES = "share", "swirl", "swirl_rate", "spin_rate"  # of the parameters
OTHER_FLOW = 0.02  # relative change of the flow after which the rates of following are recomputed


def steady_share(outer_diameter: FloatArray, hole_diameter: FloatArray) -> FloatArray:
    """Compute the share (n,) [-] of the string's spin that the mud has, D_o^2/(D_o^2 + D_w^2) (manual: eq-mud-swirl-share).

    It is the mean of Couette's flow weighted with its angular momentum.  outer_diameter, hole_diameter: (n,) [m].
    """
    inner, outer = outer_diameter**2, hole_diameter**2
    return np.asarray(inner / (inner + outer))


class MeanSpins:
    """Mean spins of the string between pairs of nodes.  nodes: (n, 2) local numbers."""

    def __init__(self, nodes: np.ndarray) -> None:
        self._nodes, self._out = nodes, np.zeros(len(nodes))
        self._places = np.zeros((0, 2), dtype=np.int32)  # of the spins in the rates
        self._call: tuple[int, ...] = ()  # arguments of the compiled call, whose arrays keep their memory

    def __call__(self, state: Any) -> FloatArray:
        """(n,) [rad/s] at the assembly's rates; the next call overwrites them."""
        _mean_spins(*self.call(state))
        return self._out

    def call(self, state: Any) -> tuple[int, ...]:
        """Number, and addresses of their places in the rates, of the rates and of the result."""
        if not self._call or state.derive is not None:  # which computes the derived spins
            self._places = np.ascontiguousarray(state.dofs_of("string.spin")[self._nodes, 0], dtype=np.int32)
            self._call = len(self._out), *map(pointer, (self._places, state.y, self._out))
        return self._call


class Swirl:
    """Swirl about elements, from the spins at accepted steps, and its position in the parameters of their blocks.

    share: (n,) ratio of steady swirl to spin [-], 0 for mud at rest; it may be changed in place.
    After the last step, (n,) each: spin, swirl [rad/s], trend of the spin [rad/s2].
    follow: (n,) rate at which the swirl follows [1/s], inf: at once; flow: (n,) corresponding flow rate [m3/s].
    leader: swirl in a run beside which this one is, whose ``follow`` is renewed together with this one's.
    renewed: the last ``follows_other_flow`` was true.
    """

    STATE = 6  #: columns of ``get_state``

    def __init__(self, share: FloatArray) -> None:
        self._count = len(share)
        self._state = np.zeros((_ROWS.width, self._count))
        self._state_at = pointer(self._state)
        rows = [self._state[_ROWS[name]] for name in _ROWS.names]
        self.share, self.spin, self.swirl, self.trend, self.follow, self._now, self._rate = rows
        self.share[:], self.follow[:] = share, np.inf
        self.flow = np.zeros(self._count)
        self.leader: Swirl | None = None
        self._beside: list[Swirl] = []  # that it leads
        self.renewed = False
        self._start: float | None = None  # of the trend: time of the last step [s]; None: before a motion
        self._written = np.nan  # time to which the parameters of the blocks belong [s]
        self._computed = np.nan  # time to which the swirl and its rate in the state belong [s]
        self._blocks = (_Block * 0)()  # whose parameters it sets
        self._blocks_at = 0, ctypes.addressof(self._blocks)
        self._kept: list[np.ndarray] = []  # whose addresses are among them
        self._calls, self._calls_at = (_Call * 0)(), 0  # of this one, then of those beside

    # ------------------------------------------------------------------ parameters
    def attach(
        self,
        block: ElementBlock,
        others: Callable[[float], None] | None = None,
        rows: np.ndarray | None = None,
    ) -> None:
        """Set share, swirl and their rates among the parameters of a ``block`` before each evaluation, after what ``others`` sets.

        rows: (m,) places of its elements in the arrays of this object, None: the block's points.
        """
        named = block.named
        places = np.ascontiguousarray(block.points if rows is None else rows, dtype=np.int32)
        at = np.array([named.columns[name] for name in _NAMES], dtype=np.int32)
        self._kept += [places, at, block.params]
        record = _Block(
            rows=pointer(places),
            parameters=pointer(block.params),
            columns=pointer(at),
            count=len(places),
            width=named.columns.width,
        )
        self._calls_at = 0
        self._blocks = (_Block * (len(self._blocks) + 1))(*self._blocks, record)
        self._blocks_at = len(self._blocks), ctypes.addressof(self._blocks)

        def update(t: float) -> None:
            if others is not None:
                others(t)
            if t != self._written:
                self._write(t)

        block.update = update

    def _write(self, t: float) -> None:
        """Set the parameters of all blocks for time ``t`` [s]."""
        moves, step = self._start is not None, 0.0 if self._start is None else max(0.0, t - self._start)
        together = self._together
        _write_all(1 + len(together), self._records(), moves, step)
        for swirl in (self, *together):
            swirl._written = swirl._computed = t

    # ------------------------------------------------------------------ swirls beside a run
    def join(self, leader: Swirl, spins: MeanSpins, state: Any) -> None:
        """Be renewed with ``leader``, and go on in its calls; spins: about which this one is, of the assembly ``state``."""
        self.leader = leader
        leader._beside.append(self)
        self._spins_call, leader._calls_at = spins.call(state), 0

    @property
    def _together(self) -> list[Swirl]:
        """Swirls that this one leads, as long as they have its times."""
        return self._beside if all(q._start == self._start for q in self._beside) else []

    def _records(self) -> int:
        """Address of the records of this one and of those beside it."""
        if not self._calls_at:
            self._calls = (_Call * (1 + len(self._beside)))()
            for call, swirl in zip(self._calls, (self, *self._beside), strict=True):
                call.n, call.state, (call.block_count, call.blocks) = (
                    swirl._count,
                    swirl._state_at,
                    swirl._blocks_at,
                )
                if swirl is not self:
                    _, call.places, call.rates, call.spins = swirl._spins_call
            self._calls_at = ctypes.addressof(self._calls)
        return self._calls_at

    def accept_beside(self, t: float) -> None:
        """Let the swirls beside this one go on to the end ``t`` [s] of an accepted step, with their spins there."""
        if not self._beside:
            return
        first = self._beside[0]
        if first._start is None:  # before a motion
            first._start = t
        step, at = t - first._start, self._records() + ctypes.sizeof(_Call)
        _accept_all(len(self._beside), at, step, t == first._computed)
        for swirl in self._beside:
            swirl._take_time(t, step)

    # ------------------------------------------------------------------ steps
    def start(self, t: float, spin: FloatArray) -> None:
        """Begin, or stay, with a steady swirl at the spins (n,) [rad/s] at time ``t`` [s]."""
        self._start, self.spin[:], self.swirl[:], self.trend[:] = t, spin, self.share * spin, 0.0
        self._write(t)  # now: linear analyses read them before the next evaluation

    def stop(self) -> None:
        """Return to mud at rest."""
        self._start = None
        self.swirl[:] = self.trend[:] = 0.0
        self._write(np.nan)

    def accept(self, t: float, spin: FloatArray) -> None:
        """Go on to the end ``t`` [s] of an accepted step with the spins (n,) [rad/s] there."""
        if self._start is None:
            return self.start(t, spin)
        step = t - self._start
        _accept(self._count, step, t == self._computed, pointer(spin), self._state_at, *self._blocks_at)
        self._take_time(t, step)
        return None

    def _take_time(self, t: float, step: float) -> None:
        if step > 0.0:  # not at the start of a continued run
            self._start = t
        self._written, self._computed = t, np.nan

    def follows_other_flow(self, places: np.ndarray, x: FloatArray, limit: float) -> bool:
        """Whether ``follow`` is not known, or a flow has changed since by more than ``limit`` [m3/s].

        places: (n,) of the flows in the values x, int32, -1 for none.
        """
        if self.leader is None:
            here = pointer(places), pointer(x), pointer(self.flow)
            self.renewed = bool(_following_is_old(self._count, *here, self._state_at, limit))
        else:
            self.renewed = self.leader.renewed
        if self.renewed:  # the caller will change ``follow``
            self._computed = np.nan
        return self.renewed

    def at(self, t: float) -> tuple[FloatArray, FloatArray]:
        """Swirl (n,) [rad/s] and its rate (n,) [rad/s2] at ``t`` [s], the spins going on along their trends.

        It is the exact solution for a spin on a straight line.
        """
        if self._start is None:
            still = np.zeros_like(self.spin)
            return still, still
        _at(self._count, max(0.0, t - self._start), self._state_at)
        self._computed = t
        return self._now, self._rate

    # ------------------------------------------------------------------ checkpoints
    def get_state(self) -> FloatArray:
        """(n, 6) of a motion: spin, swirl, trend, follow, flow, time."""
        time = np.full(len(self.spin), np.nan if self._start is None else self._start)
        return np.column_stack([self.spin, self.swirl, self.trend, self.follow, self.flow, time])

    def set_state(self, saved: FloatArray) -> None:
        """Continue from the result of ``get_state``."""
        self.spin[:], self.swirl[:], self.trend[:], self.follow[:], self.flow[:], time = saved.T
        self._start = float(time[0]) if len(time) and not np.isnan(time[0]) else None
        self._written = self._computed = np.nan
