"""YAML 1.2 text -> ruamel's tree, or a CaseError: nothing in a text makes it hang, and nothing is read as
YAML 1.1 would."""

from __future__ import annotations

import re
import warnings
from io import StringIO
from pathlib import Path as FilePath
from typing import Any

from drillpetsc.case.key_paths import MOST_LEVELS, TOO_DEEP, Path, written
from drillpetsc.errors import CaseError


def parse(text: str, path: FilePath | None) -> Any:
    """The text as ruamel's mappings and lists, which know their lines; `path` is the file it came from."""
    from ruamel.yaml.constructor import DuplicateKeyError
    from ruamel.yaml.error import MarkedYAMLError
    from ruamel.yaml.reader import ReaderError

    _refuse_other_versions(text, path)
    yaml, read = _loader(path)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # an anchor that stands twice
            return yaml.load(StringIO(text))
    except CaseError:
        raise
    except DuplicateKeyError as error:
        line = error.problem_mark.line + 1
        key = str(error.problem).split('"')[1] if '"' in str(error.problem) else ""
        raise CaseError(
            at=key, got="a key that stands twice", want="each key once", file=path, line=line
        ) from None
    except MarkedYAMLError as error:
        raise _unreadable(error, text, path) from None
    except RecursionError:
        raise too_deep((), path, read[0]) from None
    except Exception as error:  # control characters, and whatever ruamel stumbles over
        line = text.count("\n", 0, error.position) + 1 if isinstance(error, ReaderError) else read[0]
        hint = " ".join(str(error).split())[:200]
        raise CaseError(
            file=path, line=line, got="text that is not YAML", want="YAML 1.2", hint=hint
        ) from None


def too_deep(at: Path, file: FilePath | None, line: int) -> CaseError:
    return CaseError(at=written(at), got=TOO_DEEP, want=f"at most {MOST_LEVELS} levels", file=file, line=line)


def _refuse_other_versions(text: str, path: FilePath | None) -> None:
    """In YAML 1.1 `yes` is true, 010 is 8 and 12:30 is 750."""
    directive = re.search(r"^%YAML(?![ \t]+1\.2[ \t\r]*$).*", text, re.MULTILINE)
    if directive:
        line = text.count("\n", 0, directive.start()) + 1
        raise CaseError(got=directive.group(), want="YAML 1.2", file=path, line=line)


def _loader(path: FilePath | None) -> tuple[Any, list[int]]:
    """A reader of texts, and the line that it has come to.

    It goes no deeper than MOST_LEVELS brackets, for which ruamel would take seconds, and takes words as keys
    alone: lists or mappings as keys, one in another, would take it centuries.
    """
    from ruamel.yaml import YAML
    from ruamel.yaml.constructor import RoundTripConstructor
    from ruamel.yaml.scanner import RoundTripScanner

    read = [1]

    class Scanner(RoundTripScanner):
        def fetch_more_tokens(self) -> Any:
            read[0] = self.reader.line + 1
            if self.flow_level > MOST_LEVELS:
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
    """Refuses keys that are lists or mappings."""
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
    return CaseError(
        got=row.strip() or "the end of the file", want="YAML 1.2", hint=problem, file=path, line=line
    )
