"""What telescoping tools add to statics: the travel of their sliders in its start, and the stops that they have reached.

Manual: sec-statics-march.
"""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.statics.placement import top_depth
from drillpetsc.arrays import FloatArray
from drillpetsc.fem.string_mesh import StringJoint, StringMesh
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.parallel import total
from drillpetsc.physics.joints import Joints
from drillpetsc.unit_systems import shown

SLIDERS = ("slider", "torsion_slider")
LEAST_SHARE = 1 / 3  # of what spring and stop carry, from which a stop is told: its force sets in gradually


def travels(mesh: StringMesh, tension: FloatArray) -> FloatArray:
    """Travel (n-1,) [m] of the sliders in their cells under the tension (n-1,) of the cells [N]; 0 elsewhere."""
    out = np.zeros(len(mesh.length))
    for joint in mesh.joints:
        if joint.kind in SLIDERS:
            out[joint.cell] = _travel(joint, float(tension[joint.cell]))
    return out


def _travel(joint: StringJoint, tension: float) -> float:
    """Travel [m] of a slider at rest: its spring, its stops, or the latch of a jar, carry the tension [N]."""
    if joint.jar is not None:
        return tension / joint.jar.latch
    pull, (low, high) = tension + joint.preload, joint.stroke or (-np.inf, np.inf)
    free = pull / joint.spring if joint.spring > 0 else np.copysign(np.inf, pull) if pull else 0.0
    if low <= free <= high:
        return free if np.isfinite(free) else 0.0  # nothing holds it
    stop = high if free > high else low
    return (pull + joint.stop_stiffness * stop) / (joint.spring + joint.stop_stiffness)


def stop_warnings(model: DrillingModel) -> list[str]:
    """Sentences on sliders with a spring that a stop holds in the present state: they act as rigid; collective."""
    system = model.system
    joints = next((c for c in system.components if isinstance(c, Joints)), None)
    if joints is None:
        return []
    rows = total(system.comm, joints.element_results(system.assembly))
    travel_of, stops = (rows[:, joints.RESULTS.index(name)] for name in ("travel", "stop"))
    out, units = [], model.case.shown_units
    for joint, travel, stop in zip(joints.joints, travel_of, stops, strict=True):
        if joint.jar is not None or joint.stroke is None or not joint.spring > 0:
            continue
        if abs(stop) < LEAST_SHARE * (abs(stop) + joint.spring * abs(travel)):
            continue
        end, how = (joint.stroke[0], "closed") if stop < 0 else (joint.stroke[1], "extended")
        out.append(
            f"the slider at MD {shown(top_depth(model) + joint.depth, 'length', units, 6)} is {how} to its stop at {shown(end, 'diameter', units)}, "
            f"which carries {shown(abs(stop), 'force', units, 3)}: it acts as rigid at this load"
        )
    return out
