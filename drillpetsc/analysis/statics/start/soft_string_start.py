"""The soft string beside statics (manual: sec-soft-string-bound)."""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.statics.placement import top_depth
from drillpetsc.analysis.statics.start.soft_string import TorqueDrag, torque_drag
from drillpetsc.case.blocks.ends import ForcedBottom
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.model.mud_sections import mud_of_rigid_items


def soft_string(
    model: DrillingModel, motion: tuple[float, float], wob: float | None = None
) -> TorqueDrag | None:
    """Compute torque and drag of the soft string with friction against ``motion``, to be reported.

    motion: axial velocity [m/s, down positive] and rotation [rad/s].
    wob: weight on bit instead of that of the case [N]; negative: a pull at the bit.
    Returns None without contact, or where gravity is not vertical.
    """
    mesh, case = model.mesh, model.case
    if model.contact is None:
        return None
    well = model.contact.well
    gravity = np.array(case.gravity)
    g = float(np.linalg.norm(gravity))
    if gravity[0] or gravity[1] or gravity[2] < 0:
        return None
    depth = mesh.node_depth + top_depth(model)
    wob = (case.initial.wob or 0.0) if wob is None else wob
    # an interval is an element and the rigid items above it; a joint has no length and is left out
    span, length = np.diff(depth), np.where(mesh.is_joint, 0.0, mesh.length)
    weight = model.effective_mass * g * length
    rigid = mud_of_rigid_items(case, mesh)
    np.add.at(rigid, [b.node for b in mesh.bodies], [b.mass for b in mesh.bodies])
    for node in np.flatnonzero(rigid[:-1]):
        weight[node - 1 if node and not span[node] > 0 else node] += rigid[node] * g
    has_length = span > 0
    share = (length / np.where(has_length, span, 1.0))[has_length]  # of an interval that stretches and twists
    axial, torsional = (
        np.divide(q[has_length], share, out=np.full(len(share), np.inf), where=share > 0)
        for q in (mesh.axial_stiffness, mesh.torsional_stiffness)
    )
    turning = motion[1] + model.motor_speed
    soft = torque_drag(
        well,
        depth[np.append(True, has_length)],
        (weight / np.where(has_length, span, 1.0))[has_length],
        0.5 * mesh.contact_diameter[has_length],
        axial,
        torsional,
        bottom_force=_force_below(model, g * float(rigid[-1])) - wob,
        bottom_torque=_torque_below(model, wob, turning),
        axial_velocity=-motion[0],
        rotation=motion[1],
    )
    return soft


def _force_below(model: DrillingModel, weight: float) -> float:
    """Compute the axial force [N] on the lowest node from the buoyed ``weight`` [N] of its rigid items and a given force."""
    bottom, force = model.case.bottom, np.array([0.0, 0.0, weight])
    if isinstance(bottom, ForcedBottom):
        force += bottom.force
    return float(force @ model.tangent[-1])


def _torque_below(model: DrillingModel, wob: float, turning: float) -> float:
    """Compute the torque [N m] that the string must bring to its end, of a bit or a given moment; ``turning``: there [rad/s]."""
    bottom = model.case.bottom
    if isinstance(bottom, ForcedBottom):
        return -float(np.array(bottom.moment) @ model.tangent[-1])
    return float(model.bit.torque_for(wob, turning) * np.sign(turning)) if model.bit else 0.0
