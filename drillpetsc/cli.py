"""The command line: parser and dispatch.

A command is one entry of COMMANDS and a handler. Handlers import what they need, so that no command waits for
the imports of another.
"""

from __future__ import annotations

import argparse
import os
import re
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drillpetsc import __version__
from drillpetsc.errors import CaseError, DrillError, SolveError
from drillpetsc.parallel import report_error, report_interrupt, start_job, world_rank

if TYPE_CHECKING:
    from drillpetsc.case import Case

EXIT_STATUS = (
    "Exit status: 0 done, 1 the run failed (what was written is kept), 2 bad input (nothing written)."
)
EPILOG = f"""Words that start with a dash and are PETSc options go to PETSc: -ts_rtol 1e-5 -ts_monitor -log_view ...
The time integrator is TS BDF with the condensed Newton solver (prefix q_): -ts_rtol (default 1e-4, relative to the usual size
of each unknown), -ts_bdf_order, -ts_dt, -ts_adapt_type none, -q_snes_stol, -q_snes_linesearch_type bt, -q_pc_type lu ...;
Newton also goes on while what it leaves does more work than -drillpetsc_newton_work (default 1e-3) of the power exchanged;
-snes_type newtonls solves the whole assembled system instead, -ts_type arkimex, theta integrate it.
{EXIT_STATUS}"""

RENAMED_OPTIONS = {"--companion": "--mesh-error"}  # old -> new

_CASE_KEY = re.compile(r"[A-Za-z_]\w*(\[\d+\]|\.\w+)*\s*=")  # KEY=..., which is no value of a PETSc option


@dataclass(frozen=True)
class Command:
    """A command of the command line."""

    name: str
    help: str
    add_arguments: Callable[[argparse.ArgumentParser], None]
    handler: Callable[[argparse.Namespace, list[str]], int]
    """(arguments, PETSc options) -> exit status."""
    takes_petsc_options: bool = True
    parents: tuple[argparse.ArgumentParser, ...] = ()
    """Parsers whose arguments the command takes, too."""


def main(words: list[str] | None = None) -> int:
    """Run the command line and return the exit status.

    words: command line without the name of the program; by default that of this process
    """
    try:
        try:
            return _main(words)
        finally:
            sys.stdout.flush()
    except BrokenPipeError:  # the reader, `head` for instance, has read enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0


def _main(words: list[str] | None) -> int:
    words = sys.argv[1:] if words is None else words
    own, petsc_options = split_words(words)
    arguments, unknown = parser().parse_known_args(own)
    command = next(command for command in COMMANDS if command.name == arguments.command)
    try:
        if unknown:
            raise _unknown_option(unknown[0])
        if petsc_options and not command.takes_petsc_options:
            raise CaseError(at=petsc_options[0], want=f"no PETSc options with {command.name}")
        return command.handler(arguments, petsc_options)
    except DrillError as error:
        return report_error(error)
    except KeyboardInterrupt:
        return report_interrupt()
    except RuntimeError as error:  # PETSc.Error is one
        if "petsc4py.PETSc" not in sys.modules or not isinstance(error, sys.modules["petsc4py.PETSc"].Error):
            raise
        from drillpetsc.petsc_compat import reason_of

        return report_error(SolveError(f"PETSc failed: {reason_of(error)}", hint="check the PETSc options"))


def parser() -> argparse.ArgumentParser:
    """The parser of all commands."""
    whole = argparse.ArgumentParser(
        prog="drillpetsc", description="Drillstring dynamics on PETSc.", **_PARSER_STYLE
    )
    whole.add_argument("--version", action="version", version=f"drillpetsc {__version__}")
    sub = whole.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for command in COMMANDS:
        command.add_arguments(
            sub.add_parser(
                command.name,
                help=command.help,
                description=command.help,
                parents=list(command.parents),
                **(_PARSER_STYLE if command.takes_petsc_options else _PARSER_STYLE | {"epilog": EXIT_STATUS}),
            )
        )
    return whole


_PARSER_STYLE: dict[str, Any] = {
    "epilog": EPILOG,
    "allow_abbrev": False,
    "formatter_class": argparse.RawDescriptionHelpFormatter,
}


def split_words(words: list[str]) -> tuple[list[str], list[str]]:
    """(words of this program, PETSc options).

    Words of this program have no dash or two. A PETSc option is -word and the value after it, which may be a
    negative number.
    """
    own: list[str] = []
    petsc_options: list[str] = []
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
            petsc_options.append(word)
            following = words[i + 1] if i + 1 < len(words) else "-"
            if (
                (not following.startswith("-") or _is_number(following))
                and not following.endswith((".yaml", ".yml"))
                and not (words[0] == "sweep" and _CASE_KEY.match(following))
            ):
                petsc_options.append(following)
                i += 1
        else:
            own.append(word)
        i += 1
    return own, petsc_options


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _unknown_option(word: str) -> CaseError:
    old = word.partition("=")[0]
    if old in RENAMED_OPTIONS:
        new = RENAMED_OPTIONS[old]
        return CaseError(at=old, want=new, hint=f"{old} is now called {new}")
    return CaseError(at=word, want="a known --option (see --help), or a PETSc option with one dash")


# ---------------------------------------------------------------------- arguments
def _output_folder(
    out: str = "run folder (default: results/<case>-NNN)", restart: str = ""
) -> argparse.ArgumentParser:
    """Parent parser with --out and --overwrite, and with --restart where a help text for it is given.

    out: help text of --out
    restart: help text of --restart
    """
    parent = argparse.ArgumentParser(add_help=False)
    parent.add_argument("--out", metavar="DIR", help=out)
    if restart:
        parent.add_argument("--restart", action="store_true", help=restart)
    parent.add_argument("--overwrite", action="store_true", help="replace the results in an existing --out")
    return parent


def _case_argument(command: argparse.ArgumentParser) -> None:
    command.add_argument("case", metavar="CASE.yaml")


def _check_arguments(command: argparse.ArgumentParser) -> None:
    _case_argument(command)
    _units_argument(command)


def _units_argument(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--units",
        choices=("field", "metric", "metric_t", "SI"),
        help="units of what is printed and plotted (default: the case's; files stay in SI); metric_t: forces in tonnes",
    )


def _run_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument("cases", nargs="+", metavar="CASE.yaml")
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
    _units_argument(command)


def _sweep_arguments(command: argparse.ArgumentParser) -> None:
    _case_argument(command)
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


def _study_arguments(command: argparse.ArgumentParser) -> None:
    _case_argument(command)
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


def _statics_arguments(command: argparse.ArgumentParser) -> None:
    _case_argument(command)
    _units_argument(command)
    command.add_argument(
        "--motion",
        choices=("hoist", "lower", "rotate"),
        help="motion that friction opposes (default: the top's)",
    )
    command.add_argument(
        "--path",
        choices=("sliding", "slack_off"),
        help="follow the history of a buckled string with friction: the whole string slides (gives the band of states), "
        "or it is lowered onto a bit that stands",
    )


def _hydraulics_arguments(command: argparse.ArgumentParser) -> None:
    _case_argument(command)
    command.add_argument(
        "--flow",
        metavar="Q1,Q2",
        help="flow rates, such as '400,500,600 gpm' or '20..60 l/s' (default: the case's)",
    )
    command.add_argument(
        "--spp", metavar="P", help="instead, the flow rate at this pump pressure, such as '3000 psi'"
    )
    _units_argument(command)


def _surge_arguments(command: argparse.ArgumentParser) -> None:
    _case_argument(command)
    command.add_argument(
        "--speed",
        metavar="V1,V2",
        required=True,
        help="trip speeds, such as '30,60,90 ft/min' or '20..200 ft/min'",
    )
    command.add_argument(
        "--operation", default="trip_in,trip_out", metavar="A,B", help="trip_in, trip_out (default: both)"
    )
    command.add_argument(
        "--pipe",
        default="closed,open",
        metavar="A,B",
        help="closed: no flow through the bit; open: open at the top, too; pumping: with --flow (default: closed,open)",
    )
    command.add_argument(
        "--bit-depth", metavar="D1,D2", help="measured depths of the bit (default: the case's)"
    )
    command.add_argument(
        "--window",
        metavar="PORE,FRAC",
        help="limits of the open hole, such as '11.2,13.8 ppg' (default: the case's window)",
    )
    command.add_argument("--flow", metavar="Q", help="flow rate of --pipe pumping (default: the case's)")
    _units_argument(command)


def _limits_arguments(command: argparse.ArgumentParser) -> None:
    _case_argument(command)
    command.add_argument(
        "--operation",
        metavar="WORD",
        help="trip_in, trip_out, rotate_off_bottom, drilling, sliding, backreaming; or slackoff, pickup, rob "
        "(default: the case as it is, moving as its top prescribes)",
    )
    command.add_argument(
        "--helical", choices=("chen", "wu"), default="chen", help="law of the helical limit (default: chen)"
    )
    command.add_argument(
        "--design-factor",
        type=float,
        default=1.25,
        help="least yield strength over von Mises stress, below which a warning is given (default: 1.25)",
    )
    command.add_argument(
        "--tension-fraction",
        type=float,
        default=0.9,
        help="share of the pull at yield that tension_limit allows (default: 0.9)",
    )
    _units_argument(command)


def _freepoint_arguments(command: argparse.ArgumentParser) -> None:
    _case_argument(command)
    command.add_argument(
        "--stretch",
        metavar="E1,E2",
        required=True,
        help="stretch at the surface under each pull, such as '24 in' or '10,24 in'",
    )
    command.add_argument(
        "--pull",
        metavar="F1,F2",
        required=True,
        help="pulls beyond the weight of the free string, such as '30 klb' or '12,30 klb'",
    )
    _units_argument(command)


def _roadmap_arguments(command: argparse.ArgumentParser) -> None:
    _case_argument(command)
    command.add_argument(
        "--measured", metavar="FILE", help="measured points to plot: CSV, xlsx or LAS (default: the case's)"
    )
    _units_argument(command)


def _calibrate_arguments(command: argparse.ArgumentParser) -> None:
    _case_argument(command)
    command.add_argument(
        "--measured", metavar="FILE", help="measured points: CSV, xlsx or LAS (default: the case's)"
    )
    command.add_argument(
        "--fit",
        metavar="A,B",
        help="what is fitted: cased, open_hole, block_weight, weight_factor (default: cased,open_hole)",
    )
    _units_argument(command)


def _modes_arguments(command: argparse.ArgumentParser) -> None:
    _case_argument(command)
    command.add_argument(
        "--count", type=int, default=20, help="how many oscillating modes, the lowest (default: 20)"
    )
    command.add_argument(
        "--shift",
        type=float,
        metavar="HZ",
        help="the modes nearest to this frequency instead of the lowest [Hz]",
    )
    command.add_argument(
        "--kind",
        choices=("lateral", "axial", "torsional", "fluid"),
        help="modes of this kind alone (default: all)",
    )
    command.add_argument(
        "--about",
        choices=("steady", "rest"),
        default="steady",
        help="the state: moving as the top prescribes at time 0, or at rest without friction (default: steady)",
    )


def _view_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument("run", metavar="RUN")
    command.add_argument("--field", help="field that colours the string (default: the axial force)")
    command.add_argument(
        "--time", type=float, help="simulated time of the picture [s] (default: the last frame)"
    )
    command.add_argument("--animate", action="store_true", help="all frames, as an animation")
    command.add_argument(
        "--lateral-scale",
        type=float,
        help="exaggeration of lateral offsets (default: automatic, and stated in the picture)",
    )
    command.add_argument(
        "--interval", type=float, nargs=2, metavar=("FROM", "TO"), help="measured depths to look at [m]"
    )
    command.add_argument("--out", metavar="FILE")


def _plot_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument("run", metavar="RUN")
    command.add_argument("--out", metavar="DIR")
    _units_argument(command)


def _report_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "paths",
        nargs="+",
        metavar="RUN|CASE.yaml",
        help="run folders of one case, and its file; or the file alone",
    )
    command.add_argument(
        "--out",
        metavar="FILE.html",
        help="file to be written (default: report.html in the first run folder, or CASE-report.html)",
    )
    command.add_argument(
        "--sections",
        metavar="A,B",
        help="well, string, mud, roadmap, statics, limits, hydraulics, surge, dynamics, modes, inputs, solver (default: all)",
    )
    _units_argument(command)


def _import_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "files",
        nargs="+",
        metavar="FILE",
        help="WITSML 1.4.1 trajectory, tubular, wbGeometry (.xml), or a survey in CSV, xlsx, LAS",
    )
    command.add_argument("--out", metavar="CASE.yaml", help="where to write (default: standard output)")
    command.add_argument("--overwrite", action="store_true", help="replace an existing --out")


def _catalogue_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "text",
        nargs="*",
        metavar="TEXT",
        help="what a row must have: a size (5in), a size and a weight (5in 19.50), a grade, a connection, a kind "
        "(hwdp, drill_collar, casing); all rows without it",
    )
    command.add_argument(
        "--files",
        metavar="PATH",
        help="a folder with CSV files, or one CSV file, whose rows come before the built-in ones",
    )


def _schema_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument("file", nargs="?", metavar="FILE", help="where to write (default: standard output)")
    command.add_argument(
        "--outputs",
        action="store_true",
        help="instead, list the outputs as JSON: file, name, unit, label, mnemonic, sign, doc and condition of each column, "
        "field and key of a run folder",
    )


# ---------------------------------------------------------------------- handlers
def _run(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    if arguments.accept_changes and not arguments.restart:
        raise CaseError(at="--accept-changes", want="--accept-changes together with --restart")
    if len(arguments.cases) > 1:
        return _run_several(arguments, petsc_options)
    from drillpetsc.case import load_case

    name, case = Path(arguments.cases[0]).stem, _in_units(load_case(arguments.cases[0]), arguments.units)
    start_job(petsc_options)
    _warn(case)
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
    _print(closing_lines(result.summary, result.folder, case.output.units))
    summary = result.summary
    if arguments.mesh_error:
        from drillpetsc.studies.convergence.coarse_mesh import add_mesh_error, mesh_lines

        summary = add_mesh_error(case, result.folder, summary, name, progress=arguments.progress)
        _print(mesh_lines(summary))
    if arguments.check_tolerance:
        from drillpetsc.studies.convergence.fine_tolerance import add_tolerance_check, tolerance_lines

        summary = add_tolerance_check(case, result.folder, summary, name, progress=arguments.progress)
        _print(tolerance_lines(summary))
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
    start_job(petsc_options)
    from drillpetsc.studies.sweep.sweep import closing_lines, run_cases

    result = run_cases(
        arguments.cases,
        arguments.out,
        restart=arguments.restart,
        overwrite=arguments.overwrite,
        progress=arguments.progress,
    )
    _print(closing_lines(result))
    return 1 if result.failed else 0


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
    _print(closing_lines(result))
    return 1 if result.failed else 0


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
        limit=arguments.limit,
        few=arguments.few,
        steps=entries(arguments.steps),
        tolerances=entries(arguments.tolerances),
    )
    print("\n".join(closing_lines(result)))
    return 1 if result.useless else 0


def _check(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.case import load_case

    case = _in_units(load_case(arguments.case), arguments.units)
    start_job(petsc_options)
    from drillpetsc.analysis.check import describe

    print(describe(case))
    return 0


def _catalogue(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.case.catalogue import catalogue

    print(catalogue(" ".join(arguments.text), arguments.files))
    return 0


def _statics(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.case import load_case

    case = _in_units(load_case(arguments.case), arguments.units)
    start_job(petsc_options)
    _warn(case)
    from drillpetsc.analysis.statics import run_statics

    name = Path(arguments.case).stem
    motion, path = arguments.motion, arguments.path
    _print(run_statics(case, arguments.out, motion, arguments.overwrite, name, path=path).lines)
    return 0


def _hydraulics(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.case import load_case
    from drillpetsc.case.flow_options import read_flows

    case = load_case(arguments.case)
    flows, pressure = read_flows(arguments.flow, arguments.spp, case.output.units or "SI")
    start_job(petsc_options)
    from drillpetsc.analysis.hydraulics.hydraulics import run_hydraulics

    name, units = Path(arguments.case).stem, arguments.units or case.output.units
    result = run_hydraulics(case, flows, pressure, arguments.out, arguments.overwrite, name, units=units)
    _print(result.lines)
    return _draw_on_first_rank(result.folder)


def _surge(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.case import load_case
    from drillpetsc.case.flow_options import read_trips

    case = load_case(arguments.case)
    trips = read_trips(
        arguments.speed,
        arguments.operation,
        arguments.pipe,
        arguments.bit_depth,
        arguments.window,
        arguments.flow,
        units=case.output.units or "SI",
    )
    start_job(petsc_options)
    from drillpetsc.analysis.hydraulics.surge import run_surge

    name, units = Path(arguments.case).stem, arguments.units or case.output.units
    result = run_surge(case, trips, arguments.out, arguments.overwrite, name, units=units)
    _print(result.lines)
    return _draw_on_first_rank(result.folder)


def _limits(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.case import load_case

    case = load_case(arguments.case)
    start_job(petsc_options)
    _warn(case)
    from drillpetsc.analysis.limits.limits import run_limits
    from drillpetsc.analysis.limits.table import Choices

    choices = Choices(
        helical=arguments.helical,
        design_factor=arguments.design_factor,
        tension_fraction=arguments.tension_fraction,
    )
    name, units = Path(arguments.case).stem, arguments.units or case.output.units
    out, overwrite = arguments.out, arguments.overwrite
    result = run_limits(case, arguments.operation, choices, out, overwrite, name, units=units)
    _print(result.lines)
    return _draw_on_first_rank(result.folder)


def _freepoint(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.case import load_case
    from drillpetsc.case.free_point_options import read_pairs

    case, pairs = load_case(arguments.case), read_pairs(arguments.stretch, arguments.pull)
    from drillpetsc.analysis.limits.free_point import free_point_lines

    _print(free_point_lines(case, pairs, arguments.units or case.output.units or "metric"))
    return 0


def _roadmap(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.case import load_case
    from drillpetsc.case.measured_option import measured_option

    case = load_case(arguments.case)
    measured = None if arguments.measured is None else measured_option(arguments.measured, case)
    start_job(petsc_options)
    _warn(case)
    from drillpetsc.analysis.torque_drag.roadmap import run_roadmap

    name, units = Path(arguments.case).stem, arguments.units or case.output.units
    result = run_roadmap(
        case,
        arguments.out,
        arguments.overwrite,
        name,
        units=units,
        measured=measured,
    )
    _print(result.lines)
    return _draw_on_first_rank(result.folder)


def _calibrate(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.case import load_case
    from drillpetsc.case.measured_option import fit_option, measured_option

    case = load_case(arguments.case)
    fit = None if arguments.fit is None else fit_option(arguments.fit)
    measured = None if arguments.measured is None else measured_option(arguments.measured, case)
    start_job(petsc_options)
    _warn(case)
    from drillpetsc.analysis.torque_drag.calibrate import run_calibrate

    name, units = Path(arguments.case).stem, arguments.units or case.output.units
    result = run_calibrate(case, measured, fit, arguments.out, arguments.overwrite, name, units=units)
    _print(result.lines)
    return _draw_on_first_rank(result.folder)


def _draw_on_first_rank(folder: Path) -> int:
    """Draw the pictures of a run folder, on one rank."""
    if world_rank() != 0:
        return 0
    from drillpetsc.plotting.plot import plot

    return _draw(lambda: plot(folder), str(folder))


def _modes(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.case import load_case

    case = load_case(arguments.case)
    start_job(petsc_options)
    _warn(case)
    from drillpetsc.analysis.modal import run_modes

    result = run_modes(
        case,
        arguments.out,
        arguments.count,
        arguments.shift,
        arguments.kind,
        arguments.about,
        arguments.overwrite,
        Path(arguments.case).stem,
    )
    _print(result.lines)
    return 0


def _view(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.plotting.view import view

    def draw() -> list[Path]:
        return [
            view(
                arguments.run,
                arguments.out,
                field=arguments.field,
                time=arguments.time,
                animate=arguments.animate,
                lateral_scale=arguments.lateral_scale,
                interval=tuple(arguments.interval) if arguments.interval else None,
                say=print,
            )
        ]

    return _draw(draw, arguments.run)


def _plot(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.plotting.plot import plot

    return _draw(lambda: plot(arguments.run, arguments.out, arguments.units), arguments.run)


def _report(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.reporting import report

    sections = [name.strip() for name in (arguments.sections or "").split(",") if name.strip()]
    try:
        file = report(*arguments.paths, out=arguments.out, units=arguments.units, sections=sections)
    except (OSError, ValueError) as error:
        raise CaseError(at="RUN", got=" ".join(arguments.paths), want=str(error)) from None
    print(f"{file}  ({file.stat().st_size / 1e6:.2f} MB)")
    return 0


def _draw(draw: Callable[[], Iterable[Path]], run: str) -> int:
    """Draw pictures of a run folder and print their names."""
    try:
        files = draw()
    except (OSError, ValueError) as error:
        raise CaseError(at="RUN", got=run, want=str(error)) from None
    for file in files:
        print(file)
    return 0


def _schema(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    import json

    from drillpetsc.case import case_json_schema, write_schema
    from drillpetsc.output.catalogue import records

    if not arguments.file:
        print(json.dumps(records() if arguments.outputs else case_json_schema(), indent=2))
        return 0
    try:
        if arguments.outputs:
            text = json.dumps(records(), indent=2)
            Path(arguments.file).write_text(f"{text}\n", encoding="utf-8")
        else:
            write_schema(arguments.file)
    except OSError as error:
        raise CaseError(
            at="FILE", got=arguments.file, want=f"a file that can be written ({error.strerror})"
        ) from None
    return 0


def _in_units(case: Case, units: str | None) -> Case:
    """The case with another system of units for what is printed and plotted."""
    return (
        case
        if units is None
        else case.model_copy(update={"output": case.output.model_copy(update={"units": units})})
    )


def _warn(case: Case) -> None:
    """Print warnings about values that look like another unit, once for the whole job, to standard error."""
    from drillpetsc.case.plausibility import notes

    if world_rank() == 0:
        for line in notes(case):
            if line.startswith("WARNING"):
                print(line, file=sys.stderr)


def _import(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.case.importers.fragment import fragment

    out = Path(arguments.out) if arguments.out else None
    if out is not None and out.exists() and not arguments.overwrite:
        raise CaseError(at="--out", got=out, want="a file that does not exist, or --overwrite")
    text, remarks = fragment(arguments.files, out.parent if out is not None else Path())
    if out is None:
        print(text, end="")
        return 0
    try:
        out.write_text(text, encoding="utf-8")
    except OSError as error:
        raise CaseError(at="--out", got=out, want=f"a file that can be written ({error.strerror})") from None
    print("\n".join([f"{out}: written", *(f"  {remark}" for remark in remarks)]))
    return 0


def _print(lines: Iterable[str]) -> None:
    """Print lines once for the whole job."""
    if world_rank() == 0:
        print("\n".join(lines))


# ---------------------------------------------------------------------- commands
COMMANDS = (
    Command(
        "run",
        "simulate one case on all ranks, or several wells at once with the ranks shared out over them",
        _run_arguments,
        _run,
        parents=(_output_folder(restart="continue from the checkpoint in the run folder"),),
    ),
    Command(
        "sweep",
        "simulate every combination of some values, with the ranks shared out over the combinations",
        _sweep_arguments,
        _sweep,
        parents=(
            _output_folder(
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
            _output_folder(
                "folder of table, pictures and runs (default: results/<case>-study-NNN)",
                "keep points that are done, run the others, failed ones too",
            ),
        ),
    ),
    Command(
        "check",
        "read and validate a case, and say what the model contains and leaves out",
        _check_arguments,
        _check,
    ),
    Command(
        "catalogue",
        "rows of the catalogue of drill pipe, collars and casing, in field and metric units, with their sources",
        _catalogue_arguments,
        _catalogue,
        takes_petsc_options=False,
    ),
    Command(
        "statics",
        "static equilibrium: torque and drag, contact forces, buckling state",
        _statics_arguments,
        _statics,
        parents=(_output_folder(),),
    ),
    Command(
        "hydraulics",
        "steady flow of the mud: pressures, losses, equivalent densities, power at the bit, for one or more flow rates",
        _hydraulics_arguments,
        _hydraulics,
        parents=(_output_folder(),),
    ),
    Command(
        "surge",
        "pressures of running in and pulling out, and the largest trip speed within the window of the open hole",
        _surge_arguments,
        _surge,
        parents=(_output_folder(),),
    ),
    Command(
        "roadmap",
        "torque and drag over the bit depth: hook load and torque for six operations and several friction factors",
        _roadmap_arguments,
        _roadmap,
        parents=(_output_folder(),),
    ),
    Command(
        "limits",
        "stresses, safety factors, buckling and fatigue limits along the string, margin of overpull, largest weight on bit",
        _limits_arguments,
        _limits,
        parents=(_output_folder(),),
    ),
    Command(
        "freepoint",
        "how much of a stuck string is free, from its stretch under a pull",
        _freepoint_arguments,
        _freepoint,
        takes_petsc_options=False,
    ),
    Command(
        "calibrate",
        "friction factors from measured hook loads and torques, with intervals",
        _calibrate_arguments,
        _calibrate,
        parents=(_output_folder(),),
    ),
    Command(
        "modes",
        "eigenvalues about the static or steady state: frequencies, damping, stability, mode shapes",
        _modes_arguments,
        _modes,
        parents=(_output_folder(),),
    ),
    Command(
        "view",
        "picture or animation of the string in its hole",
        _view_arguments,
        _view,
        takes_petsc_options=False,
    ),
    Command(
        "plot",
        "time histories, probe orbits, forces along depth, as pictures",
        _plot_arguments,
        _plot,
        takes_petsc_options=False,
    ),
    Command(
        "report",
        "one HTML file on a case and its run folders: well, string, mud, results, inputs with sources",
        _report_arguments,
        _report,
        takes_petsc_options=False,
    ),
    Command(
        "import",
        "write a part of a case from a survey, or from WITSML documents: survey, string, hole",
        _import_arguments,
        _import,
        takes_petsc_options=False,
    ),
    Command(
        "schema",
        "write the JSON schema of case files, for editors, or the list of outputs",
        _schema_arguments,
        _schema,
        takes_petsc_options=False,
    ),
)
