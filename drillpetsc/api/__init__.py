"""The public Python face: a function for each command of the command line, made from the class of the command.

    import drillpetsc
    case = drillpetsc.load_case("cases/vertical-2000m.yaml", ["top.rotation=90 rpm"])
    result = drillpetsc.run(case, "out")
    print(result.summary["real_time_factor"], result.history["hook_load"][-1])

PETSc is initialised by the first function that needs it, unless the caller has done so. Each function writes
the same files as its command and raises the same errors: CaseError for bad input, SolveError for a computation
that cannot go on.
"""

from __future__ import annotations

from typing import Any

import drillpetsc.operations as operations
from drillpetsc.api.functions import function_of
from drillpetsc.api.runs import mud_motor, open_run, run, study, sweep
from drillpetsc.case import Case, load_case
from drillpetsc.case.catalogue import catalogue
from drillpetsc.case.python_blocks import PYTHON_BLOCKS
from drillpetsc.errors import CaseError, SolveError

COMMANDS = (
    operations.Statics,
    operations.Sensitivities,
    operations.Uncertain,
    operations.Hydraulics,
    operations.Surge,
    operations.Roadmap,
    operations.Limits,
    operations.Freepoint,
    operations.Calibrate,
    operations.Follow,
    operations.ImportLog,
    operations.Modes,
    operations.Campbell,
    operations.Stability,
    operations.Response,
    operations.Linearise,
    operations.Fmu,
    operations.TopDrive,
)
WRITTEN = (Case, CaseError, SolveError, catalogue, load_case, mud_motor, open_run, run, study, sweep)
#: public name -> what it is; `drillpetsc/__init__.pyi` has the types
PUBLIC: dict[str, Any] = {
    **PYTHON_BLOCKS,
    **{thing.__name__: thing for thing in WRITTEN},
    **{function.__name__: function for function in map(function_of, COMMANDS)},
}
