"""YAML 1.2 text as plain data: dicts, lists and scalars, with the line of each key.

The reader never hangs, and nothing is read by the rules of YAML 1.1.
"""

from __future__ import annotations

import re
import warnings
from io import StringIO
from pathlib import Path as FilePath
from typing import Any

from drillpetsc.case.files import plain_yaml
from drillpetsc.case.key_paths import MAX_LEVELS, MAX_VALUES, TOO_DEEP, Path, written
from drillpetsc.errors import CaseError, shown

Lines = dict[Path, int]
"""Line (from 1) of each key and list entry, by path."""


def read_value(text: str) -> Any:
    """One YAML value, as on a command line."""
    try:
        return plain_yaml.read_scalar(text)
    except plain_yaml.OtherYaml:
        return plain(parse(text, None), (), {}, None)


def read_mapping(text: str, path: FilePath) -> tuple[dict[str, Any], Lines]:
    """Plain data of the text of a file, which is one mapping, and their lines; CaseError for other texts.

    path: the file, for messages
    """
    try:
        return plain_yaml.read(text)
    except plain_yaml.OtherYaml:
        pass
    tree = parse(text, path)
    want = "a mapping of keys: string, top, well, ..."
    if tree is None:
        raise CaseError(file=path, line=1, got="an empty file", want=want)
    if not isinstance(tree, dict):
        raise CaseError(file=path, line=1, got="a list" if isinstance(tree, list) else tree, want=want)
    lines: Lines = {}
    return plain(tree, (), lines, path), lines


def parse(text: str, path: FilePath | None) -> Any:
    """Text as mappings and lists of ruamel, which hold line numbers; CaseError for text that is not YAML 1.2.

    path: file of the text, for messages
    """
    from ruamel.yaml.constructor import DuplicateKeyError
    from ruamel.yaml.error import MarkedYAMLError
    from ruamel.yaml.reader import ReaderError

    _refuse_other_versions(text, path)
    yaml, read = _loader(path)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # an anchor that is defined twice
            return yaml.load(StringIO(text))
    except CaseError:
        raise
    except DuplicateKeyError as error:
        line = error.problem_mark.line + 1
        key = str(error.problem).split('"')[1] if '"' in str(error.problem) else ""
        raise CaseError(at=key, got="a key given twice", want="each key once", file=path, line=line) from None
    except MarkedYAMLError as error:
        raise _unreadable(error, text, path) from None
    except RecursionError:
        raise too_deep((), path, read[0]) from None
    except Exception as error:  # control characters, and errors inside ruamel
        line = text.count("\n", 0, error.position) + 1 if isinstance(error, ReaderError) else read[0]
        hint = " ".join(str(error).split())[:200]
        raise CaseError(
            file=path, line=line, got="text that is not YAML", want="YAML 1.2", hint=hint
        ) from None


def plain(node: Any, at: Path, lines: Lines, file: FilePath | None) -> Any:
    """The tree of ruamel as dicts, lists and scalars.

    Stores the line of each key and entry in `lines`. Refuses tags, empty values and other types.
    """
    if len(at) > MAX_LEVELS:
        raise too_deep(at[:3], file, line_of(at, lines))
    if len(lines) > MAX_VALUES:
        want = f"at most {MAX_VALUES} values, those behind aliases counted each time"
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
        return [plain(part, (*at, i), lines, file) for i, part in enumerate(node)]
    if (
        isinstance(node, bool) or type(node).__name__ == "ScalarBoolean"
    ):  # the latter is a truth value with an anchor, not a bool of Python
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


def _plain_mapping(node: Any, at: Path, lines: Lines, file: FilePath | None) -> dict[str, Any]:
    mapping: dict[str, Any] = {}
    for key in node:
        line = _line(node, key) or line_of(at, lines)
        if at and at[-1] == "dial" and isinstance(key, (int, float)) and not isinstance(key, bool):
            path = (*at, str(key))  # speeds of a viscometer
            lines[path] = line
            mapping[str(key)] = plain(node[key], path, lines, file)
            continue
        if not isinstance(key, str):
            raise CaseError(at=written(at), got=shown(key), want="a word as key", file=file, line=line)
        path = (*at, str(key))
        lines[path] = line
        mapping[str(key)] = plain(node[key], path, lines, file)
    return mapping


def _line(node: Any, key: Any) -> int | None:
    """Line of a key or entry of a mapping or list of ruamel; None for merged keys."""
    position = (node.lc.data or {}).get(key) if hasattr(node, "lc") else None
    return position[0] + 1 if position else None


def line_of(path: Path, lines: Lines) -> int:
    """Line of a path, or of the nearest block above it."""
    while path and path not in lines:
        path = path[:-1]
    return lines.get(path, 1)


def too_deep(at: Path, file: FilePath | None, line: int) -> CaseError:
    return CaseError(at=written(at), got=TOO_DEEP, want=f"at most {MAX_LEVELS} levels", file=file, line=line)


def _refuse_other_versions(text: str, path: FilePath | None) -> None:
    """Refuse a %YAML directive of another version. In YAML 1.1 `yes` is true, 010 is 8 and 12:30 is 750."""
    directive = re.search(r"^%YAML(?![ \t]+1\.2[ \t\r]*$).*", text, re.MULTILINE)
    if directive:
        line = text.count("\n", 0, directive.start()) + 1
        raise CaseError(got=directive.group(), want="YAML 1.2", file=path, line=line)


def _loader(path: FilePath | None) -> tuple[Any, list[int]]:
    """(reader of texts, [line reached]).

    The reader stops at MAX_LEVELS nested brackets, for which ruamel would need seconds. It refuses lists and
    mappings as keys: nested in each other, they would take centuries.
    """
    from ruamel.yaml import YAML
    from ruamel.yaml.constructor import RoundTripConstructor
    from ruamel.yaml.scanner import RoundTripScanner

    read = [1]

    class Scanner(RoundTripScanner):
        def fetch_more_tokens(self) -> Any:
            read[0] = self.reader.line + 1
            if self.flow_level > MAX_LEVELS:
                raise RecursionError
            return super().fetch_more_tokens()

    class Constructor(RoundTripConstructor):
        def construct_document(self, node: Any) -> Any:
            _check_keys(node, path)
            return super().construct_document(node)

    yaml = YAML(typ="rt", pure=True)
    yaml.allow_duplicate_keys = False
    yaml.Scanner, yaml.Constructor = Scanner, Constructor
    return yaml, read


def _check_keys(node: Any, path: FilePath | None) -> None:
    """Refuse keys that are lists or mappings."""
    from ruamel.yaml.nodes import MappingNode, ScalarNode, SequenceNode

    seen, waiting = {id(node)}, [node]
    while waiting:
        node = waiting.pop()
        parts = node.value if isinstance(node, SequenceNode) else []
        if isinstance(node, MappingNode):
            for key, _ in node.value:
                if not isinstance(key, ScalarNode):
                    line = key.start_mark.line + 1
                    raise CaseError(got="a list or mapping", want="a word as key", file=path, line=line)
            parts = [value for _, value in node.value]
        for part in parts:
            if id(part) not in seen:
                seen.add(id(part))
                waiting.append(part)


def _unreadable(error: Any, text: str, path: FilePath | None) -> CaseError:
    """A YAML error as a CaseError with its line."""
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
    return CaseError(
        got=row.strip() or "the end of the file", want="YAML 1.2", hint=problem, file=path, line=line
    )
