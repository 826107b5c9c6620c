"""The YAML in which nearly all cases are written, read and written line by line; all else is left to ruamel.

It takes block mappings and lists, `[...]` and `{...}` also over several lines, comments, numbers, words and texts
in quotes.  A text with anything else, or with a mistake, is not read: `yaml_text` then reads it by all rules
of YAML 1.2, and finds the words for the mistake.  ruamel takes forty times as long, and 36 ms to be imported.
"""

from __future__ import annotations

import math
import re
from functools import lru_cache
from typing import Any

from drillpetsc.case.key_paths import MAX_LEVELS, MAX_VALUES, Path

MAX_WIDTH = 4096  # of a line that is written

_OTHER_LETTERS = re.compile(
    "[^\n -~\xa0-\u1fff]"
)  # tabs, and letters that YAML takes for ends of lines, or refuses
_KEY = re.compile(r"([A-Za-z_][\w-]{0,99}|[1-9][0-9]{0,3}):(?: +|$)", re.ASCII)
#: a text in quotes without escapes, or a plain one, each with the rest of its line
_SCALAR = re.compile(r"""(?:"([^"\\]*)"|'([^']*)'|((?:[\w(/]|[-+.][0-9])[^:#"']*?)) *(?:(?<= )\#.*)?$""")
#: plain texts as they are written, in blocks and in brackets: letters of ASCII without :#"' and without ,[]{}
_PLAIN = re.compile(r"[A-Za-z0-9(/](?:[ !$-&(-9;-~]*[!$-&(-9;-~])?")
_PLAIN_IN_BRACKETS = re.compile(r"[A-Za-z0-9(/](?:[ !$-&(-+\--9;-Z\\^-z|~]*[!$-&(-+\--9;-Z\\^-z|~])?")
_BLANK = re.compile(r"[ \n]*(?:(?<=[ \n])\#[^\n]*[ \n]*)*")
_FLOW_KEY = re.compile(r"([A-Za-z_][\w-]{0,99}|[1-9][0-9]{0,3}):(?=[ \n])", re.ASCII)
_FLOW_SCALAR = re.compile(
    r"""(?:"([^"\\\n]*)"|'([^'\n]*)'|((?:[\w(/]|[-+.][0-9])[^:#"'\[\]{},\n]*?)) *(?=[\],}\n])"""
)
_WHOLE = re.compile("-?(?:0|[1-9][0-9]{0,15})")
_DECIMAL = re.compile(r"-?(?:0|[1-9][0-9]{0,30})(?:\.[0-9]{1,30})?(?:[eE][-+]?[0-9]{1,3})?")
_NUMBER_AND_UNIT = re.compile(r"-?[0-9]+(?:\.[0-9]+)?(?![eExob])[A-Za-z%].*")
_TRUTH = {word: word.lower() == "true" for word in ("true", "True", "TRUE", "false", "False", "FALSE")}
_NOTHING = ("null", "Null", "NULL")


class OtherYaml(Exception):
    """The text is not of this kind."""


def read(text: str) -> tuple[dict[str, Any], dict[Path, int]]:
    """Data and lines of a mapping, as `yaml_text.parse` and `plain` have them; raises OtherYaml for texts of another kind."""
    if _OTHER_LETTERS.search(text):
        raise OtherYaml
    reader = _Reader(text)
    data = reader.block(reader.indent, ())
    if reader.content or not isinstance(data, dict):
        raise OtherYaml
    return data, reader.lines


def read_scalar(text: str) -> Any:
    """A number, truth value or text on one line; raises OtherYaml for all else."""
    found = _SCALAR.match(text.strip(" "))
    if not found or _OTHER_LETTERS.search(text) or "\n" in text:
        raise OtherYaml
    return _value(found)


def _value(found: re.Match) -> Any:
    """What the scalar found stands for."""
    double, single, text = found.groups()
    return _meaning(text) if text is not None else single if double is None else double


def _meaning(text: str) -> Any:
    """What a plain text stands for by the rules of YAML 1.2."""
    if text[0].isalpha():
        if text in _NOTHING:
            raise OtherYaml
        return _TRUTH.get(text, text)
    if " " in text or text[0] in "(/" or _NUMBER_AND_UNIT.fullmatch(text):
        return text
    if _WHOLE.fullmatch(text):
        return int(text)
    if _DECIMAL.fullmatch(text):
        return float(text)
    raise OtherYaml


def _key(found: re.Match | None, at: Path, mapping: dict[str, Any]) -> str:
    """The key found, of the mapping at a path, which does not have it yet."""
    if found is None or (key := found.group(1)) in mapping or key in _TRUTH or key in _NOTHING:
        raise OtherYaml
    if key[0].isdigit() and at[-1:] != ("dial",):  # speeds of a viscometer
        raise OtherYaml
    return str(key)


class _Reader:
    """The lines of a text, of which one is at hand.

    content: of the line at hand without its indentation; empty after the last line.
    indent: of the line at hand; after a dash, the column behind it.
    lines: line (from 1) of each key and list entry found so far, by path.
    """

    def __init__(self, text: str) -> None:
        self.rows = text.split("\n")
        self.row = -1
        self.lines: dict[Path, int] = {}
        self.next()

    def next(self) -> None:
        """Take the next line with a content."""
        rows, row = self.rows, self.row + 1
        while row < len(rows) and (not (content := rows[row].strip(" ")) or content[0] == "#"):
            row += 1
        self.row = row
        if row == len(rows):
            self.content, self.indent = "", -1
        else:
            self.content, self.indent = content, len(rows[row]) - len(rows[row].lstrip(" "))

    def block(self, indent: int, at: Path) -> Any:
        """The list or mapping whose entries begin in column `indent`, from the line at hand on."""
        if len(at) >= MAX_LEVELS or len(self.lines) > MAX_VALUES:
            raise OtherYaml
        if self.content.startswith("- "):
            return self.block_list(indent, at)
        mapping: dict[str, Any] = {}
        while self.indent == indent:
            found = _KEY.match(self.content)
            key = _key(found, at, mapping)
            assert found
            path = (*at, key)
            self.lines[path] = self.row + 1
            rest = self.content[found.end() :]
            if rest and rest[0] != "#":
                mapping[key] = self.value(rest, path)
                continue
            self.next()
            if self.indent > indent or (self.indent == indent and self.content.startswith("- ")):
                mapping[key] = self.block(self.indent, path)
            else:
                raise OtherYaml
        if self.indent > indent:
            raise OtherYaml
        return mapping

    def block_list(self, indent: int, at: Path) -> list[Any]:
        entries: list[Any] = []
        while self.indent == indent and self.content.startswith("- "):
            path = (*at, len(entries))
            self.lines[path] = self.row + 1
            rest = self.content[2:].lstrip(" ")
            if rest.startswith("- ") or _KEY.match(rest):
                self.indent += len(self.content) - len(rest)
                self.content = rest
                entries.append(self.block(self.indent, path))
            else:
                entries.append(self.value(rest, path))
        if self.indent > indent:
            raise OtherYaml
        return entries

    def value(self, text: str, at: Path) -> Any:
        """The value that `text`, the rest of the line at hand, begins; the next line is then at hand."""
        if text[0] in "[{":
            return self.flow(text, at)
        found = _SCALAR.match(text)
        if not found:
            raise OtherYaml
        self.next()
        return _value(found)

    def flow(self, text: str, at: Path) -> Any:
        """The list or mapping in brackets that `text` begins, and that ends in this line or a later one."""
        opened = text.count("[") + text.count("{") - text.count("]") - text.count("}")
        last = self.row
        while opened > 0 and last + 1 < len(self.rows):
            last += 1
            row = self.rows[last]
            opened += row.count("[") + row.count("{") - row.count("]") - row.count("}")
        brackets = _Brackets("\n".join([text, *self.rows[self.row + 1 : last + 1]]), self.row + 1, self.lines)
        value = brackets.value(at)
        if brackets.next():
            raise OtherYaml
        self.row = last
        self.next()
        return value


class _Brackets:
    """The text of a list or mapping in brackets.

    position: of the letter at hand.
    line: of the letter at hand, from 1.
    lines: as in `_Reader`.
    """

    def __init__(self, text: str, line: int, lines: dict[Path, int]) -> None:
        self.text, self.position, self.line, self.lines = text, 0, line, lines

    def next(self) -> str:
        """The next letter after blanks, ends of lines and comments; empty at the end."""
        found = _BLANK.match(self.text, self.position)
        assert found
        self.line += found.group().count("\n")
        self.position = found.end()
        return self.text[self.position : self.position + 1]

    def value(self, at: Path) -> Any:
        """The value that begins here."""
        letter = self.next()
        if letter in ("[", "{"):
            if len(at) >= MAX_LEVELS or len(self.lines) > MAX_VALUES:
                raise OtherYaml
            self.position += 1
            return self.list_(at) if letter == "[" else self.mapping(at)
        found = _FLOW_SCALAR.match(self.text, self.position)
        if not found:
            raise OtherYaml
        self.position = found.end()
        return _value(found)

    def list_(self, at: Path) -> list[Any]:
        entries: list[Any] = []
        while not self.ended("]", first=not entries):
            path = (*at, len(entries))
            self.lines[path] = self.line
            entries.append(self.value(path))
        return entries

    def mapping(self, at: Path) -> dict[str, Any]:
        mapping: dict[str, Any] = {}
        while not self.ended("}", first=not mapping):
            found = _FLOW_KEY.match(self.text, self.position)
            key = _key(found, at, mapping)
            assert found
            path = (*at, key)
            self.lines[path], self.position = self.line, found.end()
            mapping[key] = self.value(path)
        return mapping

    def ended(self, close: str, first: bool) -> bool:
        """Whether the bracket ends here; otherwise the next entry is at hand."""
        letter = self.next()
        if letter == "," and not first:
            self.position += 1
            letter = self.next()
        elif letter != close and not first:
            raise OtherYaml
        self.position += letter == close
        return letter == close


# ---------------------------------------------------------------------- writing
def entry(key: str, value: Any) -> str:
    """Lines of a key of a mapping in blocks, as ruamel writes them: what holds only scalars is in brackets.

    Raises OtherYaml for a value that needs quotes, or a line above MAX_WIDTH, which ruamel breaks.
    """
    rows = _mapping_rows({key: value}, "")
    if max(map(len, rows)) > MAX_WIDTH:
        raise OtherYaml
    return "\n".join(rows) + "\n"


def _mapping_rows(mapping: dict[str, Any], indent: str) -> list[str]:
    rows = []
    for key, value in mapping.items():
        if _on_one_line(value):
            rows.append(f"{indent}{_written(key, True)}: {_line(value)}")
        else:
            rows.append(f"{indent}{_written(key, True)}:")
            is_list = isinstance(value, list)
            rows += _list_rows(value, indent) if is_list else _mapping_rows(value, indent + "  ")
    return rows


def _list_rows(entries: list[Any], indent: str) -> list[str]:
    rows = []
    for value in entries:
        if _on_one_line(value):
            rows.append(f"{indent}- {_line(value)}")
        else:
            below = indent + "  "
            inner = (_list_rows if isinstance(value, list) else _mapping_rows)(value, below)
            rows += [f"{indent}- {inner[0][len(below) :]}", *inner[1:]]
    return rows


def _on_one_line(value: Any) -> bool:
    """Whether a value is a scalar, or holds only scalars."""
    parts = value if isinstance(value, list) else value.values() if isinstance(value, dict) else ()
    return not any(isinstance(part, list | dict) for part in parts)


def _line(value: Any) -> str:
    if isinstance(value, list):
        return "[" + ", ".join([_written(part, True) for part in value]) + "]"
    if isinstance(value, dict):
        return (
            "{"
            + ", ".join([f"{_written(k, True)}: {_written(part, True)}" for k, part in value.items()])
            + "}"
        )
    return _written(value, False)


def _written(value: Any, in_brackets: bool) -> str:
    """A scalar without quotes.  in_brackets: where commas and brackets would end it."""
    kind = type(value)
    if kind is str:
        return _written_text(value, in_brackets)
    if kind is float and math.isfinite(value):
        return repr(value)
    if kind is bool:
        return "true" if value else "false"
    if kind is int:
        return str(value)
    if value is None:
        return "null"
    raise OtherYaml


@lru_cache(maxsize=4096)
def _written_text(text: str, in_brackets: bool) -> str:
    if not (_PLAIN_IN_BRACKETS if in_brackets else _PLAIN).fullmatch(text) or _meaning(text) != text:
        raise OtherYaml
    return text
