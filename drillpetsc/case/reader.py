"""YAML 1.2 with line numbers -> Case."""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from io import StringIO
from pathlib import Path as FilePath
from typing import Any

from drillpetsc.case.keys import Path, override, parsed, written
from drillpetsc.case.scene import Case
from drillpetsc.case.survey_file import FOLDER
from drillpetsc.errors import CaseError

Lines = dict[Path, int]
"""Line (from 1) of each key and list entry, by path."""


def load_case(path: str | FilePath, changes: tuple[str, ...] | list[str] = ()) -> Case:
    """The case in a YAML file; `changes` are `key=value` texts that replace its values (`top.rotation=90 rpm`)."""
    path = FilePath(path)
    data, lines = read_case_file(path)
    for change in changes:
        data = override(data, change)
    return case_from_data(data, path, lines)


def case_from_data(data: Mapping[str, Any], path: FilePath, lines: Lines) -> Case:
    """A case from data as read from the file `path`; errors carry its name and the line."""
    token = FOLDER.set(path.parent)
    try:
        return Case(**data)
    except CaseError as error:
        for each in (error, *error.also):
            if each.file is None:
                each.file = str(path)
                each.line = line_of(parsed(each.at), lines)
        raise
    finally:
        FOLDER.reset(token)


def line_of(path: Path, lines: Lines) -> int:
    """Line of a path, or of the nearest block above it."""
    while path and path not in lines:
        path = path[:-1]
    return lines.get(path, 1)


def read_case_file(path: str | FilePath) -> tuple[dict[str, Any], Lines]:
    """Plain data and line numbers of a case file."""
    path = FilePath(path)
    try:
        text = path.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError:
        raise CaseError(file=path, want="a text file in UTF-8") from None
    except OSError:
        near = difflib.get_close_matches(path.name, [other.name for other in path.parent.glob("*.y*ml")], 1)
        hint = f"did you mean {path.parent / near[0]}?" if near else ""
        raise CaseError(got=path, want="a case file that exists and can be read", hint=hint) from None
    tree = _parse(text, path)
    if tree is None:
        raise CaseError(file=path, line=1, got="an empty file", want="a mapping of keys: string, top, well, ...")
    if not isinstance(tree, dict):
        got = "a list" if isinstance(tree, list) else tree
        raise CaseError(file=path, line=1, got=got, want="a mapping of keys: string, top, well, ...")
    lines: Lines = {}
    return _plain(tree, (), lines, path), lines


def read_value(text: str) -> Any:
    """One YAML value, as on a command line."""
    value = _parse(text, None)
    return _plain(value, (), {}, None)


def _parse(text: str, path: FilePath | None) -> Any:
    from ruamel.yaml import YAML
    from ruamel.yaml.constructor import DuplicateKeyError
    from ruamel.yaml.error import MarkedYAMLError, YAMLError

    yaml = YAML(typ="rt", pure=True)
    yaml.allow_duplicate_keys = False
    try:
        return yaml.load(StringIO(text))
    except DuplicateKeyError as error:
        line = error.problem_mark.line + 1
        key = str(error.problem).split('"')[1] if '"' in str(error.problem) else ""
        raise CaseError(at=key, got="a key that stands twice", want="each key once", file=path, line=line) from None
    except MarkedYAMLError as error:
        raise _unreadable(error, text, path) from None
    except (YAMLError, ValueError, RecursionError) as error:  # ReaderError: control characters
        what = " ".join(str(error).split())
        raise CaseError(file=path, got="text that is not YAML", want="YAML 1.2", hint=what[:200]) from None


def _unreadable(error: Any, text: str, path: FilePath | None) -> CaseError:
    """A YAML error in the words of its place."""
    mark = error.problem_mark or error.context_mark
    line = mark.line + 1 if mark else 1
    rows = text.splitlines()
    row = rows[line - 1] if line <= len(rows) else ""
    indent = row[: len(row) - len(row.lstrip())]
    if "\t" in indent or "\\t" in str(error.problem) or "tab" in str(error.problem).lower():
        return CaseError(got="a tab", want="spaces for indentation", file=path, line=line)
    if "single document" in str(error):
        return CaseError(got="several documents (---)", want="one case in a file", file=path, line=line)
    problem = " ".join(str(error.problem or error.context or "").split())
    return CaseError(got=row.strip() or "the end of the file", want="YAML 1.2", hint=problem, file=path, line=line)


def _plain(node: Any, at: Path, lines: Lines, file: FilePath | None) -> Any:
    """ruamel's tree as dicts, lists and scalars; notes lines; refuses what no case can hold."""
    if isinstance(node, dict):
        return _plain_mapping(node, at, lines, file)
    if isinstance(node, list):
        for i in range(len(node)):
            lines[(*at, i)] = _line(node, i) or line_of(at, lines)
        return [_plain(part, (*at, i), lines, file) for i, part in enumerate(node)]
    if isinstance(node, bool):
        return node
    for kind in (int, float, str):
        if isinstance(node, kind):
            return kind(node)
    if node is None and not (at and at[0] == "petsc"):
        hint = "the block is empty" if len(at) == 1 else ""
        raise CaseError(at=written(at), got="nothing", want="a value", hint=hint, file=file, line=line_of(at, lines))
    if node is not None:
        want = "a number, text, list or mapping"
        raise CaseError(at=written(at), got=node, want=want, file=file, line=line_of(at, lines))
    return None


def _line(node: Any, key: Any) -> int | None:
    """Line of a key or entry of one of ruamel's mappings or lists, where it has one (merged keys have none)."""
    position = (node.lc.data or {}).get(key) if hasattr(node, "lc") else None
    return position[0] + 1 if position else None


def _plain_mapping(node: Any, at: Path, lines: Lines, file: FilePath | None) -> dict[str, Any]:
    plain: dict[str, Any] = {}
    for key in node:
        line = _line(node, key) or line_of(at, lines)
        if not isinstance(key, str):
            raise CaseError(at=written(at), got=key, want="a word as key", file=file, line=line)
        path = (*at, str(key))
        lines[path] = line
        plain[str(key)] = _plain(node[key], path, lines, file)
    return plain
