"""The JSON schema describes what the reader accepts; `cases/schema.json` is the one of this version."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from drillpetsc.case import case_json_schema, read_case_file

CASES = Path(__file__).parents[3] / "cases"
SCHEMA = case_json_schema()

KINDS: dict[str, tuple[type, ...]] = {
    "object": (dict,),
    "array": (list,),
    "string": (str,),
    "number": (int, float),
    "integer": (int,),
    "boolean": (bool,),
    "null": (type(None),),
}


UNDERSTOOD = set(
    "$ref $defs $schema title description default type const enum anyOf oneOf properties required items minItems "
    "maxItems additionalProperties minimum maximum exclusiveMinimum exclusiveMaximum".split()
)


def errors(value: Any, schema: dict[str, Any], at: str = "") -> Iterator[str]:
    """What JSON Schema (the part of it that is used here) has against the value."""
    assert set(schema) <= UNDERSTOOD
    if "$ref" in schema:
        yield from errors(value, SCHEMA["$defs"][schema["$ref"].removeprefix("#/$defs/")], at)
    for word in ("anyOf", "oneOf"):
        if word in schema and not any(not list(errors(value, option, at)) for option in schema[word]):
            yield f"{at}: fits no option"
    if "const" in schema and value != schema["const"] or "enum" in schema and value not in schema["enum"]:
        yield f"{at}: other value"
    if "type" in schema and (
        not isinstance(value, KINDS[schema["type"]])
        or (isinstance(value, bool) and schema["type"] != "boolean")
    ):
        yield f"{at}: not of type {schema['type']}"
        return
    if isinstance(value, dict):
        known = schema.get("properties", {})
        yield from (f"{at}.{key}: missing" for key in schema.get("required", []) if key not in value)
        for key, part in value.items():
            rest = schema.get("additionalProperties", True)
            if key not in known and rest is False:
                yield f"{at}.{key}: unknown"
            elif key in known or isinstance(rest, dict):
                yield from errors(part, known.get(key, rest), f"{at}.{key}")
    if isinstance(value, list):
        if not schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", len(value)):
            yield f"{at}: wrong length"
        for i, part in enumerate(value):
            yield from errors(part, schema.get("items", {}), f"{at}[{i}]")
    if isinstance(value, (int, float)):
        below = value < schema.get("minimum", value) or value <= schema.get("exclusiveMinimum", value - 1)
        if (
            below
            or value > schema.get("maximum", value)
            or value >= schema.get("exclusiveMaximum", value + 1)
        ):
            yield f"{at}: out of range"


@pytest.mark.parametrize("path", sorted(CASES.glob("*.yaml")), ids=lambda path: path.stem)
def test_ready_cases_fit_the_schema(path: Path) -> None:
    data, _ = read_case_file(path)
    assert list(errors(data, SCHEMA)) == []


@pytest.mark.parametrize(
    "name",
    "unknown-key misspelt-key key-of-another-kind missing-key missing-block missing-kind unknown-kind unknown-top "
    "bare-millimetres yes-for-a-number no-items contact-off short-vector quaternion half-points fluid-without-rheology "
    "rheology-key-of-another-model unknown-rheology unknown-friction-law flow-index-out-of-range "
    "unknown-bit-law bit-law-key-of-another half-a-blade layer-with-a-walk bit-anisotropy-above-one".split(),
)
def test_mistakes_that_an_editor_can_see(name: str) -> None:
    data, _ = read_case_file(CASES / "broken" / f"{name}.yaml")
    assert list(errors(data, SCHEMA)) != []


def test_every_key_of_a_block_is_described() -> None:
    blocks = {"": SCHEMA, **SCHEMA["$defs"]}
    bare = [f"{name}.{key}" for name, block in blocks.items() for key, part in block.get("properties", {}).items()
            if not part.get("description")]  # fmt: skip
    assert bare == []
    assert all(
        block.get("additionalProperties") is False for block in blocks.values() if "properties" in block
    )


def test_schema_file_is_the_current_one() -> None:
    """When this fails: python -c "from drillpetsc.case import write_schema;
    write_schema('cases/schema.json')"."""
    assert json.loads((CASES / "schema.json").read_text()) == SCHEMA
