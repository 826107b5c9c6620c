"""YAML of usual cases by libyaml, in a tenth of the time of ruamel; all else is left to ruamel.

libyaml follows YAML 1.1.  A text that 1.2 may read otherwise is not read here, nor is one with anchors, tags, texts over several lines
or a mistake: `yaml_text` then reads it by all rules of YAML 1.2, and finds the words for the mistake.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from functools import lru_cache
from typing import Any, ClassVar

from drillpetsc.case.key_paths import MAX_LEVELS, MAX_VALUES, Path

MAX_WIDTH = 4096  # of a line that is written, after which it goes on in the next one

#: tabs, and letters that YAML takes for ends of lines, or refuses
_OTHER_LETTERS = re.compile("[^\n -~\xa0-\u1fff]")
_KEY = re.compile(r"[A-Za-z_][\w-]{0,99}|[1-9][0-9]{0,3}", re.ASCII)
_WHOLE = re.compile("-?(?:0|[1-9][0-9]{0,15})")
_DECIMAL = re.compile(r"-?(?:0|[1-9][0-9]{0,30})(?:\.[0-9]{1,30})?(?:[eE][-+]?[0-9]{1,3})?")
_BEGINNING = re.compile(r"[\w(/]|[-+.][0-9]")
_NUMBER_AND_UNIT = re.compile(r"-?[0-9]+(?:\.[0-9]+)?(?![eExob])[A-Za-z%].*")
_TRUTH = {word: word.lower() == "true" for word in ("true", "True", "TRUE", "false", "False", "FALSE")}
_NOTHING = ("null", "Null", "NULL")


_TAG = "tag:yaml.org,2002:"
#: tag -> form of plain scalars that stand for it (YAML 1.2, 10.3.2), and the letters with which they begin
_RESOLVED = {
    "bool": ("true|True|TRUE|false|False|FALSE", "tTfF"),
    "null": ("(?:~|null|Null|NULL)?", ["", *"~nN"]),
    "int": ("-?[0-9]+", "-0123456789"),
    "float": (r"-?[0-9]+(?:\.[0-9]*)?(?:e[-+]?[0-9]+)?|-?\.inf|\.nan", "-.0123456789"),
    # what 1.1, ruamel or others read as a number, a date or a merged key
    "timestamp": (
        r"[-+.]*[0-9][0-9a-fA-FxobeE_.:+-]*|[0-9]+-[0-9]+-[0-9]+.*|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)",
        "-+.0123456789",
    ),
    "merge": ("<<", "<"),
    "value": ("=", "="),
}


class OtherYaml(Exception):
    """The text is not of this kind."""


# ---------------------------------------------------------------------- reading
def read(text: str) -> tuple[dict[str, Any], dict[Path, int]]:
    """Data and lines of a mapping, as `yaml_text.parse` and `plain` have them; raises OtherYaml for texts of another kind."""
    lines: dict[Path, int] = {}
    data = _document(text, lines)
    if not isinstance(data, dict):
        raise OtherYaml
    return data, lines


def read_scalar(text: str) -> Any:
    """A number, truth value or text on one line; raises OtherYaml for all else."""
    value = _document(text, {})
    if isinstance(value, list | dict):
        raise OtherYaml
    return value


def _document(text: str, lines: dict[Path, int]) -> Any:
    """The one value of a text, whose lines are stored."""
    import yaml

    if _OTHER_LETTERS.search(text) or not yaml.__with_libyaml__:
        raise OtherYaml
    events = yaml.parse(text, Loader=yaml.CSafeLoader)
    try:
        if next(events) and next(events).explicit:
            raise OtherYaml
        value = _value(next(events), events, (), lines)
        if next(events).explicit or not isinstance(next(events), yaml.StreamEndEvent):
            raise OtherYaml
    except (yaml.YAMLError, AttributeError):  # the events of a text without a document have nothing explicit
        raise OtherYaml from None
    return value


def _value(event: Any, events: Iterator[Any], at: Path, lines: dict[Path, int]) -> Any:
    """The value that an event begins."""
    kind = type(event).__name__
    if kind == "AliasEvent" or event.anchor or event.tag:
        raise OtherYaml
    if kind == "ScalarEvent":
        return _scalar(event)
    if len(at) >= MAX_LEVELS or len(lines) > MAX_VALUES:
        raise OtherYaml
    if kind == "SequenceStartEvent":
        entries: list[Any] = []
        while type(event := next(events)).__name__ != "SequenceEndEvent":
            path = (*at, len(entries))
            lines[path] = event.start_mark.line + 1
            entries.append(_value(event, events, path, lines))
        return entries
    mapping: dict[str, Any] = {}
    while type(event := next(events)).__name__ != "MappingEndEvent":
        key = _key(event, at, mapping)
        path = (*at, key)
        lines[path] = event.start_mark.line + 1
        mapping[key] = _value(next(events), events, path, lines)
    return mapping


def _key(event: Any, at: Path, mapping: dict[str, Any]) -> str:
    """The key of an event, of the mapping at a path, which does not have it yet."""
    if type(event).__name__ != "ScalarEvent" or event.anchor or event.tag or event.style:
        raise OtherYaml
    key = str(event.value)
    if not _KEY.fullmatch(key) or key in mapping or key in _TRUTH or key in _NOTHING:
        raise OtherYaml
    if key[0].isdigit() and at[-1:] != ("dial",):  # speeds of a viscometer
        raise OtherYaml
    return key


def _scalar(event: Any) -> Any:
    """What a scalar stands for by the rules of YAML 1.2."""
    if event.start_mark.line != event.end_mark.line or event.style in ("|", ">"):
        raise OtherYaml
    return str(event.value) if event.style else _meaning(event.value)


def _meaning(text: str) -> Any:
    """What a plain scalar stands for by the rules of YAML 1.2."""
    if not _BEGINNING.match(text) or any(letter in text for letter in ":#\"'"):
        raise OtherYaml
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


# ---------------------------------------------------------------------- writing
def written(data: dict[str, Any]) -> str:
    """YAML 1.2 of plain data, in the order of its keys; what holds only scalars is in brackets."""
    import yaml

    return str(
        yaml.dump(
            data,
            Dumper=_dumper(),
            sort_keys=False,
            default_flow_style=None,
            allow_unicode=True,
            width=MAX_WIDTH,
        )
    )


@lru_cache(maxsize=1)
def _dumper() -> Any:
    """A writer that puts a text in quotes where YAML 1.2 would take it for something else."""
    import yaml

    class Dumper(getattr(yaml, "CSafeDumper", yaml.SafeDumper)):  # type: ignore[misc]
        yaml_implicit_resolvers: ClassVar[dict[str, Any]] = {}

        def ignore_aliases(self, data: Any) -> bool:
            return True

    for tag, (form, letters) in _RESOLVED.items():
        Dumper.add_implicit_resolver(_TAG + tag, re.compile(f"^(?:{form})$"), list(letters))
    Dumper.add_representer(float, lambda dumper, x: dumper.represent_scalar(_TAG + "float", _float(x)))
    return Dumper


def _float(value: float) -> str:
    if math.isfinite(value):
        return repr(value)
    return ".nan" if math.isnan(value) else ".inf" if value > 0 else "-.inf"
