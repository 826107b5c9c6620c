"""The channels of the drilling fluid: bore of the string and annulus, element by element, from string, hole and materials.

A rigid item between two elements is part of the channel of the element below it; its metal, mass over density, is what it takes
from hole and bore, whatever the shape of its blades.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.case.items import Pipe, Rigid
from drillpetsc.case.scene import Case
from drillpetsc.field import FloatArray
from drillpetsc.tubulars import StringMesh
from drillpetsc.well import Well

SAMPLES = (np.arange(16) + 0.5) / 16  # places in an element at which the hole's size is looked up


@dataclass(frozen=True)
class Bore:
    """Bore of the string; all (n,) SI: area [m2], wall d(ln area)/dp [1/Pa], area_above of the rigid item above the element."""

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
    """Space between string and hole; all (n,) SI: outer and hole areas [m2], wall d(ln area)/dp [1/Pa], outer_above of rigid items."""

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


def poisson(case: Case, mesh: StringMesh) -> FloatArray:
    """(n,) Poisson's ratio by which the section narrows under stretch; 0 for pieces given by stiffnesses, and for rigid walls."""
    assert case.fluid is not None
    if not case.fluid.elastic_walls:
        return np.zeros(len(mesh.upper))
    return np.array([_constants(case, number)[1] for number in mesh.item])


def _constants(case: Case, number: int) -> tuple[float, float]:
    """Young's modulus [Pa] and Poisson's ratio of a string item; a piece given by its stiffnesses has a rigid wall."""
    item = case.string[number]
    return (item.material.young, item.material.poisson) if isinstance(item, Pipe) else (np.inf, 0.0)


def _rigid_runs(case: Case, mesh: StringMesh) -> tuple[FloatArray, FloatArray]:
    """(n+1, 2) mean bore area and metal area [m2] of the rigid items that hang on each node, and (n+1,) their metal volume [m3]."""
    area, volume, length = np.zeros((mesh.nodes, 2)), np.zeros(mesh.nodes), np.zeros(mesh.nodes)
    items = [item for item in case.string if isinstance(item, Rigid)]
    for item, body in zip(items, mesh.bodies, strict=True):
        density = getattr(item, "material", case.material).density
        bore = np.pi / 4 * (getattr(item, "id", 0.0) or 0.0) ** 2
        if bore == 0.0:  # solid as far as the case tells: what flows through is as wide as in the pipe beside it
            bore = np.pi / 4 * mesh.inner_diameter[min(body.node, len(mesh.upper) - 1)] ** 2
        area[body.node] += np.array([bore * body.length, body.mass / density])
        volume[body.node] += body.mass / density
        length[body.node] += body.length
    area /= np.maximum(length, 1e-300)[:, None]
    return area, volume


def build_bore(case: Case, mesh: StringMesh) -> Bore:
    """Bore of every element. Elasticity of a thick tube (Lame): (2/E) [(Ro^2 + Ri^2)/(Ro^2 - Ri^2) + nu]."""
    assert case.fluid is not None
    inner, outer = 0.5 * mesh.inner_diameter, 0.5 * mesh.outer_diameter
    area, wall = np.pi * inner**2, np.zeros(len(inner))
    if case.fluid.elastic_walls:
        young, nu = np.array([_constants(case, k) for k in mesh.item]).T
        wall = 2 / young * ((outer**2 + inner**2) / (outer**2 - inner**2) + nu)
    runs, _ = _rigid_runs(case, mesh)
    return Bore(area, wall, np.where(mesh.rigid_above > 0, runs[:-1, 0], area))


def build_annulus(case: Case, mesh: StringMesh, well: Well, shift: float = 0.0) -> Annulus:
    """Annulus of every element, with the string ``shift`` [m] lower than at the start.

    Elasticity (Lame): 2/(Rw^2 - Ro^2) {Rw^2 (1 + nu_r)/E_r + (Ro^2/E) [(Ro^2 + Ri^2)/(Ro^2 - Ri^2) - nu]}; the first term is that of
    rock without end (left out where a section gives no compliance: a rigid wall).
    """
    assert case.fluid is not None and case.well is not None
    inner, outer = 0.5 * mesh.inner_diameter, 0.5 * mesh.outer_diameter
    depth = mesh.upper[:, None] + shift + SAMPLES * mesh.length[:, None]
    radius = np.sqrt(np.mean(np.asarray(well.radius(np.clip(depth, 0.0, well.depth))) ** 2, axis=1))
    rock, wall = np.zeros(len(outer)), np.zeros(len(outer))
    if case.fluid.elastic_walls:
        young, nu = np.array([_constants(case, k) for k in mesh.item]).T
        ends = np.array([q.to for q in case.well.sections])
        give = np.array([_give(q) for q in case.well.sections])
        rock = radius**2 * give[np.minimum(np.searchsorted(ends, depth.mean(axis=1)), len(ends) - 1)]
        wall = 2 / (radius**2 - outer**2) * (rock + outer**2 / young * ((outer**2 + inner**2) / (outer**2 - inner**2) - nu))
    runs, _ = _rigid_runs(case, mesh)
    area = np.pi * outer**2
    return Annulus(area, np.pi * radius**2, wall, np.where(mesh.rigid_above > 0, runs[:-1].sum(axis=1), area))


def _give(section) -> float:
    rock = getattr(section, "compliance", None)
    return 0.0 if rock is None else (1 + rock.poisson) / rock.young


def metal_below(case: Case, mesh: StringMesh) -> float:
    """Volume of the rigid items below the last node [m3]: mud that a bit displaces."""
    return float(_rigid_runs(case, mesh)[1][-1])
