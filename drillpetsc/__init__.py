"""drillpetsc: drillstring dynamics on PETSc.  Importing the package starts no MPI and draws nothing."""

__version__ = "0.1.0"
