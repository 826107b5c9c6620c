"""What differs between versions of petsc4py."""

from __future__ import annotations

import gc
import os
from pathlib import Path

import numpy as np
import pytest

from drillpetsc import petsc_compat
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.fem.chain import build_chain
from drillpetsc.solvers.time.first_order_system import IMPLICIT, refuse_integrator


def raise_as_petsc(error: Exception, by_context: bool) -> None:
    """As petsc4py 3.22 and newer do with what a callback raised."""
    from petsc4py import PETSc

    try:
        raise error
    except Exception as cause:
        if by_context:
            raise PETSc.Error(101)  # noqa: B904  the chain by context is what is tested
        raise PETSc.Error(101) from cause


@pytest.mark.parametrize("by_context", [False, True])
def test_errors_of_callbacks_come_out_as_they_were_raised(by_context):
    ours = SolveError("no pivot", time=1.5)
    with pytest.raises(SolveError) as caught, petsc_compat.own_errors():
        raise_as_petsc(ours, by_context)
    assert caught.value is ours


@pytest.mark.parametrize("nested", [False, True])
def test_errors_pass_while_garbage_is_collected(nested):
    """An exception on its way through PETSc outlives a collection; afterwards PETSc's own errors have their trace again.

    With Python 3.12 and newer, petsc4py 3.22 ended the process here, and 3.26 raised an error of its own.
    """
    from petsc4py import PETSc

    inner = solver_of(PETSc, raising("from within"))

    def solve_inner(snes, x, f):
        with petsc_compat.own_errors():
            inner.solve(None, inner.getSolution())

    solver = solver_of(PETSc, solve_inner) if nested else inner
    threshold = gc.get_threshold()
    gc.set_threshold(1)
    try:
        for _ in range(20):
            with pytest.raises(SolveError, match="from within"), petsc_compat.own_errors():
                solver.solve(None, solver.getSolution())
    finally:
        gc.set_threshold(*threshold)
    with pytest.raises(PETSc.Error) as caught:
        PETSc.KSP().create(PETSc.COMM_SELF).setType("no method")
    assert "KSPSetType" in str(caught.value)


def raising(text):
    """A residual that leaves cycles of objects behind and raises."""

    def residual(snes, x, f):
        for _ in range(100):
            cycle = []
            cycle.append(cycle)
        raise SolveError(text)

    return residual


def solver_of(PETSc, residual):
    """A SNES of one unknown with this residual."""
    snes = PETSc.SNES().create(PETSc.COMM_SELF)
    vector = PETSc.Vec().createSeq(1, comm=PETSc.COMM_SELF)
    snes.setSolution(vector.duplicate())
    snes.setFunction(petsc_compat.callback(residual), vector)
    snes.setUseMF(True)
    snes.setUp()
    return snes


def test_errors_of_petsc_stay_petscs():
    from petsc4py import PETSc

    with pytest.raises(PETSc.Error), petsc_compat.own_errors():
        raise PETSc.Error(56)
    with pytest.raises(KeyError), petsc_compat.own_errors():
        raise KeyError("of someone else")
    try:  # an error that is being handled when the solver is called is not the solver's
        raise ValueError("earlier")
    except ValueError:
        with pytest.raises(PETSc.Error), petsc_compat.own_errors():
            raise PETSc.Error(56)  # noqa: B904  the chain by context is what is tested


def test_integrators_that_this_petsc_lacks_are_refused():
    """dirk came with PETSc 3.19."""
    from petsc4py import PETSc

    for kind in IMPLICIT:
        if kind == "dirk" and PETSc.Sys.getVersion() < (3, 19, 0):
            with pytest.raises(CaseError) as caught:
                refuse_integrator(kind)
            assert "dirk" in str(caught.value) and "3.18" in str(caught.value)
        else:
            refuse_integrator(kind)
    with pytest.raises(CaseError):
        refuse_integrator("rk")


def test_a_new_model_frees_what_earlier_ones_left():
    """petsc4py lists what Python drops, and frees it when told: 80 MB of vectors before each chain, and the process does not grow."""
    from petsc4py import PETSc

    resident = []  # memory of this process [MB]
    for _ in range(3):
        for _ in range(10):
            PETSc.Vec().createMPI(1_000_000, comm=PETSc.COMM_WORLD).set(1.0)
        build_chain(np.linspace(0.0, 10.0, 3), PETSc.COMM_WORLD)
        pages = int(Path("/proc/self/statm").read_text().split()[1])
        resident.append(pages * os.sysconf("SC_PAGE_SIZE") / 1e6)
    assert resident[2] < resident[0] + 40.0
