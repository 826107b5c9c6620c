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

from drillpetsc import operations
from drillpetsc.api.functions import function_of
from drillpetsc.api.runs import mud_motor, open_run, run, study, sweep
from drillpetsc.case import Case, load_case
from drillpetsc.case.catalogue import catalogue
from drillpetsc.case.items import (
    HWDP,
    Agitator,
    Beam,
    Bit,
    Body,
    BumperSub,
    Casing,
    CoiledTubing,
    DrillCollar,
    DrillPipe,
    Jar,
    MudMotor,
    Pipe,
    Reamer,
    RotarySteerable,
    ShockSub,
    Stabilizer,
    Tool,
)
from drillpetsc.errors import CaseError, SolveError

statics = function_of(operations.Statics)
hydraulics = function_of(operations.Hydraulics)
surge = function_of(operations.Surge)
roadmap = function_of(operations.Roadmap)
limits = function_of(operations.Limits)
freepoint = function_of(operations.Freepoint)
calibrate = function_of(operations.Calibrate)
import_log = function_of(operations.ImportLog)
modes = function_of(operations.Modes)
campbell = function_of(operations.Campbell)
stability = function_of(operations.Stability)
response = function_of(operations.Response)
linearise = function_of(operations.Linearise)
fmu = function_of(operations.Fmu)
top_drive = function_of(operations.TopDrive)

__all__ = [
    "Agitator",
    "Beam",
    "Bit",
    "Body",
    "BumperSub",
    "Case",
    "CaseError",
    "Casing",
    "CoiledTubing",
    "DrillCollar",
    "DrillPipe",
    "HWDP",
    "Jar",
    "MudMotor",
    "Pipe",
    "Reamer",
    "RotarySteerable",
    "ShockSub",
    "Stabilizer",
    "Tool",
    "calibrate",
    "campbell",
    "catalogue",
    "fmu",
    "freepoint",
    "hydraulics",
    "import_log",
    "limits",
    "linearise",
    "load_case",
    "modes",
    "mud_motor",
    "open_run",
    "response",
    "roadmap",
    "SolveError",
    "run",
    "stability",
    "statics",
    "study",
    "surge",
    "sweep",
    "top_drive",
]
