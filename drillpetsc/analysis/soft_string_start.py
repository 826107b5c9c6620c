"""Soft-string start of statics: the string without bending stiffness, on the wall of its hole.

Manual: sec-statics-soft-string, eq-statics-start-position.
"""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.soft_string import TorqueDrag, torque_drag
from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.ends import ForcedBottom
from drillpetsc.kernels.parameters import constant
from drillpetsc.model.drilling_model import DrillingModel, hole_depth

ONSET = constant("contact_onset")  # half width of the contact's onset [m] (manual: eq-contact-onset)
#: lateral load at the top, as a fraction of the weight, above which the string is on the wall there
LATERAL_LOAD_THRESHOLD = 0.1


def soft_string_start(model: DrillingModel, motion: tuple[float, float]) -> TorqueDrag | None:
    """Place the string at the positions of a soft string with friction against ``motion``.

    The positions contain the stretch of the string and the touched side of the hole (manual:
    eq-statics-start-position). The top moves along its axis to meet a requested weight on bit, and across to
    the wall where the string is on it.

    motion: axial velocity [m/s, down positive] and rotation [rad/s].
    Returns the results of the soft string.  Without contact, or where gravity is not vertical, the string is
    not placed and the result is None.
    """
    mesh, well, case = model.mesh, model.well, model.case
    if model.contact is None or well is None:
        return None
    gravity = np.array(case.gravity)
    g = float(np.linalg.norm(gravity))
    if gravity[0] or gravity[1] or gravity[2] < 0:
        return None
    depth = mesh.node_depth
    wob = case.initial.wob or 0.0
    force = case.top.force
    weight = model.effective_mass * g
    for b in mesh.bodies:
        if b.node < mesh.nodes - 1:
            cell = b.node - 1 if mesh.is_joint[b.node] and b.node else b.node  # a joint is no element
            weight[cell] += b.mass * g / mesh.length_divisor[cell]
    # joints have no length and are left out; both nodes of a joint get the same values
    has_length = np.diff(depth) > 0
    at = np.concatenate([[0], np.cumsum(has_length)])  # boundary of the soft string at each node
    soft = torque_drag(
        well,
        depth[np.append(True, has_length)],
        weight[has_length],
        0.5 * mesh.outer_diameter[has_length],
        mesh.axial_stiffness[has_length],
        mesh.torsional_stiffness[has_length],
        bottom_force=_force_below(model, g) - wob,
        bottom_torque=model.bit.torque_for(wob, motion[1]) * np.sign(motion[1]) if model.bit else 0.0,
        axial_velocity=-motion[0],
        rotation=motion[1],
    )
    clearance = np.asarray(well.radius(depth)) - 0.5 * np.append(mesh.outer_diameter, mesh.outer_diameter[-1])
    offset = np.maximum(clearance, 0.0) + _penetration(soft.contact_force[at], case.contact)
    top_motion = 0.0
    if case.initial.wob is not None and model.bit is not None:
        top_motion = hole_depth(model.case) - (mesh.total_length + soft.stretch)
        if model.top is not None:
            model.top.shift(top_motion)
    if force is not None:
        top_motion = 0.0
    centre, tangent, _ = well.at(depth + soft.elongation[at] + top_motion)
    strain = np.concatenate(
        [[soft.axial_force[0] / mesh.axial_stiffness[0]], soft.axial_force[at[1:]] / mesh.axial_stiffness]
    )
    system = model.system
    if model.top is not None and soft.contact_force[0] > LATERAL_LOAD_THRESHOLD * weight[0]:
        # the top is at the wall with the string: on the axis it would carry the first tens of metres, which
        # changes torque and drag of a short string by percents
        model.top.displace(offset[0] * soft.wall_direction[0])
    system.set_field("string.position", centre + offset[:, None] * soft.wall_direction[at])
    system.set_field("string.tangent", (1 + strain)[:, None] * tangent)
    return soft


def _penetration(force: FloatArray, contact) -> FloatArray:
    """Compute the penetration (n,) [m] at which a linear wall carries ``force`` (n,) [N/m].

    The onset is a parabola, (d + e)^2/4e for |d| < e (manual: eq-contact-onset).
    """
    if contact.law != "linear":
        return np.zeros_like(force)
    d = force / contact.stiffness
    return np.where(d > ONSET, d, 2 * np.sqrt(ONSET * np.maximum(d, 0.0)) - ONSET)


def _force_below(model: DrillingModel, g: float) -> float:
    """Compute the axial force [N] on the lowest node from its rigid items and from a given force.

    ``g`` in m/s2.
    """
    mesh, bottom = model.mesh, model.case.bottom
    force = np.array([0.0, 0.0, g * sum(b.mass for b in mesh.bodies if b.node == mesh.nodes - 1)])
    if isinstance(bottom, ForcedBottom):
        force += bottom.force
    return float(force @ model.tangent[-1])
