"""Parser of the command line, and dispatch to the commands."""

from __future__ import annotations

import argparse
import os
import re
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, get_args, get_origin

from drillpetsc import __version__, operations
from drillpetsc.errors import CaseError, DrillError, SolveError
from drillpetsc.operations.operation import RENAMED_OPTIONS, Mark, Option
from drillpetsc.operations.shell import EPILOG, EXIT_STATUS
from drillpetsc.parallel import ENDING, report_error, report_interrupt
from drillpetsc.units import is_number

_NEGATIVE = re.compile(r"-\.?\d")  # a number below zero, with or without a unit: no option begins so
_CASE_KEY = re.compile(r"[A-Za-z_]\w*(\[\d+\]|\.\w+)*\s*=")  # KEY=..., which is no value of a PETSc option


def main(words: list[str] | None = None) -> int:
    """Run the command line and return the exit status.

    words: command line without the name of the program; by default that of this process
    """
    try:
        try:
            with _signals_put_back():
                return _main(words)
        finally:
            sys.stdout.flush()
    except BrokenPipeError:  # the reader, `head` for instance, has read enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0


@contextmanager
def _signals_put_back() -> Iterator[None]:
    """Within this context SIGUSR1 does not end the process: a run takes it over when it moves, and begins with a checkpoint anyway.

    At the end all signals that a command takes over (``parallel.start_job``) have their handlers of before: a program that calls
    a command goes on, and SIGTERM ends it as usual.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    taken = [getattr(signal, name) for name in ("SIGUSR1", "SIGPIPE", *ENDING) if hasattr(signal, name)]
    before = {number: signal.getsignal(number) for number in taken}
    if hasattr(signal, "SIGUSR1") and before[signal.SIGUSR1] == signal.SIG_DFL:
        signal.signal(signal.SIGUSR1, lambda *_: None)
    try:
        yield
    finally:
        for number, handler in before.items():
            if handler is not None:  # None: not set from Python
                signal.signal(number, handler)


def _main(words: list[str] | None) -> int:
    words = sys.argv[1:] if words is None else words
    own, petsc_options = split_words(words)
    if own[:2] == ["import", "log"]:
        own[:2] = ["import-log"]
    try:
        _refuse_old(own)
        arguments, unknown = parser(own[:1]).parse_known_args(own)
        operation = next(q for q in operations.OPERATIONS if q.command() == arguments.command)
        if unknown:
            raise _unknown_option(unknown[0])
        if petsc_options and not operation.petsc:
            raise CaseError(at=petsc_options[0], want=f"no PETSc options with {operation.command()}")
        given = {
            q.name: getattr(arguments, q.name) for q in operation.options() if hasattr(arguments, q.name)
        }
        return operation(**given).run(petsc_options)
    except DrillError as error:
        return report_error(error)
    except KeyboardInterrupt:
        return report_interrupt()
    except RuntimeError as error:  # PETSc.Error is one
        if "petsc4py.PETSc" not in sys.modules or not isinstance(error, sys.modules["petsc4py.PETSc"].Error):
            raise
        from drillpetsc.petsc_compat import reason_of

        return report_error(SolveError(f"PETSc failed: {reason_of(error)}", hint="check the PETSc options"))


def parser(wanted: list[str] | None = None) -> argparse.ArgumentParser:
    """The parser of all commands.

    wanted: the one command that is needed, which saves most of the time; None: all. Of an unknown one it has the names of all.
    """
    whole = argparse.ArgumentParser(
        prog="drillpetsc", description="Drillstring dynamics on PETSc.", **_PARSER_STYLE
    )
    whole.add_argument("--version", action="version", version=f"drillpetsc {__version__}")
    sub = whole.add_subparsers(dest="command", required=True, metavar="COMMAND")
    chosen = [q for q in operations.OPERATIONS if wanted is None or q.command() in wanted]
    for operation in chosen or operations.OPERATIONS:
        command = sub.add_parser(
            operation.command(),
            help=operation.summary().replace("%", "%%"),
            description=operation.summary(),
            **(_PARSER_STYLE if operation.petsc else _PARSER_STYLE | {"epilog": EXIT_STATUS}),
        )
        for option in operation.options() if chosen else ():
            if Mark.PYTHON not in option.marks:
                _add_option(command, option)
    return whole


def _add_option(command: argparse.ArgumentParser, option: Option) -> None:
    words: dict[str, Any] = {"help": option.text.replace("%", "%%"), "default": option.default}
    if option.kind is bool:
        command.add_argument(option.flag, action="store_true", help=words["help"])
        return
    if option.metavar:
        words["metavar"] = option.metavar
    if option.choices:
        words["choices"] = option.choices
    if option.kind in (int, float):
        words["type"] = option.kind
    many = get_origin(option.kind) is tuple
    if many and Ellipsis not in get_args(option.kind):  # a pair
        words |= {"nargs": len(get_args(option.kind)), "metavar": tuple(option.metavar.split())}
    if bool in get_args(option.kind):  # the value may be left out
        words |= {"nargs": "?", "const": True}
    if Mark.ARGUMENT in option.marks:
        nargs = {(True, True): "+", (True, False): "*", (False, False): "?"}.get((many, option.required))
        words |= {"nargs": nargs} if nargs else {}
        if option.required:
            del words["default"]
        command.add_argument(option.name, **words)
        return
    if many and Ellipsis in get_args(option.kind):  # given several times
        words |= {"action": "append", "default": []}
    if option.required:
        words |= {"required": True, "default": None}
    command.add_argument(option.flag, dest=option.name, **words)


_PARSER_STYLE: dict[str, Any] = {
    "epilog": EPILOG,
    "allow_abbrev": False,
    "formatter_class": argparse.RawDescriptionHelpFormatter,
}


def split_words(words: list[str]) -> tuple[list[str], list[str]]:
    """(words of this program, PETSc options).

    Words of this program have no dash or two. A PETSc option is -word and the value after it, which may be a
    negative number. A number below zero after an option of this program is its value (`--amplitude -5kN`), and so is KEY=VALUE
    after `--set`.
    """
    own: list[str] = []
    petsc_options: list[str] = []
    i = 0
    while i < len(words):
        word = words[i]
        value = (
            not is_number(word)
            and own
            and i
            and own[-1] == words[i - 1]
            and own[-1].startswith("--")
            and "=" not in own[-1]
        )
        if value and (_NEGATIVE.match(word) or (own[-1] == "--set" and word[:1] == "-" and "=" in word)):
            own[-1] += (
                f"={word}"  # as one word, since a parser takes a dash before other words for the sign of an option
            )
        elif (
            word.startswith("-")
            and not word.startswith("--")
            and word not in ("-h", "-o")
            and not _NEGATIVE.match(word)
            and len(word) > 1
        ):
            petsc_options.append(word)
            following = words[i + 1] if i + 1 < len(words) else "-"
            if (
                (not following.startswith("-") or _NEGATIVE.match(following))
                and not following.endswith((".yaml", ".yml"))
                and not (words[0] == "sweep" and _CASE_KEY.match(following))
            ):
                petsc_options.append(following)
                i += 1
        else:
            own.append(word)
        i += 1
    return own, petsc_options


def _refuse_old(words: list[str]) -> None:
    """Raise CaseError for a former option, which names the present one."""
    for old in (word.partition("=")[0] for word in words):
        if old in RENAMED_OPTIONS:
            new = RENAMED_OPTIONS[old]
            raise CaseError(at=old, want=new, hint=f"{old} is now called {new}")


def _unknown_option(word: str) -> CaseError:
    hint = f"to change a key of the case: --set '{word}'" if _CASE_KEY.match(word) else ""
    return CaseError(
        at=word, want="a known --option (see --help), or a PETSc option with one dash", hint=hint
    )
