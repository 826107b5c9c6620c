"""What the swirl of the mud adds to the torque of a turning string, which an equilibrium leaves out (manual: sec-mud-swirl)."""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.statics.placement import prescribed_motion
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.parallel import total
from drillpetsc.physics.contact import RESULTS
from drillpetsc.physics.fluid.swirl import steady_share
from drillpetsc.unit_systems import shown

SMALL = 0.02  # share of the surface torque below which nothing is said


def swirl_left_out(model: DrillingModel, turns: bool, torque: float | None) -> list[str]:
    """Sentence on the torque that swirling mud adds where pipe lies on the wall; collective.

    turns: the string turns in the equilibrium; torque: at the surface, in the equilibrium [N m].  An element on the wall, with the clearance c, is pressed to it by M_a Omega_s^2 c
    per length and braked by share k_v Omega_s c^2.
    """
    fluid, contact = model.case.fluid, model.contact
    annulus = None if model.fluid is None else model.fluid.annulus
    rotation = abs(prescribed_motion(model)[1])
    if fluid is None or annulus is None or contact is None or not (turns and rotation) or fluid.swirl == 0.0:
        return []
    cells, _ = contact.element_results(model.system.assembly)
    own, mesh = model.system.chain.cells, model.mesh
    normal = cells[:, RESULTS["normal"]]
    lever = np.abs(cells[:, RESULTS["torque"]]) / np.maximum(normal, 1e-9)  # friction times radius
    outer, hole = annulus.lateral_sizes().T
    share = steady_share(outer, hole) if fluid.swirl == "auto" else np.full(len(outer), float(fluid.swirl))
    swirl, length = share * rotation, mesh.length[own]
    clearance = np.maximum(0.0, 0.5 * (hole - mesh.contact_diameter[own]))
    pressed = annulus.parameter("chi") * fluid.density * np.pi / 4 * outer**2 * swirl**2 * clearance * length
    braked = share * annulus.parameter("damping") * swirl * clearance**2 * length
    mine = float(np.where(normal > 0, pressed * lever + braked, 0.0).sum())
    added = float(total(model.system.comm.tompi4py(), mine)) if model.system.comm.size > 1 else mine
    if added <= SMALL * abs(torque or 0.0):
        return []
    units = model.case.shown_units
    return [
        f"the mud that swirls with the turning string adds about {shown(added, 'torque', units)} to the torque in motion "
        f"({100 * added / max(abs(torque or 0.0), 1e-9):.2g} %): it presses pipe that lies on the wall and brakes it; this "
        "equilibrium leaves the swirl out (fluid.swirl)"
    ]
