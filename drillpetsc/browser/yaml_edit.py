"""One value of a YAML text set, added or removed; every other letter stays, comments and spaces included."""

from __future__ import annotations

from io import StringIO
from typing import Any

from drillpetsc.case.files.yaml_text import parse
from drillpetsc.case.key_paths import parsed
from drillpetsc.errors import CaseError

INDENT = 2  # spaces of a new block


def with_value(text: str, at: str, value: str) -> str:
    """The text with the value at a key path such as `string[1].od`, which is added if it is not there.

    value: as YAML, such as `8 in` or `{kind: bit}`.  Raises CaseError for a path that the text does not have.
    """
    value = value.strip()
    if not value or "\n" in value:
        raise CaseError(at=at, got=value, want="a value on one line")
    *above, last = parsed(at)
    holder = _node(text, above)
    if holder is not None and isinstance(last, int):
        found = holder.value[last] if _is(holder, "Sequence") and last < len(holder.value) else None
    elif holder is None or _is(holder, "Mapping"):
        found = next((v for k, v in holder.value if k.value == last), None) if holder is not None else None
    else:
        raise CaseError(at=at, want="a key path inside the case")
    if found is not None:
        end = _end(text, found)
        changed = text[: found.start_mark.index] + value + text[end:]
    elif isinstance(last, int):
        raise CaseError(at=at, want="an entry that the list has")
    else:
        changed = _with_key(text, holder, last, value)
    _refuse_unreadable(changed, at, value)
    return changed


def without(text: str, at: str) -> str:
    """The text without a key, or without an entry of a list."""
    *above, last = parsed(at)
    holder = _node(text, above)
    if holder is None or _is(holder, "Scalar"):
        raise CaseError(at=at, want="a key that the case has")
    pairs = [(k, v) for k, v in holder.value] if _is(holder, "Mapping") else [(v, v) for v in holder.value]
    number = (
        last
        if isinstance(last, int)
        else next((i for i, (k, _) in enumerate(pairs) if k.value == last), len(pairs))
    )
    if not 0 <= number < len(pairs):
        raise CaseError(at=at, want="a key that the case has")
    if len(pairs) == 1 and above:
        return without(text, at[: max(at.rfind("."), at.rfind("["))])  # an empty block has no meaning
    key, value = pairs[number]
    if holder.flow_style:
        if number + 1 < len(pairs):
            return text[: key.start_mark.index] + text[pairs[number + 1][0].start_mark.index :]
        return text[: _end(text, pairs[number - 1][1])] + text[_end(text, value) :]
    start = text.rfind("\n", 0, key.start_mark.index) + 1
    if text[start : key.start_mark.index].strip(" "):  # the first key of an entry stands behind its dash
        following = (
            pairs[number + 1][0].start_mark.index
            if isinstance(last, str) and number + 1 < len(pairs)
            else None
        )
        if following is not None:
            return text[: key.start_mark.index] + text[following:]
    end = text.find("\n", _end(text, value))
    return text[:start] + (text[end + 1 :] if end >= 0 else "")


def _with_key(text: str, holder: Any, key: str, value: str) -> str:
    """The text with a new key at the end of a mapping; holder None: of an empty text."""
    new = f"{key}: {value}"
    if holder is None:
        return f"{text.rstrip()}\n{new}\n".lstrip()
    if holder.flow_style:
        close = holder.end_mark.index - 1
        before = text[:close].rstrip()
        return before + (", " if holder.value else "") + new + text[close:]
    last = _end(text, holder.value[-1][1])
    end = text.find("\n", last)
    end = len(text) if end < 0 else end
    indent = " " * holder.value[-1][0].start_mark.column
    return f"{text[:end]}\n{indent}{new}{text[end:]}"


def _node(text: str, path: list[Any]) -> Any:
    """The node of ruamel at a path; None for an empty text."""
    from ruamel.yaml import YAML

    parse(text, None)  # the messages of the case reader
    node: Any = YAML(typ="rt", pure=True).compose(StringIO(text))
    for number, step in enumerate(path):
        if isinstance(step, int) and _is(node, "Sequence") and step < len(node.value):
            node = node.value[step]
        elif isinstance(step, str) and _is(node, "Mapping") and any(k.value == step for k, _ in node.value):
            node = next(v for k, v in node.value if k.value == step)
        else:
            raise CaseError(at=str(path[number]), want="a key path inside the case")
    return node


def _is(node: Any, kind: str) -> bool:
    return type(node).__name__ == f"{kind}Node"


def _end(text: str, node: Any) -> int:
    """Where the letters of a node end: the mark of a block stands at the next key."""
    start, end = node.start_mark.index, node.end_mark.index
    if _is(node, "Scalar") or node.flow_style or not node.value:
        return start + len(text[start:end].rstrip())
    last = node.value[-1]
    return _end(text, last[1] if isinstance(last, tuple) else last)


def _refuse_unreadable(text: str, at: str, value: str) -> None:
    """Raise CaseError if a new value has made the text unreadable."""
    try:
        parse(text, None)
    except CaseError as error:
        raise CaseError(
            at=at, got=value, want="a value of YAML, such as 8 in, true or [1, 2]", hint=error.want
        ) from None
