"""Plan of a sweep or batch: the run folder of each member, and the work left there.

One process decides this before any member runs.
"""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

from drillpetsc.errors import CaseError
from drillpetsc.output import RunFolder, read_summary
from drillpetsc.output.files.run_folder import SWEEP_PICTURES, SWEEP_TABLE, WELLS_TABLE
from drillpetsc.studies.sweep.table import Action, Member, MemberFolder, Plan

STATE = ".members"  # folder of claims and outcomes while a job runs

Out = str | Path | None


def plan_sweep(
    title: str, name: str, members: list[Member], out: Out, restart: bool, overwrite: bool
) -> Plan:
    """Plan a sweep into ``out``, or results/<name>-NNN; the folder stays locked until the job ends."""
    if restart and out is None:
        out = _latest_sweep(name)
    found = RunFolder.create(name, out, restart=restart, overwrite=overwrite)
    folder = found.path
    if restart and not (folder / SWEEP_TABLE).is_file():
        found.release()
        raise CaseError(
            at="--out",
            got=str(folder),
            want=f"the folder of a sweep, with a {SWEEP_TABLE}",
            hint="--restart continues a sweep",
        )
    if overwrite:
        _clear(folder)
    folders = (
        _restart_folders(folder, members)
        if restart
        else [MemberFolder(folder / m.name, Action.AGAIN if overwrite else Action.NEW) for m in members]
    )
    return Plan(title, SWEEP_TABLE, folder, _state(folder), tuple(members), tuple(folders))


def _latest_sweep(name: str) -> Path:
    """The sweep folder of the case with the highest number."""
    sweeps = sorted(
        Path("results").glob(f"{name}-*/{SWEEP_TABLE}"),
        key=lambda file: (len(file.parent.name), file.parent.name),
    )
    if not sweeps:
        raise CaseError(
            got=f"results/{name}-NNN", want="a sweep to continue", hint="name its folder with --out"
        )
    return sweeps[-1].parent


def _clear(folder: Path) -> None:
    """Remove the files of an earlier sweep and of its members; other files are kept."""
    for name in (SWEEP_TABLE, *(f"{name}.png" for name in SWEEP_PICTURES)):
        (folder / name).unlink(missing_ok=True)
    for old in folder.glob("member-*"):
        if old.is_dir():
            RunFolder(old).clear()
            if not any(old.iterdir()):
                old.rmdir()


def _state(folder: Path) -> Path:
    """Create an empty state folder."""
    state = folder / STATE
    shutil.rmtree(state, ignore_errors=True)  # claims of a job that was stopped
    state.mkdir(parents=True)
    return state


def _restart_folders(folder: Path, members: list[Member]) -> list[MemberFolder]:
    """Run folders of a restarted sweep: the folder in which the same case was run, or a new one."""
    known: dict[str, list[Path]] = {}
    for path in sorted(folder.glob("member-*")):
        if text := _case_text(path):
            known.setdefault(text, []).append(path)
    taken = {path for several in known.values() for path in several}
    folders = []
    for m in members:
        same = known.get(m.case.to_yaml())
        if same:
            folders.append(MemberFolder(same[0], _action(same[0])))
            same.pop(0)  # 1 m and 100 cm are two members
            continue
        number = m.number
        while (path := folder / f"member-{number:03d}") in taken:
            number = max(number + 1, len(members) + 1)
        taken.add(path)
        folders.append(MemberFolder(path, Action.AGAIN if path.exists() else Action.NEW))
    return folders


def _case_text(folder: Path) -> str:
    file = RunFolder(folder).case
    return file.read_text(encoding="utf-8") if file.is_file() else ""


def _action(folder: Path) -> Action:
    """Work left in a run folder of the same case."""
    found = RunFolder(folder)
    if found.summary.is_file() and read_summary(found.summary).get("status") == "done":
        return Action.KEEP
    return Action.CONTINUE if found.checkpoint.is_file() else Action.AGAIN


def plan_wells(members: list[Member], out: Out, restart: bool, overwrite: bool) -> Plan:
    """Plan a batch of several case files into ``out``/<name>, or results/<name>-NNN each."""
    folder = (
        RunFolder.create("wells", out, restart=restart, overwrite=overwrite).path if out is not None else None
    )
    folders = []
    for m in members:
        path = folder / m.name if folder is not None else _latest(m.name) if restart else None
        if path is None:
            made = RunFolder.create(m.name)
            made.release()  # the rank that computes the member takes the lock
            folders.append(MemberFolder(made.path, Action.AGAIN))
        elif restart and path.is_dir():
            folders.append(_restart_folder(path, m))
        else:
            folders.append(MemberFolder(path, Action.AGAIN if overwrite else Action.NEW))
    if folder is not None:
        return Plan("", WELLS_TABLE, folder, _state(folder), tuple(members), tuple(folders))
    state = Path(tempfile.mkdtemp(prefix=".wells-", dir="results"))
    return Plan("", WELLS_TABLE, None, state, tuple(members), tuple(folders))


def _restart_folder(path: Path, m: Member) -> MemberFolder:
    """Run folder of a restarted well; a changed case (a later end) continues from its checkpoint."""
    action = _action(path)
    changed = _case_text(path) != m.case.to_yaml()
    return MemberFolder(path, Action.CONTINUE if changed and action is Action.KEEP else action)


def _latest(name: str) -> Path | None:
    try:
        return RunFolder.latest(name).path
    except FileNotFoundError:
        return None
