"""The side law of a bit: resistance of the rock beside it, whether its friction may push the bit round the hole, and yielding of the rock.

Kernel: kernels/bit/bit.hpp, cutting_side.cpp.  Manual: sec-bit-side.
"""

from __future__ import annotations

from dataclasses import dataclass

from drillpetsc.fem.component import Field

_OVERGAUGE = "hole.overgauge"


@dataclass(frozen=True)
class Gauge:
    """Gauge of a bit in a hole that yields beside it (manual: eq-bit-overgauge).

    strength: force at which the rock is crushed, N_y [N]; length: of the gauge, l_g [m].
    relaxation: eta, force beyond the strength over the rate at which the rock yields [N s/m].
    """

    strength: float
    length: float
    relaxation: float = 1e6


@dataclass(frozen=True)
class SideLaw:
    """Contact of the bit with the side of its hole.

    stiffness: [N/m], 0: the side does not touch; friction: coefficient [-].
    guided: friction of the side does not push the bit round the hole.
    gauge: of a yielding side; None: the side does not yield.
    """

    stiffness: float
    friction: float
    guided: bool = False
    gauge: Gauge | None = None

    @property
    def kernel(self) -> str:
        """End of the name of the bit's kernels."""
        return "" if self.gauge is None else "_cutting"

    def fields(self, scale: float) -> tuple[Field, ...]:
        """The over-gauge of the hole [m] in excess of new hole, if the side yields."""
        if self.gauge is None:
            return ()
        return (Field(_OVERGAUGE, 1, physics="rock", region="bottom", scale=scale, second_order=False),)

    def slots(self) -> tuple[tuple[str, int], ...]:
        """Its place behind the other unknowns of the bit."""
        return () if self.gauge is None else ((_OVERGAUGE, 0),)

    def parameters(self) -> dict[str, float]:
        """Parameters of the bit's kernels."""
        gauge = self.gauge or Gauge(0.0, 1.0)
        return {
            "side": self.stiffness,
            "wall": self.friction,
            "guided": float(self.guided),
            "strength": gauge.strength,
            "relaxation": gauge.relaxation,
            "gauge": gauge.length,
        }
