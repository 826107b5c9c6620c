"""The table of a static state along the string, statics.csv."""

from __future__ import annotations

from functools import partial

import numpy as np

from drillpetsc.fem.component import FloatArray
from drillpetsc.fem.quantity import Sample
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output.catalogue import outputs_by_file
from drillpetsc.output.files.tables import Column
from drillpetsc.output.measured.bending import curvatures
from drillpetsc.output.measured.flow_recorder import FlowRecorder, flow_recorder
from drillpetsc.output.measured.in_hole import below_flow_line, equivalent_density, offsets
from drillpetsc.output.measured.rigid_items import RigidItems
from drillpetsc.output.measured.string_fields import StringFields
from drillpetsc.output.quantities.along_string import BENDING
from drillpetsc.parallel import total


def static_table(model: DrillingModel) -> tuple[list[Column], FloatArray | None]:
    """Names and units of the columns, and values (n_nodes, columns) at the nodes for the model's present state, on
    rank 0; no columns and None elsewhere.  Collective.

    Values of elements are means over the elements that meet at a node; the catalogue describes the columns.
    """
    mud = flow_recorder(model)
    wet = _of_mud(model, mud) if mud is not None else {}
    dry = _of_string(model, mud, wet) if model.beam.moves else {"md": model.mesh.node_depth}
    if wet is None or dry is None:
        return [], None
    data = wet | dry
    outputs = [q for q in outputs_by_file()["statics.csv"] if q.name in data]
    return [q.column for q in outputs], np.column_stack([data[q.name] for q in outputs])


def _of_mud(model: DrillingModel, mud: FlowRecorder) -> dict[str, FloatArray] | None:
    """Columns of the mud on rank 0; ``ecd`` is p/(g h), h the height of the flow line above the node at its present position."""
    system, sample = model.system, Sample(model.system, 0.0)
    parts = [q for q in mud.quantities() if q.on in ("node", "element") and q.unit != "m/s"]
    local = {q.name: (q.on, np.asarray(q.value(mud, sample))) for q in parts if q.value is not None}
    nodal = {name: values for name, (on, values) in local.items() if on == "node"}
    cellwise = {name: values for name, (on, values) in local.items() if on == "element"}
    at_vertices = system.gather(np.column_stack(list(nodal.values())))
    in_cells = system.gather(np.column_stack(list(cellwise.values())), "cell")
    places = system.gather(StringFields(model, mud).position(sample))
    if at_vertices is None or in_cells is None or places is None:
        return None
    out = dict(zip(nodal, at_vertices.T, strict=True))
    out |= {name: at_nodes(c, c) for name, c in zip(cellwise, in_cells.T, strict=True)}
    if mud.fluid.annulus is not None:
        gravity = float(np.linalg.norm(mud.fluid.constants.gravity))
        out["ecd"] = equivalent_density(out["annulus_pressure"], below_flow_line(model, places), gravity)
    return out


def _of_string(
    model: DrillingModel, mud: FlowRecorder | None, wet: dict[str, FloatArray] | None
) -> dict[str, FloatArray] | None:
    """Columns of the string on rank 0.

    buckling_load: 2 sqrt(EI q/r) of Dawson and Paslay (SPE 11167), with the side load q = |w_perp + T kappa| of the
    string in the hole and the radial clearance r; with mud, T and w are effective tension and buoyed weight.
    """
    system, mesh, sample = model.system, model.mesh, Sample(model.system, 0.0)
    string = StringFields(model, mud)
    axial, torque = string.axial_force(sample), string.results(sample, "torque")
    push = np.zeros(len(torque))
    if model.contact is not None:
        push = sample.once(model.contact.element_results)[0][:, 0] / mesh.length_divisor[system.chain.cells]
    items = RigidItems(model)
    on_items = items.at_nodes(total(system.comm.tompi4py(), items.loads(sample)))
    forces = string.end_forces(sample)
    bend = np.linalg.norm(curvatures(model, forces.moment), axis=2)
    parts = [
        forces.moment_size,
        forces.shear_size,
        string.bending_components(sample),
        string.shear_components(sample),
    ]
    # -1 would not do on a rank without elements
    across = np.concatenate([p.reshape(len(p), 2, int(np.prod(p.shape[2:]))) for p in parts], axis=2)
    nodal = system.gather(np.hstack([system.field("string.position"), system.field("string.tangent")]))
    cell = system.gather(
        np.column_stack(
            [axial, torque, push, bend, across.reshape(len(across), across.shape[1] * across.shape[2])]
        ),
        "cell",
    )
    if nodal is None or cell is None:
        return None
    upper, lower, torque, push, bend_upper, bend_lower, *ends = cell.T
    names = [q.name for q in (BENDING[0], BENDING[3], *BENDING[1:3], *BENDING[4:])]
    mean = partial(at_nodes, element=~mesh.is_joint)
    t = nodal[:, 3:] / np.linalg.norm(nodal[:, 3:], axis=1, keepdims=True)
    tension = effective = mean(upper, lower)
    out = {"md": mesh.node_depth, "axial_force": tension}
    if mud is not None and wet is not None:
        effective = tension + _of_pressures(model, mud, wet)
        out["effective_tension"] = effective
    radius = 0.5 * mesh.outer_diameter
    inertia = np.pi / 64 * (mesh.outer_diameter**4 - mesh.inner_diameter**4)
    by_moment = np.divide(radius, inertia, out=np.zeros_like(radius), where=inertia > 0)  # stress per moment
    moment = ends[0], ends[len(names)]
    load = _buckling_load(model, nodal[:, :3], effective)
    out["torque"] = -_linear(torque, ~mesh.is_joint)
    lag = -torque * mesh.length / np.where(mesh.is_joint, 1.0, mesh.torsional_stiffness)
    out["twist_angle"] = np.append(0.0, np.cumsum(np.where(mesh.is_joint, 0.0, lag)))
    out["contact_force"] = mean(push, push)
    out["item_side_force"] = on_items
    out |= {name: mean(ends[i], ends[i + len(names)]) for i, name in enumerate(names)}
    out["inclination"] = np.degrees(np.arccos(np.clip(t[:, 2], -1, 1)))
    out["offset_x"], out["offset_y"] = offsets(model, nodal[:, :3]).T
    out["curvature"] = mean(bend_upper, bend_lower)
    out["bending_stress"] = mean(np.multiply(by_moment, moment[0]), np.multiply(by_moment, moment[1]))
    out["buckling_load"] = load
    out["buckling_ratio"] = np.maximum(-effective, 0.0) / load
    return out


def _of_pressures(model: DrillingModel, mud: FlowRecorder, wet: dict[str, FloatArray]) -> FloatArray:
    """(n_nodes,) effective tension less axial force [N], -p_i A_i + p_o A_o, with mean areas at the nodes."""
    out = np.zeros(model.mesh.nodes)
    columns = {"bore": "internal_pressure", "annulus": "annulus_pressure"}
    for name, _, area, sign in mud.pressed_areas():
        out += -sign * wet[columns[name]] * at_nodes(area, area)
    return out


def at_nodes(upper: FloatArray, lower: FloatArray, element: np.ndarray | None = None) -> FloatArray:
    """(n+1,) means at the nodes of values (n,) at the upper and lower ends of the elements.

    element: (n,) False for joints, at which the two parts have separate ends.
    """
    out = np.concatenate([upper, lower[-1:]])
    out[1:-1] = 0.5 * (upper[1:] + lower[:-1])
    if element is None:
        return out
    for cell in np.flatnonzero(~element):
        out[cell] = lower[cell - 1] if cell and element[cell - 1] else 0.0
        out[cell + 1] = upper[cell + 1] if cell + 1 < len(upper) and element[cell + 1] else 0.0
    return out


def _linear(values: FloatArray, element: np.ndarray) -> FloatArray:
    """(n+1,) at the nodes from values (n,) constant in each element: means, continued linearly to the ends."""
    out = at_nodes(values, values, element)
    if len(values) > 1:
        out[0], out[-1] = 1.5 * values[0] - 0.5 * values[1], 1.5 * values[-1] - 0.5 * values[-2]
    return out


def _buckling_load(model: DrillingModel, position: FloatArray, tension: FloatArray) -> FloatArray:
    """(n_nodes,) load of sinusoidal buckling [N] of nodes at ``position`` (n_nodes, 3) [m] under an effective tension
    (n_nodes,) [N]; nan if the string has no side load or no clearance."""
    mesh, contact = model.mesh, model.contact
    if contact is None:
        return np.full(mesh.nodes, np.nan)
    well = contact.well
    depth = well.project(position).md  # of the hole at the node, which may be lowered or stretched to there
    _, t, kappa = well.at(depth)
    weight = at_nodes(model.effective_mass, model.effective_mass)[:, None] * np.array(model.case.gravity)
    side = np.linalg.norm(
        weight - t * np.sum(weight * t, axis=1, keepdims=True) + tension[:, None] * kappa, axis=1
    )
    radius = at_nodes(0.5 * mesh.clearance_diameter, 0.5 * mesh.clearance_diameter)
    clearance = np.asarray(well.radius(depth)) - radius
    inside = (clearance > 0) & (side > 1e-6 * np.linalg.norm(weight, axis=1))
    stiffness = at_nodes(mesh.bending_stiffness, mesh.bending_stiffness)
    square = np.divide(stiffness * side, clearance, out=np.full(mesh.nodes, np.nan), where=inside)
    return np.asarray(2 * np.sqrt(square))
