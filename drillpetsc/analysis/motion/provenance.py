"""Provenance of a run: its case, versions and PETSc options, and their changes since a checkpoint.

A checkpoint contains the resolved case, so that a restart with another case is found and refused.
"""

from __future__ import annotations

import hashlib
import json
import platform
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from petsc4py import PETSc

from drillpetsc.case.case import Case
from drillpetsc.case.writer import case_data
from drillpetsc.errors import shown
from drillpetsc.output.files.json_file import plain
from drillpetsc.solvers.petsc_options import changes_no_result
from drillpetsc.version import __version__

#: keys of a case that may change at a restart: they do not act on the motion before the checkpoint
FREE_KEYS = (
    "title",
    "time.end",
    "output.history_every",
    "output.field_every",
    "output.checkpoint_every",
)
MOST_LISTED = 12  # changes that a message lists
ABSENT = object()


def versions() -> dict[str, str]:
    """Versions of drillpetsc, PETSc, numpy and Python."""
    return {
        "drillpetsc": __version__,
        "petsc": ".".join(map(str, PETSc.Sys.getVersion())),
        "numpy": np.__version__,
        "python": platform.python_version(),
    }


def resolved(case: Case) -> dict[str, Any]:
    """The case with all defaults, in SI, as JSON data, without the units of what is printed."""
    data = plain(case_data(case))
    assert isinstance(data, dict)
    data.get("output", {}).pop("units", None)
    return _moved(data)


def _moved(data: Any) -> Any:
    """The data with laws of the user independent of the folder of their file, whose digest they have."""
    if isinstance(data, list):
        return [_moved(part) for part in data]
    if not isinstance(data, dict):
        return data
    out = {key: _moved(part) for key, part in data.items()}
    if "source" in out and "function" in out:
        out["function"] = out["function"].rpartition("/")[2]
    return out


def digest(case: Case) -> str:
    """SHA-256 of the resolved case."""
    return _digest(resolved(case))


def _digest(data: Mapping[str, Any]) -> str:
    return hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()


def record(case: Case, user_options: Mapping[str, str]) -> dict[str, Any]:
    """Provenance for a checkpoint.

    user_options: PETSc options of the user, by name without dash.
    """
    data = resolved(case)
    return {
        "case": data,
        "case_digest": _digest(data),
        "versions": versions(),
        "petsc_options": dict(user_options),
    }


def changes(saved: Mapping[str, Any], case: Case, user_options: Mapping[str, str]) -> list[str]:
    """Changes by a restart, one line each: "top.rotation: 6 -> 12".

    saved: provenance of the checkpoint.
    """
    before, now = dict(saved["case"]), resolved(case)
    before.pop("petsc", None)  # the options in effect are compared instead
    now.pop("petsc", None)
    found = [
        f"{key}: {_text(old)} -> {_text(new)}"
        for key, old, new in _differences(before, now)
        if key not in FREE_KEYS
    ]
    options = [
        {name: text for name, text in given.items() if not changes_no_result(name)}
        for given in (saved["petsc_options"], user_options)
    ]
    for name in sorted(options[0].keys() | options[1].keys()):
        old, new = (given.get(name, ABSENT) for given in options)
        if not _same_option(old, new):
            found.append(f"petsc option -{name}: {_text(old)} -> {_text(new)}")
    version = saved["versions"]["drillpetsc"]
    if version != __version__:
        found.append(f"version of drillpetsc: {version} -> {__version__}")
    return found


def changed_libraries(saved: Mapping[str, Any]) -> list[tuple[str, str, str]]:
    """(name, version of the checkpoint, version now) of changed libraries: results are then equal up to rounding only."""
    now = versions()
    return [
        (name, str(saved["versions"][name]), str(now[name]))
        for name in ("petsc", "numpy")
        if saved["versions"].get(name) != now[name]
    ]


def listed(found: list[str]) -> str:
    """The changes on one line; only the first of them if there are many."""
    more = f"; and {len(found) - MOST_LISTED} more" if len(found) > MOST_LISTED else ""
    return "; ".join(found[:MOST_LISTED]) + more


def _differences(old: Any, new: Any, key: str = "") -> Iterator[tuple[str, Any, Any]]:
    """(key, old value, new value) of all leaves that differ."""
    if isinstance(old, dict) and isinstance(new, dict):
        for name in [*old, *(n for n in new if n not in old)]:
            inner = f"{key}.{name}" if key else name
            yield from _differences(old.get(name, ABSENT), new.get(name, ABSENT), inner)
    elif isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        for i, (a, b) in enumerate(zip(old, new, strict=True)):
            yield from _differences(a, b, f"{key}[{i}]")
    elif old is ABSENT or new is ABSENT or old != new:
        yield key, old, new


def _same_option(old: Any, new: Any) -> bool:
    if old is ABSENT or new is ABSENT:
        return False
    try:
        return float(old) == float(new)
    except ValueError:
        return bool(old == new)


def _text(value: Any) -> str:
    return "absent" if value is ABSENT else shown(value, 40)
