"""Checks of a downhole motor against the rest of the case."""

from __future__ import annotations

from drillpetsc.case.blocks.case_blocks import CaseBlocks
from drillpetsc.case.blocks.items.agitator import AgitatorTool
from drillpetsc.case.blocks.items.motor import PositiveDisplacementMotor
from drillpetsc.case.key_paths import refuse


def check_motor(case: CaseBlocks) -> None:
    """Raise if a downhole motor does not fit the rest of the case."""
    for i, tool in enumerate(case.string):
        if isinstance(tool, AgitatorTool):
            _check_agitator(case, i, tool)
    motors = [(i, q) for i, q in enumerate(case.string) if isinstance(q, PositiveDisplacementMotor)]
    if not motors:
        return
    number, item = motors[0]
    at = ("string", number)
    if len(motors) > 1:
        hint = "power sections on one shaft are one motor: stall_torque and no_load_pressure are their sums"
        want = f"one motor; string[{number}] is one"
        raise refuse("string", motors[1][0], "kind", got="pdm", want=want, hint=hint)
    if case.hold_string:
        raise refuse(*at, "kind", got="pdm", want="no motor in a string that hold_string keeps still")
    if case.beam.formulation == "quaternion":
        hint = "leave it out, or take beam.formulation ancf"
        raise refuse(*at, "kind", got="pdm", want="not with quaternion yet: a downhole motor", hint=hint)
    if case.time is not None and case.time.mode == "quasi_static":
        hint = "mode: dynamic, because the law of a motor needs speeds; or kind: pipe with the same bend"
        raise refuse(*at, "kind", got="pdm", want="no motor in a quasi-static run", hint=hint)
    if case.top.force is not None and case.initial.wob is not None:
        hint = "leave wob out, because the top force sets the weight on bit; or prescribe the top's position"
        raise refuse(
            "initial", "wob", got=case.initial.wob, want="no wob with a top force and a motor", hint=hint
        )
    if case.fluid is None:
        if item.pdm.flow_rate is None:
            hint = "without fluid the flow through the motor is unknown"
            raise refuse(*at, "pdm", "flow_rate", want="a flow_rate of the motor, or a fluid", hint=hint)
        return
    if item.pdm.flow_rate is not None:
        hint = "the flow in the bore turns the motor: fluid.flow_rate"
        raise refuse(*at, "pdm", "flow_rate", got="a flow rate", want="no flow_rate with a fluid", hint=hint)
    if item.pressure_loss is not None:
        hint = "the law of the motor has its pressure"
        raise refuse(*at, "pressure_loss", got="a loss", want="no pressure_loss of a motor", hint=hint)
    if case.fluid.formulation == "hermite":
        raise refuse("fluid", "formulation", got="hermite", want="mixed with a downhole motor")
    if not case.has_bore or item.id == 0:
        raise refuse(
            *at, "kind", got="pdm", want="mud in the bore of the motor: an id, and an open lower end"
        )


def _check_agitator(case: CaseBlocks, number: int, item: AgitatorTool) -> None:
    """Raise if the agitator ``item``, with the given ``number``, does not fit the rest of the case."""
    if case.hold_string and case.fluid is not None:
        want = "no agitator in a string that hold_string keeps still"
        raise refuse("string", number, "kind", got="agitator", want=want)
    if case.time is not None and case.time.mode == "quasi_static":
        hint = "pulses need inertia: mode: dynamic"
        raise refuse(
            "string", number, "kind", got="agitator", want="no agitator in a quasi-static run", hint=hint
        )
    if case.fluid is None:
        return
    at = ("string", number)
    if item.agitator.flow_rate is not None:
        hint = "the flow in the bore turns the valve: fluid.flow_rate"
        raise refuse(
            *at, "agitator", "flow_rate", got="a flow rate", want="no flow_rate with a fluid", hint=hint
        )
    if case.fluid.formulation == "hermite":
        raise refuse("fluid", "formulation", got="hermite", want="mixed with an agitator")
    if not case.has_bore or item.id == 0:
        want = "mud in the bore of the agitator: an id, and an open lower end"
        raise refuse(*at, "kind", got="agitator", want=want)
