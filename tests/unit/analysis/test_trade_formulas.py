"""Trade formulas of hydraulics against published examples.

The examples are in field units.  LAP: Lapeyrouse, Formulas and Calculations for Drilling, Production and Workover; DF:
drillingformulas.com; BH: Baker Hughes, Drilling Fluids Reference Manual (2006).
"""

from __future__ import annotations

import pytest

from drillpetsc.analysis.hydraulics import trade_formulas as trade
from drillpetsc.analysis.hydraulics.trade_formulas import (
    FOOT,
    FOOT_PER_MINUTE,
    GPM,
    INCH,
    LBF_PER_100FT2,
    PPG,
    PSI,
)
from drillpetsc.case.files.mud_report import api_annulus, by_rules
from drillpetsc.units import to_si
from tests.helpers import handbook_hydraulics as handbook
from tests.helpers.tables import each_row

HP, LBF = 745.69987, to_si("1 lbf", "N")
THREE_TWELVES = 3 * 0.25 * 3.141592653589793 * (12 / 32 * INCH) ** 2


def test_bit_with_three_nozzles():
    """400 gpm of 12 ppg through 3 x 12/32 in, Cd 0.95, 8 1/2 in bit (formulas of BH)."""
    flow, density = 400 * GPM, 12 * PPG
    loss = handbook.bit_pressure_loss(flow, density, THREE_TWELVES)
    power = trade.hydraulic_power(loss, flow)
    assert loss / PSI == pytest.approx(1610.3, rel=1e-3)
    assert power / HP == pytest.approx(375.8, rel=1e-3)
    assert trade.power_per_bit_area(power, 8.5 * INCH) / (HP / INCH**2) == pytest.approx(6.62, rel=1e-3)
    assert trade.jet_velocity(flow, THREE_TWELVES) / FOOT == pytest.approx(387.3, rel=1e-3)
    assert trade.impact_force(flow, density, THREE_TWELVES) / LBF == pytest.approx(963.0, rel=1e-3)


def test_bit_hydraulics_of_lapeyrouse():
    """520 gpm of 12 ppg, 3 x 12/32, 3000 psi, 12 1/4 in hole, 5 in pipe (LAP).

    LAP's jet velocity 417.2 Q/(sum of N^2) has a constant 0.26 % below the exact 418.3; the force contains it.
    """
    flow, density = 520 * GPM, 12 * PPG
    loss = handbook.bit_pressure_loss(flow, density, THREE_TWELVES)
    power = trade.hydraulic_power(loss, flow)
    assert loss / PSI == pytest.approx(2721.0, rel=2e-3)
    assert loss / (3000 * PSI) == pytest.approx(0.907, rel=2e-3)
    assert trade.jet_velocity(flow, THREE_TWELVES) / FOOT == pytest.approx(502.2, rel=3e-3)
    assert trade.impact_force(flow, density, THREE_TWELVES) / LBF == pytest.approx(1624.0, rel=3e-3)
    assert trade.power_per_bit_area(power, 12.25 * INCH) / (HP / INCH**2) == pytest.approx(6.99, rel=2e-3)
    assert trade.hydraulic_power(3000 * PSI, flow) / HP == pytest.approx(910.0, rel=2e-3)
    speed = handbook.annular_velocity(flow, 12.25 * INCH, 5 * INCH)
    assert speed / FOOT_PER_MINUTE == pytest.approx(101.9, rel=2e-3)


def test_power_law_losses_by_api():
    """12.8 ppg, dial 53/34/21/8, 335 gpm; an example worked by the rules of RP 13D (1995), surface line of case 3."""
    dial = {"600": 53.0, "300": 34.0, "100": 21.0, "3": 8.0}
    in_pipe, around = by_rules("power_law", dial), api_annulus(dial)
    assert in_pipe == pytest.approx((0.3209, 0.640), rel=5e-3)  # 3.209 dyn s^n/cm2
    assert around == pytest.approx((2.609, 0.2754), rel=5e-3)
    flow, density = 335 * GPM, 12.8 * PPG
    for length, bore, loss in ((11641, 3.826, 792.8), (390, 2.25, 277.9), (610, 3.826, 41.5)):
        found = handbook.api_pipe_loss(flow, bore * INCH, length * FOOT, density, *in_pipe)
        assert found / PSI == pytest.approx(loss, rel=5e-3)
    for length, hole, pipe, loss in (
        (390, 8.625, 7.0, 16.7),
        (855, 8.625, 4.5, 15.4),
        (10786, 8.835, 4.5, 178.6),
    ):
        found = handbook.api_annulus_loss(flow, hole * INCH, pipe * INCH, length * FOOT, density, *around)
        assert found / PSI == pytest.approx(loss, rel=5e-3)


def test_annular_velocity():
    """200 gpm in 6.2 x 4 in and 320 gpm in 6.5 x 4 in (DF)."""
    for flow, hole, speed in ((200, 6.2, 218.4), (320, 6.5, 298.7)):
        found = handbook.annular_velocity(flow * GPM, hole * INCH, 4 * INCH)
        assert found / FOOT_PER_MINUTE == pytest.approx(speed, rel=1e-3)


@each_row(
    ("r600", "r300", "viscosity", "stress", "index"),
    [(60, 40, 20, 20, 0.585), (40, 25, 15, 10, 0.678), (53, 34, 19, 15, 0.640), (140, 80, 60, 20, 0.807)],
)
def test_dial_readings(r600, r300, viscosity, stress, index):
    """Plastic viscosity [cP], yield point [lbf/100 ft2] and index of two readings (DF, LAP)."""
    assert trade.plastic_viscosity(r600, r300) == pytest.approx(1e-3 * viscosity)
    assert trade.yield_point(r600, r300) / LBF_PER_100FT2 == pytest.approx(stress)
    assert trade.power_law_index(r600, r300) == pytest.approx(index, rel=2e-3)


def test_herschel_bulkley_by_api():
    """Readings 65/45/9/8 at 600/300/6/3 rpm (rule of RP 13D)."""
    stress, index, consistency = handbook.herschel_bulkley(65, 45, 9, 8)
    assert stress / LBF_PER_100FT2 == pytest.approx(7.0)
    assert index == pytest.approx(0.6097, rel=1e-3)
    assert consistency / LBF_PER_100FT2 == pytest.approx(0.8481, rel=1e-3)


@each_row("readings", [(45, 65, 9, 8), (65, 45, 9, 4), (10, 8, 1, 8)])
def test_readings_that_do_not_rise_are_refused(readings):
    with pytest.raises(ValueError, match="rising"):
        handbook.herschel_bulkley(*readings)


def test_critical_velocity_of_lapeyrouse():
    """14 ppg, dial 64/37, 8 1/2 x 7 in (LAP): index, consistency, critical velocity and flow."""
    index = trade.power_law_index(64, 37)
    consistency = handbook.power_law_consistency(64, index)
    assert index == pytest.approx(0.790, rel=2e-3)
    assert consistency / LBF_PER_100FT2 == pytest.approx(0.2682, rel=2e-3)
    speed = handbook.critical_annular_velocity_by_index(8.5 * INCH, 7 * INCH, 14 * PPG, consistency, index)
    area = 0.25 * 3.141592653589793 * (8.5**2 - 7**2) * INCH**2
    assert speed / FOOT_PER_MINUTE == pytest.approx(310.6, rel=2e-3)
    assert speed * area / GPM == pytest.approx(294.7, rel=2e-3)


def test_annulus_losses_and_equivalent_density():
    """9.5 ppg, dial 60/40, 650 gpm, 8 1/2 in hole, 10,000 ft of 5 in and 600 ft of 6 3/4 in, TVD 9,000 ft (DF)."""
    flow, density, hole = 650 * GPM, 9.5 * PPG, 8.5 * INCH
    index = trade.power_law_index(60, 40)
    consistency = handbook.power_law_consistency(60, index)
    speeds = [handbook.annular_velocity(flow, hole, od * INCH) for od in (5.0, 6.75)]
    limits = [
        handbook.critical_annular_velocity(hole, od * INCH, density, consistency, index) for od in (5.0, 6.75)
    ]
    assert [v / FOOT_PER_MINUTE for v in speeds] == pytest.approx([337.0, 596.7], rel=2e-3)
    assert [v / FOOT_PER_MINUTE for v in limits] == pytest.approx([342.6, 456.2], rel=2e-3)
    pipe = handbook.laminar_annulus_loss(speeds[0], hole, 5 * INCH, 10000 * FOOT, consistency, index)
    collars = handbook.turbulent_annulus_loss(
        flow, hole, 6.75 * INCH, 600 * FOOT, density, trade.plastic_viscosity(60, 40)
    )
    assert [pipe / PSI, collars / PSI] == pytest.approx([271.3, 81.5], rel=2e-3)
    ecd = handbook.equivalent_density(density, pipe + collars, 9000 * FOOT)
    assert ecd / PPG == pytest.approx(10.25, rel=2e-3)


def test_bottom_hole_pressure():
    """12.7 ppg at 10,000 ft with 50 psi of annulus loss (DF); 520 psi at 3,195.5 ft on 9 ppg; 3,500 psi x 800 gpm."""
    assert handbook.bottom_hole_pressure(12.7 * PPG, 50 * PSI, 10000 * FOOT) / PSI == pytest.approx(
        6654, rel=1e-3
    )
    assert handbook.equivalent_density(12.7 * PPG, 50 * PSI, 10000 * FOOT) / PPG == pytest.approx(
        12.80, rel=1e-3
    )
    assert handbook.equivalent_density(9 * PPG, 520 * PSI, 3195.5 * FOOT) / PPG == pytest.approx(
        12.13, rel=1e-3
    )
    assert trade.hydraulic_power(3500 * PSI, 800 * GPM) / HP == pytest.approx(1633.6, rel=1e-3)


def test_surge_of_lapeyrouse():
    """15 ppg, dial 140/80, 7 7/8 in hole, 14,300 ft of 4 1/2 x 3.82 in at 270 ft/min, closed and open (LAP)."""
    hole, pipe, bore, speed = 7.875 * INCH, 4.5 * INCH, 3.82 * INCH, 270 * FOOT_PER_MINUTE
    index = trade.power_law_index(140, 80)
    consistency = handbook.power_law_consistency(140, index)
    closed = handbook.surge_velocity_closed(speed, hole, pipe)
    opened = handbook.surge_velocity_open(speed, hole, pipe, bore)
    assert closed / FOOT_PER_MINUTE == pytest.approx(252.4, rel=2e-3)
    assert opened / FOOT_PER_MINUTE == pytest.approx(148.6, rel=2e-3)
    for mean, pressure in ((closed, 716.8), (opened, 467.5)):
        found = handbook.laminar_annulus_loss(
            handbook.LAP_SURGE_FACTOR * mean, hole, pipe, 14300 * FOOT, consistency, index
        )
        assert found / PSI == pytest.approx(pressure, rel=2e-3)
