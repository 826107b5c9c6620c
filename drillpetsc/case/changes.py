"""Changed values of a case: texts as in a case file, `on` and `off` for blocks, laid over the data of the case.

A sweep and `Case.replace` change cases by these functions.
"""

from __future__ import annotations

import copy
import json
from collections.abc import Mapping
from typing import Any

from drillpetsc.case.files.own_function import name_of
from drillpetsc.case.files.yaml_text import read_value
from drillpetsc.case.key_paths import Path, parsed, written
from drillpetsc.case.quantities import with_text
from drillpetsc.errors import CaseError

WITHOUT = {"contact": "none"}  # blocks that a case has by default -> the value that removes them
#: keys that are not blocks of physics: on and off are refused
SETTINGS = (
    "material",
    "beam",
    "initial",
    "time",
    "output",
    "petsc",
    "bottom",
    "top",
    "string",
    "well.survey",
    "well.sections",
)


def override(data: Mapping[str, Any], change: str) -> dict[str, Any]:
    """A copy of case data with one value replaced: `override(data, "string[1].od=8 in")`.

    data: plain data of a case
    change: `key=value`; the value is read as YAML, as in `contact=none` or `output.probes=[1 m, 2 m]`
    """
    key, separator, value = change.partition("=")
    if not separator or not key.strip():
        raise CaseError(got=change, want="KEY=VALUE, such as top.rotation=90 rpm")
    result = copy.deepcopy(dict(data))
    path = parsed(key.strip())
    target: Any = result
    for depth, step in enumerate(path):
        if not (
            isinstance(target, dict)
            if isinstance(step, str)
            else isinstance(target, list) and step < len(target)
        ):
            raise _no_such_path(path, depth, target)
        if depth == len(path) - 1:
            try:
                target[step] = read_value(value)
            except CaseError as error:
                hint = error.hint or f"{key.strip()}=off leaves the key out"
                raise CaseError(at=key.strip(), got=error.got, want=error.want, hint=hint) from None
        else:
            target = target.setdefault(step, {}) if isinstance(target, dict) else target[step]
    return result


def _no_such_path(path: Path, depth: int, there: Any) -> CaseError:
    """The error for a key path whose entry ``depth`` does not exist in what is ``there``, one level above it."""
    above, step = written(path[:depth]), path[depth]
    if isinstance(there, list):
        example = above + "[0]" + (f".{step}" if isinstance(step, str) else "")
        want = f"an entry of {above}, a list of {len(there)}, such as {example}"
    elif isinstance(there, dict):
        want = f"a key: {above or 'the case'} is a block and no list"
    else:
        block = f"{{kind: {there}, {step}: ..}}" if isinstance(there, str) else "{..}"
        want = f"a path of keys: {above} is {there!r} and no block; give it as a whole, {above}={block}"
    return CaseError(at=written(path), want=want)


def text_of(value: Any) -> str:
    """A value as text of a case file: a text is taken as it is, a quantity of pint with its unit, all others as YAML."""
    value = name_of(with_text(value))  # a function is known by its name
    return value if isinstance(value, str) else json.dumps(value, default=_plain)


def _plain(value: Any) -> Any:
    return value.tolist() if hasattr(value, "tolist") else str(name_of(value))


def changed(data: Mapping[str, Any], values: Mapping[str, str]) -> dict[str, Any]:
    """Case data with values set; a block is set before the keys inside it. The data given are left alone.

    data: keys of a case
    values: key path -> text of the value as in a case file; `on`, `off` keep or remove a block
    Raises CaseError for unknown paths and for texts that cannot be read.
    """
    data = dict(data)
    for key, text in sorted(values.items(), key=lambda each: len(parsed(each[0]))):
        try:
            data = (
                _switched(data, key, text == "on")
                if text in ("on", "off")
                else override(data, f"{key}={text}")
            )
        except CaseError as error:
            raise CaseError(at=key, got=text, want=error.want, hint=error.hint) from None
    return data


def with_change(data: Mapping[str, Any], change: str) -> dict[str, Any]:
    """Case data with one change `KEY=VALUE`; `KEY=on`, `KEY=off` keep or remove a block, as in a sweep."""
    key, separator, text = change.partition("=")
    if separator and key.strip() and text.strip() in ("on", "off"):
        return changed(data, {key.strip(): text.strip()})
    return override(data, change)


def _switched(data: dict[str, Any], key: str, on: bool) -> dict[str, Any]:
    """Case data with a block kept or removed."""
    *above, last = parsed(key)
    holder: Any = data
    for step in above:
        holder = holder.get(step) if isinstance(holder, dict) else None
    there = isinstance(holder, dict) and last in holder
    if there and isinstance(holder[last], bool):
        return override(data, f"{key}={'true' if on else 'false'}")
    if not on and key in WITHOUT:
        return override(data, f"{key}={WITHOUT[key]}")
    if key in SETTINGS or isinstance(last, int) or (above and not there):
        raise CaseError(
            want="on and off only for a block of physics that the file has, such as fluid",
            hint="give its values instead",
        )
    if on and not there and key not in WITHOUT:
        raise CaseError(
            want="on and off only for a block of physics that the file has",
            hint=f"write the block {key} into the case file; off leaves it out",
        )
    if on:
        return data
    if not there:
        raise CaseError(want="on and off only for a block of physics that the file has")
    data = copy.deepcopy(data)
    holder = data
    for step in above:
        holder = holder[step]
    del holder[last]
    return data
