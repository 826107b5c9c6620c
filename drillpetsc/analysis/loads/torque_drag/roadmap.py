"""The `roadmap` command: hook load and torque against bit depth for operations and friction factors."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from petsc4py import PETSc

from drillpetsc.analysis.loads.torque_drag.batch import Batch, Columns, Hole, soft_strings
from drillpetsc.analysis.loads.torque_drag.circulation import Circulation, circulation
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
from drillpetsc.analysis.loads.torque_drag.readings.measured_table import BesidePoints, beside_points
from drillpetsc.analysis.loads.torque_drag.readings.reading import corrected_points
from drillpetsc.analysis.loads.torque_drag.readings.sensor import DIRECTION, Sensor, sensor_of
from drillpetsc.analysis.loads.torque_drag.string_rows import (
    StringRows,
    bends_left_out,
    cutters_left_out,
    gravity_of,
    mud_in_bore,
    need_well,
    partly_filled,
)
from drillpetsc.analysis.loads.torque_drag.table import (
    OK,
    Pressures,
    failed,
    passed,
    rows_of,
    still_mud,
    torque_lines,
)
from drillpetsc.analysis.motion.run_options import options_of
from drillpetsc.case.blocks.roadmap import MeasuredPoint, Roadmap
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.geometry.well import Well
from drillpetsc.output import write_summary
from drillpetsc.output.files.run_folder import MEASURED_TABLE, ROADMAP_FILE, ROADMAP_TABLE
from drillpetsc.output.job import Job, RunResult
from drillpetsc.output.shown_units import shown_unit
from drillpetsc.unit_systems import System, plain

#: models of the string by the word of `--model`
MODELS = {"soft": "soft string", "stiff": "beam in static equilibrium"}


def columns_of(loads: list[Load], placed: list[int], pairs: list[Pair]) -> Columns:
    """Columns of soft strings from lists of the same length."""
    return Columns(
        np.array(placed, dtype=int),
        np.array([pair.friction for pair in pairs]),
        np.array([load.wob for load in loads]),
        np.array([load.torque for load in loads]),
        np.array([load.axial_velocity for load in loads]),
        np.array([load.rotation for load in loads]),
        np.array([pair.item_factor for pair in pairs]),
    )


def densities_of(case: Case) -> tuple[float, float]:
    """Density of the mud in and around the string [kg/m3], 0 where there is none."""
    density = 0.0 if case.fluid is None else case.fluid.density
    filled = case.has_bore or partly_filled(case)
    return (density if filled else 0.0, density if case.has_annulus else 0.0)


@dataclass(frozen=True)
class RowsAsked:
    """What the rows of a roadmap are computed for: each operation with each pair of friction factors at each bit depth.

    notes: assumptions of the rows, as sentences.
    """

    case: Case
    well: Well
    pairs: list[Pair]
    strings: list[StringRows]
    notes: list[str]

    @property
    def plan(self) -> Roadmap:
        """The case's roadmap, or one with all defaults."""
        return plan_of(self.case)

    @property
    def block_weight(self) -> float | None:
        """Weight of the travelling block [N], None if it is not given."""
        return None if self.case.rig is None else self.case.rig.block_weight

    def keys(self) -> list[tuple[str, int, int]]:
        """(operation, pair, depth) of each row."""
        pairs, depths = range(len(self.pairs)), range(len(self.strings))
        return [(o, p, d) for o in self.plan.operations for p in pairs for d in depths]

    def loads(self) -> dict[str, Load]:
        """Loads of the operations."""
        return {o: load_of(self.case, self.plan, o) for o in self.plan.operations}

    def named(self, rows: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
        """The rows, each with what names it before its numbers."""
        return [
            head_of(o, self.pairs[p], self.strings[d]) | row
            for (o, p, d), row in zip(self.keys(), rows, strict=True)
        ]


def rows_asked(case: Case, model: str) -> RowsAsked:
    """Rows of the case's roadmap; raises CaseError without a well or gravity, and for more than ``MOST_ROWS`` rows."""
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
    return RowsAsked(case, well, pairs, strings, notes)


@dataclass(frozen=True)
class SoftProblem:
    """Soft strings of all rows, ready to be integrated.

    mud: pressures in and around the strings; found: of each row the forces of the flow, the error where there is no steady
    flow, None where the mud stands still.
    """

    asked: RowsAsked
    hole: Hole
    columns: Columns
    mud: Pressures
    found: list[Circulation | SolveError | None]

    def rows(self, batch: Batch) -> list[dict[str, Any]]:
        """Rows [SI] of solved strings: by operation, pair and bit depth."""
        asked = self.asked
        rows = rows_of(self.hole, self.columns, batch, self.mud, asked.block_weight or 0.0)
        for row, flow, (_, _, d) in zip(rows, self.found, asked.keys(), strict=True):
            if asked.strings[d].misfit:
                row |= failed(asked.strings[d].misfit)
            elif isinstance(flow, SolveError):
                row |= failed(f"the flow: {flow}")
        return asked.named(rows)


def soft_problem(
    asked: RowsAsked, flows: Mapping[tuple[str, int], Circulation | SolveError], like: Hole | None = None
) -> SoftProblem:
    """Soft strings of the rows of a roadmap, with the ``flows`` of ``circulations``; like: as for ``Hole``."""
    case, pairs, strings, keys, loads = asked.case, asked.pairs, asked.strings, asked.keys(), asked.loads()
    columns = columns_of(
        [loads[o] for o, _, _ in keys], [d for _, _, d in keys], [pairs[p] for _, p, _ in keys]
    )
    hole = Hole(asked.well, strings, like=like)
    bores = [mud_in_bore(case, strings[d].depth) for _, _, d in keys]
    mud = still_mud(hole, bores, densities_of(case), gravity_of(case, "roadmap"))
    found = [flows.get((o, d)) for o, _, d in keys]
    if flows:
        columns, mud = _with_flow(hole, columns, mud, found)
    return SoftProblem(asked, hole, columns, mud, found)


def soft_rows(asked: RowsAsked) -> list[dict[str, Any]]:
    """Rows of a roadmap [SI] with the soft string: by operation, pair and bit depth."""
    problem = soft_problem(asked, circulations(asked.case, asked.strings, asked.loads()))
    return problem.rows(soft_strings(problem.hole, problem.columns))


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
    lift, thrust = [np.zeros(len(hole.h))] * len(found), np.zeros(len(found))
    for c, flow in enumerate(found):
        if isinstance(flow, Circulation):
            lift[c], thrust[c] = flow.lift(hole.edges), flow.thrust
            mud.inside[:, c] = np.interp(hole.edges, flow.md, flow.inside)
            mud.outside[:, c] = np.interp(hole.edges, flow.md, flow.outside)
            mud.momentum[:, c] = np.interp(hole.edges, flow.md, flow.momentum)
    return replace(columns, lift=lift, thrust=thrust), mud


def stiff_rows(asked: RowsAsked, comm: PETSc.Comm) -> list[dict[str, Any]]:
    """Rows of a roadmap [SI] with the beam, in the order of `soft_rows`; collective."""
    from drillpetsc.analysis.loads.torque_drag import stiff

    case, strings, loads = asked.case, asked.strings, asked.loads()
    stiff.need_beam(case)
    flows = circulations(case, strings, loads)
    block, densities = asked.block_weight or 0.0, densities_of(case)
    jobs = [
        stiff.Job(strings[d], asked.pairs[p], loads[o], block, densities, flows.get((o, d)))
        for o, p, d in asked.keys()
    ]
    return asked.named(stiff.solve_jobs(case, asked.well, jobs, comm))


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

    measured: points to be plotted; None: the case's.
    model: soft, the soft string, every rank computes the same; stiff, the static equilibrium of the beam, whose rows the
    ranks share out.  The first rank writes.
    """
    case, system = job.case, job.case.shown_units
    asked = rows_asked(case, model)
    rows, stiff = _solved(asked, model, job.comm)
    sensor = sensor_of(case)
    add_readings(asked, sensor, rows)
    plan = asked.plan
    read = (plan.measured if measured is None else measured) or ()
    points = corrected_points(case, read, plan.hookload_excludes_block)
    lines_of_torque = torque_lines(case, asked.strings, rows)
    warnings = _warnings(case, rows, lines_of_torque, system)
    block = 0.0 if plan.hookload_excludes_block else (asked.block_weight or 0.0)
    found = beside_curves(rows, points, block)
    end = None if case.well is None else float(case.well.survey.md[-1])
    warnings += measured_warnings(
        found, points, end, asked.block_weight, plan.hookload_excludes_block, system
    )
    table = _beside(asked, read, points, warnings)
    folder = job.make_folder()
    summary = {
        "title": case.title,
        "units": system,
        "model": model,
        **stiff,
        "rows": len(rows),
        "rows_not_ok": sum(row["status"] != OK for row in rows),
        "warnings": warnings,
        "notes": asked.notes,
    }
    if table is not None:
        summary["measured"] = table.summary
    absent = () if asked.pairs[0].groups else ("ff_groups",)
    tables = {ROADMAP_TABLE: [{k: v for k, v in row.items() if k not in absent} for row in rows]}
    tables |= {} if table is None else {MEASURED_TABLE: table.rows}
    if job.comm.rank == 0:
        write_summary(
            folder.path / ROADMAP_FILE,
            _inputs(asked, points) | {"model": model, "torque_lines": lines_of_torque},
        )
    lines = [f"{case.title or 'case'}: roadmap, {MODELS[model]}, {len(rows)} rows"]
    lines += [f"  {told(case, plan, word, system)}" for word in plan.operations]
    lines += _lines(asked, rows, system)
    lines += measured_lines(found, system)
    lines += table.lines(system) if table is not None else []
    lines += _compared(stiff, len(rows)) if stiff else []
    return job.result(folder, summary, lines, tables)


def _solved(asked: RowsAsked, model: str, comm: PETSc.Comm) -> tuple[list[dict[str, Any]], dict[str, Any]]:
    """Rows of the roadmap, and what the beam's are compared by; empty with the soft string (collective)."""
    with options_of(asked.case):
        soft = soft_rows(asked)
        if model == "soft":
            return soft, {}
        start = time.perf_counter()
        rows = stiff_rows(asked, comm)
    stiff = {"stiff_seconds": time.perf_counter() - start, "soft_against_stiff": deviations(soft, rows)}
    asked.notes.append(
        "torque on bit is added to the torque of the string; its effect on bending is left out"
    )
    return rows, stiff


def add_readings(asked: RowsAsked, sensor: Sensor, rows: list[dict[str, Any]]) -> None:
    """Add the hook load with the block, and the reading of a sensor that is not ideal, to each row [N]."""
    for row in rows:
        if asked.block_weight is not None:
            row["hook_load_total"] = row["hook_load"] + asked.block_weight
        if sensor != Sensor():
            total = row.get("hook_load_total", row["hook_load"])
            row["hook_load_reading"] = total / sensor.factor(DIRECTION[row["operation"]])


def _beside(
    asked: RowsAsked, read: Sequence[MeasuredPoint], points: Sequence[MeasuredPoint], warnings: list[str]
) -> BesidePoints | None:
    """Measured points beside computed ones, None without points; a warning is added if they cannot be computed.

    read, points: as in ``beside_points``.
    """
    if not points:
        return None
    try:
        with options_of(asked.case):
            return beside_points(asked.case, read, points, asked.pairs, asked.plan.hookload_excludes_block)
    except (CaseError, SolveError) as error:  # the curves stand without it
        reason = " ".join(str(error).split())
        warnings.append(f"{MEASURED_TABLE} is left out, the points cannot be computed: {reason}")
        return None


def _inputs(asked: RowsAsked, points: tuple[MeasuredPoint, ...]) -> dict[str, Any]:
    """Contents of roadmap.json: everything that the rows come from, and what pictures draw beside them."""
    plan, rig = asked.plan, asked.case.rig
    loads = {}
    for operation, load in asked.loads().items():
        loads[operation] = {"wob [N]": load.wob, "tob [N m]": load.torque, "rotation [rad/s]": load.rotation}
        if load.flow:
            loads[operation]["flow_rate [m3/s]"] = load.flow
        if operation != "sliding":
            loads[operation]["axial_speed [m/s]"] = load.axial_velocity
    return {
        "operations": loads,
        "friction_factor": [
            {"cased": p.cased, "open_hole": p.open_hole, **({"groups": p.groups} if p.groups else {})}
            for p in asked.pairs
        ],
        "casing_shoes [m]": shoes_of(asked.case),
        "block_weight [N]": asked.block_weight,
        "max_hookload [N]": None if rig is None else rig.max_hookload,
        "max_surface_torque [N m]": None if rig is None else rig.max_surface_torque,
        "lines [m, N]": lines_of(asked.case, asked.well, asked.strings),
        "measured": [
            {key: value for key, value in point.model_dump().items() if value is not None} for point in points
        ],
        "hookload_excludes_block": plan.hookload_excludes_block,
        "hole_grows": plan.hole_grows,
    }


def _warnings(
    case: Case, rows: list[dict[str, Any]], torque: dict[str, list[float | None]], system: System
) -> list[str]:
    """What passes the rig's limits, and rows that are not to be trusted, one sentence a kind."""
    size, unit = shown_unit("bit_depth", "m", system)

    def where(some: Sequence[dict[str, Any]]) -> tuple[str, dict[str, Any]]:
        first = min(some, key=lambda row: row["bit_depth"])
        return f"in {len(some)} rows, first at MD {first['bit_depth'] / size:.0f} {unit}", first

    rig, beyond = case.rig, []
    if rig is not None:
        key = "hook_load" if rig.block_weight is None else "hook_load_total"
        for name, limit in ((key, "max_hookload"), ("surface_torque", "max_surface_torque")):
            largest, words = getattr(rig, limit), name.removesuffix("_total").replace("_", " ")
            if largest is not None:
                beyond.append((f"{words} above rig.{limit}", [row for row in rows if row[name] > largest]))
    beyond += [(f"surface torque above {words}", above) for words, above in passed(torque, rows)]
    out = []
    for words, above in beyond:
        if above:
            place, first = where(above)
            out.append(f"{words} {place} ({first['operation']}, {pair_text(first)})")
    kinds: dict[tuple[str, str], list[dict[str, Any]]] = {}
    for row in rows:
        if row["status"] != OK:
            kinds.setdefault((row["operation"], row["status"].split(":")[0]), []).append(row)
    for (operation, words), some in kinds.items():
        place, first = where(some)
        reason = first["status"].partition(": ")[2] if words == "failed" else ""
        out.append(f"{operation}: {words} {place} ({pair_text(first)})" + (f": {reason}" if reason else ""))
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
        text = f"hook load within {plain(100 * found['hook_load'], 2)} %"
        if found["surface_torque"] is not None:
            text += f", torque within {plain(100 * found['surface_torque'], 2)} %"
        lines.append(f"  soft string in the {found['rows']} rows where nothing buckles: {text} of the beam")
    return lines


def pair_text(row: dict[str, Any]) -> str:
    """Friction factors of a row as text: `0.2 / 0.3`."""
    words = [_factors(row["ff_cased"], row["ff_open_hole"]), row["ff_groups"]]
    return f"friction {', '.join(filter(None, words))}"


def _factors(*values: float) -> str:
    return " / ".join(f"{v:.4g}" for v in values if not np.isnan(v))


def _lines(asked: RowsAsked, rows: list[dict[str, Any]], system: System) -> list[str]:
    """Hook load and torque at the deepest bit depth."""
    pairs, depth, total = asked.pairs, asked.strings[-1].depth, asked.block_weight is not None
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
    for operation in asked.plan.operations:
        some = [row for row in at_end if row["operation"] == operation][: len(shown)]
        turning = any(abs(row["surface_torque"]) > 0 for row in some)
        for head, name, words, size, unit, there in (
            (operation, key, "hook load" + (" with block" if total else ""), f, force, True),
            ("", "surface_torque", "surface torque", m, moment, turning),
            ("", "overpull_margin", "margin of overpull", f, force, None),
        ):
            if there if there is not None else any(np.isfinite(row[name]) for row in some):
                values = "".join(f"{_cell(row[name] / size):>14}" for row in some)
                lines.append(f"  {head:<18} {words:<20} {unit:<8}{values}")
        if any(row["buckling_state"] != "none" for row in some):
            values = "".join(f"{row['buckling_state']:>14}" for row in some)
            lines.append(f"  {'':<18} {'buckling':<28} {values}")
    return lines


def _cell(value: float) -> str:
    return "-" if np.isnan(value) else f"{value:.5g}"
