"""First guess of the static state: the string without bending stiffness, lying on the wall of its hole."""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.soft_string import TorqueDrag, torque_drag
from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.ends import ForcedBottom
from drillpetsc.kernels.parameters import constant
from drillpetsc.model.drilling_model import DrillingModel, hole_depth

ONSET = constant("contact_onset")  # half width of the smooth onset of the penetration [m]
SIDE_LOAD_THRESHOLD = (
    0.1  # side load at the top, as a share of the weight, above which the string lies on the wall there
)


def soft_string_start(model: DrillingModel, motion: tuple[float, float]) -> TorqueDrag | None:
    """Place the string as a soft string with friction against ``motion`` would lie: its stretch and the side
    of the hole.

    None, and nothing is placed, without contact or where gravity is not vertical.  The top is moved to where
    it meets the asked weight on bit, and aside where the string lies on the wall there.
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
            cell = (
                b.node - 1 if mesh.is_joint[b.node] and b.node else b.node
            )  # at a joint there is no element below
            weight[cell] += b.mass * g / mesh.divisor[cell]
    # a joint between two nodes at one depth has no length: left out, and its lower node takes what the upper
    # one gets
    keep = np.diff(depth) > 0
    at = np.concatenate([[0], np.cumsum(keep)])  # place of each node among those that are left
    soft = torque_drag(
        well,
        depth[np.append(True, keep)],
        weight[keep],
        0.5 * mesh.outer_diameter[keep],
        mesh.axial_stiffness[keep],
        mesh.torsional_stiffness[keep],
        bottom_force=_pull_below(model, g) - wob,
        bottom_torque=model.bit.torque_for(wob) * np.sign(motion[1]) if model.bit else 0.0,
        axial_velocity=-motion[0],
        rotation=motion[1],
    )
    clearance = np.asarray(well.radius(depth)) - 0.5 * np.append(mesh.outer_diameter, mesh.outer_diameter[-1])
    deep = np.maximum(clearance, 0.0) + _penetration(soft.contact_force[at], case.contact)
    top_moves = 0.0
    if case.initial.wob is not None and model.bit is not None:
        top_moves = hole_depth(model.case) - (mesh.total_length + soft.stretch)
        if model.top is not None:
            model.top.shift(top_moves)
    if force is not None:
        top_moves = 0.0
    centre, tangent, _ = well.at(depth + soft.elongation[at] + top_moves)
    strain = np.concatenate(
        [[soft.axial_force[0] / mesh.axial_stiffness[0]], soft.axial_force[at[1:]] / mesh.axial_stiffness]
    )
    m = model.system
    if model.top is not None and soft.contact_force[0] > SIDE_LOAD_THRESHOLD * weight[0]:
        # the top holds the string where it lies in the hole, not on the axis: else the first tens of metres hang from
        # the top, and torque and drag of a short string are off by percents
        model.top.displace(deep[0] * soft.side[0])
    m.set_field("string.position", centre + deep[:, None] * soft.side[at])
    m.set_field("string.tangent", (1 + strain)[:, None] * tangent)
    return soft


def _penetration(force: FloatArray, contact) -> FloatArray:
    """Penetration [m] at which a linear wall carries ``force`` [N/m]; its onset is a parabola, (d + e)^2/4e
    for |d| < e."""
    if contact.law != "linear":
        return np.zeros_like(force)
    d = force / contact.stiffness
    return np.where(d > ONSET, d, 2 * np.sqrt(ONSET * np.maximum(d, 0.0)) - ONSET)


def _pull_below(model: DrillingModel, g: float) -> float:
    """Axial force on the lowest node from the rigid items that hang on it and from a given force there
    [N]."""
    mesh, bottom = model.mesh, model.case.bottom
    force = np.array([0.0, 0.0, g * sum(b.mass for b in mesh.bodies if b.node == mesh.nodes - 1)])
    if isinstance(bottom, ForcedBottom):
        force += bottom.force
    return float(force @ model.tangent[-1])
