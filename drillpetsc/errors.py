"""Errors, with messages for the user.

A `CaseError` is bad input: exit status 2, nothing has been written. A `SolveError` is a computation that cannot
continue: exit status 1, earlier output is kept.
"""

from __future__ import annotations

import os
import shlex
from collections.abc import Sequence
from pathlib import Path

LONGEST = 1000  # letters of one part of a message; a word of a file may have any length


def shown(value: object, longest: int = 60) -> str:
    """A value as the user wrote it, on one line, cut to `longest` letters."""
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
    """Text on one line, cut to `longest` letters, with control characters written out."""
    text = " ".join(text[: 20 * longest].split()) if len(text) > 20 * longest else " ".join(text.split())
    text = text if len(text) <= longest else text[: longest - 3] + "..."
    if text.isprintable():
        return text
    return "".join(
        c if c.isprintable() else c.encode("unicode_escape", "surrogatepass").decode("ascii") for c in text
    )


RESTART_HINT = "the output written so far can be read; free disk space, then continue with --restart"


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
    """Base of all errors whose message explains them to the user."""

    exit_status = 1

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle an error with its named parts, as messages between ranks need."""
        return _rebuild, (type(self), self.__dict__)

    def _render_traceback_(self) -> list[str]:
        """The error in a notebook: the message on one line, without the library's traceback."""
        parts = [line.strip() for line in str(self).splitlines()]
        return [f"{type(self).__name__}: " + "; ".join(" ".join(part.split()) for part in parts if part)]


class CaseError(DrillError):
    """Bad input: place, value, allowed values, and a cure.

    at: key path as in the case file, `string[3].od`; empty for the file as a whole
    got: value as given; None if there is none
    want: what is allowed
    hint: a likely cause or cure
    file, line: place of the value; lines count from 1
    also: further errors in the same file
    longest: letters of the value that are shown
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
        longest: int = 60,
    ) -> None:
        super().__init__()
        self.longest = longest
        self.at = at
        self.got = got
        self.want = want
        self.hint = hint
        self.file = None if file is None else str(file)
        self.line = line
        self.also = tuple(also)

    def place(self) -> str:
        """`file, line 12: string[3].od`, without unknown parts."""
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
            lines.append(f"  given:   {shown(self.got, self.longest)}")
        if self.want:
            lines.append(f"  allowed: {plain(self.want, LONGEST)}")
        if self.hint:
            lines.append(f"  hint:    {plain(self.hint, LONGEST)}")
        for error in self.also:
            lines.extend(str(error).splitlines())
        return "\n".join(lines)


class OptionError(CaseError):
    """A PETSc option that is refused; its message is one line."""

    def __str__(self) -> str:
        parts = [] if self.got is None else [f"given {shown(self.got)}"]
        parts += [f"allowed: {plain(self.want, LONGEST)}"] if self.want else []
        parts += [plain(self.hint, LONGEST)] if self.hint else []
        return f"{self.place()}: " + "; ".join(parts)


class SolveError(DrillError):
    """A computation that cannot go on.

    what: what happened
    time: simulated time [s]
    component: name of the component of the model
    element: number of the element
    measured_depth: place on the string [m]
    item: name of the item of the string there
    place: the measured depth as text, in the units of the case; in m when not given
    hint: a likely cause or cure
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
        item: str = "",
        place: str = "",
    ) -> None:
        super().__init__()
        self.item, self.place = item, place
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
            place = self.place or f"{self.measured_depth:.6g} m"
            where.append(f"at MD {place}" + (f" ({self.item})" if self.item else ""))
        lines = [self.what]
        if where:
            lines.append("  where:   " + ", ".join(where))
        if self.hint:
            lines.append(f"  hint:    {self.hint}")
        return "\n".join(lines)


class Interrupted(DrillError):
    """A run that a signal has ended, with a checkpoint.

    signal: name of the signal
    time: simulated time [s]
    folder: run folder
    """

    exit_status = 1

    def __init__(self, signal: str, time: float, folder: str | Path) -> None:
        super().__init__()
        self.signal, self.time, self.folder = signal, time, str(folder)

    def __str__(self) -> str:
        return (
            f"stopped by {self.signal} at {self.time:.6g} s, with a checkpoint\n"
            f"  continue: the same command with --out {shlex.quote(self.folder)} --restart"
        )
