"""Short runs for the verification of motion: a model integrated with given options."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from drillpetsc import Case
from drillpetsc.analysis.statics.placement import move_rigidly, place_along_hole, release
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.model.drilling_model import DrillingModel, build_model
from drillpetsc.solvers.petsc_options import applied
from drillpetsc.solvers.time.generalized_alpha import integrator_class
from drillpetsc.solvers.time.time_integrator import TimeIntegrator


def fixed(step: float, **more) -> dict:
    """Options for steps of one length [s]."""
    return {"ts_adapt_type": "none", "ts_dt": step, **more}


def integrate(
    system: DiscreteSystem,
    end: float,
    petsc: dict | None = None,
    call: Callable[[float, float], None] | None = None,
    breaks: tuple[float, ...] = (),
    start: float = 0.0,
) -> TimeIntegrator:
    """Run ``model`` from its present state at ``start`` to ``end`` [s]; call(t, dt) after every step."""
    with applied({} if petsc is None else petsc):
        integrator = integrator_class()(system)
        if call is not None:
            integrator.after_step.append(call)
        integrator.run(start, end, breaks)
    return integrator


def sampled(
    system: DiscreteSystem,
    end: float,
    sample: Callable[[DiscreteSystem], object],
    breaks: tuple[float, ...] = (),
    **petsc,
) -> np.ndarray:
    """Run from 0 to ``end`` [s]; rows (t, *sample(model)) of all accepted steps."""
    rows: list[list[float]] = []
    integrate(system, end, petsc, lambda t, dt: rows.append([t, *np.atleast_1d(sample(system))]), breaks)
    return np.array(rows)


def straight(**case) -> DrillingModel:
    """DrillingModel of a case, unstrained along its axis, moving as prescribed at its top."""
    model = build_model(Case(**case))
    place_along_hole(model)
    release(model)
    move_rigidly(model)
    return model


def beam(
    length: float,
    elements: int,
    axial: float,
    bending: float,
    torsional: float,
    mass: float,
    polar: float,
    **more,
) -> dict:
    """A beam item of a case; SI."""
    return {
        "kind": "beam",
        "length": length,
        "axial_stiffness": axial,
        "bending_stiffness": bending,
        "torsional_stiffness": torsional,
        "mass": mass,
        "polar_inertia": polar,
        "element_length": length / elements,
        **more,
    }
