"""The case: a typed, frozen description of a scene, from a YAML file or from Python."""

from drillpetsc.case.case import Case
from drillpetsc.case.key_paths import override
from drillpetsc.case.reader import case_from_data, load_case, read_case_file
from drillpetsc.case.schema import case_json_schema, write_schema

__all__ = [
    "Case",
    "case_from_data",
    "case_json_schema",
    "load_case",
    "override",
    "read_case_file",
    "write_schema",
]
