"""Functions of the user: what they take, and where they failed (manual: sec-own-physics)."""

from __future__ import annotations

import inspect
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

MEMORY = "memory"  # parameter of a function that keeps numbers from step to step


def parameters_of(call: Callable[..., Any]) -> tuple[inspect.Parameter, ...]:
    """The parameters of a function; a compiled function may tell none."""
    try:
        return tuple(inspect.signature(call).parameters.values())
    except (TypeError, ValueError):
        return ()


def file_of(call: Callable[..., Any]) -> Path | None:
    """The file with the source of a function; None if it is compiled."""
    try:
        return Path(inspect.getsourcefile(call if hasattr(call, "__code__") else type(call)) or "").resolve()
    except TypeError:
        return None


def place_of(error: BaseException, call: Callable[..., Any]) -> str:
    """``law.py, line 12`` where the user's function raised an error; empty if its code was not reached."""
    own = file_of(call)
    lines = [
        at for at in traceback.extract_tb(error.__traceback__) if own is not None and Path(at.filename) == own
    ]
    return f"{lines[-1].filename}, line {lines[-1].lineno}" if lines else ""
