"""Commands of several members in turn in one job, with intended faults: run_sweep.py LINES, a JSON file of lists WHAT, WORDS...

plain: the command line unchanged.
sleep: members only sleep, so that the work of each rank does not depend on the machine.
lost: in worker groups of several ranks the last rank leaves the computation while the others wait for it.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path

import petsc4py

petsc4py.init()

import drillpetsc.studies.sweep.sweep as sweep_module  # noqa: E402
from drillpetsc.cli import main  # noqa: E402
from drillpetsc.studies.sweep import worker_groups  # noqa: E402

real = sweep_module.run


def sleep(case, out, **keywords) -> None:
    out.mkdir()
    time.sleep(0.5)


def lost(case, out, **keywords) -> None:
    comm = keywords["comm"]
    if comm.size > 1 and comm.rank == comm.size - 1:
        raise RuntimeError("gone")
    if comm.size > 1:
        comm.tompi4py().Barrier()
    real(case, out, **keywords)


worker_groups.RANK_TIMEOUT = 2.0
worker_groups.LEAST_ELEMENTS = 40  # short strings get two ranks
for what, *words in json.loads(Path(sys.argv[1]).read_text()):
    sweep_module.run = {"plain": real, "sleep": sleep, "lost": lost}[what]  # type: ignore[assignment]
    status = main(words)
    if petsc4py.PETSc.COMM_WORLD.rank == 0:
        print("exit status", status)
