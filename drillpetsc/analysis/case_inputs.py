"""Inputs of a case that a session sets and that a linear model takes: keys that may vary over time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from drillpetsc.case.blocks.fluid import Fluid
from drillpetsc.case.case import Case
from drillpetsc.unit_tables import DIMENSIONS

INPUTS = {
    "top": ("rotation", "lowering", "force", "torque"),
    "fluid": ("flow_rate", "pump_pressure", "outlet_pressure"),
}
_UNITS = {"force": "N", "torque": "N m", "pump_pressure": "Pa"}
assert set(_UNITS.values()) <= set(DIMENSIONS)


@dataclass(frozen=True)
class SessionInput:
    """An input of a session.

    name: key path of the case; unit: SI; minimum, maximum: allowed values, None: any; description.
    """

    name: str
    unit: str
    minimum: float | None
    maximum: float | None
    description: str


def inputs_of(case: Case) -> dict[str, Any]:
    """What the case gives over time, by key path."""
    out: dict[str, Any] = {}
    for block_name, keys in INPUTS.items():
        block = getattr(case, block_name)
        for key in keys if block is not None else ():
            given = getattr(block, key, None) if key in type(block).model_fields else None
            if given is None or (key == "lowering" and case.top.force is not None):
                continue
            if key == "rotation" and case.top.torque is not None:
                continue
            out[f"{block_name}.{key}"] = given
    return out


def with_inputs(case: Case, inputs: Mapping[str, Any]) -> Case:
    """The case with other inputs over time in place of those of ``inputs_of``."""
    changed: dict[str, Any] = {}
    for block_name in INPUTS:
        update = {
            key: value
            for name, value in inputs.items()
            for block, key in [name.split(".")]
            if block == block_name
        }
        if update:
            changed[block_name] = getattr(case, block_name).model_copy(update=update)
    return case.model_copy(update=changed)


def describe(case: Case, name: str) -> SessionInput:
    """Unit, bounds and description of the input ``name`` of a case."""
    block_name, key = name.split(".")
    block = type(getattr(case, block_name))
    field = block.model_fields[key]
    metadata = [m for m in field.metadata if hasattr(m, "unit")]
    unit = metadata[0].unit if metadata else _UNITS[key]
    least = 0.0 if block is Fluid else None
    return SessionInput(name, unit, least, None, field.description or "")
