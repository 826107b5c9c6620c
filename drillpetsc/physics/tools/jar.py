"""Latch of a jar: when it meters, fires and re-cocks (manual: sec-jar)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.string_mesh import JarLaw

LATCHED, METERING, FREE = 0, 1, 2
TURNED_BACK = 1e-6  # speed against the pull at which metering ends, with it at which the way back ends [m/s]
PUSHED = 1e-3  # push, over the threshold, at which a jar runs back from within its metering stroke [-]


@dataclass
class Jar:
    """State of a jar.

    law: constants; mode: LATCHED, METERING or FREE; side: 1 up (the jar opens), -1 down, of the last pull.
    place: travel at which the latch holds [m]; load: its force there [N, tension positive]; fired: number of shots.
    returning: it is free on its way back to the latch, without having fired: if pulled again, it meters from there.
    """

    law: JarLaw
    mode: int = LATCHED
    side: float = 1.0
    place: float = 0.0
    load: float = 0.0
    fired: int = 0
    returning: bool = False

    def slider(self) -> dict[str, float]:
        """Spring [N/m], damper [N s/m] and preload [N] of the slider in this state."""
        if self.mode == LATCHED:
            return {
                "spring": self.law.latch,
                "damper": 0.0,
                "preload": self.law.latch * self.place - self.load,
            }
        if self.mode == METERING:
            return {"spring": 0.0, "damper": self.law.resistance, "preload": -self.brake}
        return {"spring": 0.0, "damper": 0.0, "preload": 0.0}

    @property
    def brake(self) -> float:
        """Force of the latch while the jar meters, in addition to the metering force [N]."""
        return self.side * self.law.threshold if self.mode == METERING else 0.0

    @property
    def at_latch(self) -> float:
        """Difference in energy [J] between a spring with preload and one that begins at the held position of the latch."""
        held = self.mode == LATCHED
        return (0.5 * self.law.latch * self.place - self.load) * self.place if held else 0.0

    def passed(self, travel: float, speed: float, force: float) -> bool:
        """Whether the state has ended at the present travel [m], speed [m/s] and force [N, tension positive]."""
        first, *others = self.ends(travel, speed, force)
        return max(first, *others) > 0.0 or (first == 0.0 and self.mode != LATCHED)

    def ends(self, travel: float, speed: float, force: float) -> list[float]:
        """How far travel [m], speed [m/s] and force [N, tension positive] are beyond each limit at which the state ends."""
        law, never = self.law, -np.inf
        if self.mode == LATCHED:
            pushed = -self.side * force - PUSHED * law.threshold if self.place != 0.0 else never
            return [
                force - law.threshold if law.up else never,
                -force - law.threshold if law.down else never,
                pushed,
            ]
        if self.mode == METERING:
            return [self.side * travel - law.metering, -self.side * speed - TURNED_BACK]
        return [-self.side * travel, self.side * speed - TURNED_BACK if self.returning else never]

    def switch(self, travel: float, speed: float, force: float) -> None:
        """Change to the next state."""
        law = self.law
        if self.mode == LATCHED:
            pulled = abs(force) > law.threshold
            self.side = float(np.copysign(1.0, force)) if pulled else self.side
            if pulled and law.resistance > 0 and self.side * travel < law.metering:
                self.mode = METERING
            else:
                self.mode, self.fired, self.returning = FREE, self.fired + pulled, not pulled
        elif self.mode == METERING:
            if self.side * travel >= law.metering:
                self.mode, self.fired, self.returning = FREE, self.fired + 1, False
            else:  # the pull has fallen to the latch's force
                self.load = self.side * law.threshold
                self.mode, self.place = LATCHED, travel
        else:
            self.mode, self.load = LATCHED, 0.0
            self.place = travel if self.returning and self.side * travel > 0 else 0.0

    def follow(self, leader: Jar, travel: float) -> None:
        """Change to the state of ``leader``, a jar of which this one differs a little, with one's own latch at the travel [m]."""
        if self.mode == leader.mode:
            return
        self.mode, self.side, self.fired, self.returning = (
            leader.mode,
            leader.side,
            leader.fired,
            leader.returning,
        )
        if self.mode == LATCHED:
            self.load = self.side * self.law.threshold if leader.load else 0.0
            self.place = travel if leader.place else 0.0

    def numbers(self) -> FloatArray:
        """All that changes, for a checkpoint."""
        return np.array(
            [self.mode, self.side, self.place, self.load, self.fired, self.returning], dtype=float
        )

    def set_numbers(self, numbers: FloatArray) -> None:
        """Continue from ``numbers``."""
        self.mode, self.fired, self.returning = int(numbers[0]), int(numbers[4]), bool(numbers[5])
        self.side, self.place, self.load = (float(q) for q in numbers[1:4])
