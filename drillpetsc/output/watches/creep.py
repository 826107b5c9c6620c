"""Creep of the regularised friction that holds a string at the end of a run (manual: sec-contact-creep)."""

from __future__ import annotations

import numpy as np

from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.physics.contact import RESULTS
from drillpetsc.unit_systems import shown

SMALLEST_SHARE = 1e-3  # of the weight: friction below it holds nothing worth a message


def held_by_creep(model: DrillingModel) -> tuple[float, float]:
    """(friction [N] of elements that creep, mean of their slip speeds [m/s] weighted by it); collective.

    An element creeps if its slip speed is below the slip velocity of the law. Its friction is then below 0.71 of
    the limit and would hold without regularisation. The slip speed is the power of the friction over its force.
    """
    contact, system, mesh = model.contact, model.system, model.mesh
    if contact is None or model.beam is None:
        return 0.0, 0.0
    results, _ = contact.element_results(system.assembly)
    radius = 0.5 * mesh.contact_diameter[system.chain.cells]
    friction = np.hypot(results[:, RESULTS["axial"]], results[:, RESULTS["torque"]] / radius)
    power = np.abs(results[:, RESULTS["friction_power"]])
    speed = np.divide(power, friction, out=np.zeros_like(power), where=friction > 0)
    creeps = (friction > 0) & (speed < contact.law.slip_velocity)
    sums = np.array([friction[creeps].sum(), power[creeps].sum()])
    if system.comm.size > 1:
        sums = system.comm.tompi4py().allreduce(sums)
    return float(sums[0]), float(sums[1] / sums[0]) if sums[0] > 0 else 0.0


def creep_warnings(model: DrillingModel, t: float) -> list[str]:
    """Warning if the top is at rest at ``t`` [s] and friction holds the string; collective."""
    top = model.case.top
    motions = (top.lowering if top.force is None else None, top.rotation)
    if any(motion is not None and motion.value(t) != 0.0 for motion in motions):
        return []
    force, speed = held_by_creep(model)
    weight = float(np.sum(model.effective_mass * model.mesh.length) * np.linalg.norm(model.case.gravity))
    if force <= SMALLEST_SHARE * weight:
        return []
    assert model.contact is not None
    slip, units = model.contact.law.slip_velocity, model.case.shown_units
    return [
        f"friction of {shown(force, 'force', units, 3)} held by creep of {shown(speed, 'creep', units, 3)} at the end: held loads relax with time; "
        f"a smaller contact.slip_velocity ({shown(slip, 'creep', units, 3)}) creeps less"
    ]
