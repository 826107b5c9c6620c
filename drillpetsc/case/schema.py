"""JSON schema of case files, for completion and checks in editors."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from drillpetsc.case.scene import Case


def case_json_schema() -> dict[str, Any]:
    """JSON schema (draft 2020-12) of a case file. Units inside texts are beyond it; `drillpetsc check` knows them."""
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


def _tidy(node: Any) -> Any:
    """Without empty defaults and generated titles."""
    if isinstance(node, list):
        return [_tidy(part) for part in node]
    if not isinstance(node, dict):
        return node
    is_names = "type" in node and not isinstance(node["type"], (str, list))  # a mapping of properties, one named `type`
    tidy = {}
    for key, value in node.items():
        if not is_names and (key == "default" and value is None or key == "title" and isinstance(value, str)):
            continue
        tidy[key] = _tidy(value)
    return tidy
