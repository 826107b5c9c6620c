"""What the tools of a string do that the soft string does not know (manual: sec-soft-string)."""

from __future__ import annotations

from drillpetsc.case.blocks.items.reamer import Reamer
from drillpetsc.case.case import Case


def bends_left_out(case: Case) -> list[str]:
    """A sentence on the tools that push or bend the string: a soft string lies along the hole; none without such a tool."""
    tools = [
        item.name
        for item in case.string
        if getattr(item, "rss", None) is not None or getattr(item, "bend", None) is not None
    ]
    if not tools:
        return []
    return [
        f"the soft string leaves out the side forces and torque of steering and bends: {', '.join(tools)}"
    ]


def cutters_left_out(case: Case) -> list[str]:
    """A sentence on a reamer that could cut: weight and torque on bit act at the lower end alone; none without a reamer."""
    reamers = [item.name for item in case.string if isinstance(item, Reamer)]
    if not reamers:
        return []
    return [f"torque and drag leave out the weight and torque of cutters above the bit: {', '.join(reamers)}"]
