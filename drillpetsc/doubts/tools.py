"""Doubts about tools in a static state: a downhole motor."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Any

from drillpetsc.doubts.doubt import Values, doubt
from drillpetsc.doubts.moments import Moment
from drillpetsc.physics.tools.motor_law import SLIP
from drillpetsc.physics.tools.mud_motor import MudMotor


@dataclass(frozen=True, kw_only=True)
class Driven(Moment):
    """Statics has found the equilibrium of a string with a downhole motor, for any command.

    torque: of the motor [N m]; flow: rate through it [m3/s]; settled: its speed did not change any more.
    """

    motor: MudMotor
    torque: float
    flow: float
    settled: bool

    @property
    def free_speed(self) -> float:
        """Speed without load [rad/s]; zero if it does not turn."""
        speed = float(self.motor.law.free_speed(self.flow))
        return speed if abs(speed) > SLIP else 0.0

    @property
    def figures(self) -> dict[str, Any]:
        """Name, flow rate, free speed [rpm], torque and stall torque."""
        law = self.motor.law
        return {
            "name": self.motor.label,
            "flow": self.flow,
            "rpm": law.free_speed(self.flow) * 30 / pi,
            "torque": abs(self.torque),
            "stall": law.stall_torque(self.flow),
        }


@doubt(
    "the speed of the downhole motor did not settle in the search for the equilibrium",
    "Read torque and weight on bit as estimates, or simulate the motion with `run`.",
)
def unsettled_motor(at: Driven) -> Values:
    """The speed of the downhole motor and the equilibrium did not agree after some rounds."""
    return not at.settled


@doubt(
    "{name}: no flow through the motor, so it does not turn",
    "Give `fluid.flow_rate`, or a motor with a flow rate of its own.",
)
def motor_without_flow(at: Driven) -> Values:
    """No mud flows through the downhole motor, so it does not turn."""
    return not at.free_speed and {"name": at.motor.label}


@doubt(
    "{name}: the mud flows up through the motor and turns it backwards with {rpm:.4g} rpm",
    "Check the sign of the flow rate, and a string that is run in open-ended.",
)
def motor_backwards(at: Driven) -> Values:
    """The mud flows up through the downhole motor and turns it backwards."""
    return at.free_speed and at.flow < 0 and {"name": at.motor.label, "rpm": -at.figures["rpm"]}


@doubt(
    "{name}: {flow:flow} gives {rpm:.4g} rpm, torque of the start {torque:torque} is above stall_torque {stall:torque}: the motor "
    "does not turn",
    "Give less weight on bit, or more flow.",
)
def motor_stalls_at_start(at: Driven) -> Values:
    """The torque of the start exceeds the stall torque of the downhole motor."""
    return at.free_speed and at.flow >= 0 and at.torque >= at.figures["stall"] and at.figures


@doubt(
    "{name}: {flow:flow} gives {rpm:.4g} rpm, the part below the motor drives it with {torque:torque} at the start",
    "Check the torque on bit: the rock resists a bit that turns.",
)
def motor_is_driven(at: Driven) -> Values:
    """The string below the downhole motor drives it."""
    return at.free_speed and at.flow >= 0 and at.torque < 0 and at.figures
