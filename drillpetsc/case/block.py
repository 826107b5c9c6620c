"""Base class of all blocks of a case: frozen, no unknown keys, error messages with a cure."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import fields
from functools import partial, reduce
from operator import or_
from typing import Annotated, Any, ClassVar, Literal, TypeVar, get_args

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    Tag,
    model_validator,
)
from pydantic_core import CoreSchema

from drillpetsc.case.key_paths import refuse, suggestion, unsupported
from drillpetsc.case.quantities import unit_of_field
from drillpetsc.case.trade_words import key_hint, kind_hint
from drillpetsc.errors import shown
from drillpetsc.units import spelled

AnyBlock = TypeVar("AnyBlock", bound="Block")


MOST_SHOWN = 6  # entries of a list in a repr


class _Shown(str):
    """A text that is its own repr."""

    def __repr__(self) -> str:
        return str(self)


class Block(BaseModel):
    """A block of the case file. Attribute names are the keys (`from` is `from_`)."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", populate_by_name=True, use_attribute_docstrings=False, defer_build=True
    )

    unsupported_keys: ClassVar[tuple[str, ...]] = ()
    """Keys of the case format that this version refuses."""
    keys_elsewhere: ClassVar[Mapping[str, str]] = {}
    """Keys that belong to another block, and what to write there."""
    unsupported_values: ClassVar[Mapping[str, tuple[str, ...]]] = {}
    """Values of the case format that this version refuses, by key."""
    discriminator: ClassVar[str] = "kind"
    """Key that selects among the blocks that may stand in one place."""
    optional_attributes: ClassVar[Mapping[str, Any]] = {}
    """Attributes that every block of a family has, although they are keys of some of its blocks only.

    Attribute -> value in a block without that key. So `case.top.force` is None where the kind of top takes no
    force.
    """

    @classmethod
    def __pydantic_init_subclass__(cls, **_: Any) -> None:
        """Give a block of a certain kind the attributes of its family that are not keys of it."""
        if cls.discriminator in cls.model_fields:
            for name, value in cls.optional_attributes.items():
                if name not in cls.model_fields:
                    setattr(cls, name, value)

    @classmethod
    def __get_pydantic_json_schema__(
        cls, core_schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """The schema of pydantic, with the unit of its quantity in the description of each key."""
        schema = handler(core_schema)
        properties = handler.resolve_ref_schema(schema).get("properties", {})
        for name, field in cls.model_fields.items():
            unit = unit_of_field(field)
            if unit is not None:
                text = re.sub("^[^:;]*", rf"\g<0> [{spelled(unit) or '-'}]", field.description or "", count=1)
                properties[field.alias or name]["description"] = text
        return schema

    @classmethod
    def keys(cls) -> list[str]:
        """The keys of this block as written in a case file."""
        return sorted(
            (field.alias or name for name, field in cls.model_fields.items()),
            key=lambda key: key != cls.discriminator,
        )

    @model_validator(mode="before")
    @classmethod
    def _known_keys_only(cls, data: Any) -> Any:
        if not isinstance(data, Mapping):
            return data
        allowed = set(cls.keys()) | set(cls.model_fields)
        for key, value in data.items():
            if key in cls.keys_elsewhere:
                raise refuse(key, got=value, want=cls.keys_elsewhere[key])
            if key in cls.unsupported_keys:
                raise unsupported(key, got=value, what=key)
            if isinstance(value, str) and value in cls.unsupported_values.get(key, ()):
                raise unsupported(key, got=value, what=f"{key} {value}")
            if key not in allowed:
                of = (
                    f" ({cls.discriminator}: {shown(data[cls.discriminator])})"
                    if cls.discriminator in data
                    else ""
                )
                want = f"one of these keys{of}: {', '.join(cls.keys())}"
                raise refuse(key, got=value, want=want, hint=key_hint(str(key), cls.keys()))
        return data

    def __repr_args__(self) -> Iterator[tuple[str | None, Any]]:
        """The keys that were given, long lists of numbers in short; what follows from defaults is left out."""
        for name in type(self).model_fields:
            value = getattr(self, name)
            if name in self.model_fields_set and value is not None:
                long = (
                    isinstance(value, tuple) and len(value) > MOST_SHOWN and not isinstance(value[0], Block)
                )
                yield name, _Shown(f"({value[0]!r}, ..., {value[-1]!r}: {len(value)})") if long else value

    def __dir__(self) -> list[str]:
        """The keys, and what follows from them; the machinery that reads blocks is left out."""
        return [name for name in super().__dir__() if name.startswith("__") or not hasattr(Block, name)]

    def fill_defaults(self, **values: Any) -> None:
        """Fill in defaults that depend on other keys, while the block is being validated."""
        self.__dict__.update(values)


def derived_default(description: str) -> Any:
    """A key whose default follows from other keys: None until defaults are filled in, a value afterwards."""
    return Field(default=None, description=description)


def overlaid(below: AnyBlock, above: AnyBlock | None) -> AnyBlock:
    """The block `below` with the keys that `above` gives in its stead, blocks inside blocks likewise."""
    if above is None:
        return below
    given = {key: getattr(above, key) for key in above.model_fields_set}
    for key, value in given.items():
        if isinstance(value, Block):
            given[key] = overlaid(getattr(below, key), value)
    return below.model_copy(update=given)


def kinds_of(block: type[BaseModel], key: str = "kind") -> tuple[str, ...]:
    """The values of `kind` (or of another key) that select this block."""
    return get_args(block.model_fields[key].annotation)


class ByKind:
    """Metadata of a union of blocks that differ by `kind`, or by the key named ``key``.

    short: kinds that may be written as a single word instead of a mapping.
    """

    def __init__(self, *short: str, key: str = "kind") -> None:
        self.short, self.key = short, key

    @property
    def json_schema_input_type(self) -> Any:
        """Type of the words, for the manual."""
        return Literal[self.short] if self.short else None

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        blocks = get_args(source)
        block_of = {kind: block for block in blocks for kind in kinds_of(block, self.key)}

        def tag(value: Any) -> str:
            """Name of the block for pydantic; messages drop such a step of a key path."""
            kind = value[self.key] if isinstance(value, Mapping) else getattr(value, self.key)
            return f"kind:{block_of[kind].__name__}"

        tagged = [Annotated[block, Tag(f"kind:{block.__name__}")] for block in blocks]
        words = {"json_schema_input_type": Literal[self.short] | source} if self.short else {}
        check = BeforeValidator(partial(self._checked, blocks, block_of), **words)
        return handler.generate_schema(Annotated[reduce(or_, tagged), Discriminator(tag), check])

    def _checked(self, blocks: tuple[type, ...], block_of: Mapping[str, type], value: Any) -> Any:
        """A mapping or a block of a known kind; otherwise the key's error."""
        key, every = self.key, ", ".join(block_of)
        if isinstance(value, blocks):
            return value
        if isinstance(value, str) and self.short:
            if value in self.short:
                return {key: value}
            if value in block_of:
                words = ", ".join(self.short)
                raise refuse(
                    got=value, want=f"a mapping {{{key}: {value}, ...}}, or one of the words {words}"
                )
            raise refuse(got=value, want=f"one of {every}", hint=suggestion(value, block_of))
        if not isinstance(value, Mapping):
            raise refuse(got=value, want=f"a mapping with a {key}, one of {every}")
        if key not in value:
            suggested = next((suggestion(other, [key]) for other in value if suggestion(other, [key])), "")
            raise refuse(key, want=f"a key '{key}', one of {every}", hint=suggested)
        if not isinstance(value[key], str) or value[key] not in block_of:
            raise refuse(key, got=value[key], want=f"one of {every}", hint=kind_hint(value[key], block_of))
        return value


def by_names(kind: type, block: Block) -> dict[str, Any]:
    """What a block has by the names of the fields of a data class, for its construction."""
    return {field.name: getattr(block, field.name) for field in fields(kind) if hasattr(block, field.name)}
