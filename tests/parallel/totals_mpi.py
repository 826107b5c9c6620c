"""Sums, largest values and conditions over the ranks of the job, checked on every rank: totals_mpi.py."""

import petsc4py

petsc4py.init([])

import numpy as np  # noqa: E402
from petsc4py import PETSc  # noqa: E402

from drillpetsc.parallel import all_true, largest, total  # noqa: E402

comm = PETSc.COMM_WORLD
rank, size = comm.rank, comm.size
values = np.array([[1.0, rank], [0.1, -rank]])
kept = values.copy()
for communicator in (comm, comm.tompi4py()):
    summed = np.asarray(total(communicator, values))
    assert summed.shape == (2, 2) and np.array_equal(values, kept)
    assert np.allclose(
        summed, [[size, size * (size - 1) / 2], [0.1 * size, -size * (size - 1) / 2]], rtol=1e-15
    )
    assert total(communicator, rank) == size * (size - 1) / 2
    assert largest(communicator, -float(rank)) == 0.0
    assert all_true(communicator, True) and all_true(communicator, rank != size - 1) is False
    # not a number on one rank only: the same answer on every rank
    answers = comm.tompi4py().allgather(largest(communicator, float("nan") if rank == size - 1 else 1.0))
    assert all(str(a) == str(answers[0]) for a in answers) and not answers[0] <= 1.0, answers
    # the same bits on every rank
    noise = np.random.default_rng(rank).normal(size=1000)
    every = comm.tompi4py().allgather(np.asarray(total(communicator, noise)).tobytes())
    assert len(set(every)) == 1
if rank == 0:
    print("totals agree on", size, "ranks")
