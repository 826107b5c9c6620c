"""Results that depend on the stiffness of the wall: parts that press into it by a share of their clearance (manual: sec-contact-physical)."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.fem.quantity import Sample
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output.measured.rigid_items import RigidItems
from drillpetsc.parallel import total
from drillpetsc.physics.contact import RESULTS

LARGEST = 0.03  # penetration over radial clearance from which results depend on the stiffness of the wall
IN_GAUGE = 1e-4  # clearance below which a part is led by the wall, whatever its stiffness [m]


def deepest_in_wall(model: DrillingModel) -> dict[str, Any] | None:
    """The part that presses into the wall by the largest share of its clearance at present; collective, and the same on all ranks.

    Returns name, md, depth in the wall and radial clearance [m]; None without a part that has a clearance.
    """
    contact = model.contact
    if contact is None:
        return None
    system, mesh = model.system, model.mesh
    place = system.gather(system.field("string.position"))
    sample = Sample(system, 0.0)
    cells, _ = sample.once(contact.element_results)
    depth = system.gather(np.ascontiguousarray(cells[:, [RESULTS["penetration"]]]), "cell")
    bodies = total(system.comm, RigidItems(model).wall_results(sample)[0, :, RESULTS["penetration"]])
    found: dict[str, Any] | None = None
    if place is not None and depth is not None:
        hole = contact.well.project(place)
        nodes = [*range(len(mesh.upper)), *(b.node for b in mesh.bodies)]
        below = [*(0.5 * mesh.length), *(b.middle for b in mesh.bodies)]
        radii = np.array([*(0.5 * mesh.contact_diameter), *(b.radius for b in mesh.bodies)])
        names = [model.case.string[k].name or model.case.string[k].kind for k in mesh.item]
        names += [b.name for b in mesh.bodies]
        depths, clearance = np.append(depth[:, 0], bodies), hole.radius[nodes] - radii
        share = np.divide(depths, clearance, out=np.zeros_like(depths), where=clearance > IN_GAUGE)
        k = int(np.argmax(share))
        if share[k] > 0:
            md = float(hole.md[nodes][k] + below[k])
            found = {
                "name": names[k],
                "md": md,
                "depth": float(depths[k]),
                "clearance": float(clearance[k]),
            }
    return found if system.comm.size == 1 else system.comm.tompi4py().bcast(found)
