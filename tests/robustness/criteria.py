"""Criteria of the robustness suite: rows of measured and allowed values, and the criteria common to all cases
(manual: sec-verif-robustness, verif-robust-common).

The criteria of a case are functions of its runs (contact.py, string.py, mud.py, drilling.py). scripts/extreme
runs the cases of cases/extreme and prints the table.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.case import load_case
from drillpetsc.fem.component import FloatArray
from drillpetsc.output import read_frame, read_series, read_summary, read_table

LARGEST_GAIN = 0.01  # largest energy gained without input, over the energy exchanged
LARGEST_REJECTED = 3.0  # largest ratio of rejected to accepted steps
LARGEST_SLOWDOWN = 1.5  # largest CPU time over that of the first passing version
SHORTEST_COMPARED_TIME = (
    5.0  # CPU times below are not compared: start-up and other load are of that order [s]
)


@dataclass(frozen=True)
class Row:
    """One criterion of one case.

    case: number of the case, such as X05.
    criterion: description.
    measured: measured value.
    allowed: allowed values in words.
    passed: whether the criterion is met.
    """

    case: str
    criterion: str
    measured: float | str
    allowed: str
    passed: bool


def at_most(case: str, criterion: str, measured: float, limit: float) -> Row:
    """Criterion: the value does not exceed a limit; nan does not pass."""
    return Row(case, criterion, float(measured), f"<= {limit:.4g}", bool(measured <= limit))


def at_least(case: str, criterion: str, measured: float, limit: float) -> Row:
    """Criterion: the value reaches a limit."""
    return Row(case, criterion, float(measured), f">= {limit:.4g}", bool(measured >= limit))


def near(case: str, criterion: str, measured: float, expected: float, share: float) -> Row:
    """Criterion: the value lies within a fraction ``share`` of the expected one."""
    return Row(
        case,
        criterion,
        float(measured),
        f"{expected:.5g} +- {100 * share:g} %",
        bool(abs(measured - expected) <= share * abs(expected)),
    )


def holds(case: str, criterion: str, measured: float | str, allowed: str, passed: bool) -> Row:
    """Criterion that has been evaluated by the caller."""
    return Row(case, criterion, measured, allowed, bool(passed))


@dataclass(frozen=True)
class Run:
    """A run folder; files are read on first use."""

    folder: Path

    @property
    def name(self) -> str:
        return self.folder.name

    @cached_property
    def case(self) -> Any:
        """The case; untyped, because a criterion uses the items and ends of its own case."""
        return load_case(self.folder / "case.yaml")

    @cached_property
    def summary(self) -> dict[str, Any]:
        return read_summary(self.folder / "summary.json")

    @cached_property
    def history(self) -> dict[str, FloatArray]:
        return _named(read_table(self.folder / "history.csv"))

    @cached_property
    def probes(self) -> dict[str, FloatArray]:
        path = self.folder / "probes.csv"
        return _named(read_table(path)) if path.is_file() else {}

    @cached_property
    def statics(self) -> dict[str, FloatArray]:
        return _named(read_table(self.folder / "statics.csv"))

    @cached_property
    def frames(self) -> tuple[FloatArray, dict[str, FloatArray]]:
        """Times (f,) [s] of the frames, and their point data (f, n, ...) by name without unit; ``point`` has the
        positions."""
        series = read_series(self.folder)
        read = [read_frame(path) for _, path in series]
        data = {
            name.split(" [")[0]: np.array([f.point_data[name] for f in read])
            for name in (read[0].point_data if read else ())
        }
        return np.array([t for t, _ in series]), data | {"point": np.array([f.points for f in read])}

    def after(self, t: float, column: str) -> FloatArray:
        """A column of the history from a time on."""
        return self.history[column][self.history["time"] >= t]

    @cached_property
    def penetration(self) -> FloatArray:
        """Penetration (f, n) of the wall by the nodes at the frames [m], negative for a free node; empty without
        a hole."""
        _, data = self.frames
        if "hole_radius" not in data:
            return np.zeros((0, 0))
        clearance = np.maximum(data["hole_radius"] - data["outer_radius"], 0.0)
        return np.hypot(data["offset_x"], data["offset_y"]) - clearance


def _named(table: dict[str, Any]) -> dict[str, FloatArray]:
    return {title.split(" [")[0]: values for title, values in table.items()}


Runs = Mapping[str, Run]
Check = Callable[[Runs], list[Row]]


# ---------------------------------------------------------------------- criteria of all cases
def finite(run: Run) -> bool:
    """Whether all output of a run is finite."""
    tables = [*run.history.values(), *run.probes.values()]
    _, data = run.frames
    return all(np.isfinite(values).all() for values in (*tables, *data.values()))


def allowed_penetration(run: Run) -> float:
    """Largest allowed lateral penetration of a node [m].

    It is the largest of 1 mm, 5 % of the clearance, and three times the penetration of the static start. Nodes
    lie between contact points: in a curve the pipe is straighter there than the hole.
    """
    _, data = run.frames
    clearance = data["hole_radius"] - data["outer_radius"]
    inside = clearance[clearance > 0]
    static = float(run.penetration[0].max()) if run.case.initial.from_ == "statics" else 0.0
    return max(1e-3, 0.05 * float(inside.min()) if inside.size else 0.0, 3 * static)


def common(case: str, run: Run, *, penetration: bool = True, gain: bool = True) -> list[Row]:
    """Common criteria of a run: done, finite, small penetration, no energy gain, few rejected steps.

    The default beam has no constraint that could drift (its tangent is a free vector, its spin an angle), so
    there is no criterion for drift.
    """
    summary = run.summary
    if summary["status"] != "done":
        return [holds(case, f"{run.name}: done", str(summary["status"]).split("\n")[0], "done", False)]
    rows = [holds(case, f"{run.name}: finite", "yes" if finite(run) else "no", "yes", finite(run))]
    if penetration and run.penetration.size and run.case.contact is not None:
        rows.append(
            at_most(
                case,
                f"{run.name}: penetration at the frames [m]",
                float(run.penetration.max()),
                allowed_penetration(run),
            )
        )
    if gain and "energy" in summary:
        rows.append(
            at_most(
                case,
                f"{run.name}: energy gained / exchanged",
                summary["energy"]["gained_share"],
                LARGEST_GAIN,
            )
        )
    rows.append(
        at_most(
            case,
            f"{run.name}: rejected / accepted steps",
            summary["rejected_steps"] / max(summary["steps"], 1),
            LARGEST_REJECTED,
        )
    )
    return rows


def in_time(case: str, run: Run, budget: float | None) -> list[Row]:
    """CPU time compared with that of the first passing version.

    budget: CPU time of the first passing version [s]; None if not known.
    """
    cpu = float(run.summary.get("cpu_seconds", np.nan))
    if budget is None:
        return [holds(case, f"{run.name}: CPU time [s]", cpu, "first passing version", True)]
    return [
        at_most(
            case, f"{run.name}: CPU time [s]", cpu, LARGEST_SLOWDOWN * max(budget, SHORTEST_COMPARED_TIME)
        )
    ]
