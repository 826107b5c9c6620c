"""Commands that simulate in time: run, sweep, study."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any, Literal

from drillpetsc.errors import CaseError
from drillpetsc.operations.fields import Names, entries
from drillpetsc.operations.operation import (
    CHANGE,
    CaseFile,
    Changes,
    Mark,
    Operation,
    Overwrite,
    Units,
    in_units,
    print_once,
    print_warnings,
)
from drillpetsc.parallel import start_job


class Run(Operation):
    """Simulate one case on all ranks, or several wells at once with the ranks shared out over them."""

    petsc = True
    cases: Annotated[tuple[str, ...], Mark.ARGUMENT, "CASE.yaml", "the case file, or several"]
    set: Annotated[tuple[str, ...], "KEY=VALUE", f"{CHANGE} (one case)"] = ()
    mesh_error: Annotated[
        bool,
        "run the case on elements twice as long, too, and state the differences as mesh error in summary.json (one case)",
    ] = False
    check_tolerance: Annotated[
        bool,
        "run the case at a tenth of its tolerance, too: warn where the class of motion (whirl, contact, sliding, sticking) changes, or a "
        "mean or range of the history by more than 1 % (one case; costs 2 to 3 times the run)",
    ] = False
    accept_changes: Annotated[
        bool, "with --restart: continue although the case or the PETSc options have changed (one case)"
    ] = False
    progress: Annotated[Literal["auto", "live", "log", "silent"], "how progress is shown"] = "auto"
    units: Units = None
    out: Annotated[str | None, "DIR", "run folder (default: results/<case>-NNN)"] = None
    restart: Annotated[bool, "continue from the checkpoint in the run folder"] = False
    overwrite: Overwrite = False

    def run(self, petsc_options: list[str]) -> int:
        """Read the case before PETSc starts; print what the run says before the runs that check it."""
        if self.accept_changes and not self.restart:
            raise CaseError(at="--accept-changes", want="--accept-changes together with --restart")
        if len(self.cases) > 1:
            return self._run_several(petsc_options)
        from drillpetsc.case import load_case

        name = Path(self.cases[0]).stem
        case = in_units(load_case(self.cases[0], self.set), self.units)
        start_job(petsc_options)
        print_warnings(case)
        from drillpetsc.analysis.motion.summary import closing_lines
        from drillpetsc.analysis.motion.transient import run

        result = run(
            case,
            self.out,
            restart=self.restart,
            overwrite=self.overwrite,
            accept_changes=self.accept_changes,
            name=name,
            progress=self.progress,
            watch_motion=self.check_tolerance,
        )
        print_once(closing_lines(result.summary, result.folder, case.output.units, self.check_tolerance))
        summary = result.summary
        if self.mesh_error:
            from drillpetsc.studies.convergence.coarse_mesh import add_mesh_error, mesh_lines

            summary = add_mesh_error(case, result.folder, summary, name, progress=self.progress)
            print_once(mesh_lines(summary))
        if self.check_tolerance:
            from drillpetsc.studies.convergence.fine_tolerance import add_tolerance_check, tolerance_lines

            summary = add_tolerance_check(case, result.folder, summary, name, progress=self.progress)
            print_once(tolerance_lines(summary))
        return 0

    def _run_several(self, petsc_options: list[str]) -> int:
        for name in ("mesh_error", "check_tolerance", "accept_changes"):
            if getattr(self, name):
                raise CaseError(at="--" + name.replace("_", "-"), want="one case")
        if self.units:
            raise CaseError(at="--units", got=self.units, want="one case, or the key units of each")
        if self.set:
            raise CaseError(at="--set", got=self.set[0], want="one case", hint="the keys of each case file")
        start_job(petsc_options)
        from drillpetsc.studies.sweep.sweep import closing_lines, run_cases

        result = run_cases(
            self.cases, self.out, restart=self.restart, overwrite=self.overwrite, progress=self.progress
        )
        print_once(closing_lines(result))
        return 1 if result.failed else 0


class Sweep(Operation):
    """Simulate every combination of some values, with the ranks shared out over the combinations."""

    petsc = True
    case: CaseFile
    values: Annotated[
        tuple[str, ...],
        Mark.ARGUMENT,
        "KEY=V1,V2",
        "a key of the case file and its values: 'fluid.flow_rate=20 l/s,30 l/s'; commas inside brackets or quotes "
        "belong to a value; fluid=on,off leaves a block as it is, and takes it out",
    ]
    progress: Annotated[Literal["auto", "silent"], "one line for each member that ends, or none"] = "auto"
    out: Annotated[
        str | None, "DIR", "folder of the table and of the members' run folders (default: results/<case>-NNN)"
    ] = None
    restart: Annotated[bool, "keep members that are done, continue those with a checkpoint"] = False
    overwrite: Overwrite = False

    def compute(self, job: Any) -> Any:
        from drillpetsc.studies.sweep.sweep import sweep
        from drillpetsc.studies.sweep.variations import choices_of, variations

        choices = choices_of(self.values)
        print_warnings(*(member.case for member in variations(self.case, choices)))
        return sweep(
            self.case,
            choices,
            self.out,
            restart=self.restart,
            overwrite=self.overwrite,
            progress=self.progress,
        )

    def printed(self, result: Any) -> Iterable[Any]:
        from drillpetsc.studies.sweep.sweep import closing_lines

        return closing_lines(result)

    def show(self, result: Any) -> int:
        """Print the lines; a member that failed makes the exit status 1."""
        return super().show(result) or int(result.failed > 0)


class Study(Operation):
    """Error against run time: many runs of a case, a reference, a table and work-precision pictures."""

    petsc = True
    case: CaseFile
    set: Changes = ()
    vary: Annotated[
        str | None, "WHAT", "time-step | tolerance | order | mesh | formulation | integrator | solver | ranks"
    ] = None
    curves: Annotated[
        str | bool | None,
        entries,
        "NAMES",
        "instead of --vary, several named curves at once (default: BDF 1 to 3 with fixed steps, BDF2, BDF3 and "
        "ARKIMEX over tolerances, the quaternion element with BDF 1 and 2)",
    ] = None
    values: Annotated[
        Names, entries, "V1,V2", "along the curve, or names of curves (default: around the case's own)"
    ] = ""
    steps: Annotated[
        Names, entries, "H1,H2", "fixed steps of all curves that have them (default: around the mean)"
    ] = ""
    tolerances: Annotated[
        Names, entries, "T1,T2", "tolerances of all adaptive curves (default: around -ts_rtol)"
    ] = ""
    outputs: Annotated[
        Names, entries, "A,B", "columns of history.csv and probes.csv to compare (default: up to six)"
    ] = ""
    repeats: Annotated[int, "runs of each point, for the median of their times"] = 3
    reference: Annotated[
        str,
        "exact, arkimex, bdf3, bdf2, or a run folder; auto: a closed form if there is one, else what works",
    ] = "auto"
    limit: Annotated[float, "S", "wall seconds that one run may take, the reference three times as long"] = (
        600.0
    )
    few: Annotated[bool, "three points a curve, for a quick look (with --curves)"] = False
    out: Annotated[
        str | None, "DIR", "folder of table, pictures and runs (default: results/<case>-study-NNN)"
    ] = None
    restart: Annotated[bool, "keep points that are done, run the others, failed ones too"] = False
    overwrite: Overwrite = False

    def run(self, petsc_options: list[str]) -> int:
        """Run the study in this process without PETSc: each of its runs starts MPI itself, with the options."""
        from drillpetsc.studies.convergence.plan import options_of
        from drillpetsc.studies.convergence.study import closing_lines, study

        q = self.read(None)
        given = {option.name: getattr(q, option.name) for option in q.options() if option.name != "set"}
        result = study(**given, changes=self.set, options=options_of(petsc_options))
        print_once(closing_lines(result))
        return 1 if result.useless else 0
