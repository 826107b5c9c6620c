"""PETSc options.  The command line overrides the case file; options that are never read are errors."""

from __future__ import annotations

import ctypes
import difflib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager

from petsc4py import PETSc

from drillpetsc.errors import CaseError

#: parts of names of options that PETSc reads late (views, logs) or at its own start
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
    before = dict(database.getAll())
    for name, value in case_options.items():
        if name not in before:
            text = str(value).lower() if isinstance(value, bool) else str(value)
            database.setValue(name, text)
    try:
        yield [*before, *case_options]
    finally:
        for name in database.getAll():
            if name not in before:
                database.delValue(name)
        for name, value in before.items():
            database.setValue(name, value)


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
    return _is_late(name) or name in ("drillpetsc_gain_limit", "drillpetsc_stop_on_gain")


def refuse_unread(names: Iterable[str]) -> None:
    """Raise CaseError for options that the solvers, once set up, have not read."""
    for name in unread(names):
        raise not_an_option(name, "this case")


def not_an_option(name: str, where: str) -> CaseError:
    """Return the error for an option that is not read; ``where``: the run or command it was given to."""
    near = difflib.get_close_matches(name, KNOWN_OPTIONS, n=1)
    return CaseError(
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
)
