"""JSON schema of case files, for completion and checks in editors."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

from drillpetsc.case.case import Case
from drillpetsc.case.key_paths import parsed


def case_json_schema() -> dict[str, Any]:
    """JSON schema (draft 2020-12) of a case file. Units inside texts are beyond it; `drillpetsc check` knows
    them."""
    schema = Case.model_json_schema(by_alias=True, mode="validation")
    schema = _tidy(schema)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "drillpetsc case",
        **{key: value for key, value in schema.items() if key != "title"},
    }


def write_schema(path: str | Path) -> None:
    """Write the schema to a file (`cases/schema.json`)."""
    Path(path).write_text(json.dumps(case_json_schema(), indent=1) + "\n", encoding="utf-8")


def unit_of(key: str) -> str:
    """SI unit of a key such as `fluid.density` as its description gives it (`kg/m3`), or nothing."""
    schema = case_json_schema()
    nodes: list[dict[str, Any]] = [schema]
    for step in parsed(key):
        inside = [option for node in nodes for option in _options(node, schema)]
        nodes = [
            node["items"] if isinstance(step, int) else node["properties"][step]
            for node in inside
            if ("items" in node if isinstance(step, int) else step in node.get("properties", {}))
        ]
    units = {
        match.group(1) for node in nodes if (match := re.search(r"\[([^\]]+)\]", node.get("description", "")))
    }
    return units.pop().replace("-", "") if len(units) == 1 else ""


def _options(node: dict[str, Any], schema: dict[str, Any]) -> list[dict[str, Any]]:
    """What a node of the schema may be, references followed."""
    if "$ref" in node:
        return _options(schema["$defs"][node["$ref"].rsplit("/", 1)[1]], schema)
    several = [*node.get("anyOf", []), *node.get("oneOf", [])]
    return [node, *(found for option in several for found in _options(option, schema))]


def _tidy(node: Any) -> Any:
    """Without empty defaults and generated titles."""
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
