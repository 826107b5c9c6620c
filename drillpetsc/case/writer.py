"""Case -> YAML."""

from __future__ import annotations

from io import StringIO
from typing import Any

from drillpetsc.case.blocks.case_blocks import CaseBlocks


def case_data(case: CaseBlocks) -> dict[str, Any]:
    """The case as plain data in SI, with every default and the keys of a case file.

    `Case(**case_data(case)) == case`.
    """
    data = case.model_dump(mode="python", by_alias=True, exclude_none=True, exclude={"units"})
    if case.well is not None and case.contact is None:
        data["contact"] = "none"
    if case.well is not None:  # the hole gives the position of the string
        del data["initial"]["inclination"], data["initial"]["azimuth"]
    if case.initial.from_ != "statics" and "imperfection" not in case.initial.model_fields_set:
        del data["initial"]["imperfection"]  # a start from rest has one only where it is given
    for item, item_data in zip(case.string, data["string"], strict=True):
        if item.material == case.material:
            del item_data["material"]
    if case.top.force is not None:
        data["top"].pop("lowering")
    return {key: value for key, value in _plain(data).items() if value not in ({}, [])}


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {
            key: _plain(value[key]) for key in sorted(value, key=lambda key: key not in ("kind", "model"))
        }
    if isinstance(value, (list, tuple)):
        return [_plain(part) for part in value]
    return value


def case_yaml(case: CaseBlocks) -> str:
    """The case as YAML 1.2 text: SI numbers, blocks in the order of the schema."""
    from ruamel.yaml import YAML

    yaml = YAML(typ="safe", pure=True)
    yaml.default_flow_style = None  # short lists on one line
    yaml.sort_base_mapping_type_on_output = False  # type: ignore[assignment]
    yaml.width = 4096  # ruamel breaks between a key and its value
    stream = StringIO()
    yaml.dump(case_data(case), stream)
    return "# all numbers in SI: m, kg, s, N, Pa, rad\n" + stream.getvalue()
