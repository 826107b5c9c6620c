"""Travel of the sliders of telescoping tools at the start of statics (manual: sec-statics-march)."""

from __future__ import annotations

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.string_mesh import StringJoint, StringMesh

SLIDERS = ("slider", "torsion_slider")


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
