"""What can go wrong, in words for the person who wrote the case.

A `CaseError` is bad input (exit status 2, nothing was written); a `SolveError` is a run that could not go on
(exit status 1, what was written up to then is kept).
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

LONGEST = 1000  # letters of one part of a message; a word from a file may be endless


def shown(value: object, longest: int = 60) -> str:
    """A value as its author would recognise it, on one line."""
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return f"{float(value):g}" if float(f"{value:g}") == value else repr(float(value))
    try:
        text = str(value)
    except (ValueError, RecursionError):  # a whole number of more than 4300 digits; lists in lists in lists
        text = f"a {type(value).__name__} too large to show"
    return plain(text, longest)


def plain(text: str, longest: int) -> str:
    """Text on one line, cut to a length, with what a terminal would act upon written out."""
    text = " ".join(text[: 20 * longest].split()) if len(text) > 20 * longest else " ".join(text.split())
    text = text if len(text) <= longest else text[: longest - 3] + "..."
    if text.isprintable():
        return text
    return "".join(
        c if c.isprintable() else c.encode("unicode_escape", "surrogatepass").decode("ascii") for c in text
    )


RESTART_HINT = "what was written up to now can be read; make room, then continue with --restart"


def cannot_write(error: OSError, what: str) -> str:
    """Message for a file that cannot be written.

    what: name of the file
    """
    return f"cannot write {what}: {os.strerror(error.errno) if error.errno else error}"


def _rebuild(kind: type[DrillError], state: dict[str, object]) -> DrillError:
    error = kind.__new__(kind)
    error.__dict__.update(state)
    return error


class DrillError(Exception):
    """Base of every error that is ours to explain."""

    exit_status = 1

    def __reduce__(self) -> tuple[object, ...]:
        """Errors travel between ranks, so they must survive pickling with their named parts."""
        return _rebuild, (type(self), self.__dict__)


class CaseError(DrillError):
    """Bad input: place, what was given, what is allowed, and a cure.

    at    key path as in the case file, `string[3].od`; empty when the file as a whole is meant
    got   the value as given; None when there is none
    want  what is allowed
    hint  a likely cause or cure
    file, line   where it stands (line counts from 1)
    also  further errors found in the same file
    """

    exit_status = 2

    def __init__(
        self,
        at: str = "",
        got: object = None,
        want: str = "",
        hint: str = "",
        file: str | Path | None = None,
        line: int | None = None,
        also: Sequence[CaseError] = (),
    ) -> None:
        super().__init__()
        self.at = at
        self.got = got
        self.want = want
        self.hint = hint
        self.file = None if file is None else str(file)
        self.line = line
        self.also = tuple(also)

    def place(self) -> str:
        """`file, line 12: string[3].od`, as much of it as is known."""
        where = self.file or ""
        if self.line is not None:
            where += f", line {self.line}" if where else f"line {self.line}"
        at = plain(self.at, LONGEST)
        if where and at:
            return f"{where}: {at}"
        return where or at or "case"

    def __str__(self) -> str:
        lines = [self.place()]
        if self.got is not None:
            lines.append(f"  given:   {shown(self.got)}")
        if self.want:
            lines.append(f"  allowed: {plain(self.want, LONGEST)}")
        if self.hint:
            lines.append(f"  hint:    {plain(self.hint, LONGEST)}")
        for error in self.also:
            lines.extend(str(error).splitlines())
        return "\n".join(lines)


class SolveError(DrillError):
    """A computation that could not go on: what happened, when and where.

    time [s], component and element name the part of the model, measured_depth [m] the place on the string.
    """

    exit_status = 1

    def __init__(
        self,
        what: str,
        time: float | None = None,
        component: str = "",
        element: int | None = None,
        measured_depth: float | None = None,
        hint: str = "",
    ) -> None:
        super().__init__()
        self.what = what
        self.time = time
        self.component = component
        self.element = element
        self.measured_depth = measured_depth
        self.hint = hint

    def __str__(self) -> str:
        where = []
        if self.time is not None:
            where.append(f"time {self.time:.6g} s")
        if self.component:
            where.append(f"component {self.component}")
        if self.element is not None:
            where.append(f"element {self.element}")
        if self.measured_depth is not None:
            where.append(f"measured depth {self.measured_depth:.6g} m")
        lines = [self.what]
        if where:
            lines.append("  where:   " + ", ".join(where))
        if self.hint:
            lines.append(f"  hint:    {self.hint}")
        return "\n".join(lines)


class Interrupted(DrillError):
    """A run that was asked to end by a ``signal`` and did, at ``time`` [s], with a checkpoint in
    ``folder``."""

    exit_status = 1

    def __init__(self, signal: str, time: float, folder: str | Path) -> None:
        super().__init__()
        self.signal, self.time, self.folder = signal, time, str(folder)

    def __str__(self) -> str:
        return (
            f"stopped by {self.signal} at {self.time:.6g} s, with a checkpoint\n"
            f"  continue: the same command with --out {self.folder} --restart"
        )
