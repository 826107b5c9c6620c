"""Checks of the outcome of reading a case: a validated case with the given values, or a helpful CaseError."""

from __future__ import annotations

import math
import signal
import traceback
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

from drillpetsc.case import Case
from drillpetsc.case.writer import case_data
from drillpetsc.errors import CaseError
from drillpetsc.units import DIMENSIONS, UnitError, to_si

LONGEST_LINE = 1020  # characters of a message
VALID, REFUSED = "valid", "refused"
#: keys whose values become other keys
CONVERTED = {
    "dial",
    "fit",
    "pv",
    "yp",
    "n",
    "k",
    "ty",
    "surface_line",
    "annulus_rheology",
    "units",
    "force_unit",
}

Result = TypeVar("Result")


class Hang(BaseException):
    """Reading took longer than the deadline."""


class Failure(Exception):
    """A forbidden outcome; the text is the same for the same cause."""


@contextmanager
def deadline(seconds: float) -> Iterator[None]:
    """Raise Hang in the block when it exceeds the processor time (main thread only).

    Processor time does not depend on the load of the machine.
    """

    def ring(number: int, frame: Any) -> None:
        raise Hang(f"longer than {seconds:g} s")

    before = signal.signal(signal.SIGPROF, ring)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


def guarded(work: Callable[[], Result], seconds: float = 5.0) -> Result:
    """Result or CaseError of ``work``; Failure for any other exception, for a warning and for a hang."""
    try:
        with warnings.catch_warnings(), deadline(seconds):
            warnings.simplefilter("error")
            return work()
    except (CaseError, Failure):
        raise
    except (Exception, Hang, SystemExit) as error:
        frames = [
            f
            for f in traceback.extract_tb(error.__traceback__)
            if "drillpetsc" in f.filename and "fuzz" not in f.filename
        ]
        where = f"{Path(frames[-1].filename).name} {frames[-1].name}" if frames else "?"
        text = " ".join(str(error).split())[:80]
        raise Failure(
            f"{type(error).__name__} in {where}" + (f": {text}" if not isinstance(error, Hang) else "")
        ) from error


def check_message(error: CaseError, files: tuple[Path, ...], lines: int | None) -> None:
    """Raise Failure unless the message names file, line, key, the given and the allowed values, in lines that a
    terminal can show.

    files: files in which the error may be.
    lines: number of lines of the case file; None without a file.
    """
    for each in (error, *error.also):
        message = str(each)
        if not each.want:
            raise Failure("message without what is allowed")
        if each.file is None or Path(each.file) not in files:
            raise Failure(f"message without the file: want {each.want[:40]}")
        if (
            lines is not None
            and each.line is not None
            and Path(each.file) == files[0]
            and not 1 <= each.line <= lines + 1
        ):
            raise Failure(f"message with a line that the file does not have: {each.want[:40]}")
        if each.line is None and "UTF-8" not in each.want:
            raise Failure(f"message without a line: want {each.want[:40]}")
        if (
            not each.at
            and each.got is None
            and "UTF-8" not in each.want
            and "header" not in each.want
            and "stations" not in each.want
        ):
            raise Failure(f"message without key or value: want {each.want[:40]}")
        if any(len(row) > LONGEST_LINE + len(each.file) for row in message.split("\n")):
            raise Failure(f"message with an endless line: want {each.want[:40]}")
        if any(not letter.isprintable() and letter != "\n" for letter in message):
            raise Failure("message with unprintable letters")


# ---------------------------------------------------------------------- given values in the case
def check_visible(case: Case, path: tuple[str | int, ...], given: Any, held: Any = None) -> None:
    """Raise Failure unless the validated case has the value given at the path, in SI.

    Values must not be replaced or dropped without an error. held: case_data(case), if known.
    """
    data: Any = case_data(case) if held is None else held
    if case.output.units is not None and path[0] != "petsc":  # bare numbers are not in SI
        return
    inside = {str(key) for key in given} if isinstance(given, dict) else set()
    if CONVERTED & ({str(step) for step in path} | inside):
        return
    if (
        not path
        or path[-1] in ("survey", "from")
        and isinstance(given, str)
        or path[-1] == "name"
        and given == ""
    ):  # of files; none
        return
    if path[0] == "contact" and case.hold_string:  # which says that there is none
        return
    if given is None and path[0] != "petsc":  # from Python a key left out; the YAML reader refuses it
        return
    for depth, step in enumerate(path):
        if isinstance(data, list) and len(data) == 1 and isinstance(step, str):
            data = data[0]  # a key that takes one block or a list of them is written as a list
        if isinstance(data, (dict, list)) and (
            step in data if isinstance(data, dict) else int(step) < len(data)
        ):
            data = data[step]  # type: ignore[index]
            continue
        if not _dropped_by_contract(case, path[:depth], step, given):
            raise Failure(f"accepted but not in the case: {_shape(path)}")
        return
    if not same(given, data):
        raise Failure(f"accepted but changed: {_shape(path)}")


def _shape(path: tuple[str | int, ...]) -> str:
    return ".".join("[]" if isinstance(step, int) else step for step in path)[:100]


def _dropped_by_contract(case: Case, block: tuple[str | int, ...], step: str | int, given: Any) -> bool:
    """Whether the case format omits the value from a validated case."""
    if step in ("from_", "to_"):  # the Python name of the key
        return True
    if (block or (step,))[0] == "contact":
        return given == "none" or (case.well is None and step == "contact")
    if len(block) >= 2 and block[0] == "string" and "material" in (*block, step):
        return getattr(case.string[int(block[1])], "material", None) == case.material
    if given in ({}, []):
        return True
    return len(block) == 1 and block[0] == "top" and step == "lowering"


def same(given: Any, held: Any) -> bool:
    """Whether the case has the given value: a number in SI, a word, a list, or a mapping with added defaults."""
    if type(given) is type(held) and given == held:
        return True
    if isinstance(held, dict):
        if isinstance(given, str):
            return given == held.get("kind", given)
        if not isinstance(given, dict):
            return False
        return all(key not in held or same(value, held[key]) for key, value in given.items())
    if isinstance(held, list):
        if not isinstance(given, list):  # one number along an axis
            return sum(part != 0 for part in held) <= 1 and any(same(given, part) for part in held)
        return len(held) >= len(given) and all(same(a, b) for a, b in zip(given, held, strict=False))
    if isinstance(held, bool) or isinstance(given, bool):
        return given is held
    if isinstance(held, (int, float)):
        return given == "none" and held == 0 or _same_number(given, float(held))
    if given is None:
        return held == ""
    return given == held or isinstance(given, dict) and given.get("kind") == held


def _same_number(given: Any, held: float) -> bool:
    if not isinstance(given, str):
        return isinstance(given, (int, float)) and math.isclose(given, held, rel_tol=1e-12)
    for unit in list(_UNITS):
        try:
            if math.isclose(to_si(given, unit), held, rel_tol=1e-12):
                _UNITS.remove(unit)  # the usual ones come to the front: trying all takes milliseconds
                _UNITS.insert(0, unit)
                return True
        except UnitError:
            continue
    return False


_UNITS = [*DIMENSIONS, "rad/m^3"]


def check_round_trip(case: Case, load: Callable[[str], Case]) -> None:
    """Raise Failure unless the written case reads as the same case, and is written identically again."""
    text = case.to_yaml()
    try:
        again = load(text)
    except CaseError as error:
        raise Failure(f"its own to_yaml is refused: {error.at} {error.want[:60]}") from error
    if again != case:
        first, second = case_data(case), case_data(again)
        keys = [key for key in first if first.get(key) != second.get(key)]
        raise Failure(f"load(to_yaml(case)) differs in {', '.join(keys) or 'something not written'}")
    if again.to_yaml() != text:
        raise Failure("to_yaml of the case read back differs")
