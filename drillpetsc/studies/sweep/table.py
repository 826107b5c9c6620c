"""Table of a sweep: one row per member, rewritten when a member ends, and the files from which it is built.

Ranks that compute different members share these files only. A claim file marks a member as taken, an outcome
file marks it as ended.
"""

from __future__ import annotations

import fcntl
import json
import os
import time as clock
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from enum import Enum
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from drillpetsc.case import Case
from drillpetsc.case.schema import unit_of
from drillpetsc.output import RunFolder, read_summary, read_table, write_summary
from drillpetsc.output.catalogue import find
from drillpetsc.output.files.atomic import replace_text
from drillpetsc.output.files.tables import csv_text, split_name
from drillpetsc.units import is_number


class Action(Enum):
    """Action for the run folder of a member."""

    NEW = "new"  # run into a new folder
    AGAIN = "again"  # run from the beginning, replacing the results in the folder
    CONTINUE = "continue"  # continue from the checkpoint
    KEEP = "keep"  # keep the results: the member is done


@dataclass(frozen=True)
class Member:
    """One run of a sweep or batch.

    number: from 1.
    name: name of the run folder.
    values: column -> word; what distinguishes this member from the others.
    case: the case to run.
    elements: number of elements of its mesh.
    numbers: column -> value in SI, for the values that are numbers.
    """

    number: int
    name: str
    values: dict[str, str]
    case: Case
    elements: int
    numbers: dict[str, float] = field(default_factory=dict)

    @property
    def cost(self) -> float:
        """Expected cost in elements times simulated seconds; the cost of a step is proportional to the number
        of elements."""
        assert self.case.time is not None
        return self.elements * float(self.case.time.end)

    @property
    def label(self) -> str:
        return ", ".join(f"{key}={word}" for key, word in self.values.items())


@dataclass(frozen=True)
class MemberFolder:
    """The run folder of a member, and the action for it."""

    folder: Path
    action: Action


@dataclass(frozen=True)
class Outcome:
    """How a member ended.

    number: number of the member.
    status: done or failed.
    message: reason of a failure.
    ranks: ranks (of the job) that computed the member; empty if an earlier job did.
    wall: wall time [s].
    results: title with unit -> value, from the run folder.
    """

    number: int
    status: str
    message: str = ""
    ranks: tuple[int, ...] = ()
    wall: float = 0.0
    results: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Plan:
    """A sweep or batch that is about to run.

    title: title of the sweep.
    table: file name of the table.
    folder: folder of the table and the summary; None for no table and no summary.
    state: folder of claims and outcomes.
    members: the members in the order of their numbers.
    folders: the run folder of each member.
    read: outcomes that this rank has read, by number of the member.
    """

    title: str
    table: str
    folder: Path | None
    state: Path
    members: tuple[Member, ...]
    folders: tuple[MemberFolder, ...]
    read: dict[int, Outcome] = field(default_factory=dict, compare=False)

    def folder_of(self, member: Member) -> MemberFolder:
        return self.folders[member.number - 1]


@dataclass
class Pace:
    """When the table is written again: it is as long as the sweep, so that many short members would spend more
    time on it than on their runs.

    again: reading of the clock from which on it may be written [s].
    """

    share: ClassVar[float] = 0.1  # of the time that goes into the table, at most
    again: float = 0.0

    def write(self, plan: Plan, job: dict[str, Any]) -> None:
        """Write the table, unless it was written shortly before."""
        began = clock.perf_counter()
        if began < self.again:
            return
        write(plan, job)
        ended = clock.perf_counter()
        self.again = ended + (ended - began) * (1 / self.share - 1)


# ---------------------------------------------------------------------- claims and outcomes
def claim(plan: Plan, member: Member) -> bool:
    """Claim a member; False if another worker group has claimed it.

    An exclusive create succeeds on one rank only, so no rank waits for another.
    """
    try:
        os.close(os.open(plan.state / f"{member.number}.claim", os.O_CREAT | os.O_EXCL))
    except FileExistsError:
        return False
    return True


def store_outcome(plan: Plan, outcome: Outcome) -> None:
    """Write the outcome of a member to the state folder."""
    replace_text(plan.state / f"{outcome.number}.json", json.dumps(asdict(outcome)))


def outcomes(plan: Plan) -> dict[int, Outcome]:
    """All outcomes stored so far, by number of the member."""
    for file in plan.state.glob("[0-9]*.json"):
        if int(file.stem) not in plan.read:  # each file is written once, and there is one a member
            data = json.loads(file.read_text(encoding="utf-8"))
            plan.read[data["number"]] = Outcome(**{**data, "ranks": tuple(data["ranks"])})
    return dict(plan.read)


@contextmanager
def _locked(plan: Plan) -> Iterator[None]:
    """Allow one writer at a time.

    On a file system without locks nothing is locked: the last row may then be written with the next table.
    """
    with open(plan.state / "lock", "w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX)
        except OSError:
            pass
        yield


# ---------------------------------------------------------------------- rows
def run_results(folder: Path) -> dict[str, float]:
    """Results of a run, from its folder: title with unit -> value.

    Final values, error shares, and means over the last half of the simulated time.
    """
    run = RunFolder(folder)
    if not run.summary.is_file():
        return {}
    summary = read_summary(run.summary)
    out = {
        "time [s]": summary.get("time"),
        "real_time_factor [-]": summary.get("real_time_factor"),
        "steps [-]": summary.get("steps"),
        "energy_error_share [-]": summary.get("energy", {}).get("error_share"),
    }
    if "mass" in summary:
        out["mass_error_share [-]"] = summary["mass"].get("error_share")
    out |= summary.get("final", {}) | summary.get("new_hole", {})
    out |= _means(run.history)
    return {name: np.nan if value is None else float(value) for name, value in out.items()}


def _means(history: Path) -> dict[str, float]:
    """Means over the last half of the simulated time; the rows of a history are equidistant in time."""
    if not history.is_file():
        return {}
    table = read_table(history)
    time = table.get("time [s]", np.zeros(0))
    if len(time) < 2:
        return {}
    late = time >= 0.5 * (time[0] + time[-1])
    return {
        f"mean_{title}": float(values[late].mean())
        for title, values in table.items()
        if _has_mean(title) and values.dtype.kind == "f"
    }


def _has_mean(title: str) -> bool:
    """Whether the mean of a column of history.csv has a meaning."""
    quantity = find(split_name(title)[0])
    return quantity is None or quantity.mean


def rows(plan: Plan, ended: dict[int, Outcome]) -> list[dict[str, Any]]:
    """One row per member. All rows have the same columns; a result that a member does not have is nan."""
    titles = list(
        dict.fromkeys(title for m in plan.members if m.number in ended for title in ended[m.number].results)
    )
    also_si = [  # keys with a number that is written with a unit (`20 l/s`)
        key
        for key in plan.members[0].values
        if any(key in m.numbers and not is_number(m.values[key]) for m in plan.members)
    ]
    out = []
    for m in plan.members:
        outcome, folder = ended.get(m.number), plan.folder_of(m).folder
        if outcome is None:
            status = "running" if (plan.state / f"{m.number}.claim").exists() else "waiting"
            outcome = Outcome(m.number, status, wall=np.nan)
        row: dict[str, Any] = {
            "member": m.number,
            **m.values,
            **{f"{key} (SI)": m.numbers.get(key, np.nan) for key in also_si},
        }
        row |= {
            "status": outcome.status,
            "folder": os.path.relpath(folder, plan.folder) if plan.folder else str(folder),
            "ranks": len(outcome.ranks),
            "wall [s]": outcome.wall,
        }
        row |= {title: outcome.results.get(title, np.nan) for title in titles}
        out.append({**row, "message": outcome.message})
    return out


def write(plan: Plan, job: dict[str, Any], ended: dict[int, Outcome] | None = None) -> list[dict[str, Any]]:
    """Write the table and the summary in their present state; returns the rows.

    job: entries of the summary about the whole job, such as ranks, worker groups and versions.
    ended: outcomes to add if the outcomes on file may be incomplete.
    """
    with _locked(plan):
        ended = {**outcomes(plan), **(ended or {})}
        table = rows(plan, ended)
        if plan.folder is None:
            return table
        replace_text(plan.folder / plan.table, csv_text(table[0], (row.values() for row in table)))
        write_summary(plan.folder / "summary.json", _summary(plan, table, ended, job))
        return table


def _summary(
    plan: Plan, table: list[dict[str, Any]], ended: dict[int, Outcome], job: dict[str, Any]
) -> dict[str, Any]:
    """Content of summary.json; `units` has the SI unit of each varied key, for plots of the table."""
    count = {
        status: sum(row["status"] == status for row in table)
        for status in ("done", "failed", "running", "waiting")
    }
    complete = count["running"] + count["waiting"] == 0
    status = ("failed" if count["failed"] else "done") if complete else "running"
    if not complete and job.get("ended"):
        status = "stopped"
    ranks = {number: list(outcome.ranks) for number, outcome in ended.items()}
    return {
        "title": plan.title,
        "status": status,
        "table": plan.table,
        **count,
        **job,
        "units": {key: unit_of(key) for key in plan.members[0].values},
        "members": [{**row, "computed_by": ranks.get(row["member"], [])} for row in table],
    }
