"""Run the case files of a folder, each into a folder with its name: run_flow.py CASES OUT [PETSc options]."""

import sys
from pathlib import Path

import petsc4py

petsc4py.init([sys.argv[0], *sys.argv[3:]])

from drillpetsc import run  # noqa: E402

for path in sorted(Path(sys.argv[1]).glob("*.yaml")):
    run(path, Path(sys.argv[2]) / path.stem, progress="silent")
