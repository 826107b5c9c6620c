"""Contacts renewed apart on this rank against a whole factorisation of the same entries: contacts_apart_mpi.py OUT."""

import sys

import petsc4py

petsc4py.init([])

import numpy as np  # noqa: E402
from petsc4py import PETSc  # noqa: E402

from drillpetsc.analysis.transient import run  # noqa: E402
from drillpetsc.case import load_case  # noqa: E402
from drillpetsc.fem.contact_entries import ContactEntries  # noqa: E402
from drillpetsc.solvers.newton import CondensedNewton  # noqa: E402

comm = PETSc.COMM_WORLD
firsts: list[int] = []  # of each renewal: first node of this rank that has changed
totals = [0, 0, 0]
_update, _apart = CondensedNewton.update_contacts, ContactEntries.update


def apart(self, *arguments):
    firsts.append(_apart(self, *arguments))
    return firsts[-1]


def update(self, its):
    renewed = _update(self, its)
    if renewed:
        rows = self.last_rows()
        partly, whole = np.zeros((2, len(rows)))
        self.factor.solve_owned(rows, partly)
        self.factor.factor(self.system.assembly.values)
        self.take_factor()
        self.factor.solve_owned(rows, whole)
        assert np.array_equal(partly, whole), abs(partly - whole).max()
        last = self.contacts.nodes - 1
        totals[0] += 1
        totals[1] += 0 < firsts[-1] <= last
        totals[2] += firsts[-1] > last
    return renewed


CondensedNewton.update_contacts, ContactEntries.update = update, apart
CondensedNewton._compiled = lambda self: None  # its parts on one rank, too
case = load_case(sys.argv[1], ["time.end=0.5 s", "initial.wob=60 kN"])
run(case, sys.argv[2], progress="silent")
every = comm.tompi4py().allgather(totals)
assert len({renewed for renewed, *_ in every}) == 1 and every[0][0] > 0, every
if comm.size > 1:
    assert any(unchanged for *_, unchanged in every), every
assert any(tail for _, tail, _ in every), every
if comm.rank == 0:
    print("renewed apart on", comm.size, "ranks:", every)
