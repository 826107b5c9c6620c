"""Geometry of the fluid channels, element by element: bore of the string and annulus.

A rigid item between two elements belongs to the channel of the element below it. Its metal volume, mass over
density, reduces the space in hole and bore, independent of the shape of its blades.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.geometry.well import Well

_GAUSS = np.polynomial.legendre.leggauss(4)  # exact to degree 7


@dataclass(frozen=True)
class Bore:
    """Bore of the string; all (n,) SI: area [m2], wall d(ln area)/dp [1/Pa], area_above of the rigid item
    above the element."""

    area: FloatArray
    wall: FloatArray
    area_above: FloatArray

    @property
    def diameter(self) -> FloatArray:
        return np.sqrt(4 / np.pi * self.area)

    @property
    def diameter_above(self) -> FloatArray:
        return np.sqrt(4 / np.pi * self.area_above)


@dataclass(frozen=True)
class Annulus:
    """Space between string and hole; all (n,) SI: outer and hole areas [m2], wall d(ln area)/dp [1/Pa],
    outer_above of rigid items."""

    outer: FloatArray
    hole: FloatArray
    wall: FloatArray
    outer_above: FloatArray

    @property
    def outer_diameter(self) -> FloatArray:
        return np.sqrt(4 / np.pi * self.outer)

    @property
    def hole_diameter(self) -> FloatArray:
        return np.sqrt(4 / np.pi * self.hole)

    @property
    def gap(self) -> FloatArray:
        """Hydraulic diameter D_w - D_o [m]."""
        return self.hole_diameter - self.outer_diameter

    @property
    def gap_above(self) -> FloatArray:
        return self.hole_diameter - np.sqrt(4 / np.pi * self.outer_above)

    def only(self, which: np.ndarray) -> Annulus:
        """Some of the elements."""
        return Annulus(self.outer[which], self.hole[which], self.wall[which], self.outer_above[which])


class HoleVolume:
    """Volume of a well's hole from measured depth 0 downwards, exact: the radius squared is a polynomial of
    degree 6 between the places where a transition begins or ends."""

    def __init__(self, well: Well):
        rows = well.transitions
        self.well, self._at = well, np.unique(np.concatenate([[0.0], rows[:, 0], rows[:, 0] + rows[:, 1]]))
        self._at = self._at[self._at >= 0]
        self._below = np.concatenate([[0.0], np.cumsum(self._piece(self._at[:-1], self._at[1:]))])

    def _piece(self, upper: FloatArray, lower: FloatArray) -> FloatArray:
        middle, half = 0.5 * (upper + lower), 0.5 * (lower - upper)
        return half * (self.area(middle[..., None] + half[..., None] * _GAUSS[0]) @ _GAUSS[1])

    def area(self, md: FloatArray | float) -> FloatArray:
        """Area [m2] at md (...) [m]; above the rotary table and below the last section that of the section
        next to it."""
        return np.pi * np.asarray(self.well.radius(md)) ** 2

    def volume(self, md: FloatArray) -> FloatArray:
        """Volume [m3] between measured depth 0 and md (...) [m]."""
        at = self._at[i := np.maximum(np.searchsorted(self._at, md, side="right") - 1, 0)]
        return self._below[i] + self._piece(at, np.asarray(md, dtype=float))


@dataclass(frozen=True)
class AnnulusWalls:
    """What bounds the annulus besides the hole's size: outer, inner radius (n,) [m] of the elements, their
    Young's modulus [Pa] and Poisson's ratio, mean section of the string about their upper node (n,) [m2];
    give (m,) [1/Pa] of the rock of each hole section down to section_to (m,) [m]; elastic or rigid."""

    outer: FloatArray
    inner: FloatArray
    young: FloatArray
    poisson: FloatArray
    outer_above: FloatArray
    rigid_above: FloatArray
    section_to: FloatArray
    give: FloatArray
    elastic: bool

    def annulus(self, hole: HoleVolume, e: np.ndarray, upper: FloatArray, lower: FloatArray) -> Annulus:
        """Annulus of the elements ``e`` (k,) with their ends at measured depths ``upper``, ``lower`` (k,)
        [m].

        Elasticity (Lame): 2/(Rw^2 - Ro^2) {Rw^2 (1 + nu_r)/E_r + (Ro^2/E) [(Ro^2 + Ri^2)/(Ro^2 - Ri^2) -
        nu]}; the first term is that of rock without end (left out where a section gives no compliance: a
        rigid wall).
        """
        top, outer, inner, wall = (
            upper - self.rigid_above[e],
            self.outer[e] ** 2,
            self.inner[e] ** 2,
            np.zeros(len(e)),
        )
        area = (hole.volume(lower) - hole.volume(top)) / (lower - top)
        if self.elastic:
            square = area / np.pi
            section = np.minimum(
                np.searchsorted(self.section_to, 0.5 * (upper + lower)), len(self.section_to) - 1
            )
            steel = outer / self.young[e] * ((outer + inner) / (outer - inner) - self.poisson[e])
            wall = 2 / (square - outer) * (square * self.give[section] + steel)
        return Annulus(np.pi * outer, area, wall, self.outer_above[e])
