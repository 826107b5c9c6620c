"""Options of PETSc that no member of an ensemble would read are refused before any member runs."""

from __future__ import annotations

import gc
from collections.abc import Hashable, Sequence

from petsc4py import PETSc

from drillpetsc.analysis.quasi_static import QuasiStatic
from drillpetsc.analysis.transient import make_integrator
from drillpetsc.case import Case
from drillpetsc.errors import CaseError, DrillError
from drillpetsc.model.drilling_model import build_model, is_quasi_static
from drillpetsc.output.energy_balance import EnergyGainMonitor
from drillpetsc.output.recorder import Recorder
from drillpetsc.solvers import petsc_options as options


def refuse_misspelt(comm: PETSc.Comm, cases: Sequence[Case]) -> None:
    """Raise CaseError for an option, of the command line or of a case, that no scene of ``cases`` reads;
    collective over ``comm``.

    Rank 0 sets up one scene, and more of other physics as long as an option is left that none has read.
    """
    mpi = comm.tompi4py()
    answer: CaseError | list[str] | None = None
    if comm.rank == 0:
        given = list(PETSc.Options().getAll())
        left = _left(given, cases)
        answer = options.not_an_option(left[0], "one of the scenes") if left else given
    answer = mpi.bcast(answer)
    if isinstance(answer, CaseError):
        raise answer
    for name in answer or ():
        PETSc.Options().hasName(
            name
        )  # asking counts as reading: a member whose scene leaves it unread runs all the same


def _left(given: Sequence[str], cases: Sequence[Case]) -> list[str]:
    """Names of options that no scene has read, in the order in which they were given."""
    names = dict.fromkeys([*given, *(name for case in cases for name in case.petsc)])
    tried: set[Hashable] = set()
    built = 0
    for case in cases:
        if not names:
            break
        if (what := _physics(case)) in tried:
            continue
        tried.add(what)
        try:
            read = _read(case)
        except DrillError:  # the member will say so in its row
            continue
        built += 1
        for name in read:
            names.pop(name, None)
    return list(names) if built else []


def _physics(case: Case) -> Hashable:
    """The same for cases whose solvers read the same options."""
    fluid, contact = case.fluid, case.contact
    return (
        fluid is not None and (fluid.formulation, fluid.dynamics), contact is not None and contact.law, case.formation is not None,
        case.hold_string, case.beam.formulation, case.top.kind, case.bottom.kind, case.time is not None and case.time.mode,
        tuple(sorted((name, str(value)) for name, value in case.petsc.items())),
    )  # fmt: skip


def _read(case: Case) -> list[str]:
    """Options that the solvers of a case read, or may read at the end, of those of the command line and of
    the case."""
    with options.applied(case.petsc) as used:
        model = build_model(case, PETSc.COMM_SELF)
        integrator = make_integrator(model, QuasiStatic(model) if is_quasi_static(case) else None)
        recorder = Recorder(model)
        EnergyGainMonitor(recorder.energy)
        unread = options.unread(used)
        del model, integrator, recorder
        gc.collect()
        return [name for name in used if name not in unread]
