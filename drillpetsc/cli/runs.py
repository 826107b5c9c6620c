"""Commands that simulate in time: run, sweep, study."""

from __future__ import annotations

import argparse
from pathlib import Path

from drillpetsc.cli.command import (
    Command,
    case_argument,
    in_units,
    output_folder,
    print_once,
    print_warnings,
    set_argument,
    units_argument,
)
from drillpetsc.errors import CaseError
from drillpetsc.parallel import start_job


def _run_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument("cases", nargs="+", metavar="CASE.yaml")
    set_argument(command, " (one case)")
    command.add_argument(
        "--mesh-error",
        action="store_true",
        help="run the case on elements twice as long, too, and state the differences as mesh error in summary.json (one case)",
    )
    command.add_argument(
        "--check-tolerance",
        action="store_true",
        help="run the case at a tenth of its tolerance, too: warn where the class of motion (whirl, contact, sliding, sticking) changes, or a "
        "mean or range of the history by more than 1 %% (one case; costs 2 to 3 times the run)",
    )
    command.add_argument(
        "--accept-changes",
        action="store_true",
        help="with --restart: continue although the case or the PETSc options have changed (one case)",
    )
    command.add_argument(
        "--progress", choices=("auto", "live", "log", "silent"), default="auto", help="how progress is shown"
    )
    units_argument(command)


def _run(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    if arguments.accept_changes and not arguments.restart:
        raise CaseError(at="--accept-changes", want="--accept-changes together with --restart")
    if len(arguments.cases) > 1:
        return _run_several(arguments, petsc_options)
    from drillpetsc.case import load_case

    name = Path(arguments.cases[0]).stem
    case = in_units(load_case(arguments.cases[0], arguments.set), arguments.units)
    start_job(petsc_options)
    print_warnings(case)
    from drillpetsc.analysis.summary import closing_lines
    from drillpetsc.analysis.transient import run

    result = run(
        case,
        arguments.out,
        restart=arguments.restart,
        overwrite=arguments.overwrite,
        accept_changes=arguments.accept_changes,
        name=name,
        progress=arguments.progress,
        watch_motion=arguments.check_tolerance,
    )
    print_once(closing_lines(result.summary, result.folder, case.output.units, arguments.check_tolerance))
    summary = result.summary
    if arguments.mesh_error:
        from drillpetsc.studies.convergence.coarse_mesh import add_mesh_error, mesh_lines

        summary = add_mesh_error(case, result.folder, summary, name, progress=arguments.progress)
        print_once(mesh_lines(summary))
    if arguments.check_tolerance:
        from drillpetsc.studies.convergence.fine_tolerance import add_tolerance_check, tolerance_lines

        summary = add_tolerance_check(case, result.folder, summary, name, progress=arguments.progress)
        print_once(tolerance_lines(summary))
    return 0


def _run_several(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    if arguments.mesh_error:
        raise CaseError(at="--mesh-error", want="one case")
    if arguments.check_tolerance:
        raise CaseError(at="--check-tolerance", want="one case")
    if arguments.accept_changes:
        raise CaseError(at="--accept-changes", want="one case")
    if arguments.units:
        raise CaseError(at="--units", got=arguments.units, want="one case, or the key units of each")
    if arguments.set:
        raise CaseError(at="--set", got=arguments.set[0], want="one case", hint="the keys of each case file")
    start_job(petsc_options)
    from drillpetsc.studies.sweep.sweep import closing_lines, run_cases

    result = run_cases(
        arguments.cases,
        arguments.out,
        restart=arguments.restart,
        overwrite=arguments.overwrite,
        progress=arguments.progress,
    )
    print_once(closing_lines(result))
    return 1 if result.failed else 0


def _sweep_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument("case", metavar="CASE.yaml")
    command.add_argument(
        "values",
        nargs="+",
        metavar="KEY=V1,V2",
        help="a key of the case file and its values: 'fluid.flow_rate=20 l/s,30 l/s'; commas inside brackets or quotes "
        "belong to a value; fluid=on,off leaves a block as it is, and takes it out",
    )
    command.add_argument(
        "--progress",
        choices=("auto", "silent"),
        default="auto",
        help="one line for each member that ends, or none",
    )


def _sweep(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    start_job(petsc_options)
    from drillpetsc.studies.sweep.sweep import closing_lines, sweep
    from drillpetsc.studies.sweep.variations import choices_of

    result = sweep(
        arguments.case,
        choices_of(arguments.values),
        arguments.out,
        restart=arguments.restart,
        overwrite=arguments.overwrite,
        progress=arguments.progress,
    )
    print_once(closing_lines(result))
    return 1 if result.failed else 0


def _study_arguments(command: argparse.ArgumentParser) -> None:
    case_argument(command)
    command.add_argument(
        "--vary",
        metavar="WHAT",
        help="time-step | tolerance | order | mesh | formulation | integrator | solver | ranks",
    )
    command.add_argument(
        "--curves",
        nargs="?",
        const="",
        metavar="NAMES",
        help="instead of --vary, several named curves at once (default: BDF 1 to 3 with fixed steps, BDF2, BDF3 and "
        "ARKIMEX over tolerances, the quaternion element with BDF 1 and 2)",
    )
    command.add_argument(
        "--values",
        default="",
        metavar="V1,V2",
        help="along the curve, or names of curves (default: around the case's own)",
    )
    command.add_argument(
        "--steps",
        default="",
        metavar="H1,H2",
        help="fixed steps of all curves that have them (default: around the mean)",
    )
    command.add_argument(
        "--tolerances",
        default="",
        metavar="T1,T2",
        help="tolerances of all adaptive curves (default: around -ts_rtol)",
    )
    command.add_argument(
        "--outputs",
        default="",
        metavar="A,B",
        help="columns of history.csv and probes.csv to compare (default: up to six)",
    )
    command.add_argument(
        "--repeats",
        type=int,
        default=3,
        help="runs of each point, for the median of their times (default: 3)",
    )
    command.add_argument(
        "--reference",
        default="auto",
        help="exact, arkimex, bdf3, bdf2, or a run folder (default: a closed form if there is one, else what works)",
    )
    command.add_argument(
        "--limit",
        type=float,
        default=600.0,
        metavar="S",
        help="wall seconds that one run may take, the reference three times as long (default: 600)",
    )
    command.add_argument(
        "--few", action="store_true", help="three points a curve, for a quick look (with --curves)"
    )


def _study(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.studies.convergence.plan import options_of
    from drillpetsc.studies.convergence.study import closing_lines, study
    from drillpetsc.studies.sweep.variations import split_values

    def entries(text: str | None) -> list[str]:
        return split_values(text) if text else []

    result = study(
        arguments.case,
        arguments.vary,
        None if arguments.curves is None else entries(arguments.curves),
        values=entries(arguments.values),
        outputs=entries(arguments.outputs),
        repeats=arguments.repeats,
        reference=arguments.reference,
        out=arguments.out,
        restart=arguments.restart,
        overwrite=arguments.overwrite,
        options=options_of(petsc_options),
        changes=arguments.set,
        limit=arguments.limit,
        few=arguments.few,
        steps=entries(arguments.steps),
        tolerances=entries(arguments.tolerances),
    )
    print("\n".join(closing_lines(result)))
    return 1 if result.useless else 0


COMMANDS = (
    Command(
        "run",
        "simulate one case on all ranks, or several wells at once with the ranks shared out over them",
        _run_arguments,
        _run,
        parents=(output_folder(restart="continue from the checkpoint in the run folder"),),
    ),
    Command(
        "sweep",
        "simulate every combination of some values, with the ranks shared out over the combinations",
        _sweep_arguments,
        _sweep,
        parents=(
            output_folder(
                "folder of the table and of the members' run folders (default: results/<case>-NNN)",
                "keep members that are done, continue those with a checkpoint",
            ),
        ),
    ),
    Command(
        "study",
        "error against run time: many runs of a case, a reference, a table and work-precision pictures",
        _study_arguments,
        _study,
        parents=(
            output_folder(
                "folder of table, pictures and runs (default: results/<case>-study-NNN)",
                "keep points that are done, run the others, failed ones too",
            ),
        ),
    ),
)
