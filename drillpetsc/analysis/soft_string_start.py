"""The soft string beside statics, and the start of statics on the wall of the hole.

Manual: sec-soft-string-bound, sec-statics-march.
"""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.march import March
from drillpetsc.analysis.placement import top_depth
from drillpetsc.analysis.soft_string import TorqueDrag, torque_drag
from drillpetsc.case.blocks.ends import ForcedBottom
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.model.fluid import rigid_weights


def soft_string(
    model: DrillingModel, motion: tuple[float, float], wob: float | None = None
) -> TorqueDrag | None:
    """Compute torque and drag of the soft string with friction against ``motion``, to be reported.

    motion: axial velocity [m/s, down positive] and rotation [rad/s].
    wob: weight on bit instead of that of the case [N]; negative: a pull at the bit.
    Returns None without contact, or where gravity is not vertical.
    """
    mesh, well, case = model.mesh, model.well, model.case
    if model.contact is None or well is None:
        return None
    gravity = np.array(case.gravity)
    g = float(np.linalg.norm(gravity))
    if gravity[0] or gravity[1] or gravity[2] < 0:
        return None
    depth = mesh.node_depth + top_depth(model)
    wob = (case.initial.wob or 0.0) if wob is None else wob
    rigid = rigid_weights(case, mesh) * g
    load = np.where(mesh.is_joint, 0.0, model.effective_mass * mesh.length * g)
    for node in np.flatnonzero(rigid[:-1]):
        load[node - 1 if mesh.is_joint[node] and node else node] += rigid[node]  # a joint is no element
    # between two nodes lies an element and what is rigid above it: its length is not the distance of the nodes
    span = np.diff(depth)
    weight = np.divide(load, span, out=np.zeros_like(load), where=span > 0)
    # joints have no length and are left out; both nodes of a joint get the same values
    has_length = span > 0
    turning = motion[1] + (model.motor.static_speed if model.motor is not None else 0.0)
    soft = torque_drag(
        well,
        depth[np.append(True, has_length)],
        weight[has_length],
        0.5 * mesh.contact_diameter[has_length],
        mesh.axial_stiffness[has_length],
        mesh.torsional_stiffness[has_length],
        bottom_force=_force_below(model, rigid[-1]) - wob,
        bottom_torque=model.bit.torque_for(wob, turning) * np.sign(turning) if model.bit else 0.0,
        axial_velocity=-motion[0],
        rotation=motion[1],
    )
    return soft


def place_marched(model: DrillingModel, found: March) -> None:
    """Put the string at the start that ``march`` found, and its top at the wall where the string is on it."""
    system, top = model.system, model.top
    if top is not None:
        if model.case.top.force is None:
            top.shift(found.top_motion)
        if found.top_on_wall:
            # the top is at the wall with the string: on the axis it would carry the first tens of metres, which
            # changes torque and drag of a short string by percents
            top.displace(found.offset[0])
    system.set_field("string.position", found.position)
    system.set_field("string.tangent", found.tangent)
    system.set_field("string.spin", found.twist[:, None])
    if "string.ratio" in system.layout.dofs:
        system.set_field("string.ratio", found.ratio[:, None])


def _force_below(model: DrillingModel, rigid: float) -> float:
    """Compute the axial force [N] on the lowest node from its rigid items, of weight ``rigid`` [N], and from a given force."""
    bottom = model.case.bottom
    force = np.array([0.0, 0.0, rigid])
    if isinstance(bottom, ForcedBottom):
        force += bottom.force
    return float(force @ model.tangent[-1])
