"""Checks of hoist, autodriller, downhole motor and steerable tool against the rest of the case."""

from __future__ import annotations

from drillpetsc.case.blocks.case_blocks import CaseBlocks
from drillpetsc.case.blocks.items.agitator import AgitatorTool
from drillpetsc.case.blocks.items.motor import PositiveDisplacementMotor
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import said


def check_hoist(case: CaseBlocks) -> None:
    """Raise CaseError if an autodriller has nothing to measure."""
    drill = case.top.autodriller
    if drill is None:
        return
    if case.bottom.kind != "bit":
        for key, given in (("mode", "wob" in drill.mode), ("mode", "rop" in drill.mode)):
            if given:
                want = "no wob or rop unless bottom is a bit on the end of the hole"
                raise refuse(
                    "top", "autodriller", key, got=", ".join(drill.mode), want=want, hint="bottom: bit"
                )
    if "differential_pressure" in drill.mode and (case.fluid is None or not case.has_bore):
        want = "no differential_pressure without mud that is pumped into the string"
        raise refuse("top", "autodriller", "mode", got=", ".join(drill.mode), want=want)
    fixed = case.petsc.get("ts_dt") if case.petsc.get("ts_adapt_type") == "none" else None
    if drill.sample and isinstance(fixed, (int, float)) and fixed > drill.sample * (1 + 1e-9):
        want = f"at least the fixed step petsc.ts_dt, {fixed:g} s"
        raise refuse("top", "autodriller", "sample", got=drill.sample, want=want)


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
    if not case.has_bore or item.id == 0:
        raise refuse(
            *at, "kind", got="pdm", want="mud in the bore of the motor: an id, and an open lower end"
        )


def _check_agitator(case: CaseBlocks, number: int, item: AgitatorTool) -> None:
    """Raise if the agitator ``item``, with the given ``number``, does not fit the rest of the case."""
    if case.fluid is None:
        return
    at = ("string", number)
    if item.agitator.flow_rate is not None:
        hint = "the flow in the bore turns the valve: fluid.flow_rate"
        raise refuse(
            *at, "agitator", "flow_rate", got="a flow rate", want="no flow_rate with a fluid", hint=hint
        )
    if not case.has_bore or item.id == 0:
        want = "mud in the bore of the agitator: an id, and an open lower end"
        raise refuse(*at, "kind", got="agitator", want=want)


TOLERANCE = 1e-6  # [m] depths closer than this are equal


def check_steering(case: CaseBlocks) -> None:
    """Raise if there are several steerable tools, or a joint inside one."""
    tools = list(case.steering_depths)
    if len(tools) > 1:
        raise refuse(
            "string",
            tools[1],
            "kind",
            got="rss",
            want=f"one steerable tool in a string, as in string[{tools[0]}]",
            hint="tool face, steering inputs and columns serve one tool; use loads for a second, constant side force",
        )
    for number in tools:
        above, below = case.item_depths[number]
        for i, joint in enumerate(case.joints):
            if above + TOLERANCE < joint.at < below - TOLERANCE:
                ends = " to ".join(said(v, "length", case.said_units) for v in (above, below))
                want = f"no joint inside the steerable tool string[{number}], from {ends}"
                raise refuse("joints", i, "at", got=joint.at, want=want)
