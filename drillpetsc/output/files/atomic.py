"""A file is either the old one or the new one, never half of it."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from pathlib import Path

from drillpetsc.output.files.lock import check_place

LEFTOVER = re.compile(r"\.\d+-.+")


def replace_file(path: str | os.PathLike, write: Callable[[Path], object], *, lasting: bool = False) -> Path:
    """Let `write` make a file beside `path`, then rename it over `path` in one step.

    A reader (such as ParaView during the run) or a kill at any moment finds a whole file. The temporary name
    keeps the suffix, because some writers choose the format by it. It starts with a dot, so patterns like string/*.vtu
    do not match it. lasting: the new file is on disk before the old one is removed, so a power cut
    leaves one of them.
    """
    path = Path(path)
    held = check_place(path)
    temporary = path.with_name(f".{os.getpid()}-{path.name}")
    try:
        _make_parent(path, held)
        write(temporary)
        if lasting:
            to_disk(temporary)
        os.replace(temporary, path)
        if lasting:
            to_disk(path.parent)
    except BaseException as error:
        temporary.unlink(missing_ok=True)
        if isinstance(error, OSError):  # the folder may have been moved since it was looked for
            check_place(path)
        raise
    return path


def _make_parent(path: Path, held: Path | None) -> None:
    """Make the folder of a file; ``held``, the folder of a run that goes on, is not made again."""
    if held is None:
        path.parent.mkdir(parents=True, exist_ok=True)
        return
    for part in reversed(path.absolute().parents):
        if held in part.parents:
            part.mkdir(exist_ok=True)


def to_disk(path: str | os.PathLike) -> None:
    """Wait until the disk has the file, or the names in the folder."""
    number = os.open(path, os.O_RDONLY)
    try:
        os.fsync(number)
    finally:
        os.close(number)


def remove_leftovers(folder: str | os.PathLike) -> None:
    """Remove the temporary files of `replace_file` that a killed process left in the folder."""
    for file in Path(folder).glob(".*-*"):
        if LEFTOVER.fullmatch(file.name):
            file.unlink(missing_ok=True)


def replace_text(path: str | os.PathLike, text: str) -> Path:
    """Write `text` to `path` (UTF-8), whole or not at all."""
    return replace_file(path, lambda temporary: temporary.write_text(text, encoding="utf-8"))
