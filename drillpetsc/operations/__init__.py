"""Operations: one class a command, from which the command line, the Python functions and pages of the manual are made."""

from __future__ import annotations

from drillpetsc.operations import shell
from drillpetsc.operations.cases import Catalogue, Check, Import, ImportLog, Schema
from drillpetsc.operations.flow import Hydraulics, Surge
from drillpetsc.operations.linear import Campbell, Fmu, Linearise, Modes, Response, Stability, TopDrive
from drillpetsc.operations.loads import (
    Calibrate,
    Follow,
    Freepoint,
    Limits,
    Roadmap,
    Sensitivities,
    Statics,
    Uncertain,
)
from drillpetsc.operations.operation import RENAMED_OPTIONS as RENAMED_OPTIONS
from drillpetsc.operations.operation import Operation
from drillpetsc.operations.pictures import Export, Paraview, Plot, Report, Serve, Vibration, View
from drillpetsc.operations.runs import Run, Study, Sweep
from drillpetsc.operations.shell import Completion, Man

#: in the order in which the help lists them
OPERATIONS: list[type[Operation]] = [
    *(Run, Sweep, Study),
    *(Check, Catalogue, Import, ImportLog, Schema),
    *(Statics, Hydraulics, Surge, Roadmap, Limits, Freepoint, Calibrate, Follow, Sensitivities, Uncertain),
    *(Modes, Campbell, Stability, Response, Linearise, Fmu, TopDrive),
    *(View, Paraview, Plot, Serve, Vibration, Report, Export),
    *(Completion, Man),
]
shell.OFFERED += OPERATIONS
