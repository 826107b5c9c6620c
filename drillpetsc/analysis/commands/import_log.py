"""The `import log` command: a rig's log in SI with its states, its quality, and points for `calibrate`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from datetime import timedelta
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from drillpetsc.analysis.commands.doubts import Imported
from drillpetsc.analysis.loads.torque_drag.string_rows import need_well, rows_at
from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.roadmap import MeasuredPoint
from drillpetsc.case.case import Case
from drillpetsc.case.quantities import InSI
from drillpetsc.doubts import doubts_at
from drillpetsc.errors import CaseError
from drillpetsc.logs.channels import CHANNELS
from drillpetsc.logs.log import Log, between, read_log, read_map
from drillpetsc.logs.points import COLUMNS, Point, cells_of, points_of, read_every
from drillpetsc.logs.quality import (
    Check,
    check_sizes,
    dead_flag,
    gaps,
    held_values,
    spikes,
    weight_off_bottom,
    without_jumps,
)
from drillpetsc.logs.states import States, read_limits, spells, states_of
from drillpetsc.output import write_summary, write_table
from drillpetsc.output.files.run_folder import LOG_PAGE, LOG_POINTS, LOG_QUALITY, LOG_STATES, LOG_TABLE

WEIGHT_STEP = 20.0  # between depths at which the string is weighed [m]
SHOWN_UNUSED = 12  # titles of columns that the screen lists


@dataclass(frozen=True)
class LogResult:
    """What `import log` has written and found.

    folder: with log.csv, states.csv, points.csv, quality.json; log, states, points; checks: of the quality.
    lines: for the screen.
    """

    folder: Path
    log: Log
    states: States
    points: list[Point]
    checks: list[Check]
    lines: list[str]


@dataclass(frozen=True)
class Choices:
    """Texts of the options of the command.

    mapping: `--map`; every: `--every`; limits: `--states`; part: `--between`.
    """

    mapping: Sequence[str] = ()
    every: str | None = None
    limits: Sequence[str] = ()
    part: str | None = None


def import_log(
    files: Sequence[str], case: Case | None, out: str | Path | None, overwrite: bool, choices: Choices
) -> LogResult:
    """Read, check and divide a log, and write its folder.

    case: for the weight of the string, which reveals slips and wrong units; None: states that need it are unknown.
    out: folder, None: one named after the first file.
    Raises CaseError for what cannot be understood without a guess; nothing is written then.
    """
    folder = Path(out) if out else Path(f"{Path(files[0]).stem}-log")
    if folder.exists() and not overwrite:
        raise CaseError(at="--out", got=folder, want="a folder that does not exist, or --overwrite")
    found = read_and_divide(files, case, choices)
    _write(folder, found)
    return LogResult(folder, found.log, found.states, found.points, found.checks, _lines(folder, found, case))


@dataclass(frozen=True)
class Divided:
    """A log without its depth jumps, with states, points, checks, and the (n,) mask of rows after a gap."""

    log: Log
    states: States
    points: list[Point]
    checks: list[Check]
    far: np.ndarray


def read_and_divide(files: Sequence[str], case: Case | None, choices: Choices) -> Divided:
    """Read the files of a log, check it, and divide it into states and points; writes nothing."""
    figures = read_limits(choices.limits)
    log = between(read_log(files, read_map(choices.mapping)), choices.part)
    size = read_every(choices.every, log.by_time)
    checks = held_values(log)
    log, jumps = without_jumps(log)
    far, gap = gaps(log)
    checks += [jumps, gap, *spikes(log), *weight_off_bottom(log)]
    block = None if case is None or case.rig is None else case.rig.block_weight
    weigh = None if case is None else weights(case, log.column("bit_depth"))
    expected = None if weigh is None else (lambda depth: weigh(depth) + (block or 0.0))
    log = replace(log, warnings=(*log.warnings, *check_sizes(log, expected)))
    weight = np.full(len(log), np.nan) if weigh is None else weigh(log.column("bit_depth"))
    states = states_of(log, weight, block, figures, far)
    checks += dead_flag(log, states.in_slips)
    return Divided(log, states, points_of(log, states, weight, size, far), checks, far)


def weights(case: Case, depth: FloatArray) -> Callable[[FloatArray], FloatArray]:
    """Function from bit depths (k,) [m] to the weight that a string in mud hangs on the hook without friction (k,) [N].

    depth: (n,) all bit depths of the log [m]. Deeper than the hole the weight is unknown, nan.
    """
    well, end = need_well(case, "import log"), float(case.given_well.survey.md[-1])
    deepest = min(float(np.nanmax(depth, initial=0.0)), end)
    shallowest = max(float(np.nanmin(depth, initial=deepest)), 0.0)
    count = max(int(np.ceil((deepest - shallowest) / WEIGHT_STEP)), 1)
    found: list[tuple[float, float]] = [(0.0, 0.0)]
    for place in np.unique(np.linspace(shallowest, deepest, count + 1)):
        try:
            rows = rows_at(case, float(place), "FILE")
        except CaseError:
            continue  # shallower than the string can be cut
        down = np.asarray(well.at(rows.edges)[0])[:, 2]
        found.append((float(place), float(rows.weight @ np.diff(down)) + rows.end_weight))
    at, weight = np.array(found).T
    return lambda depth: np.where(depth <= end + 1.0, np.interp(depth, at, weight), np.nan)


def points_of_log(file: str, case: Case, every: str | None) -> tuple[MeasuredPoint, ...]:
    """Points for `calibrate` of a raw log, as `import log` would write them; nothing is written."""
    found = read_and_divide([file], case, Choices(every=every))
    points = tuple(measured_point(point) for point in found.points)
    if not points:
        counts = ", ".join(f"{word} {count}" for word, count in found.states.count().items())
        raise CaseError(
            at="--log",
            got=f"{file}: {counts}",
            want="a log with trips, drilling or rotation that makes points",
            hint="points that are made already, such as points.csv of import log, are given with --measured",
        )
    return points


def measured_point(point: Point) -> MeasuredPoint:
    """A point of a log as one of a case; a reading that a case does not have is left out.

    Raises CaseError if a reading is outside of what a case allows.
    """
    names = {
        "hook_load": "hook_load",
        "torque": "torque",
        "wob": "wob",
        "torque_downhole": "tob",
        "rpm": "rpm",
        "flow_rate": "flow_rate",
    }
    keys = {key: InSI(max(point.values[name], 0.0)) for name, key in names.items() if name in point.values}
    if point.speed == point.speed:
        keys["speed"] = InSI(point.speed)
    try:
        return MeasuredPoint.model_validate(
            {"bit_depth": InSI(point.bit_depth), "operation": point.operation, **keys}
        )
    except ValidationError as error:
        name = str(error.errors()[0]["loc"][0])
        got = f"{float(keys[name]):g} in SI" if name in keys else "no value"
        want = f"readings that a rig can have; at bit depth {point.bit_depth:.1f} m, {point.operation}, this is none"
        hint = "leave these rows out, or name the unit of the column with --map"
        raise CaseError(at=name, got=got, want=want, hint=hint) from None


# ---------------------------------------------------------------------- files
def _write(folder: Path, found: Divided) -> None:
    log, states = found.log, found.states
    try:
        folder.mkdir(parents=True, exist_ok=True)
        write_table(folder / LOG_TABLE, *_log_table(log, states))
        _write_parquet(folder, *_log_table(log, states))
        write_table(folder / LOG_STATES, *_spell_table(log, states, found.far))
        cells = cells_of(found.points)
        write_table(
            folder / LOG_POINTS, [(name, unit or "-") for name, unit, _ in COLUMNS], list(cells.values())
        )
        write_summary(folder / LOG_QUALITY, _summary(found))
    except OSError as error:
        raise CaseError(
            at="--out", got=folder, want=f"a folder that can be written ({error.strerror})"
        ) from None


def _write_parquet(folder: Path, columns: list[tuple[str, str]], cells: list[Any]) -> None:
    """The table of the log for data frames, if the package pyarrow is installed."""
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError:
        return
    table = {
        f"{name} [{unit}]": pyarrow.array(values) for (name, unit), values in zip(columns, cells, strict=True)
    }
    parquet.write_table(pyarrow.table(table), folder / f"{Path(LOG_TABLE).stem}.parquet")


def _log_table(log: Log, states: States) -> tuple[list[tuple[str, str]], list[Any]]:
    columns: list[tuple[str, str]] = []
    cells: list[Any] = []
    for name, values in log.values.items():
        columns.append((name, CHANNELS[name].unit.replace("^", "") or "-"))
        cells.append(values)
    if log.start is not None:
        columns.append(("clock", "-"))  # ISO 8601, which names the zone
        cells.append([(log.start + timedelta(seconds=t)).isoformat() for t in log.values["time"].tolist()])
    return [*columns, ("state", "-")], [*cells, states.word]


def _spell_table(log: Log, states: States, far: np.ndarray) -> tuple[list[tuple[str, str]], list[Any]]:
    runs = spells(states.word, far)
    index = log.index
    unit = "s" if log.by_time else "m"
    columns = [
        ("state", "-"),
        ("from", unit),
        ("to", unit),
        ("rows", "-"),
        ("bit_depth_from", "m"),
        ("bit_depth_to", "m"),
    ]
    columns += [("hook_load", "N")]
    depth, hook = log.column("bit_depth"), log.column("hook_load")
    with np.errstate(all="ignore"):
        middle = [
            float(np.nanmedian(hook[a:b])) if not np.isnan(hook[a:b]).all() else np.nan for a, b in runs
        ]
    return columns, [
        [str(states.word[a]) for a, _ in runs],
        [index[a] for a, _ in runs],
        [index[b - 1] for _, b in runs],
        [b - a for a, b in runs],
        [depth[a] for a, _ in runs],
        [depth[b - 1] for _, b in runs],
        middle,
    ]


def _summary(found: Divided) -> dict[str, Any]:
    log, states = found.log, found.states
    return {
        "rows": len(log),
        "index": "time" if log.by_time else "depth",
        "start": None if log.start is None else log.start.isoformat(),
        "columns": log.titles,
        "unused": list(log.unused),
        "checks": [check.record() for check in found.checks],
        "states": states.count(),
        "block_weight": states.block,
        "points": len(found.points),
        "warnings": [*log.warnings, *_doubts(found)],
        "notes": list(log.remarks),
    }


def _doubts(found: Divided) -> list[str]:
    """What is doubtful about a log as a whole."""
    states = found.states
    return doubts_at(Imported(states.count(), len(found.points), states.block is not None, found.log.by_time))


def _lines(folder: Path, found: Divided, case: Case | None) -> list[str]:
    log, states, points, checks = found.log, found.states, found.points, found.checks
    lines = [
        f"{len(log)} rows by {'time' if log.by_time else 'depth'}: {', '.join(f'{q} = {t}' for q, t in log.titles.items())}"
    ]
    if log.unused:
        more = f" and {len(log.unused) - SHOWN_UNUSED} more" if len(log.unused) > SHOWN_UNUSED else ""
        lines.append(f"  not used: {', '.join(log.unused[:SHOWN_UNUSED])}{more}")
    for check in checks:
        if check.count:
            share = check.count / check.n
            lines.append(
                f"  {check.name}, {check.channel}: {check.count} ({share:.1%}), {check.detail}; {check.action}"
            )
    lines.append("  states: " + ", ".join(f"{word} {count}" for word, count in states.count().items()))
    if states.block is not None:
        lines.append(f"  hook load in slips (block): {states.block / 1e3:.4g} kN")
    elif log.by_time:
        reason = "without --case" if case is None else "the log shows no block weight"
        lines.append(f"  note: {reason}, slips are not recognised, and trips make no points")
    kinds = {p.operation: sum(q.operation == p.operation for q in points) for p in points}
    lines.append(
        f"  {len(points)} points for calibrate"
        + "".join(f", {word} {count}" for word, count in kinds.items())
    )
    lines += [f"  WARNING: {text}" for text in (*log.warnings, *_doubts(found))]
    lines += [f"  note: {text}" for text in log.remarks]
    names = ", ".join((LOG_TABLE, LOG_STATES, LOG_POINTS, LOG_QUALITY, LOG_PAGE))
    return [*lines, f"  results: {folder}: {names}"]
