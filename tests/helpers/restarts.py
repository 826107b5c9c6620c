"""Runs that are continued from each of their checkpoints."""

from __future__ import annotations

import shutil
from pathlib import Path

from drillpetsc import load_case
from drillpetsc.analysis.motion import checkpoint
from drillpetsc.analysis.motion.transient import run


def files(folder: Path) -> dict[str, bytes]:
    """All files of a run without wall times."""
    return {
        str(p.relative_to(folder)): p.read_bytes()
        for p in sorted(folder.rglob("*"))
        if p.is_file() and p.name not in ("summary.json", "checkpoint.h5")
    }


def run_with_copies(case: Path, out: Path, monkeypatch) -> list[Path]:
    """Run a case, with copies of its folder after each checkpoint."""
    write, copies = checkpoint.write, []

    def write_and_copy(path: Path, c: checkpoint.Checkpoint) -> None:
        write(path, c)
        copies.append(out.with_name(f"{out.name}-at-{len(copies)}"))
        shutil.copytree(out, copies[-1])

    with monkeypatch.context() as patch:
        patch.setattr(checkpoint, "write", write_and_copy)
        run(load_case(case), out, progress="silent")
    return copies


def restarted_is_identical(case: Path, folder: Path, monkeypatch, which: slice, least: int = 3) -> Path:
    """Run a case and continue it from the checkpoints ``which``, of ``least`` at least: every file is the same.

    Returns the folder of the whole run.
    """
    copies = run_with_copies(case, folder / "run", monkeypatch)
    whole = files(folder / "run")
    assert len(copies) >= least and copies[which]
    for copy in copies[which]:
        run(load_case(case), copy, restart=True, progress="silent")
        continued = files(copy)
        assert continued.keys() == whole.keys(), copy
        for name, content in continued.items():
            assert content == whole[name], (copy, name)
    return folder / "run"
