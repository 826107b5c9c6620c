"""A file is either the old one or the new one, never half of it."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path


def replace_file(path: str | os.PathLike, write: Callable[[Path], object]) -> Path:
    """Let `write` make a file beside `path`, then rename it over `path` in one step.

    A reader (ParaView while the run goes on) or a kill at any moment meets a whole file. The temporary name keeps
    the suffix, because some writers choose the format by it, and starts with a dot, so that no pattern like
    string/*.vtu finds it.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{os.getpid()}-{path.name}")
    try:
        write(temporary)
        os.replace(temporary, path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise
    return path


def replace_text(path: str | os.PathLike, text: str) -> Path:
    """Write `text` to `path` (UTF-8), whole or not at all."""
    return replace_file(path, lambda temporary: temporary.write_text(text, encoding="utf-8"))
