"""Static equilibrium of a string with a downhole motor, whose speed follows from the torque that statics finds.

Manual: sec-motor-statics.
"""

from __future__ import annotations

from drillpetsc.analysis.statics.equilibrium import director_equilibrium
from drillpetsc.analysis.statics.path.path_answer import PathKind
from drillpetsc.analysis.statics.static_problem import StaticState
from drillpetsc.case.blocks.fluid import Fluid
from drillpetsc.doubts import doubts_at
from drillpetsc.doubts.tools import Driven
from drillpetsc.errors import CaseError
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.model.tools.mud_motor import motor_item
from drillpetsc.parallel import total
from drillpetsc.physics.tools.mud_motor import MudMotor

MOST_ROUNDS = 8  # equilibria, each with the speed of the one before
SAME_SPEED = 1e-3  # change of speed and torque, as shares of free speed and stall torque, that is none


def motor_equilibrium(
    model: DrillingModel,
    motor: MudMotor,
    motion: tuple[float, float] | None,
    lateral_friction: bool,
    path: PathKind | None,
) -> StaticState:
    """Find the equilibrium with the motor turning as its torque lets it; arguments as in ``director_equilibrium``.

    Friction below the motor opposes the rotation of the string and that of the motor.  The motor stands where no mud
    flows, and where ``motion`` is (0, 0).
    """
    if path is not None:
        raise CaseError(at="--path", got=path, want="a string without a downhole motor")
    motor.run_statically(0.0 if motion == (0.0, 0.0) else _given_flow(model))
    start = model.top.anchor.copy()
    for _ in range(MOST_ROUNDS):
        model.top.anchor[:] = start  # statics moves the top from there
        state = director_equilibrium(model, motion, lateral_friction)
        torque, flow = _torque_and_flow(model, motor)
        if motion == (0.0, 0.0):
            return state
        settled = motor.update_static_speed(torque, flow) < SAME_SPEED
        if settled:
            break
    state.warnings += doubts_at(Driven(model=model, motor=motor, torque=torque, flow=flow, settled=settled))
    return state


def _given_flow(model: DrillingModel) -> float:
    """Flow rate at the start that the case gives [m3/s], 0 where it is unknown before the flow is solved."""
    fluid: Fluid | None = model.case.fluid
    if fluid is not None:
        return fluid.flow_rate.value(0.0) if fluid.flow_rate is not None else 0.0
    return float(motor_flow(model))


def motor_flow(model: DrillingModel) -> float:
    """Flow rate of the motor at the start where the case has no fluid [m3/s]."""
    found = motor_item(model.case)
    assert found is not None and found[1].pdm.flow_rate is not None
    return max(found[1].pdm.flow_rate.value(0.0), 0.0)


def _torque_and_flow(model: DrillingModel, motor: MudMotor) -> tuple[float, float]:
    """Torque [N m] and flow rate [m3/s] of the motor, the same on all ranks."""
    torque, flow = total(model.system.comm, motor.torque_and_flow(0.0, model.system.assembly))
    return float(torque), float(flow)
