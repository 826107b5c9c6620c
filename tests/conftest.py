"""The kernels are compiled if a source has changed, and PETSc starts once for the whole test run, without reading
pytest's own words. Nothing waits for the disk, which costs a third of the time of a run: no test cuts the power."""

import gc
import os

import petsc4py
import pytest

from drillpetsc.kernels.build import build

build()
petsc4py.init(["pytest"])
os.fsync = os.fstat  # a file that is not open is still an error
gc.disable()  # a third of the time of the collection went into walking through what stays


def pytest_collection_finish() -> None:
    gc.enable()
    gc.freeze()


@pytest.fixture
def options():
    """PETSc options for one test."""
    from petsc4py import PETSc

    database, given = PETSc.Options(), []

    def give(**values: object) -> None:
        for name, value in values.items():
            database.setValue(name, value)
            given.append(name)

    yield give
    for name in given:
        database.delValue(name)
