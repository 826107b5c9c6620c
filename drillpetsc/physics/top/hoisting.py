"""Hoisting gear and autodriller as plain numbers: drilling line, sheaves, heave of the floor, control loops.

Manual: sec-hoist.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.physics.end_conditions import Input
from drillpetsc.unit_systems import System

#: PI loops of an autodriller, in the order of the kernel
LOOPS = ("wob", "torque", "differential_pressure")


@dataclass(frozen=True)
class Line:
    """Drilling line between drum and dead-line anchor (manual: eq-hoist-stiffness).

    lines: number of lines between crown and block, n; axial_stiffness: EA of the rope [N].
    length: of one of these lines at the start; fast_line, dead_line: of the other two [m].
    damping: between drum and block [N s/m].
    """

    lines: int
    axial_stiffness: float
    length: float
    fast_line: float
    dead_line: float
    damping: float = 0.0

    @property
    def rope(self) -> float:
        """Length of the rope at the start [m]."""
        return self.lines * self.length + self.fast_line + self.dead_line

    @property
    def modulus(self) -> float:
        """Stiffness of the block times length of the rope, n^2 EA [N]."""
        return self.lines**2 * self.axial_stiffness

    @property
    def stiffness(self) -> float:
        """Stiffness against which the block moves at the start [N/m]."""
        return self.modulus / self.rope


def fast_line_efficiency(efficiency: float, lines: int) -> float:
    """Compute e in fast-line tension = load/(n e) while the block is hoisted (manual: eq-hoist-sheaves).

    efficiency: of one sheave [-]; lines: n.
    """
    if efficiency == 1.0:
        return 1.0
    K = 1.0 / efficiency
    return float((K**lines - 1) / (K**lines * lines * (K - 1)))


def dead_line_share(efficiency: float, lines: int, lowering: bool) -> float:
    """Compute dead-line tension over load of the lines while the block moves (manual: eq-hoist-sheaves).

    efficiency: of one sheave [-]; lines: n; lowering: the block moves down, else up.
    """
    if efficiency == 1.0:
        return 1.0 / lines
    K = 1.0 / efficiency
    return float((1 - 1 / K) / (1 - K**-lines) if lowering else (K - 1) / (K**lines - 1))


@dataclass(frozen=True)
class Heave:
    """Upward motion of the rig floor, amplitude(t) sin(2 pi t/period + phase), of which a share reaches the block.

    amplitude: over time [m]; period: [s]; phase: [rad]; compensation: share that is taken away [-].
    """

    amplitude: Input
    period: float
    phase: float = 0.0
    compensation: float = 0.0

    def floor(self, t: float) -> tuple[float, float]:
        """Height of the floor over its mean [m], and its rate [m/s]."""
        w = 2 * np.pi / self.period
        a, rate = self.amplitude.value(t), self.amplitude.rate(t)
        s, c = np.sin(w * t + self.phase), np.cos(w * t + self.phase)
        return float(a * s), float(rate * s + a * w * c)

    def crown(self, t: float) -> tuple[float, float]:
        """Motion of the crown since the start [m] and its rate [m/s], up, as far as they are not compensated."""
        here, rate = self.floor(t)
        share = 1.0 - self.compensation
        return share * (here - self.floor(0.0)[0]), share * rate


@dataclass(frozen=True)
class HeavingSpeed:
    """Downward speed of the top: speed of the drum minus speed of the crown (an ``Input``)."""

    drum: Input
    heave: Heave

    def value(self, t: float) -> float:
        return self.drum.value(t) - self.heave.crown(t)[1]

    def rate(self, t: float) -> float:
        """Its derivative, by central differences."""
        h = 1e-4 * self.heave.period
        return (self.value(t + h) - self.value(t - h)) / (2 * h)

    def integral(self, t: float) -> float:
        return self.drum.integral(t) - self.heave.crown(t)[0]

    def breaks(self) -> tuple[float, ...]:
        return tuple(sorted({*self.drum.breaks(), *self.heave.amplitude.breaks()}))


@dataclass(frozen=True)
class Hoisting:
    """Parts between crown and string.

    mass: of block, hook and top drive [kg]; line: None: the block moves with the drum.
    height: of the block over the floor at the start; crown: of the crown [m].
    lines: n; efficiency: of one sheave [-]; tare: the sensor of the hook load leaves out the block's weight.
    heave: None without; units: of messages.
    """

    mass: float
    line: Line | None
    lines: int
    height: float
    crown: float
    efficiency: float = 1.0
    tare: bool = False
    heave: Heave | None = None
    units: System = "SI"


@dataclass(frozen=True)
class Loop:
    """PI controller of the drum's speed (manual: eq-hoist-loop).

    kind: one of ``LOOPS``; goal: set point over time; p: [m/s per unit]; i: [m/s2 per unit].
    """

    kind: str
    goal: Input
    p: float
    i: float


@dataclass(frozen=True)
class Autodriller:
    """Controller of the drum: of several loops, the one with the lowest speed acts.

    loops: PI loops; rate: set point of the rate of penetration over time [m/s], None: none.
    start: time from which it acts [s]; least, most: speed of the drum [m/s].
    at_bit: the weight is measured at the bit, otherwise at the surface.
    filter: time constant of the measurements; sample: their interval [s], 0: none.
    ramp: rate at which the set point of the weight may change [N/s], 0: any.
    """

    loops: tuple[Loop, ...]
    rate: Input | None
    start: float = 0.0
    least: float = 0.0
    most: float = 1.5
    at_bit: bool = False
    filter: float = 0.0
    sample: float = 0.0
    ramp: float = 0.0
