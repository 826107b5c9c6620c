"""Run a case with an error on rank 1 alone: fail_case.py nan|exception|error CASE OUT CLOCK.

The time of day of the error [s] is written to CLOCK.
"""

import sys
import time
from pathlib import Path

import numpy as np

from drillpetsc.cli import main
from drillpetsc.errors import SolveError
from drillpetsc.fem.assembly import Assembly

KIND, CASE, OUT, CLOCK = sys.argv[1:]
residual, step_rows = Assembly.residual, Assembly.step_rows


def spoil(self: Assembly, t: float) -> None:
    from petsc4py import PETSc

    if PETSc.COMM_WORLD.rank == 1 and t > 0.02:
        if not Path(CLOCK).exists():
            Path(CLOCK).write_text(repr(time.time()))
        pieces = [
            b
            for b in self.bound_blocks
            if b.block.component == "contact" and b.block.on == "cell" and len(b.block.points)
        ]
        contact = max(pieces, key=lambda b: b.block.points[-1])
        if KIND == "exception":
            contact.block.update = lambda t: 1 / 0
        elif KIND == "error":
            raise SolveError("spoiled on purpose", time=t, component="contact")
        else:
            contact.block.named["radius"][-1] = np.nan  # of this rank's last element


def spoiled_residual(self: Assembly, t: float):
    spoil(self, t)
    return residual(self, t)


def spoiled_step(self: Assembly, t: float, *rest):
    spoil(self, t)
    return step_rows(self, t, *rest)


Assembly.residual, Assembly.step_rows = spoiled_residual, spoiled_step  # type: ignore[method-assign]
raise SystemExit(main(["run", CASE, "--out", OUT, "--progress", "silent"]))
