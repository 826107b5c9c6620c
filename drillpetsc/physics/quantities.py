"""Outputs that physics components declare.

Plain descriptions: a value is a function of the component and the sample, so plots and the manual can read this page
without PETSc and without compiled kernels.  Each component returns its tuple from ``quantities()``.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from drillpetsc.fem.quantity import FloatArray, Quantity, Sample


# ---------------------------------------------------------------------- wall contact
def _force_per_length(contact: Any, sample: Sample) -> FloatArray:
    cells, _ = sample.once(contact.element_results)
    return np.asarray(cells[:, 0] / contact.mesh.length_divisor[sample.system.chain.cells])


CONTACT: tuple[Quantity, ...] = (
    Quantity(
        "contact_force",
        "N/m",
        kind="side_force",
        on="element",
        label="Side force",
        mnemonic="SFPL",
        sign="push of the wall on the string, not negative",
        doc="Normal force of the wall per length of string.",
        value=_force_per_length,
    ),
)

# ---------------------------------------------------------------------- bit on bottom, bit that cuts rock
BIT: tuple[Quantity, ...] = (
    Quantity(
        "wob",
        "N",
        on="scalar",
        label="Weight on bit",
        mnemonic="WOB",
        sign="positive on the rock",
        doc="Force of the bit on the bottom of the hole, along the hole's axis.",
        value=lambda bit, sample: sample.once(bit.weight_and_torque)[0],
        panel=2,
        interest=2,
    ),
    Quantity(
        "bit_torque",
        "N m",
        on="scalar",
        label="Torque on bit",
        mnemonic="TOB",
        sign="the rock brakes clockwise rotation",
        doc="Torque of the rock on the bit.",
        value=lambda bit, sample: sample.once(bit.weight_and_torque)[1],
        panel=3,
        interest=7,
    ),
)


# ---------------------------------------------------------------------- joints
def _of_joints(name: str, joints: Any, sample: Sample) -> FloatArray:
    return np.asarray(sample.once(joints.element_results)[:, joints.RESULTS.index(name)])


JOINTS: tuple[Quantity, ...] = (
    Quantity(
        "joint_NNN_force",
        "N",
        on="joint",
        label="Tension of the joint at NNN m",
        mnemonic="JFNNN",
        sign="tension positive",
        doc="Axial force that the joint carries.",
        value=partial(_of_joints, "tension"),
    ),
    Quantity(
        "joint_NNN_side_force",
        "N",
        on="joint",
        label="Side force of the joint at NNN m",
        mnemonic="JSNNN",
        sign="not negative",
        doc="Force across the string that the joint carries.",
        value=partial(_of_joints, "side_force"),
    ),
    Quantity(
        "joint_NNN_torque",
        "N m",
        on="joint",
        label="Torque of the joint at NNN m",
        mnemonic="JTNNN",
        sign="the part above turns the part below clockwise (looking down)",
        doc="Torque that the joint carries.",
        value=partial(_of_joints, "torque"),
    ),
    Quantity(
        "joint_NNN_bending_moment",
        "N m",
        on="joint",
        label="Bending moment of the joint at NNN m",
        mnemonic="JBNNN",
        sign="not negative",
        doc="Bending moment that the joint carries.",
        value=partial(_of_joints, "bending"),
    ),
    Quantity(
        "joint_NNN_angle",
        "rad",
        on="joint",
        label="Angle of the joint at NNN m",
        mnemonic="JANNN",
        sign="not negative",
        doc="Angle between the parts that the joint connects.",
        value=partial(_of_joints, "angle"),
    ),
    Quantity(
        "joint_NNN_travel",
        "m",
        on="joint",
        label="Travel of the joint at NNN m",
        mnemonic="JDNNN",
        sign="positive as the joint extends",
        doc="Travel of a slider.",
        value=partial(_of_joints, "travel"),
    ),
)
