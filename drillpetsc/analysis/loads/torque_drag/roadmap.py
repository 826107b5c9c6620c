"""The `roadmap` command: hook load and torque against bit depth for operations and friction factors."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any, Literal

import numpy as np
from petsc4py import PETSc

from drillpetsc.analysis.loads.torque_drag.batch import Columns, Hole, soft_strings
from drillpetsc.analysis.loads.torque_drag.circulation import Circulation, circulation
from drillpetsc.analysis.loads.torque_drag.left_out import bends_left_out, cutters_left_out
from drillpetsc.analysis.loads.torque_drag.operations import (
    MOST_ROWS,
    Load,
    Pair,
    assumptions,
    load_of,
    pairs_of,
    plan_of,
    running_speed,
    shoes_of,
    strings_of,
    told,
)
from drillpetsc.analysis.loads.torque_drag.readings.measured import (
    beside_curves,
    measured_lines,
    measured_warnings,
)
from drillpetsc.analysis.loads.torque_drag.readings.measured_table import beside_points
from drillpetsc.analysis.loads.torque_drag.readings.reading import (
    DIRECTION,
    Sensor,
    corrected_points,
    sensor_of,
)
from drillpetsc.analysis.loads.torque_drag.string_rows import StringRows, gravity_of, mud_level, need_well
from drillpetsc.analysis.loads.torque_drag.table import OK, Pressures, failed, rows_of, still_mud
from drillpetsc.analysis.loads.torque_drag.torque_lines import passed, torque_lines
from drillpetsc.analysis.motion.run_options import options_of
from drillpetsc.case.blocks.roadmap import MeasuredPoint
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.geometry.well import Well
from drillpetsc.output import write_summary, write_table
from drillpetsc.output.files.case_files import write_case
from drillpetsc.output.files.run_folder import MEASURED_TABLE, ROADMAP_FILE, ROADMAP_TABLE
from drillpetsc.output.job import Job
from drillpetsc.output.quantities.torque_drag import BESIDE, ROADMAP
from drillpetsc.output.result import RunResult
from drillpetsc.output.shown_units import lengths_shown, shown_unit
from drillpetsc.unit_systems import System

#: models of the string by the word of `--model`
MODELS = {"soft": "soft string", "stiff": "beam in static equilibrium"}


def columns_of(loads: list[Load], placed: list[int], pairs: list[Pair]) -> Columns:
    """Columns of soft strings from lists of the same length."""
    return Columns(
        np.array(placed, dtype=int),
        np.array([pair.friction for pair in pairs]),
        np.array([pair.item_factor for pair in pairs]),
        np.array([load.wob for load in loads]),
        np.array([load.torque for load in loads]),
        np.array([load.axial_velocity for load in loads]),
        np.array([load.rotation for load in loads]),
        np.ones(len(loads)),
    )


def densities_of(case: Case) -> tuple[float, float]:
    """Density of the mud in and around the string [kg/m3], 0 where there is none."""
    density = 0.0 if case.fluid is None else case.fluid.density
    filled = case.has_bore or mud_level(case) is not None
    return (density if filled else 0.0, density if case.has_annulus else 0.0)


def soft_rows(
    case: Case, well: Well, strings: list[StringRows], operations: tuple[str, ...], pairs: list[Pair]
) -> list[dict[str, Any]]:
    """Rows of a roadmap [SI] with the soft string: by operation, pair and bit depth."""
    keys, loads = _rows_asked(case, strings, operations, pairs)
    flows = circulations(case, strings, loads)
    columns = columns_of(
        [loads[o] for o, _, _ in keys], [d for _, _, d in keys], [pairs[p] for _, p, _ in keys]
    )
    hole = Hole(well, strings)
    mud = still_mud(hole, len(keys), densities_of(case), gravity_of(case, "roadmap"), mud_level(case))
    found = [flows.get((o, d)) for o, _, d in keys]
    if flows:
        columns, mud = _with_flow(hole, columns, mud, found)
    block = (case.rig.block_weight if case.rig is not None else None) or 0.0
    rows = rows_of(hole, columns, soft_strings(hole, columns), mud, block)
    for row, flow, (_, _, d) in zip(rows, found, keys, strict=True):
        if strings[d].misfit:
            row |= failed(strings[d].misfit)
        elif isinstance(flow, SolveError):
            row |= failed(f"the flow: {flow}")
    return [head_of(o, pairs[p], strings[d]) | row for (o, p, d), row in zip(keys, rows, strict=True)]


def _rows_asked(
    case: Case, strings: list[StringRows], operations: tuple[str, ...], pairs: list[Pair]
) -> tuple[list[tuple[str, int, int]], dict[str, Load]]:
    """(operation, pair, depth) of each row, and the loads of the operations."""
    plan = plan_of(case)
    keys = [(o, p, d) for o in operations for p in range(len(pairs)) for d in range(len(strings))]
    return keys, {o: load_of(case, plan, o) for o in operations}


def circulations(
    case: Case, strings: list[StringRows], loads: dict[str, Load]
) -> dict[tuple[str, int], Circulation | SolveError]:
    """Forces of the mud by operation and string; the error where there is no steady flow."""
    found: dict[tuple[int, float, float], Circulation | SolveError] = {}
    out: dict[tuple[str, int], Circulation | SolveError] = {}
    for operation, load in loads.items():
        speed = running_speed(case, operation, load.axial_velocity)
        for d, rows in enumerate(strings):
            if rows.misfit or not (load.flow or speed):
                continue
            key = d, load.flow, speed
            if key not in found:
                try:
                    given = getattr(getattr(plan_of(case), operation, None), "flow_rate", None)
                    at = "fluid.flow_rate" if given is None else f"roadmap.{operation}.flow_rate"
                    found[key] = circulation(case, rows.depth, load.flow, at, speed)
                except SolveError as error:
                    found[key] = error
            out[operation, d] = found[key]
    return out


def _with_flow(
    hole: Hole, columns: Columns, mud: Pressures, found: list[Circulation | SolveError | None]
) -> tuple[Columns, Pressures]:
    """Columns and pressures with the forces of the mud where it flows."""
    lift, thrust = np.zeros((len(hole.h), len(found))), np.zeros(len(found))
    for c, flow in enumerate(found):
        if isinstance(flow, Circulation):
            lift[:, c], thrust[c] = flow.lift(hole.edges), flow.thrust
            mud.inside[:, c] = np.interp(hole.edges, flow.md, flow.inside)
            mud.outside[:, c] = np.interp(hole.edges, flow.md, flow.outside)
            mud.momentum[:, c] = np.interp(hole.edges, flow.md, flow.momentum)
    return replace(columns, lift=lift, thrust=thrust), mud


def stiff_rows(
    case: Case,
    well: Well,
    strings: list[StringRows],
    operations: tuple[str, ...],
    pairs: list[Pair],
    comm: PETSc.Comm,
) -> list[dict[str, Any]]:
    """Rows of a roadmap [SI] with the beam, in the order of `soft_rows`; collective."""
    from drillpetsc.analysis.loads.torque_drag import stiff

    stiff.need_beam(case)
    keys, loads = _rows_asked(case, strings, operations, pairs)
    flows = circulations(case, strings, loads)
    block = (case.rig.block_weight if case.rig is not None else None) or 0.0
    jobs = [
        stiff.Job(strings[d], pairs[p], loads[o], block, densities_of(case), flows.get((o, d)))
        for o, p, d in keys
    ]
    found = stiff.solve_jobs(case, well, jobs, comm)
    return [head_of(o, pairs[p], strings[d]) | row for (o, p, d), row in zip(keys, found, strict=True)]


def head_of(operation: str, pair: Pair, rows: StringRows) -> dict[str, Any]:
    """What names a row."""
    return {
        "bit_depth": rows.depth,
        "operation": operation,
        "ff_cased": pair.cased,
        "ff_open_hole": pair.open_hole,
        "ff_groups": pair.groups,
    }


def lines_of(case: Case, well: Well, strings: list[StringRows]) -> dict[str, list[float]]:
    """Weight of the freely rotating string and weight in air [N] over the bit depth [m]."""
    hole, count = Hole(well, strings), len(strings)
    still = Load(0.0, 0.0, 0.0, 0.0)
    smooth = Pair(0.0, 0.0, np.zeros(len(well.section_to)), 0.0)
    batch = soft_strings(hole, columns_of([still] * count, list(range(count)), [smooth] * count))
    return {
        "bit_depth": [rows.depth for rows in strings],
        "free_rotating_weight": [float(v) for v in batch.tension[0]],
        "weight_in_air": [rows.air_weight for rows in strings],
    }


# ---------------------------------------------------------------------- command
def run_roadmap(
    job: Job,
    measured: tuple[MeasuredPoint, ...] | None = None,
    model: Literal["soft", "stiff"] = "soft",
) -> RunResult:
    """Compute hook load and torque over the bit depth (collective).

    measured: points to be plotted; None: those of the case.
    model: soft, the soft string, every rank computes the same; stiff, the static equilibrium of the beam, whose rows the
    ranks share out.  The first rank writes.
    """
    case, comm = job.case, job.comm
    well = need_well(case, "roadmap")
    gravity_of(case, "roadmap")
    plan = plan_of(case)
    notes: list[str] = assumptions(case, plan) + cutters_left_out(case)
    notes += bends_left_out(case) if model == "soft" else []
    pairs = pairs_of(case, plan, notes)
    strings = strings_of(case, plan, notes)
    if len(plan.operations) * len(pairs) * len(strings) > MOST_ROWS:
        got = f"{len(plan.operations)} operations x {len(pairs)} pairs x {len(strings)} depths"
        raise CaseError(at="roadmap", got=got, want=f"at most {MOST_ROWS} rows")
    stiff: dict[str, Any] = {}
    with options_of(case):
        rows = soft = soft_rows(case, well, strings, plan.operations, pairs)
        start = time.perf_counter()
        if model == "stiff":
            rows = stiff_rows(case, well, strings, plan.operations, pairs, comm)
    if model == "stiff":
        stiff = {"stiff_seconds": time.perf_counter() - start, "soft_against_stiff": deviations(soft, rows)}
        notes.append("torque on bit is added to the torque of the string; its effect on bending is left out")
    block = None if case.rig is None else case.rig.block_weight
    if block is not None:
        for row in rows:
            row["hook_load_total"] = row["hook_load"] + block
    excludes = plan.hookload_excludes_block
    read = (plan.measured if measured is None else measured) or ()
    points = corrected_points(case, read, excludes)
    sensor = sensor_of(case)
    if sensor != Sensor():
        for row in rows:
            total = row.get("hook_load_total", row["hook_load"])
            row["hook_load_reading"] = total / sensor.factor(DIRECTION[row["operation"]])
    system: System = case.shown_units
    lines_of_torque = torque_lines(case, strings, rows)
    warnings = _warnings(case, rows, lines_of_torque, system)
    found = beside_curves(rows, points, 0.0 if excludes else (block or 0.0))
    end = None if case.well is None else float(case.well.survey.md[-1])
    warnings += measured_warnings(found, points, end, block, excludes, system)
    table = None
    if points:
        try:
            with options_of(case):
                table = beside_points(case, read, points, pairs, excludes)
        except (CaseError, SolveError) as error:  # the curves stand without it
            reason = " ".join(str(error).split())
            warnings.append(f"{MEASURED_TABLE} is left out, the points cannot be computed: {reason}")
    folder = job.make_folder()
    summary = {
        "title": case.title,
        "units": system,
        "model": model,
        **stiff,
        "rows": len(rows),
        "rows_not_ok": sum(row["status"] != OK for row in rows),
        "warnings": warnings,
        "notes": notes,
    }
    if table is not None:
        summary["measured"] = table.summary
    if comm.rank == 0:
        write_case(case, folder)
        if table is not None:
            write_table(
                folder.path / MEASURED_TABLE,
                [q.column for q in BESIDE],
                [[row[q.name] for row in table.rows] for q in BESIDE],
            )
        absent = {
            "hook_load_total": block is None,
            "hook_load_reading": sensor == Sensor(),
            "ff_groups": not pairs[0].groups,
        }
        quantities = [q for q in ROADMAP if not absent.get(q.name, False)]
        write_table(
            folder.path / ROADMAP_TABLE,
            [q.column for q in quantities],
            [[row[q.name] for row in rows] for q in quantities],
        )
        write_summary(
            folder.path / ROADMAP_FILE,
            _inputs(case, well, strings, pairs, points, block)
            | {"model": model, "torque_lines": lines_of_torque},
        )
        write_summary(folder.summary, summary)
    lines = [f"{case.title or 'case'}: roadmap, {MODELS[model]}, {len(rows)} rows"]
    lines += [f"  {told(case, plan, word, system)}" for word in plan.operations]
    lines += _lines(rows, pairs, plan.operations, strings[-1].depth, system, block is not None)
    lines += measured_lines(found, system)
    lines += table.lines(system) if table is not None else []
    if stiff:
        lines += _compared(stiff, len(rows))
    lines += [f"  WARNING: {w}" for w in warnings] + [f"  note: {lengths_shown(n, system)}" for n in notes]
    return job.result(folder, summary, lines)


def _inputs(
    case: Case,
    well: Well,
    strings: list[StringRows],
    pairs: list[Pair],
    points: tuple[MeasuredPoint, ...],
    block: float | None,
) -> dict[str, Any]:
    """Contents of roadmap.json: everything that the rows come from, and what pictures draw beside them."""
    plan, rig = plan_of(case), case.rig
    loads = {}
    for operation in plan.operations:
        load = load_of(case, plan, operation)
        loads[operation] = {"wob [N]": load.wob, "tob [N m]": load.torque, "rotation [rad/s]": load.rotation}
        if load.flow:
            loads[operation]["flow_rate [m3/s]"] = load.flow
        if operation != "sliding":
            loads[operation]["axial_speed [m/s]"] = load.axial_velocity
    return {
        "operations": loads,
        "friction_factor": [_factors_told(p) for p in pairs],
        "casing_shoes [m]": shoes_of(case),
        "block_weight [N]": block,
        "max_hookload [N]": None if rig is None else rig.max_hookload,
        "max_surface_torque [N m]": None if rig is None else rig.max_surface_torque,
        "lines [m, N]": lines_of(case, well, strings),
        "measured": [
            {key: value for key, value in point.model_dump().items() if value is not None} for point in points
        ],
        "hookload_excludes_block": plan.hookload_excludes_block,
        "hole_grows": plan.hole_grows,
    }


def _factors_told(pair: Pair) -> dict[str, Any]:
    factors = {"cased": _plain(pair.cased), "open_hole": _plain(pair.open_hole)}
    return factors | ({"groups": pair.groups} if pair.groups else {})


def _plain(value: float) -> float | None:
    return None if np.isnan(value) else value


def _warnings(
    case: Case, rows: list[dict[str, Any]], torque: dict[str, list[float | None]], system: System
) -> list[str]:
    """What passes the rig's limits, and rows that are not to be trusted, one sentence a kind."""
    out = []
    rig = case.rig
    size, unit = shown_unit("bit_depth", "m", system)
    limits = (
        (
            "hook_load_total" if rig is not None and rig.block_weight is not None else "hook_load",
            "max_hookload",
            "hook load",
        ),
        ("surface_torque", "max_surface_torque", "surface torque"),
    )
    for key, limit, words in limits:
        largest = None if rig is None else getattr(rig, limit)
        beyond = [] if largest is None else [row for row in rows if row[key] > largest]
        if beyond:
            first = min(beyond, key=lambda row: row["bit_depth"])
            out.append(
                f"{words} above rig.{limit} in {len(beyond)} rows, first at MD {first['bit_depth'] / size:.0f} {unit} "
                f"({first['operation']}, {pair_text(first)})"
            )
    for words, above in passed(torque, rows):
        first = min(above, key=lambda row: row["bit_depth"])
        out.append(
            f"surface torque above {words} in {len(above)} rows, first at MD {first['bit_depth'] / size:.0f} {unit} "
            f"({first['operation']}, {pair_text(first)})"
        )
    kinds: dict[tuple[str, str], list[dict[str, Any]]] = {}
    for row in rows:
        if row["status"] != OK:
            kinds.setdefault((row["operation"], row["status"].split(":")[0]), []).append(row)
    for (operation, words), some in kinds.items():
        first = min(some, key=lambda row: row["bit_depth"])
        depth = f"MD {first['bit_depth'] / size:.0f} {unit}"
        reason = first["status"].partition(": ")[2] if words == "failed" else ""
        out.append(
            f"{operation}: {words} in {len(some)} rows, first at {depth} ({pair_text(first)})"
            + (f": {reason}" if reason else "")
        )
    return out


def deviations(soft: list[dict[str, Any]], stiff: list[dict[str, Any]]) -> dict[str, Any]:
    """Largest deviations of the soft string from the beam, over rows where both are ok and nothing buckles.

    hook_load: over the hook load of the beam; surface_torque: over its largest in the operation.
    """
    pairs = [
        (a, b)
        for a, b in zip(soft, stiff, strict=True)
        if a["status"] == b["status"] == OK and a["buckling_state"] == b["buckling_state"] == "none"
    ]
    out: dict[str, Any] = {"rows": len(pairs), "hook_load": None, "surface_torque": None}
    if not pairs:
        return out
    out["hook_load"] = max(
        abs(a["hook_load"] - b["hook_load"]) / max(abs(b["hook_load"]), 1.0) for a, b in pairs
    )
    turning = [(a, b) for a, b in pairs if a["surface_torque"]]
    largest: dict[str, float] = {}
    for _, b in turning:
        largest[b["operation"]] = max(largest.get(b["operation"], 0.0), abs(b["surface_torque"]))
    if any(largest.values()):
        out["surface_torque"] = max(
            abs(a["surface_torque"] - b["surface_torque"]) / largest[b["operation"]]
            for a, b in turning
            if largest[b["operation"]]
        )
    return out


def _compared(stiff: dict[str, Any], count: int) -> list[str]:
    """How long the beam took, and how far the soft string is from it."""
    seconds, found = stiff["stiff_seconds"], stiff["soft_against_stiff"]
    lines = [f"  {seconds:.3g} s for {count} static solutions of the beam, {seconds / count:.2g} s each"]
    if found["hook_load"] is not None:
        text = f"hook load within {100 * found['hook_load']:.2g} %"
        if found["surface_torque"] is not None:
            text += f", torque within {100 * found['surface_torque']:.2g} %"
        lines.append(f"  soft string in the {found['rows']} rows where nothing buckles: {text} of the beam")
    return lines


def pair_text(row: dict[str, Any]) -> str:
    """Friction factors of a row as text: `0.2 / 0.3`."""
    words = [_factors(row["ff_cased"], row["ff_open_hole"]), row["ff_groups"]]
    return f"friction {', '.join(filter(None, words))}"


def _factors(*values: float) -> str:
    return " / ".join(f"{v:.4g}" for v in values if not np.isnan(v))


def _lines(
    rows: list[dict[str, Any]],
    pairs: list[Pair],
    operations: tuple[str, ...],
    depth: float,
    system: System,
    total: bool,
) -> list[str]:
    """Hook load and torque at the deepest bit depth."""
    d, depth_unit = shown_unit("bit_depth", "m", system)
    key = "hook_load_total" if total else "hook_load"
    f, force = shown_unit(key, "N", system)
    m, moment = shown_unit("surface_torque", "N m", system)
    at_end = [row for row in rows if row["bit_depth"] == depth]
    heads = [_factors(pair.cased, pair.open_hole) for pair in pairs]
    shown = heads[:6]
    groups = [f"    {head}: {pair.groups}" for head, pair in zip(shown, pairs, strict=False) if pair.groups]
    lines = [
        f"  bit at MD {depth / d:.6g} {depth_unit}; friction cased / open hole:"
        + "".join(f"{h:>14}" for h in shown),
        *groups,
    ]
    for operation in operations:
        some = [row for row in at_end if row["operation"] == operation][: len(shown)]
        values = "".join(f"{_cell(row[key] / f):>14}" for row in some)
        lines.append(
            f"  {operation:<18} {'hook load' + (' with block' if total else ''):<20} {force:<8}{values}"
        )
        if any(abs(row["surface_torque"]) > 0 for row in some):
            values = "".join(f"{_cell(row['surface_torque'] / m):>14}" for row in some)
            lines.append(f"  {'':<18} {'surface torque':<20} {moment:<8}{values}")
        if any(np.isfinite(row["overpull_margin"]) for row in some):
            values = "".join(f"{_cell(row['overpull_margin'] / f):>14}" for row in some)
            lines.append(f"  {'':<18} {'margin of overpull':<20} {force:<8}{values}")
        if any(row["buckling_state"] != "none" for row in some):
            values = "".join(f"{row['buckling_state']:>14}" for row in some)
            lines.append(f"  {'':<18} {'buckling':<28} {values}")
    return lines


def _cell(value: float) -> str:
    return "-" if np.isnan(value) else f"{value:.5g}"
