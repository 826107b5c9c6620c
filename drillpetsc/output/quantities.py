"""Outputs that need more than one component: ends of the string, drilled hole, mud, energy, probes, fields, tables.

Plain descriptions, like ``drillpetsc.physics.quantities``: no PETSc and no compiled kernels.  A value is a function of
the source that declares it (a class of this folder) and of the sample.  Signs: manual, sec-conventions-signs.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.fem.quantity import FloatArray, Quantity, Sample
from drillpetsc.physics.quantities import BIT

# ---------------------------------------------------------------------- the row itself
TIME = Quantity(
    "time",
    "s",
    on="scalar",
    label="Time",
    mnemonic="TIME",
    doc="Simulated time.",
    interpolate="none",
    mean=False,
    value=lambda row, sample: row.time,
    numerics=True,
)
STEP = Quantity(
    "step",
    "s",
    on="scalar",
    label="Time step",
    mnemonic="STEP",
    doc="Last time step before the row.",
    interpolate="none",
    mean=False,
    value=lambda row, sample: row.step,
    panel=11,
    numerics=True,
)
NEWTON = Quantity(
    "newton",
    "-",
    on="scalar",
    label="Newton iterations",
    mnemonic="NEWT",
    doc="Newton iterations of the last time step before the row.",
    interpolate="none",
    mean=False,
    value=lambda row, sample: row.newton,
    panel=12,
    numerics=True,
)
ROW_START, ROW_END = (TIME,), (STEP, NEWTON)

# ---------------------------------------------------------------------- ends of the string, drilled hole
TOP_END: tuple[Quantity, ...] = (
    Quantity(
        "hook_load",
        "N",
        on="scalar",
        label="Hook load",
        mnemonic="HKLD",
        sign="the drive pulls the string up",
        doc="Pull of the top on the string: the reaction, or the given force.",
        value=lambda top, sample: top.hook_load(sample),
        panel=1,
        interest=3,
    ),
    Quantity(
        "surface_torque",
        "N m",
        on="scalar",
        label="Surface torque",
        mnemonic="STOR",
        sign="the drive turns the string clockwise (looking down)",
        doc="Torque of the drive on the string.",
        value=lambda top, sample: top.surface_torque(sample),
        panel=3,
        interest=6,
    ),
)
LOWER_END: tuple[Quantity, ...] = (
    Quantity(
        "bit_speed",
        "rad/s",
        on="scalar",
        label="Bit speed",
        mnemonic="BRPM",
        sign="clockwise (looking down)",
        doc="Spin rate of the lower end of the string.",
        interpolate="motion",
        value=lambda end, sample: sample.once(end.motion)[3],
        panel=4,
        interest=1,
    ),
    Quantity(
        "bit_depth",
        "m",
        on="scalar",
        label="Bit depth",
        mnemonic="DBTM",
        sign="down",
        doc="Measured depth of the face of the string's lower end.",
        interpolate="motion",
        mean=False,
        value=lambda end, sample: sample.once(end.motion)[:3],
        size=3,
        finish=lambda end, point, depth: (end.depth_of(point),),
        panel=5,
        interest=5,
    ),
)
HOLE: tuple[Quantity, ...] = (
    Quantity(
        "hole_depth",
        "m",
        on="scalar",
        label="Hole depth",
        mnemonic="DMEA",
        sign="down",
        doc="Measured depth of the end of the hole.",
        interpolate="motion",
        mean=False,
        value=lambda hole, sample: sample.once(hole.bit.progress)[0],
        finish=lambda hole, drilled, depth: (hole.start + drilled[0],),
        panel=5,
    ),
    Quantity(
        "rop",
        "m/s",
        on="scalar",
        label="Rate of penetration",
        mnemonic="ROP",
        sign="the hole grows",
        doc="Rate at which the bit lengthens the hole.",
        value=lambda hole, sample: sample.once(hole.bit.progress)[1],
        panel=6,
        interest=8,
    ),
)

# ---------------------------------------------------------------------- mud
PUMP_FLOW = Quantity(
    "pump_flow",
    "m3/s",
    on="scalar",
    label="Flow rate in",
    mnemonic="MFIA",
    sign="into the bore; negative in reverse circulation",
    doc="Flow rate of the pump, as volume at zero pressure.",
    value=lambda mud, sample: mud.pump_flow(sample),
    panel=8,
)
OUTLET_FLOW = Quantity(
    "outlet_flow",
    "m3/s",
    on="scalar",
    label="Flow rate out",
    mnemonic="MFOA",
    sign="out of the annulus at the top",
    doc="Flow rate out of the flow line (without an annulus: out of the string), as volume at zero pressure.",
    value=lambda mud, sample: mud.outlet_flow(sample),
    panel=8,
    interest=10,
)
MUD: tuple[Quantity, ...] = (
    Quantity(
        "pump_pressure",
        "Pa",
        on="scalar",
        label="Pump pressure",
        mnemonic="SPP",
        sign="gauge",
        doc="Pressure in the bore at the string's upper end.",
        value=lambda mud, sample: mud.pump_pressure(sample),
        panel=7,
        interest=4,
    ),
    Quantity(
        "bit_pressure",
        "Pa",
        on="scalar",
        label="Pressure under the bit",
        mnemonic="BHP",
        sign="gauge",
        doc="Pressure of the mud under the bit, outside the nozzles.",
        value=lambda mud, sample: mud.bit_pressure(sample),
        panel=7,
        interest=9,
    ),
    OUTLET_FLOW,
    PUMP_FLOW,
    Quantity(
        "bit_flow",
        "m3/s",
        on="scalar",
        label="Flow rate through the bit",
        mnemonic="MFBT",
        sign="out of the string",
        doc="Flow rate through the nozzles, as volume at zero pressure.",
        value=lambda mud, sample: mud.bit_flow(sample),
    ),
)
#: columns that exist only with mud in the bore
BORE_ONLY = ("pump_pressure", "pump_flow", "bit_flow")
#: what the mass balance samples besides the two flow rates; not written anywhere
CUTTINGS_FLOW = Quantity(
    "cuttings_flow",
    "m3/s",
    on="scalar",
    label="Cuttings",
    doc="Rock that the mud takes up, as volume of mud.",
    value=lambda mud, sample: mud.cuttings_flow(sample),
)
MUD_CONTENT = Quantity(
    "mud_content",
    "m3",
    on="scalar",
    label="Content",
    doc="Volume at zero pressure of all mud.",
    value=lambda mud, sample: mud.content(sample),
)
MUD_FIELDS: tuple[Quantity, ...] = (
    Quantity(
        "internal_pressure",
        "Pa",
        on="node",
        label="Pressure in the bore",
        mnemonic="PPRS",
        sign="gauge",
        doc="Pressure of the mud in the bore.",
        value=lambda mud, sample: mud.pressure("bore"),
    ),
    Quantity(
        "annulus_pressure",
        "Pa",
        on="node",
        label="Pressure in the annulus",
        mnemonic="APRS",
        sign="gauge",
        doc="Pressure of the mud in the annulus.",
        value=lambda mud, sample: mud.pressure("annulus"),
    ),
    Quantity(
        "internal_flow",
        "m3/s",
        on="element",
        label="Flow rate in the bore",
        mnemonic="FLWP",
        sign="towards the bit",
        doc="Flow rate in the bore, as volume at zero pressure.",
        value=lambda mud, sample: mud.flow("bore"),
    ),
    Quantity(
        "internal_speed",
        "m/s",
        on="element",
        label="Speed of the mud in the bore",
        mnemonic="VELP",
        sign="towards the bit",
        doc="Mean speed of the mud over the section of the bore.",
        value=lambda mud, sample: mud.speed("bore", sample),
    ),
    Quantity(
        "annulus_flow",
        "m3/s",
        on="element",
        label="Flow rate in the annulus",
        mnemonic="FLWA",
        sign="towards the bit: normal circulation is negative",
        doc="Flow rate in the annulus, as volume at zero pressure.",
        value=lambda mud, sample: mud.flow("annulus"),
    ),
    Quantity(
        "annulus_speed",
        "m/s",
        on="element",
        label="Speed of the mud in the annulus",
        mnemonic="VELA",
        sign="towards the bit: normal circulation is negative",
        doc="Mean speed of the mud over the section of the annulus.",
        value=lambda mud, sample: mud.speed("annulus", sample),
    ),
)

# ---------------------------------------------------------------------- energy
ENERGY: tuple[Quantity, ...] = (
    Quantity(
        "kinetic_energy",
        "J",
        on="scalar",
        label="Kinetic energy",
        mnemonic="EKIN",
        doc="Kinetic energy of string and mud.",
        interpolate="none",
        mean=False,
        value=lambda balance, sample: balance.energies[0],
        panel=9,
        numerics=True,
    ),
    Quantity(
        "strain_energy",
        "J",
        on="scalar",
        label="Strain energy",
        mnemonic="ESTR",
        doc="Energy stored in the string, in contacts, springs and compressed mud.",
        interpolate="none",
        mean=False,
        value=lambda balance, sample: balance.energies[1],
        panel=9,
        numerics=True,
    ),
    Quantity(
        "energy_error",
        "J",
        on="scalar",
        label="Energy error",
        mnemonic="EERR",
        sign="the time integration created energy",
        doc="Stored energy gained plus dissipated less supplied energy since the start.",
        interpolate="none",
        mean=False,
        value=lambda balance, sample: balance.error,
        panel=10,
        numerics=True,
    ),
)
#: what the energy balance samples: dissipated and supplied power; not written anywhere
POWERS = Quantity(
    "powers",
    "W",
    on="scalar",
    label="Powers",
    doc="Dissipated and supplied power.",
    value=lambda balance, sample: sample.system.local_powers(sample.time),
    size=2,
)


# ---------------------------------------------------------------------- probes
def _probe_position(probes: Any, sample: Sample) -> FloatArray:
    return np.asarray(sample.once(probes.motion)[:, :3])


def _probe_offset(probes: Any, position: FloatArray, depth: float) -> FloatArray:
    return np.asarray(probes.offset(position, depth))


PROBES: tuple[Quantity, ...] = (
    Quantity(
        "x_NNN",
        "m",
        on="probe",
        label="Offset to the high side at NNN m",
        mnemonic="OXNNN",
        sign="towards the high side (north in a vertical hole)",
        doc="Offset of the string's centre from the hole's axis.",
        interpolate="motion",
        value=_probe_position,
        size=3,
        finish=_probe_offset,
        index=0,
    ),
    Quantity(
        "y_NNN",
        "m",
        on="probe",
        label="Offset to the right at NNN m",
        mnemonic="OYNNN",
        sign="to the right of the high side, looking down (east in a vertical hole)",
        doc="Offset of the string's centre from the hole's axis.",
        interpolate="motion",
        value=_probe_position,
        size=3,
        finish=_probe_offset,
        index=1,
    ),
    Quantity(
        "spin_NNN",
        "rad/s",
        on="probe",
        label="Spin rate at NNN m",
        mnemonic="RPMNNN",
        sign="clockwise (looking down)",
        doc="Spin rate of the string about its axis.",
        interpolate="motion",
        value=lambda probes, sample: sample.once(probes.motion)[:, 3],
    ),
    Quantity(
        "contact_NNN",
        "N",
        on="probe",
        label="Contact force at NNN m",
        mnemonic="SFNNN",
        sign="push of the wall on the string, not negative",
        doc="Normal force of the wall on the element that holds the probe.",
        value=lambda probes, sample: probes.contact_force(),
    ),
)


# ---------------------------------------------------------------------- along the string
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
    doc="Magnitude of the bending moment, beyond the stress-free shape.",
    value=lambda string, sample: string.bending_moment(sample),
)
EFFECTIVE_TENSION = Quantity(
    "effective_tension",
    "N",
    on="element",
    label="Effective tension",
    mnemonic="EFFT",
    sign="tension positive, compression negative",
    doc="Axial force less the pressures, the quantity that buckles (manual: eq-mud-effective-tension).",
    value=lambda string, sample: string.tension_and_pressure(sample),
    size=2,
    finish=lambda string, parts, depth: parts[:, :1] + parts[:, 1:],
)
HOLE_RADIUS = Quantity(
    "hole_radius",
    "m",
    on="node",
    label="Radius of the hole",
    mnemonic="HRAD",
    doc="Radius of the hole where the node is now.",
    value=_position,
    size=3,
    finish=lambda string, position, depth: string.hole_radius(position),
)
STRING_FIELDS: tuple[Quantity, ...] = (
    MD,
    Quantity(
        "outer_radius",
        "m",
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
    BENDING_MOMENT,
    Quantity(
        "stress",
        "Pa",
        on="element",
        label="Largest normal stress",
        mnemonic="STRS",
        sign="not negative",
        doc="Largest normal stress of the section, from axial force and bending.",
        value=lambda string, sample: string.stress(sample),
    ),
    EFFECTIVE_TENSION,
)

# ---------------------------------------------------------------------- statics.csv, modes.csv, trajectory.csv
INCLINATION = Quantity(
    "inclination",
    "deg",
    on="node",
    label="Inclination",
    mnemonic="INCL",
    sign="from the vertical, 90 deg is level",
    doc="Angle of the string (in trajectory.csv: of the hole) from the vertical.",
)
CURVATURE = Quantity(
    "curvature",
    "1/m",
    on="node",
    label="Curvature",
    mnemonic="CURV",
    sign="not negative",
    doc="Magnitude of the string's curvature.",
)
BENDING_STRESS = Quantity(
    "bending_stress",
    "Pa",
    on="node",
    label="Bending stress",
    mnemonic="BSTR",
    sign="not negative",
    doc="Bending stress at the outer fibre.",
)
BUCKLING_LOAD = Quantity(
    "buckling_load",
    "N",
    on="node",
    label="Sinusoidal buckling load",
    mnemonic="SBKL",
    sign="compression",
    doc="2 sqrt(EI q/r) of the string in the hole (Dawson and Paslay 1984); nan without side load or clearance.",
)
BUCKLING_RATIO = Quantity(
    "buckling_ratio",
    "-",
    on="node",
    label="Compression over buckling load",
    mnemonic="SBKR",
    sign="not negative",
    doc="Effective compression over the sinusoidal buckling load.",
)
ECD = Quantity(
    "ecd",
    "kg/m3",
    on="node",
    label="Equivalent circulating density",
    mnemonic="ECD",
    doc="Pressure in the annulus over gravity and the vertical depth below the top.",
)
STRETCH = Quantity(
    "stretch",
    "m",
    on="scalar",
    label="Stretch",
    mnemonic="STRC",
    sign="longer than free of stress",
    doc="Elongation of the whole string by axial force, in the summary of statics.",
)
TWIST = Quantity(
    "twist",
    "rad",
    on="scalar",
    label="Twist",
    mnemonic="TWST",
    sign="not negative",
    doc="Angle between the ends of the string, in the summary of statics.",
)
#: shown after the `statics` command
STATIC_SUMMARY: tuple[Quantity, ...] = (*TOP_END, *BIT, STRETCH, TWIST)

#: kinds of modes: each has a share of the energy
MODE_KINDS = ("lateral", "axial", "torsional", "fluid")
MODE_SHARES: tuple[Quantity, ...] = tuple(
    Quantity(
        f"{kind}_share",
        "-",
        on="item",
        label=f"Share of {kind} energy",
        mnemonic=f"SH{kind[:2].upper()}",
        doc=f"Share of the mode's energy in {kind} motion.",
    )
    for kind in MODE_KINDS
)
MODES: tuple[Quantity, ...] = (
    Quantity("mode", "-", on="item", label="Mode", mnemonic="MODE", doc="Number of the mode, from 1."),
    Quantity(
        "frequency",
        "Hz",
        on="item",
        label="Frequency",
        mnemonic="FREQ",
        sign="not negative",
        doc="Frequency of the oscillation, 0 for a real eigenvalue.",
    ),
    Quantity(
        "speed",
        "rpm",
        on="item",
        label="Critical speed",
        mnemonic="CRPM",
        sign="not negative",
        doc="Rotary speed at which one excitation per turn meets the mode.",
    ),
    Quantity(
        "damping_ratio",
        "-",
        on="item",
        label="Damping ratio",
        mnemonic="DAMP",
        sign="the mode decays",
        doc="Damping as a fraction of critical damping (manual: eq-eigen-figures).",
    ),
    Quantity(
        "growth",
        "1/s",
        on="item",
        label="Growth rate",
        mnemonic="GROW",
        sign="the mode grows",
        doc="Real part of the eigenvalue.",
    ),
    Quantity(
        "kind",
        "-",
        on="item",
        label="Kind of mode",
        mnemonic="KIND",
        doc="Motion with the largest share of the mode's energy.",
    ),
    *MODE_SHARES,
    Quantity(
        "backward_error",
        "-",
        on="item",
        label="Backward error",
        mnemonic="BERR",
        sign="not negative",
        doc="Backward error of the eigenvalue (manual: eq-eigen-error).",
    ),
)

TRAJECTORY: tuple[Quantity, ...] = (
    MD,
    INCLINATION,
    Quantity(
        "azimuth",
        "deg",
        on="node",
        label="Azimuth",
        mnemonic="AZIM",
        sign="from north over east",
        doc="Direction of the hole in the horizontal plane.",
    ),
    Quantity("north", "m", on="node", label="North", mnemonic="NS", sign="north", doc="Offset to the north."),
    Quantity("east", "m", on="node", label="East", mnemonic="EW", sign="east", doc="Offset to the east."),
    Quantity(
        "tvd",
        "m",
        on="node",
        label="True vertical depth",
        mnemonic="TVD",
        sign="down",
        doc="Vertical depth of the hole's axis.",
    ),
    Quantity(
        "dogleg_severity",
        "deg/30m",
        on="node",
        label="Dogleg severity",
        mnemonic="DLS",
        sign="not negative",
        doc="Change of the hole's direction over 30 m.",
    ),
)
