"""A run on these ranks with few and with many steps evaluated together, and with rows that never wait: steps_together_mpi.py FOLDER."""

import sys
from pathlib import Path

import petsc4py

petsc4py.init([])

from petsc4py import PETSc  # noqa: E402

from drillpetsc.analysis.motion.transient import run  # noqa: E402
from drillpetsc.case import load_case  # noqa: E402
from drillpetsc.output import recorder  # noqa: E402
from drillpetsc.output.files import run_writer  # noqa: E402

CASE = "cases/benchmark/coupled-2000m.yaml"
folder, found = Path(sys.argv[1]), []
case = load_case(
    CASE,
    [
        "time.end=0.2 s",
        "string[0].element_length=45 m",
        "string[1].element_length=33 m",
        "output.probes=[600 m, 1900 m]",
    ],
)
for count, wait in ((1, 0.5), (5, 0.5), (256, 1e9), (256, 0.0)):
    recorder.STEPS_AT_ONCE, run_writer.ROWS_WAIT = count, wait
    out = folder / f"{count}-{wait:g}"
    result = run(case, out, progress="silent")
    if PETSc.COMM_WORLD.rank == 0:
        tables = [(out / f"{name}.csv").read_bytes() for name in ("history", "probes")]
        found.append((*tables, result.summary["energy"], result.summary["mass"]))
if found:
    assert found[0][0].count(b"\n") == 22, found[0][0]
    assert all(one == found[0] for one in found)
    print("same files on", PETSc.COMM_WORLD.size, "ranks")
