"""Figures of nozzles and of dial readings that have a fixed definition in the trade, in SI (jet impact, power per bit area).

The pressures of the commands come from the solver, not from here.

Sources: Lapeyrouse, Formulas and Calculations for Drilling, Production and Workover (LAP); Baker Hughes, Drilling
Fluids Reference Manual, 2006 {cite}`bakerhughes2006`; API RP 13D, third edition, 1995 {cite}`apirp13d`.
"""

from __future__ import annotations

from math import log10, pi

from drillpetsc.units import to_si

FOOT, INCH, FOOT_PER_MINUTE = to_si("1 ft", "m"), to_si("1 in", "m"), to_si("1 ft/min", "m/s")
GPM, PPG, PSI, CP = to_si("1 gpm", "m^3/s"), to_si("1 ppg", "kg/m^3"), to_si("1 psi", "Pa"), 1e-3
LBF_PER_100FT2 = to_si("1 lbf", "N") / (100 * FOOT**2)  # stress of a dial reading as the trade rounds it [Pa]


def jet_velocity(flow: float, area: float) -> float:
    """Compute the mean speed of the jets [m/s], Q/A; flow: [m3/s]; area: total flow area [m2]."""
    return flow / area


def impact_force(flow: float, density: float, area: float) -> float:
    """Compute the impact force of the jets [N], rho Q v with v = Q/A (LAP).

    flow: [m3/s]; density: [kg/m3]; area: total flow area [m2].
    """
    return density * flow**2 / area


def hydraulic_power(pressure: float, flow: float) -> float:
    """Compute the hydraulic power [W] of a pressure [Pa] and a flow [m3/s]."""
    return pressure * flow


def power_per_bit_area(power: float, diameter: float) -> float:
    """Compute the power at the bit over the area of its hole [W/m2] (HSI in hp/in2).

    power: [W]; diameter: of the bit [m].
    """
    return power / (0.25 * pi * diameter**2)


def plastic_viscosity(r600: float, r300: float) -> float:
    """Compute the plastic viscosity [Pa s]: R600 - R300 in cP; readings in dial degrees."""
    return (r600 - r300) * CP


def yield_point(r600: float, r300: float) -> float:
    """Compute the yield point [Pa]: 2 R300 - R600 in lbf/100 ft2; readings in dial degrees."""
    return (2 * r300 - r600) * LBF_PER_100FT2


def power_law_index(r600: float, r300: float) -> float:
    """Compute the flow index [-], 3.32 log10(R600/R300); readings in dial degrees."""
    return 3.32 * log10(r600 / r300)
