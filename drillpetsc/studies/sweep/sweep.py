"""Several runs in one job: a sweep over values of a case, or a batch of several wells.

The ranks of the job are divided into worker groups, each of which computes one member at a time.
"""

from __future__ import annotations

import gc
import shutil
import sys
import time as clock
import traceback
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from petsc4py import PETSc

from drillpetsc.analysis.motion.integrator_choice import make_integrator
from drillpetsc.analysis.motion.quasi_static import QuasiStatic
from drillpetsc.analysis.motion.transient import run
from drillpetsc.case import Case, load_case
from drillpetsc.errors import CaseError, DrillError, Interrupted
from drillpetsc.model.drilling_model import build_model, is_quasi_static
from drillpetsc.model.mesh import build_mesh
from drillpetsc.output import RunFolder, read_summary
from drillpetsc.output.balances.energy_balance import EnergyGainMonitor
from drillpetsc.output.files.run_folder import SWEEP_TABLE
from drillpetsc.output.progress import Receiver, check_progress, duration
from drillpetsc.output.recorder import Recorder
from drillpetsc.parallel import first_rank_gives, wait_for, wait_for_files
from drillpetsc.solvers import petsc_options as options
from drillpetsc.studies.sweep import table
from drillpetsc.studies.sweep.plan import plan_sweep, plan_wells
from drillpetsc.studies.sweep.table import Action, Member, Outcome, Plan
from drillpetsc.studies.sweep.variations import choices_from, variations
from drillpetsc.studies.sweep.worker_groups import WorkerGroup, group_sizes, split
from drillpetsc.version import __version__


@dataclass(frozen=True)
class SweepResult:
    """Result of a sweep or batch, the same on all ranks.

    folder: folder of the table and the summary; None if there are none.
    table: file of the table, or None.
    rows: one per member.
    pictures: files with pictures of the new hole.
    """

    folder: Path | None
    table: Path | None
    rows: tuple[dict[str, Any], ...]
    pictures: tuple[Path, ...] = ()

    @property
    def failed(self) -> int:
        """Number of members that are not done."""
        return sum(row["status"] != "done" for row in self.rows)


def sweep(
    case: Case | str | Path,
    values: Mapping[str, Iterable[Any]],
    out: str | Path | None = None,
    *,
    restart: bool = False,
    overwrite: bool = False,
    comm: PETSc.Comm | None = None,
    progress: str | Receiver = "auto",
) -> SweepResult:
    """Simulate every combination of ``values`` of a case (collective over ``comm``).

    case: a Case, or the path of a case file.
    values: key of the case -> values.
    out: folder of the sweep; by default results/<case>-NNN.
    restart: keep members that are done, continue those with a checkpoint, run the others.
    overwrite: replace the results in an existing ``out``.
    progress: auto or silent, or a function of (share of members ended, text) that is called when a member ends.

    Raises CaseError, before anything runs, for an error in any member. A member that fails later is marked
    failed in its row.
    """
    comm = comm or PETSc.COMM_WORLD
    check_progress(progress, ("auto", "silent"))
    members = []
    for number, v in enumerate(variations(case, choices_from(values)), 1):
        numbers = {key: x for key in v.values if (x := v.number_of(key)) is not None}
        members.append(Member(number, f"member-{number:03d}", v.values, v.case, _elements(v.case), numbers))
    refuse_unread_options(comm, [m.case for m in members])
    title, name = members[0].case.title, "case" if isinstance(case, Case) else Path(case).stem
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
    """Simulate several case files, each into a separate run folder: results/<case>-NNN, or ``out``/<case>.

    Otherwise as ``sweep``.
    """
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
    refuse_unread_options(comm, [m.case for m in members])
    return _run_all(comm, progress, lambda: plan_wells(members, out, restart, overwrite))


def _elements(case: Case) -> int:
    """Number of elements of the mesh; 1 if no mesh can be built, in which case the run of the member fails
    with the reason."""
    try:
        return len(build_mesh(case).upper)
    except DrillError:
        return 1


# ---------------------------------------------------------------------- PETSc options
def refuse_unread_options(comm: PETSc.Comm, cases: Sequence[Case]) -> None:
    """Raise CaseError for a PETSc option that none of ``cases`` reads (collective over ``comm``).

    Options of the command line and of the cases are checked. Rank 0 builds one model, and further models with
    other physics as long as an option is left that none has read.
    """

    def options_given() -> list[str]:
        given = list(PETSc.Options().getAll())
        if unread := _unread_options(given, cases):
            raise options.not_an_option(unread[0], "one of the cases")
        return given

    for name in first_rank_gives(comm.tompi4py(), options_given):
        # a query counts as reading, so a member whose own solvers leave the option unread is not refused
        PETSc.Options().hasName(name)


def _unread_options(given: Sequence[str], cases: Sequence[Case]) -> list[str]:
    """Names of options that no model has read, in the order in which they were given."""
    names = dict.fromkeys([*given, *(name for case in cases for name in case.petsc)])
    tried: set[Hashable] = set()
    built = 0
    for case in cases:
        if not names:
            break
        if (key := _physics_key(case)) in tried:
            continue
        tried.add(key)
        try:
            read = _read_options(case)
        except DrillError:  # the run of the member reports it in its row
            continue
        built += 1
        for name in read:
            names.pop(name, None)
    return list(names) if built else []


def _physics_key(case: Case) -> Hashable:
    """Key that is equal for cases whose solvers read the same options."""
    fluid, contact = case.fluid, case.contact
    return (
        fluid is not None and (fluid.formulation, fluid.dynamics), contact is not None and contact.law, case.formation is not None,
        case.hold_string, case.beam.formulation, case.top.kind, case.bottom.kind, case.time is not None and case.time.mode,
        tuple(sorted((name, str(value)) for name, value in case.petsc.items())),
    )  # fmt: skip


def _read_options(case: Case) -> list[str]:
    """Options of the command line and of the case that the solvers of the case read, or may read at the end
    of the run."""
    with options.applied(case.petsc) as used:
        model = build_model(case, PETSc.COMM_SELF)
        integrator = make_integrator(model, QuasiStatic(model) if is_quasi_static(case) else None)
        recorder = Recorder(model)
        EnergyGainMonitor(recorder.energy)
        unread = options.unread(used)
        del model, integrator, recorder
        gc.collect()
        return [name for name in used if name not in unread]


# ---------------------------------------------------------------------- the job
def _run_all(comm: PETSc.Comm, progress: str | Receiver, make_plan: Callable[[], Plan]) -> SweepResult:
    """Plan on rank 0, run the members in worker groups, and collect their outcomes (collective)."""
    mpi = comm.tompi4py()

    def made() -> Plan:
        try:
            return make_plan()
        except (OSError, ValueError) as error:
            raise CaseError(at="--out", want=str(error)) from None

    plan: Plan = first_rank_gives(mpi, made)
    order = sorted(
        (m for m in plan.members if plan.folder_of(m).action is not Action.KEEP),
        key=lambda m: (-m.cost, m.number),
    )
    sizes = group_sizes([m.cost for m in order], [m.elements for m in order], mpi.size)
    job = _Job(plan, order, sizes, mpi, progress, clock.perf_counter())
    if mpi.rank == 0:
        job.begin()
    mpi.Barrier()
    for m in plan.members:
        PETSc.Log.Stage(m.name)  # on all ranks in one order
    group = split(mpi, sizes)
    on_rank = job.work(group) if group is not None else []
    wait_for(mpi.Ibarrier())
    gathered = mpi.gather(on_rank)
    rows: list[dict[str, Any]] = []
    pictures: list[Path] = []
    if mpi.rank == 0:
        rows = job.end({o.number: o for each in gathered for o in each})
        pictures = _pictures(plan, rows)
    rows, pictures = mpi.bcast((rows, pictures))
    return SweepResult(
        plan.folder,
        plan.folder / plan.table if plan.folder is not None else None,
        tuple(rows),
        tuple(pictures),
    )


def _pictures(plan: Plan, rows: list[dict[str, Any]]) -> list[Path]:
    """Draw the new hole of the members of a sweep; without new hole nothing is drawn and nothing imported."""
    drilled = any(row.get("drilled [m]", 0.0) > 0 for row in rows)
    if plan.folder is None or plan.table != SWEEP_TABLE or not drilled:
        return []
    try:
        from drillpetsc.plotting.command.sweep import draw_sweep

        return draw_sweep(plan.folder)
    except Exception as error:  # a failed picture must not fail a sweep whose results are written
        print(
            f"drillpetsc: no pictures of the sweep: {type(error).__name__}: {error}",
            file=sys.stderr,
            flush=True,
        )
        return []


@dataclass(frozen=True)
class _Job:
    """One job of several members.

    order: members to be computed, in descending order of cost.
    sizes: number of ranks of each worker group.
    mpi: mpi4py communicator of the job.
    began: clock reading at the start [s].
    stopped: signals that ended a member, and with it the job.
    pace: of writing the table.
    """

    plan: Plan
    order: list[Member]
    sizes: list[int]
    mpi: Any
    progress: str | Receiver
    began: float
    stopped: list[str] = field(default_factory=list)
    pace: table.Pace = field(default_factory=table.Pace)

    def facts(self) -> dict[str, Any]:
        """Entries of the summary about the whole job."""
        return {
            "ranks": self.mpi.size,
            "worker_groups": self.sizes,
            "wall_seconds": clock.perf_counter() - self.began,
            "versions": {
                "drillpetsc": __version__,
                "petsc": ".".join(map(str, PETSc.Sys.getVersion())),
            },
        }

    def begin(self) -> None:
        """Store outcomes of the members that are kept, and claim the first member of each group."""
        for m in self.plan.members:
            member_folder = self.plan.folder_of(m)
            if member_folder.action is Action.KEEP:
                folder = member_folder.folder
                summary = read_summary(RunFolder(folder).summary)
                wall = summary.get("wall_seconds", 0.0) + summary.get("start_seconds", 0.0)
                table.store_outcome(
                    self.plan, Outcome(m.number, "done", wall=wall, results=table.run_results(folder))
                )
        for m in self.order[: len(self.sizes)]:
            table.claim(self.plan, m)
        table.write(self.plan, self.facts())

    def end(self, outcomes: dict[int, Outcome]) -> list[dict[str, Any]]:
        """Write the final table and release the folder; returns the rows."""
        rows = table.write(self.plan, {**self.facts(), "ended": True}, outcomes)
        shutil.rmtree(self.plan.state, ignore_errors=True)
        if self.plan.folder is not None:
            RunFolder(self.plan.folder).release()
        return rows

    def work(self, group: WorkerGroup) -> list[Outcome]:
        """Compute members until none is left; returns their outcomes on the first rank of the group."""
        on_rank: list[Outcome] = []
        member: Member | None = self.order[group.number]
        while member is not None:
            began = clock.perf_counter()
            message = self._compute(group, member)
            messages = group.gather(message)
            if messages is None:
                self._give_up(group, member, message, clock.perf_counter() - began)
            else:
                number = 0
                if group.first:
                    on_rank.append(self._outcome(group, member, messages, clock.perf_counter() - began))
                    self._report(on_rank[-1], member)
                    number = 0 if self.stopped else self._claim_next(len(group.ranks))
                number = group.control.bcast(number)
                member = self.plan.members[number - 1] if number else None
        gc.unfreeze()
        if group.first:
            self._ended_file(group.number).touch()
        return on_rank

    def _claim_next(self, ranks: int) -> int:
        """Claim the most expensive member that is free, for a group of ``ranks`` ranks; its number, or 0.

        A string too short for a large group is left to a smaller one. There is always a group of one rank if
        the members outnumber the groups.
        """
        fitting = (m for m in self.order[len(self.sizes) :] if ranks == 1 or m.elements >= 2 * ranks)
        return next((m.number for m in fitting if table.claim(self.plan, m)), 0)

    def _compute(self, group: WorkerGroup, member: Member) -> str:
        """Run a member on its group; returns the error message of this rank, or an empty one."""
        member_folder = self.plan.folder_of(member)
        stage = PETSc.Log.Stage(member.name)  # separate counts for run()
        stage.push()
        message = ""
        try:
            run(
                member.case,
                member_folder.folder,
                restart=member_folder.action is Action.CONTINUE,
                overwrite=member_folder.action is Action.AGAIN,
                name=member.name,
                comm=group.comm,
                progress="silent",
            )
        except DrillError as error:
            message = str(error)
            if isinstance(error, Interrupted):
                self.stopped.append(error.signal)
        except Exception as error:  # an unexpected error fails this member only
            message = f"{type(error).__name__}: {error}"
            print(f"{member.name}:\n{traceback.format_exc()}", file=sys.stderr, flush=True)
        finally:
            stage.pop()
        gc.collect()  # frees PETSc objects at the same place on all ranks of the group
        gc.freeze()  # what is alive now stays; the next collection need not visit the objects of all modules again
        return message

    def _outcome(self, group: WorkerGroup, member: Member, messages: list[str], wall: float) -> Outcome:
        """Outcome of a member from the messages of all ranks of its group."""
        message = next(filter(None, messages), "")
        folder = self.plan.folder_of(member).folder
        if message and folder.is_dir() and not any(folder.iterdir()):
            folder.rmdir()  # created by the plan, and left empty by the run
        return Outcome(
            member.number,
            "failed" if message else "done",
            "; ".join(" ".join(part.split()) for part in message.splitlines()),
            group.ranks,
            wall,
            table.run_results(folder),
        )

    def _report(self, outcome: Outcome, member: Member) -> None:
        """Store the outcome, write the table if it is due, and print one line."""
        table.store_outcome(self.plan, outcome)
        self.pace.write(self.plan, self.facts())
        if self.progress == "silent":
            return
        ended, members = len(table.outcomes(self.plan)), len(self.plan.members)
        ranks = (
            f"rank {outcome.ranks[0]}"
            if len(outcome.ranks) == 1
            else f"ranks {outcome.ranks[0]} to {outcome.ranks[-1]}"
        )
        line = (
            f"[{ended}/{members}] {member.label}: {outcome.status}, {duration(outcome.wall)} wall on {ranks}"
        )
        line += f": {outcome.message}" if outcome.message else ""
        spent = clock.perf_counter() - self.began
        line += f"  ETA {duration(spent / ended * (members - ended))}" if ended < members else ""
        if callable(self.progress):
            self.progress(ended / members, line)
        else:
            print(line, file=sys.stderr, flush=True)

    def _ended_file(self, number: int) -> Path:
        """File that marks that a worker group has ended."""
        return self.plan.state / f"group-{number}"

    def _give_up(self, group: WorkerGroup, member: Member, message: str, wall: float) -> None:
        """End the job because other ranks of this group are still in a member that has ended on this rank.

        A rank that waits in a computation for one that has left it cannot be released. All other groups
        finish first.
        """
        text = message or "a rank of this member did not return"
        self._report(self._outcome(group, member, [f"on rank {self.mpi.rank} alone: {text}"], wall), member)
        self._ended_file(group.number).touch()
        wait_for_files([self._ended_file(number) for number in range(len(self.sizes))])
        table.write(self.plan, {**self.facts(), "ended": True})
        print(
            "drillpetsc: a member failed on some of its ranks only, so the job ends; the other worker groups have finished",
            file=sys.stderr,
            flush=True,
        )
        self.mpi.Abort(1)


def closing_lines(result: SweepResult) -> list[str]:
    """Lines that a sweep or batch prints at its end."""
    lines = [f"{len(result.rows) - result.failed} of {len(result.rows)} members done"]
    for row in result.rows:
        if row["status"] != "done":
            lines.append(f"  member {row['member']} {row['status']}: {row['message']}")
    if result.folder is None:
        return lines + [f"  results: {row['folder']}" for row in result.rows]
    pictures = [f"  pictures: {', '.join(file.name for file in result.pictures)}"] if result.pictures else []
    return [*lines, f"  table: {result.table}", f"  results: {result.folder}", *pictures]
