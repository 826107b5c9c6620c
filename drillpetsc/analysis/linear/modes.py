"""Modes of a string about a state (manual: eq-eigen-figures)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.solvers.linear.quadratic_eigenproblem import damping_ratio, growing

#: kinds of modes; each has a share of the energy, in this order in modes.csv
KINDS = ("lateral", "axial", "torsional", "fluid")


@dataclass(frozen=True)
class Modes:
    """Modes exp(s t), s = growth + i 2 pi frequency, sorted by frequency (manual: eq-eigen-figures).

    Real eigenvalues (frequency 0) are first, of them the fastest growing.

    eigenvalue: (m,) s [1/s].
    share: (m, 4) fractions of the mode's energy in the columns of ``KINDS`` [-].
    error: (m,) backward errors of the eigenvalues [-].
    shapes: by field, (m, nodes, size) complex; the largest displacement is 1 m, or spin angle 1 rad, or
    pressure 1 bar, and real.
    imbalance: largest unbalanced force on a node in the state [N].
    zero: eigenvalues of this size or smaller count as zero [1/s].
    lowering [m/s], rotation [rad/s]: of the state.
    stokes_number: (m,) [-], with ``added_mass: stokes``; kept: number of modes that then use the mud's force at the
    reference frequency, because their own frequency was not found.
    """

    eigenvalue: np.ndarray
    share: FloatArray
    error: FloatArray
    shapes: dict[str, np.ndarray]
    imbalance: float
    zero: float
    lowering: float
    rotation: float
    stokes_number: FloatArray | None = None
    kept: int = 0

    @property
    def frequency(self) -> FloatArray:
        """(m,) [Hz]."""
        return self.eigenvalue.imag / (2 * np.pi)

    @property
    def growth(self) -> FloatArray:
        """(m,) [1/s]."""
        return self.eigenvalue.real

    @property
    def damping_ratio(self) -> FloatArray:
        """(m,) -growth/|s| [-], nan at zero."""
        return damping_ratio(self.eigenvalue)

    @property
    def kind(self) -> tuple[str, ...]:
        """(m,) the kind with the largest share."""
        return tuple(KINDS[i] for i in self.share.argmax(axis=1))

    @property
    def count(self) -> int:
        """Number of modes."""
        return len(self.eigenvalue)

    @property
    def margin(self) -> float:
        """Largest growth [1/s]; negative if all computed modes decay."""
        return float(self.growth.max(initial=-np.inf))

    @property
    def grows(self) -> np.ndarray:
        """(k,) whether a mode grows."""
        return growing(self.eigenvalue, self.zero)

    @property
    def diverging(self) -> int:
        """Number of modes that grow without oscillation."""
        return int((self.grows & (self.frequency == 0)).sum())

    @property
    def fluttering(self) -> int:
        """Number of modes that grow with oscillation."""
        return int((self.grows & (self.frequency > 0)).sum())

    @property
    def unstable(self) -> int:
        """Number of modes that grow."""
        return self.diverging + self.fluttering

    @property
    def zeros(self) -> int:
        """Number of eigenvalues that are zero: unconstrained motions, or a load at which the string just buckles."""
        return int((np.abs(self.eigenvalue) <= self.zero).sum())

    @property
    def smallest(self) -> float:
        """Smallest |s| [rad/s]."""
        return float(np.abs(self.eigenvalue).min(initial=np.inf))
