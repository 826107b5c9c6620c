"""What all blocks of a case share: frozen, no unknown keys, helpful refusals."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, ClassVar, get_args

from pydantic import BaseModel, ConfigDict, Field, model_validator

from drillpetsc.case.keys import later, near, refuse


class Model(BaseModel):
    """A block of the case file. Attribute names are the keys (`from` is `from_`)."""

    model_config = ConfigDict(frozen=True, extra="forbid", populate_by_name=True, use_attribute_docstrings=False)

    later_keys: ClassVar[tuple[str, ...]] = ()
    """Keys of the case format that this version refuses."""
    later_values: ClassVar[Mapping[str, tuple[str, ...]]] = {}
    """Values of the case format that this version refuses, by key."""

    @classmethod
    def keys(cls) -> list[str]:
        """The keys of this block as written in a case file."""
        return sorted((field.alias or name for name, field in cls.model_fields.items()), key=lambda key: key != "kind")

    @model_validator(mode="before")
    @classmethod
    def _known_keys_only(cls, data: Any) -> Any:
        if not isinstance(data, Mapping):
            return data
        allowed = set(cls.keys()) | set(cls.model_fields)
        for key, value in data.items():
            if key in cls.later_keys:
                raise later(key, got=value, what=key)
            if isinstance(value, str) and value in cls.later_values.get(key, ()):
                raise later(key, got=value, what=f"{key} {value}")
            if key not in allowed:
                of = f" (kind: {data['kind']})" if "kind" in data else ""
                hint = near(key, cls.keys())
                raise refuse(key, got=value, want=f"one of these keys{of}: {', '.join(cls.keys())}", hint=hint)
        return data

    def settle(self, **values: Any) -> None:
        """Fill in defaults that depend on other keys, while the model is being validated."""
        self.__dict__.update(values)


def follows(description: str) -> Any:
    """A key whose default follows from other keys: None until the model is settled, a value afterwards."""
    return Field(default=None, description=description)


def kinds_of(model: type[BaseModel]) -> tuple[str, ...]:
    """The values of `kind` that this model stands for."""
    return get_args(model.model_fields["kind"].annotation)


def chosen(*models: type[BaseModel], short: tuple[str, ...] = ()) -> tuple[Callable[[Any], Any], Callable[[Any], str]]:
    """(check, tag) for a union of models that differ by `kind`.

    check normalises and refuses: kinds named in `short` may be written as a bare word instead of a mapping.
    tag names the model for pydantic, as `kind:<name of the model>` (the prefix is dropped from key paths in messages).
    """
    model_of = {kind: model for model in models for kind in kinds_of(model)}
    every = ", ".join(model_of)

    def check(value: Any) -> Any:
        if isinstance(value, models):
            return value
        if isinstance(value, str) and short:
            if value in short:
                return {"kind": value}
            if value in model_of:
                words = ", ".join(short)
                raise refuse(got=value, want=f"a mapping {{kind: {value}, ...}}, or one of the words {words}")
            raise refuse(got=value, want=f"one of {every}", hint=near(value, model_of))
        if not isinstance(value, Mapping):
            raise refuse(got=value, want=f"a mapping with a kind, one of {every}")
        if "kind" not in value:
            guess = next((near(key, ["kind"]) for key in value if near(key, ["kind"])), "")
            raise refuse("kind", want=f"a key 'kind', one of {every}", hint=guess)
        if not isinstance(value["kind"], str) or value["kind"] not in model_of:
            raise refuse("kind", got=value["kind"], want=f"one of {every}", hint=near(value["kind"], model_of))
        return value

    def tag(value: Any) -> str:
        kind = value["kind"] if isinstance(value, Mapping) else value.kind
        return f"kind:{model_of[kind].__name__}"

    return check, tag
