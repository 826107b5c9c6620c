"""The command line: drillpetsc run | sweep | study | check | statics | modes | view | plot | schema."""

from __future__ import annotations

import argparse
import re
import sys
from pathlib import Path

from drillpetsc import __version__
from drillpetsc.errors import CaseError, DrillError

EPILOG = """Words that start with a dash and are PETSc options go to PETSc: -ts_rtol 1e-5 -ts_monitor -log_view ...
The time integrator is TS BDF with the condensed Newton solver (prefix q_): -ts_rtol (default 1e-4, relative to the usual size
of each unknown), -ts_bdf_order, -ts_dt, -ts_adapt_type none, -q_snes_stol, -q_snes_linesearch_type bt, -q_pc_type lu ...;
-snes_type newtonls solves the whole assembled system instead, -ts_type arkimex, alpha2, theta integrate it.
Exit status: 0 done, 1 the run failed (what was written is kept), 2 bad input (nothing written)."""


CHANGE = re.compile(r"[A-Za-z_]\w*(\[\d+\]|\.\w+)*\s*=")  # KEY=..., which is no value of a PETSc option


def parser() -> argparse.ArgumentParser:
    p = argparse.ArgumentParser(
        prog="drillpetsc",
        description="Drillstring dynamics on PETSc.",
        epilog=EPILOG,
        allow_abbrev=False,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    p.add_argument("--version", action="version", version=f"drillpetsc {__version__}")
    sub = p.add_subparsers(dest="command", required=True, metavar="COMMAND")

    def command(name: str, text: str) -> argparse.ArgumentParser:
        return sub.add_parser(
            name,
            help=text,
            description=text,
            epilog=EPILOG,
            allow_abbrev=False,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )

    run = command(
        "run", "simulate one case on all ranks, or several wells at once with the ranks shared out over them"
    )
    run.add_argument("cases", nargs="+", metavar="CASE.yaml")
    run.add_argument("--out", metavar="DIR", help="run folder (default: results/<case>-NNN)")
    run.add_argument("--restart", action="store_true", help="continue from the checkpoint in the run folder")
    run.add_argument("--overwrite", action="store_true", help="replace the results in an existing --out")
    run.add_argument(
        "--companion",
        action="store_true",
        help="run the case on elements twice as long, too, and state the differences as mesh error in summary.json (one case)",
    )
    run.add_argument(
        "--progress", choices=("auto", "live", "log", "silent"), default="auto", help="how progress is shown"
    )
    sweep = command(
        "sweep", "simulate every combination of some values, with the ranks shared out over the combinations"
    )
    sweep.add_argument("case", metavar="CASE.yaml")
    sweep.add_argument(
        "values",
        nargs="+",
        metavar="KEY=V1,V2",
        help="a key of the case file and its values: 'fluid.flow_rate=20 l/s,30 l/s'; commas inside brackets or quotes "
        "belong to a value; fluid=on,off leaves a block as it is, and takes it out",
    )
    sweep.add_argument(
        "--out",
        metavar="DIR",
        help="folder of the table and of the members' run folders (default: results/<case>-NNN)",
    )
    sweep.add_argument(
        "--restart", action="store_true", help="keep members that are done, continue those with a checkpoint"
    )
    sweep.add_argument("--overwrite", action="store_true", help="replace the results in an existing --out")
    sweep.add_argument(
        "--progress",
        choices=("auto", "silent"),
        default="auto",
        help="one line for each member that ends, or none",
    )
    study = command(
        "study",
        "error against run time: many runs of a case, a reference, a table and work-precision pictures",
    )
    study.add_argument("case", metavar="CASE.yaml")
    study.add_argument(
        "--vary",
        metavar="WHAT",
        help="time-step | tolerance | order | mesh | formulation | integrator | solver | ranks",
    )
    study.add_argument(
        "--curves",
        nargs="?",
        const="",
        metavar="NAMES",
        help="instead of --vary, several named curves at once (default: BDF 1 to 3 with fixed steps, BDF2, BDF3 and "
        "ARKIMEX over tolerances, the quaternion element with BDF 1 and 2)",
    )
    study.add_argument(
        "--values",
        default="",
        metavar="V1,V2",
        help="along the curve, or names of curves (default: around the case's own)",
    )
    study.add_argument(
        "--steps",
        default="",
        metavar="H1,H2",
        help="fixed steps of all curves that have them (default: around the mean)",
    )
    study.add_argument(
        "--tolerances",
        default="",
        metavar="T1,T2",
        help="tolerances of all adaptive curves (default: around -ts_rtol)",
    )
    study.add_argument(
        "--outputs",
        default="",
        metavar="A,B",
        help="columns of history.csv and probes.csv to compare (default: up to six)",
    )
    study.add_argument(
        "--repeats",
        type=int,
        default=3,
        help="runs of each point, for the median of their times (default: 3)",
    )
    study.add_argument(
        "--reference",
        default="auto",
        help="exact, arkimex, bdf3, bdf2, or a run folder (default: a closed form if there is one, else what works)",
    )
    study.add_argument(
        "--limit",
        type=float,
        default=600.0,
        metavar="S",
        help="wall seconds that one run may take, the reference three times as long (default: 600)",
    )
    study.add_argument(
        "--few", action="store_true", help="three points a curve, for a quick look (with --curves)"
    )
    study.add_argument(
        "--out", metavar="DIR", help="folder of table, pictures and runs (default: results/<case>-study-NNN)"
    )
    study.add_argument(
        "--restart", action="store_true", help="keep points that are done, run the others, failed ones too"
    )
    study.add_argument("--overwrite", action="store_true", help="replace the results in an existing --out")
    check = command("check", "read and validate a case, and say what the scene contains and leaves out")
    check.add_argument("case", metavar="CASE.yaml")
    statics = command("statics", "static equilibrium: torque and drag, contact forces, buckling state")
    statics.add_argument("case", metavar="CASE.yaml")
    statics.add_argument(
        "--motion",
        choices=("hoist", "lower", "rotate"),
        help="motion that friction opposes (default: the top's)",
    )
    statics.add_argument("--out", metavar="DIR", help="run folder (default: results/<case>-NNN)")
    statics.add_argument("--overwrite", action="store_true", help="replace the results in an existing --out")
    modes = command(
        "modes", "eigenvalues about the static or steady state: frequencies, damping, stability, mode shapes"
    )
    modes.add_argument("case", metavar="CASE.yaml")
    modes.add_argument(
        "--count", type=int, default=20, help="how many oscillating modes, the lowest (default: 20)"
    )
    modes.add_argument(
        "--shift",
        type=float,
        metavar="HZ",
        help="the modes nearest to this frequency instead of the lowest [Hz]",
    )
    modes.add_argument(
        "--kind",
        choices=("lateral", "axial", "torsional", "fluid"),
        help="modes of this kind alone (default: all)",
    )
    modes.add_argument(
        "--about",
        choices=("steady", "rest"),
        default="steady",
        help="the state: moving as the top prescribes at time 0, or at rest without friction (default: steady)",
    )
    modes.add_argument("--out", metavar="DIR", help="run folder (default: results/<case>-NNN)")
    modes.add_argument("--overwrite", action="store_true", help="replace the results in an existing --out")
    view = command("view", "picture or animation of the string in its hole")
    view.add_argument("run", metavar="RUN")
    view.add_argument("--field", default="axial_force [N]", help="what colours the string")
    view.add_argument(
        "--time", type=float, help="simulated time of the picture [s] (default: the last frame)"
    )
    view.add_argument("--animate", action="store_true", help="all frames, as an animation")
    view.add_argument(
        "--lateral-scale",
        type=float,
        help="exaggeration of lateral offsets (default: chosen, and stated in the picture)",
    )
    view.add_argument(
        "--interval", type=float, nargs=2, metavar=("FROM", "TO"), help="measured depths to look at [m]"
    )
    view.add_argument("--out", metavar="FILE")
    plot = command("plot", "time histories, probe orbits, forces along depth, as pictures")
    plot.add_argument("run", metavar="RUN")
    plot.add_argument("--out", metavar="DIR")
    schema = command("schema", "write the JSON schema of case files, for editors")
    schema.add_argument("file", nargs="?", metavar="FILE", help="default: standard output")
    return p


def main(words: list[str] | None = None) -> int:
    """Run the command line; returns the exit status."""
    words = sys.argv[1:] if words is None else words
    ours, petsc_names = _split(words)
    arguments, unknown = parser().parse_known_args(ours)
    try:
        if unknown:
            raise CaseError(
                at=unknown[0], want="a known --option (see --help), or a PETSc option with one dash"
            )
        if petsc_names and arguments.command not in ("run", "sweep", "study", "statics", "check", "modes"):
            raise CaseError(at=petsc_names[0], want=f"no PETSc options with {arguments.command}")
        return COMMANDS[arguments.command](arguments, petsc_names)
    except DrillError as error:
        return _fail(error)
    except KeyboardInterrupt:
        print("drillpetsc: interrupted; what was written up to now is kept", file=sys.stderr)
        if not _all_here():
            _TALK[0].Abort(1)
        return 1


def _split(words: list[str]) -> tuple[list[str], list[str]]:
    """Ours: words without a dash and with two; PETSc's: -word and the value after it (a number may be
    negative)."""
    ours: list[str] = []
    petsc_names: list[str] = []
    i = 0
    while i < len(words):
        word = words[i]
        if (
            word.startswith("-")
            and not word.startswith("--")
            and word not in ("-h",)
            and not _is_number(word)
            and len(word) > 1
        ):
            petsc_names.append(word)
            following = words[i + 1] if i + 1 < len(words) else "-"
            if (
                (not following.startswith("-") or _is_number(following))
                and not following.endswith((".yaml", ".yml"))
                and not (words[0] == "sweep" and CHANGE.match(following))
            ):
                petsc_names.append(following)
                i += 1
        else:
            ours.append(word)
        i += 1
    return ours, petsc_names


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _fail(error: DrillError) -> int:
    """One message for the whole job: rank 0 speaks, or whoever failed alone; that one then ends the job, in
    which others wait for it."""
    together = _all_here()
    if _rank() == 0 or not together:
        alone = "" if together else f"rank {_rank()}: "
        print(f"drillpetsc: {alone}{error}", file=sys.stderr)
    sys.stderr.flush()
    if not together:
        _TALK[0].Abort(error.exit_status)
    return error.exit_status


RANK_TIMEOUT = 5.0  # how long a rank that has failed waits for the others to fail as well [s]
_TALK: list = []  # communicator of all ranks for this alone, so that it meets no message of a computation


def _all_here() -> bool:
    """Whether all ranks have come to their end."""
    if not _TALK:
        return True
    from drillpetsc.studies.sweep.worker_groups import wait_for

    return wait_for(_TALK[0].Ibarrier(), RANK_TIMEOUT)


def _rank() -> int:
    if "petsc4py.PETSc" not in sys.modules:
        return 0
    from petsc4py import PETSc

    return PETSc.COMM_WORLD.rank


def _start_petsc(petsc_names: list[str]) -> None:
    import petsc4py

    petsc4py.init(["drillpetsc", *petsc_names])
    from petsc4py import PETSc

    PETSc.Log.begin()
    if PETSc.COMM_WORLD.size > 1:
        _TALK[:] = [PETSc.COMM_WORLD.tompi4py().Dup()]
        _abort_hook()


def _abort_hook() -> None:
    """An exception that is not ours to explain on one rank must not leave the others waiting."""
    from petsc4py import PETSc

    def hook(kind, value, trace) -> None:
        sys.__excepthook__(kind, value, trace)
        print(f"drillpetsc: rank {_rank()} failed, so the job is ended", file=sys.stderr, flush=True)
        PETSc.COMM_WORLD.tompi4py().Abort(1)

    sys.excepthook = hook


def _load(path: str):
    from drillpetsc.case import load_case

    return load_case(path)


def _run(arguments, petsc_names: list[str]) -> int:
    if len(arguments.cases) > 1 and arguments.companion:
        raise CaseError(at="--companion", want="one case")
    if len(arguments.cases) > 1:
        return _run_several(arguments, petsc_names)
    name, case = Path(arguments.cases[0]).stem, _load(arguments.cases[0])
    _start_petsc(petsc_names)
    from drillpetsc.analysis.summary import closing_lines
    from drillpetsc.analysis.transient import run

    result = run(
        case,
        arguments.out,
        restart=arguments.restart,
        overwrite=arguments.overwrite,
        name=name,
        progress=arguments.progress,
    )
    if _rank() == 0:
        print("\n".join(closing_lines(result.summary, result.folder)))
    if arguments.companion:
        from drillpetsc.studies.convergence.coarse_mesh import add_mesh_error, mesh_lines

        reported = add_mesh_error(case, result.folder, result.summary, name, progress=arguments.progress)
        if _rank() == 0:
            print("\n".join(mesh_lines(reported)))
    return 0


def _run_several(arguments, petsc_names: list[str]) -> int:
    _start_petsc(petsc_names)
    from drillpetsc.studies.sweep.sweep import run_cases

    return _ended(
        run_cases(
            arguments.cases,
            arguments.out,
            restart=arguments.restart,
            overwrite=arguments.overwrite,
            progress=arguments.progress,
        )
    )


def _sweep(arguments, petsc_names: list[str]) -> int:
    _start_petsc(petsc_names)
    from drillpetsc.studies.sweep.sweep import sweep
    from drillpetsc.studies.sweep.variations import choices_of

    return _ended(
        sweep(
            arguments.case,
            choices_of(arguments.values),
            arguments.out,
            restart=arguments.restart,
            overwrite=arguments.overwrite,
            progress=arguments.progress,
        )
    )


def _study(arguments, petsc_names: list[str]) -> int:
    from drillpetsc.studies.convergence.plan import options_of
    from drillpetsc.studies.convergence.study import closing_lines, study
    from drillpetsc.studies.sweep.variations import split_values

    def listed(text: str | None) -> list[str]:
        return split_values(text) if text else []

    result = study(
        arguments.case,
        arguments.vary,
        None if arguments.curves is None else listed(arguments.curves),
        values=listed(arguments.values),
        outputs=listed(arguments.outputs),
        repeats=arguments.repeats,
        reference=arguments.reference,
        out=arguments.out,
        restart=arguments.restart,
        overwrite=arguments.overwrite,
        options=options_of(petsc_names),
        limit=arguments.limit,
        few=arguments.few,
        steps=listed(arguments.steps),
        tolerances=listed(arguments.tolerances),
    )
    print("\n".join(closing_lines(result)))
    return 1 if result.useless else 0


def _ended(result) -> int:
    """The end of a job of several members: 1 when any failed."""
    from drillpetsc.studies.sweep.sweep import closing_lines

    if _rank() == 0:
        print("\n".join(closing_lines(result)))
    return 1 if result.failed else 0


def _check(arguments, petsc_names: list[str]) -> int:
    case = _load(arguments.case)
    _start_petsc(petsc_names)
    from drillpetsc.analysis.check import describe

    print(describe(case))
    return 0


def _statics(arguments, petsc_names: list[str]) -> int:
    case = _load(arguments.case)
    _start_petsc(petsc_names)
    from drillpetsc.analysis.statics import run_statics

    lines = run_statics(case, arguments.out, arguments.motion, arguments.overwrite, Path(arguments.case).stem)
    if _rank() == 0:
        print("\n".join(lines))
    return 0


def _modes(arguments, petsc_names: list[str]) -> int:
    case = _load(arguments.case)
    _start_petsc(petsc_names)
    from drillpetsc.analysis.modal import run_modes

    lines = run_modes(
        case,
        arguments.out,
        arguments.count,
        arguments.shift,
        arguments.kind,
        arguments.about,
        arguments.overwrite,
        Path(arguments.case).stem,
    )
    if _rank() == 0:
        print("\n".join(lines))
    return 0


def _view(arguments, petsc_names: list[str]) -> int:
    from drillpetsc.plotting.view import view

    interval = tuple(arguments.interval) if arguments.interval else None
    return _drawn(
        lambda: [
            view(
                arguments.run,
                arguments.out,
                field=arguments.field,
                time=arguments.time,
                animate=arguments.animate,
                lateral_scale=arguments.lateral_scale,
                interval=interval,
                say=print,
            )
        ],
        arguments.run,
    )


def _plot(arguments, petsc_names: list[str]) -> int:
    from drillpetsc.plotting.plot import plot

    return _drawn(lambda: plot(arguments.run, arguments.out), arguments.run)


def _drawn(make, run: str) -> int:
    try:
        files = make()
    except (OSError, ValueError) as error:
        raise CaseError(got=run, want=str(error)) from None
    for file in files:
        print(file)
    return 0


def _schema(arguments, petsc_names: list[str]) -> int:
    import json

    from drillpetsc.case import case_json_schema, write_schema

    if arguments.file:
        write_schema(arguments.file)
    else:
        print(json.dumps(case_json_schema(), indent=2))
    return 0


COMMANDS = {
    "run": _run,
    "sweep": _sweep,
    "study": _study,
    "check": _check,
    "statics": _statics,
    "modes": _modes,
    "view": _view,
    "plot": _plot,
    "schema": _schema,
}
