"""PETSc options.  The command line overrides the case file; options that are never read are errors."""

from __future__ import annotations

import ctypes
import difflib
import math
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from petsc4py import PETSc

from drillpetsc import petsc_compat
from drillpetsc.errors import OptionError

#: integrators that are offered
INTEGRATORS = "bdf | alpha2 | beuler | cn | theta | alpha | arkimex | dirk"
#: parts of names of options that PETSc reads late (views, logs) or when it starts
READ_LATE = (
    "view",
    "monitor",
    "log_",
    "malloc",
    "options_left",
    "options_table",
    "help",
    "on_error",
    "fp_trap",
    "checkstack",
    "reason",
    "debugger",
    "no_signal_handler",
    "petsc",
    "info",
)


@contextmanager
def applied(case_options: Mapping[str, object]) -> Iterator[list[str]]:
    """Set the options of a case while a run lasts; options of the command line override them.

    Yields the names that the user gave, in the case or on the command line.
    """
    database = PETSc.Options()
    petsc_compat.rename_time_step(database)
    before = dict(database.getAll())
    for name, value in case_options.items():
        if name not in before:
            text = str(value).lower() if isinstance(value, bool) else str(value)
            database.setValue(name, text)
    petsc_compat.rename_time_step(database)
    try:
        refuse_values(database.getAll())
        yield [*before, *case_options]
    finally:
        for name in database.getAll():
            if name not in before:
                database.delValue(name)
        for name, value in before.items():
            database.setValue(name, value)


#: values that PETSc or this program would misread: name -> (smallest, whether it is excluded, largest, whole number)
NUMBERS: dict[str, tuple[float, bool, float, bool]] = {
    "ts_rtol": (0, True, 1, False),
    "ts_dt": (0, True, math.inf, False),
    "ts_time_step": (0, True, math.inf, False),
    "ts_adapt_dt_max": (0, True, math.inf, False),
    "ts_adapt_dt_min": (0, True, math.inf, False),
    "ts_bdf_order": (1, False, 6, True),
    "ts_alpha_radius": (0, False, 1, False),
    "ts_max_steps": (1, False, 2**31 - 1, True),
    "ts_max_reject": (-1, False, 2**31 - 1, True),
    "ts_max_step_rejections": (-1, False, 2**31 - 1, True),
    "q_snes_stol": (0, True, 1, False),
    "q_snes_max_it": (1, False, 2**31 - 1, True),
    "q_snes_rtol": (0, False, 1, False),
    "snes_stol": (0, False, 1, False),
    "snes_rtol": (0, False, 1, False),
    "snes_max_it": (1, False, 2**31 - 1, True),
    "drillpetsc_gain_limit": (0, True, math.inf, False),
    "drillpetsc_newton_work": (0, False, 1, False),
}
#: words that PETSc accepts; the last word of the option's name covers all prefixes
WORDS = {
    "ts_adapt_type": ("basic", "none", "dsp"),
    "ts_exact_final_time": ("matchstep",),
    "snes_linesearch_type": ("basic", "bt", "cp", "l2", "nleqerr"),
}
#: classes of PETSc whose types are accepted; the last words of the option's name cover all prefixes
TYPES = {
    "snes_type": PETSc.SNES,
    "ksp_type": PETSc.KSP,
    "pc_type": PETSc.PC,
    "mat_type": PETSc.Mat,
    "vec_type": PETSc.Vec,
}
#: options that something else sets
SET_ELSEWHERE = {
    "ts_max_time": "time.end of the case is the end of the run",
    "ts_final_time": "time.end of the case is the end of the run",
    "ts_init_time": "a run starts at 0 s",
    "ts_atol": "-ts_rtol sets the tolerances of all unknowns",
}
#: integrators that PETSc has and that are refused, with the reason
REFUSED_INTEGRATORS = {
    "rosw": "its stages do not fulfil the equations of motion, so hook load and surface torque would be wrong; use arkimex",
}


def refuse_values(options: Mapping[str, str]) -> None:
    """Raise OptionError for values that PETSc would refuse with a stack, or misread.

    options: name without dash -> value.
    """
    for name, text in options.items():
        if name in SET_ELSEWHERE:
            raise OptionError(
                at=f"petsc option -{name}", got=text, want="not this option", hint=SET_ELSEWHERE[name]
            )
        if name in NUMBERS:
            _refuse_number(name, text)
        for ending, words in WORDS.items():
            if name.endswith(ending) and text not in words:
                raise OptionError(at=f"petsc option -{name}", got=text, want=" | ".join(words))
        for ending, kind in TYPES.items():
            if name == ending or name.endswith(f"_{ending}"):
                _refuse_type(name, text, kind)


def refuse_integrator_of_run(options: Mapping[str, str]) -> None:
    """Raise OptionError for an integrator whose outputs would be wrong, with the reason."""
    kind = options.get("ts_type", "bdf")
    if kind in REFUSED_INTEGRATORS:
        raise OptionError(
            at="petsc option -ts_type", got=kind, want=INTEGRATORS, hint=REFUSED_INTEGRATORS[kind]
        )


def _refuse_number(name: str, text: str) -> None:
    low, open_end, high, whole = NUMBERS[name]
    try:
        value = float(text)
        fits = (
            (value > low if open_end else value >= low)
            and value <= high
            and (not whole or value == int(value))
        )
    except (ValueError, OverflowError):
        fits = False
    if not fits:
        want = ("a whole number " if whole else "a number ") + (
            f"above {low:g}" if open_end else f"of at least {low:g}"
        )
        want += f" and at most {high:g}" if high < 2**31 - 1 else ""
        raise OptionError(at=f"petsc option -{name}", got=text, want=want)


def _refuse_type(name: str, text: str, kind: Any) -> None:
    solver = kind().create(comm=PETSc.COMM_SELF)
    try:
        solver.setType(text)
    except PETSc.Error:
        raise OptionError(
            at=f"petsc option -{name}", got=text, want=f"a {kind.__name__} type of the installed PETSc"
        ) from None
    finally:
        solver.destroy()


@contextmanager
def refused_by_petsc() -> Iterator[None]:
    """Around a set-up from options: PETSc's error becomes an OptionError with its reason on one line."""
    try:
        yield
    except PETSc.Error as error:
        reason = petsc_compat.reason_of(error)
        raise OptionError(at="petsc options", want="options that PETSc takes", hint=reason) from None


def _was_read(name: str) -> bool:
    used = ctypes.c_int(0)
    library = ctypes.CDLL(PETSc.__file__)
    library.PetscOptionsUsed(ctypes.c_void_p(None), ctypes.c_char_p(name.encode()), ctypes.byref(used))
    return bool(used.value)


def unread(names: Iterable[str]) -> list[str]:
    """Return the options that the solvers have not read after their set-up.

    Options read only at the end are left out.
    """
    present = PETSc.Options().getAll()  # petsc_compat removes options that have a newer name
    return [name for name in names if name in present and not _is_late(name) and not _was_read(name)]


def _is_late(name: str) -> bool:
    return not name.startswith("drillpetsc_") and any(word in name for word in READ_LATE)


def changes_no_result(name: str) -> bool:
    """Whether an option acts on reports and monitors only."""
    return _is_late(name) or name in ("drillpetsc_gain_limit", "drillpetsc_stop_on_gain", "ts_max_steps")


def refuse_unread(names: Iterable[str]) -> None:
    """Raise CaseError for options that the solvers, once set up, have not read."""
    for name in unread(names):
        raise not_an_option(name, "this case")


def not_an_option(name: str, where: str) -> OptionError:
    """Return the error for an option that is not read; ``where``: the run or command it was given to."""
    near = difflib.get_close_matches(name, KNOWN_OPTIONS, n=1)
    return OptionError(
        at=f"petsc option -{name}",
        want=f"an option that PETSc or drillpetsc reads in {where}",
        hint=f"did you mean -{near[0]}?"
        if near
        else "check the spelling and the prefix (-q_ for the condensed Newton)",
    )


#: options that a hint may suggest
KNOWN_OPTIONS = (
    "ts_type",
    "ts_bdf_order",
    "ts_alpha_radius",
    "ts_rtol",
    "ts_dt",
    "ts_time_step",
    "ts_adapt_type",
    "ts_adapt_clip",
    "ts_adapt_dt_max",
    "ts_adapt_dt_min",
    "ts_max_reject",
    "ts_adapt_wnormtype",
    "ts_max_steps",
    "ts_max_snes_failures",
    "snes_type",
    "q_snes_stol",
    "q_snes_max_it",
    "q_snes_rtol",
    "q_snes_linesearch_type",
    "q_ksp_type",
    "q_pc_type",
    "q_pc_factor_mat_ordering_type",
    "ksp_type",
    "pc_type",
    "drillpetsc_energy_strict",
    "drillpetsc_stop_on_gain",
    "drillpetsc_gain_limit",
    "drillpetsc_newton_work",
)
