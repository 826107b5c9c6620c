"""Report of a study: table, findings and files."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.output import write_rows, write_summary
from drillpetsc.output.catalogue import find
from drillpetsc.output.files.json_file import plain
from drillpetsc.studies.convergence.error_norms import (
    NORMS,
    cost_of,
    errors_of,
    extent,
    moves,
    observed_order,
)
from drillpetsc.studies.convergence.reference import Reference
from drillpetsc.studies.convergence.runs import Measured

Row = dict[str, Any]

MOST_OUTPUTS = 6  # outputs compared by default
LAST = 1000  # rank of outputs without an interest
DIVERGED = 10.0  # rms error over range above which a completed run counts as failed
PLATEAU_RATIO = 1.5  # errors within this ratio count as equal, steps beyond it as different
TARGET_ERRORS = (0.1, 0.01, 0.001)  # errors whose cost is reported
COLUMNS = (
    ("curve", "-"),
    ("point", "-"),
    ("value", "-"),
    ("ranks", "-"),
    ("status", "-"),
    ("step", "s"),
    ("elements", "-"),
    ("steps", "-"),
    ("rejected_steps", "-"),
    ("newton_iterations", "-"),
    ("linear_iterations", "-"),
    ("jacobians", "-"),
    ("residuals", "-"),
    ("wall", "s"),
    ("wall_spread", "s"),
    ("cpu", "s"),
    ("cpu_spread", "s"),
    ("energy_error", "-"),
)


def chosen_outputs(reference: Reference, outputs: Sequence[str]) -> list[str]:
    """Outputs to compare: the given ones, or up to MOST_OUTPUTS that change with time."""
    if outputs:
        return [name for name in outputs if extent(reference.values[name]) > 0]
    moving = [
        name
        for name, v in reference.values.items()
        if not _about_numerics(name) and np.isfinite(v).all() and moves(v)
    ]
    return sorted(moving, key=_rank)[:MOST_OUTPUTS]


def _about_numerics(name: str) -> bool:
    """Whether an output describes the computation, not the string."""
    quantity = find(name)
    return quantity is not None and quantity.numerics


def _rank(name: str) -> int:
    """Rank of an output: by interest, then offsets at probes, others, and contact forces at probes."""
    quantity = find(name)
    if quantity is None:
        return LAST
    if quantity.interest:
        return quantity.interest
    return (
        LAST - 1
        if quantity.unit == "m" and quantity.on == "probe"
        else LAST + (quantity.name == "contact_NNN")
    )


def table_rows(
    measured: Sequence[Measured],
    found: Mapping[int, Mapping[str, np.ndarray]],
    reference: Reference | None,
    outputs: Sequence[str] = (),
) -> list[Row]:
    """One row per point: description, cost, and `error_<output>_<norm>` of each output (NaN if unknown).

    found: number of the point -> outputs name -> (k,) [SI].
    """
    names = chosen_outputs(reference, outputs) if reference is not None else []
    rows = []
    for k, m in enumerate(measured):
        row: Row = {
            "curve": m.point.curve,
            "point": m.point.label,
            "value": m.point.value,
            "ranks": m.point.ranks,
            "status": m.status,
            "step": m.step,
            **{name: m.counts.get(name) for name, _ in COLUMNS[6:13]},
            "wall": m.median("wall"),
            "wall_spread": m.spread("wall"),
            "cpu": m.median("cpu"),
            "cpu_spread": m.spread("cpu"),
            "energy_error": m.energy_error,
            "message": m.message,
        }
        for name in names:
            assert reference is not None
            values = found.get(k, {}).get(name)
            errors = dict.fromkeys(NORMS, math.nan)
            if values is not None and len(values) == len(reference.values[name]):
                if np.isfinite(values).all():
                    errors = errors_of(values, reference.values[name])
                else:
                    row.update(status="failed", message=f"{name} is not a number")
            if errors["rms"] > DIVERGED:
                row.update(
                    status="failed",
                    message=f"diverged: {name} is off by {errors['rms']:.2g} times its range",
                )
            row |= {f"error_{name}_{norm}": errors[norm] for norm in NORMS}
        rows.append(row)
    return rows


def findings(
    vary: str,
    measured: Sequence[Measured],
    rows: Sequence[Row],
    reference: Reference | None,
    units: Mapping[str, str],
    length: float,
) -> dict[str, Any]:
    """Findings of a study, for study.json: outputs and ranges, reference, orders, costs of given errors, points.

    units: output -> unit. length: length of the string [m].
    """
    names = (
        [key[6:-4] for key in rows[0] if key.startswith("error_") and key.endswith("_rms")] if rows else []
    )
    curves = list(dict.fromkeys(row["curve"] for row in rows))
    orders: dict[str, Any] = {}
    costs: dict[str, Any] = {}
    for curve in curves:
        done = [row for row in rows if row["curve"] == curve and row["status"] == "done"]
        steps = np.array([abscissa(vary, row, length) for row in done], dtype=float)
        cpu = np.array([row["cpu"] for row in done], dtype=float)
        orders[curve], costs[curve] = {}, {}
        for name in names:
            floor = _floor(reference, rows, name, vary, length)
            by_norm = {
                norm: np.array([row[f"error_{name}_{norm}"] for row in done], dtype=float) for norm in NORMS
            }
            orders[curve][name] = {
                norm: None if (o := observed_order(steps, e, floor)) is None else asdict(o)
                for norm, e in by_norm.items()
            }
            if vary != "ranks":
                found = {
                    f"{target:g}": cost_of(target, by_norm["rms"], cpu)
                    for target in TARGET_ERRORS
                    if target > floor
                }
                costs[curve][name] = {key: asdict(c) for key, c in found.items() if c is not None}
    about = None
    if reference is not None:
        about = {
            "what": reference.description,
            "closed_form": reference.exact,
            "own_error": {n: reference.errors.get(n) for n in names},
            "mesh_order": {n: reference.orders[n] for n in names if n in reference.orders},
            "refused": list(reference.refused),
        }
    return {
        "outputs": {n: {"unit": units.get(n, ""), "range": extent(reference.values[n])} for n in names}
        if reference
        else {},
        "norms": "errors as shares of the output's range in the reference: max over the rows, rms over the rows, end = last row, "
        "mean = of the mean over the rows",
        "abscissa": "element length [m]" if vary == "mesh" else "mean step [s]",
        "reference": about,
        "orders": orders,
        "cpu_seconds_at_rms_error": costs,
        "speed_up": _speed_up(rows) if vary == "ranks" else {},
        "points": [_point_as_dict(row, m, vary, length) for row, m in zip(rows, measured, strict=True)],
    }


def _point_as_dict(row: Row, m: Measured, vary: str, length: float) -> dict[str, Any]:
    options = {"petsc": dict(m.point.petsc), "changes": list(m.point.changes)}
    return {
        **row,
        "abscissa": abscissa(vary, row, length),
        "walls": list(m.wall),
        "cpus": list(m.cpu),
        **options,
    }


def abscissa(vary: str, row: Row, length: float) -> float:
    """Mean step [s], or mean element length [m] if the mesh varies."""
    return length / row["elements"] if vary == "mesh" and row["elements"] else row["step"]


def _floor(reference: Reference | None, rows: Sequence[Row], name: str, vary: str, length: float) -> float:
    """Error below which the points show no order: the error of the reference.

    With a closed form it is the common error of points with clearly different steps (or elements), caused by
    the mesh (or by time integration); 0 if there is no such level.
    """
    if reference is None:
        return 0.0
    if not reference.exact:
        return reference.floor(name)
    done = [row for row in rows if row["status"] == "done" and row[f"error_{name}_rms"] > 0]
    errors = [(row[f"error_{name}_rms"], abscissa(vary, row, length)) for row in done]
    lowest = min((e for e, _ in errors), default=0.0)
    steps = [h for e, h in errors if e < PLATEAU_RATIO * lowest]
    return lowest if steps and max(steps) > PLATEAU_RATIO * min(steps) else 0.0


def _speed_up(rows: Sequence[Row]) -> dict[str, float]:
    """Number of ranks -> wall time on one rank over wall time on this number."""
    one = next((row["wall"] for row in rows if row["ranks"] == 1 and row["status"] == "done"), None)
    return {str(row["ranks"]): one / row["wall"] for row in rows if row["status"] == "done"} if one else {}


def write_results(folder: Path, rows: Sequence[Row], content: Mapping[str, Any]) -> list[Path]:
    """Write study.csv, study.json and the pictures; returns the files."""
    from drillpetsc.plotting.command.work_precision import draw_study

    errors = [key for key in (rows[0] if rows else {}) if key.startswith("error_")]
    columns = [*COLUMNS, *((key, "-") for key in errors), ("message", "-")]
    files = [write_rows(folder / "study.csv", columns, rows), write_summary(folder / "study.json", content)]
    return files + draw_study(plain(content), folder)
