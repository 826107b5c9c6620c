"""drillpetsc: drillstring dynamics on PETSc.  Importing the package starts no MPI and draws nothing.

``Case`` describes a scene (the keys of a case file), ``load_case`` reads one, ``run`` simulates it, ``sweep``
many variations of it.
"""

from typing import Any

from drillpetsc.version import __version__

__all__ = ["Case", "__version__", "load_case", "run", "sweep"]


def __getattr__(name: str) -> Any:  # so that the import stays quick and starts nothing
    if name in ("Case", "load_case"):
        from drillpetsc import case

        return getattr(case, name)
    raise AttributeError(f"module 'drillpetsc' has no attribute {name!r}")


def run(case: Any, out: Any = None, **keywords: Any) -> Any:
    """Simulate a Case, or the case file at a path, and write its run folder (see
    drillpetsc.analysis.transient.run).

    PETSc is initialised first if the caller has not done so.
    """
    import petsc4py

    petsc4py.init()
    from drillpetsc.analysis.transient import run as whole_run

    return whole_run(case, out, **keywords)


def sweep(case_path: Any, values: Any, out: Any = None, **keywords: Any) -> Any:
    """Simulate every combination of ``values``, {"fluid.flow_rate": ["20 l/s", 0.03], "fluid": ["on",
    "off"]}, of the case file at a path.

    See drillpetsc.studies.sweep.sweep.sweep; PETSc is initialised first if the caller has not done so.
    """
    import petsc4py

    petsc4py.init()
    from drillpetsc.studies.sweep.sweep import sweep as whole_sweep

    return whole_sweep(case_path, values, out, **keywords)
