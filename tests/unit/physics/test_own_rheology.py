"""Flow curves of the user: wall stresses of the models that they repeat (manual: sec-own-physics)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.errors import CaseError
from drillpetsc.physics.fluid.own_rheology import flow_curve
from drillpetsc.physics.fluid.rheology import Rheology, wall_shear_and_slope
from drillpetsc.physics.own_law import RHEOLOGY, OwnLaw
from tests.helpers.tables import each_row

SPEEDS = np.geomspace(1e-3, 10, 60)
#: consistency, index, yield stress
FLUIDS = [(0.03, 1.0, 0.0), (0.5, 0.6, 0.0), (0.4, 0.65, 6.0), (0.02, 1.0, 8.0)]


def own(stress, consistency: float, index: float) -> Rheology:
    curve = flow_curve(OwnLaw(RHEOLOGY, "mud", stress))
    return Rheology("python", "exact", consistency, index, curve=curve, shear_rate_eps=1e-3)


@each_row(("K", "n", "Y"), FLUIDS)
@each_row("slot", [False, True])
def test_the_wall_stress_is_that_of_the_model(K, n, Y, slot):
    """Stress within 1e-8 and slope within 1e-6, laminar and turbulent."""
    built_in = Rheology("herschel_bulkley", "exact", K, n, Y, shear_rate_eps=1e-3)
    mine = own(lambda s: Y + K * s.shear_rate**n, K, n)
    one, other = (wall_shear_and_slope(law, SPEEDS, 0.1, slot, 1200.0) for law in (built_in, mine))
    assert np.abs(other[0] / one[0] - 1).max() < 1e-8
    assert np.abs(other[1] / one[1] - 1).max() < 1e-6


def test_the_slope_is_the_derivative():
    mine = own(lambda s: 3 + 0.4 * s.shear_rate**0.7, 0.4, 0.7)
    w, h = np.geomspace(0.01, 5, 40), 1e-6
    (low, _), (_, slope), (high, _) = (
        wall_shear_and_slope(mine, w * (1 + k * h), 0.1, True, 1200.0) for k in (-1, 0, 1)
    )
    assert slope == pytest.approx((high - low) / (2 * w * h), rel=1e-5)


def test_beyond_the_table_a_power_law_goes_on():
    mine = own(lambda s: 0.5 * s.shear_rate**0.6, 0.5, 0.6)
    stress, _ = wall_shear_and_slope(mine, [2e7, 4e7], 0.1, False, 0.0)
    assert stress[1] / stress[0] == pytest.approx(2**0.6, rel=1e-6)


@each_row("stress", [lambda s: -s.shear_rate, lambda s: 5 + 0 * s.shear_rate, lambda s: np.sin(s.shear_rate)])
def test_a_stress_that_does_not_grow_is_refused(stress):
    with pytest.raises(CaseError, match="positive and grows"):
        flow_curve(OwnLaw(RHEOLOGY, "mud", stress))
