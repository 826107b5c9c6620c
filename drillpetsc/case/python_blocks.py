"""Blocks of a case for Python: `DrillPipe("5in 19.50 S-135 NC50 premium", length="9200 ft")`, `TopDrive(rotation="120 rpm")`.

Each block of the case file has a class of its name here, made from the block itself. It is a mapping as in a case file, with the
keys of that block. Values are written as in the file: text carries a unit, and a bare number has the unit set by the case. They are
read when the case is made, because a unit of bare numbers belongs to a case. An unknown key is refused at once.
"""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from typing import Any, ClassVar, get_args

from drillpetsc.case.block import Block
from drillpetsc.case.case import Case
from drillpetsc.case.quantities import with_text
from drillpetsc.case.schema import case_json_schema
from drillpetsc.case.trade_words import key_hint
from drillpetsc.errors import CaseError

#: block -> name for users, where the block is called otherwise to keep it apart from the component that it becomes
PUBLIC_NAMES = {
    "HeavyPipe": "HWDP",
    "PositiveDisplacementMotor": "MudMotor",
    "AgitatorTool": "Agitator",
    "HoistBlock": "Hoist",
    "AutodrillerBlock": "Autodriller",
}
TAGS = ("kind", "model")  # keys that tell the blocks apart that may stand in one place
POSITIONAL = "pipe"  # text reference to the catalogue, which needs no name


class PythonBlock(dict[str, Any]):
    """A block of a case: a mapping of its keys. Use the class of a block, such as `DrillPipe`.

    Raises CaseError for a key that the block does not have, and for a key that must be given and is not.
    """

    keys_of_kind: ClassVar[Mapping[str, Any]] = {}
    """The key that the class itself gives, such as `kind: drill_pipe`."""

    def __init__(self, /, *positional: Any, **keys: Any) -> None:
        signature = inspect.signature(type(self))
        if positional and POSITIONAL in signature.parameters:
            keys = {POSITIONAL: positional[0], **keys}
            positional = positional[1:]
        name = type(self).__name__
        if positional:
            raise CaseError(
                at=name, got=positional[0], want=f"keys by name: {', '.join(signature.parameters)}"
            )
        for key, value in keys.items():
            if key in self.keys_of_kind:
                raise CaseError(at=key, got=value, want=f"no {key} in {name}: {self.keys_of_kind[key]}")
            if key not in signature.parameters:
                want = f"one of these keys ({name}): {', '.join(sorted(signature.parameters))}"
                raise CaseError(at=key, got=value, want=want, hint=key_hint(key, signature.parameters))
        for key, parameter in signature.parameters.items():
            if parameter.default is parameter.empty and keys.get(key) is None:
                raise CaseError(at=f"{name}: {key}", want="this key; it has no default")
        given = {key.removesuffix("_"): with_text(value) for key, value in keys.items() if value is not None}
        super().__init__({**self.keys_of_kind, **given})

    def __repr__(self) -> str:
        keyword = {name.removesuffix("_"): name for name in inspect.signature(type(self)).parameters}
        given = ", ".join(f"{keyword[k]}={v!r}" for k, v in self.items() if k not in self.keys_of_kind)
        return f"{type(self).__name__}({given})"

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, (type(self), dict(self))


def _again(of: type[PythonBlock], keys: Mapping[str, Any]) -> PythonBlock:
    """A block from a copy of its keys (copy and pickle)."""
    block = of.__new__(of)
    block.update(keys)
    return block


def signature_of(block: type[Block]) -> inspect.Signature:
    """The keys of a block as keywords, those first that must be given; a key that is a Python word ends with an underscore."""
    parameters = []
    for name, field in block.model_fields.items():
        if name in fixed_keys(block):
            continue
        default = inspect.Parameter.empty if field.is_required() else None
        named = inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default)
        first = name == POSITIONAL
        parameters.append(named.replace(kind=inspect.Parameter.POSITIONAL_OR_KEYWORD) if first else named)
    return inspect.Signature(sorted(parameters, key=lambda p: (p.name != POSITIONAL, p.default is None)))


def fixed_keys(block: type[Block]) -> dict[str, Any]:
    """The keys of a block that have one value."""
    words = {name: get_args(field.annotation) for name, field in block.model_fields.items()}
    return {name: word[0] for name, word in words.items() if name in TAGS and len(word) == 1}


def _documentation(block: type[Block], signature: inspect.Signature) -> str:
    """The docstring of the block, and a line for each key."""
    lines = [inspect.getdoc(block) or "", ""]
    lines += [f"{name}: {block.model_fields[name].description or ''}" for name in signature.parameters]
    return "\n".join(lines)


def _of_every_level(block: type[Block]) -> dict[str, type[Block]]:
    """All blocks that follow from one, by name."""
    found: dict[str, type[Block]] = {}
    for part in block.__subclasses__():
        found |= {part.__name__: part} | _of_every_level(part)
    return found


def _python_block(block: type[Block]) -> type[PythonBlock]:
    signature = signature_of(block)
    contents = {
        "__doc__": _documentation(block, signature),
        "__module__": "drillpetsc",  # where copies and pickles find it
        "__signature__": signature,
        "keys_of_kind": fixed_keys(block),
    }
    return type(PUBLIC_NAMES.get(block.__name__, block.__name__), (PythonBlock,), contents)


Case.__signature__ = signature_of(Case)  # for the help of a notebook
#: blocks that stand in a case, by their names in the schema
CASE_BLOCKS = {name: _of_every_level(Block)[name] for name in case_json_schema()["$defs"]}
#: classes for Python by name
PYTHON_BLOCKS = {PUBLIC_NAMES.get(name, name): _python_block(block) for name, block in CASE_BLOCKS.items()}
