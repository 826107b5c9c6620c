"""PETSc options of a run with another tolerance of its steps."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from petsc4py import PETSc

from drillpetsc import petsc_compat
from drillpetsc.solvers.time.time_integrator import TOLERANCE


@contextmanager
def scaled_tolerance(options: Mapping[str, Any], factor: float) -> Iterator[str]:
    """Multiply the tolerance while a run lasts, also if the command line has set it; yields the options in words.

    Fixed steps are multiplied by the cube root of ``factor``: the local error of order 2 goes with the step's cube.

    options: PETSc options in effect in the run.
    """
    database, key = PETSc.Options(), petsc_compat.time_step_option()
    values = {"ts_rtol": float(options.get("ts_rtol", TOLERANCE)) * factor}
    if options.get("ts_adapt_type") == "none" and key in options:
        values[key] = float(options[key]) * factor ** (1 / 3)
    if "q_snes_stol" in options:
        values["q_snes_stol"] = float(options["q_snes_stol"]) * factor
    before = dict(database.getAll())
    for name, value in values.items():
        database.setValue(name, repr(value))
    try:
        yield " ".join(f"-{name} {value:.3g}" for name, value in values.items())
    finally:
        for name in values:
            if name in before:
                database.setValue(name, before[name])
            else:
                database.delValue(name)
