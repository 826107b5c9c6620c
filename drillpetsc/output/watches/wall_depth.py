"""Results that depend on the stiffness of the wall: parts that press into it by a share of their clearance (manual: sec-contact-physical)."""

from __future__ import annotations

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.quantity import Sample
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output.measured.rigid_items import RigidItems
from drillpetsc.physics.contact import RESULTS
from drillpetsc.unit_systems import shown

LARGEST = 0.03  # penetration over radial clearance from which results depend on the stiffness of the wall
IN_GAUGE = 1e-4  # clearance below which a part is led by the wall, whatever its stiffness [m]


def wall_depth_notes(model: DrillingModel) -> list[str]:
    """One sentence on the part of the string that presses into the wall by the largest share of its clearance, at present; collective."""
    if model.contact is None or model.well is None or model.beam is None:
        return []
    system, mesh = model.system, model.mesh
    place = system.gather(system.field("string.position"))
    sample = Sample(system, 0.0)
    cells, _ = sample.once(model.contact.element_results)
    depth = system.gather(np.ascontiguousarray(cells[:, [RESULTS["penetration"]]]), "cell")
    bodies = RigidItems(model).wall_results(sample)[:, RESULTS["penetration"]]
    if system.comm.size > 1:
        bodies = system.comm.tompi4py().allreduce(bodies)
    answer: list[str] = []
    if place is not None and depth is not None:
        hole = model.well.project(place)
        nodes = [*range(len(mesh.upper)), *(b.node for b in mesh.bodies)]
        below = [*(0.5 * mesh.length), *(b.middle for b in mesh.bodies)]
        radii = np.array([*(0.5 * mesh.contact_diameter), *(b.radius for b in mesh.bodies)])
        names = [model.case.string[k].name or model.case.string[k].kind for k in mesh.item]
        names += [b.name for b in mesh.bodies]
        depths = np.append(depth[:, 0], bodies)
        answer = _sentence(model, names, hole.md[nodes] + below, depths, hole.radius[nodes] - radii)
    if system.comm.size > 1:
        answer = system.comm.tompi4py().bcast(answer)
    return answer


def _sentence(
    model: DrillingModel, names: list[str], md: FloatArray, depth: FloatArray, clearance: FloatArray
) -> list[str]:
    """The sentence on the part with the largest ``depth`` in the wall over its ``clearance`` [m], none below ``LARGEST``."""
    share = np.divide(depth, clearance, out=np.zeros_like(depth), where=clearance > IN_GAUGE)
    k = int(np.argmax(share))
    if not share[k] >= LARGEST:
        return []
    units = model.case.shown_units
    pressed, free = (shown(float(v), "diameter", units, 2) for v in (depth[k], clearance[k]))
    return [
        f"{names[k]} at MD {shown(float(md[k]), 'length', units, 5)} depends on the wall stiffness: it presses into the wall by {pressed} of its "
        f"radial clearance of {free} (contact.stiffness; physical takes it from the moduli of casing and rock)"
    ]
