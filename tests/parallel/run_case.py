"""Run a case: run_case.py CASE OUT [PETSc options]."""

import sys

from drillpetsc.cli import main

raise SystemExit(main(["run", sys.argv[1], "--out", sys.argv[2], "--progress", "silent", *sys.argv[3:]]))
