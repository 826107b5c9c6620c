"""PETSc starts once for the whole test run, without reading pytest's own words."""

import petsc4py

petsc4py.init(["pytest"])
