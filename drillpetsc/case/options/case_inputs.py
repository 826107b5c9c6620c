"""Inputs of a case that a session sets and that a linear model takes: keys that may vary over time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from drillpetsc.case.blocks.fluid import Fluid
from drillpetsc.case.case import Case
from drillpetsc.case.key_paths import parsed
from drillpetsc.unit_tables import DIMENSIONS

INPUTS = {
    "top": ("rotation", "lowering", "force", "torque"),
    "fluid": ("flow_rate", "pump_pressure", "outlet_pressure"),
}
AUTODRILLER = ("wob", "rop", "torque", "differential_pressure")
_UNITS = {
    "force": "N",
    "torque": "N m",
    "pump_pressure": "Pa",
    "wob": "N",
    "rop": "m/s",
    "differential_pressure": "Pa",
}
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
    drill = case.top.autodriller
    if drill is not None:
        out |= {f"top.autodriller.{key}": q for key in AUTODRILLER if (q := getattr(drill, key)) is not None}
        if drill.from_ == 0:  # it never acts
            out.pop("top.lowering", None)
    return out | {f"loads[{k}].value_over": load.value_over for k, load in enumerate(case.loads)}


def with_inputs(case: Case, inputs: Mapping[str, Any]) -> Case:
    """The case with other inputs over time in place of those of ``inputs_of``."""
    blocks: dict[str, dict[str, Any]] = {}
    for name, value in inputs.items():
        block, _, key = name.rpartition(".")
        blocks.setdefault(block, {})[key] = value
    loads = tuple(load.model_copy(update=blocks.pop(f"loads[{k}]", {})) for k, load in enumerate(case.loads))
    drill = blocks.pop("top.autodriller", None)
    if drill is not None and case.top.autodriller is not None:
        blocks.setdefault("top", {})["autodriller"] = case.top.autodriller.model_copy(update=drill)
    new = {block: getattr(case, block).model_copy(update=update) for block, update in blocks.items()}
    return case.model_copy(update=new | {"loads": loads})


def describe(case: Case, name: str) -> SessionInput:
    """Unit, bounds and description of the input ``name`` of a case."""
    *path, key = parsed(name)
    here: Any = case
    for part in path:
        here = here[part] if isinstance(part, int) else getattr(here, part)
    block = type(here)
    field = block.model_fields[str(key)]
    metadata = [m for m in field.metadata if hasattr(m, "unit")]
    unit = metadata[0].unit if metadata else _UNITS[str(key)]
    least = 0.0 if block is Fluid else None
    return SessionInput(name, unit, least, None, field.description or "")
