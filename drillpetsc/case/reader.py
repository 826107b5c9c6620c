"""YAML 1.2 with line numbers -> Case."""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from pathlib import Path as FilePath
from typing import Any

from drillpetsc.case.case import Case
from drillpetsc.case.key_paths import MOST_LEVELS, Path, override, written
from drillpetsc.case.survey_file import FOLDER
from drillpetsc.case.yaml_text import parse, too_deep
from drillpetsc.errors import CaseError, shown

Lines = dict[Path, int]
"""Line (from 1) of each key and list entry, by path."""

MOST_BYTES = 50_000_000  # of a case file
MOST_VALUES = 300_000  # keys and list entries of a case


def load_case(path: str | FilePath, changes: tuple[str, ...] | list[str] = ()) -> Case:
    """The case in a YAML file; `changes` are `key=value` texts that replace its values (`top.rotation=90
    rpm`)."""
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
                each.line = _line_of_text(each.at, lines)
        raise
    finally:
        FOLDER.reset(token)


def _line_of_text(at: str, lines: Lines) -> int:
    """The same of a path as text; keys of a wrong case may hold dots and brackets, so it is not taken
    apart."""
    known = {written(path): line for path, line in lines.items()}
    while at and at not in known:
        at = at[: max(at.rfind("."), at.rfind("["), 0)]
    return known.get(at, 1)


def line_of(path: Path, lines: Lines) -> int:
    """Line of a path, or of the nearest block above it."""
    while path and path not in lines:
        path = path[:-1]
    return lines.get(path, 1)


def read_case_file(path: str | FilePath) -> tuple[dict[str, Any], Lines]:
    """Plain data and line numbers of a case file."""
    path = FilePath(path)
    try:
        with path.open("rb") as file:
            raw = file.read(MOST_BYTES + 1)  # a device may never end
        if len(raw) > MOST_BYTES:
            raise CaseError(
                file=path, line=1, got="a larger one", want=f"a file of at most {MOST_BYTES // 10**6} MB"
            )
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise CaseError(file=path, want="a text file in UTF-8") from None
    except OSError:
        suggestion = difflib.get_close_matches(
            path.name, [other.name for other in path.parent.glob("*.y*ml")], 1
        )
        hint = f"did you mean {path.parent / suggestion[0]}?" if suggestion else ""
        raise CaseError(got=path, want="a case file that exists and can be read", hint=hint) from None
    tree = parse(text, path)
    if tree is None:
        raise CaseError(
            file=path, line=1, got="an empty file", want="a mapping of keys: string, top, well, ..."
        )
    if not isinstance(tree, dict):
        got = "a list" if isinstance(tree, list) else tree
        raise CaseError(file=path, line=1, got=got, want="a mapping of keys: string, top, well, ...")
    lines: Lines = {}
    return _plain(tree, (), lines, path), lines


def read_value(text: str) -> Any:
    """One YAML value, as on a command line."""
    value = parse(text, None)
    return _plain(value, (), {}, None)


def _plain(node: Any, at: Path, lines: Lines, file: FilePath | None) -> Any:
    """ruamel's tree as dicts, lists and scalars; notes lines; refuses what no case can hold."""
    if len(at) > MOST_LEVELS:
        raise too_deep(at[:3], file, line_of(at, lines))
    if len(lines) > MOST_VALUES:
        want = f"at most {MOST_VALUES} values, those behind aliases counted each time"
        raise CaseError(
            at=written(at[:1]), got="more values", want=want, file=file, line=line_of(at[:1], lines)
        )
    if getattr(getattr(node, "tag", None), "value", None) is not None:
        raise CaseError(
            at=written(at), got=node.tag.value, want="no YAML tag (!)", file=file, line=line_of(at, lines)
        )
    if isinstance(node, dict):
        return _plain_mapping(node, at, lines, file)
    if isinstance(node, list):
        for i in range(len(node)):
            lines[(*at, i)] = _line(node, i) or line_of(at, lines)
        return [_plain(part, (*at, i), lines, file) for i, part in enumerate(node)]
    if (
        isinstance(node, bool) or type(node).__name__ == "ScalarBoolean"
    ):  # the latter has an anchor, and is no bool for Python
        return bool(node)
    for kind in (int, float, str):
        if isinstance(node, kind):
            return kind(node)
    if node is None and not (at and at[0] == "petsc"):
        hint = "the block is empty" if len(at) == 1 else ""
        raise CaseError(
            at=written(at), got="nothing", want="a value", hint=hint, file=file, line=line_of(at, lines)
        )
    if node is not None:
        want = "a number, text, list or mapping"
        raise CaseError(at=written(at), got=node, want=want, file=file, line=line_of(at, lines))
    return None


def _line(node: Any, key: Any) -> int | None:
    """Line of a key or entry of one of ruamel's mappings or lists, where it has one (merged keys have
    none)."""
    position = (node.lc.data or {}).get(key) if hasattr(node, "lc") else None
    return position[0] + 1 if position else None


def _plain_mapping(node: Any, at: Path, lines: Lines, file: FilePath | None) -> dict[str, Any]:
    plain: dict[str, Any] = {}
    for key in node:
        line = _line(node, key) or line_of(at, lines)
        if not isinstance(key, str):
            raise CaseError(at=written(at), got=shown(key), want="a word as key", file=file, line=line)
        path = (*at, str(key))
        lines[path] = line
        plain[str(key)] = _plain(node[key], path, lines, file)
    return plain
