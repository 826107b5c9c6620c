"""Formulas of hydraulics as handbooks print them, in SI: losses, critical velocities, equivalent densities, surge.

Hand calculations with which tests compare the solver's pressures.

Sources: Lapeyrouse, Formulas and Calculations for Drilling, Production and Workover (LAP); Baker Hughes, Drilling
Fluids Reference Manual, 2006; API RP 13D, third edition, 1995.
"""

from __future__ import annotations

from math import log10, pi

from drillpetsc.analysis.hydraulics.trade_formulas import (
    CP,
    FOOT,
    FOOT_PER_MINUTE,
    GPM,
    INCH,
    LBF_PER_100FT2,
    PPG,
    PSI,
)

API_CRITICAL_REYNOLDS = 2100.0  # RP 13D, 1995
LAP_SURGE_FACTOR = 1.5  # largest over mean speed of the pipe during a stand (LAP)


def bit_pressure_loss(flow: float, density: float, area: float, coefficient: float = 0.95) -> float:
    """Compute the pressure loss of the nozzles [Pa], rho Q^2 / (2 Cd^2 A^2) (Baker Hughes 2006).

    flow: [m3/s]; density: [kg/m3]; area: total flow area [m2]; coefficient: of discharge [-].
    """
    return density * flow * abs(flow) / (2 * coefficient**2 * area**2)


def annular_velocity(flow: float, hole: float, pipe: float) -> float:
    """Compute the mean speed in an annulus [m/s]; flow: [m3/s]; hole, pipe: diameters [m]."""
    return flow / (0.25 * pi * (hole**2 - pipe**2))


def power_law_consistency(r600: float, index: float) -> float:
    """Compute the consistency [Pa s^n]: R600/1022^n in lbf s^n/100 ft2 (LAP); index: [-]."""
    return r600 / 1022.0**index * LBF_PER_100FT2


def herschel_bulkley(r600: float, r300: float, r6: float, r3: float) -> tuple[float, float, float]:
    """Compute yield stress [Pa], index [-] and consistency [Pa s^n] by the rule of API RP 13D.

    tau_y = 2 R3 - R6, n = 3.32 log10((R600 - tau_y)/(R300 - tau_y)), K = (R300 - tau_y)/511^n, in lbf/100 ft2.
    Raises ValueError where the readings do not rise.
    """
    stress = 2 * r3 - r6
    if not r600 > r300 > stress >= 0:
        raise ValueError("want rising readings with R300 above 2 R3 - R6, and that not negative")
    index = 3.32 * log10((r600 - stress) / (r300 - stress))
    return stress * LBF_PER_100FT2, index, (r300 - stress) / 511.0**index * LBF_PER_100FT2


def api_pipe_loss(
    flow: float, diameter: float, length: float, density: float, consistency: float, index: float
) -> float:
    """Compute the loss of a power-law fluid in a pipe [Pa] (API RP 13D, 1995).

    flow: [m3/s]; diameter, length: [m]; density: [kg/m3]; consistency: [Pa s^n]; index: [-].
    """
    speed = flow / (0.25 * pi * diameter**2)
    rate = 8 * speed / diameter
    viscosity = consistency * rate ** (index - 1) * ((3 * index + 1) / (4 * index)) ** index
    return _api_loss(speed, diameter, length, density, viscosity, index, 16.0)


def api_annulus_loss(
    flow: float, hole: float, pipe: float, length: float, density: float, consistency: float, index: float
) -> float:
    """Compute the loss of a power-law fluid in an annulus [Pa] (API RP 13D, 1995).

    flow: [m3/s]; hole, pipe: diameters, length: [m]; density: [kg/m3]; consistency: [Pa s^n]; index: [-].
    """
    gap, speed = hole - pipe, annular_velocity(flow, hole, pipe)
    viscosity = consistency * (12 * speed / gap) ** (index - 1) * ((2 * index + 1) / (3 * index)) ** index
    return _api_loss(speed, gap, length, density, viscosity, index, 24.0)


def _api_loss(
    speed: float, gap: float, length: float, density: float, viscosity: float, index: float, laminar: float
) -> float:
    """Compute 2 f rho v^2 L/d with f = laminar/Re or a/Re^b [Pa].

    gap: hydraulic diameter [m]; viscosity: effective [Pa s]; laminar: friction factor times Reynolds number [-].
    """
    reynolds = density * speed * gap / viscosity
    factor = laminar / reynolds
    if reynolds > API_CRITICAL_REYNOLDS:
        factor = (log10(index) + 3.93) / 50 / reynolds ** ((1.75 - log10(index)) / 7)
    return 2 * factor * density * speed**2 * length / gap


def laminar_annulus_loss(
    speed: float, hole: float, pipe: float, length: float, consistency: float, index: float
) -> float:
    """Compute the loss of laminar power-law flow in an annulus [Pa] (LAP; exact for a slot).

    4 K g^n L/d with g = 12 v/d (2n + 1)/(3n).

    speed: [m/s]; hole, pipe: diameters, length: [m]; consistency: [Pa s^n]; index: [-].
    """
    gap = hole - pipe
    rate = 12 * speed / gap * (2 * index + 1) / (3 * index)
    return 4 * consistency * rate**index * length / gap


def turbulent_annulus_loss(
    flow: float, hole: float, pipe: float, length: float, density: float, viscosity: float
) -> float:
    """Compute the loss of turbulent flow in an annulus [Pa] (LAP).

    7.7e-5 W^0.8 Q^1.8 PV^0.2 L / ((Dh - Dp)^3 (Dh + Dp)^1.8) in psi, ppg, gal/min, cP, ft, in.

    flow: [m3/s]; hole, pipe: diameters, length: [m]; density: [kg/m3]; viscosity: plastic [Pa s].
    """
    top = (density / PPG) ** 0.8 * (flow / GPM) ** 1.8 * (viscosity / CP) ** 0.2 * length / FOOT
    bottom = ((hole - pipe) / INCH) ** 3 * ((hole + pipe) / INCH) ** 1.8
    return 7.7e-5 * top / bottom * PSI


def critical_annular_velocity(
    hole: float, pipe: float, density: float, consistency: float, index: float
) -> float:
    """Compute the speed at which laminar flow in an annulus ends [m/s] (LAP).

    (3.878e4 K/W)^(1/(2-n)) (2.4/(Dh - Dp) (2n + 1)/(3n))^(n/(2-n)) in ft/min, lbf s^n/100 ft2, ppg, in.

    hole, pipe: diameters [m]; density: [kg/m3]; consistency: [Pa s^n]; index: [-].
    """
    n = index
    inertia = 3.878e4 * (consistency / LBF_PER_100FT2) / (density / PPG)
    rate = 2.4 / ((hole - pipe) / INCH) * (2 * n + 1) / (3 * n)
    return inertia ** (1 / (2 - n)) * rate ** (n / (2 - n)) * FOOT_PER_MINUTE


def critical_annular_velocity_by_index(
    hole: float, pipe: float, density: float, consistency: float, index: float
) -> float:
    """Compute the same speed by the other formula of LAP [m/s]; arguments as in `critical_annular_velocity`.

    (81,600 K n^0.387 / ((Dh - Dp)^n W))^(1/(2-n)) in ft/min, lbf s^n/100 ft2, in, ppg.  The two differ by about 10 %.
    """
    n = index
    top = 81600 * (consistency / LBF_PER_100FT2) * n**0.387
    return (top / (((hole - pipe) / INCH) ** n * (density / PPG))) ** (1 / (2 - n)) * FOOT_PER_MINUTE


def equivalent_density(density: float, loss: float, tvd: float, gravity: float = 9.80665) -> float:
    """Compute the density whose column has the weight of the mud and a pressure beside it [kg/m3].

    density: of the mud [kg/m3]; loss: pressure [Pa]; tvd: vertical depth [m]; gravity: [m/s2].
    """
    return density + loss / (gravity * tvd)


def bottom_hole_pressure(density: float, loss: float, tvd: float, gravity: float = 9.80665) -> float:
    """Compute the pressure at the bottom [Pa]: weight of the mud and the loss above; arguments as above."""
    return density * gravity * tvd + loss


def surge_velocity_closed(speed: float, hole: float, pipe: float, clinging: float = 0.45) -> float:
    """Compute the speed of the mud past a closed pipe that enters the frictional loss [m/s] (LAP).

    V (Kc + d^2/(D^2 - d^2)).

    speed: of the pipe [m/s]; hole, pipe: diameters [m]; clinging: constant [-].
    """
    return speed * (clinging + pipe**2 / (hole**2 - pipe**2))


def surge_velocity_open(speed: float, hole: float, pipe: float, bore: float, clinging: float = 0.45) -> float:
    """Compute the same for an open pipe [m/s] (LAP).

    V (Kc + (d^2 - b^2)/(D^2 - d^2 + b^2)).  The displaced mud is shared between bore and annulus by their areas,
    without a balance of friction; the command `surge` solves that balance.

    bore: inner diameter of the pipe [m]; others as in `surge_velocity_closed`.
    """
    return speed * (clinging + (pipe**2 - bore**2) / (hole**2 - pipe**2 + bore**2))
