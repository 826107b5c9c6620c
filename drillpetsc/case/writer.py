"""Case -> YAML."""

from __future__ import annotations

from io import StringIO
from typing import Any

from drillpetsc.case.blocks.case_blocks import CaseBlocks
from drillpetsc.case.files import plain_yaml
from drillpetsc.case.pipe.figures import Figures


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
        del data["initial"]["imperfection"]  # a start from rest has one only if it is given
    for item, item_data in zip(case.string, data["string"], strict=True):
        if item.material == case.material:
            del item_data["material"]
    if case.top.force is not None:
        data["top"].pop("lowering")
    if case.top.torque is not None:
        data["top"].pop("rotation")
    if not case.top.control:
        data["top"].pop("control", None)
    if case.top.hoist is not None:
        _without_unused(case, data["top"])
    return {key: value for key, value in _plain(data).items() if value not in ({}, [])}


def _without_unused(case: CaseBlocks, top: dict[str, Any]) -> None:
    """Leave out defaults of the hoist and its autodriller that belong to missing keys."""
    hoist, drill = case.top.hoist, case.top.autodriller
    if hoist is not None and hoist.line is not None and hoist.line.diameter is None:
        del top["hoist"]["line"]["modulus"], top["hoist"]["line"]["fill"]
    if drill is None:
        return
    if drill.from_ == 0:
        top.pop("lowering")
    for key, mode in drill.mode_of_key.items():
        if mode not in drill.mode:
            top["autodriller"].pop(key, None)


def sourced_yaml(case: CaseBlocks, figures: Figures) -> str:
    """The case as `case_yaml`, one key a line, with `# from: ...` behind each figure that the case did not give."""
    from ruamel.yaml import YAML

    data = case_data(case)
    tree = _commented(data)
    for number, found in figures.of_item.items():
        reference = figures.references.get(number)
        if reference is not None:
            tree["string"][number].yaml_set_start_comment(f"pipe: {reference}", indent=2)
        for figure in found:
            *blocks, key = figure.key.split(".")
            place = tree["string"][number]
            for block in blocks:
                place = place.get(block, {})
            if key in place:  # a material equal to the case's is in the block of the case instead
                place.yaml_add_eol_comment(f"from: {figure.source}", key)
    yaml = YAML(typ="rt", pure=True)
    yaml.width = 4096
    stream = StringIO()
    yaml.dump(tree, stream)
    return "# all numbers in SI: m, kg, s, N, Pa, rad\n" + stream.getvalue()


def _commented(value: Any) -> Any:
    """Plain data as ruamel's mappings and lists, which take comments; lists of numbers on one line."""
    from ruamel.yaml.comments import CommentedMap, CommentedSeq

    if isinstance(value, dict):
        return CommentedMap((key, _commented(part)) for key, part in value.items())
    if isinstance(value, list):
        parts = CommentedSeq(_commented(part) for part in value)
        if not any(isinstance(part, (dict, list)) for part in value):
            parts.fa.set_flow_style()
        return parts
    return value


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
    text = "# all numbers in SI: m, kg, s, N, Pa, rad\n"
    for key, value in case_data(case).items():
        try:
            text += plain_yaml.entry(key, value)
        except plain_yaml.OtherYaml:
            text += _by_ruamel(key, value)
    return text


def _by_ruamel(key: str, value: Any) -> str:
    """Lines of a key of a mapping in blocks, with any value."""
    from ruamel.yaml import YAML

    yaml = YAML(typ="safe", pure=True)
    yaml.default_flow_style = None  # short lists on one line
    yaml.sort_base_mapping_type_on_output = False  # type: ignore[assignment]
    yaml.width = plain_yaml.MAX_WIDTH  # ruamel breaks between a key and its value
    stream, last = StringIO(), "last: []\n"  # with a list in it the mapping is written in blocks
    yaml.dump({key: value, "last": []}, stream)
    return stream.getvalue().removesuffix(last)
