"""Motion, forces and surroundings of the string at its nodes and elements."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.fem.quantity import FloatArray, Quantity, Sample


def _position(string: Any, sample: Sample) -> FloatArray:
    return np.asarray(string.position(sample))


def _offset(string: Any, position: FloatArray, depth: FloatArray) -> FloatArray:
    return np.asarray(string.offset(position, depth))


MD = Quantity(
    "md",
    "m",
    on="node",
    label="Measured depth",
    mnemonic="MD",
    sign="down",
    doc="Measured depth: along the unstrained string, in trajectory.csv along the hole.",
    mean=False,
    value=lambda string, sample: string.node_depth,
)
OFFSET_X = Quantity(
    "offset_x",
    "m",
    kind="diameter",
    on="node",
    label="Offset to the high side",
    mnemonic="OFFX",
    sign="towards the high side (north in a vertical hole)",
    doc="Offset of the string's centre from the hole's axis.",
    value=_position,
    size=3,
    finish=_offset,
    index=0,
)
OFFSET_Y = Quantity(
    "offset_y",
    "m",
    kind="diameter",
    on="node",
    label="Offset to the right",
    mnemonic="OFFY",
    sign="to the right of the high side, looking down (east in a vertical hole)",
    doc="Offset of the string's centre from the hole's axis.",
    value=_position,
    size=3,
    finish=_offset,
    index=1,
)
AXIAL_FORCE = Quantity(
    "axial_force",
    "N",
    on="element",
    label="Axial force",
    mnemonic="AXFR",
    sign="tension positive, compression negative",
    doc="Tension of the pipe's wall (manual: eq-mud-effective-tension).",
    value=lambda string, sample: string.axial_force(sample),
)
TORQUE = Quantity(
    "torque",
    "N m",
    on="element",
    label="Torque",
    mnemonic="TORQ",
    sign="as the surface torque: the part above turns the part below clockwise",
    doc="Torque in the string.",
    value=lambda string, sample: string.results(sample, "torque"),
    finish=lambda string, values, depth: -values,
)
BENDING_MOMENT = Quantity(
    "bending_moment",
    "N m",
    on="element",
    label="Bending moment",
    mnemonic="BEND",
    sign="not negative",
    doc="Magnitude of the bending moment, from the equilibrium of the elements (manual: sec-beam-nodal).",
    value=lambda string, sample: string.bending_moment(sample),
)


def _bending_components(string: Any, sample: Sample) -> FloatArray:
    return np.asarray(string.bending_components(sample))


def _shear_components(string: Any, sample: Sample) -> FloatArray:
    return np.asarray(string.shear_components(sample))


BENDING_MOMENT_X = Quantity(
    "bending_moment_x",
    "N m",
    on="element",
    label="Bending moment to the high side",
    mnemonic="BNDX",
    sign="bends the string towards the high side (north in a vertical hole)",
    doc="Part of the bending moment that bends the string in the plane of the high side.",
    value=_bending_components,
    size=2,
    index=0,
)
BENDING_MOMENT_Y = Quantity(
    "bending_moment_y",
    "N m",
    on="element",
    label="Bending moment to the right",
    mnemonic="BNDY",
    sign="bends the string to the right of the high side, looking down (east in a vertical hole)",
    doc="Part of the bending moment that bends the string across the plane of the high side.",
    value=_bending_components,
    size=2,
    index=1,
)
SHEAR_FORCE = Quantity(
    "shear_force",
    "N",
    on="element",
    label="Shear force",
    mnemonic="SHRF",
    sign="not negative",
    doc="Magnitude of the force across the string.",
    value=lambda string, sample: string.shear_force(sample),
)
SHEAR_FORCE_X = Quantity(
    "shear_force_x",
    "N",
    on="element",
    label="Shear force to the high side",
    mnemonic="SHRX",
    sign="the part below pushes the part above to the high side (north in a vertical hole)",
    doc="Component of the force across the string.",
    value=_shear_components,
    size=2,
    index=0,
)
SHEAR_FORCE_Y = Quantity(
    "shear_force_y",
    "N",
    on="element",
    label="Shear force to the right",
    mnemonic="SHRY",
    sign="the part below pushes the part above to the right of the high side, looking down (east in a vertical hole)",
    doc="Component of the force across the string.",
    value=_shear_components,
    size=2,
    index=1,
)
#: bending moment and shear force of a string
BENDING: tuple[Quantity, ...] = (
    BENDING_MOMENT,
    BENDING_MOMENT_X,
    BENDING_MOMENT_Y,
    SHEAR_FORCE,
    SHEAR_FORCE_X,
    SHEAR_FORCE_Y,
)
EFFECTIVE_TENSION = Quantity(
    "effective_tension",
    "N",
    on="element",
    label="Effective tension",
    mnemonic="EFFT",
    sign="tension positive, compression negative",
    doc="Axial force minus the pressure forces, T - p_i A_i + p_o A_o, which governs buckling (manual: eq-mud-effective-tension).",
    value=lambda string, sample: string.tension_and_pressure(sample),
    size=2,
    finish=lambda string, parts, depth: parts[:, :1] + parts[:, 1:],
)
HOLE_RADIUS = Quantity(
    "hole_radius",
    "m",
    kind="diameter",
    on="node",
    label="Radius of the hole",
    mnemonic="HRAD",
    doc="Radius of the hole at the present place of the node.",
    value=_position,
    size=3,
    finish=lambda string, position, depth: string.hole_radius(position),
)
STRING_FIELDS: tuple[Quantity, ...] = (
    MD,
    Quantity(
        "outer_radius",
        "m",
        kind="diameter",
        on="element",
        label="Outer radius of the pipe",
        mnemonic="PRAD",
        doc="Outer radius of the pipe.",
        value=lambda string, sample: string.outer_radius,
    ),
    Quantity(
        "displacement",
        "m",
        on="node",
        label="Displacement",
        mnemonic="DISP",
        sign="north, east, down",
        doc="Displacement from the unstrained string along the hole's axis at the start.",
        value=_position,
        size=3,
        finish=lambda string, position, depth: position - string.start,
        index=None,
    ),
    Quantity(
        "slope",
        "-",
        on="node",
        label="Slope",
        mnemonic="SLOP",
        sign="north, east, down",
        doc="Derivative of the position by the length of the unstrained string: with it the string is a cubic between two nodes.",
        value=lambda string, sample: string.slope(sample),
        size=3,
        index=None,
    ),
    Quantity(
        "velocity",
        "m/s",
        on="node",
        label="Velocity",
        mnemonic="VELO",
        sign="north, east, down",
        doc="Velocity of the string's centre.",
        value=lambda string, sample: string.motion(sample)[:, 3:6],
        size=3,
        index=None,
    ),
    Quantity(
        "spin",
        "rad/s",
        on="node",
        label="Spin rate",
        mnemonic="SPIN",
        sign="clockwise (looking down)",
        doc="Spin rate of the string about its axis.",
        value=lambda string, sample: string.motion(sample)[:, 6],
    ),
    Quantity(
        "spin_angle",
        "rad",
        on="node",
        label="Spin angle",
        mnemonic="SANG",
        sign="clockwise (looking down)",
        doc="Angle about the string's axis since the start, turns included.",
        value=lambda string, sample: string.motion(sample)[:, 7],
    ),
    OFFSET_X,
    OFFSET_Y,
    AXIAL_FORCE,
    TORQUE,
    *BENDING,
    Quantity(
        "stress",
        "Pa",
        kind="stress",
        on="element",
        label="Largest normal stress",
        mnemonic="STRS",
        sign="not negative",
        doc="Largest normal stress of the section, from axial force and bending.",
        value=lambda string, sample: string.stress(sample),
    ),
    EFFECTIVE_TENSION,
)
