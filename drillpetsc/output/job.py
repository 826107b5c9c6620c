"""What the computation of a command works on, and what it returns: its run folder, its summary and its report for the screen."""

from __future__ import annotations

import shlex
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from drillpetsc.case.case import Case
from drillpetsc.output.files.json_file import write_summary
from drillpetsc.output.files.run_folder import RunFolder, make_folder, refuse_existing
from drillpetsc.output.files.tables import Row, write_rows
from drillpetsc.output.quantities.tables import columns_of
from drillpetsc.output.shown_units import lengths_shown


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

    def refuse_existing(self) -> None:
        """Raise CaseError if the run folder exists and may not be replaced; collective."""
        if self.out is not None and not self.overwrite:
            refuse_existing(self.comm, self.out)

    def make_folder(self) -> RunFolder:
        """Make the run folder; collective.  A computation does so when nothing can be refused any more."""
        return make_folder(self.comm, self.name, self.out, False, self.overwrite)

    def result(
        self,
        folder: RunFolder,
        summary: dict[str, Any],
        lines: list[str],
        tables: Mapping[str, Iterable[Row]] = {},
    ) -> RunResult:
        """Write case, tables and summary on the first rank, and return the result.

        The last lines for the screen are warnings and notes of the summary, the folder, and how it is drawn again.  Without notes of
        its own, a summary has them among its warnings.
        """
        if self.comm.rank == 0:
            folder.write_case(self.case)  # as the user has it; the summary has the operation
            for name, rows in tables.items():
                rows = list(rows)
                write_rows(folder.path / name, columns_of(name, rows), rows)
            write_summary(folder.summary, summary)
        word = "WARNING" if "notes" in summary else "note"
        said = [(word, text) for text in summary.get("warnings", ())]
        said += [("note", text) for text in summary.get("notes", ())]
        told = [f"  {word}: {lengths_shown(text, self.case.shown_units)}" for word, text in said]
        plot = f"scripts/drillpetsc plot {shlex.quote(str(folder.path))}"
        return RunResult(folder.path, summary, [*lines, *told, f"  results: {folder.path}   ({plot})"])

    def of(self, case: Case) -> Job:
        """The same job on another case."""
        return replace(self, case=case)
