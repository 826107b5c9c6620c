"""The work that Newton's remainder does, and how much of it a step may leave (manual: sec-time-work).

Rows R that remain after Newton's last iteration act like forces. With the rates y they have the power R.y,
which is missing in the model's energy.  It is limited to a share of the power that the motion exchanges.
"""

from __future__ import annotations

import ctypes

import numpy as np

from drillpetsc.arrays import FloatArray, IntArray
from drillpetsc.fem.component import FLUID
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.kernels import function, pointer
from drillpetsc.parallel import total

_power = function("residual_power", "pippp", ctypes.c_double)
SHARE = 1e-3  # default of -drillpetsc_newton_work
SAMPLE_INTERVAL = 16  # accepted steps between two samples of the exchanged power
EARLY_SAMPLES = (1, 2, 4, 8)  # steps of a run with a sample before the first interval has passed


class ResidualWork:
    """Power of the rows that Newton leaves, and its limit, from samples of the exchanged power.

    system: the discrete system.
    share: of the exchanged power that a step may leave [-].

    ``limit`` is the largest power that may be left [W], 0 until the exchanged power is known.
    ``left`` is the work of the residuals of all accepted steps on this rank [J], by the trapezoidal rule.

    The exchanged power is the larger of two values.  The first is the power of the last steps: the largest
    of dissipated power, supplied power and the rates of kinetic and strain energy, averaged with the sample before.  The
    second is the mean power of the whole run: the energy exchanged since the start over
    the time since then.  Without it, a motion at rest or at a dead point would require more digits than its result
    needs.
    """

    def __init__(self, system: DiscreteSystem, share: float):
        self.system, self.share, self.limit, self.left = system, share, 0.0, 0.0
        layout = system.layout
        # of the same kind as a force: rows of mud, rock and constraints are balances
        forces = np.array([f.second_order and f.does_work and f.physics != FLUID for f in layout.fields])
        owned = layout.local_of_owned
        self._rows = np.flatnonzero(forces[layout.field_of[owned]])
        self._rows = self._rows.astype(np.int32)
        self._rates = np.ascontiguousarray(owned[self._rows], dtype=np.int32)
        self._rows_at, self._rates_at = pointer(self._rows), pointer(self._rates)
        self._residual, self._residual_at = np.zeros(0), 0  # last residual, and its address
        self._steps, self._began, self._last, self._supplied, self._peak = 0, 0.0, 0.0, 0.0, 0.0
        self._supply, self._recent, self._started = 0.0, 0.0, False
        self._left_power = 0.0  # of the last step, this rank [W]
        self._first_energies, self._energies = np.zeros(2), np.zeros(2)

    def power(self, rows: FloatArray) -> float:
        """Compute the power R.y [W] at the assembly's rates, without the rows of prescribed motion; collective.

        rows: (owned,) residual of the owned unknowns, summed over ranks.
        """
        power = self._local_power(rows)
        return float(total(self.system.comm, power))

    def _local_power(self, rows: FloatArray) -> float:
        if rows is not self._residual:
            self._residual, self._residual_at = rows, pointer(rows)
        at, count = self.system.assembly.calls.step_at, len(self._rows)
        power: float = _power(at, count, self._rows_at, self._residual_at, self._rates_at)
        return power

    @property
    def pairs(self) -> tuple[IntArray, IntArray]:
        """Owned rows and local rates whose products are the power."""
        return self._rows, self._rates

    def start(self, t: float) -> None:
        """Begin at the assembly's state at ``t`` [s], unless begun or restored; collective."""
        if self._started:
            return
        self._started = True
        self._began = self._last = t
        self._first_energies = self._energies = self._sampled_energies(t)

    def after_step(self, t: float, dt: float, rows: FloatArray, inputs_at: float, jumped: bool) -> None:
        """Sum the work that an accepted step left, and every few steps sample the exchanged power; collective.

        t: time at the end of the step [s], with the inputs of ``inputs_at``; dt: its length [s].
        rows: (owned,) residual of the owned unknowns at its end.
        jumped: the formula reaches over a jump of a prescribed velocity, so powers have no meaning.
        """
        self._steps += 1
        # across a jump of a velocity, force and velocity have no value to multiply
        power = 0.0 if jumped else self._local_power(rows)
        self.left += 0.5 * dt * (self._left_power + power)
        self._left_power = power
        if jumped or not (self._steps % SAMPLE_INTERVAL == 0 or self._steps in EARLY_SAMPLES):
            return
        interval = t - self._last
        energies, powers = self._sampled_energies(t), self.system.powers(inputs_at)
        rates = np.abs(energies - self._energies) / interval
        now = max(abs(powers.dissipated), abs(powers.supplied), float(rates.max()))
        self._recent = 0.5 * (self._recent + now) if self._recent else now
        self._supplied += 0.5 * interval * (self._supply + powers.supplied)
        self._peak = max(self._peak, float(np.abs(energies - self._first_energies).sum()))
        self._supply, self._energies, self._last = float(powers.supplied), energies, t
        exchanged = max(abs(self._supplied), self._peak)
        # the mean of the run keeps the limit up while the motion rests or turns back
        self.limit = self.share * max(self._recent, exchanged / (t - self._began))

    def _sampled_energies(self, t: float) -> FloatArray:
        energies = self.system.energies(t)
        return np.array([energies.kinetic, energies.strain])

    def total_left(self) -> float:
        """Return the work of the residuals of all accepted steps [J]; collective."""
        return self._over_ranks(np.array([self.left]))[0]

    def _over_ranks(self, parts: FloatArray) -> FloatArray:
        return np.asarray(total(self.system.comm, parts))

    def get_state(self) -> dict[str, FloatArray]:
        """For a checkpoint; the same on all ranks, empty before the start; collective."""
        if not self._started:
            return {}
        sums = [
            self.limit,
            self._steps,
            self._began,
            self._last,
            self._supplied,
            self._peak,
            self._supply,
            self._recent,
            *self._first_energies,
            *self._energies,
            *self._over_ranks(np.array([self.left, self._left_power])),
        ]
        return {"newton_work": np.array(sums, dtype=float)}

    def set_state(self, state: dict[str, FloatArray]) -> None:
        """Continue from a checkpoint; one without an entry leaves the state as it is."""
        if "newton_work" not in state:
            return
        values, self._started = np.array(state["newton_work"], dtype=float), True
        self.limit, self._began, self._last = float(values[0]), float(values[2]), float(values[3])
        self._steps = int(values[1])
        self._supplied, self._peak, self._supply, self._recent = map(float, values[4:8])
        self._first_energies, self._energies = values[8:10], values[10:12]
        # the sum over ranks was saved, so only one rank continues with it
        if self.system.comm.rank == 0:
            self.left, self._left_power = map(float, values[12:14])
