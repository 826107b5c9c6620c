"""Case file -> `Case`, with the file and the line in every error."""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from pathlib import Path as FilePath
from typing import Any

from drillpetsc.case.case import Case
from drillpetsc.case.changes import with_change
from drillpetsc.case.files.named_file import FOLDER, bytes_of
from drillpetsc.case.files.yaml_text import Lines, read_mapping
from drillpetsc.case.key_paths import written
from drillpetsc.errors import CaseError

MAX_BYTES = 50_000_000  # of a case file


def load_case(path: str | FilePath, changes: tuple[str, ...] | list[str] = ()) -> Case:
    """Read a case file.

    path: YAML file
    changes: texts `key=value` that replace values of the file, such as `top.rotation=90 rpm`, or `fluid=off`
    """
    path = FilePath(path)
    data, lines = read_case_file(path)
    for change in changes:
        data = with_change(data, change)
    try:
        return case_from_data(data, path, lines)
    except CaseError as error:
        keys = tuple(change.partition("=")[0].strip() for change in changes)
        for each in (error, *error.also):
            if keys and each.at.startswith(keys):  # no line of the file has this value
                each.file, each.line = None, None
        raise


def data_of_case(case: Case | str | FilePath) -> tuple[FilePath, dict[str, Any], Lines | None]:
    """The name of a case, its plain data and their line numbers: of a file, or of a case built in Python.

    The name of such a case is `case` in the folder that its file names start from, and it has no lines.
    """
    if isinstance(case, Case):
        keys, folder = case.given_keys
        return folder / "case", dict(keys), None
    return FilePath(case), *read_case_file(case)


def case_from_data(data: Mapping[str, Any], path: FilePath, lines: Lines | None) -> Case:
    """A case from the data of a file. Errors carry the name of the file and the line.

    data, lines: what `read_case_file` returns, the data changed or not; lines None: of no file
    path: the file
    """
    token = FOLDER.set(path.parent)
    try:
        return Case(**data)
    except CaseError as error:
        for each in (error, *error.also):
            if each.file is None and lines is not None:
                each.file = str(path)
                each.line = _line_of_text(each.at, lines)
        raise
    finally:
        FOLDER.reset(token)


def _line_of_text(at: str, lines: Lines) -> int:
    """Line of a path as text, or of the nearest block above it.

    The text is compared as a whole, because unknown keys may hold dots and brackets.
    """
    known = {written(path): line for path, line in lines.items()}
    while at and at not in known:
        at = at[: max(at.rfind("."), at.rfind("["), 0)]
    return known.get(at, 1)


def read_case_file(path: str | FilePath) -> tuple[dict[str, Any], Lines]:
    """Plain data and line numbers of a case file."""
    path = FilePath(path)
    try:
        text = bytes_of(path, MAX_BYTES).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise CaseError(file=path, want="a text file in UTF-8") from None
    except OSError:
        suggestion = difflib.get_close_matches(
            path.name, [other.name for other in path.parent.glob("*.y*ml")], 1
        )
        hint = f"did you mean {path.parent / suggestion[0]}?" if suggestion else ""
        raise CaseError(got=path, want="a case file that exists and can be read", hint=hint) from None
    return read_mapping(text, path)
