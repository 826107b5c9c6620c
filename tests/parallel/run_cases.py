"""Run cases in turn in one job, each with PETSc options of its own: run_cases.py JOBS, a JSON file of [case, folder, options]."""

import json
import sys
from pathlib import Path

import petsc4py

petsc4py.init(sys.argv[:1])

from petsc4py import PETSc  # noqa: E402

from drillpetsc import run  # noqa: E402

database = PETSc.Options()
for case, folder, options in json.loads(Path(sys.argv[1]).read_text()):
    given = dict(zip(options[::2], options[1::2], strict=True))
    for name, value in given.items():
        database.setValue(name, value)
    run(case, folder, progress="silent")
    for name in given:
        database.delValue(name)
