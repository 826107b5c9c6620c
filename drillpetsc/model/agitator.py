"""From the item `agitator` of a case to its component (manual: sec-agitator)."""

from __future__ import annotations

from drillpetsc.case.blocks.agitator import AgitatorTool
from drillpetsc.case.case import Case
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.physics.tools.agitator import Agitator, Valve
from drillpetsc.time_function import Constant


def build_agitator(case: Case, mesh: StringMesh) -> Agitator | None:
    """Create the agitator of the string; None without one, and in a plugged string without the mud that would turn it."""
    if case.fluid is not None and not case.has_bore:
        return None
    for _, item, joint in case.tools:
        if isinstance(item, AgitatorTool):
            cell = next(j.cell for j in mesh.joints if abs(j.depth - joint.at) < 1e-6)
            a = item.agitator
            valve = Valve(a.rev_per_volume, a.pressure_amplitude, a.piston_area, a.pulse == "square")
            if case.fluid is not None:
                return Agitator(mesh, cell, valve, None, 1.0 / case.fluid.bulk_modulus)
            return Agitator(mesh, cell, valve, a.flow_rate or Constant(0.0))
    return None
