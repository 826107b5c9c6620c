"""The case file: a typed, frozen description of the simulation, from YAML or from Python.

Plain data: nothing here imports PETSc, the kernels or a solver.
"""

from drillpetsc.case.case import Case
from drillpetsc.case.changes import override
from drillpetsc.case.reader import case_from_data, data_of_case, load_case, read_case_file
from drillpetsc.case.schema import case_json_schema, write_schema

__all__ = [
    "Case",
    "case_from_data",
    "case_json_schema",
    "data_of_case",
    "load_case",
    "override",
    "read_case_file",
    "write_schema",
]
