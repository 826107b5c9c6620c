"""Commands that read cases and what belongs to them: check, catalogue, import, schema."""

from __future__ import annotations

import argparse
from pathlib import Path

from drillpetsc.cli.command import Command, case_argument, in_units, read_case, units_argument
from drillpetsc.errors import CaseError
from drillpetsc.parallel import start_job


def _check_arguments(command: argparse.ArgumentParser) -> None:
    case_argument(command)
    units_argument(command)


def _check(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    case = in_units(read_case(arguments), arguments.units)
    start_job(petsc_options)
    from drillpetsc.analysis.check import describe

    print(describe(case))
    return 0


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


def _catalogue(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.case.catalogue import catalogue

    print(catalogue(" ".join(arguments.text), arguments.files))
    return 0


def _import_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "files",
        nargs="+",
        metavar="FILE",
        help="WITSML 1.4.1 trajectory, tubular, wbGeometry (.xml), an EDM export (.xml), or a survey in CSV, xlsx, LAS",
    )
    for option, what in (
        ("wellbore", "the wellbore of an EDM export that has several"),
        ("assembly", "the drill string of an EDM export that has several"),
        (
            "hole",
            "the design, by the name of its case, whose hole is taken from an EDM export that has several",
        ),
    ):
        command.add_argument(f"--{option}", metavar="NAME", help=what)
    command.add_argument("--out", metavar="CASE.yaml", help="where to write (default: standard output)")
    command.add_argument("--overwrite", action="store_true", help="replace an existing --out")


def _import(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.case.importers.edm import Wanted
    from drillpetsc.case.importers.fragment import fragment

    out = Path(arguments.out) if arguments.out else None
    if out is not None and out.exists() and not arguments.overwrite:
        raise CaseError(at="--out", got=out, want="a file that does not exist, or --overwrite")
    wanted = Wanted(arguments.wellbore, arguments.assembly, arguments.hole)
    text, remarks = fragment(arguments.files, out.parent if out is not None else Path(), wanted)
    if out is None:
        print(text, end="")
        return 0
    try:
        out.write_text(text, encoding="utf-8")
    except OSError as error:
        raise CaseError(at="--out", got=out, want=f"a file that can be written ({error.strerror})") from None
    print("\n".join([f"{out}: written", *(f"  {remark}" for remark in remarks)]))
    return 0


def _schema_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument("file", nargs="?", metavar="FILE", help="where to write (default: standard output)")
    command.add_argument(
        "--outputs",
        action="store_true",
        help="instead, list the outputs as JSON: file, name, unit, label, mnemonic, sign, doc and condition of each column, "
        "field and key of a run folder",
    )


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


COMMANDS = (
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
        "import",
        "write a part of a case from a survey, WITSML documents or an EDM export: survey, string, hole",
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
