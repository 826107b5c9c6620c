"""Variations of a case: cases from `KEY=V1,V2` words or lists of Python values, all checked before any runs.

A value is written as in the case file (`20 l/s`, `none`, `{kind: clamped}`). Commas inside brackets or quotes
belong to the value. `on` and `off` switch a block: off removes it from the case, on leaves it as in the file.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from drillpetsc.case import Case, case_from_data, data_of_case
from drillpetsc.case.case import system_of
from drillpetsc.case.changes import changed, text_of
from drillpetsc.case.key_paths import Path as KeyPath
from drillpetsc.case.key_paths import parsed, written
from drillpetsc.case.schema import bare_unit_of
from drillpetsc.errors import CaseError
from drillpetsc.output.files.run_folder import ABSENT
from drillpetsc.unit_systems import System
from drillpetsc.units import bare_number

MOST_ERRORS = 5  # explained at once


@dataclass(frozen=True)
class Variation:
    """One member of a sweep.

    values: key -> word as given; ABSENT if the key lies in a block that is off.
    case: the case with these values.
    """

    values: dict[str, str]
    case: Case

    @property
    def label(self) -> str:
        """`fluid.density=1000 kg/m3, fluid.flow_rate=20 l/s`."""
        return ", ".join(f"{key}={word}" for key, word in self.values.items())

    def number_of(self, key: str) -> float | None:
        """Value of ``key`` in the case, in SI; None if it is not a number."""
        from drillpetsc.case.writer import case_data

        found: Any = case_data(self.case)
        for step in parsed(key):
            try:
                found = found[step]
            except (KeyError, IndexError, TypeError):
                return None
        return float(found) if isinstance(found, (int, float)) and not isinstance(found, bool) else None


def choices_of(words: Sequence[str]) -> dict[str, list[str]]:
    """Keys and their values from words such as `fluid.flow_rate=20 l/s,30 l/s`.

    Raises CaseError for any other word.
    """
    choices: dict[str, list[str]] = {}
    for word in words:
        key, separator, text = word.partition("=")
        if not separator or not key.strip():
            raise CaseError(
                got=word, want="KEY=V1,V2 with a key of the case file, such as fluid.flow_rate=20 l/s,30 l/s"
            )
        if key.strip() in choices:
            raise CaseError(at=key.strip(), got=text, want="each key once, with all its values in one list")
        choices[key.strip()] = split_values(text)
    return checked_choices(choices)


def choices_from(values: Mapping[str, Iterable[Any]]) -> dict[str, list[str]]:
    """Keys and their values from Python: a value is a number, a text as in the case file, a list or a mapping."""
    for key, several in values.items():
        if isinstance(several, (str, Mapping)) or not isinstance(several, Iterable):
            raise CaseError(at=key, got=several, want="a list of values")
    return checked_choices({key: [text_of(value) for value in several] for key, several in values.items()})


def checked_choices(choices: dict[str, list[str]]) -> dict[str, list[str]]:
    """Return the choices; raises CaseError if one is empty or repeated."""
    if not choices:
        raise CaseError(want="at least one KEY=V1,V2 to vary")
    paths: dict[KeyPath, str] = {}
    for key, words in choices.items():
        path = parsed(key)
        if path in paths:
            raise CaseError(at=key, want=f"each key once; {paths[path]} is the same")
        paths[path] = key
        if not words or not all(words):
            raise CaseError(
                at=key,
                got=",".join(words),
                want="one value or more, none of them empty",
                hint="commas separate values",
            )
        twice = next((word for i, word in enumerate(words) if word in words[:i]), None)
        if twice is not None:
            raise CaseError(at=key, got=twice, want="each value once")
    return choices


def split_values(text: str) -> list[str]:
    """Split a list at its commas, except those inside brackets or quotes."""
    parts, depth, quote = [""], 0, ""
    for letter in text:
        if quote:
            quote = "" if letter == quote else quote
        elif letter in "\"'" and not parts[-1].strip():
            quote = letter
        elif letter in "([{":
            depth += 1
        elif letter in ")]}":
            depth -= 1
        if letter == "," and depth <= 0 and not quote:
            parts.append("")
        else:
            parts[-1] += letter
    return [part.strip() for part in parts]


def variations(case: Case | str | Path, choices: dict[str, list[str]]) -> list[Variation]:
    """All combinations, the last key varying fastest.

    Combinations that differ only inside a block that is off make one member. Raises one CaseError that names
    the keys and values of all errors.
    """
    path, data, lines = data_of_case(case)
    found: list[Variation] = []
    errors: dict[str, CaseError] = {}
    seen: set[tuple[str, ...]] = set()
    for words in itertools.product(*choices.values()):
        values = _with_units(_present(dict(zip(choices, words, strict=True))), system_of(data))
        if tuple(values.values()) in seen:
            continue
        seen.add(tuple(values.values()))
        present = {key: text for key, text in values.items() if text != ABSENT}
        try:
            case = case_from_data(changed(data, present), path, lines)
            if case.time is None:
                raise CaseError(at="time", want="a block {end: ...}", file=path)
            found.append(Variation(values, case))
        except CaseError as error:
            for each in (error, *error.also):
                explained = _explained(each, values)
                errors.setdefault(f"{explained.at} {explained.got} {explained.want}", explained)
    if errors:
        first, *others = list(errors.values())[:MOST_ERRORS]
        first.also = tuple(others)
        raise first
    return found


def _present(values: dict[str, str]) -> dict[str, str]:
    """Values with ABSENT for keys inside a block that is off."""
    off = [parsed(key) for key, word in values.items() if word == "off"]

    def gone(path: KeyPath) -> bool:
        return any(len(path) > len(block) and path[: len(block)] == block for block in off)

    return {key: ABSENT if gone(parsed(key)) else word for key, word in values.items()}


def _with_units(values: dict[str, str], system: System) -> dict[str, str]:
    """Values with the unit that the case gives to bare numbers, so that tables and pictures show it."""
    if system == "SI":
        return values
    units = {key: bare_unit_of(key, system) for key in values}
    return {
        key: f"{word} {units[key]}" if units[key] and bare_number(word) is not None else word
        for key, word in values.items()
    }


def _explained(error: CaseError, values: dict[str, str]) -> CaseError:
    """The error in terms of the varied values: key and value as given, and the combination."""
    try:
        where = parsed(error.at)
    except CaseError:  # a key of the file that is not a path
        where = ()
    cause = None
    for key in values:
        path = parsed(key)
        if values[key] != ABSENT and where and (path[: len(where)] == where or where[: len(path)] == path):
            cause = key
    label = ", ".join(f"{key}={word}" for key, word in values.items())
    inner = f"{written(where)}: " if cause is not None and written(where) != cause else ""
    hint = "; ".join(filter(None, [error.hint, f"in the member {label}"]))
    if cause is None:
        return CaseError(error.at, error.got, error.want, hint, error.file, error.line)
    return CaseError(at=cause, got=values[cause], want=inner + error.want, hint=hint)
