"""What a scene with the quaternion element cannot have."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pydantic_core import PydanticCustomError

from drillpetsc.case.blocks.ends import DrivenTop
from drillpetsc.case.blocks.string import Rigid
from drillpetsc.case.key_paths import refuse
from drillpetsc.errors import CaseError

if TYPE_CHECKING:
    from drillpetsc.case.case import Case


def check_quaternion(case: Case) -> None:
    """Raises on the first part of the scene that the quaternion element does not know."""
    if case.beam.formulation != "quaternion":
        return
    if case.hold_string:
        raise _not_yet("hold_string", got=True, what="hold_string (there is no string to compute)")
    if case.fluid is not None and case.fluid.formulation == "hermite":
        raise _not_yet("fluid", "formulation", got="hermite", what="hermite mud")
    if isinstance(case.top, DrivenTop):
        raise _not_yet("top", "kind", got="driven", what="a driven top")
    last = max((i for i, item in enumerate(case.string) if not isinstance(item, Rigid)), default=0)
    for i, item in enumerate(case.string[:last]):
        if isinstance(item, Rigid):
            raise _not_yet("string", i, "kind", got=item.kind, what="rigid items above other pipe")
    if case.initial.from_ not in ("statics", "rest", "straight"):
        raise _not_yet("initial", "from", got=case.initial.from_, what="the end of another run")
    if getattr(case, "joints", ()):
        raise _not_yet("joints", what="joints")
    mode = getattr(case.time, "mode", "dynamic")
    if mode != "dynamic":
        raise _not_yet("time", "mode", got=mode, what=f"time.mode {mode}")


def refuse_quaternion(case: Case, command: str) -> None:
    """Raises CaseError where a command knows the ANCF element only."""
    if case.beam.formulation == "quaternion":
        raise CaseError(
            at="beam.formulation",
            got="quaternion",
            want=f"ancf with {command}: not with quaternion yet",
            hint="the string is the same, in other unknowns",
        )


def _not_yet(*at: str | int, got: Any = None, what: str, hint: str = "") -> PydanticCustomError:
    return refuse(
        *at,
        got=got,
        want=f"not with quaternion yet: {what}",
        hint=hint or "leave it out, or take beam.formulation ancf",
    )
