"""What a shell knows of the program, made from the commands: `completion` and the manual page, `man`."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from drillpetsc.operations.operation import Mark, Operation, Option
from drillpetsc.version import __version__

EXIT_STATUS = (
    "Exit status: 0 done, 1 the run failed (what was written is kept), 2 bad input (nothing written)."
)
PETSC_OPTIONS = """Words that start with a dash and are PETSc options go to PETSc: -ts_rtol 1e-5 -ts_monitor -log_view ...
The time integrator is TS BDF with the condensed Newton solver (prefix q_): -ts_rtol (default 1e-4, relative to the usual size
of each unknown), -ts_bdf_order, -ts_dt, -ts_adapt_type none, -q_snes_stol, -q_snes_linesearch_type bt, -q_pc_type lu ...;
Newton also goes on while what it leaves does more work than -drillpetsc_newton_work (default 1e-3) of the power exchanged;
-ts_type alpha2 is generalised-alpha (time.integrator) with -ts_alpha_radius; -snes_type newtonls solves the whole assembled
system instead, -ts_type arkimex, theta integrate it."""
EPILOG = f"{PETSC_OPTIONS}\n{EXIT_STATUS}"

SCRIPT = """_drillpetsc() {{
  local words="" word=${{COMP_WORDS[COMP_CWORD]}}
  if [ "$COMP_CWORD" = 1 ]; then words="{commands}"; else
    case "${{COMP_WORDS[1]}} ${{COMP_WORDS[COMP_CWORD-1]}}" in
{choices}
      *) case "${{COMP_WORDS[1]}}" in
{options}
      esac;;
    esac
  fi
  COMPREPLY=($(compgen -W "$words" -- "$word"))
}}
complete -o default -F _drillpetsc drillpetsc scripts/drillpetsc"""


OFFERED: list[type[Operation]] = []
"""All commands; the package that lists them sets it."""


class Completion(Operation):
    """Print a script that completes commands and options in bash: eval "$(drillpetsc completion)"."""

    def compute(self, job: Any) -> Any:
        options, choices = [], []
        for operation in OFFERED:
            shown = [q for q in operation.options() if not {Mark.ARGUMENT, Mark.PYTHON} & set(q.marks)]
            options.append(
                f'        {operation.command()}) words="{" ".join(q.flag for q in shown)} --help";;'
            )
            choices += [
                f'      "{operation.command()} {q.flag}") words="{" ".join(map(str, q.choices))}";;'
                for q in shown
                if q.choices
            ]
        commands = " ".join(operation.command() for operation in OFFERED)
        return SCRIPT.format(commands=commands, choices="\n".join(choices), options="\n".join(options))


class Man(Operation):
    """Print the manual page, for `man`: drillpetsc man >drillpetsc.1."""

    def compute(self, job: Any) -> Any:
        lines = [
            f'.TH DRILLPETSC 1 "" "drillpetsc {__version__}"',
            ".SH NAME",
            "drillpetsc \\- drillstring dynamics on PETSc",
            ".SH SYNOPSIS",
            ".B drillpetsc",
            "COMMAND [options]",
            ".br",
            ".B mpirun \\-n 4 drillpetsc",
            "COMMAND [options]",
            ".SH DESCRIPTION",
            "Simulates a drillstring in its hole and mud, from a case file.",
            ".SH COMMANDS",
        ]
        for operation in OFFERED:
            lines += _section(operation)
        lines += [".SH PETSC OPTIONS", _roff(PETSC_OPTIONS), ".SH EXIT STATUS", _roff(EXIT_STATUS)]
        return "\n".join(lines)


def _section(operation: type[Operation]) -> Iterator[str]:
    shown = [q for q in operation.options() if Mark.PYTHON not in q.marks]
    words = [q.flag for q in shown if Mark.ARGUMENT in q.marks]
    yield f'.SS "{_roff(" ".join([operation.command(), *words]))}"'
    yield _roff(operation.summary()) + "."
    for option in shown:
        yield ".TP"
        yield f"\\fB{_roff(option.flag)}\\fR {_roff(_value_of(option))}".rstrip()
        yield _roff(option.text)


def _value_of(option: Option) -> str:
    """Placeholder of the value of an option, or its words; empty of an argument and of a switch."""
    if Mark.ARGUMENT in option.marks or option.kind is bool:
        return ""
    return "{" + ",".join(map(str, option.choices)) + "}" if option.choices else option.metavar


def _roff(text: str) -> str:
    """Text as roff has it: one line, dashes and backslashes as they are, no command at the start."""
    plain = " ".join(text.split()).replace("\\", "\\e").replace("-", "\\-").replace('"', "\\(dq")
    return re.sub(r"^([.'])", r"\\&\1", plain)
