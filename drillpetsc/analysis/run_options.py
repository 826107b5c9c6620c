"""PETSc options in commands without time integration: those of the case's runs are accepted, misspelt ones are not."""

from __future__ import annotations

from collections.abc import Iterable

from petsc4py import PETSc

from drillpetsc.analysis.transient import make_integrator
from drillpetsc.case.case import Case
from drillpetsc.model.drilling_model import build_model
from drillpetsc.solvers import petsc_options as options


def refuse_misspelt(case: Case, names: Iterable[str]) -> None:
    """Raise OptionError for options that a run of the case would not read either.

    names: options that the user gave.  An integrator is made only where one of them is not generally known.
    """
    known = {name.removeprefix("q_") for name in options.KNOWN_OPTIONS}
    doubtful = [name for name in options.unread(names) if name.removeprefix("q_") not in known]
    if doubtful:
        make_integrator(build_model(case, PETSc.COMM_SELF))
        options.refuse_unread(doubtful)
