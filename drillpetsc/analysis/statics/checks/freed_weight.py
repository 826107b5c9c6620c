"""The weight on bit after a string that was lowered without rotation begins to turn."""

from __future__ import annotations

from drillpetsc.analysis.statics.placement import prescribed_motion
from drillpetsc.analysis.statics.start.soft_string_start import soft_string
from drillpetsc.case.quantities import largest
from drillpetsc.model.drilling_model import DrillingModel

MOST = 100.0  # largest weight that is tried, over initial.wob
ACCURACY = 1e-4


def freed_weight(model: DrillingModel, least: float = 0.0) -> float | None:
    """Weight on bit [N] at which the turning string is as long as the sliding one of the start, with its top where it was.

    By the soft string.  None where the start does not slide, the top never turns, or no such weight is found.

    least: growth over initial.wob below which the weight is not sought.
    """
    case, (lowering, rotation) = model.case, prescribed_motion(model)
    top = case.top.rotation
    later = 0.0 if top is None else largest(top)
    if not case.initial.wob or not lowering > 0 or rotation or not later > 0 or case.top.force is not None:
        return None
    sliding = soft_string(model, (lowering, 0.0))
    if sliding is None:
        return None

    def longer(wob: float) -> float:
        turning = soft_string(model, (lowering, later), wob)
        assert turning is not None
        return turning.stretch - sliding.stretch

    if not longer((1 + least) * case.initial.wob) > 0:
        return None
    from scipy.optimize import brentq  # takes longer to be imported than all else here

    low, high = case.initial.wob, 2 * case.initial.wob
    while longer(high) > 0:
        low, high = high, 2 * high
        if high > MOST * case.initial.wob:
            return None
    return float(brentq(longer, low, high, rtol=ACCURACY)) if longer(low) > 0 else None
