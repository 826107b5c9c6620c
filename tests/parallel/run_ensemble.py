"""A job of several members on several ranks, with faults on purpose: run_ensemble.py WHAT WORDS...

plain: the command line as it is.  nap: members do nothing but sleep, so that the share of each rank does not
depend on the machine.
lost: on teams of several ranks the last rank leaves the computation alone, the others wait for it.
"""

from __future__ import annotations

import sys
import time

import petsc4py

petsc4py.init()

import drillpetsc.studies.sweep.sweep as ensemble  # noqa: E402
from drillpetsc.cli import main  # noqa: E402
from drillpetsc.studies.sweep import worker_groups as teams  # noqa: E402

what, *words = sys.argv[1:]
real = ensemble.run


def nap(case, out, **keywords) -> None:
    out.mkdir()
    time.sleep(0.5)


def lost(case, out, **keywords) -> None:
    comm = keywords["comm"]
    if comm.size > 1 and comm.rank == comm.size - 1:
        raise RuntimeError("gone")
    if comm.size > 1:
        comm.tompi4py().Barrier()
    real(case, out, **keywords)


teams.RANK_TIMEOUT = 2.0
teams.LEAST_ELEMENTS = 40  # so that short strings, too, get two ranks
ensemble.run = {"plain": real, "nap": nap, "lost": lost}[what]  # type: ignore[assignment]
status = main(words)
if petsc4py.PETSc.COMM_WORLD.rank == 0:
    print("exit status", status)
