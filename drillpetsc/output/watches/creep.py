"""Creep of the regularised friction that holds a string at the end of a run (manual: sec-contact-creep)."""

from __future__ import annotations

import numpy as np

from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.physics.contact import RESULTS


def held_by_creep(model: DrillingModel) -> tuple[float, float]:
    """(friction [N] of elements that creep, mean of their slip speeds [m/s] weighted by it); collective.

    An element creeps if its slip speed is below the slip velocity of the law. Its friction is then below 0.71 of
    the limit and would hold without regularisation. The slip speed is the power of the friction over its force.
    """
    contact, system, mesh = model.contact, model.system, model.mesh
    if contact is None:
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
