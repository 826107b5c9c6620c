"""Several runs in one job: sweeps over the values of a case, and several wells; the ranks are shared out over
them."""

from __future__ import annotations

import gc
import shutil
import sys
import time as clock
import traceback
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from petsc4py import PETSc

import drillpetsc
from drillpetsc.analysis.transient import run
from drillpetsc.case import Case, load_case
from drillpetsc.errors import CaseError, DrillError, Interrupted
from drillpetsc.model.mesh import build_mesh
from drillpetsc.output import RunFolder, read_summary
from drillpetsc.output.progress import duration
from drillpetsc.parallel import wait_for, wait_for_files
from drillpetsc.studies.sweep import table
from drillpetsc.studies.sweep.member_options import refuse_misspelt
from drillpetsc.studies.sweep.plan import SWEEP, plan_sweep, plan_wells
from drillpetsc.studies.sweep.table import AGAIN, CONTINUE, KEEP, Member, Outcome, Plan
from drillpetsc.studies.sweep.variations import choices_from, variations
from drillpetsc.studies.sweep.worker_groups import WorkerGroup, split, team_sizes


@dataclass(frozen=True)
class SweepResult:
    """folder: of table and summary (None: there are none); table: its file; rows: one a member; pictures: of
    what was drilled; the same on all ranks."""

    folder: Path | None
    table: Path | None
    rows: tuple[dict[str, Any], ...]
    pictures: tuple[Path, ...] = ()

    @property
    def failed(self) -> int:
        """Number of members that are not done."""
        return sum(row["status"] != "done" for row in self.rows)


def sweep(
    case: str | Path,
    values: Mapping[str, Iterable[Any]],
    out: str | Path | None = None,
    *,
    restart: bool = False,
    overwrite: bool = False,
    comm: PETSc.Comm | None = None,
    progress: str = "auto",
) -> SweepResult:
    """Simulate every combination of ``values`` (key of the case file -> values); collective over ``comm``.

    Raises CaseError, before anything runs, for what is wrong in any member; a member that fails later is told
    in its row.
    restart: members that are done are kept, those with a checkpoint continued, the others run.
    """
    comm = comm or PETSc.COMM_WORLD
    members = []
    for number, v in enumerate(variations(case, choices_from(values)), 1):
        numbers = {key: x for key in v.values if (x := v.number_of(key)) is not None}
        members.append(Member(number, f"member-{number:03d}", v.values, v.case, _elements(v.case), numbers))
    refuse_misspelt(comm, [m.case for m in members])
    title, name = members[0].case.title, Path(case).stem
    return _run_all(comm, progress, lambda: plan_sweep(title, name, members, out, restart, overwrite))


def run_cases(
    paths: Sequence[str | Path],
    out: str | Path | None = None,
    *,
    restart: bool = False,
    overwrite: bool = False,
    comm: PETSc.Comm | None = None,
    progress: str = "auto",
) -> SweepResult:
    """Simulate several case files, each into its own run folder: results/<case>-NNN, or ``out``/<case>; as
    ``sweep`` else."""
    comm = comm or PETSc.COMM_WORLD
    members: list[Member] = []
    names: list[str] = []
    for number, path in enumerate(paths, 1):
        case, stem = load_case(path), Path(path).stem
        if case.time is None:
            raise CaseError(
                at="time",
                want="a block {end: ...}",
                file=path,
                hint="for the static state alone use: drillpetsc statics",
            )
        name, again = stem, 1
        while name in names:
            again += 1
            name = f"{stem}-{again}"
        names.append(name)
        members.append(Member(number, name, {"case": str(path)}, case, _elements(case)))
    refuse_misspelt(comm, [m.case for m in members])
    return _run_all(comm, progress, lambda: plan_wells(members, out, restart, overwrite))


def _elements(case: Case) -> int:
    """Of the mesh; 1 where there is none: the member will fail, and say why, when it is built."""
    try:
        return len(build_mesh(case).upper)
    except DrillError:
        return 1


# ---------------------------------------------------------------------- the job
def _run_all(comm: PETSc.Comm, progress: str, make_plan: Callable[[], Plan]) -> SweepResult:
    """Plan on rank 0, run the members in teams, gather what came out; collective."""
    mpi = comm.tompi4py()
    answer: Any = None
    if mpi.rank == 0:
        try:
            answer = make_plan()
        except (CaseError, OSError, ValueError) as error:
            answer = error if isinstance(error, CaseError) else CaseError(at="--out", want=str(error))
    answer = mpi.bcast(answer)
    if isinstance(answer, CaseError):
        raise answer
    plan: Plan = answer
    order = sorted(
        (m for m in plan.members if plan.place(m).action != KEEP), key=lambda m: (-m.cost, m.number)
    )
    sizes = team_sizes([m.cost for m in order], [m.elements for m in order], mpi.size)
    job = _Job(plan, order, sizes, mpi, progress, clock.perf_counter())
    if mpi.rank == 0:
        job.begin()
    mpi.Barrier()
    for m in plan.members:
        PETSc.Log.Stage(m.name)  # on all ranks in one order
    team = split(mpi, sizes)
    on_rank = job.work(team) if team is not None else []
    wait_for(mpi.Ibarrier())
    reported = mpi.gather(on_rank)
    rows: list[dict[str, Any]] = []
    pictures: list[Path] = []
    if mpi.rank == 0:
        rows = job.end({o.number: o for each in reported for o in each})
        pictures = _pictures(plan, rows)
    rows, pictures = mpi.bcast((rows, pictures))
    return SweepResult(
        plan.folder,
        plan.folder / plan.table if plan.folder is not None else None,
        tuple(rows),
        tuple(pictures),
    )


def _pictures(plan: Plan, rows: list[dict[str, Any]]) -> list[Path]:
    """Pictures of what the members of a sweep drilled; none, and nothing is imported for them, when they
    drilled nothing."""
    if plan.folder is None or plan.table != SWEEP or not any(row.get("drilled [m]", 0.0) > 0 for row in rows):
        return []
    try:
        from drillpetsc.plotting.sweep import draw_sweep

        return draw_sweep(plan.folder)
    except Exception as error:  # the results are there, whatever happens to their pictures
        print(
            f"drillpetsc: no pictures of the sweep: {type(error).__name__}: {error}",
            file=sys.stderr,
            flush=True,
        )
        return []


@dataclass(frozen=True)
class _Job:
    """order: members to be computed, the costliest first; sizes: ranks of each team; began: clock reading
    [s]."""

    plan: Plan
    order: list[Member]
    sizes: list[int]
    mpi: Any
    progress: str
    began: float
    stopped: list[str] = field(default_factory=list)  # the signal that ended a member, and with it the job

    def facts(self) -> dict[str, Any]:
        return {
            "ranks": self.mpi.size,
            "teams": self.sizes,
            "wall_seconds": clock.perf_counter() - self.began,
            "versions": {
                "drillpetsc": drillpetsc.__version__,
                "petsc": ".".join(map(str, PETSc.Sys.getVersion())),
            },
        }

    def begin(self) -> None:
        """Outcomes of members that are kept, and the claims of those that the teams begin with."""
        for m in self.plan.members:
            folder, action = self.plan.place(m).folder, self.plan.place(m).action
            if action == KEEP:
                reported = read_summary(RunFolder(folder).summary)
                wall = reported.get("wall_seconds", 0.0) + reported.get("start_seconds", 0.0)
                table.keep_outcome(
                    self.plan, Outcome(m.number, "done", wall=wall, figures=table.figures(folder))
                )
        for m in self.order[: len(self.sizes)]:
            table.claim(self.plan, m)
        table.write(self.plan, self.facts())

    def end(self, reported: dict[int, Outcome]) -> list[dict[str, Any]]:
        rows = table.write(self.plan, {**self.facts(), "ended": True}, reported)
        shutil.rmtree(self.plan.state, ignore_errors=True)
        if self.plan.folder is not None:
            RunFolder(self.plan.folder).release()
        return rows

    def work(self, team: WorkerGroup) -> list[Outcome]:
        """Compute members until none is left; the outcomes, on the team's first rank."""
        on_rank: list[Outcome] = []
        member: Member | None = self.order[team.number]
        while member is not None:
            began = clock.perf_counter()
            message = self._compute(team, member)
            messages = team.gathered(message)
            if messages is None:
                self._give_up(team, member, message, clock.perf_counter() - began)
            else:
                number = 0
                if team.first:
                    on_rank.append(self._outcome(team, member, messages, clock.perf_counter() - began))
                    self._tell(on_rank[-1], member)
                    number = 0 if self.stopped else self._free(len(team.ranks))
                number = team.talk.bcast(number)
                member = self.plan.members[number - 1] if number else None
        if team.first:
            self._left(team.number).touch()
        return on_rank

    def _free(self, ranks: int) -> int:
        """Take the costliest member that nobody has, for a team of so many ranks; 0 when there is none.

        A string too short for a large team is left to the smaller ones, of which there is one whenever
        members outnumber the teams.
        """
        fitting = (m for m in self.order[len(self.sizes) :] if ranks == 1 or m.elements >= 2 * ranks)
        return next((m.number for m in fitting if table.claim(self.plan, m)), 0)

    def _compute(self, team: WorkerGroup, member: Member) -> str:
        """Run a member on its team; what went wrong on this rank, or nothing."""
        place = self.plan.place(member)
        stage = PETSc.Log.Stage(member.name)  # with counts of its own for run() to read
        stage.push()
        message = ""
        try:
            run(
                member.case,
                place.folder,
                restart=place.action == CONTINUE,
                overwrite=place.action == AGAIN,
                name=member.name,
                comm=team.comm,
                progress="silent",
            )
        except DrillError as error:
            message = str(error)
            if isinstance(error, Interrupted):
                self.stopped.append(error.signal)
        except Exception as error:  # whatever it is, it is this member's own
            message = f"{type(error).__name__}: {error}"
            print(f"{member.name}:\n{traceback.format_exc()}", file=sys.stderr, flush=True)
        finally:
            stage.pop()
        gc.collect()  # objects of PETSc go at the same place on all ranks of the team
        return message

    def _outcome(self, team: WorkerGroup, member: Member, messages: list[str], wall: float) -> Outcome:
        """How a member ended, from what each rank of its team says."""
        message = next(filter(None, messages), "")
        folder = self.plan.place(member).folder
        if message and folder.is_dir() and not any(folder.iterdir()):
            folder.rmdir()  # made beforehand, and nothing came of it
        return Outcome(
            member.number,
            "failed" if message else "done",
            "; ".join(" ".join(part.split()) for part in message.splitlines()),
            team.ranks,
            wall,
            table.figures(folder),
        )

    def _tell(self, outcome: Outcome, member: Member) -> None:
        """Renew the table, and one line to the user."""
        table.keep_outcome(self.plan, outcome)
        rows = table.write(self.plan, self.facts())
        if self.progress == "silent":
            return
        ended = sum(row["status"] in ("done", "failed") for row in rows)
        ranks = (
            f"rank {outcome.ranks[0]}"
            if len(outcome.ranks) == 1
            else f"ranks {outcome.ranks[0]} to {outcome.ranks[-1]}"
        )
        line = f"[{ended}/{len(rows)}] {member.label}: {outcome.status}, {duration(outcome.wall)} wall on {ranks}"
        print(line + (f": {outcome.message}" if outcome.message else ""), file=sys.stderr, flush=True)

    def _left(self, number: int) -> Path:
        return self.plan.state / f"team-{number}"

    def _give_up(self, team: WorkerGroup, member: Member, message: str, wall: float) -> None:
        """End the job when others of this team are stuck in a member that ended here, but let all other teams
        finish first.

        A rank that waits in a computation for one that left it cannot be called back.
        """
        text = message or "a rank of this member did not come back from it"
        self._tell(self._outcome(team, member, [f"on rank {self.mpi.rank} alone: {text}"], wall), member)
        self._left(team.number).touch()
        wait_for_files([self._left(number) for number in range(len(self.sizes))])
        table.write(self.plan, {**self.facts(), "ended": True})
        print(
            "drillpetsc: a member failed on some of its ranks alone, so the job is ended; the other teams have finished",
            file=sys.stderr,
            flush=True,
        )
        self.mpi.Abort(1)


def closing_lines(result: SweepResult) -> list[str]:
    """The few lines that end an ensemble on the screen."""
    lines = [f"{len(result.rows) - result.failed} of {len(result.rows)} members done"]
    for row in result.rows:
        if row["status"] != "done":
            lines.append(f"  member {row['member']} {row['status']}: {row['message']}")
    if result.folder is None:
        return lines + [f"  results: {row['folder']}" for row in result.rows]
    pictures = [f"  pictures: {', '.join(file.name for file in result.pictures)}"] if result.pictures else []
    return [*lines, f"  table: {result.table}", f"  results: {result.folder}", *pictures]
