"""What a hook-load sensor reads: the force in the dead line of the travelling block, which the sheaves' friction changes.

manual: sec-roadmap-sensor
"""

from __future__ import annotations

from dataclasses import dataclass

from drillpetsc.case.blocks.rig import HookloadSensor
from drillpetsc.case.case import Case

#: direction of the block in an operation: 1 hoists, -1 lowers, 0 at rest
DIRECTION = {
    "trip_in": -1,
    "trip_out": 1,
    "rotate_off_bottom": 0,
    "drilling": -1,
    "sliding": -1,
    "backreaming": 1,
}


def weight_over_line(lines: int, efficiency: float, dead_sheave: str) -> tuple[float, float]:
    """Weight on the hook over the force in the dead line, while hoisting and while lowering [-].

    Each sheave passes the share e = ``efficiency`` of the force of the line that pulls it (manual: eq-roadmap-dead-line).
    Hoisting, the force falls from the fast line to the dead line: W/F = (1 - e^n)/((1 - e) e^(n-1)). Lowering, it rises:
    (1 - e^n)/(1 - e). A dead-line sheave that turns adds its loss.
    """
    e, n = efficiency, lines
    lowering = float(n) if e == 1.0 else (1 - e**n) / (1 - e)
    hoisting = lowering / e ** (n - 1)
    return (hoisting / e, lowering * e) if dead_sheave == "turning" else (hoisting, lowering)


@dataclass(frozen=True)
class Sensor:
    """Weight on the hook over the weight that is indicated, while hoisting and while lowering [-]; 1 at the hook."""

    hoisting: float = 1.0
    lowering: float = 1.0

    def factor(self, direction: float) -> float:
        """Weight over reading, 1 at rest, where it is anywhere between lowering and hoisting.

        direction: of the block, positive up.
        """
        return self.hoisting if direction > 0 else self.lowering if direction < 0 else 1.0

    def range(self, direction: float) -> tuple[float, float]:
        """Smallest and largest weight over reading: one value in motion, a band at rest."""
        factor = self.factor(direction)
        return (factor, factor) if direction else (self.lowering, self.hoisting)


def sensor_of(case: Case, efficiency: float | None = None) -> Sensor:
    """The hook-load sensor of the rig; one at the hook if the case names none.

    efficiency: of a sheave, in the place of the case's.
    """
    given: HookloadSensor | None = None if case.rig is None else case.rig.hookload_sensor
    if given is None or given.at == "hook":
        return Sensor()
    efficiency = given.sheave_efficiency if efficiency is None else efficiency
    assert given.lines is not None and efficiency is not None
    hoisting, lowering = weight_over_line(given.lines, efficiency, given.dead_sheave)
    return Sensor(hoisting / given.lines, lowering / given.lines)
