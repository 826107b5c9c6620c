"""Where the members of an ensemble are computed, and what is left to do there; one process decides this,
before any runs."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

from drillpetsc.errors import CaseError
from drillpetsc.output import RunFolder, read_summary
from drillpetsc.studies.sweep.table import AGAIN, CONTINUE, KEEP, NEW, Member, MemberFolder, Plan

SWEEP, WELLS = "sweep.csv", "wells.csv"
STATE = ".members"
PICTURES = ("trajectory.png", "inclination.png", "build_rate.png")  # of what the members of a sweep drilled

Out = str | Path | None


def plan_sweep(
    title: str, name: str, members: list[Member], out: Out, restart: bool, overwrite: bool
) -> Plan:
    if restart and out is None:
        out = _latest_sweep(name)
    found = RunFolder.create(
        name, out, restart=restart, overwrite=overwrite
    )  # held until the job ends (ensemble._Job.end)
    folder = found.path
    if restart and not (folder / SWEEP).is_file():
        found.release()
        raise CaseError(
            at="--out",
            got=str(folder),
            want=f"the folder of a sweep, with a {SWEEP}",
            hint="--restart continues a sweep",
        )
    if overwrite:
        _clear(folder)
    places = (
        _places(folder, members)
        if restart
        else [MemberFolder(folder / m.name, AGAIN if overwrite else NEW) for m in members]
    )
    return Plan(title, SWEEP, folder, _state(folder), tuple(members), tuple(places))


def _latest_sweep(name: str) -> Path:
    sweeps = sorted(
        Path("results").glob(f"{name}-*/{SWEEP}"), key=lambda file: (len(file.parent.name), file.parent.name)
    )
    if not sweeps:
        raise CaseError(
            got=f"results/{name}-NNN", want="a sweep to continue", hint="name its folder with --out"
        )
    return sweeps[-1].parent


def _clear(folder: Path) -> None:
    """Remove the members of an earlier sweep, but nothing that is not theirs."""
    for name in (SWEEP, *PICTURES):
        (folder / name).unlink(missing_ok=True)
    for old in folder.glob("member-*"):
        if old.is_dir():
            RunFolder(old).clear()
            if not any(old.iterdir()):
                old.rmdir()


def _state(folder: Path) -> Path:
    state = folder / STATE
    shutil.rmtree(state, ignore_errors=True)  # claims of a job that was stopped
    state.mkdir(parents=True)
    return state


def _places(folder: Path, members: list[Member]) -> list[MemberFolder]:
    """For a restart: the folder in which the same case was run, wherever it stands; a new one for a member
    that has none."""
    known: dict[str, list[Path]] = {}
    for path in sorted(folder.glob("member-*")):
        if text := _case_text(path):
            known.setdefault(text, []).append(path)
    taken = {path for several in known.values() for path in several}
    places = []
    for m in members:
        same = known.get(m.case.to_yaml())
        if same:
            places.append(MemberFolder(same[0], _action(same[0])))
            same.pop(0)  # 1 m and 100 cm are two members
            continue
        number = m.number
        while (path := folder / f"member-{number:03d}") in taken:
            number = max(number + 1, len(members) + 1)
        taken.add(path)
        places.append(MemberFolder(path, AGAIN if path.exists() else NEW))
    return places


def _case_text(folder: Path) -> str:
    file = RunFolder(folder).case
    return file.read_text(encoding="utf-8") if file.is_file() else ""


def _action(folder: Path) -> str:
    """What is left to do in a run folder of the same case."""
    found = RunFolder(folder)
    if found.summary.is_file() and read_summary(found.summary).get("status") == "done":
        return KEEP
    return CONTINUE if found.checkpoint.is_file() else AGAIN


def plan_wells(members: list[Member], out: Out, restart: bool, overwrite: bool) -> Plan:
    folder = (
        RunFolder.create("wells", out, restart=restart, overwrite=overwrite).path if out is not None else None
    )
    places = []
    for m in members:
        path = folder / m.name if folder is not None else _latest(m.name) if restart else None
        if path is None:
            made = RunFolder.create(m.name)
            made.release()  # to the rank that will compute it
            places.append(MemberFolder(made.path, AGAIN))
        elif restart and path.is_dir():
            places.append(_again(path, m))
        else:
            places.append(MemberFolder(path, AGAIN if overwrite else NEW))
    if folder is not None:
        return Plan("", WELLS, folder, _state(folder), tuple(members), tuple(places))
    return Plan(
        "",
        WELLS,
        None,
        Path(tempfile.mkdtemp(prefix=".wells-", dir="results")),
        tuple(members),
        tuple(places),
    )


def _again(path: Path, m: Member) -> MemberFolder:
    """For a restart: a case that was changed (a later end) goes on from its checkpoint, as with one well."""
    action = _action(path)
    changed = _case_text(path) != m.case.to_yaml()
    return MemberFolder(path, CONTINUE if changed and action == KEEP else action)


def _latest(name: str) -> Path | None:
    try:
        return RunFolder.latest(name).path
    except FileNotFoundError:
        return None
