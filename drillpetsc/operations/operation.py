"""A command is one class: its fields are its options on the command line, its keywords in Python and its rows in the manual.

    class Campbell(DrawnOperation):
        \"\"\"Modes over rotary speeds, followed by shape, and critical speeds.\"\"\"

        speeds: Annotated[Numbers, rotary_speeds(), "RANGE", "rotary speeds: ..."]
        count: Annotated[int, at_least(1, "modes"), "N", "oscillating modes at each speed"] = 20

        def compute(self, job): ...

The first line of the docstring is the help of the command. In the metadata of a field stand functions that check or read its value,
the placeholder of the value and the help, both texts, and a ``Mark``. Nothing heavy is imported here, nor at the top of the modules
of the commands, because ``drillpetsc --help`` imports them all.
"""

from __future__ import annotations

import dataclasses
import inspect
import re
import sys
from collections.abc import Callable, Iterable
from enum import Enum
from functools import cache
from pathlib import Path
from types import NoneType
from typing import (
    TYPE_CHECKING,
    Annotated,
    Any,
    ClassVar,
    Literal,
    dataclass_transform,
    get_args,
    get_origin,
    get_type_hints,
)

from drillpetsc.errors import CaseError
from drillpetsc.operations.fields import reading
from drillpetsc.parallel import initialise_petsc, start_job, world_rank

if TYPE_CHECKING:
    from drillpetsc.case import Case

Reader = Callable[[Any, str, Any], Any]
"""(value, name of the option, units of bare numbers in text) -> value; raises CaseError, which names the option."""
CHANGE = (
    "change a key of the case for this call, such as 'top.rotation=90 rpm', 'string[1].od=8 in' or fluid=off; may be "
    "given several times"
)

#: former option -> the present one, which the error names
RENAMED_OPTIONS = {"--companion": "--mesh-error", "--rpm": "--speeds", "--speed": "--speeds", "-o": "--out"}


class Mark(Enum):
    """What a field is beside an option with two dashes that Python takes as a keyword."""

    ARGUMENT = "a word of the command line without dashes"
    POSITIONAL = "in Python before the keywords"
    SHELL = "not in Python"
    PYTHON = "not on the command line"


CaseFile = Annotated[Any, Mark.ARGUMENT, Mark.POSITIONAL, "CASE.yaml", "the case file"]
Changes = Annotated[tuple[str, ...], Mark.SHELL, "KEY=VALUE", CHANGE]
Units = Annotated[
    Literal["field", "metric", "metric_t", "SI"] | None,
    "units of what is printed and plotted (default: the case's; files stay in SI); metric_t: forces in tonnes",
]
Overwrite = Annotated[bool, "replace the results in an existing --out"]


@dataclasses.dataclass(frozen=True)
class Option:
    """A field of an operation.

    name: as in Python; type: with None where that is allowed; default: ``dataclasses.MISSING`` for a value that must be given.
    metavar: placeholder of the value; help: what it is; readers: check and convert a value, in turn.
    """

    name: str
    type: Any
    default: Any
    metavar: str
    help: str
    readers: tuple[Reader, ...]
    marks: tuple[Mark, ...]

    @property
    def kind(self) -> Any:
        """The type of a value that is given."""
        kinds = [q for q in get_args(self.type) if q is not NoneType]
        return kinds[0] if len(kinds) == 1 and NoneType in get_args(self.type) else self.type

    @property
    def required(self) -> bool:
        """Whether a value must be given."""
        return self.default is dataclasses.MISSING

    @property
    def choices(self) -> tuple[Any, ...]:
        """The words that are allowed; empty for any."""
        return get_args(self.kind) if get_origin(self.kind) is Literal else ()

    @property
    def flag(self) -> str:
        """The name on the command line: that of the option, or the placeholder of an argument."""
        return self.metavar if Mark.ARGUMENT in self.marks else "--" + self.name.replace("_", "-")

    @property
    def text(self) -> str:
        """The help with the default."""
        shown = (
            isinstance(self.default, str | int | float)
            and not isinstance(self.default, bool)
            and self.default != ""
        )
        return (
            f"{self.help} (default: {self.default:{'' if isinstance(self.default, str) else 'g'}})"
            if shown
            else self.help
        )

    def read(self, value: Any, units: Any) -> Any:
        """Check and convert a value; None and the absence of a value stay what they are."""
        if value is None:
            return None
        if self.choices and value not in self.choices:
            raise CaseError(at=self.flag, got=value, want=" or ".join(self.choices))
        for reader in self.readers:
            value = reader(value, self.flag, units)
        return value


@dataclass_transform(kw_only_default=True, frozen_default=True)
class Operation:
    """A command that needs no case."""

    petsc: ClassVar[bool] = False
    """Whether the command starts PETSc, and takes its options."""

    def __init_subclass__(cls) -> None:
        dataclasses.dataclass(frozen=True, kw_only=True)(cls)

    def compute(self, job: Any) -> Any:
        """Compute the result; collective.  job: None without a case."""
        raise NotImplementedError

    def printed(self, result: Any) -> Iterable[Any]:
        """What the command line prints of a result, line by line: its lines, the text that it is, or what it lists."""
        return [result] if isinstance(result, str) else getattr(result, "lines", result)

    # ------------------------------------------------------------------ what follows from the fields
    @classmethod
    def command(cls) -> str:
        """Name of the command: `top-drive` of the class TopDrive."""
        return re.sub(r"(?<=[a-z])(?=[A-Z])", "-", cls.__name__).lower()

    @classmethod
    def summary(cls) -> str:
        """The first line of the docstring, as the help shows it."""
        first = (cls.__doc__ or "").splitlines()[0].removesuffix(".")
        return first if first[1:2].isupper() else first[:1].lower() + first[1:]

    @classmethod
    @cache
    def options(cls) -> tuple[Option, ...]:
        """The fields: words without dashes, those of the class itself, then those that it shares with others."""
        hints = get_type_hints(cls, include_extras=True)
        fields = {q.name: q for q in dataclasses.fields(cls)}  # type: ignore[arg-type]  # a data class by __init_subclass__
        own = [name for name in inspect.get_annotations(cls) if name in fields]
        options = [_option(fields[name], hints[name]) for name in dict.fromkeys([*own, *fields])]
        return tuple(sorted(options, key=lambda option: Mark.ARGUMENT not in option.marks))

    def read(self, units: Any) -> Any:
        """The operation with its values checked and converted; raises CaseError.  units: of bare numbers in text."""
        values = {
            q.name: q.read(getattr(self, q.name), units) for q in self.options() if q.readers or q.choices
        }
        return dataclasses.replace(self, **values)  # type: ignore[type-var]

    # ------------------------------------------------------------------ running
    def run(self, petsc_options: list[str]) -> int:
        """Run the command for the command line; returns the exit status."""
        if self.petsc:
            start_job(petsc_options)
        operation = self.read(None)
        return operation.show(operation.compute(None))

    def call(self) -> Any:
        """Run the operation for Python; returns its result."""
        return self.read("SI").compute(None)

    def show(self, result: Any) -> int:
        """Print the lines of a result once for the whole job; returns the exit status."""
        print_once(self.printed(result))
        return 0


class CaseOperation(Operation):
    """A command on a case."""

    petsc = True
    case: CaseFile
    set: Changes = ()
    units: Units = None

    def run(self, petsc_options: list[str]) -> int:
        """Read the case, start PETSc, read the options, compute, and print; returns the exit status."""
        from drillpetsc.case import load_case

        case = load_case(self.case, self.set)
        if self.petsc:  # before the options are read: several ranks then say once what is wrong with them
            start_job(petsc_options)
        operation = self.read(case.said_units)
        case = in_units(self.prepared(case), self.units)
        self.warn(case)
        return operation.show(operation.compute(operation.job(case, Path(self.case).stem)))

    def call(self) -> Any:
        """Run the operation for Python; returns its result."""
        from drillpetsc.case import Case, load_case

        operation = self.read("SI")
        given = isinstance(self.case, Case)
        case = in_units(self.prepared(self.case if given else load_case(self.case)), self.units)
        if self.petsc:
            initialise_petsc()
        return operation.compute(operation.job(case, "case" if given else Path(self.case).stem))

    def job(self, case: Case, name: str) -> Any:
        """The case, and where results go."""
        from drillpetsc.output.job import Job

        return Job(case, name=name)

    def prepared(self, case: Case) -> Case:
        """The case with the changes of the options."""
        return case

    def warn(self, case: Case) -> None:
        """Print warnings about values that look like another unit."""
        print_warnings(case)


class AtBitDepth(CaseOperation):
    """A command on a string whose bit may be at another depth than in the case."""

    bit_depth: Annotated[
        str | float | None,
        "D",
        "measured depth of the bit, such as '2000 m' (default: bit_depth of the case)",
    ] = None

    def prepared(self, case: Case) -> Case:
        """The case with its bit at the depth, in a hole that ends there."""
        return case if self.bit_depth is None else case.replace({"bit_depth": self.bit_depth})


class FolderOperation(CaseOperation):
    """A command that writes a run folder."""

    out: Annotated[Any, Mark.POSITIONAL, "DIR", "run folder (default: results/<case>-NNN)"] = None
    overwrite: Overwrite = False
    name: Annotated[str | None, Mark.PYTHON, "name of the case in the default folder"] = None
    comm: Annotated[Any, Mark.PYTHON, "PETSc communicator; by default all ranks"] = None

    def job(self, case: Case, name: str) -> Any:
        """The case, and the folder of the results."""
        from drillpetsc.output.job import Job

        job = Job(case, self.out, self.overwrite, self.name or name, self.comm)
        if not self.continues:
            job.refuse_existing()
        return job

    @property
    def continues(self) -> bool:
        """Whether the command goes on with a folder that exists."""
        return False

    def call(self) -> Any:
        """Run the operation for Python; returns its result, with tables and pictures."""
        from drillpetsc.output.job import RunResult
        from drillpetsc.results.result import result_of

        result = super().call()
        return result_of(result) if type(result) is RunResult else result


class DrawnOperation(FolderOperation):
    """A command that draws pictures of its run folder."""

    report: Annotated[
        bool, Mark.SHELL, "write report.html into the run folder, too (see the command report)"
    ] = False

    def show(self, result: Any) -> int:
        """Print the lines, draw the pictures on one rank, and print their names."""
        super().show(result)
        if world_rank() != 0:
            return 0
        from drillpetsc.plotting.run.plot import drawn

        with reading(result.folder):
            files = drawn(result.folder)
            if self.report:
                from drillpetsc.reporting import report

                files.append(report(result.folder, units=self.units))
        print_once(files)
        return 0


def _option(field: Any, hint: Any) -> Option:
    """The option of a field of a data class with its type."""
    kind, *metadata = get_args(hint) if get_origin(hint) is Annotated else (hint,)
    texts = [q for q in metadata if isinstance(q, str)]
    return Option(
        field.name,
        kind,
        field.default,
        texts[0] if len(texts) > 1 else "",
        texts[-1] if texts else "",
        tuple(q for q in metadata if callable(q)),
        tuple(q for q in metadata if isinstance(q, Mark)),
    )


def in_units(case: Case, units: str | None) -> Case:
    """The case with another system of units for what is printed and plotted."""
    return (
        case
        if units is None
        else case.model_copy(update={"output": case.output.model_copy(update={"units": units})})
    )


def print_warnings(*cases: Case) -> None:
    """Print warnings about values that look like another unit, each once for the whole job, to standard error."""
    from drillpetsc.case.plausible.plausibility import notes

    if world_rank() == 0:
        for line in dict.fromkeys(line for case in cases for line in notes(case)):
            if line.startswith("WARNING"):
                print(line, file=sys.stderr)


def print_once(lines: Iterable[Any]) -> None:
    """Print lines once for the whole job."""
    for line in lines:
        if world_rank() == 0:
            print(line)
