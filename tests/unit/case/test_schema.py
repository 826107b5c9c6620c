"""The JSON schema describes what the reader accepts; `cases/schema.json` is the one of this version."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from drillpetsc.case import Case, case_json_schema, read_case_file
from drillpetsc.case.schema import bare_unit_of
from drillpetsc.errors import CaseError
from tests.helpers.tables import each_row

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


@each_row("path", sorted([*CASES.glob("*.yaml"), *CASES.glob("field/*.yaml")]), ids=lambda path: path.stem)
def test_ready_cases_fit_the_schema(path: Path) -> None:
    data, _ = read_case_file(path)
    assert list(errors(data, SCHEMA)) == []


@each_row(
    "name",
    "unknown-key misspelt-key key-of-another-kind missing-key missing-block missing-kind unknown-kind unknown-top "
    "yes-for-a-number no-items contact-off short-vector quaternion half-points fluid-without-rheology "
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


MUD = {"density": 1260, "flow_rate": "550 gpm"}
RHEOLOGIES: tuple[tuple[dict[str, Any], bool], ...] = (
    ({"dial": {"600": 64, "300": 41}}, True),
    ({"dial": {"600": 64, "300": 41, "100": 22}, "model": "herschel_bulkley", "fit": "least_squares"}, True),
    ({"pv": "23 cP", "yp": "18 lbf/100ft2"}, True), ({"pv": 0.023, "yp": 9.0, "law": "exact"}, True),
    ({"n": 0.65, "k": "1.2 lbf s^n/100ft2"}, True), ({"ty": 3.0, "n": 0.65, "k": 0.5}, True),
    ({"model": "newtonian", "viscosity": 0.001}, True), ({"pv": "23 cP"}, False), ({"n": 0.65}, False),
    ({"pv": "23 cP", "yp": 9, "k": 1.0}, False), ({"dial": {"600": 64, "300": 41}, "model": "honey"}, False),
    ({"model": "newtonian"}, False), ({}, False),
)  # fmt: skip


@each_row(("rheology", "fits"), RHEOLOGIES, ids=lambda value: str(value)[:40])
@each_row("key", ["rheology", "annulus_rheology"])
def test_the_forms_of_a_mud_report_fit_where_the_reader_takes_them(
    key: str, rheology: dict[str, Any], fits: bool
) -> None:
    """The schema and the reader answer the same."""
    fluid = {"rheology": {"model": "newtonian", "viscosity": 0.001}, **MUD, key: rheology}
    schema = SCHEMA["properties"]["fluid"]
    assert (not list(errors(fluid, schema))) == fits
    case = {
        "string": [{"kind": "pipe", "length": 9.0, "od": 0.127, "id": 0.1}],
        "top": "clamped",
        "well": {
            "survey": {"md": [0, 20], "inclination": [0, 0], "azimuth": [0, 0]},
            "sections": [{"to": "end", "kind": "open_hole", "diameter": 0.2}],
        },
        "fluid": fluid,
    }
    if fits:
        assert Case(**case).fluid is not None
    else:
        with pytest.raises(CaseError):
            Case(**case)


def test_values_over_time_have_the_unit_of_their_key():
    """As of a sensitivity by the value of a ramp."""
    for key in ("top.rotation", "fluid.flow_rate"):
        for system in ("SI", "field", "metric"):
            assert bare_unit_of(f"{key}.value", system) == bare_unit_of(key, system) != ""
    assert bare_unit_of("fluid.density.value", "SI") == ""
