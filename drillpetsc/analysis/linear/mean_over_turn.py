"""The mean over a turn of what moves with the string's angle, for linear models (manual: sec-eigen-state)."""

from __future__ import annotations

from drillpetsc.case.blocks.formation import level_bottom
from drillpetsc.case.blocks.items.steering import PushSteering, RotarySteerable
from drillpetsc.case.blocks.items.string import Item
from drillpetsc.case.case import Case


def mean_over_turn(case: Case) -> Case:
    """The case with the mean bottom under a roller cone, and the mean force of pads that turn with the string.

    A case without either is returned as it is.
    """
    string = tuple(_steady(item) for item in case.string)
    formation = level_bottom(case.formation)
    if formation is case.formation and all(a is b for a, b in zip(string, case.string, strict=True)):
        return case
    return case.model_copy(update={"formation": formation, "string": string})


def _steady(item: Item) -> Item:
    """The item with pads on a sleeve."""
    if (
        not isinstance(item, RotarySteerable)
        or not isinstance(item.rss, PushSteering)
        or item.rss.pads == "sleeve"
    ):
        return item
    return item.model_copy(update={"rss": item.rss.model_copy(update={"pads": "sleeve"})})
