"""Measured points beside the bands of a roadmap."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from drillpetsc.analysis.loads.torque_drag.operations import load_of, plan_of
from drillpetsc.analysis.loads.torque_drag.readings.reading import corrected_points
from drillpetsc.analysis.sensitivities.solution import Output
from drillpetsc.arrays import FloatArray
from drillpetsc.case.case import Case


def inside_band(case: Case, outputs: Sequence[Output], quantiles: FloatArray) -> list[dict[str, Any]]:
    """Measured values [SI] with the lowest and highest quantile at their bit depths, interpolated between rows.

    quantiles: (m, q) of the outputs [SI], ascending.  Points outside the rows' depths, and outputs that were not computed, are left out.
    """
    plan, out = plan_of(case), []
    hook = "hook_load" if plan.hookload_excludes_block else "hook_load_total"
    for point in corrected_points(case, plan.measured or (), plan.hookload_excludes_block):
        turns = load_of(case, plan, point.operation).rotation if point.rpm is None else point.rpm
        for name, value in ((hook, point.hook_load), ("surface_torque", point.torque if turns else None)):
            rows = [i for i, q in enumerate(outputs) if q.name == f"{point.operation}.{name}"]
            rows.sort(key=lambda i: outputs[i].bit_depth)
            depths = np.array([outputs[i].bit_depth for i in rows])
            if value is None or not rows or not depths[0] <= point.bit_depth <= depths[-1]:
                continue
            low, high = (float(np.interp(point.bit_depth, depths, quantiles[rows, q])) for q in (0, -1))
            head = {"bit_depth": point.bit_depth, "operation": point.operation, "output": name}
            out.append(head | {"measured": value, "low": low, "high": high, "inside": low <= value <= high})
    return out
