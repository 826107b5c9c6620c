"""Numbers of a case as parameters: which keys can be varied, by how much, and the case with another value of one."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from drillpetsc.case.blocks.well import Survey
from drillpetsc.case.case import Case, system_of
from drillpetsc.case.changes import changed
from drillpetsc.case.files.named_file import FOLDER
from drillpetsc.case.key_paths import Path, parsed, suggestion, written
from drillpetsc.case.schema import bare_unit_of
from drillpetsc.case.writer import case_data
from drillpetsc.errors import CaseError
from drillpetsc.units import UnitError, bare_number, to_si

STEP = 1e-4  # of differences by a key, relative to its value [-]
SHARE = 0.01  # of a key's value for which its effect is stated
FRICTION_STEP = 0.05  # of a friction coefficient for which its effect is stated
#: size of a quantity whose value is zero, by its SI unit; 1 for others
USUAL_SIZE = {
    "Pa": 1e5,
    "N": 1e4,
    "N m": 1e3,
    "m": 0.1,
    "m3/s": 1e-3,
    "N/m": 100.0,
    "kg": 10.0,
    "": 0.1,
    "rad": 0.01,
    "1/m": 1e-3,
    "m/s": 0.1,
    "m/(s N)": 1e-8,
}
#: blocks and keys that set the numerics or the output -> why they are refused
NUMERICS = {
    "mesh": "the mesh is held: its error is what `study --vary mesh` measures",
    "element_length": "the mesh is held: its error is what `study --vary mesh` measures",
    "petsc": "a tolerance of the solver changes its error, not the answer",
    "output": "output does not change the answer",
    "time": "times of a run do not enter a static answer",
    "measured": "measured points do not enter what is computed",
    "uncertain": "a distribution does not change the answer; name its key",
}
_WITH_UNIT = r"([-+]?[\d.]+(?:[eE][-+]?\d+)?)\s+(\S.*)"
#: of `--all`: lists of many numbers, which must be named one by one
LISTS = ("survey", "dial_readings", "measured", "friction_factor", "bit_depth")


@dataclass(frozen=True)
class Key:
    """A number of a case.

    name: path, such as `string[1].od`; value: in the case [SI]; unit: SI unit, empty for a pure number.  A key that exists in the file
    only has the unit of the file.
    resolved: it is changed in the case with all defaults, because the file has no place for it.
    """

    name: str
    value: float
    unit: str
    resolved: bool = field(default=False, compare=False)

    @property
    def size(self) -> float:
        """Magnitude by which steps are chosen [SI]."""
        return abs(self.value) or USUAL_SIZE.get(self.unit, 1.0)

    @property
    def per(self) -> float:
        """Change for which the effect is stated [SI]: 0.05 of a friction coefficient, 1 % of others."""
        return FRICTION_STEP if self.name.endswith("friction") and not self.unit else SHARE * self.size

    def changed(self, case: Case, value: float) -> Case:
        """The case with another value [SI] of the key; raises CaseError for one that is not allowed."""
        return changed_case(case, {self: value})


def changed_case(case: Case, values: Mapping[Key, float], survey: Survey | None = None) -> Case:
    """The case with other values [SI] of some keys, and another survey; raises CaseError for one that is not allowed."""
    given = case._given.keys
    keys = case_data(case) if given is None or any(key.resolved for key in values) else given
    well = keys.get("well")
    own_survey = any(key.name.startswith(("well.survey", "bit_depth")) for key in values)
    if isinstance(well, Mapping) and "survey" in well and not own_survey:
        # read once, not for every key; it ends at bit_depth, and so do the sections
        kept = list(well["sections"])[: len(case.given_well.sections)]
        last = kept[-1]
        kept[-1] = (
            {**last, "to": "end"} if isinstance(last, Mapping) else last.model_copy(update={"to": None})
        )
        keys = {**keys, "well": {**well, "survey": survey or case.given_well.survey, "sections": kept}}
    token = FOLDER.set(case._given.folder)
    try:
        return Case(**changed(keys, {q.name: f"{v!r} {q.unit}".rstrip() for q, v in values.items()}))
    finally:
        FOLDER.reset(token)


def key_of(case: Case, name: str) -> Key:
    """The key of a case by its path; an item of the string may be named by index or by name: `string[jar].weight`.

    Raises CaseError, with the reason, for what is not a continuous number of the case.
    """
    path = parsed(_with_index(case, name.strip()))
    for step in path:
        if step in NUMERICS:
            raise _refused(name, NUMERICS[str(step)])
    given: Mapping[str, Any] | None = case._given.keys
    resolved = case_data(case)
    found, at_home = _at(resolved, path), given is None or _has_place(given, path)
    if found is None and given is not None:
        found = _at(given, path)
    if isinstance(found, Mapping | list | tuple):
        inside = (
            [str(step) for step in found]
            if isinstance(found, Mapping)
            else [f"[{i}]" for i in range(len(found))]
        )
        raise _refused(name, f"it is a block: name one of its keys ({', '.join(inside[:8])})")
    if found is None:
        leaves = [written(q) for q in _leaves(resolved, ())]
        raise _refused(name, "the case has no such number", suggestion(written(path), leaves))
    if isinstance(found, bool | int) and not isinstance(_at(given, path) if given else None, float):
        raise _refused(name, f"{found} is a whole number or a switch, which has no derivative")
    unit = bare_unit_of(written(path), "SI")
    match = None if unit or not isinstance(found, str) else re.fullmatch(_WITH_UNIT, found)
    if match is not None:  # a key that the resolved case has under another name, such as yield_point
        return Key(written(path), float(match[1]), match[2])
    value = _number(found, unit, bare_unit_of(written(path), system_of(given or {})))
    if value is None:
        raise _refused(name, f"{found!r} is a word or varies over time, which has no derivative")
    return Key(written(path), value, unit, not at_home)


def every_key(case: Case) -> list[Key]:
    """Every continuous number of the resolved case, without lists of many numbers; pipe that gives its weight has `weight`."""
    found = []
    given = case._given.keys or {}
    names = dict.fromkeys([*_leaves(case_data(case), ()), *_leaves(given, ())])
    for path in names:
        if any(step in LISTS for step in path):
            continue
        try:
            found.append(key_of(case, written(path)))
        except CaseError:
            continue
    return found


def _refused(name: str, reason: str, hint: str = "") -> CaseError:
    return CaseError(at="--to", got=name, want=f"a continuous number of the case: {reason}", hint=hint)


def _with_index(case: Case, name: str) -> str:
    """The path with the index of an item of the string that is named: `string[jar].od` -> `string[3].od`."""
    match = re.match(r"string\[([^\]]*[^\]\d][^\]]*)\](.*)", name)
    if match is None:
        return name
    word = match[1].strip()
    index = [i for i, item in enumerate(case.string) if word in (item.name, item.kind)]
    if len(index) != 1:
        names = ", ".join(dict.fromkeys(item.name or item.kind for item in case.string))
        what = f"{len(index)} items are called {word!r}" if index else f"no item is called {word!r}"
        raise _refused(name, f"{what}; the string has {names}")
    return f"string[{index[0]}]{match[2]}"


def _at(data: Any, path: Path) -> Any:
    """The value at a path of plain data; None if there is none."""
    for step in path:
        try:
            data = data[step]
        except (KeyError, IndexError, TypeError):
            return None
    return data


def _has_place(given: Any, path: Path) -> bool:
    """Whether the value at a path can be set in the keys of a case as they were given."""
    for number, step in enumerate(path[:-1]):
        if (
            isinstance(given, Mapping)
            and step not in given
            and all(isinstance(q, str) for q in path[number:])
        ):
            return True  # a block that the file leaves to its defaults
        if _at(given, (step,)) is None:
            return False
        given = given[step]
    last = path[-1]
    return (
        isinstance(given, Mapping)
        if isinstance(last, str)
        else isinstance(given, list | tuple) and last < len(given)
    )


def _number(value: Any, unit: str, own: str) -> float | None:
    """A number [SI] of a resolved value or of one as it was given; None for anything else.

    own: unit of a bare number of the case.
    """
    if isinstance(value, float | int):
        return float(value)
    try:
        bare = bare_number(value)
        return float(to_si(f"{bare!r} {own}" if bare is not None and own else value, unit))
    except (UnitError, ValueError, TypeError):
        return None


def _leaves(data: Any, path: Path) -> Iterator[Path]:
    """Paths of all values of plain data that are neither mappings nor lists."""
    if isinstance(data, Mapping):
        for key, value in data.items():
            yield from _leaves(value, (*path, key))
    elif isinstance(data, list | tuple):
        for i, value in enumerate(data):
            yield from _leaves(value, (*path, i))
    else:
        yield path
