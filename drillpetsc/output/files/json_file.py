"""summary.json: plain JSON that any reader takes, written whole or not at all."""

from __future__ import annotations

import dataclasses
import json
import math
import os
from collections.abc import Mapping
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.errors import CaseError
from drillpetsc.output.files.atomic import replace_text


def plain(value: Any) -> Any:
    """The value in JSON types.

    numpy scalars and arrays become numbers and lists, NaN and infinity (which JSON does not have) null,
    complex numbers [real, imaginary], dataclasses and mappings objects, paths and anything unknown text: a
    summary must never fail a finished run.
    """
    if value is None or isinstance(value, str | bool):
        return value
    if isinstance(value, Enum):
        return plain(value.value)
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, int):
        return int(value)
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, complex):
        return [plain(value.real), plain(value.imag)]
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {field.name: plain(getattr(value, field.name)) for field in dataclasses.fields(value)}
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple | set | frozenset):
        return [plain(item) for item in value]
    return str(value)


def write_summary(path: str | os.PathLike, summary: Mapping[str, object]) -> Path:
    """Write the summary, in the order of its keys."""
    return replace_text(
        path, json.dumps(plain(summary), indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    )


def read_summary(path: str | os.PathLike) -> dict:
    """The summary in a file; raises CaseError if it is damaged."""
    try:
        found = json.loads(Path(path).read_text(encoding="utf-8"))
    except ValueError as error:  # no JSON, or no text
        raise CaseError(
            file=Path(path),
            got=f"no JSON: {error}",
            want="the summary that a command has written",
            hint="compute the run again",
        ) from None
    if not isinstance(found, dict):
        raise CaseError(file=Path(path), got="no JSON object", want="the summary that a command has written")
    return found
