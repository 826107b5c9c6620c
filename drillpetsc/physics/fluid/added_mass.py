"""Added mass and viscous damping of a string that moves laterally in a fluid-filled annulus.

Manual: sec-mud-added-mass.

The fluid's force per length on a cylinder of diameter D_o that oscillates with the lateral velocity V at the
angular frequency Omega is

    F = -rho A_o (C_m dV/dt + C_d Omega V),   A_o = pi D_o^2/4

Without viscosity C_d = 0 and C_m = chi.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

# S (ratio - 1)^2 below which inertia is left out, since the four functions become nearly dependent there; the
# part of inertia in C_d, measured against the exact solution just above, is below 1e-6
QUASI_STEADY = 1e-3


def chi_confined(outer_diameter: ArrayLike, hole_diameter: ArrayLike) -> Array:
    """Compute added mass over displaced mass (n,) [-] of a concentric cylinder (manual: eq-mud-chi).

    It is (D_w^2 + D_o^2)/(D_w^2 - D_o^2), from potential flow with phi = (A r + B/r) cos(theta); Paidoussis,
    Fluid-Structure Interactions, vol. 2.

    outer_diameter, hole_diameter: (n,) of string and hole [m].
    """
    inner, outer = np.asarray(outer_diameter, dtype=float) ** 2, np.asarray(hole_diameter, dtype=float) ** 2
    return (outer + inner) / (outer - inner)


def chi_eccentric(outer_diameter: float, hole_diameter: float, eccentricity: float) -> float:
    """Compute added mass over displaced mass [-] of an eccentric cylinder (manual: eq-mud-chi-eccentric).

    It is the same along the offset and across it.  Derivation by potential flow in bipolar coordinates (tau,
    sigma), where the circles are tau_1 (string) and tau_2 (hole): x/c = 1 + 2 sum exp(-n tau) cos(n sigma),
    y/c = 2 sum exp(-n tau) sin(n sigma).  The stream function of a motion U along x is U y on the string and
    0 on the hole, psi = 2 c U sum exp(-n tau_1) sinh(n(tau - tau_2))/sinh(n(tau_1 - tau_2)) sin(n sigma).  A
    motion along y has cos(n sigma) instead.  The kinetic energy rho/2 int psi dpsi/dtau dsigma over the
    string gives, with a = c/sinh(tau_1),

        chi = 4 sinh^2(tau_1) sum_n n exp(-2 n tau_1) coth(n(tau_1 - tau_2)).

    outer_diameter, hole_diameter: of string and hole [m].
    eccentricity: offset of the axes over the radial clearance [-], 0 <= e < 1.
    Raises ValueError for other values.
    """
    a, b = 0.5 * outer_diameter, 0.5 * hole_diameter
    if not (0 < a < b and 0 <= eccentricity < 1):
        raise ValueError("chi_eccentric: need 0 < outer_diameter < hole_diameter and 0 <= eccentricity < 1")
    d = eccentricity * (b - a)
    if d < 1e-9 * a:  # chi is even in the eccentricity: the change is below rounding
        return float(chi_confined(outer_diameter, hole_diameter))
    tau_1 = np.arccosh((b * b - a * a - d * d) / (2 * a * d))
    tau_2 = np.arccosh((b * b - a * a + d * d) / (2 * b * d))
    n = np.arange(1, int(np.ceil(20.0 / tau_1)) + 2)
    terms = (
        n * np.exp(-2.0 * (n - 1) * tau_1) / np.tanh(n * (tau_1 - tau_2))
    )  # 4 sinh^2(tau_1) exp(-2 tau_1) = (1 - exp(-2 tau_1))^2
    return float(np.expm1(-2.0 * tau_1) ** 2 * terms.sum())


def stokes_coefficients(stokes_number: ArrayLike, ratio: ArrayLike) -> tuple[Array, Array]:
    """Compute (C_m, C_d) [-] of a cylinder that oscillates with small amplitude in a concentric annulus of
    viscous fluid.

    Manual: eq-mud-stokes, eq-mud-stokes-coefficients.  Exact solution of the unsteady Stokes equations (Chen,
    Wambsganss and Jendrzejczyk, J. Appl. Mech. 43, 1976, 325-329), derived here: lengths in R_o, speeds in
    the cylinder's speed, stream function f(r) sin(theta) exp(i Omega t) with

        f = A/r + B r + C I_1(l r) + D K_1(l r),  l = sqrt(i S);   f(1) = f'(1) = 1, f(ratio) = f'(ratio) = 0.

    The pressure belongs to A and B only, the shear stress at the wall is mu l^2 (C I_1 + D K_1), and together
    C_m - i C_d = 2 A - 1.  With k = 1/ratio the damping is C_d = (2 sqrt(2)/sqrt(S)) (1 + k^3)/(1 - k^2)^2
    within a few per cent if S (1 - k)^2 > 1e4.  For slow motion, S (ratio - 1)^2 < QUASI_STEADY, steady
    Stokes flow has C_d S = 4/(ln(ratio) - (ratio^2 - 1)/(ratio^2 + 1)), and C_m has its value at that limit.

    stokes_number: S = Omega R_o^2/nu [-], above 0; ratio: hole over string diameter [-], above 1; they
    broadcast.
    Raises ValueError for other values.
    """
    S, R = np.broadcast_arrays(np.asarray(stokes_number, dtype=float), np.asarray(ratio, dtype=float))
    if not (np.all(S > 0) and np.all(R > 1)):
        raise ValueError("stokes_coefficients: need stokes_number above 0 and ratio above 1")
    slowest = QUASI_STEADY / (R - 1.0) ** 2
    H = _unsteady(np.sqrt(1j * np.maximum(S, slowest)), R)
    C_m, C_d = H.real, -H.imag
    return C_m, np.where(S < slowest, steady_resistance(R) / S, C_d)


def steady_resistance(ratio: ArrayLike) -> Array:
    """Compute the limit of C_d S (n,) [-] for slow motion, in which the force per length is (C_d S) pi mu V.

    Steady Stokes flow between concentric cylinders, f = A/r + B r + C r ln(r) + D r^3 with the wall
    conditions of `stokes_coefficients`.  The force is the force of the Stokeslet C.

    ratio: (n,) hole over string diameter [-].
    """
    R = np.asarray(ratio, dtype=float)
    return 4.0 / (np.log(R) - (R**2 - 1.0) / (R**2 + 1.0))


def stokes_force(rate: ArrayLike, radius: ArrayLike, viscosity: ArrayLike, ratio: ArrayLike) -> Complex:
    """Compute H (n,) [-] of a cylinder that moves as exp(s t): the fluid's force per length is -rho A_o H s^2 u.

    Manual: eq-mud-stokes-complex.  On the imaginary axis, s = i Omega, H is C_m - i C_d of ``stokes_coefficients``.

    rate: s [1/s] of all or (n,) of each, with Re(sqrt(s)) > 0: not on the negative real axis.
    radius: (n,) R_o [m]; viscosity: (n,) kinematic [m2/s], above 0; ratio: (n,) hole over string diameter [-].
    Raises ValueError for other values.
    """
    R_o, nu, R = np.broadcast_arrays(*(np.asarray(v, dtype=float) for v in (radius, viscosity, ratio)))
    s = np.asarray(rate, dtype=complex)
    if not (np.all(nu > 0) and np.all(R > 1)) or np.any((s.imag == 0) & (s.real <= 0)):
        raise ValueError(
            "stokes_force: need a viscosity above 0, a ratio above 1, and a rate off the negative axis"
        )
    z = s * R_o**2 / nu
    slowest = QUASI_STEADY / (R - 1.0) ** 2
    size = np.maximum(np.abs(z), 1e-300)
    slow = size < slowest
    H = _unsteady(np.sqrt(np.where(slow, z / size * slowest, z)), R)
    if not slow.any():
        return H
    inertia = _unsteady(np.sqrt(1j * slowest), R).real
    return np.asarray(np.where(slow, inertia + steady_resistance(R) / z, H))


def _unsteady(l: Complex, R: Array) -> Complex:
    """Solution 2 A - 1 of the four wall conditions; the Bessel functions are scaled, so that no exponential
    overflows."""
    from scipy.special import ive, kve  # a slow import

    decay = np.exp(l.real * (1.0 - R)) + 0j

    def rows(r: Array, growing: Complex, falling: Complex) -> tuple[list[Complex], list[Complex]]:
        """Compute value and derivative over |l| of the four functions at r.

        The factors undo the scaling of I_1 and K_1.
        """
        z, size = l * r, np.abs(l)
        i1, k1 = ive(1, z), kve(1, z)
        value = [1.0 / r + 0j, r + 0j, i1 * growing, k1 * falling]
        slope = [
            -1.0 / r**2 + 0j,
            1.0 + 0j * r,
            l * (ive(0, z) - i1 / z) * growing,
            -l * (kve(0, z) + k1 / z) * falling,
        ]
        return value, [s / size for s in slope]

    one = np.ones_like(R)
    falling = np.asarray(np.exp(l * (1.0 - R)), dtype=complex)
    whole = np.asarray(one, dtype=complex)
    near, far = rows(one, np.asarray(decay, dtype=complex), whole), rows(R, whole, falling)
    matrix = np.stack([np.stack(row, axis=-1) for row in (near[0], near[1], far[0], far[1])], axis=-2)
    right = np.stack([one + 0j, one / np.abs(l), 0j * one, 0j * one], axis=-1)
    A = np.linalg.solve(matrix, right[..., None])[..., 0, 0]
    return np.asarray(2.0 * A - 1.0)


def lateral_damping(
    outer_diameter: ArrayLike,
    hole_diameter: ArrayLike,
    density: ArrayLike,
    apparent_viscosity: ArrayLike,
    omega: ArrayLike,
) -> Array:
    """Compute the damping force per length and lateral speed, C_d rho A_o Omega [N s/m2].

    Manual: eq-mud-stokes.

    At omega = 0 it is the steady Stokes value, without viscosity zero.  All arguments broadcast.

    outer_diameter, hole_diameter: of string and hole [m].
    density: [kg/m3]; apparent_viscosity: [Pa s].
    omega: frequency or whirl speed of the motion [rad/s].
    """
    D, W, rho, mu, speed = (
        np.asarray(v, dtype=float)
        for v in np.broadcast_arrays(
            outer_diameter, hole_diameter, density, apparent_viscosity, np.abs(omega)
        )
    )
    ratio = W / D
    stokes = np.divide(rho * speed * D**2 / 4.0, mu, out=np.full(D.shape, np.inf), where=mu > 0)
    moving = np.isfinite(stokes) & (stokes > 0)
    C_d = stokes_coefficients(np.where(moving, stokes, 1.0), ratio)[1]
    return np.where(moving, C_d * rho * np.pi * D**2 / 4.0 * speed, steady_resistance(ratio) * np.pi * mu)
