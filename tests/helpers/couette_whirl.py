"""Force of a viscous fluid on a cylinder that turns and whirls in a hole: the Navier-Stokes equations linearised about Couette's flow.

Chebyshev collocation along the radius.  Independent of the package.
"""

from __future__ import annotations

import numpy as np

from drillpetsc.arrays import FloatArray


def chebyshev(n: int) -> tuple[FloatArray, FloatArray]:
    """Points (n+1,) from 1 down to -1 and the matrix (n+1, n+1) of the derivative (Trefethen, Spectral Methods in MATLAB, chapter 6)."""
    k = np.arange(n + 1)
    x = np.cos(np.pi * k / n)
    c = np.where((k == 0) | (k == n), 2.0, 1.0) * (-1.0) ** k
    D = np.outer(c, 1 / c) / (x[:, None] - x + np.eye(n + 1))
    return x, D - np.diag(D.sum(axis=1))


def stiffness(
    inner: float, outer: float, viscosity: float, spin: float, whirl: float, n: int = 32
) -> complex:
    """Dynamic stiffness of the fluid over its density, the cylinder's area and spin^2 [-], for a fluid of density 1 kg/m3.

    The axis of the cylinder goes round that of the hole on a small circle, at z = e exp(i whirl t); the force on the cylinder is
    -stiffness z.  With the mode exp(i(theta - whirl t)) the disturbed velocities and pressure u, v, p obey, with Couette's U,

        (-i whirl + i U/r) u - 2 U/r v       = -p'/rho    + nu (lap u - 2 i v/r^2)
        (-i whirl + i U/r) v + (U' + U/r) u  = -i p/rho r + nu (lap v + 2 i u/r^2)
        u' + u/r + i v/r = 0,                  lap = d2/dr2 + 1/r d/dr - 2/r^2

    with u = -i e (whirl - spin), v = e (whirl - U') on the cylinder and zero on the hole.  The pressure of Couette's flow, which the
    displaced cylinder cuts, adds -rho pi inner^2 spin^2 e.

    inner, outer: radii [m]; viscosity: kinematic [m2/s]; spin, whirl: rates [rad/s]; n: points along the radius.
    """
    x, D = chebyshev(n)
    r, D = inner + 0.5 * (outer - inner) * (x + 1), 2 / (outer - inner) * D
    A = spin * inner**2 / (inner**2 - outer**2)
    B = -A * outer**2
    U, slope, R, m = A * r + B / r, A - B / r**2, np.diag(1 / r), n + 1
    inertia = np.diag(1j * (U / r - whirl)) - viscosity * (D @ D + R @ D - 2 * R @ R)
    zero = np.zeros((m, m))
    M = np.block(
        [
            [inertia, -2 * np.diag(U / r) + 2j * viscosity * R @ R, D],
            [np.diag(slope + U / r) - 2j * viscosity * R @ R, inertia, 1j * R],
            [D + R, 1j * R, zero],
        ]
    )
    right = np.zeros(3 * m, dtype=complex)
    for row, value in ((0, 0.0), (n, -1j * (whirl - spin)), (m, 0.0), (m + n, whirl - slope[-1])):
        M[row], M[row, row], right[row] = 0.0, 1.0, value
    u, v, p = np.linalg.lstsq(M, right, rcond=None)[0].reshape(3, m)  # continuity holds twice on the walls
    radial = (-p + 2 * viscosity * (D @ u))[-1]
    around = viscosity * (D @ v - v / r + 1j * u / r)[-1]
    force = np.pi * inner * (np.conj(radial) + 1j * np.conj(around)) - np.pi * inner**2 * spin**2
    return complex(-force / (np.pi * inner**2 * spin**2))
