"""How much weight on bit, slack-off and overpull a string can take: bisection with the soft string.

The soft string (manual: sec-soft-string-bound) takes milliseconds where the stiff one takes seconds, and both agree until
the string buckles, which is where these searches end.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from drillpetsc.analysis.loads.limits.along_string import Surroundings
from drillpetsc.analysis.loads.limits.buckling_loads import Helical
from drillpetsc.analysis.loads.limits.operations import motion_of
from drillpetsc.analysis.statics.equilibrium import MOTIONS
from drillpetsc.analysis.statics.placement import top_depth
from drillpetsc.analysis.statics.start.soft_string import TorqueDrag
from drillpetsc.analysis.statics.start.soft_string_start import soft_string
from drillpetsc.arrays import FloatArray
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.physics.roots import bracketed_root

SMALLEST, ACCURACY = 10.0, 1e-3  # first weight tried [N]; relative accuracy of a search
CRUSHING = 0.01  # share of EA beyond which no search goes


@dataclass(frozen=True)
class Found:
    """Result of a search: the largest load [N], and the measured depth [m] and item of what limits it.

    load: None where nothing limits it before the pipe is crushed.
    """

    load: float | None
    md: float | None
    item: str | None

    def as_dict(self, name: str) -> dict[str, Any]:
        return {name: self.load, "md": self.md, "item": self.item}


class SoftLimits:
    """Searches on one model; the string is where it is, and only the load at its lower end changes."""

    def __init__(self, model: DrillingModel, law: Helical) -> None:
        self.model, self.law, self.hole = model, law, Surroundings(model)
        mesh = model.mesh
        self.element = ~mesh.is_joint
        self.most = CRUSHING * float(mesh.axial_stiffness[self.element].min())
        names = [item.name for item in model.case.string]
        self.names = np.array([names[i] for i in mesh.item])

    @property
    def works(self) -> bool:
        """Whether there is a soft string: a hole with contact, and gravity that points down."""
        return soft_string(self.model, MOTIONS["hoist"], 0.0) is not None

    def run(self, motion: tuple[float, float], wob: float) -> TorqueDrag:
        """The soft string with a weight on bit [N], negative for a pull."""
        found = soft_string(self.model, motion, wob)
        assert found is not None
        return found

    def tension(self, motion: tuple[float, float], wob: float) -> FloatArray:
        """(n, 2) effective tension [N] at the ends of the elements."""
        soft = self.run(motion, wob)
        mesh = self.model.mesh
        depth = np.column_stack([mesh.upper, mesh.lower]) + top_depth(self.model)
        return np.interp(depth, soft.md, soft.axial_force)

    def max_wob(self, operation: str, helical: bool) -> Found:
        """Largest weight on bit before the string buckles, to 0.1 %.

        operation: drilling or sliding. helical: before it coils, else before it buckles sinusoidally.
        """
        motion = motion_of(self.model.case, operation)

        def ratio(wob: float) -> FloatArray:
            tension = self.tension(motion, wob)
            load = self.hole.loads(tension, self.law)[int(helical)]
            with np.errstate(invalid="ignore", divide="ignore"):
                out = -tension / load
            return np.where(self.element[:, None] & np.isfinite(out), out, -np.inf)

        return self._largest(lambda wob: float(ratio(wob).max()) - 1.0, ratio)

    def available_wob(self, operation: str, block: float) -> dict[str, Any]:
        """Largest weight on bit that the string brings down by itself: to 0.1 %, before it coils or must be pushed.

        operation: drilling or sliding; block: weight of the block, which pushes, too [N].
        Returns wob [N], limited_by (hook_load where nothing is left to slack off, helical, or None where neither is reached
        before the pipe is crushed), md [m] and item.
        """
        motion = motion_of(self.model.case, operation)
        coils = self.max_wob(operation, helical=True)
        top = float(self.hole.md.min()), str(self.names[0])
        whole = max(abs(self.run(motion, 0.0).hook_load + block), SMALLEST)

        def excess(wob: float) -> float:
            return -(self.run(motion, wob).hook_load + block) / whole

        nothing = np.zeros((1, 1))
        slack = self._largest(excess, lambda _: nothing).load
        if coils.load is not None and (slack is None or coils.load <= slack):
            return {**coils.as_dict("wob"), "limited_by": "helical"}
        if slack is None:
            return {**Found(None, None, None).as_dict("wob"), "limited_by": None}
        return {**Found(slack, *top).as_dict("wob"), "limited_by": "hook_load"}

    def max_overpull(self, limit: FloatArray, pressure: FloatArray) -> Found:
        """Largest pull at the lower end, beyond the string's own pick-up load, before a tension limit is reached.

        limit: (n, 2) tension limits [N], nan where not known; pressure: (n, 2) wall tension less effective tension [N].
        """

        def ratio(pull: float) -> FloatArray:
            out = (self.tension(MOTIONS["hoist"], -pull) + pressure) / limit
            return np.where(self.element[:, None] & np.isfinite(out), out, -np.inf)

        return self._largest(lambda pull: float(ratio(pull).max()) - 1.0, ratio)

    def place(self, values: FloatArray) -> tuple[float, str]:
        """Measured depth [m] and item of the largest of values (n, 2)."""
        cell, end = np.unravel_index(int(np.argmax(values)), values.shape)
        return float(self.hole.md[cell, end]), str(self.names[cell])

    def _largest(self, excess: Callable[[float], float], ratio: Callable[[float], FloatArray]) -> Found:
        if not np.isfinite(excess(0.0)):
            return Found(None, None, None)
        if excess(0.0) >= 0:
            return Found(0.0, *self.place(ratio(0.0)))
        low, high = 0.0, SMALLEST
        while excess(high) < 0:
            if high >= self.most:
                return Found(None, None, None)
            low, high = high, min(4 * high, self.most)
        load = bracketed_root(excess, low, high, ACCURACY * high, ACCURACY)
        return Found(load, *self.place(ratio(load)))
