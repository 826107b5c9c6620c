"""Commands that show results: view, plot, report, export."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from drillpetsc.cli.command import Command, draw_and_print, units_argument
from drillpetsc.errors import CaseError


def _say_unfinished(run: str) -> None:
    """Say of the folder of a run that it did not reach its end: what is shown of it stops somewhere."""
    from drillpetsc.output import RunFolder, read_summary

    folder = RunFolder(Path(run))
    if not folder.history.is_file():
        return
    status = "there is no summary.json"
    if folder.summary.is_file():
        status = read_summary(folder.summary).get("status", "done")
    if status != "done":
        print(f"drillpetsc: {run}: the run is not complete: {status}", file=sys.stderr)


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
        "--interval",
        nargs=2,
        metavar=("FROM", "TO"),
        help="measured depths to look at, in m, or with a unit: '4000 ft'",
    )
    command.add_argument("--out", metavar="FILE")
    units_argument(command)


def _depth(text: str) -> float:
    """A depth [m] of --interval."""
    from drillpetsc.units import to_si

    try:
        return to_si(text if text.strip()[-1:].isalpha() else f"{text} m", "m")
    except ValueError:
        raise CaseError(at="--interval", got=text, want="a depth such as 1200, or '4000 ft'") from None


def _view(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.plotting.view import view

    _say_unfinished(arguments.run)
    interval = None
    if arguments.interval:
        start, end = (_depth(text) for text in arguments.interval)
        interval = start, end

    def draw() -> list[Path]:
        return [
            view(
                arguments.run,
                arguments.out,
                field=arguments.field,
                time=arguments.time,
                animate=arguments.animate,
                lateral_scale=arguments.lateral_scale,
                interval=interval,
                say=print,
                units=arguments.units,
            )
        ]

    return draw_and_print(draw, arguments.run)


def _plot_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument("run", metavar="RUN")
    command.add_argument("--out", metavar="DIR")
    command.add_argument(
        "--waterfall",
        metavar="SIGNAL",
        action="append",
        default=[],
        help="amplitudes of a signal over time and frequency: SENSOR:COLUMN such as mwd:ax, history:bit_speed, probes:x_600; "
        "only what is asked for is drawn",
    )
    command.add_argument(
        "--order",
        action="store_true",
        help="with --waterfall: over the order of rotation instead of the frequency",
    )
    command.add_argument(
        "--psd",
        metavar="SIGNAL",
        action="append",
        default=[],
        help="power density of a signal over the frequency",
    )
    command.add_argument(
        "--segment",
        metavar="LENGTH",
        help="length of a segment, such as '2 s'; with --order its revolutions (default: from the length of the run)",
    )
    units_argument(command)


def _segment(text: str | None, order: bool) -> float | None:
    """Length of a segment [s], or its revolutions."""
    from drillpetsc.units import to_si

    if text is None:
        return None
    try:
        length = float(text) if order else to_si(text, "s")
    except ValueError:
        length = 0.0
    if not 0 < length < 1e9:
        want = "a number of revolutions above 0" if order else "a time above 0, such as '2 s'"
        raise CaseError(at="--segment", got=text, want=want)
    return length


def _plot(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.plotting.plot import plot, save_figures, spectra

    _say_unfinished(arguments.run)
    if arguments.order and not arguments.waterfall:
        raise CaseError(at="--order", want="--waterfall SIGNAL beside it")
    if arguments.segment is not None and not (arguments.waterfall or arguments.psd):
        raise CaseError(at="--segment", want="--waterfall SIGNAL or --psd SIGNAL beside it")
    if arguments.waterfall or arguments.psd:

        def draw() -> list[Path]:
            drawn = spectra(
                arguments.run,
                arguments.waterfall,
                arguments.psd,
                order=arguments.order,
                segment=_segment(arguments.segment, arguments.order),
                units=arguments.units,
            )
            return save_figures(drawn, Path(arguments.out or Path(arguments.run) / "plots"))

        return draw_and_print(draw, arguments.run)
    return draw_and_print(lambda: plot(arguments.run, arguments.out, arguments.units), arguments.run)


def _vibration_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument("run", metavar="RUN")
    command.add_argument(
        "--window", metavar="TIME", help="length of a window (default: that of the case, else 20 s)"
    )
    command.add_argument(
        "--every",
        metavar="TIME",
        help="time from the end of a window to that of the next (default: the case's, else 1 s)",
    )


def _time(text: str | None, at: str) -> float | None:
    """A time above 0 [s]."""
    from drillpetsc.units import to_si

    try:
        time = None if text is None else to_si(text if text.strip()[-1:].isalpha() else f"{text} s", "s")
    except ValueError:
        time = 0.0
    if time is not None and not 0 < time < 1e9:
        raise CaseError(at=at, got=text, want="a time above 0, such as '20 s'")
    return time


def _vibration(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.results import open_run

    _say_unfinished(arguments.run)
    window, every = (_time(getattr(arguments, key), f"--{key}") for key in ("window", "every"))
    result = open_run(arguments.run)
    print("\n".join(result.find_indices(window, every)))
    return 0


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
    command.add_argument(
        "--interactive",
        action="store_true",
        help="pictures of lines and bars zoom in a browser, by a script in the file (4.5 MB more; needs the package plotly)",
    )
    units_argument(command)


def _report(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.reporting import report

    sections = [name.strip() for name in (arguments.sections or "").split(",") if name.strip()]
    try:
        file = report(
            *arguments.paths,
            out=arguments.out,
            units=arguments.units,
            sections=sections,
            interactive=arguments.interactive,
        )
    except (OSError, ValueError) as error:
        raise CaseError(at="RUN", got=" ".join(arguments.paths), want=str(error)) from None
    print(f"{file}  ({file.stat().st_size / 1e6:.2f} MB)")
    return 0


def _export_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument("run", metavar="RUN")
    command.add_argument(
        "--out", metavar="DIR", help="folder of the files (default: export in the run folder)"
    )
    command.add_argument(
        "--format",
        choices=("csv", "xlsx", "las", "parquet"),
        default="csv",
        help="format of the files (default: csv)",
    )
    command.add_argument(
        "--columns",
        metavar="A,B",
        help="names of columns, such as hook_load,wob; time or depth goes along (default: all)",
    )
    units_argument(command)


def _export(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.reporting import export

    _say_unfinished(arguments.run)
    columns = [name.strip() for name in (arguments.columns or "").split(",") if name.strip()]
    if arguments.columns is not None and not columns:
        raise CaseError(at="--columns", got=arguments.columns, want="names of columns, such as hook_load,wob")
    files, remarks = export(
        arguments.run, arguments.out, units=arguments.units, format=arguments.format, columns=columns
    )
    print("\n".join([*map(str, files), *(f"  note: {text}" for text in remarks)]))
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
        "vibration",
        "indices of drilling dynamics of a run: stick-slip, vibration, specific energy, whirl; writes indices.csv",
        _vibration_arguments,
        _vibration,
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
        "export",
        "tables of a run folder for other programs: CSV, xlsx or LAS, with units and headers as engineers write them",
        _export_arguments,
        _export,
        takes_petsc_options=False,
    ),
)
