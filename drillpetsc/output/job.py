"""What the computation of a command works on, and what it returns: its run folder, its summary and its report for the screen."""

from __future__ import annotations

import shlex
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from drillpetsc.case.case import Case
from drillpetsc.output.files.run_folder import RunFolder, make_folder


@dataclass
class RunResult:
    """Results of a command; the same on all ranks.

    folder: run folder
    summary: contents of its summary.json
    lines: report for the screen
    """

    folder: Path
    summary: dict[str, Any] = field(default_factory=dict)
    lines: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class Job:
    """A case, and where the results of its computation go.

    case: the user's case.
    out: run folder, None: a new one named after ``name``; overwrite: replace the results in an existing one.
    comm: PETSc communicator, None: all ranks.
    """

    case: Case
    out: str | Path | None = None
    overwrite: bool = False
    name: str = "case"
    communicator: Any = None

    @property
    def comm(self) -> Any:
        """PETSc communicator of the computation."""
        from petsc4py import PETSc

        return self.communicator or PETSc.COMM_WORLD

    def make_folder(self) -> RunFolder:
        """Make the run folder; collective.  A computation does so when nothing can be refused any more."""
        return make_folder(self.comm, self.name, self.out, False, self.overwrite)

    def result(self, folder: RunFolder, summary: dict[str, Any], lines: list[str]) -> RunResult:
        """The result in a run folder; the last line for the screen says how it is drawn again."""
        plot = f"scripts/drillpetsc plot {shlex.quote(str(folder.path))}"
        return RunResult(folder.path, summary, [*lines, f"  results: {folder.path}   ({plot})"])

    def noted(self, folder: RunFolder, summary: dict[str, Any], lines: list[str]) -> RunResult:
        """The result in a run folder; the last lines for the screen are its warnings, as notes, and the folder."""
        notes = (f"  note: {text}" for text in summary["warnings"])
        return RunResult(folder.path, summary, [*lines, *notes, f"  results: {folder.path}"])

    def of(self, case: Case) -> Job:
        """The same job on another case."""
        return replace(self, case=case)
