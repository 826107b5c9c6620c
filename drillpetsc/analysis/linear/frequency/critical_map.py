"""Critical speeds over the stiffness of the wall, without damping (manual: sec-campbell-stiffness)."""

from __future__ import annotations

from typing import Any

import numpy as np
from petsc4py import PETSc

from drillpetsc.analysis.linear.frequency.campbell import Critical, Sought, campbell
from drillpetsc.analysis.linear.frequency.response import rpm_of
from drillpetsc.analysis.linear.frequency.turning import TurningModel, turning_case
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError


def demand_wall(case: Case) -> None:
    """Raise CaseError for a case whose string touches nothing."""
    if case.well is None or case.contact is None:
        raise CaseError(
            at="--stiffness",
            want="a well and contact: it is the stiffness of the wall",
            hint="give well and contact",
        )
    if case.contact.law != "linear":
        raise CaseError(
            at="--stiffness",
            got=f"contact.law {case.contact.law}",
            want="contact.law linear, whose stiffness is in Pa",
        )


def undamped(case: Case, stiffness: float) -> Case:
    """The case at a stiffness of the wall [Pa], without damping of the pipe and of impacts, and without friction."""
    assert case.well is not None and case.contact is not None
    none = {"stiffness": 0.0, "mass": 0.0}

    def still(material: Any) -> Any:
        if material is None or material.damping is None:
            return material
        return material.model_copy(update={"damping": material.damping.model_copy(update=none)})

    def smooth(item: Any) -> Any:
        changed: dict[str, Any] = {"friction": None if item.friction is None else 0.0}
        if item.material is not None:
            changed["material"] = still(item.material)
        if getattr(item, "damping", None) is not None and hasattr(item.damping, "stiffness"):
            changed["damping"] = item.damping.model_copy(update=none)
        return item.model_copy(update=changed)

    sections = tuple(q.model_copy(update={"friction": 0.0}) for q in case.well.sections)
    wall = {"stiffness": stiffness, "restitution": 1.0, "stribeck": None}
    changed = {
        "material": still(case.material),
        "string": tuple(smooth(item) for item in case.string),
        "well": case.well.model_copy(update={"sections": sections}),
        "contact": case.contact.model_copy(update=wall),
    }
    if getattr(case.bottom, "friction", None) is not None:
        changed["bottom"] = case.bottom.model_copy(update={"friction": 0.0})
    return case.model_copy(update=changed)


def critical_map(
    case: Case,
    stiffnesses: tuple[float, ...],
    sought: Sought,
    without_control: bool,
    comm: PETSc.Comm,
) -> list[tuple[float, Critical]]:
    """Critical speeds of the undamped case at each stiffness of the wall [Pa], by natural frequencies; collective.

    without_control: as for ``run_campbell``.
    """
    out = []
    for stiffness in stiffnesses:
        states = TurningModel(turning_case(undamped(case, stiffness), "campbell", without_control), comm)
        out += [(stiffness, c) for c in campbell(states, sought, natural=True).critical]
    return out


def map_columns(found: list[tuple[float, Critical]]) -> list[Any]:
    """Columns of critical_map.csv."""
    rows = [
        [k, c.branch, c.kind, c.whirl, c.excitation, c.line, rpm_of(c.speed), c.frequency] for k, c in found
    ]
    return [np.array(column) for column in zip(*rows, strict=True)] if rows else [np.zeros(0)] * 8
