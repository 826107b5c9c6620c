"""Outputs that physics components declare.

Plain descriptions: a value is a function of the component and the sample. So plots and the manual can read this file
without PETSc and compiled kernels.  Each component returns its tuple from ``quantities()``.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.fem.quantity import FloatArray, Quantity, Sample, quantities_of

quantity = quantities_of(Path(__file__).with_suffix(".csv"))


# ---------------------------------------------------------------------- wall contact
def _force_per_length(contact: Any, sample: Sample) -> FloatArray:
    cells, _ = sample.once(contact.element_results)
    return np.asarray(cells[:, 0] / contact.mesh.length_divisor[sample.system.chain.cells])


CONTACT: tuple[Quantity, ...] = (quantity("contact_force", value=_force_per_length),)

# ---------------------------------------------------------------------- bit on bottom, bit that cuts rock
BIT: tuple[Quantity, ...] = (
    quantity("wob", values=lambda bit, steps: bit.element_results_of(steps)[:, 0]),
    quantity("bit_torque", values=lambda bit, steps: bit.element_results_of(steps)[:, 1]),
)

#: of a bit whose hole yields beside it
BIT_SIDE: tuple[Quantity, ...] = (
    quantity("bit_overgauge", value=lambda bit, sample: sample.once(bit.orbit_and_overgauge)[1]),
    quantity("bit_orbit", value=lambda bit, sample: sample.once(bit.orbit_and_overgauge)[0]),
)

# ---------------------------------------------------------------------- reamer
REAMER: tuple[Quantity, ...] = (
    quantity("wob_reamer", value=lambda reamer, sample: float(sample.once(reamer.element_results)[0])),
    quantity("torque_reamer", value=lambda reamer, sample: float(sample.once(reamer.element_results)[1])),
    quantity("hole_depth_reamer", value=lambda reamer, sample: reamer.depth(sample.assembly)),
)


# ---------------------------------------------------------------------- rotary steerable tool
_STEERING_TOOL_FACE = quantity("steering_tool_face", value=lambda tool, sample: tool.tool_face(sample.time))
STEERING_PUSH: tuple[Quantity, ...] = (
    quantity("steering_force", value=lambda tool, sample: tool.force * tool.share(sample.time)),
    _STEERING_TOOL_FACE,
)
STEERING_POINT: tuple[Quantity, ...] = (
    quantity("steering_tilt", value=lambda tool, sample: tool.tilt * tool.share(sample.time)),
    _STEERING_TOOL_FACE,
)


# ---------------------------------------------------------------------- joints
def _of_joints(name: str, joints: Any, sample: Sample) -> FloatArray:
    return np.asarray(sample.once(joints.element_results)[:, joints.RESULTS.index(name)])


JOINTS: tuple[Quantity, ...] = (
    quantity("joint_NNN_force", value=partial(_of_joints, "tension")),
    quantity("joint_NNN_side_force", value=partial(_of_joints, "side_force")),
    quantity("joint_NNN_torque", value=partial(_of_joints, "torque")),
    quantity("joint_NNN_bending_moment", value=partial(_of_joints, "bending")),
    quantity("joint_NNN_angle", value=partial(_of_joints, "angle")),
    quantity("joint_NNN_travel", value=partial(_of_joints, "travel")),
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
    quantity("jar_state", value=partial(_of_jar, 0), finish=_whole),
    quantity("jar_stroke", value=partial(_of_jar, 1)),
    quantity("jar_impact_force", value=partial(_of_jar, 2)),
    quantity("jar_fired", value=partial(_of_jar, 3), finish=_whole),
)


def jar(number: int) -> tuple[Quantity, ...]:
    """Quantities of the jar of this number from the top."""
    return tuple(
        replace(q.numbered(number), value=partial(_of_jar, len(JAR) * (number - 1) + i))
        for i, q in enumerate(JAR)
    )


TOP_MOTOR: tuple[Quantity, ...] = (
    quantity("top_speed", value=partial(_figure, 0)),
    quantity("motor_torque", value=partial(_figure, 2)),
    quantity("pipe_torque", value=partial(_figure, 3)),
    quantity("motor_power", value=_motor_power),
    quantity("speed_error", value=partial(_figure, 4)),
    quantity("control_mode", value=partial(_figure, 5), finish=_whole),
    quantity("torque_limited", value=partial(_figure, 6), finish=_whole),
)


# ---------------------------------------------------------------------- downhole motor
#: places in ``MudMotor.figures``
_MOTOR_TORQUE, _MOTOR_SPEED, _MOTOR_PRESSURE, _MOTOR_STALLED, _MOTOR_ORBIT = range(5)


MUD_MOTOR: tuple[Quantity, ...] = (
    quantity("motor_speed", value=partial(_figure, _MOTOR_SPEED)),
    quantity("motor_output_torque", value=partial(_figure, _MOTOR_TORQUE)),
    quantity("motor_differential_pressure", value=partial(_figure, _MOTOR_PRESSURE)),
    quantity("motor_stalled", value=partial(_figure, _MOTOR_STALLED), finish=_whole),
    quantity("rotor_orbit_speed", value=partial(_figure, _MOTOR_ORBIT)),
    quantity("bearing_load", value=lambda motor, sample: sample.once(motor.thrust, sample.time)),
    quantity(
        "tool_face",
        value=lambda motor, sample: sample.once(motor.housing),
        size=6,
        finish=lambda motor, values, depth: (motor.tool_face(values),),
    ),
)


# ---------------------------------------------------------------------- agitator
AGITATOR: tuple[Quantity, ...] = (
    quantity("agitator_pressure", value=partial(_figure, 0)),
    quantity("agitator_force", value=partial(_figure, 1)),
)


# ---------------------------------------------------------------------- hoist
HOIST: tuple[Quantity, ...] = (
    quantity("block_position", value=partial(_figure, 0)),
    quantity("block_speed", value=partial(_figure, 1)),
    quantity("drum_speed", value=partial(_figure, 2)),
    quantity("line_tension", value=partial(_figure, 3)),
    quantity("dead_line_tension", value=partial(_figure, 4)),
    quantity("hook_load_sensor", value=partial(_figure, 5)),
)
AUTODRILLER: tuple[Quantity, ...] = (
    quantity("wob_surface", value=partial(_figure, 6)),
    quantity("autodriller_mode", value=partial(_figure, 7), finish=_whole),
)
