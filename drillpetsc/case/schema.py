"""JSON schema of case files, for completion and checks in editors."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, get_args

from pydantic.fields import FieldInfo

from drillpetsc.case.block import Block
from drillpetsc.case.blocks.case_blocks import CaseBlocks
from drillpetsc.case.key_paths import parsed
from drillpetsc.case.quantities import kinds_of_field, unit_of_field, varies_over_time
from drillpetsc.unit_systems import System, unit_of_bare_number
from drillpetsc.units import spelled


def case_json_schema() -> dict[str, Any]:
    """JSON schema (draft 2020-12) of a case file.

    It cannot check units inside texts; `drillpetsc check` does.
    """
    schema = _tidy(CaseBlocks.model_json_schema(by_alias=True, mode="validation"))
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "drillpetsc case",
        **{key: value for key, value in schema.items() if key != "title"},
    }


def write_schema(path: str | Path) -> None:
    """Write the schema to a file (`cases/schema.json`)."""
    Path(path).write_text(json.dumps(case_json_schema(), indent=1) + "\n", encoding="utf-8")


def unit_of(key: str) -> str:
    """SI unit of a key such as `fluid.density`, spelled `kg/m3`.

    Empty for pure numbers, for unknown keys, and for keys whose unit depends on other keys.
    """
    units = {unit_of_field(field) for field in _fields_of(key)}
    unit = units.pop() if len(units) == 1 else None
    return spelled(unit or "")


def bare_unit_of(key: str, system: System) -> str:
    """Unit of a number without one, of a key in a case with these units; empty as for `unit_of`, and if no such number is allowed."""
    kinds = {kind for field in _fields_of(key) for kind in kinds_of_field(field)}
    if len(kinds) != 1:
        return ""
    return spelled(unit_of_bare_number(*kinds.pop(), system) or "")


def _fields_of(key: str) -> list[FieldInfo]:
    """The fields of a key, one for each block that it may contain."""
    blocks: list[type[Block]] = [CaseBlocks]
    fields: list[FieldInfo] = []
    for step in parsed(key):
        if isinstance(step, int):  # the entries of a list have the unit of the list
            continue
        if step == "value" and any(varies_over_time(field) for field in fields):
            continue  # the values of a function of time have the unit of its key
        fields = [
            field
            for block in blocks
            for name, field in block.model_fields.items()
            if step in (name, field.alias)
        ]
        blocks = [block for field in fields for block in _blocks_in(field.annotation)]
    return fields


def _blocks_in(annotation: Any) -> list[type[Block]]:
    """Blocks that a value of this type may be or hold."""
    if isinstance(annotation, type) and issubclass(annotation, Block):
        return [annotation]
    return [block for part in get_args(annotation) for block in _blocks_in(part)]


def _tidy(node: Any) -> Any:
    """The schema without empty defaults and generated titles."""
    if isinstance(node, list):
        return [_tidy(part) for part in node]
    if not isinstance(node, dict):
        return node
    is_names = "type" in node and not isinstance(
        node["type"], (str, list)
    )  # a mapping of properties, one named `type`
    tidy = {}
    for key, value in node.items():
        if not is_names and (key == "default" and value is None or key == "title" and isinstance(value, str)):
            continue
        tidy[key] = _tidy(value)
    return tidy
