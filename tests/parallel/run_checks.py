"""Checks in turn in one job, since its start costs as much as they do: run_checks.py FOLDER [NAMES].

What they return on rank 0 is written to FOLDER/report.json.  One that fails is named on every rank that it fails on, and ends the job.
"""

import json
import sys
import traceback
from pathlib import Path

import petsc4py

petsc4py.init(sys.argv[:1])

import pytest  # noqa: E402
from petsc4py import PETSc  # noqa: E402

from tests.parallel.checks_of_chain import chain_solver  # noqa: E402
from tests.parallel.checks_of_parts import (  # noqa: E402
    exchange,
    other_integrators,
    quaternion_string,
    totals,
)
from tests.parallel.checks_of_runs import (  # noqa: E402
    contacts_apart,
    counts,
    no_rank_holds_the_whole_string,
    steps_together,
    two_elements,
)

ON_FOUR = (exchange, totals, two_elements)
CHECKS = (
    *ON_FOUR, chain_solver, other_integrators, quaternion_string, contacts_apart, counts, steps_together,
    no_rank_holds_the_whole_string,
)  # fmt: skip


def report(folder: Path, checks=CHECKS) -> dict:
    """What each check returns, by its name."""
    found = {}
    for check in checks:
        try:
            with pytest.MonkeyPatch.context() as patch:
                found[check.__name__] = check(folder / check.__name__, patch)
        except BaseException as error:
            error.add_note(f"in the check {check.__name__} on rank {PETSc.COMM_WORLD.rank}")
            raise
    return found


if __name__ == "__main__":
    try:
        found = report(Path(sys.argv[1]), [check for check in CHECKS if check.__name__ in sys.argv[2:]])
    except BaseException:
        traceback.print_exc()
        sys.stderr.flush()
        PETSc.COMM_WORLD.tompi4py().Abort(1)
    if PETSc.COMM_WORLD.rank == 0:
        (Path(sys.argv[1]) / "report.json").write_text(json.dumps(found))
