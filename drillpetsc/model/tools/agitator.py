"""From the items `agitator` of a case to their components (manual: sec-agitator)."""

from __future__ import annotations

from drillpetsc.case.blocks.items.agitator import AgitatorTool
from drillpetsc.case.case import Case
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.physics.tools.agitator import Agitator, Valve
from drillpetsc.time_function import Constant


def build_agitators(case: Case, mesh: StringMesh) -> tuple[Agitator, ...]:
    """Create the agitators of the string, from the top; none in a plugged string without the mud that would turn them."""
    found: list[Agitator] = []
    if case.fluid is not None and not case.has_bore:
        return ()
    for _, item, joint in case.tools:
        if isinstance(item, AgitatorTool):
            cell = next(j.cell for j in mesh.joints if abs(j.depth - joint.at) < 1e-6)
            a = item.agitator
            valve = Valve(a.rev_per_volume, a.pressure_amplitude, a.piston_area, a.pulse == "square")
            wet = case.fluid is not None
            found.append(
                Agitator(
                    mesh,
                    cell,
                    valve,
                    None if wet else a.flow_rate or Constant(0.0),
                    1.0 / case.fluid.bulk_modulus if case.fluid is not None else None,
                    len(found) + 1,
                )
            )
    return tuple(found)
