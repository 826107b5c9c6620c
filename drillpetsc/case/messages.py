"""Errors of pydantic -> CaseError."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import islice
from typing import Any

from pydantic import ValidationError

from drillpetsc.case.key_paths import Path, suggestion, written
from drillpetsc.errors import CaseError, shown

_MISSING = object()

_WANT = {
    "missing": "this key; it has no default",
    "model_type": "a mapping of keys",
    "model_attributes_type": "a mapping of keys",
    "dict_type": "a mapping of keys",
    "tuple_type": "a list",
    "list_type": "a list",
    "string_type": "text",
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "int_parsing": "a whole number",
    "bool_type": "true or false",
    "none_required": "nothing",
}


def case_error(error: ValidationError, given: Mapping[str, Any]) -> CaseError:
    """All errors that pydantic found, as the first one with the others in `also`.

    given: data as the user wrote it
    """
    found: dict[str, CaseError] = {}
    for details in error.errors(include_url=False):
        one = _one(details, given)
        found.setdefault(one.at, one)
    # a list whose only entry is wrong is also "too short" for pydantic: the error of the entry says more
    first, *others = (
        one for at, one in found.items() if not any(at and _is_inside(other, at) for other in found)
    )
    if "units" in found:  # the others may come from reading bare numbers in other units than meant
        return found["units"]
    first.also = tuple(others)
    return first


def _is_inside(inner: str, outer: str) -> bool:
    """Whether a key path lies inside a block."""
    return inner != outer and inner.startswith(outer) and inner[len(outer)] in ".["


def _one(details: Mapping[str, Any], given: Mapping[str, Any]) -> CaseError:
    """CaseError of one error of pydantic."""
    context = details.get("ctx", {})
    kind = details["type"]
    location = (*details["loc"], *(context.get("at", ()) if kind == "case" else ()))
    path = _keys_only(location, given)
    value = _at(given, path)
    if kind == "case":
        got = context["got"] if value is _MISSING else value
        return CaseError(at=written(path), got=_brief(got), want=context["want"], hint=context["hint"])
    got = None if kind == "missing" or value is _MISSING else value
    want, hint = _allowed(details, got)
    return CaseError(at=written(path), got=_brief(got), want=want, hint=hint)


def _allowed(details: Mapping[str, Any], got: Any) -> tuple[str, str]:
    """(what is allowed, hint) of an error of pydantic."""
    kind, context = details["type"], details.get("ctx", {})
    if kind in ("literal_error", "enum"):
        words = [word.strip("'") for word in context["expected"].replace(" or ", ", ").split(", ")]
        return f"one of {', '.join(words)}" if len(words) > 1 else words[0], suggestion(got, words)
    if kind == "too_short":
        return f"at least {context['min_length']} entries" if context[
            "min_length"
        ] > 1 else "at least 1 entry", ""
    bounds = {"greater_than_equal": ("at least", "ge"), "less_than_equal": ("at most", "le")}
    if kind in bounds:
        word, key = bounds[kind]
        return f"{word} {context[key]:g}", ""
    return _WANT.get(kind, details["msg"]), ""


def _keys_only(location: Path, given: Any) -> Path:
    """The path without the steps that pydantic adds for members of a union."""
    path: list[str | int] = []
    for step in location:
        value = _at(given, (step,))
        if value is not _MISSING or isinstance(step, int) or ":" not in step and "[" not in step:
            path.append(step)
            given = value
    return tuple(path)


def _at(given: Any, path: Path) -> Any:
    """Value that the user wrote at a path; _MISSING if there is none."""
    for step in path:
        if isinstance(given, Mapping) and step in given:
            given = given[step]
        elif (
            isinstance(step, int)
            and isinstance(given, Sequence)
            and not isinstance(given, str)
            and step < len(given)
        ):
            given = given[step]
        else:
            return _MISSING
    return given


def _brief(value: Any, levels: int = 4) -> Any:
    """A value as YAML shows it, cut to the part that a message can show."""
    if isinstance(value, (Mapping, list, tuple)) and not levels:
        return "..."
    if isinstance(value, Mapping):
        parts = (f"{key}: {shown(_brief(part, levels - 1))}" for key, part in islice(value.items(), 40))
        return "{" + ", ".join(parts) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(shown(_brief(part, levels - 1)) for part in value[:40]) + "]"
    return shown(value) if isinstance(value, bool) else value
