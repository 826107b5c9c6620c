"""Key paths such as `string[3].od`, and the errors that validators of blocks raise."""

from __future__ import annotations

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


MAX_LEVELS = 40  # of blocks in blocks
MAX_VALUES = 300_000  # keys and list entries of a case
TOO_DEEP = "blocks in blocks in blocks"


def check_plain(value: Any, at: Path = ()) -> None:
    """Raise CaseError for data that cannot be shown or written: too deep, lone surrogates, endless
    numbers."""
    if len(at) > MAX_LEVELS:
        raise CaseError(at=written(at[:3]), got=TOO_DEEP, want=f"at most {MAX_LEVELS} levels")
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
    """`did you mean ...?` with the most similar known word, or an empty text."""
    if not isinstance(word, str) or len(word) > 100:
        return ""
    matches = difflib.get_close_matches(word, list(known), 1, 0.6)
    return f"did you mean '{matches[0]}'?" if matches else ""


def refuse(*at: str | int, got: object = None, want: str, hint: str = "") -> PydanticCustomError:
    """The error to raise in a validator.

    at: key path below the block of the validator
    got: value as given
    want: what is allowed
    hint: a likely cause or cure
    """
    return PydanticCustomError("case", "wrong value", {"at": at, "got": got, "want": want, "hint": hint})


def unsupported(*at: str | int, got: object = None, what: str) -> PydanticCustomError:
    """The error for a key of the case format that this version does not support."""
    return refuse(*at, got=got, want=f"{what} is not available in this version", hint="leave the key out")
