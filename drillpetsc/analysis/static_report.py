"""What a static state comes to: the table along the string (statics.csv) and the figures of its summary."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from drillpetsc.analysis.equilibrium import StaticState
from drillpetsc.fem.component import FloatArray
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output.bending import curvatures
from drillpetsc.output.flow_recorder import FlowRecorder
from drillpetsc.output.recorder import Recorder
from drillpetsc.physics.beam import REPORT

COLUMNS: list[tuple[str, str]] = [
    ("md", "m"),
    ("axial_force", "N"),
    ("torque", "N m"),
    ("contact_force", "N/m"),
    ("bending_moment", "N m"),
    ("inclination", "deg"),
    ("offset_x", "m"),
    ("offset_y", "m"),
    ("curvature", "1/m"),
    ("bending_stress", "Pa"),
    ("buckling_load", "N"),
    ("buckling_ratio", "-"),
]


def static_table(model: DrillingModel, state: StaticState) -> tuple[list[tuple[str, str]], FloatArray | None]:
    """Columns (name, unit) and the values (n_nodes, columns) at the nodes on rank 0 (None elsewhere), for the
    model's present state.

    axial_force: compression negative, torque: positive as the drive turns clockwise; both, bending and
    contact are the mean of the elements that meet at a node.  buckling_load: 2 sqrt(EI q/r) of Dawson and
    Paslay (SPE 11167), with the side load q = |w_perp + T kappa| of the string in the hole and the radial
    clearance r (not a number where q or r is zero), T and w being effective tension and buoyed weight where
    there is mud; buckling_ratio: compression over it.
    """
    system, scene_mesh = model.system, model.mesh
    asm = system.assembly
    fluid_columns, fluid = flow_table(model)
    if model.beam is None:
        return [("md", "m"), *fluid_columns], None if fluid is None else np.column_stack(
            [scene_mesh.node_depth, fluid]
        )
    cells = model.beam.report(system.layout, asm.x, asm.y)
    if model.fluid is not None:
        cells[:, [REPORT.index("axial_upper"), REPORT.index("axial_lower")]] += FlowRecorder(
            system, model.fluid
        ).wall_tension()
    contact = model.contact.report(asm)[0][:, :1] if model.contact is not None else np.zeros((len(cells), 1))
    bend = np.linalg.norm(curvatures(model), axis=3).reshape(len(cells), 4)
    nodal = system.gather(np.hstack([system.field("string.position"), system.field("string.tangent")]))
    cell = system.gather(
        np.hstack([cells, contact / scene_mesh.divisor[system.chain.cells][:, None], bend]), "cell"
    )
    if nodal is None or cell is None:
        return COLUMNS + fluid_columns, None
    table = _table(model, nodal, cell, None if fluid is None else fluid[:, -1])
    if fluid is not None:
        fluid[:, -1] += table[:, 1]  # what the pressures leave of the wall's tension
        table = np.hstack([table, fluid])
    return COLUMNS + fluid_columns, table


def flow_table(model: DrillingModel) -> tuple[list[tuple[str, str]], FloatArray | None]:
    """Columns of the drilling fluid and their values (n_nodes, columns) on rank 0: pressures and flow rates
    of the channels, equivalent circulating density p/(g depth) where there is an annulus, and last, with a
    string, what effective tension has beyond the axial force, -p_i A_i + p_o A_o [N] (areas the mean of the
    elements that meet at a node)."""
    if model.fluid is None:
        return [], None
    record, mesh, system = FlowRecorder(model.system, model.fluid), model.mesh, model.system
    nodal, cell = record.nodal(), {k: v for k, v in record.cellwise().items() if "flow" in k}
    columns = [_name_unit(k) for k in (*nodal, *cell)]
    if model.fluid.annulus is not None:
        columns.append(("ecd", "kg/m3"))
    if model.beam is not None:
        columns.append(("effective_tension", "N"))
    at_vertices = system.gather(np.column_stack(list(nodal.values())))
    in_cells = system.gather(np.column_stack(list(cell.values())), "cell")
    if at_vertices is None or in_cells is None:
        return columns, None
    out = [*at_vertices.T, *(_at_nodes(c, c) for c in in_cells.T)]
    if model.fluid.annulus is not None:
        head = (model.position - model.position[0]) @ model.fluid.constants.gravity
        pressure = at_vertices[:, list(nodal).index("annulus_pressure [Pa]")]
        out.append(np.divide(pressure, head, out=np.full(mesh.nodes, np.nan), where=head > 0))
    if model.beam is not None:
        beyond = np.zeros(mesh.nodes)
        for component, title, sign in (
            ("bore", "internal_pressure [Pa]", -1.0),
            ("annulus", "annulus_pressure [Pa]", 1.0),
        ):
            channel = getattr(model.fluid, component)
            if channel is not None:
                area = channel.bore.area if component == "bore" else channel.annulus.outer
                beyond += sign * at_vertices[:, list(nodal).index(title)] * _at_nodes(area, area)
        out.append(beyond)
    return columns, np.column_stack(out)


def _name_unit(title: str) -> tuple[str, str]:
    name, unit = title.rstrip("]").split(" [")
    return name, unit


def _table(
    model: DrillingModel, nodal: FloatArray, cell: FloatArray, beyond: FloatArray | None = None
) -> FloatArray:
    at_nodes = partial(_at_nodes, element=~model.mesh.is_joint)
    mesh, column = model.mesh, {name: i for i, name in enumerate(REPORT)}
    n = len(REPORT)
    t = nodal[:, 3:] / np.linalg.norm(nodal[:, 3:], axis=1, keepdims=True)
    offset = Recorder(model).offset(nodal[:, :3], mesh.node_depth)
    stiffness, radius = mesh.bending_stiffness, 0.5 * mesh.outer_diameter
    inertia = np.pi / 64 * (mesh.outer_diameter**4 - mesh.inner_diameter**4)
    by_moment = np.divide(radius, inertia, out=np.zeros_like(radius), where=inertia > 0)  # stress per moment
    axial = at_nodes(cell[:, column["axial_upper"]], cell[:, column["axial_lower"]])
    effective = axial if beyond is None else axial + beyond  # it is effective tension that buckles
    load = _buckling_load(model, effective)
    moment = [stiffness * cell[:, n + 3], stiffness * cell[:, n + 4]]
    out = [
        mesh.node_depth,
        axial,
        -_linear(cell[:, column["torque"]], ~mesh.is_joint),
        at_nodes(cell[:, n], cell[:, n]),
        at_nodes(*moment),
        np.degrees(np.arccos(np.clip(t[:, 2], -1, 1))),
        *offset.T,
        at_nodes(cell[:, n + 1], cell[:, n + 2]),
        at_nodes(np.multiply(by_moment, moment[0]), np.multiply(by_moment, moment[1])),
        load,
        np.maximum(-effective, 0.0) / load,
    ]
    return np.column_stack(out)


def _at_nodes(upper: FloatArray, lower: FloatArray, element: np.ndarray | None = None) -> FloatArray:
    """(n+1,) means at the nodes of values at the upper and lower ends of the elements (n,); ``element`` (n,):
    false for joints."""
    out = np.concatenate([upper, lower[-1:]])
    out[1:-1] = 0.5 * (upper[1:] + lower[:-1])
    if element is None:
        return out
    for cell in np.flatnonzero(~element):  # either part has its own end at a joint
        out[cell] = lower[cell - 1] if cell and element[cell - 1] else 0.0
        out[cell + 1] = upper[cell + 1] if cell + 1 < len(upper) and element[cell + 1] else 0.0
    return out


def _linear(values: FloatArray, element: np.ndarray) -> FloatArray:
    """(n+1,) at the nodes from values constant in each element (n,): means, continued linearly to the
    ends."""
    out = _at_nodes(values, values, element)
    if len(values) > 1:
        out[0], out[-1] = 1.5 * values[0] - 0.5 * values[1], 1.5 * values[-1] - 0.5 * values[-2]
    return out


def _buckling_load(model: DrillingModel, axial: FloatArray) -> FloatArray:
    """(n_nodes,) load of sinusoidal buckling [N] of a string that lies in the hole; not a number where it has
    no such load."""
    mesh, well = model.mesh, model.well
    if well is None or model.contact is None:
        return np.full(mesh.nodes, np.nan)
    _, t, kappa = well.at(mesh.node_depth)
    weight = _at_nodes(model.effective_mass, model.effective_mass)[:, None] * np.array(model.case.gravity)
    side = np.linalg.norm(
        weight - t * np.sum(weight * t, axis=1, keepdims=True) + axial[:, None] * kappa, axis=1
    )
    component = np.asarray(well.radius(mesh.node_depth)) - _at_nodes(
        0.5 * mesh.outer_diameter, 0.5 * mesh.outer_diameter
    )
    inside = (component > 0) & (side > 1e-6 * np.linalg.norm(weight, axis=1))
    square = np.divide(
        _at_nodes(mesh.bending_stiffness, mesh.bending_stiffness) * side,
        component,
        out=np.full(mesh.nodes, np.nan),
        where=inside,
    )
    return 2 * np.sqrt(square)


def static_summary(model: DrillingModel, state: StaticState) -> dict[str, Any]:
    """Figures of a static state, the same on all ranks; SI.

    hook_load: pull of the top on the string, positive up; surface_torque: positive where the drive has to
    turn it clockwise; stretch: elongation of the whole string by axial force; twist: angle between its ends,
    not negative.
    """
    system, mesh = model.system, model.mesh
    if model.beam is None:
        return flow_summary(model)
    asm, cells, report = system.assembly, system.chain.cells, state.equilibrium
    beam = model.beam.report(system.layout, asm.x, asm.y)
    length, column = mesh.length[cells], REPORT.index
    mean = (
        beam[:, column("axial_upper")] + 4 * beam[:, column("axial_middle")] + beam[:, column("axial_lower")]
    ) / 6
    local = np.array(
        [
            np.sum(mean * length / mesh.axial_stiffness[cells]),
            np.sum(beam[:, column("torque")] * length / mesh.torsional_stiffness[cells]),
            *(model.bit.weight_and_torque(asm) if model.bit is not None else (0.0, 0.0)),
            model.drive.torque(0.0, asm) if model.drive is not None else 0.0,
        ]
    )
    stretch, twist, wob, bit_torque, drive = (
        local if system.comm.size == 1 else system.comm.tompi4py().allreduce(local)
    )
    force = model.case.top.force
    soft = state.soft_string
    out = {
        "motion": {"lowering": state.motion[0], "rotation": state.motion[1]},
        "hook_load": float(force.value(0.0)) if force is not None else -system.reaction("top.axial_reaction"),
        "surface_torque": system.reaction("top.torque_reaction") + float(drive),
        "stretch": float(stretch),
        "twist": abs(float(twist)),
        "wob": float(wob),
        "bit_torque": float(bit_torque),
        "negative_pivots": report.negative_pivots,
        "stable": state.stable,
        "iterations": report.iterations,
        "residual": report.residual,
        "imperfection": report.imperfection,
        "warnings": list(state.warnings),
    }
    if soft is not None:
        out["soft_string"] = {
            "hook_load": soft.hook_load,
            "surface_torque": soft.surface_torque,
            "stretch": soft.stretch,
        }
    return out | flow_summary(model)


def flow_summary(model: DrillingModel) -> dict[str, Any]:
    """Figures of the steady flow, the same on all ranks; SI: pressures at pump, under the bit and lost in the
    nozzles, flows, equivalent circulating density at the bottom (also that of the mud at rest under the same
    outlet is the density itself, if stiff)."""
    if model.fluid is None:
        return {}
    system = model.system
    record = FlowRecorder(system, model.fluid)
    sample = record.sample(0.0)
    if system.comm.size > 1:
        sample = system.comm.tompi4py().allreduce(sample)
    out = {name: value for (name, _), value in zip(record.columns, record.row(sample), strict=True)}
    head = float((model.position[-1] - model.position[0]) @ model.fluid.constants.gravity)
    if model.fluid.annulus is not None and head > 0:
        out["ecd"] = float(sample[1]) / head
    return out
