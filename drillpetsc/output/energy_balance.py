"""Whether a run makes energy out of nothing: time integration may lose some, but gains are the first sign of
one that is unstable."""

from __future__ import annotations

from typing import Any

from petsc4py import PETSc

from drillpetsc.errors import SolveError
from drillpetsc.output.recorder import Recorder

LIMIT = 0.01  # of the larger of work supplied and peak change of stored energy
ROWS_ABOVE_LIMIT = 3  # rows in a row above the limit before a run is stopped


class EnergyGainMonitor:
    """Energy gained without input, from the recorder's books at every row of the history.

    Options: -drillpetsc_gain_limit (default 0.01) and -drillpetsc_stop_on_gain, which ends such a run.
    """

    def __init__(self, recorder: Recorder):
        options = PETSc.Options()
        self.recorder, self.rows = recorder, 0
        self.limit = options.getReal("drillpetsc_gain_limit", LIMIT)
        self.stops = options.getBool("drillpetsc_stop_on_gain", False) and recorder.has_energies

    def check(self, t: float) -> None:
        """After a row at ``t`` [s]: raise SolveError, on all ranks, if the run is to be stopped."""
        if not self.stops:
            return
        self.rows = self.rows + 1 if self.recorder.audited_error > self.limit * self.recorder.exchanged else 0
        if self.rows >= ROWS_ABOVE_LIMIT:
            raise SolveError(
                self.message(),
                time=t,
                hint="a smaller -ts_rtol, -ts_bdf_order 1 or contact.energy_strict: true may help",
            )

    def summary(self) -> dict[str, Any]:
        """For summary.json: gained, the most at any row [J]; its share; whether that is too much."""
        share = self.recorder.gained / self.recorder.exchanged
        return {
            "gained": self.recorder.gained,
            "gained_share": share,
            "gain_limit": self.limit,
            "flag": bool(share > self.limit),
        }

    def message(self) -> str:
        """For the user."""
        r = self.recorder
        return f"the time integration gained {r.gained:.3g} J without input, {100 * r.gained / r.exchanged:.2g} % of the energy exchanged"
