"""Contacts renewed apart on this rank against a whole factorisation of the same entries: contacts_apart_mpi.py OUT."""

import sys

import petsc4py

petsc4py.init([])

import numpy as np  # noqa: E402
from petsc4py import PETSc  # noqa: E402

from drillpetsc.analysis.motion.transient import run  # noqa: E402
from drillpetsc.case import load_case  # noqa: E402
from drillpetsc.solvers.time.newton_iteration import NewtonIteration  # noqa: E402

comm = PETSc.COMM_WORLD
totals = [0, 0, 0]
entries, factor = NewtonIteration.compute_entries, NewtonIteration._factor_from
whole = [False]  # the next factorisation is that of new entries


def compute_entries(self):
    whole[0] = True
    entries(self)


def factor_from(self, first):
    factor(self, first)
    if not whole[0]:  # of the contacts alone
        partly, again = np.zeros((2, len(self.rows)))
        self.factor.solve_owned(self.rows, partly)
        self.factor.factor(self.system.assembly.values)
        self.factor.solve_owned(self.rows, again)
        assert np.array_equal(partly, again), abs(partly - again).max()
        last = self.contacts.nodes - 1
        totals[0] += 1
        totals[1] += 0 < first <= last
        totals[2] += first > last
    whole[0] = False


def in_python(self, *arguments):
    self.compiled = False
    begin(self, *arguments)


NewtonIteration.compute_entries, NewtonIteration._factor_from = compute_entries, factor_from
begin, NewtonIteration.begin = NewtonIteration.begin, in_python
case = load_case(sys.argv[1], ["time.end=0.5 s", "initial.wob=60 kN"])
run(case, sys.argv[2], progress="silent")
every = comm.tompi4py().allgather(totals)
assert len({renewed for renewed, *_ in every}) == 1 and every[0][0] > 0, every
if comm.size > 1:
    assert any(unchanged for *_, unchanged in every), every
assert any(tail for _, tail, _ in every), every
if comm.rank == 0:
    print("renewed apart on", comm.size, "ranks:", every)
