"""Channels of the drilling fluid: bore and annulus of each element, from string, hole and materials.

A rigid item between two elements is part of the channel of the element below it.  The volume of its metal,
mass over density, is taken from hole and bore, independent of the shape of its blades.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.string import Pipe, Rigid
from drillpetsc.case.case import Case
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.well import Well

_GAUSS = np.polynomial.legendre.leggauss(4)  # exact to degree 7


@dataclass(frozen=True)
class Bore:
    """Bore of the string, all arrays (n,).

    area: [m2]; wall: compliance d(ln area)/dp [1/Pa] (manual: eq-mud-wall-bore).
    area_above: of the rigid item above the element [m2].
    """

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
    """Space between string and hole, all arrays (n,).

    outer, hole: areas of string and hole [m2].
    wall: compliance d(ln area)/dp [1/Pa] (manual: eq-mud-wall-annulus).
    outer_above: area of the rigid item above the element [m2].
    """

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
        """Return the annulus of the elements ``which`` (mask or numbers)."""
        return Annulus(self.outer[which], self.hole[which], self.wall[which], self.outer_above[which])


def poisson(case: Case, mesh: StringMesh) -> FloatArray:
    """Return Poisson's ratio (n,) [-] by which the section narrows under stretch (manual: eq-mud-narrowing).

    It is 0 for items that are given by stiffnesses, and for rigid walls.
    """
    assert case.fluid is not None
    if not case.fluid.elastic_walls:
        return np.zeros(len(mesh.upper))
    return np.array([_constants(case, number)[1] for number in mesh.item])


def _constants(case: Case, number: int) -> tuple[float, float]:
    """Return Young's modulus [Pa] and Poisson's ratio of a string item.

    An item given by stiffnesses has a rigid wall.
    """
    item = case.string[number]
    return (item.material.young, item.material.poisson) if isinstance(item, Pipe) else (np.inf, 0.0)


def _rigid_runs(case: Case, mesh: StringMesh) -> tuple[FloatArray, FloatArray]:
    """Compute (n+1, 2) mean bore and metal area [m2] of the rigid items at each node, and (n+1,) their metal
    volume [m3].
    """
    area, volume, length = np.zeros((mesh.nodes, 2)), np.zeros(mesh.nodes), np.zeros(mesh.nodes)
    items = [item for item in case.string if isinstance(item, Rigid)]
    for item, body in zip(items, mesh.bodies, strict=True):
        density = getattr(item, "material", case.material).density
        bore = np.pi / 4 * (getattr(item, "id", 0.0) or 0.0) ** 2
        if bore == 0.0:  # the case gives no bore: it is taken as wide as that of the pipe beside it
            bore = np.pi / 4 * mesh.inner_diameter[min(body.node, len(mesh.upper) - 1)] ** 2
        area[body.node] += np.array([bore * body.length, body.mass / density])
        volume[body.node] += body.mass / density
        length[body.node] += body.length
    area /= np.maximum(length, 1e-300)[:, None]
    return area, volume


def build_bore(case: Case, mesh: StringMesh) -> Bore:
    """Create the bore of every element (manual: eq-mud-wall-bore).

    Compliance of a thick tube (Lame): (2/E) [(Ro^2 + Ri^2)/(Ro^2 - Ri^2) + nu].
    """
    assert case.fluid is not None
    inner, outer = 0.5 * mesh.inner_diameter, 0.5 * mesh.outer_diameter
    area, wall = np.pi * inner**2, np.zeros(len(inner))
    if case.fluid.elastic_walls:
        young, nu = np.array([_constants(case, k) for k in mesh.item]).T
        wall = 2 / young * ((outer**2 + inner**2) / (outer**2 - inner**2) + nu)
    runs, _ = _rigid_runs(case, mesh)
    return Bore(area, wall, np.where(mesh.rigid_above > 0, runs[:-1, 0], area))


class HoleVolume:
    """Exact volume of a well's hole from measured depth 0 downwards (manual: sec-borehole-volume).

    Between the ends of transitions the radius squared is a polynomial of degree 6.
    """

    def __init__(self, well: Well):
        rows = well.transitions
        self.well, self._at = well, np.unique(np.concatenate([[0.0], rows[:, 0], rows[:, 0] + rows[:, 1]]))
        self._at = self._at[self._at >= 0]
        self._below = np.concatenate([[0.0], np.cumsum(self._piece(self._at[:-1], self._at[1:]))])

    def _piece(self, upper: FloatArray, lower: FloatArray) -> FloatArray:
        middle, half = 0.5 * (upper + lower), 0.5 * (lower - upper)
        return half * (self.area(middle[..., None] + half[..., None] * _GAUSS[0]) @ _GAUSS[1])

    def area(self, md: FloatArray | float) -> FloatArray:
        """Compute the area (...) [m2] at md (...) [m].

        Beyond the ends of the hole it is that of the nearest section.
        """
        return np.pi * np.asarray(self.well.radius(md)) ** 2

    def volume(self, md: FloatArray) -> FloatArray:
        """Compute the volume (...) [m3] between measured depth 0 and md (...) [m]."""
        at = self._at[i := np.maximum(np.searchsorted(self._at, md, side="right") - 1, 0)]
        return self._below[i] + self._piece(at, np.asarray(md, dtype=float))


@dataclass(frozen=True)
class AnnulusWalls:
    """Walls of the annulus: string and rock.

    outer, inner: (n,) radii of the elements [m]; young: (n,) [Pa]; poisson: (n,) [-].
    outer_above: (n,) mean section of the rigid items above the element [m2]; rigid_above: (n,) their length
    [m].
    section_to: (m,) lower end of each hole section [m]; give: (m,) compliance of its rock, (1 + nu)/E [1/Pa].
    elastic: the walls are elastic, else rigid.
    """

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
        """Create the annulus of the elements ``e`` (k,) between measured depths ``upper`` and ``lower`` (k,) [m].

        Compliance (Lame; manual: eq-mud-wall-annulus): 2/(Rw^2 - Ro^2) {Rw^2 (1 + nu_r)/E_r + (Ro^2/E) [(Ro^2
        + Ri^2)/(Ro^2 - Ri^2) - nu]}.  The first term is that of infinite rock; it is left out where a section
        has no compliance (a rigid wall).
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


def build_walls(case: Case, mesh: StringMesh) -> AnnulusWalls:
    """Create the walls of the annulus of the case's string."""
    assert case.fluid is not None and case.well is not None
    outer, sections = 0.5 * mesh.outer_diameter, case.well.sections
    young, nu = np.array([_constants(case, k) for k in mesh.item]).T
    runs, _ = _rigid_runs(case, mesh)
    above = np.where(mesh.rigid_above > 0, runs[:-1].sum(axis=1), np.pi * outer**2)
    return AnnulusWalls(
        outer,
        0.5 * mesh.inner_diameter,
        young,
        nu,
        above,
        mesh.rigid_above,
        np.array([q.to for q in sections]),
        np.array([_give(q) for q in sections]),
        case.fluid.elastic_walls,
    )


def _give(section) -> float:
    rock = getattr(section, "compliance", None)
    return 0.0 if rock is None else (1 + rock.poisson) / rock.young


def metal_below(case: Case, mesh: StringMesh) -> float:
    """Return the volume of the rigid items below the last node [m3], which displace mud at the bit."""
    return float(_rigid_runs(case, mesh)[1][-1])
