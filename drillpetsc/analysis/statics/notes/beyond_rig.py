"""A static state that asks more of the rig than its limits."""

from __future__ import annotations

from typing import Any

from drillpetsc.case.case import Case
from drillpetsc.unit_systems import System, shown


def beyond_rig(case: Case, summary: dict[str, Any], units: System | None = None) -> list[str]:
    """Warnings where a static state asks more of the rig than it can bear.

    summary: of the state, in SI; units: of the figures, None: the case's.
    """
    rig = case.rig
    if rig is None:
        return []
    limits = (
        (
            "hook load",
            summary.get("hook_load_total", summary.get("hook_load")),
            rig.max_hookload,
            "max_hookload",
            "force",
        ),
        (
            "surface torque",
            summary.get("surface_torque"),
            rig.max_surface_torque,
            "max_surface_torque",
            "torque",
        ),
        ("standpipe pressure", summary.get("pump_pressure"), rig.max_spp, "max_spp", "pressure"),
    )
    system = units or case.shown_units
    return [
        f"{name} of {shown(abs(value), kind, system)} exceeds rig.{key}, {shown(limit, kind, system)}"
        for name, value, limit, key, kind in limits
        if value is not None and limit is not None and abs(value) > limit
    ]
