"""The answer of statics: numbers of a static state, the same on all ranks."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.analysis.statics.equilibrium import StaticState
from drillpetsc.analysis.statics.placement import top_depth
from drillpetsc.fem.component import FloatArray
from drillpetsc.fem.quantity import Sample
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output.measured.flow_recorder import flow_recorder
from drillpetsc.output.measured.in_hole import below_flow_line, equivalent_density
from drillpetsc.output.measured.rigid_items import RigidItems
from drillpetsc.output.measured.string_ends import TopEnd
from drillpetsc.parallel import total
from drillpetsc.physics.beam import RESULT_NAMES
from drillpetsc.physics.interfaces import Drive

NOISE = 1e-12  # share of the largest load below which a load is rounding noise


def static_summary(model: DrillingModel, state: StaticState) -> dict[str, Any]:
    """Numbers of a static state [SI], the same on all ranks; the catalogue describes them."""
    system, mesh = model.system, model.mesh
    if not model.beam.moves:
        return flow_summary(model)
    asm, cells, report = system.assembly, system.chain.cells, state.equilibrium
    beam = model.beam.element_results(asm)
    length, column = mesh.length[cells], RESULT_NAMES.index
    mean = (
        beam[:, column("axial_upper")] + 4 * beam[:, column("axial_middle")] + beam[:, column("axial_lower")]
    ) / 6
    local = np.array(
        [
            np.sum(mean * length / mesh.axial_stiffness[cells]),
            np.sum(beam[:, column("torque")] * length / mesh.torsional_stiffness[cells]),
            *(model.bit.weight_and_torque(asm) if model.bit is not None else (0.0, 0.0)),
            sum(drive.torque(0.0, asm) for drive in model.parts(Drive)),
        ]
    )
    stretch, twist, wob, bit_torque, drive = _sum_over_ranks(model, local)
    force, soft = model.case.top.force, state.soft_string
    out: dict[str, Any] = {
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
    if model.top.prescribes or force is not None:
        top, sample = TopEnd(model), Sample(system, 0.0)
        out["top_travel"] = top.travel(_sum_over_ranks(model, top.positions(sample)[0]))
    if model.case.rig is not None and model.case.rig.block_weight is not None:
        out["hook_load_total"] = out["hook_load"] + model.case.rig.block_weight
    if model.contact is not None:
        items = RigidItems(model)
        out["rigid_items"] = items.listed(
            _sum_over_ranks(model, items.loads(Sample(system, 0.0))), top_depth(model)
        )
    for name in ("hook_load", "surface_torque", "wob", "bit_torque"):
        out[name] = without_noise(out[name], abs(out["hook_load"]) + abs(out["wob"]))
    if soft is not None:
        out["soft_string"] = {
            "hook_load": soft.hook_load,
            "surface_torque": soft.surface_torque,
            "stretch": soft.stretch,
        }
    return out | flow_summary(model)


def without_noise(value: float, scale: float) -> float:
    """``value``, or 0 where it is rounding noise of numbers of the size ``scale``."""
    return 0.0 if abs(value) <= NOISE * scale else value


def flow_summary(model: DrillingModel) -> dict[str, Any]:
    """Numbers of the steady flow [SI], the same on all ranks; empty without mud.

    ecd: equivalent circulating density at the bottom [kg/m3], of the column from the flow line to where the lower end is now; that
    of still mud is the density, if it is stiff.
    """
    mud, sample = flow_recorder(model), Sample(model.system, 0.0)
    if mud is None:
        return {}
    ends = [q for q in mud.quantities() if q.on == "scalar" and q.value is not None]
    values = _sum_over_ranks(model, np.array([q.value(mud, sample) for q in ends]))  # type: ignore[misc]
    out: dict[str, Any] = dict(zip([q.name for q in ends], map(float, values), strict=True))
    if mud.fluid.annulus is not None:
        gravity = float(np.linalg.norm(mud.fluid.constants.gravity))
        density = equivalent_density(out["bit_pressure"], below_flow_line(model, _lower_end(model)), gravity)[
            0
        ]
        if np.isfinite(density):
            out["ecd"] = float(density)
    return out


def _lower_end(model: DrillingModel) -> FloatArray:
    """(1, 3) position of the last node [m], the same on all ranks."""
    chain, place = model.system.chain, np.zeros(3)
    mine = np.flatnonzero(chain.owned & (chain.vertices == model.mesh.nodes - 1))
    if len(mine):
        place = np.asarray(model.beam.section(model.system.assembly, int(mine[0]))[0])
    return _sum_over_ranks(model, place)[None, :]


def _sum_over_ranks(model: DrillingModel, values: FloatArray) -> FloatArray:
    return np.asarray(total(model.system.comm, values))
