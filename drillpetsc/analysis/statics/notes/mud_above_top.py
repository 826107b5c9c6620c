"""What mud above a string's top inside the hole means for the hook load (manual: sec-mud-ends)."""

from __future__ import annotations

import numpy as np

from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output.measured.mud_column import below_flow_line
from drillpetsc.unit_systems import shown

LEAST_DEPTH = 1.0  # of the top below the flow line that is reported [m]


def mud_above_top(model: DrillingModel, hook_load: float | None = None) -> list[str]:
    """Sentence on the push of the mud on the upper face of a string whose top lies in it; none elsewhere.  Collective.

    hook_load: the force at the top [N], to which the push is added; None: it is not known.

    The force at the top balances the string below it.  The face above it is not part of the model: what stands there,
    a running string or a hanger, carries the mud's push on it.
    """
    fluid, system = model.fluid, model.system
    if fluid is None or fluid.annulus is None or model.well is None or model.beam is None:
        return []
    here = np.flatnonzero(system.chain.owned & (system.chain.vertices == 0))
    found = np.zeros(2)
    if len(here):
        position = system.field("string.position")[here[:1]]
        pressure = float(system.field("annulus.pressure")[here[0], 0]) - fluid.annulus.outlet.value(0.0)
        found[:] = float(below_flow_line(model, position)[0]), pressure
    if system.comm.size > 1:
        found = system.comm.tompi4py().allreduce(found)
    if not found[0] >= LEAST_DEPTH:  # nan without gravity
        return []
    units = model.case.shown_units
    force = found[1] * float(fluid.annulus.annulus.outer[0])
    push = shown(force, "force", units)
    both = (
        "" if hook_load is None else f", {shown(hook_load + force, 'force', units)} in all, the buoyed load"
    )
    return [
        f"the string's top stands in mud, {shown(found[0], 'length', units)} below the flow line: the hook load is the force on "
        f"the string there, without the mud's push on its upper face, {push}; a rig above sees this force, that push{both}, and the "
        "buoyed weight of what carries the string"
    ]
