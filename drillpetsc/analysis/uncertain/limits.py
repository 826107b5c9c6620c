"""How likely the outputs of uncertain numbers are to pass a limit: buckling, the rig, the window of the open hole."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from drillpetsc.analysis.loads.torque_drag.table import LEAST_PUSH
from drillpetsc.analysis.sensitivities.solution import Output
from drillpetsc.arrays import FloatArray
from drillpetsc.case.case import Case


@dataclass(frozen=True)
class Limit:
    """A value of an output that should not be passed.

    output: its name; value: [SI]; above: whether greater values pass it; words: what it means for the string.
    """

    output: str
    value: float
    above: bool
    words: str


def limits_of(case: Case, outputs: Sequence[Output]) -> list[Limit]:
    """Limits of a case on the outputs that it has."""
    present = {output.quantity.name for output in outputs}
    hook = "hook_load_total" if "hook_load_total" in present else "hook_load"
    limits = [
        Limit("sinusoidal_ratio", 1.0, True, "buckles sinusoidally"),
        Limit("helical_ratio", 1.0, True, "coils"),
        Limit(hook, -LEAST_PUSH, False, "must be pushed"),
    ]
    limits += [
        Limit("frac_margin", 0.0, False, "above the fracture density"),
        Limit("pore_margin", 0.0, False, "below the pore density"),
    ]
    rig = case.rig
    if rig is not None:
        of_rig = (
            ("hook_load_total", rig.max_hookload, "rig.max_hookload"),
            ("surface_torque", rig.max_surface_torque, "rig.max_surface_torque"),
            ("pump_pressure", rig.max_spp, "rig.max_spp"),
        )
        limits += [
            Limit(name, value, True, f"above {key}") for name, value, key in of_rig if value is not None
        ]
    return [limit for limit in limits if limit.output in present]


def passed(
    limits: Sequence[Limit], outputs: Sequence[Output], values: FloatArray, method: str
) -> list[dict[str, Any]]:
    """Rows of uncertain_limits.csv: the share of the samples, those without a solution not counted, that pass each limit.

    values: (n, m) of all outputs [SI].
    """
    rows = []
    for limit in limits:
        for i, output in enumerate(outputs):
            mine = values[np.isfinite(values[:, i]), i]
            if output.quantity.name != limit.output or not len(mine):
                continue
            beyond = mine > limit.value if limit.above else mine < limit.value
            head = {
                "output": output.name,
                "bit_depth": output.bit_depth,
                "method": method,
                "output_unit": output.quantity.unit,
            }
            rows.append(head | {"limit": limit.value, "meaning": limit.words, "beyond": float(beyond.mean())})
    return rows
