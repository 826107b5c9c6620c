"""Whether an item of the string fits the hole around it, and the hole that it has passed."""

from __future__ import annotations

from dataclasses import dataclass

from drillpetsc.case.blocks.items.reamer import Reamer
from drillpetsc.case.blocks.items.string import Bit, Item, Rigid
from drillpetsc.case.blocks.well import Well
from drillpetsc.case.checks.reamer import BLADE_OVER_HOLE
from drillpetsc.case.quantities import said
from drillpetsc.unit_systems import System

LENGTH_TOLERANCE = 1e-6  # [m] sums of item lengths


@dataclass(frozen=True)
class Misfit:
    """A section of the hole that is too narrow for an item.

    section: its number; depth: at which the item meets it [m]; outer, hole: diameters of the item and of the section [m].
    key: path of the item's diameter in its block.
    """

    section: int
    kind: str
    depth: float
    outer: float
    hole: float
    key: tuple[str, ...]

    def told(self, name: str, units: System) -> str:
        """The misfit of the item ``name`` in words."""
        outer, hole = (said(v, "diameter", units) for v in (self.outer, self.hole))
        where = f"the {self.kind.replace('_', ' ')} of {hole} at MD {said(self.depth, 'length', units)}"
        return f"{name}, {outer}, does not fit {where}"


def misfit(well: Well, item: Item, above: float, below: float) -> Misfit | None:
    """The first section that a flexible item at these depths does not fit, or that a rigid item could not have passed.

    Stabilizers and bodies pass holes up to 1/16 in narrower, as worn and tight blades do.  A reamer passes with its body.
    above, below: measured depths of the ends of the item [m].
    """
    outer, reach, excess, key = _gauge(item, above)
    if outer is None:
        return None
    top = 0.0
    for n, section in enumerate(well.sections):
        meets = section.to > reach + LENGTH_TOLERANCE and top < below - LENGTH_TOLERANCE
        narrow = outer > section.diameter + excess if excess else outer >= section.diameter
        if meets and narrow:
            return Misfit(n, section.kind, max(top, reach), outer, section.diameter, key)
        top = section.to
    return None


def _gauge(item: Item, above: float) -> tuple[float | None, float, float, tuple[str, ...]]:
    """(diameter that has to fit [m], None: none; depth down to which it is free [m]; tolerated excess [m]; key of the diameter)."""
    if not isinstance(item, Rigid):
        widest = item.widest_od
        return widest, above, 0.0, ("od",) if widest == item.od else ("tool_joint", "od")
    if isinstance(item, Reamer):
        body, key = (item.id, "id") if item.body_od is None else (item.body_od, "body_od")
        return body, 0.0, LENGTH_TOLERANCE, (key,)
    return item.od, 0.0, LENGTH_TOLERANCE if isinstance(item, Bit) else BLADE_OVER_HOLE, ("od",)
