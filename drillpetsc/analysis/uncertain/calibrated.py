"""Distributions of numbers from a calibration: a case with what `calibrate` has found, and how sure that is."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from drillpetsc.analysis.uncertain.uncertain_keys import WEIGHT_FACTOR, names_of
from drillpetsc.case.case import Case
from drillpetsc.case.changes import changed
from drillpetsc.case.files.named_file import FOLDER
from drillpetsc.errors import CaseError
from drillpetsc.output.files.json_file import read_summary
from drillpetsc.output.files.run_folder import RunFolder

OPTION = "--calibration"
HALF_WIDTH = 1.959963984540054  # of a 95 % interval of a normal number, over its standard deviation
LEAST = 1e-3  # correlation that is carried over
#: numbers of `calibrate` -> keys of the case that they are
KEYS = {
    "block_weight": "rig.block_weight",
    "weight_factor": WEIGHT_FACTOR,
    "sheave_efficiency": "rig.hookload_sensor.sheave_efficiency",
}
NO_KEY = "running_drag"  # which `calibrate` fits, and the case computes


def calibrated(case: Case, folder: Path) -> tuple[Case, list[str]]:
    """The case with the numbers of a calibration in ``folder``, normally distributed as their 95 % intervals, and what was left out.

    They replace distributions of the same numbers; further ones of the case stay.  Raises CaseError for a folder without a
    calibration, one that determines nothing, and numbers that the case does not have.
    """
    summary = _summary(folder)
    fit, names = summary["fit"], [*summary["parameters"]]
    usable = [q for q in names if q != NO_KEY and fit[q]["value"] is not None and fit[q]["interval"]]
    if not usable:
        raise CaseError(at=OPTION, got=str(folder), want="a calibration that determines at least one number")
    spreads, values, own = dict[str, Any](), dict[str, str](), set[str]()
    for name in usable:
        low, high = fit[name]["interval"]
        unit = f" {fit[name]['unit']}".rstrip()
        key, value = KEYS.get(name, name), f"{fit[name]['value']!r}{unit}"
        spreads[key] = {"normal": [value, f"{(high - low) / 2 / HALF_WIDTH!r}{unit}"]}
        if key != WEIGHT_FACTOR:
            own |= set(names_of(case, key))
            values |= dict.fromkeys(names_of(case, key), value)
    for i, name in enumerate(usable):
        row = summary["correlation"][names.index(name)]
        others = {KEYS.get(q, q): row[names.index(q)] for q in usable[i + 1 :]}
        alike = {q: c for q, c in others.items() if c is not None and LEAST < abs(c) < 1}
        if alike:
            spreads[KEYS.get(name, name)]["correlated"] = alike
    keys, where = case.given_keys
    kept = _others(case, keys.get("uncertain"), own | set(spreads))
    token = FOLDER.set(where)
    try:
        found = Case(**{**changed(keys, values), "uncertain": kept | spreads})
    except CaseError as error:
        want = f"a calibration of this case, which has {', '.join(usable)}"
        raise CaseError(at=OPTION, got=str(folder), want=want, hint=str(error).replace("\n", ";")) from None
    finally:
        FOLDER.reset(token)
    unused, title = [name for name in names if name not in usable], summary.get("title")
    notes = {
        f"not taken from the calibration, which gives no interval of it: {', '.join(unused)}": unused,
        f"the calibration is of another case, {title or 'without a title'}: its friction may differ from this well's": title
        != case.title,
    }
    return found, [note for note, holds in notes.items() if holds]


def _summary(folder: Path) -> dict[str, Any]:
    """summary.json of a calibration."""
    file = RunFolder(folder).summary if folder.is_dir() else folder
    if not file.is_file():
        raise CaseError(at=OPTION, got=str(folder), want="a run folder of calibrate")
    summary = read_summary(file)
    fit, names, rows = (summary.get(q) for q in ("fit", "parameters", "correlation"))
    whole = isinstance(fit, dict) and isinstance(names, list) and isinstance(rows, list)
    if not whole or not all(
        {"value", "interval", "unit"} <= set(summary["fit"].get(name, ())) for name in summary["parameters"]
    ):
        raise CaseError(
            at=OPTION,
            got=str(folder),
            want="a run folder of calibrate",
            hint="this is of another command, or damaged",
        )
    return summary


def _others(case: Case, given: Any, replaced: set[str]) -> dict[str, Any]:
    """Distributions of the case of numbers that the calibration does not replace, without their correlations with those."""
    if not isinstance(given, Mapping):
        return {}
    out = {}
    for name, spread in given.items():
        if replaced & {name, *names_of(case, name)}:
            continue
        pairs = spread.get("correlated") if isinstance(spread, Mapping) else None
        kept = {q: c for q, c in (pairs or {}).items() if q not in replaced}
        out[name] = {**spread, "correlated": kept} if pairs else spread
    return out
