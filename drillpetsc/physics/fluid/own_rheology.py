"""A flow curve of the user as a table of the wall stress in pipe and slot (manual: eq-mud-own-curve).

The profile of a laminar flow gives the mean speed w under the wall stress T, with the shear rate g at the wall (Rabinowitsch):

    pipe  8 w/D = 4/3 int_0^g (1 - (tau/T)^3) dg,   d ln T/d ln w = 1/(4 g D/(8 w) - 3)
    slot  8 w/d =     int_0^g (1 - (tau/T)^2) dg,   d ln T/d ln w = 1/(2 g d/(8 w) - 2)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.errors import CaseError
from drillpetsc.physics.own_law import OwnLaw

RATES = np.geomspace(1e-4, 1e7, 700)  # at the wall, of the rows [1/s]: beyond them a power law goes on
POINTS, POWER = (
    48,
    4,
)  # of Gauss' rule in s with g = g_wall s^4, which makes the profile of thin shear near the axis smooth

_tables: dict[bytes, FloatArray] = {}  # kernels have addresses of them, so they are kept


@dataclass(frozen=True)
class FlowCurve:
    """law: the user's function; table: its rows for the kernels (kernels/fluid/rheology.hpp, OwnCurve)."""

    law: OwnLaw
    table: FloatArray

    def stress(self, shear_rate: FloatArray) -> FloatArray:
        """Shear stress [Pa] (n,) at shear rates (n,) [1/s]."""
        rate = np.ravel(np.asarray(shear_rate, dtype=float))
        return self.law.evaluate(rate[:, None], False)[:, 0, 0].reshape(np.shape(shear_rate))


def flow_curve(law: OwnLaw) -> FlowCurve:
    """Tabulate the flow curve of the user.  Raises CaseError unless the stress is positive and grows with the shear rate."""
    x, weight = np.polynomial.legendre.leggauss(POINTS)
    s, weight = 0.5 * (x + 1), 0.5 * weight
    share, weight = s**POWER, weight * POWER * s ** (POWER - 1)
    wall = law.evaluate(RATES[:, None], False)[:, 0, 0]
    if not (wall[0] > 0 and (np.diff(wall) > 0).all()):
        k = int(np.argmin(np.diff(wall, prepend=0.0) > 0))
        raise CaseError(
            at=f"{law.kind.key}.function",
            got=f"{law.name} gives {wall[k]:.6g} Pa at {RATES[k]:.6g} 1/s",
            want="a shear stress that is positive and grows with the shear rate",
            longest=300,
        )
    inside = law.evaluate((RATES[:, None] * share).reshape(-1, 1), False)[:, 0, 0].reshape(len(RATES), POINTS)
    part = np.log(np.minimum(inside / wall[:, None], 1.0))
    rows = []
    for factor, power in ((4 / 3, 3), (1.0, 2)):
        nominal = factor * RATES * (-np.expm1(power * part) @ weight)
        slope = 1 / (4 * RATES / nominal - 3) if power == 3 else 1 / (2 * RATES / nominal - 2)
        rows.append(np.column_stack([np.log(nominal), np.log(wall), slope]).ravel())
    table = np.concatenate([[len(RATES)], *rows])
    return FlowCurve(law, _tables.setdefault(table.tobytes(), table))
