"""Sections of bore and annulus along the string of a case, their walls, and the losses of its tools (manual: sec-mud-content)."""

from __future__ import annotations

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.items.string import Rigid, Tube
from drillpetsc.case.blocks.items.tubulars import Jointed
from drillpetsc.case.blocks.well import Section
from drillpetsc.case.case import Case
from drillpetsc.case.pipe.section import TubularSection, tubular_section
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.model.item_section import metal_of
from drillpetsc.physics.fluid.channels import AnnulusWalls, Bore
from drillpetsc.physics.fluid.tool_losses import LossTable


def poisson(case: Case, mesh: StringMesh) -> FloatArray:
    """(n,) Poisson's ratio of each element for the narrowing under stretch [-].

    0 for items given by stiffnesses, and for rigid walls.
    """
    if not case.given_fluid.elastic_walls:
        return np.zeros(len(mesh.upper))
    return np.array([_constants(case, number)[1] for number in mesh.item])


def _constants(case: Case, number: int) -> tuple[float, float]:
    """Young's modulus [Pa] and Poisson's ratio [-] of a string item; rigid if given by its stiffnesses."""
    item = case.string[number]
    return (item.material.young, item.material.poisson) if isinstance(item, Tube) else (np.inf, 0.0)


def _rigid_runs(case: Case, mesh: StringMesh) -> tuple[FloatArray, FloatArray]:
    """(n+1, 2) mean bore area and metal area [m2] of the rigid items below each node, and (n+1,) their metal
    volume [m3]."""
    area, volume, length = np.zeros((mesh.nodes, 2)), np.zeros(mesh.nodes), np.zeros(mesh.nodes)
    items = [
        (item, 0.5 * sum(depths))
        for item, depths in zip(case.string, case.item_depths, strict=True)
        if isinstance(item, Rigid)
    ]
    for (item, depth), body in zip(items, mesh.bodies, strict=True):
        bore = item.bore_section
        if bore == 0.0:  # no bore given: the bore of the pipe beside the item
            bore = np.pi / 4 * mesh.inner_diameter[min(body.node, len(mesh.upper) - 1)] ** 2
        metal = metal_of(item, bore, case.well, depth)
        area[body.node] += np.array([bore * body.length, metal])
        volume[body.node] += metal
        length[body.node] += body.length
    area /= np.maximum(length, 1e-300)[:, None]
    return area, volume


def mud_of_rigid_items(case: Case, mesh: StringMesh) -> FloatArray:
    """(n+1,) mass [kg] of the mud in the rigid items below each node, minus the mass of the mud that they displace.

    Below the last node only the metal counts, as in the equations of the bit's flow.
    """
    out = np.zeros(mesh.nodes)
    if case.fluid is None:
        return out
    area, volume = _rigid_runs(case, mesh)
    length = np.zeros(mesh.nodes)
    np.add.at(length, [b.node for b in mesh.bodies], [b.length for b in mesh.bodies])
    inside = area[:, 0] * length
    inside[-1] = 0.0
    if case.has_bore:
        out += inside
    if case.has_annulus:
        out -= inside + volume
    return np.asarray(case.fluid.density * out)


def build_bore(case: Case, mesh: StringMesh) -> Bore:
    """Bore of every element. A thick tube of fixed length widens by (2/E) [1 + nu + 2 (1 - nu^2) Ri^2/(Ro^2 - Ri^2)] (eq-mud-wall-bore)."""
    inner, outer = 0.5 * mesh.inner_diameter, 0.5 * mesh.outer_diameter
    area, wall = mesh.bore_area, np.zeros(len(inner))
    if case.given_fluid.elastic_walls:
        young, nu = np.array([_constants(case, k) for k in mesh.item]).T
        wall = 2 / young * (1 + nu + 2 * (1 - nu**2) * inner**2 / (outer**2 - inner**2))
    runs, _ = _rigid_runs(case, mesh)
    above = np.where(mesh.rigid_above > 0, runs[:-1, 0], area)
    sections = _joint_sections(case)
    tool = tool_losses(case, mesh)
    if not sections:
        return Bore(area, wall, above, tool=tool)
    joints = np.array(
        [
            (sections[k].joint_share, sections[k].joint_bore) if k in sections else (0.0, 2 * r)
            for k, r in zip(mesh.item, inner, strict=True)
        ]
    )
    return Bore(area, wall, above, np.pi * inner**2, joints[:, 0], np.pi / 4 * joints[:, 1] ** 2, tool)


def _joint_sections(case: Case) -> dict[int, TubularSection]:
    """Sections of the items with tool joints, by their number."""
    return {k: tubular_section(item) for k, item in enumerate(case.string) if isinstance(item, Jointed)}


def _tools_with_loss(case: Case, mesh: StringMesh) -> list[tuple[int, np.ndarray, FloatArray]]:
    """(number of the item, its elements of the bore, share of each [-]) of the items with a pressure_loss, from the top down.

    A flexible tool has its loss over its length. The value of a rigid one is in the element below it, or in the last element if
    the tool is the string's end.
    """
    found, bodies = [], iter(mesh.bodies)
    for number, item in enumerate(case.string):
        body = next(bodies) if isinstance(item, Rigid) else None
        if item.pressure_loss is None:
            continue
        if body is not None:
            cells = np.array([min(body.node, len(mesh.upper) - 1)])
        else:
            cells = np.flatnonzero(mesh.item == number)
        length = mesh.length[cells] if body is None else np.ones(1)
        found.append((number, cells, length / length.sum()))
    return found


def tool_losses(case: Case, mesh: StringMesh) -> FloatArray | None:
    """(n,) loss of tools in the string over density and flow rate squared [1/m4], None without such tools."""
    out = np.zeros(len(mesh.upper))
    for number, cells, shares in _tools_with_loss(case, mesh):
        out[cells] += case.string[number].flow_resistance * shares
    return out if out.any() else None


def loss_tables(case: Case, mesh: StringMesh) -> tuple[LossTable, ...]:
    """Losses of the tools with a measured curve."""
    tables = []
    for number, cells, shares in _tools_with_loss(case, mesh):
        loss = case.string[number].pressure_loss
        if loss is not None and loss.curve is not None:
            assert loss.density is not None
            tables.append(LossTable(np.array(loss.curve.table), loss.density, cells, shares))
    return tuple(tables)


def losses_of_items(case: Case, mesh: StringMesh, flow: FloatArray, density: FloatArray) -> dict[int, float]:
    """Pressure loss [Pa] of each item with one, by its number.

    flow, density: (n,) flow rate [m3/s] at the pressure there, towards the bit, and density [kg/m3] in the elements of the bore.
    """
    return {
        number: float(
            sum(
                share * case.string[number].tool_loss(float(flow[c]), float(density[c]))
                for c, share in zip(cells, shares, strict=True)
            )
        )
        for number, cells, shares in _tools_with_loss(case, mesh)
    }


def build_walls(case: Case, mesh: StringMesh) -> AnnulusWalls:
    """Walls of the annulus around the string of a case."""
    assert case.fluid is not None and case.well is not None
    outer, sections = 0.5 * mesh.outer_diameter, case.well.sections
    young, nu = np.array([_constants(case, k) for k in mesh.item]).T
    body = None
    if any(item.annulus_od is not None for item in case.string):
        given = np.array([case.string[k].annulus_od is not None for k in mesh.item])
        body = np.where(given, mesh.outer_area, np.pi * outer**2)
    runs, _ = _rigid_runs(case, mesh)
    above = np.where(mesh.rigid_above > 0, runs[:-1].sum(axis=1), mesh.outer_area)
    joints, share, joint_area = _joint_sections(case), None, None
    if joints:
        share, joint_od = np.array(
            [(joints[k].joint_share, joints[k].joint_od) if k in joints else (0.0, 0.0) for k in mesh.item]
        ).T
        joint_area = np.pi / 4 * joint_od**2
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
        mesh.outer_area,
        share,
        joint_area,
        body,
    )


def _give(section: Section) -> float:
    """Compliance of the rock around a hole section, (1 + nu)/E [1/Pa]; 0 for a rigid wall."""
    rock = section.compliance
    return 0.0 if rock is None else (1 + rock.poisson) / rock.young


def metal_below(case: Case, mesh: StringMesh) -> float:
    """Metal volume of the rigid items below the last node [m3]: mud that the bit displaces."""
    return float(_rigid_runs(case, mesh)[1][-1])
