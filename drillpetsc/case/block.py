"""What all blocks of a case share: frozen, no unknown keys, helpful refusals."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, ClassVar, get_args

from pydantic import BaseModel, ConfigDict, Field, model_validator

from drillpetsc.case.key_paths import refuse, suggestion, unsupported
from drillpetsc.errors import shown


class Block(BaseModel):
    """A block of the case file. Attribute names are the keys (`from` is `from_`)."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", populate_by_name=True, use_attribute_docstrings=False
    )

    later_keys: ClassVar[tuple[str, ...]] = ()
    """Keys of the case format that this version refuses."""
    later_values: ClassVar[Mapping[str, tuple[str, ...]]] = {}
    """Values of the case format that this version refuses, by key."""
    told_by: ClassVar[str] = "kind"
    """The key, if it has it, that tells this block from others that may stand in its place."""

    @classmethod
    def keys(cls) -> list[str]:
        """The keys of this block as written in a case file."""
        return sorted(
            (field.alias or name for name, field in cls.model_fields.items()),
            key=lambda key: key != cls.told_by,
        )

    @model_validator(mode="before")
    @classmethod
    def _known_keys_only(cls, data: Any) -> Any:
        if not isinstance(data, Mapping):
            return data
        allowed = set(cls.keys()) | set(cls.model_fields)
        for key, value in data.items():
            if key in cls.later_keys:
                raise unsupported(key, got=value, what=key)
            if isinstance(value, str) and value in cls.later_values.get(key, ()):
                raise unsupported(key, got=value, what=f"{key} {value}")
            if key not in allowed:
                of = f" ({cls.told_by}: {shown(data[cls.told_by])})" if cls.told_by in data else ""
                hint = suggestion(key, cls.keys())
                raise refuse(
                    key, got=value, want=f"one of these keys{of}: {', '.join(cls.keys())}", hint=hint
                )
        return data

    def fill_defaults(self, **values: Any) -> None:
        """Fill in defaults that depend on other keys, while the model is being validated."""
        self.__dict__.update(values)


def derived_default(description: str) -> Any:
    """A key whose default follows from other keys: None until the model is settled, a value afterwards."""
    return Field(default=None, description=description)


def kinds_of(model: type[BaseModel], key: str = "kind") -> tuple[str, ...]:
    """The values of `kind` (or another key) that this model stands for."""
    return get_args(model.model_fields[key].annotation)


def tagged_union(
    *models: type[BaseModel], short: tuple[str, ...] = (), key: str = "kind"
) -> tuple[Callable[[Any], Any], Callable[[Any], str]]:
    """(check, tag) for a union of models that differ by `kind`, or by the key named `key`.

    check normalises and refuses: kinds named in `short` may be written as a bare word instead of a mapping.
    tag names the model for pydantic, as `kind:<name of the model>` (the prefix is dropped from key paths in
    messages).
    """
    model_of = {kind: model for model in models for kind in kinds_of(model, key)}
    every = ", ".join(model_of)

    def check(value: Any) -> Any:
        if isinstance(value, models):
            return value
        if isinstance(value, str) and short:
            if value in short:
                return {key: value}
            if value in model_of:
                words = ", ".join(short)
                raise refuse(
                    got=value, want=f"a mapping {{{key}: {value}, ...}}, or one of the words {words}"
                )
            raise refuse(got=value, want=f"one of {every}", hint=suggestion(value, model_of))
        if not isinstance(value, Mapping):
            raise refuse(got=value, want=f"a mapping with a {key}, one of {every}")
        if key not in value:
            guess = next((suggestion(other, [key]) for other in value if suggestion(other, [key])), "")
            raise refuse(key, want=f"a key '{key}', one of {every}", hint=guess)
        if not isinstance(value[key], str) or value[key] not in model_of:
            raise refuse(key, got=value[key], want=f"one of {every}", hint=suggestion(value[key], model_of))
        return value

    def tag(value: Any) -> str:
        kind = value[key] if isinstance(value, Mapping) else getattr(value, key)
        return f"kind:{model_of[kind].__name__}"

    return check, tag
