"""Commands that read cases and what belongs to them: check, catalogue, import, schema."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from drillpetsc.errors import CaseError
from drillpetsc.operations.operation import CaseOperation, Changes, Mark, Operation

if TYPE_CHECKING:
    from drillpetsc.case import Case


class Check(CaseOperation):
    """Read and validate a case, and say what the model contains and leaves out."""

    verbose: Annotated[
        bool, "also element lengths, the source of each figure, numbers of unknowns, ranks and time scales"
    ] = False

    def warn(self, case: Case) -> None:
        """Print nothing: the text has the warnings."""

    def compute(self, job: Any) -> Any:
        from drillpetsc.analysis.commands.check import describe

        return describe(job.case, self.verbose)


class Catalogue(Operation):
    """Rows of the catalogue of drill pipe, collars and casing, in field and metric units, with their sources."""

    text: Annotated[
        tuple[str, ...],
        Mark.ARGUMENT,
        "TEXT",
        "what a row must have: a size (5in), a size and a weight (5in 19.50), a grade, a connection, a kind "
        "(hwdp, drill_collar, casing); all rows without it",
    ] = ()
    files: Annotated[
        str | None,
        "PATH",
        "a folder with CSV files, or one CSV file, whose rows come before the built-in ones",
    ] = None

    def compute(self, job: Any) -> Any:
        from drillpetsc.case.catalogue import catalogue

        return str(catalogue(" ".join(self.text), self.files))


class Import(Operation):
    """Write a part of a case from a survey, a tally, WITSML documents or an EDM export: survey, string, hole."""

    files: Annotated[
        tuple[str, ...],
        Mark.ARGUMENT,
        "FILE",
        "WITSML 1.4.1 trajectory, tubular, wbGeometry (.xml), an EDM export (.xml), a tally in CSV or xlsx, or a survey in CSV, xlsx, LAS",
    ]
    wellbore: Annotated[str | None, "NAME", "the wellbore of an EDM export that has several"] = None
    assembly: Annotated[str | None, "NAME", "the string of an EDM export or a tally that has several"] = None
    hole: Annotated[
        str | None,
        "NAME",
        "the design, by the name of its case, whose hole is taken from an EDM export that has several",
    ] = None
    out: Annotated[str | None, "CASE.yaml", "where to write (default: standard output)"] = None
    overwrite: Annotated[bool, "replace an existing --out"] = False

    def compute(self, job: Any) -> Any:
        from drillpetsc.case.importers.edm import Wanted
        from drillpetsc.case.importers.fragment import fragment

        out = Path(self.out) if self.out else None
        if out is not None and out.exists() and not self.overwrite:
            raise CaseError(at="--out", got=out, want="a file that does not exist, or --overwrite")
        wanted = Wanted(self.wellbore, self.assembly, self.hole)
        text, remarks = fragment(self.files, out.parent if out is not None else Path(), wanted)
        if out is None:
            return text.splitlines()
        with writing(out, "--out"):
            out.write_text(text, encoding="utf-8")
        return [f"{out}: written", *(f"  {remark}" for remark in remarks)]


class ImportLog(Operation):
    """Read a rig's log (`import log FILE`): channels in SI, quality, rig states, points for `calibrate`.

    Writes log.csv, states.csv, points.csv, quality.json and log.html.
    """

    files: Annotated[
        tuple[str, ...],
        Mark.ARGUMENT,
        Mark.POSITIONAL,
        "FILE",
        "the log: CSV or another text table, LAS, WITSML 1.4.1.1 log (.xml), xlsx; several files of the same columns are joined",
    ]
    case: Annotated[Any, "CASE.yaml", "the case, whose string tells slips and the units of the hook load"] = (
        None
    )
    set: Changes = ()
    out: Annotated[str | None, "DIR", "folder of the results (default: named after the log)"] = None
    map: Annotated[
        tuple[str, ...],
        "CHANNEL=TITLE:UNIT",
        "the column of a channel, such as hook_load=HKLD:t; may be given several times",
    ] = ()
    between: Annotated[
        str | None,
        "A,B",
        "a part of the log: two clock times, as 2020-12-31T01:00,2020-12-31T15:00, or two depths with units",
    ] = None
    every: Annotated[
        str | None, "LENGTH", "length of a point while drilling, such as 1m or 10s (default: 10 m)"
    ] = None
    states: Annotated[
        tuple[str, ...],
        "KEY=VALUE",
        "a figure of the rig states, such as 'edge_time=14 s'; may be given several times",
    ] = ()
    overwrite: Annotated[bool, "replace an existing --out"] = False

    def compute(self, job: Any) -> Any:
        from drillpetsc.analysis.commands.import_log import Choices, import_log
        from drillpetsc.case import Case, load_case
        from drillpetsc.plotting.command.log import log_page

        if self.set and self.case is None:
            raise CaseError(at="--set", got=self.set[0], want="--case, the case that is changed")
        case = self.case
        if not (case is None or isinstance(case, Case)):
            case = load_case(case, self.set)
        choices = Choices(self.map, self.every, self.states, self.between)
        files = (self.files,) if isinstance(self.files, str | Path) else self.files
        result = import_log(tuple(map(str, files)), case, self.out, self.overwrite, choices)
        log_page(result.folder)
        return result


class Schema(Operation):
    """Write the JSON schema of case files, for editors, or the list of outputs."""

    file: Annotated[str | None, Mark.ARGUMENT, "FILE", "where to write (default: standard output)"] = None
    outputs: Annotated[
        bool,
        "instead, list the outputs as JSON: file, name, unit, label, mnemonic, sign, doc and condition of each column, "
        "field and key of a run folder",
    ] = False

    def compute(self, job: Any) -> Any:
        import json

        from drillpetsc.case import case_json_schema, write_schema
        from drillpetsc.output.catalogue import records

        if not self.file:
            return [json.dumps(records() if self.outputs else case_json_schema(), indent=2)]
        with writing(self.file, "FILE"):
            if self.outputs:
                Path(self.file).write_text(f"{json.dumps(records(), indent=2)}\n", encoding="utf-8")
            else:
                write_schema(self.file)
        return []


@contextmanager
def writing(file: Any, at: str) -> Iterator[None]:
    """While a file is written: raises CaseError, which names the option, where that fails."""
    try:
        yield
    except OSError as error:
        raise CaseError(at=at, got=file, want=f"a file that can be written ({error.strerror})") from None
