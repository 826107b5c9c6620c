"""Key paths such as `string[3].od`, and the one way in which a model refuses a value."""

from __future__ import annotations

import copy
import difflib
import re
from collections.abc import Iterable, Mapping
from typing import Any

from pydantic_core import PydanticCustomError

from drillpetsc.errors import CaseError

Path = tuple[str | int, ...]

_STEP = re.compile(r"\.?([^.\[\]]+)|\[(\d+)\]")


def written(path: Path) -> str:
    """("string", 3, "od") -> `string[3].od`."""
    text = ""
    for step in path:
        if isinstance(step, int):
            text += f"[{step}]"
        else:
            text += f".{step}" if text else step
    return text


def parsed(text: str) -> Path:
    """`string[3].od` -> ("string", 3, "od")."""
    steps: list[str | int] = []
    position = 0
    while position < len(text):
        match = _STEP.match(text, position)
        if not match:
            raise CaseError(at=text, want="a key path such as top.rotation or string[1].od")
        steps.append(match.group(1) if match.group(1) is not None else int(match.group(2)))
        position = match.end()
    return tuple(steps)


MOST_LEVELS = 40  # of blocks in blocks
TOO_DEEP = "blocks in blocks in blocks"


def check_plain(value: Any, at: Path = ()) -> None:
    """Refuses, with a CaseError, data that nobody could show or write: endlessly deep, half letters
    (surrogates), endless numbers."""
    if len(at) > MOST_LEVELS:
        raise CaseError(at=written(at[:3]), got=TOO_DEEP, want=f"at most {MOST_LEVELS} levels")
    if isinstance(value, str):
        try:
            value.encode("utf-8")
        except UnicodeEncodeError:
            raise CaseError(at=written(at), got=value, want="letters of Unicode") from None
    elif isinstance(value, int) and value.bit_length() > 1024:
        raise CaseError(at=written(at), got="a larger one", want="a number of at most 308 digits")
    elif isinstance(value, Mapping):
        for key, part in value.items():
            check_plain(key, at)
            check_plain(part, (*at, key))
    elif isinstance(value, (list, tuple)):
        for i, part in enumerate(value):
            check_plain(part, (*at, i))


def suggestion(word: object, known: Iterable[str]) -> str:
    """`did you mean ...?`, or nothing."""
    if not isinstance(word, str) or len(word) > 100:
        return ""
    matches = difflib.get_close_matches(word, list(known), 1, 0.6)
    return f"did you mean '{matches[0]}'?" if matches else ""


def refuse(*at: str | int, got: object = None, want: str, hint: str = "") -> PydanticCustomError:
    """The error to raise in a validator; `at` is the path below the model whose validator it is."""
    return PydanticCustomError("case", "wrong value", {"at": at, "got": got, "want": want, "hint": hint})


def unsupported(*at: str | int, got: object = None, what: str) -> PydanticCustomError:
    """The error for a key of the case format that this version cannot honour."""
    return refuse(*at, got=got, want=f"{what} is not available in this version", hint="leave the key out")


def override(data: Mapping[str, Any], change: str) -> dict[str, Any]:
    """A copy of case data with one value replaced: `override(data, "string[1].od=8 in")`.

    The value is read as YAML, so `contact=none`, `top={kind: clamped}` and `output.probes=[1 m, 2 m]` work
    too.
    """
    from drillpetsc.case.reader import read_value

    key, separator, value = change.partition("=")
    if not separator or not key.strip():
        raise CaseError(got=change, want="KEY=VALUE, such as top.rotation=90 rpm")
    result = copy.deepcopy(dict(data))
    *parents, last = parsed(key.strip())
    target: Any = result
    for step in parents:
        if isinstance(step, str) and isinstance(target, dict):
            target = target.setdefault(step, {})
        elif isinstance(step, int) and isinstance(target, list) and step < len(target):
            target = target[step]
        else:
            raise CaseError(at=key.strip(), want="a place that the case has")
    if isinstance(last, int):
        if not isinstance(target, list) or last >= len(target):
            raise CaseError(at=key.strip(), want="a place that the case has")
        target[last] = read_value(value)
    elif isinstance(target, dict):
        target[last] = read_value(value)
    else:
        raise CaseError(at=key.strip(), want="a place that the case has")
    return result
