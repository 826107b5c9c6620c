"""Formulas of handbooks for stretch, stuck pipe, collars and overpull, in SI.

Hand calculations with which tests compare the figures of the commands.

Sources: Lapeyrouse, Formulas and Calculations for Drilling, Production and Workover (LAP); drillingformulas.com (DF);
PetroSkills drill string course (PS); Mitchell Engineering, BHA sheet, 1990 (ME); API RP 7G (RP).
"""

from __future__ import annotations

from drillpetsc.case.catalogue.sizes import INCH, LB_PER_FT, LBF

FT = 0.3048  # [m]
STEEL_PPG = 65.5  # density of steel in the trade's buoyancy factor [ppg]
PPG = 0.45359237 / 3.785411784e-3  # [kg/m3]
STRETCH = 735000.0  # 30e6 psi over 3.4 lb/ft per in2, over 12 in/ft (RP)
STUCK = 735294.0  # the same as LAP prints it
FREE_POINT = 2500.0  # LAP: 30e6 psi over 12,000
COLLAR_FACTOR = 1.15  # LAP
CRITICAL_SPEED = 4.76e6  # RP: 60 pi/8 sqrt(E/rho), 30e6 psi and 489.5 lb/ft3 [in rpm]


def buoyancy_factor(density: float, steel: float = STEEL_PPG * PPG) -> float:
    """Buoyancy factor [-], 1 - rho/rho_s (LAP); densities of the mud and of the steel [kg/m3]."""
    return 1 - density / steel


def stretch(length: float, pull: float, weight: float) -> float:
    """Stretch of drill pipe under a pull [m], L T/(735,000 W) in ft, lbf, lb/ft, in (DF, after RP).

    length [m]; pull [N]; weight: of the plain tube per length [kg/m].
    """
    return (length / FT) * (pull / LBF) / (STRETCH * weight / LB_PER_FT) * INCH


def free_length_by_weight(stretch: float, pull: float, weight: float) -> float:
    """Length of free pipe of one size [m], 735,294 e W/F in in, lb/ft, lbf, ft (LAP).

    stretch: under the pull [m]; pull [N]; weight: of the plain tube per length [kg/m].
    """
    return STUCK * (stretch / INCH) * (weight / LB_PER_FT) / (pull / LBF) * FT


def free_point_constant(outer: float, inner: float) -> float:
    """Free point constant, 2500 A with A in in2 (LAP); diameters [m]."""
    return FREE_POINT * 0.25 * 3.141592653589793 * (outer**2 - inner**2) / INCH**2


def free_length_by_constant(stretch: float, pull: float, constant: float) -> float:
    """Length of free pipe [m], e C/F with e in in, F in klbf (LAP); stretch [m]; pull [N]; constant: C."""
    return (stretch / INCH) * constant / (pull / (1e3 * LBF)) * FT


def critical_speed(outer: float, inner: float, length: float) -> float:
    """Rotation at which pipe between two tool joints vibrates laterally [rad/s], 4.76e6/l^2 sqrt(D^2 + d^2) rpm (RP).

    It is the first bending mode of a pinned steel pipe, (pi/l)^2 sqrt(EI/(rho A)); diameters and length [m] (in).
    """
    return (
        CRITICAL_SPEED
        / (length / INCH) ** 2
        * ((outer / INCH) ** 2 + (inner / INCH) ** 2) ** 0.5
        * 0.10471975511965977
    )


def collar_length(
    weight_on_bit: float, weight: float, buoyancy: float, factor: float = COLLAR_FACTOR
) -> float:
    """Length of collars that give a weight on bit [m], WOB f/(W BF) (LAP, PS).

    weight_on_bit [N]; weight: of the collars in air per length [N/m]; buoyancy: factor [-]; factor: reserve [-].
    """
    return weight_on_bit * factor / (weight * buoyancy)


def length_carried(load: float, weight: float, buoyancy: float) -> float:
    """Length of pipe whose weight in mud is a load [m] (PS); load [N]; weight: in air per length [N/m].

    Buoyancy belongs to the weight of the pipe: LAP's formula multiplies the load by it.
    """
    return load / (weight * buoyancy)


def margin_of_overpull(tensile: float, hook_load: float, fraction: float = 0.9) -> tuple[float, float]:
    """Pull that is left above the hook load [N], and the ratio of allowed pull to hook load [-] (DF).

    tensile: pull at yield [N]; fraction: of it that is allowed [-].
    """
    return tensile * fraction - hook_load, tensile * fraction / hook_load
