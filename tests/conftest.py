"""The kernels are compiled if a source has changed, and PETSc starts once for the whole test run, without reading
pytest's own words."""

import petsc4py

from drillpetsc.kernels.build import build

build()
petsc4py.init(["pytest"])
