"""Commands that show results: view, plot, report."""

from __future__ import annotations

import argparse
from pathlib import Path

from drillpetsc.cli.command import Command, draw_and_print, units_argument
from drillpetsc.errors import CaseError


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

    return draw_and_print(draw, arguments.run)


def _plot_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument("run", metavar="RUN")
    command.add_argument("--out", metavar="DIR")
    units_argument(command)


def _plot(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.plotting.plot import plot

    return draw_and_print(lambda: plot(arguments.run, arguments.out, arguments.units), arguments.run)


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
    units_argument(command)


def _report(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.reporting import report

    sections = [name.strip() for name in (arguments.sections or "").split(",") if name.strip()]
    try:
        file = report(*arguments.paths, out=arguments.out, units=arguments.units, sections=sections)
    except (OSError, ValueError) as error:
        raise CaseError(at="RUN", got=" ".join(arguments.paths), want=str(error)) from None
    print(f"{file}  ({file.stat().st_size / 1e6:.2f} MB)")
    return 0


COMMANDS = (
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
)
