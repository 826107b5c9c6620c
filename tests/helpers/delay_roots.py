"""Rightmost roots of the linear delay equation of a bit in the groove of the preceding blade, computed
without the simulator.

m u'' + c u' + (k + K) u = K u(t - tau): a mass on a spring and a damper whose cutting force is K times the
depth of cut u(t) - u(t - tau). Three independent methods: the eigenvalues of the Chebyshev collocation of the
delay operator (Breda, Maset and Vermiglio, "Pseudospectral differencing methods for characteristic roots of
delay differential equations", SIAM J. Sci. Comput. 27(2):482, 2005), Newton's method on the characteristic
function, and the number of its zeros in a rectangle by the argument principle.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Regenerative:
    """mass [kg], damping [N s/m], stiffness [N/m] of the spring, cutting stiffness K [N/m], delay [s]."""

    mass: float
    damping: float
    stiffness: float
    cutting: float
    delay: float

    def characteristic(self, s):
        return (
            self.mass * s**2
            + self.damping * s
            + self.stiffness
            + self.cutting * (1 - np.exp(-s * self.delay))
        )

    def slope(self, s):
        return 2 * self.mass * s + self.damping + self.cutting * self.delay * np.exp(-s * self.delay)

    def roots(self, count: int, points: int = 80) -> np.ndarray:
        """(count,) roots with imaginary part >= 0, the rightmost first [1/s]."""
        guesses = np.linalg.eigvals(self._collocated(points))
        guesses = guesses[
            np.abs(guesses.imag) < points / (2 * self.delay)
        ]  # the larger ones are not resolved
        found: list[complex] = []
        for s in guesses[np.argsort(-guesses.real)]:
            s = self._polished(complex(s.real, abs(s.imag)))
            if not any(abs(s - other) < 1e-6 * (1 + abs(s)) for other in found):
                found.append(s)
            if len(found) == count + 4:  # polishing may change the order
                break
        return np.array(sorted(found, key=lambda s: -s.real)[:count])

    def _collocated(self, n: int) -> np.ndarray:
        """(2(n+1), 2(n+1)) matrix: (u, u') at Chebyshev points of the delay, with transport along the delay
        and the equation of motion at its end."""
        angle = np.pi * np.arange(n + 1) / n
        x = np.cos(angle)  # 1 is now, -1 a delay ago
        weight = np.where((angle == 0) | (np.arange(n + 1) == n), 2.0, 1.0) * (-1.0) ** np.arange(n + 1)
        D = np.outer(weight, 1 / weight) / (x[:, None] - x[None, :] + np.eye(n + 1))
        D -= np.diag(D.sum(axis=1))
        A = np.kron(D * 2 / self.delay, np.eye(2))
        A[:2] = 0.0
        A[0, 1] = 1.0
        A[1, :2] = -(self.stiffness + self.cutting) / self.mass, -self.damping / self.mass
        A[1, -2] = self.cutting / self.mass
        return A

    def _polished(self, s: complex) -> complex:
        for _ in range(50):
            step = self.characteristic(s) / self.slope(s)
            s -= step
            if abs(step) < 1e-13 * (1 + abs(s)):
                break
        return s

    def zeros_within(self, left: float, right: float, top: float, points: int = 40_000) -> float:
        """Number of roots with real part left..right and imaginary part -top..top [1/s], by the argument
        principle."""
        u = np.linspace(0, 1, points)
        sides = [
            left - 1j * top + u * (right - left),
            right - 1j * top + u * 2j * top,
            right + 1j * top - u * (right - left),
            left + 1j * top - u * 2j * top,
        ]
        phase = np.unwrap(np.angle(self.characteristic(np.concatenate(sides))))
        return float((phase[-1] - phase[0]) / (2 * np.pi))

    def bound(self, left: float) -> float:
        """Modulus that no root with real part above ``left`` exceeds [1/s]: m |s|^2 <= c |s| + k + K (1 +
        exp(-left tau))."""
        most = self.stiffness + self.cutting * (1 + np.exp(-min(left, 0.0) * self.delay))
        return float((self.damping + np.sqrt(self.damping**2 + 4 * self.mass * most)) / (2 * self.mass))


def fitted_exponents(samples: np.ndarray, step: float, order: int) -> np.ndarray:
    """Exponents [1/s] of a sum of ``order`` exponentials sampled every ``step`` [s], strongest part of the
    signal (Hua and Sarkar, IEEE Trans. ASSP 38(5):814, 1990)."""
    n = len(samples)
    half = n // 2
    H = np.array([samples[i : i + half] for i in range(n - half + 1)])
    U, S, Vt = np.linalg.svd(H, full_matrices=False)
    V = Vt[:order].T
    z = np.linalg.eigvals(np.linalg.pinv(V[:-1]) @ V[1:])
    return np.log(z.astype(complex)) / step
