"""What runs of extreme scenes must show: rows of criteria, measured on run folders; the criteria that all
scenes share.

The criteria of a scene are functions of its runs (extreme_contact, extreme_string, extreme_mud,
extreme_drilling); scripts/extreme runs the cases of cases/extreme and prints the table.
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

GAIN = 0.01  # largest energy gained without input, over the energy exchanged
REJECTED = 3.0  # largest ratio of rejected to accepted steps
SLOWER = 1.5  # largest time over that of the first passing version
SHORT = (
    5.0  # [s] below which times of a run are not compared: starts and other people's load are of that order
)


@dataclass(frozen=True)
class Row:
    """One criterion of one scene: what it is, the figure measured, what is allowed in words, whether it is
    met."""

    model: str
    criterion: str
    measured: float | str
    allowed: str
    passed: bool


def at_most(model: str, criterion: str, measured: float, limit: float) -> Row:
    """A figure that must not exceed a limit; not-a-number does not pass."""
    return Row(model, criterion, float(measured), f"<= {limit:.4g}", bool(measured <= limit))


def at_least(model: str, criterion: str, measured: float, limit: float) -> Row:
    """A figure that must reach a limit."""
    return Row(model, criterion, float(measured), f">= {limit:.4g}", bool(measured >= limit))


def near(model: str, criterion: str, measured: float, expected: float, share: float) -> Row:
    """A figure within a share of what is expected."""
    return Row(
        model,
        criterion,
        float(measured),
        f"{expected:.5g} +- {100 * share:g} %",
        bool(abs(measured - expected) <= share * abs(expected)),
    )


def holds(model: str, criterion: str, measured: float | str, allowed: str, passed: bool) -> Row:
    """Anything else."""
    return Row(model, criterion, measured, allowed, bool(passed))


@dataclass(frozen=True)
class Run:
    """A run folder, read as it is asked for."""

    folder: Path

    @property
    def name(self) -> str:
        return self.folder.name

    @cached_property
    def case(self) -> Any:
        """The Case; a criterion knows which kinds of items and ends its own case has."""
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
        """Times (f,) [s] of the frames, and their point data (f, n, ...) by name without unit; ``point`` is
        the place."""
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
        """(f, n) depth of the nodes in the wall at the frames [m], negative where there is room; empty
        without a hole."""
        _, data = self.frames
        if "hole_radius" not in data:
            return np.zeros((0, 0))
        component = np.maximum(data["hole_radius"] - data["outer_radius"], 0.0)
        return np.hypot(data["offset_x"], data["offset_y"]) - component


def _named(table: dict[str, Any]) -> dict[str, FloatArray]:
    return {title.split(" [")[0]: values for title, values in table.items()}


Runs = Mapping[str, Run]
Check = Callable[[Runs], list[Row]]


# ---------------------------------------------------------------------- what all scenes share
def finite(run: Run) -> bool:
    """Whether all that a run has written is numbers."""
    tables = [*run.history.values(), *run.probes.values()]
    _, data = run.frames
    return all(np.isfinite(values).all() for values in (*tables, *data.values()))


def allowed_penetration(run: Run) -> float:
    """Largest lateral penetration of a node [m]: the largest of 1 mm, 5 % of the clearance, and three times
    that of the static start (nodes lie between the points of contact: in a curve the pipe is straighter there
    than the hole)."""
    _, data = run.frames
    component = data["hole_radius"] - data["outer_radius"]
    inside = component[component > 0]
    static = float(run.penetration[0].max()) if run.case.initial.from_ == "statics" else 0.0
    return max(1e-3, 0.05 * float(inside.min()) if inside.size else 0.0, 3 * static)


def common(model: str, run: Run, *, penetration: bool = True, gain: bool = True) -> list[Row]:
    """Criteria C of a run: it is done, its numbers are finite, nothing sinks into the wall, no energy is
    gained, few steps are rejected.

    The default beam has no constraint that could drift (its tangent is a free vector, its spin an angle), so
    there is no row for it.
    """
    reported = run.summary
    if reported["status"] != "done":
        return [holds(model, f"{run.name}: done", str(reported["status"]).split("\n")[0], "done", False)]
    rows = [holds(model, f"{run.name}: finite", "yes" if finite(run) else "no", "yes", finite(run))]
    if penetration and run.penetration.size and run.case.contact is not None:
        rows.append(
            at_most(
                model,
                f"{run.name}: penetration at the frames [m]",
                float(run.penetration.max()),
                allowed_penetration(run),
            )
        )
    if gain and "energy" in reported:
        rows.append(
            at_most(model, f"{run.name}: energy gained / exchanged", reported["energy"]["gained_share"], GAIN)
        )
    rows.append(
        at_most(
            model,
            f"{run.name}: rejected / accepted steps",
            reported["rejected_steps"] / max(reported["steps"], 1),
            REJECTED,
        )
    )
    return rows


def in_time(model: str, run: Run, budget: float | None) -> list[Row]:
    """CPU seconds against the first passing version's (wall seconds of a core that the run has for
    itself)."""
    cpu = float(run.summary.get("cpu_seconds", np.nan))
    if budget is None:
        return [holds(model, f"{run.name}: CPU time [s]", cpu, "first passing version", True)]
    return [at_most(model, f"{run.name}: CPU time [s]", cpu, SLOWER * max(budget, SHORT))]
