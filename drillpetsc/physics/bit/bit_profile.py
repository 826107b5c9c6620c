"""The profile of the rock ahead of a blade of a drag bit: its derivative, and the chip that carries a weight.

Manual: eq-bit-profile.
"""

from __future__ import annotations

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.kernels.parameters import constant
from drillpetsc.physics.roots import bracketed_root

CHIPS = int(constant("bit_chips"))  # states of the rock's profile ahead of a blade
RING_DAMPING = (
    4.0  # damping of the profile's shortest wave, times its length; with 3 to 6 no wave grows on a ring
)


def profile_derivative(states: int, length: float) -> FloatArray:
    """Compute the derivative matrix (n, n+1) of a profile at Chebyshev points from 0 to ``length``.

    Manual: eq-bit-profile.

    The points are x_k = (1 - cos(pi k/n)) length/2, k = 0 .. n; the last one is the inflow.  The entries
    follow from the barycentric weights (Trefethen, Spectral Methods in MATLAB, chapter 6).  Chebyshev modes
    above two thirds of n are damped (spectral viscosity, Tadmor 1989).  Off bottom the inflow equals the
    outflow, and on this ring the undamped derivative lets one mode grow by 5e-4 per radian.  With the damping
    no mode grows.  For smooth profiles the derivative is unchanged: polynomials of degree <= 2 n/3 are exact,
    and a sine is within 1e-4 after a quarter turn.

    states: number n of states; length: of the profile [rad].
    """
    k = np.arange(states + 1)
    x = 0.5 * length * (1 - np.cos(np.pi * k / states))
    weight = np.where((k == 0) | (k == states), 2.0, 1.0) * (-1.0) ** k
    difference = x[:, None] - x[None, :] + np.eye(states + 1)
    d = weight[:, None] / weight[None, :] / difference
    d -= np.diag(d.sum(axis=1))
    kept = 2 * states // 3
    modes = np.polynomial.chebyshev.chebvander(2 * x / length - 1, states)
    damping = RING_DAMPING / length * np.clip((k - kept) / (states - kept), 0.0, None) ** 2
    d -= modes @ (damping[:, None] * np.linalg.inv(modes))
    return np.ascontiguousarray(d[:states])


def chip_for(weight: float, cut: float, flat: float, onset: float) -> float:
    """Chip per blade [m] that carries ``weight`` [N]: cut d + flat e(d/onset) with the smooth onset e of
    kernels/bit/bit.hpp.  A sharp bit (``flat`` 0) cuts with all of the weight."""
    if weight <= 0 or flat <= 0:
        return max(weight, 0.0) / cut

    def miss(d: float) -> float:
        u = np.clip(d / onset, 0.0, 1.0)
        return float(cut * d + flat * u * u * (3 - 2 * u) - weight)

    return bracketed_root(miss, 0.0, weight / cut, 0.0)  # to rounding: its derivative is a difference
