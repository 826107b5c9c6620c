"""A command of the command line, and what several commands share."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from drillpetsc.errors import CaseError
from drillpetsc.parallel import world_rank

if TYPE_CHECKING:
    from drillpetsc.case import Case
    from drillpetsc.unit_systems import System


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


def output_folder(
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


def report_option() -> argparse.ArgumentParser:
    """Parent parser with --report."""
    parent = argparse.ArgumentParser(add_help=False)
    parent.add_argument(
        "--report",
        action="store_true",
        help="write report.html into the run folder, too (see the command report)",
    )
    return parent


def case_argument(command: argparse.ArgumentParser) -> None:
    """Add the argument CASE.yaml, and the option --set that changes its keys; ``read_case`` reads both."""
    command.add_argument("case", metavar="CASE.yaml")
    set_argument(command)


def set_argument(command: argparse.ArgumentParser, only: str = "") -> None:
    """Add the option --set.  only: words on what it is confined to."""
    command.add_argument(
        "--set",
        metavar="KEY=VALUE",
        action="append",
        default=[],
        help="change a key of the case for this call, such as 'top.rotation=90 rpm', 'string[1].od=8 in' or fluid=off; may be "
        f"given several times{only}",
    )


def read_case(arguments: argparse.Namespace) -> Case:
    """Read the case of a command line with the changes of --set."""
    from drillpetsc.case import load_case

    return load_case(arguments.case, arguments.set)


def units_argument(command: argparse.ArgumentParser) -> None:
    """Add the option --units."""
    command.add_argument(
        "--units",
        choices=("field", "metric", "metric_t", "SI"),
        help="units of what is printed and plotted (default: the case's; files stay in SI); metric_t: forces in tonnes",
    )


def in_units(case: Case, units: str | None) -> Case:
    """The case with another system of units for what is printed and plotted."""
    return (
        case
        if units is None
        else case.model_copy(update={"output": case.output.model_copy(update={"units": units})})
    )


def name_and_units(arguments: argparse.Namespace, case: Case) -> tuple[str, System | None]:
    """(name of the case file, units of what is printed and plotted): those of --units, or the case's."""
    return Path(arguments.case).stem, arguments.units or case.output.units


def print_warnings(case: Case) -> None:
    """Print warnings about values that look like another unit, once for the whole job, to standard error."""
    from drillpetsc.case.plausibility import notes

    if world_rank() == 0:
        for line in notes(case):
            if line.startswith("WARNING"):
                print(line, file=sys.stderr)


def print_once(lines: Iterable[str]) -> None:
    """Print lines once for the whole job."""
    if world_rank() == 0:
        print("\n".join(lines))


def show(lines: Iterable[str], folder: Path, arguments: argparse.Namespace) -> int:
    """Print the lines of a result, draw the pictures of its folder on one rank, and print their names.

    arguments: of a command with --units and --report
    """
    print_once(lines)
    if world_rank() != 0:
        return 0
    from drillpetsc.plotting.plot import plot

    def files() -> list[Path]:
        drawn = plot(folder)
        if arguments.report:
            from drillpetsc.reporting import report

            drawn.append(report(folder, units=arguments.units))
        return drawn

    return draw_and_print(files, str(folder))


def draw_and_print(draw: Callable[[], Iterable[Path]], run: str) -> int:
    """Draw pictures of a run folder and print their names."""
    try:
        files = draw()
    except (OSError, ValueError) as error:
        raise CaseError(at="RUN", got=run, want=str(error)) from None
    for file in files:
        print(file)
    return 0
