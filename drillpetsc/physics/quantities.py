"""Outputs that physics components declare.

Plain descriptions: a value is a function of the component and the sample. So plots and the manual can read this file
without PETSc and compiled kernels.  Each component returns its tuple from ``quantities()``.
"""

from __future__ import annotations

from dataclasses import replace
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
        label="Weight on bit",
        mnemonic="WOB",
        sign="positive on the rock",
        doc="Force of the bit on the bottom of the hole, along the hole's axis.",
        values=lambda bit, steps: bit.element_results_of(steps)[:, 0],
        panel=2,
        interest=2,
    ),
    Quantity(
        "bit_torque",
        "N m",
        label="Torque on bit",
        mnemonic="TOB",
        sign="the rock brakes clockwise rotation",
        doc="Torque of the rock on the bit.",
        values=lambda bit, steps: bit.element_results_of(steps)[:, 1],
        panel=3,
        interest=7,
    ),
)

#: of a bit whose hole yields beside it
BIT_SIDE: tuple[Quantity, ...] = (
    Quantity(
        "bit_overgauge",
        "m",
        kind="diameter",
        label="Over-gauge at the bit",
        mnemonic="OVGA",
        sign="hole wider than the bit",
        doc="Radius of the hole beside the bit minus radius of the bit.",
        value=lambda bit, sample: sample.once(bit.orbit_and_overgauge)[1],
    ),
    Quantity(
        "bit_orbit",
        "m",
        kind="diameter",
        label="Orbit of the bit",
        mnemonic="OBIT",
        sign="not negative",
        doc="Distance of the bit's centre from the axis of its hole.",
        value=lambda bit, sample: sample.once(bit.orbit_and_overgauge)[0],
    ),
)

# ---------------------------------------------------------------------- reamer
REAMER: tuple[Quantity, ...] = (
    Quantity(
        "wob_reamer",
        "N",
        label="Weight on reamer",
        mnemonic="WOR",
        sign="positive on the rock",
        doc="Force of the reamer on its shoulder, along the hole's axis.",
        value=lambda reamer, sample: float(sample.once(reamer.element_results)[0]),
        panel=2,
        tool="reamer",
    ),
    Quantity(
        "torque_reamer",
        "N m",
        label="Torque on reamer",
        mnemonic="TOR",
        sign="the rock brakes clockwise rotation",
        doc="Torque of the rock on the reamer.",
        value=lambda reamer, sample: float(sample.once(reamer.element_results)[1]),
        panel=3,
        tool="reamer",
    ),
    Quantity(
        "hole_depth_reamer",
        "m",
        label="Depth of the reamed hole",
        mnemonic="DRMD",
        sign="down",
        doc="Measured depth of the shoulder between reamed and pilot hole.",
        mean=False,
        value=lambda reamer, sample: reamer.depth(sample.assembly),
        tool="reamer",
    ),
)


# ---------------------------------------------------------------------- rotary steerable tool
_STEERING_TOOL_FACE = Quantity(
    "steering_tool_face",
    "rad",
    label="Commanded tool face",
    mnemonic="TFST",
    sign="clockwise from the high side looking down the hole; from north below 5 deg of inclination",
    doc="Direction in which the steerable tool steers.",
    mean=False,
    value=lambda tool, sample: tool.tool_face(sample.time),
)
STEERING_PUSH: tuple[Quantity, ...] = (
    Quantity(
        "steering_force",
        "N",
        label="Steering force",
        mnemonic="STFO",
        sign="not negative, towards the tool face",
        doc="Commanded force of the pads on the string, its mean over a turn.",
        value=lambda tool, sample: tool.force * tool.share(sample.time),
    ),
    _STEERING_TOOL_FACE,
)
STEERING_POINT: tuple[Quantity, ...] = (
    Quantity(
        "steering_tilt",
        "rad",
        label="Tilt of the shaft",
        mnemonic="STTI",
        sign="not negative, towards the tool face",
        doc="Commanded tilt of the shaft of the steerable tool.",
        value=lambda tool, sample: tool.tilt * tool.share(sample.time),
    ),
    _STEERING_TOOL_FACE,
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


# ---------------------------------------------------------------------- jar
def _of_jar(index: int, joints: Any, sample: Sample) -> float:
    return float(sample.once(joints.jar_figures)[index])


# ---------------------------------------------------------------------- motor of the top drive, other machines
def _figure(index: int, machine: Any, sample: Sample) -> float:
    return float(sample.once(machine.figures, sample.time)[index])


def _motor_power(drive: Any, sample: Sample) -> float:
    speed, _, torque = sample.once(drive.figures, sample.time)[:3]
    return float(speed * torque)


def _whole(drive: Any, values: FloatArray, depth: Any) -> tuple[float]:
    """The nearest whole number, if a row lies between two steps."""
    return (float(np.round(values[0])),)


JAR: tuple[Quantity, ...] = (
    Quantity(
        "jar_state",
        "-",
        label="State of the jar",
        mnemonic="JARS",
        sign="0 latched, 1 metering, 2 free",
        doc="State of the jar's latch.",
        mean=False,
        value=partial(_of_jar, 0),
        finish=_whole,
        tool="jar",
    ),
    Quantity(
        "jar_stroke",
        "m",
        label="Stroke of the jar",
        mnemonic="JARX",
        sign="positive as the jar opens",
        doc="Travel of the jar from its cocked position.",
        value=partial(_of_jar, 1),
        tool="jar",
    ),
    Quantity(
        "jar_impact_force",
        "N",
        label="Impact force of the jar",
        mnemonic="JARF",
        sign="not negative",
        doc="Force on the stop at the end of the jar's stroke.",
        value=partial(_of_jar, 2),
        tool="jar",
    ),
    Quantity(
        "jar_fired",
        "-",
        label="Shots of the jar",
        mnemonic="JARN",
        sign="not negative",
        doc="Number of times that the jar has fired.",
        mean=False,
        value=partial(_of_jar, 3),
        finish=_whole,
        tool="jar",
    ),
)


def jar(number: int) -> tuple[Quantity, ...]:
    """Quantities of the jar of this number from the top."""
    return tuple(
        replace(q.numbered(number), value=partial(_of_jar, len(JAR) * (number - 1) + i))
        for i, q in enumerate(JAR)
    )


TOP_MOTOR: tuple[Quantity, ...] = (
    Quantity(
        "top_speed",
        "rad/s",
        label="Speed of the top drive",
        mnemonic="RPMA",
        sign="clockwise (looking down)",
        doc="Speed of the quill.",
        value=partial(_figure, 0),
        panel=4,
        interest=4,
    ),
    Quantity(
        "motor_torque",
        "N m",
        label="Motor torque",
        mnemonic="TQMO",
        sign="the motor drives clockwise (looking down)",
        doc="Torque of the motor at the quill, within its limits.",
        value=partial(_figure, 2),
        panel=3,
    ),
    Quantity(
        "pipe_torque",
        "N m",
        label="Torque on the pipe",
        mnemonic="TQPI",
        sign="the drive turns the string clockwise (looking down)",
        doc="Motor torque minus the torque that accelerates the drive; the surface torque.",
        value=partial(_figure, 3),
        panel=3,
    ),
    Quantity(
        "motor_power",
        "W",
        label="Motor power",
        mnemonic="PWMO",
        sign="the motor drives the string",
        doc="Motor torque times the speed of the quill.",
        value=_motor_power,
    ),
    Quantity(
        "speed_error",
        "rad/s",
        label="Speed error of the top drive",
        mnemonic="RPME",
        sign="the drive is slower than its set point",
        doc="Set point minus the speed of the quill; 0 if the torque is prescribed.",
        value=partial(_figure, 4),
    ),
    Quantity(
        "control_mode",
        "-",
        label="Control mode",
        mnemonic="CMOD",
        sign="0 torque prescribed, 1 pi, 2 stiff, 3 soft_torque, 4 z_torque, 5 python",
        doc="Kind of the controller that acts.",
        mean=False,
        value=partial(_figure, 5),
        finish=_whole,
    ),
    Quantity(
        "torque_limited",
        "-",
        label="Torque at a limit",
        mnemonic="TQLI",
        sign="1 at a limit, else 0",
        doc="Whether a limit of the motor holds its torque.",
        value=partial(_figure, 6),
        finish=_whole,
    ),
)


# ---------------------------------------------------------------------- downhole motor
#: places in ``MudMotor.figures``
_MOTOR_TORQUE, _MOTOR_SPEED, _MOTOR_PRESSURE, _MOTOR_STALLED, _MOTOR_ORBIT = range(5)


MUD_MOTOR: tuple[Quantity, ...] = (
    Quantity(
        "motor_speed",
        "rad/s",
        label="Speed of the downhole motor",
        mnemonic="MRPM",
        sign="the rotor turns clockwise in the stator (looking down)",
        doc="Speed of the rotor and the bit from the stator.",
        value=partial(_figure, _MOTOR_SPEED),
        panel=4,
        interest=3,
    ),
    Quantity(
        "motor_output_torque",
        "N m",
        label="Torque of the downhole motor",
        mnemonic="MTOR",
        sign="the stator turns the rotor clockwise (looking down)",
        doc="Torque of the downhole motor on the part below it; the opposite torque acts on the string above.",
        value=partial(_figure, _MOTOR_TORQUE),
        panel=3,
    ),
    Quantity(
        "motor_differential_pressure",
        "Pa",
        kind="pressure",
        label="Motor pressure",
        mnemonic="MDPR",
        sign="pressure above less pressure below",
        doc="Pressure that the mud loses in the downhole motor.",
        value=partial(_figure, _MOTOR_PRESSURE),
    ),
    Quantity(
        "motor_stalled",
        "-",
        label="Motor stalled",
        mnemonic="MSTA",
        sign="1 stalled, else 0",
        doc="Whether the torque of the downhole motor has reached its stall torque.",
        value=partial(_figure, _MOTOR_STALLED),
        finish=_whole,
    ),
    Quantity(
        "rotor_orbit_speed",
        "rad/s",
        label="Orbit of the rotor",
        mnemonic="MORB",
        sign="clockwise in space (looking down)",
        doc="Speed in space at which the centre of the rotor circles the centre of the stator.",
        value=partial(_figure, _MOTOR_ORBIT),
    ),
    Quantity(
        "bearing_load",
        "N",
        label="Load of the thrust bearing",
        mnemonic="MBRG",
        sign="positive if mud and weight push the rotor down",
        doc="Thrust of the mud on the seal of the downhole motor, and the tension between its halves, which weight on bit takes off.",
        value=lambda motor, sample: sample.once(motor.thrust, sample.time),
    ),
    Quantity(
        "tool_face",
        "rad",
        label="Tool face",
        mnemonic="TFAC",
        sign="clockwise from the high side (looking down), from north if the inclination is below 5 deg",
        doc="Direction of the bend of the downhole motor's housing, or of its scribe line if it is straight.",
        mean=False,
        value=lambda motor, sample: sample.once(motor.housing),
        size=6,
        finish=lambda motor, values, depth: (motor.tool_face(values),),
    ),
)


# ---------------------------------------------------------------------- agitator
AGITATOR: tuple[Quantity, ...] = (
    Quantity(
        "agitator_pressure",
        "Pa",
        kind="pressure",
        label="Agitator pressure",
        mnemonic="AGPR",
        interpolate="motion",
        sign="pressure above less pressure below",
        doc="Oscillating part of the pressure that the mud loses in the valve of the agitator.",
        value=partial(_figure, 0),
        tool="agitator",
    ),
    Quantity(
        "agitator_force",
        "N",
        label="Agitator force",
        mnemonic="AGFO",
        interpolate="motion",
        sign="pushes the halves apart",
        doc="Force of that pressure on the piston of the agitator.",
        value=partial(_figure, 1),
        tool="agitator",
    ),
)


# ---------------------------------------------------------------------- hoist
HOIST: tuple[Quantity, ...] = (
    Quantity(
        "block_position",
        "m",
        label="Height of the block",
        mnemonic="BPOS",
        sign="above the floor",
        doc="Height of the block over the rig floor.",
        mean=False,
        value=partial(_figure, 0),
    ),
    Quantity(
        "block_speed",
        "m/s",
        label="Speed of the block",
        mnemonic="BVEL",
        sign="down",
        doc="Speed of the block.",
        value=partial(_figure, 1),
    ),
    Quantity(
        "drum_speed",
        "m/s",
        label="Speed of the drum",
        mnemonic="DRSP",
        sign="the drum pays out",
        doc="Speed of the drum as the speed that the block has under a constant load.",
        value=partial(_figure, 2),
    ),
    Quantity(
        "line_tension",
        "N",
        label="Force of the lines",
        mnemonic="LINF",
        sign="the lines pull the block up",
        doc="Force of all lines on the block.",
        value=partial(_figure, 3),
    ),
    Quantity(
        "dead_line_tension",
        "N",
        label="Dead-line tension",
        mnemonic="DLTN",
        sign="tension positive",
        doc="Tension of the dead line, with the friction of the sheaves against the motion of the block.",
        value=partial(_figure, 4),
    ),
    Quantity(
        "hook_load_sensor",
        "N",
        label="Hook load by the dead line",
        mnemonic="HKLS",
        sign="the hook pulls up",
        doc="Dead-line tension times the number of lines; with top.hoist.tare minus the weight of the block.",
        value=partial(_figure, 5),
        panel=1,
    ),
)
AUTODRILLER: tuple[Quantity, ...] = (
    Quantity(
        "wob_surface",
        "N",
        label="Weight on bit by the hook load",
        mnemonic="SWOB",
        sign="positive on the rock",
        doc="Tared hook load without weight on bit, minus the present hook load.",
        value=partial(_figure, 6),
        panel=2,
    ),
    Quantity(
        "autodriller_mode",
        "-",
        label="Mode of the autodriller",
        mnemonic="ADMO",
        sign="0 off, 1 wob, 2 rop, 3 torque, 4 differential_pressure",
        doc="Loop that is in charge of the drum.",
        mean=False,
        value=partial(_figure, 7),
        finish=_whole,
    ),
)
