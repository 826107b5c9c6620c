"""Types of the public names, for editors and type checkers: `drillpetsc/__init__.pyi` is written from the blocks and commands.

A test compares the file with this text; `python -m drillpetsc.api.stub` writes it anew.
"""

from __future__ import annotations

import inspect
import textwrap
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import drillpetsc
from drillpetsc.api import PUBLIC
from drillpetsc.case import Case, case_json_schema
from drillpetsc.case.block import Block
from drillpetsc.case.python_blocks import CASE_BLOCKS, POSITIONAL, PUBLIC_NAMES, fixed_keys

HEAD = '''"""Types of the public names. Written by `python -m drillpetsc.api.stub`; do not edit."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

from drillpetsc import units as units, vibration as vibration
from drillpetsc.analysis.motion.session.session import Session as Session
from drillpetsc.case import Case as _Case
from drillpetsc.case.catalogue import catalogue as catalogue
from drillpetsc.errors import CaseError as CaseError, SolveError as SolveError
from drillpetsc.physics.tools.motor_law import MotorLaw
from drillpetsc.results import Result
from drillpetsc.studies.convergence.study import StudyResult
from drillpetsc.studies.sweep.sweep import SweepResult

__version__: str

Value = float | str
"""A text with a unit, or a number in the unit of the case."""

class PythonBlock:
    """A block of a case: a mapping of its keys."""
    def __getitem__(self, key: str) -> Any: ...
    def __setitem__(self, key: str, value: Any) -> None: ...
'''
STUB = Path(drillpetsc.__file__).with_suffix(".pyi")
TYPES = {
    "number": "float",
    "string": "str",
    "boolean": "bool",
    "integer": "int",
    "null": "None",
    "object": "dict[str, Any]",
}


def type_of(schema: dict[str, Any]) -> list[str]:
    """The Python types of a value with this JSON schema."""
    if "$ref" in schema:
        name = schema["$ref"].rpartition("/")[2]
        return [PUBLIC_NAMES.get(name, name), "dict[str, Any]"]
    for key in ("anyOf", "oneOf"):
        if key in schema:
            types = list(dict.fromkeys(name for part in schema[key] for name in type_of(part)))
            return (
                ["Value", *(q for q in types if q not in ("float", "str"))]
                if {"float", "str"} <= {*types}
                else types
            )
    if "const" in schema or "enum" in schema:
        words = schema.get("enum", [schema.get("const")])
        return [f"Literal[{', '.join(map(repr, words))}]"]
    if schema.get("type") == "array":
        items = schema.get("items") or {"anyOf": schema.get("prefixItems", [])}
        return [f"Sequence[{' | '.join(type_of(items))}]"]
    return [TYPES[schema["type"]]] if "type" in schema else ["Any"]


def _keywords(block: type[Block], schema: dict[str, Any]) -> list[str]:
    """The parameters of the class of a block, those first that must be given."""
    required, optional, positional = [], [], []
    for name, field in block.model_fields.items():
        if name in fixed_keys(block):
            continue
        types = type_of(schema["properties"][field.alias or name])
        if name == POSITIONAL:
            positional.append(f"{name}: {' | '.join(dict.fromkeys([*types, 'None']))} = None")
        elif field.is_required():
            required.append(f"{name}: {' | '.join(types)}")
        else:
            optional.append(f"{name}: {' | '.join(dict.fromkeys([*types, 'None']))} = None")
    return [*positional, "*", *required, *optional]


def _class(name: str, base: str, block: type[Block], schema: dict[str, Any]) -> str:
    keys = _keywords(block, schema)
    names = [key.partition(":")[0] for key in keys if key != "*"]
    text = [inspect.getdoc(block) or "", ""]
    text += [
        f"{key}: {schema['properties'][block.model_fields[key].alias or key].get('description', '')}"
        for key in names
    ]
    lines = [f"class {name}({base}):", f'    """{_indented(text)}', '    """']
    lines += [
        "    def __init__(",
        "        self,",
        *(f"        {key}," for key in keys),
        "    ) -> None: ...",
    ]
    return "\n".join(lines) + "\n"


def _indented(lines: Iterable[str]) -> str:
    return textwrap.indent("\n".join(lines), "    ").strip().replace("\\", "\\\\").replace('"""', "'''")


def _annotation(annotation: Any) -> str:
    """A type as it is written in Python."""
    if annotation is inspect.Parameter.empty:
        return "Any"
    text = annotation if isinstance(annotation, str) else inspect.formatannotation(annotation)
    text = (
        text.replace("collections.abc.", "")
        .replace("typing.", "")
        .replace("pathlib.", "")
        .replace("FilePath", "Path")
    )
    return text if not text.startswith("Optional[") else f"{text[len('Optional[') : -1]} | None"


def _function(name: str, function: Callable[..., Any]) -> str:
    signature = inspect.signature(function)
    lines, named = [], False
    for parameter in signature.parameters.values():
        kind = "_Case | str | Path" if parameter.name == "case" else _annotation(parameter.annotation)
        if parameter.default is None and "None" not in kind and kind != "Any":
            kind += " | None"
        star = "**" if parameter.kind is parameter.VAR_KEYWORD else ""
        if parameter.kind is parameter.KEYWORD_ONLY and not named:
            lines.append("*")
            named = True
        default = "" if parameter.default is parameter.empty else f" = {parameter.default!r}"
        lines.append(f"{star}{parameter.name}: {kind}{default}")
    back = _annotation(signature.return_annotation).replace("Case", "_Case")
    text = [f"def {name}(", *(f"    {line}," for line in lines), f") -> {back}:"]
    return (
        "\n".join([*text, f'    """{_indented([inspect.getdoc(function) or ""])}', '    """', "    ..."])
        + "\n"
    )


def stub() -> str:
    """The text of `drillpetsc/__init__.pyi`."""
    schema = case_json_schema()
    parts = [HEAD]
    for name, block in CASE_BLOCKS.items():
        parts.append(_class(PUBLIC_NAMES.get(name, name), "PythonBlock", block, schema["$defs"][name]))
    parts.append(_class("Case", "_Case", Case, schema))
    for name, thing in PUBLIC.items():
        if not isinstance(thing, type) and f" {name} as {name}" not in HEAD:
            parts.append(_function(name, thing))
    return "\n".join(parts)


if __name__ == "__main__":
    STUB.write_text(stub(), encoding="utf-8")
