"""Checks of a rotary steerable tool against the rest of the case."""

from __future__ import annotations

from drillpetsc.case.blocks.case_blocks import CaseBlocks
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import said

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
        if case.hold_string:
            raise refuse("string", number, "kind", got="rss", want="no steerable tool with hold_string")
        above, below = case.item_depths[number]
        for i, joint in enumerate(case.joints):
            if above + TOLERANCE < joint.at < below - TOLERANCE:
                ends = " to ".join(said(v, "length", case.output.units or case.units) for v in (above, below))
                want = f"no joint inside the steerable tool string[{number}], from {ends}"
                raise refuse("joints", i, "at", got=joint.at, want=want)
