"""PETSc options in commands without time integration: those of the case's runs are accepted, misspelt ones are not."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager

from petsc4py import PETSc

from drillpetsc.analysis.motion.integrator_choice import make_integrator
from drillpetsc.case.case import Case
from drillpetsc.model.drilling_model import build_model
from drillpetsc.solvers import petsc_options as options


@contextmanager
def options_of(case: Case, given: Case | None = None) -> Iterator[None]:
    """Set the PETSc options of a case while a command lasts that integrates nothing.

    given: the user's case, where the command has changed it into ``case``.
    Raises OptionError for options, of the case or of the command line, that a run of the case would not read either.
    """
    with options.applied(case.petsc) as used:
        _refuse_misspelt(given or case, used)
        yield


def _refuse_misspelt(case: Case, names: Iterable[str]) -> None:
    """Raise OptionError for such options.  An integrator is made only where one of them is not generally known."""
    known = {name.removeprefix("q_") for name in options.KNOWN_OPTIONS}
    doubtful = [name for name in options.unread(names) if name.removeprefix("q_") not in known]
    if not doubtful:
        return
    make_integrator(build_model(case, PETSc.COMM_SELF))
    options.refuse_unread(doubtful)
