"""Files that a case names: where they are, and what is in them, up to a size."""

from __future__ import annotations

import csv
import os
import re
from collections.abc import Callable
from contextvars import ContextVar
from pathlib import Path

from drillpetsc.case.key_paths import refuse, suggestion
from drillpetsc.errors import CaseError

FOLDER: ContextVar[Path] = ContextVar("FOLDER", default=Path())
"""Base of relative file names in a case: the folder of the case file, else the working directory."""

SHEETS = (".xlsx", ".xlsm")


def find_file(name: str | Path, exists: Callable[[Path], bool] = os.path.isfile) -> Path | None:
    """The file of this name beside the case file, else in the working directory; None without one.

    exists: of os.path, for a folder; Path.is_file raises for a name longer than any file's.
    """
    places = (FOLDER.get() / name, Path(name))
    return next((path for path in places if str(name).strip() and exists(path)), None)


def named_file(name: str, want: str) -> tuple[Path, str]:
    """(file, sheet or "") of a name such as `well.csv` or `well.xlsx#Sheet2`; otherwise the key's error, with ``want``."""
    book, mark, sheet = name.partition("#")
    if (path := find_file(name)) is not None:
        return path, ""
    if mark and book.casefold().endswith(SHEETS) and (path := find_file(book)) is not None:
        return path, sheet
    folder = FOLDER.get()
    hint = suggestion(name, [other.name for other in folder.glob("*.csv")])
    hint = hint or f"looked in {'' if str(folder) == '.' else f'{folder} and '}the working directory"
    raise refuse(got=name, want=want, hint=hint)


def bytes_of(file: Path, most: int) -> bytes:
    """The bytes of a file; CaseError for more than ``most`` of them, as of a device, which may never end."""
    with file.open("rb") as opened:
        raw = opened.read(most + 1)
    if len(raw) > most:
        raise CaseError(got="a larger one", want=f"a file of at most {most // 10**6} MB", file=file, line=1)
    return raw


def text_of(file: Path, most: int) -> tuple[str, bool]:
    """(text of a file, whether it is Unicode); other bytes are read as Windows-1252.  CaseError for bytes that are no text."""
    raw = bytes_of(file, most)
    wide = raw[:2] in (b"\xff\xfe", b"\xfe\xff")
    if b"\0" in raw and not wide:
        raise CaseError(file=file, want="a text file in UTF-8")
    try:
        return raw.decode("utf-16" if wide else "utf-8-sig"), True
    except UnicodeDecodeError:
        if wide:
            raise CaseError(file=file, want="a text file in UTF-8") from None
        return raw.decode("cp1252", "replace"), False


def lines_of(text: str) -> list[str]:
    """The lines of a text, whatever ends them."""
    return re.split(r"\r\n|\r|\n", text)


def is_comment(line: str) -> bool:
    """Whether a line of a table begins as comments do: with `#`, `//` or `!`."""
    return line.lstrip("\ufeff \t").startswith(("#", "//", "!"))


def cells_of(line: str, mark: str, file: Path, number: int) -> list[str]:
    """The cells of a line of a table, with ``mark`` between them; a blank stands for any number of them.

    number: of the line in the file.  CaseError for a cell of more than 131072 letters.
    """
    if mark == " ":
        return line.split()
    try:
        return [cell.strip() for cell in next(csv.reader([line], delimiter=mark, skipinitialspace=True), [])]
    except csv.Error as error:
        want, hint = "cells of a table", str(error)
        raise CaseError(got=line[:60], want=want, hint=hint, file=file, line=number) from None
