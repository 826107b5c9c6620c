"""The time integrator of a case: which one, and the longest step that it may take (manual: sec-time-choice)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from petsc4py import PETSc

from drillpetsc import petsc_compat
from drillpetsc.analysis.motion.quasi_static import QuasiStatic
from drillpetsc.analysis.motion.session.sampled_control import sampled_control
from drillpetsc.analysis.motion.time_scales import longest_strict_step, time_scales
from drillpetsc.analysis.motion.whirl_steps import (
    PRODUCT_BDF,
    UNBALANCE_PRODUCT,
    UNBALANCE_PRODUCT_BDF,
    WhirlSteps,
    product_of_alpha,
    unbalanced,
)
from drillpetsc.analysis.statics.steady_flow import fluid_unknowns
from drillpetsc.case.blocks.formation import OwnBitLaw, VelocityWeakening
from drillpetsc.case.case import Case
from drillpetsc.case.quantities import largest
from drillpetsc.errors import CaseError
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.model.fluid import may_turn
from drillpetsc.solvers.time import generalized_alpha
from drillpetsc.solvers.time.generalized_alpha import GeneralizedAlpha
from drillpetsc.solvers.time.time_integrator import TimeIntegrator

#: default spectral radius of generalised-alpha under a bit that sticks (manual: verif-default-tolerance)
STICKING_RADIUS = 0.5
#: largest spectral radius at which long fixed steps across impacts lose energy; larger ones gain
STEADY_RADIUS = 0.5
#: least steps from sample to sample of a controller: a jump of the torque acts half a step late, since the formula is not restarted
STEPS_PER_SAMPLE = 4


def make_integrator(model: DrillingModel, quasi: QuasiStatic | None = None) -> TimeIntegrator:
    """The integrator of a case: with inertia, with mud that follows the string at once, or quasi-static."""
    with _chosen_integrator(model.case):
        return _make_integrator(model, quasi)


def _sticks(case: Case) -> bool:
    """Whether the law of the bit falls with its speed, so that the bit sticks and slips; a law of the user may."""
    law = None if case.formation is None else case.formation.bit_law
    return law is not None and isinstance(law.torque_law, (VelocityWeakening, OwnBitLaw))


#: options that only integrators of PETSc have, or that fix the steps: with them ``auto`` is BDF
OF_PETSC = ("ts_bdf_order", "snes_type", "ts_adapt_type")


def is_alpha(case: Case, given: Iterable[str] = ()) -> bool:
    """Whether ``time.integrator`` of the case means generalised-alpha.

    auto: if the string may turn in a hole, so that it may whirl (manual: sec-time-choice).  given: names of PETSc options.
    """
    time = case.time
    if time is None or time.integrator == "bdf":
        return False
    if time.integrator == "generalized_alpha":
        return True
    # whirl needs 92 steps a period with BDF, 21 with generalised-alpha (manual: sec-time-whirl-steps)
    whirls = case.well is not None and (case.contact is not None or case.has_annulus)
    return whirls and may_turn(case) and not set(given) & set(OF_PETSC)


@contextmanager
def _chosen_integrator(case: Case) -> Iterator[None]:
    """Set ``time.integrator`` as PETSc options, unless -ts_type is given, while an integrator is made."""
    options, time = PETSc.Options(), case.time
    alpha = is_alpha(case, (name for name in OF_PETSC if options.hasName(name)))
    chosen: dict[str, str] = {}
    if time is not None and alpha and not options.hasName("ts_type"):
        chosen["ts_type"] = generalized_alpha.NAMES[0]
        if time.spectral_radius is not None and not options.hasName("ts_alpha_radius"):
            chosen["ts_alpha_radius"] = repr(time.spectral_radius)
    selected = options.getString("ts_type", chosen.get("ts_type", "")) in generalized_alpha.NAMES
    given = {*chosen, *(name for name in ("ts_alpha_radius", "ts_alpha_alpha_m") if options.hasName(name))}
    if selected and not given & {"ts_alpha_radius", "ts_alpha_alpha_m"} and _sticks(case):
        chosen["ts_alpha_radius"] = repr(STICKING_RADIUS)
    for name, value in chosen.items():
        options.setValue(name, value)
    try:
        yield
    finally:
        for name in chosen:
            # the next case in this process chooses anew
            options.delValue(name)


def _make_integrator(model: DrillingModel, quasi: QuasiStatic | None) -> TimeIntegrator:
    if quasi is not None:
        if generalized_alpha.selected():
            raise CaseError(
                at="petsc.ts_type",
                got=PETSc.Options().getString("ts_type"),
                want="no -ts_type with time.mode: quasi_static",
                hint="a string without inertia has no accelerations to average",
            )
        return quasi.integrator()
    system, mud = model.system, model.case.fluid
    _refuse_long_fixed_steps(model)
    alpha = generalized_alpha.selected()
    kept, sampler, kind = _step_limits(model), sampled_control(model), generalized_alpha.integrator_class()
    orbit = _longest_of_orbits(model, alpha)
    if orbit < kept.get("ts_adapt_dt_max", np.inf):
        kept = {"ts_adapt_dt_max": orbit}
    if sampler is not None:
        longest = sampler.period / STEPS_PER_SAMPLE
        kept = {"ts_adapt_dt_max": min(longest, kept.get("ts_adapt_dt_max", np.inf))}
    if mud is not None and mud.dynamics == "quasi_steady":  # the mud follows the string without delay
        system.assembly.set_imposed_rates(np.zeros(system.layout.size + 1), fluid_unknowns(system))
        made = kind(system, controlled=lambda field: field.physics != "fluid", defaults=kept, sampler=sampler)
    else:
        made = kind(system, defaults=kept, sampler=sampler)
    if isinstance(made, GeneralizedAlpha):
        # the user's limit replaces the limit by whirl (manual: sec-time-choice)
        if "ts_adapt_dt_max" not in made.user_options:
            made.step_limit = WhirlSteps(model, product_of_alpha(made.formula.radius))
    return made


def whirl_steps_of(model: DrillingModel, integrator: TimeIntegrator) -> WhirlSteps:
    """The limit of an integrator's steps by whirl, actual or hypothetical."""
    if isinstance(integrator, GeneralizedAlpha):
        limit = integrator.step_limit
        return (
            limit
            if isinstance(limit, WhirlSteps)
            else WhirlSteps(model, product_of_alpha(integrator.formula.radius))
        )
    return WhirlSteps(model, PRODUCT_BDF)


def _longest_of_orbits(model: DrillingModel, alpha: bool) -> float:
    """Longest step [s] with which the orbits of a turning string that is not balanced are within 1 %, inf without any."""
    speed = largest(model.case.top.rotation)
    if not speed or not unbalanced(model):
        return float("inf")
    return (UNBALANCE_PRODUCT if alpha else UNBALANCE_PRODUCT_BDF) / speed


def _refuse_long_fixed_steps(model: DrillingModel) -> None:
    """Raise CaseError for fixed steps with which generalised-alpha makes energy in impacts (manual: sec-time-alpha-steps)."""
    options = PETSc.Options()
    if not generalized_alpha.selected() or options.getString("ts_adapt_type", "basic") != "none":
        return
    radius = options.getReal("ts_alpha_radius", generalized_alpha.RADIUS)
    step, longest = options.getReal(petsc_compat.time_step_option(), 0.0), time_scales(model).impact
    # at radius 0.8, steps of 1.25 impacts gained 11 % of the energy exchanged (manual: sec-time-alpha-steps)
    if radius > STEADY_RADIUS and step > longest:
        raise CaseError(
            at="petsc.ts_dt",
            got=f"{step:g} s",
            want=f"at most {longest:.3g} s, the shortest impact, with generalised-alpha at a spectral radius above {STEADY_RADIUS:g}",
            hint="longer fixed steps generate energy there; let -ts_rtol control the steps, or take spectral_radius: 0.5",
        )


def _step_limits(model: DrillingModel) -> dict[str, Any]:
    """PETSc options that cap the step under contact.energy_strict or -drillpetsc_energy_strict."""
    options, contact = PETSc.Options(), model.case.contact
    strict = options.getBool("drillpetsc_energy_strict", contact is not None and contact.energy_strict)
    longest = longest_strict_step(model) if strict else np.inf
    drill = model.case.top.autodriller
    if drill is not None and drill.sample and drill.sample < longest:
        return {"ts_adapt_dt_max": drill.sample}
    if not np.isfinite(longest):
        return {}
    fixed = (
        options.getReal(petsc_compat.time_step_option(), 0.0)
        if options.getString("ts_adapt_type", "basic") == "none"
        else 0.0
    )
    if fixed > longest:
        raise CaseError(
            at="petsc.ts_dt",
            got=f"{fixed:g} s",
            want=f"at most {longest:.3g} s, half the shortest impact",
            hint="contact.energy_strict requires it",
        )
    return {"ts_adapt_dt_max": longest}
