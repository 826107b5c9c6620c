"""The table of an ensemble: one row a member, written whole again each time a member ends, and the files that
members leave for it.

Ranks that compute different members share nothing but these files: a claim says that a member is taken, an
outcome that it has ended.
"""

from __future__ import annotations

import csv
import fcntl
import io
import json
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.case import Case
from drillpetsc.output import RunFolder, read_summary, read_table, write_summary
from drillpetsc.output.catalogue import find
from drillpetsc.output.files.atomic import replace_text
from drillpetsc.output.files.tables import split_name

NEW, AGAIN, CONTINUE, KEEP = "new", "again", "continue", "keep"


@dataclass(frozen=True)
class Member:
    """One run of an ensemble.

    number: from 1; name: in front of its run folder's number; values: what tells it from the others, column
    -> word; numbers: column -> the same in SI, where it is a number; elements: of its mesh.
    """

    number: int
    name: str
    values: dict[str, str]
    case: Case
    elements: int
    numbers: dict[str, float] = field(default_factory=dict)

    @property
    def cost(self) -> float:
        """Expected, in elements times simulated seconds: a step costs as much as the string has elements
        (describe.COST)."""
        assert self.case.time is not None
        return self.elements * float(self.case.time.end)

    @property
    def label(self) -> str:
        return ", ".join(f"{key}={word}" for key, word in self.values.items())


@dataclass(frozen=True)
class MemberFolder:
    """Where a member's run folder lies, and what is to be done there: NEW, AGAIN (what is there is replaced),
    CONTINUE or KEEP."""

    folder: Path
    action: str


@dataclass(frozen=True)
class Outcome:
    """How a member ended.  status: done or failed; ranks: numbers in the whole job of the ranks that computed
    it, none when an earlier job did; wall [s]; figures: of its run folder."""

    number: int
    status: str
    message: str = ""
    ranks: tuple[int, ...] = ()
    wall: float = 0.0
    figures: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Plan:
    """An ensemble about to run.  folder: where table and summary go, None for neither; state: folder of
    claims and outcomes."""

    title: str
    table: str
    folder: Path | None
    state: Path
    members: tuple[Member, ...]
    places: tuple[MemberFolder, ...]

    def place(self, member: Member) -> MemberFolder:
        return self.places[member.number - 1]


# ---------------------------------------------------------------------- claims and outcomes
def claim(plan: Plan, member: Member) -> bool:
    """Take a member; false when another team has it.  One create that only one can win, so no rank waits for
    another."""
    try:
        os.close(os.open(plan.state / f"{member.number}.claim", os.O_CREAT | os.O_EXCL))
    except FileExistsError:
        return False
    return True


def keep_outcome(plan: Plan, outcome: Outcome) -> None:
    replace_text(plan.state / f"{outcome.number}.json", json.dumps(asdict(outcome)))


def outcomes(plan: Plan) -> dict[int, Outcome]:
    """All outcomes so far, by number of the member."""
    found = {}
    for file in plan.state.glob("[0-9]*.json"):
        data = json.loads(file.read_text(encoding="utf-8"))
        found[data["number"]] = Outcome(**{**data, "ranks": tuple(data["ranks"])})
    return found


@contextmanager
def _alone(plan: Plan) -> Iterator[None]:
    """One writer at a time, or without a lock where the file system has none: then the last row may come with
    the next writing."""
    with open(plan.state / "lock", "w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX)
        except OSError:
            pass
        yield


# ---------------------------------------------------------------------- rows
def figures(folder: Path) -> dict[str, float]:
    """What a run folder says about its run: title with unit -> value.  Final values, shares of error, means
    over the last half."""
    run = RunFolder(folder)
    if not run.summary.is_file():
        return {}
    reported = read_summary(run.summary)
    out = {
        "time [s]": reported.get("time"),
        "real_time_factor [-]": reported.get("real_time_factor"),
        "steps [-]": reported.get("steps"),
        "energy_error_share [-]": reported.get("energy", {}).get("error_share"),
    }
    if "mass" in reported:
        out["mass_error_share [-]"] = reported["mass"].get("error_share")
    out |= reported.get("final", {}) | reported.get("new_hole", {})
    out |= _means(run.history)
    return {name: np.nan if value is None else float(value) for name, value in out.items()}


def _means(history: Path) -> dict[str, float]:
    """Means over the last half of the simulated time; the rows of a history are equally far apart."""
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
    """Whether the mean of a column of history.csv tells something."""
    quantity = find(split_name(title)[0])
    return quantity is None or quantity.mean


def rows(plan: Plan, ended: dict[int, Outcome]) -> list[dict[str, Any]]:
    """One row a member; all have the same columns, nan where a member has no such figure."""
    titles = list(
        dict.fromkeys(title for m in plan.members if m.number in ended for title in ended[m.number].figures)
    )
    also_si = [key for key in plan.members[0].values if _in_words(plan.members, key)]
    out = []
    for m in plan.members:
        outcome, folder = ended.get(m.number), plan.place(m).folder
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
        row |= {title: outcome.figures.get(title, np.nan) for title in titles}
        out.append({**row, "message": outcome.message})
    return out


def _in_words(members: Sequence[Member], key: str) -> bool:
    """Whether values of ``key`` are numbers that do not look like it (`20 l/s`)."""

    def plain(word: str) -> bool:
        try:
            float(word)
        except ValueError:
            return False
        return True

    return any(key in m.numbers and not plain(m.values[key]) for m in members)


def write(plan: Plan, began: dict[str, Any], ended: dict[int, Outcome] | None = None) -> list[dict[str, Any]]:
    """Write table and summary as things stand now (``ended``: given when the outcomes on file may be
    incomplete); returns the rows.

    began: what the summary tells about the whole job: ranks, teams, petsc.
    """
    with _alone(plan):
        ended = {**outcomes(plan), **(ended or {})}
        table = rows(plan, ended)
        if plan.folder is None:
            return table
        text = io.StringIO()
        sheet = csv.writer(text, lineterminator="\n")
        sheet.writerow(table[0])
        sheet.writerows([["" if value is None else value for value in row.values()] for row in table])
        replace_text(plan.folder / plan.table, text.getvalue())
        write_summary(plan.folder / "summary.json", _summary(plan, table, ended, began))
        return table


def _summary(
    plan: Plan, table: list[dict[str, Any]], ended: dict[int, Outcome], began: dict[str, Any]
) -> dict[str, Any]:
    count = {
        status: sum(row["status"] == status for row in table)
        for status in ("done", "failed", "running", "waiting")
    }
    over = count["running"] + count["waiting"] == 0
    status = ("failed" if count["failed"] else "done") if over else "running"
    if not over and began.get("ended"):
        status = "stopped"
    ranks = {number: list(outcome.ranks) for number, outcome in ended.items()}
    return {
        "title": plan.title,
        "status": status,
        "table": plan.table,
        **count,
        **began,
        "members": [{**row, "computed_by": ranks.get(row["member"], [])} for row in table],
    }
