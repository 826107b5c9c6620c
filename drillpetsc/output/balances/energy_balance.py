"""Energy balance of a run, and the monitor of spurious energy gain, the first sign of an unstable integration."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from petsc4py import PETSc

from drillpetsc.errors import SolveError
from drillpetsc.fem.component import FloatArray
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.fem.quantity import Quantity
from drillpetsc.output.quantities.history import ENERGY
from drillpetsc.parallel import total
from drillpetsc.unit_systems import shown

LIMIT = 0.01  # of the energy exchanged
#: share of the strain energy below which an exchange is the settling of a state that is known to the solver's tolerance
SETTLING = 1e-5
ROWS_ABOVE_LIMIT = 3  # consecutive rows above the limit that stop a run
#: attributes of an energy balance in a checkpoint, before its powers
_SUMS = ("dissipated", "supplied", "start_energy", "peak_exchange", "_before_jump", "gained", "last_error")


class EnergyBalance:
    """Stored, dissipated and supplied energy since the start (manual: eq-conv-energy).

    energies: kinetic, strain and potential energy [J] at the last update.
    dissipated, supplied: sums since the start [J].
    peak_exchange: largest supplied work and largest change of kinetic and strain energy so far [J].
    last_error: energy error [J] at the last update; gained: its largest value since the start, at least 0.
    """

    def __init__(self, system: DiscreteSystem) -> None:
        self.system = system
        self.dissipated = self.supplied = self.start_energy = 0.0
        self.peak_exchange = self._before_jump = self._before_event = 0.0
        self.last_error = self.gained = 0.0
        self._powers: tuple[float, float] = (0.0, 0.0)
        self._first_energies = self.energies = (0.0, 0.0, 0.0)
        self._stored = 0.0  # sum of ``energies``
        #: unknowns and rates at the last update, for unknowns that follow at once; None without such
        self._before: tuple[FloatArray, FloatArray] | None = None
        self.followed = 0.0  # sum since the start [J]
        self._follows = False  # whether there are such unknowns, on any rank

    def quantities(self) -> tuple[Quantity, ...]:
        return ENERGY

    def start(self, t: float, powers: tuple[float, float]) -> None:
        """Begin at the present state.  powers: dissipated and supplied [W], summed over ranks."""
        self._powers = powers
        self._set_energies(self.system.energies(t))
        self._keep_state()
        self._first_energies = self.energies
        self.start_energy = self._stored

    def _set_energies(self, energies: Sequence[float]) -> None:
        kinetic, strain, potential = map(float, energies)
        self.energies, self._stored = (kinetic, strain, potential), kinetic + strain + potential

    def step(self, t: float, dt: float, powers: tuple[float, float]) -> None:
        """Integrate the powers over an accepted step ``dt`` [s] to ``t`` [s] by the trapezoidal rule; collective."""
        self.add(dt, powers, self.follow(t))

    def add(self, dt: float, powers: tuple[float, float], followed: float) -> None:
        """The same with the energy ``followed`` [J] that mud took up at once in this step (``follow``)."""
        self.supplied, self.followed = self.supplied + followed, self.followed + followed
        self.dissipated += 0.5 * dt * (self._powers[0] + powers[0])
        self.supplied += 0.5 * dt * (self._powers[1] + powers[1])
        self.peak_exchange = max(self.peak_exchange, abs(self.supplied))
        self._powers = powers

    def _keep_state(self) -> None:
        asm = self.system.assembly
        self._follows = bool(total(self.system.comm, float(asm.imposed is not None)))
        self._before = (asm.x.copy(), asm.y.copy()) if self._follows else None

    def follow(self, t: float) -> float:
        """Energy [J] that quasi-steady mud has stored by its change of pressures and flows in a step to ``t`` [s] (manual: eq-mud-follows).

        Their rates are zero in the rows, so no power feeds this energy, and it counts as supplied.  Collective.
        """
        if self._before is None:
            return 0.0
        system, asm = self.system, self.system.assembly
        (x0, y0), x1, y1 = self._before, asm.x.copy(), asm.y.copy()
        n, stored = system.layout.size, list[float]()
        mask = np.zeros(n, dtype=bool) if asm.imposed is None else asm.imposed
        for x, y in ((x1, y1), (x0, y0)):
            for fluid in (x1, x0):
                at = x.copy()
                at[:n][mask] = fluid[:n][mask]
                with asm.elsewhere(at, y):
                    stored.append(sum(system.energies(t, "fluid")))
        taken = 0.5 * (stored[0] - stored[1] + stored[2] - stored[3])
        self._before = x1, y1
        return taken

    def update(self, t: float) -> None:
        """Read the energies at the present state (collective); keeps the largest change since the start."""
        self.take(self.system.energies(t))

    def take(self, energies: Sequence[float]) -> None:
        """The same with the present ``energies`` (3,) [J]."""
        self._set_energies(energies)
        (kinetic, strain, _), (kinetic0, strain0, _) = self.energies, self._first_energies
        self.peak_exchange = max(self.peak_exchange, abs(kinetic - kinetic0) + abs(strain - strain0))
        self.last_error = self.error
        self.gained = max(self.gained, self.last_error)

    def before_event(self, t: float) -> None:
        """Store the energy error just before a component changes its law."""
        self.update(t)
        self._before_event = self._stored

    def after_event(self, t: float) -> None:
        """Count the stored energy released by a change of law, such as by a latch, as turned into heat."""
        self.update(t)
        self.dissipated += self._before_event - self._stored
        self._take_powers(t)

    def _take_powers(self, t: float) -> None:
        powers = self.system.powers(t)
        self._powers = float(powers.dissipated), float(powers.supplied)

    def after_sample(self, t: float) -> None:
        """Read the powers after a force has jumped: the quadrature of the next step begins with them."""
        self._take_powers(t)

    def at_jump(self, t: float) -> None:
        """Store the energy error just before a jump of a prescribed velocity."""
        self.update(t)
        self._before_jump = self.error

    def add_impulse_work(self, t: float) -> None:
        """Count as supplied the energy gained in the steps whose formula spans a jump of a prescribed velocity.

        Reaction and rate have no value at the jump, so quadrature over these steps cannot give their product.
        """
        self.update(t)
        self.supplied += self.error - self._before_jump

    @property
    def exchanged(self) -> float:
        """Scale of an energy error [J]: the largest supplied work, or change of kinetic and strain energy, since the start.
        It is at least the rounding of the energies and the settling of the start.  Work that was
        supplied and returned counts."""
        least = max(1e-9 * sum(map(abs, self.energies)), SETTLING * abs(self.energies[1]), 1e-300)
        return max(abs(self.supplied), self.peak_exchange, least)

    @property
    def error(self) -> float:
        """Stored energy gained plus dissipated less supplied energy since the start [J]."""
        return self._stored - self.start_energy + self.dissipated - self.supplied

    def summary(self, left: float | None = None) -> dict[str, float]:
        """For summary.json, at the last update [J]; shares are relative to ``exchanged``.

        left: work of the residuals that Newton left [J]; the rest of the energy error is the time formula's.
        """
        kinetic, strain, potential = self.energies
        out = {
            "kinetic": kinetic,
            "strain": strain,
            "potential": potential,
            "dissipated": self.dissipated,
            "supplied": self.supplied,
            "error": self.last_error,
            "error_share": self.last_error / self.exchanged,
        }
        if left is not None:
            damped = left - self.last_error
            out |= {"newton": left, "damped": damped, "damped_share": damped / self.exchanged}
        return out | ({"followed": self.followed} if self._follows else {})

    def get_state(self) -> dict[str, FloatArray]:
        """For a checkpoint; the same on all ranks."""
        sums = [*(getattr(self, name) for name in _SUMS), *self._powers, self.followed]
        return {
            "sums": np.array(sums),
            "first_energies": np.array(self._first_energies),
            "energies": np.array(self.energies),
        }

    def set_state(self, saved: dict[str, FloatArray]) -> None:
        """Continue from a checkpoint."""
        sums = list(map(float, saved["sums"]))
        self._powers, self.followed = (sums[7], sums[8]), sums[9]
        for name, value in zip(_SUMS, sums, strict=False):
            setattr(self, name, value)
        kinetic, strain, potential = saved["first_energies"].tolist()
        self._first_energies = kinetic, strain, potential
        self._set_energies(saved["energies"].tolist())
        self._keep_state()


#: sentence on the energy that the time integration created
GAINED = "the time integration generated {energy} without input, {percent:.2g} % of the energy exchanged"


class EnergyGainMonitor:
    """Checks, at every row of the history, how much energy the time integration created.

    balance: None for a run without an energy balance, which is never stopped.
    Options: -drillpetsc_gain_limit (default 0.01) and -drillpetsc_stop_on_gain, which ends such a run.
    """

    def __init__(self, balance: EnergyBalance | None) -> None:
        options = PETSc.Options()
        self.balance, self.rows = balance, 0
        self.limit = options.getReal("drillpetsc_gain_limit", LIMIT)
        self.stops = options.getBool("drillpetsc_stop_on_gain", False)

    def check(self, t: float) -> None:
        """After a row at ``t`` [s]: raise SolveError, on all ranks, if the run is to be stopped."""
        if not self.stops or self.balance is None:
            return
        above = self.balance.last_error > self.limit * self.balance.exchanged
        self.rows = self.rows + 1 if above else 0
        if self.rows >= ROWS_ABOVE_LIMIT:
            raise SolveError(
                GAINED.format(**self.figures()),
                time=t,
                hint="a smaller -ts_rtol, -ts_bdf_order 1 or contact.energy_strict: true may help",
            )

    def summary(self) -> dict[str, Any]:
        """For summary.json: gained, the most at any row [J]; its share; whether that exceeds the limit."""
        if self.balance is None:
            return {}
        share = self.balance.gained / self.balance.exchanged
        return {
            "gained": self.balance.gained,
            "gained_share": share,
            "gain_limit": self.limit,
            "flag": bool(share > self.limit),
        }

    def figures(self) -> dict[str, Any]:
        """Values of ``GAINED``."""
        b = self.balance
        assert b is not None
        return {
            "energy": shown(b.gained, "energy", b.system.units, 3),
            "percent": 100 * b.gained / b.exchanged,
        }
